//! The frame of an object: the rotation in which its box is small (Gottschalk, Lin, Manocha 1996).
//!
//! A thin part that lies askew has a box many times its size, and rays enter it for nothing. The axes along which its surface
//! spreads most and least make a frame in which its box fits: the eigenvectors of the covariance of the surface (`covariance`),
//! each point of it counting the same, however it is cut into triangles.
//!
//! **What is tried beside them.** A cube spreads the same along all axes, so its eigenvectors are any. Parts of machines have flat
//! faces: the plane of the largest triangle and its longest edge are a frame, too, and so are the object's own axes. Each of the
//! three is turned about its axes as long as that makes the box smaller (`refine`). That is searched on few points, the extreme
//! ones of some directions. The box of few points is never larger than that of all, so what is not small enough for them
//! is refused without a look at the others; what is, is measured on all vertices, and those that stand out join the few.
//!
//! **Invariants.** The frame is a rotation, never a reflection, and finite; it is the identity exactly where no other has a box
//! whose area is smaller by a tenth, and where there is nothing to measure. Vertices that are not finite count for nothing.
//!
//! **Cost.** 0.1 ms for the search and some passes over the triangles. Measured on 2026-11-22 on an AMD EPYC (family 26), one thread:
//! 0.07 ms for 12 triangles, 0.3 ms for 1,000, 24 ms for 100,000 and 0.29 s for a million.

mod covariance;
mod refine;
#[cfg(test)]
mod tests;

use crate::FlatTriangle;
use covariance::Moments;
use glam::{DMat3, DVec3, Mat3, Vec3};
use refine::{Extremes, refine};

/// A frame is taken where its box has less than this part of the area of the box in the object's own space. For less than a
/// tenth it is not worth it to turn walls out of the planes of the axes, in which boxes and splits fit them best: with a
/// hundredth 130 of the 161 objects of the BART robots were turned, all boxes together kept 99.9 percent of their area, and
/// rays made a fifth more triangle tests in the turned trees (`ropewalk lab two-level Robot.aff`, 2026-11-22).
const GAIN: f64 = 0.9;
/// A box of few points is as good as that of all where the latter is larger by no more than this.
const CLOSE: f64 = 1.001;
/// How often a frame is measured on all vertices before the best so far is good enough. Two or three are usual.
const ROUNDS: usize = 8;

/// The rotation from the object's space to the frame in which its box is smallest, of those tried; the identity, exactly, where
/// the object's own space is as good.
#[must_use]
pub fn frame_of(triangles: &[FlatTriangle]) -> Mat3 {
    let Some(points) = Points::new(triangles) else { return Mat3::IDENTITY };
    let own = refine::half_area(points.measure(&DMat3::IDENTITY).size());
    let mut few = Vec::new();
    Extremes::of_directions(points.iter().flatten(), &mut few);
    let mut candidates: Vec<(f64, DMat3)> =
        [points.eigenvectors(), points.largest_face(), Some(DMat3::IDENTITY)]
            .into_iter()
            .flatten()
            .map(|frame| refine(frame, &few))
            .collect();
    let mut best = (GAIN * own, None);
    for _ in 0..ROUNDS {
        candidates.retain(|&(bound, _)| bound < best.0);
        let least = candidates.iter_mut().min_by(|a, b| a.0.total_cmp(&b.0));
        let Some((bound, frame)) = least else { break };
        let measured = points.measure(frame);
        let area = refine::half_area(measured.size());
        if area < best.0 {
            best = (area, Some(*frame));
        }
        if area > CLOSE * *bound {
            few.extend(measured.points());
            (*bound, *frame) = refine(*frame, &few);
        } else {
            *bound = f64::INFINITY;
        }
    }
    best.1.map_or(Mat3::IDENTITY, |frame| frame.as_mat3())
}

/// The vertices, moved and scaled so that they lie around zero and the largest coordinate is 1: then nothing overflows.
struct Points<'a> {
    triangles: &'a [FlatTriangle],
    center: DVec3,
    scale: f64,
}

impl<'a> Points<'a> {
    /// `None` where there are no two different finite vertices.
    fn new(triangles: &'a [FlatTriangle]) -> Option<Self> {
        let (mut min, mut max) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let all = triangles.iter().flat_map(|triangle| triangle.triangle().vertices);
        for vertex in all.filter(|vertex| vertex.is_finite()).map(Vec3::as_dvec3) {
            (min, max) = (min.min(vertex), max.max(vertex));
        }
        let scale = 2.0 / (max - min).max_element();
        (scale.is_finite() && scale > 0.0).then_some(Self { triangles, center: (min + max) * 0.5, scale })
    }

    /// The triangles whose vertices are finite.
    fn iter(&self) -> impl Iterator<Item = [DVec3; 3]> {
        let place = |vertex: Vec3| (vertex.as_dvec3() - self.center) * self.scale;
        let all = self.triangles.iter().map(|triangle| triangle.triangle().vertices);
        all.filter(|vertices| vertices.iter().all(|vertex| vertex.is_finite()))
            .map(move |vertices| vertices.map(place))
    }

    /// The extreme points along the axes of a frame.
    fn measure(&self, frame: &DMat3) -> Extremes {
        Extremes::along(frame, self.iter().flatten())
    }

    /// The axes along which the surface spreads: Gottschalk's frame.
    fn eigenvectors(&self) -> Option<DMat3> {
        let mut moments = Moments::default();
        self.iter().for_each(|triangle| moments.add(&triangle));
        moments.axes()
    }

    /// The plane and the longest edge of the largest triangle.
    fn largest_face(&self) -> Option<DMat3> {
        let mut largest = (0.0, None);
        for [a, b, c] in self.iter() {
            let normal = (b - a).cross(c - a);
            if normal.length_squared() > largest.0 {
                let edges = [b - a, c - b, a - c];
                let longest =
                    edges.into_iter().max_by(|a, b| a.length_squared().total_cmp(&b.length_squared()));
                largest = (normal.length_squared(), longest.map(|edge| (edge, normal)));
            }
        }
        let (edge, normal) = largest.1?;
        refine::frame(edge, normal)
    }
}
