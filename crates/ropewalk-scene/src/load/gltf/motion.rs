//! A scene that moves: nodes by their curves, skinned meshes by their joints, cameras and lights by their nodes.

use super::animation::Tracks;
use super::buffers::Buffers;
use super::document::Document;
use super::moving_document::MovingDocument;
use super::nodes::{Local, Placed};
use super::skin::{self, SkinnedObject};
use super::{Loaded, looks, transform};
use crate::animation::{Animated, Clip, Motion, ObjectShape, Pose};
use crate::{Camera, Light, LoadReport};
use glam::{Affine3A, DAffine3, DVec3};
use ropewalk::{Ray, Transform};
use std::collections::HashMap;
use std::sync::Arc;

/// The skins of a scene that is read: the object of each and what it follows. Its instance stands in the scene's own space
/// then, and shares its object with no other.
pub(super) fn read_skins(
    buffers: &Buffers<'_>,
    moving: &MovingDocument,
    placed: &[Placed],
    loaded: &mut Loaded,
) -> Vec<(u32, SkinnedObject)> {
    let Loaded { model, instances, kept, .. } = loaded;
    let place_of: HashMap<u64, usize> =
        placed.iter().enumerate().map(|(place, placed)| (placed.node as u64, place)).collect();
    let mut users = vec![0_usize; model.scene.objects.len()];
    for instance in &model.scene.instances {
        if let Some(users) = users.get_mut(instance.object as usize) {
            *users += 1;
        }
    }
    let mut budget = skin::Budget::default();
    let mut skinned = Vec::new();
    for (index, (mesh, place)) in instances.iter_mut().enumerate() {
        let Some(node) = place.and_then(|place| placed.get(place)).map(|placed| placed.node) else {
            continue;
        };
        let Some(instance) = model.scene.instances.get_mut(index) else { continue };
        let object = instance.object as usize;
        let (Some(meshes), Some(surfaces)) = (model.scene.objects.get(object), model.surfaces.get(object))
        else {
            continue;
        };
        let kept = kept.get(mesh).map_or(&[][..], Vec::as_slice);
        let geometries: Vec<_> = meshes
            .geometries
            .iter()
            .zip(surfaces)
            .zip(kept)
            .map(|((mesh, surface), kept)| (mesh, surface, kept))
            .collect();
        let find = |node| place_of.get(&node).copied();
        let read = skin::read(buffers, moving, node, &geometries, find, &mut budget, &mut model.report);
        let Some(skin) = read else { continue };
        if let Some(users) = users.get_mut(object).filter(|users| **users > 1) {
            *users -= 1;
            let (meshes, surfaces) = (meshes.clone(), surfaces.clone());
            instance.object = model.scene.objects.len() as u32;
            model.scene.objects.push(meshes);
            model.surfaces.push(surfaces);
            let name = model.object_names.get(object).cloned().unwrap_or_default();
            model.object_names.push(name);
        }
        (instance.transform, instance.mask) = (Transform::IDENTITY, Ray::ALL);
        *place = None;
        skinned.push((instance.object, skin));
    }
    skinned
}

/// The scene with its clips.
pub(super) fn animated(
    document: Document,
    placed: Vec<Placed>,
    loaded: Loaded,
    skinned: Vec<(u32, SkinnedObject)>,
    clips: Vec<(Clip, Tracks)>,
) -> Animated {
    let Loaded { model, instances, cameras, lights, .. } = loaded;
    let (clips, tracks): (Vec<Clip>, Vec<Tracks>) = clips.into_iter().unzip();
    // Parents come before children.
    let mut moves = vec![false; placed.len()];
    for (place, node) in placed.iter().enumerate() {
        moves[place] = node.parent.is_some_and(|parent| moves[parent])
            || tracks.iter().any(|tracks| tracks.moves(node.node));
    }
    let moving = |place: Option<usize>| place.filter(|&place| moves.get(place) == Some(&true));
    let rest = model.scene.instances.iter().map(|instance| *instance.transform.to_world());
    let movement = Movement {
        document,
        origin: model.scene.origin,
        instances: rest.zip(instances).map(|(rest, (_, place))| (rest, moving(place))).collect(),
        hidden: model.scene.instances.iter().map(|instance| instance.mask == 0).collect(),
        skinned,
        cameras: cameras.into_iter().zip(model.cameras.iter().cloned()).collect(),
        lights: lights.into_iter().zip(model.lights.iter().cloned()).collect(),
        placed,
        clips: tracks,
    };
    Animated::new(model, clips, Arc::new(movement))
}

/// What moves in a document.
#[derive(Debug)]
struct Movement {
    document: Document,
    /// The nodes of the scene as they rest, parents before children.
    placed: Vec<Placed>,
    clips: Vec<Tracks>,
    origin: DVec3,
    /// Where the instances rest, and the place of the node that moves each; `None` for one that nothing moves.
    instances: Vec<(Affine3A, Option<usize>)>,
    /// Whether each instance rests flattened to nothing.
    hidden: Vec<bool>,
    skinned: Vec<(u32, SkinnedObject)>,
    /// The places of the nodes that the cameras and lights stand at.
    cameras: Vec<(usize, Camera)>,
    lights: Vec<(usize, Light)>,
}

impl Movement {
    /// Where every node of the scene is at a time.
    fn to_world(&self, tracks: &Tracks, time: f64) -> Vec<DAffine3> {
        let mut to_world: Vec<DAffine3> = self.placed.iter().map(|placed| placed.to_world).collect();
        let mut has_moved = vec![false; self.placed.len()];
        for (place, placed) in self.placed.iter().enumerate() {
            let parent = placed.parent;
            let parent_moved = parent.is_some_and(|parent| has_moved[parent]);
            if !parent_moved && !tracks.moves(placed.node) {
                continue;
            }
            let Some(node) = self.document.nodes.get(placed.node) else { continue };
            let parent = parent.map_or(DAffine3::IDENTITY, |parent| to_world[parent]);
            let local = match Local::of(node) {
                Some(rest) => tracks.local(placed.node, rest, time).to_parent(),
                None => super::nodes::local(node),
            };
            to_world[place] = parent * local;
            has_moved[place] = true;
        }
        to_world
    }
}

impl Motion for Movement {
    fn pose(&self, clip: usize, time: f64) -> Pose {
        let mut pose = Pose { time, ..Pose::default() };
        let Some(tracks) = self.clips.get(clip) else { return pose };
        let to_world = self.to_world(tracks, time);
        for (&(rest, place), &is_hidden) in self.instances.iter().zip(&self.hidden) {
            let placed = match place.and_then(|place| to_world.get(place)) {
                None => (!is_hidden).then_some(rest),
                Some(to_world) => transform(to_world, self.origin).ok().map(|to| *Transform::to_world(&to)),
            };
            pose.transforms.push(placed.unwrap_or(rest));
            pose.visible.push(placed.is_some());
        }
        let at = |place: usize| {
            let placed = self.placed.get(place)?;
            Some(Placed { to_world: *to_world.get(place)?, ..*placed })
        };
        // What is wrong was told when the file was read; what is wrong at some times keeps its rest.
        let report = &mut LoadReport::default();
        for (place, rest) in &self.cameras {
            let camera = at(*place).and_then(|at| looks::camera(&self.document, &at, self.origin, report));
            pose.cameras.push(camera.unwrap_or_else(|| rest.clone()));
        }
        for (place, rest) in &self.lights {
            let light = at(*place).and_then(|at| looks::light(&self.document, &at, self.origin, report));
            pose.lights.push(light.unwrap_or_else(|| rest.clone()));
        }
        let shape = |(object, skin): &(u32, SkinnedObject)| ObjectShape {
            object: *object,
            geometries: skin.shape(&to_world, self.origin),
        };
        pose.shapes = self.skinned.iter().map(shape).collect();
        pose
    }
}
