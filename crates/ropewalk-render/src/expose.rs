//! Writes the samples of a run of pixels onto the film, each pixel the mean of its samples in their order.

use crate::film::{Film, Layers};
use crate::looks::Looks;
use crate::primary::Seen;
use crate::statistics::Statistics;
use glam::Vec3;
use rayon::prelude::*;
use ropewalk::CounterTotals;
use std::ops::Range;

/// Writes the means of a run's samples.
pub(crate) fn expose(
    film: &mut Film,
    range: Range<usize>,
    samples: usize,
    ground_instance: Option<u32>,
    seen: &Seen,
    colors: &[Vec3],
    statistics: &mut Statistics,
) {
    let share = 1.0 / samples as f32;
    for (pixel, first) in range.zip((0..).step_by(samples)) {
        let of_pixel = first..first + samples;
        let mut sum = Vec3::ZERO;
        for &color in &colors[of_pixel.clone()] {
            if color.is_finite() {
                sum += color;
            } else {
                statistics.not_finite += 1;
            }
        }
        film.color[pixel] = (sum * share).to_array();
        // The ground that only catches shadows counts as background.
        let model = seen.hits[of_pixel.clone()]
            .iter()
            .filter(|hit| hit.is_hit() && Some(hit.instance_index) != ground_instance);
        film.coverage[pixel] = model.clone().count() as f32 * share;
        film.depth[pixel] = model.map(|hit| hit.t).fold(f32::INFINITY, f32::min);
        if let (Some(counters), Some(visits)) = (&seen.counters, film.visits.get_mut(pixel)) {
            let work: u64 = counters[of_pixel]
                .iter()
                .map(|counters| u64::from(counters.inner_visits) + u64::from(counters.primitive_tests))
                .sum();
            *visits = work as f32 * share;
        }
    }
    if let Some(counters) = &seen.counters {
        let totals: CounterTotals = counters.iter().collect();
        let sum = statistics.counters.get_or_insert_default();
        sum.rays += totals.rays;
        sum.inner_visits += totals.inner_visits;
        sum.leaf_visits += totals.leaf_visits;
        sum.primitive_tests += totals.primitive_tests;
        sum.restarts += totals.restarts;
        sum.stack_depth = sum.stack_depth.max(totals.stack_depth);
        sum.objects_entered += totals.objects_entered;
    }
}

/// Writes the layers behind a picture: what its surfaces are, whatever the light.
pub(crate) fn expose_layers(
    layers: &mut Layers,
    looks: &Looks,
    range: Range<usize>,
    samples: usize,
    ground_instance: Option<u32>,
    seen: &Seen,
) {
    let share = 1.0 / samples as f32;
    let planes = (&mut layers.albedo[range.clone()])
        .into_par_iter()
        .zip(&mut layers.normal[range.clone()])
        .zip(&mut layers.ids[range]);
    planes.enumerate().with_min_len(256).for_each(|(pixel, ((albedo, normal), ids))| {
        let (mut albedo_sum, mut normal_sum) = (Vec3::ZERO, Vec3::ZERO);
        for index in pixel * samples..(pixel + 1) * samples {
            let hit = &seen.hits[index];
            if !hit.is_hit() || Some(hit.instance_index) == ground_instance {
                continue;
            }
            let Some(place) = looks.place(&seen.rays[index], hit) else { continue };
            albedo_sum += place.material.base_color;
            normal_sum += place.normal;
            // Indices have no mean: those of one sample stand for the pixel.
            if *ids == Layers::NOBODY {
                *ids = [hit.instance_index, hit.geometry_index, hit.primitive_index];
            }
        }
        *albedo = (albedo_sum * share).to_array();
        *normal = (normal_sum * share).to_array();
    });
}
