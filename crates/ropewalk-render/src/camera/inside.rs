//! A place within a building: the most open one at eye height, and from there along the longest line of sight.
//!
//! From a lattice of points, rays go into all directions. The point wins from which there is most to see: the
//! free lengths of its rays, summed, times the number of different things (instances and geometries) and of
//! different triangles that they meet. Length alone would choose empty halls between a building and its shell.
//! Five thousand rays or so: nothing beside a picture.

use crate::error::RenderError;
use crate::sampling::{self, Purpose};
use crate::stage::Stage;
use crate::trace::Trace;
use glam::Vec3;
use ropewalk::{Answer, Query, Ray, TraceOptions, Walk};
use ropewalk_scene::Camera;
use std::collections::HashSet;

/// The eye's height over the floor, as a share of the whole height.
const EYE_HEIGHT: f32 = 0.22;
/// Lattice points along each level direction; odd, so that one is in the middle.
const LATTICE: usize = 9;
/// Rays from each of them: half up, half down.
const DIRECTIONS: u32 = 64;
/// Level directions in which the line of sight is looked for.
const LEVEL_DIRECTIONS: usize = 16;
/// The share of the free line that the eye keeps off its end.
const BACK_OFF: f32 = 0.08;

/// The extents of a stage along two level directions and up.
struct Extents {
    axes: [Vec3; 3],
    low: Vec3,
    high: Vec3,
}

impl Extents {
    fn of(stage: &Stage, up: Vec3) -> Self {
        let (a, b) = sampling::frame(up);
        let axes = [a, b, up];
        let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        stage.for_each_point(|point| {
            let place = Vec3::from(axes.map(|axis| point.dot(axis)));
            low = low.min(place);
            high = high.max(place);
        });
        if !low.cmple(high).all() {
            (low, high) = (Vec3::ZERO, Vec3::ONE);
        }
        Self { axes, low, high }
    }

    fn at(&self, share: Vec3) -> Vec3 {
        let place = self.low + (self.high - self.low) * share;
        self.axes[0] * place.x + self.axes[1] * place.y + self.axes[2] * place.z
    }

    /// How far a ray from within stays within.
    fn exit(&self, ray: &Ray) -> f32 {
        (0..3)
            .map(|axis| {
                let (place, way) = (ray.origin.dot(self.axes[axis]), ray.dir.dot(self.axes[axis]));
                let edge = if way > 0.0 { self.high[axis] } else { self.low[axis] };
                if way == 0.0 { f32::INFINITY } else { ((edge - place) / way).max(0.0) }
            })
            .fold(f32::INFINITY, f32::min)
    }
}

/// Finds the camera.
pub(super) fn inside(
    stage: &Stage,
    tracer: &dyn Trace,
    walk: Walk,
    vertical_fov: f32,
) -> Result<Camera, RenderError> {
    let up = stage.up();
    let extents = Extents::of(stage, up);
    let share = |index: usize| (index as f32 + 0.5) / LATTICE as f32;
    let all_ways: Vec<Vec3> = (0..DIRECTIONS)
        .map(|index| {
            let pole = if index % 2 == 0 { up } else { -up };
            sampling::cosine_direction(pole, sampling::point(Purpose::Sky, (0, 0), index, DIRECTIONS))
        })
        .collect();
    let places: Vec<Vec3> = (0..LATTICE * LATTICE)
        .map(|cell| extents.at(Vec3::new(share(cell % LATTICE), share(cell / LATTICE), EYE_HEIGHT)))
        .collect();
    let rays: Vec<Ray> =
        places.iter().flat_map(|&place| all_ways.iter().map(move |&way| Ray::new(place, way))).collect();
    let sights = look(&extents, tracer, walk, &rays)?;
    let mut best = (extents.at(Vec3::splat(0.5)), 0.0);
    for (&place, sights) in places.iter().zip(sights.chunks(all_ways.len())) {
        let score = score(sights);
        if score > best.1 {
            best = (place, score);
        }
    }
    let place = best.0;
    let rays: Vec<Ray> = (0..LEVEL_DIRECTIONS)
        .map(|index| {
            let turn = index as f32 / LEVEL_DIRECTIONS as f32 * std::f32::consts::TAU;
            Ray::new(place, extents.axes[0] * turn.cos() + extents.axes[1] * turn.sin())
        })
        .collect();
    let free: Vec<f32> = look(&extents, tracer, walk, &rays)?.iter().map(|sight| sight.free).collect();
    let half = LEVEL_DIRECTIONS / 2;
    let ahead = (0..half).fold(0, |best, index| {
        let line = |index: usize| free[index] + free[index + half];
        if line(index) > line(best) { index } else { best }
    });
    let behind = ahead + half;
    let length = free[ahead] + free[behind];
    Ok(Camera {
        name: "inside".into(),
        position: place + rays[behind].dir * (free[behind] - BACK_OFF * length).max(0.0),
        forward: rays[ahead].dir,
        up,
        vertical_fov,
    })
}

/// What one ray meets.
struct Sight {
    /// How far it runs before it meets something or leaves the bounds.
    free: f32,
    /// The instance, the geometry and the triangle, where it meets something.
    met: Option<(u32, u32, u32)>,
}

/// How much there is to see.
fn score(sights: &[Sight]) -> f32 {
    let met = || sights.iter().filter_map(|sight| sight.met);
    let things: HashSet<(u32, u32)> = met().map(|(instance, geometry, _)| (instance, geometry)).collect();
    let triangles: HashSet<(u32, u32, u32)> = met().collect();
    sights.iter().map(|sight| sight.free).sum::<f32>() * things.len() as f32 * triangles.len() as f32
}

fn look(extents: &Extents, tracer: &dyn Trace, walk: Walk, rays: &[Ray]) -> Result<Vec<Sight>, RenderError> {
    let traced = tracer
        .trace_batch(walk, Query::Closest, rays, TraceOptions::default())
        .map_err(RenderError::Trace)?;
    match traced.answer {
        Answer::Closest(hits) if hits.len() == rays.len() => Ok(rays
            .iter()
            .zip(hits)
            .map(|(ray, hit)| {
                let exit = extents.exit(ray);
                Sight { free: hit.t.min(exit), met: (hit.t <= exit).then(|| hit.id()) }
            })
            .collect()),
        _ => Err(RenderError::Trace("the device answered another question than was asked".into())),
    }
}
