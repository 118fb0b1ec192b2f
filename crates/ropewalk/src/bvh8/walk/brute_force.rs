//! Every leaf, whatever its box: the reference.

use super::boxes::Boxes;
use super::single::{ByForm, Place, visit_leaf};
use super::sink::{Named, tell};
use crate::batch::Traversal;
use crate::bvh::walk::Collect;
use crate::bvh8::arena::Reader;
use crate::bvh8::leaf::Triangles;
use crate::bvh8::node::{Fan, PackedNode, Word};
use crate::bvh8::simd::{Level, Task, dispatch};
use crate::bvh8::{Bvh8, ROOT};
use crate::{Counters, FlatTriangle, PreparedRay, Probe, Ray};

/// The leaves of a tree, in its order.
struct Leaves<'a> {
    bvh: &'a Bvh8,
    pending: Vec<Word>,
}

impl Iterator for Leaves<'_> {
    type Item = Word;

    fn next(&mut self) -> Option<Word> {
        loop {
            let word = self.pending.pop()?;
            if word.is_leaf() {
                return Some(word);
            }
            let children = self.bvh.fan(word).children;
            self.pending.extend(children.into_iter().rev().map(Word).filter(|&word| word != ROOT));
        }
    }
}

impl Bvh8 {
    fn leaves(&self) -> Leaves<'_> {
        Leaves { bvh: self, pending: if self.is_empty() { Vec::new() } else { vec![ROOT] } }
    }

    /// What is in the places of a node, by a word that was read from a node or the root's.
    fn fan(&self, word: Word) -> &Fan {
        match self.place() {
            // SAFETY: inside of this folder there are no other words of nodes.
            ByForm::Full(place) => unsafe { place.view.node(word) }.fan(),
            // SAFETY: as above.
            ByForm::Compact(place) => unsafe { place.view.node(word) }.fan(),
        }
    }

    /// The node of a word that was read from a node, or of the root's, as a full one.
    pub(in super::super) fn node(&self, word: Word) -> PackedNode {
        match self.place() {
            // SAFETY: inside of this folder there are no other words of nodes.
            ByForm::Full(place) => *unsafe { place.view.node(word) },
            // SAFETY: as above.
            ByForm::Compact(place) => unsafe { place.view.node(word) }.full(),
        }
    }

    /// Appends the triangles of a leaf, with their names.
    pub(in super::super) fn read_leaf(&self, word: Word, triangles: &mut Vec<FlatTriangle>) {
        match self.place() {
            // SAFETY: inside of this folder there are no other words of leaves.
            ByForm::Full(place) => self.append(unsafe { place.view.leaf(word) }, triangles),
            // SAFETY: as above.
            ByForm::Compact(place) => self.append(unsafe { place.view.leaf(word) }, triangles),
        }
    }

    fn append<T: Triangles>(&self, leaf: T, triangles: &mut Vec<FlatTriangle>) {
        for place in 0..leaf.len() {
            let ([v0, v1, v2], name) = (leaf.vertices(place), self.names.name(leaf.name(place)));
            triangles.push(FlatTriangle {
                v0,
                primitive: name.primitive,
                v1,
                geometry_and_mirror: name.geometry | if name.mirrored { FlatTriangle::MIRROR } else { 0 },
                v2,
                instance_and_mask: name.instance | name.mask,
            });
        }
    }

    /// Appends where the vertices of a leaf's triangles begin in the arena, in words. Nothing of a tree in full.
    pub(in super::super) fn append_vertices(&self, word: Word, vertices: &mut Vec<usize>) {
        if let ByForm::Compact(place) = self.place() {
            // SAFETY: inside of this folder there are no other words of leaves.
            let leaf = unsafe { place.view.leaf(word) };
            let of = |triangle| [0, 1, 2].map(|corner| leaf.vertex(corner, triangle));
            vertices.extend((0..leaf.len()).flat_map(of));
        }
    }

    /// Tests every triangle. Kept out of its callers, as the walk of one ray is.
    #[inline(never)]
    fn test_every_leaf<'r>(&self, ray: &'r PreparedRay, sink: Named<'r, false>) -> Counters {
        match self.place() {
            ByForm::Full(place) => dispatch(self.level, Test { bvh: self, place, ray, sink }),
            ByForm::Compact(place) => dispatch(self.level, Test { bvh: self, place, ray, sink }),
        }
    }

    /// The triangles, in the order of the leaves, as they stand there.
    #[must_use]
    pub fn triangles(&self) -> Vec<FlatTriangle> {
        let mut triangles = Vec::with_capacity(self.report().references);
        for word in self.leaves() {
            self.read_leaf(word, &mut triangles);
        }
        triangles
    }
}

/// The tree, and no walk.
#[derive(Clone, Copy)]
pub(super) struct EveryLeaf<'a>(pub(super) &'a Bvh8);

impl Traversal for EveryLeaf<'_> {
    fn visit<C: Collect, P: Probe>(
        &self,
        _: &Ray,
        ray: &PreparedRay,
        mut collect: C,
        mut probe: P,
    ) -> (C, P) {
        let sink = Named::new(&mut collect, &self.0.names);
        tell(&self.0.test_every_leaf(ray, sink), &mut probe);
        (collect, probe)
    }

    fn has_repeats(&self) -> bool {
        self.0.has_repeats()
    }
}

struct Test<'a, 'r, R> {
    bvh: &'a Bvh8,
    place: Place<'a, R>,
    ray: &'r PreparedRay,
    sink: Named<'r, false>,
}

impl<'a, R: Reader<'a>> Task for Test<'a, '_, R> {
    type Output = Counters;

    #[inline(always)]
    fn run<L: Level>(mut self, level: L) -> Counters {
        let mut counters = Counters::default();
        for word in self.bvh.leaves() {
            // SAFETY: the word was read from a node of this arena.
            let flow =
                unsafe { visit_leaf(level, self.place, word, self.ray, &mut self.sink, &mut counters) };
            if flow.is_break() {
                break;
            }
        }
        counters
    }
}
