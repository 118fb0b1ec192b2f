//! What the two buffers of a two-level structure hold: see [`crate::shader::level_layout`].

use super::content::{Bytes, Content, list_header};
use super::shape::Shape;
use crate::GpuError;
use crate::shader::{LevelBottoms, Tree, level_layout as layout};
use ropewalk::kd_tree::KdPlace;
use ropewalk::two_level::{Bottom, Entry, ObjectStructure, TwoLevel};
use ropewalk::{Aabb, CatalogueError, Structure};
use std::borrow::Cow;

/// Bytes of a four of words.
const FOUR: u64 = 16;

/// A buffer in the making.
#[derive(Default)]
struct Pieces<'a> {
    pieces: Vec<Cow<'a, [u8]>>,
    bytes: u64,
}

impl<'a> Pieces<'a> {
    /// Appends bytes at the next place that so many bytes divide; that place, counted in them.
    fn push(&mut self, grain: u64, bytes: impl Into<Cow<'a, [u8]>>) -> u64 {
        let padding = self.bytes.next_multiple_of(grain) - self.bytes;
        if padding > 0 {
            self.pieces.push(Cow::Owned(vec![0; padding as usize]));
        }
        let place = (self.bytes + padding) / grain;
        let bytes = bytes.into();
        self.bytes += padding + bytes.len() as u64;
        self.pieces.push(bytes);
        place
    }

    /// Whole fours of words, so that kernels can load the last of them.
    fn finish(mut self) -> Vec<Cow<'a, [u8]>> {
        self.push(FOUR, Vec::new());
        self.pieces
    }
}

/// The content of a two-level structure.
pub(super) fn content<'a>(structure: &'a Structure, scene: &'a TwoLevel) -> Result<Content<'a>, GpuError> {
    let mut nodes = Pieces::default();
    let mut triangles = Pieces::default();
    let mut bottoms = None;
    let mut deepest = 0;
    // The header and the objects come first, and are known last.
    nodes.push(FOUR, Vec::new());
    nodes.bytes = FOUR * (layout::HEADER_FOURS + layout::OBJECT_FOURS * scene.objects().len()) as u64;
    let mut records = Vec::with_capacity(4 * layout::OBJECT_FOURS * scene.objects().len());
    for object in scene.objects() {
        let Some(object) = object else {
            records.extend([0; 4 * layout::OBJECT_FOURS]);
            continue;
        };
        records.extend(record(object, &mut nodes, &mut triangles, &mut bottoms)?);
        deepest = deepest.max(object.bottom().stack_entries());
    }
    // More places than a word counts are refused by the bytes.
    let top_at = nodes.push(2 * FOUR, bytemuck::cast_slice(scene.top().nodes()));
    let entries: Vec<u32> = scene.entries().iter().flat_map(|&entry| leaf(scene, entry)).collect();
    let entries_at = nodes.push(FOUR, bytemuck::cast_slice(&entries).to_vec());
    let placed_at = nodes.push(FOUR, bytemuck::cast_slice(scene.placed()));
    let top = scene.top().bounds();
    let largest = top.min.abs().max(top.max.abs()).max_element();
    let mut header = vec![top_at as u32, entries_at as u32, placed_at as u32, scene.width().to_bits()];
    header.extend([largest.to_bits(), 0, 0, 0]);
    header.extend(records);
    let mut node_pieces = nodes.finish();
    if let Some(first) = node_pieces.first_mut() {
        *first = Cow::Owned(bytemuck::cast_slice(&header).to_vec());
    }
    let way_out = "trace on the CPU, or place fewer different objects";
    // Kernels count words.
    let most = 4 << 32;
    let entered =
        scene.entries().iter().map(|entry| nodes_of(scene, entry.place)).fold(0, u64::saturating_add);
    let shape = Shape {
        entered: entered.saturating_add(scene.top().nodes().len() as u64),
        ..Shape::of_tree(
            Tree::Levels(bottoms.unwrap_or(LevelBottoms::KdTree)),
            structure,
            scene.top().nodes().len(),
            // One child a level is postponed.
            scene.top().depth() + deepest,
        )
    };
    Ok(Content {
        nodes: Bytes { what: "nodes of both levels", way_out, least: 32, most, pieces: node_pieces },
        triangles: Bytes {
            what: "triangles of the objects",
            way_out,
            least: 64,
            most,
            pieces: triangles.finish(),
        },
        shape,
    })
}

/// The object of an instance.
fn object_of(scene: &TwoLevel, place: u32) -> Option<&ObjectStructure> {
    let placed = scene.placed().get(place as usize)?;
    scene.objects().get(placed.object as usize)?.as_deref()
}

/// Nodes of the object of an instance.
fn nodes_of(scene: &TwoLevel, place: u32) -> u64 {
    object_of(scene, place).map_or(0, |object| match object.bottom() {
        // A step for each layer, too.
        Bottom::List(lists) => (lists.elements().len() + lists.layers()) as u64,
        _ => object.report().nodes as u64,
    })
}

/// The words of what a leaf of the top level leads to.
fn leaf(scene: &TwoLevel, entry: Entry) -> [u32; 8] {
    let bounds = object_of(scene, entry.place).map_or(Aabb::EMPTY, |object| match object.bottom() {
        Bottom::KdTree(tree) if entry.node > 0 => {
            tree.places().get(entry.node as usize).map_or_else(|| tree.bounds(), KdPlace::bounds)
        }
        _ => object.bounds(),
    });
    let [min, max] = corners(&bounds);
    [min[0], min[1], min[2], entry.place, max[0], max[1], max[2], entry.node]
}

fn corners(bounds: &Aabb) -> [[u32; 3]; 2] {
    [bounds.min, bounds.max].map(|corner| corner.to_array().map(f32::to_bits))
}

/// Puts an object's structure into the buffers; the words that say where it is.
fn record<'a>(
    object: &'a ObjectStructure,
    nodes: &mut Pieces<'a>,
    triangles: &mut Pieces<'a>,
    bottoms: &mut Option<LevelBottoms>,
) -> Result<[u32; 4 * layout::OBJECT_FOURS], GpuError> {
    let (kind, own, nodes_at, triangles_at, references_at) = match object.bottom() {
        Bottom::Bvh(bvh) => (
            layout::BVH,
            LevelBottoms::Bvh,
            nodes.push(2 * FOUR, bytemuck::cast_slice(bvh.nodes())),
            triangles.push(3 * FOUR, bytemuck::cast_slice(bvh.triangles())),
            0,
        ),
        Bottom::KdTree(tree) => (
            layout::KD_TREE,
            LevelBottoms::KdTree,
            nodes.push(FOUR, bytemuck::cast_slice(tree.nodes())),
            triangles.push(3 * FOUR, bytemuck::cast_slice(tree.triangles())),
            triangles.push(FOUR, bytemuck::cast_slice(tree.references())),
        ),
        Bottom::WideBvh(bvh) => (
            layout::WIDE_BVH,
            LevelBottoms::Wide(bvh.width()),
            nodes.push(2 * FOUR * bvh.width().children() as u64, bytemuck::cast_slice(bvh.children())),
            triangles.push(3 * FOUR, bytemuck::cast_slice(bvh.triangles())),
            0,
        ),
        Bottom::List(lists) => {
            let header = bytemuck::cast_slice(&list_header(lists)?).to_vec();
            let header_at = nodes.push(FOUR, header);
            nodes.push(4, bytemuck::cast_slice(lists.elements()));
            let vertices_at = triangles.push(3 * FOUR, bytemuck::cast_slice(lists.vertices()));
            triangles.push(4, bytemuck::cast_slice(lists.identities()));
            let own = LevelBottoms::List { bounds: lists.options().bounds, one_sided: lists.is_one_sided() };
            (layout::LIST, own, header_at, vertices_at, 0)
        }
        _ => {
            let text = "an object's structure has no walk below a top level on a graphics adapter: build it with kd-trees \
                        or BVHs, or trace it on the device cpu";
            return Err(GpuError::Catalogue(CatalogueError(text.into())));
        }
    };
    let both = bottoms.map_or(Some(own), |others| own.and(others));
    let Some(both) = both else {
        let text = "objects have wide BVHs of several widths, or lists of several kinds, which no kernel goes through: build \
                    all objects alike, or trace on the device cpu";
        return Err(GpuError::Catalogue(CatalogueError(text.into())));
    };
    *bottoms = Some(both);
    let [min, max] = corners(&object.bounds());
    Ok([
        min[0],
        min[1],
        min[2],
        kind,
        max[0],
        max[1],
        max[2],
        nodes_at as u32,
        triangles_at as u32,
        references_at as u32,
        0,
        0,
    ])
}
