//! Instances from front to back, so that what is nearer hides what is drawn after it before that costs anything (Reichl et al.
//! 2010, section 4.2.2).
//!
//! Of two levels the top level is walked from the eye, of two children the nearer one first; else the instances are sorted by
//! how near their boxes are. It is a matter of speed alone.

use super::drawing::Drawing;
use glam::{DVec3, Vec3};
use ropewalk::{Aabb, Structure, TwoLevel};

impl Drawing<'_> {
    /// The parts, from front to back.
    pub(super) fn front_to_back(&self, eye: Vec3) -> Vec<u32> {
        let order = match self.structure {
            Structure::TwoLevel(scene) => walk(scene, eye),
            _ => Vec::new(),
        };
        // A part that the top level did not lead to would be lost.
        if order.len() == self.parts.len() { order } else { self.sorted(eye) }
    }

    fn sorted(&self, eye: Vec3) -> Vec<u32> {
        let mut order: Vec<(f64, u32)> =
            (0..).zip(&self.parts).map(|(index, part)| (distance(&part.world, eye), index)).collect();
        order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        order.into_iter().map(|(_, index)| index).collect()
    }
}

/// The places of a two-level structure in the order in which its top level is walked from the eye. An object that was opened
/// stands where its first part does.
fn walk(scene: &TwoLevel, eye: Vec3) -> Vec<u32> {
    let nodes = scene.top().nodes();
    let mut is_there = vec![false; scene.placed().len()];
    let mut order = Vec::with_capacity(is_there.len());
    let mut stack: Vec<u32> = if nodes.is_empty() { Vec::new() } else { vec![0] };
    while let Some(index) = stack.pop() {
        let Some(node) = nodes.get(index as usize) else { continue };
        if !node.is_leaf() {
            let [first, second] = [index + 1, node.link];
            let [a, b] = [first, second].map(|child| {
                nodes.get(child as usize).map_or(f64::INFINITY, |child| distance(&child.bounds(), eye))
            });
            stack.extend(if a <= b { [second, first] } else { [first, second] });
            continue;
        }
        let entries = scene.entries().iter().skip(node.link as usize).take(node.count as usize);
        for place in entries.map(|entry| entry.place) {
            if let Some(there) = is_there.get_mut(place as usize)
                && !std::mem::replace(there, true)
            {
                order.push(place);
            }
        }
    }
    order
}

/// The squared distance of a point from a box.
fn distance(bounds: &Aabb, eye: Vec3) -> f64 {
    let [min, max, eye] = [bounds.min, bounds.max, eye].map(Vec3::as_dvec3);
    (min - eye).max(eye - max).max(DVec3::ZERO).length_squared()
}

#[cfg(test)]
mod tests {
    use super::*;
    use ropewalk::two_level::TwoLevelOptions;
    use ropewalk::{BuildOptions, Mesh, Scene, Transform};

    /// Seen from in front of a row, both ways give the row, from whichever end.
    #[test]
    fn the_nearest_comes_first() {
        let mut scene = Scene::default();
        let object = scene.add_object(Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]));
        for step in [3.0, 0.0, 4.0, 1.0, 2.0] {
            scene.add_instance(object, Transform::from_translation(Vec3::Z * step * 5.0));
        }
        let flat = Structure::Bvh(scene.build(&BuildOptions::default()).unwrap());
        let levels = Structure::TwoLevel(scene.build_two_level(&TwoLevelOptions::default()).unwrap());
        for structure in [&flat, &levels] {
            let drawing = Drawing::new(structure).unwrap();
            assert_eq!(drawing.front_to_back(Vec3::Z * -9.0), [1, 3, 4, 0, 2], "{}", structure.kind());
            assert_eq!(drawing.front_to_back(Vec3::Z * 90.0), [2, 0, 4, 3, 1], "{}", structure.kind());
        }
    }
}
