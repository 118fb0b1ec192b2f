//! From a [`Document`] to a model at one time.

use super::animation::Keyframes;
use super::document::{Deforming, Document, Standing, standing};
use super::part::Part;
use super::shape::{Shape, Values};
use crate::load::placement::Placement;
use crate::{LoadReport, Model};
use glam::{Affine3A, DAffine3, DVec3, Vec3};
use ropewalk::{Transform, TransformError};

/// An object on its way into the model.
struct Object {
    node: Option<usize>,
    part: Part,
    standing: Standing,
}

/// Makes the model of a time.
pub(super) fn assemble(mut document: Document, time: f64) -> Model {
    let standings = document.standings(time);
    let rigid = std::mem::take(&mut document.rigid);
    let deforming = std::mem::take(&mut document.deforming);
    let deforming_count = deforming.iter().map(|(_, triangles)| triangles.len()).sum();
    let deforming = deforming.into_iter().map(|(node, triangles)| (node, deformed(&triangles, time)));
    let objects: Vec<Object> = rigid
        .into_iter()
        .chain(deforming)
        .filter(|(_, part)| !part.triangles.is_empty())
        .map(|(node, part)| Object { node, part, standing: standing(&standings, node) })
        .collect();

    let origin = Placement::of(objects.iter().flat_map(Object::positions_in_world)).origin;
    let middle = middle(&objects);
    let mut model = Model { up: Some(Vec3::Y), ..Model::default() };
    model.scene.origin = origin;
    model.report = std::mem::take(&mut document.report);
    model.materials = std::mem::take(&mut document.materials);
    for object in objects {
        place(&document, object, origin, &mut model);
    }
    let camera_track = document.keyframes.get("camera");
    if let Some(view) = &document.view {
        let camera = view.camera(time, camera_track, origin);
        if camera.is_none() {
            model.report.skip("views that span no picture", || view.place.clone());
        }
        model.cameras.extend(camera);
    }
    for light in &document.lights {
        let track = light.name().and_then(|name| document.keyframes.get(name));
        let at = light.at(time, track, &standing(&standings, light.node), middle, origin);
        if at.is_none() {
            model.report.skip("lights that cannot be placed", String::new);
        }
        model.lights.extend(at);
    }
    note_what_is_not_read(&document, time, deforming_count, &mut model.report);
    model
}

impl Object {
    fn positions_in_world(&self) -> impl Iterator<Item = DVec3> {
        let to_world = self.standing.to_world;
        self.part.positions.iter().map(move |&at| to_world.transform_point3(at))
    }
}

/// Where the vertices are on average.
fn middle(objects: &[Object]) -> DVec3 {
    let (mut sum, mut count) = (DVec3::ZERO, 0.0);
    for position in objects.iter().flat_map(Object::positions_in_world).filter(|at| at.is_finite()) {
        sum += position;
        count += 1.0;
    }
    if count > 0.0 && sum.is_finite() { sum / count } else { DVec3::ZERO }
}

/// Triangles with keys as they are at a time.
fn deformed(triangles: &[Deforming], time: f64) -> Part {
    let mut part = Part::default();
    for Deforming { triangle, to_node, material } in triangles {
        let Some(corners) = triangle.at(time) else { continue };
        let shape = Shape {
            positions: corners.map(|(position, _)| position).into(),
            triangles: vec![[0, 1, 2]],
            normals: Some(Values {
                values: corners.map(|(_, normal)| normal).into(),
                indices: vec![[0, 1, 2]],
            }),
            coordinates: None,
        };
        // There are fewer of them than bytes in memory: they cannot be too many.
        if part.add(&shape, to_node, *material).is_err() {
            break;
        }
    }
    part
}

/// Adds an object with its instance. What stands in no animated block is stored as it stands in the world.
fn place(document: &Document, object: Object, origin: DVec3, model: &mut Model) {
    let Object { node, part, standing } = object;
    let name = node.and_then(|node| document.nodes.get(node)).map_or("", |node| node.path.as_str());
    let placement = Placement { origin: if node.is_some() { DVec3::ZERO } else { origin } };
    let (mesh, surface) = part.finish(|position| placement.place(position));
    let index = model.scene.add_object(mesh);
    model.object_names.push(name.into());
    model.surfaces.push(vec![surface]);
    let to_scene =
        if node.is_some() { transform(&standing.to_world, origin) } else { Ok(Transform::IDENTITY) };
    match to_scene {
        Ok(transform) => {
            model.scene.add_instance(index, transform);
            if let Some(instance) = model.scene.instances.last_mut().filter(|_| !standing.is_visible) {
                // It stays in its place for the times at which it is shown.
                instance.mask = 0;
            }
        }
        Err(TransformError::NotFinite) => {
            model.report.skip("objects whose transform is not finite", || name.into());
        }
        Err(_) => model
            .report
            .skip("objects whose transform is singular, with a scale of 0 for example", || name.into()),
    }
}

fn transform(to_world: &DAffine3, origin: DVec3) -> Result<Transform, TransformError> {
    let translation = (to_world.translation - origin).as_vec3();
    Transform::new(Affine3A::from_mat3_translation(to_world.matrix3.as_mat3(), translation))
}

fn note_what_is_not_read(document: &Document, time: f64, deforming: usize, report: &mut LoadReport) {
    let tracks: usize = document.keyframes.values().map(Keyframes::tracks).sum();
    let at = format!("shown as at time {time}");
    let rows = [
        (tracks, "keyframe tracks", at.as_str()),
        (deforming, "animated triangles", at.as_str()),
        (document.textures.len(), "textures", "not read; surfaces keep their plain colours"),
        (document.spheres, "spheres", "made of triangles, with 32 sides"),
        (document.cones, "cones", "made of triangles, with 32 sides"),
        (document.lights.len(), "lights", "fall off with distance; in the file they do not"),
    ];
    let rows = rows.into_iter().filter(|&(count, ..)| count > 0);
    report.notes.extend(rows.map(|(count, what, fate)| format!("{count} {what}: {fate}")));
}
