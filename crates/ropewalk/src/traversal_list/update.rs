//! A scene that moved, without a new build: vertices, volumes and heads are made anew in their places, and the order of
//! the lists stays (Toczek 2010, section 5).
//!
//! Volumes are those of the first list, worked out once and written to where each list has the same node
//! ([`super::Layer`]). What is bounded is whole triangles, spatial splits or not. The more the scene moves the worse the
//! order fits: then build anew.
//!
//! **Cost.** Of boxes one step a node; of spheres, which reach to the triangles' boxes, one for each triangle below a node.

use super::{Bounds, Element, Grid, Identity, TraversalList};
use crate::clock::Clock;
use crate::parallel::map_chunks;
use crate::{Aabb, Scene, UpdateError};
use std::ops::Range;
use std::time::Duration;

/// What an update did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UpdateReport {
    /// Vertices that moved.
    pub moved: usize,
    /// Inner nodes, over all lists, that were written.
    pub nodes: usize,
    /// The time that it took; zero where there is no clock (wasm32).
    pub time: Duration,
}

/// Nodes that a thread takes at a time.
const CHUNK: usize = 1024;

impl TraversalList {
    /// Moves the vertices to where a scene has them: the one that the lists were built of, with other positions or
    /// transforms. Afterwards the lists answer as ones do that are built of that scene.
    ///
    /// ```
    /// use ropewalk::{ListOptions, Mesh, Ray, Scene, glam::Vec3};
    /// let mesh = Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]);
    /// let mut scene = Scene::from_mesh(mesh);
    /// let mut list = scene.build_list(&ListOptions::default())?;
    /// scene.objects[0].geometries[0].positions[0] = Vec3::NEG_Y;
    /// list.update(&scene)?;
    /// assert!(list.any(&Ray::new(Vec3::new(0.2, -0.3, 5.0), -Vec3::Z)));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// When the scene has other triangles, or what the lists leave out depends on where these are. Then nothing has changed.
    pub fn update(&mut self, scene: &Scene) -> Result<UpdateReport, UpdateError> {
        if self.is_one_sided() {
            return Err(UpdateError::Culled);
        }
        let clock = Clock::start();
        let flat = scene.flatten()?;
        let (was, is) = (self.identities.len(), flat.triangles.len());
        if was != is {
            return Err(UpdateError::OtherCount { was, is });
        }
        let mut vertices = self.vertices.clone();
        for (number, triangle) in flat.triangles.iter().enumerate() {
            if self.identities[number] != Identity::of(triangle) {
                return Err(UpdateError::OtherTriangle { number });
            }
            for (corner, position) in
                self.corners[number].into_iter().zip([triangle.v0, triangle.v1, triangle.v2])
            {
                vertices[corner as usize] = position;
            }
        }
        // A vertex that two triangles have at different places is no longer one.
        let is_at = |corner: u32, position| vertices[corner as usize] == position;
        for (number, triangle) in flat.triangles.iter().enumerate() {
            let [a, b, c] = self.corners[number];
            if !(is_at(a, triangle.v0) && is_at(b, triangle.v1) && is_at(c, triangle.v2)) {
                return Err(UpdateError::OtherTriangle { number });
            }
        }
        let moved = vertices.iter().zip(&self.vertices).filter(|(new, old)| new != old).count();
        self.vertices = vertices;
        let mut nodes = 0;
        for layer in 0..self.layers.len() {
            let own = self.layers[layer].triangles.clone();
            nodes += self.update_layer(layer, &flat.triangles[own.start as usize..own.end as usize]);
        }
        self.report.input = flat.report;
        self.measure(&flat.triangles);
        Ok(UpdateReport { moved, nodes, time: clock.elapsed() })
    }

    /// Writes the volumes of a layer with these triangles; how many.
    fn update_layer(&mut self, layer: usize, triangles: &[crate::FlatTriangle]) -> usize {
        let first = self.layers[layer].triangles.start;
        let triangle_boxes: Vec<Aabb> = triangles.iter().map(|it| it.triangle().bounds()).collect();
        let grid = Grid::over(&triangle_boxes.iter().copied().fold(Aabb::EMPTY, Aabb::union));
        let list = self.list_of_layer(layer, 0);
        let boxes = boxes(list, |element| triangle_boxes[(element.payload[3] - first) as usize]);
        let (of_bounds, reach) = (self.options.bounds, self.options.reach);
        let volume = |place: usize| match of_bounds {
            Bounds::Aabb => Element::of_box(grid.pack(&boxes[place])).payload,
            Bounds::Sphere => {
                let below = below(list, place).filter(|&place| list[place].is_triangle());
                let number = |place: usize| (list[place].payload[3] - first) as usize;
                let vertices = below.clone().flat_map(|place| triangles[number(place)].triangle().vertices);
                let below = below.map(|place| boxes[place]);
                Element::of_sphere(&reach.sphere(boxes[place].center(), below, vertices)).payload
            }
        };
        let places = self.layers[layer].places(0);
        let payloads = map_chunks(places, CHUNK, |_, places| {
            places.iter().map(|&place| volume(place as usize)).collect::<Vec<_>>()
        })
        .concat();
        let lists = self.options.directions.lists();
        for list in 0..lists {
            let start = self.starts[layer * lists + list];
            for (&place, payload) in self.layers[layer].places(list).iter().zip(&payloads) {
                self.elements[(start + place) as usize].payload = *payload;
            }
        }
        self.layers[layer].grid = grid;
        lists * payloads.len()
    }
}

/// The places below an inner node.
fn below(list: &[Element], place: usize) -> Range<usize> {
    place + 1..end(list, place)
}

/// Where what follows a subtree begins.
fn end(list: &[Element], place: usize) -> usize {
    match list[place].escape {
        0 | 1 => place + 1,
        Element::NOWHERE => list.len(),
        escape => place + escape as usize,
    }
}

/// The box of each element, given those of triangles: children come after their parents.
fn boxes(list: &[Element], of_triangle: impl Fn(&Element) -> Aabb) -> Vec<Aabb> {
    let mut boxes = vec![Aabb::EMPTY; list.len()];
    for place in (0..list.len()).rev() {
        boxes[place] = if list[place].is_triangle() {
            of_triangle(&list[place])
        } else {
            let (mut child, last) = (place + 1, end(list, place));
            let mut bounds = Aabb::EMPTY;
            while child < last {
                bounds = bounds.union(boxes[child]);
                child = end(list, child);
            }
            bounds
        };
    }
    boxes
}
