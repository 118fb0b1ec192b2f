//! `ropewalk lab two-level`: two levels beside one, found out by `ropewalk-lab`; the camera, the light and the files are chosen
//! here.

use super::common::{CommonArguments, Findings, Plot, not_compared, unique_or};
use crate::failure::Failure;
use crate::output::OutputFile;
use clap::Args;
use glam::Vec3;
use ropewalk::two_level::BottomSpec;
use ropewalk::{BuildOptions, CatalogueError, Scene, Structure, StructureKind, StructureSpec, Walk};
use ropewalk_lab::two_level::{
    HeatMap, REBUILD_COUNTS, Sight, TwoLevelFindings, TwoLevelSettings, markdown, plot_objects,
    plot_rebuilds, plot_speeds, rebuild, run as compare, turned, write_csv, write_rebuild_csv,
};
use ropewalk_render::{CameraChoice, Ground, Stage, StageOptions, camera, image_file};
use ropewalk_scene::{Camera, Light};
use std::io::{self, Write};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

const EXAMPLES: &str = "\
Rays of one camera, shadow rays from what it sees to a light, and rays that bounce
off there go through two levels, with every structure that objects can have, in
oriented boxes and without, and through one kd-tree and one BVH. Every answer is
held against the BVH's before anything counts. Counts are means over all rays and
the same on every machine. Speeds are measured in rounds, and the rebuilding of
the top level with them; --rounds 0 leaves both out.

The light is the file's first, else one above the camera.

Heat maps show how many objects' structures the ray of each pixel enters: up to 3
blue, up to 6 green, up to 9 red, more white; black where there is no ray.

Examples:
  ropewalk lab two-level engine.glb -o engine
  ropewalk lab two-level kitchen.aff Robot.aff --rounds 0 -o bart
  ropewalk lab two-level engine.glb --turned --bottom kd-tree -o askew
  ropewalk lab two-level room.obj --camera inside --bottom bvh --json
  ropewalk lab two-level --rebuild 1000 --rebuild 10000

With -o the folder gets two-level.json, .csv, .md and .svg (speeds), and
two-level-objects.svg, two-level-rebuild.csv and .svg, and a two-level-heat PNG
for each scene, class of rays and kind of box.";

/// The arguments of `ropewalk lab two-level`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(super) struct Arguments {
    #[command(flatten)]
    common: CommonArguments,
    /// Pixels a side of the picture
    #[arg(long, value_name = "PIXELS", default_value_t = 512, value_parser = clap::value_parser!(u16).range(1..=2048))]
    size: u16,
    /// From where: auto (the file's first camera, else from outside), frame:..., inside:..., look:..., or a camera of the
    /// file, as for render
    #[arg(long, value_name = "CAMERA", default_value = "auto")]
    camera: CameraChoice,
    /// What objects have, as a structure: kd-tree, bvh, wide-bvh or list with their keys; may be given several times; by
    /// default each kind
    #[arg(long, value_name = "NAME[:key=value,...]", value_parser = bottom)]
    bottom: Vec<BottomSpec>,
    /// Turn each shape in its own space at random, and its instances back: the scene looks the same, and parts lie askew in
    /// their boxes, as where they were exported in the turn that they have in an assembly
    #[arg(long)]
    turned: bool,
    /// Objects over which the top level is rebuilt; may be given several times; by default 100 to 100000
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    rebuild: Vec<u32>,
}

fn bottom(text: &str) -> Result<BottomSpec, CatalogueError> {
    match text.parse()? {
        StructureSpec::KdTree(options) => Ok(BottomSpec::KdTree(options)),
        StructureSpec::Bvh(options) => Ok(BottomSpec::Bvh(options)),
        StructureSpec::WideBvh(options) => Ok(BottomSpec::WideBvh(options)),
        StructureSpec::List(options) if !options.is_one_sided() => Ok(BottomSpec::List(options)),
        StructureSpec::List(_) => Err(CatalogueError(
            "these lists have triangles of one side, whose answers are not those of one BVH: leave out cull and heads"
                .into(),
        )),
        other => {
            let names: Vec<&str> = StructureKind::EVERY
                .into_iter()
                .filter(|kind| !matches!(kind, StructureKind::Bvh8 | StructureKind::Instanced | StructureKind::TwoLevel))
                .map(StructureKind::name)
                .collect();
            Err(CatalogueError(format!("objects cannot have '{other}'; they can have {}", names.join(", "))))
        }
    }
}

impl Findings for TwoLevelFindings {
    const NAME: &'static str = "two-level";
    const TITLE: &'static str = "Two levels beside one";
    const PLOT: Option<Plot<Self>> = Some(|found| plot_speeds(&found.rows).map_err(Failure::failed));

    fn add(&mut self, more: Self) {
        self.scenes.extend(more.scenes);
        self.rows.extend(more.rows);
        self.heat.extend(more.heat);
        self.rebuilds.extend(more.rebuilds);
    }

    fn is_empty(&self) -> bool {
        self.scenes.is_empty()
    }

    fn markdown(&self) -> String {
        markdown(self)
    }

    fn write_csv(&self, writer: &mut dyn Write) -> io::Result<()> {
        write_csv(&self.rows, writer)
    }

    fn write_more(&self, folder: &Path) -> Result<(), Failure> {
        let text = |name: &str, text: &str| {
            OutputFile::new(&folder.join(name))?.write(|writer| writer.write_all(text.as_bytes()))
        };
        text("two-level-objects.svg", &plot_objects(&self.rows).map_err(Failure::failed)?)?;
        if !self.rebuilds.is_empty() {
            text("two-level-rebuild.svg", &plot_rebuilds(&self.rebuilds).map_err(Failure::failed)?)?;
            OutputFile::new(&folder.join("two-level-rebuild.csv"))?
                .write(|writer| write_rebuild_csv(&self.rebuilds, writer))?;
        }
        for map in &self.heat {
            let number = self.scenes.iter().position(|scene| scene.scene == map.scene).unwrap_or(0);
            let side = map.side as u32;
            image_file::write_png(&folder.join(heat_name(number, map)), side, side, &map.to_srgb8())
                .map_err(Failure::failed)?;
        }
        Ok(())
    }
}

/// The number tells scenes of one name in several folders apart.
fn heat_name(number: usize, map: &HeatMap) -> String {
    let file = map.scene.rsplit(['/', '\\', ':']).next().unwrap_or_default();
    let stem: String = file
        .split('.')
        .next()
        .unwrap_or_default()
        .chars()
        .map(|letter| if letter.is_ascii_alphanumeric() { letter.to_ascii_lowercase() } else { '-' })
        .collect();
    let boxes = if map.oriented_boxes { "oriented" } else { "not-oriented" };
    format!("two-level-heat-{}-{stem}-{}-{boxes}.png", number + 1, map.rays)
}

/// Runs the command.
pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let common = &arguments.common;
    common.check()?;
    let plain = TwoLevelSettings::new();
    let settings = TwoLevelSettings {
        bottoms: unique_or(&arguments.bottom, plain.bottoms),
        size: arguments.size.into(),
        devices: common.devices()?,
        rounds: common.rounds(),
    };
    let counts = unique_or(&arguments.rebuild, REBUILD_COUNTS.into());
    // Rebuilding has nothing to do with the scene: it is measured once, with the first.
    let is_first = AtomicBool::new(common.rounds() > 0);
    common.run_models(|name, model, watch| {
        let (mut name, mut model) = (name.to_owned(), model);
        if arguments.turned {
            model.scene = turned(model.scene).map_err(|why| Failure::failed(format!("{name}: {why}")))?;
            name.push_str(", turned");
        }
        let stage = Stage::new(model, &StageOptions { ground: Ground::Off, up: None, crease: 0.0 });
        let sight = sight(&stage, &arguments.camera)?;
        let compared = |error| not_compared(&name, error);
        let mut found = compare(&name, stage.scene(), &sight, &settings, watch).map_err(compared)?;
        if is_first.swap(false, Ordering::Relaxed) {
            found.rebuilds = rebuild(&counts, settings.rounds, watch).map_err(compared)?;
        }
        Ok(found)
    })
}

/// The camera that was chosen, and the light.
fn sight(stage: &Stage, choice: &CameraChoice) -> Result<Sight, Failure> {
    // To look for a place within, rays are traced.
    let tree = match choice {
        CameraChoice::Inside { .. } => stage.scene().build(&BuildOptions::default())?,
        _ => Scene::default().build(&BuildOptions::default())?,
    };
    let camera = camera::resolve(choice, stage, &Structure::Bvh(tree), Walk::default(), 1.0)?;
    let light = light(stage, &camera);
    let Camera { position, forward, up, vertical_fov, .. } = camera;
    Sight::new(position, forward, up, vertical_fov, light).ok_or_else(|| {
        Failure::failed(format!(
            "the camera at {position} along {forward} with {} degrees makes no picture",
            vertical_fov.to_degrees()
        ))
    })
}

/// The file's first light; else, for a camera within, one below the top of the middle, and for one outside one above it, to its
/// left.
fn light(stage: &Stage, camera: &Camera) -> Vec3 {
    let bounds = stage.bounds();
    let (center, size) = (bounds.center(), bounds.size());
    match stage.model().lights.first() {
        Some(Light::Point { position, .. } | Light::Lamp { position, .. }) if position.is_finite() => {
            return *position;
        }
        Some(Light::Sun { direction, .. }) => {
            if let Some(direction) = direction.try_normalize() {
                return center - direction * (100.0 * size.length());
            }
        }
        _ => {}
    }
    let up = stage.up();
    if bounds.contains(&ropewalk::Aabb::new(camera.position, camera.position)) {
        return center + up * (0.35 * size.dot(up.abs()));
    }
    let ahead = camera.forward.reject_from(up).normalize_or_zero();
    let left = up.cross(ahead);
    center + (up + left * 0.6 - ahead * 0.4) * size.length()
}

#[cfg(test)]
mod tests {
    use super::*;
    use ropewalk::Mesh;
    use ropewalk_scene::Model;

    fn stage(lights: Vec<Light>) -> Stage {
        let mesh = Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::ONE], vec![[0, 1, 2]]);
        let model = Model { scene: Scene::from_mesh(mesh), lights, ..Model::default() };
        Stage::new(model, &StageOptions { ground: Ground::Off, up: None, crease: 0.0 })
    }

    #[test]
    fn the_light_is_the_first_of_the_file_or_above() {
        let camera = |position| Camera {
            name: String::new(),
            position,
            forward: Vec3::NEG_Z,
            up: Vec3::Y,
            vertical_fov: 1.0,
        };
        let outside = camera(Vec3::Z * 9.0);
        let place = Vec3::new(3.0, 4.0, 5.0);
        let point = Light::Point { position: place, color: Vec3::ONE };
        assert_eq!(light(&stage(vec![point]), &outside), place);
        let sun = Light::Sun { direction: Vec3::NEG_Y, color: Vec3::ONE };
        assert!(light(&stage(vec![sun]), &outside).y > 100.0);
        let above = light(&stage(Vec::new()), &outside);
        assert!(above.y > 1.0 && above.x < 0.5 && above.z > 0.5, "{above}");
        let within = light(&stage(Vec::new()), &camera(Vec3::splat(0.5)));
        assert!(within.y > 0.5 && within.y < 1.0 && within.x == 0.5, "{within}");
    }

    #[test]
    fn a_picture_is_named_after_its_scene() {
        let map = |scene: &str| HeatMap::new((scene, "shadow", "kd-tree".into()), true, 1, &[], &[]);
        assert_eq!(heat_name(0, &map("cars/My car.glb")), "two-level-heat-1-my-car-shadow-oriented.png");
        assert_eq!(heat_name(2, &map("builtin:assembly")), "two-level-heat-3-assembly-shadow-oriented.png");
    }
}
