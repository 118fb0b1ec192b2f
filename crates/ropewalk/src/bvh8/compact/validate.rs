//! Checks that a compact tree keeps the rules of its form.

use crate::bvh8::node::Word;
use crate::bvh8::tree::MAX_LEVELS;
use crate::bvh8::{Bvh8, Form, ROOT};
use crate::{Aabb, ValidationError};

/// A node on the way.
struct Visited {
    /// The node above; none of the root.
    parent: Option<usize>,
    /// Its box, as the node above has it.
    own: Aabb,
    /// The box around the triangles below it.
    inside: Aabb,
}

impl Bvh8 {
    /// Checks that every box holds the triangles below it, that triangles have vertices of the section, and that none is there
    /// twice. Nothing of a tree in full.
    pub(in super::super) fn validate_compact(&self) -> Result<(), ValidationError> {
        let Form::Compact { vertices, count } = self.form else { return Ok(()) };
        let section = vertices..vertices + 3 * count;
        let mut visited: Vec<Visited> = Vec::new();
        let mut pending = if self.is_empty() { Vec::new() } else { vec![(ROOT, None, self.bounds(), 1)] };
        let (mut triangles, mut corners) = (Vec::new(), Vec::new());
        while let Some((word, parent, own, level)) = pending.pop() {
            let this = visited.len();
            let fail = |what: &str| Err(ValidationError { node: this, what: what.into() });
            if level > MAX_LEVELS {
                return fail("it is deeper than a walk can go");
            }
            let node = self.node(word);
            let mut inside = Aabb::EMPTY;
            for place in (0..node.children.len()).filter(|&place| node.children[place] != ROOT.0) {
                let (word, own) = (Word(node.children[place]), node.child_bounds(place));
                if !word.is_leaf() {
                    pending.push((word, Some(this), own, level + 1));
                    continue;
                }
                corners.clear();
                self.append_vertices(word, &mut corners);
                if !corners.iter().all(|at| section.contains(at) && (at - vertices).is_multiple_of(3)) {
                    return fail("a triangle has a vertex that is none");
                }
                triangles.clear();
                self.read_leaf(word, &mut triangles);
                let whole = triangles
                    .iter()
                    .fold(Aabb::EMPTY, |whole, triangle| whole.union(triangle.triangle().bounds()));
                if !own.contains(&whole) {
                    return fail("a triangle leaves the box of its leaf");
                }
                inside = inside.union(whole);
            }
            visited.push(Visited { parent, own, inside });
        }
        // Nodes come behind those above them.
        for index in (0..visited.len()).rev() {
            let Visited { parent, own, inside } = visited[index];
            if !own.contains(&inside) {
                return Err(ValidationError { node: index, what: "a triangle leaves a box above it".into() });
            }
            if let Some(parent) = parent {
                visited[parent].inside = visited[parent].inside.union(inside);
            }
        }
        let mut places = self.arena.words()[section].as_chunks::<3>().0.to_vec();
        places.sort_unstable();
        match places.windows(2).any(|pair| pair[0] == pair[1]) {
            true => Err(ValidationError { node: 0, what: "a vertex is there twice".into() }),
            false => Ok(()),
        }
    }
}
