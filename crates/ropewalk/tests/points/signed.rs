//! The sign of the distance against rays: a point is inside where most of several rays leave through an odd number of
//! walls. Nothing of the one is in the other.

use ropewalk::glam::{DQuat, DVec3, Vec3};
use ropewalk::{
    BuildOptions, Builder, Bvh, Feature, Mesh, Ray, Scene, SignedDistance, SurfacePoint, Transform, glam,
};
use ropewalk_testkit::meshes;
use ropewalk_testkit::points::{PointOracle, around};
use ropewalk_testkit::random::Random;

const POINTS: usize = 100_000;

fn build(mesh: Mesh) -> Bvh {
    Scene::from_mesh(mesh).build(&BuildOptions::default()).unwrap()
}

fn torus(around: u32, across: u32, thickness: f64) -> Mesh {
    let point = |i: u32, j: u32| {
        let turn = |index: u32, of: u32| std::f64::consts::TAU * f64::from(index) / f64::from(of);
        let (u, v) = (turn(i, around), turn(j, across));
        let ring = 1.0 + thickness * v.cos();
        DVec3::new(ring * u.cos(), ring * u.sin(), thickness * v.sin()).as_vec3()
    };
    let positions = (0..around).flat_map(|i| (0..across).map(move |j| point(i, j))).collect();
    let corner = |i: u32, j: u32| i % around * across + j % across;
    let triangles = (0..around)
        .flat_map(|i| (0..across).map(move |j| (i, j)))
        .flat_map(|(i, j)| {
            let [a, b, c, d] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect();
    Mesh::new(positions, triangles)
}

/// Triangles turned over, so that the other side is outside.
fn inside_out(mut mesh: Mesh) -> Mesh {
    mesh.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
    mesh
}

/// A solid of spikes: neighbouring vertices lie at very different distances from the middle.
fn spikes() -> Mesh {
    let mut random = Random::new(12);
    let mut mesh = meshes::icosphere(3);
    mesh.positions.iter_mut().for_each(|position| *position *= random.between(0.05, 1.0).powi(2) as f32);
    mesh
}

/// A long rod of many sides: each side is two needles, and its ends are fans of slivers.
fn rod() -> Mesh {
    const SIDES: u32 = 200;
    let rim = |index: u32, x: f64| {
        let turn = std::f64::consts::TAU * f64::from(index) / f64::from(SIDES);
        DVec3::new(x, 0.2 * turn.cos(), 0.2 * turn.sin()).as_vec3()
    };
    let mut mesh = Mesh::new(vec![Vec3::new(-5.0, 0.0, 0.0), Vec3::new(5.0, 0.0, 0.0)], Vec::new());
    for index in 0..SIDES {
        mesh.positions.extend([rim(index, -5.0), rim(index, 5.0)]);
        let [a, b] = [2 + 2 * index, 2 + 2 * ((index + 1) % SIDES)];
        mesh.triangles.extend([[0, b, a], [1, a + 1, b + 1], [a, b, b + 1], [a, b + 1, a + 1]]);
    }
    mesh
}

fn far(mesh: Mesh) -> Mesh {
    let turn = DQuat::from_xyzw(0.1, -0.5, 0.3, 0.8).normalize();
    meshes::mapped(mesh, |point| turn * (point * 25.0) + DVec3::new(10_000.0, -10_000.0, 5_000.0))
}

fn solids() -> Vec<(&'static str, Mesh)> {
    let mut shells = meshes::icosphere(3);
    for (index, radius) in [0.8, 0.6, 0.4, 0.2].into_iter().enumerate() {
        let shell = meshes::mapped(meshes::icosphere(3), |point| point * radius);
        meshes::append(&mut shells, &if index % 2 == 0 { inside_out(shell) } else { shell });
    }
    let mut boxes = meshes::cuboid(Vec3::new(-1.0, -2.0, 0.0), Vec3::new(1.5, 0.25, 3.0));
    // Apart from the first, thin, and touching a third in one vertex.
    meshes::append(&mut boxes, &meshes::cuboid(Vec3::new(1.6, -2.0, 0.0), Vec3::new(1.61, 0.0, 1.0)));
    meshes::append(&mut boxes, &meshes::cuboid(Vec3::new(1.61, 0.0, 1.0), Vec3::new(2.0, 0.5, 2.0)));
    vec![
        ("sphere", meshes::icosphere(4)),
        ("boxes", boxes),
        ("torus", torus(60, 24, 0.35)),
        ("shells", shells),
        ("spikes", spikes()),
        ("rod", rod()),
        ("far spikes", far(spikes())),
        ("far torus", far(torus(60, 24, 0.35))),
    ]
}

/// Whether most of five rays leave through an odd number of walls.
fn is_inside_by_rays(bvh: &Bvh, point: Vec3, random: &mut Random) -> bool {
    let odd = (0..5).filter(|_| bvh.count(&Ray::new(point, random.direction().as_vec3())) % 2 == 1).count();
    odd >= 3
}

/// How often a rule disagrees with the rays, among points that are not as near to the surface as rounding is.
fn disagreements(bvh: &Bvh, solid: &SignedDistance<'_>, rule: impl Fn(Vec3, &SurfacePoint) -> bool) -> usize {
    let mut random = Random::new(6);
    let bounds = bvh.bounds();
    let size = bounds.size().max_element().max(bounds.max.abs().max(bounds.min.abs()).max_element());
    let (mut inside, mut compared, mut wrong) = (0, 0, 0);
    for query in around(&bounds, POINTS, 11) {
        let closest = solid.closest(query.point).unwrap();
        if closest.closest.distance > 1e-6 * size {
            let expected = is_inside_by_rays(bvh, query.point, &mut random);
            compared += 1;
            inside += usize::from(expected);
            wrong += usize::from(rule(query.point, &closest) != expected);
        }
    }
    println!("{compared} points compared, {inside} inside, {wrong} wrong");
    assert!(compared > POINTS * 9 / 10 && inside > 100);
    wrong
}

#[test]
fn the_sign_is_that_of_the_rays() {
    for (name, mesh) in solids() {
        assert!(meshes::is_closed(&mesh), "{name}");
        let bvh = build(mesh);
        let solid = SignedDistance::new(&bvh).unwrap();
        assert!(solid.volume() > 0.0, "{name}");
        print!("{name}: ");
        let wrong = disagreements(&bvh, &solid, |point, closest| {
            let inside = closest.signed_distance < 0.0;
            assert_eq!(solid.contains(point), inside, "{point}");
            inside
        });
        assert_eq!(wrong, 0, "{name}");
    }
}

/// The comparison itself: with the normal of the face alone, or with a vertex's normals summed without their angles,
/// there are wrong signs, and it sees them.
#[test]
fn plain_normals_are_found_out() {
    let mesh = spikes();
    let bvh = build(mesh.clone());
    let solid = SignedDistance::new(&bvh).unwrap();
    let by_face = disagreements(&bvh, &solid, |point, closest| {
        let normal = mesh.triangle(closest.closest.primitive_index as usize).unwrap().normal();
        (point - closest.closest.point).dot(normal) < 0.0
    });
    assert!(by_face > 50, "{by_face}");
}

#[test]
fn the_distance_is_right_and_its_parts_belong_together() {
    for (name, mesh) in solids() {
        let scene = Scene::from_mesh(mesh);
        let oracle = PointOracle::of_scene(&scene).unwrap();
        for builder in [Builder::BinnedSah, Builder::Sbvh] {
            let bvh = scene.build(&BuildOptions { builder, ..BuildOptions::default() }).unwrap();
            let solid = SignedDistance::new(&bvh).unwrap();
            for query in around(&bvh.bounds(), 2000, 3) {
                let found = solid.closest(query.point).unwrap();
                assert_eq!(oracle.closest_objection(&query, &found.closest), None, "{name}: {query:?}");
                assert_eq!(found.signed_distance.abs(), found.closest.distance);
                assert!((found.normal.length() - 1.0).abs() < 1e-5, "{found:?}");
            }
        }
    }
}

/// What any tree says is the same, single or in a batch.
#[test]
fn trees_and_batches_agree() {
    let scene = Scene::from_mesh(spikes());
    let points: Vec<Vec3> = around(&scene.bounds(), 5000, 5).iter().map(|query| query.point).collect();
    let mut first: Option<Vec<f32>> = None;
    for builder in [Builder::BinnedSah, Builder::SweepSah, Builder::Sbvh] {
        let bvh = scene.build(&BuildOptions { builder, max_leaf: 2, ..BuildOptions::default() }).unwrap();
        let solid = SignedDistance::new(&bvh).unwrap();
        let (mut distances, mut inside) = (vec![0.0; points.len()], vec![false; points.len()]);
        solid.distances(&points, &mut distances);
        solid.contains_batch(&points, &mut inside);
        for ((&point, &distance), &inside) in points.iter().zip(&distances).zip(&inside) {
            assert_eq!(
                (solid.distance(point).to_bits(), solid.contains(point)),
                (distance.to_bits(), inside)
            );
            assert_eq!(inside, distance <= 0.0);
        }
        match &first {
            None => first = Some(distances),
            Some(first) => assert_eq!(first, &distances, "{builder:?}"),
        }
    }
}

/// Of a surface that is inside out, all the space around is inside, near and far.
#[test]
fn a_surface_that_is_inside_out_contains_what_is_around() {
    let bvh = build(inside_out(spikes()));
    let solid = SignedDistance::new(&bvh).unwrap();
    assert!(solid.volume() < 0.0);
    let mut inside = 0;
    for query in around(&bvh.bounds(), 2000, 5) {
        assert_eq!(solid.contains(query.point), solid.distance(query.point) <= 0.0, "{query:?}");
        inside += u32::from(solid.contains(query.point));
    }
    assert!(inside > 1000, "{inside} of 2000 points");
    assert!(solid.contains(Vec3::splat(1e6)) && !solid.contains(Vec3::NAN));
}

#[test]
fn the_surface_is_inside_and_at_no_distance() {
    let (low, high) = (Vec3::new(-1.0, -2.0, 0.5), Vec3::new(1.5, 0.25, 3.0));
    let bvh = build(meshes::cuboid(low, high));
    let solid = SignedDistance::new(&bvh).unwrap();
    assert!((solid.volume() - 2.5 * 2.25 * 2.5).abs() < 1e-9);
    let middle = (low + high) * 0.5;
    for (point, feature) in [
        (low, Feature::Vertex),
        (high, Feature::Vertex),
        (Vec3::new(low.x, low.y, middle.z), Feature::Edge),
        (Vec3::new(low.x, middle.y - 0.3, middle.z), Feature::Face),
        (Vec3::new(middle.x + 0.1, high.y, middle.z), Feature::Face),
    ] {
        let found = solid.closest(point).unwrap();
        assert_eq!((found.signed_distance, found.feature), (0.0, feature), "{point}");
        assert!(solid.contains(point));
        let outwards = (point - middle).normalize() * 1e-4;
        assert!(!solid.contains(point + outwards) && solid.contains(point - outwards), "{point}");
    }
    let above = solid.closest(Vec3::new(0.0, -1.0, 5.0)).unwrap();
    assert_eq!((above.signed_distance, above.normal), (2.0, Vec3::Z));
    let beside = solid.closest(high + Vec3::new(0.0, 3.0, 4.0)).unwrap();
    assert_eq!((beside.signed_distance, beside.feature), (5.0, Feature::Vertex));
    assert!((beside.normal - Vec3::splat(1.0 / 3f32.sqrt())).length() < 1e-6, "three right angles");
}

/// Instances that mirror, stretch and turn: their outsides stay outside.
#[test]
fn mirrored_instances_keep_their_outside() {
    let mut scene = Scene::default();
    let spikes = scene.add_object(spikes());
    let turn = glam::Affine3A::from_quat(glam::Quat::from_xyzw(0.1, 0.7, -0.2, 0.4).normalize());
    for (index, scale) in
        [Vec3::ONE, Vec3::new(-1.0, 1.0, 1.0), Vec3::new(0.5, 2.0, -1.0)].into_iter().enumerate()
    {
        let place = glam::Affine3A::from_translation(Vec3::X * (4.0 * index as f32));
        let map = place * turn * glam::Affine3A::from_scale(scale);
        scene.add_instance(spikes, Transform::new(map).unwrap());
        // The solid is there for all, whoever sees its instances.
        scene.instances[index].mask = index as u32;
    }
    let bvh = scene.build(&BuildOptions::default()).unwrap();
    let solid = SignedDistance::new(&bvh).unwrap();
    for instance in &mut scene.instances {
        instance.mask = Ray::ALL;
    }
    let seen = scene.build(&BuildOptions::default()).unwrap();
    assert_eq!(disagreements(&seen, &solid, |_, closest| closest.signed_distance < 0.0), 0);
}

#[test]
fn what_is_no_number_or_no_surface_is_far_outside() {
    let bvh = build(meshes::icosphere(1));
    let solid = SignedDistance::new(&bvh).unwrap();
    for bad in [f32::NAN, f32::INFINITY, f32::MAX] {
        let point = Vec3::new(0.0, bad, 0.0);
        assert!(
            solid.closest(point).is_none() && solid.distance(point).is_infinite() && !solid.contains(point)
        );
    }
    let nothing = build(Mesh::default());
    let nothing = SignedDistance::new(&nothing).unwrap();
    assert!(nothing.distance(Vec3::ZERO).is_infinite() && !nothing.contains(Vec3::ZERO));
    let (mut distances, mut inside) = ([1.0], [true; 3]);
    nothing.distances(&[Vec3::ZERO; 2], &mut distances);
    nothing.contains_batch(&[Vec3::ZERO; 2], &mut inside);
    assert_eq!((distances, inside), ([f32::INFINITY], [false, false, true]));
}
