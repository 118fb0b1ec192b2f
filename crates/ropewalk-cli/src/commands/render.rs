//! `ropewalk render`: a scene to a picture.

mod summary;

use crate::device_argument::{self, DEVICE_HELP, DEVICE_LONG_HELP};
use crate::failure::Failure;
use crate::light_argument::LightArgument;
use crate::output::{self, note};
use crate::progress::Progress;
use crate::scene_argument::{DEFAULT_SCENE, SceneArgument, scene_help};
use crate::threads::MOST_THREADS;
use crate::{interrupt, structure, threads};
use clap::Args;
use clap::builder::{OsStringValueParser, TypedValueParser};
use ropewalk::{Query, StructureSpec, Walk};
use ropewalk_gpu::DeviceChoice;
use ropewalk_render::{
    CameraChoice, Ground, ImageError, Picture, RenderError, RenderSettings, Renderer, Stage, StageOptions,
    View, image_file,
};
use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;
use std::time::Instant;
use summary::Summary;

const EXAMPLES: &str = "\
Cameras:
  auto                        the file's first camera, else as frame
  frame[:azimuth=DEG,elevation=DEG,fov=DEG]
                              everything framed from outside, from this side
  inside[:fov=DEG]            from within a building
  look:eye=X/Y/Z,target=X/Y/Z[,up=X/Y/Z][,fov=DEG]
                              from a point to a point
  NAME or NUMBER              a camera of the file
Coordinates are those in which `ropewalk info` shows the bounds.

Examples:
  ropewalk render -o demo.png
  ropewalk render gearbox.glb -o gearbox.png --size 1920x1080 --device gpu
  ropewalk render house.obj -o hall.exr --camera inside --exposure 1
  ropewalk render bunny.ply -o cost.png --view visits

ctrl-C keeps the rows that are finished.";

/// The arguments of `ropewalk render`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    #[arg(value_name = "SCENE", help = scene_help(), default_value = DEFAULT_SCENE)]
    #[arg(value_parser = OsStringValueParser::new().map(SceneArgument::from))]
    scene: SceneArgument,
    /// The picture: .png (8-bit sRGB) or .exr (32-bit linear, with depth)
    #[arg(short, long, value_name = "FILE", default_value = "ropewalk.png")]
    output: PathBuf,
    /// Width and height in pixels
    #[arg(long, value_name = "WIDTHxHEIGHT", default_value_t)]
    size: Size,
    /// Samples a pixel: a square number, such as 1, 4, 9, 16
    #[arg(long, value_name = "N", default_value_t = RenderSettings::default().samples)]
    samples: u32,
    #[arg(long, value_name = "DEVICE", default_value_t, help = DEVICE_HELP, long_help = DEVICE_LONG_HELP)]
    device: DeviceChoice,
    /// What is built; see `ropewalk list`
    #[arg(long, value_name = "NAME[:key=value,...]", default_value_t)]
    structure: StructureSpec,
    /// How rays go through it; see `ropewalk list`; by default the best for the structure
    #[arg(long, value_name = "NAME[:key=value,...]")]
    walk: Option<Walk>,
    /// From where: auto, frame:..., inside:..., look:..., or a camera of the file; see below
    #[arg(long, value_name = "CAMERA", default_value = "auto")]
    camera: CameraChoice,
    /// What the picture shows: shaded, normals, depth, ids, or visits (the cost of each pixel)
    #[arg(long, value_name = "VIEW", default_value_t)]
    view: View,
    /// The light: auto, sun:X/Y/Z (the way its light shines) or point:X/Y/Z (where it is)
    #[arg(long, value_name = "LIGHT", default_value = "auto")]
    light: LightArgument,
    /// A ground that catches the shadow: on, off, or auto (where the scene has none)
    #[arg(long, value_name = "GROUND", default_value_t)]
    ground: Ground,
    /// Stops of exposure: 1 is twice as bright
    #[arg(long, value_name = "STOPS", default_value_t = 0.0, allow_negative_numbers = true)]
    exposure: f32,
    /// What is up in the scene: x, y, z, -x, -y or -z; by default what the file says
    #[arg(long, value_name = "AXIS", allow_hyphen_values = true)]
    up: Option<Up>,
    /// Threads of the CPU; all of them by default
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=MOST_THREADS))]
    threads: Option<u16>,
    /// Print the statistics as one JSON document
    #[arg(long)]
    json: bool,
}

/// The size of a picture. Whether it can be made is the renderer's to say.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Size {
    width: u32,
    height: u32,
}

impl Default for Size {
    fn default() -> Self {
        let RenderSettings { width, height, .. } = RenderSettings::default();
        Self { width, height }
    }
}

impl fmt::Display for Size {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}x{}", self.width, self.height)
    }
}

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let side = |text: &str| text.trim().parse().ok();
        text.split_once(['x', 'X'])
            .and_then(|(width, height)| Some(Self { width: side(width)?, height: side(height)? }))
            .ok_or_else(|| "a size is written WIDTHxHEIGHT, such as 1280x720".into())
    }
}

/// An axis of the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Up(glam::Vec3);

impl FromStr for Up {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text.strip_prefix(['-', '+']).unwrap_or(text) {
            "x" | "X" => Ok(glam::Vec3::X),
            "y" | "Y" => Ok(glam::Vec3::Y),
            "z" | "Z" => Ok(glam::Vec3::Z),
            _ => Err("it can be x, y, z, -x, -y or -z".to_owned()),
        }
        .map(|axis| Self(if text.starts_with('-') { -axis } else { axis }))
    }
}

impl From<RenderError> for Failure {
    fn from(error: RenderError) -> Self {
        match error {
            RenderError::Memory { .. } | RenderError::Trace(_) => Self::failed(error),
            _ => Self::usage(error),
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
    let mut settings = arguments.settings();
    settings.check()?;
    arguments.scene.check()?;
    image_file::check(&arguments.output)?;
    let queries =
        if settings.view == View::Shaded { &[Query::Closest, Query::Any][..] } else { &[Query::Closest] };
    let device =
        device_argument::open(&arguments.device, arguments.structure.kind(), arguments.walk(), queries)?;
    interrupt::listen()?;
    threads::run(arguments.threads, || {
        let start = Instant::now();
        let mut scene = arguments.scene.load()?;
        scene.note_defects();
        settings.light = arguments.light.choose(&mut scene.model);
        let load_time = scene.time;
        let options =
            StageOptions { ground: arguments.ground, up: arguments.up.map(|up| up.0), ..Default::default() };
        let stage = Stage::new(scene.model, &options);
        if stage.bounds().is_empty() {
            let what = "it has no triangle that could be seen: there is nothing to render";
            return Err(Failure::failed(format!("{}: {what}", arguments.scene)));
        }
        let built = structure::build(&arguments.structure, stage.scene())?;
        structure::note_defects(&built);
        let build_time = built.report().flatten_time + built.report().build_time;
        let traceable = device_argument::prepare(&arguments.device, &device, built)?;
        let progress = Progress::bar("rendering");
        let picture =
            Renderer::new(&stage, &traceable).render(&settings, &|done, total| progress.step(done, total))?;
        drop(progress);
        picture.notes.iter().for_each(|text| note(text));
        if picture.partial && picture.finished_rows == 0 {
            return Err(Failure::failed("stopped by ctrl-C before a row was finished: nothing was written"));
        }
        picture.save(&arguments.output)?;
        let mut summary = Summary::new(arguments, &picture);
        summary.load_seconds = load_time.as_secs_f64();
        summary.build_seconds = build_time.as_secs_f64();
        summary.total_seconds = start.elapsed().as_secs_f64();
        summary.device = traceable.device().to_string();
        if arguments.json {
            output::print_json(&summary)?;
        } else {
            output::print(&summary.to_text())?;
        }
        verdict(arguments, &picture)
    })
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

impl Arguments {
    /// The walk that was asked for, or the best for the structure.
    fn walk(&self) -> Walk {
        self.walk.unwrap_or(self.structure.kind().default_walk())
    }

    fn settings(&self) -> RenderSettings {
        RenderSettings {
            width: self.size.width,
            height: self.size.height,
            samples: self.samples,
            view: self.view,
            walk: self.walk(),
            camera: self.camera.clone(),
            light: self.light.checked(),
            exposure: self.exposure,
            ..RenderSettings::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_and_axes_are_read() {
        assert_eq!("640x480".parse(), Ok(Size { width: 640, height: 480 }));
        for bad in ["", "640", "640x", "x480", "640x480x3", "-1x5", "99999999999x1", "a x b"] {
            assert!(bad.parse::<Size>().is_err(), "{bad}");
        }
        assert_eq!("-z".parse(), Ok(Up(glam::Vec3::NEG_Z)));
        assert_eq!("y".parse(), Ok(Up(glam::Vec3::Y)));
        assert!("up".parse::<Up>().is_err() && "--x".parse::<Up>().is_err());
    }
}
