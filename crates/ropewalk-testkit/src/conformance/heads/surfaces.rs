//! Rays that leave the triangles that a case's rays hit, as a renderer's secondary rays do.
//!
//! They start at the point that was hit, at a corner, on an edge, and a little above; towards a light, along axes and
//! diagonals, along the triangle's edges, almost within its plane, and anywhere. Most leave the front; those that leave
//! the back must begin with the first element.

use super::Batch;
use crate::cases::Case;
use crate::random::Random;
use glam::{DVec3, Vec3};
use ropewalk::{Answer, FlatTriangle, Hit, Query, Ray, TraceOptions, TraversalList, Walk};

/// Hits from which rays start, and how many from each.
const HITS: usize = 48;
const RAYS_A_HIT: usize = 12;
/// Percent: see [`Batch::slack`].
const SLACK: u64 = 10;
/// How far above a triangle some rays start, as a share of the scene's largest coordinate: no farther than the rule of
/// [`TraversalList::polygon_starts`] allows.
const ABOVE: f64 = 0.9e-6;

/// The rays and the rows of their heads; none where the list has no heads, or nothing is hit.
pub(super) fn batch(list: &TraversalList, case: &Case) -> Vec<Batch> {
    let Some(table) = list.polygon_heads() else { return Vec::new() };
    let seed = case.name.bytes().map(u64::from).sum();
    let (rays, triangles) = rays(list, case, &mut Random::new(seed));
    if rays.is_empty() {
        return Vec::new();
    }
    let rows = list.polygon_starts(&rays, &triangles);
    vec![Batch {
        what: "from surfaces",
        rays,
        tables: vec![table.clone()],
        rows: vec![rows],
        slack: Some(SLACK),
    }]
}

/// The rays, and the number of the triangle that each leaves. All rays of a hit stand together.
fn rays(list: &TraversalList, case: &Case, random: &mut Random) -> (Vec<Ray>, Vec<u32>) {
    let options = TraceOptions::default();
    let hits = match list.trace(Walk::BruteForce, Query::Closest, &case.rays, options) {
        Ok(traced) => match traced.answer {
            Answer::Closest(hits) => hits,
            _ => Vec::new(),
        },
        Err(_) => Vec::new(),
    };
    let seen: Vec<(&Ray, Hit)> = case.rays.iter().zip(hits).filter(|(_, hit)| hit.is_hit()).collect();
    let step = seen.len().div_ceil(HITS).max(1);
    let size = f64::from(list.largest_coordinate());
    let light = list.bounds().center().as_dvec3() + DVec3::new(-0.6, 1.0, 0.4) * size * 2.0;
    let (mut rays, mut numbers) = (Vec::new(), Vec::new());
    for (seen, hit) in seen.into_iter().step_by(step) {
        let Some(number) = list.number_of(hit.id()) else { continue };
        let Some(surface) = Surface::new(&list.triangle_at(number), &hit) else { continue };
        for kind in 0..RAYS_A_HIT {
            let origin = surface.start(size * ABOVE, random);
            let ray = surface.leave(origin, kind, light, random);
            if ray.is_valid() {
                rays.push(ray.with_mask(seen.mask));
                numbers.push(number);
            }
        }
    }
    (rays, numbers)
}

/// A triangle and the point of it that was hit.
struct Surface {
    corners: [DVec3; 3],
    point: DVec3,
    /// Of length 1, on the front.
    front: DVec3,
}

impl Surface {
    fn new(triangle: &FlatTriangle, hit: &Hit) -> Option<Self> {
        let corners = triangle.triangle().vertices.map(Vec3::as_dvec3);
        let [a, b, c] = corners;
        let (u, v) = (f64::from(hit.barycentrics.x), f64::from(hit.barycentrics.y));
        let normal = (b - a).cross(c - a).try_normalize()?;
        let front = if triangle.is_mirrored() { -normal } else { normal };
        Some(Self { corners, point: a * (1.0 - u - v) + b * u + c * v, front })
    }

    /// Where a ray starts: mostly at the point.
    fn start(&self, above: f64, random: &mut Random) -> Vec3 {
        let [a, b] = [self.corners[0], self.corners[1]];
        let point = match random.below(8) {
            0 => random.pick(&self.corners),
            1 => a + (b - a) * random.unit(),
            2 | 3 => self.point + self.front * above,
            _ => self.point,
        };
        point.as_vec3()
    }

    fn leave(&self, origin: Vec3, kind: usize, light: DVec3, random: &mut Random) -> Ray {
        let [a, b, c] = self.corners;
        let upwards = |dir: DVec3| if dir.dot(self.front) < 0.0 { -dir } else { dir };
        let edges = [b - a, c - b, a - c];
        let dir = match kind {
            0 => return Ray::new(origin, (light - origin.as_dvec3()).as_vec3()).window(0.0, 1.0),
            1 => upwards(random.pick(&[DVec3::X, DVec3::Y, DVec3::Z])),
            2 => upwards(DVec3::from_array([(); 3].map(|()| random.pick(&[1.0, -1.0])))),
            // In the plane of the triangle, or so near to it that f32 can hardly tell.
            3 => random.pick(&edges) * random.pick(&[1.0, -1.0]),
            4 => {
                let along = edges[0] * random.between(-1.0, 1.0) + edges[1] * random.between(-1.0, 1.0);
                along + self.front * along.length() * random.pick(&[1e-3, 1e-5, 1e-7, -1e-7])
            }
            // From the back.
            5 => -upwards(random.direction()),
            // By the cosine.
            6 | 7 => self.front + random.direction() * 0.999_999,
            _ => upwards(random.direction()),
        };
        let ray = Ray::new(origin, dir.as_vec3());
        // As renderers do who start on the surface itself: some way off.
        if kind == 8 {
            ray.window(f32::EPSILON * light.abs().max_element() as f32, f32::INFINITY)
        } else {
            ray
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ropewalk::traversal_list::{Heads, ListOptions, Starts};

    /// The rows are asked for of rays that leave the front, and of no others.
    #[test]
    fn rays_leave_fronts_and_backs_and_are_told_apart() {
        for name in ["soup", "placed", "boxes"] {
            let case = Case::named(name).unwrap();
            let list = case
                .scene
                .build_list(&ListOptions { heads: Heads::Simple, ..ListOptions::default() })
                .unwrap();
            let (rays, numbers) = rays(&list, &case, &mut Random::new(1));
            let rows = list.polygon_starts(&rays, &numbers);
            assert!(rays.len() > 500, "{name}: {}", rays.len());
            let (mut front, mut back) = (0, 0);
            for ((ray, &number), &row) in rays.iter().zip(&numbers).zip(&rows) {
                let triangle = list.triangle_at(number);
                let [a, b, c] = triangle.triangle().vertices.map(Vec3::as_dvec3);
                let normal =
                    (b - a).cross(c - a).normalize() * if triangle.is_mirrored() { -1.0 } else { 1.0 };
                let slope = ray.dir.as_dvec3().normalize().dot(normal);
                if slope > 1e-4 {
                    front += 1;
                    assert_eq!(row, number, "{name}: {ray:?}");
                } else if slope < -1e-4 {
                    back += 1;
                    assert_eq!(row, Starts::FROM_THE_FIRST, "{name}: {ray:?}");
                }
            }
            assert!(front > 300 && back > 40, "{name}: {front} leave fronts, {back} backs");
        }
    }
}
