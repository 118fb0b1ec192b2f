//! Cutting a concave outline into triangles, ear by ear.
//!
//! An ear is a corner that turns left and whose triangle holds no other corner. Every simple outline has two, also with
//! corners on its straight edges, and cutting one off leaves a simple outline with a corner less. Only corners that do
//! not turn left can lie in an ear, so only these are looked at.
//!
//! The usual cost is that of 3n corners times those that do not turn left. Outlines that cross themselves stop as
//! soon as no ear is left; what takes very long is stopped by a budget of looks. (The crate earcut looks for a way on
//! in these cases that takes n³ steps: half a minute for 10,000 corners.)

use glam::DVec2;
use std::collections::VecDeque;

/// The outline that is left, as a ring of corners.
struct Ring<'a> {
    outline: &'a [DVec2],
    previous: Vec<u32>,
    next: Vec<u32>,
    /// The corners that do not turn left.
    blunt: Vec<u32>,
}

/// Puts n - 2 triangles into `triangles`, corners in ascending order. False where the outline crosses itself or the
/// budget is spent.
pub(super) fn cut(outline: &[DVec2], triangles: &mut Vec<[u32; 3]>, budget: &mut u64) -> bool {
    let count = outline.len() as u32;
    if count < 3 {
        return true;
    }
    let mut ring = Ring {
        outline,
        previous: (0..count).map(|corner| (corner + count - 1) % count).collect(),
        next: (0..count).map(|corner| (corner + 1) % count).collect(),
        blunt: Vec::new(),
    };
    ring.blunt = (0..count).filter(|&corner| ring.turn(corner) <= 0.0).collect();
    // First come, first served: going round leaves rounder triangles than nibbling at one place.
    let mut candidates: VecDeque<u32> = (0..count).collect();
    let mut is_candidate = vec![true; outline.len()];
    let mut is_left = vec![true; outline.len()];
    let mut left = count;
    let mut cut_since_all_were_looked_at = false;
    while left > 3 {
        let Some(at) = candidates.pop_front() else {
            // What was in the way of an ear may have been cut off since.
            if !std::mem::take(&mut cut_since_all_were_looked_at) {
                return false;
            }
            candidates.extend((0..count).filter(|&corner| is_left[corner as usize]));
            is_candidate.copy_from_slice(&is_left);
            continue;
        };
        is_candidate[at as usize] = false;
        if !is_left[at as usize] {
            continue;
        }
        let Some(is_ear) = ring.is_ear(at, budget) else { return false };
        if !is_ear {
            continue;
        }
        let [before, _, after] = ring.corners(at);
        triangles.push(ascending([before, at, after]));
        ring.cut_off(at);
        is_left[at as usize] = false;
        left -= 1;
        cut_since_all_were_looked_at = true;
        for neighbour in [before, after] {
            if !std::mem::replace(&mut is_candidate[neighbour as usize], true) {
                candidates.push_back(neighbour);
            }
        }
    }
    let last = (0..count).find(|&corner| is_left[corner as usize]).unwrap_or(0);
    triangles.push(ascending(ring.corners(last)));
    true
}

/// A triangle of a polygon winds like the polygon when its corners come in the polygon's order.
fn ascending(mut corners: [u32; 3]) -> [u32; 3] {
    corners.sort_unstable();
    corners
}

impl Ring<'_> {
    /// A corner between its neighbours.
    fn corners(&self, at: u32) -> [u32; 3] {
        [self.previous[at as usize], at, self.next[at as usize]]
    }

    fn points(&self, at: u32) -> [DVec2; 3] {
        self.corners(at).map(|corner| self.outline[corner as usize])
    }

    /// Above zero where the outline turns left.
    fn turn(&self, at: u32) -> f64 {
        let [a, b, c] = self.points(at);
        (b - a).perp_dot(c - b)
    }

    /// None when the budget is spent.
    fn is_ear(&self, at: u32, budget: &mut u64) -> Option<bool> {
        if self.turn(at) <= 0.0 {
            *budget = budget.checked_sub(1)?;
            return Some(false);
        }
        let [a, b, c] = self.points(at);
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let is_in_the_way = |&corner: &u32| {
            let point = self.outline[corner as usize];
            let is_near = point.cmpge(low).all() && point.cmple(high).all();
            // Where an outline touches itself, as around a hole that a slit leads to, corners share a place.
            is_near && point != a && point != b && point != c && is_inside(point, [a, b, c])
        };
        let found = self.blunt.iter().position(is_in_the_way);
        *budget = budget.checked_sub(found.unwrap_or(self.blunt.len()) as u64 + 1)?;
        Some(found.is_none())
    }

    fn cut_off(&mut self, at: u32) {
        let [before, _, after] = self.corners(at);
        self.next[before as usize] = after;
        self.previous[after as usize] = before;
        // The neighbours turn further left now.
        for corner in [before, after] {
            if self.turn(corner) > 0.0
                && let Some(index) = self.blunt.iter().position(|&blunt| blunt == corner)
            {
                self.blunt.swap_remove(index);
            }
        }
    }
}

/// Whether a point is in a counter-clockwise triangle or on its edge.
fn is_inside(point: DVec2, [a, b, c]: [DVec2; 3]) -> bool {
    [(a, b), (b, c), (c, a)].iter().all(|&(from, to)| (to - from).perp_dot(point - from) >= 0.0)
}
