//! Closed solids, built ring by ring.
//!
//! A [`Solid`] is a mesh in the making: vertices in f64, triangles, a material a triangle. Shapes are made of
//! *rings* (loops of vertices, counter-clockwise seen from the tip of the axis): [`Solid::bridge`] spans the
//! wall between two of them and [`Solid::fill`] the plane region inside one. Neighbouring faces share their
//! rings, so a solid is closed by construction: every edge is used twice, once in each direction. A solid may consist
//! of several closed bodies that run into each other.
//!
//! Built from it: [`sweep`] (extrusion with chamfers and twist), [`lathe`] (surface of revolution),
//! [`primitives`], [`cut`] (a half space taken away, with caps), [`normals`] (shading normals).

pub(crate) mod cut;
mod fill;
pub(crate) mod lathe;
pub(crate) mod normals;
pub(crate) mod outline;
pub(crate) mod primitives;
pub(crate) mod sweep;

use glam::{DAffine3, DVec2, DVec3};

/// A loop of vertices.
pub(crate) type Ring = Vec<u32>;

/// A mesh in the making.
#[derive(Clone, Debug, Default)]
pub(crate) struct Solid {
    pub(crate) positions: Vec<DVec3>,
    pub(crate) triangles: Vec<[u32; 3]>,
    /// The material of each triangle.
    pub(crate) materials: Vec<u32>,
}

/// Which way a filled region looks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Facing {
    Up,
    Down,
}

impl Solid {
    /// Adds a vertex.
    pub(crate) fn vertex(&mut self, position: DVec3) -> u32 {
        self.positions.push(position);
        (self.positions.len() - 1) as u32
    }

    /// Adds a vertex for each point.
    pub(crate) fn ring(&mut self, points: impl IntoIterator<Item = DVec3>) -> Ring {
        points.into_iter().map(|point| self.vertex(point)).collect()
    }

    /// Adds a ring of points at one height.
    pub(crate) fn flat_ring(&mut self, points: &[DVec2], z: f64) -> Ring {
        self.ring(points.iter().map(|point| point.extend(z)))
    }

    pub(crate) fn triangle(&mut self, corners: [u32; 3], material: u32) {
        self.triangles.push(corners);
        self.materials.push(material);
    }

    /// Adds two triangles, split along the shorter diagonal.
    pub(crate) fn quad(&mut self, [a, b, c, d]: [u32; 4], material: u32) {
        let length = |i: u32, j: u32| self.positions[i as usize].distance_squared(self.positions[j as usize]);
        let halves =
            if length(a, c) <= length(b, d) { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] };
        for half in halves {
            self.triangle(half, material);
        }
    }

    /// Spans the wall between two rings of the same length. It looks to the right of somebody who walks along
    /// `lower` with `upper` overhead: outwards for a counter-clockwise ring below another one.
    pub(crate) fn bridge(&mut self, lower: &[u32], upper: &[u32], material: u32) {
        debug_assert_eq!(lower.len(), upper.len());
        for (i, j) in successors(lower.len()) {
            self.quad([lower[i], lower[j], upper[j], upper[i]], material);
        }
    }

    /// Spans a cone from a ring to a tip, looking like [`Solid::bridge`] with the tip above.
    pub(crate) fn cone(&mut self, ring: &[u32], tip: u32, material: u32) {
        for (i, j) in successors(ring.len()) {
            self.triangle([ring[i], ring[j], tip], material);
        }
    }

    /// As [`Solid::cone`], looking the other way.
    pub(crate) fn cone_below(&mut self, ring: &[u32], tip: u32, material: u32) {
        for (i, j) in successors(ring.len()) {
            self.triangle([ring[j], ring[i], tip], material);
        }
    }

    /// Fills the region between a ring and holes in it, all at one height.
    pub(crate) fn fill(&mut self, outer: &[u32], holes: &[&[u32]], facing: Facing, material: u32) {
        let (u, v) = match facing {
            Facing::Up => (DVec3::X, DVec3::Y),
            Facing::Down => (DVec3::Y, DVec3::X),
        };
        let mut rings = vec![outer];
        rings.extend_from_slice(holes);
        self.fill_plane(&rings, u, v, material);
    }

    /// Fills a plane region that looks along `u x v`; the first ring is the outer one. Rings may run either way.
    pub(crate) fn fill_plane(&mut self, rings: &[&[u32]], u: DVec3, v: DVec3, material: u32) {
        let project = |&vertex: &u32| {
            let position = self.positions[vertex as usize];
            DVec2::new(position.dot(u), position.dot(v))
        };
        let loops: Vec<Vec<DVec2>> = rings.iter().map(|ring| ring.iter().map(project).collect()).collect();
        let vertices = rings.concat();
        for corners in fill::triangulate(&loops) {
            self.triangle(corners.map(|corner| vertices[corner]), material);
        }
    }

    /// Adds another body.
    pub(crate) fn append(&mut self, other: &Self) {
        let offset = self.positions.len() as u32;
        self.positions.extend_from_slice(&other.positions);
        self.triangles.extend(other.triangles.iter().map(|triangle| triangle.map(|vertex| vertex + offset)));
        self.materials.extend_from_slice(&other.materials);
    }

    /// The solid moved; the map must not mirror.
    #[must_use]
    pub(crate) fn moved(mut self, placement: &DAffine3) -> Self {
        for position in &mut self.positions {
            *position = placement.transform_point3(*position);
        }
        self
    }

    /// The solid shifted.
    #[must_use]
    pub(crate) fn shifted(self, offset: DVec3) -> Self {
        self.moved(&DAffine3::from_translation(offset))
    }

    /// Several bodies as one solid.
    pub(crate) fn of(bodies: impl IntoIterator<Item = Self>) -> Self {
        let mut all = Self::default();
        for body in bodies {
            all.append(&body);
        }
        all
    }

    /// Drops the vertices that no triangle uses.
    pub(crate) fn compact(&mut self) {
        let mut place = vec![u32::MAX; self.positions.len()];
        let mut kept = Vec::new();
        for vertex in self.triangles.iter_mut().flatten() {
            let old = *vertex as usize;
            if place[old] == u32::MAX {
                place[old] = kept.len() as u32;
                kept.push(self.positions[old]);
            }
            *vertex = place[old];
        }
        self.positions = kept;
    }
}

/// Each index of a loop with the next one.
pub(crate) fn successors(length: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..length).map(move |i| (i, (i + 1) % length))
}

#[cfg(test)]
pub(crate) mod check {
    //! Whether a solid is one.

    use super::Solid;
    use std::collections::HashMap;

    /// The volume, or what is wrong.
    pub(crate) fn volume(solid: &Solid) -> Result<f64, String> {
        let mut edges: HashMap<(u32, u32), i32> = HashMap::new();
        let mut volume = 0.0;
        for &[a, b, c] in &solid.triangles {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                *edges.entry((from, to)).or_default() += 1;
            }
            let [a, b, c] = [a, b, c].map(|vertex| solid.positions[vertex as usize]);
            if (b - a).cross(c - a).length() < 1e-12 {
                return Err(format!("a triangle without area at {a}"));
            }
            volume += a.dot(b.cross(c)) / 6.0;
        }
        for (&(from, to), &count) in &edges {
            if count != 1 || edges.get(&(to, from)) != Some(&1) {
                let at = solid.positions[from as usize];
                return Err(format!("edge {from}-{to} at {at} is not shared by two faces"));
            }
        }
        if solid.materials.len() != solid.triangles.len() {
            return Err("not one material a triangle".into());
        }
        Ok(volume)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_check_objects_to_a_hole_and_to_a_turned_face() {
        let cube = primitives::bevelled_cube(1.0, 0.1, 0);
        assert!(check::volume(&cube).is_ok());
        let mut open = cube.clone();
        open.triangles.pop();
        open.materials.pop();
        assert!(check::volume(&open).is_err());
        let mut turned = cube.clone();
        turned.triangles[3].swap(0, 1);
        assert!(check::volume(&turned).is_err());
        let mut doubled = cube;
        doubled.triangles.push(doubled.triangles[0]);
        doubled.materials.push(0);
        assert!(check::volume(&doubled).is_err());
    }
}
