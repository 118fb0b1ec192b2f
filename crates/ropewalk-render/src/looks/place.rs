//! From a ray and its hit to the place on the surface, in f32. The twin of `looks_place` in the shaders.
//!
//! **How exact.** The place is the first vertex plus the two edges times the barycentrics: the products are small where
//! the triangle is, so only the last sum rounds at the size of the coordinates. The step off the surface covers that: see
//! [`crate::offset`], and the tests here, which ask the triangle itself.
//!
//! **Terminator.** Where corner normals say that the surface is curved, rays leave from the curved surface above the
//! triangle, on the side on which it bulges.

use super::layout::{self, GEOMETRY, INSTANCE, NOTHING, TRIANGLE};
use super::{Looks, Shaded};
use crate::bsdf::arithmetic::{sum_of_three, unit};
use glam::{Vec2, Vec3};
use ropewalk::{Hit, Ray};

/// A place on a surface, seen along a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Place {
    /// Where it is.
    pub(crate) position: Vec3,
    /// From where rays leave it on the side from which it is seen.
    pub(crate) origin_outside: Vec3,
    /// From where rays leave it on the other side.
    pub(crate) origin_inside: Vec3,
    /// The normal of the triangle, of unit length, towards the side from which it is seen.
    pub(crate) geometric_normal: Vec3,
    /// The normal for shading, of unit length, on the same side.
    pub(crate) normal: Vec3,
    /// Against the ray, of unit length.
    pub(crate) to_eye: Vec3,
    /// Whether the front is seen: the ray comes from outside of a closed thing.
    pub(crate) front: bool,
    /// Texture coordinates; 0 where there are none.
    pub(crate) uv: Vec2,
    /// Whether this is the ground that catches shadows.
    pub(crate) is_catcher: bool,
    /// The material.
    pub(crate) material: Shaded,
    /// Instance, geometry and primitive when rays leave from the triangle itself and not from a curved surface above it.
    pub(crate) triangle: Option<(u32, u32, u32)>,
}

/// The rows of a triangle that a hit names.
#[derive(Clone, Copy)]
pub(super) struct Rows {
    instance: usize,
    pub(super) triangle: usize,
}

impl Looks {
    pub(super) fn rows(&self, hit: &Hit) -> Option<Rows> {
        let (instance, geometry, primitive) = hit.id();
        if instance >= self.word(layout::INSTANCES + 1) {
            return None;
        }
        let instance = self.row(layout::INSTANCES, instance, INSTANCE);
        if geometry >= self.word(instance + 22) {
            return None;
        }
        let geometry = self.row(layout::GEOMETRIES, self.word(instance + 21) + geometry, GEOMETRY);
        if primitive >= self.word(geometry + 1) {
            return None;
        }
        let triangle = self.row(layout::TRIANGLES, self.word(geometry) + primitive, TRIANGLE);
        (self.word(triangle) != NOTHING).then_some(Rows { instance, triangle })
    }

    /// Texture coordinates at a hit.
    pub(super) fn uv(&self, triangle: usize, barycentrics: Vec2) -> Vec2 {
        if self.word(triangle + 6) == NOTHING {
            return Vec2::ZERO;
        }
        let a = self.pair(self.row(layout::COORDINATES, self.word(triangle + 6), 2));
        let b = self.pair(self.row(layout::COORDINATES, self.word(triangle + 7), 2));
        let c = self.pair(self.row(layout::COORDINATES, self.word(triangle + 8), 2));
        Vec2::new(
            along(a.x, b.x - a.x, c.x - a.x, barycentrics),
            along(a.y, b.y - a.y, c.y - a.y, barycentrics),
        )
    }

    /// Whether there is a hole where the hit is: then it is no hit. False for indices that lead nowhere.
    pub(crate) fn is_cut_out(&self, hit: &Hit) -> bool {
        let Some(rows) = self.rows(hit) else { return false };
        self.is_hole(self.word(rows.triangle + 9), self.uv(rows.triangle, hit.barycentrics))
    }

    /// The place of a hit; `None` when its indices lead nowhere, which a sound structure never answers.
    pub(crate) fn place(&self, ray: &Ray, hit: &Hit) -> Option<Place> {
        let rows = self.rows(hit)?;
        let vertex = |corner: usize| {
            let row = self.row(layout::VERTICES, self.word(rows.triangle + corner), 3);
            self.to_world(rows.instance, self.vector(row))
        };
        let (a, b, c) = (vertex(0), vertex(1), vertex(2));
        let (ab, ac) = (b - a, c - a);
        let barycentrics = hit.barycentrics;
        let position = Vec3::new(
            along(a.x, ab.x, ac.x, barycentrics),
            along(a.y, ab.y, ac.y, barycentrics),
            along(a.z, ab.z, ac.z, barycentrics),
        );
        let size = ray.dir.abs();
        let to_eye = unit(-ray.dir / size.x.max(size.y).max(size.z));
        let outward = facing(triangle_normal(ab, ac).unwrap_or(to_eye), to_eye);
        let step = offset_step(a, b, c, outward);
        let uv = self.uv(rows.triangle, barycentrics);
        let mut place = Place {
            position,
            origin_outside: position + outward * step,
            origin_inside: position - outward * step,
            geometric_normal: outward,
            normal: outward,
            to_eye,
            front: hit.front_face,
            uv,
            is_catcher: hit.instance_index == self.word(layout::CATCHER),
            material: self.shaded(self.word(rows.triangle + 9), uv),
            triangle: Some(hit.id()),
        };
        if self.word(rows.triangle + 3) != NOTHING {
            self.bend(&mut place, rows, [a, b, c], barycentrics, step);
        }
        Some(place)
    }

    /// Gives a place the normal of the curved surface, and moves the origins of its rays onto it.
    fn bend(&self, place: &mut Place, rows: Rows, vertices: [Vec3; 3], barycentrics: Vec2, step: f32) {
        let outward = place.geometric_normal;
        let corner = |corner: usize| {
            let row = self.row(layout::NORMALS, self.word(rows.triangle + 3 + corner), 3);
            let normal = self.normal_to_world(rows.instance, self.vector(row));
            facing(unit_or(normal, outward), outward)
        };
        let (na, nb, nc) = (corner(0), corner(1), corner(2));
        let weights = Vec3::new(1.0 - barycentrics.x - barycentrics.y, barycentrics.x, barycentrics.y);
        let mean = sum_of_three(na, nb, nc, weights);
        if mean.dot(outward) <= 0.0 {
            return;
        }
        place.normal = unit_or(mean, outward);
        let depths = Vec3::new(
            (place.position - vertices[0]).dot(na),
            (place.position - vertices[1]).dot(nb),
            (place.position - vertices[2]).dot(nc),
        );
        let below = depths.min(Vec3::ZERO) * weights;
        let above = depths.max(Vec3::ZERO) * weights;
        let bulge = sum_of_three(na, nb, nc, below);
        let hollow = sum_of_three(na, nb, nc, above);
        place.origin_outside = (place.position - bulge) + outward * step;
        place.origin_inside = (place.position - hollow) - outward * step;
        if bulge != Vec3::ZERO || hollow != Vec3::ZERO {
            place.triangle = None;
        }
    }

    /// A point of an instance's object in the scene: the same operations as the core's, so the same bits.
    fn to_world(&self, instance: usize, point: Vec3) -> Vec3 {
        Vec3::new(
            self.vector(instance).dot(point) + self.float(instance + 3),
            self.vector(instance + 4).dot(point) + self.float(instance + 7),
            self.vector(instance + 8).dot(point) + self.float(instance + 11),
        )
    }

    /// A normal of an instance's object in the scene, not of unit length.
    fn normal_to_world(&self, instance: usize, normal: Vec3) -> Vec3 {
        Vec3::new(
            self.vector(instance + 12).dot(normal),
            self.vector(instance + 15).dot(normal),
            self.vector(instance + 18).dot(normal),
        )
    }
}

/// A value at a triangle's first corner, plus its changes along two edges times how far along them.
fn along(first: f32, change_b: f32, change_c: f32, barycentrics: Vec2) -> f32 {
    first + Vec2::new(change_b, change_c).dot(barycentrics)
}

/// The vector with length 1, or another where it is too short to have a direction.
fn unit_or(vector: Vec3, other: Vec3) -> Vec3 {
    let square = vector.dot(vector);
    // A unit vector that cancels to less than 1e-15 is made of rounding.
    if square > 1e-30 { vector / square.sqrt() } else { other }
}

/// The vector or its opposite: the one on the side of `side`.
fn facing(vector: Vec3, side: Vec3) -> Vec3 {
    if vector.dot(side) < 0.0 { -vector } else { vector }
}

/// The normal of a triangle, of unit length, from two of its edges; `None` for one that is no more than a line.
fn triangle_normal(ab: Vec3, ac: Vec3) -> Option<Vec3> {
    let reach = ab.abs().max(ac.abs());
    let largest = reach.x.max(reach.y).max(reach.z);
    if largest <= 0.0 {
        return None;
    }
    // Of the three edges the two shorter ones: of a needle's two long ones the product would have no right digit.
    let (ab, ac) = (ab / largest, ac / largest);
    let bc = ac - ab;
    let (ab_square, bc_square, ac_square) = (ab.dot(ab), bc.dot(bc), ac.dot(ac));
    let mut normal = ab.cross(ac);
    if ab_square >= bc_square && ab_square >= ac_square {
        normal = ac.cross(bc);
    } else if ac_square >= bc_square {
        normal = ab.cross(bc);
    }
    let square = normal.dot(normal);
    (square > 1e-30).then(|| normal / square.sqrt())
}

/// How far off the triangle's plane rays leave it: see [`crate::offset`].
fn offset_step(a: Vec3, b: Vec3, c: Vec3, normal: Vec3) -> f32 {
    let largest = a.abs().max(b.abs()).max(c.abs());
    let size = a.max(b).max(c) - a.min(b).min(c);
    let extent = size.x.max(size.y).max(size.z);
    (normal.abs().dot(largest) + extent) * STEPS
}

/// The step off a surface, in units of its coordinates along the normal and of its extent.
const STEPS: f32 = 8.0 / 16_777_216.0;
