//! What came of a collapse.

use super::{Width, bounds_of, is_empty};
use crate::bvh::Node;
use crate::{BuildReport, FlatTriangle};

/// Completes the report of a valid tree whose input, times and different triangles are known, and finds the most entries
/// that a walk's stack can hold.
pub(super) fn measure(
    width: Width,
    children: &[Node],
    triangles: &[FlatTriangle],
    known: BuildReport,
) -> (BuildReport, u32) {
    let wide_nodes = children.len() / width.children();
    let mut report = BuildReport {
        references: triangles.len(),
        nodes: wide_nodes,
        leaves: 0,
        depth: 0,
        largest_leaf: 0,
        bytes: size_of_val(children) + size_of_val(triangles),
        ..known
    };
    let mut stack_entries = 0;
    let root_area =
        children.get(..width.children()).map_or(0.0, |root| f64::from(bounds_of(root).half_area()));
    let mut weighted = root_area;
    // Of each wide node: how many lie above it, and how many of their other children may wait meanwhile. Parents come
    // before their children, so one pass is enough.
    let mut above = vec![(0u32, 0u32); wide_nodes];
    for (wide, places) in children.chunks_exact(width.children()).enumerate() {
        let (levels, waiting) = above[wide];
        let places = places.split(is_empty).next().unwrap_or_default();
        let (levels, waiting) = (levels + 1, waiting + places.len() as u32 - 1);
        stack_entries = stack_entries.max(waiting);
        for child in places {
            let area = f64::from(child.bounds().half_area());
            if child.is_leaf() {
                weighted += area * f64::from(child.count);
                report.leaves += 1;
                report.depth = report.depth.max(levels);
                report.largest_leaf = report.largest_leaf.max(child.count);
            } else {
                weighted += area;
                above[child.link as usize] = (levels, waiting);
            }
        }
    }
    report.nodes += report.leaves;
    report.sah_cost = if root_area > 0.0 { weighted / root_area } else { 0.0 };
    (report, stack_entries)
}

#[cfg(test)]
mod tests {
    use crate::bvh::Node;
    use crate::wide_bvh::{WideBvh, Width};
    use crate::{Aabb, FlatTriangle};
    use bytemuck::Zeroable;
    use glam::Vec3;

    /// Two levels by hand: a root with a leaf, an inner node and a leaf, and two leaves below.
    #[test]
    fn everything_is_counted() {
        let mut triangle = FlatTriangle { instance_and_mask: 0xff00_0000, ..FlatTriangle::zeroed() };
        triangle.v1 = [1.0, 0.0, 0.0];
        triangle.v2 = [0.0, 1.0, 0.0];
        let triangles: Vec<_> = (0..6).map(|primitive| FlatTriangle { primitive, ..triangle }).collect();
        let unit = Aabb::new(Vec3::ZERO, Vec3::ONE);
        let inner = Node { link: 1, ..Node::inner(&unit, 0) };
        let nothing = Node::zeroed();
        let children = vec![
            Node::leaf(&unit, 0, 1),
            inner,
            Node::leaf(&unit, 1, 3),
            nothing,
            Node::leaf(&unit, 4, 1),
            Node::leaf(&unit, 5, 1),
            nothing,
            nothing,
        ];
        let bvh = WideBvh::from_parts(Width::Four, children, triangles).unwrap();
        let report = bvh.report();
        assert_eq!((report.triangles, report.references, report.nodes, report.leaves), (6, 6, 6, 4));
        assert_eq!((report.depth, report.largest_leaf, report.bytes), (2, 3, 8 * 32 + 6 * 48));
        // Two visits and six tests, all boxes being the root's.
        assert_eq!(report.sah_cost, 8.0);
        // Two of the root's three children may wait, and then one of the two below.
        assert_eq!(bvh.stack_entries(), 3);
        assert_eq!(bvh.bounds(), unit);
        assert!(!bvh.has_repeats());
    }

    #[test]
    fn nothing_at_all_is_counted() {
        let bvh = WideBvh::from_parts(Width::Eight, vec![], vec![]).unwrap();
        assert_eq!((bvh.report().nodes, bvh.report().depth, bvh.stack_entries()), (0, 0, 0));
        assert_eq!(bvh.report().sah_cost, 0.0);
        assert!(bvh.bounds().is_empty());
    }
}
