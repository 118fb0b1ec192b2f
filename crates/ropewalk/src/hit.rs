//! Hits: what a walk answers, and the rule that makes the answer unique.
//!
//! **The tie rule.** The smaller `t` wins; at equal `t` the smaller `(instance, geometry, primitive)`. With it
//! the closest hit does not depend on the order in which a walk meets the triangles, so all structures and all
//! walks give the same answer, bit for bit on the CPU.

use glam::Vec2;

/// Where a ray meets a triangle. A miss has every field written: `t` is infinite, the indices are
/// [`Hit::NONE`], the barycentrics are zero and `front_face` is false.
///
/// ```
/// use ropewalk::Hit;
/// assert!(!Hit::MISS.is_hit());
/// assert_eq!(Hit::MISS.t, f32::INFINITY);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The ray parameter, in units of the ray's direction.
    pub t: f32,
    /// The weights of the triangle's second and third vertex; the first one's is `1 - u - v`.
    pub barycentrics: Vec2,
    /// The triangle within its geometry.
    pub primitive_index: u32,
    /// The geometry (mesh) within its object.
    pub geometry_index: u32,
    /// The instance within the scene.
    pub instance_index: u32,
    /// Whether the ray meets the side from which the vertices run counter-clockwise, in the object's own space.
    pub front_face: bool,
}

impl Hit {
    /// The index of nothing.
    pub const NONE: u32 = u32::MAX;

    /// The answer of a ray that hits nothing.
    pub const MISS: Self = Self {
        t: f32::INFINITY,
        barycentrics: Vec2::ZERO,
        primitive_index: Self::NONE,
        geometry_index: Self::NONE,
        instance_index: Self::NONE,
        front_face: false,
    };

    /// Whether anything was hit.
    #[inline]
    #[must_use]
    pub const fn is_hit(&self) -> bool {
        self.primitive_index != Self::NONE
    }

    /// What orders hits of equal `t`: instance, then geometry, then primitive.
    #[inline]
    #[must_use]
    pub const fn id(&self) -> (u32, u32, u32) {
        (self.instance_index, self.geometry_index, self.primitive_index)
    }

    /// Whether this hit is preferred to `other`: the tie rule.
    #[inline]
    #[must_use]
    pub fn precedes(&self, other: &Self) -> bool {
        self.t < other.t || (self.t == other.t && self.id() < other.id())
    }

    /// The same hit as words, for comparisons to the bit.
    #[must_use]
    pub fn to_words(&self) -> [u32; 7] {
        [
            self.t.to_bits(),
            self.barycentrics.x.to_bits(),
            self.barycentrics.y.to_bits(),
            self.primitive_index,
            self.geometry_index,
            self.instance_index,
            u32::from(self.front_face),
        ]
    }
}

impl Default for Hit {
    fn default() -> Self {
        Self::MISS
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ties_go_to_the_smaller_id() {
        let a = Hit { t: 1.0, primitive_index: 3, geometry_index: 0, instance_index: 1, ..Hit::MISS };
        let b = Hit { primitive_index: 9, instance_index: 0, ..a };
        assert!(b.precedes(&a) && !a.precedes(&b), "the instance counts before the primitive");
        assert!(!a.precedes(&a));
        assert!(Hit { t: 0.5, instance_index: 7, ..a }.precedes(&b));
        assert!(a.precedes(&Hit::MISS));
    }
}
