//! Packs a stage and its light into words. Whatever is no number, or leads nowhere, is caught here, once, so that the
//! readers need no checks.

use super::layout::{self, HEADER, NOTHING};
use super::{Looks, atlas::Atlas};
use crate::error::RenderError;
use crate::stage::Stage;
use glam::{Affine3A, DVec3, Vec2, Vec3};
use ropewalk::Instance;
use ropewalk_scene::{Filter, Material, Surface, TextureUse, Wrap};
use std::ops::Range;

/// Where a geometry's vertices and normals stand: their first rows, and how many; and how many triangles it has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Part {
    pub(super) triangles: usize,
    pub(super) first_vertex: usize,
    pub(super) vertices: usize,
    pub(super) first_normal: usize,
    pub(super) normals: usize,
}

/// The tables before they are joined.
#[derive(Default)]
struct Tables {
    instances: Vec<u32>,
    geometries: Vec<u32>,
    triangles: Vec<u32>,
    vertices: Vec<u32>,
    normals: Vec<u32>,
    coordinates: Vec<u32>,
    materials: Vec<u32>,
    textures: Vec<u32>,
}

impl Looks {
    /// Packs a stage. `light` are the words of its light, `request` those of what the picture asks for.
    ///
    /// # Errors
    /// When the tables or the textures are larger than indices of 32 bits reach.
    pub(crate) fn new(stage: &Stage, light: &[u32], request: &[u32]) -> Result<Self, RenderError> {
        let model = stage.model();
        let atlas = Atlas::new(&model.textures)?;
        let mut tables = Tables::default();
        let mut uses: Vec<TextureUse> = Vec::new();
        let mut flags = 0;
        for material in model.materials.iter().chain([&Material::default()]) {
            let mut description = |use_: &Option<TextureUse>| {
                let Some(use_) = use_ else { return NOTHING };
                if !atlas.places.get(use_.texture as usize).is_some_and(Option::is_some) {
                    return NOTHING;
                }
                let known = uses.iter().position(|one| one == use_);
                known.unwrap_or_else(|| {
                    uses.push(*use_);
                    uses.len() - 1
                }) as u32
            };
            let descriptions = [
                description(&material.base_color_texture),
                description(&material.emissive_texture),
                description(&material.metallic_roughness_texture),
            ];
            if material.alpha_cutoff > 0.0 {
                flags |= layout::HAS_CUT_OUTS;
            }
            if material.transmission > 0.0 && material.ior == 1.0 {
                flags |= layout::HAS_PANES;
            }
            tables.materials.extend(material_row(material, descriptions));
        }
        for use_ in &uses {
            if let (Some(Some(place)), Some(texture)) =
                (atlas.places.get(use_.texture as usize), model.textures.get(use_.texture as usize))
            {
                tables.textures.extend(texture_row(
                    use_,
                    *place,
                    [texture.width, texture.height],
                    texture.is_srgb,
                ));
            }
        }
        let plain_material = model.materials.len() as u32;
        let mut parts = Vec::new();
        let mut first_parts = Vec::new();
        for (object, surfaces) in model.scene.objects.iter().zip(&model.surfaces) {
            first_parts.push(parts.len());
            for (mesh, surface) in object.geometries.iter().zip(surfaces) {
                let part = Part {
                    triangles: mesh.triangles.len(),
                    first_vertex: tables.vertices.len() / 3,
                    vertices: mesh.positions.len(),
                    first_normal: tables.normals.len() / 3,
                    normals: surface.normals.as_ref().map_or(0, |normals| normals.values.len()),
                };
                parts.push(part);
                let first_triangle = (tables.triangles.len() / layout::TRIANGLE) as u32;
                tables.geometries.extend([first_triangle, mesh.triangles.len() as u32, 0, 0]);
                let first_coordinate = tables.coordinates.len() / 2;
                for index in 0..mesh.triangles.len() {
                    tables.triangles.extend(triangle_row(
                        &mesh.triangles[index],
                        index,
                        surface,
                        &part,
                        first_coordinate,
                        plain_material,
                    ));
                }
                mesh.positions.iter().for_each(|&vertex| push_vector(&mut tables.vertices, finite(vertex)));
                if let Some(normals) = &surface.normals {
                    normals.values.iter().for_each(|&normal| {
                        push_vector(&mut tables.normals, direction(normal).unwrap_or(Vec3::ZERO));
                    });
                }
                if let Some(coordinates) = &surface.texture_coordinates {
                    for &Vec2 { x, y } in &coordinates.values {
                        tables.coordinates.extend([number(x, 0.0).to_bits(), number(y, 0.0).to_bits()]);
                    }
                }
            }
        }
        first_parts.push(parts.len());
        for instance in &model.scene.instances {
            tables.instances.extend(instance_row(instance, &first_parts));
        }
        let mut looks = Self { words: Vec::new(), texels: atlas.texels, parts, first_parts };
        looks.join(&tables, light, request)?;
        looks.words[layout::ATLAS] = atlas.width;
        looks.words[layout::ATLAS + 1] = atlas.height;
        looks.words[layout::FLAGS] = flags;
        looks.words[layout::CATCHER] = stage.ground_instance().unwrap_or(NOTHING);
        if let Some(catcher) = stage.catcher() {
            let middle = catcher.center.to_array().map(f32::to_bits);
            looks.words[layout::CATCHER + 1..layout::CATCHER + 4].copy_from_slice(&middle);
            looks.words[layout::CATCHER + 4] = catcher.reach.to_bits();
        }
        Ok(looks)
    }

    /// Joins the tables behind a header.
    fn join(&mut self, tables: &Tables, light: &[u32], request: &[u32]) -> Result<(), RenderError> {
        let bytes: Vec<u32> = byte_values().map(f32::to_bits).collect();
        let list: [(usize, &[u32], usize); 11] = [
            (layout::REQUEST, request, 1),
            (layout::LIGHT, light, 1),
            (layout::BYTES, &bytes, 1),
            (layout::MATERIALS, &tables.materials, layout::MATERIAL),
            (layout::TEXTURES, &tables.textures, layout::TEXTURE),
            (layout::INSTANCES, &tables.instances, layout::INSTANCE),
            (layout::GEOMETRIES, &tables.geometries, layout::GEOMETRY),
            (layout::TRIANGLES, &tables.triangles, layout::TRIANGLE),
            (layout::VERTICES, &tables.vertices, 3),
            (layout::NORMALS, &tables.normals, 3),
            (layout::COORDINATES, &tables.coordinates, 2),
        ];
        let count = HEADER + list.iter().map(|(_, words, _)| words.len()).sum::<usize>();
        // Beyond 2^31 the bytes' addresses of shaders, which have 32 bits and a sign, could not reach.
        let most = 1_usize << 29;
        if count > most {
            return Err(RenderError::Looks { words: count as u64, most: most as u64 });
        }
        self.words
            .try_reserve_exact(count)
            .map_err(|_| RenderError::Looks { words: count as u64, most: most as u64 })?;
        self.words.resize(HEADER, 0);
        for (pair, words, row) in list {
            self.words[pair] = self.words.len() as u32;
            self.words[pair + 1] = (words.len() / row) as u32;
            self.words.extend_from_slice(words);
        }
        Ok(())
    }

    /// Replaces what the picture asks for. Returns the range of its words, or `None` when their number is another: then
    /// everything must be packed anew.
    pub(crate) fn set_request(&mut self, request: &[u32]) -> Option<Range<usize>> {
        self.set_table(layout::REQUEST, request)
    }

    /// Replaces the light, as [`Self::set_request`] does.
    pub(crate) fn set_light(&mut self, light: &[u32]) -> Option<Range<usize>> {
        self.set_table(layout::LIGHT, light)
    }

    fn set_table(&mut self, table: usize, words: &[u32]) -> Option<Range<usize>> {
        let start = self.word(table) as usize;
        let range = start..start + words.len();
        if self.word(table + 1) as usize != words.len() {
            return None;
        }
        self.words.get_mut(range.clone())?.copy_from_slice(words);
        Some(range)
    }
}

/// The value of each byte as sRGB, then as it is.
fn byte_values() -> impl Iterator<Item = f32> {
    let srgb = (0..=255_u8).map(|byte| crate::decode_srgb(f64::from(byte) / 255.0) as f32);
    srgb.chain((0..=255_u8).map(|byte| (f64::from(byte) / 255.0) as f32))
}

pub(super) fn push_vector(words: &mut Vec<u32>, vector: Vec3) {
    words.extend(vector.to_array().map(f32::to_bits));
}

/// A number, or another where it is none.
fn number(value: f32, other: f32) -> f32 {
    if value.is_finite() { value } else { other }
}

/// A number from 0 to 1; `other` for NaN.
fn share(value: f32, other: f32) -> f32 {
    if value.is_nan() { other } else { value.clamp(0.0, 1.0) }
}

/// A vertex with what is no number taken out: no structure holds a triangle with such a vertex.
pub(super) fn finite(vector: Vec3) -> Vec3 {
    vector.to_array().map(|value| number(value, 0.0)).into()
}

/// A vector of any length as one of length 1.
pub(super) fn direction(vector: Vec3) -> Option<Vec3> {
    vector.as_dvec3().try_normalize().map(DVec3::as_vec3)
}

fn triangle_row(
    vertices: &[u32; 3],
    index: usize,
    surface: &Surface,
    part: &Part,
    first_coordinate: usize,
    materials: u32,
) -> [u32; layout::TRIANGLE] {
    let mut row = [NOTHING; layout::TRIANGLE];
    let rows = |indices: [u32; 3], first: usize, count: usize| {
        let all = indices.iter().all(|&index| (index as usize) < count);
        if all { indices.map(|index| first as u32 + index) } else { [NOTHING; 3] }
    };
    row[..3].copy_from_slice(&rows(*vertices, part.first_vertex, part.vertices));
    if let Some(normals) = &surface.normals {
        let corners = normals.corners(index, *vertices);
        if corners.is_some_and(|corners| corners.iter().all(|&normal| direction(normal).is_some())) {
            let indices = normals.indices.as_ref().and_then(|all| all.get(index)).unwrap_or(vertices);
            row[3..6].copy_from_slice(&rows(*indices, part.first_normal, part.normals));
        }
    }
    if let Some(coordinates) = &surface.texture_coordinates {
        let indices = match &coordinates.indices {
            None => Some(*vertices),
            Some(all) => all.get(index).copied(),
        };
        if let Some(indices) = indices {
            row[6..9].copy_from_slice(&rows(indices, first_coordinate, coordinates.values.len()));
        }
    }
    row[9] = surface.materials.of(index).min(materials);
    row
}

/// The row of an instance; one that names no object has no geometries.
pub(super) fn instance_row(instance: &Instance, first_parts: &[usize]) -> [u32; layout::INSTANCE] {
    let mut row = [0; layout::INSTANCE];
    let to_world: &Affine3A = instance.transform.to_world();
    let columns = to_world.matrix3;
    for axis in 0..3 {
        let line =
            [columns.x_axis[axis], columns.y_axis[axis], columns.z_axis[axis], to_world.translation[axis]];
        row[4 * axis..4 * axis + 4].copy_from_slice(&line.map(f32::to_bits));
    }
    let inverse = instance.transform.to_object().matrix3;
    let lines = [inverse.x_axis, inverse.y_axis, inverse.z_axis].map(Vec3::from);
    // Normals are made unit vectors behind it: the size of the matrix says nothing, but it could overflow.
    let largest = lines.iter().map(|line| line.abs().max_element()).fold(f32::MIN_POSITIVE, f32::max);
    for (axis, line) in lines.iter().enumerate() {
        // A row of the transposed inverse is a column of the inverse.
        let line = line.to_array().map(|value| (value / largest).to_bits());
        row[12 + 3 * axis..15 + 3 * axis].copy_from_slice(&line);
    }
    let object = instance.object as usize;
    if let (Some(&first), Some(&end)) = (first_parts.get(object), first_parts.get(object + 1)) {
        row[21] = first as u32;
        row[22] = (end - first) as u32;
    }
    row
}

fn material_row(material: &Material, descriptions: [u32; 3]) -> [u32; layout::MATERIAL] {
    let plain = Material::default();
    let color = |color: Vec3, other: Vec3| [0, 1, 2].map(|axis| share(color[axis], other[axis]));
    let emissive = material.emissive.to_array().map(|value| if value > 0.0 { value.min(1e6) } else { 0.0 });
    let ior = if material.ior.is_finite() && material.ior >= 1.0 { material.ior } else { plain.ior };
    let reflectance = ((f64::from(ior) - 1.0) / (f64::from(ior) + 1.0)).powi(2) as f32;
    let mut flags = 0;
    for (is_set, flag) in [
        (material.ambient.is_some(), layout::GIVES_AMBIENT),
        (material.specular.is_some(), layout::GIVES_SPECULAR),
        (material.mirrors_sharply, layout::MIRRORS_SHARPLY),
    ] {
        flags |= if is_set { flag } else { 0 };
    }
    let mut row = [0; layout::MATERIAL];
    let mut put = |at: usize, values: &[f32]| {
        for (word, value) in row[at..].iter_mut().zip(values) {
            *word = value.to_bits();
        }
    };
    put(0, &color(material.base_color, plain.base_color));
    put(3, &[share(material.opacity, 1.0)]);
    put(4, &emissive);
    put(7, &[share(material.alpha_cutoff, 0.0)]);
    put(8, &color(material.ambient.unwrap_or(Vec3::ZERO), Vec3::ZERO));
    put(12, &color(material.specular.unwrap_or(Vec3::ZERO), Vec3::ZERO));
    put(15, &[ior, share(material.roughness, 1.0), share(material.metallic, 0.0)]);
    put(18, &[share(material.transmission, 0.0), reflectance]);
    row[11] = flags;
    row[20..23].copy_from_slice(&descriptions);
    row
}

fn texture_row(use_: &TextureUse, place: [u32; 2], size: [u32; 2], is_srgb: bool) -> [u32; layout::TEXTURE] {
    let wrap = |wrap: Wrap| match wrap {
        Wrap::Repeat => layout::REPEAT,
        Wrap::Mirror => layout::MIRROR,
        Wrap::Clamp => layout::CLAMP,
    };
    let mut flags = wrap(use_.wrap[0]) | wrap(use_.wrap[1]) << 2;
    if use_.filter == Filter::Linear {
        flags |= layout::IS_LINEAR;
    }
    if is_srgb {
        flags |= layout::IS_SRGB;
    }
    let mut row = [0; layout::TEXTURE];
    row[..2].copy_from_slice(&place);
    row[2..4].copy_from_slice(&size);
    row[4] = flags;
    for (word, value) in row[5..9].iter_mut().zip([use_.scale.x, use_.scale.y, use_.offset.x, use_.offset.y])
    {
        *word = number(value, 0.0).to_bits();
    }
    row
}
