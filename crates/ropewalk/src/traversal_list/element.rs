//! The element of a traversal list: 20 bytes, one node of the hierarchy (Toczek 2010, section 2.1).
//!
//! | relative escape index | the element is |
//! |---|---|
//! | 2 and more | an inner node; what follows its subtree is so many elements on |
//! | -1 | an inner node whose subtree the list ends with |
//! | 1 | a triangle |
//! | 0 | the triangle that the list ends with |
//!
//! The next element of the array is an inner node's first child. The payload of 128 bits is the inner node's sphere or
//! box, or the triangle's three vertices, which all lists share, and who it is.

use super::packed_box::PackedBox;
use crate::Sphere;
use bytemuck::{Pod, Zeroable};

/// An element.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
pub struct Element {
    /// The relative escape index.
    pub escape: i32,
    /// A sphere, a box or a triangle.
    pub payload: [u32; 4],
}

impl Element {
    /// The escape index of an inner node with which the list ends.
    pub const NOWHERE: i32 = -1;

    /// Whether it is a triangle.
    #[inline(always)]
    #[must_use]
    pub const fn is_triangle(&self) -> bool {
        // -1 becomes the largest number.
        self.escape as u32 <= 1
    }

    /// An inner node bounded by a sphere. Its escape index is to be set when its subtree is known.
    #[must_use]
    pub fn of_sphere(sphere: &Sphere) -> Self {
        let [x, y, z] = sphere.center.to_array().map(f32::to_bits);
        Self { escape: Self::NOWHERE, payload: [x, y, z, sphere.radius.to_bits()] }
    }

    /// An inner node bounded by a box.
    #[must_use]
    pub const fn of_box(bounds: PackedBox) -> Self {
        Self { escape: Self::NOWHERE, payload: bounds.words }
    }

    /// A triangle: the indices of its vertices, and of who it is.
    #[must_use]
    pub const fn of_triangle(vertices: [u32; 3], identity: u32) -> Self {
        let [a, b, c] = vertices;
        Self { escape: 1, payload: [a, b, c, identity] }
    }

    /// The sphere of an inner node of a list of spheres.
    #[inline(always)]
    #[must_use]
    pub fn sphere(&self) -> Sphere {
        let [x, y, z, radius] = self.payload.map(f32::from_bits);
        Sphere { center: glam::Vec3::new(x, y, z), radius }
    }

    /// The box of an inner node of a list of boxes.
    #[inline(always)]
    #[must_use]
    pub const fn packed_box(&self) -> PackedBox {
        PackedBox { words: self.payload }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_element_is_twenty_bytes_and_tells_what_it_is() {
        assert_eq!(size_of::<Element>(), 20);
        let sphere = Sphere { center: glam::Vec3::new(1.0, -2.0, 3.0), radius: 0.5 };
        let inner = Element::of_sphere(&sphere);
        assert_eq!(inner.sphere(), sphere);
        for (escape, is_triangle) in [(-1, false), (0, true), (1, true), (2, false), (i32::MAX, false)] {
            assert_eq!(Element { escape, ..inner }.is_triangle(), is_triangle, "{escape}");
        }
        assert!(Element::of_triangle([4, 5, 6], 7).is_triangle());
    }
}
