//! What drafts become is the cheapest of all that they could become.

use super::*;
use glam::Vec3;

/// Drafts of a random binary tree over so many references, each half a box of its own within the whole.
fn drafts(count: u32, seed: u32) -> Vec<Draft> {
    fn grow(drafts: &mut Vec<Draft>, first: u32, count: u32, size: Vec3, random: &mut impl FnMut() -> f32) {
        let this = drafts.len();
        drafts.push(Draft::new(&Extent([0.0, 0.0, 0.0, 0.0, -size.x, -size.y, -size.z, 0.0]), first, count));
        if count > 1 {
            let low = 1 + (random() * (count - 1) as f32) as u32;
            let mut half = || size * Vec3::new(0.4 + 0.6 * random(), 0.4 + 0.6 * random(), 0.7);
            let sizes = [half(), half()];
            grow(drafts, first, low, sizes[0], random);
            let second = drafts.len() as u32;
            drafts[this].split(second);
            grow(drafts, first + low, count - low, sizes[1], random);
        }
    }
    let mut state = seed.wrapping_mul(0x9e37_79b9) | 1;
    let mut random = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / 16_777_216.0
    };
    let mut drafts = Vec::new();
    grow(&mut drafts, 0, count, Vec3::ONE, &mut random);
    drafts
}

/// Every cut of at most `places` drafts through the subtree of `index`.
fn cuts(drafts: &[Draft], index: u32, places: usize) -> Vec<Vec<u32>> {
    let mut found = vec![vec![index]];
    let second = drafts[index as usize].second;
    for share in 1..if second == 0 { 1 } else { places } {
        // Each cut once: the first part has exactly its share.
        for first in cuts(drafts, index + 1, share).into_iter().filter(|first| first.len() == share) {
            let rest = cuts(drafts, second, places - share);
            found.extend(rest.into_iter().map(|rest| [first.clone(), rest].concat()));
        }
    }
    found
}

/// The least cost of a subtree that gets one place, by trying everything.
fn least(drafts: &[Draft], costs: &Costs, index: u32) -> f64 {
    let draft = &drafts[index as usize];
    let area = f64::from(draft.area());
    let below = cuts(drafts, index, WIDTH).into_iter().filter(|cut| cut.len() > 1);
    let below = below.map(|cut| cut.iter().map(|&child| least(drafts, costs, child)).sum::<f64>());
    let inner = area * f64::from(costs.node) + below.fold(f64::INFINITY, f64::min);
    inner.min(area * f64::from(costs.leaf(draft.count)))
}

fn cost(nodes: &[TreeNode], costs: &Costs, root: f64) -> f64 {
    let mut sum = root * f64::from(costs.node);
    for node in nodes {
        for place in 0..node.len() {
            let area = f64::from(node.child_bounds(place).half_area());
            let count = node.children[place].count;
            sum += area * f64::from(if count > 0 { costs.leaf(count) } else { costs.node });
        }
    }
    sum
}

#[test]
fn no_other_nodes_and_leaves_cost_less() {
    for seed in 0..40 {
        let mut drafts = drafts(9 + seed % 4, seed);
        for costs in
            [Costs::new(1.0, 1.0, 0.0, 4), Costs::new(1.0, 0.5, 0.4, 3), Costs::new(3.0, 1.0, 0.1, 1)]
        {
            let expected = least(&drafts, &costs, 0);
            let mut collapse = Collapse { drafts: &mut drafts, costs };
            collapse.weigh();
            let mut nodes = Vec::new();
            assert_eq!(collapse.emit(&mut nodes, Child::leaf), Outcome::Node);
            let found = cost(&nodes, &costs, f64::from(drafts[0].area()));
            assert!((found / expected - 1.0).abs() < 1e-5, "{seed}: {found} {expected}");
        }
    }
}

#[test]
fn what_is_cheapest_as_a_leaf_becomes_one() {
    let mut drafts = drafts(4, 1);
    let mut collapse = Collapse { drafts: &mut drafts, costs: Costs::new(1.0, 1.0, 0.0, 4) };
    collapse.weigh();
    let mut nodes = Vec::new();
    assert_eq!(collapse.emit(&mut nodes, Child::leaf), Outcome::Leaf { first: 0, count: 4 });
    assert!(nodes.is_empty());
    let nothing = Collapse { drafts: &mut [], costs: Costs::new(1.0, 1.0, 0.0, 4) };
    assert_eq!(nothing.emit(&mut nodes, Child::leaf), Outcome::Leaf { first: 0, count: 0 });
}

/// A crown under nothing else is the tree that it came from.
#[test]
fn a_crown_and_what_is_below_it_are_the_whole() {
    let costs = Costs::new(1.0, 1.0, 0.0, 2);
    for levels in 0..4 {
        let mut drafts = drafts(700, 9);
        let mut collapse = Collapse { drafts: &mut drafts, costs };
        collapse.weigh();
        let mut whole = Vec::new();
        collapse.emit(&mut whole, Child::leaf);
        let (mut below, mut crown) = (Vec::new(), Vec::new());
        collapse.emit_crown(levels, 0, &mut below, &mut crown);
        let mut collapse = Collapse { drafts: &mut crown, costs };
        collapse.weigh();
        let mut above = Vec::new();
        collapse.emit(&mut above, |first, count| Child { link: first, count });
        assert_eq!(above.len() + below.len(), whole.len(), "{levels}");
        let finished = above.iter().flat_map(|node| &node.children).filter(|it| it.count == Draft::FINISHED);
        assert!(finished.count() > 0 || levels == 3 && below.is_empty());
    }
}
