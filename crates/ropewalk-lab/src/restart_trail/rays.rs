//! Six views of a scene, and the rays of a class from all of them.

use glam::{DVec3, Vec3};
use ropewalk::{Aabb, FlatScene, Mesh, Ray, Scene, Transform};
use ropewalk_testkit::rays::{RayClass, RayMaker, View};
use std::f64::consts::TAU;

/// From where primary rays come.
#[derive(Clone, Debug, PartialEq)]
pub enum Seen {
    /// From six places around the scene, a little above it, each with all of it in sight.
    Around,
    /// From the middle of the scene's box, in six directions around, with a light below its top: for rooms.
    Within,
    /// From given places.
    From(Vec<View>),
}

/// Views around a scene.
const VIEWS: usize = 6;

impl Seen {
    fn views(&self, bounds: &Aabb) -> Vec<View> {
        let (low, high) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        let (center, diagonal) = ((low + high) * 0.5, (high - low).length());
        let around = (0..VIEWS).map(|index| {
            let angle = TAU * index as f64 / VIEWS as f64;
            DVec3::new(angle.cos(), 0.0, angle.sin())
        });
        match self {
            Self::Around => around
                .map(|aside| {
                    let eye = center + (aside * 0.93 + DVec3::Y * 0.36) * diagonal * 1.1;
                    View::look_at(eye.as_vec3(), center.as_vec3(), 0.5)
                })
                .collect(),
            Self::Within => around
                .map(|ahead| View::look_at(center.as_vec3(), (center + ahead * diagonal).as_vec3(), 0.75))
                .collect(),
            Self::From(views) => views.clone(),
        }
    }

    /// `count` rays of a class, as many from each view; views that see nothing give none of those that start on
    /// surfaces.
    pub(super) fn rays(
        &self,
        scene: &FlatScene,
        class: RayClass,
        count: usize,
        closest: &dyn Fn(&[Ray]) -> Vec<ropewalk::Hit>,
    ) -> Vec<Ray> {
        let maker = RayMaker::new(scene, 1);
        let bounds = maker.bounds();
        let views = self.views(&bounds);
        let maker = match self {
            Self::Within => {
                let lamp = bounds.center() + Vec3::Y * bounds.size().y * 0.35;
                maker.with_light(lamp.as_dvec3())
            }
            Self::Around | Self::From(_) => maker,
        };
        let each = count.div_ceil(views.len().max(1));
        views.into_iter().flat_map(|view| maker.clone().with_view(view).make(class, each, closest)).collect()
    }
}

/// The scene on a ground of two triangles, twice as wide and deep as the scene is large, as the figures of Toczek 2010
/// have it.
#[must_use]
pub fn with_ground(mut scene: Scene) -> Scene {
    let bounds = scene.bounds();
    if bounds.is_empty() {
        return scene;
    }
    let (center, reach) = (bounds.center(), bounds.size().max_element());
    let corner = |x: f32, z: f32| Vec3::new(center.x + x * reach, bounds.min.y, center.z + z * reach);
    let corners = vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
    let ground = scene.add_object(Mesh::new(corners, vec![[0, 2, 1], [0, 3, 2]]));
    scene.add_instance(ground, Transform::IDENTITY);
    scene
}

#[cfg(test)]
mod tests {
    use super::*;
    use ropewalk::Hit;

    #[test]
    fn every_view_has_its_rays() {
        let scene = Scene::from_mesh(ropewalk_testkit::meshes::icosphere(1));
        let flat = scene.flatten().unwrap();
        let nothing = |rays: &[Ray]| vec![Hit::MISS; rays.len()];
        for seen in [Seen::Around, Seen::Within] {
            let rays = seen.rays(&flat, RayClass::Primary, 60, &nothing);
            assert_eq!(rays.len(), 60);
            let mut first: Vec<_> =
                rays.iter().step_by(10).map(|ray| ray.dir.to_array().map(f32::to_bits)).collect();
            first.sort_unstable();
            first.dedup();
            assert_eq!(first.len(), 6, "six different views");
        }
        assert_eq!(Seen::From(Vec::new()).rays(&flat, RayClass::Primary, 60, &nothing), []);
    }

    #[test]
    fn the_ground_is_two_triangles_below() {
        let scene = with_ground(Scene::from_mesh(ropewalk_testkit::meshes::icosphere(1)));
        assert_eq!(scene.triangle_count(), 82);
        assert_eq!(scene.bounds().min.y, -1.0);
        assert_eq!(scene.bounds().size().x, 4.0);
        assert_eq!(with_ground(Scene::default()).triangle_count(), 0);
    }
}
