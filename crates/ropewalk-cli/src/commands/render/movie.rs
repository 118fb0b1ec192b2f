//! Pictures of a scene that moves: numbered frames, or one at a time.

use super::numbered::Numbered;
use super::provenance::metadata;
use super::{Arguments, summary};
use crate::device_argument;
use crate::failure::Failure;
use crate::light_argument::LightArgument;
use crate::output::{self, note};
use crate::progress::Progress;
use crate::{interrupt, structure};
use ropewalk_gpu::Device;
use ropewalk_render::{
    Frame, FrameJob, FrameStatistics, FramesError, Picture, RenderSettings, Stage, image_file, render_frames,
    structure_for_frames,
};
use ropewalk_scene::Animated;
use serde::Serialize;
use std::collections::BTreeSet;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// A line a frame: what it took, and where it is.
#[derive(Debug, Serialize)]
struct FrameRecord<'a> {
    #[serde(flatten)]
    statistics: &'a FrameStatistics,
    output: String,
}

impl From<FramesError> for Failure {
    fn from(error: FramesError) -> Self {
        match error {
            FramesError::Render(error) => error.into(),
            FramesError::Build(error) => error.into(),
            FramesError::Gpu(error) => error.into(),
            FramesError::Still => Self::usage(error),
            other => Self::failed(other),
        }
    }
}

/// A scene that was made ready, and the device for it.
pub(super) struct Prepared<'a> {
    pub(super) animated: &'a Animated,
    pub(super) stage: Stage,
    pub(super) settings: RenderSettings,
    pub(super) device: &'a Device,
}

impl<'a> Prepared<'a> {
    /// Builds the structure.
    fn job(self, arguments: &Arguments) -> Result<FrameJob<'a>, Failure> {
        let spec = arguments.structure.unwrap_or_else(|| structure_for_frames(self.animated));
        let structure = structure::build(&spec, self.stage.scene())?;
        structure::note_defects(&structure);
        Ok(FrameJob {
            animated: self.animated,
            stage: self.stage,
            spec,
            structure,
            device: self.device,
            settings: self.settings,
            keeps_lights: matches!(arguments.light, LightArgument::Point(_)),
        })
    }
}

/// Renders the frames that were asked for, each into a file of its own.
pub(super) fn frames(arguments: &Arguments, prepared: Prepared<'_>) -> Result<(), Failure> {
    let numbered = Numbered::new(&arguments.output)?;
    let frames = selected(arguments, prepared.animated)?;
    let device = prepared.device.to_string();
    let settings = prepared.settings.clone();
    let job = prepared.job(arguments)?;
    let progress = Progress::bar("rendering");
    let (mut done, mut unfinished) = (0, 0_u64);
    let mut notes = BTreeSet::new();
    if !arguments.json {
        output::print(summary::FRAME_HEADER)?;
    }
    // Ctrl-C is heard between frames: the one at hand is finished.
    render_frames(job, &frames, &|_, _| ControlFlow::Continue(()), |frame| {
        let Frame { picture, statistics } = frame;
        let file = numbered.file(statistics.frame);
        picture.save_with(&file, &metadata(arguments, &settings, &device, Some(statistics.time)))?;
        done += 1;
        unfinished += statistics.incomplete_rays;
        progress.set(done, frames.len());
        for text in &picture.notes {
            // A hundred frames have the same to say; numbers in it may differ.
            let gist: String = text.chars().filter(|character| !character.is_ascii_digit()).collect();
            if notes.insert(gist) {
                note(&format!("frame {}: {text}", statistics.frame));
            }
        }
        let record = FrameRecord { statistics: &statistics, output: file.display().to_string() };
        if arguments.json {
            output::print_json_line(&record)?;
        } else {
            output::print(&summary::frame_row(&statistics, &record.output))?;
        }
        Ok::<_, Failure>(interrupt::check())
    })?;
    drop(progress);
    if done < frames.len() {
        return Err(Failure::failed(format!(
            "stopped by ctrl-C: {done} of {} frames are finished",
            frames.len()
        )));
    }
    if unfinished > 0 {
        return Err(Failure::failed(format!(
            "the frames are not complete: {unfinished} samples are magenta"
        )));
    }
    Ok(())
}

/// The frames of this run, with their times.
fn selected(arguments: &Arguments, animated: &Animated) -> Result<Vec<(u32, f64)>, Failure> {
    let (Some(range), Some(span)) = (arguments.frames, animated.span()) else {
        return Err(FramesError::Still.into());
    };
    let mut frames = range.resolve(span)?;
    if let Some(shard) = arguments.shard {
        frames.retain(|&(frame, _)| shard.has(frame));
        if frames.is_empty() {
            note("none of the frames is in this share: there is nothing to do");
        }
    }
    Ok(frames)
}

/// Renders the one picture of a time.
pub(super) fn picture(
    arguments: &Arguments,
    prepared: Prepared<'_>,
    time: f64,
) -> Result<(Picture, Duration), Failure> {
    let job = prepared.job(arguments)?;
    let build_time = job.structure.report().flatten_time + job.structure.report().build_time;
    let progress = Progress::bar("rendering");
    let mut rendered = None;
    render_frames(job, &[(0, time)], &|done, total| progress.step(done, total), |frame| {
        rendered = Some(frame.picture);
        Ok::<_, Failure>(ControlFlow::Continue(()))
    })?;
    drop(progress);
    rendered
        .map(|picture| (picture, build_time))
        .ok_or_else(|| Failure::failed("stopped before the picture was begun: nothing was written"))
}

/// Where a run will write, known before any work is done: a file of the frames where there are several.
pub(super) fn probe(arguments: &Arguments) -> Result<PathBuf, Failure> {
    let path: &Path = &arguments.output;
    let path = if arguments.frames.is_some() { Numbered::new(path)?.file(0) } else { path.to_path_buf() };
    image_file::check(&path)?;
    Ok(path)
}

/// Opens the device that answers what a run asks.
pub(super) fn device(arguments: &Arguments, queries: &[ropewalk::Query]) -> Result<Device, Failure> {
    device_argument::open(&arguments.device, arguments.structure().kind(), arguments.walk(), queries)
}
