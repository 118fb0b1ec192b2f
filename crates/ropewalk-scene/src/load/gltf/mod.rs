//! glTF 2.0, as JSON text with buffers beside it or in it, and GLB (Khronos, ISO/IEC 12113).
//!
//! A mesh that the scene uses becomes an object, its primitives the object's geometries in their order; a node with
//! a mesh becomes an instance. Normals, texture coordinates, materials, cameras and lights come along, and the
//! pictures of materials ([`pictures`]). Morph targets are not read: the report says how many there are. Animations and skins are read where motion is asked for
//! ([`motion`]); else geometry stands as stored.
//!
//! **Nothing in a document is trusted.** It is plain data ([`document`]) whose references are checked once;
//! every byte of a buffer goes through [`accessor`], which checks its bounds before anything is allocated; the node
//! graph is walked without recursion ([`nodes`]); and the geometry of a file has a budget ([`primitive`]).
//!
//! The cost is one pass over the JSON, one over the used nodes, and one over the used triangles.

mod accessor;
mod animation;
mod buffers;
mod container;
mod curve;
mod document;
mod extensions;
mod looks;
mod motion;
mod moving_document;
mod nodes;
mod picture_document;
mod pictures;
mod primitive;
mod skin;
mod topology;
mod uri;

use super::placement::Placement;
use super::source::Source;
use crate::{Animated, LoadError, LoadReport, Material, Model};
use buffers::Buffers;
use container::Container;
use document::{Document, get};
use glam::{Affine3A, DAffine3, DVec3, Vec3};
use moving_document::MovingDocument;
use nodes::Placed;
use primitive::{Kept, PrimitiveReader};
use ropewalk::{Aabb, Instance, Object, Transform};
use std::collections::{BTreeMap, HashSet};

/// Loads a glTF or GLB file.
pub(crate) fn load(source: &Source) -> Result<Model, LoadError> {
    let container = Container::open(source)?;
    let (document, mut report) = open(source, &container)?;
    let placed = nodes::walk(&document, &mut report);
    let buffers = Buffers::new(source, &document, container.binary);
    Ok(read(&buffers, &placed, report, Moves::No)?.model)
}

/// Loads a glTF or GLB file with its animations and skins. What is flattened to nothing at first is hidden; each mesh that
/// follows a skin is an object of its own.
pub(crate) fn load_animated(source: &Source) -> Result<Animated, LoadError> {
    let container = Container::open(source)?;
    let (document, mut report) = open(source, &container)?;
    let moving = MovingDocument::parse(source, container.json)?;
    let placed = nodes::walk(&document, &mut report);
    let buffers = Buffers::new(source, &document, container.binary);
    if moving.animations.is_empty() {
        return Ok(Animated::still(read(&buffers, &placed, report, Moves::No)?.model));
    }
    let mut loaded = read(&buffers, &placed, report, Moves::Yes)?;
    let skinned = motion::read_skins(&buffers, &moving, &placed, &mut loaded);
    let clips = animation::read(&buffers, &moving, &mut loaded.model.report);
    drop(buffers);
    Ok(motion::animated(document, placed, loaded, skinned, clips))
}

/// The document of a file, whose references lead somewhere.
fn open(source: &Source, container: &Container<'_>) -> Result<(Document, LoadReport), LoadError> {
    let document = Document::parse(source, container.json)?;
    let mut report = LoadReport { format: container.format.into(), ..LoadReport::default() };
    extensions::check(source, &document, &mut report)?;
    document.check_references(source)?;
    Ok((document, report))
}

/// Whether a scene is read with its motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Moves {
    No,
    Yes,
}

/// For each mesh that is used, the vertices that its primitives kept.
type KeptOf = BTreeMap<u64, Vec<Kept>>;

/// A model, and where its parts come from.
struct Loaded {
    model: Model,
    /// For each instance, the mesh that it shows and the place of its node.
    instances: Vec<(u64, Option<usize>)>,
    kept: KeptOf,
    /// The places of the nodes of cameras and lights.
    cameras: Vec<usize>,
    lights: Vec<usize>,
}

fn read(
    buffers: &Buffers<'_>,
    placed: &[Placed],
    mut report: LoadReport,
    moves: Moves,
) -> Result<Loaded, LoadError> {
    let document = buffers.document;
    let instances = instances(document, placed, &mut report);
    let mut model = Model { up: Some(Vec3::Y), report, ..Model::default() };
    let (objects, kept) = read_objects(buffers, &instances, &mut model)?;
    pictures::read(buffers, &mut model);
    let sources = place(document, &objects, &instances, moves, &mut model);
    let (mut cameras, mut lights) = (Vec::new(), Vec::new());
    for (index, node) in placed.iter().enumerate() {
        let origin = model.scene.origin;
        model.cameras.extend(looks::camera(document, node, origin, &mut model.report));
        cameras.resize(model.cameras.len(), index);
        model.lights.extend(looks::light(document, node, origin, &mut model.report));
        lights.resize(model.lights.len(), index);
    }
    note_what_is_not_read(document, &instances, moves, &mut model.report);
    Ok(Loaded { model, instances: sources, kept, cameras, lights })
}

/// A mesh placed by a node.
struct MeshInstance {
    mesh: u64,
    /// `None` where no node places the mesh.
    node: Option<usize>,
    /// The node's place among those of the scene.
    place: Option<usize>,
    to_world: DAffine3,
}

/// The meshes that the scene shows. A file without nodes is a collection of meshes: each is shown once as it is.
fn instances(document: &Document, placed: &[Placed], report: &mut LoadReport) -> Vec<MeshInstance> {
    if document.nodes.is_empty() && !document.meshes.is_empty() {
        report.notes.push("the file has no nodes: every mesh is shown once, as it is stored".into());
        let meshes = 0..document.meshes.len() as u64;
        let as_stored = |mesh| MeshInstance { mesh, node: None, place: None, to_world: DAffine3::IDENTITY };
        return meshes.map(as_stored).collect();
    }
    let of_node = |(place, placed): (usize, &Placed)| {
        let mesh = document.nodes.get(placed.node)?.mesh?;
        Some(MeshInstance { mesh, node: Some(placed.node), place: Some(place), to_world: placed.to_world })
    };
    placed.iter().enumerate().filter_map(of_node).collect()
}

/// Reads the meshes that are used, in the order of the file, and the materials. Returns each mesh's object, and which vertices
/// its primitives kept.
fn read_objects(
    buffers: &Buffers<'_>,
    instances: &[MeshInstance],
    model: &mut Model,
) -> Result<(BTreeMap<u64, u32>, KeptOf), LoadError> {
    let document = buffers.document;
    // The name of the first node serves where a mesh has none.
    let mut used = BTreeMap::new();
    for instance in instances {
        let node = instance.node.and_then(|node| document.nodes.get(node));
        used.entry(instance.mesh).or_insert_with(|| node.and_then(|node| node.name.as_ref()));
    }
    let mut reader = PrimitiveReader::new(buffers);
    let mut counted = HashSet::new();
    let (mut objects, mut kept) = (BTreeMap::new(), BTreeMap::new());
    for (index, node_name) in used {
        let Some(mesh) = get(&document.meshes, index) else {
            continue;
        };
        let mut object = Object::default();
        let mut surfaces = Vec::new();
        let mut kept_of = Vec::new();
        for (part, primitive) in mesh.primitives.iter().enumerate() {
            let place = format!("meshes[{index}].primitives[{part}]");
            let (geometry, surface, kept) = reader.read(primitive, &place, &mut model.report)?;
            object.geometries.push(geometry);
            surfaces.push(surface);
            kept_of.push(kept);
            if let Some(position) = primitive.attributes.position.filter(|&position| counted.insert(position))
            {
                let count = get(&document.accessors, position).map_or(0, |accessor| accessor.count);
                let sum = (model.report.vertices as u64).saturating_add(count);
                model.report.vertices = usize::try_from(sum).unwrap_or(usize::MAX);
            }
        }
        kept.insert(index, kept_of);
        objects.insert(index, model.scene.add_object(object));
        model.surfaces.push(surfaces);
        model.object_names.push(mesh.name.as_ref().or(node_name).cloned().unwrap_or_default());
    }
    model.materials = document.materials.iter().map(looks::material).collect();
    if reader.uses_default_material {
        // The neutral one that all formats share. The default of the specification is white metal, which is
        // black where there is nothing to mirror.
        model.materials.push(Material { name: "default".into(), ..Material::default() });
    }
    Ok((objects, kept))
}

/// Chooses the scene's origin and places the objects, leaving out and counting what cannot be placed, or hiding it where it
/// moves. Returns the mesh of each instance of the scene, and its node's place.
fn place(
    document: &Document,
    objects: &BTreeMap<u64, u32>,
    instances: &[MeshInstance],
    moves: Moves,
    model: &mut Model,
) -> Vec<(u64, Option<usize>)> {
    let mut placed = Vec::with_capacity(instances.len());
    for instance in instances {
        let Some(&object) = objects.get(&instance.mesh) else {
            continue;
        };
        if let Err(error) = transform(&instance.to_world, DVec3::ZERO) {
            if moves == Moves::Yes {
                placed.push((object, instance, None));
                continue;
            }
            let what = match error {
                ropewalk::TransformError::NotFinite => "instances whose transform is not finite",
                _ => "instances whose transform is singular, with a scale of 0 for example",
            };
            model
                .report
                .skip(what, || instance.node.map_or_else(String::new, |node| document.node_place(node)));
            continue;
        }
        placed.push((object, instance, Some(instance.to_world)));
    }
    let bounds: Vec<Aabb> = model.scene.objects.iter().map(Object::bounds).collect();
    let there = placed.iter().filter_map(|(object, _, to_world)| Some((object, (*to_world)?)));
    let corners = there.flat_map(|(object, to_world)| {
        let bounds = bounds.get(*object as usize).filter(|bounds| !bounds.is_empty());
        bounds.into_iter().flat_map(corners).map(move |corner| to_world.transform_point3(corner))
    });
    let origin = Placement::of(corners).origin;
    model.scene.origin = origin;
    let mut sources = Vec::with_capacity(placed.len());
    for (object, instance, to_world) in placed {
        let source = (instance.mesh, instance.place);
        match to_world.map(|to_world| transform(&to_world, origin)) {
            Some(Ok(transform)) => {
                model.scene.add_instance(object, transform);
                sources.push(source);
            }
            None => {
                let hidden = Instance { mask: 0, ..Instance::new(object, Transform::IDENTITY) };
                model.scene.instances.push(hidden);
                sources.push(source);
            }
            Some(Err(_)) => model.report.skip("instances too far from the others to be placed", String::new),
        }
    }
    sources
}

fn transform(to_world: &DAffine3, origin: DVec3) -> Result<Transform, ropewalk::TransformError> {
    let translation = (to_world.translation - origin).as_vec3();
    Transform::new(Affine3A::from_mat3_translation(to_world.matrix3.as_mat3(), translation))
}

fn corners(bounds: &Aabb) -> impl Iterator<Item = DVec3> + use<> {
    let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
    (0..8).map(move |corner| {
        let pick = |axis: usize, low: f64, high: f64| if corner >> axis & 1 == 0 { low } else { high };
        DVec3::new(pick(0, min.x, max.x), pick(1, min.y, max.y), pick(2, min.z, max.z))
    })
}

fn note_what_is_not_read(
    document: &Document,
    instances: &[MeshInstance],
    moves: Moves,
    report: &mut LoadReport,
) {
    let used: HashSet<u64> = instances.iter().map(|instance| instance.mesh).collect();
    let primitives = || document.meshes.iter().flat_map(|mesh| &mesh.primitives);
    let skinned = instances.iter().filter(|instance| {
        let node = instance.node.and_then(|node| document.nodes.get(node));
        node.is_some_and(|node| node.skin.is_some())
    });
    let blended = |material: &&document::Material| material.alpha_mode.as_deref() == Some("BLEND");
    let spots = document.extensions.punctual.lights.iter().filter(|light| light.kind == "spot");
    let still = moves == Moves::No;
    let rows = [
        (document.meshes.len().saturating_sub(used.len()), "meshes", "not part of the scene, left out"),
        (
            primitives().filter(|primitive| primitive.attributes.color.is_some()).count(),
            "primitives",
            "vertex colours not read",
        ),
        (
            document.materials.iter().filter(blended).count(),
            "materials",
            "blended by alpha; light goes through, and pictures have holes where their alpha is below 0.5",
        ),
        (if still { skinned.count() } else { 0 }, "skinned meshes", "shown as stored, in the rest pose"),
        (
            primitives().filter(|primitive| !primitive.targets.is_empty()).count(),
            "primitives",
            "morph targets not read",
        ),
        (if still { document.animations.len() } else { 0 }, "animations", "not read"),
        (spots.count(), "spot lights", "shine in all directions"),
    ];
    let rows = rows.into_iter().filter(|&(count, ..)| count > 0);
    report.notes.extend(rows.map(|(count, what, fate)| format!("{count} {what}: {fate}")));
}
