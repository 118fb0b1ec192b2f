//! Refitting: new boxes for the same tree, in one pass from the last node to the first. A child follows its parent, so its box is
//! done when its parent's is asked.

use super::build::is_usable;
use super::{TopLevel, TopLevelError, restructure};
use crate::Aabb;
use crate::bvh::Node;
use std::ops::Range;

impl TopLevel {
    /// Moves the boxes of the tree as it is: the leaf of entry `i` gets box `i`, every other node the union of its children.
    /// Gives back what has changed so far: [`TopLevel::changed`].
    ///
    /// # Errors
    /// When a box is empty or not finite, or there is not one for each entry. Then nothing has changed.
    pub fn refit(&mut self, boxes: &[Aabb]) -> Result<&[Range<usize>], TopLevelError> {
        if boxes.len() != self.entries() {
            return Err(TopLevelError::OtherCount { was: self.entries(), is: boxes.len() });
        }
        if let Some(entry) = boxes.iter().position(|bounds| !is_usable(bounds)) {
            return Err(TopLevelError::Box { entry });
        }
        // How good the tree was can be told until its boxes move.
        if self.built_efficiency.len() != self.nodes.len() {
            restructure::remember(&self.nodes, &mut self.built_efficiency, &mut self.measures);
        }
        for index in (0..self.nodes.len()).rev() {
            let node = self.nodes[index];
            let moved = if node.is_leaf() {
                let Some(bounds) = boxes.get(node.link as usize) else { continue };
                Node::leaf(bounds, node.link, 1)
            } else {
                let (Some(first), Some(second)) =
                    (self.nodes.get(index + 1), self.nodes.get(node.link as usize))
                else {
                    continue;
                };
                union(first, second, node.link)
            };
            if moved != node {
                self.nodes[index] = moved;
                self.changes.add(index..index + 1);
            }
        }
        self.changes.merge();
        Ok(self.changes.ranges())
    }
}

/// The parent of two nodes.
#[inline(always)]
pub(super) fn union(first: &Node, second: &Node, link: u32) -> Node {
    let ([first_min, first_max], [second_min, second_max]) = (first.corners(), second.corners());
    let bounds = Aabb::new(first_min.min(second_min).truncate(), first_max.max(second_max).truncate());
    Node::inner(&bounds, link)
}
