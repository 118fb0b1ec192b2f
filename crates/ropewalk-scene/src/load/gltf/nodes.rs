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
    /// From the node's space to the world.
    pub(super) to_world: DAffine3,
}

/// The nodes of the scene, parents before children, in the order of the file.
pub(super) fn walk(document: &Document, report: &mut LoadReport) -> Vec<Placed> {
    let mut visited = vec![false; document.nodes.len()];
    let mut placed = Vec::new();
    let roots = roots(document, report);
    // The last of a stack comes first.
    let mut open: Vec<(usize, DAffine3)> =
        roots.into_iter().rev().map(|node| (node, DAffine3::IDENTITY)).collect();
    while let Some((index, parent)) = open.pop() {
        let (Some(node), Some(seen)) = (document.nodes.get(index), visited.get_mut(index)) else {
            continue;
        };
        if std::mem::replace(seen, true) {
            report
                .skip("nodes met again, in a cycle or below a second parent", || document.node_place(index));
            continue;
        }
        let to_world = parent * local(node);
        placed.push(Placed { node: index, to_world });
        open.extend(indices(&node.children).rev().map(|child| (child, to_world)));
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

/// From a node's space to its parent's: a matrix, or scale, then rotation, then translation.
fn local(node: &Node) -> DAffine3 {
    if let Some(matrix) = &node.matrix {
        // By columns. The last row says nothing that an affine map could.
        let [a, b, c, _, d, e, f, _, g, h, i, _, x, y, z, _] = **matrix;
        let linear = DMat3::from_cols(DVec3::new(a, b, c), DVec3::new(d, e, f), DVec3::new(g, h, i));
        return DAffine3::from_mat3_translation(linear, DVec3::new(x, y, z));
    }
    let scale = node.scale.map_or(DVec3::ONE, DVec3::from);
    // A rotation of length zero becomes NaN here and is counted with the instances that cannot be placed.
    let rotation = node.rotation.map_or(DQuat::IDENTITY, |rotation| {
        let rotation = DQuat::from_array(rotation);
        rotation * rotation.length().recip()
    });
    let translation = node.translation.map_or(DVec3::ZERO, DVec3::from);
    DAffine3::from_scale_rotation_translation(scale, rotation, translation)
}
