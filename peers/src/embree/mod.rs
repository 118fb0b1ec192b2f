//! Embree 3 and 4, opened at run time where they are.
//!
//! | file | concept |
//! |---|---|
//! | `abi` | its memory and its functions |
//! | `library` | where it lies |
//! | `device` | threads, instructions, bytes |
//! | `scene` | triangles that are built, that move, that are placed many times |
//! | `trace` | rays, one by one and in packets |

mod abi;
mod device;
mod library;
mod scene;
mod trace;

use crate::flush::Flushed;
use crate::{Absent, Peers, Places};
use device::Devices;
use library::Library;
use ropewalk::Hit;
use ropewalk::glam::Affine3A;
use ropewalk_lab::arena::{Engine, EngineError, Grade, Mode, RaySet, Refitter, Shape, TopLevel, Tracer};
use scene::{Placed, Recipe, Scene};
use std::ops::Range;
use std::sync::Arc;

/// Adds the presets of both versions, or why they are not there.
pub(crate) fn find(places: &Places, peers: &mut Peers) {
    for (version, name, named) in [(4, "embree 4", &places.embree4), (3, "embree 3", &places.embree3)] {
        let found = Library::open(version, named.as_deref()).and_then(|library| {
            let devices = Arc::new(Devices::new(library));
            let version = devices.get(1, "")?.version();
            Ok((devices, format!("embree {version}")))
        });
        match found {
            Ok((devices, name)) => peers.engines.extend(presets(&devices, &name)),
            Err(why) => peers.absent.push(Absent { name, why }),
        }
    }
}

/// A preset: its name, its grade, how it is built, and whether with 16 lanes.
type Preset = (&'static str, Grade, u32, u32, bool);

const PRESETS: &[Preset] = &[
    ("low", Grade::Fast, abi::QUALITY_LOW, 0, false),
    ("medium", Grade::Balanced, abi::QUALITY_MEDIUM, 0, false),
    ("high", Grade::High, abi::QUALITY_HIGH, 0, false),
    ("high avx512", Grade::High, abi::QUALITY_HIGH, 0, true),
    ("robust", Grade::Balanced, abi::QUALITY_MEDIUM, abi::SCENE_ROBUST, false),
    ("compact", Grade::Compact, abi::QUALITY_MEDIUM, abi::SCENE_COMPACT, false),
];

fn presets(devices: &Arc<Devices>, name: &str) -> Vec<Box<dyn Engine>> {
    let has_16_lanes = has_avx512();
    let is_worth = |preset: &&Preset| match preset.0 {
        "high avx512" => has_16_lanes && devices.library().version == 4,
        // Version 3 is an older version 4: what stands beside it is its best.
        "robust" | "compact" => devices.library().version == 4,
        _ => true,
    };
    let engine = |&(preset, grade, quality, flags, wide): &Preset| -> Box<dyn Engine> {
        let recipe = Recipe { quality, flags, refits: false };
        let options = if wide { ",frequency_level=simd512" } else { "" };
        Box::new(Embree { devices: Arc::clone(devices), name: name.into(), preset, grade, recipe, options })
    };
    PRESETS.iter().filter(is_worth).map(engine).collect()
}

fn has_avx512() -> bool {
    #[cfg(target_arch = "x86_64")]
    return std::arch::is_x86_feature_detected!("avx512f") && std::arch::is_x86_feature_detected!("avx512vl");
    #[cfg(not(target_arch = "x86_64"))]
    false
}

struct Embree {
    devices: Arc<Devices>,
    name: String,
    preset: &'static str,
    grade: Grade,
    recipe: Recipe,
    options: &'static str,
}

impl Embree {
    fn scene(&self, shape: &Shape, threads: usize, recipe: Recipe) -> Result<Scene, EngineError> {
        let device = self.devices.get(threads, self.options).map_err(|why| self.error(why))?;
        Scene::new(device, shape, recipe).map_err(|why| self.error(why))
    }
}

impl Engine for Embree {
    fn name(&self) -> &str {
        &self.name
    }

    fn preset(&self) -> &str {
        self.preset
    }

    fn is_peer(&self) -> bool {
        true
    }

    fn grade(&self) -> Grade {
        self.grade
    }

    fn has_own_build(&self) -> bool {
        self.options.is_empty()
    }

    fn build(&self, shape: &Shape, threads: usize) -> Result<Box<dyn Tracer>, EngineError> {
        Ok(Box::new(self.scene(shape, threads, self.recipe)?))
    }

    fn refitter(&self, shape: &Shape, threads: usize) -> Option<Result<Box<dyn Refitter>, EngineError>> {
        // With any other quality it builds anew.
        if self.preset != "low" {
            return None;
        }
        let recipe = Recipe { flags: abi::SCENE_DYNAMIC, refits: true, ..self.recipe };
        let moving = |scene| Box::new(Moving { scene, engine: self.name.clone() }) as Box<dyn Refitter>;
        Some(self.scene(shape, threads, recipe).map(moving))
    }

    fn top_level(&self, object: &Shape, threads: usize) -> Option<Result<Box<dyn TopLevel>, EngineError>> {
        if self.preset != "medium" && self.preset != "low" {
            return None;
        }
        // The object is always a good one; the preset is that of the top level.
        let good = Recipe { quality: abi::QUALITY_MEDIUM, flags: 0, refits: false };
        let flags = if self.preset == "low" { abi::SCENE_DYNAMIC } else { 0 };
        let recipe = Recipe { flags, ..self.recipe };
        let copies = |object| {
            let placed = Placed::new(object, recipe);
            Box::new(Copies { placed, recipe, engine: self.name.clone() }) as Box<dyn TopLevel>
        };
        Some(self.scene(object, threads, good).map(copies))
    }
}

impl Tracer for Scene {
    fn bytes(&self) -> Option<usize> {
        Some(self.kept)
    }

    fn peak_bytes(&self) -> Option<usize> {
        Some(self.peak)
    }

    fn modes(&self) -> &[Mode] {
        &[Mode::Single, Mode::Packet8, Mode::Packet16]
    }

    fn closest(&self, mode: Mode, rays: &RaySet, range: Range<usize>, hits: &mut [Hit]) {
        let _flushed = Flushed::new();
        // SAFETY: a scene that exists is committed, and holds its library.
        unsafe { trace::closest(&self.device.library.queries, self.pointer, mode, rays, range, hits) };
    }

    fn any(&self, mode: Mode, rays: &RaySet, range: Range<usize>, hits: &mut [bool]) {
        let _flushed = Flushed::new();
        // SAFETY: as above.
        unsafe { trace::any(&self.device.library.queries, self.pointer, mode, rays, range, hits) };
    }
}

struct Moving {
    scene: Scene,
    engine: String,
}

impl Refitter for Moving {
    fn refit(&mut self, moved: &Shape) -> Result<(), EngineError> {
        let done = self.scene.refit(&moved.aligned_positions());
        done.map_err(|what| EngineError { engine: self.engine.clone(), what })
    }
}

struct Copies {
    placed: Placed,
    recipe: Recipe,
    engine: String,
}

impl TopLevel for Copies {
    fn place(&mut self, places: &[Affine3A]) -> Result<(), EngineError> {
        let done = self.placed.place(places, self.recipe);
        done.map_err(|what| EngineError { engine: self.engine.clone(), what })
    }

    fn modes(&self) -> &[Mode] {
        &[Mode::Single]
    }

    fn closest(&self, mode: Mode, rays: &RaySet, range: Range<usize>, hits: &mut [Hit]) {
        let _flushed = Flushed::new();
        let queries = &self.placed.object.device.library.queries;
        // SAFETY: `Placed` commits its scene when it makes it and whenever it changes it.
        unsafe { trace::closest(queries, self.placed.pointer, mode, rays, range, hits) };
    }
}
