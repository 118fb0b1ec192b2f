//! The rules of traversal lists: see [`super`].

use super::cull::Hidden;
use super::{Bounds, Element, Layer, TraversalList};
use crate::{Aabb, ValidationError};
use glam::Vec3;

/// Checks every list by itself, and that those of a layer hold its triangles.
pub(super) fn validate(lists: &TraversalList) -> Result<(), ValidationError> {
    let (count, options) = (lists.options().directions.lists(), lists.options());
    for (place, &start) in lists.starts.iter().enumerate().take(count * lists.layers.len()) {
        let (layer, list) = (place / count, place % count);
        let elements = lists.list_of_layer(layer, list);
        let wrong = |(node, what): (usize, String)| ValidationError { node: start as usize + node, what };
        Checker { lists, layer: &lists.layers[layer], elements }.check().map_err(wrong)?;
        let mut held: Vec<u32> =
            elements.iter().filter(|it| it.is_triangle()).map(|it| it.payload[3]).collect();
        held.sort_unstable();
        let places = held.len();
        held.dedup();
        if !lists.has_repeats() && held.len() != places {
            return Err(wrong((0, "the list holds a triangle twice".into())));
        }
        let hidden = Hidden::new(options.cull, options.directions, list);
        let own = lists.layers[layer].triangles.clone();
        let expected = own.filter(|&number| !hidden.hides(&lists.triangle_at(number)));
        if !held.into_iter().eq(expected) {
            return Err(wrong((0, "the list does not hold the triangles that it should".into())));
        }
    }
    Ok(())
}

struct Checker<'a> {
    lists: &'a TraversalList,
    layer: &'a Layer,
    elements: &'a [Element],
}

impl Checker<'_> {
    fn check(&self) -> Result<(), (usize, String)> {
        let len = self.elements.len();
        // The ends of the subtrees in which the element lies, with their volumes, the innermost last.
        let mut open: Vec<(usize, Volume)> = Vec::new();
        for (index, element) in self.elements.iter().enumerate() {
            let fail = |what: &str| Err((index, what.to_owned()));
            while open.last().is_some_and(|&(end, _)| end <= index) {
                open.pop();
            }
            let end = match element.escape {
                0 | 1 => index + 1,
                Element::NOWHERE => len,
                escape if escape > 0 => index + escape as usize,
                _ => return fail("its escape index is no such index"),
            };
            if end > open.last().map_or(len, |&(end, _)| end) {
                return fail("it escapes beyond its parent's subtree");
            }
            let is_last = index + 1 == len;
            if element.is_triangle() {
                if (element.escape == 0) != is_last {
                    return fail("the end of the list is where the index 0 is, and nowhere else");
                }
                let [a, b, c, identity] = element.payload.map(|word| word as usize);
                let (vertices, identities) = (self.lists.vertices.len(), self.lists.identities.len());
                if [a, b, c].iter().any(|&vertex| vertex >= vertices) || identity >= identities {
                    return fail("it has a vertex or a name that is not there");
                }
                let triangle = self.lists.triangle(element).triangle();
                let options = self.lists.options();
                // What each node above must hold: the box, or each vertex, a box of no size.
                let vertices = triangle.vertices.map(|vertex| Aabb::new(vertex, vertex));
                let held = match options.reach.is_of_vertices(options.bounds) {
                    true => vertices.as_slice(),
                    false => &[triangle.bounds()],
                };
                let holds = |(_, volume): &(usize, Volume)| held.iter().all(|part| volume.holds_box(part));
                if !self.lists.has_repeats() && !open.iter().all(holds) {
                    return fail("its box leaves the volume of a node above it");
                }
                continue;
            }
            if is_last || end < index + 2 {
                return fail("an inner node without a child");
            }
            if (element.escape == Element::NOWHERE) != (end == len) {
                return fail("the index -1 is for nodes with which the list ends");
            }
            let volume = self.volume(element);
            if !volume.is_whole() {
                return fail("its volume is no volume");
            }
            open.push((end, volume));
        }
        Ok(())
    }

    fn volume(&self, element: &Element) -> Volume {
        match self.lists.options.bounds {
            Bounds::Sphere => Volume::Sphere(element.sphere()),
            Bounds::Aabb => {
                let [min, max] = element.packed_box().corners(&self.layer.grid);
                Volume::Box(Aabb::new(min.truncate(), max.truncate()))
            }
        }
    }
}

#[derive(Clone, Copy)]
enum Volume {
    Sphere(crate::Sphere),
    Box(Aabb),
}

impl Volume {
    fn is_whole(&self) -> bool {
        match self {
            Self::Sphere(sphere) => {
                sphere.center.is_finite() && sphere.radius >= 0.0 && sphere.radius.is_finite()
            }
            Self::Box(bounds) => bounds.min.cmple(bounds.max).all(),
        }
    }

    fn holds_box(&self, bounds: &Aabb) -> bool {
        match self {
            Self::Sphere(sphere) => {
                let center = sphere.center.as_dvec3();
                let reach = |corner: Vec3| (corner.as_dvec3() - center).abs();
                reach(bounds.min).max(reach(bounds.max)).length() <= f64::from(sphere.radius)
            }
            Self::Box(around) => around.min.cmple(bounds.min).all() && around.max.cmpge(bounds.max).all(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ListOptions, Mesh, Scene};

    fn lists(bounds: Bounds) -> TraversalList {
        let mut mesh = Mesh::default();
        for index in 0..40 {
            let place = Vec3::new((index % 5) as f32, (index / 5) as f32, (index % 3) as f32);
            let first = mesh.positions.len() as u32;
            mesh.positions.extend([place, place + Vec3::X * 0.3, place + Vec3::Y * 0.4]);
            mesh.triangles.push([first, first + 1, first + 2]);
        }
        Scene::from_mesh(mesh).build_list(&ListOptions { bounds, ..ListOptions::default() }).unwrap()
    }

    /// Where it breaks, how, and what of.
    type Damage<'a> = (usize, &'a dyn Fn(&mut TraversalList), &'a str);

    /// One change at a time, each answered with the rule that it breaks.
    #[test]
    fn what_is_broken_is_named() {
        for bounds in [Bounds::Sphere, Bounds::Aabb] {
            let good = lists(bounds);
            assert_eq!(good.validate(), Ok(()));
            let triangle = good.elements.iter().position(Element::is_triangle).unwrap();
            let broken = |change: &dyn Fn(&mut TraversalList)| {
                let mut lists = good.clone();
                change(&mut lists);
                lists.validate().unwrap_err()
            };
            let len = good.list(0).len();
            let cases: [Damage<'_>; 7] = [
                (0, &|it| it.elements[0].escape = len as i32 + 1, "beyond"),
                (0, &|it| it.elements[0].escape = len as i32, "index -1"),
                (0, &|it| it.elements[0].escape = -5, "no such index"),
                (triangle, &|it| it.elements[triangle].escape = 0, "index 0"),
                (triangle, &|it| it.elements[triangle].payload[1] = 9999, "not there"),
                (triangle, &|it| it.vertices[it.elements[triangle].payload[0] as usize][0] = 99.0, "leaves"),
                (0, &|it| it.elements[triangle].payload[3] = it.elements[len - 1].payload[3], "twice"),
            ];
            for (node, change, what) in cases {
                let error = broken(change);
                assert!(error.what.contains(what), "{error}, not {what}");
                assert_eq!(error.node, node, "{error}");
            }
        }
    }
}
