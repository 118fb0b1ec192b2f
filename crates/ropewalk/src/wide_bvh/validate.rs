//! Checks the rules of a wide BVH: what makes unchecked trust in one unnecessary. What must hold between a leaf's box and
//! its triangles is the same as in a binary tree: see [`crate::bvh::validate`].

use super::{EMPTY, MAX_LEVELS, Width, is_empty};
use crate::bvh::Node;
use crate::bvh::validate::{check_parts, identity};
use crate::{Aabb, FlatTriangle, ValidationError};

/// Checks every rule that [`super`] names.
pub(super) fn validate(
    width: Width,
    children: &[Node],
    triangles: &[FlatTriangle],
) -> Result<(), ValidationError> {
    if children.is_empty() {
        return if triangles.is_empty() { Ok(()) } else { fail(0, "there are triangles but no nodes") };
    }
    let width = width.children();
    if !children.len().is_multiple_of(width) {
        return fail(children.len() / width, format!("it has fewer than {width} places"));
    }
    // How each wide node is reached: the box that leads to it and the wide nodes above it. Parents come before their
    // children, so one pass sees each before it is needed.
    let mut reached: Vec<Option<(Aabb, u32)>> = vec![None; children.len() / width];
    let everything = Aabb::new(glam::Vec3::NEG_INFINITY, glam::Vec3::INFINITY);
    reached[0] = Some((everything, 0));
    let mut seen = vec![false; triangles.len()];
    // Who leaves the box of a leaf, and must be in others as well.
    let mut leaving = Vec::new();
    for (wide, places) in children.chunks_exact(width).enumerate() {
        let Some((bounds, levels)) = reached[wide] else {
            return fail(wide, "no node before it leads to it");
        };
        if levels >= MAX_LEVELS {
            return fail(wide, format!("it is deeper than {MAX_LEVELS} levels"));
        }
        let held = places.iter().position(is_empty).unwrap_or(width);
        if !places[held..].iter().all(is_empty) {
            return fail(wide, format!("its place {held} holds nothing, but one behind it does"));
        }
        if held == 0 {
            return fail(wide, "it has no child");
        }
        for (slot, child) in places[..held].iter().enumerate() {
            check_box(wide, slot, &child.bounds(), &bounds)?;
            if child.is_leaf() {
                check_leaf(wide, slot, child, &mut seen)?;
                let leaf = &triangles[child.link as usize..][..child.count as usize];
                let leaves =
                    |triangle: &&FlatTriangle| !child.bounds().contains(&triangle.triangle().bounds());
                leaving.extend(leaf.iter().filter(leaves).map(identity));
                continue;
            }
            let link = child.link as usize;
            match reached.get_mut(link) {
                None => return fail(wide, format!("its child {slot} names a node {link} that is not there")),
                Some(_) if link <= wide => {
                    return fail(
                        wide,
                        format!("its child {slot} names the node {link}, which is not behind it"),
                    );
                }
                Some(Some(_)) => {
                    return fail(wide, format!("its child {slot} names the node {link}, which has a parent"));
                }
                Some(new @ None) => *new = Some((child.bounds(), levels + 1)),
            }
        }
    }
    if let Some(triangle) = seen.iter().position(|&seen| !seen) {
        return fail(0, format!("triangle {triangle} is in no leaf"));
    }
    leaving.sort_unstable();
    // It speaks of places: theirs are the children's.
    check_parts(children, triangles, &leaving)
        .map_err(|error| ValidationError { node: error.node / width, ..error })
}

const _: () = assert!(EMPTY == 0, "a child that names the root is a place that holds nothing");

fn check_box(wide: usize, slot: usize, bounds: &Aabb, parent: &Aabb) -> Result<(), ValidationError> {
    if !(bounds.min.is_finite() && bounds.max.is_finite() && !bounds.is_empty()) {
        return fail(wide, format!("the box of its child {slot} is empty or not finite"));
    }
    if !parent.contains(bounds) {
        return fail(wide, format!("the box of its child {slot} leaves its own"));
    }
    Ok(())
}

/// The triangles of a leaf are there, and in no other.
fn check_leaf(wide: usize, slot: usize, child: &Node, seen: &mut [bool]) -> Result<(), ValidationError> {
    let first = child.link as usize;
    let Some(places) = seen.get_mut(first..first.saturating_add(child.count as usize)) else {
        return fail(wide, format!("its child {slot} names triangles that are not there"));
    };
    if places.contains(&true) {
        return fail(wide, format!("a triangle of its child {slot} is in another leaf too"));
    }
    places.fill(true);
    Ok(())
}

fn fail(node: usize, what: impl Into<String>) -> Result<(), ValidationError> {
    Err(ValidationError { node, what: what.into() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BuildOptions, Mesh, Scene, WideBvh, WideOptions};
    use bytemuck::Zeroable;
    use glam::Vec3;

    fn strip() -> WideBvh {
        let positions = (0..42).map(|i| Vec3::new(i as f32, (i % 2) as f32, 0.1 * i as f32)).collect();
        let mesh = Mesh::new(positions, (0..40).map(|i| [i, i + 1, i + 2]).collect());
        let build = BuildOptions { max_leaf: 2, ..BuildOptions::default() };
        let options = WideOptions { width: Width::Four, build, ..WideOptions::default() };
        Scene::from_mesh(mesh).build_wide(&options).unwrap()
    }

    #[test]
    fn what_the_collapse_makes_is_valid() {
        let good = strip();
        assert_eq!(validate(Width::Four, good.children(), good.triangles()), Ok(()));
        assert_eq!(validate(Width::Four, &[], &[]), Ok(()));
        let again =
            WideBvh::from_parts(Width::Four, good.children().to_vec(), good.triangles().to_vec()).unwrap();
        assert_eq!(again.stack_entries(), good.stack_entries());
        let (again, good) = (again.report(), good.report());
        assert_eq!((again.triangles, again.nodes, again.depth), (good.triangles, good.nodes, good.depth));
        assert_eq!((again.sah_cost, again.bytes), (good.sah_cost, good.bytes));
    }

    /// Each kind of damage must be found, and named at its node.
    #[test]
    fn damage_is_found() {
        let good = strip();
        let (good, triangles) = (good.children().to_vec(), good.triangles());
        let is_inner = |child: &Node| !child.is_leaf() && !is_empty(child);
        let inner = good.iter().position(is_inner).unwrap();
        let uncle = good[..4].iter().rposition(is_inner).unwrap();
        let below = good.iter().skip(4).position(is_inner).map_or(inner, |place| place + 4);
        let leaf = good.iter().position(Node::is_leaf).unwrap();
        let other = good.iter().rposition(Node::is_leaf).unwrap();
        let last = good.len() - 4;
        assert!(below > 3 && uncle != inner && last > 8, "the tree is too small for the damage");
        type Harm<'a> = &'a dyn Fn(&mut Vec<Node>);
        let damage: [(&str, &str, Harm<'_>); 19] = [
            ("child outside parent", "leaves its own", &|all| all[below].max[0] += 100.0),
            ("leaf outside parent", "leaves its own", &|all| all[last].max[1] += 100.0),
            ("triangle outside leaf", "leaves its box", &|all| all[leaf].max[0] = all[leaf].min[0]),
            ("NaN box", "not finite", &|all| all[leaf].min[1] = f32::NAN),
            ("infinite box", "not finite", &|all| all[inner].max[1] = f32::INFINITY),
            ("empty box", "empty", &|all| all[leaf].max[0] = all[leaf].min[0] - 1.0),
            ("link to nowhere", "not there", &|all| all[inner].link = 100_000),
            ("largest link", "not there", &|all| all[inner].link = u32::MAX),
            ("link to itself", "not behind", &|all| all[below].link = (below / 4) as u32),
            ("two parents", "has a parent", &|all| all[below].link = all[uncle].link),
            ("link to the root", "nothing, but", &|all| all[inner].link = EMPTY),
            ("triangles that are not there", "not there", &|all| all[leaf].link = 1000),
            ("overflowing range", "not there", &|all| all[leaf].count = u32::MAX),
            ("a triangle twice", "another leaf", &|all| all[other].link = all[leaf].link),
            ("a leaf too few", "in no leaf", &|all| all[other] = Node::zeroed()),
            ("an empty node too many", "leads to it", &|all| all.extend([Node::zeroed(); 4])),
            ("a node that nothing leads to", "leads to it", &|all| all.extend_from_within(last..)),
            ("a node too few", "not there", &|all| all.truncate(last)),
            ("half a node", "fewer than 4", &|all| all.truncate(last + 2)),
        ];
        for (what, message, harm) in damage {
            let mut children = good.clone();
            harm(&mut children);
            let error = validate(Width::Four, &children, triangles).expect_err(what);
            assert!(error.what.contains(message), "{what}: {error}");
        }
        let mut hole = good.clone();
        hole[0] = Node::zeroed();
        assert!(validate(Width::Four, &hole, triangles).unwrap_err().what.contains("behind it does"));
        hole[1..4].fill(Node::zeroed());
        assert!(validate(Width::Four, &hole, triangles).unwrap_err().what.contains("no child"));
        assert!(validate(Width::Four, &good, &triangles[1..]).is_err());
        assert!(validate(Width::Four, &[], triangles).is_err());
        assert!(validate(Width::Eight, &good, triangles).is_err(), "read at another width");
    }

    #[test]
    fn a_chain_that_is_too_deep_is_refused() {
        let check = |levels: u32| {
            let (children, triangles) = chain(levels);
            validate(Width::Four, &children, &triangles)
        };
        assert_eq!(check(MAX_LEVELS), Ok(()));
        assert!(check(MAX_LEVELS + 1).unwrap_err().what.contains("deeper"));
    }

    /// A tree in which every wide node but the deepest has a leaf and an inner child.
    fn chain(levels: u32) -> (Vec<Node>, Vec<FlatTriangle>) {
        let triangle = strip().triangles()[0];
        let bounds = triangle.triangle().bounds();
        let mut children = Vec::new();
        for level in 0..levels {
            let next = Node { link: level + 1, ..Node::inner(&bounds, 0) };
            let below = if level + 1 < levels { next } else { Node::zeroed() };
            children.extend([Node::leaf(&bounds, level, 1), below, Node::zeroed(), Node::zeroed()]);
        }
        let place = |primitive| FlatTriangle { primitive, ..triangle };
        (children, (0..levels).map(place).collect())
    }

    /// A triangle in two leaves may leave the box of each, but not of both together.
    #[test]
    fn a_repeated_triangle_lies_in_its_leaves_together() {
        let triangle = FlatTriangle {
            v0: [0.0, 0.0, 0.0],
            v1: [2.0, 0.0, 0.0],
            v2: [0.0, 1.0, 0.0],
            ..FlatTriangle::zeroed()
        };
        let half = |from: f32, to: f32, first: u32| {
            Node::leaf(&Aabb::new(Vec3::new(from, 0.0, 0.0), Vec3::new(to, 1.0, 0.0)), first, 1)
        };
        let nothing = Node::zeroed();
        let halves = [half(0.0, 1.0, 0), half(1.0, 2.0, 1), nothing, nothing];
        assert_eq!(validate(Width::Four, &halves, &[triangle; 2]), Ok(()));
        let short = [half(0.0, 1.0, 0), half(1.0, 1.5, 1), nothing, nothing];
        assert!(validate(Width::Four, &short, &[triangle; 2]).is_err());
        // Two triangles of different names must each lie in its own leaf.
        let other = FlatTriangle { primitive: 1, ..triangle };
        assert!(validate(Width::Four, &halves, &[triangle, other]).is_err());
    }
}
