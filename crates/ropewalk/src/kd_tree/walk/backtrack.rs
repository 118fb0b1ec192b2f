//! kd-backtrack (Foley and Sugerman 2005): after each leaf up to the first ancestor that the ray has not left yet, and down again.
//!
//! Parents and cells are needed for it, 32 bytes a node ([`KdPlace`]). A test of an ancestor's box counts as an inner visit.
//! Where the next leaf is not certain the ray is given over to the restart trail ([`super::certain`]). The twin is
//! `walk_kd_backtrack.wgsl`.

use super::certain::{Fork, is_behind};
use super::crossing::{RayPlanes, whole_tree};
use super::{Course, KdWalk, give_over};
use crate::PreparedRay;
use crate::aabb::{Interval, slab_test};
use crate::bvh::walk::Visitor;
use crate::kd_tree::{KdPlace, KdTree};

/// The walk.
#[derive(Clone, Copy, Debug)]
pub struct Backtrack;

impl KdWalk for Backtrack {
    const SHOWS_AGAIN: bool = true;

    #[inline(always)]
    fn walk<V: Visitor>(self, tree: &KdTree, ray: &PreparedRay, visitor: &mut V) -> Course {
        let (nodes, places) = (tree.nodes(), tree.places());
        if nodes.is_empty() {
            return Course::Own;
        }
        let planes = RayPlanes::of(ray);
        let limit = visitor.t_max();
        let whole = whole_tree(tree, ray, limit);
        if !whole.is_hit() {
            return Course::Own;
        }
        // Where the last leaf ended.
        let mut done = f32::NEG_INFINITY;
        let (mut current, mut cell) = (0, whole);
        loop {
            let node = &nodes[current as usize];
            if !node.is_leaf() {
                visitor.inner_visit(current);
                let crossing = planes.crossing(current, node);
                (current, cell) = match Fork::of(&crossing, cell) {
                    Fork::Near => (crossing.near, cell),
                    Fork::Far => (crossing.far, cell),
                    Fork::Both if crossing.near_exit <= done => (crossing.far, crossing.far_part(cell)),
                    Fork::Both => (crossing.near, crossing.near_part(cell)),
                    Fork::Undecided => return give_over(tree, ray, visitor),
                };
                continue;
            }
            // All that comes after begins later still.
            if cell.entry > visitor.t_max() || visitor.leaf(node.first(), node.count()).is_break() {
                return Course::Own;
            }
            done = cell.exit;
            // The next leaf begins no further before `done` than the pads.
            if done >= whole.exit || is_behind(done, visitor.t_max()) {
                return Course::Own;
            }
            match ancestor_beyond(places, current, done, ray, limit, visitor) {
                Some(ancestor) => (current, cell) = ancestor,
                None => return Course::Own,
            }
        }
    }
}

/// The first ancestor of a node in which the ray is beyond `done`, and where the ray is in its cell: the same floats as on the
/// way down.
#[inline(always)]
fn ancestor_beyond<V: Visitor>(
    places: &[KdPlace],
    node: u32,
    done: f32,
    ray: &PreparedRay,
    limit: f32,
    visitor: &mut V,
) -> Option<(u32, Interval)> {
    let mut current = places[node as usize].parent;
    while let Some(place) = places.get(current as usize) {
        visitor.inner_visit(current);
        let [min, max] = place.corners();
        let cell = slab_test(ray, min, max, limit);
        if cell.exit > done {
            return Some((current, cell));
        }
        current = place.parent;
    }
    None
}
