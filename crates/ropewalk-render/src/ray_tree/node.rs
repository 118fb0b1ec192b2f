//! One node of a tree: from a place that a ray has found to its own light, and the rays that leave it. The twin of
//! `tree_node` in the kernel.
//!
//! **Order**, which is the order of all sums: the node's own light, one addend; then its rays: to each light, into the sky
//! (at the first place, in the studio), into the mirror, through the glass.
//!
//! **Own light** is, in this order: what the place gives off; light of lights that are not asked for with rays; the
//! surroundings; what comes through glass that no ray follows.
//!
//! **Weights.** Every ray carries the share of its light that reaches the picture. A ray to a light carries that light as it
//! arrives if nothing is in the way, so that all that follows is to add it or not. Rays whose weight is exactly zero are
//! none; only mirrored and refracted rays are cut off by weight, since a small light may be one of many.
//!
//! **The ground that catches shadows** shows what is behind it, darkened by the share of light that is missing. That share
//! is a sum over its lights, so each of its rays carries what is behind times its light's share.

use super::Request;
use crate::bsdf::{Bsdf, arithmetic, fresnel};
use crate::light::Lights;
use crate::looks::{Looks, Place};
use crate::sampling::{self, Purpose};
use glam::Vec3;
use ropewalk::{Hit, Ray};

/// What a ray is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// It leaves the eye.
    Primary,
    /// It asks whether a light arrives.
    Light,
    /// It asks whether the sky's light arrives.
    Sky,
    /// It comes from a mirror.
    Mirrored,
    /// It has gone through glass.
    Refracted,
}

impl Kind {
    /// Whether all that is asked is if something is in the way.
    pub(crate) const fn is_occlusion(self) -> bool {
        matches!(self, Self::Light | Self::Sky)
    }
}

/// A sample: who asks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Sample {
    /// The pixel's column and row.
    pub(crate) pixel: (u32, u32),
    /// The number of the sample in its pixel.
    pub(crate) index: u32,
    /// What the eye sees here when its ray leaves the scene.
    pub(crate) behind: Vec3,
}

/// A ray of a tree: one record for all kinds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TreeRay {
    pub(crate) ray: Ray,
    /// The share of what it finds that reaches the picture; for a ray to a light, that light.
    pub(crate) weight: Vec3,
    pub(crate) kind: Kind,
    /// How often it has been mirrored or refracted.
    pub(crate) depth: u32,
    /// The triangle that it leaves, where it leaves one exactly.
    pub(crate) left: Option<(u32, u32, u32)>,
}

impl TreeRay {
    pub(crate) const fn primary(ray: Ray) -> Self {
        Self { ray, weight: Vec3::ONE, kind: Kind::Primary, depth: 0, left: None }
    }
}

/// What a place gives.
#[derive(Clone, Debug, Default)]
pub(crate) struct Node {
    /// Its own light, weighted.
    pub(crate) own: Vec3,
    /// The rays that leave it, in the order in which their light is added.
    pub(crate) rays: Vec<TreeRay>,
    pub(crate) cut_by_depth: u32,
    pub(crate) cut_by_weight: u32,
}

/// What trees grow in.
#[derive(Clone, Copy)]
pub(crate) struct Tree<'a> {
    pub(crate) looks: &'a Looks,
    pub(crate) lights: &'a Lights,
    pub(crate) request: Request,
}

/// A place with what its rays have in common.
struct Site<'a> {
    sample: &'a Sample,
    ray: &'a TreeRay,
    place: Place,
    bsdf: Bsdf,
    /// What light from here is multiplied by on its way to the picture.
    weight: Vec3,
}

impl Tree<'_> {
    /// What is seen along a ray that leaves the scene.
    pub(crate) fn behind(&self, sample: &Sample, ray: &TreeRay) -> Vec3 {
        if ray.depth == 0 { sample.behind } else { self.lights.environment.radiance(ray.ray.dir) }
    }

    /// The light of a ray that leaves the scene.
    pub(crate) fn missed(&self, sample: &Sample, ray: &TreeRay) -> Vec3 {
        ray.weight * self.behind(sample, ray)
    }

    /// Works out a node. False when the hit leads nowhere, which a sound structure never answers.
    pub(crate) fn grow(&self, sample: &Sample, ray: &TreeRay, hit: &Hit, node: &mut Node) -> bool {
        *node = Node { rays: std::mem::take(&mut node.rays), ..Node::default() };
        node.rays.clear();
        let Some(place) = self.looks.place(&ray.ray, hit) else { return false };
        let bsdf = Bsdf::new(&place.material, place.front);
        let follows_mirrors = self.request.tree.reflections && ray.depth < self.request.tree.bounces;
        let surroundings =
            bsdf.surroundings(place.normal, place.to_eye, &self.lights.environment, follows_mirrors);
        let mut site = Site { sample, ray, place, bsdf, weight: ray.weight };
        let is_catcher = site.place.is_catcher;
        node.own = ray.weight * site.place.material.emissive;
        if is_catcher {
            let behind = ray.weight * self.behind(sample, ray);
            let strength = self.looks.catcher_strength(site.place.position);
            node.own = behind * (1.0 - strength);
            site.weight = behind * strength / self.open_light(&site, surroundings);
        }
        self.lights(&site, node);
        self.surroundings(&site, surroundings, node);
        if !is_catcher {
            self.mirror(&site, node);
            self.glass(&site, node);
        }
        true
    }

    /// The light that arrives at a place from light number `number`, and its ray.
    fn light(&self, site: &Site<'_>, number: usize) -> Option<(Vec3, Ray)> {
        let source = self.lights.sources.get(number)?;
        let place = &site.place;
        // Each light and each depth starts elsewhere in the pattern, or all penumbras would have the same grain.
        let index = (site.sample.index + 7 * number as u32 + 3 * site.ray.depth) % self.request.samples;
        let square = sampling::point(Purpose::Light, site.sample.pixel, index, self.request.samples);
        let incoming = source.towards(place.origin_outside, square)?;
        let light = site.bsdf.direct(place.normal, place.to_eye, incoming.to_light) * incoming.light;
        // Just short of the light, which may stand on a lamp's own surface.
        let ray = Ray::new(place.origin_outside, incoming.to_light).window(0.0, incoming.distance * 0.999);
        Some((light, ray))
    }

    /// All light that would arrive at a place if nothing were in the way; never zero.
    fn open_light(&self, site: &Site<'_>, surroundings: Vec3) -> Vec3 {
        let mut open = Vec3::ZERO;
        for number in 0..self.lights.sources.len() {
            if let Some((light, _)) = self.light(site, number) {
                open += light;
            }
        }
        open += surroundings;
        open.max(Vec3::splat(1e-30))
    }

    fn lights(&self, site: &Site<'_>, node: &mut Node) {
        for number in 0..self.lights.sources.len() {
            let Some((light, ray)) = self.light(site, number) else { continue };
            let weight = site.weight * light;
            if self.request.tree.shadows {
                push_occlusion(site, node, Kind::Light, ray, weight);
            } else {
                node.own += weight;
            }
        }
    }

    fn surroundings(&self, site: &Site<'_>, surroundings: Vec3, node: &mut Node) {
        let weight = site.weight * surroundings;
        let is_first = site.ray.depth == 0 && self.lights.environment.is_studio();
        if !is_first || self.request.sky_rays == 0 {
            node.own += weight;
            return;
        }
        node.own += weight * self.request.sky_open;
        let carried = weight * self.request.sky_share;
        let place = &site.place;
        let rounds = self.request.sky_rays;
        for round in 0..rounds {
            let index = site.sample.index * rounds + round;
            let square =
                sampling::point(Purpose::Sky, site.sample.pixel, index, rounds * self.request.samples);
            let direction =
                arithmetic::above(sampling::cosine_direction(place.normal, square), place.geometric_normal);
            let length = sampling::fraction(site.sample.pixel, index);
            let reach = (length * length) * self.request.sky_reach;
            let ray = Ray::new(place.origin_outside, direction).window(0.0, reach);
            push_occlusion(site, node, Kind::Sky, ray, carried);
        }
    }

    fn mirror(&self, site: &Site<'_>, node: &mut Node) {
        let place = &site.place;
        let weight = site.weight * site.bsdf.mirror_weight(place.normal.dot(place.to_eye));
        if !self.request.tree.reflections || weight == Vec3::ZERO {
            return;
        }
        if site.ray.depth >= self.request.tree.bounces {
            // The surroundings hold it.
            node.cut_by_depth += 1;
            return;
        }
        let direction =
            arithmetic::above(arithmetic::mirrored(place.normal, place.to_eye), place.geometric_normal);
        self.push_followed(site, node, Kind::Mirrored, Ray::new(place.origin_outside, direction), weight);
    }

    fn glass(&self, site: &Site<'_>, node: &mut Node) {
        let place = &site.place;
        let weight = site.weight * site.bsdf.through_weight(place.normal.dot(place.to_eye));
        if weight == Vec3::ZERO {
            return;
        }
        let Some(bent) = fresnel::refract(-place.to_eye, place.normal, site.bsdf.eta) else { return };
        let direction = arithmetic::above(bent, -place.geometric_normal);
        let is_too_deep = site.ray.depth >= self.request.tree.bounces;
        if !self.request.tree.refractions || is_too_deep {
            node.own += weight * self.lights.environment.radiance(direction);
            node.cut_by_depth += u32::from(self.request.tree.refractions);
            return;
        }
        self.push_followed(site, node, Kind::Refracted, Ray::new(place.origin_inside, direction), weight);
    }

    fn push_followed(&self, site: &Site<'_>, node: &mut Node, kind: Kind, ray: Ray, weight: Vec3) {
        if weight.x.max(weight.y).max(weight.z) < self.request.tree.smallest_weight {
            node.cut_by_weight += 1;
            return;
        }
        let ray = ray.with_mask(site.ray.ray.mask);
        node.rays.push(TreeRay { ray, weight, kind, depth: site.ray.depth + 1, left: site.place.triangle });
    }
}

fn push_occlusion(site: &Site<'_>, node: &mut Node, kind: Kind, ray: Ray, weight: Vec3) {
    if weight != Vec3::ZERO {
        node.rays.push(TreeRay { ray, weight, kind, depth: site.ray.depth + 1, left: site.place.triangle });
    }
}
