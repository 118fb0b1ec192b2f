//! Our own engines in the arena: each a structure with its default walks, one ray a call and many.

use super::{Engine, EngineError, Grade, Mode, RaySet, Refitter, Shape, TopLevel, Tracer};
use ropewalk::glam::Affine3A;
use ropewalk::two_level::{BottomSpec, Bottoms};
use ropewalk::{
    BuildOptions, Builder, Bvh, Hit, NoMonitor, Scene, TwoLevel, TwoLevelOptions, WideBvh, WideOptions,
};
use std::ops::Range;

/// All of them.
#[must_use]
pub fn engines() -> Vec<Box<dyn Engine>> {
    let binned = BuildOptions::default();
    let sbvh = BuildOptions { builder: Builder::Sbvh, ..binned };
    let mut engines = super::packed::engines();
    let others: Vec<Box<dyn Engine>> = vec![
        Box::new(Binary { preset: "binned", grade: Grade::Balanced, options: binned }),
        Box::new(Binary { preset: "sbvh", grade: Grade::High, options: sbvh }),
        Box::new(Wide { preset: "binned", grade: Grade::Balanced, options: binned }),
        Box::new(Wide { preset: "sbvh", grade: Grade::High, options: sbvh }),
    ];
    engines.extend(others);
    engines
}

pub(super) const MODES: &[Mode] = &[Mode::Single, Mode::Batch];

/// A structure of ours: what all have in common.
pub(super) trait Structure: Send + Sync {
    fn bytes(&self) -> usize;
    fn closest(&self, ray: &ropewalk::Ray) -> Hit;
    fn any(&self, ray: &ropewalk::Ray) -> bool;
    fn closest_batch(&self, rays: &[ropewalk::Ray], hits: &mut [Hit]);
    fn any_batch(&self, rays: &[ropewalk::Ray], hits: &mut [bool]);
}

macro_rules! structure {
    ($type:ty) => {
        impl Structure for $type {
            fn bytes(&self) -> usize {
                self.report().bytes
            }
            fn closest(&self, ray: &ropewalk::Ray) -> Hit {
                Self::closest(self, ray)
            }
            fn any(&self, ray: &ropewalk::Ray) -> bool {
                Self::any(self, ray)
            }
            fn closest_batch(&self, rays: &[ropewalk::Ray], hits: &mut [Hit]) {
                Self::closest_batch(self, rays, hits);
            }
            fn any_batch(&self, rays: &[ropewalk::Ray], hits: &mut [bool]) {
                Self::any_batch(self, rays, hits);
            }
        }
    };
}

structure!(Bvh);
structure!(WideBvh);

pub(super) struct Ours<S>(pub(super) S);

impl<S: Structure> Tracer for Ours<S> {
    fn bytes(&self) -> Option<usize> {
        Some(self.0.bytes())
    }

    fn modes(&self) -> &[Mode] {
        MODES
    }

    fn closest(&self, mode: Mode, rays: &RaySet, range: Range<usize>, hits: &mut [Hit]) {
        let Some(rays) = rays.rays.get(range) else { return };
        match mode {
            Mode::Batch => self.0.closest_batch(rays, hits),
            _ => hits.iter_mut().zip(rays).for_each(|(hit, ray)| *hit = self.0.closest(ray)),
        }
    }

    fn any(&self, mode: Mode, rays: &RaySet, range: Range<usize>, hits: &mut [bool]) {
        let Some(rays) = rays.rays.get(range) else { return };
        match mode {
            Mode::Batch => self.0.any_batch(rays, hits),
            _ => hits.iter_mut().zip(rays).for_each(|(hit, ray)| *hit = self.0.any(ray)),
        }
    }
}

/// The binary BVH.
struct Binary {
    preset: &'static str,
    grade: Grade,
    options: BuildOptions,
}

impl Engine for Binary {
    fn name(&self) -> &str {
        "ropewalk bvh"
    }

    fn preset(&self) -> &str {
        self.preset
    }

    fn is_peer(&self) -> bool {
        false
    }

    fn grade(&self) -> Grade {
        self.grade
    }

    fn build(&self, shape: &Shape, _threads: usize) -> Result<Box<dyn Tracer>, EngineError> {
        let built = shape.scene().build_monitored(&self.options, &NoMonitor);
        Ok(Box::new(Ours(built.map_err(|error| self.error(error))?)))
    }

    fn refitter(&self, shape: &Shape, _threads: usize) -> Option<Result<Box<dyn Refitter>, EngineError>> {
        let built = shape.scene().build(&self.options).map_err(|error| self.error(error));
        Some(built.map(|bvh| Box::new(Moving(bvh)) as Box<dyn Refitter>))
    }
}

struct Moving(Bvh);

impl Refitter for Moving {
    fn refit(&mut self, moved: &Shape) -> Result<(), EngineError> {
        let error = |error: ropewalk::UpdateError| EngineError {
            engine: "ropewalk bvh".into(),
            what: error.to_string(),
        };
        self.0.refit(moved.scene()).map(drop).map_err(error)
    }
}

/// The wide BVH of 8 children, and the two levels over it.
struct Wide {
    preset: &'static str,
    grade: Grade,
    options: BuildOptions,
}

impl Engine for Wide {
    fn name(&self) -> &str {
        "ropewalk wide-bvh"
    }

    fn preset(&self) -> &str {
        self.preset
    }

    fn is_peer(&self) -> bool {
        false
    }

    fn grade(&self) -> Grade {
        self.grade
    }

    fn build(&self, shape: &Shape, _threads: usize) -> Result<Box<dyn Tracer>, EngineError> {
        let options = WideOptions { build: self.options, ..WideOptions::default() };
        let built = shape.scene().build_wide_monitored(&options, &NoMonitor);
        Ok(Box::new(Ours(built.map_err(|error| self.error(error))?)))
    }

    fn top_level(&self, object: &Shape, _threads: usize) -> Option<Result<Box<dyn TopLevel>, EngineError>> {
        if self.grade != Grade::Balanced {
            return None;
        }
        let mut scene = Scene::default();
        let _ = scene.add_object(object.mesh().clone());
        let wide = WideOptions { build: self.options, ..WideOptions::default() };
        let bottoms = Bottoms::Each(BottomSpec::WideBvh(wide));
        let options = TwoLevelOptions { bottoms, ..TwoLevelOptions::default() };
        let built = scene.build_two_level(&options).map_err(|error| self.error(error));
        Some(built.map(|two_level| {
            Box::new(Copies { two_level, instances: Vec::new(), engine: self.name().into() })
                as Box<dyn TopLevel>
        }))
    }
}

struct Copies {
    two_level: TwoLevel,
    instances: Vec<u32>,
    engine: String,
}

impl TopLevel for Copies {
    fn place(&mut self, places: &[Affine3A]) -> Result<(), EngineError> {
        let error = |what: &dyn std::fmt::Display| EngineError {
            engine: self.engine.clone(),
            what: what.to_string(),
        };
        for instance in self.instances.drain(places.len().min(self.instances.len())..) {
            self.two_level.remove_instance(instance).map_err(|why| error(&why))?;
        }
        for (index, place) in places.iter().enumerate() {
            match self.instances.get(index) {
                Some(&instance) => {
                    self.two_level.set_transform(instance, *place).map_err(|why| error(&why))?;
                }
                None => {
                    let instance = self.two_level.add_instance(0, *place, ropewalk::Ray::ALL);
                    self.instances.push(instance.map_err(|why| error(&why))?);
                }
            }
        }
        self.two_level.commit(ropewalk::two_level::TopUpdate::Rebuild).map(drop).map_err(|why| error(&why))
    }

    fn modes(&self) -> &[Mode] {
        MODES
    }

    fn closest(&self, mode: Mode, rays: &RaySet, range: Range<usize>, hits: &mut [Hit]) {
        let Some(rays) = rays.rays.get(range) else { return };
        match mode {
            Mode::Batch => self.two_level.closest_batch(rays, hits),
            _ => hits.iter_mut().zip(rays).for_each(|(hit, ray)| *hit = self.two_level.closest(ray)),
        }
    }
}
