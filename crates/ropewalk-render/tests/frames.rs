//! Frames of a scene that moves, through the library.

use ropewalk::glam::{Affine3A, Vec3};
use ropewalk::{Mesh, NoMonitor, Scene};
use ropewalk_gpu::Device;
use ropewalk_render::{
    FrameJob, FrameStatistics, FramesError, Picture, RenderError, RenderSettings, Stage, StageOptions,
    render_frames, structure_for_frames,
};
use ropewalk_scene::animation::{GeometryShape, ObjectShape};
use ropewalk_scene::{Animated, Clip, Model, Motion, Pose, Span};
use std::ops::ControlFlow;
use std::sync::Arc;

/// A sheet that waves over a second one that slides, seen by nobody: the camera is found.
#[derive(Debug)]
struct Waves;

fn sheet(height: impl Fn(f32, f32) -> f32) -> Vec<Vec3> {
    let places = (0..9).flat_map(|x| (0..9).map(move |z| (x as f32 * 0.25 - 1.0, z as f32 * 0.25 - 1.0)));
    places.map(|(x, z)| Vec3::new(x, height(x, z), z)).collect()
}

impl Motion for Waves {
    fn pose(&self, _clip: usize, time: f64) -> Pose {
        let t = time as f32;
        // Without sines, which differ from machine to machine.
        let positions = sheet(|x, z| 0.4 * t * (x * x - z * x * t));
        Pose {
            time,
            transforms: vec![Affine3A::IDENTITY, Affine3A::from_translation(Vec3::new(0.3 * t, -0.5, 0.0))],
            visible: vec![true, t < 1.5],
            shapes: vec![ObjectShape {
                object: 0,
                geometries: vec![GeometryShape { positions, normals: None }],
            }],
            ..Pose::default()
        }
    }
}

fn waves() -> Animated {
    let triangles = (0..8_u32).flat_map(|x| {
        (0..8).flat_map(move |z| {
            let at = |x: u32, z: u32| 9 * x + z;
            [[at(x, z), at(x, z + 1), at(x + 1, z)], [at(x + 1, z), at(x, z + 1), at(x + 1, z + 1)]]
        })
    });
    let mesh = Mesh::new(sheet(|_, _| 0.0), triangles.collect());
    let mut scene = Scene::from_mesh(mesh.clone());
    let still = scene.add_object(mesh);
    scene.add_instance(still, Default::default());
    let clip = Clip { name: "waves".into(), span: Span { start: 0.0, end: 2.0, frames: 9 } };
    Animated::new(Model { scene, ..Model::default() }, vec![clip], Arc::new(Waves))
}

fn job<'a>(animated: &'a Animated, device: &'a Device) -> FrameJob<'a> {
    let stage = Stage::new(animated.model().clone(), &StageOptions::default());
    let spec = structure_for_frames(animated);
    let structure = spec.build(stage.scene(), &NoMonitor).unwrap();
    let settings = RenderSettings { width: 40, height: 30, samples: 1, ..RenderSettings::default() };
    FrameJob { animated, stage, spec, structure, device, settings, keeps_lights: false }
}

/// The pictures of some frames, up to so many.
fn render(frames: &[u32], most: usize) -> Vec<(Picture, FrameStatistics)> {
    let animated = waves();
    let span = animated.span().unwrap();
    let frames: Vec<(u32, f64)> = frames.iter().map(|&frame| (frame, span.time(frame))).collect();
    let mut finished = Vec::new();
    let progress = |_, _| ControlFlow::Continue(());
    render_frames::<FramesError>(job(&animated, &Device::Cpu), &frames, &progress, |frame| {
        finished.push((frame.picture, frame.statistics));
        Ok(if finished.len() < most { ControlFlow::Continue(()) } else { ControlFlow::Break(()) })
    })
    .unwrap();
    finished
}

#[test]
fn a_frame_is_the_same_after_whatever_came_before() {
    let all = render(&[0, 1, 2, 3, 4, 5, 6, 7, 8], 9);
    let back = render(&[8, 7, 3, 0], 4);
    for (picture, statistics) in &back {
        let (other, _) = &all[statistics.frame as usize];
        assert!(picture.film == other.film, "frame {}", statistics.frame);
        assert_eq!(picture.camera, all[0].0.camera, "nothing of the scene moves the camera");
    }
    assert!(
        all[0].0.film != all[1].0.film && all[5].0.film != all[7].0.film,
        "it moves, and a part is hidden"
    );
    for (index, (_, statistics)) in all.iter().enumerate() {
        assert_eq!((statistics.frame as usize, statistics.time), (index, 0.25 * index as f64));
        assert_eq!(statistics.primary_rays, 1200);
        let shapes = statistics.objects_refitted + statistics.objects_rebuilt;
        assert_eq!((shapes, statistics.instances_moved), if index == 0 { (0, 0) } else { (1, 1) });
    }
}

#[test]
fn the_work_ends_when_it_is_told_to() {
    let finished = render(&[4, 5, 6], 2);
    let frames: Vec<u32> = finished.iter().map(|(_, statistics)| statistics.frame).collect();
    assert_eq!(frames, [4, 5]);
    assert!(render(&[], 1).is_empty());
}

#[test]
fn what_cannot_be_rendered_is_an_error() {
    let animated = waves();
    let progress = |_, _| ControlFlow::Continue(());
    let each = |_| Ok(ControlFlow::Continue(()));
    let mut wrong = job(&animated, &Device::Cpu);
    wrong.settings.samples = 2;
    let error = render_frames::<FramesError>(wrong, &[(0, 0.0)], &progress, each).unwrap_err();
    assert!(matches!(error, FramesError::Render(RenderError::Samples { .. })), "{error}");
    let still = Animated::still(animated.model().clone());
    let error =
        render_frames::<FramesError>(job(&still, &Device::Cpu), &[(0, 0.0)], &progress, each).unwrap_err();
    assert!(matches!(error, FramesError::Still), "{error}");
}
