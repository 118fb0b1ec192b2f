//! What the SBVH builder promises beyond what every builder does: the leaves of a triangle cover its box, references
//! stay in their budget, hits are those of other trees to the bit, and rays visit less where large triangles are.

use glam::{DQuat, DVec3, Vec3};
use ropewalk::bvh::{BuildOptions, Builder, Bvh};
use ropewalk::{Aabb, Hit, Mesh, Query, Ray, Scene, TraceOptions, Walk, glam};
use ropewalk_testkit::cases::Case;
use ropewalk_testkit::meshes;
use ropewalk_testkit::random::Random;
use ropewalk_testkit::rays::{RayClass, RayMaker};
use std::collections::HashMap;

fn sbvh() -> BuildOptions {
    BuildOptions { builder: Builder::Sbvh, ..BuildOptions::default() }
}

/// A room with slanted beams and many small things: what spatial splits are for.
fn interior() -> Mesh {
    let mut random = Random::new(31);
    let mut mesh = meshes::cuboid(Vec3::new(-5.0, -1.0, -4.0), Vec3::new(5.0, 3.0, 4.0));
    for _ in 0..24 {
        let turn = DQuat::from_axis_angle(random.direction(), random.between(0.0, 3.0));
        let place =
            DVec3::new(random.between(-4.0, 4.0), random.between(0.0, 2.0), random.between(-3.0, 3.0));
        let beam = meshes::cuboid(Vec3::new(-3.0, -0.05, -0.1), Vec3::new(3.0, 0.05, 0.1));
        meshes::append(&mut mesh, &meshes::mapped(beam, |point| turn * point + place));
    }
    for _ in 0..30 {
        let place =
            DVec3::new(random.between(-4.5, 4.5), random.between(-0.9, 2.5), random.between(-3.5, 3.5));
        let size = random.between(0.05, 0.25);
        let ball = meshes::mapped(meshes::icosphere(2), |point| point * size + place);
        meshes::append(&mut mesh, &ball);
    }
    mesh
}

/// Everything odd, and the room.
fn scenes() -> Vec<(&'static str, Scene)> {
    let mut scenes: Vec<(&str, Scene)> =
        Case::every().into_iter().map(|case| (case.name, case.scene)).collect();
    scenes.push(("interior", Scene::from_mesh(interior())));
    for (name, size) in [("huge interior", 1e11), ("tiny interior", 1e-30)] {
        scenes.push((name, Scene::from_mesh(meshes::mapped(interior(), |point| point * size))));
    }

    let mut random = Random::new(12);
    let one = [DVec3::ZERO, DVec3::X, DVec3::new(0.3, 1.0, 0.4)];
    let mut add = |name, triangles: Vec<[DVec3; 3]>| {
        let mut mesh = Mesh::default();
        triangles.into_iter().for_each(|triangle| meshes::push(&mut mesh, triangle));
        scenes.push((name, Scene::from_mesh(mesh)));
    };
    add("the same triangle 2,000 times", vec![one; 2000]);
    add("halving sizes at one point", (0..100).map(|k| one.map(|corner| corner * 0.5f64.powi(k))).collect());
    add(
        "concentric",
        (1..200).map(|k| one.map(|corner| (corner - DVec3::splat(0.3)) * f64::from(k))).collect(),
    );
    let needle = |_| {
        let (from, along) = (random.in_cube(), random.direction() * 3.0);
        [from, from + along, from + along * 0.5 + random.in_cube() * 1e-4]
    };
    add("needles", (0..500).map(needle).collect());
    scenes
}

type Identity = (u32, u32, u32);

/// For each triangle its box, and the boxes of the leaves in which it stands.
fn places(bvh: &Bvh) -> HashMap<Identity, (Aabb, Vec<Aabb>)> {
    let mut places: HashMap<Identity, (Aabb, Vec<Aabb>)> = HashMap::new();
    for leaf in bvh.nodes().iter().filter(|node| node.is_leaf()) {
        let mut here: Vec<Identity> = Vec::new();
        for triangle in &bvh.triangles()[leaf.link as usize..(leaf.link + leaf.count) as usize] {
            let identity = (triangle.instance(), triangle.geometry(), triangle.primitive);
            here.push(identity);
            let place = places.entry(identity).or_insert_with(|| (triangle.triangle().bounds(), Vec::new()));
            place.1.push(leaf.bounds());
        }
        here.sort_unstable();
        assert!(here.windows(2).all(|pair| pair[0] != pair[1]), "a triangle stands twice in one leaf");
    }
    places
}

/// What of `whole` is in none of `boxes`: a list of boxes, without rounding. Nothing is left of a face alone.
fn uncovered(whole: Aabb, boxes: &[Aabb]) -> Vec<Aabb> {
    let mut rest = vec![whole];
    for cover in boxes {
        let mut left = Vec::new();
        for mut part in rest {
            let meets = part.min.cmple(cover.max).all() && cover.min.cmple(part.max).all();
            if !meets {
                left.push(part);
                continue;
            }
            for axis in 0..3 {
                if part.min[axis] < cover.min[axis] {
                    let mut below = part;
                    below.max[axis] = cover.min[axis];
                    left.push(below);
                    part.min[axis] = cover.min[axis];
                }
                if cover.max[axis] < part.max[axis] {
                    let mut above = part;
                    above.min[axis] = cover.max[axis];
                    left.push(above);
                    part.max[axis] = cover.max[axis];
                }
            }
        }
        rest = left;
    }
    rest
}

/// What identical hits rest on: see the builder's text. Not a sample of points, but the whole box, exactly.
#[test]
fn the_leaves_of_a_triangle_cover_its_box() {
    let mut repeated = 0;
    for (name, scene) in scenes() {
        for (max_leaf, duplication, reinsertion) in [(1, 400, 0), (4, 50, 0), (2, 30, 2)] {
            let options = BuildOptions { max_leaf, duplication, reinsertion, ..sbvh() };
            let bvh = scene.build(&options).unwrap();
            bvh.validate().unwrap_or_else(|error| panic!("{name}: {error}"));
            let places = places(&bvh);
            assert_eq!(places.len(), bvh.report().triangles, "{name}");
            for (identity, (own, leaves)) in places {
                repeated += usize::from(leaves.len() > 1);
                let rest = uncovered(own, &leaves);
                assert!(rest.is_empty(), "{name} {options:?}: of {identity:?} {rest:?} is in no leaf");
            }
        }
    }
    assert!(repeated > 500, "{repeated} triangles in several leaves test little");
}

/// The comparator of the test above.
#[test]
fn a_gap_is_found() {
    let boxed = |low: [f32; 3], high: [f32; 3]| Aabb::new(low.into(), high.into());
    let whole = boxed([0.0; 3], [4.0, 4.0, 0.0]);
    let halves = [boxed([0.0, 0.0, -1.0], [2.0, 4.0, 1.0]), boxed([2.0, 0.0, 0.0], [4.0, 4.0, 0.0])];
    assert!(uncovered(whole, &halves).is_empty());
    assert!(uncovered(whole, &[whole]).is_empty());
    assert_eq!(uncovered(whole, &[]), [whole]);
    assert_eq!(uncovered(whole, &halves[..1]), [boxed([2.0, 0.0, 0.0], [4.0, 4.0, 0.0])]);
    let gap = [halves[0], boxed([2.0f32.next_up(), 0.0, 0.0], [4.0, 4.0, 0.0])];
    assert_eq!(uncovered(whole, &gap).len(), 1);
    let hole = [halves[0], boxed([2.0, 0.0, 0.0], [4.0, 1.0, 0.0]), boxed([2.0, 2.0, 0.0], [4.0, 4.0, 0.0])];
    assert_eq!(uncovered(whole, &hole), [boxed([2.0, 1.0, 0.0], [4.0, 2.0, 0.0])]);
    assert_eq!(uncovered(whole, &[boxed([0.0, 0.0, 1.0], [4.0, 4.0, 1.0])]), [whole], "beside it");
}

#[test]
fn references_stay_in_their_budget() {
    for (name, scene) in scenes() {
        for duplication in [0, 1, 7, 30, 100, 400] {
            for (max_leaf, max_depth) in [(1, 63), (4, 31), (3, 8), (2, 1)] {
                let options = BuildOptions { duplication, max_leaf, max_depth, ..sbvh() };
                let report = *scene.build(&options).unwrap().report();
                let most = report.triangles + report.triangles * duplication as usize / 100;
                assert!(report.references >= report.triangles, "{name} {options:?}");
                assert!(report.references <= most, "{name} {options:?}: {} of {most}", report.references);
                assert!(report.depth <= max_depth, "{name} {options:?}");
            }
        }
    }
    let grown = |duplication| {
        let bvh = scenes()[Case::names().len()].1.build(&BuildOptions { duplication, ..sbvh() }).unwrap();
        bvh.report().references - bvh.report().triangles
    };
    assert!(0 == grown(0) && 0 < grown(5) && grown(5) < grown(100), "a larger budget is used");
}

/// Every class of rays, hard ones in planes of triangles included; and every query.
#[test]
fn hits_are_those_of_a_binned_tree_to_the_bit() {
    let scene = Scene::from_mesh(interior());
    compare(&scene, 60_000);
    for case in Case::every() {
        let flat = case.scene.flatten().unwrap();
        if !flat.triangles.is_empty() {
            compare(&case.scene, 500);
        }
    }
}

/// The kitchen, where the file is at hand: a million rays.
#[test]
fn hits_in_the_kitchen_are_those_of_a_binned_tree_to_the_bit() {
    let path = std::path::PathBuf::from(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../../shared/scenes/kitchen_obvhs/kitchen_56939.obj.gz"
    ));
    let Ok(packed) = std::fs::read(&path) else {
        println!("skipped: {} is not there", path.display());
        return;
    };
    let scene = Scene::from_mesh(read_obj(&packed));
    compare(&scene, 70_000);
    for max_leaf in [1, 4, 8] {
        let inner = |builder| {
            let bvh = scene.build(&BuildOptions { builder, max_leaf, ..BuildOptions::default() }).unwrap();
            inner_visits(&bvh, &from_inside(&bvh, 20_000))
        };
        let ratio = inner(Builder::Sbvh) / inner(Builder::SweepSah);
        println!("kitchen, leaves of {max_leaf}: inner visits of the SBVH are {ratio:.3} of the sweep's");
        assert!(ratio < 0.9, "{ratio}");
    }
}

fn compare(scene: &Scene, rays_a_class: usize) {
    let flat = scene.flatten().unwrap();
    let maker = RayMaker::new(&flat, 23);
    let binned = scene.build(&BuildOptions::default()).unwrap();
    let closest = |rays: &[Ray]| {
        let mut hits = vec![Hit::MISS; rays.len()];
        binned.closest_batch(rays, &mut hits);
        hits
    };
    let trees = [1, 4].map(|max_leaf| scene.build(&BuildOptions { max_leaf, ..sbvh() }).unwrap());
    for class in RayClass::EVERY {
        let rays = maker.make(class, rays_a_class, &closest);
        for query in Query::EVERY {
            // All hits of many rays are many.
            let rays = if query == Query::Closest { &rays[..] } else { &rays[..rays.len().min(5000)] };
            let trace = |bvh: &Bvh| bvh.trace(Walk::default(), query, rays, TraceOptions::default()).unwrap();
            let expected = trace(&binned);
            for tree in &trees {
                ropewalk_testkit::compare::same_bits(rays, &expected, &trace(tree), false)
                    .unwrap_or_else(|error| panic!("{class} {query}: {error}"));
            }
        }
    }
}

fn from_inside(bvh: &Bvh, count: usize) -> Vec<Ray> {
    let mut random = Random::new(2);
    let bounds = bvh.bounds();
    (0..count)
        .map(|_| Ray::new(random.in_box(&bounds, 0.7).as_vec3(), random.direction().as_vec3()))
        .collect()
}

fn inner_visits(bvh: &Bvh, rays: &[Ray]) -> f64 {
    let options = TraceOptions { counters: true };
    let traced = bvh.trace(Walk::default(), Query::Closest, rays, options).unwrap();
    traced.totals().unwrap().inner_visits as f64 / rays.len() as f64
}

#[test]
fn large_triangles_cost_fewer_visits_and_small_ones_no_more() {
    let inner = |mesh: &Mesh, builder| {
        let scene = Scene::from_mesh(mesh.clone());
        let bvh = scene.build(&BuildOptions { builder, ..BuildOptions::default() }).unwrap();
        let growth = bvh.report().references as f64 / bvh.report().triangles as f64;
        (inner_visits(&bvh, &from_inside(&bvh, 20_000)), growth)
    };
    let room = interior();
    let (swept, (split, growth)) = (inner(&room, Builder::SweepSah), inner(&room, Builder::Sbvh));
    println!("interior: {} inner visits, {split} with {growth} references a triangle", swept.0);
    assert!(split < 0.9 * swept.0 && growth > 1.01);
    let sphere = meshes::icosphere(5);
    let (swept, (split, growth)) = (inner(&sphere, Builder::SweepSah), inner(&sphere, Builder::Sbvh));
    println!("sphere: {} inner visits, {split} with {growth} references a triangle", swept.0);
    assert!(split < 1.03 * swept.0 && growth < 1.05);
}

/// Just enough of OBJ for the file above.
fn read_obj(packed: &[u8]) -> Mesh {
    use std::io::Read;
    let mut text = String::new();
    flate2::read::GzDecoder::new(packed).read_to_string(&mut text).unwrap();
    let mut mesh = Mesh::default();
    for line in text.lines() {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => {
                let numbers: Vec<f32> = words.take(3).map(|word| word.parse().unwrap()).collect();
                mesh.positions.push(Vec3::from_slice(&numbers));
            }
            Some("f") => {
                let index = |word: &str| word.split('/').next().unwrap().parse::<u32>().unwrap() - 1;
                let corners: Vec<u32> = words.map(index).collect();
                for pair in corners[1..].windows(2) {
                    mesh.triangles.push([corners[0], pair[0], pair[1]]);
                }
            }
            _ => {}
        }
    }
    mesh
}
