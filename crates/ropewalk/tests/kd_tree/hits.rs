//! Hits of every walk against brute force and a BVH, to the bit, for all four queries.

use super::support::{builds, interior, scenes, walks};
use ropewalk::kd_tree::KdOptions;
use ropewalk::{BuildOptions, Bvh, Hit, KdTree, Query, Ray, Scene, TraceOptions, Traced, Walk};
use ropewalk_testkit::cases::Case;
use ropewalk_testkit::compare::same_bits;
use ropewalk_testkit::rays::{RayClass, RayMaker};

const PLAIN: TraceOptions = TraceOptions { counters: false };

/// A BVH, and trees that must answer like it.
struct Judge<'a> {
    name: &'a str,
    bvh: Bvh,
    trees: Vec<(KdOptions, KdTree)>,
}

impl<'a> Judge<'a> {
    fn new(name: &'a str, scene: &Scene, builds: &[KdOptions]) -> Self {
        let trees = builds.iter().map(|&options| (options, scene.build_kd(&options).unwrap())).collect();
        Self { name, bvh: scene.build(&BuildOptions::default()).unwrap(), trees }
    }

    /// Compares every walk of the trees with the BVH, on all rays, and for lists of hits on some, which are long.
    fn check(&self, rays: &[Ray], lists: usize) {
        for query in Query::EVERY {
            let is_list = matches!(query, Query::All | Query::Count);
            let rays = if is_list { &rays[..rays.len().min(lists)] } else { rays };
            let expected = self.bvh.trace(Walk::default(), query, rays, PLAIN).unwrap();
            let agree = |what: &str, given: &Traced| {
                same_bits(rays, &expected, given, false)
                    .unwrap_or_else(|error| panic!("{}, {query}, {what}: {error}", self.name));
            };
            for (options, tree) in &self.trees {
                for walk in walks() {
                    let given = tree.trace(walk, query, rays, PLAIN).unwrap();
                    agree(&format!("{walk}, {options:?}"), &given);
                }
                if rays.len() <= 2000 {
                    agree("brute force", &tree.trace_by_force(query, rays, PLAIN));
                }
            }
        }
    }
}

#[test]
fn every_case_has_the_hits_of_brute_force() {
    for case in Case::every() {
        Judge::new(case.name, &case.scene, &builds()).check(&case.rays, 500);
    }
}

#[test]
fn every_class_of_rays_has_the_hits_of_a_bvh() {
    for (name, scene) in scenes() {
        let flat = scene.flatten().unwrap();
        if flat.triangles.is_empty() {
            continue;
        }
        let judge = Judge::new(name, &scene, &builds()[..2]);
        let maker = RayMaker::new(&flat, 23);
        let closest = |rays: &[Ray]| {
            let mut hits = vec![Hit::MISS; rays.len()];
            judge.bvh.closest_batch(rays, &mut hits);
            hits
        };
        let many = match name {
            "interior" | "blocks" => 4000,
            // Its products are subnormal numbers, which take a hundred times as long.
            "tiny interior" => 5,
            _ => 100,
        };
        for class in RayClass::EVERY {
            judge.check(&maker.make(class, many, &closest), 100);
        }
    }
}

#[test]
fn one_ray_at_a_time_is_answered_like_a_batch() {
    let scene = Scene::from_mesh(interior());
    let tree = scene.build_kd(&KdOptions::default()).unwrap();
    let bvh = scene.build(&BuildOptions::default()).unwrap();
    let rays = super::support::rays(4, 500);
    let (mut hits, mut any) = (vec![Hit::MISS; rays.len()], vec![false; rays.len()]);
    tree.closest_batch(&rays, &mut hits);
    tree.any_batch(&rays, &mut any);
    let (mut all, mut expected) = (Vec::new(), Vec::new());
    for ((ray, hit), any) in rays.iter().zip(&hits).zip(&any) {
        assert_eq!(hit.to_words(), bvh.closest(ray).to_words());
        assert_eq!(tree.closest(ray).to_words(), hit.to_words());
        assert_eq!((*any, tree.any(ray)), (hit.is_hit(), hit.is_hit()));
        tree.all(ray, &mut all);
        bvh.all(ray, &mut expected);
        assert_eq!(all, expected);
        assert_eq!(tree.count(ray) as usize, all.len());
    }
}
