//! Checks the rules of a kd-tree: what makes unchecked trust in one unnecessary.

use super::cells::cells;
use super::{KdNode, MAX_DEPTH};
use crate::{Aabb, FlatTriangle, ValidationError};

/// Checks every rule that [`super`] names. `O(r d)` for `r` references and depth `d`.
pub(super) fn validate(
    nodes: &[KdNode],
    references: &[u32],
    triangles: &[FlatTriangle],
    bounds: &Aabb,
) -> Result<(), ValidationError> {
    if nodes.is_empty() || triangles.is_empty() {
        let nothing = nodes.is_empty() && triangles.is_empty() && references.is_empty();
        return if nothing {
            Ok(())
        } else {
            fail(0, "there are nodes without triangles, or the other way round")
        };
    }
    if nodes.len() >= KdNode::LIMIT || triangles.len() >= KdNode::LIMIT {
        return fail(0, format!("there are more nodes or triangles than {}", KdNode::LIMIT - 1));
    }
    if let Some(index) = triangles.iter().position(|it| !it.triangle().vertices.iter().all(|v| v.is_finite()))
    {
        return fail(0, format!("triangle {index} is not finite"));
    }
    check_shape(nodes, references, triangles.len(), bounds)?;
    Members { nodes, references, triangles, starts: starts(nodes), stamps: vec![0; triangles.len()] }
        .check(bounds)
}

/// The order of the nodes, the planes, the depth, and that each reference is there.
fn check_shape(
    nodes: &[KdNode],
    references: &[u32],
    triangles: usize,
    bounds: &Aabb,
) -> Result<(), ValidationError> {
    let mut visited_nodes = 0;
    let mut first = 0;
    // Inner nodes whose upper child is to come.
    let mut pending: Vec<usize> = Vec::new();
    for visited in cells(nodes, bounds) {
        let (index, node) = (visited.index, visited.node);
        visited_nodes += 1;
        if !node.is_leaf() {
            if visited.depth >= MAX_DEPTH {
                return fail(index, format!("its children are deeper than {MAX_DEPTH}"));
            }
            let (axis, split) = (node.axis(), node.split());
            if !(visited.cell.min[axis] <= split && split <= visited.cell.max[axis]) {
                return fail(index, "its plane does not lie in its cell");
            }
            pending.push(index);
            continue;
        }
        if node.first() as usize != first {
            return fail(index, format!("its references begin at {}, not at {first}", node.first()));
        }
        let Some(own) = references.get(first..first.saturating_add(node.count() as usize)) else {
            return fail(index, "it names references that are not there");
        };
        if own.iter().any(|&reference| reference as usize >= triangles) {
            return fail(index, "it names a triangle that is not there");
        }
        first += own.len();
        if let Some(parent) = pending.pop()
            && nodes[parent].upper() as usize != index + 1
        {
            let upper = nodes[parent].upper();
            return fail(parent, format!("its upper child is named {upper} but follows at {}", index + 1));
        }
    }
    if !pending.is_empty() {
        return fail(nodes.len(), "the last subtree is cut off");
    }
    if visited_nodes < nodes.len() {
        return fail(visited_nodes, "no node leads to it");
    }
    if first < references.len() {
        return fail(0, format!("reference {first} is in no leaf"));
    }
    Ok(())
}

/// How many references there are before each node, and in all.
fn starts(nodes: &[KdNode]) -> Vec<u32> {
    let mut before = 0;
    let mut starts = Vec::with_capacity(nodes.len() + 1);
    for node in nodes {
        starts.push(before);
        if node.is_leaf() {
            before += node.count();
        }
    }
    starts.push(before);
    starts
}

/// Whether each leaf names the triangles that it must, of a tree whose shape is right.
struct Members<'a> {
    nodes: &'a [KdNode],
    references: &'a [u32],
    triangles: &'a [FlatTriangle],
    starts: Vec<u32>,
    /// Who was seen, and in which step.
    stamps: Vec<u32>,
}

impl Members<'_> {
    fn check(&mut self, bounds: &Aabb) -> Result<(), ValidationError> {
        let mut step = 0;
        // The triangles that must be in a subtree; of those that wait the next one's come last.
        let mut due: Vec<Vec<u32>> = vec![(0..self.triangles.len() as u32).collect()];
        for visited in cells(self.nodes, bounds) {
            let Some(required) = due.pop() else { break };
            step += 1;
            if visited.node.is_leaf() {
                self.check_leaf(visited.index, &visited.node, &visited.cell, &required, step)?;
            } else {
                let [low, high] = self.divide(visited.index, &visited.node, &required, step);
                due.push(high);
                due.push(low);
            }
        }
        Ok(())
    }

    /// Where triangles must be: on each side of the plane that their box reaches, and where it lies in the plane, on that side
    /// on which it is, or else above.
    fn divide(&mut self, index: usize, node: &KdNode, required: &[u32], step: u32) -> [Vec<u32>; 2] {
        let mut sides = [Vec::new(), Vec::new()];
        let mut flat = Vec::new();
        for &triangle in required {
            let bounds = self.triangles[triangle as usize].triangle().bounds();
            let [below, above] =
                [bounds.min[node.axis()] < node.split(), bounds.max[node.axis()] > node.split()];
            if below {
                sides[0].push(triangle);
            }
            if above {
                sides[1].push(triangle);
            }
            if !below && !above {
                flat.push(triangle);
            }
        }
        if !flat.is_empty() {
            let of_lower = self.starts[index + 1] as usize..self.starts[node.upper() as usize] as usize;
            for &triangle in &self.references[of_lower] {
                self.stamps[triangle as usize] = step;
            }
            for triangle in flat {
                sides[usize::from(self.stamps[triangle as usize] != step)].push(triangle);
            }
        }
        sides
    }

    fn check_leaf(
        &mut self,
        index: usize,
        node: &KdNode,
        cell: &Aabb,
        required: &[u32],
        step: u32,
    ) -> Result<(), ValidationError> {
        let own = &self.references[node.first() as usize..][..node.count() as usize];
        for &triangle in own {
            let stamp = &mut self.stamps[triangle as usize];
            if *stamp == step {
                return fail(index, format!("it names triangle {triangle} twice"));
            }
            *stamp = step;
            let bounds = self.triangles[triangle as usize].triangle().bounds();
            if !(bounds.min.cmple(cell.max).all() && cell.min.cmple(bounds.max).all()) {
                return fail(index, format!("triangle {triangle} does not meet its cell"));
            }
        }
        match required.iter().find(|&&triangle| self.stamps[triangle as usize] != step) {
            Some(triangle) => fail(index, format!("triangle {triangle} overlaps its cell and is not in it")),
            None => Ok(()),
        }
    }
}

fn fail(node: usize, what: impl Into<String>) -> Result<(), ValidationError> {
    Err(ValidationError { node, what: what.into() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::glam::Vec3;
    use crate::kd_tree::{KdOptions, KdTree};
    use crate::{Mesh, Scene};

    fn strip() -> KdTree {
        let positions = (0..42).map(|i| Vec3::new(i as f32, (i % 2) as f32, 0.1 * i as f32)).collect();
        let mesh = Mesh::new(positions, (0..40).map(|i| [i, i + 1, i + 2]).collect());
        Scene::from_mesh(mesh).build_kd(&KdOptions::default()).unwrap()
    }

    #[test]
    fn what_the_builder_makes_is_valid() {
        let tree = strip();
        assert!(tree.report().leaves > 8 && tree.has_repeats(), "{:?}", tree.report());
        assert_eq!(tree.validate(), Ok(()));
        let parts = (tree.nodes().to_vec(), tree.references().to_vec(), tree.triangles().to_vec());
        let again = KdTree::from_parts(parts.0, parts.1, parts.2).unwrap();
        assert_eq!((again.passive_references(), again.report().references), (14, tree.references().len()));
        assert_eq!(tree.passive_references(), 14);
        assert!(KdTree::from_parts(vec![], vec![], vec![]).is_ok());
    }

    /// Each kind of damage must be found.
    #[test]
    fn damage_is_found() {
        let good = strip();
        let leaf = good.nodes().iter().position(|node| node.is_leaf() && node.count() > 1).unwrap();
        let last = good.nodes().iter().rposition(|node| node.is_leaf() && node.count() > 1).unwrap();
        type Parts = (Vec<KdNode>, Vec<u32>, Vec<FlatTriangle>);
        type Harm<'a> = &'a dyn Fn(&mut Parts);
        let damage: [(&str, Harm<'_>); 16] = [
            ("a plane outside of its cell", &|(nodes, ..)| {
                nodes[0] = KdNode::inner(nodes[0].axis(), 1e6, nodes[0].upper());
            }),
            ("a plane that is none", &|(nodes, ..)| {
                nodes[0] = KdNode::inner(nodes[0].axis(), f32::NAN, nodes[0].upper());
            }),
            ("a plane elsewhere", &|(nodes, ..)| {
                nodes[0] = KdNode::inner(nodes[0].axis(), nodes[0].split() + 1.0, nodes[0].upper());
            }),
            ("another axis", &|(nodes, ..)| nodes[0] = KdNode::inner(1, 0.5, nodes[0].upper())),
            ("upper child elsewhere", &|(nodes, ..)| nodes[0].axis_and_link += 4),
            ("upper child at itself", &|(nodes, ..)| nodes[0].axis_and_link &= 3),
            ("a leaf that begins elsewhere", &|(nodes, ..)| nodes[last].split_or_first -= 1),
            ("a leaf that is too long", &|(nodes, ..)| nodes[last].axis_and_link += 400),
            ("a leaf that is too short", &|(nodes, ..)| nodes[last].axis_and_link -= 4),
            ("a triangle twice", &|(nodes, references, _)| {
                let first = nodes[leaf].first() as usize;
                references[first] = references[first + 1];
            }),
            ("a triangle that is elsewhere", &|(nodes, references, _)| {
                references[nodes[last].first() as usize] = 0;
            }),
            ("a triangle that is not there", &|(_, references, _)| references[3] = 40),
            ("a triangle too many", &|(.., triangles)| triangles.push(triangles[0])),
            ("a triangle that is not finite", &|(.., triangles)| triangles[0].v0[0] = f32::NAN),
            ("a node too many", &|(nodes, ..)| nodes.push(KdNode::leaf(0, 0))),
            ("a node too few", &|(nodes, ..)| nodes.truncate(nodes.len() - 1)),
        ];
        for (what, harm) in damage {
            let mut parts = (good.nodes().to_vec(), good.references().to_vec(), good.triangles().to_vec());
            harm(&mut parts);
            assert!(KdTree::from_parts(parts.0, parts.1, parts.2).is_err(), "{what} was not found");
        }
        assert!(KdTree::from_parts(vec![KdNode::leaf(0, 0)], vec![], vec![]).is_err());
        assert!(KdTree::from_parts(vec![], vec![], good.triangles().to_vec()).is_err());
    }

    /// One that lies in a plane may be on either side, and must be on one.
    #[test]
    fn what_lies_in_a_plane_is_on_one_side() {
        let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
        let place = |x: f32| corners.map(|[y, z]| Vec3::new(x, y, z));
        let positions = [place(0.0), place(1.0), place(2.0)].concat();
        let mesh = Mesh::new(positions, vec![[0, 1, 2], [3, 4, 5], [6, 7, 8]]);
        let triangles = Scene::from_mesh(mesh).flatten().unwrap().triangles;
        let make = |references: [u32; 3], low: u32| {
            let nodes = vec![KdNode::inner(0, 1.0, 2), KdNode::leaf(0, low), KdNode::leaf(low, 3 - low)];
            KdTree::from_parts(nodes, references.to_vec(), triangles.clone())
        };
        assert!(make([0, 1, 2], 1).is_ok() && make([0, 1, 2], 2).is_ok());
        assert!(make([0, 2, 2], 1).is_err() && make([0, 0, 2], 2).is_err());
    }
}
