//! What the two buffers of a structure hold: the bytes, in the pieces in which the structure has them, so that nothing large is
//! copied before it is sent.

use super::levels;
use super::shape::Shape;
use crate::GpuError;
use crate::shader::{Tree, kd_layout, list_layout as layout};
use ropewalk::traversal_list::{Grid, Layer};
use ropewalk::{CatalogueError, FlatTriangle, KdTree, Structure, TraversalList};
use std::borrow::Cow;

/// Both buffers of a structure: nodes and triangles, or elements and vertices.
#[derive(Debug)]
pub(super) struct Content<'a> {
    pub(super) nodes: Bytes<'a>,
    pub(super) triangles: Bytes<'a>,
    pub(super) shape: Shape,
}

/// What one buffer holds.
#[derive(Debug)]
pub(super) struct Bytes<'a> {
    /// For labels and errors.
    pub(super) what: &'static str,
    /// What can be done where it is too large, beside tracing on the CPU.
    pub(super) way_out: &'static str,
    /// No buffer may be empty, so one for nothing has so many zeroes.
    pub(super) least: u64,
    /// The most that its words can be counted for.
    pub(super) most: u64,
    /// Whole words each, one after the other.
    pub(super) pieces: Vec<Cow<'a, [u8]>>,
}

impl Bytes<'_> {
    /// Of the buffer.
    pub(super) fn len(&self) -> u64 {
        self.written().max(self.least)
    }

    /// Of the content.
    pub(super) fn written(&self) -> u64 {
        self.pieces.iter().map(|piece| piece.len() as u64).sum()
    }

    /// The content from a place on, as far as it lies in one piece; nothing behind the end.
    pub(super) fn from(&self, place: u64) -> &[u8] {
        let mut before = 0;
        for piece in &self.pieces {
            let end = before + piece.len() as u64;
            if place < end {
                return &piece[(place - before) as usize..];
            }
            before = end;
        }
        &[]
    }
}

impl<'a> Content<'a> {
    /// Of any structure for which there are kernels, for buffers of at most so many bytes.
    pub(super) fn of(structure: &'a Structure, room: u64) -> Result<Self, GpuError> {
        match structure {
            Structure::Bvh(bvh) => {
                // One child a level is postponed.
                let stack_entries = bvh.report().depth;
                let shape = Shape::of_tree(Tree::Binary, structure, bvh.nodes().len(), stack_entries);
                Ok(Self::of_tree(bytemuck::cast_slice(bvh.nodes()), bvh.triangles(), shape))
            }
            Structure::WideBvh(bvh) => {
                let nodes = bvh.children().len() / bvh.width().children();
                let shape = Shape::of_tree(Tree::Wide(bvh.width()), structure, nodes, bvh.stack_entries());
                Ok(Self::of_tree(bytemuck::cast_slice(bvh.children()), bvh.triangles(), shape))
            }
            Structure::KdTree(tree) => Ok(Self::of_kd_tree(structure, tree, room)),
            Structure::List(lists) => Self::of_lists(lists),
            Structure::TwoLevel(scene) => levels::content(structure, scene),
            _ => {
                let text = "this structure has no walk on a graphics adapter; trace it on the device cpu";
                Err(GpuError::Catalogue(CatalogueError(text.into())))
            }
        }
    }

    fn of_tree(nodes: &'a [u8], triangles: &'a [FlatTriangle], shape: Shape) -> Self {
        let way_out = "trace on the CPU, build with larger leaves (bvh:max-leaf=8), or split the scene";
        let bytes = |what, least, bytes| Bytes {
            what,
            way_out,
            least,
            most: u64::MAX,
            pieces: vec![Cow::Borrowed(bytes)],
        };
        Self {
            nodes: bytes("nodes of the structure", 32, nodes),
            triangles: bytes("triangles of the structure", 48, bytemuck::cast_slice(triangles)),
            shape,
        }
    }

    /// The places and the ropes are five times as large as the nodes, and two walks read them: where they do not fit they
    /// are left out.
    fn of_kd_tree(structure: &'a Structure, tree: &'a KdTree, room: u64) -> Self {
        let way_out =
            "trace on the CPU, build a tree that is less deep (kd-tree:max-depth=20), or split the scene";
        // Kernels count the words of these buffers.
        let most = 4 << 32;
        let nodes: &[u8] = bytemuck::cast_slice(tree.nodes());
        let leaves = tree.report().leaves as u64;
        let without = size_of::<[u32; kd_layout::HEADER_WORDS]>() as u64 + nodes.len() as u64;
        let with = without + 32 * tree.nodes().len() as u64 + 24 * leaves;
        let is_complete = with <= room.min(most);
        let header: [u32; kd_layout::HEADER_WORDS] = kd_header(tree, is_complete);
        let mut pieces = vec![Cow::Owned(bytemuck::cast_slice(&header).to_vec()), Cow::Borrowed(nodes)];
        if is_complete {
            pieces.push(Cow::Borrowed(bytemuck::cast_slice(tree.places())));
            pieces.push(Cow::Borrowed(bytemuck::cast_slice(tree.ropes())));
        }
        let references: &[u8] = bytemuck::cast_slice(tree.references());
        // Kernels load four at a time.
        let padding = vec![0; references.len().next_multiple_of(16) - references.len()];
        // One child a level is postponed.
        let stack_entries = tree.report().depth;
        let shape = Shape::of_tree(Tree::Kd, structure, tree.nodes().len(), stack_entries);
        Self {
            nodes: Bytes { what: "nodes of the kd-tree", way_out, least: 0, most, pieces },
            triangles: Bytes {
                what: "triangles of the kd-tree",
                way_out,
                least: 64,
                most,
                pieces: vec![
                    Cow::Borrowed(bytemuck::cast_slice(tree.triangles())),
                    Cow::Borrowed(references),
                    Cow::Owned(padding),
                ],
            },
            shape: Shape { left_out: if is_complete { 0 } else { with }, room, ..shape },
        }
    }

    fn of_lists(lists: &'a TraversalList) -> Result<Self, GpuError> {
        let way_out = "trace on the CPU, build fewer lists (list:directions=1), or split the scene";
        // Kernels count the words of these buffers.
        let most = 4 << 32;
        let header: [u32; layout::HEADER_WORDS] = list_header(lists)?;
        let elements = Cow::Borrowed(bytemuck::cast_slice(lists.elements()));
        let vertices = Cow::Borrowed(bytemuck::cast_slice(lists.vertices()));
        let identities = Cow::Borrowed(bytemuck::cast_slice(lists.identities()));
        Ok(Self {
            nodes: Bytes {
                what: "elements of the lists",
                way_out,
                least: 0,
                most,
                pieces: vec![Cow::Owned(bytemuck::cast_slice(&header).to_vec()), elements],
            },
            triangles: Bytes {
                what: "vertices of the lists",
                way_out,
                least: 24,
                most,
                pieces: vec![vertices, identities],
            },
            shape: Shape::of_lists(lists),
        })
    }
}

/// The words before the nodes: see [`kd_layout`].
fn kd_header(tree: &KdTree, has_places: bool) -> [u32; kd_layout::HEADER_WORDS] {
    let mut words = [0; kd_layout::HEADER_WORDS];
    let bounds = tree.bounds();
    let corners = bounds.min.to_array().into_iter().chain(bounds.max.to_array());
    words[kd_layout::BOUNDS_AT..].iter_mut().zip(corners).for_each(|(word, corner)| *word = corner.to_bits());
    // More than a word counts are refused by their bytes.
    if has_places {
        let places_at = kd_layout::HEADER_PAIRS + tree.nodes().len();
        words[kd_layout::PLACES_AT..][..2]
            .copy_from_slice(&[places_at as u32, (places_at + 4 * tree.nodes().len()) as u32]);
    }
    words[kd_layout::REFERENCES_AT] = (3 * tree.triangles().len()) as u32;
    words
}

/// The words before the elements: see [`layout`].
pub(super) fn list_header(lists: &TraversalList) -> Result<[u32; layout::HEADER_WORDS], GpuError> {
    let (layers, of_layer) = (lists.layers(), lists.options().directions.lists());
    if layers > layout::MOST_LAYERS {
        let most = layout::MOST_LAYERS;
        let text = format!(
            "lists of {layers} layers have no walk on a graphics adapter, which has {most} at most; trace them on the device cpu"
        );
        return Err(GpuError::Catalogue(CatalogueError(text)));
    }
    let mut words = [0; layout::HEADER_WORDS];
    // More than a word counts are refused by their bytes.
    let identities_at = (3 * lists.vertices().len()) as u32;
    words[..5].copy_from_slice(&[
        layers as u32,
        of_layer as u32,
        identities_at,
        lists.identities().len() as u32,
        lists.largest_coordinate().to_bits(),
    ]);
    let starts = lists.starts().windows(of_layer + 1).step_by(of_layer);
    let of_layers = words[layout::LAYERS_AT..].chunks_exact_mut(layout::LAYER_WORDS);
    for ((layer, starts), words) in (0..layers).zip(starts).zip(of_layers) {
        let (firsts, grid) = words.split_at_mut(layout::GRID_AT);
        firsts.fill(layout::NO_ELEMENT);
        for (first, bounds) in firsts.iter_mut().zip(starts.windows(2)) {
            if bounds[0] < bounds[1] {
                *first = bounds[0];
            }
        }
        if let Some(Grid { origin, step }) = lists.layer(layer).map(Layer::grid) {
            let places = [origin, step].into_iter().flat_map(|lanes| lanes.truncate().to_array());
            grid.iter_mut().zip(places).for_each(|(word, place)| *word = place.to_bits());
        }
    }
    Ok(words)
}
