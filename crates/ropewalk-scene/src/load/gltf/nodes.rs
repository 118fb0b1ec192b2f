//! The node graph: which nodes the scene shows, and where each stands, composed in f64.
//!
//! The walk keeps its own stack, so a chain of a million nodes is no danger, and visits a node once, so neither a
//! cycle nor nodes shared by many parents make it endless. A node met again is counted.

use super::document::{Document, Node};
use crate::LoadReport;
use glam::{DAffine3, DMat3, DQuat, DVec3};

/// A node of the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Placed {
    /// Its index in the document.
    pub(super) node: usize,
    /// The place of its parent among the nodes of the scene.
    pub(super) parent: Option<usize>,
    /// From the node's space to the world.
    pub(super) to_world: DAffine3,
}

/// The nodes of the scene, parents before children, in the order of the file.
pub(super) fn walk(document: &Document, report: &mut LoadReport) -> Vec<Placed> {
    let mut visited = vec![false; document.nodes.len()];
    let mut placed = Vec::new();
    let roots = roots(document, report);
    // The last of a stack comes first.
    let mut open: Vec<(usize, Option<usize>)> = roots.into_iter().rev().map(|node| (node, None)).collect();
    while let Some((index, parent)) = open.pop() {
        let (Some(node), Some(seen)) = (document.nodes.get(index), visited.get_mut(index)) else {
            continue;
        };
        if std::mem::replace(seen, true) {
            report
                .skip("nodes met again, in a cycle or below a second parent", || document.node_place(index));
            continue;
        }
        let above = parent.and_then(|parent| placed.get(parent));
        let above = above.map_or(DAffine3::IDENTITY, |above: &Placed| above.to_world);
        let place = Some(placed.len());
        placed.push(Placed { node: index, parent, to_world: above * local(node) });
        open.extend(indices(&node.children).rev().map(|child| (child, place)));
    }
    placed
}

/// The roots of the default scene, or of the first one; without scenes all nodes that no node has as a child.
fn roots(document: &Document, report: &mut LoadReport) -> Vec<usize> {
    let count = document.scenes.len();
    let named = document.scene.and_then(|scene| usize::try_from(scene).ok());
    let chosen = named.filter(|&scene| scene < count).unwrap_or(0);
    let Some(scene) = document.scenes.get(chosen) else {
        let mut is_child = vec![false; document.nodes.len()];
        for child in document.nodes.iter().flat_map(|node| indices(&node.children)) {
            if let Some(is_child) = is_child.get_mut(child) {
                *is_child = true;
            }
        }
        report.notes.push("the file has no scene: all its nodes are shown".into());
        return (0..document.nodes.len()).filter(|&node| is_child.get(node) == Some(&false)).collect();
    };
    if let Some(named) = document.scene.filter(|&named| named >= count as u64) {
        report
            .notes
            .push(format!("the file names scene {named} as its default, but has {count}: scene 0 is shown"));
    } else if count > 1 {
        report.notes.push(format!("the file has {count} scenes: scene {chosen} is shown"));
    }
    indices(&scene.nodes).collect()
}

fn indices(list: &[u64]) -> impl DoubleEndedIterator<Item = usize> {
    list.iter().filter_map(|&index| usize::try_from(index).ok())
}

/// Where a node is in its parent's space, where that is not given by a matrix.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Local {
    pub(super) translation: DVec3,
    /// NaN where the file's has length zero: what it turns is counted with what cannot be placed.
    pub(super) rotation: DQuat,
    pub(super) scale: DVec3,
}

impl Local {
    /// `None` for a node that is placed by a matrix.
    pub(super) fn of(node: &Node) -> Option<Self> {
        if node.matrix.is_some() {
            return None;
        }
        let rotation = node.rotation.map_or(DQuat::IDENTITY, |rotation| {
            let rotation = DQuat::from_array(rotation);
            rotation * rotation.length().recip()
        });
        let scale = node.scale.map_or(DVec3::ONE, DVec3::from);
        Some(Self { translation: node.translation.map_or(DVec3::ZERO, DVec3::from), rotation, scale })
    }

    /// Scale, then rotation, then translation.
    pub(super) fn to_parent(self) -> DAffine3 {
        DAffine3::from_scale_rotation_translation(self.scale, self.rotation, self.translation)
    }
}

/// From a node's space to its parent's.
pub(super) fn local(node: &Node) -> DAffine3 {
    if let Some(matrix) = &node.matrix {
        // By columns. The last row says nothing that an affine map could.
        let [a, b, c, _, d, e, f, _, g, h, i, _, x, y, z, _] = **matrix;
        let linear = DMat3::from_cols(DVec3::new(a, b, c), DVec3::new(d, e, f), DVec3::new(g, h, i));
        return DAffine3::from_mat3_translation(linear, DVec3::new(x, y, z));
    }
    Local::of(node).map_or(DAffine3::IDENTITY, Local::to_parent)
}
