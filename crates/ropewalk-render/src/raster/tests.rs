//! Drawn hits against traced ones.
//!
//! By the processor they are equal to the bit, whatever the scene. By an adapter they are equal but for rays near edges and where
//! surfaces nearly coincide, which are counted and bounded.

mod adapter;
mod scenes;

use super::{Drawing, Holes, Rasterised, Request};
use crate::camera::Pinhole;
use crate::error::RenderError;
use crate::sampling;
use crate::trace::Trace;
use glam::{Vec2, Vec3};
use ropewalk::two_level::TwoLevelOptions;
use ropewalk::{Answer, Hit, NoMonitor, Query, Ray, Scene, Structure, StructureSpec, TraceOptions};
use ropewalk_scene::{Camera, builtin};
use scenes::{camera, grid, mirrors, scenes, specs};
use std::ops::Range;

/// A picture to be drawn.
struct Shot {
    pinhole: Pinhole,
    width: u32,
    pixels: Range<usize>,
    subpixels: Vec<Vec2>,
    rays: Vec<Ray>,
}

impl Shot {
    fn new(camera: &Camera, [width, height]: [u32; 2], samples: u32) -> Self {
        Self::of_run(camera, [width, height], samples, 0..(width * height) as usize)
    }

    fn of_run(camera: &Camera, [width, height]: [u32; 2], samples: u32, pixels: Range<usize>) -> Self {
        let pinhole = Pinhole::new(camera, width, height).unwrap();
        let side = samples.isqrt();
        let subpixels: Vec<Vec2> = (0..samples).map(|index| sampling::subpixel(index, side)).collect();
        let ray = |pixel: usize, step: Vec2| {
            let corner = Vec2::new((pixel % width as usize) as f32, (pixel / width as usize) as f32);
            pinhole.ray(corner + step)
        };
        let rays =
            pixels.clone().flat_map(|pixel| subpixels.iter().map(move |&step| ray(pixel, step))).collect();
        Self { pinhole, width, pixels, subpixels, rays }
    }

    fn traced(&self, tracer: &dyn Trace) -> Vec<Hit> {
        let structure = tracer.structure().unwrap();
        let walk = structure.kind().default_walk();
        let traced = tracer.trace_batch(walk, Query::Closest, &self.rays, TraceOptions::default()).unwrap();
        let Answer::Closest(hits) = traced.answer else { panic!("another question was answered") };
        hits
    }

    fn drawn(&self, tracer: &dyn Trace, is_hole: Option<&Holes<'_>>) -> Result<Rasterised, RenderError> {
        let request = Request {
            pinhole: &self.pinhole,
            width: self.width,
            pixels: self.pixels.clone(),
            subpixels: &self.subpixels,
            rays: &self.rays,
            is_hole,
        };
        let walk = tracer.structure().unwrap().kind().default_walk();
        Drawing::new(tracer)?.hits(&request, &|rays| {
            tracer
                .trace_batch(walk, Query::Closest, rays, TraceOptions::default())
                .map_err(RenderError::Trace)
        })
    }
}

/// The first ray for which two answers differ.
fn first_difference(shot: &Shot, traced: &[Hit], drawn: &[Hit]) -> Option<String> {
    assert_eq!(traced.len(), drawn.len());
    let place = traced.iter().zip(drawn).position(|(a, b)| a.to_words() != b.to_words())?;
    Some(format!("ray {place}, {:?}: traced {:?}, drawn {:?}", shot.rays[place], traced[place], drawn[place]))
}

/// Draws a scene by the processor in every structure, and demands what the structure's walk finds. Tells how many rays hit.
fn demand_equal(name: &str, scene: &Scene, camera: &Camera, size: [u32; 2], samples: u32) -> usize {
    let shot = Shot::new(camera, size, samples);
    let mut met = 0;
    for spec in specs() {
        let structure = spec.build(scene, &NoMonitor).unwrap();
        let traced = shot.traced(&structure);
        let drawn = shot.drawn(&structure, None).unwrap();
        assert_eq!(first_difference(&shot, &traced, &drawn.hits), None, "{name}, {spec}");
        assert!(drawn.status.iter().all(|status| status.is_complete()));
        assert_eq!(drawn.traced_instead, 0);
        met = traced.iter().filter(|hit| hit.is_hit()).count();
    }
    met
}

#[test]
fn the_processor_draws_what_is_traced() {
    let mut met = 0;
    for (name, scene, camera) in scenes() {
        let hits = demand_equal(name, &scene, &camera, [75, 61], 1);
        println!("{name}: {hits} of {} rays hit", 75 * 61);
        met += hits;
    }
    assert!(met > 10_000, "{met}");
}

/// Where every sample lies on an edge the last bit decides which of the neighbours is met, and rounding must be allowed for.
#[test]
fn samples_on_edges_are_given_to_the_right_neighbour() {
    let (scene, camera) = grid();
    assert_eq!(demand_equal("grid", &scene, &camera, [61, 61], 1), 61 * 61);
}

#[test]
fn several_samples_a_pixel_are_drawn_where_they_lie() {
    for (name, scene, camera) in scenes().into_iter().skip(4).step_by(3) {
        demand_equal(name, &scene, &camera, [33, 40], 9);
    }
}

#[test]
fn the_assembly_is_drawn_as_it_is_traced() {
    let model = builtin::builtin("assembly").unwrap();
    let bounds = model.scene.bounds();
    let eye = bounds.center() + bounds.size().length() * Vec3::new(0.3, 0.4, 0.6);
    assert!(
        demand_equal("assembly", &model.scene, &camera(eye, bounds.center(), 40.0), [160, 120], 1) > 2000
    );
    let inside = camera(bounds.center(), bounds.center() + Vec3::new(1.0, 0.2, 0.3), 90.0);
    demand_equal("inside the assembly", &model.scene, &inside, [80, 60], 4);
}

/// A run that begins and ends within a row gives the rays of that run.
#[test]
fn a_run_of_pixels_is_drawn_alone() {
    let structure = StructureSpec::default().build(&mirrors(), &NoMonitor).unwrap();
    let camera = camera(Vec3::Z * 8.0, Vec3::ZERO, 40.0);
    for pixels in [0..1, 13..14, 130..977, 64 * 47 - 5..64 * 48] {
        let shot = Shot::of_run(&camera, [64, 48], 4, pixels);
        let drawn = shot.drawn(&structure, None).unwrap();
        assert_eq!(first_difference(&shot, &shot.traced(&structure), &drawn.hits), None);
    }
    let none = Shot::of_run(&camera, [64, 48], 4, 5..5).drawn(&structure, None).unwrap();
    assert!(none.hits.is_empty());
}

#[test]
fn rays_of_another_run_are_refused() {
    let structure = StructureSpec::default().build(&mirrors(), &NoMonitor).unwrap();
    let mut shot = Shot::new(&camera(Vec3::Z * 8.0, Vec3::ZERO, 40.0), [8, 8], 1);
    shot.rays.pop();
    assert!(shot.drawn(&structure, None).unwrap_err().to_string().contains("63 rays"));
}

#[test]
fn masks_hide_instances() {
    let mut scene = mirrors();
    scene.instances[3].mask = 2;
    scene.instances[4].mask = 2;
    let mut shot = Shot::new(&camera(Vec3::Z * 8.0, Vec3::ZERO, 40.0), [60, 60], 1);
    shot.pinhole = shot.pinhole.with_mask(2);
    shot.rays.iter_mut().for_each(|ray| ray.mask = 2);
    for spec in specs() {
        let structure = spec.build(&scene, &NoMonitor).unwrap();
        let traced = shot.traced(&structure);
        let drawn = shot.drawn(&structure, None).unwrap();
        assert_eq!(first_difference(&shot, &traced, &drawn.hits), None, "{spec}");
    }
}

/// Whether a hit lies in a hole of a chequered triangle.
fn chequer(_: &Ray, hit: &Hit) -> bool {
    ((hit.barycentrics * 4.0).floor().element_sum() as i32) % 2 == 0
}

/// What a ray hits when hits in holes are none.
fn through_holes(structure: &Structure, rays: &[Ray]) -> Vec<Hit> {
    let walk = structure.kind().default_walk();
    let traced = structure.trace(walk, Query::All, rays, TraceOptions::default()).unwrap();
    let Answer::All(lists) = traced.answer else { panic!("another question was answered") };
    let of = |(ray, bounds): (&Ray, &[u64])| {
        let hits = &lists.hits[bounds[0] as usize..bounds[1] as usize];
        hits.iter().copied().find(|hit| !chequer(ray, hit)).unwrap_or(Hit::MISS)
    };
    rays.iter().zip(lists.offsets.windows(2)).map(of).collect()
}

#[test]
fn holes_let_through_what_is_behind() {
    let shot = Shot::new(&camera(Vec3::Z * 8.0, Vec3::ZERO, 40.0), [60, 60], 1);
    for spec in [StructureSpec::default(), StructureSpec::TwoLevel(TwoLevelOptions::default())] {
        let structure = spec.build(&mirrors(), &NoMonitor).unwrap();
        let expected = through_holes(&structure, &shot.rays);
        let drawn = shot.drawn(&structure, Some(&chequer)).unwrap();
        assert_eq!(first_difference(&shot, &expected, &drawn.hits), None, "{spec}");
        assert!(first_difference(&shot, &shot.traced(&structure), &drawn.hits).is_some(), "there are holes");
    }
}
