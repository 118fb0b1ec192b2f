//! Triangulation of plane regions with holes, by cutting off ears.
//!
//! Unlike general libraries it uses *every* vertex it is given, also those on a straight stretch, and makes no
//! triangle without area: the walls around the region have those vertices as well, and a region that skipped one
//! would leave a crack. Holes are joined to the outline by their shortest free bridges; of all ears the
//! roundest is cut off first, which keeps needles rare. O(n^2) for n vertices, a few thousand at most here.

use super::successors;
use glam::DVec2;

/// A corner flatter than this (twice the area of its triangle over the square of its longest side) is no ear.
const FLAT: f64 = 1e-9;

/// The vertices are this close to a triangle when they count as inside it.
const TOUCH: f64 = 1e-9;

/// Triangles, counter-clockwise, between the vertices of the loops as counted through all of them.
///
/// The first loop is the outline, the others are holes in it; they may run either way and must not touch.
pub(crate) fn triangulate(loops: &[Vec<DVec2>]) -> Vec<[usize; 3]> {
    let points = loops.concat();
    let mut start = 0;
    let mut rings: Vec<Vec<usize>> = Vec::new();
    for (index, points) in loops.iter().enumerate() {
        let mut ring: Vec<usize> = (start..start + points.len()).collect();
        start += points.len();
        let counter_clockwise = signed_area(points) > 0.0;
        if counter_clockwise != (index == 0) {
            ring.reverse();
        }
        rings.push(ring);
    }
    let holes = rings.split_off(1.min(rings.len()));
    let Some(outline) = rings.pop() else { return Vec::new() };
    cut_ears(&points, join(&points, outline, holes))
}

/// The area of a loop, positive when it runs counter-clockwise.
pub(crate) fn signed_area(points: &[DVec2]) -> f64 {
    successors(points.len()).map(|(i, j)| points[i].perp_dot(points[j])).sum::<f64>() / 2.0
}

/// One ring from an outline and its holes, with a bridge there and back to each hole.
fn join(points: &[DVec2], mut ring: Vec<usize>, mut holes: Vec<Vec<usize>>) -> Vec<usize> {
    while !holes.is_empty() {
        let Some((hole, at_hole, at_ring)) = shortest_bridge(points, &ring, &holes) else { break };
        let mut hole = holes.swap_remove(hole);
        hole.rotate_left(at_hole);
        let detour = hole.iter().copied().chain([hole[0], ring[at_ring]]).collect::<Vec<_>>();
        ring.splice(at_ring + 1..at_ring + 1, detour);
    }
    ring
}

/// The hole, the place in it and the place in the ring between which the shortest free bridge leads.
fn shortest_bridge(points: &[DVec2], ring: &[usize], holes: &[Vec<usize>]) -> Option<(usize, usize, usize)> {
    let mut candidates = Vec::new();
    for (hole, loop_) in holes.iter().enumerate() {
        for (at_hole, &from) in loop_.iter().enumerate() {
            // The nearest few of each hole's vertex would do, but a bridge is short and a pass is cheap.
            let nearest = (0..ring.len())
                .map(|at_ring| (points[from].distance_squared(points[ring[at_ring]]), at_ring))
                .filter(|&(_, at_ring)| looks_inside(points, ring, at_ring, points[from]))
                .min_by(|a, b| a.0.total_cmp(&b.0));
            candidates.extend(nearest.map(|(distance, at_ring)| (distance, (hole, at_hole, at_ring))));
        }
    }
    candidates.sort_by(|a, b| a.0.total_cmp(&b.0));
    let free = |&&(_, (hole, at_hole, at_ring)): &&(f64, (usize, usize, usize))| {
        let (a, b) = (points[holes[hole][at_hole]], points[ring[at_ring]]);
        let crossed = |other: &[usize]| {
            successors(other.len()).any(|(i, j)| crosses(a, b, points[other[i]], points[other[j]]))
        };
        !crossed(ring) && !holes.iter().any(|hole| crossed(hole))
    };
    candidates.iter().find(free).or(candidates.first()).map(|candidate| candidate.1)
}

/// Whether the way from a ring's vertex to a point starts inside the ring.
fn looks_inside(points: &[DVec2], ring: &[usize], at: usize, target: DVec2) -> bool {
    let corner = points[ring[at]];
    let before = points[ring[(at + ring.len() - 1) % ring.len()]] - corner;
    let after = points[ring[(at + 1) % ring.len()]] - corner;
    let way = target - corner;
    let (left_of_after, right_of_before) = (after.perp_dot(way) > 0.0, way.perp_dot(before) > 0.0);
    if after.perp_dot(before) > 0.0 {
        left_of_after && right_of_before
    } else {
        left_of_after || right_of_before
    }
}

/// Whether two segments cross in the inner of both.
fn crosses(a: DVec2, b: DVec2, c: DVec2, d: DVec2) -> bool {
    let side = |p: DVec2, q: DVec2, r: DVec2| (q - p).perp_dot(r - p);
    side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
}

/// A ring as a doubly linked list, so that a vertex is taken out at once.
struct Links<'a> {
    points: &'a [DVec2],
    vertices: Vec<usize>,
    next: Vec<usize>,
    previous: Vec<usize>,
}

impl Links<'_> {
    fn corner(&self, at: usize) -> [DVec2; 3] {
        [self.previous[at], at, self.next[at]].map(|place| self.points[self.vertices[place]])
    }

    /// How round the triangle at a corner is, 1 for the best; `None` when it is no ear.
    fn score(&self, at: usize, blunt: &[bool]) -> Option<f64> {
        let [a, b, c] = self.corner(at);
        let longest = (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
        let roundness = (b - a).perp_dot(c - b) / longest;
        if roundness.is_nan() || roundness <= FLAT {
            return None;
        }
        let (min, max) = (a.min(b).min(c) - TOUCH, a.max(b).max(c) + TOUCH);
        let mut place = self.next[self.next[at]];
        while place != self.previous[at] {
            let point = self.points[self.vertices[place]];
            // The box rules nearly all of them out.
            let near = blunt[place] && point.cmpge(min).all() && point.cmple(max).all();
            if near && point != a && point != b && point != c && touches(point, [a, b, c]) {
                return None;
            }
            place = self.next[place];
        }
        Some(roundness)
    }

    /// Whether a corner is straight or turns the wrong way: only such vertices can lie in an ear.
    fn is_blunt(&self, at: usize) -> bool {
        let [a, b, c] = self.corner(at);
        (b - a).perp_dot(c - b) <= FLAT * (c - a).length_squared()
    }
}

/// Whether a point is in a counter-clockwise triangle or closer to it than [`TOUCH`].
fn touches(point: DVec2, corners: [DVec2; 3]) -> bool {
    successors(3).all(|(i, j)| {
        let edge = corners[j] - corners[i];
        edge.perp_dot(point - corners[i]) >= -TOUCH * edge.length()
    })
}

fn cut_ears(points: &[DVec2], vertices: Vec<usize>) -> Vec<[usize; 3]> {
    let count = vertices.len();
    let mut triangles = Vec::with_capacity(count);
    let mut links = Links {
        points,
        vertices,
        next: (0..count).map(|i| (i + 1) % count).collect(),
        previous: (0..count).map(|i| (i + count - 1) % count).collect(),
    };
    let mut left: Vec<usize> = (0..count).collect();
    let mut blunt: Vec<bool> = (0..count).map(|at| links.is_blunt(at)).collect();
    let mut scores: Vec<Option<f64>> = (0..count).map(|at| links.score(at, &blunt)).collect();
    while left.len() >= 3 {
        let roundest = |scores: &[Option<f64>]| {
            let ears = left.iter().enumerate().filter_map(|(i, &at)| Some((i, at, scores[at]?)));
            ears.max_by(|a, b| a.2.total_cmp(&b.2))
        };
        let mut ear = roundest(&scores);
        if ear.is_none() {
            // What was in the way of an ear may be gone by now.
            for &at in &left {
                scores[at] = links.score(at, &blunt);
            }
            ear = roundest(&scores);
        }
        let Some((index, at, _)) = ear else { break };
        let (before, after) = (links.previous[at], links.next[at]);
        triangles.push([before, at, after].map(|place| links.vertices[place]));
        links.next[before] = after;
        links.previous[after] = before;
        left.swap_remove(index);
        for neighbour in [before, after] {
            blunt[neighbour] = links.is_blunt(neighbour);
        }
        for neighbour in [before, after] {
            scores[neighbour] = links.score(neighbour, &blunt);
        }
    }
    triangles
}

#[cfg(test)]
mod tests {
    use super::super::outline::circle;
    use super::*;

    fn check(loops: &[Vec<DVec2>]) {
        let points = loops.concat();
        let triangles = triangulate(loops);
        let expected: f64 =
            signed_area(&loops[0]).abs() - loops[1..].iter().map(|hole| signed_area(hole).abs()).sum::<f64>();
        let areas: Vec<f64> =
            triangles.iter().map(|triangle| signed_area(&triangle.map(|vertex| points[vertex]))).collect();
        assert!(areas.iter().all(|&area| area > 1e-12), "{areas:?}");
        assert!((areas.iter().sum::<f64>() - expected).abs() < 1e-9 * expected);
        assert_eq!(triangles.len(), points.len() + 2 * (loops.len() - 1) - 2, "every vertex is used");
    }

    #[test]
    fn straight_stretches_keep_their_vertices() {
        let square = |n: i32, size: f64| -> Vec<DVec2> {
            let side = |from: DVec2, step: DVec2| {
                (0..n).map(move |i| from + step * (f64::from(i) * size / f64::from(n)))
            };
            [
                side(DVec2::ZERO, DVec2::X),
                side(DVec2::new(size, 0.0), DVec2::Y),
                side(DVec2::splat(size), -DVec2::X),
                side(DVec2::new(0.0, size), -DVec2::Y),
            ]
            .into_iter()
            .flatten()
            .collect()
        };
        check(&[square(1, 1.0)]);
        check(&[square(7, 3.0)]);
        let hole = square(5, 1.0).iter().map(|&p| p + DVec2::ONE).collect();
        check(&[square(9, 3.0), hole]);
        check(&[vec![DVec2::ZERO, DVec2::new(0.5, 0.0), DVec2::X, DVec2::Y]]);
    }

    #[test]
    fn discs_with_holes() {
        let mut loops = vec![circle(DVec2::ZERO, 1.0, 60)];
        for i in 0..6 {
            let center = DVec2::from_angle(f64::from(i)) * 0.65;
            loops.push(circle(center, 0.15, 24));
        }
        loops.push(circle(DVec2::ZERO, 0.3, 32));
        check(&loops);
        for hole in &mut loops {
            hole.reverse();
        }
        check(&loops);
    }

    #[test]
    fn nothing_comes_of_nothing() {
        assert!(triangulate(&[]).is_empty());
        assert!(triangulate(&[vec![DVec2::ZERO, DVec2::X]]).is_empty());
        assert!(triangulate(&[vec![DVec2::ZERO, DVec2::X, DVec2::X * 2.0]]).is_empty(), "no area");
    }
}
