//! Everything that shading reads, as plain words: the same for the CPU and for a graphics device.
//!
//! A [`Looks`] is made of a [`Stage`](crate::Stage) and of the light of a picture. [`layout`] says which word is which;
//! [`place`] finds the place of a hit in them, [`shaded`] the material there, [`texture`] looks textures up. These are the
//! only readers on the CPU, and each has its twin in the shaders; so both devices see the same material to the bit.
//!
//! **Arithmetic.** f32 and whole numbers; sums of products as scalar products (`dot`), whose order shader compilers keep;
//! no function but the square root.
//!
//! **Size.** 40 bytes a triangle, 12 a vertex and a normal, 8 a coordinate, 4 a texel: a scene of a million triangles and
//! half a million vertices takes about 60 MB.

mod atlas;
pub(crate) mod layout;
mod pack;
mod panes;
mod place;
mod shaded;
#[cfg(test)]
mod tests;
mod texture;
mod update;

pub(crate) use panes::MOST_PANES;
pub(crate) use place::Place;
pub(crate) use shaded::Shaded;

use glam::{Vec2, Vec3};

/// Everything that shading reads. See [`layout`] for the words.
#[derive(Clone, Debug)]
pub(crate) struct Looks {
    words: Vec<u32>,
    texels: Vec<u32>,
    /// Where the vertices and normals of each geometry stand, for poses.
    parts: Vec<pack::Part>,
    /// The first of `parts` of each object.
    first_parts: Vec<usize>,
}

impl Looks {
    /// The tables, for a device.
    pub(crate) fn words(&self) -> &[u32] {
        &self.words
    }

    /// The atlas, for a device; never empty.
    pub(crate) fn texels(&self) -> &[u32] {
        &self.texels
    }

    /// Whether some material has holes, so that walks must ask [`Looks::is_cut_out`].
    pub(crate) fn has_cut_outs(&self) -> bool {
        self.word(layout::FLAGS) & layout::HAS_CUT_OUTS != 0
    }

    /// How much of a shadow the ground that catches shadows shows at a point of it: 1 near the model, 0 at its rim.
    pub(crate) fn catcher_strength(&self, point: Vec3) -> f32 {
        let away = point - self.vector(layout::CATCHER + 1);
        let share = away.dot(away).sqrt() / self.float(layout::CATCHER + 4);
        // As crate::ground has it: whole up to 0.45 of the reach.
        let fade = ((1.0 - share) / 0.55).clamp(0.0, 1.0);
        let square = fade * fade;
        square * (3.0 - (fade + fade))
    }

    /// A word; 0 beyond the end.
    pub(crate) fn word(&self, at: usize) -> u32 {
        self.words.get(at).copied().unwrap_or(0)
    }

    pub(crate) fn float(&self, at: usize) -> f32 {
        f32::from_bits(self.word(at))
    }

    fn pair(&self, at: usize) -> Vec2 {
        Vec2::new(self.float(at), self.float(at + 1))
    }

    pub(crate) fn vector(&self, at: usize) -> Vec3 {
        Vec3::new(self.float(at), self.float(at + 1), self.float(at + 2))
    }

    /// Where a row of a table stands.
    fn row(&self, table: usize, row: u32, size: usize) -> usize {
        self.word(table) as usize + row as usize * size
    }
}
