//! From what the eye sees to its colours: the studio, trees of rays, or paths.

use crate::error::RenderError;
use crate::gpu::TreeKernel;
use crate::integrator::TreeOrder;
use crate::light::{Environment, Lights};
use crate::looks::Looks;
use crate::path::PathTracer;
use crate::primary::{Seen, column_and_row};
use crate::ray_tree::{self, Followed, Request, Root, Sample, Tally, Tree};
use crate::settings::RenderSettings;
use crate::shade::{self, BRIGHTEST, BROKEN, Place, Shader};
use crate::stage::Stage;
use crate::statistics::Statistics;
use crate::tracing::Tracing;
use crate::view::{self, DATA_BACKGROUND, View};
use glam::Vec3;
use rayon::prelude::*;
use ropewalk_gpu::GpuStructure;
use std::ops::Range;
use std::time::Instant;

/// Follows light, for one picture.
pub(crate) enum Follower<'a> {
    /// The studio: one surface deep.
    Studio(Shader<'a>),
    /// Trees of rays.
    Tree(Trees<'a>),
    /// What shows data follows nothing.
    Data(&'a Stage),
}

/// What trees, and paths, grow in.
pub(crate) struct Trees<'a> {
    pub(crate) looks: &'a Looks,
    pub(crate) lights: &'a Lights,
    pub(crate) tracing: Tracing<'a>,
    pub(crate) order: TreeOrder,
    pub(crate) request: Request,
    /// The kernel, and the structure on its device.
    pub(crate) kernel: Option<(&'a TreeKernel, &'a GpuStructure)>,
    /// What paths need besides; where there is none, trees are followed.
    pub(crate) paths: Option<PathTracer>,
}

impl Trees<'_> {
    /// The colours of samples that have hit something.
    fn follow(&self, roots: &[Root]) -> Result<(Vec<Followed>, Tally), RenderError> {
        if let Some(paths) = &self.paths {
            return paths.follow(self.looks, self.lights, &self.tracing, roots);
        }
        if let Some((kernel, structure)) = self.kernel {
            return kernel.follow(structure, self.tracing.walk, roots, true);
        }
        let tree = Tree { looks: self.looks, lights: self.lights, request: self.request };
        ray_tree::follow(&tree, &self.tracing, self.order, roots)
    }
}

impl Follower<'_> {
    /// What the eye sees at a pixel behind everything.
    fn behind(&self, settings: &RenderSettings, pixel: (u32, u32)) -> Vec3 {
        match self {
            Self::Data(_) => DATA_BACKGROUND,
            Self::Tree(Trees {
                lights: Lights { environment: Environment::Even { radiance, .. }, .. },
                ..
            }) => *radiance,
            Self::Studio(_) | Self::Tree(_) => shade::background(pixel, settings.width, settings.height),
        }
    }

    /// The colour of every sample of a run of pixels.
    pub(crate) fn colors(
        &self,
        settings: &RenderSettings,
        range: &Range<usize>,
        seen: &Seen,
        statistics: &mut Statistics,
    ) -> Result<Vec<Vec3>, RenderError> {
        let clock = Instant::now();
        let (width, samples) = (settings.width as usize, settings.samples as usize);
        let pixel = |index: usize| column_and_row(range.start + index / samples, width);
        seen.status.iter().for_each(|&status| statistics.incomplete.count(status));
        let colors: Vec<Vec3> = (0..seen.rays.len())
            .into_par_iter()
            .with_min_len(1024)
            .map(|index| {
                let is_complete = seen.status[index].is_complete();
                if is_complete { self.behind(settings, pixel(index)) } else { BROKEN }
            })
            .collect();
        let found: Vec<usize> = (0..seen.rays.len())
            .filter(|&index| seen.status[index].is_complete() && seen.hits[index].is_hit())
            .collect();
        statistics.shading_time += clock.elapsed();
        match self {
            Self::Studio(shader) => studio(shader, seen, colors, &found, samples, pixel, statistics),
            Self::Tree(trees) => {
                let sample = |index: usize| Sample {
                    pixel: pixel(index),
                    index: (index % samples) as u32,
                    behind: colors[index],
                };
                let root = |&index: &usize| Root {
                    sample: sample(index),
                    ray: seen.rays[index],
                    hit: seen.hits[index],
                };
                let roots: Vec<Root> = found.iter().map(root).collect();
                let clock = Instant::now();
                let (followed, tally) = trees.follow(&roots)?;
                statistics.occlusion_time += clock.elapsed();
                statistics.add(&tally);
                let mut colors = colors;
                let is_path = trees.paths.is_some();
                for (index, followed) in found.into_iter().zip(followed) {
                    colors[index] = finished(followed, is_path);
                }
                Ok(colors)
            }
            Self::Data(stage) => Ok(data(stage, settings.view, seen, colors, &found, statistics)),
        }
    }
}

/// The colour of a sample: magenta where an answer was missing. A highlight in a tree may not outweigh all other samples
/// of its pixel; a mean of paths is right only with all of its samples.
fn finished(followed: Followed, is_path: bool) -> Vec3 {
    if followed.is_broken {
        BROKEN
    } else if is_path || !followed.color.is_finite() {
        followed.color
    } else {
        followed.color.min(Vec3::splat(BRIGHTEST))
    }
}

fn studio(
    shader: &Shader<'_>,
    seen: &Seen,
    mut colors: Vec<Vec3>,
    found: &[usize],
    samples: usize,
    pixel: impl Fn(usize) -> (u32, u32) + Sync,
    statistics: &mut Statistics,
) -> Result<Vec<Vec3>, RenderError> {
    let clock = Instant::now();
    let place = |&index: &usize| {
        let point = shader.stage.surface_point(&seen.rays[index], &seen.hits[index])?;
        let sample = (index % samples) as u32;
        Some(Place { point, pixel: pixel(index), sample, background: colors[index] })
    };
    let all: Vec<Option<Place>> = found.par_iter().with_min_len(1024).map(place).collect();
    let mut places = Vec::with_capacity(all.len());
    let mut place_of = Vec::with_capacity(all.len());
    for (&index, place) in found.iter().zip(all) {
        colors[index] = BROKEN;
        match place {
            Some(place) => {
                places.push(place);
                place_of.push(index);
            }
            None => statistics.incomplete.count_lost(1),
        }
    }
    statistics.shading_time += clock.elapsed();
    for (index, color) in place_of.into_iter().zip(shader.shade(&places, statistics)?) {
        colors[index] = color;
    }
    Ok(colors)
}

fn data(
    stage: &Stage,
    view: View,
    seen: &Seen,
    mut colors: Vec<Vec3>,
    found: &[usize],
    statistics: &mut Statistics,
) -> Vec<Vec3> {
    let clock = Instant::now();
    let color = |&index: &usize| {
        let point = stage.surface_point(&seen.rays[index], &seen.hits[index])?;
        Some(match view {
            View::Normals => view::normal_color(point.normal),
            View::Ids => view::id_color(&seen.hits[index]),
            View::Depth | View::Visits | View::Shaded => Vec3::ZERO,
        })
    };
    let all: Vec<Option<Vec3>> = found.par_iter().with_min_len(1024).map(color).collect();
    for (&index, color) in found.iter().zip(all) {
        statistics.incomplete.count_lost(u64::from(color.is_none()));
        colors[index] = color.unwrap_or(BROKEN);
    }
    statistics.shading_time += clock.elapsed();
    colors
}

impl Statistics {
    /// Adds what following trees took.
    fn add(&mut self, tally: &Tally) {
        self.shadow_rays += tally.shadow_rays;
        self.ambient_rays += tally.sky_rays;
        self.reflected_rays += tally.reflected_rays;
        self.refracted_rays += tally.refracted_rays;
        self.scattered_rays += tally.scattered_rays;
        self.ended_by_chance += tally.ended_by_chance;
        self.clipped += tally.clipped;
        self.cut_by_depth += tally.cut_by_depth;
        self.cut_by_weight += tally.cut_by_weight;
        self.incomplete.add(&tally.incomplete);
    }
}
