//! One place of a path: the light that it gives off, the light that is asked for with rays, and where the path goes on.

use super::PathTracer;
use super::asking::{balance, share_of_miss};
use super::sequence::Sequence;
use crate::bsdf::arithmetic::{above, unit};
use crate::bsdf::{Bsdf, Step};
use crate::light::Lights;
use crate::looks::{Looks, Place, Shaded};
use crate::ray_tree::Sample;
use glam::{Vec2, Vec3};
use ropewalk::{Hit, Ray};

/// Bounces before chance may end a path: what the eye sees straight and its first reflections are never grainier for it.
const BOUNCES_BEFORE_CHANCE: u32 = 3;
/// The least chance to go on.
const LEAST_CHANCE: f32 = 0.05;
/// The most light that one addend brings where a surface is seen straight, at an exposure of 0: as much as a sample of the
/// studio. What shines itself is not cut down there.
pub(super) const BRIGHTEST: f32 = 6.0;
/// The share of it that one addend brings which comes by way of other surfaces. A path that finds a small light, or
/// what a near lamp lights, by chance would be a white speck that no number of samples takes away; what is taken off is
/// missing, and is counted.
const SHARE_BEHIND: f32 = 0.5;
/// Normals for shading are bent until the eye sees their surface at least at this cosine.
const LEAST_COSINE: f32 = 0.01;

/// Which number of a sample's sequence is for what. Each place of a path has its own.
#[derive(Clone, Copy)]
pub(super) enum Decision {
    Way,
    Direction,
    Source,
    SourcePoint,
    Emitter,
    EmitterPoint,
    LampPoint,
    Chance,
}

/// A path on its way.
#[derive(Clone, Copy, Debug)]
pub(super) struct Path {
    /// The number of its root.
    pub(super) root: u32,
    pub(super) ray: Ray,
    pub(super) hit: Hit,
    /// The share of the light from here that reaches the picture.
    pub(super) weight: Vec3,
    /// How likely the direction was; `None` where there was only one.
    pub(super) chance: Option<f32>,
    /// How far it was to the last pane that the ray has passed since its direction was chosen.
    pub(super) before: f32,
    pub(super) depth: u32,
}

/// A ray to a light, and the light that it brings if nothing is in its way.
#[derive(Clone, Copy, Debug)]
pub(super) struct Asked {
    pub(super) ray: Ray,
    pub(super) light: Vec3,
}

/// A ray along which the path goes on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Onward {
    pub(super) ray: Ray,
    pub(super) weight: Vec3,
    pub(super) step: Step,
    /// Whether it has only passed a pane.
    pub(super) is_straight: bool,
}

/// What a place of a path gives.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Vertex {
    /// Light from here.
    pub(super) own: Vec3,
    /// Rays to a light of the file, to a surface that shines, and to the lamp of the surroundings.
    pub(super) asked: [Option<Asked>; 3],
    pub(super) onward: Option<Onward>,
    /// The triangle that all rays leave, where they leave one exactly.
    pub(super) left: Option<(u32, u32, u32)>,
    /// The hit leads nowhere.
    pub(super) is_lost: bool,
    pub(super) is_cut_by_depth: bool,
    pub(super) is_ended_by_chance: bool,
    /// Addends that were too bright.
    pub(super) clipped: u32,
}

/// A place that is being worked out.
pub(super) struct Site<'a> {
    pub(super) path: &'a Path,
    sequence: Sequence,
    pub(super) place: Place,
    /// The normal for shading, bent so that the eye sees its side.
    pub(super) normal: Vec3,
    pub(super) bsdf: Bsdf,
    /// What light from here is multiplied by on its way to the picture.
    pub(super) weight: Vec3,
}

impl Site<'_> {
    pub(super) fn number(&self, decision: Decision) -> f32 {
        self.sequence.number(self.path.depth * 8 + decision as u32)
    }

    pub(super) fn square(&self, decision: Decision) -> Vec2 {
        self.sequence.square(self.path.depth * 8 + decision as u32)
    }
}

impl PathTracer {
    /// Works out the place that a path has found, or what lies behind everything.
    pub(super) fn vertex(&self, looks: &Looks, lights: &Lights, sample: &Sample, path: &Path) -> Vertex {
        let mut vertex = Vertex::default();
        let behind = |path: &Path| match path.depth {
            0 => sample.behind,
            _ => lights.environment.radiance(path.ray.dir),
        };
        if !path.hit.is_hit() {
            let light = path.weight * behind(path) * share_of_miss(lights, path);
            vertex.own = self.limited(light, path.depth, &mut vertex.clipped);
            return vertex;
        }
        let Some(place) = looks.place(&path.ray, &path.hit) else {
            return Vertex { is_lost: true, ..vertex };
        };
        vertex.left = place.triangle;
        let bsdf = Bsdf::new(&place.material, place.front);
        let sequence = Sequence::new(sample.pixel, sample.index);
        let normal = towards_eye(place.normal, place.to_eye);
        let mut site = Site { path, sequence, place, normal, bsdf, weight: path.weight };
        if site.place.is_catcher {
            let behind = path.weight * behind(path);
            let strength = looks.catcher_strength(site.place.position);
            vertex.own = behind * (1.0 - strength);
            site.bsdf = Bsdf::new(&Shaded { base_color: Vec3::ONE, ..Shaded::default() }, true);
            site.weight = behind * strength / self.open_light(lights, &site);
        } else {
            let emissive = site.place.material.emissive * self.share_of_hit(&site);
            let light = path.weight * (emissive + glow(lights, &site));
            vertex.own =
                if path.depth == 0 { light } else { self.limited(light, path.depth, &mut vertex.clipped) };
        }
        vertex.asked[0] = self.ask_source(lights, &site, &mut vertex.clipped);
        vertex.asked[1] = self.ask_emitter(looks, &site, &mut vertex.clipped);
        vertex.asked[2] = self.ask_lamp(lights, &site, &mut vertex.clipped);
        self.go_on(&site, &mut vertex);
        vertex
    }

    /// The share that light counts which a path has found by itself: the rest was asked for.
    fn share_of_hit(&self, site: &Site<'_>) -> f32 {
        let Some(chance) = site.path.chance else { return 1.0 };
        let density = self.emitters.density(site.path.hit.id());
        let cos = site.place.geometric_normal.dot(site.place.to_eye);
        if density <= 0.0 || cos <= 0.0 {
            return 1.0;
        }
        let distance = site.path.before + site.path.hit.t;
        balance(chance, density * distance * distance / cos)
    }

    /// The light, no brighter than it may be.
    pub(super) fn limited(&self, light: Vec3, depth: u32, clipped: &mut u32) -> Vec3 {
        let largest = light.x.max(light.y).max(light.z);
        let limit = if depth == 0 { self.brightest } else { self.brightest * SHARE_BEHIND };
        if largest <= limit {
            return light;
        }
        *clipped += 1;
        if largest.is_finite() { light * (limit / largest) } else { Vec3::ZERO }
    }

    /// Finds where the path goes on.
    fn go_on(&self, site: &Site<'_>, vertex: &mut Vertex) {
        let place = &site.place;
        let (way, direction) = (site.number(Decision::Way), site.square(Decision::Direction));
        let Some(mut step) = site.bsdf.step(&self.energy, site.normal, place.to_eye, way, direction) else {
            return;
        };
        let mut weight = site.weight * step.weight;
        let largest = weight.x.max(weight.y).max(weight.z);
        // Written so that a NaN ends the path.
        if !(largest > 0.0 && largest.is_finite()) {
            return;
        }
        if site.path.depth >= self.bounces {
            vertex.is_cut_by_depth = true;
            return;
        }
        if site.path.depth >= BOUNCES_BEFORE_CHANCE {
            let chance = largest.clamp(LEAST_CHANCE, 1.0);
            if site.number(Decision::Chance) >= chance {
                vertex.is_ended_by_chance = true;
                return;
            }
            weight /= chance;
        }
        let (side, origin) = if step.is_through {
            (-place.geometric_normal, place.origin_inside)
        } else {
            (place.geometric_normal, place.origin_outside)
        };
        step.direction = unit(above(step.direction, side));
        let ray = Ray::new(origin, step.direction).with_mask(site.path.ray.mask);
        let is_straight = step.is_through && site.bsdf.eta == 1.0;
        vertex.onward = Some(Onward { ray, weight, step, is_straight });
    }
}

/// What a surface sends on of a file's ambient light and could of no other: pictures of what lies outside of a window are
/// made so.
fn glow(lights: &Lights, site: &Site<'_>) -> Vec3 {
    (site.bsdf.ambient - site.bsdf.diffuse).max(Vec3::ZERO) * lights.environment.ambient()
}

/// The normal, bent so that the eye sees its side.
fn towards_eye(normal: Vec3, to_eye: Vec3) -> Vec3 {
    let cos = normal.dot(to_eye);
    if cos >= LEAST_COSINE { normal } else { unit(normal + to_eye * (LEAST_COSINE - cos)) }
}
