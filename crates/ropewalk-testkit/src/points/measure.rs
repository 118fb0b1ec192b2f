//! The distance of a point from a triangle in f64, and between which bounds a right answer in f32 lies.

use glam::DVec3;

/// Half a unit in the last place of 1 in f32.
const HALF_ULP: f64 = 1.0 / (1 << 24) as f64;

/// By how many half units of the numbers in play (the way to the nearest corner and the longest edge) a distance in f32
/// may be off. 13 is the worst that was seen among 200,000 needles of every thinness, by the test
/// `needles_are_as_good_as_others` of the library; the rest is room for those that it did not see.
const ROUNDINGS: f64 = 20.0;

/// Squares of smaller lengths are no numbers of f32 any more.
const SMALLEST: f64 = 1e-22;

/// How far a point is from a triangle.
#[derive(Clone, Copy, Debug)]
pub struct Measured {
    /// The distance.
    pub distance: f64,
    /// No right answer is nearer.
    pub low: f64,
    /// No right answer is farther.
    pub high: f64,
    /// By how much the weights and the closest point, at the size of the triangle, may be off.
    pub spread: f64,
}

impl Measured {
    /// Measures by the plane where the point is above the face, and by the sides where it is not.
    #[must_use]
    pub fn new(point: DVec3, corners: &[DVec3; 3]) -> Self {
        let distance = distance(point, corners);
        let [a, b, c] = *corners;
        let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
        let nearest = corners.iter().map(|corner| corner.distance(point)).fold(f64::INFINITY, f64::min);
        let error = ROUNDINGS * HALF_ULP * (nearest + longest) + SMALLEST;
        let largest = corners.iter().map(|corner| corner.abs().max_element()).fold(0.0, f64::max);
        let spread = ROUNDINGS * HALF_ULP * (largest + longest) + SMALLEST;
        Self { distance, low: (distance - error).max(0.0), high: distance + error, spread }
    }
}

/// The distance of a point from a triangle of any shape.
#[must_use]
pub(super) fn distance(point: DVec3, corners: &[DVec3; 3]) -> f64 {
    let [a, b, c] = *corners;
    let normal = (b - a).cross(c - a);
    let is_above = |from: DVec3, to: DVec3| normal.cross(to - from).dot(point - from) >= 0.0;
    if normal != DVec3::ZERO && is_above(a, b) && is_above(b, c) && is_above(c, a) {
        return (normal.normalize().dot(point - a)).abs();
    }
    [(a, b), (b, c), (c, a)]
        .map(|(from, to)| from_segment(point, from, to))
        .into_iter()
        .fold(f64::INFINITY, f64::min)
}

fn from_segment(point: DVec3, from: DVec3, to: DVec3) -> f64 {
    let way = to - from;
    let length_squared = way.length_squared();
    let along =
        if length_squared > 0.0 { ((point - from).dot(way) / length_squared).clamp(0.0, 1.0) } else { 0.0 };
    point.distance(from + way * along)
}
