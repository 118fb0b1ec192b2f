//! What came of a build.

use super::Node;
use crate::{FlatTriangle, InputReport};
use std::time::Duration;

/// How a structure was built, and what came of it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BuildReport {
    /// What was wrong with the triangles that were given.
    pub input: InputReport,
    /// The time that placing the triangles took; zero where there is no clock (wasm32).
    pub flatten_time: Duration,
    /// The time that the builder took; zero where there is no clock (wasm32).
    pub build_time: Duration,
    /// Triangles in the leaves, each counted once.
    pub triangles: usize,
    /// References to triangles in the leaves: more than there are triangles where spatial splits put some into
    /// several leaves.
    pub references: usize,
    /// Nodes, inner ones and leaves.
    pub nodes: usize,
    /// Leaves.
    pub leaves: usize,
    /// The depth of the deepest leaf; the root's is 0.
    pub depth: u32,
    /// Triangles in the largest leaf. More than the option `max_leaf` only where the depth cap left no room.
    pub largest_leaf: u32,
    /// The expected cost of a random ray by the surface area heuristic: 1 for the boxes of a node's two
    /// children, 1 for a triangle.
    pub sah_cost: f64,
    /// Bytes of nodes and triangles.
    pub bytes: usize,
}

impl BuildReport {
    /// Bytes a triangle, nodes and triangles together; 0 for an empty structure.
    #[must_use]
    pub fn bytes_per_triangle(&self) -> f64 {
        if self.triangles == 0 { 0.0 } else { self.bytes as f64 / self.triangles as f64 }
    }

    /// Adds what an object under a top level counts: sums, and the greatest depth and leaf.
    pub(crate) fn add_object(&mut self, object: &Self) {
        self.flatten_time += object.flatten_time;
        self.triangles += object.triangles;
        self.references += object.references;
        self.nodes += object.nodes;
        self.leaves += object.leaves;
        self.bytes += object.bytes;
        self.largest_leaf = self.largest_leaf.max(object.largest_leaf);
        self.depth = self.depth.max(object.depth);
    }

    /// Measures a valid tree over `distinct` triangles, some of which may stand among `triangles` several times; the
    /// input report and the times are left at zero.
    pub(super) fn measure(nodes: &[Node], triangles: &[FlatTriangle], distinct: usize) -> Self {
        let mut report = Self {
            triangles: distinct,
            references: triangles.len(),
            nodes: nodes.len(),
            bytes: size_of_val(nodes) + size_of_val(triangles),
            ..Self::default()
        };
        let root_area = nodes.first().map_or(0.0, |root| f64::from(root.bounds().half_area()));
        let mut weighted = 0.0;
        // Second children that are still to come, with their depth: depth-first order needs no more.
        let mut pending: Vec<u32> = Vec::new();
        let mut depth = 0;
        for node in nodes {
            let area = f64::from(node.bounds().half_area());
            if node.is_leaf() {
                weighted += area * f64::from(node.count);
                report.leaves += 1;
                report.depth = report.depth.max(depth);
                report.largest_leaf = report.largest_leaf.max(node.count);
                depth = pending.pop().unwrap_or(0);
            } else {
                weighted += area;
                depth += 1;
                pending.push(depth);
            }
        }
        report.sah_cost = if root_area > 0.0 { weighted / root_area } else { weighted.max(0.0) };
        report
    }
}
