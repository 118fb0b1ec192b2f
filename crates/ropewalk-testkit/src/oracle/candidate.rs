//! A triangle that a ray hits or almost hits, and what f32 may make of it.

use super::frame::{FLUSHED, RayFrame, Sheared};
use super::{Corners, Name};
use glam::{DVec2, DVec3};
use ropewalk::Hit;

/// Beyond this a f32 product may overflow.
const OVERFLOW: f64 = 1e38;
/// Below this a determinant has lost bits to the smallest f32, or is flushed to zero.
const UNDERFLOW: f64 = FLUSHED * 1e4;

/// A triangle that a ray hits or almost hits.
///
/// **The bounds.** `e` is half a unit in the last place of a f32, 2^-24 relative. A sheared coordinate
/// `x - s * z` has five roundings and errs by at most `e * (2|x| + 4|s z|)`, with `x` and `z` measured from the
/// ray's origin: so the bounds grow with the distance of the geometry from the origin, not with its coordinates.
/// An edge function, a difference of two products of them, errs by what its factors err plus two roundings: the
/// *edge bound*. A triangle is certain to be hit when all edge functions have one sign by more than their bounds,
/// and certain to be missed when two have opposite signs by more than them. Between that lie edges, vertices and
/// grazes, where either answer is right.
///
/// `t` is the distance of the triangle's plane over its slope; how far both err is worked out at `plane_error`. An
/// interpolation of the vertices' depths would not do: of a needle it errs by a share of its length. Where the
/// slope is lost in its error, in a graze, any value between the ray's entry into the triangle's own padded box and
/// its exit may be reported, for the contract keeps `t` there. A ray that passes by that box misses the triangle,
/// however the edge functions are rounded.
///
/// **One side.** Which side a ray meets is told by two signs, that of the sum of the edge functions and that of the slope of
/// the plane; see [`Candidate::facing_margin`]. A triangle of one side is hit where both show the front.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Candidate {
    /// The index of the triangle in the flattened scene.
    pub triangle: u32,
    /// Instance, geometry, primitive.
    pub id: (u32, u32, u32),
    /// The first triangle of the scene with exactly the same vertices in the same order and the same side as its front: two
    /// candidates of one shape have the same `t` to the bit, and show the same side.
    pub shape: u32,
    /// Where the ray meets the triangle's plane, in f64; the middle of the triangle's range in a graze.
    pub t: f64,
    /// The weights of the second and third vertex, in f64.
    pub barycentrics: DVec2,
    /// Whether the front is met.
    pub front_face: bool,
    /// The least `t` that f32 may report.
    pub t_low: f64,
    /// The greatest `t` that f32 may report.
    pub t_high: f64,
    /// Whether f32 loses `t` as a whole, in a graze or in numbers that are too small: then it may report any `t` at which
    /// the ray is in the triangle's own box, be the triangle behind the ray's origin.
    pub t_is_lost: bool,
    /// How far f32 barycentrics may lie from these; infinite in a graze.
    pub barycentric_error: f64,
    /// The smallest edge function in units of its bound, negative outside. Above 1 the ray passes inside.
    pub edge_margin: f64,
    /// The determinant in units of its bound. Above 1 the side is certain.
    pub side_margin: f64,
    /// How surely the front is met: above 1 it is, below -1 it is not, and between that f32 may see either side or, of a
    /// triangle of one side, none. It is the lesser of the determinant and the slope of the plane, each in units of its
    /// bound, positive where the front shows.
    pub facing_margin: f64,
    /// Whether only a hit of the front counts.
    pub one_sided: bool,
    /// How far the range of `t` lies inside the window, in units of `t`; negative when an end cuts it.
    pub window_margin: f64,
    /// Whether f32 may overflow, underflow or lose the ray in a parallel slab, so that nothing is certain.
    pub out_of_range: bool,
}

impl Candidate {
    pub(super) fn new(frame: &RayFrame, corners: &Corners, name: &Name, triangle: u32) -> Option<Self> {
        let [a, b, c] = corners.map(|corner| frame.shear(corner));
        let edges = [edge(frame, c, b), edge(frame, a, c), edge(frame, b, a)];
        let inside = |(value, error): (f64, f64)| value / error;
        let (least, most) = edges
            .map(inside)
            .into_iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |m, x| (m.0.min(x), m.1.max(x)));
        if least < -1.0 && most > 1.0 {
            return None;
        }
        let weights = edges.map(|edge| edge.0);
        let errors = edges.map(|edge| edge.1);
        let sum: f64 = weights.iter().sum();
        let size: f64 = weights.iter().map(|weight| weight.abs()).sum();
        let sum_error = errors.iter().sum::<f64>() * (1.0 + 2.0 * frame.unit) + 2.0 * frame.unit * size;
        let depths = [a.z, b.z, c.z];
        let deepest = depths.iter().fold(0.0f64, |deepest, z| deepest.max(z.abs()));
        let rounding = 12.0 * frame.unit * deepest + frame.shift * frame.shear.z.abs() + FLUSHED;
        let range = depths.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |m, &z| (m.0.min(z), m.1.max(z)));
        let range = match frame.spread > 0.0 {
            // The axes of the box are others than the ray's.
            true => (f64::NEG_INFINITY, f64::INFINITY),
            false => (range.0 - rounding, range.1 + rounding),
        };

        let sure = sum.abs() - sum_error;
        let (mut t, mut t_error, mut barycentric_error) =
            ((depths[0] + depths[1] + depths[2]) / 3.0, f64::INFINITY, f64::INFINITY);
        let mut barycentrics = DVec2::new(1.0 / 3.0, 1.0 / 3.0);
        if sure > 0.0 {
            t = (0..3).map(|i| weights[i] * depths[i]).sum::<f64>() / sum;
            t_error = plane_error(frame, corners, t) + FLUSHED;
            barycentrics = DVec2::new(weights[1], weights[2]) / sum;
            let largest_error = errors[0].max(errors[1]).max(errors[2]);
            barycentric_error = (largest_error + sum_error) / sure + 6.0 * frame.unit;
        }
        let (low, high) = frame.around(corners);
        let (entry, exit) = frame.span(low, high)?;
        let determinant = size + sum_error;
        let underflows = determinant < UNDERFLOW;
        let overflows = overflows(frame, &[a, b, c], determinant, deepest / frame.shear.z.abs());
        let (mut t_low, mut t_high) = (range.0.max(t - t_error), range.1.min(t + t_error));
        if underflows || t_error.is_infinite() {
            (t_low, t_high) = (f64::NEG_INFINITY, f64::INFINITY);
        }
        // Kept within the ray's stay in the triangle's own box, whatever was computed.
        (t_low, t_high) = (t_low.min(exit).max(entry), t_high.max(entry).min(exit));
        if overflows {
            (t_low, t_high) = (f64::NEG_INFINITY, f64::INFINITY);
        }
        let front_face = ((sum > 0.0) == (frame.dir[frame.axes[2]] > 0.0)) != name.mirrored;
        let side_margin = sum.abs() / sum_error;
        let facing_margin = if underflows || overflows {
            0.0
        } else {
            let side = if front_face { side_margin } else { -side_margin };
            side.min(slope_margin(frame, corners, name.mirrored))
        };
        let aside = (0..3).any(|axis| {
            let origin = frame.origin[axis];
            let (low, high) = (low[axis] + frame.shift, high[axis] - frame.shift);
            frame.is_parallel(axis) && !(low <= origin && origin <= high)
        });
        let (t_min, t_max) = frame.window;
        if t_high < t_min || t_low > t_max || t_min > t_max {
            return None;
        }
        Some(Self {
            triangle,
            id: name.id,
            shape: name.shape,
            t,
            barycentrics,
            front_face,
            t_low,
            t_high,
            t_is_lost: t_error.is_infinite() || underflows || overflows,
            barycentric_error,
            edge_margin: if sum >= 0.0 { least } else { -most },
            side_margin,
            facing_margin,
            one_sided: false,
            window_margin: (t_low - t_min).min(t_max - t_high),
            out_of_range: underflows || overflows || aside,
        })
    }

    /// Whether every right implementation reports the triangle.
    #[must_use]
    pub fn is_certain(&self) -> bool {
        self.edge_margin > 1.0
            && self.window_margin >= 0.0
            && !self.out_of_range
            && (!self.one_sided || self.facing_margin > 1.0)
    }

    /// The same triangle with one side, which only hits of its front count of; `None` where the ray surely meets its back.
    #[must_use]
    pub fn one_sided(self) -> Option<Self> {
        (self.facing_margin >= -1.0).then_some(Self { one_sided: true, ..self })
    }

    /// What is wrong with a hit of this triangle, its id and the window aside.
    #[must_use]
    pub fn objection(&self, hit: &Hit) -> Option<String> {
        let t = f64::from(hit.t);
        if !(t >= self.t_low && t <= self.t_high) {
            return Some(format!(
                "t is {t:e}, but the triangle is at {:e}, in f32 between {:e} and {:e}",
                self.t, self.t_low, self.t_high
            ));
        }
        if self.one_sided && !hit.front_face {
            return Some("a back face is reported, but these triangles have one side".into());
        }
        if self.side_margin > 1.0 && !self.out_of_range && hit.front_face != self.front_face {
            return Some(format!("front_face is {}, but should be {}", hit.front_face, self.front_face));
        }
        let given = hit.barycentrics.as_dvec2();
        // All of one sign: none is negative, and none is more than all together. Two roundings.
        let in_range = given.min_element() >= 0.0 && given.element_sum() <= 1.0 + 1e-6;
        if !(in_range || self.out_of_range) {
            return Some(format!("the barycentrics {given} do not lie in the triangle"));
        }
        if !self.out_of_range && (given - self.barycentrics).abs().max_element() > self.barycentric_error {
            return Some(format!(
                "the barycentrics are {given}, but should be {} to {:e}",
                self.barycentrics, self.barycentric_error
            ));
        }
        None
    }
}

/// An edge function and its bound.
fn edge(frame: &RayFrame, p: Sheared, q: Sheared) -> (f64, f64) {
    let products = [p.x * q.y, p.y * q.x];
    let error = p.x.abs() * q.y_error
        + q.y.abs() * p.x_error
        + p.x_error * q.y_error
        + p.y.abs() * q.x_error
        + q.x.abs() * p.y_error
        + p.y_error * q.x_error
        + 2.0 * frame.unit * (products[0].abs() + products[1].abs())
        + 4.0 * FLUSHED;
    (products[0] - products[1], error)
}

/// How far `t` may lie off when it is computed from the plane: the distance from the origin over the slope, both
/// along a normal that is the cross product of the two shorter edges.
///
/// A component of the normal errs by at most 8 roundings of the product of the edges' lengths, so the normal by 14.
/// That turns the plane about the vertex that it is hung up at, and so counts with the distance from there to the
/// hit alone. The two dot products add 5 roundings each of what they sum.
fn plane_error(frame: &RayFrame, corners: &Corners, t: f64) -> f64 {
    let Plane { normal, normal_error, product } = Plane::of(frame, corners);
    let hit = frame.origin + frame.dir * t;
    let turned = normal_error * corners.map(|corner| (corner - hit).length()).into_iter().fold(0.0, f64::max);
    let reach = (corners[0] - frame.origin).length() + (frame.dir * t).length();
    if product * reach.min(1.0) < UNDERFLOW {
        return f64::INFINITY;
    }
    let length = normal.length() + normal_error;
    let summed = (5.0 * frame.unit * reach + 2.0 * frame.shift) * length;
    let slope = normal.dot(frame.dir).abs()
        - (normal_error + 5.0 * frame.unit * normal.length()) * frame.dir.length();
    if slope <= 0.0 { f64::INFINITY } else { (turned + summed) / slope + 6.0 * frame.unit * t.abs() }
}

/// The slope of the ray against the front in units of its bound, negative where the ray comes from the back.
///
/// Of the five roundings of the dot product one is to spare: it covers that a component to which the ray is parallel for the
/// slab test, 2^-64 of the largest one, is left out.
fn slope_margin(frame: &RayFrame, corners: &Corners, mirrored: bool) -> f64 {
    let Plane { normal, normal_error, product } = Plane::of(frame, corners);
    let length = frame.dir.length();
    let error = (normal_error + 5.0 * frame.unit * normal.length()) * length + 8.0 * FLUSHED * length;
    if product < UNDERFLOW {
        return 0.0;
    }
    let slope = normal.dot(frame.dir) / error;
    if mirrored { slope } else { -slope }
}

/// A triangle's plane as f32 computes it: the cross product of the two shorter edges, how far it may lie off, and the
/// product of the edges' lengths.
struct Plane {
    normal: DVec3,
    normal_error: f64,
    product: f64,
}

impl Plane {
    fn of(frame: &RayFrame, corners: &Corners) -> Self {
        let edges = [corners[1] - corners[0], corners[2] - corners[1], corners[0] - corners[2]];
        let longest =
            (0..3).fold(0, |best, i| if edges[i].length() > edges[best].length() { i } else { best });
        let (first, second) = (edges[(longest + 1) % 3], edges[(longest + 2) % 3]);
        let product = first.length() * second.length();
        // An edge is shifted at both ends.
        let shifted = 2.0 * frame.shift * (first.length() + second.length() + 2.0 * frame.shift);
        let normal_error = 14.0 * frame.unit * product + shifted;
        Self { normal: first.cross(second), normal_error, product }
    }
}

fn overflows(frame: &RayFrame, vertices: &[Sheared; 3], determinant: f64, depth: f64) -> bool {
    let largest = vertices.iter().fold(0.0f64, |size, v| size.max(v.x.abs()).max(v.y.abs()));
    largest * largest > OVERFLOW
        || determinant * depth > OVERFLOW
        || depth * frame.shear.z.abs() > OVERFLOW
        || frame.shear.abs().max_element() > OVERFLOW
}
