//! A document that moves: where its blocks, cameras, lights and animated triangles are at a time.

use super::assemble::{Assembled, Unplaceable, assemble_whole, transform};
use super::document::{Deforming, Document, Standing, standing};
use super::part::normal_matrix;
use crate::animation::{Animated, Clip, GeometryShape, MOST_FRAMES, Motion, ObjectShape, Pose, Span};
use crate::{Camera, Light};
use glam::{Affine3A, DVec3, Vec3};
use ropewalk::Transform;
use std::sync::Arc;

/// The scene of a document, moving where it has a span of time.
pub(super) fn animated(document: Document) -> Animated {
    let Document { start, end, frames, .. } = document;
    let assembled = assemble_whole(document, start, Unplaceable::Hidden);
    if frames == 0 {
        return Animated::still(assembled.model);
    }
    let Assembled { model, nodes, deforming, document } = assembled;
    let movement = Movement {
        origin: model.scene.origin,
        rest: model.scene.instances.iter().map(|instance| *instance.transform.to_world()).collect(),
        nodes,
        deforming,
        cameras: model.cameras.clone(),
        lights: placed_lights(&document, &model.lights, start, model.scene.origin),
        document,
    };
    let clip = Clip { name: String::new(), span: Span { start, end, frames: frames.min(MOST_FRAMES) } };
    Animated::new(model, vec![clip], Arc::new(movement))
}

/// The lights of the model, and which of the document's each is: some may have had no place.
fn placed_lights(document: &Document, lights: &[Light], start: f64, origin: DVec3) -> Vec<(usize, Light)> {
    let standings = document.standings(start);
    let has_place = |&number: &usize| light(document, &standings, number, start, origin).is_some();
    (0..document.lights.len()).filter(has_place).zip(lights.iter().cloned()).collect()
}

fn light(
    document: &Document,
    standings: &[Standing],
    number: usize,
    time: f64,
    origin: DVec3,
) -> Option<Light> {
    let light = document.lights.get(number)?;
    let track = light.name().and_then(|name| document.keyframes.get(name));
    light.at(time, track, &standing(standings, light.node), origin)
}

/// What moves.
#[derive(Debug)]
struct Movement {
    document: Document,
    origin: DVec3,
    /// Where the instances are at the start: what stands in no block stays there.
    rest: Vec<Affine3A>,
    nodes: Vec<Option<usize>>,
    deforming: Vec<(u32, Option<usize>, Vec<Deforming>)>,
    cameras: Vec<Camera>,
    lights: Vec<(usize, Light)>,
}

impl Motion for Movement {
    fn pose(&self, _clip: usize, time: f64) -> Pose {
        let time = if time.is_nan() { self.document.start } else { time };
        let standings = self.document.standings(time);
        let mut pose = Pose { time, ..Pose::default() };
        for (&node, &rest) in self.nodes.iter().zip(&self.rest) {
            let standing = standing(&standings, node);
            let placed = match node {
                None => Some(rest),
                Some(_) => {
                    transform(&standing.to_world, self.origin).ok().map(|to| *Transform::to_world(&to))
                }
            };
            pose.transforms.push(placed.unwrap_or(rest));
            pose.visible.push(standing.is_visible && placed.is_some());
        }
        let view = self.document.view.as_ref();
        let track = self.document.keyframes.get("camera");
        let camera = |rest: &Camera| {
            view.and_then(|view| view.camera(time, track, self.origin)).unwrap_or_else(|| rest.clone())
        };
        pose.cameras = self.cameras.iter().map(camera).collect();
        let lights = self.lights.iter().map(|(number, rest)| {
            light(&self.document, &standings, *number, time, self.origin).unwrap_or_else(|| rest.clone())
        });
        pose.lights = lights.collect();
        let shapes = self.deforming.iter().map(|(object, node, triangles)| {
            let origin = if node.is_some() { DVec3::ZERO } else { self.origin };
            ObjectShape { object: *object, geometries: vec![deformed(triangles, time, origin)] }
        });
        pose.shapes = shapes.collect();
        pose
    }
}

/// Where the corners of triangles with keys are at a time, in their block or, relative to the origin, in the world.
fn deformed(triangles: &[Deforming], time: f64, origin: DVec3) -> GeometryShape {
    let mut positions = Vec::with_capacity(3 * triangles.len());
    let mut normals: Vec<Vec3> = Vec::with_capacity(3 * triangles.len());
    for Deforming { triangle, to_node, .. } in triangles {
        let Some(corners) = triangle.at(time) else { continue };
        let to_normal = normal_matrix(&to_node.matrix3);
        for (position, normal) in corners {
            positions.push((to_node.transform_point3(position) - origin).as_vec3());
            normals.push((to_normal * normal).normalize_or_zero().as_vec3());
        }
    }
    GeometryShape { positions, normals: Some(normals) }
}
