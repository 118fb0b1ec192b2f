//! What came of a build.

use super::tree::Tree;
use crate::{Aabb, BuildReport};

/// Completes the report of a valid tree whose input, times and different triangles are known, and finds the box around everything.
pub(super) fn measure(tree: &Tree, known: BuildReport) -> (BuildReport, Aabb) {
    let mut report = BuildReport {
        references: tree.order.len(),
        nodes: tree.nodes.len(),
        leaves: 0,
        depth: 0,
        largest_leaf: 0,
        ..known
    };
    let bounds = tree.nodes.first().map_or(Aabb::EMPTY, |root| {
        (0..root.len()).map(|place| root.child_bounds(place)).fold(Aabb::EMPTY, Aabb::union)
    });
    let root_area = f64::from(bounds.half_area());
    let mut weighted = root_area;
    // Parents come before their children, so one pass is enough.
    let mut levels = vec![1u32; tree.nodes.len()];
    for (index, node) in tree.nodes.iter().enumerate() {
        report.depth = report.depth.max(levels[index]);
        for place in 0..node.len() {
            weighted += f64::from(node.child_bounds(place).half_area());
            let child = node.children[place];
            if child.is_leaf() {
                report.leaves += 1;
                report.largest_leaf = report.largest_leaf.max(child.count);
            } else {
                levels[child.link as usize] = levels[index] + 1;
            }
        }
    }
    report.nodes += report.leaves;
    report.sah_cost = if root_area > 0.0 { weighted / root_area } else { 0.0 };
    (report, bounds)
}
