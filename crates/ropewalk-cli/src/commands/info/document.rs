//! What is known about a scene, as data.

use super::Arguments;
use crate::scene_argument::LoadedScene;
use ropewalk::traversal_list::{Element, HeadTable};
use ropewalk::{BuildReport, Structure, TraversalList};
use ropewalk_gpu::{AdapterSummary, Gpu, GpuStructure};
use serde::Serialize;

#[derive(Debug, Serialize)]
pub(super) struct Document {
    pub(super) scene: String,
    pub(super) format: String,
    pub(super) triangles: usize,
    pub(super) unique_triangles: usize,
    pub(super) vertices: usize,
    pub(super) objects: usize,
    pub(super) instances: usize,
    pub(super) geometries: usize,
    pub(super) materials: usize,
    pub(super) cameras: usize,
    pub(super) lights: usize,
    pub(super) bounds: Option<Bounds>,
    /// Where the scene's zero lies in the world; bounds are relative to it.
    pub(super) origin: [f64; 3],
    pub(super) up: Option<[f32; 3]>,
    pub(super) load_seconds: f64,
    pub(super) defects: Defects,
    pub(super) structure: StructureRecord,
    pub(super) gpu: Vec<Fit>,
}

#[derive(Debug, Serialize)]
pub(super) struct Bounds {
    pub(super) min: [f32; 3],
    pub(super) max: [f32; 3],
}

#[derive(Debug, Serialize)]
pub(super) struct Defects {
    pub(super) not_finite: usize,
    pub(super) out_of_range: usize,
    pub(super) degenerate: usize,
    pub(super) collinear: usize,
    pub(super) skipped: Vec<SkippedRecord>,
    pub(super) notes: Vec<String>,
}

#[derive(Debug, Serialize)]
pub(super) struct SkippedRecord {
    pub(super) what: String,
    pub(super) count: usize,
    pub(super) first: String,
}

/// Traversal lists, and where their memory goes.
#[derive(Debug, Serialize)]
pub(super) struct ListsRecord {
    /// Lists of each layer.
    pub(super) lists: usize,
    pub(super) layers: usize,
    /// Elements of all lists of all layers.
    pub(super) elements: usize,
    pub(super) bytes_per_element: usize,
    /// The share of triangles, over all lists, that lists leave out because their rays do not see them.
    pub(super) culled_share: f64,
    pub(super) one_sided: bool,
    pub(super) element_bytes: usize,
    /// What all lists share: vertices, and who each triangle is.
    pub(super) shared_bytes: usize,
    /// Heads of triangles.
    pub(super) head_bytes: usize,
}

impl ListsRecord {
    pub(super) fn new(list: &TraversalList) -> Self {
        let element_bytes = size_of_val(list.elements());
        let head_bytes = list.polygon_heads().map_or(0, HeadTable::bytes);
        Self {
            lists: list.options().directions.lists(),
            layers: list.layers(),
            elements: list.elements().len(),
            bytes_per_element: size_of::<Element>(),
            culled_share: list.culled_share(),
            one_sided: list.is_one_sided(),
            element_bytes,
            shared_bytes: list.report().bytes.saturating_sub(element_bytes + head_bytes),
            head_bytes,
        }
    }
}

#[derive(Debug, Serialize)]
pub(super) struct StructureRecord {
    pub(super) name: String,
    pub(super) triangles: usize,
    /// References to triangles in the leaves.
    pub(super) references: usize,
    /// How many more references there are than triangles, as a share of the triangles.
    pub(super) reference_growth: f64,
    /// Children a node, where every node has as much room.
    pub(super) width: Option<usize>,
    /// What there is of traversal lists.
    pub(super) lists: Option<ListsRecord>,
    pub(super) nodes: usize,
    pub(super) leaves: usize,
    pub(super) depth: u32,
    pub(super) largest_leaf: u32,
    pub(super) sah_cost: f64,
    pub(super) bytes: usize,
    pub(super) bytes_per_triangle: f64,
    pub(super) flatten_seconds: f64,
    pub(super) build_seconds: f64,
}

/// Whether a structure fits an adapter.
#[derive(Debug, Serialize)]
pub(super) struct Fit {
    pub(super) device: String,
    pub(super) name: String,
    pub(super) software: bool,
    /// The largest storage buffer that a kernel can bind.
    pub(super) limit_bytes: Option<u64>,
    pub(super) node_bytes: u64,
    pub(super) triangle_bytes: u64,
    pub(super) fits: bool,
    /// Why the adapter gives no device, where it gives none.
    pub(super) problem: Option<String>,
}

impl Document {
    pub(super) fn new(arguments: &Arguments, scene: &LoadedScene, built: &Structure) -> Self {
        let model = &scene.model;
        let geometry = &model.scene;
        let meshes = || geometry.objects.iter().flat_map(|object| &object.geometries);
        let bounds = geometry.bounds();
        let report = built.report();
        let skipped = model.report.skipped.iter().map(|row| SkippedRecord {
            what: row.what.clone(),
            count: row.count,
            first: row.first.clone(),
        });
        Self {
            scene: arguments.scene.to_string(),
            format: if model.report.format.is_empty() {
                "built-in".into()
            } else {
                model.report.format.clone()
            },
            triangles: geometry.triangle_count(),
            unique_triangles: meshes().map(|mesh| mesh.triangles.len()).sum(),
            vertices: match model.report.vertices {
                0 => meshes().map(|mesh| mesh.positions.len()).sum(),
                stored => stored,
            },
            objects: geometry.objects.len(),
            instances: geometry.instances.len(),
            geometries: meshes().count(),
            materials: model.materials.len(),
            cameras: model.cameras.len(),
            lights: model.lights.len(),
            bounds: (!bounds.is_empty())
                .then(|| Bounds { min: bounds.min.to_array(), max: bounds.max.to_array() }),
            origin: geometry.origin.to_array(),
            up: model.up.map(|up| up.to_array()),
            load_seconds: scene.time.as_secs_f64(),
            defects: Defects {
                not_finite: report.input.not_finite,
                out_of_range: report.input.out_of_range,
                degenerate: report.input.degenerate,
                collinear: report.input.collinear,
                skipped: skipped.collect(),
                notes: model.report.notes.clone(),
            },
            structure: StructureRecord {
                name: arguments.structure.to_string(),
                triangles: report.triangles,
                references: report.references,
                reference_growth: growth(report),
                width: match built {
                    Structure::Bvh(_) => Some(2),
                    Structure::WideBvh(bvh) => Some(bvh.width().children()),
                    _ => None,
                },
                lists: match built {
                    Structure::List(list) => Some(ListsRecord::new(list)),
                    _ => None,
                },
                nodes: report.nodes,
                leaves: report.leaves,
                depth: report.depth,
                largest_leaf: report.largest_leaf,
                sah_cost: report.sah_cost,
                bytes: report.bytes,
                bytes_per_triangle: report.bytes_per_triangle(),
                flatten_seconds: report.flatten_time.as_secs_f64(),
                build_seconds: report.build_time.as_secs_f64(),
            },
            gpu: fits(built),
        }
    }
}

fn growth(report: &BuildReport) -> f64 {
    let more = report.references.saturating_sub(report.triangles);
    if report.triangles == 0 { 0.0 } else { more as f64 / report.triangles as f64 }
}

/// Asks every adapter whether it holds the structure.
fn fits(structure: &Structure) -> Vec<Fit> {
    let Ok([node_bytes, triangle_bytes]) = GpuStructure::bytes_needed(structure) else { return Vec::new() };
    let fit = |adapter: &AdapterSummary| {
        let opened = Gpu::open(adapter.index);
        let limits = opened.as_ref().map(|gpu| gpu.device().limits());
        let limit = limits
            .as_ref()
            .ok()
            .map(|limits| limits.max_storage_buffer_binding_size.min(limits.max_buffer_size));
        Fit {
            device: format!("gpu:{}", adapter.index),
            name: adapter.name.clone(),
            software: adapter.is_software,
            limit_bytes: limit,
            node_bytes,
            triangle_bytes,
            fits: limit.is_some_and(|limit| node_bytes.max(triangle_bytes) <= limit),
            problem: limits.err().map(ToString::to_string),
        }
    };
    ropewalk_gpu::adapters().iter().map(fit).collect()
}
