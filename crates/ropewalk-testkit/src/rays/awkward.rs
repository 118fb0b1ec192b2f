//! The rays that find mistakes.

use super::{Closest, RayClass, RayMaker, towards};
use crate::random::Random;
use glam::{DVec3, Vec3};
use ropewalk::{Hit, LARGEST_DIRECTION, Ray, SMALLEST_DIRECTION};

impl RayMaker<'_> {
    pub(super) fn awkward(&self, class: RayClass, count: usize, closest: &Closest<'_>) -> Vec<Ray> {
        let random = &mut self.random(class);
        match class {
            RayClass::Windows => return self.windows(count, random, closest),
            RayClass::OnSurface => return self.on_surface(count, random, closest),
            _ => {}
        }
        (0..count)
            .map(|index| match class {
                RayClass::AxisAligned => self.axis_aligned(random),
                RayClass::Vertices => towards(self.around(random), self.vertex(random)),
                RayClass::Edges => towards(self.around(random), self.on_edge(random)),
                RayClass::Planes => self.in_plane(random),
                RayClass::ZeroComponents => self.zero_components(random),
                RayClass::Lengths => {
                    let ray = self.aimed(random);
                    let length = 10f64.powi(index as i32 % 25 - 12);
                    let dir = ray.dir.as_dvec3().try_normalize().unwrap_or(DVec3::X);
                    Ray { dir: (dir * length).as_vec3(), ..ray }
                }
                RayClass::Masks => {
                    let masks = [0, 1, 2, 4, 0x80, 0xff, 0x100, 0xffff_ff00, 0x101, random.bits()];
                    self.aimed(random).with_mask(masks[index % masks.len()])
                }
                RayClass::Invalid => self.invalid(index, random),
                _ => Ray::new(self.around(random).as_vec3(), random.direction().as_vec3()),
            })
            .map(|ray| match class {
                RayClass::Invalid => ray,
                // A target in the very origin leaves no direction; another one is as good.
                _ if ray.is_valid() => ray,
                _ => Ray { dir: Vec3::X, ..ray },
            })
            .collect()
    }

    /// `count` rays from around `inside`, within `reach` of it, at edges, vertices and (one in four) anywhere. A
    /// closed mesh that contains that ball lets none escape.
    #[must_use]
    pub fn rays_from_inside(&self, inside: DVec3, reach: f64, count: usize) -> Vec<Ray> {
        let mut random = self.random(RayClass::Inside);
        (0..count)
            .map(|_| {
                let (from, target) = self.point_and_target(inside, reach, &mut random);
                towards(from, target)
            })
            .collect()
    }

    /// `count` rays from far outside through edges, vertices and (one in four) anywhere into the ball of radius `reach`
    /// about `inside`. A closed mesh that contains that ball lets none in unseen, and where its fronts are outside, each
    /// meets a front.
    #[must_use]
    pub fn rays_from_outside(&self, inside: DVec3, reach: f64, count: usize) -> Vec<Ray> {
        let mut random = self.random(RayClass::Outside);
        let far = 2.0 * self.diagonal();
        (0..count)
            .map(|_| {
                let (into, target) = self.point_and_target(inside, reach, &mut random);
                let outwards = (target - into).try_normalize().unwrap_or(DVec3::X);
                towards(target + outwards * far, into)
            })
            .collect()
    }

    /// A point of a ball, and what is looked at from there.
    fn point_and_target(&self, inside: DVec3, reach: f64, random: &mut Random) -> (DVec3, DVec3) {
        let from = inside + random.in_cube() * (reach * 0.57);
        let target = match random.below(8) {
            0 | 1 => from + random.direction(),
            2 | 3 => self.vertex(random),
            _ => self.on_edge(random),
        };
        (from, target)
    }

    fn around(&self, random: &mut Random) -> DVec3 {
        // A flat scene is seen from outside of its plane too.
        let center = self.bounds.center().as_dvec3();
        let half = (self.bounds.max.as_dvec3() - center).max(DVec3::splat(self.diagonal() * 0.2));
        center + random.in_cube() * half * 1.6
    }

    fn corners(&self, random: &mut Random) -> [DVec3; 3] {
        match self.triangles.get(random.below(self.triangles.len())) {
            Some(triangle) => triangle.triangle().vertices.map(Vec3::as_dvec3),
            None => [self.bounds.min.as_dvec3(), self.bounds.max.as_dvec3(), DVec3::ZERO],
        }
    }

    fn vertex(&self, random: &mut Random) -> DVec3 {
        let corners = self.corners(random);
        random.pick(&corners)
    }

    fn on_edge(&self, random: &mut Random) -> DVec3 {
        let corners = self.corners(random);
        let first = random.below(3);
        let (from, to) = (corners[first], corners[(first + 1) % 3]);
        // Sixteenths are exact in f32 on many edges; the others are as near as f32 gets.
        let along = if random.one_in(2) { random.below(17) as f64 / 16.0 } else { random.unit() };
        from + (to - from) * along
    }

    fn in_triangle(&self, random: &mut Random) -> DVec3 {
        let [a, b, c] = self.corners(random);
        let (mut u, mut v) = (random.unit(), random.unit());
        if u + v > 1.0 {
            (u, v) = (1.0 - u, 1.0 - v);
        }
        a + (b - a) * u + (c - a) * v
    }

    /// A ray at a random point of a random triangle.
    fn aimed(&self, random: &mut Random) -> Ray {
        towards(self.around(random), self.in_triangle(random))
    }

    fn axis_aligned(&self, random: &mut Random) -> Ray {
        let axis = random.below(3);
        let mut origin = self.around(random);
        for other in [(axis + 1) % 3, (axis + 2) % 3] {
            if !random.one_in(3) {
                origin[other] = self.vertex(random)[other];
            }
        }
        let mut dir = Vec3::splat(random.pick(&[0.0, -0.0]));
        dir[axis] = random.pick(&[1.0, -1.0, 0.3, -7.0]);
        Ray::new(origin.as_vec3(), dir)
    }

    fn in_plane(&self, random: &mut Random) -> Ray {
        let corners = self.corners(random);
        if random.one_in(3) {
            // In the plane of the triangle, as nearly as f32 allows.
            let (along, across) = (corners[1] - corners[0], corners[2] - corners[0]);
            let mut place = || along * random.between(-1.5, 1.5) + across * random.between(-1.5, 1.5);
            let (from, to) = (corners[0] + place(), corners[0] + place());
            return towards(from, to);
        }
        // In a plane across an axis: that of a vertex, where a flat triangle or its box has its face.
        let axis = random.below(3);
        let plane = random.pick(&corners)[axis];
        let (mut from, mut to) = (self.around(random), self.around(random));
        if random.one_in(2) {
            to = self.vertex(random);
        }
        (from[axis], to[axis]) = (plane, plane);
        let mut ray = towards(from, to);
        ray.dir[axis] = random.pick(&[0.0, -0.0]);
        ray
    }

    fn zero_components(&self, random: &mut Random) -> Ray {
        const TINY: [f32; 9] = [
            0.0,
            -0.0,
            f32::from_bits(1),
            -f32::from_bits(1),
            1e-40,
            -1e-39,
            f32::MIN_POSITIVE,
            1e-30,
            -1e-22,
        ];
        let mut ray = self.aimed(random);
        let axis = random.below(3);
        ray.dir[axis] = random.pick(&TINY);
        if random.one_in(2) {
            ray.dir[(axis + 1) % 3] = random.pick(&TINY);
        }
        if random.one_in(2) {
            ray.origin[axis] = self.vertex(random)[axis] as f32;
        }
        if ray.dir.abs().max_element() < SMALLEST_DIRECTION {
            ray.dir[(axis + 2) % 3] = 1.0;
        }
        ray
    }

    fn windows(&self, count: usize, random: &mut Random, closest: &Closest<'_>) -> Vec<Ray> {
        let rays: Vec<Ray> = (0..count).map(|_| valid(self.aimed(random))).collect();
        let hits = closest(&rays);
        let ends = rays.iter().zip(&hits).enumerate();
        ends.map(|(index, (ray, hit))| {
            let t = if hit.is_hit() { hit.t.max(0.0) } else { 1.0 };
            match index % 16 {
                0 => ray.window(0.0, t),
                1 => ray.window(0.0, t.next_down()),
                2 => ray.window(0.0, t.next_up()),
                3 => ray.window(t, f32::INFINITY),
                4 => ray.window(t.next_up(), f32::INFINITY),
                5 => ray.window(t.next_down().max(0.0), f32::INFINITY),
                6 => ray.window(t, t),
                7 => ray.window(t * 1.5, t * 0.5),
                8 => ray.window(0.0, 0.0),
                9 => ray.window(0.0, -1.0),
                10 => ray.window(-0.0, t * 2.0),
                11 => ray.window(f32::INFINITY, f32::INFINITY),
                12 => ray.window(0.0, f32::MAX),
                13 => ray.window(0.0, f32::NEG_INFINITY),
                14 => ray.window(t * 0.5, t * 1.5),
                _ => ray.window(t * 1.01, t * 3.0),
            }
        })
        .collect()
    }

    fn on_surface(&self, count: usize, random: &mut Random, closest: &Closest<'_>) -> Vec<Ray> {
        let rays: Vec<Ray> = (0..count).map(|_| valid(self.aimed(random))).collect();
        let hits = closest(&rays);
        let mut starts = |ray: &Ray, hit: &Hit| match random.below(3) {
            0 => (self.vertex(random).as_vec3(), random.direction().as_vec3()),
            1 => {
                let axis = random.pick(&[Vec3::X, Vec3::Y, Vec3::Z]);
                (self.in_triangle(random).as_vec3(), axis * random.pick(&[1.0, -1.0]))
            }
            _ if hit.is_hit() => (ray.at(hit.t), random.direction().as_vec3()),
            _ => (self.on_edge(random).as_vec3(), random.direction().as_vec3()),
        };
        rays.iter().zip(&hits).map(|(ray, hit)| starts(ray, hit)).map(|(o, dir)| Ray::new(o, dir)).collect()
    }

    fn invalid(&self, index: usize, random: &mut Random) -> Ray {
        let good = valid(self.aimed(random));
        let axis = random.below(3);
        let with = |mut vector: Vec3, value: f32| {
            vector[axis] = value;
            vector
        };
        match index % 16 {
            0 => Ray { dir: Vec3::ZERO, ..good },
            1 => Ray { dir: -Vec3::ZERO, ..good },
            2 => Ray { dir: with(good.dir, f32::NAN), ..good },
            3 => Ray { dir: with(good.dir, f32::INFINITY), ..good },
            4 => Ray { dir: with(good.dir, f32::NEG_INFINITY), ..good },
            5 => Ray { dir: Vec3::splat(SMALLEST_DIRECTION.next_down()), ..good },
            6 => Ray { dir: with(good.dir, LARGEST_DIRECTION.next_up()), ..good },
            7 => Ray { dir: Vec3::splat(f32::from_bits(1)), ..good },
            8 => Ray { origin: with(good.origin, f32::NAN), ..good },
            9 => Ray { origin: with(good.origin, f32::INFINITY), ..good },
            10 => Ray { t_min: -1.0, ..good },
            11 => Ray { t_min: f32::NAN, ..good },
            12 => Ray { t_max: f32::NAN, ..good },
            13 => Ray { t_min: -f32::from_bits(1), ..good },
            14 => Ray { t_min: f32::NEG_INFINITY, ..good },
            _ => Ray { dir: Vec3::splat(f32::NAN), origin: Vec3::splat(f32::NAN), ..good },
        }
    }
}

fn valid(ray: Ray) -> Ray {
    if ray.is_valid() { ray } else { Ray { dir: Vec3::X, ..ray } }
}
