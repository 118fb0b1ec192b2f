//! Turning a frame about its axes until its box is no longer made smaller; on few points, see [`super`].

use glam::{DMat2, DMat3, DVec2, DVec3};

/// Directions whose extreme points are the few: axes, diagonals of faces, diagonals of the cube.
const DIRECTIONS: [[f64; 3]; 13] = [
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [1.0, 1.0, 0.0],
    [1.0, -1.0, 0.0],
    [1.0, 0.0, 1.0],
    [1.0, 0.0, -1.0],
    [0.0, 1.0, 1.0],
    [0.0, 1.0, -1.0],
    [1.0, 1.0, 1.0],
    [1.0, 1.0, -1.0],
    [1.0, -1.0, 1.0],
    [-1.0, 1.0, 1.0],
];

/// Angles that are tried of a quarter turn, which is where boxes come back to themselves. Between two of them, 6 degrees apart,
/// the area of the box of a face goes down and up at most once, but for round things, whose boxes hardly change.
const ANGLES: usize = 16;
/// Steps of the search between two angles: each makes what is left 0.6 times as long, in the end 0.005 degrees.
const STEPS: usize = 15;
/// A round over the axes that makes the area smaller by less than this part of it is the last one.
const WORTH: f64 = 1e-3;
/// The most rounds.
const ROUNDS: usize = 6;

/// The points that reach out farthest along three axes, and how far.
pub(super) struct Extremes {
    low: [(f64, DVec3); 3],
    high: [(f64, DVec3); 3],
}

impl Extremes {
    const NONE: Self =
        Self { low: [(f64::INFINITY, DVec3::ZERO); 3], high: [(f64::NEG_INFINITY, DVec3::ZERO); 3] };

    /// Along the axes of a frame.
    pub(super) fn along(frame: &DMat3, points: impl Iterator<Item = DVec3>) -> Self {
        let mut extremes = Self::NONE;
        for point in points {
            for (axis, reach) in (*frame * point).to_array().into_iter().enumerate() {
                if reach < extremes.low[axis].0 {
                    extremes.low[axis] = (reach, point);
                }
                if reach > extremes.high[axis].0 {
                    extremes.high[axis] = (reach, point);
                }
            }
        }
        extremes
    }

    /// Puts the extreme points of all directions into `few`.
    pub(super) fn of_directions(points: impl Iterator<Item = DVec3>, few: &mut Vec<DVec3>) {
        let mut extremes = [(f64::INFINITY, DVec3::ZERO, f64::NEG_INFINITY, DVec3::ZERO); DIRECTIONS.len()];
        for point in points {
            for (direction, (low, lowest, high, highest)) in DIRECTIONS.iter().zip(&mut extremes) {
                let reach = DVec3::from(*direction).dot(point);
                if reach < *low {
                    (*low, *lowest) = (reach, point);
                }
                if reach > *high {
                    (*high, *highest) = (reach, point);
                }
            }
        }
        // Many directions have the same: a box has eight for all of them.
        for point in extremes.iter().flat_map(|&(_, lowest, _, highest)| [lowest, highest]) {
            if !few.contains(&point) {
                few.push(point);
            }
        }
    }

    /// The size of the box along the axes.
    pub(super) fn size(&self) -> DVec3 {
        let [x, y, z] = [0, 1, 2].map(|axis| self.high[axis].0 - self.low[axis].0);
        DVec3::new(x, y, z)
    }

    pub(super) fn points(&self) -> impl Iterator<Item = DVec3> {
        self.low.iter().chain(&self.high).map(|&(_, point)| point)
    }
}

/// Half the surface area of a box.
pub(super) fn half_area(size: DVec3) -> f64 {
    size.x * size.y + size.y * size.z + size.z * size.x
}

/// The frame with one axis along `first` and one in the plane of `first` and `third`, at a right angle to it. Its rows are the axes: it
/// leads from the object's space to the frame. `None` where the two have no plane.
pub(super) fn frame(first: DVec3, third: DVec3) -> Option<DMat3> {
    let x = first.try_normalize()?;
    let y = third.cross(x).try_normalize()?;
    Some(DMat3::from_cols(x, y, x.cross(y)).transpose())
}

/// The area of the box of the few in the frame that is found, and the frame.
pub(super) fn refine(mut frame: DMat3, few: &[DVec3]) -> (f64, DMat3) {
    let mut least = half_area(Extremes::along(&frame, few.iter().copied()).size());
    let mut flat = Vec::with_capacity(few.len());
    for _ in 0..ROUNDS {
        let before = least;
        for axis in 0..3 {
            let (angle, area) = turn(&frame, axis, few, &mut flat);
            if area < least {
                frame = about(axis, angle) * frame;
                least = area;
            }
        }
        if least >= before * (1.0 - WORTH) {
            break;
        }
    }
    (least, frame)
}

fn about(axis: usize, angle: f64) -> DMat3 {
    let turn = [DMat3::from_rotation_x, DMat3::from_rotation_y, DMat3::from_rotation_z];
    turn[axis % 3](angle)
}

/// The angle about an axis of the frame at which the box is the smallest, and its area. `flat` is room for the points as they are
/// seen along the axis.
fn turn(frame: &DMat3, axis: usize, few: &[DVec3], flat: &mut Vec<DVec2>) -> (f64, f64) {
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    flat.clear();
    for &point in few {
        let point = *frame * point;
        (low, high) = (low.min(point[axis]), high.max(point[axis]));
        flat.push(DVec2::new(point[u], point[v]));
    }
    let length = high - low;
    let area_at = |angle: f64| {
        let turn = DMat2::from_angle(angle);
        let (mut min, mut max) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        for &point in flat.iter() {
            let turned = turn * point;
            (min, max) = (min.min(turned), max.max(turned));
        }
        let size = max - min;
        size.x * size.y + length * (size.x + size.y)
    };
    let step = std::f64::consts::FRAC_PI_2 / ANGLES as f64;
    let mut best = (0.0, f64::INFINITY);
    for index in 0..ANGLES {
        let angle = index as f64 * step;
        let area = area_at(angle);
        if area < best.1 {
            best = (angle, area);
        }
    }
    // Golden section between the neighbours of the best.
    let golden = 0.618_033_988_749_894_9;
    let (mut low, mut high) = (best.0 - step, best.0 + step);
    let (mut a, mut b) = (high - golden * (high - low), low + golden * (high - low));
    let (mut at_a, mut at_b) = (area_at(a), area_at(b));
    for _ in 0..STEPS {
        if at_a < at_b {
            (high, b, at_b) = (b, a, at_a);
            a = high - golden * (high - low);
            at_a = area_at(a);
        } else {
            (low, a, at_a) = (a, b, at_b);
            b = low + golden * (high - low);
            at_b = area_at(b);
        }
    }
    for (angle, area) in [(a, at_a), (b, at_b)] {
        if area < best.1 {
            best = (angle, area);
        }
    }
    best
}
