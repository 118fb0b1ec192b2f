//! A structure that changes while it is traced: every frame sees one version, and the one that it should.

use crate::machine::on_every_adapter;
use crate::rays;
use crate::scenes::{instances, soup};
use ropewalk::glam::{Affine3A, Quat, Vec3};
use ropewalk::traversal_list::{Bounds, ListOptions};
use ropewalk::{
    Answer, BuildOptions, Hit, Instance, Query, Ray, Scene, Structure, TraceOptions, Transform, Walk,
    WideOptions,
};
use ropewalk_gpu::{GpuStructure, StructureVersions, Tracer};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

const FRAMES: usize = 100;

/// The scene of a frame: a soup that stays, and parts that turn and move, some with vertices that move too.
fn scene(frame: usize) -> Scene {
    let mut scene = Scene::default();
    let still = scene.add_object(soup(150));
    let mut wave = soup(40);
    for (index, position) in wave.positions.iter_mut().enumerate() {
        position.y += (index as f32 + frame as f32 * 0.3).sin() * 0.2;
    }
    let wave = scene.add_object(wave);
    scene.instances.push(Instance::new(still, Transform::IDENTITY));
    for part in 0..4 {
        let turn = Quat::from_rotation_z(frame as f32 * 0.05 + part as f32);
        let place = Vec3::new(part as f32 * 0.5 - 1.0, (frame as f32 * 0.1).cos() * 0.5, 0.2);
        let place = Affine3A::from_scale_rotation_translation(Vec3::splat(0.4), turn, place);
        scene.instances.push(Instance::new(wave, Transform::new(place).expect("it can be undone")));
    }
    scene
}

/// A structure for each frame.
type Versions = Vec<Arc<Structure>>;

fn built(build: impl Fn(&Scene) -> Structure, frames: usize) -> Versions {
    (0..frames).map(|frame| Arc::new(build(&scene(frame)))).collect()
}

/// Lists that are built once and then follow the scene.
fn updated(options: &ListOptions, frames: usize) -> Versions {
    let mut lists = scene(0).build_list(options).unwrap();
    (0..frames)
        .map(|frame| {
            lists.update(&scene(frame)).unwrap();
            Arc::new(Structure::List(lists.clone()))
        })
        .collect()
}

fn some_rays() -> Vec<Ray> {
    let mut random = rays::Random::new(21);
    let mut ray = || {
        let origin = random.vector() * 2.0;
        Ray::new(origin, random.vector() * 0.7 - origin)
    };
    (0..600).map(|_| ray()).collect()
}

/// The hits of a frame. In small tiles, so that what is written meanwhile has many places to come between.
fn frame(tracer: &Tracer, structure: &GpuStructure, walk: Walk, rays: &[Ray]) -> Vec<Hit> {
    let traced = tracer.trace(structure, walk, Query::Closest, rays, TraceOptions::default());
    let Answer::Closest(hits) = traced.unwrap().traced.answer else { panic!("closest was asked") };
    hits
}

/// What each frame shows when it is uploaded, waited for, and traced.
fn one_after_the_other(tracer: &Tracer, versions: &Versions, rays: &[Ray]) -> Vec<Vec<Hit>> {
    let hits = |version: &Arc<Structure>| {
        let uploaded = tracer.upload(version).unwrap();
        frame(tracer, &uploaded, version.kind().default_walk(), rays)
    };
    versions.iter().map(hits).collect()
}

/// The first frame that differs.
fn compare(expected: &[Vec<Hit>], frames: &[Vec<Hit>]) -> Result<(), String> {
    if expected.len() != frames.len() {
        return Err(format!("{} frames of {}", frames.len(), expected.len()));
    }
    match expected.iter().zip(frames).position(|(a, b)| a != b) {
        Some(frame) => Err(format!("frame {frame} differs")),
        None => Ok(()),
    }
}

/// Traces each frame while another thread uploads the next one; and the share of all versions that was sent.
fn overlapped(tracer: &Tracer, versions: &Versions, rays: &[Ray]) -> (Vec<Vec<Hit>>, f64) {
    let walk = versions[0].kind().default_walk();
    let changing = StructureVersions::new(tracer, &versions[0]).unwrap();
    let (mut frames, mut written, mut whole, mut new_sets) = (Vec::new(), 0, 0, 0);
    for index in 0..versions.len() {
        let current = changing.current();
        std::thread::scope(|scope| {
            let upload = versions.get(index + 1).map(|next| scope.spawn(|| changing.upload(next).unwrap()));
            frames.push(frame(tracer, &current, walk, rays));
            drop(current);
            if let Some(upload) = upload {
                let report = upload.join().unwrap();
                written += report.bytes_written;
                whole += report.bytes;
                new_sets += usize::from(report.is_new);
            }
        });
    }
    // The set of the frame before is free by now. It is left only where a version outgrows it, which then leaves room.
    let grows = versions.iter().any(|version| version.report().nodes != versions[0].report().nodes);
    assert!(new_sets >= 1 && new_sets <= if grows { 6 } else { 1 }, "{new_sets} new sets");
    (frames, written as f64 / whole as f64)
}

#[test]
fn every_frame_is_that_of_the_synchronous_run() {
    let plain = ListOptions { moving: Some(1), ..ListOptions::default() };
    let rays = some_rays();
    on_every_adapter(|machine| {
        let tracer = machine.tracer(|options| options.tile_rays = Some(100));
        for (versions, most_written) in [
            // What does not move is a layer of its own, and is sent once.
            (updated(&plain, FRAMES), 0.8),
            (updated(&ListOptions { bounds: Bounds::Aabb, ..plain }, 30), 0.8),
            (built(|scene| Structure::List(scene.build_list(&plain).unwrap()), 30), 1.0),
            (built(|scene| Structure::Bvh(scene.build(&BuildOptions::default()).unwrap()), 30), 1.0),
            (built(|scene| Structure::WideBvh(scene.build_wide(&WideOptions::default()).unwrap()), 30), 1.0),
        ] {
            let expected = one_after_the_other(&tracer, &versions, &rays);
            let different = expected.windows(2).filter(|pair| pair[0] != pair[1]).count();
            assert_eq!(different, versions.len() - 1, "each frame shows something new");
            let (frames, written) = overlapped(&tracer, &versions, &rays);
            assert_eq!(compare(&expected, &frames), Ok(()));
            assert!(written <= most_written, "{written} of all was sent");
        }
    });
}

/// With nobody waiting for anybody, each frame is still that of one version, and none of an earlier one than the frame
/// before.
#[test]
fn a_frame_never_mixes_versions() {
    let versions = updated(&ListOptions { moving: Some(1), ..ListOptions::default() }, FRAMES);
    let rays = some_rays();
    on_every_adapter(|machine| {
        let tracer = machine.tracer(|options| options.tile_rays = Some(100));
        let expected = one_after_the_other(&tracer, &versions, &rays);
        let changing = StructureVersions::new(&tracer, &versions[0]).unwrap();
        let done = AtomicBool::new(false);
        let shown = std::thread::scope(|scope| {
            scope.spawn(|| {
                for next in &versions[1..] {
                    changing.upload(next).unwrap();
                }
                done.store(true, Ordering::Release);
            });
            let mut shown = Vec::new();
            loop {
                let was_done = done.load(Ordering::Acquire);
                shown.push(frame(&tracer, &changing.current(), Walk::List, &rays));
                if was_done {
                    return shown;
                }
            }
        });
        let mut before = 0;
        for (index, hits) in shown.iter().enumerate() {
            let version = expected.iter().position(|expected| expected == hits);
            let version = version.unwrap_or_else(|| panic!("frame {index} is that of no version"));
            assert!(version >= before, "frame {index} shows version {version} after {before}");
            before = version;
        }
        assert_eq!(before, FRAMES - 1, "the last is shown in the end");
    });
}

/// The comparison objects to frames of two versions, of another one, and that are missing.
#[test]
fn mixed_frames_are_found() {
    let hit = |t| Hit { t, ..Hit::MISS };
    let expected = vec![vec![hit(1.0), hit(2.0)], vec![hit(3.0), hit(4.0)]];
    assert_eq!(compare(&expected, &expected), Ok(()));
    let mixed = vec![expected[0].clone(), vec![hit(1.0), hit(4.0)]];
    assert!(compare(&expected, &mixed).unwrap_err().contains("frame 1"));
    let late = vec![expected[0].clone(); 2];
    assert!(compare(&expected, &late).is_err());
    assert!(compare(&expected, &expected[..1]).is_err());
}

/// A version of any kind and size follows any other.
#[test]
fn versions_may_grow_and_change_their_kind() {
    let large = || instances();
    let list = |scene: Scene| Structure::List(scene.build_list(&ListOptions::default()).unwrap());
    let versions: Versions = [
        list(scene(0)),
        list(Scene::default()),
        list(large()),
        list(scene(1)),
        Structure::Bvh(large().build(&BuildOptions::default()).unwrap()),
        list(large()),
        Structure::WideBvh(scene(3).build_wide(&WideOptions::default()).unwrap()),
        Structure::Bvh(Scene::default().build(&BuildOptions::default()).unwrap()),
        list(scene(4)),
    ]
    .map(Arc::new)
    .into();
    let rays = some_rays();
    on_every_adapter(|machine| {
        let tracer = &machine.trusted;
        let expected = one_after_the_other(tracer, &versions, &rays);
        let changing = StructureVersions::new(tracer, &versions[0]).unwrap();
        for (index, version) in versions.iter().enumerate() {
            if index > 0 {
                let report = changing.upload(version).unwrap();
                assert!(report.bytes_written <= report.bytes);
            }
            let current = changing.current();
            assert!(current.bytes() > 0);
            let hits = frame(tracer, &current, version.kind().default_walk(), &rays);
            assert_eq!(hits, expected[index], "version {index}");
        }
    });
}
