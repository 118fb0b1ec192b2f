//! What the refits of all trees share: the triangles of a scene that moved, in the order of a structure's leaves.

use crate::{FlatTriangle, Scene, UpdateError};
use std::time::Duration;

/// What became of a tree whose boxes were moved.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RefitReport {
    /// The expected cost of a random ray before, by the surface area heuristic.
    pub cost_before: f64,
    /// The same after. The more of it the boxes have come to overlap: where it has grown by half or so, build anew.
    pub cost: f64,
    /// The time that it took; zero where there is no clock (wasm32).
    pub time: Duration,
}

impl RefitReport {
    /// How many times the cost before the cost after is; 1 for an empty tree.
    #[must_use]
    pub fn drift(&self) -> f64 {
        if self.cost_before > 0.0 { self.cost / self.cost_before } else { 1.0 }
    }
}

type Id = (u32, u32, u32);

fn id(triangle: &FlatTriangle) -> Id {
    (triangle.instance(), triangle.geometry(), triangle.primitive)
}

/// The triangles of a scene in the places of these, of which `distinct` are different ones, and what was wrong with others.
///
/// # Errors
/// When the scene has other triangles.
pub(crate) fn moved(
    triangles: &[FlatTriangle],
    distinct: usize,
    scene: &Scene,
) -> Result<(Vec<FlatTriangle>, crate::InputReport), UpdateError> {
    let flat = scene.flatten()?;
    let (was, is) = (distinct, flat.triangles.len());
    if was != is {
        return Err(UpdateError::OtherCount { was, is });
    }
    let place = |(number, old): (usize, &FlatTriangle)| {
        // Flat triangles are ordered by their ids.
        let found = flat.triangles.binary_search_by_key(&id(old), id);
        found.map(|place| flat.triangles[place]).map_err(|_| UpdateError::OtherTriangle { number })
    };
    let moved = triangles.iter().enumerate().map(place).collect::<Result<_, _>>()?;
    Ok((moved, flat.report))
}
