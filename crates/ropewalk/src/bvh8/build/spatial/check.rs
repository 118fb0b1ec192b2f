//! The rules of a [`Tree`], for the tests of its builders, and what a ray is expected to pay in it.
//!
//! A triangle that stands in one leaf lies in its box. One that stands in several lies in their boxes taken together:
//! each corner of its own box is in one of them, and each of them meets its box.

use crate::bvh8::tree::{Child, LARGEST_LEAF, MAX_LEVELS, Tree, WIDTH};
use crate::{Aabb, FlatTriangle};
use glam::Vec3;

/// What a valid tree comes to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(in crate::bvh8) struct Summary {
    pub(in crate::bvh8) levels: u32,
    pub(in crate::bvh8) leaves: usize,
    pub(in crate::bvh8) references: usize,
    pub(in crate::bvh8) largest_leaf: u32,
    /// 1 for each visit of a node and of a leaf, expected of a ray that enters the root's box.
    pub(in crate::bvh8) cost: f64,
}

/// Checks every rule that the tree's own text names.
pub(in crate::bvh8) fn check(tree: &Tree, triangles: &[FlatTriangle]) -> Result<Summary, String> {
    let mut summary = Summary { references: tree.order.len(), ..Summary::default() };
    if tree.nodes.is_empty() {
        return if triangles.is_empty() && tree.order.is_empty() {
            Ok(summary)
        } else {
            Err("no node".into())
        };
    }
    // The box that a parent has for each node, and the level of it.
    let mut known: Vec<Option<(Aabb, u32)>> = vec![None; tree.nodes.len()];
    let mut taken = vec![false; tree.order.len()];
    let mut standing: Vec<(u32, Aabb)> = Vec::new();
    let mut areas = 0.0;
    known[0] = Some((Aabb::new(Vec3::splat(f32::MIN), Vec3::splat(f32::MAX)), 1));
    let mut root = Aabb::EMPTY;
    for (index, node) in tree.nodes.iter().enumerate() {
        let Some((outer, level)) = known[index] else { return Err(format!("no node leads to {index}")) };
        summary.levels = summary.levels.max(level);
        let len = node.len();
        if len == 0 {
            return Err(format!("node {index} has no child"));
        }
        for place in 0..WIDTH {
            let (child, bounds) = (node.children[place], node.child_bounds(place));
            if place >= len {
                if child != Child::NOTHING || bounds != Aabb::EMPTY {
                    return Err(format!("node {index}: place {place} is not empty"));
                }
                continue;
            }
            if bounds.is_empty() || !(bounds.min.is_finite() && bounds.max.is_finite()) {
                return Err(format!("node {index}: the box of place {place} is {bounds:?}"));
            }
            if !outer.contains(&bounds) {
                return Err(format!("node {index}: place {place} leaves the box above"));
            }
            if index == 0 {
                root = root.union(bounds);
            }
            areas += f64::from(bounds.half_area());
            if !child.is_leaf() {
                let below = known.get_mut(child.link as usize).filter(|_| child.link as usize > index);
                match below {
                    Some(known @ None) => *known = Some((bounds, level + 1)),
                    _ => return Err(format!("node {index}: place {place} leads to node {}", child.link)),
                }
                continue;
            }
            summary.leaves += 1;
            summary.largest_leaf = summary.largest_leaf.max(child.count);
            let range = child.link as usize..child.link as usize + child.count as usize;
            let Some(leaf) = tree.order.get(range.clone()) else {
                return Err(format!("node {index}: place {place} has references that are not there"));
            };
            for (number, triangle) in leaf.iter().enumerate() {
                if leaf[..number].contains(triangle) {
                    return Err(format!("node {index}: place {place} has triangle {triangle} twice"));
                }
                standing.push((*triangle, bounds));
            }
            if taken[range.clone()].contains(&true) {
                return Err(format!("node {index}: place {place} has references of another leaf"));
            }
            taken[range].fill(true);
        }
    }
    if taken.contains(&false) {
        return Err("a reference is in no leaf".into());
    }
    if summary.largest_leaf > LARGEST_LEAF || summary.levels > MAX_LEVELS {
        return Err(format!("too large or too deep: {summary:?}"));
    }
    covered(triangles, standing)?;
    let area = f64::from(root.half_area());
    summary.cost = if area > 0.0 { 1.0 + areas / area } else { 0.0 };
    Ok(summary)
}

/// Every triangle is in a leaf, and those it is in cover it together.
fn covered(triangles: &[FlatTriangle], mut standing: Vec<(u32, Aabb)>) -> Result<(), String> {
    standing.sort_by_key(|&(triangle, _)| triangle);
    let mut places = standing.chunk_by(|a, b| a.0 == b.0);
    for (index, triangle) in triangles.iter().enumerate() {
        let Some(places) = places.next().filter(|places| places[0].0 as usize == index) else {
            return Err(format!("triangle {index} is in no leaf"));
        };
        let own = triangle.triangle().bounds();
        let stray = |bounds: &Aabb| !(bounds.min.cmple(own.max).all() && own.min.cmple(bounds.max).all());
        if places.iter().any(|(_, bounds)| stray(bounds)) {
            return Err(format!("triangle {index} does not meet the box of its leaf"));
        }
        let is_covered = (0..8).all(|corner| {
            let side = |axis: u32| if corner >> axis & 1 == 0 { own.min } else { own.max };
            let point = Vec3::new(side(0).x, side(1).y, side(2).z);
            places.iter().any(|(_, bounds)| bounds.contains(&Aabb::new(point, point)))
        });
        if !is_covered {
            return Err(format!("triangle {index} leaves the boxes of its leaves"));
        }
    }
    if places.next().is_some() { Err("a leaf names a triangle that is not there".into()) } else { Ok(()) }
}

mod tests {
    use super::*;
    use crate::NoMonitor;
    use crate::bvh8::build::spatial::tests::soup;
    use crate::bvh8::build::spatial::{SpatialOptions, build_spatial};

    /// Each kind of damage must be found.
    #[test]
    fn damage_is_found() {
        let triangles = soup(300, 1, 1.0);
        let options = SpatialOptions { duplication: 0, ..SpatialOptions::default() };
        let good = build_spatial(&triangles, &options, &NoMonitor).unwrap();
        check(&good, &triangles).unwrap();
        let inner = good.nodes[0].children.iter().position(|child| !child.is_leaf()).unwrap();
        let last = good.nodes.len() - 1;
        let leaf = good.nodes[last].children.iter().position(|child| child.count > 1).unwrap();
        type Harm<'a> = &'a dyn Fn(&mut Tree);
        let damage: [(&str, Harm<'_>); 12] = [
            ("child outside of its parent", &|tree| tree.nodes[last].bounds[3][0] += 100.0),
            ("triangle outside of its leaf", &|tree| {
                tree.nodes[last].bounds[3][leaf] = tree.nodes[last].bounds[0][leaf];
            }),
            ("NaN", &|tree| tree.nodes[0].bounds[1][inner] = f32::NAN),
            ("a node that leads to itself", &|tree| tree.nodes[last].children[0] = Child::inner(last as u32)),
            ("a node two lead to", &|tree| tree.nodes[0].children[inner].link += 1),
            ("references that are not there", &|tree| tree.nodes[last].children[leaf].link = u32::MAX),
            ("a triangle twice in a leaf", &|tree| {
                let first = tree.nodes[last].children[leaf].link as usize;
                tree.order[first] = tree.order[first + 1];
            }),
            ("a leaf named twice", &|tree| tree.nodes[last].children[leaf].link = 0),
            ("a reference too many", &|tree| tree.order.push(0)),
            ("a triangle that is not there", &|tree| tree.order[0] = 300),
            ("an empty place with a box", &|tree| {
                let node = tree.nodes.iter_mut().find(|node| node.len() < WIDTH).unwrap();
                node.bounds[0][WIDTH - 1] = 0.0;
            }),
            ("a node that nobody leads to", &|tree| tree.nodes.push(tree.nodes[last])),
        ];
        for (what, harm) in damage {
            let mut tree = good.clone();
            harm(&mut tree);
            assert!(check(&tree, &triangles).is_err(), "{what} was not found");
        }
        assert!(check(&good, &triangles[1..]).is_err());
    }
}
