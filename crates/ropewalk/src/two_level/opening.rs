//! Parts of large objects as entries of the top level.
//!
//! An object that fills the scene is entered by every ray, and its box says nothing. Opened, it stands in the top level with
//! nodes of its own tree, each with a box of its own; a ray that comes to one enters the object there, and is led through that
//! subtree alone. [`super::top_level`] decides what is worth opening ([`rebraid`], or blindly [`subdivide`]).
//!
//! **The same answer.** The box of a whole instance takes part in what a hit is ([`super::enter`]), so nothing above can miss it.
//! The boxes of parts do not: they are images of boxes of the object's space, where the ray was rounded in another way. So for the
//! top level a ray is *wide*: its two origins are moved apart by more than all that rounding, which makes every box larger by as
//! much, whichever it is. Of a ray at `o` that meets something at `t`, taking it to the object and back moves it by no more than
//! 16 units of roundoff of `|o| + |t d|`, times how many times longer the transform makes some vectors than others; and
//! `|t d|` is no more than `|o|` and the scene's largest coordinate together. [`WIDTH`] doubles that again. A ray that is not
//! opened for is not widened.

use super::top_level::{OpenEntry, Openable, rebraid, subdivide};
use super::{Entry, Opening, Placed, TwoLevel};
use crate::{Aabb, PreparedRay};
use glam::{Mat3, Vec3};

/// 128 units of roundoff.
const WIDTH: f32 = 64.0 * f32::EPSILON;

/// An instance is opened blindly where its box has so much of the area of the scene's.
const LARGE: f32 = 0.25;

/// The objects' own trees.
struct Parts<'a>(&'a TwoLevel);

impl Openable for Parts<'_> {
    fn open(&self, entry: &OpenEntry) -> Option<[OpenEntry; 2]> {
        let placed = self.0.placed.get(entry.instance as usize)?;
        let structure = self.0.objects.get(placed.object as usize)?.as_deref()?;
        let parts = structure.bottom().parts(entry.node)?;
        let part = |(node, _): (u32, Aabb)| {
            let bounds = self.0.entry_bounds(Entry { place: entry.instance, node });
            OpenEntry { instance: entry.instance, node, bounds }
        };
        let parts = parts.map(part);
        // What rounding has left nothing of is not worth a leaf.
        parts.iter().all(|part| !part.bounds.is_empty()).then_some(parts)
    }
}

impl TwoLevel {
    /// Makes the entries of the top level, and their boxes.
    pub(super) fn open(&mut self) {
        self.entries.clear();
        self.boxes.clear();
        self.width = 0.0;
        if self.options.opening == Opening::Never {
            self.entries.extend((0..self.placed.len() as u32).map(|place| Entry { place, node: 0 }));
            self.boxes.extend(self.placed.iter().map(Placed::bounds));
            return;
        }
        let whole = |(place, placed): (usize, &Placed)| OpenEntry {
            instance: place as u32,
            node: 0,
            bounds: placed.bounds(),
        };
        let entries: Vec<OpenEntry> = self.placed.iter().enumerate().map(whole).collect();
        let opened = match self.options.opening {
            Opening::Never => entries,
            Opening::ByCost(parts) => {
                let budget = entries.len().saturating_mul(parts as usize - 1);
                rebraid(entries, budget, &Parts(self))
            }
            Opening::Blindly(parts) => {
                let limit = self.bounds().half_area() * LARGE;
                let is_large = |entry: &OpenEntry| entry.bounds.half_area() >= limit;
                let (large, mut opened): (Vec<_>, Vec<_>) = entries.into_iter().partition(is_large);
                opened.extend(subdivide(large, parts as usize, &Parts(self)));
                opened
            }
        };
        if opened.len() > self.placed.len() {
            self.width = WIDTH * self.placed.iter().map(stretch).fold(1.0, f32::max);
        }
        self.entries.extend(opened.iter().map(|part| Entry { place: part.instance, node: part.node }));
        self.boxes.extend(opened.iter().map(|part| part.bounds));
    }

    /// Moves the boxes of the entries to where the instances are.
    pub(super) fn follow(&mut self) {
        for index in 0..self.entries.len() {
            self.boxes[index] = self.entry_bounds(self.entries[index]);
        }
        if self.width > 0.0 {
            self.width = WIDTH * self.placed.iter().map(stretch).fold(1.0, f32::max);
        }
    }

    /// The box of an entry: of a whole instance its own, of a part what its image and that have in common.
    fn entry_bounds(&self, entry: Entry) -> Aabb {
        let placed = &self.placed[entry.place as usize];
        let whole = placed.bounds();
        if entry.node == 0 {
            return whole;
        }
        let structure = self.objects.get(placed.object as usize).and_then(Option::as_deref);
        let (Some(structure), Some(instance)) = (structure, self.instance(placed.instance())) else {
            return whole;
        };
        let part = structure.bottom().part_bounds(entry.node);
        let image = structure.part_bounds(&instance.transform, &part);
        let common = Aabb::new(whole.min.max(image.min), whole.max.min(image.max));
        // Of a part that moved with its instance rounding may leave nothing: then the whole is right, too.
        if common.is_empty() { whole } else { common }
    }

    /// A ray as the boxes of the top level are asked for it.
    #[inline(always)]
    pub(super) fn widened(&self, ray: &PreparedRay) -> PreparedRay {
        if self.width == 0.0 {
            return *ray;
        }
        let bounds = self.top.bounds();
        let largest = bounds.min.abs().max(bounds.max.abs()).max_element();
        let from = Vec3::from(ray.origin).abs().max_element();
        let step = Vec3::splat(self.width * (from + largest)).extend(0.0);
        PreparedRay { origin_low: ray.origin_low + step, origin_high: ray.origin_high - step, ..*ray }
    }
}

/// How many times longer an instance's transform makes some vectors than others, at most.
fn stretch(placed: &Placed) -> f32 {
    let axes = [placed.axis_x, placed.axis_y, placed.axis_z].map(Vec3::from);
    let to_local = Mat3::from_cols(axes[0], axes[1], axes[2]);
    let norm = |matrix: Mat3| matrix.to_cols_array().map(|it| it * it).iter().sum::<f32>().sqrt();
    let stretch = norm(to_local) * norm(to_local.inverse());
    if stretch.is_finite() { stretch } else { f32::MAX }
}
