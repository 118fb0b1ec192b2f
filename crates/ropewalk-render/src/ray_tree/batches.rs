//! Batches of rays, sorted so that neighbours in the batch are neighbours in the scene: they visit the same nodes of a
//! structure one after the other, or side by side in a device's group. The answers come back in the order of the
//! questions.

use super::{Tally, TreeRay};
use crate::begin::Begin;
use crate::error::RenderError;
use crate::tracing::{Asking, Tracing};
use glam::Vec3;
use rayon::prelude::*;
use ropewalk::{Hit, Ray, Status};

/// Cells along each axis of the box around the origins: a cell of a picture's worth of rays holds a few of them.
const CELLS: f32 = 256.0;

/// Where a ray belongs: its octant first, then the cell of its origin along a Morton curve.
fn key(ray: &Ray, low: Vec3, per_length: Vec3) -> u32 {
    let octant =
        u32::from(ray.dir.x < 0.0) | u32::from(ray.dir.y < 0.0) << 1 | u32::from(ray.dir.z < 0.0) << 2;
    // A float that is no number becomes 0: such a ray is answered as not valid, wherever it stands.
    let cell = ((ray.origin - low) * per_length).to_array().map(|place| place.clamp(0.0, CELLS - 1.0) as u32);
    octant << 24 | spread(cell[0]) | spread(cell[1]) << 1 | spread(cell[2]) << 2
}

/// The eight low bits, three places apart.
fn spread(cell: u32) -> u32 {
    let cell = (cell | cell << 8) & 0x0000_f00f;
    let cell = (cell | cell << 4) & 0x000c_30c3;
    (cell | cell << 2) & 0x0024_9249
}

/// The order in which rays are traced.
fn order(rays: &[TreeRay]) -> Vec<u32> {
    let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for ray in rays {
        low = low.min(ray.ray.origin);
        high = high.max(ray.ray.origin);
    }
    let per_length = CELLS / (high - low).max(Vec3::splat(f32::MIN_POSITIVE));
    let mut keys: Vec<(u32, u32)> = rays
        .par_iter()
        .enumerate()
        .map(|(index, ray)| (key(&ray.ray, low, per_length), index as u32))
        .collect();
    keys.par_sort_unstable();
    keys.into_iter().map(|(_, index)| index).collect()
}

/// Rays in the order in which they are traced.
struct Sorted {
    order: Vec<u32>,
    rays: Vec<Ray>,
    left: Vec<Option<(u32, u32, u32)>>,
}

impl Sorted {
    fn new(rays: &[TreeRay]) -> Self {
        let order = order(rays);
        let of = |index: &u32| &rays[*index as usize];
        Self {
            rays: order.iter().map(|index| of(index).ray).collect(),
            left: order.iter().map(|index| of(index).left).collect(),
            order,
        }
    }

    /// Answers in the order of the questions.
    fn back<T: Copy>(&self, answers: &[T], plain: T) -> Vec<T> {
        let mut back = vec![plain; answers.len()];
        for (&index, &answer) in self.order.iter().zip(answers) {
            back[index as usize] = answer;
        }
        back
    }
}

/// The closest hits of rays.
pub(super) fn closest(
    tracing: &Tracing<'_>,
    rays: &[TreeRay],
) -> Result<(Vec<Hit>, Vec<Status>), RenderError> {
    let sorted = Sorted::new(rays);
    let (hits, status) = tracing.closest_of(&sorted.rays, &Begin::OnTriangles(&sorted.left))?;
    Ok((sorted.back(&hits, Hit::MISS), sorted.back(&status, Status::COMPLETE)))
}

/// What of their light rays to lights bring; rays that went on behind a pane, and those that were stopped, are counted.
pub(super) fn arriving(
    tracing: &Tracing<'_>,
    rays: &[TreeRay],
    tally: &mut Tally,
) -> Result<(Vec<Vec3>, Vec<Status>), RenderError> {
    let sorted = Sorted::new(rays);
    let of = |index: &u32| &rays[*index as usize];
    let mut asking = Asking {
        light: sorted.order.iter().map(|index| of(index).weight).collect(),
        depth: sorted.order.iter().map(|index| of(index).depth).collect(),
        rays: sorted.rays.clone(),
        left: sorted.left.clone(),
        ..Asking::default()
    };
    let status = tracing.arriving_of(&mut asking)?;
    asking.passed.iter().for_each(|&ray| tally.count(of(&sorted.order[ray]).kind));
    tally.cut_by_depth += asking.stopped;
    Ok((sorted.back(&asking.light, Vec3::ZERO), sorted.back(&status, Status::COMPLETE)))
}
