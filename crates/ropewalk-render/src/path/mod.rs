//! All light there is, by random paths (Kajiya 1986): from the eye to a surface, on to the next, and so on, and at each
//! place a ray to a light.
//!
//! * **Light** is asked for at every place ([`asking`]): one of the file's lights, picked by what it would bring, and a
//!   point of a surface that shines ([`emitters`]), and the studio's lamp. What surrounds the scene, and surfaces that
//!   shine, are also found by the paths themselves; both ways to them are weighed by their chances. The file's lights are
//!   so small that only rays to them find them. So they shine through panes, which bend nothing, but through no other
//!   glass: its shadow is dark but for what the surroundings and shining surfaces send through it.
//! * **Directions** are chosen as the material sends light on (`bsdf::lobes`).
//! * **Numbers** are scrambled Sobol points ([`sequence`]): no random state, so a sample's path depends on its pixel and
//!   its number alone.
//! * **A file's ambient light** stands in for light that is thrown on by surfaces. Paths follow that light, so they leave
//!   ambient light out, but for surfaces that send on more of it than of any other: they glow.
//!
//! **Generations.** All paths of a run of pixels take a step together: one batch of rays to lights, one of rays onward.
//! Everything else is done on the CPU for each path by itself, and what a path finds is added in the order in which
//! it finds it. So the picture is the same on every device that gives the same hits, and for any number of threads.
//!
//! **Limits.** A path ends after the bounces that were asked for, and by chance, weighed so that the mean stays
//! right, from the third on. Light that comes in by a bounce and is brighter than [`vertex`] lets through is cut down. All
//! three are counted.
//!
//! **Cost.** About 500 bytes a path on its way.

mod asking;
mod emitters;
mod noise;
pub(crate) mod sequence;
mod vertex;

pub use noise::Noise;

use crate::begin::Begin;
use crate::bsdf::Energy;
use crate::error::RenderError;
use crate::light::Lights;
use crate::looks::Looks;
use crate::ray_tree::{Followed, Root, Tally};
use crate::settings::RenderSettings;
use crate::stage::Stage;
use crate::tracing::{Asking, Tracing};
use emitters::Emitters;
use glam::Vec3;
use rayon::prelude::*;
use ropewalk::Ray;
use sequence::Sequence;
use vertex::{Path, Vertex};

/// What paths need besides looks and lights, made once a picture.
#[derive(Clone, Debug)]
pub(crate) struct PathTracer {
    emitters: Emitters,
    energy: Energy,
    bounces: u32,
    /// The most light that one addend brings.
    brightest: f32,
    /// The mean radiance that the ground sees of what surrounds the scene.
    open_sky: Vec3,
}

impl PathTracer {
    /// Makes the tables for a picture.
    pub(crate) fn new(stage: &Stage, lights: &Lights, settings: &RenderSettings) -> Self {
        const SAMPLES: u32 = 1024;
        let mut open_sky = Vec3::ZERO;
        for index in 0..SAMPLES {
            let square = Sequence::new((0, 0), index).square(0);
            open_sky += lights.environment.radiance(sequence::cosine_direction(stage.up(), square));
        }
        Self {
            emitters: Emitters::new(stage),
            energy: Energy::new(),
            bounces: settings.tree.bounces,
            brightest: vertex::BRIGHTEST * (-settings.exposure).exp2(),
            open_sky: open_sky / SAMPLES as f32,
        }
    }

    /// Follows the paths of samples whose first hits are known.
    pub(crate) fn follow(
        &self,
        looks: &Looks,
        lights: &Lights,
        tracing: &Tracing<'_>,
        roots: &[Root],
    ) -> Result<(Vec<Followed>, Tally), RenderError> {
        let mut followed = vec![Followed::default(); roots.len()];
        let mut tally = Tally::default();
        let mut paths: Vec<Path> = roots
            .iter()
            .enumerate()
            .map(|(index, root)| Path {
                root: index as u32,
                ray: root.ray,
                hit: root.hit,
                weight: Vec3::ONE,
                chance: None,
                before: 0.0,
                depth: 0,
            })
            .collect();
        while !paths.is_empty() {
            let vertices: Vec<Vertex> = paths
                .par_iter()
                .with_min_len(256)
                .map(|path| match roots.get(path.root as usize) {
                    Some(root) => self.vertex(looks, lights, &root.sample, path),
                    None => Vertex::default(),
                })
                .collect();
            let brought = self.ask(tracing, &paths, &vertices, &mut tally)?;
            for ((path, vertex), brought) in paths.iter().zip(&vertices).zip(brought) {
                let Some(one) = followed.get_mut(path.root as usize) else { continue };
                one.color += vertex.own;
                for light in brought {
                    match light {
                        Some(light) => one.color += light,
                        None => one.is_broken = true,
                    }
                }
                one.is_broken |= vertex.is_lost;
                tally.incomplete.count_lost(u64::from(vertex.is_lost));
                tally.cut_by_depth += u64::from(vertex.is_cut_by_depth);
                tally.ended_by_chance += u64::from(vertex.is_ended_by_chance);
                tally.clipped += u64::from(vertex.clipped);
            }
            paths = self.advance(tracing, &paths, &vertices, &mut followed, &mut tally)?;
        }
        Ok((followed, tally))
    }

    /// What the rays to lights of each place bring; `None` inside where an answer is missing.
    fn ask(
        &self,
        tracing: &Tracing<'_>,
        paths: &[Path],
        vertices: &[Vertex],
        tally: &mut Tally,
    ) -> Result<Vec<[Option<Vec3>; 3]>, RenderError> {
        let mut brought = vec![[Some(Vec3::ZERO); 3]; vertices.len()];
        let mut asking = Asking::default();
        for (path, vertex) in paths.iter().zip(vertices) {
            for asked in vertex.asked.iter().flatten() {
                asking.push(asked.ray, vertex.left, asked.light, path.depth + 1);
            }
        }
        if asking.rays.is_empty() {
            return Ok(brought);
        }
        let status = tracing.arriving_of(&mut asking)?;
        tally.shadow_rays += (asking.rays.len() + asking.passed.len()) as u64;
        tally.cut_by_depth += asking.stopped;
        let mut answers = asking.light.into_iter().zip(status);
        for (vertex, brought) in vertices.iter().zip(&mut brought) {
            for (_, brought) in vertex.asked.iter().zip(brought).filter(|(asked, _)| asked.is_some()) {
                *brought = match answers.next() {
                    Some((light, status)) if status.is_complete() => Some(light),
                    Some((_, status)) => {
                        tally.incomplete.count(status);
                        None
                    }
                    None => None,
                };
            }
        }
        Ok(brought)
    }

    /// Traces the rays onward: the paths of the next generation.
    fn advance(
        &self,
        tracing: &Tracing<'_>,
        paths: &[Path],
        vertices: &[Vertex],
        followed: &mut [Followed],
        tally: &mut Tally,
    ) -> Result<Vec<Path>, RenderError> {
        let mut next: Vec<Path> = Vec::new();
        let mut left = Vec::new();
        for (path, vertex) in paths.iter().zip(vertices) {
            let Some(onward) = vertex.onward else { continue };
            if onward.step.chance.is_some() {
                tally.scattered_rays += 1;
            } else if onward.step.is_through {
                tally.refracted_rays += 1;
            } else {
                tally.reflected_rays += 1;
            }
            // Behind a pane the ray is the same one.
            let (chance, before) = match onward.is_straight {
                true => (path.chance, path.before + path.hit.t),
                false => (onward.step.chance, 0.0),
            };
            next.push(Path {
                ray: onward.ray,
                weight: onward.weight,
                chance,
                before,
                depth: path.depth + 1,
                ..*path
            });
            left.push(vertex.left);
        }
        if next.is_empty() {
            return Ok(next);
        }
        let rays: Vec<Ray> = next.iter().map(|path| path.ray).collect();
        let (hits, status) = tracing.closest_of(&rays, &Begin::OnTriangles(&left))?;
        let mut arrived = Vec::with_capacity(next.len());
        for ((path, hit), status) in next.into_iter().zip(hits).zip(status) {
            if status.is_complete() {
                arrived.push(Path { hit, ..path });
            } else {
                tally.incomplete.count(status);
                if let Some(one) = followed.get_mut(path.root as usize) {
                    one.is_broken = true;
                }
            }
        }
        Ok(arrived)
    }
}

#[cfg(test)]
mod tests;
