//! What came of a build.

use super::KdNode;
use super::build::clip::clip;
use super::cells::cells;
use crate::{Aabb, BuildReport, FlatTriangle};

/// Measures a valid tree; the input report and the times are left at zero. The cost is that of other structures: 1 for a
/// node, 1 for a triangle.
pub(super) fn measure(
    nodes: &[KdNode],
    references: &[u32],
    triangles: &[FlatTriangle],
    bounds: &Aabb,
) -> BuildReport {
    let mut report = BuildReport {
        triangles: triangles.len(),
        references: references.len(),
        nodes: nodes.len(),
        bytes: size_of_val(nodes) + size_of_val(references) + size_of_val(triangles),
        ..BuildReport::default()
    };
    let mut weighted = 0.0;
    for visited in cells(nodes, bounds) {
        let area = half_area(&visited.cell);
        if visited.node.is_leaf() {
            weighted += area * f64::from(visited.node.count());
            report.leaves += 1;
            report.depth = report.depth.max(visited.depth);
            report.largest_leaf = report.largest_leaf.max(visited.node.count());
        } else {
            weighted += area;
        }
    }
    let root = half_area(bounds);
    report.sah_cost = if root > 0.0 { weighted / root } else { weighted };
    report
}

fn half_area(cell: &Aabb) -> f64 {
    let size = cell.size().as_dvec3();
    size.x * size.y + size.y * size.z + size.z * size.x
}

/// How many references of a valid tree name a triangle of which nothing lies in the leaf's cell, or only touches one of its faces
/// from outside.
pub(super) fn count_passive(
    nodes: &[KdNode],
    references: &[u32],
    triangles: &[FlatTriangle],
    bounds: &Aabb,
) -> usize {
    let leaves = cells(nodes, bounds).filter(|visited| visited.node.is_leaf());
    leaves
        .map(|leaf| {
            let of_leaf = references.iter().skip(leaf.node.first() as usize).take(leaf.node.count() as usize);
            of_leaf.filter(|&&it| is_passive(&triangles[it as usize], &leaf.cell)).count()
        })
        .sum()
}

fn is_passive(triangle: &FlatTriangle, cell: &Aabb) -> bool {
    let Some(part) = clip(&triangle.triangle(), cell) else { return true };
    let own = triangle.triangle().bounds();
    let from_below = part.max.cmple(cell.min) & own.min.cmplt(cell.min);
    let from_above = part.min.cmpge(cell.max) & own.max.cmpgt(cell.max);
    (from_below | from_above).any()
}
