//! What width saves, counted.

use crate::scenes::SHAPES;
use glam::{DVec3, Vec3};
use ropewalk::catalogue::TrailOptions;
use ropewalk::wide_bvh::{Collapse, WideBvh, Width};
use ropewalk::{BuildOptions, CounterTotals, Hit, Query, Ray, Scene, TraceOptions, Walk, glam};
use ropewalk_testkit::meshes;
use ropewalk_testkit::random::Random;
use ropewalk_testkit::rays::{RayClass, RayMaker, View};

/// Bushes of small leaves over a ground: long ways past many half-empty boxes.
fn bushes() -> Scene {
    let mut random = Random::new(12);
    let mut mesh = meshes::grid(1, 0.0, 20, 1.0);
    for _ in 0..60 {
        let root = DVec3::new(random.between(1.0, 19.0), 0.0, random.between(1.0, 19.0));
        for _ in 0..500 {
            let place = root + DVec3::Y * 2.0 + random.in_cube() * DVec3::new(0.9, 1.6, 0.9);
            let (along, across) = (random.direction() * 0.25, random.direction() * 0.1);
            meshes::push(&mut mesh, [place - across, place + across, place + along]);
        }
    }
    Scene::from_mesh(mesh)
}

const RAYS: usize = 8000;
const COUNTED: TraceOptions = TraceOptions { counters: true };

fn totals(wide: &WideBvh, walk: Walk, rays: &[Ray]) -> CounterTotals {
    wide.trace(walk, Query::Closest, rays, COUNTED).unwrap().totals().unwrap()
}

/// Half of the visits with 4 children, a third with 8; and the short stacks' shares of the full stack, which are those of
/// the kitchen, the atrium and the forest of the table in ALGORITHMS (4.4) and of others like them.
#[test]
fn wide_nodes_save_visits_and_short_stacks_cost_some() {
    let scene = bushes();
    let bvh = scene.build(&BuildOptions::default()).unwrap();
    let flat = scene.flatten().unwrap();
    let closest = |rays: &[Ray]| rays.iter().map(|ray| bvh.closest(ray)).collect::<Vec<Hit>>();
    let view = View::look_at(Vec3::new(-3.0, 2.5, 9.0), Vec3::new(10.0, 1.5, 10.0), 0.6);
    let maker = RayMaker::new(&flat, 2).with_view(view);
    for class in [RayClass::Primary, RayClass::DiffuseBounce] {
        let rays = maker.make(class, RAYS, &closest);
        assert_eq!(rays.len(), RAYS);
        let binary = bvh.trace(Walk::default(), Query::Closest, &rays, COUNTED).unwrap().totals().unwrap();
        for (width, how) in SHAPES {
            let wide = WideBvh::from_bvh(&bvh, width, how);
            let full = totals(&wide, Walk::default(), &rays);
            let share = full.inner_visits as f64 / binary.inner_visits as f64;
            println!("{class} {width:?} {how:?}: {share:.3} of {} visits", binary.inner_visits / RAYS as u64);
            let band = match width {
                Width::Four => 0.4..0.6,
                Width::Eight => 0.25..0.42,
            };
            assert!(band.contains(&share), "{class} {width:?} {how:?}: {share}");
            assert_eq!(full.restarts, 0);
            assert!(full.stack_depth <= wide.stack_entries());
            // The same leaves, but for what a shorter ray has spared one of them.
            let leaves = full.leaf_visits as f64 / binary.leaf_visits as f64;
            assert!((0.9..1.05).contains(&leaves), "{class} {width:?} {how:?}: {leaves}");

            let shares = [0, 1, 2, 3, 4, 5, 8, 16].map(|short_stack| {
                let walk = Walk::RestartTrail(TrailOptions { short_stack, ..TrailOptions::default() });
                let trail = totals(&wide, walk, &rays);
                assert_eq!(trail.leaf_visits, full.leaf_visits, "{short_stack} entries");
                assert_eq!(trail.primitive_tests, full.primitive_tests, "{short_stack} entries");
                assert!(trail.stack_depth <= short_stack);
                trail.inner_visits as f64 / full.inner_visits as f64
            });
            println!("  {shares:.3?}");
            assert!(shares.is_sorted_by(|a, b| a >= b), "{shares:?}");
            assert!((1.4..3.2).contains(&shares[0]), "{shares:?}");
            assert!(shares[3] < 1.25 && shares[5] < 1.1 && shares[7] < 1.002, "{shares:?}");
        }
    }
}

/// The collapse of least cost costs no more than the greedy one, by its own measure, and makes fuller nodes.
#[test]
fn the_collapse_of_least_cost_is_the_better_one() {
    let scene = bushes();
    let bvh = scene.build(&BuildOptions::default()).unwrap();
    for width in [Width::Four, Width::Eight] {
        let [area, sah] =
            [Collapse::Area, Collapse::Sah].map(|how| *WideBvh::from_bvh(&bvh, width, how).report());
        assert!(sah.sah_cost < area.sah_cost, "{width:?}: {} {}", sah.sah_cost, area.sah_cost);
        assert!(sah.nodes < area.nodes && sah.leaves == area.leaves, "{width:?}");
        assert!(area.sah_cost < bvh.report().sah_cost);
    }
}
