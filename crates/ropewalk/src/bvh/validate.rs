//! Checks the rules of a binary BVH: what makes unchecked trust in one unnecessary.

use super::{MAX_DEPTH, Node};
use crate::{FlatTriangle, ValidationError};

/// Checks every rule that [`super`] names.
pub(super) fn validate(nodes: &[Node], triangles: &[FlatTriangle]) -> Result<(), ValidationError> {
    if nodes.is_empty() {
        return if triangles.is_empty() { Ok(()) } else { fail(0, "there are triangles but no nodes") };
    }
    let mut next_triangle = vec![false; triangles.len()];
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
                return fail(index, "a triangle leaves its box");
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
    match next_triangle.iter().position(|&seen| !seen) {
        Some(triangle) => fail(0, format!("triangle {triangle} is in no leaf")),
        None => Ok(()),
    }
}

fn fail(node: usize, what: impl Into<String>) -> Result<(), ValidationError> {
    Err(ValidationError { node, what: what.into() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::BuildOptions;
    use crate::{Mesh, Scene};
    use glam::Vec3;

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
