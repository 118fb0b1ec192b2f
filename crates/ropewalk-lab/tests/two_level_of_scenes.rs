//! Two levels over a whole scene that moves: the built-in assembly, a thousand frames.

use ropewalk::glam::{Affine3A, DVec3, EulerRot, Quat, Vec3};
use ropewalk::two_level::{BackgroundBuild, BottomSpec, TopUpdate, TwoLevelOptions};
use ropewalk::{Aabb, Hit, Instance, Object, Ray, Scene, Transform, TwoLevel};
use ropewalk_scene::builtin::builtin;
use ropewalk_testkit::random::Random;

fn rays(bounds: &Aabb, count: usize, random: &mut Random) -> Vec<Ray> {
    let ray = |_| {
        let (origin, target): (DVec3, DVec3) = (random.in_box(bounds, 1.2), random.in_box(bounds, 0.8));
        Ray::new(origin.as_vec3(), (target - origin).as_vec3())
    };
    (0..count).map(ray).collect()
}

fn closest(scene: &TwoLevel, rays: &[Ray]) -> Vec<[u32; 7]> {
    let mut hits = vec![Hit::MISS; rays.len()];
    scene.closest_batch(rays, &mut hits);
    hits.iter().map(Hit::to_words).collect()
}

/// Where a part is moved to: it turns about its own middle and shifts a little.
fn moved(instance: &Instance, bounds: &Aabb, random: &mut Random) -> Affine3A {
    let mut between = |low: f64, high: f64| random.between(low, high) as f32;
    let turn = Quat::from_euler(EulerRot::XYZ, between(-0.4, 0.4), between(-0.4, 0.4), between(-0.4, 0.4));
    let shift = Vec3::new(between(-0.05, 0.05), between(-0.05, 0.05), between(-0.05, 0.05)) * bounds.size();
    let middle = instance.transform.point(bounds.center());
    Affine3A::from_translation(middle + shift)
        * Affine3A::from_quat(turn)
        * Affine3A::from_translation(-middle)
        * *instance.transform.to_world()
}

/// A shape of the object for each version: it grows a little each time.
fn shape(object: &Object, version: usize) -> Object {
    let mut shape = object.clone();
    let positions = shape.geometries.iter_mut().flat_map(|mesh| &mut mesh.positions);
    positions.for_each(|position| *position *= 1.0 + 0.01 * (version % 20) as f32);
    shape
}

/// Each frame's hits are those of a scene that is put together from scratch, while the structure of one of the objects is
/// being built in the background again and again; and every hundredth frame's those of a scene of which every structure is
/// built from scratch.
#[test]
fn a_thousand_frames_of_the_assembly() {
    let model = builtin("assembly").unwrap();
    let mut plain: Scene = model.scene;
    let options = TwoLevelOptions::default();
    let mut scene = plain.build_two_level(&options).unwrap();
    let original = plain.objects[0].clone();
    let mut random = Random::new(2026);
    let mut build = BackgroundBuild::start(shape(&original, 1), BottomSpec::default(), options.oriented);
    let (mut version, mut swaps, mut hits) = (1, 0, 0);
    let start: Vec<Instance> = plain.instances.clone();
    let frames = 1000;
    for frame in 0..frames {
        for _ in 0..5 {
            let index = random.below(plain.instances.len());
            let bounds = plain.objects[start[index].object as usize].bounds();
            let to_world = moved(&start[index], &bounds, &mut random);
            scene.set_transform(index as u32, to_world).unwrap();
            plain.instances[index].transform = Transform::new(to_world).unwrap();
        }
        // What was built comes into the scene between two frames, or not yet.
        if let Some(built) = build.poll() {
            scene.adopt_object(0, built.unwrap()).unwrap();
            plain.objects[0] = shape(&original, version);
            version += 1;
            swaps += 1;
            build =
                BackgroundBuild::start(shape(&original, version), BottomSpec::default(), options.oriented);
        }
        let update = [TopUpdate::Rebuild, TopUpdate::Refit, TopUpdate::Restructure][frame % 3];
        scene.commit(update).unwrap();
        let rays = rays(&scene.bounds(), 150, &mut random);
        let given = closest(&scene, &rays);
        let instances = plain.instances.iter().copied().map(Some).collect();
        let fresh = TwoLevel::assemble(options, scene.objects().to_vec(), instances).unwrap();
        assert_eq!(given, closest(&fresh, &rays), "frame {frame}");
        if frame % 100 == 99 {
            let fresh = plain.build_two_level(&options).unwrap();
            assert_eq!(given, closest(&fresh, &rays), "frame {frame}, every structure built anew");
            scene.validate().unwrap();
        }
        hits += given.iter().filter(|words| **words != Hit::MISS.to_words()).count();
    }
    println!("{frames} frames, {swaps} structures came from the background, {hits} hits");
    assert!(hits > frames * 50 && swaps > 0);
}
