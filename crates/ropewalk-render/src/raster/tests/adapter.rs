//! An adapter's hits: those of tracing but near edges, where each difference must be explained.

use super::scenes::{ball, camera, mirrors, scenes, specs};
use super::{Shot, chequer, first_difference, through_holes};
use crate::error::RenderError;
use crate::raster::adapter::AdapterDrawing;
use crate::raster::{Drawing, Request};
use crate::trace::Trace;
use glam::{Vec2, Vec3};
use ropewalk::two_level::TwoLevelOptions;
use ropewalk::{Answer, Hit, NoMonitor, Query, Ray, Scene, Status, StructureSpec, TraceOptions};
use ropewalk_gpu::{Device, DeviceChoice, adapters};
use ropewalk_scene::{Camera, load};
use std::path::Path;
use std::sync::Arc;

/// The software adapter, where there is one.
fn software_adapter() -> Option<Device> {
    let Some(found) = adapters().into_iter().find(|adapter| adapter.is_software) else {
        assert!(std::env::var_os("CI").is_none(), "there is no software adapter, and CI wants one");
        println!("skipped: there is no software adapter here");
        return None;
    };
    Some(Device::open(&DeviceChoice::GpuIndex(found.index)).expect("the adapter opens").device)
}

/// How far from where it should be a rasteriser may take a sample to be, in pixels: it snaps corners to a 256th.
const SNAP: f32 = 1.0 / 128.0;

/// Whether a drawn hit that differs lies within what a rasteriser rounds: a ray a little beside finds another triangle than the
/// traced one, so that an edge is near (through which, where a corner lies on another's edge, a gap may open), or both are as
/// good as equally far.
fn is_explained(tracer: &dyn Trace, shot: &Shot, place: usize, expected: &Hit, drawn: &Hit) -> bool {
    if (expected.t - drawn.t).abs() <= 1e-4 * expected.t.abs() {
        return true;
    }
    let samples = shot.subpixels.len();
    let pixel = shot.pixels.start + place / samples;
    let corner = Vec2::new((pixel % shot.width as usize) as f32, (pixel / shot.width as usize) as f32);
    let sample = corner + shot.subpixels[place % samples];
    let beside: Vec<Ray> = (0..25)
        .map(|step| Vec2::new((step % 5) as f32 - 2.0, (step / 5) as f32 - 2.0) * 0.5 * SNAP)
        .map(|step| shot.pinhole.ray(sample + step))
        .collect();
    let structure = tracer.structure().unwrap();
    let walk = structure.kind().default_walk();
    let traced = structure.trace(walk, Query::Closest, &beside, TraceOptions::default()).unwrap();
    let Answer::Closest(hits) = traced.answer else { panic!("another question was answered") };
    hits.iter().any(|hit| hit.id() != expected.id())
}

/// Draws by an adapter and tells how many hits differ, each of which must be explained.
fn differing(tracer: &dyn Trace, shot: &Shot) -> (usize, u64) {
    // A device's walks find what the processor's do: that is tested elsewhere, and takes long.
    let traced = shot.traced(tracer.structure().unwrap());
    let drawn = shot.drawn(tracer, None).unwrap();
    assert!(drawn.status.iter().all(|status| *status == Status::COMPLETE));
    let mut different = 0;
    for (place, (a, b)) in traced.iter().zip(&drawn.hits).enumerate() {
        if a.id() == b.id() {
            // Where the same triangle is named, the hit is the same to the bit.
            assert_eq!(a.to_words(), b.to_words(), "{:?}", shot.rays[place]);
        } else {
            different += 1;
            assert!(is_explained(tracer, shot, place, a, b), "{:?}: {a:?}, drawn {b:?}", shot.rays[place]);
        }
    }
    (different, drawn.traced_instead)
}

#[test]
fn an_adapter_draws_what_is_traced_but_for_edges() {
    let Some(device) = software_adapter() else { return };
    for (name, scene, camera) in scenes() {
        // Of both sides and of one, in one level and in two.
        for spec in specs().into_iter().skip(2).take(4) {
            let traceable = device.prepare(spec.build(&scene, &NoMonitor).unwrap()).unwrap();
            for samples in [1, 4] {
                let shot = Shot::new(&camera, [75, 61], samples);
                let (different, instead) = differing(&traceable, &shot);
                println!("{name}, {spec}, {samples}: {different} differ, {instead} traced instead");
                assert!(different * 50 <= shot.rays.len(), "{name}, {spec}: {different} differ");
            }
        }
    }
}

/// A scene beside the repository; `None`, with a word, where it is not there.
fn shared_scene(name: &str) -> Option<ropewalk_scene::Model> {
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/scenes")).join(name);
    if !path.exists() {
        println!("skipped: {name} is not there");
        return None;
    }
    Some(load::load(&path).expect("the scene is read"))
}

/// The camera of a file, or one that sees all of it.
fn camera_of(model: &ropewalk_scene::Model) -> Camera {
    let bounds = model.scene.bounds();
    let eye = bounds.center() + bounds.size().length() * Vec3::new(0.3, 0.3, 0.8);
    model.cameras.first().cloned().unwrap_or_else(|| camera(eye, bounds.center(), 45.0))
}

/// The paper's two rooms: by the processor to the bit, by an adapter but for few.
#[test]
fn the_rooms_of_the_paper_are_drawn() {
    let device = software_adapter();
    for name in ["bart_robot/Robot.aff", "bart_kitchen/kitchen.aff"] {
        let Some(model) = shared_scene(name) else { continue };
        let shot = Shot::new(&camera_of(&model), [256, 256], 1);
        for spec in [StructureSpec::default(), StructureSpec::TwoLevel(TwoLevelOptions::default())] {
            let structure = Arc::new(spec.build(&model.scene, &NoMonitor).unwrap());
            let traced = shot.traced(structure.as_ref());
            let drawn = shot.drawn(structure.as_ref(), None).unwrap();
            assert_eq!(first_difference(&shot, &traced, &drawn.hits), None, "{name}, {spec}");
            assert!(traced.iter().filter(|hit| hit.is_hit()).count() > 10_000);
            let Some(device) = &device else { continue };
            let traceable = device.prepare(structure).unwrap();
            let (different, instead) = differing(&traceable, &shot);
            println!("{name}, {spec}: {different} differ, {instead} traced instead");
            assert!(different < 256 * 256 / 200, "{name}, {spec}: {different} differ");
        }
    }
}

/// A wrong hit in the middle of a triangle is not explained by rounding.
#[test]
fn a_wrong_hit_is_not_explained() {
    let structure = StructureSpec::default().build(&Scene::from_mesh(ball(4)), &NoMonitor).unwrap();
    let shot = Shot::new(&camera(Vec3::Z * 3.0, Vec3::ZERO, 40.0), [40, 40], 1);
    let traced = shot.traced(&structure);
    let explained = (0..traced.len())
        .filter(|&place| traced[place].is_hit())
        .filter(|&place| is_explained(&structure, &shot, place, &traced[place], &Hit { t: 9.0, ..Hit::MISS }))
        .count();
    let hits = traced.iter().filter(|hit| hit.is_hit()).count();
    assert!(explained * 10 < hits, "{explained} of {hits}");
}

/// A picture in small pieces is that in one, several samples a pixel included.
#[test]
fn pieces_make_up_the_picture() {
    let Some(device) = software_adapter() else { return };
    let traceable = device.prepare(specs().swap_remove(4).build(&mirrors(), &NoMonitor).unwrap()).unwrap();
    let shot = Shot::new(&camera(Vec3::Z * 8.0, Vec3::ZERO, 40.0), [75, 61], 4);
    let drawing = Drawing::new(&traceable).unwrap();
    let mut adapter = AdapterDrawing::new(traceable.gpu().unwrap(), &drawing).unwrap();
    let request = Request {
        pinhole: &shot.pinhole,
        width: shot.width,
        pixels: shot.pixels.clone(),
        subpixels: &shot.subpixels,
        rays: &shot.rays,
        is_hole: None,
    };
    let trace = |rays: &[Ray]| {
        let walk = traceable.structure().kind().default_walk();
        traceable.trace_batch(walk, Query::Closest, rays, TraceOptions::default()).map_err(RenderError::Trace)
    };
    let whole = adapter.hits(&drawing, &request, &trace).unwrap();
    adapter.side = 16;
    let pieces = adapter.hits(&drawing, &request, &trace).unwrap();
    // Snapped corners lie elsewhere in a pixel of another target by less than its 256th.
    let different = whole.hits.iter().zip(&pieces.hits).filter(|(a, b)| a.id() != b.id()).count();
    assert!(different * 200 <= whole.hits.len(), "{different}");
    assert!(whole.hits.iter().filter(|hit| hit.is_hit()).count() > 1000);
}

/// Behind a hole the ray is traced, and what is behind it is found.
#[test]
fn an_adapter_sees_through_holes() {
    let Some(device) = software_adapter() else { return };
    let structure = Arc::new(StructureSpec::default().build(&mirrors(), &NoMonitor).unwrap());
    let traceable = device.prepare(Arc::clone(&structure)).unwrap();
    let shot = Shot::new(&camera(Vec3::Z * 8.0, Vec3::ZERO, 40.0), [60, 60], 1);
    let expected = through_holes(&structure, &shot.rays);
    let request = Request {
        pinhole: &shot.pinhole,
        width: shot.width,
        pixels: shot.pixels.clone(),
        subpixels: &shot.subpixels,
        rays: &shot.rays,
        is_hole: Some(&chequer),
    };
    let drawn = Drawing::new(&traceable)
        .unwrap()
        .hits(&request, &|rays| {
            // The filter is asked of hits alone: that of the test does not look at the ray.
            let keep = |hit: &Hit| !chequer(&rays[0], hit);
            let walk = structure.kind().default_walk();
            structure
                .trace_filtered(walk, Query::Closest, rays, TraceOptions::default(), &keep)
                .map_err(|error| RenderError::Trace(error.into()))
        })
        .unwrap();
    assert!(drawn.traced_instead > 50, "{}", drawn.traced_instead);
    let different = expected.iter().zip(&drawn.hits).filter(|(a, b)| a.id() != b.id()).count();
    assert!(different * 100 <= shot.rays.len(), "{different}");
}
