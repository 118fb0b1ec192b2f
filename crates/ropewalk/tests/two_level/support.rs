//! Two levels in every way, a scene of instances of every kind, and rays.

use ropewalk::glam::{Affine3A, DQuat, DVec3, EulerRot, Quat, Vec3};
use ropewalk::traversal_list::ListOptions;
use ropewalk::two_level::{BottomSpec, Bottoms, Opening, TwoLevelOptions};
use ropewalk::wide_bvh::WideOptions;
use ropewalk::{
    Answer, BuildOptions, Builder, Hit, KdOptions, Mesh, Query, Ray, Scene, TraceOptions, Transform,
    TwoLevel, Walk,
};
use ropewalk_testkit::meshes;
use ropewalk_testkit::random::Random;

/// Every kind of bottom structure, in frames and without.
pub(crate) fn every() -> Vec<TwoLevelOptions> {
    let sbvh = BuildOptions { builder: Builder::Sbvh, ..BuildOptions::default() };
    let bottoms = [
        Bottoms::Each(BottomSpec::KdTree(KdOptions::default())),
        Bottoms::Each(BottomSpec::Bvh(BuildOptions::default())),
        Bottoms::Each(BottomSpec::Bvh(sbvh)),
        Bottoms::Each(BottomSpec::WideBvh(WideOptions::default())),
        Bottoms::Each(BottomSpec::List(ListOptions::default())),
        Bottoms::Mixed,
    ];
    bottoms
        .into_iter()
        .flat_map(|bottoms| {
            [false, true].map(|oriented| TwoLevelOptions { bottoms, oriented, opening: Opening::Never })
        })
        .collect()
}

/// A transform with rotation, uneven scale, sometimes a mirror and a shear.
pub(crate) fn placement(random: &mut Random) -> Affine3A {
    let mut between = |low: f64, high: f64| random.between(low, high) as f32;
    let scale = Vec3::new(between(0.2, 1.5), between(0.2, 1.5), between(0.2, 1.5));
    let scale = if between(0.0, 1.0) < 0.3 { scale * Vec3::new(-1.0, 1.0, 1.0) } else { scale };
    let turn = Quat::from_euler(EulerRot::XYZ, between(-3.0, 3.0), between(-3.0, 3.0), between(-3.0, 3.0));
    let place = Vec3::new(between(-3.0, 3.0), between(-3.0, 3.0), between(-3.0, 3.0));
    let shear = Affine3A::from_cols(
        Vec3::X.into(),
        Vec3::new(between(-0.3, 0.3), 1.0, 0.0).into(),
        Vec3::Z.into(),
        Vec3::ZERO.into(),
    );
    Affine3A::from_scale_rotation_translation(scale, turn, place) * shear
}

/// Objects: a soup, a thin plate that lies askew, a sphere, boxes along the axes.
pub(crate) fn shapes() -> Vec<Mesh> {
    let askew = |point: DVec3| {
        let turn = DQuat::from_euler(EulerRot::XYZ, 0.5, 0.7, 0.2);
        turn * (point * DVec3::new(1.0, 0.05, 0.3))
    };
    vec![
        meshes::soup(200, 0.3, 5),
        meshes::mapped(meshes::icosphere(2), askew),
        meshes::icosphere(2),
        meshes::grid(1, 0.0, 6, 0.3),
    ]
}

/// Forty instances of four objects, one of them where the object is.
pub(crate) fn scene() -> Scene {
    let mut random = Random::new(41);
    let mut scene = Scene::default();
    for mesh in shapes() {
        scene.add_object(mesh);
    }
    scene.add_instance(0, Transform::IDENTITY);
    for index in 1..40 {
        scene.add_instance(index % 4, Transform::new(placement(&mut random)).unwrap());
    }
    scene.instances[7].mask = 2;
    scene
}

/// Rays through the scene; every fourth along an axis.
pub(crate) fn rays(count: usize, seed: u64) -> Vec<Ray> {
    let mut random = Random::new(seed);
    let ray = |index: usize| {
        let target = random.in_cube() * 3.0;
        let origin = if index.is_multiple_of(3) { random.in_cube() * 3.0 } else { random.direction() * 9.0 };
        let axis = DVec3::AXES[index % 3] * if index.is_multiple_of(8) { -1.0 } else { 1.0 };
        let dir = if index.is_multiple_of(4) { axis } else { target - origin };
        Ray::new(origin.as_vec3(), dir.as_vec3())
    };
    (0..count).map(ray).collect()
}

/// The closest hits by a walk.
pub(crate) fn closest(scene: &TwoLevel, walk: Walk, rays: &[Ray]) -> Vec<Hit> {
    match scene.trace(walk, Query::Closest, rays, TraceOptions::default()).unwrap().answer {
        Answer::Closest(hits) => hits,
        other => panic!("{other:?}"),
    }
}

/// Demands the same words.
pub(crate) fn assert_same(rays: &[Ray], given: &[Hit], wanted: &[Hit], what: &str) {
    assert_eq!(given.len(), wanted.len(), "{what}");
    for (index, (given, wanted)) in given.iter().zip(wanted).enumerate() {
        assert_eq!(given.to_words(), wanted.to_words(), "{what}: ray {index} {:?}", rays[index]);
    }
}
