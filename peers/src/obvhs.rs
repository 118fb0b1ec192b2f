//! obvhs: a binary BVH and a compressed wide one, with triangles put in the order of the leaves, as its author advises.

use crate::flush::Flushed;
use obvhs::BvhBuildParams;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2_from_tris;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::builder::build_cwbvh_from_tris;
use obvhs::ray::RayHit;
use obvhs::rt_triangle::RtTriangle;
use obvhs::triangle::Triangle;
use ropewalk::{Hit, Ray};
use ropewalk_lab::arena::{Engine, EngineError, Grade, Mode, RaySet, Refitter, Shape, Tracer};
use std::ops::Range;
use std::time::Duration;

pub(crate) fn engines() -> Vec<Box<dyn Engine>> {
    let binary = |preset, grade, params| Box::new(Obvhs { preset, grade, params, is_wide: false });
    let wide = |preset, grade, params| Box::new(Obvhs { preset, grade, params, is_wide: true });
    vec![
        binary("bvh2 fastest", Grade::Fast, BvhBuildParams::fastest_build()),
        binary("bvh2 medium", Grade::Balanced, BvhBuildParams::medium_build()),
        binary("bvh2 very-slow", Grade::High, BvhBuildParams::very_slow_build()),
        wide("cwbvh medium", Grade::Compact, BvhBuildParams::medium_build()),
        wide("cwbvh very-slow", Grade::High, BvhBuildParams::very_slow_build()),
    ]
}

struct Obvhs {
    preset: &'static str,
    grade: Grade,
    params: BvhBuildParams,
    is_wide: bool,
}

impl Engine for Obvhs {
    fn name(&self) -> &str {
        "obvhs 0.4"
    }

    fn preset(&self) -> &str {
        self.preset
    }

    fn is_peer(&self) -> bool {
        true
    }

    fn grade(&self) -> Grade {
        self.grade
    }

    fn build(&self, shape: &Shape, _threads: usize) -> Result<Box<dyn Tracer>, EngineError> {
        let corners = shape.aligned_corners();
        let triangles: &[Triangle] = bytemuck::cast_slice(&corners);
        let mut unused = Duration::ZERO;
        Ok(if self.is_wide {
            let tree = build_cwbvh_from_tris(triangles, self.params, &mut unused);
            let leaves = Leaves::new(triangles, &tree.primitive_indices);
            Box::new(Wide { tree, leaves })
        } else {
            let tree = build_bvh2_from_tris(triangles, self.params, &mut unused);
            let leaves = Leaves::new(triangles, &tree.primitive_indices);
            Box::new(Binary { tree, leaves })
        })
    }

    fn refitter(&self, shape: &Shape, _threads: usize) -> Option<Result<Box<dyn Refitter>, EngineError>> {
        // With presplits a leaf holds a part of a triangle, and wide trees have no refit.
        if self.is_wide || self.params.pre_split {
            return None;
        }
        let mut unused = Duration::ZERO;
        let corners = shape.aligned_corners();
        let mut tree = build_bvh2_from_tris(bytemuck::cast_slice(&corners), self.params, &mut unused);
        tree.reorder_in_stack_traversal_order();
        Some(Ok(Box::new(Moving(tree))))
    }
}

/// Triangles in the order of the leaves, and which each is.
struct Leaves {
    triangles: Vec<RtTriangle>,
    names: Vec<u32>,
}

impl Leaves {
    fn new(triangles: &[Triangle], order: &[u32]) -> Self {
        let ordered = order.iter().map(|&index| RtTriangle::from(&triangles[index as usize])).collect();
        Self { triangles: ordered, names: order.to_vec() }
    }

    fn bytes(&self) -> usize {
        size_of_val(&self.triangles[..]) + size_of_val(&self.names[..])
    }

    fn hit(&self, hit: &RayHit) -> Hit {
        match self.names.get(hit.primitive_id as usize) {
            Some(&primitive_index) => {
                Hit { t: hit.t, primitive_index, geometry_index: 0, instance_index: 0, ..Hit::MISS }
            }
            None => Hit::MISS,
        }
    }
}

fn peer_ray(ray: &Ray) -> obvhs::ray::Ray {
    obvhs::ray::Ray::new(ray.origin.into(), ray.dir.into(), ray.t_min, ray.t_max)
}

struct Binary {
    tree: Bvh2,
    leaves: Leaves,
}

struct Wide {
    tree: CwBvh,
    leaves: Leaves,
}

macro_rules! tracer {
    ($type:ty) => {
        impl Tracer for $type {
            fn bytes(&self) -> Option<usize> {
                Some(size_of_val(&self.tree.nodes[..]) + self.leaves.bytes())
            }

            fn modes(&self) -> &[Mode] {
                &[Mode::Single]
            }

            fn closest(&self, _: Mode, rays: &RaySet, range: Range<usize>, hits: &mut [Hit]) {
                let _flushed = Flushed::new();
                let leaves = &self.leaves;
                for (ray, out) in rays.rays[range].iter().zip(hits) {
                    let mut hit = RayHit::none();
                    self.tree
                        .ray_traverse(peer_ray(ray), &mut hit, |ray, at| leaves.triangles[at].intersect(ray));
                    *out = leaves.hit(&hit);
                }
            }

            fn any(&self, _: Mode, rays: &RaySet, range: Range<usize>, hits: &mut [bool]) {
                let _flushed = Flushed::new();
                let leaves = &self.leaves;
                for (ray, out) in rays.rays[range].iter().zip(hits) {
                    *out = !self
                        .tree
                        .ray_traverse_miss(peer_ray(ray), |ray, at| leaves.triangles[at].intersect(ray));
                }
            }
        }
    };
}

tracer!(Binary);
tracer!(Wide);

struct Moving(Bvh2);

impl Refitter for Moving {
    fn refit(&mut self, moved: &Shape) -> Result<(), EngineError> {
        let corners = moved.aligned_corners();
        let triangles: &[Triangle] = bytemuck::cast_slice(&corners);
        let Bvh2 { nodes, primitive_indices, .. } = &mut self.0;
        for node in nodes.iter_mut().filter(|node| node.is_leaf()) {
            let first = node.first_index as usize;
            let places = &primitive_indices[first..first + node.prim_count as usize];
            let boxes = places.iter().map(|&index| triangles[index as usize].aabb());
            let Some(bounds) = boxes.reduce(|a, b| a.union(&b)) else { continue };
            node.set_aabb(bounds);
        }
        self.0.refit_all();
        Ok(())
    }
}
