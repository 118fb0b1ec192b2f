//! Queries that are hard on a given tree.

use crate::rays::Random;
use ropewalk::glam::Vec3;
use ropewalk::point::LARGEST_POINT;
use ropewalk::{Bvh, PointQuery};

/// Some hundred queries: plain ones and every nasty kind.
pub(super) fn against(bvh: &Bvh) -> Vec<PointQuery> {
    let mut random = Random::new(21);
    let (triangles, bounds) = (bvh.triangles(), bvh.bounds());
    let (center, size) =
        if triangles.is_empty() { (Vec3::ZERO, 1.0) } else { (bounds.center(), bounds.size().max_element()) };
    let mut points =
        vec![center, Vec3::ZERO, Vec3::splat(-0.0), bounds.min.min(center), bounds.max.max(center)];
    // Inside and around.
    for _ in 0..60 {
        points.push(center + random.vector() * size * 0.6);
        points.push(center + random.vector() * size * 3.0);
    }
    // On vertices, edges and faces, beside them, above them, and in their planes.
    for index in 0..40 {
        let Some(triangle) = triangles.get(random.below(triangles.len())) else { break };
        let [a, b, c] = triangle.triangle().vertices;
        let away = random.vector() * size * 10f32.powi(-(index % 9));
        let normal = (b - a).cross(c - a).normalize_or_zero() * size * 0.1;
        let middle = (a + b + c) / 3.0;
        points.extend([a, a.midpoint(b), middle, a + away, b.midpoint(c) + away, middle + away]);
        points.extend([middle + normal, b.midpoint(c) - normal, c + normal, a + (a - b), a + (b - c)]);
    }
    // Whole and half numbers: many triangles are equally near.
    for _ in 0..60 {
        points.push((random.vector() * 5.99).trunc() * 0.5);
    }
    // Near and far beyond all proportion.
    for index in 0..40 {
        points.push(random.vector() * 10f32.powi(index % 38 - 19));
        points.push(center + random.vector() * size * 10f32.powi(index % 7));
    }
    let mut queries: Vec<PointQuery> = points.into_iter().map(PointQuery::new).collect();

    // Radii that end at what is found, a float before and a float behind it; masks, and bits that do not count.
    let found: Vec<PointQuery> = queries
        .iter()
        .map(|&query| query.within(bvh.closest_point(&query).distance))
        .filter(|query| query.radius.is_finite())
        .collect();
    for _ in 0..40 {
        let Some(&query) = found.get(random.below(found.len())) else { break };
        let radius = query.radius;
        for radius in
            [radius, radius.next_down().max(0.0), radius.next_up(), radius * 1.5, 0.0, -0.0, size * 0.05]
        {
            queries.push(query.within(radius));
        }
        let whole = query.within(f32::INFINITY);
        for mask in [1 << random.below(10), 0, 0xffff_ff00] {
            queries.push(whole.with_mask(mask));
        }
        queries.push(query.within(radius * 2.0).with_mask(0x7f));
    }
    queries.extend(invalid());
    queries
}

/// Queries that may not be asked, and a few at the edge of what may.
pub(super) fn invalid() -> Vec<PointQuery> {
    let good = PointQuery::new(Vec3::new(0.25, -0.5, 0.75));
    let mut queries = vec![
        good.within(-1.0),
        good.within(-f32::from_bits(1)),
        // Valid ones:
        good.within(f32::from_bits(1)),
        good.within(f32::MAX),
        good.within(1e19),
        PointQuery::new(Vec3::new(LARGEST_POINT, -LARGEST_POINT, LARGEST_POINT)),
        PointQuery::new(Vec3::new(f32::from_bits(1), f32::from_bits(0x8000_0001), 0.0)),
    ];
    // Quiet, signalling and negative NaN, the infinities, and what is just too large, in every place.
    for bits in [0x7fc0_0000, 0x7f80_0001, 0xffff_ffff, 0x7f80_0000, 0xff80_0000, LARGEST_POINT.to_bits() + 1]
    {
        for axis in 0..3 {
            let mut query = good;
            query.point[axis] = f32::from_bits(bits);
            queries.push(query);
        }
        queries.push(good.within(f32::from_bits(bits)));
    }
    queries
}
