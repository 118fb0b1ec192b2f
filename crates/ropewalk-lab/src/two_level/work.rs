//! What a ray did on its way, the levels told apart.

use rayon::prelude::*;
use ropewalk::bvh::walk::{AnyHit, ClosestHit, Summary};
use ropewalk::two_level::SmartStack;
use ropewalk::{Counters, PreparedRay, Probe, Query, Ray, Structure, TraceError, TraceOptions, TwoLevel};

/// What a ray did. As a probe it tells the top level's events from those of the objects by when objects are entered and left.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct RayWork {
    /// Nodes of the top level, or of a single BVH.
    pub(super) top_visits: u32,
    /// Nodes of the objects' structures, or of a single kd-tree.
    pub(super) bottom_visits: u32,
    pub(super) primitive_tests: u32,
    /// Objects whose boxes were tested.
    pub(super) objects_tested: u32,
    /// Objects whose structure was entered.
    pub(super) objects_entered: u32,
    /// The most entries of the top level's stack, or of a single BVH's.
    pub(super) top_depth: u32,
    /// The most entries of an object's stack, or of a single kd-tree's.
    pub(super) bottom_depth: u32,
    /// The most bytes that both stacks took together, in one ring.
    pub(super) stack_bytes: u32,
    /// Entries that left the ring.
    pub(super) swaps: u32,
    /// Whether it hit something.
    pub(super) is_hit: bool,
    pub(super) inside: bool,
}

impl Probe for RayWork {
    fn inner_visit(&mut self) {
        *(if self.inside { &mut self.bottom_visits } else { &mut self.top_visits }) += 1;
    }

    fn primitive_test(&mut self) {
        self.primitive_tests += 1;
    }

    fn stack_depth(&mut self, entries: usize) {
        let depth = if self.inside { &mut self.bottom_depth } else { &mut self.top_depth };
        *depth = (*depth).max(entries as u32);
    }

    fn object_tested(&mut self) {
        self.objects_tested += 1;
    }

    fn object_entered(&mut self) {
        self.objects_entered += 1;
        self.inside = true;
    }

    fn object_left(&mut self) {
        self.inside = false;
    }

    fn stack_bytes(&mut self, most: u32, swaps: u32) {
        self.stack_bytes = most;
        self.swaps = swaps;
    }
}

impl RayWork {
    /// Of a ray through a structure of one level.
    fn of_one_level(counters: &Counters, is_kd: bool, is_hit: bool) -> Self {
        let Counters { inner_visits, primitive_tests, stack_depth, .. } = *counters;
        let work = Self { primitive_tests, is_hit, ..Self::default() };
        if is_kd {
            Self { bottom_visits: inner_visits, bottom_depth: stack_depth, ..work }
        } else {
            Self { top_visits: inner_visits, top_depth: stack_depth, ..work }
        }
    }
}

/// What each ray of a batch does in a structure, on the CPU. Only [`Query::Closest`] and [`Query::Any`] are asked.
pub(super) fn count(structure: &Structure, query: Query, rays: &[Ray]) -> Result<Vec<RayWork>, TraceError> {
    if let Structure::TwoLevel(scene) = structure {
        let one = |ray: &Ray| match query {
            Query::Any => through::<AnyHit>(scene, ray, |answer| answer),
            _ => through::<ClosestHit>(scene, ray, |hit| hit.is_hit()),
        };
        return Ok(rays.par_iter().with_min_len(256).map(one).collect());
    }
    let is_kd = matches!(structure, Structure::KdTree(_));
    let walk = structure.kind().default_walk();
    let traced = structure.trace(walk, query, rays, TraceOptions { counters: true })?;
    let is_hit: Vec<bool> = match &traced.answer {
        ropewalk::Answer::Any(hits) => hits.clone(),
        ropewalk::Answer::Closest(hits) => hits.iter().map(ropewalk::Hit::is_hit).collect(),
        _ => Vec::new(),
    };
    let counters = traced.counters.unwrap_or_default();
    Ok(counters.iter().zip(is_hit).map(|(it, is_hit)| RayWork::of_one_level(it, is_kd, is_hit)).collect())
}

/// Through both levels by the walk with one ring, which does what the other does.
fn through<S: Summary>(scene: &TwoLevel, ray: &Ray, is_hit: impl Fn(S::Answer) -> bool) -> RayWork {
    let Some(prepared) = PreparedRay::new(ray) else { return RayWork::default() };
    let collect = S::new(&prepared);
    let (collect, work) =
        scene.visit_merged(SmartStack::MOST_BYTES, ray, &prepared, collect, RayWork::default());
    RayWork { is_hit: is_hit(collect.answer()), ..work }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::two_level::depths::Depths;
    use glam::Vec3;
    use ropewalk::{Mesh, NoMonitor, Scene, StructureSpec, Transform};

    /// What a walk tells by hand: two entries above, then an object with three, one below that, an object with one.
    #[test]
    fn the_levels_are_told_apart() {
        let mut work = RayWork::default();
        work.inner_visit();
        work.stack_depth(1);
        work.inner_visit();
        work.stack_depth(2);
        work.object_tested();
        work.object_entered();
        for entries in [1, 2, 3, 2] {
            work.inner_visit();
            work.stack_depth(entries);
        }
        work.primitive_test();
        work.object_left();
        work.inner_visit();
        work.stack_depth(1);
        work.object_tested();
        work.object_tested();
        work.object_entered();
        work.stack_depth(1);
        work.object_left();
        work.stack_bytes(2 * 8 + 3 * 12, 0);
        let expected = RayWork {
            top_visits: 3,
            bottom_visits: 4,
            primitive_tests: 1,
            objects_tested: 3,
            objects_entered: 2,
            top_depth: 2,
            bottom_depth: 3,
            stack_bytes: 52,
            ..RayWork::default()
        };
        assert_eq!(work, expected);
        let depths = Depths::of([work, RayWork::default()].iter().map(|it| it.bottom_depth));
        assert_eq!(depths, Depths { avg: 1.5, max: 3, var: 2.25 });
    }

    /// Three triangles one behind the other, each an object: all are entered where the hit is in the last, and the top level of
    /// three leaves holds one entry.
    #[test]
    fn a_ray_through_three_objects_enters_what_it_meets() {
        let mut scene = Scene::default();
        let corners = vec![Vec3::new(-1.0, -1.0, 0.0), Vec3::X, Vec3::Y];
        let object = scene.add_object(Mesh::new(corners, vec![[0, 1, 2]]));
        for step in 0..3 {
            scene.add_instance(object, Transform::from_translation(Vec3::Z * -2.0 * step as f32));
        }
        let spec: StructureSpec = "two-level".parse().unwrap();
        let structure = spec.build(&scene, &NoMonitor).unwrap();
        let rays = [
            Ray::new(Vec3::new(0.0, 0.0, 1.0), -Vec3::Z),
            Ray::new(Vec3::new(0.0, 0.0, 1.0), Vec3::Z),
            Ray::new(Vec3::ZERO, Vec3::ZERO),
        ];
        let works = count(&structure, Query::Closest, &rays).unwrap();
        assert_eq!(works[0].objects_entered, 1, "the first hit hides the others: {works:?}");
        assert!(works[0].is_hit && works[0].primitive_tests == 1 && works[0].top_visits >= 1);
        assert_eq!((works[0].bottom_depth, works[0].bottom_visits), (0, 0), "one leaf has no inner node");
        assert!(works[0].stack_bytes == 8 * works[0].top_depth && works[0].swaps == 0);
        assert!(!works[1].is_hit && works[1].objects_entered == 0);
        assert_eq!(works[2], RayWork::default());
        // One kd-tree and one BVH have one level each.
        for (name, is_kd) in [("kd-tree", true), ("bvh:max-leaf=1", false)] {
            let spec: StructureSpec = name.parse().unwrap();
            let single = spec.build(&scene, &NoMonitor).unwrap();
            let works = count(&single, Query::Any, &rays).unwrap();
            assert!(works[0].is_hit && works[0].objects_entered == 0);
            assert_eq!((works[0].top_visits > 0, works[0].bottom_visits > 0), (!is_kd, is_kd), "{works:?}");
        }
    }
}
