//! Checks the rules of a binary BVH: what makes unchecked trust in one unnecessary.
//!
//! A triangle that stands in one leaf lies in its box. One that stands in several, as spatial splits make it, lies
//! in their boxes taken together: each corner of its own box is in one of them, and each of them meets its box. Who
//! a triangle is tell instance, geometry and primitive.

use super::{MAX_DEPTH, Node};
use crate::{Aabb, FlatTriangle, ValidationError};
use glam::Vec3;

/// Checks every rule that [`super`] names. `O(n)`, and a sort of the triangles that leave a leaf's box.
pub(super) fn validate(nodes: &[Node], triangles: &[FlatTriangle]) -> Result<(), ValidationError> {
    if nodes.is_empty() {
        return if triangles.is_empty() { Ok(()) } else { fail(0, "there are triangles but no nodes") };
    }
    let mut next_triangle = vec![false; triangles.len()];
    // Who leaves the box of a leaf, and must be in others as well.
    let mut leaving: Vec<Identity> = Vec::new();
    // Second children to come: (index that the parent names, the parent, depth).
    let mut pending: Vec<(usize, usize, u32)> = Vec::new();
    let mut parent: Option<usize> = None;
    let mut depth = 0;
    for (index, node) in nodes.iter().enumerate() {
        let bounds = node.bounds();
        if !(bounds.min.is_finite() && bounds.max.is_finite() && !bounds.is_empty()) {
            return fail(index, "its box is empty or not finite");
        }
        if let Some(parent) = parent
            && !nodes[parent].bounds().contains(&bounds)
        {
            return fail(index, format!("its box leaves that of its parent {parent}"));
        }
        if !node.is_leaf() {
            depth += 1;
            if depth > MAX_DEPTH {
                return fail(index, format!("its children are deeper than {MAX_DEPTH}"));
            }
            pending.push((node.link as usize, index, depth));
            parent = Some(index);
            continue;
        }
        let first = node.link as usize;
        let Some(leaf) = triangles.get(first..first.saturating_add(node.count as usize)) else {
            return fail(index, "it names triangles that are not there");
        };
        for (triangle, seen) in leaf.iter().zip(&mut next_triangle[first..]) {
            if *seen {
                return fail(index, "one of its triangles is in another leaf too");
            }
            *seen = true;
            if !bounds.contains(&triangle.triangle().bounds()) {
                leaving.push(identity(triangle));
            }
        }
        match pending.pop() {
            Some((second, of, second_depth)) => {
                if second != index + 1 {
                    return fail(
                        of,
                        format!("its second child is named {second} but follows at {}", index + 1),
                    );
                }
                parent = Some(of);
                depth = second_depth;
            }
            None if index + 1 < nodes.len() => return fail(index + 1, "no node leads to it"),
            None => {}
        }
    }
    if !pending.is_empty() {
        return fail(nodes.len(), "the last subtree is cut off");
    }
    if let Some(triangle) = next_triangle.iter().position(|&seen| !seen) {
        return fail(0, format!("triangle {triangle} is in no leaf"));
    }
    leaving.sort_unstable();
    check_parts(nodes, triangles, &leaving)
}

/// Instance, geometry, primitive.
pub(crate) type Identity = (u32, u32, u32);

pub(crate) fn identity(triangle: &FlatTriangle) -> Identity {
    (triangle.instance(), triangle.geometry(), triangle.primitive)
}

/// Checks the triangles that leave a leaf's box, sorted: the leaves in which each stands must cover it together.
pub(crate) fn check_parts(
    nodes: &[Node],
    triangles: &[FlatTriangle],
    leaving: &[Identity],
) -> Result<(), ValidationError> {
    if leaving.is_empty() {
        return Ok(());
    }
    let mut standing: Vec<(Identity, usize, &FlatTriangle)> = Vec::new();
    for (index, leaf) in nodes.iter().enumerate().filter(|(_, node)| node.is_leaf()) {
        for triangle in triangles.iter().skip(leaf.link as usize).take(leaf.count as usize) {
            let identity = identity(triangle);
            if leaving.binary_search(&identity).is_ok() {
                standing.push((identity, index, triangle));
            }
        }
    }
    standing.sort_unstable_by_key(|&(identity, leaf, _)| (identity, leaf));
    for places in standing.chunk_by(|a, b| a.0 == b.0) {
        let Some(&(_, first, triangle)) = places.first() else { continue };
        if places.iter().any(|(.., other)| *other != triangle) {
            return fail(first, "one of its triangles bears the indices of a different one");
        }
        let own = triangle.triangle().bounds();
        let boxes = || places.iter().map(|&(_, leaf, _)| nodes[leaf].bounds());
        let stray = places.iter().find(|&&(_, leaf, _)| !overlap(&nodes[leaf].bounds(), &own));
        if let Some(&(_, leaf, _)) = stray {
            return fail(leaf, "a triangle does not meet its box");
        }
        let is_covered = (0..8).all(|corner| {
            let side = |axis: u32| if corner >> axis & 1 == 0 { own.min } else { own.max };
            let point = Vec3::new(side(0).x, side(1).y, side(2).z);
            boxes().any(|bounds| bounds.contains(&Aabb::new(point, point)))
        });
        if !is_covered {
            return fail(first, "a triangle leaves its box, and no other leaf has the rest of it");
        }
    }
    Ok(())
}

fn overlap(a: &Aabb, b: &Aabb) -> bool {
    a.min.cmple(b.max).all() && b.min.cmple(a.max).all()
}

/// How many different triangles there are among these.
pub(crate) fn count_distinct(triangles: &[FlatTriangle]) -> usize {
    let mut ids: Vec<Identity> = triangles.iter().map(identity).collect();
    ids.sort_unstable();
    ids.dedup();
    ids.len()
}

fn fail(node: usize, what: impl Into<String>) -> Result<(), ValidationError> {
    Err(ValidationError { node, what: what.into() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::BuildOptions;
    use crate::{Mesh, Scene};

    fn strip() -> (Vec<Node>, Vec<FlatTriangle>) {
        let positions = (0..12).map(|i| Vec3::new(i as f32, (i % 2) as f32, 0.1 * i as f32)).collect();
        let mesh = Mesh::new(positions, (0..10).map(|i| [i, i + 1, i + 2]).collect());
        let options = BuildOptions { max_leaf: 2, ..BuildOptions::default() };
        let bvh = Scene::from_mesh(mesh).build(&options).unwrap();
        (bvh.nodes().to_vec(), bvh.triangles().to_vec())
    }

    #[test]
    fn what_the_builder_makes_is_valid() {
        let (nodes, triangles) = strip();
        assert_eq!(validate(&nodes, &triangles), Ok(()));
        assert_eq!(validate(&[], &[]), Ok(()));
    }

    /// Each kind of damage must be found.
    #[test]
    fn damage_is_found() {
        let (good, triangles) = strip();
        let inner = good.iter().rposition(|node| !node.is_leaf()).unwrap();
        let leaf = good.iter().position(Node::is_leaf).unwrap();
        let other = good.iter().rposition(Node::is_leaf).unwrap();
        type Harm<'a> = &'a dyn Fn(&mut Vec<Node>);
        let damage: [(&str, Harm<'_>); 10] = [
            ("child outside parent", &|nodes| nodes[leaf].max[0] += 100.0),
            ("triangle outside leaf", &|nodes| nodes[leaf].max[0] = nodes[leaf].min[0]),
            ("NaN box", &|nodes| nodes[leaf].min[1] = f32::NAN),
            ("second child elsewhere", &|nodes| nodes[inner].link += 1),
            ("second child at itself", &|nodes| nodes[inner].link = inner as u32),
            ("triangles that are not there", &|nodes| nodes[leaf].link = 1000),
            ("overflowing range", &|nodes| nodes[leaf].count = u32::MAX),
            ("a triangle twice", &|nodes| nodes[other].link = nodes[leaf].link),
            ("a node too many", &|nodes| nodes.push(nodes[leaf])),
            ("a node too few", &|nodes| nodes.truncate(nodes.len() - 1)),
        ];
        for (what, harm) in damage {
            let mut nodes = good.clone();
            harm(&mut nodes);
            assert!(validate(&nodes, &triangles).is_err(), "{what} was not found");
        }
        assert!(validate(&good, &triangles[1..]).is_err());
        assert!(validate(&[], &triangles).is_err());
    }

    /// Two triangles: one whole in the first leaf, the other half in each of two.
    fn split_in_two() -> (Vec<Node>, Vec<FlatTriangle>) {
        let corners = [Vec3::ZERO, Vec3::new(4.0, 0.0, 0.0), Vec3::new(0.0, 4.0, 0.0)];
        let mesh = Mesh::new(corners.to_vec(), vec![[0, 1, 2], [0, 2, 1]]);
        let [whole, split] = Scene::from_mesh(mesh).flatten().unwrap().triangles[..] else { panic!() };
        let bounds = |low: f32, high: f32, top: f32| Aabb::new(Vec3::X * low, Vec3::new(high, top, 0.0));
        let nodes = vec![
            Node::inner(&bounds(0.0, 4.0, 4.0), 2),
            Node::leaf(&bounds(0.0, 4.0, 4.0), 0, 2),
            Node::leaf(&bounds(2.0, 4.0, 4.0), 2, 1),
        ];
        (nodes, vec![whole, split, split])
    }

    #[test]
    fn parts_must_cover_the_whole() {
        let (good, triangles) = split_in_two();
        assert_eq!(validate(&good, &triangles), Ok(()));
        // Without the whole triangle the first leaf may be as small as its part.
        let parts = [triangles[1], triangles[1]];
        let mut small = good.clone();
        (small[1].count, small[2].link, small[1].max[0]) = (1, 1, 2.0);
        assert_eq!(validate(&small, &parts), Ok(()));
        assert_eq!(count_distinct(&parts), 1);

        type Harm<'a> = &'a dyn Fn(&mut Vec<Node>, &mut Vec<FlatTriangle>);
        let damage: [(&str, Harm<'_>); 6] = [
            ("a gap at a corner", &|nodes, _| nodes[1].max[1] = 3.0),
            ("parts that end early", &|nodes, _| nodes[2].max[0] = 3.0),
            ("a leaf elsewhere", &|nodes, _| (nodes[2].min[2], nodes[2].max[2]) = (1.0, 1.0)),
            ("another triangle of the same name", &|_, triangles| triangles[1].v1[0] = 3.5),
            ("a part whose other part is gone", &|_, triangles| triangles[1].primitive += 1),
            ("a child outside its parent", &|nodes, _| nodes[2].max[0] = 5.0),
        ];
        for (what, harm) in damage {
            let (mut nodes, mut triangles) = (small.clone(), parts.to_vec());
            harm(&mut nodes, &mut triangles);
            // A leaf elsewhere is a fault only while its parent is not.
            nodes[0].max[2] = nodes[2].max[2].max(0.0);
            assert!(validate(&nodes, &triangles).is_err(), "{what} was not found");
        }
        // One that stands once must still lie in its leaf.
        let mut alone = good;
        alone[1].max[0] = 2.0;
        assert!(validate(&alone, &triangles).is_err());
    }

    #[test]
    fn a_chain_that_is_too_deep_is_refused() {
        let (nodes, triangles) = chain(MAX_DEPTH as usize);
        assert_eq!(validate(&nodes, &triangles), Ok(()));
        let (nodes, triangles) = chain(MAX_DEPTH as usize + 1);
        assert!(validate(&nodes, &triangles).unwrap_err().what.contains("deeper"));
    }

    /// A tree in which every inner node has a leaf first: `inner` inner nodes above each other.
    fn chain(inner: usize) -> (Vec<Node>, Vec<FlatTriangle>) {
        let (nodes, triangles) = strip();
        let (bounds, triangle) = (nodes[0].bounds(), triangles[0]);
        let mut nodes = Vec::new();
        for level in 0..inner as u32 {
            nodes.push(Node::inner(&bounds, 2 * level + 2));
            nodes.push(Node::leaf(&bounds, level, 1));
        }
        nodes.push(Node::leaf(&bounds, inner as u32, 1));
        (nodes, vec![triangle; inner + 1])
    }
}
