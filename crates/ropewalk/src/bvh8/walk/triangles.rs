//! The test of a leaf's triangles, all at once, at any level.
//!
//! The operations of the scalar test ([`crate::triangle`]) in its order, without fused ones: each lane computes the very same numbers,
//! so that hits are those of every other structure, bit for bit. Most leaves end behind the edges.

use super::boxes::splat;
use crate::PreparedRay;
use crate::aabb::{PAD_ENTRY, PAD_EXIT};
use crate::bvh8::leaf::Triangles;
use crate::bvh8::simd::Level;
use crate::bvh8::tree::WIDTH;
use crate::triangle::{Crossing, permute};

/// Which triangles of a leaf a ray crosses, and where.
pub(super) struct Crossings {
    /// A bit a triangle.
    pub(super) lanes: u32,
    t: [f32; WIDTH],
    v: [f32; WIDTH],
    w: [f32; WIDTH],
    /// A bit a triangle.
    seen_from_front: u32,
}

impl Crossings {
    #[inline(always)]
    pub(super) fn get(&self, triangle: usize) -> Crossing {
        let lane = triangle % WIDTH;
        Crossing {
            t: self.t[lane],
            v: self.v[lane],
            w: self.w[lane],
            seen_from_front: self.seen_from_front >> lane & 1 != 0,
        }
    }
}

/// Vertices, or whatever else has three coordinates, in eight lanes, in the ray's order of axes.
pub(super) type Triple<L> = [<L as Level>::Floats; 3];

/// A ray in all lanes, or eight rays that share their order of axes.
pub(super) struct RayLanes<L: Level> {
    pub(super) origin: Triple<L>,
    pub(super) shears: Triple<L>,
    pub(super) low: Triple<L>,
    pub(super) high: Triple<L>,
    pub(super) inverse: Triple<L>,
    pub(super) t_min: L::Floats,
    pub(super) t_max: L::Floats,
    pub(super) forward: bool,
}

/// Where a ray crosses the triangles of a leaf within `[t_min, t_max]`, ends included; `None` where it crosses none.
///
/// # Safety
/// The leaf is one of an arena.
#[inline(always)]
pub(super) unsafe fn cross<L: Level, T: Triangles>(
    level: L,
    leaf: T,
    ray: &PreparedRay,
    t_max: f32,
) -> Option<Crossings> {
    // SAFETY: the caller's; a ray's axes are 0, 1 and 2.
    let vertices = unsafe { leaf.corners(level, ray.axes) };
    let (origin, shears) = (splat(level, &permute(ray, &ray.origin)), splat(level, &ray.shear));
    let edges = Edges::new(level, &vertices, &origin, &shears);
    let possible = edges.possible(level) & leaf.lanes();
    if possible == 0 {
        return None;
    }
    let lanes = RayLanes {
        origin,
        shears,
        low: splat(level, &in_order(ray, ray.origin_low.as_ref())),
        high: splat(level, &in_order(ray, ray.origin_high.as_ref())),
        inverse: splat(level, &in_order(ray, ray.inverse.as_ref())),
        t_min: level.splat(ray.t_min),
        t_max: level.splat(t_max),
        forward: ray.forward,
    };
    edges.settle(level, &vertices, &lanes, possible)
}

/// The edge functions of triangles, and how high their vertices lie along the ray.
pub(super) struct Edges<L: Level> {
    u: L::Floats,
    v: L::Floats,
    w: L::Floats,
    heights: Triple<L>,
}

impl<L: Level> Edges<L> {
    #[inline(always)]
    pub(super) fn new(level: L, vertices: &[Triple<L>; 3], origin: &Triple<L>, shears: &Triple<L>) -> Self {
        let a = shear(level, &vertices[0], origin, shears);
        let b = shear(level, &vertices[1], origin, shears);
        let c = shear(level, &vertices[2], origin, shears);
        Self {
            u: edge(level, &c, &b),
            v: edge(level, &a, &c),
            w: edge(level, &b, &a),
            heights: [a[2], b[2], c[2]],
        }
    }

    /// In which lanes the ray is not outside: a bit a lane.
    #[inline(always)]
    pub(super) fn possible(&self, level: L) -> u32 {
        let (u, v, w, zero) = (self.u, self.v, self.w, level.splat(0.0));
        let negative =
            level.either(level.either(level.less(u, zero), level.less(v, zero)), level.less(w, zero));
        let positive =
            level.either(level.either(level.less(zero, u), level.less(zero, v)), level.less(zero, w));
        !level.bits(level.both(negative, positive))
    }

    /// The rest of the test, for the lanes that are possible.
    #[inline(always)]
    pub(super) fn settle(
        &self,
        level: L,
        vertices: &[Triple<L>; 3],
        ray: &RayLanes<L>,
        possible: u32,
    ) -> Option<Crossings> {
        let (u, v, w, zero) = (self.u, self.v, self.w, level.splat(0.0));
        let determinant = level.add(level.add(u, v), w);
        let flat = level.less(magnitude(level, determinant), level.splat(f32::MIN_POSITIVE));
        let scale = level.div(level.splat(1.0), determinant);
        let depth = depth(level, vertices, ray, [u, v, w], &self.heights, scale);
        let (entry, exit) = span(level, vertices, ray);
        let t = level.mul(depth, ray.shears[2]);
        // Plus zero, as in the scalar test: of -0 and 0 either may come.
        let t = level.add(level.smaller(level.larger(t, entry), exit), zero);
        let inside = level.both(
            level.at_most(level.larger(entry, ray.t_min), exit),
            level.both(level.at_most(ray.t_min, t), level.at_most(t, ray.t_max)),
        );
        let lanes = level.bits(level.both(inside, finite(level, depth))) & !level.bits(flat) & possible;
        if lanes == 0 {
            return None;
        }
        let counter_clockwise = level.bits(level.less(zero, determinant));
        Some(Crossings {
            lanes,
            t: level.numbers(t),
            v: level.numbers(level.add(level.mul(v, scale), zero)),
            w: level.numbers(level.add(level.mul(w, scale), zero)),
            seen_from_front: if ray.forward { counter_clockwise } else { !counter_clockwise },
        })
    }
}

/// How far along the axis `kz` rays meet the planes; by the weights where they run in them.
#[inline(always)]
fn depth<L: Level>(
    level: L,
    vertices: &[Triple<L>; 3],
    ray: &RayLanes<L>,
    weights: Triple<L>,
    heights: &Triple<L>,
    scale: L::Floats,
) -> L::Floats {
    let (distance, normal) = plane(level, vertices, &ray.origin);
    let slope = level
        .add(level.add(level.mul(normal[0], ray.shears[0]), level.mul(normal[1], ray.shears[1])), normal[2]);
    let steep = level.div(distance, slope);
    let interpolated = level.mul(dot(level, &weights, heights), scale);
    level.select(finite(level, steep), steep, interpolated)
}

/// Where rays enter and leave the triangles' own boxes, padded.
#[inline(always)]
fn span<L: Level>(level: L, vertices: &[Triple<L>; 3], ray: &RayLanes<L>) -> (L::Floats, L::Floats) {
    let [first, second, third] = vertices;
    let (mut near, mut far) = (*first, *first);
    for axis in 0..3 {
        let least = level.smaller(level.smaller(first[axis], second[axis]), third[axis]);
        let most = level.larger(level.larger(first[axis], second[axis]), third[axis]);
        let least = level.mul(level.sub(least, ray.low[axis]), ray.inverse[axis]);
        let most = level.mul(level.sub(most, ray.high[axis]), ray.inverse[axis]);
        near[axis] = level.smaller(least, most);
        far[axis] = level.larger(least, most);
    }
    (
        level.mul(level.larger(level.larger(near[0], near[1]), near[2]), level.splat(PAD_ENTRY)),
        level.mul(level.smaller(level.smaller(far[0], far[1]), far[2]), level.splat(PAD_EXIT)),
    )
}

/// Numbers of x, y and z in the ray's order of axes.
#[inline(always)]
fn in_order(ray: &PreparedRay, numbers: &[f32; 4]) -> [f32; 3] {
    // The mask lets the compiler see that the index is in range.
    let [x, y, z] = ray.axes;
    [numbers[usize::from(x & 3)], numbers[usize::from(y & 3)], numbers[usize::from(z & 3)]]
}

/// Vertices in the space in which the ray is the z axis.
#[inline(always)]
fn shear<L: Level>(level: L, vertex: &Triple<L>, origin: &Triple<L>, shears: &Triple<L>) -> Triple<L> {
    let x = level.sub(vertex[0], origin[0]);
    let y = level.sub(vertex[1], origin[1]);
    let z = level.sub(vertex[2], origin[2]);
    [level.sub(x, level.mul(shears[0], z)), level.sub(y, level.mul(shears[1], z)), z]
}

#[inline(always)]
fn edge<L: Level>(level: L, p: &Triple<L>, q: &Triple<L>) -> L::Floats {
    level.sub(level.mul(p[0], q[1]), level.mul(p[1], q[0]))
}

/// The distance of the triangles' planes from the origin along their normals, and the normals.
#[inline(always)]
fn plane<L: Level>(level: L, [a, b, c]: &[Triple<L>; 3], origin: &Triple<L>) -> (L::Floats, Triple<L>) {
    let (ab, bc, ca) = (minus(level, b, a), minus(level, c, b), minus(level, a, c));
    let (ab_length, bc_length, ca_length) =
        (dot(level, &ab, &ab), dot(level, &bc, &bc), dot(level, &ca, &ca));
    let ab_longest = level.both(level.at_most(bc_length, ab_length), level.at_most(ca_length, ab_length));
    let bc_longer = level.at_most(ca_length, bc_length);
    // The two shorter edges.
    let mut p = [ab_length; 3];
    let mut q = [ab_length; 3];
    for axis in 0..3 {
        let (other_p, other_q) =
            (level.select(bc_longer, ca[axis], ab[axis]), level.select(bc_longer, ab[axis], bc[axis]));
        p[axis] = level.select(ab_longest, bc[axis], other_p);
        q[axis] = level.select(ab_longest, ca[axis], other_q);
    }
    let normal = [
        level.sub(level.mul(p[1], q[2]), level.mul(q[1], p[2])),
        level.sub(level.mul(p[2], q[0]), level.mul(q[2], p[0])),
        level.sub(level.mul(p[0], q[1]), level.mul(q[0], p[1])),
    ];
    let distance = dot(level, &normal, &minus(level, a, origin));
    (distance, normal)
}

#[inline(always)]
fn minus<L: Level>(level: L, a: &Triple<L>, b: &Triple<L>) -> Triple<L> {
    [level.sub(a[0], b[0]), level.sub(a[1], b[1]), level.sub(a[2], b[2])]
}

#[inline(always)]
fn dot<L: Level>(level: L, a: &Triple<L>, b: &Triple<L>) -> L::Floats {
    level.add(level.add(level.mul(a[0], b[0]), level.mul(a[1], b[1])), level.mul(a[2], b[2]))
}

#[inline(always)]
fn magnitude<L: Level>(level: L, floats: L::Floats) -> L::Floats {
    level.larger(floats, level.sub(level.splat(0.0), floats))
}

#[inline(always)]
fn finite<L: Level>(level: L, floats: L::Floats) -> L::Mask {
    level.at_most(magnitude(level, floats), level.splat(f32::MAX))
}
