//! Outlines: plane loops of points, counter-clockwise unless a text says otherwise.

use super::fill::signed_area;
use super::successors;
use glam::DVec2;
use std::f64::consts::{PI, TAU};

/// A circle.
pub(crate) fn circle(center: DVec2, radius: f64, segments: u32) -> Vec<DVec2> {
    (0..segments)
        .map(|i| center + DVec2::from_angle(TAU * f64::from(i) / f64::from(segments)) * radius)
        .collect()
}

/// An arc, both ends included; clockwise when `to` is below `from`.
pub(crate) fn arc(center: DVec2, radius: f64, from: f64, to: f64, segments: u32) -> Vec<DVec2> {
    (0..=segments)
        .map(|i| center + DVec2::from_angle(from + (to - from) * f64::from(i) / f64::from(segments)) * radius)
        .collect()
}

/// A rectangle from corner to corner whose corners are rounded.
pub(crate) fn rectangle(min: DVec2, max: DVec2, radius: f64) -> Vec<DVec2> {
    let corners = [min, DVec2::new(max.x, min.y), max, DVec2::new(min.x, max.y)];
    if radius == 0.0 { corners.to_vec() } else { rounded(&corners.map(|corner| (corner, radius)), 6) }
}

/// A loop whose corners are replaced by arcs that touch both sides; a radius of zero keeps a corner.
pub(crate) fn rounded(corners: &[(DVec2, f64)], segments: u32) -> Vec<DVec2> {
    let mut points = Vec::new();
    for (i, &(corner, radius)) in corners.iter().enumerate() {
        let before = (corners[(i + corners.len() - 1) % corners.len()].0 - corner).normalize();
        let after = (corners[(i + 1) % corners.len()].0 - corner).normalize();
        if radius == 0.0 {
            points.push(corner);
            continue;
        }
        let half = before.angle_to(after).abs() / 2.0;
        let center = corner + (before + after).normalize() * (radius / half.sin());
        let first = corner + before * (radius / half.tan()) - center;
        let turn = first.angle_to(corner + after * (radius / half.tan()) - center);
        points.extend((0..=segments).map(|step| {
            center + DVec2::from_angle(turn * f64::from(step) / f64::from(segments)).rotate(first)
        }));
    }
    points
}

/// An open path whose inner corners are cut off at a distance; for the profiles of turned parts.
pub(crate) fn chamfered(points: &[(f64, f64, f64)]) -> Vec<DVec2> {
    let mut path = Vec::new();
    for (i, &(x, y, chamfer)) in points.iter().enumerate() {
        let corner = DVec2::new(x, y);
        let at = |j: usize| DVec2::new(points[j].0, points[j].1);
        if chamfer == 0.0 || i == 0 || i + 1 == points.len() {
            path.push(corner);
        } else {
            path.push(corner + (at(i - 1) - corner).normalize() * chamfer);
            path.push(corner + (at(i + 1) - corner).normalize() * chamfer);
        }
    }
    path
}

/// A loop moved to its left, which is into the material, by a small distance.
pub(crate) fn inset(points: &[DVec2], distance: f64) -> Vec<DVec2> {
    if distance == 0.0 {
        return points.to_vec();
    }
    let count = points.len();
    let left = |i: usize, j: usize| (points[j] - points[i]).perp().normalize();
    (0..count)
        .map(|i| {
            let (n, m) = (left((i + count - 1) % count, i), left(i, (i + 1) % count));
            // A corner sharper than a right angle would shoot far out: its mitre is held back.
            points[i] + (n + m) * (distance / (1.0 + n.dot(m)).max(0.5))
        })
        .collect()
}

/// The convex hull of some points, without those on its straight stretches.
pub(crate) fn convex_hull(points: &[DVec2]) -> Vec<DVec2> {
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let chain = |points: &mut dyn Iterator<Item = DVec2>| {
        let mut chain: Vec<DVec2> = Vec::new();
        for point in points {
            while let [.., a, b] = chain[..] {
                if (b - a).perp_dot(point - b) > 1e-12 {
                    break;
                }
                chain.pop();
            }
            chain.push(point);
        }
        chain.pop();
        chain
    };
    let mut hull = chain(&mut sorted.iter().copied());
    hull.extend(chain(&mut sorted.iter().rev().copied()));
    hull
}

/// Half a ring between two radii: the upper one, or the lower one when `below`.
pub(crate) fn half_ring(center: DVec2, inner: f64, outer: f64, below: bool, segments: u32) -> Vec<DVec2> {
    let (from, to) = if below { (-PI, 0.0) } else { (0.0, PI) };
    let mut points = arc(center, outer, from, to, segments);
    points.extend(arc(center, inner, to, from, segments));
    points
}

/// The loop the other way round, as a hole runs.
pub(crate) fn reversed(mut points: Vec<DVec2>) -> Vec<DVec2> {
    points.reverse();
    points
}

/// Whether a loop runs counter-clockwise.
pub(crate) fn is_counter_clockwise(points: &[DVec2]) -> bool {
    signed_area(points) > 0.0
}

/// Whether a point lies in a loop.
pub(crate) fn contains(points: &[DVec2], point: DVec2) -> bool {
    let crossings = successors(points.len())
        .filter(|&(i, j)| {
            let (a, b) = (points[i], points[j]);
            (a.y > point.y) != (b.y > point.y) && point.x < a.x + (b.x - a.x) * (point.y - a.y) / (b.y - a.y)
        })
        .count();
    crossings % 2 == 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_keeps_the_size_and_the_direction() {
        let plate = rectangle(DVec2::new(-1.0, -2.0), DVec2::new(3.0, 1.0), 0.5);
        assert!(is_counter_clockwise(&plate));
        let exact = 12.0 - (4.0 - PI) * 0.25;
        assert!((signed_area(&plate) - exact).abs() < 0.01, "{}", signed_area(&plate));
        assert!(plate.iter().all(|p| p.x >= -1.0 - 1e-12 && p.y <= 1.0 + 1e-12));
        let notch = [(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (2.0, 1.0), (0.0, 4.0)];
        let notch = rounded(&notch.map(|(x, y)| (DVec2::new(x, y), 0.2)), 5);
        assert!(is_counter_clockwise(&notch), "a concave corner is rounded as well");
    }

    #[test]
    fn insets_and_hulls() {
        let square = rectangle(DVec2::ZERO, DVec2::ONE, 0.0);
        assert!((signed_area(&inset(&square, 0.1)) - 0.64).abs() < 1e-12);
        assert!((signed_area(&inset(&reversed(square.clone()), 0.1)) + 1.44).abs() < 1e-12, "a hole grows");
        let mut points = square.clone();
        points.extend([DVec2::splat(0.5), DVec2::new(0.5, 0.0)]);
        assert_eq!(convex_hull(&points), square);
        assert!(contains(&square, DVec2::splat(0.5)) && !contains(&square, DVec2::new(0.5, 1.5)));
    }
}
