//! The shafts: stepped and chamfered, turned from one piece, with a thread or splines at the driven end.

use super::super::shape::Solid;
use super::super::shape::lathe::turned;
use super::super::shape::outline::{arc, chamfered};
use super::super::shape::sweep::extrude;
use super::fasteners::thread;
use super::palette::{BRIGHT, DARK};
use glam::DVec2;
use std::f64::consts::TAU;

/// The radius of the input shaft where the crank sits.
pub(crate) const CRANK_SEAT: f64 = 0.19;
/// The radius of the thread before it.
pub(crate) const CRANK_THREAD: f64 = 0.13;

/// A turned body from steps (radius, end), each with its edges chamfered; the first one begins at `start`.
fn stepped(start: f64, steps: &[(f64, f64)], material: u32) -> Solid {
    let mut corners = vec![(0.0, start, 0.0)];
    let mut z = start;
    for (i, &(radius, end)) in steps.iter().enumerate() {
        let before = i.checked_sub(1).map_or(0.0, |i| steps[i].0);
        let after = steps.get(i + 1).map_or(0.0, |step| step.0);
        // Outer edges are chamfered, inner corners get a small fillet of one facet.
        let edge = |other: f64| if other < radius { 0.022 } else { 0.008 };
        corners.push((radius, z, edge(before)));
        corners.push((radius, end, edge(after)));
        z = end;
    }
    corners.push((0.0, z, 0.0));
    turned(&chamfered(&corners), 96, material)
}

pub(crate) fn input() -> Solid {
    let steps = [
        (0.25, -0.93),
        (0.29, -0.17),
        (0.36, -0.04),
        (0.29, 0.93),
        (0.25, 1.46),
        (CRANK_SEAT, 1.84),
        (CRANK_THREAD - 0.03, 1.9),
    ];
    Solid::of([stepped(-1.36, &steps, DARK), thread(CRANK_THREAD, 1.86, 2.14, BRIGHT)])
}

pub(crate) fn middle() -> Solid {
    stepped(-1.3, &[(0.25, -0.93), (0.31, -0.14), (0.42, -0.01), (0.29, 0.93), (0.25, 1.3)], DARK)
}

pub(crate) fn output() -> Solid {
    let steps = [
        (0.325, -0.93),
        (0.39, -0.2),
        (0.5, -0.035),
        (0.39, 0.84),
        (0.365, 0.93),
        (0.325, 1.42),
        (0.30, 1.62),
        (0.235, 1.7),
    ];
    Solid::of([stepped(-1.34, &steps, DARK), splines(0.24, 0.285, 10, 1.66, 2.28)])
}

/// A splined end with straight teeth.
fn splines(root: f64, tip: f64, count: u32, bottom: f64, top: f64) -> Solid {
    let pitch = TAU / f64::from(count);
    let outline: Vec<DVec2> = (0..count)
        .flat_map(|i| {
            let middle = pitch * f64::from(i);
            let mut tooth = arc(DVec2::ZERO, tip, middle - 0.24 * pitch, middle + 0.24 * pitch, 4);
            tooth.extend(arc(DVec2::ZERO, root, middle + 0.29 * pitch, middle + 0.71 * pitch, 4));
            tooth
        })
        .collect();
    extrude(&outline.into(), bottom, top, 0.02, BRIGHT)
}

#[cfg(test)]
mod tests {
    use super::super::super::shape::check::volume;
    use super::*;

    #[test]
    fn shafts_are_closed() {
        for shaft in [input(), middle(), output()] {
            assert!(volume(&shaft).unwrap() > 0.0);
        }
    }
}
