//! The arguments of `ropewalk render`, and what they mean together.

use super::frame_range::{FrameRange, Shard};
use super::provenance::Provenance;
use super::values::{Size, Up, finite};
use crate::device_argument::{DEVICE_HELP, DEVICE_LONG_HELP};
use crate::failure::Failure;
use crate::light_argument::LightArgument;
use crate::scene_argument::{DEFAULT_SCENE, SceneArgument, scene_help};
use crate::threads::MOST_THREADS;
use clap::Args;
use clap::builder::{OsStringValueParser, TypedValueParser};
use ropewalk::two_level::TwoLevelOptions;
use ropewalk::{StructureSpec, Walk};
use ropewalk_gpu::DeviceChoice;
use ropewalk_render::{
    CameraChoice, Ground, Integrator, Primary, RenderSettings, Stage, StageOptions, TreeOrder, TreeSettings,
    View,
};
use ropewalk_scene::Model;
use std::path::PathBuf;

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

Scenes that move (AFF, glTF with animations, builtin:assembly):
  --time 2.5                  one picture, of this time
  --frames 0..100             frames 0 to 99, each in a file of its own;
                              also A..=B, A.., ..B, .. (all) and N
  -o walk.png                 walk.0000.png, walk.0001.png, ...
  -o 'walk_%06d.png'          walk_000000.png, ...; ###### means the same
  --frames .. --shard 3/8     each frame that divided by 8 leaves 3: for the
                              fourth of eight machines
  --clip Walk                 the clip of this name or number; else the first
With --json each frame prints one line of JSON when it is finished.

Examples:
  ropewalk render -o demo.png
  ropewalk render gearbox.glb -o gearbox.png --size 1920x1080 --device gpu
  ropewalk render house.obj -o hall.exr --camera inside --exposure 1
  ropewalk render bunny.ply -o cost.png --view visits
  ropewalk render Robot.aff -o robots.png --frames 0..100 --size 512x512

ctrl-C keeps the rows that are finished; of several frames it finishes the one
at hand.";

/// The arguments of `ropewalk render`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    #[arg(value_name = "SCENE", help = scene_help(), default_value = DEFAULT_SCENE)]
    #[arg(value_parser = OsStringValueParser::new().map(SceneArgument::from))]
    pub(super) scene: SceneArgument,
    /// The picture: .png (8-bit sRGB) or .exr (32-bit linear, with depth); with --frames numbered, see below
    #[arg(short, long, value_name = "FILE", default_value = "ropewalk.png")]
    pub(super) output: PathBuf,
    /// Width and height in pixels
    #[arg(long, value_name = "WIDTHxHEIGHT", default_value_t)]
    pub(super) size: Size,
    /// Samples a pixel: a square number, such as 1, 4, 9, 16
    #[arg(long, value_name = "N", default_value_t = RenderSettings::default().samples)]
    pub(super) samples: u32,
    #[arg(long, value_name = "DEVICE", default_value_t, help = DEVICE_HELP, long_help = DEVICE_LONG_HELP)]
    pub(super) device: DeviceChoice,
    /// What is built; see `ropewalk list`; by default bvh, and for scenes that move two-level
    /// with bottom=bvh
    #[arg(long, value_name = "NAME[:key=value,...]")]
    pub(super) structure: Option<StructureSpec>,
    /// How rays go through it; see `ropewalk list`; by default the best for the structure
    #[arg(long, value_name = "NAME[:key=value,...]")]
    pub(super) walk: Option<Walk>,
    /// From where: auto, frame:..., inside:..., look:..., or a camera of the file; see below
    #[arg(long, value_name = "CAMERA", default_value = "auto")]
    pub(super) camera: CameraChoice,
    /// What the picture shows: shaded, normals, depth, ids, or visits (the cost of each pixel)
    #[arg(long, value_name = "VIEW", default_value_t)]
    pub(super) view: View,
    /// How light is followed: studio, ray-tree or path; by default what suits the scene: ray-tree where it has mirrors, glass,
    /// textures, or lights and a background of its own, else studio
    #[arg(long, value_name = "INTEGRATOR")]
    pub(super) integrator: Option<Integrator>,
    /// How often light is mirrored or refracted, for ray-tree and path: 0 to 16
    #[arg(long, value_name = "N", default_value_t = TreeSettings::default().bounces)]
    pub(super) bounces: u32,
    /// How primary hits are found: traced or rasterised
    #[arg(long, value_name = "HOW", default_value_t)]
    pub(super) primary: Primary,
    /// The order in which a tree's rays are traced: auto, recursive, stack or wavefront; the picture is the same
    #[arg(long, value_name = "ORDER", default_value_t)]
    pub(super) tree_order: TreeOrder,
    /// The time of which a scene that moves is shown
    #[arg(long, value_name = "T", allow_negative_numbers = true, value_parser = finite, conflicts_with = "frames")]
    pub(super) time: Option<f64>,
    /// The frames of a scene that moves: A..B (without B), A..=B, A.., ..B, .. (all) or N
    #[arg(long, value_name = "A..B", allow_hyphen_values = true)]
    pub(super) frames: Option<FrameRange>,
    /// Of the frames only those whose number divided by N leaves I
    #[arg(long, value_name = "I/N", requires = "frames")]
    pub(super) shard: Option<Shard>,
    /// The clip of a scene that moves, by name or number; else the first
    #[arg(long, value_name = "CLIP")]
    pub(super) clip: Option<String>,
    /// Write what surfaces are into the .exr file too: albedo, normal, and ids of instance, geometry and primitive
    #[arg(long)]
    pub(super) layers: bool,
    /// Save the rows that are finished every so many seconds while a shaded picture is rendered; not for scenes that move
    #[arg(long, value_name = "SECONDS", value_parser = clap::value_parser!(u16).range(0..))]
    #[arg(conflicts_with_all = ["frames", "time", "clip"])]
    pub(super) save_every: Option<u16>,
    /// What the file says of how it was made: plain is what decides the picture; full adds command, device and time
    #[arg(long, value_name = "HOW", value_enum, default_value_t)]
    pub(super) metadata: Provenance,
    /// The light: auto, sun:X/Y/Z (the way its light shines), point:X/Y/Z (where it is) or even:R/G/B
    #[arg(long, value_name = "LIGHT", default_value = "auto")]
    pub(super) light: LightArgument,
    /// A ground that catches the shadow: on, off, or auto (where the scene has none)
    #[arg(long, value_name = "GROUND", default_value_t)]
    pub(super) ground: Ground,
    /// Stops of exposure: 1 is twice as bright
    #[arg(long, value_name = "STOPS", default_value_t = 0.0, allow_negative_numbers = true)]
    pub(super) exposure: f32,
    /// What is up in the scene: x, y, z, -x, -y or -z; by default what the file says
    #[arg(long, value_name = "AXIS", allow_hyphen_values = true)]
    pub(super) up: Option<Up>,
    /// Threads of the CPU; all of them by default
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=MOST_THREADS))]
    pub(super) threads: Option<u16>,
    /// Print the statistics as one JSON document; with --frames as one line a frame
    #[arg(long)]
    pub(super) json: bool,
}

impl Arguments {
    /// Whether the scene is wanted with its motion.
    pub(super) fn moves(&self) -> bool {
        self.frames.is_some() || self.time.is_some() || self.clip.is_some()
    }

    /// The structure that was asked for; else a BVH, and two levels where the scene moves.
    pub(super) fn structure(&self) -> StructureSpec {
        // How the objects of two levels are built is said when the scene is there.
        let two_levels = StructureSpec::TwoLevel(TwoLevelOptions::default());
        self.structure.unwrap_or_else(|| if self.moves() { two_levels } else { StructureSpec::default() })
    }

    /// The walk that was asked for, or the best for the structure.
    pub(super) fn walk(&self) -> Walk {
        self.walk.unwrap_or(self.structure().kind().default_walk())
    }

    /// The integrator that was asked for, or the one that suits the model.
    pub(super) fn integrator_for(&self, model: &Model) -> Integrator {
        self.integrator.unwrap_or_else(|| Integrator::suited_to(model))
    }

    /// The stage for a model, on which there is something to see.
    pub(super) fn stage(&self, model: Model) -> Result<Stage, Failure> {
        let options =
            StageOptions { ground: self.ground, up: self.up.map(|up| up.0), ..StageOptions::default() };
        let stage = Stage::new(model, &options);
        if stage.bounds().is_empty() {
            let what = "it has no triangle that could be seen: there is nothing to render";
            return Err(Failure::failed(format!("{}: {what}", self.scene)));
        }
        Ok(stage)
    }

    pub(super) fn settings(&self) -> RenderSettings {
        RenderSettings {
            width: self.size.width,
            height: self.size.height,
            samples: self.samples,
            view: self.view,
            walk: self.walk(),
            camera: self.camera.clone(),
            light: self.light.checked(),
            exposure: self.exposure,
            integrator: self.integrator.unwrap_or_default(),
            tree: TreeSettings { bounces: self.bounces, order: self.tree_order, ..TreeSettings::default() },
            primary: self.primary,
            layers: self.layers,
            ..RenderSettings::default()
        }
    }
}
