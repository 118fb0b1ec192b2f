//! From a [`Document`] to a model: faces checked, polygons cut, every object with vertices of its own.

use super::document::{Corner, Document, Face, NONE};
use super::maps::MapReader;
use super::mtl::Materials;
use crate::load::placement::Placement;
use crate::load::polygon::{Cutter, newell_normal};
use crate::{CornerAttribute, LoadReport, Material, MaterialAssignment, Model, Surface};
use glam::{DVec3, Vec2};
use ropewalk::{Mesh, Transform};

/// Why a face is skipped that names a vertex which the file does not have.
pub(super) const NO_SUCH_VERTEX: &str = "faces that name a vertex that is not there";

/// Makes the model.
pub(super) fn assemble(mut document: Document, library: Materials) -> Model {
    let mut report = std::mem::take(&mut document.report);
    let faces = sound_faces(&document, &mut report);
    let used = faces.iter().flat_map(|(_, corners)| *corners);
    let placement =
        Placement::of(used.filter_map(|corner| document.positions.get(corner.vertex as usize).copied()));
    let mut maps = MapReader::default();
    let (materials, material_of_name) = used_materials(&document, &faces, &library, &mut maps, &mut report);

    let mut model = Model { materials, ..Model::default() };
    model.scene.origin = placement.origin;
    let mut builder = ObjectBuilder::new(&document, placement);
    for faces in faces.chunk_by(|(one, _), (other, _)| one.object == other.object) {
        let (mesh, surface) = builder.object(faces, &material_of_name);
        let name = faces.first().and_then(|(face, _)| document.objects.get(face.object as usize));
        model.object_names.push(name.cloned().unwrap_or_default());
        let object = model.scene.add_object(mesh);
        model.scene.add_instance(object, Transform::IDENTITY);
        model.surfaces.push(vec![surface]);
    }
    if builder.guesses > 0 {
        report.notes.push(format!(
            "{} polygons cross themselves or are too long and were cut into fans; the first is on line {}",
            builder.guesses, builder.first_guess
        ));
    }
    model.report = report;
    maps.textures.finish(&mut model);
    model
}

type Polygon<'a> = (&'a Face, &'a [Corner]);

/// The faces that can be made, objects in the order of their first such face, each object's in the file's order.
fn sound_faces<'a>(document: &'a Document, report: &mut LoadReport) -> Vec<Polygon<'a>> {
    let mut sound: Vec<Polygon> = Vec::with_capacity(document.faces.len());
    for (face, corners) in document.faces() {
        let place = || format!("line {}", face.line);
        if corners.iter().any(|corner| corner.vertex as usize >= document.positions.len()) {
            report.skip(NO_SUCH_VERTEX, place);
        } else if !document.unreadable.is_empty()
            && corners.iter().any(|corner| document.unreadable.contains(&corner.vertex))
        {
            report.skip("faces that use a vertex with an unreadable number", place);
        } else {
            let mut count_missing = |index: u32, count: usize, what: &str| {
                if index != NONE && index as usize >= count {
                    report.skip(what, place);
                }
            };
            for corner in corners {
                count_missing(corner.normal, document.normals.len(), "corners whose normal is not there");
                let coordinates = document.texture_coordinates.len();
                let what = "corners whose texture coordinate is not there";
                count_missing(corner.texture_coordinate, coordinates, what);
            }
            sound.push((face, corners));
        }
    }
    // Stable: the file's order stays. Objects are numbered by their first face.
    sound.sort_by_key(|(face, _)| face.object);
    sound
}

/// The materials that faces use: first those of the libraries in their order, then those that are in none. Also which
/// of them each name means; the last one is the material of faces without a name.
fn used_materials(
    document: &Document,
    faces: &[Polygon],
    library: &Materials,
    maps: &mut MapReader,
    report: &mut LoadReport,
) -> (Vec<Material>, Vec<u32>) {
    let nameless = document.materials.len();
    let mut is_used = vec![false; nameless + 1];
    for (face, _) in faces {
        is_used[(face.material as usize).min(nameless)] = true;
    }
    let names = document.materials.iter().zip(&is_used).enumerate().filter(|(_, (_, is_used))| **is_used);
    let mut in_library = Vec::new();
    let mut in_none = Vec::new();
    for (index, (name, _)) in names {
        match library.by_name.get(name) {
            Some(&at) => in_library.push((at, index)),
            None => in_none.push(index),
        }
    }
    in_library.sort_unstable();
    if let Some(&first) = in_none.first() {
        let name = &document.materials[first];
        report.notes.push(format!("{} materials are in no library; the first is '{name}'", in_none.len()));
    }
    let mut materials = Vec::new();
    let mut of_name = vec![0; nameless + 1];
    let found = in_library.into_iter().map(|(at, index)| {
        let mut material = library.list.get(at as usize).cloned();
        if let (Some(material), Some(of_it)) = (&mut material, library.maps.get(at as usize)) {
            maps.add(of_it, material);
        }
        (index, material)
    });
    let made = in_none.into_iter().map(|index| (index, None));
    let of_nameless = is_used[nameless].then(|| (nameless, Some(Material::default())));
    for (index, material) in found.chain(made).chain(of_nameless) {
        of_name[index] = materials.len() as u32;
        let of_its_name = || Material { name: document.materials[index].clone(), ..Material::default() };
        materials.push(material.unwrap_or_else(of_its_name));
    }
    (materials, of_name)
}

/// Makes objects one after the other, keeping its tables.
struct ObjectBuilder<'a> {
    document: &'a Document,
    placement: Placement,
    cutter: Cutter,
    polygon: Vec<DVec3>,
    vertices: Renumbering,
    normals: Renumbering,
    texture_coordinates: Renumbering,
    guesses: usize,
    first_guess: usize,
}

impl<'a> ObjectBuilder<'a> {
    fn new(document: &'a Document, placement: Placement) -> Self {
        Self {
            document,
            placement,
            cutter: Cutter::new(),
            polygon: Vec::new(),
            vertices: Renumbering::new(document.positions.len()),
            normals: Renumbering::new(document.normals.len()),
            texture_coordinates: Renumbering::new(document.texture_coordinates.len()),
            guesses: 0,
            first_guess: 0,
        }
    }

    fn object(&mut self, faces: &[Polygon], material_of_name: &[u32]) -> (Mesh, Surface) {
        let document = self.document;
        self.vertices.start();
        self.normals.start();
        self.texture_coordinates.start();
        let mut mesh = Mesh::default();
        let mut normals = Attribute::new(faces, document.normals.len(), |corner| corner.normal);
        let mut texture_coordinates =
            Attribute::new(faces, document.texture_coordinates.len(), |corner| corner.texture_coordinate);
        let mut materials = Vec::new();
        let (mut corners_here, mut normals_here, mut coordinates_here) = (Vec::new(), Vec::new(), Vec::new());
        for &(face, corners) in faces {
            self.polygon.clear();
            corners_here.clear();
            for corner in corners {
                let position = document.positions.get(corner.vertex as usize).copied().unwrap_or(DVec3::NAN);
                self.polygon.push(position);
                let place = || self.placement.place(position);
                corners_here.push(self.vertices.renumber(corner.vertex, &mut mesh.positions, place));
            }
            if let Some(normals) = &mut normals {
                let own = || newell_normal(&self.polygon).normalize_or_zero().as_vec3();
                normals.corners(corners, &document.normals, &mut self.normals, own, &mut normals_here);
            }
            if let Some(coordinates) = &mut texture_coordinates {
                let (values, numbers) = (&document.texture_coordinates, &mut self.texture_coordinates);
                coordinates.corners(corners, values, numbers, || Vec2::ZERO, &mut coordinates_here);
            }
            let pieces = self.cutter.cut(&self.polygon);
            if pieces.is_guess {
                self.guesses += 1;
                if self.guesses == 1 {
                    self.first_guess = face.line;
                }
            }
            let name = (face.material as usize).min(material_of_name.len() - 1);
            for triangle in pieces.triangles {
                let pick = |from: &[u32]| triangle.map(|corner| from[corner as usize]);
                mesh.triangles.push(pick(&corners_here));
                if let Some(normals) = &mut normals {
                    normals.indices.push(pick(&normals_here));
                }
                if let Some(coordinates) = &mut texture_coordinates {
                    coordinates.indices.push(pick(&coordinates_here));
                }
                materials.push(material_of_name[name]);
            }
        }
        let surface = Surface {
            normals: normals.map(|normals| normals.finish(&mesh)),
            texture_coordinates: texture_coordinates.map(|coordinates| coordinates.finish(&mesh)),
            materials: match materials.first() {
                Some(&first) if materials.iter().all(|&material| material == first) => {
                    MaterialAssignment::One(first)
                }
                _ => MaterialAssignment::PerTriangle(materials),
            },
        };
        (mesh, surface)
    }
}

/// From the file's numbers to an object's, in the order of first use. Starting on the next object costs nothing.
struct Renumbering {
    object: u32,
    /// For each of the file's values: the object that used it last, and its number there.
    last: Vec<(u32, u32)>,
}

impl Renumbering {
    fn new(count: usize) -> Self {
        Self { object: 0, last: vec![(0, 0); count] }
    }

    fn start(&mut self) {
        self.object += 1;
    }

    fn renumber<T>(&mut self, index: u32, values: &mut Vec<T>, value: impl FnOnce() -> T) -> u32 {
        let next = values.len() as u32;
        match self.last.get_mut(index as usize) {
            Some((object, number)) if *object == self.object => *number,
            last => {
                if let Some(last) = last {
                    *last = (self.object, next);
                }
                values.push(value());
                next
            }
        }
    }
}

/// A corner attribute while an object is made.
struct Attribute<T> {
    values: Vec<T>,
    indices: Vec<[u32; 3]>,
    index: fn(&Corner) -> u32,
}

impl<T: Copy> Attribute<T> {
    /// None when no corner has it.
    fn new(faces: &[Polygon], values: usize, index: fn(&Corner) -> u32) -> Option<Self> {
        let mut corners = faces.iter().flat_map(|(_, corners)| *corners);
        let is_used = corners.any(|corner| (index(corner) as usize) < values);
        is_used.then_some(Self { values: Vec::new(), indices: Vec::new(), index })
    }

    /// Puts the numbers of a face's corners into `numbers`. Corners without a value share a stand-in.
    fn corners(
        &mut self,
        corners: &[Corner],
        values: &[T],
        renumbering: &mut Renumbering,
        stand_in: impl Fn() -> T,
        numbers: &mut Vec<u32>,
    ) {
        numbers.clear();
        let mut shared = None;
        for index in corners.iter().map(self.index) {
            numbers.push(match values.get(index as usize) {
                Some(&value) => renumbering.renumber(index, &mut self.values, || value),
                None => *shared.get_or_insert_with(|| {
                    self.values.push(stand_in());
                    self.values.len() as u32 - 1
                }),
            });
        }
    }

    fn finish(self, mesh: &Mesh) -> CornerAttribute<T> {
        let same = self.indices == mesh.triangles;
        CornerAttribute { values: self.values, indices: (!same).then_some(self.indices) }
    }
}
