//! Frames of a scene that moves: each a pose, a structure that has followed it, and a picture.
//!
//! While a frame is rendered, the next one's pose is worked out, its structure brought up to date and what changed sent to the
//! device; what is rendered keeps its own version of all three. Where there is one thread, one comes after the other.
//!
//! **Invariants.** A frame's picture depends on its time alone, not on which frames were rendered before it or beside it: many
//! machines can share the frames of an animation. The camera of a scene without one is chosen once, for the scene as the
//! animation begins.

mod error;
mod pose;
mod statistics;
mod structure;

pub use error::FramesError;
pub use statistics::{FrameStatistics, resident_bytes};

use crate::camera::{self, CameraChoice};
use crate::error::RenderError;
use crate::kept::Kept;
use crate::picture::Picture;
use crate::renderer::Renderer;
use crate::settings::RenderSettings;
use crate::stage::Stage;
use ropewalk::two_level::{BottomSpec, Bottoms, TwoLevelOptions};
use ropewalk::{BuildOptions, Structure, StructureSpec};
use ropewalk_gpu::{Device, Moving, Traceable};
use ropewalk_scene::{Animated, Pose};
use statistics::milliseconds;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::time::{Duration, Instant};
use structure::Follower;

/// What frames are rendered of, and how.
pub struct FrameJob<'a> {
    /// What moves.
    pub animated: &'a Animated,
    /// The stage set for its model as the clip begins.
    pub stage: Stage,
    /// How the structure is built.
    pub spec: StructureSpec,
    /// The structure over the stage.
    pub structure: Structure,
    /// Where rays are traced.
    pub device: &'a Device,
    /// How each frame is rendered.
    pub settings: RenderSettings,
    /// Whether the lights of the stage stay as they are, whatever the poses say of lights.
    pub keeps_lights: bool,
}

/// A frame that is finished.
#[derive(Clone, Debug)]
pub struct Frame {
    /// Its picture.
    pub picture: Picture,
    /// What it took.
    pub statistics: FrameStatistics,
}

/// A frame that can be rendered.
struct Prepared {
    pose: Pose,
    traceable: Traceable,
    statistics: FrameStatistics,
}

/// What prepares frames.
struct Preparation<'a> {
    animated: &'a Animated,
    follower: Follower,
    moving: Moving,
    keeps_lights: bool,
}

impl Preparation<'_> {
    fn prepare(&mut self, frame: u32, time: f64) -> Result<Prepared, FramesError> {
        let clock = Instant::now();
        let mut pose = self.animated.pose(time).ok_or(FramesError::Still)?;
        if self.keeps_lights {
            pose.lights.clear();
        }
        let (structure, followed) = self.follower.follow(&pose)?;
        let mut statistics = FrameStatistics { frame, time, ..FrameStatistics::default() };
        statistics.follow(followed, clock.elapsed());
        let clock = Instant::now();
        let (traceable, upload) = self.moving.advance(structure)?;
        if let Some(upload) = upload {
            statistics.upload_bytes = upload.bytes_written;
            statistics.upload_ms = milliseconds(clock.elapsed());
        }
        Ok(Prepared { pose, traceable, statistics })
    }
}

/// The structure that suits frames of a scene: two levels, whose objects are BVHs, since these follow what deforms; in oriented
/// boxes where nothing does, since what lies in such a box cannot be refitted without a trace.
#[must_use]
pub fn structure_for_frames(animated: &Animated) -> StructureSpec {
    let deforms = animated
        .span()
        .and_then(|span| animated.pose(span.start))
        .is_some_and(|pose| !pose.shapes.is_empty());
    StructureSpec::TwoLevel(TwoLevelOptions {
        bottoms: Bottoms::Each(BottomSpec::Bvh(BuildOptions::default())),
        oriented: !deforms,
        ..TwoLevelOptions::default()
    })
}

/// Renders frames, each with its number and time, in this order. `progress` hears of each picture as
/// [`Renderer::render`] tells it; `each` is given each frame that is finished, and may end the work.
///
/// # Errors
/// When the scene stands still, a setting is out of range, a structure cannot be built, or the device fails. The frames
/// before were given to `each`.
pub fn render_frames<E: From<FramesError>>(
    job: FrameJob<'_>,
    frames: &[(u32, f64)],
    progress: &(dyn Fn(usize, usize) -> ControlFlow<()> + Sync),
    mut each: impl FnMut(Frame) -> Result<ControlFlow<()>, E>,
) -> Result<(), E> {
    let FrameJob { animated, mut stage, spec, structure, device, mut settings, keeps_lights } = job;
    let span = animated.span().ok_or(FramesError::Still)?;
    let start = animated.pose(span.start).ok_or(FramesError::Still)?;
    let deforming: Vec<u32> = start.shapes.iter().map(|shape| shape.object).collect();
    let follower = Follower::new(spec, &structure, stage.scene(), &deforming);
    let (moving, first) = device.prepare_moving(Arc::new(structure)).map_err(FramesError::from)?;
    settings.camera = fixed_camera(&settings, &stage, &first).map_err(FramesError::from)?;
    drop(first);
    let mut preparation = Preparation { animated, follower, moving, keeps_lights };
    let kept = Kept::default();
    let mut remaining = frames.iter().copied().peekable();
    let Some((frame, time)) = remaining.next() else { return Ok(()) };
    let mut next = Some(preparation.prepare(frame, time));
    while let Some(prepared) = next.take() {
        let Prepared { pose, traceable, mut statistics } = prepared?;
        stage.pose(&pose);
        let following = remaining.next();
        let render = || {
            let clock = Instant::now();
            let picture = Renderer::new(&stage, &traceable).keeping(&kept).render(&settings, progress);
            (picture, clock.elapsed())
        };
        let prepare = || following.map(|(frame, time)| preparation.prepare(frame, time));
        let ((picture, duration), prepared): ((Result<Picture, RenderError>, Duration), _) =
            rayon::join(render, prepare);
        // The device's buffers are free for the frame after the next.
        drop(traceable);
        let picture = picture.map_err(FramesError::from)?;
        statistics.render(&picture.statistics, duration);
        statistics.resident_bytes = resident_bytes();
        next = prepared;
        if each(Frame { picture, statistics })?.is_break() {
            break;
        }
    }
    Ok(())
}

/// A camera of the file moves as the file says; one that is found by looking at the scene is found once.
fn fixed_camera(
    settings: &RenderSettings,
    stage: &Stage,
    traceable: &Traceable,
) -> Result<CameraChoice, RenderError> {
    let of_file = match &settings.camera {
        CameraChoice::OfFile(_) | CameraChoice::Look { .. } => true,
        CameraChoice::Automatic => !stage.model().cameras.is_empty(),
        CameraChoice::Frame(_) | CameraChoice::Inside { .. } => false,
    };
    if of_file {
        return Ok(settings.camera.clone());
    }
    let aspect = (f64::from(settings.width) / f64::from(settings.height)) as f32;
    let camera = camera::resolve(&settings.camera, stage, traceable, settings.walk, aspect)?;
    Ok(CameraChoice::Look {
        eye: camera.position,
        target: camera.position + camera.forward,
        up: Some(camera.up),
        vertical_fov: Some(camera.vertical_fov),
    })
}
