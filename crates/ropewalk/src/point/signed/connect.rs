//! Which triangles of a surface meet at which edges, and what keeps it from being closed.

use crate::FlatTriangle;
use glam::{DVec3, Vec3};
use std::collections::HashMap;
use thiserror::Error;

/// A surface that is not closed, or not oriented, so that nothing is inside of it.
#[derive(Clone, Debug, Error, PartialEq)]
#[error(
    "the surface has no inside: of its {edges} edges {open} have a triangle on one side only, {flipped} lie between \
     two triangles that face opposite ways, and {crowded} have more than two triangles; one of them runs from {from} \
     to {to}, and {left_out} damaged triangles were left out: close the holes, turn triangles so that all face \
     outwards, remove what is there twice, or ask Bvh::closest_point for the distance without a sign"
)]
#[non_exhaustive]
pub struct SurfaceError {
    /// The edges of the surface, each counted once.
    pub edges: usize,
    /// Edges with a triangle on one side only: the rims of holes.
    pub open: usize,
    /// Edges along which two triangles run in the same direction.
    pub flipped: usize,
    /// Edges of more than two triangles.
    pub crowded: usize,
    /// Where one of these edges begins ...
    pub from: Vec3,
    /// ... and where it ends.
    pub to: Vec3,
    /// Triangles that the tree does not hold: see [`InputReport::skipped`](crate::InputReport::skipped).
    pub left_out: usize,
}

/// Beyond an edge of a triangle that is left out.
const NOTHING: u32 = u32::MAX;

/// Numbers triangles by their ids: the number at each place of the leaves, and a place of each number.
pub(super) fn number(references: &[FlatTriangle]) -> (Vec<u32>, Vec<usize>) {
    let id = |place: usize| {
        let triangle = &references[place];
        (triangle.instance(), triangle.geometry(), triangle.primitive)
    };
    let mut places: Vec<usize> = (0..references.len()).collect();
    places.sort_unstable_by_key(|&place| (id(place), place));
    let (mut numbers, mut firsts) = (vec![0; references.len()], Vec::<usize>::new());
    for place in places {
        if firsts.last().is_none_or(|&last| id(last) != id(place)) {
            firsts.push(place);
        }
        numbers[place] = (firsts.len() - 1) as u32;
    }
    (numbers, firsts)
}

/// Makes one vertex of all corners at one position.
pub(super) fn weld(triangles: &[[DVec3; 3]]) -> (Vec<[u32; 3]>, Vec<DVec3>) {
    let (mut known, mut positions) = (HashMap::<[u64; 3], u32>::new(), Vec::new());
    let mut vertex = |position: DVec3| {
        // Plus zero: -0 is where 0 is.
        let place = (position + DVec3::ZERO).to_array().map(f64::to_bits);
        *known.entry(place).or_insert_with(|| {
            positions.push(position);
            (positions.len() - 1) as u32
        })
    };
    let corners = triangles.iter().map(|triangle| triangle.map(&mut vertex)).collect();
    (corners, positions)
}

/// A triangle's side: its two vertices, the smaller one first, and whose it is.
#[derive(Clone, Copy)]
struct Side {
    ends: [u32; 2],
    triangle: u32,
    edge: u8,
    runs_up: bool,
}

/// Finds the neighbour at every edge, or what keeps the surface from being closed.
pub(super) fn connect(corners: &[[u32; 3]], positions: &[DVec3]) -> Result<Vec<[u32; 3]>, SurfaceError> {
    let mut sides = Vec::with_capacity(3 * corners.len());
    for (triangle, corners) in corners.iter().enumerate() {
        let [a, b, c] = *corners;
        // Two corners at one place: the neighbours at the two other edges meet without this triangle.
        if a == b || b == c || c == a {
            continue;
        }
        for (edge, [from, to]) in [[a, b], [b, c], [c, a]].into_iter().enumerate() {
            let (ends, runs_up) = ([from.min(to), from.max(to)], from < to);
            sides.push(Side { ends, triangle: triangle as u32, edge: edge as u8, runs_up });
        }
    }
    sides.sort_unstable_by_key(|side| (side.ends, side.triangle, side.edge));
    let mut neighbours = vec![[NOTHING; 3]; corners.len()];
    let (mut edges, mut open, mut flipped, mut crowded, mut first_bad) = (0, 0, 0, 0, None);
    for edge in sides.chunk_by(|one, other| one.ends == other.ends) {
        edges += 1;
        match edge {
            [one, other] if one.runs_up != other.runs_up => {
                neighbours[one.triangle as usize][usize::from(one.edge)] = other.triangle;
                neighbours[other.triangle as usize][usize::from(other.edge)] = one.triangle;
                continue;
            }
            [_] => open += 1,
            [_, _] => flipped += 1,
            _ => crowded += 1,
        }
        first_bad = first_bad.or_else(|| edge.first().map(|side| side.ends));
    }
    match first_bad {
        None => Ok(neighbours),
        Some(ends) => {
            let [from, to] = ends.map(|vertex| positions[vertex as usize].as_vec3());
            Err(SurfaceError { edges, open, flipped, crowded, from, to, left_out: 0 })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::SignedDistance;
    use super::*;
    use crate::{BuildOptions, Mesh, Scene};

    fn corners() -> Vec<Vec3> {
        vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z]
    }

    const TETRAHEDRON: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];

    fn error(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> SurfaceError {
        let bvh = Scene::from_mesh(Mesh::new(positions, triangles)).build(&BuildOptions::default()).unwrap();
        SignedDistance::new(&bvh).unwrap_err()
    }

    #[test]
    fn what_has_no_inside_is_told() {
        let counts = |error: &SurfaceError| (error.edges, error.open, error.flipped, error.crowded);
        let hole = error(corners(), TETRAHEDRON[..3].to_vec());
        assert_eq!(counts(&hole), (6, 3, 0, 0));
        assert!(hole.to_string().contains("6 edges 3 have a triangle on one side only"), "{hole}");
        let mut turned = TETRAHEDRON.to_vec();
        turned[3].swap(0, 1);
        assert_eq!(counts(&error(corners(), turned)), (6, 0, 3, 0));
        let twice = [TETRAHEDRON, TETRAHEDRON].concat();
        assert_eq!(counts(&error(corners(), twice)), (6, 0, 0, 6));
        let mut damaged = corners();
        damaged.push(Vec3::splat(f32::NAN));
        let mut triangles = TETRAHEDRON.to_vec();
        triangles[3][1] = 4;
        let error = error(damaged, triangles);
        assert_eq!((counts(&error), error.left_out), ((6, 3, 0, 0), 1));
    }
}
