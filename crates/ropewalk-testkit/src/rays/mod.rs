//! Seeded rays of every class, the same on every machine.
//!
//! The classes of [`RayClass::MEASURED`] are what rendering asks: the benchmarks use them. The others are hard:
//! along faces, through vertices, with windows that end at a hit, not valid at all.
//!
//! Some classes start on surfaces. A [`RayMaker`] then needs to know where rays hit, and asks the closure it is
//! given: any tracer will do.

mod awkward;
mod rendering;
mod view;

pub use view::View;

use crate::random::Random;
use glam::{DVec3, Vec3};
use ropewalk::{Aabb, FlatScene, FlatTriangle, Hit, Query, Ray};
use std::fmt;

/// A kind of rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RayClass {
    /// Through the pixels of a pinhole camera, row by row.
    Primary,
    /// From what the camera sees to a light, no further.
    Shadow,
    /// From what the camera sees, a tenth of the scene far.
    AmbientOcclusion,
    /// From what the camera sees, distributed by the cosine, in the camera's order.
    DiffuseBounce,
    /// The same rays in random order.
    DiffuseShuffled,
    /// Origins in and around the scene's box, uniform directions.
    Random,
    /// Along an axis, mostly at a vertex's coordinates.
    AxisAligned,
    /// Aimed at vertices.
    Vertices,
    /// Aimed at points on edges.
    Edges,
    /// Origin and direction in the plane of a triangle or of a face of a box.
    Planes,
    /// Components that are zero, negative zero, denormal or tiny.
    ZeroComponents,
    /// Directions 1e-12 to 1e12 long.
    Lengths,
    /// Windows that begin or end at a hit or beside it, and empty ones.
    Windows,
    /// Masks of every kind.
    Masks,
    /// Origins on surfaces and vertices.
    OnSurface,
    /// Not valid: zero, NaN, infinite, out of range.
    Invalid,
    /// From inside a closed mesh at its edges and vertices: none may escape. Not made by [`RayMaker::make`],
    /// which knows no inside; see [`RayMaker::rays_from_inside`].
    Inside,
    /// From outside of a closed mesh through its edges and vertices into its middle: none may come in unseen, be it that
    /// triangles have one side. Not made by [`RayMaker::make`] either; see [`RayMaker::rays_from_outside`].
    Outside,
}

impl RayClass {
    /// Every class that a [`RayMaker`] makes of any scene.
    pub const EVERY: [Self; 16] = [
        Self::Primary,
        Self::Shadow,
        Self::AmbientOcclusion,
        Self::DiffuseBounce,
        Self::DiffuseShuffled,
        Self::Random,
        Self::AxisAligned,
        Self::Vertices,
        Self::Edges,
        Self::Planes,
        Self::ZeroComponents,
        Self::Lengths,
        Self::Windows,
        Self::Masks,
        Self::OnSurface,
        Self::Invalid,
    ];

    /// The classes that are worth a measurement.
    pub const MEASURED: [Self; 6] = [
        Self::Primary,
        Self::Shadow,
        Self::AmbientOcclusion,
        Self::DiffuseBounce,
        Self::DiffuseShuffled,
        Self::Random,
    ];

    /// The name in tables and files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Primary => "primary",
            Self::Shadow => "shadow",
            Self::AmbientOcclusion => "ambient-occlusion",
            Self::DiffuseBounce => "diffuse",
            Self::DiffuseShuffled => "diffuse-shuffled",
            Self::Random => "random",
            Self::AxisAligned => "axis-aligned",
            Self::Vertices => "vertices",
            Self::Edges => "edges",
            Self::Planes => "planes",
            Self::ZeroComponents => "zero-components",
            Self::Lengths => "lengths",
            Self::Windows => "windows",
            Self::Masks => "masks",
            Self::OnSurface => "on-surface",
            Self::Invalid => "invalid",
            Self::Inside => "inside",
            Self::Outside => "outside",
        }
    }

    /// What is usually asked with such rays.
    #[must_use]
    pub const fn query(self) -> Query {
        match self {
            Self::Shadow | Self::AmbientOcclusion => Query::Any,
            _ => Query::Closest,
        }
    }
}

impl fmt::Display for RayClass {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(self.name())
    }
}

/// Answers rays with their closest hits.
pub type Closest<'a> = dyn Fn(&[Ray]) -> Vec<Hit> + 'a;

/// Makes rays for a scene.
#[derive(Clone, Debug)]
pub struct RayMaker<'a> {
    triangles: &'a [FlatTriangle],
    bounds: Aabb,
    view: View,
    light: DVec3,
    seed: u64,
}

impl<'a> RayMaker<'a> {
    /// For the triangles of a scene, seen from outside. An empty scene counts as a unit box.
    #[must_use]
    pub fn new(scene: &'a FlatScene, seed: u64) -> Self {
        let corners = scene.triangles.iter().flat_map(|triangle| triangle.triangle().vertices);
        let mut bounds = Aabb::of_points(corners);
        if bounds.is_empty() {
            bounds = Aabb::new(Vec3::ZERO, Vec3::ONE);
        }
        let (low, high) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        let light = bounds.center().as_dvec3() + DVec3::new(-0.6, 1.0, 0.4) * (high - low).length();
        Self { triangles: &scene.triangles, bounds, view: View::of_bounds(&bounds), light, seed }
    }

    /// The same with another camera, for a scene that is looked at from inside, say.
    #[must_use]
    pub fn with_view(self, view: View) -> Self {
        Self { view, ..self }
    }

    /// The same with another light, for a scene whose light is in it, say. Without it the light stands far outside,
    /// above.
    #[must_use]
    pub fn with_light(self, light: DVec3) -> Self {
        Self { light, ..self }
    }

    /// The box of the scene.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// `count` rays of a class. Classes that start where the camera's rays hit are empty when none of them does.
    #[must_use]
    pub fn make(&self, class: RayClass, count: usize, closest: &Closest<'_>) -> Vec<Ray> {
        match class {
            RayClass::Primary => self.view.rays(count),
            RayClass::Shadow => self.shadow(count, closest),
            RayClass::AmbientOcclusion => self.ambient_occlusion(count, closest),
            RayClass::DiffuseBounce => self.bounce(count, closest),
            RayClass::DiffuseShuffled => {
                let mut rays = self.bounce(count, closest);
                self.random(class).shuffle(&mut rays);
                rays
            }
            RayClass::Inside | RayClass::Outside => Vec::new(),
            _ => self.awkward(class, count, closest),
        }
    }

    /// Each class has its own numbers, so that adding one class leaves the rays of the others alone.
    fn random(&self, class: RayClass) -> Random {
        let stream = class as u64;
        Random::new(self.seed.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(stream << 32))
    }

    fn diagonal(&self) -> f64 {
        (self.bounds.max.as_dvec3() - self.bounds.min.as_dvec3()).length()
    }

    /// A triangle by its identity.
    fn triangle_of(&self, hit: &Hit) -> Option<&FlatTriangle> {
        let id = |triangle: &FlatTriangle| (triangle.instance(), triangle.geometry(), triangle.primitive);
        let index = self.triangles.binary_search_by_key(&hit.id(), id).ok()?;
        self.triangles.get(index)
    }
}

/// A ray from one point to another: `t` is 1 there.
fn towards(from: DVec3, to: DVec3) -> Ray {
    let origin = from.as_vec3();
    Ray::new(origin, (to - origin.as_dvec3()).as_vec3())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::meshes;
    use crate::oracle::Oracle;
    use ropewalk::Scene;

    fn make(class: RayClass) -> Vec<Ray> {
        let scene = Scene::from_mesh(meshes::icosphere(2));
        let flat = scene.flatten().unwrap();
        // In f64, so that the rays do not change with a last bit of the tracer.
        let oracle = Oracle::new(&flat);
        let closest = |rays: &[Ray]| {
            let hit = |ray: &Ray| match oracle.candidates(ray).first() {
                None => Hit::MISS,
                Some(first) => Hit {
                    t: first.t as f32,
                    instance_index: first.id.0,
                    geometry_index: first.id.1,
                    primitive_index: first.id.2,
                    ..Hit::MISS
                },
            };
            rays.iter().map(hit).collect()
        };
        RayMaker::new(&flat, 7).make(class, 200, &closest)
    }

    fn words(rays: &[Ray]) -> Vec<[u32; 9]> {
        rays.iter()
            .map(|ray| {
                let [o, d] = [ray.origin, ray.dir].map(|v| v.to_array().map(f32::to_bits));
                [o[0], o[1], o[2], ray.t_min.to_bits(), d[0], d[1], d[2], ray.t_max.to_bits(), ray.mask]
            })
            .collect()
    }

    #[test]
    fn every_class_is_as_many_as_asked_and_always_the_same() {
        for class in RayClass::EVERY {
            let rays = make(class);
            assert_eq!(rays.len(), 200, "{class}");
            assert_eq!(words(&rays), words(&make(class)), "{class}");
            let valid = rays.iter().filter(|ray| ray.is_valid()).count();
            assert_eq!(valid, if class == RayClass::Invalid { 0 } else { 200 }, "{class}");
        }
    }

    /// One number for all rays: the same on every machine, or the counts in tests mean nothing.
    #[test]
    fn the_rays_are_the_same_on_every_machine() {
        let mut hash = 0xcbf2_9ce4_8422_2325u64;
        for class in RayClass::EVERY {
            // NaN has many bits; the invalid ones are checked by their kind alone.
            if class != RayClass::Invalid {
                for word in words(&make(class)).as_flattened() {
                    hash = (hash ^ u64::from(*word)).wrapping_mul(0x0000_0100_0000_01b3);
                }
            }
        }
        assert_eq!(hash, 0x9625_7b44_19f1_9520, "{hash:#x}");
    }

    #[test]
    fn the_names_differ() {
        let names: std::collections::HashSet<&str> =
            RayClass::EVERY.iter().map(|class| class.name()).collect();
        assert_eq!(names.len(), RayClass::EVERY.len());
    }

    #[test]
    fn a_scene_without_triangles_has_rays_too() {
        let flat = FlatScene::default();
        let maker = RayMaker::new(&flat, 1);
        for class in RayClass::EVERY {
            let rays = maker.make(class, 50, &|rays| vec![Hit::MISS; rays.len()]);
            let needs_hits = matches!(
                class,
                RayClass::Shadow
                    | RayClass::AmbientOcclusion
                    | RayClass::DiffuseBounce
                    | RayClass::DiffuseShuffled
            );
            assert_eq!(rays.len(), if needs_hits { 0 } else { 50 }, "{class}");
        }
    }
}
