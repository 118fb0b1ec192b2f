//! The crate bvh. Its own triangle test culls back faces, so the triangles here bring a two-sided one (Moeller and Trumbore
//! 1997); its tree is walked by its iterator that visits the nearer child first.

use crate::flush::Flushed;
use bvh::aabb::{Aabb, Bounded};
use bvh::bounding_hierarchy::{BHShape, BoundingHierarchy};
use bvh::bvh::{Bvh, BvhNode};
use nalgebra::{Point3, Vector3};
use ropewalk::glam::Vec3;
use ropewalk::{Hit, Ray};
use ropewalk_lab::arena::{Engine, EngineError, Grade, Mode, RaySet, Shape, Tracer};
use std::ops::Range;

pub(crate) fn engines() -> Vec<Box<dyn Engine>> {
    vec![Box::new(BvhCrate)]
}

struct BvhCrate;

impl Engine for BvhCrate {
    fn name(&self) -> &str {
        "bvh 0.13"
    }

    fn preset(&self) -> &str {
        "default"
    }

    fn is_peer(&self) -> bool {
        true
    }

    fn grade(&self) -> Grade {
        Grade::Balanced
    }

    fn build(&self, shape: &Shape, threads: usize) -> Result<Box<dyn Tracer>, EngineError> {
        let mut triangles: Vec<Triangle> = shape
            .corners()
            .enumerate()
            .map(|(index, [a, b, c])| Triangle { a, b, c, index: index as u32, node: 0 })
            .collect();
        let tree = match threads {
            1 => Bvh::build(&mut triangles),
            _ => Bvh::build_par(&mut triangles),
        };
        Ok(Box::new(Built { tree, triangles }))
    }
}

struct Triangle {
    a: Vec3,
    b: Vec3,
    c: Vec3,
    index: u32,
    node: usize,
}

impl Bounded<f32, 3> for Triangle {
    fn aabb(&self) -> Aabb<f32, 3> {
        let (low, high) = (self.a.min(self.b).min(self.c), self.a.max(self.b).max(self.c));
        Aabb::with_bounds(Point3::new(low.x, low.y, low.z), Point3::new(high.x, high.y, high.z))
    }
}

impl BHShape<f32, 3> for Triangle {
    fn set_bh_node_index(&mut self, node: usize) {
        self.node = node;
    }

    fn bh_node_index(&self) -> usize {
        self.node
    }
}

impl Triangle {
    /// `t` and the barycentrics, two-sided, within `(t_min, t_max)`.
    #[inline]
    fn intersect(&self, ray: &Ray, t_max: f32) -> Option<(f32, f32, f32)> {
        let (ab, ac) = (self.b - self.a, self.c - self.a);
        let across = ray.dir.cross(ac);
        let determinant = ab.dot(across);
        if determinant == 0.0 {
            return None;
        }
        let inverse = 1.0 / determinant;
        let from = ray.origin - self.a;
        let u = from.dot(across) * inverse;
        let turned = from.cross(ab);
        let v = ray.dir.dot(turned) * inverse;
        let t = ac.dot(turned) * inverse;
        (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t >= ray.t_min && t < t_max).then_some((t, u, v))
    }
}

struct Built {
    tree: Bvh<f32, 3>,
    triangles: Vec<Triangle>,
}

fn peer_ray(ray: &Ray) -> bvh::ray::Ray<f32, 3> {
    let dir = Vector3::new(ray.dir.x, ray.dir.y, ray.dir.z);
    // By hand: the constructor would normalise the direction once more.
    bvh::ray::Ray {
        origin: Point3::new(ray.origin.x, ray.origin.y, ray.origin.z),
        direction: dir,
        inv_direction: dir.map(|x| 1.0 / x),
    }
}

impl Tracer for Built {
    fn bytes(&self) -> Option<usize> {
        Some(self.tree.nodes.len() * size_of::<BvhNode<f32, 3>>() + size_of_val(&self.triangles[..]))
    }

    fn modes(&self) -> &[Mode] {
        &[Mode::Single]
    }

    fn closest(&self, _: Mode, rays: &RaySet, range: Range<usize>, hits: &mut [Hit]) {
        let _flushed = Flushed::new();
        for (ray, out) in rays.rays[range].iter().zip(hits) {
            let peer = peer_ray(ray);
            let mut best = Hit::MISS;
            let mut limit = ray.t_max;
            for triangle in self.tree.nearest_child_traverse_iterator(&peer, &self.triangles) {
                if let Some((t, u, v)) = triangle.intersect(ray, limit) {
                    limit = t;
                    best = Hit {
                        t,
                        barycentrics: ropewalk::glam::Vec2::new(u, v),
                        primitive_index: triangle.index,
                        geometry_index: 0,
                        instance_index: 0,
                        front_face: false,
                    };
                }
            }
            *out = best;
        }
    }

    fn any(&self, _: Mode, rays: &RaySet, range: Range<usize>, hits: &mut [bool]) {
        let _flushed = Flushed::new();
        for (ray, out) in rays.rays[range].iter().zip(hits) {
            let peer = peer_ray(ray);
            *out = self
                .tree
                .traverse_iterator(&peer, &self.triangles)
                .any(|triangle| triangle.intersect(ray, ray.t_max).is_some());
        }
    }
}
