//! Checks that both levels keep their rules.

use super::place::world_bounds;
use super::{Instanced, Top};
use crate::ValidationError;
use crate::bvh8::ROOT;
use crate::bvh8::node::Word;
use crate::bvh8::tree::{MAX_LEVELS, WIDTH};
use crate::two_level::Placed;
use crate::{Aabb, FlatTriangle};
use glam::Vec3;

impl Instanced {
    /// Checks every rule of the structure, and those of the objects' trees.
    ///
    /// # Errors
    /// Names the first node, instance or object that breaks one.
    pub fn validate(&self) -> Result<(), ValidationError> {
        let fail = |node: usize, what: String| Err(ValidationError { node, what });
        for (index, object) in self.objects.iter().enumerate() {
            if let Err(ValidationError { node, what }) = object.validate() {
                return fail(node, format!("of object {index}: {what}"));
            }
        }
        let mut placed = self.placed.iter().peekable();
        for (index, instance) in self.instances.iter().enumerate() {
            let Some(object) = self.objects.get(instance.object as usize) else {
                return fail(0, format!("instance {index} places no object"));
            };
            let own = placed.next_if(|placed| placed.instance() as usize == index);
            let Some(own) = own else {
                if object.is_empty() {
                    continue;
                }
                return fail(0, format!("instance {index} is placed nowhere"));
            };
            let is_own = own.object == instance.object
                && own.bounds() == world_bounds(&instance.transform, object)
                && own.instance_and_mask / FlatTriangle::INSTANCE_LIMIT as u32 == instance.mask & 0xff;
            if !is_own {
                return fail(0, format!("the place of instance {index} is another's"));
            }
        }
        if placed.next().is_some() {
            return fail(0, "what is placed is no instance".into());
        }
        self.validate_top()
    }

    fn validate_top(&self) -> Result<(), ValidationError> {
        let mut seen = vec![false; self.placed.len()];
        let mut pending = if self.top.is_empty() { Vec::new() } else { vec![(ROOT, self.top.bounds, 1)] };
        let mut count = 0;
        while let Some((word, bounds, level)) = pending.pop() {
            let fail = |what: &str| Err(ValidationError { node: count, what: what.into() });
            if level > MAX_LEVELS {
                return fail("it is deeper than a walk can go");
            }
            let node = self.node(word);
            for place in 0..WIDTH {
                let corner =
                    |row: usize| Vec3::from_array([0, 1, 2].map(|axis| node.bounds[row + axis][place]));
                let own = Aabb::new(corner(0), corner(3));
                let word = Word(node.children[place]);
                if word == ROOT {
                    if !own.is_empty() {
                        return fail("a place that holds nothing has a box");
                    }
                } else if !bounds.contains(&own) {
                    return fail("the box of a child leaves its own");
                } else if !word.is_leaf() {
                    pending.push((word, own, level + 1));
                } else if self.placed.get(Top::place(word)).map(Placed::bounds) != Some(own) {
                    return fail("a leaf's box is not that of its instance");
                } else if std::mem::replace(&mut seen[Top::place(word)], true) {
                    return fail("an instance stands in two leaves");
                }
            }
            count += 1;
        }
        match seen.iter().position(|seen| !seen) {
            Some(place) => Err(ValidationError { node: 0, what: format!("no leaf leads to place {place}") }),
            None => Ok(()),
        }
    }
}
