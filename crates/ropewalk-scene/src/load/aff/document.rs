//! What an AFF file says, with all its includes, before anything is placed at a time.

use super::animation::{AnimatedTriangle, Keyframes};
use super::looks::{PlacedLight, View};
use super::part::Part;
use crate::load::textures::Textures;
use crate::{LoadReport, Material};
use glam::{DAffine3, DVec3, Vec3};
use std::collections::HashMap;

/// The statements of a file and of those that it includes.
#[derive(Debug, Default)]
pub(super) struct Document {
    /// The animated blocks, each behind those around it.
    pub(super) nodes: Vec<Node>,
    /// What moves as a whole, in the order of the first shapes, and the block in which it stands.
    pub(super) rigid: Vec<(Option<usize>, Part)>,
    /// What changes its shape: triangles with keys, by the block in which they stand.
    pub(super) deforming: Vec<(Option<usize>, Vec<Deforming>)>,
    pub(super) materials: Vec<Material>,
    pub(super) keyframes: HashMap<String, Keyframes>,
    pub(super) lights: Vec<PlacedLight>,
    pub(super) view: Option<View>,
    /// When the animation starts, when it ends, and how many frames it has; 0 where the file does not say.
    pub(super) start: f64,
    pub(super) end: f64,
    pub(super) frames: u32,
    /// The names of pictures; those of materials are indices into it until [`pictures::read`](super::pictures::read).
    pub(super) textures: Vec<String>,
    pub(super) pictures: Textures,
    pub(super) background: Option<DVec3>,
    pub(super) ambient: Option<DVec3>,
    pub(super) spheres: usize,
    pub(super) cones: usize,
    pub(super) report: LoadReport,
}

/// An animated block.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Node {
    /// The animated block around it.
    pub(super) parent: Option<usize>,
    pub(super) name: String,
    /// The names of the blocks around it and its own.
    pub(super) path: String,
    /// From just outside of this block to the inside of the block around it, through the static blocks between.
    pub(super) to_parent: DAffine3,
}

/// A triangle with keys.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Deforming {
    pub(super) triangle: AnimatedTriangle,
    /// Through the static blocks around it.
    pub(super) to_node: DAffine3,
    pub(super) material: u32,
}

/// Where a block stands at some time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Standing {
    pub(super) to_world: DAffine3,
    pub(super) is_visible: bool,
}

impl Standing {
    /// Outside of all animated blocks.
    pub(super) const WORLD: Self = Self { to_world: DAffine3::IDENTITY, is_visible: true };
}

impl Document {
    /// The radiance of the background and the ambient light, where the file does not say: none, and 1. NFF knows no
    /// ambient light; what its surfaces send on is a tenth, as that of shapes without material.
    pub(super) fn surroundings(&self, format: &str) -> (Option<Vec3>, Option<Vec3>) {
        let ambient = self.ambient.unwrap_or(DVec3::splat(if format == "NFF" { 0.1 } else { 1.0 }));
        let light = |color: DVec3| Some(color.as_vec3().clamp(Vec3::ZERO, Vec3::MAX));
        (light(self.background.unwrap_or(DVec3::ZERO)), light(ambient))
    }

    /// Where each animated block stands at a time.
    pub(super) fn standings(&self, time: f64) -> Vec<Standing> {
        let mut standings: Vec<Standing> = Vec::with_capacity(self.nodes.len());
        let still = Keyframes::default();
        for node in &self.nodes {
            let parent = node.parent.and_then(|parent| standings.get(parent)).unwrap_or(&Standing::WORLD);
            let keyframes = self.keyframes.get(&node.name).unwrap_or(&still);
            standings.push(Standing {
                to_world: parent.to_world * node.to_parent * keyframes.transform(time),
                is_visible: parent.is_visible && keyframes.is_visible(time),
            });
        }
        standings
    }
}

/// Where a block stands, out of the standings of all.
pub(super) fn standing(standings: &[Standing], node: Option<usize>) -> Standing {
    node.and_then(|node| standings.get(node)).copied().unwrap_or(Standing::WORLD)
}
