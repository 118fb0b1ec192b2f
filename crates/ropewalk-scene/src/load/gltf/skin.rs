//! Skins: meshes whose vertices follow several nodes, their joints, by weights (linear blend skinning; Magnenat-Thalmann,
//! Laperrière, Thalmann 1988).
//!
//! A vertex is where the weighted mean of its joints' transforms takes it, `world(joint) * inverse_bind(joint)`; where the
//! mesh's own node stands has no say. Normals follow the cofactors of the mean, which is its inverse transpose but for the
//! length. A skin that cannot be read is left out and counted: its mesh stands as it is stored.

use super::accessor::Accessor;
use super::buffers::Buffers;
use super::document::get;
use super::moving_document::{MovingDocument, Skin, SkinAttributes};
use super::primitive::Kept;
use crate::animation::GeometryShape;
use crate::{LoadReport, Surface};
use glam::{DAffine3, DMat3, DVec3, Vec3};
use ropewalk::Mesh;

/// Four joints, and by which share a vertex follows each.
type Influence = ([u16; 4], [f32; 4]);

/// The joints of a skin.
#[derive(Clone, Debug, PartialEq)]
struct Joint {
    /// Its place among the nodes of the scene.
    placed: usize,
    inverse_bind: DAffine3,
}

/// A geometry as it is stored, and what it follows.
#[derive(Clone, Debug)]
struct Skinned {
    positions: Vec<Vec3>,
    normals: Option<Vec<Vec3>>,
    /// Four joints and their weights, which sum to one, a vertex; empty for a geometry that follows none.
    influences: Vec<Influence>,
}

/// An object that follows a skin.
#[derive(Clone, Debug)]
pub(super) struct SkinnedObject {
    joints: Vec<Joint>,
    geometries: Vec<Skinned>,
}

/// How much memory the skins of a file may take: a thousand nodes may each give the same large mesh to a skin.
#[derive(Debug, Default)]
pub(super) struct Budget {
    used: u64,
}

impl Budget {
    const ALWAYS: u64 = 512 << 20;
    /// What a vertex takes, twice over, is ten times what it takes in a file; meshes may be shared by some nodes.
    const RATIO: u64 = 64;

    fn take(&mut self, geometries: &[(&Mesh, &Surface, &Kept)], loaded: u64) -> bool {
        let vertex = size_of::<Influence>() + 5 * size_of::<Vec3>();
        let bytes = geometries.iter().map(|(mesh, ..)| {
            mesh.positions.len() as u64 * vertex as u64 + size_of_val(mesh.triangles.as_slice()) as u64
        });
        self.used = self.used.saturating_add(bytes.sum());
        self.used <= loaded.saturating_mul(Self::RATIO).saturating_add(Self::ALWAYS)
    }
}

/// Why a skin is left out: as the end of `skins ...`.
type Unread = &'static str;

/// The skin of a node with a mesh, for the meshes that were read of it and the vertices that these kept. `None` where it has none,
/// or one that is left out and counted.
pub(super) fn read(
    buffers: &Buffers<'_>,
    document: &MovingDocument,
    node: usize,
    geometries: &[(&Mesh, &Surface, &Kept)],
    place_of: impl Fn(u64) -> Option<usize>,
    budget: &mut Budget,
    report: &mut LoadReport,
) -> Option<SkinnedObject> {
    let skin = document.nodes.get(node)?.skin?;
    let mesh = buffers.document.nodes.get(node)?.mesh?;
    let what = match get(&document.skins, skin) {
        None => "that are not there",
        Some(skin) => match joints(buffers, skin, place_of) {
            Err(what) => what,
            Ok(_) if !budget.take(geometries, buffers.loaded_bytes()) => {
                "that take more memory than a file of this size may"
            }
            Ok(joints) => {
                let primitives = get(&document.meshes, mesh).map_or(&[][..], |mesh| &mesh.primitives);
                let all = geometries.iter().enumerate().map(|(part, &(mesh, surface, kept))| {
                    let attributes = primitives.get(part).map(|primitive| &primitive.attributes);
                    let influences =
                        influences(buffers, attributes, kept, mesh.positions.len(), joints.len())?;
                    let normals = surface.normals.as_ref().map(|normals| normals.values.clone());
                    Ok(Skinned { positions: mesh.positions.clone(), normals, influences })
                });
                match all.collect() {
                    Err(what) => what,
                    Ok(geometries) => {
                        if primitives.iter().any(|primitive| primitive.attributes.more_joints.is_some()) {
                            report.skip("sets of joints behind the first four of a vertex", || {
                                buffers.document.node_place(node)
                            });
                        }
                        return Some(SkinnedObject { joints, geometries });
                    }
                }
            }
        },
    };
    report.skip(&format!("skins {what}"), || buffers.document.node_place(node));
    None
}

fn joints(
    buffers: &Buffers<'_>,
    skin: &Skin,
    place_of: impl Fn(u64) -> Option<usize>,
) -> Result<Vec<Joint>, Unread> {
    if skin.joints.is_empty() || skin.joints.len() > usize::from(u16::MAX) + 1 {
        return Err("without joints, or with too many");
    }
    let matrices = match skin.inverse_bind_matrices {
        None => None,
        Some(index) => {
            let matrices =
                Accessor::<16>::open(buffers, index).map_err(|_| "whose matrices cannot be read")?;
            Some(matrices)
                .filter(|matrices| matrices.count() >= skin.joints.len())
                .map_or(Err("with fewer matrices than joints"), |matrices| Ok(Some(matrices)))?
        }
    };
    let joint = |(number, &node): (usize, &u64)| {
        let placed = place_of(node).ok_or("with joints that are not in the scene")?;
        let inverse_bind =
            matrices.as_ref().map_or(DAffine3::IDENTITY, |matrices| affine(matrices.vector(number)));
        if !inverse_bind.is_finite() {
            return Err("with matrices that are no numbers");
        }
        Ok(Joint { placed, inverse_bind })
    };
    skin.joints.iter().enumerate().map(joint).collect()
}

/// By columns. The last row says nothing that an affine map could.
fn affine(matrix: [f32; 16]) -> DAffine3 {
    let [a, b, c, _, d, e, f, _, g, h, i, _, x, y, z, _] = matrix.map(f64::from);
    let linear = DMat3::from_cols(DVec3::new(a, b, c), DVec3::new(d, e, f), DVec3::new(g, h, i));
    DAffine3::from_mat3_translation(linear, DVec3::new(x, y, z))
}

/// What the vertices that a mesh keeps follow.
fn influences(
    buffers: &Buffers<'_>,
    attributes: Option<&SkinAttributes>,
    kept: &Kept,
    vertices: usize,
    joint_count: usize,
) -> Result<Vec<Influence>, Unread> {
    if vertices == 0 {
        return Ok(Vec::new());
    }
    let (Some(joints), Some(weights)) = attributes.map_or((None, None), |of| (of.joints, of.weights)) else {
        return Err("of meshes without joints or weights");
    };
    let joints = Accessor::<4>::open(buffers, joints).map_err(|_| "whose joints cannot be read")?;
    let weights = Accessor::<4>::open(buffers, weights).map_err(|_| "whose weights cannot be read")?;
    if kept.last().is_some_and(|last| last >= joints.count().min(weights.count())) {
        return Err("with fewer joints or weights than vertices");
    }
    let read = kept.values(|vertex| (joints.vector(vertex), weights.vector(vertex)));
    let influence = |(joints, weights): ([f32; 4], [f32; 4])| {
        if !weights.iter().all(|weight| (0.0..=f32::MAX).contains(weight)) {
            return Err("with weights that are no numbers, or below zero");
        }
        let is_known = |joint: f32| joint >= 0.0 && joint.fract() == 0.0 && (joint as usize) < joint_count;
        // A joint without weight may be any.
        if joints.iter().zip(&weights).any(|(&joint, &weight)| weight > 0.0 && !is_known(joint)) {
            return Err("with joints out of range");
        }
        let sum: f32 = weights.iter().sum();
        let joints = std::array::from_fn(|part| if weights[part] > 0.0 { joints[part] as u16 } else { 0 });
        // Weights without a sum leave a vertex to its first joint.
        let shares = if sum > 0.0 && sum.is_finite() {
            weights.map(|weight| weight / sum)
        } else {
            [1.0, 0.0, 0.0, 0.0]
        };
        Ok((joints, shares))
    };
    read.into_iter().map(influence).collect()
}

impl SkinnedObject {
    /// The shape when the nodes of the scene stand like this, relative to the origin.
    pub(super) fn shape(&self, to_world: &[DAffine3], origin: DVec3) -> Vec<GeometryShape> {
        let maps: Vec<DAffine3> = self
            .joints
            .iter()
            .map(|joint| {
                let joint_to_world = to_world.get(joint.placed).copied().unwrap_or(DAffine3::IDENTITY);
                DAffine3::from_translation(-origin) * joint_to_world * joint.inverse_bind
            })
            .collect();
        self.geometries.iter().map(|geometry| geometry.shape(&maps)).collect()
    }
}

impl Skinned {
    fn shape(&self, maps: &[DAffine3]) -> GeometryShape {
        let mean = |(joints, weights): &Influence| {
            let mut linear = DMat3::ZERO;
            let mut translation = DVec3::ZERO;
            for (&joint, &weight) in joints.iter().zip(weights).filter(|&(_, &weight)| weight > 0.0) {
                let map = maps.get(usize::from(joint)).copied().unwrap_or(DAffine3::IDENTITY);
                linear += map.matrix3 * f64::from(weight);
                translation += map.translation * f64::from(weight);
            }
            DAffine3::from_mat3_translation(linear, translation)
        };
        let means: Vec<DAffine3> = self.influences.iter().map(mean).collect();
        let position =
            |(map, position): (&DAffine3, &Vec3)| map.transform_point3(position.as_dvec3()).as_vec3();
        let normal = |(map, normal): (&DAffine3, &Vec3)| {
            let linear = &map.matrix3;
            let cofactors = DMat3::from_cols(
                linear.y_axis.cross(linear.z_axis),
                linear.z_axis.cross(linear.x_axis),
                linear.x_axis.cross(linear.y_axis),
            );
            (cofactors * normal.as_dvec3()).normalize_or_zero().as_vec3()
        };
        GeometryShape {
            positions: means.iter().zip(&self.positions).map(position).collect(),
            normals: self.normals.as_ref().map(|normals| means.iter().zip(normals).map(normal).collect()),
        }
    }
}
