//! The ground of the forest: gentle hills around a clearing, with a path through it.

use super::super::shape::Solid;
use glam::DVec3;

/// Half the width of the ground, in metres.
pub(crate) const HALF: f64 = 42.0;
/// Squares along a side.
const SQUARES: u32 = 120;

/// The height of the ground.
pub(crate) fn height(x: f64, z: f64) -> f64 {
    let hills = 0.9 * (0.16 * x + 0.6).sin() * (0.13 * z - 0.4).cos()
        + 0.45 * (0.31 * x - 0.27 * z + 1.1).sin()
        + 0.12 * (0.9 * x + 0.5 * z).sin()
        + 0.06 * (1.9 * z - 1.3 * x).sin();
    // The clearing is flat, and the forest rises around it.
    let distance = x.hypot(z);
    let away = ((distance - 4.0) / 10.0).clamp(0.0, 1.0);
    let rise = (distance - 15.0).max(0.0);
    hills * (0.15 + 0.85 * away * away) + 0.004 * rise * rise
}

/// The middle of the path at some z.
fn path(z: f64) -> f64 {
    2.2 * (0.21 * z + 0.5).sin() + 0.5 * (0.6 * z).sin() - 0.6
}

/// How far from the middle of the path a place lies.
pub(crate) fn from_path(x: f64, z: f64) -> f64 {
    (x - path(z)).abs()
}

/// The surface of the ground.
pub(crate) fn surface(material: u32) -> Solid {
    let mut solid = Solid::default();
    let at = |i: u32| (2.0 * f64::from(i) / f64::from(SQUARES) - 1.0) * HALF;
    for row in 0..=SQUARES {
        for column in 0..=SQUARES {
            let (x, z) = (at(column), at(row));
            solid.vertex(DVec3::new(x, height(x, z), z));
        }
    }
    for row in 0..SQUARES {
        for column in 0..SQUARES {
            let first = row * (SQUARES + 1) + column;
            let far = first + SQUARES + 1;
            solid.quad([first, far, far + 1, first + 1], material);
        }
    }
    solid
}

/// The trodden path: a ribbon on the ground.
pub(crate) fn trail(material: u32) -> Solid {
    const STEPS: u32 = 200;
    const ACROSS: u32 = 4;
    let mut solid = Solid::default();
    for step in 0..=STEPS {
        let z = (2.0 * f64::from(step) / f64::from(STEPS) - 1.0) * 0.95 * HALF;
        let breadth = 0.62 + 0.10 * (1.3 * z).sin() + 0.05 * (3.1 * z).cos();
        for place in 0..=ACROSS {
            let share = 2.0 * f64::from(place) / f64::from(ACROSS) - 1.0;
            let x = path(z) + share * breadth;
            // Above the chords of the surface, and into the ground at both edges.
            let lift = 0.05 - 0.06 * share.powi(4);
            solid.vertex(DVec3::new(x, height(x, z) + lift, z));
        }
    }
    for step in 0..STEPS {
        for place in 0..ACROSS {
            let first = step * (ACROSS + 1) + place;
            let far = first + ACROSS + 1;
            solid.quad([first, far, far + 1, first + 1], material);
        }
    }
    solid
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_surface_looks_up_and_follows_the_height() {
        assert_eq!(surface(0).triangles.len() as u32, 2 * SQUARES * SQUARES);
        for solid in [surface(0), trail(1)] {
            for triangle in &solid.triangles {
                let [a, b, c] = triangle.map(|vertex| solid.positions[vertex as usize]);
                assert!((b - a).cross(c - a).y > 0.0);
            }
        }
        assert!(height(0.0, 0.0).abs() < 0.5, "the clearing is flat");
    }
}
