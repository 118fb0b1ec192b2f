//! Where to ask.

use crate::random::Random;
use glam::{DVec3, Vec3};
use ropewalk::{Aabb, FlatScene, PointQuery};

/// Random points around bounds that are enlarged by half, the same for the same seed. Around nothing, in the cube of
/// side 3 about zero.
#[must_use]
pub fn around(bounds: &Aabb, count: usize, seed: u64) -> Vec<PointQuery> {
    let mut random = Random::new(seed);
    let bounds = if bounds.is_empty() { Aabb::new(Vec3::NEG_ONE, Vec3::ONE) } else { *bounds };
    (0..count).map(|_| PointQuery::new(random.in_box(&bounds, 1.5).as_vec3())).collect()
}

/// Points in every awkward place: vertices, middles of edges, on faces, a little beside all these, corners and middles
/// of boxes, far away, and each of them with radii and masks; some of them several times. About `count` of each kind.
#[must_use]
pub fn awkward(scene: &FlatScene, count: usize, seed: u64) -> Vec<PointQuery> {
    let mut random = Random::new(seed);
    let boxes = scene.triangles.iter().map(|triangle| triangle.triangle().bounds());
    let bounds = boxes.fold(Aabb::EMPTY, Aabb::union);
    let mut points: Vec<Vec3> = around(&bounds, 2 * count, seed).iter().map(|query| query.point).collect();
    for _ in 0..count {
        let Some(triangle) = scene.triangles.get(random.below(scene.triangles.len())) else { break };
        let corners = triangle.triangle().vertices;
        let [a, b, c] = corners.map(Vec3::as_dvec3);
        let (u, v) = (random.unit(), random.unit());
        let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
        let on_face = (a + (b - a) * u + (c - a) * v).as_vec3();
        let beside = on_face + (random.direction() * f64::from(bounds.size().max_element()) * 1e-4).as_vec3();
        let small = triangle.triangle().bounds();
        points.extend([random.pick(&corners), ((a + b) * 0.5).as_vec3(), on_face, beside]);
        points.extend([
            small.min,
            small.max,
            small.center(),
            Vec3::new(small.min.x, small.max.y, small.min.z),
        ]);
        points.push(Vec3::from_array(on_face.to_array().map(f32::next_up)));
    }
    for corner in 0..8 {
        let pick = |axis: usize| if corner >> axis & 1 == 0 { bounds.min[axis] } else { bounds.max[axis] };
        let corner = Vec3::new(pick(0), pick(1), pick(2));
        points.extend([corner, bounds.center()].into_iter().filter(|point| point.is_finite()));
    }
    for distance in [1e3, 1e6, 1e12] {
        points.extend((0..count.div_ceil(4)).map(|_| (random.direction() * distance).as_vec3()));
    }
    // Again, as duplicates.
    points.extend_from_within(..count.min(points.len()));
    let size = f64::from(bounds.size().length()).max(f64::from(f32::MIN_POSITIVE));
    let narrowed = points.clone().into_iter().map(|point| {
        let radius = random.pick(&[0.0, 1e-6, 1e-3, 0.05, 0.3, 2.0]) * size;
        let mask = random.pick(&[0xff, 0xff, 0xff, 0x01, 0x82, 0x00, 0x1_00ff]);
        PointQuery::new(point).within(radius as f32).with_mask(mask)
    });
    let narrowed: Vec<PointQuery> = narrowed.collect();
    points.into_iter().map(PointQuery::new).chain(narrowed).collect()
}

/// Queries that are not valid.
#[must_use]
pub fn invalid() -> Vec<PointQuery> {
    let good = PointQuery::new(Vec3::splat(0.3));
    let bad = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX];
    let mut queries: Vec<PointQuery> = bad
        .iter()
        .flat_map(|&bad| (0..3).map(move |axis| (axis, bad)))
        .map(|(axis, bad)| {
            let mut query = good;
            query.point[axis] = bad;
            query
        })
        .collect();
    queries.extend([f32::NAN, -1.0, -f32::MIN_POSITIVE, f32::NEG_INFINITY].map(|radius| good.within(radius)));
    queries
}

/// The point in f64.
pub(super) fn wide(query: &PointQuery) -> DVec3 {
    query.point.as_dvec3()
}
