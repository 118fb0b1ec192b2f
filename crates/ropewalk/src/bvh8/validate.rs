//! Checks that a packed tree keeps its rules.

use super::node::Word;
use super::tree::{MAX_LEVELS, WIDTH};
use super::{Bvh8, Form, ROOT};
use crate::bvh::Node;
use crate::bvh::validate::{check_parts, identity};
use crate::{FlatTriangle, ValidationError};
use glam::Vec3;

impl Bvh8 {
    /// Checks every rule of the structure.
    ///
    /// # Errors
    /// Names the first node that breaks one, by its number in the order of the tree.
    pub fn validate(&self) -> Result<(), ValidationError> {
        let (mut leaves, mut triangles) = (Vec::new(), Vec::new());
        let mut leaving = Vec::new();
        let mut pending = if self.is_empty() { Vec::new() } else { vec![(ROOT, self.bounds(), 1)] };
        let mut count = 0;
        while let Some((word, bounds, level)) = pending.pop() {
            let fail = |what: &str| Err(ValidationError { node: count, what: what.into() });
            if level > MAX_LEVELS {
                return fail("it is deeper than a walk can go");
            }
            let packed = self.node(word);
            let mut turns = [0u32; 8];
            for order in packed.order {
                for (octant, seen) in turns.iter_mut().enumerate() {
                    *seen |= 1 << (order >> (3 * octant) & 7);
                }
            }
            if turns != [0xff; 8] {
                return fail("an octant's order leaves out a place");
            }
            let mut filled = 0;
            for place in 0..WIDTH {
                let own = packed.child_bounds(place);
                let word = Word(packed.children[place]);
                if word == ROOT {
                    if !(own.min == Vec3::INFINITY && own.max == Vec3::NEG_INFINITY) {
                        return fail("a place that holds nothing has a box");
                    }
                    continue;
                }
                filled += 1;
                if !(own.min.is_finite() && own.max.is_finite() && !own.is_empty()) {
                    return fail("the box of a child is empty or not finite");
                }
                // A compact node's boxes are larger than what the node above was packed with.
                if self.form == Form::Full && !bounds.contains(&own) {
                    return fail("the box of a child leaves its own");
                }
                if word.is_leaf() {
                    let first = triangles.len();
                    self.read_leaf(word, &mut triangles);
                    leaves.push(Node::leaf(&own, first as u32, word.count()));
                    let outside = |triangle: &&FlatTriangle| !own.contains(&triangle.triangle().bounds());
                    leaving.extend(triangles[first..].iter().filter(outside).map(identity));
                } else {
                    pending.push((word, own, level + 1));
                }
            }
            if filled == 0 {
                return fail("it has no child");
            }
            count += 1;
        }
        let fail = |what: &str| Err(ValidationError { node: 0, what: what.into() });
        if triangles.len() != self.report.references || leaves.len() != self.report.leaves {
            return fail("the tree has other leaves than were built");
        }
        self.validate_compact()?;
        leaving.sort_unstable();
        check_parts(&leaves, &triangles, &leaving)
    }
}
