//! The collapse of least expected cost (Wald, Benthin, Boulos 2008; in this form Ylitie, Karras, Laine 2017).
//!
//! A visit of a wide node costs 1 times its area, whatever its children, and a test of a triangle 1 times its leaf's
//! area. `cost(n, i)` is the least cost of the subtree of `n` where at most `i` places of a wide node above are given to
//! it:
//! ```text
//! cost(leaf, i)  = area * triangles
//! cost(n, 1)     = area + spread(n, width)                        n becomes a wide node
//! cost(n, i)     = min(spread(n, i), cost(n, i - 1))
//! spread(n, i)   = min over 0 < k < i of cost(first, k) + cost(second, i - k)
//! ```
//! One pass from the last node to the first finds all of them; the choices are found again on the way down. The table
//! has `width - 1` numbers a binary node.
//!
//! Whole subtrees are not merged into leaves, although `cost(n, 1)` could weigh that as well. It was tried on a kitchen,
//! an atrium and a forest: within the builder's own cap of 4 or 8 triangles a leaf no merge costs less, because the
//! builder has weighed it already, and beyond the cap the cost falls by 0.3 percent at most.

use super::Cut;
use crate::bvh::Node;

/// The cut, for nodes of `ROWS + 1` children.
pub(super) struct LeastCost<'a, const ROWS: usize> {
    nodes: &'a [Node],
    /// Of each node, the least cost with at most 1, 2, .. `ROWS` places.
    costs: Vec<[f32; ROWS]>,
}

impl<'a, const ROWS: usize> LeastCost<'a, ROWS> {
    pub(super) fn new(nodes: &'a [Node]) -> Self {
        let mut this = Self { nodes, costs: vec![[0.0; ROWS]; nodes.len()] };
        // Children come after their parents.
        for index in (0..nodes.len()).rev() {
            let node = &nodes[index];
            let area = node.bounds().half_area();
            let mut costs = [area * node.count as f32; ROWS];
            if !node.is_leaf() {
                costs[0] = area + this.spread(index as u32, ROWS + 1).0;
                for places in 2..=ROWS {
                    costs[places - 1] = this.spread(index as u32, places).0.min(costs[places - 2]);
                }
            }
            this.costs[index] = costs;
        }
        this
    }

    /// The least cost of an inner node's two subtrees in `places` places, and how many of them the first one gets; the
    /// fewest of equals.
    fn spread(&self, index: u32, places: usize) -> (f32, usize) {
        let first = &self.costs[index as usize + 1];
        let second = &self.costs[self.nodes[index as usize].link as usize];
        let mut best = (f32::INFINITY, 1);
        for (share, cost) in first[..places - 1].iter().enumerate() {
            let cost = cost + second[places - share - 2];
            if cost < best.0 {
                best = (cost, share + 1);
            }
        }
        best
    }

    /// Adds the children that stand for a subtree in at most `places` places. At most `ROWS + 1` calls deep.
    fn fill(&self, index: u32, mut places: usize, cut: &mut Vec<u32>) {
        let node = &self.nodes[index as usize];
        let costs = &self.costs[index as usize];
        while places > 1 && !node.is_leaf() {
            let (cost, share) = self.spread(index, places);
            // Of equals the one that uses the places.
            if cost <= costs[places - 2] {
                return self.split(index, share, places, cut);
            }
            places -= 1;
        }
        cut.push(index);
    }

    fn split(&self, index: u32, share: usize, places: usize, cut: &mut Vec<u32>) {
        self.fill(index + 1, share, cut);
        self.fill(self.nodes[index as usize].link, places - share, cut);
    }
}

impl<const ROWS: usize> Cut for LeastCost<'_, ROWS> {
    fn choose(&self, root: u32, cut: &mut Vec<u32>) {
        cut.clear();
        let (_, share) = self.spread(root, ROWS + 1);
        self.split(root, share, ROWS + 1, cut);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wide_bvh::{Collapse, WideBvh, Width};
    use crate::{BuildOptions, Bvh, Mesh, Scene};
    use glam::Vec3;

    /// Every cut of at most `places` nodes through the subtree of `index`.
    fn cuts(nodes: &[Node], index: u32, places: usize) -> Vec<Vec<u32>> {
        let mut found = vec![vec![index]];
        let node = &nodes[index as usize];
        if !node.is_leaf() {
            for share in 1..places {
                for first in cuts(nodes, index + 1, share) {
                    // Each cut once: the first part has exactly its share.
                    if first.len() == share {
                        let second = cuts(nodes, node.link, places - share);
                        found.extend(second.into_iter().map(|second| [first.clone(), second].concat()));
                    }
                }
            }
        }
        found
    }

    /// The least cost of a subtree, by trying everything.
    fn least(nodes: &[Node], index: u32, width: usize) -> f64 {
        let node = &nodes[index as usize];
        let area = f64::from(node.bounds().half_area());
        if node.is_leaf() {
            return area * f64::from(node.count);
        }
        let below = cuts(nodes, index, width).into_iter().filter(|cut| cut.len() > 1);
        let costs = below.map(|cut| cut.iter().map(|&child| least(nodes, child, width)).sum::<f64>());
        area + costs.fold(f64::INFINITY, f64::min)
    }

    fn soup(triangles: u32, seed: u32, max_leaf: u32) -> Bvh {
        let mut state = seed;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / 16_777_216.0
        };
        let positions = (0..triangles)
            .flat_map(|_| {
                let center = Vec3::new(random(), random(), random()) * 4.0;
                [(); 3].map(|()| center + Vec3::new(random(), random(), random()))
            })
            .collect();
        let mesh = Mesh::new(positions, (0..triangles).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect());
        Scene::from_mesh(mesh).build(&BuildOptions { max_leaf, ..BuildOptions::default() }).unwrap()
    }

    #[test]
    fn no_other_cuts_cost_less() {
        let mut better_than_greedy = 0;
        for seed in 0..24 {
            let bvh = soup(10 + seed % 4, seed, 1 + seed % 2);
            let area = f64::from(bvh.bounds().half_area());
            for width in [Width::Four, Width::Eight] {
                let expected = least(bvh.nodes(), 0, width.children()) / area;
                let cost = WideBvh::from_bvh(&bvh, width, Collapse::Sah).report().sah_cost;
                assert!((cost / expected - 1.0).abs() < 1e-5, "{seed} {width:?}: {cost} {expected}");
                let greedy = WideBvh::from_bvh(&bvh, width, Collapse::Area).report().sah_cost;
                assert!(greedy > cost * (1.0 - 1e-5), "{seed} {width:?}: {greedy} {cost}");
                better_than_greedy += u32::from(greedy > cost * 1.001);
            }
        }
        assert!(better_than_greedy > 8, "the trees are too simple to tell: {better_than_greedy}");
    }
}
