//! What rays go through: the top level, and the objects of its instances.

use super::find::{Find, Inside};
use crate::bvh8::arena::{CompactView, Reader, View, prefetch};
use crate::bvh8::instanced::Top;
use crate::bvh8::node::{PackedNode, Word};
use crate::bvh8::walk::single::{ByForm, Place};
use crate::bvh8::{Bvh8, Form, Instanced};
use crate::two_level::{Moving, Placed};
use crate::{PreparedRay, Probe, Ray};
use std::marker::PhantomData;
use std::sync::Arc;

/// What rays go through.
#[derive(Clone, Copy)]
pub(super) struct Levels<'a, R> {
    pub(super) top: View<'a>,
    placed: &'a [Placed],
    /// **Invariant**: their form is that of the reader.
    objects: &'a [Arc<Bvh8>],
    reader: PhantomData<R>,
}

impl Instanced {
    /// What rays go through.
    pub(super) fn levels(&self) -> ByForm<Levels<'_, View<'_>>, Levels<'_, CompactView<'_>>> {
        match self.form() {
            // SAFETY: the reader is that of the form.
            Form::Full => ByForm::Full(unsafe { Levels::of(self) }),
            // SAFETY: as above.
            Form::Compact { .. } => ByForm::Compact(unsafe { Levels::of(self) }),
        }
    }
}

impl<'a, R: Reader<'a>> Levels<'a, R> {
    /// # Safety
    /// The reader is that of the objects' form.
    unsafe fn of(scene: &'a Instanced) -> Self {
        // SAFETY: the top level has full nodes.
        let top = unsafe { View::new(&scene.top().arena) };
        Self { top, placed: scene.placed(), objects: scene.objects(), reader: PhantomData }
    }

    /// Takes a ray to the instance of a leaf's word; `None` where it passes by or does not see it.
    #[inline(always)]
    pub(super) fn approach<P: Probe>(
        self,
        word: Word,
        question: &Ray,
        ray: &PreparedRay,
        probe: &mut P,
    ) -> Option<Approach<'a, R>> {
        probe.object_tested();
        let placed = &self.placed[Top::place(word)];
        let span = placed.span(ray)?;
        let local = placed.local(question)?;
        probe.object_entered();
        // SAFETY: the maker's.
        let place = unsafe { self.objects[placed.object as usize].place_of::<R>() };
        let moving = Moving::new(placed, span, &local);
        Some(Approach { ray: local.ray, place, moving, instance: placed.instance() })
    }

    /// Asks for what a word of the top level names.
    #[inline(always)]
    pub(super) fn prefetch(self, word: Word) {
        if word.is_leaf() {
            let placed = self.placed.as_ptr().wrapping_add(Top::place(word));
            prefetch(placed);
            prefetch(placed.wrapping_byte_add(64));
        } else {
            self.top.prefetch(word);
        }
    }
}

/// A ray in the space of an instance's object.
pub(super) struct Approach<'a, R> {
    pub(super) ray: PreparedRay,
    pub(super) place: Place<'a, R>,
    pub(super) moving: Moving,
    instance: u32,
}

impl<'a, R: Copy> Approach<'a, R> {
    /// What the object's hits are offered to.
    #[inline(always)]
    pub(super) fn inside<'s, F: Find<'a>>(&self, find: &'s mut F) -> Inside<'s, 'a, F> {
        let Self { moving, instance, place, .. } = *self;
        Inside { find, moving, instance, names: place.names, ended: false }
    }
}

impl Instanced {
    /// The node of a word that was read from a node of the top level, or of the root's.
    pub(in super::super::super) fn node(&self, word: Word) -> &PackedNode {
        // SAFETY: the top level has full nodes, and inside of this folder there are no other words of nodes.
        unsafe { View::new(&self.top().arena).node(word) }
    }
}
