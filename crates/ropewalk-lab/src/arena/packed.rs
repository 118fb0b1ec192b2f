//! The packed tree in the arena: every preset with the best vector instructions of the machine, and two of them with the
//! others, too.

use super::ours::{MODES, Ours, Structure};
use super::{Engine, EngineError, Grade, Mode, RaySet, Refitter, Shape, TopLevel, Tracer};
use ropewalk::bvh8::{Instanced, Preset, SimdLevel};
use ropewalk::glam::Affine3A;
use ropewalk::{Bvh8, Bvh8Options, Hit, Instance, Ray, Scene, Transform};
use std::ops::Range;

/// All of them.
pub(super) fn engines() -> Vec<Box<dyn Engine>> {
    let best = SimdLevel::best();
    let others = || SimdLevel::EVERY.into_iter().filter(|level| *level != best && level.is_available());
    let mut engines: Vec<Box<dyn Engine>> = Vec::new();
    for &(name, preset) in Preset::NAMES {
        let engine =
            |name: String, level: Option<SimdLevel>| Packed { name, grade: grade(preset), preset, level };
        engines.push(Box::new(engine(name.into(), None)));
        if matches!(preset, Preset::Balanced | Preset::High) {
            let at = |level: SimdLevel| engine(format!("{name} {level}"), Some(level));
            engines.extend(others().map(|level| Box::new(at(level)) as Box<dyn Engine>));
        }
    }
    engines
}

/// The builds that a preset is compared with.
fn grade(preset: Preset) -> Grade {
    match preset {
        Preset::Fastest | Preset::Fast => Grade::Fast,
        Preset::Balanced => Grade::Balanced,
        Preset::High => Grade::High,
        Preset::Compact => Grade::Compact,
    }
}

struct Packed {
    name: String,
    grade: Grade,
    preset: Preset,
    /// `None`: the best.
    level: Option<SimdLevel>,
}

impl Engine for Packed {
    fn name(&self) -> &str {
        "ropewalk bvh8"
    }

    fn preset(&self) -> &str {
        &self.name
    }

    fn is_peer(&self) -> bool {
        false
    }

    fn grade(&self) -> Grade {
        self.grade
    }

    fn has_own_build(&self) -> bool {
        self.level.is_none()
    }

    fn build(&self, shape: &Shape, _threads: usize) -> Result<Box<dyn Tracer>, EngineError> {
        let options = Bvh8Options { preset: self.preset, level: self.level };
        let built = shape.scene().build_packed(&options);
        Ok(Box::new(Ours(built.map_err(|error| self.error(error))?)))
    }

    fn refitter(&self, shape: &Shape, _threads: usize) -> Option<Result<Box<dyn Refitter>, EngineError>> {
        // Vector instructions make no difference worth a row.
        (self.level.is_none() && self.preset.can_refit()).then(|| {
            let options = Bvh8Options { preset: self.preset, level: None };
            let built = shape.scene().build_packed(&options).map_err(|error| self.error(error));
            built.map(|bvh| Box::new(Moving { bvh, preset: self.name.clone() }) as Box<dyn Refitter>)
        })
    }

    fn top_level(&self, object: &Shape, _threads: usize) -> Option<Result<Box<dyn TopLevel>, EngineError>> {
        // Presets build objects, not the level above.
        if self.level.is_some() || self.preset != Preset::Balanced {
            return None;
        }
        let mut scene = Scene::default();
        scene.add_object(object.mesh().clone());
        let built = scene.build_instanced(&Bvh8Options { preset: self.preset, level: None });
        let built = built.map_err(|error| self.error(error));
        Some(
            built.map(|instanced| {
                Box::new(Copies { instanced, preset: self.name.clone() }) as Box<dyn TopLevel>
            }),
        )
    }
}

/// Copies of one object.
struct Copies {
    instanced: Instanced,
    preset: String,
}

impl TopLevel for Copies {
    fn place(&mut self, places: &[Affine3A]) -> Result<(), EngineError> {
        let error = |what: &dyn std::fmt::Display| EngineError {
            engine: format!("ropewalk bvh8 {}", self.preset),
            what: what.to_string(),
        };
        let instances = places.iter().map(|&place| Ok(Instance::new(0, Transform::new(place)?)));
        let instances: Result<Vec<Instance>, ropewalk::TransformError> = instances.collect();
        self.instanced.place(&instances.map_err(|why| error(&why))?).map_err(|why| error(&why))
    }

    fn modes(&self) -> &[Mode] {
        MODES
    }

    fn closest(&self, mode: Mode, rays: &RaySet, range: Range<usize>, hits: &mut [Hit]) {
        let Some(rays) = rays.rays.get(range) else { return };
        match mode {
            Mode::Batch => self.instanced.closest_batch(rays, hits),
            _ => hits.iter_mut().zip(rays).for_each(|(hit, ray)| *hit = self.instanced.closest(ray)),
        }
    }
}

/// A tree whose triangles move.
struct Moving {
    bvh: Bvh8,
    preset: String,
}

impl Refitter for Moving {
    fn refit(&mut self, moved: &Shape) -> Result<(), EngineError> {
        self.bvh.refit(moved.scene()).map(drop).map_err(|error| EngineError {
            engine: format!("ropewalk bvh8 {}", self.preset),
            what: error.to_string(),
        })
    }
}

impl Structure for Bvh8 {
    fn bytes(&self) -> usize {
        self.report().bytes
    }

    fn closest(&self, ray: &Ray) -> Hit {
        Self::closest(self, ray)
    }

    fn any(&self, ray: &Ray) -> bool {
        Self::any(self, ray)
    }

    fn closest_batch(&self, rays: &[Ray], hits: &mut [Hit]) {
        Self::closest_batch(self, rays, hits);
    }

    fn any_batch(&self, rays: &[Ray], hits: &mut [bool]) {
        Self::any_batch(self, rays, hits);
    }
}
