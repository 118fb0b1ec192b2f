//! What every tree must be, for the tests of all builders, and what one is expected to cost.

use crate::bvh8::tree::{LARGEST_LEAF, MAX_LEVELS, Tree, TreeNode, WIDTH};
use crate::{Aabb, FlatTriangle};

/// Says what is wrong with a tree of whole triangles: each stands in one leaf, and every box above contains it.
pub(crate) fn validate(tree: &Tree, triangles: &[FlatTriangle]) -> Result<(), String> {
    if tree.order.len() != triangles.len() {
        return Err(format!("{} references of {} triangles", tree.order.len(), triangles.len()));
    }
    let mut seen = vec![0; triangles.len()];
    for &triangle in &tree.order {
        *seen.get_mut(triangle as usize).ok_or("a reference to no triangle")? += 1;
    }
    if let Some(triangle) = seen.iter().position(|&times| times != 1) {
        return Err(format!("triangle {triangle} has {} references", seen[triangle]));
    }
    let mut taken = vec![false; tree.order.len()];
    let mut levels = vec![0u32; tree.nodes.len()];
    if let Some(root) = levels.first_mut() {
        *root = 1;
    } else if !triangles.is_empty() {
        return Err("no node".to_owned());
    }
    for (index, node) in tree.nodes.iter().enumerate() {
        let wrong = |what: &str| Err(format!("node {index}: {what}"));
        if levels[index] == 0 {
            return wrong("nothing leads to it");
        }
        if levels[index] > MAX_LEVELS {
            return wrong("too deep");
        }
        if node.len() == 0 {
            return wrong("empty");
        }
        for place in 0..WIDTH {
            let (child, bounds) = (node.children[place], node.child_bounds(place));
            if place >= node.len() {
                if !child.is_nothing() || bounds != Aabb::EMPTY {
                    return wrong("an empty place before a full one, or with a box");
                }
            } else if child.is_leaf() {
                if child.count > LARGEST_LEAF {
                    return wrong("a leaf is too large");
                }
                for at in child.link as usize..(child.link + child.count) as usize {
                    if at >= taken.len() || std::mem::replace(&mut taken[at], true) {
                        return wrong("a leaf has references of another, or of none");
                    }
                    if !bounds.contains(&triangles[tree.order[at] as usize].triangle().bounds()) {
                        return wrong("a triangle reaches out of its leaf");
                    }
                }
            } else {
                let below = child.link as usize;
                if below <= index || below >= tree.nodes.len() || levels[below] != 0 {
                    return wrong("a link that goes back, or nowhere, or to another's child");
                }
                levels[below] = levels[index] + 1;
                if !bounds.contains(&bounds_of(&tree.nodes[below])) {
                    return wrong("a child reaches out of its box");
                }
            }
        }
    }
    if taken.iter().any(|taken| !taken) { Err("a reference is in no leaf".to_owned()) } else { Ok(()) }
}

/// The box around a node's children.
pub(crate) fn bounds_of(node: &TreeNode) -> Aabb {
    (0..node.len()).fold(Aabb::EMPTY, |bounds, place| bounds.union(node.child_bounds(place)))
}

/// The expected visits of nodes and of leaves, of a ray that meets the root's box.
pub(crate) fn visits(tree: &Tree) -> [f64; 2] {
    let Some(root) = tree.nodes.first() else { return [0.0; 2] };
    let whole = f64::from(bounds_of(root).half_area());
    let mut visits = [whole, 0.0];
    for node in &tree.nodes {
        for place in 0..node.len() {
            visits[usize::from(node.children[place].is_leaf())] +=
                f64::from(node.child_bounds(place).half_area());
        }
    }
    visits.map(|area| if whole > 0.0 { area / whole } else { 0.0 })
}

/// The triangles of the largest leaf.
pub(crate) fn largest_leaf(tree: &Tree) -> u32 {
    tree.nodes.iter().flat_map(|node| node.children).map(|child| child.count).max().unwrap_or(0)
}

/// Every bit of a tree.
pub(crate) fn bits(tree: &Tree) -> Vec<u32> {
    let mut bits = tree.order.clone();
    for node in &tree.nodes {
        bits.extend(node.bounds.as_flattened().iter().map(|side| side.to_bits()));
        bits.extend(node.children.iter().flat_map(|child| [child.link, child.count]));
    }
    bits
}

/// Asserts that any number of threads builds the same valid tree.
#[cfg(feature = "parallel")]
pub(crate) fn assert_same_for_any_threads(triangles: &[FlatTriangle], build: impl Fn() -> Tree + Sync) {
    let trees = [1, 2, 7].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(&build)
    });
    assert_eq!(validate(&trees[0], triangles), Ok(()));
    for tree in &trees[1..] {
        assert!(bits(tree) == bits(&trees[0]), "another number of threads makes another tree");
    }
}

mod tests {
    use super::*;
    use crate::bvh8::tree::Child;
    use bytemuck::Zeroable;
    use glam::Vec3;

    fn triangles() -> Vec<FlatTriangle> {
        let triangle = |x: f32| FlatTriangle {
            v0: [x, 0.0, 0.0],
            v1: [x + 1.0, 0.0, 0.0],
            v2: [x, 1.0, 0.0],
            ..FlatTriangle::zeroed()
        };
        [0.0, 2.0, 4.0].map(triangle).into()
    }

    /// A root with a leaf and a node, which has two leaves.
    fn tree() -> Tree {
        let span = |from: f32, to: f32| Aabb::new(Vec3::new(from, 0.0, 0.0), Vec3::new(to, 1.0, 0.0));
        let mut nodes = vec![TreeNode::EMPTY; 2];
        nodes[0].set(0, &span(0.0, 1.0), Child::leaf(0, 1));
        nodes[0].set(1, &span(2.0, 5.0), Child::inner(1));
        nodes[1].set(0, &span(4.0, 5.0), Child::leaf(1, 1));
        nodes[1].set(1, &span(2.0, 3.0), Child::leaf(2, 1));
        Tree { nodes, order: vec![0, 2, 1] }
    }

    #[test]
    fn a_good_tree_is_good_and_its_visits_are_counted() {
        assert_eq!(validate(&tree(), &triangles()), Ok(()));
        // Half areas: 5 of the root, 3 of the node, 1 of each leaf.
        assert_eq!(visits(&tree()), [8.0 / 5.0, 3.0 / 5.0]);
        assert_eq!((validate(&Tree::default(), &[]), visits(&Tree::default())), (Ok(()), [0.0; 2]));
    }

    #[test]
    fn every_fault_is_seen() {
        type Spoil = fn(&mut Tree);
        let faults: [(&str, Spoil); 10] = [
            ("references", |tree| tree.order.truncate(2)),
            ("no triangle", |tree| tree.order[1] = 3),
            ("triangle 1", |tree| tree.order[2] = 2),
            ("no node", |tree| tree.nodes.clear()),
            ("reaches out of its leaf", |tree| tree.order.swap(0, 1)),
            ("reaches out of its box", |tree| tree.nodes[0].bounds[0][1] = 2.5),
            ("another", |tree| tree.nodes[1].children[1].link = 1),
            ("empty place", |tree| tree.nodes[1].children[3] = Child::leaf(0, 1)),
            ("goes back", |tree| tree.nodes[1].children[1] = Child::inner(1)),
            ("too large", |tree| tree.nodes[0].children[0].count = 9),
        ];
        for (what, spoil) in faults {
            let mut tree = tree();
            spoil(&mut tree);
            let found = validate(&tree, &triangles()).expect_err(what);
            assert!(found.contains(what), "{what}: {found}");
        }
        let mut tree = tree();
        tree.nodes[1].children[1] = Child::NOTHING;
        assert!(validate(&tree, &triangles()).is_err(), "an empty place keeps a box");
        tree.nodes[1].set(1, &Aabb::EMPTY, Child::NOTHING);
        assert_eq!(validate(&tree, &triangles()), Err("a reference is in no leaf".to_owned()));
    }

    #[test]
    fn trees_that_differ_in_a_bit_differ() {
        let (mut turned, mut moved) = (tree(), tree());
        turned.order.swap(0, 1);
        moved.nodes[1].bounds[0][0] = -0.0;
        assert_eq!(bits(&tree()), bits(&tree()));
        assert_ne!(bits(&turned), bits(&tree()));
        assert_ne!(bits(&moved), bits(&tree()));
        assert_eq!((largest_leaf(&tree()), largest_leaf(&Tree::default())), (1, 0));
    }
}
