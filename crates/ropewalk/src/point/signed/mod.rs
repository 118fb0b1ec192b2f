//! Signed distance to a closed surface, and whether a point is inside.
//!
//! **The sign** is that of `dot(point - closest, pseudonormal)`, where the pseudonormal belongs to the feature in which
//! the closest point lies: a face's normal, the sum of an edge's two, or the sum of a vertex's weighted by the angles
//! there. With these, and not with just any normal of the feature, the sign is always right (Baerentzen and Aanaes
//! 2005). No ray is shot, so nothing depends on what a ray would meet on its way.
//!
//! **Everything but the boxes in f64.** The coordinates are f32, so their differences and products are next to exact,
//! and the sign is right unless the point is within about 1e-15 of the surface, relative to the numbers in play: the
//! question which of two faces at a sharp edge is closer is decided far below a float's last digit. The search is the
//! stack walk, over the tree that is there already.
//!
//! **The surface** (`connect`, `surface`): vertices of equal position are one; every edge must be shared by exactly two triangles
//! that run along it in opposite directions. It may have any number of parts, shells within shells included, where a
//! cavity's shell faces into the cavity. The front of a triangle, from which it runs counter-clockwise, is outside.

mod connect;
mod surface;

pub use connect::SurfaceError;

use super::distance::box_distance_squared;
use super::foot::WideFoot;
use super::visitor::slack;
use super::{ClosestPoint, PointQuery, PreparedPoint, reach};
use crate::batch::answer_each;
use crate::bvh::Bvh;
use crate::bvh::walk::{BvhWalk, Ordered, Visitor};
use glam::{DVec2, DVec3, Vec3};
use std::ops::ControlFlow;
use surface::Surface;

/// What of a surface is closest to a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Feature {
    /// The inside of a triangle.
    Face,
    /// The inside of an edge.
    Edge,
    /// A vertex.
    Vertex,
}

/// The closest point of a closed surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// The distance, negative inside.
    pub signed_distance: f32,
    /// The pseudonormal of the feature, of unit length, towards the outside.
    pub normal: Vec3,
    /// What the closest point lies in.
    pub feature: Feature,
    /// The closest point and its triangle; the distance here is not negative. It may differ in its last digits from
    /// that of [`Bvh::closest_point`], which is computed in f32 throughout.
    pub closest: ClosestPoint,
}

/// Signed distance to the closed surface that all triangles of a [`Bvh`] form together, whatever their masks.
///
/// A point on the surface has the distance 0 and counts as inside: the solid contains its surface.
///
/// ```
/// use ropewalk::{BuildOptions, Mesh, Scene, SignedDistance, glam::Vec3};
/// let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
/// let tetrahedron = Mesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]);
/// let bvh = Scene::from_mesh(tetrahedron).build(&BuildOptions::default())?;
/// let solid = SignedDistance::new(&bvh)?;
/// assert!(solid.contains(Vec3::splat(0.1)) && !solid.contains(Vec3::splat(0.4)));
/// assert_eq!(solid.distance(Vec3::new(0.25, 0.25, -2.0)), 2.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct SignedDistance<'a> {
    bvh: &'a Bvh,
    surface: Surface,
}

impl<'a> SignedDistance<'a> {
    /// Finds how the triangles of a tree are connected, in a second or two for a million of them.
    ///
    /// # Errors
    /// When an edge has not exactly two triangles that run along it in opposite directions.
    pub fn new(bvh: &'a Bvh) -> Result<Self, SurfaceError> {
        Ok(Self { bvh, surface: Surface::new(bvh)? })
    }

    /// The volume inside. Negative where the surface is inside out: turn every triangle then, or read the signs the
    /// other way round.
    #[must_use]
    pub const fn volume(&self) -> f64 {
        self.surface.volume
    }

    /// The distance, negative inside; infinite where the point is not [valid](PointQuery::is_valid) or there is no
    /// surface.
    #[must_use]
    pub fn distance(&self, point: Vec3) -> f32 {
        self.closest(point).map_or(f32::INFINITY, |closest| closest.signed_distance)
    }

    /// Whether a point is inside or on the surface; false where the point is not [valid](PointQuery::is_valid).
    #[must_use]
    pub fn contains(&self, point: Vec3) -> bool {
        let bounds = self.bvh.bounds();
        let in_box = point.cmpge(bounds.min).all() && point.cmple(bounds.max).all();
        // Of a surface that is inside out, all the space around is inside.
        (in_box || self.volume() < 0.0) && self.distance(point) <= 0.0
    }

    /// The distances of many points, into `distances`. Only the first `min(points.len(), distances.len())` are
    /// answered.
    pub fn distances(&self, points: &[Vec3], distances: &mut [f32]) {
        answer_each(points, distances, |&point| self.distance(point));
    }

    /// Whether each of many points is inside, into `inside`. Only the first `min(points.len(), inside.len())` are
    /// answered.
    pub fn contains_batch(&self, points: &[Vec3], inside: &mut [bool]) {
        answer_each(points, inside, |&point| self.contains(point));
    }

    /// The closest point of the surface with everything known about it; `None` where the point is not
    /// [valid](PointQuery::is_valid) or there is no surface.
    #[must_use]
    pub fn closest(&self, point: Vec3) -> Option<SurfacePoint> {
        let prepared = PreparedPoint::new(&PointQuery::new(point))?;
        let mut visitor = WideVisitor {
            bvh: self.bvh,
            surface: &self.surface,
            prepared: &prepared,
            point: point.as_dvec3(),
            slack: slack(self.bvh, &prepared),
            reach: f32::MAX,
            best: None,
        };
        Ordered.walk(self.bvh.nodes(), &prepared, &mut visitor);
        visitor.best.map(|(reference, foot)| self.describe(reference, &foot))
    }

    fn describe(&self, reference: usize, foot: &WideFoot) -> SurfacePoint {
        let triangle = &self.bvh.triangles()[reference];
        let vertices = surface::outward(triangle);
        let position = foot.position(&vertices);
        let (feature, pseudonormal) = self.surface.pseudonormal(reference, foot, position);
        let distance = foot.square.sqrt();
        // The offset leads from the point to the surface: along the pseudonormal it leads outwards.
        let is_inside = foot.offset.dot(pseudonormal) > 0.0;
        let [_, u, v] = foot.weights();
        let (u, v) = if triangle.is_mirrored() { (v, u) } else { (u, v) };
        SurfacePoint {
            signed_distance: (if is_inside { -distance } else { distance }) as f32,
            normal: pseudonormal.normalize_or_zero().as_vec3(),
            feature,
            closest: ClosestPoint {
                distance: distance as f32,
                point: position.as_vec3(),
                barycentrics: DVec2::new(u, v).as_vec2(),
                primitive_index: triangle.primitive,
                geometry_index: triangle.geometry(),
                instance_index: triangle.instance(),
            },
        }
    }
}

/// Looks for the closest point in f64. Triangles without area are passed over: all their points are their neighbours'.
struct WideVisitor<'a> {
    bvh: &'a Bvh,
    surface: &'a Surface,
    prepared: &'a PreparedPoint,
    point: DVec3,
    slack: f32,
    /// What the squared distance of a box must not exceed.
    reach: f32,
    /// The place of the triangle among the leaves, and its foot.
    best: Option<(usize, WideFoot)>,
}

impl Visitor for WideVisitor<'_> {
    fn t_max(&self) -> f32 {
        self.reach
    }

    fn inner_visit(&mut self, _node: u32) {}

    fn stack_depth(&mut self, _entries: usize) {}

    fn restart(&mut self) {}

    #[inline(always)]
    fn leaf(&mut self, first: u32, count: u32) -> ControlFlow<()> {
        for reference in first as usize..first as usize + count as usize {
            let triangle = &self.bvh.triangles()[reference];
            let bounds = triangle.triangle().bounds();
            let (min, max) = (bounds.min.extend(1.0), bounds.max.extend(1.0));
            if box_distance_squared(self.prepared, min, max) > self.reach || !self.surface.has_area(reference)
            {
                continue;
            }
            let foot = WideFoot::find(self.point, surface::outward(triangle));
            let is_nearer = self.best.is_none_or(|(other, best)| {
                foot.square < best.square
                    || (foot.square == best.square && self.surface.precedes(reference, other))
            });
            if is_nearer {
                self.best = Some((reference, foot));
                // Upwards, and by the padding of `reach`: the boxes are measured in f32.
                self.reach = reach((foot.square.sqrt() as f32).next_up() + self.slack);
            }
        }
        ControlFlow::Continue(())
    }
}
