//! Frames, which follow one another, against pictures for which everything is made anew.

use crate::agreement::difference;
use crate::subject::{Subject, software};
use crate::{render, settings};
use ropewalk::NoMonitor;
use ropewalk_gpu::Device;
use ropewalk_render::{
    CameraChoice, Frame, FrameJob, FramesError, Picture, Primary, RenderSettings, render_frames,
    structure_for_frames,
};
use std::ops::ControlFlow;

/// The frames of some times, in this order, on a device.
fn frames(subject: &Subject, device: &Device, times: &[f64], settings: &RenderSettings) -> Vec<Frame> {
    let stage = subject.stage();
    let spec = structure_for_frames(&subject.animated);
    let structure = spec.build(stage.scene(), &NoMonitor).expect("the scene is sound");
    let animated = &subject.animated;
    let settings = settings.clone();
    let job = FrameJob { animated, stage, spec, structure, device, settings, keeps_lights: false };
    let numbered: Vec<(u32, f64)> = (0..).zip(times.iter().copied()).collect();
    let mut all = Vec::new();
    render_frames(job, &numbered, &|_, _| ControlFlow::Continue(()), |frame| {
        all.push(frame);
        Ok::<_, FramesError>(ControlFlow::Continue(()))
    })
    .unwrap_or_else(|error| panic!("{}: {error}", subject.name));
    all
}

/// How the frames of a scene must come about.
#[derive(Clone, Copy)]
struct Expected {
    moves: bool,
    deforms: bool,
    /// Whether a stage that is set for a pose is the one that was brought into it: where the file has its own camera and
    /// lights, so that neither is chosen by how large the scene is as the animation begins.
    is_set_alike: bool,
}

/// Renders frames forth and back on either device and compares each with a picture of a scene that was read, built and
/// prepared for it alone.
fn follow(name: &'static str, expected: Expected) {
    let Some(subject) = Subject::new(name) else { return };
    let times: Vec<f64> = subject.times(3).into_iter().flatten().collect();
    let [early, middle, late] = times[..] else { panic!("{name} does not move") };
    let order = [late, early, middle, early];
    let mut settings = settings();
    let on_processor = frames(&subject, &Device::Cpu, &order, &settings);
    if subject.animated.model().cameras.is_empty() {
        // Which is found by looking, once, as the animation begins.
        settings.camera = look(&on_processor[0].picture);
    }
    let mut anew = Vec::new();
    for &time in &order {
        let Some(subject) = Subject::new(name) else { return };
        let spec = structure_for_frames(&subject.animated);
        let (stage, structure) = subject.at(Some(time), spec);
        let picture = render(&stage, structure.as_ref(), &settings);
        if expected.is_set_alike {
            let (stage, structure) = subject.set_at(time, spec);
            let set = render(&stage, structure.as_ref(), &settings);
            if let Err(told) = difference(&picture, &set) {
                panic!("{name} at {time}: a stage in a pose and one that is set for it: {told}");
            }
        }
        anew.push(picture);
    }
    assert!(difference(&anew[1], &anew[0]).is_err(), "{name}: the comparison sees motion");
    let same = |frames: &[Frame], device: &str| {
        assert_eq!(frames.len(), order.len());
        for ((frame, wanted), time) in frames.iter().zip(&anew).zip(order) {
            if let Err(told) = difference(wanted, &frame.picture) {
                panic!("{name} at {time}: anew and as a frame on {device}: {told}");
            }
        }
        let moved: usize = frames.iter().map(|frame| frame.statistics.instances_moved).sum();
        let deformed: usize = frames
            .iter()
            .map(|frame| frame.statistics.objects_refitted + frame.statistics.objects_rebuilt)
            .sum();
        assert_eq!((moved > 0, deformed > 0), (expected.moves, expected.deforms), "{name} on {device}");
        println!(
            "{name}: {} frames on {device} are those that are made anew; {moved} instances moved, {deformed} objects deformed",
            order.len()
        );
    };
    same(&on_processor, "the processor");
    let drawn = RenderSettings { primary: Primary::Rasterised, ..settings.clone() };
    same(&frames(&subject, &Device::Cpu, &order, &drawn), "the processor, drawn");
    if let Some(device) = software() {
        same(&frames(&subject, device, &order, &settings), "the adapter");
    }
}

/// The camera of a picture.
fn look(picture: &Picture) -> CameraChoice {
    let camera = &picture.camera;
    CameraChoice::Look {
        eye: camera.position,
        target: camera.position + camera.forward,
        up: Some(camera.up),
        vertical_fov: Some(camera.vertical_fov),
    }
}

#[test]
fn robots_walk() {
    follow("bart_robot/Robot.aff", Expected { moves: true, deforms: false, is_set_alike: true });
}

#[test]
fn the_museums_sculpture_deforms() {
    follow("bart_museum/museum5.aff", Expected { moves: false, deforms: true, is_set_alike: true });
}

#[test]
fn the_fox_is_skinned() {
    follow("fox/Fox.glb", Expected { moves: false, deforms: true, is_set_alike: false });
}

#[test]
fn the_trucks_wheels_turn() {
    follow("milktruck/CesiumMilkTruck.glb", Expected { moves: true, deforms: false, is_set_alike: false });
}

#[test]
fn the_assembly_comes_apart() {
    follow("builtin:assembly", Expected { moves: true, deforms: false, is_set_alike: false });
}
