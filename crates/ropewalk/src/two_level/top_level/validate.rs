//! Checks the rules of a top level, see [`super`]. `O(n)`.

use super::MAX_DEPTH;
use crate::ValidationError;
use crate::bvh::Node;

pub(super) fn validate(nodes: &[Node]) -> Result<(), ValidationError> {
    let mut is_seen = vec![false; nodes.len().div_ceil(2)];
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
        if node.count != 1 {
            return fail(index, format!("it is a leaf of {} entries instead of one", node.count));
        }
        let entry = node.link as usize;
        let Some(seen) = is_seen.get_mut(entry) else {
            return fail(index, format!("it names entry {entry}, and there are {}", is_seen.len()));
        };
        if std::mem::replace(seen, true) {
            return fail(index, format!("entry {entry} is in another leaf too"));
        }
        match pending.pop() {
            Some((second, of, second_depth)) => {
                if second == nodes.len() {
                    return fail(of, "its second child is cut off");
                }
                if second != index + 1 {
                    let what = format!("its second child is named {second} but follows at {}", index + 1);
                    return fail(of, what);
                }
                parent = Some(of);
                depth = second_depth;
            }
            None if index + 1 < nodes.len() => return fail(index + 1, "no node leads to it"),
            None => {}
        }
    }
    if pending.is_empty() { Ok(()) } else { fail(nodes.len(), "the last subtree is cut off") }
}

fn fail(node: usize, what: impl Into<String>) -> Result<(), ValidationError> {
    Err(ValidationError { node, what: what.into() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Aabb;
    use crate::two_level::TopLevel;
    use glam::Vec3;

    /// Each kind of damage must be found.
    #[test]
    fn damage_is_found() {
        let boxes: Vec<Aabb> =
            (0..9).map(|i| Vec3::splat(i as f32)).map(|low| Aabb::new(low, low + 0.5)).collect();
        let good = TopLevel::build(&boxes).unwrap().nodes().to_vec();
        assert_eq!(validate(&good), Ok(()));
        assert_eq!(validate(&[]), Ok(()));
        let inner = good.iter().rposition(|node| !node.is_leaf()).unwrap();
        let leaf = good.iter().position(Node::is_leaf).unwrap();
        let other = good.iter().rposition(Node::is_leaf).unwrap();
        type Harm<'a> = &'a dyn Fn(&mut Vec<Node>);
        let damage: [(&str, Harm<'_>); 9] = [
            ("child outside parent", &|nodes| nodes[leaf].max[0] += 100.0),
            ("NaN box", &|nodes| nodes[leaf].min[1] = f32::NAN),
            ("second child elsewhere", &|nodes| nodes[inner].link += 1),
            ("an entry that is not there", &|nodes| nodes[leaf].link = 9),
            ("a leaf of two", &|nodes| nodes[leaf].count = 2),
            ("an entry twice", &|nodes| nodes[other].link = nodes[leaf].link),
            ("a node too many", &|nodes| nodes.push(nodes[leaf])),
            ("a node too few", &|nodes| nodes.truncate(nodes.len() - 1)),
            ("an inner node at the end", &|nodes| nodes[other].count = 0),
        ];
        for (what, harm) in damage {
            let mut nodes = good.clone();
            harm(&mut nodes);
            assert!(validate(&nodes).is_err(), "{what} was not found");
        }
        assert_eq!(validate(&chain(MAX_DEPTH)), Ok(()));
        assert!(validate(&chain(MAX_DEPTH + 1)).unwrap_err().what.contains("deeper"));
    }

    /// So many inner nodes above each other.
    fn chain(inner: u32) -> Vec<Node> {
        let bounds = Aabb::new(Vec3::ZERO, Vec3::ONE);
        let levels = 0..inner;
        let mut nodes: Vec<Node> = levels
            .flat_map(|level| [Node::inner(&bounds, 2 * level + 2), Node::leaf(&bounds, level, 1)])
            .collect();
        nodes.push(Node::leaf(&bounds, inner, 1));
        nodes
    }
}
