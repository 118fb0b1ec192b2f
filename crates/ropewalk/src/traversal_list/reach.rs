//! How far the spheres of nodes reach: to the corners of the triangles' boxes, or to their vertices alone.
//!
//! A hit may lie anywhere in the interval of its triangle's own box ([`crate::sphere`]), so it is the boxes that must be held
//! if no hit is to be lost. The paper's spheres hold vertices (Toczek 2010, section 2.2), are smaller, and are visited less.

use super::Bounds;
use crate::{Aabb, Sphere};
use glam::Vec3;

/// What spheres hold of the triangles below a node. Boxes hold boxes either way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Reach {
    /// The triangles' boxes: no hit is lost.
    #[default]
    Boxes,
    /// The triangles' vertices, as the paper has it. **A ray that runs along a triangle's plane may lose its hit.** It is there
    /// to be measured; it has no name and no place in the catalogue. Where triangles are split, their parts have boxes
    /// alone, which are held.
    Vertices,
}

impl Reach {
    /// The sphere about a place that holds triangles, given by their boxes and by their vertices.
    pub(super) fn sphere(
        self,
        center: Vec3,
        boxes: impl Iterator<Item = Aabb>,
        vertices: impl Iterator<Item = Vec3>,
    ) -> Sphere {
        match self {
            Self::Boxes => Sphere::about(center, boxes),
            Self::Vertices => Sphere::about_points(center, vertices),
        }
    }

    /// Whether nodes with such volumes hold the triangles' vertices alone.
    pub(super) fn is_of_vertices(self, bounds: Bounds) -> bool {
        self == Self::Vertices && bounds == Bounds::Sphere
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::traversal_list::{Directions, ListOptions, Source};
    use crate::{CounterTotals, Mesh, Query, Ray, Scene, TraceOptions, TraversalList, Walk};

    /// A wavy sheet of slanting triangles, each with a box far larger than itself, `lift` high.
    fn sheet(lift: f32) -> Scene {
        let side = 24_u32;
        let height = |x: u32, y: u32| ((x * 7 + y * 3) % 5) as f32 * lift;
        let place = |index: u32| (index % side, index / side);
        let positions = (0..side * side).map(place);
        let positions = positions.map(|(x, y)| Vec3::new(x as f32, y as f32, height(x, y))).collect();
        let corner = |x: u32, y: u32| y * side + x;
        let square = |(x, y): (u32, u32)| {
            let [a, b, c, d] = [corner(x, y), corner(x + 1, y), corner(x + 1, y + 1), corner(x, y + 1)];
            [[a, b, c], [a, c, d]]
        };
        let inner = (0..side * side).map(place).filter(|&(x, y)| x + 1 < side && y + 1 < side);
        Scene::from_mesh(Mesh::new(positions, inner.flat_map(square).collect()))
    }

    fn lists(scene: &Scene, source: Source, reach: Reach) -> TraversalList {
        let options = ListOptions { source, reach, directions: Directions::Six, ..ListOptions::default() };
        let lists = scene.build_list(&options).unwrap();
        lists.validate().unwrap();
        lists
    }

    fn rays() -> Vec<Ray> {
        let ray = |index: u32| {
            let (x, y) = ((index % 31) as f32 * 0.73 + 0.11, (index / 31) as f32 * 0.69 + 0.07);
            let slant = Vec3::new((index % 5) as f32 * 0.3 - 0.61, (index % 3) as f32 * 0.4 - 0.37, -1.0);
            Ray::new(Vec3::new(x, y, 9.0) - slant * 4.0, slant)
        };
        (0..31 * 31).map(ray).collect()
    }

    fn cost(lists: &TraversalList) -> CounterTotals {
        let options = TraceOptions { counters: true };
        lists.trace(Walk::List, Query::Closest, &rays(), options).unwrap().totals().unwrap()
    }

    /// Smaller spheres are visited less; rays that do not run along a triangle hit the same.
    #[test]
    fn spheres_of_vertices_are_visited_less_and_hit_the_same() {
        let scene = sheet(0.4);
        for source in [Source::Octree, Source::Sah] {
            let (boxes, vertices) =
                (lists(&scene, source, Reach::Boxes), lists(&scene, source, Reach::Vertices));
            let hits =
                |lists: &TraversalList| rays().iter().map(|ray| lists.closest(ray)).collect::<Vec<_>>();
            assert!(hits(&boxes).iter().filter(|hit| hit.is_hit()).count() > 500);
            assert_eq!(hits(&boxes), hits(&vertices), "{source:?}");
            let (wide, narrow) = (cost(&boxes), cost(&vertices));
            assert!(narrow.inner_visits + narrow.primitive_tests < wide.inner_visits + wide.primitive_tests);
            assert!(narrow.primitive_tests <= wide.primitive_tests, "{narrow:?} {wide:?}");
        }
    }

    /// No sphere of a binary tree is larger, some are smaller, and the order and the triangles stay; the octree has other
    /// groups, since fewer triangles are small beside smaller spheres.
    #[test]
    fn what_spheres_hold_changes_their_radii_and_the_octree() {
        let scene = sheet(0.4);
        let radii = |source, reach| -> Vec<f32> {
            let lists = lists(&scene, source, reach);
            lists.list(0).iter().filter(|it| !it.is_triangle()).map(|it| it.sphere().radius).collect()
        };
        let (wide, narrow) = (radii(Source::Sah, Reach::Boxes), radii(Source::Sah, Reach::Vertices));
        let sum = |radii: &[f32]| radii.iter().map(|&radius| f64::from(radius)).sum::<f64>();
        assert!(wide.len() == narrow.len() && sum(&narrow) < sum(&wide));
        let groups = |big, reach| {
            let lists = scene.build_list(&ListOptions { big, reach, ..ListOptions::default() }).unwrap();
            lists.validate().unwrap();
            lists.list(0).iter().filter(|it| !it.is_triangle()).count()
        };
        let differs = |&big: &u32| groups(big, Reach::Boxes) != groups(big, Reach::Vertices);
        assert!((10..100).step_by(5).any(|big| differs(&big)));
    }

    /// Spheres that hold vertices are found out where boxes should be held, and those that hold less in any case.
    #[test]
    fn a_list_is_held_against_what_it_says_it_holds() {
        let mut lists = lists(&sheet(0.4), Source::Octree, Reach::Vertices);
        lists.options.reach = Reach::Boxes;
        assert!(lists.validate().unwrap_err().what.contains("leaves"));
        lists.options.reach = Reach::Vertices;
        let root = lists.elements[0].sphere();
        let smaller = Sphere { radius: root.radius * 0.999, ..root };
        lists.elements[0].payload = crate::traversal_list::Element::of_sphere(&smaller).payload;
        assert!(lists.validate().unwrap_err().what.contains("leaves"));
    }

    /// An update writes what a build of the same order would.
    #[test]
    fn an_update_holds_vertices_too() {
        let (was, is) = (sheet(0.4), sheet(0.9));
        for source in [Source::Octree, Source::Sah] {
            let mut updated = lists(&was, source, Reach::Vertices);
            updated.update(&is).unwrap();
            updated.validate().unwrap();
            let mut boxes = lists(&was, source, Reach::Vertices);
            boxes.options.reach = Reach::Boxes;
            boxes.update(&is).unwrap();
            let radius = |lists: &TraversalList| lists.list(0)[0].sphere().radius;
            assert!(radius(&updated) <= radius(&boxes));
            let fresh = lists(&is, source, Reach::Vertices);
            for ray in rays() {
                assert_eq!(updated.closest(&ray), fresh.closest(&ray), "{source:?} {ray:?}");
            }
        }
    }
}
