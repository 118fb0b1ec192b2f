//! `ropewalk render`: a scene to a picture, or a scene that moves to frames.

mod arguments;
mod frame_range;
mod interim;
mod movie;
mod numbered;
mod provenance;
mod summary;
mod values;

pub(crate) use arguments::Arguments;

use crate::device_argument;
use crate::failure::Failure;
use crate::output::{self, note};
use crate::progress::Progress;
use crate::{interrupt, structure, threads};
use interim::Interim;
use movie::Prepared;
use provenance::metadata;
use ropewalk::Query;
use ropewalk_gpu::Device;
use ropewalk_render::{Film, ImageError, Picture, RenderError, RenderSettings, Renderer, View, image_file};
use std::time::{Duration, Instant};
use summary::Summary;

impl From<RenderError> for Failure {
    fn from(error: RenderError) -> Self {
        match error {
            RenderError::Size { .. }
            | RenderError::Samples { .. }
            | RenderError::Setting { .. }
            | RenderError::Camera(_)
            | RenderError::Word(_) => Self::usage(error),
            _ => Self::failed(error),
        }
    }
}

impl From<ImageError> for Failure {
    fn from(error: ImageError) -> Self {
        match error {
            ImageError::UnknownExtension { .. } => Self::usage(error),
            _ => Self::failed(error),
        }
    }
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let settings = arguments.settings();
    settings.check()?;
    arguments.scene.check()?;
    let file = movie::probe(arguments)?;
    if arguments.layers && image_file::check(&file)? != image_file::ImageFormat::Exr {
        let what = "a PNG has no layers; name a file that ends in .exr, or leave --layers out";
        return Err(Failure::usage(format!("{}: {what}", file.display())));
    }
    let queries =
        if settings.view == View::Shaded { &[Query::Closest, Query::Any][..] } else { &[Query::Closest] };
    let device = movie::device(arguments, queries)?;
    interrupt::listen()?;
    threads::run(arguments.threads, || {
        if arguments.moves() {
            moving(arguments, settings, &device)
        } else {
            still(arguments, settings, &device)
        }
    })
}

/// Renders a scene as it stands.
fn still(arguments: &Arguments, mut settings: RenderSettings, device: &Device) -> Result<(), Failure> {
    let start = Instant::now();
    let mut scene = arguments.scene.load()?;
    scene.note_defects();
    settings.light = arguments.light.choose(&mut scene.model);
    settings.integrator = arguments.integrator_for(&scene.model);
    let stage = arguments.stage(scene.model)?;
    let built = structure::build(&arguments.structure(), stage.scene())?;
    structure::note_defects(&built);
    let build_time = built.report().flatten_time + built.report().build_time;
    let traceable = device_argument::prepare(&arguments.device, device, built)?;
    let progress = Progress::bar("rendering");
    let device = traceable.device().to_string();
    let interim = Interim::new(arguments, metadata(arguments, &settings, &device, None));
    let show = |film: &Film, rows: u32| {
        if let Some(interim) = &interim {
            interim.offer(film, rows);
        }
    };
    let renderer = Renderer::new(&stage, &traceable).showing(&show);
    let picture = renderer.render(&settings, &|done, total| progress.step(done, total))?;
    drop(progress);
    finish(
        arguments,
        &settings,
        &picture,
        &Took { start, load: scene.time, build: build_time, device, time: None },
    )
}

/// Renders a scene that moves: its frames, or the picture of a time.
fn moving(arguments: &Arguments, mut settings: RenderSettings, device: &Device) -> Result<(), Failure> {
    let start = Instant::now();
    let (mut animated, load) = arguments.scene.load_animated()?;
    if let Some(clip) = &arguments.clip {
        animated.choose_clip(clip)?;
    }
    let Some(span) = animated.span() else {
        let what = "the scene stands still; leave --frames, --time and --clip out";
        return Err(Failure::usage(format!("{}: {what}", arguments.scene)));
    };
    let mut model = animated.take_model();
    settings.light = arguments.light.choose(&mut model);
    settings.integrator = arguments.integrator_for(&model);
    let stage = arguments.stage(model)?;
    let prepared = Prepared { animated: &animated, stage, settings: settings.clone(), device };
    if arguments.frames.is_some() {
        return movie::frames(arguments, prepared);
    }
    let time = arguments.time.unwrap_or(span.start);
    let (picture, build) = movie::picture(arguments, prepared, time)?;
    let device = device.to_string();
    finish(arguments, &settings, &picture, &Took { start, load, build, device, time: Some(time) })
}

/// What a picture took, and where it was made.
struct Took {
    start: Instant,
    load: Duration,
    build: Duration,
    device: String,
    /// The time that the picture shows, of a scene that moves.
    time: Option<f64>,
}

/// Writes a picture and tells what was done.
fn finish(
    arguments: &Arguments,
    settings: &RenderSettings,
    picture: &Picture,
    took: &Took,
) -> Result<(), Failure> {
    picture.notes.iter().for_each(|text| note(text));
    if picture.partial && picture.finished_rows == 0 {
        return Err(Failure::failed("stopped by ctrl-C before a row was finished: nothing was written"));
    }
    picture.save_with(&arguments.output, &metadata(arguments, settings, &took.device, took.time))?;
    let mut summary = Summary::new(arguments, settings, picture);
    summary.load_seconds = took.load.as_secs_f64();
    summary.build_seconds = took.build.as_secs_f64();
    summary.total_seconds = took.start.elapsed().as_secs_f64();
    summary.device.clone_from(&took.device);
    if arguments.json {
        output::print_json(&summary)?;
    } else {
        output::print(&summary.to_text())?;
    }
    verdict(arguments, picture)
}

/// A picture that is not what was asked for is a failure, though it was written.
fn verdict(arguments: &Arguments, picture: &Picture) -> Result<(), Failure> {
    let output = arguments.output.display();
    if picture.partial {
        return Err(Failure::failed(format!(
            "stopped by ctrl-C: {output} holds the {} of {} rows that are finished",
            picture.finished_rows, arguments.size.height
        )));
    }
    let incomplete = &picture.statistics.incomplete;
    if !incomplete.is_none() {
        return Err(Failure::failed(format!(
            "{output} is not complete: {} samples are magenta",
            incomplete.rays
        )));
    }
    Ok(())
}
