//! From a [`Document`] to a model at one time.

use super::animation::Keyframes;
use super::document::{Deforming, Document, Standing, standing};
use super::part::Part;
use super::shape::{Shape, Values};
use crate::load::placement::Placement;
use crate::{LoadReport, Model};
use glam::{Affine3A, DAffine3, DVec3, Vec3};
use ropewalk::{Instance, Transform, TransformError};

/// An object on its way into the model.
struct Object {
    node: Option<usize>,
    part: Part,
    standing: Standing,
}

/// What becomes of an instance whose transform cannot be undone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Unplaceable {
    /// It is left out and counted.
    LeftOut,
    /// It is hidden: at other times it has a place.
    Hidden,
}

/// A model, and where its parts come from.
#[derive(Debug)]
pub(super) struct Assembled {
    pub(super) model: Model,
    /// The animated block in which each instance stands.
    pub(super) nodes: Vec<Option<usize>>,
    /// The objects of triangles with keys, and the block of each.
    pub(super) deforming: Vec<(u32, Option<usize>, Vec<Deforming>)>,
    /// What is left of the document: all that moves.
    pub(super) document: Document,
}

/// Makes the model of a time.
pub(super) fn assemble(document: Document, time: f64) -> Model {
    let mut assembled = assemble_whole(document, time, Unplaceable::LeftOut);
    let tracks: usize = assembled.document.keyframes.values().map(Keyframes::tracks).sum();
    let triangles: usize = assembled.deforming.iter().map(|(.., triangles)| triangles.len()).sum();
    let rows = [(tracks, "keyframe tracks"), (triangles, "animated triangles")];
    let rows = rows.into_iter().filter(|&(count, _)| count > 0);
    let notes = rows.map(|(count, what)| format!("{count} {what}: shown as at time {time}"));
    assembled.model.report.notes.splice(0..0, notes);
    assembled.model
}

/// Makes the model of a time, and keeps what moves it.
pub(super) fn assemble_whole(mut document: Document, time: f64, unplaceable: Unplaceable) -> Assembled {
    let standings = document.standings(time);
    let rigid = std::mem::take(&mut document.rigid);
    let deforming = std::mem::take(&mut document.deforming);
    let object =
        |(node, part): (Option<usize>, Part)| Object { node, part, standing: standing(&standings, node) };
    let is_full = |(_, part): &(Option<usize>, Part)| !part.triangles.is_empty();
    let mut objects: Vec<Object> = rigid.into_iter().filter(is_full).map(object).collect();
    let mut deforming_objects = Vec::new();
    for (node, triangles) in deforming {
        let part = (node, deformed(&triangles, time));
        if is_full(&part) {
            deforming_objects.push((objects.len() as u32, node, triangles));
            objects.push(object(part));
        }
    }

    let origin = Placement::of(objects.iter().flat_map(Object::positions_in_world)).origin;
    let mut model = Model { up: Some(Vec3::Y), ..Model::default() };
    model.scene.origin = origin;
    model.report = std::mem::take(&mut document.report);
    model.materials = std::mem::take(&mut document.materials);
    std::mem::take(&mut document.pictures).finish(&mut model);
    (model.background, model.ambient) = document.surroundings(&model.report.format);
    let mut nodes = Vec::with_capacity(objects.len());
    for object in objects {
        let node = object.node;
        place(&document, object, origin, unplaceable, &mut model);
        // One that is left out has none.
        nodes.resize(model.scene.instances.len(), node);
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
        let at = light.at(time, track, &standing(&standings, light.node), origin);
        if at.is_none() {
            model.report.skip("lights that cannot be placed", String::new);
        }
        model.lights.extend(at);
    }
    note_what_is_not_read(&document, &mut model.report);
    Assembled { model, nodes, deforming: deforming_objects, document }
}

impl Object {
    fn positions_in_world(&self) -> impl Iterator<Item = DVec3> {
        let to_world = self.standing.to_world;
        self.part.positions.iter().map(move |&at| to_world.transform_point3(at))
    }
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
            texture: None,
        };
        // There are fewer of them than bytes in memory: they cannot be too many.
        if part.add(&shape, to_node, *material).is_err() {
            break;
        }
    }
    part
}

/// Adds an object with its instance. What stands in no animated block is stored as it stands in the world.
fn place(document: &Document, object: Object, origin: DVec3, unplaceable: Unplaceable, model: &mut Model) {
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
        Err(_) if unplaceable == Unplaceable::Hidden => {
            let hidden = Instance { mask: 0, ..Instance::new(index, Transform::IDENTITY) };
            model.scene.instances.push(hidden);
        }
        Err(TransformError::NotFinite) => {
            model.report.skip("objects whose transform is not finite", || name.into());
        }
        Err(_) => model
            .report
            .skip("objects whose transform is singular, with a scale of 0 for example", || name.into()),
    }
}

pub(super) fn transform(to_world: &DAffine3, origin: DVec3) -> Result<Transform, TransformError> {
    let translation = (to_world.translation - origin).as_vec3();
    Transform::new(Affine3A::from_mat3_translation(to_world.matrix3.as_mat3(), translation))
}

fn note_what_is_not_read(document: &Document, report: &mut LoadReport) {
    let rows = [
        (document.spheres, "spheres", "made of triangles, with 32 sides"),
        (document.cones, "cones", "made of triangles, with 32 sides"),
    ];
    let rows = rows.into_iter().filter(|&(count, ..)| count > 0);
    report.notes.extend(rows.map(|(count, what, fate)| format!("{count} {what}: {fate}")));
}
