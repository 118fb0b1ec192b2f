//! Checks the rules of both levels.

use super::{Bottom, Entry, TwoLevel};
use crate::ValidationError;

impl TwoLevel {
    /// Checks every rule of the structure, and those of the objects' structures.
    ///
    /// # Errors
    /// Names the first node, instance or object that breaks one.
    pub fn validate(&self) -> Result<(), ValidationError> {
        self.top.validate()?;
        let fail = |node: usize, what: String| Err(ValidationError { node, what });
        for (index, object) in self.objects.iter().enumerate() {
            let Some(object) = object else { continue };
            let checked = match object.bottom() {
                Bottom::KdTree(tree) => tree.validate(),
                Bottom::Bvh(bvh) => bvh.validate(),
                Bottom::WideBvh(bvh) => bvh.validate(),
                Bottom::List(list) => list.validate(),
            };
            if let Err(ValidationError { node, what }) = checked {
                return fail(node, format!("of object {index}: {what}"));
            }
        }
        let mut seen = vec![false; self.entries.len()];
        let mut has_leaf = vec![false; self.placed.len()];
        for (index, node) in self.top.nodes().iter().enumerate().filter(|(_, node)| node.is_leaf()) {
            let Some(&Entry { place, node: part }) = self.entries.get(node.link as usize) else {
                return fail(index, format!("it leads to entry {}, and there are fewer", node.link));
            };
            let Some(placed) = self.placed.get(place as usize) else {
                return fail(index, format!("it leads to place {place}, and there are fewer"));
            };
            if node.count != 1 || std::mem::replace(&mut seen[node.link as usize], true) {
                return fail(
                    index,
                    format!("entry {} has more than one leaf, or the leaf another", node.link),
                );
            }
            if std::mem::replace(&mut has_leaf[place as usize], true) && part == 0 {
                return fail(index, format!("place {place} has a leaf for the whole and another one"));
            }
            if part == 0 && !node.bounds().contains(&placed.bounds()) {
                return fail(index, format!("its box does not hold that of place {place}"));
            }
        }
        if let Some(place) = has_leaf.iter().position(|seen| !seen) {
            return fail(0, format!("no leaf leads to place {place}"));
        }
        for (index, instance) in self.instances.iter().enumerate() {
            let Some(instance) = instance else { continue };
            let Some(Some(object)) = self.objects.get(instance.object as usize) else {
                return fail(0, format!("instance {index} places no object"));
            };
            let placed = self.places.get(index).and_then(|&place| self.placed.get(place as usize));
            match placed {
                None if object.is_empty() => {}
                None => return fail(0, format!("instance {index} is placed nowhere")),
                Some(placed) if placed.instance() as usize == index && placed.object == instance.object => {
                    if placed.bounds() != object.world_bounds(&instance.transform) {
                        return fail(0, format!("the box of instance {index} is another"));
                    }
                }
                Some(_) => return fail(0, format!("the place of instance {index} is another's")),
            }
        }
        Ok(())
    }
}
