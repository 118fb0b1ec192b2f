//! Sums of products that come out the same on the CPU and in the kernel's language.
//!
//! A driver may not reorder what `dot` sums; it does reorder sums of products that are written out. So they are
//! dots here, and in the twin of the same name. Products that end in a constant end in it everywhere: drivers
//! move constants to the end.

use glam::{Vec2, Vec3};

/// The vector of length one along `vector`, which must not be zero.
pub(crate) fn unit(vector: Vec3) -> Vec3 {
    vector / vector.dot(vector).sqrt()
}

/// `a * x + b * y`.
pub(crate) fn sum_of_two(a: Vec3, x: f32, b: Vec3, y: f32) -> Vec3 {
    let weights = Vec2::new(x, y);
    Vec3::new(
        Vec2::new(a.x, b.x).dot(weights),
        Vec2::new(a.y, b.y).dot(weights),
        Vec2::new(a.z, b.z).dot(weights),
    )
}

/// `a * x + b * y + c * z`, with the weights in a vector.
pub(crate) fn sum_of_three(a: Vec3, b: Vec3, c: Vec3, weights: Vec3) -> Vec3 {
    Vec3::new(
        Vec3::new(a.x, b.x, c.x).dot(weights),
        Vec3::new(a.y, b.y, c.y).dot(weights),
        Vec3::new(a.z, b.z, c.z).dot(weights),
    )
}

/// From `a` where `share` is 0 to `b` where it is 1.
pub(crate) fn blend(a: Vec3, b: Vec3, share: f32) -> Vec3 {
    sum_of_two(a, 1.0 - share, b, share)
}

/// The direction into which a mirror with this unit normal throws what goes along `-to_eye`.
pub(crate) fn mirrored(normal: Vec3, to_eye: Vec3) -> Vec3 {
    let twice = normal.dot(to_eye) * 2.0;
    unit(sum_of_two(normal, twice, to_eye, -1.0))
}

/// The direction, mirrored to the side of the plane that `normal` points to where it is not there already: a normal for
/// shading may send rays to the wrong side of the triangle.
pub(crate) fn above(direction: Vec3, normal: Vec3) -> Vec3 {
    let below = direction.dot(normal).min(0.0);
    direction - normal * (below + below)
}
