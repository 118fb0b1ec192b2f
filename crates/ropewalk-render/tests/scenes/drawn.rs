//! Drawn first hits against traced ones. An adapter's rasteriser rounds places and depths, so a few hits differ; each must be
//! one that this rounding explains.

use ropewalk::glam::{DVec3, Vec3};
use ropewalk::{Answer, Hit, Query, Ray, Structure, TraceOptions};
use ropewalk_render::{Layers, Picture, Stage};
use ropewalk_scene::Camera;

/// How far from where it should be a rasteriser may take a sample to be, in pixels: corners are snapped to a 256th.
const SNAP: f64 = 1.0 / 256.0;

/// Depths that a rasteriser may take for the same, as a share of them.
const SAME_DEPTH: f32 = 1e-5;

/// The indices that a film keeps of a hit.
type Ids = [u32; 3];

/// How many pixels were drawn otherwise, and why.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Explained {
    /// Another triangle, as good as equally far.
    pub(crate) same_depth: usize,
    /// The sample lies beside an edge.
    pub(crate) edge: usize,
}

/// Compares the pixels of two pictures of one sample: where the same triangle was hit, all bits are the same; where not, either
/// both triangles are as good as equally far, or the sample, moved by what a rasteriser rounds, meets another triangle.
pub(crate) fn explain(
    stage: &Stage,
    structure: &Structure,
    traced: &Picture,
    drawn: &Picture,
) -> Result<Explained, String> {
    let layers = |picture: &'_ Picture| picture.film.layers.clone().ok_or("there are no layers");
    let (of_traced, of_drawn) = (layers(traced)?.ids, layers(drawn)?.ids);
    let pixels = traced.film.pixels();
    if of_drawn.len() != pixels || drawn.film.pixels() != pixels {
        return Err("films of two sizes".into());
    }
    let eye = Eye { stage, structure, camera: &traced.camera, film: (traced.film.width, traced.film.height) };
    let own: Vec<Ids> = eye.ids(&(0..pixels).map(|pixel| eye.ray(pixel, [0.0; 2])).collect::<Vec<_>>());
    let mistaken = own.iter().zip(&of_traced).filter(|(a, b)| eye.kept(**a) != **b).count();
    // These rays are the camera's but for their last bits; more than edges must not differ.
    if mistaken * 100 > pixels {
        return Err(format!("{mistaken} pixels cannot be judged"));
    }
    let bits = |picture: &Picture, pixel: usize| {
        let [red, green, blue] = picture.film.color[pixel].map(f32::to_bits);
        [red, green, blue, picture.film.depth[pixel].to_bits()]
    };
    let mut explained = Explained::default();
    for pixel in 0..pixels {
        let (a, b) = (of_traced[pixel], of_drawn[pixel]);
        if a == b {
            if bits(traced, pixel) == bits(drawn, pixel) {
                continue;
            }
            // Where neither shows a part of the model, one may show the added ground.
            if a != Layers::NOBODY {
                return Err(format!("pixel {pixel}: the same triangle {a:?}, and other bits"));
            }
        }
        let [near, far] = [traced, drawn].map(|picture| picture.film.depth[pixel]);
        if (near - far).abs() <= SAME_DEPTH * near.abs() {
            explained.same_depth += 1;
        } else if eye.is_near_an_edge(pixel) {
            explained.edge += 1;
        } else {
            return Err(format!("pixel {pixel}: traced {a:?} at {near:e}, drawn {b:?} at {far:e}"));
        }
    }
    Ok(explained)
}

/// A camera's rays, made a second time.
struct Eye<'a> {
    stage: &'a Stage,
    structure: &'a Structure,
    camera: &'a Camera,
    film: (u32, u32),
}

impl Eye<'_> {
    /// The ray through the middle of a pixel, moved by some pixels.
    fn ray(&self, pixel: usize, moved: [f64; 2]) -> Ray {
        let (width, height) = self.film;
        let (x, y) = (pixel % width as usize, pixel / width as usize);
        let unit = |v: Vec3| v.as_dvec3().normalize_or(DVec3::Z);
        let forward = unit(self.camera.forward);
        let right = forward.cross(unit(self.camera.up)).normalize_or(DVec3::X);
        let up = right.cross(forward);
        let pixel = 2.0 * (f64::from(self.camera.vertical_fov) * 0.5).tan() / f64::from(height);
        let across = x as f64 + 0.5 + moved[0] - 0.5 * f64::from(width);
        let down = y as f64 + 0.5 + moved[1] - 0.5 * f64::from(height);
        let dir = forward + right * (across * pixel) - up * (down * pixel);
        Ray::new(self.camera.position, dir.as_vec3())
    }

    fn ids(&self, rays: &[Ray]) -> Vec<Ids> {
        let walk = self.structure.kind().default_walk();
        let traced = self.structure.trace(walk, Query::Closest, rays, TraceOptions::default());
        let Answer::Closest(hits) = traced.expect("the walk answers").answer else {
            panic!("another question was answered")
        };
        let ids = |hit: &Hit| [hit.instance_index, hit.geometry_index, hit.primitive_index];
        hits.iter().map(|hit| if hit.is_hit() { ids(hit) } else { Layers::NOBODY }).collect()
    }

    /// What a film keeps: the added ground counts as background.
    fn kept(&self, ids: Ids) -> Ids {
        if Some(ids[0]) == self.stage.ground_instance() { Layers::NOBODY } else { ids }
    }

    /// Whether rays closely around the middle of a pixel do not all meet the same.
    fn is_near_an_edge(&self, pixel: usize) -> bool {
        let step = |index: i32| f64::from(index) * 0.5 * SNAP;
        let around: Vec<Ray> = (-2..=2)
            .flat_map(|y| (-2..=2).map(move |x| (x, y)))
            .map(|(x, y)| self.ray(pixel, [step(x), step(y)]))
            .collect();
        self.ids(&around).windows(2).any(|pair| pair[0] != pair[1])
    }
}

/// A wrong hit away from edges, and a wrong colour where the hit is right, are not explained.
#[test]
fn a_wrong_hit_is_not_explained() {
    let (stage, structure) = crate::Subject::cubes().at(None, crate::two_levels());
    let right = crate::render(&stage, structure.as_ref(), &crate::small());
    assert_eq!(explain(&stage, &structure, &right, &right.clone()), Ok(Explained::default()));
    let seen: Vec<usize> =
        (0..right.film.pixels()).filter(|&pixel| right.film.coverage[pixel] > 0.0).collect();
    assert!(seen.len() > 100);
    let damaged = |pixel: usize, damage: fn(&mut Picture, usize)| {
        let mut wrong = right.clone();
        damage(&mut wrong, pixel);
        explain(&stage, &structure, &right, &wrong)
    };
    let mut explained = 0;
    for &pixel in seen.iter().step_by(7) {
        let other_hit = damaged(pixel, |picture, pixel| {
            picture.film.layers.as_mut().unwrap().ids[pixel] = Layers::NOBODY;
            picture.film.depth[pixel] = f32::INFINITY;
        });
        explained += usize::from(other_hit.is_ok());
        let other_color = damaged(pixel, |picture, pixel| picture.film.color[pixel][0] += 1e-3);
        assert!(other_color.is_err(), "pixel {pixel}");
    }
    assert!(explained * 20 < seen.len() / 7, "{explained} of {} wrong hits are explained", seen.len() / 7);
}
