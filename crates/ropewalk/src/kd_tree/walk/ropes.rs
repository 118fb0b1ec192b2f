//! Ropes (Popov et al. 2007): out of each leaf through a face, by the rope that leads beyond it, and down to the next leaf.
//!
//! Cells are needed for it, 32 bytes a node ([`crate::kd_tree::KdPlace`]), and 24 bytes of ropes a leaf. The test of a leaf's box is a
//! part of the leaf visit. Where the next leaf is not certain the ray is given over to the restart trail ([`super::certain`]). The twin is
//! `walk_kd_ropes.wgsl`.

use super::certain::{Faces, is_behind, side_at};
use super::crossing::{RayPlanes, whole_tree};
use super::{Course, KdWalk, give_over};
use crate::PreparedRay;
use crate::bvh::walk::Visitor;
use crate::kd_tree::{KdTree, OUTSIDE};

/// The walk.
#[derive(Clone, Copy, Debug)]
pub struct Ropes;

impl KdWalk for Ropes {
    const SHOWS_AGAIN: bool = true;

    #[inline(always)]
    fn walk<V: Visitor>(self, tree: &KdTree, ray: &PreparedRay, visitor: &mut V) -> Course {
        let (nodes, places, ropes) = (tree.nodes(), tree.places(), tree.ropes());
        if nodes.is_empty() {
            return Course::Own;
        }
        let planes = RayPlanes::of(ray);
        let limit = visitor.t_max();
        let whole = whole_tree(tree, ray, limit);
        if !whole.is_hit() {
            return Course::Own;
        }
        // Where the ray comes into the cell of `current`.
        let mut at = whole.entry;
        let mut current = 0;
        loop {
            let node = &nodes[current as usize];
            if !node.is_leaf() {
                visitor.inner_visit(current);
                match side_at(&planes.crossing(current, node), at, whole) {
                    Some(child) => current = child,
                    None => return give_over(tree, ray, visitor),
                }
                continue;
            }
            let place = &places[current as usize];
            // A leaf that does not lead on would lead round in circles.
            let Some(faces) = Faces::of(place, ray, limit).filter(|faces| faces.part.exit > at) else {
                return give_over(tree, ray, visitor);
            };
            // All that comes after begins later still.
            if faces.part.entry > visitor.t_max() || visitor.leaf(node.first(), node.count()).is_break() {
                return Course::Own;
            }
            at = faces.part.exit;
            // The next leaf begins no further before `at` than the pads.
            let (Some(face), false) = (faces.face, is_behind(at, visitor.t_max())) else {
                return Course::Own;
            };
            current = ropes[place.leaf as usize][face];
            if current == OUTSIDE {
                return Course::Own;
            }
        }
    }
}
