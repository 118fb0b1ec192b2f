//! Rays that are hard on a given structure.

use crate::kd_trees::in_planes;
use ropewalk::glam::Vec3;
use ropewalk::{Aabb, Hit, Query, Ray, Structure, TraceOptions};

/// A small generator of numbers (splitmix64), so that every run has the same rays.
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed)
    }

    pub(crate) fn word(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut word = self.0;
        word = (word ^ (word >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        word = (word ^ (word >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        word ^ (word >> 31)
    }

    /// A number in `[-1, 1)`.
    pub(crate) fn number(&mut self) -> f32 {
        (self.word() >> 40) as f32 / (1 << 23) as f32 - 1.0
    }

    /// A vector in the cube of those numbers.
    pub(crate) fn vector(&mut self) -> Vec3 {
        Vec3::new(self.number(), self.number(), self.number())
    }

    pub(crate) fn below(&mut self, limit: usize) -> usize {
        (self.word() % limit.max(1) as u64) as usize
    }
}

/// Some thousand rays against a structure: plain ones and every nasty kind.
pub(crate) fn against(structure: &Structure) -> Vec<Ray> {
    let mut random = Random::new(42);
    let triangles = structure.triangles();
    let bounds = triangles.iter().map(|triangle| triangle.triangle().bounds()).fold(Aabb::EMPTY, Aabb::union);
    let (center, size) =
        if bounds.is_empty() { (Vec3::ZERO, 1.0) } else { (bounds.center(), bounds.size().max_element()) };
    let mut rays = Vec::new();

    // From around and inside, anywhere.
    for _ in 0..600 {
        let origin = center + random.vector() * size * 1.5;
        let target = center + random.vector() * size * 0.6;
        rays.push(Ray::new(origin, target - origin));
        rays.push(Ray::new(target, random.vector()));
    }
    // Along the axes, through vertices and in the planes of faces, with zeros of both signs.
    let vertex = |random: &mut Random| {
        triangles
            .get(random.below(triangles.len()))
            .map_or(center, |triangle| triangle.triangle().vertices[random.below(3)])
    };
    for index in 0..600 {
        let zero = if index % 2 == 0 { 0.0 } else { -0.0 };
        let mut dir = Vec3::splat(zero);
        dir[index % 3] = if index % 4 < 2 { 1.0 } else { -1.0 };
        let at = vertex(&mut random);
        rays.push(Ray::new(at - dir * size, dir));
        // One component is zero, the ray starts in the vertex itself.
        let mut slanted = random.vector();
        slanted[index % 3] = zero;
        rays.push(Ray::new(at, slanted));
        rays.push(Ray::new(at - slanted * size, slanted));
        // Between two vertices: along edges and diagonals.
        let other = vertex(&mut random);
        rays.push(Ray::new(at, other - at));
        let from = center + random.vector() * size;
        rays.push(Ray::new(from, at - from));
        rays.push(Ray::new(from, at.midpoint(other) - from));
    }
    // At the middles of edges, and along a triangle's own edge.
    for _ in 0..300 {
        let Some(triangle) = triangles.get(random.below(triangles.len())) else { break };
        let [a, b, c] = triangle.triangle().vertices;
        let from = center + random.vector() * size;
        rays.push(Ray::new(from, a.midpoint(b) - from));
        rays.push(Ray::new(a - (b - a), b - a));
        rays.push(Ray::new((a + b + c) / 3.0, random.vector()));
        rays.push(Ray::new(c, (b - a).cross(c - a)));
    }
    // Whole numbers: they meet the lattice's planes exactly.
    for _ in 0..400 {
        let whole = |random: &mut Random| (random.vector() * 3.99).trunc();
        let origin = whole(&mut random) * 0.5;
        rays.push(Ray::new(origin, whole(&mut random)));
        rays.push(Ray::new(whole(&mut random), whole(&mut random) - origin));
    }
    // Directions of any length, origins far away and out of all proportion, a component that all but vanishes.
    for index in 0..300 {
        let origin = center + random.vector() * size * 2.0;
        let dir = center - origin + random.vector() * size * 0.3;
        let length = 10.0_f32.powi((index % 35) - 17);
        rays.push(Ray::new(origin, dir.normalize_or(Vec3::X) * length));
        let far = random.vector() * 10.0_f32.powi(index % 39);
        rays.push(Ray::new(center + far, -far));
        let mut slight = random.vector();
        slight[index as usize % 3] *= 10.0_f32.powi(-(index % 45));
        rays.push(Ray::new(origin, slight));
        rays.push(Ray::new(vertex(&mut random) - slight * size, slight));
    }

    if let Structure::KdTree(tree) = structure {
        rays.extend(in_planes(tree));
    }

    // Windows that begin and end exactly at a hit, a float before and a float behind it, and empty ones.
    let found = structure
        .trace(structure.kind().default_walk(), Query::Closest, &rays, TraceOptions::default())
        .expect("the CPU has this row");
    let ropewalk::Answer::Closest(hits) = found.answer else { panic!("closest was asked") };
    let hit_rays: Vec<(Ray, Hit)> =
        rays.iter().copied().zip(hits).filter(|(_, hit)| hit.is_hit() && hit.t.is_finite()).collect();
    for _ in 0..200 {
        let Some(&(ray, Hit { t, .. })) = hit_rays.get(random.below(hit_rays.len())) else { break };
        rays.push(ray.window(0.0, t));
        rays.push(ray.window(t, f32::INFINITY));
        rays.push(ray.window(t, t));
        rays.push(ray.window(0.0, t.next_down()));
        rays.push(ray.window(t.next_up(), f32::INFINITY));
        rays.push(ray.window(t * 0.5, t * 0.9));
        rays.push(ray.window(t * 2.0, t * 0.5));
        // Masks, and bits that do not count.
        rays.push(ray.with_mask(1 << random.below(10)));
        rays.push(ray.with_mask(0));
        rays.push(ray.with_mask(0xffff_ff00));
        // From the surface on, as a bounce does.
        rays.push(Ray::new(ray.at(t), random.vector()));
    }
    rays.extend(invalid());
    rays
}

/// Rays that may not be traced, and a few at the edge of what may.
pub(crate) fn invalid() -> Vec<Ray> {
    let good = Ray::new(Vec3::splat(0.25), Vec3::new(0.5, -1.0, 0.25));
    let mut rays = vec![
        Ray { dir: Vec3::ZERO, ..good },
        Ray { dir: Vec3::splat(-0.0), ..good },
        Ray { dir: Vec3::splat(1e-30), ..good },
        Ray { dir: Vec3::splat(1e30), ..good },
        Ray { dir: Vec3::splat(f32::from_bits(1)), ..good },
        Ray { t_min: -1.0, ..good },
        Ray { t_min: -f32::from_bits(1), ..good },
        Ray { t_min: f32::NEG_INFINITY, ..good },
        // Valid ones:
        Ray { t_min: -0.0, ..good },
        Ray { t_min: f32::INFINITY, ..good },
        Ray { t_max: f32::NEG_INFINITY, ..good },
        Ray { t_max: -1.0, ..good },
        Ray { dir: Vec3::X * ropewalk::SMALLEST_DIRECTION, ..good },
        Ray { dir: Vec3::X * ropewalk::LARGEST_DIRECTION, ..good },
        Ray { dir: Vec3::X * ropewalk::SMALLEST_DIRECTION.next_down(), ..good },
        Ray { dir: Vec3::X * ropewalk::LARGEST_DIRECTION.next_up(), ..good },
        Ray { origin: Vec3::splat(f32::MAX), ..good },
        Ray { origin: Vec3::splat(f32::from_bits(1)), dir: Vec3::X, ..good },
        Ray { origin: Vec3::new(0.0, -0.0, f32::from_bits(0x8000_0001)), dir: Vec3::Y, ..good },
    ];
    // Quiet, signalling and negative NaN, and the infinities, in every place.
    for bits in [0x7fc0_0000, 0x7f80_0001, 0xffff_ffff, 0x7f80_0000, 0xff80_0000] {
        let bad = f32::from_bits(bits);
        for axis in 0..3 {
            let mut ray = good;
            ray.dir[axis] = bad;
            rays.push(ray);
            let mut ray = good;
            ray.origin[axis] = bad;
            rays.push(ray);
        }
        rays.push(Ray { t_min: bad, ..good });
        rays.push(Ray { t_max: bad, ..good });
    }
    rays
}
