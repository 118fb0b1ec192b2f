//! Whether a device answers points as the reference does.
//!
//! The CPU and software adapters must give the same bits. Hardware may fuse a product with a sum, so that its distances
//! lie a little beside; and which of two triangles is nearer by less than that is open to it, as long as the one that it
//! names is that near.

use crate::bench::is_hardware;
use glam::{DVec3, Vec3};
use ropewalk::{Aabb, ClosestPoint, FlatScene, PointAnswers, PointQuery};
use ropewalk_gpu::Device;
use ropewalk_testkit::points::{Measured, same_closest_points};
use std::collections::HashMap;

/// The largest difference of distances on hardware, relative to the distance and to the size of the scene with its way
/// from zero: beside a face, the distance is a difference of numbers as large as these. That of hits, which the contract
/// of the devices names.
const TOLERANCE: f64 = 1e-5;

/// Compares answers as exactly as a device can give them.
#[derive(Clone, Debug)]
pub(super) struct Judge {
    /// For hardware; without it answers must be the same bits.
    relaxed: Option<Relaxed>,
}

/// What is known of a scene's triangles.
#[derive(Clone, Debug)]
struct Relaxed {
    corners: HashMap<(u32, u32, u32), [DVec3; 3]>,
    size: f64,
}

impl Judge {
    /// For devices of which one may be hardware.
    pub(super) fn new(scene: &FlatScene, devices: &[Device]) -> Self {
        Self { relaxed: devices.iter().any(is_hardware).then(|| Relaxed::new(scene)) }
    }

    /// How many answers are not the same to the bit, or what is wrong with the first wrong one.
    pub(super) fn compare(
        &self,
        device: &Device,
        queries: &[PointQuery],
        reference: &PointAnswers<Vec<ClosestPoint>>,
        given: &PointAnswers<Vec<ClosestPoint>>,
    ) -> Result<usize, String> {
        match &self.relaxed {
            Some(relaxed) if is_hardware(device) => relaxed.compare(queries, reference, given),
            _ => same_closest_points(queries, reference, given, false)
                .map(|()| 0)
                .map_err(|mismatch| mismatch.to_string()),
        }
    }
}

impl Relaxed {
    fn new(scene: &FlatScene) -> Self {
        let corners = scene.triangles.iter().map(|triangle| {
            let id = (triangle.instance(), triangle.geometry(), triangle.primitive);
            (id, triangle.triangle().vertices.map(Vec3::as_dvec3))
        });
        let bounds = scene.triangles.iter().map(|triangle| triangle.triangle().bounds());
        let bounds = bounds.fold(Aabb::EMPTY, Aabb::union);
        let size = bounds.size().max_element().max(bounds.min.abs().max(bounds.max.abs()).max_element());
        Self { corners: corners.collect(), size: f64::from(size) }
    }

    fn compare(
        &self,
        queries: &[PointQuery],
        reference: &PointAnswers<Vec<ClosestPoint>>,
        given: &PointAnswers<Vec<ClosestPoint>>,
    ) -> Result<usize, String> {
        for (what, count) in [("answers", given.points.len()), ("status words", given.status.len())] {
            if count != queries.len() {
                return Err(format!("there are {count} {what} for {} queries", queries.len()));
            }
        }
        let mut differing = 0;
        let answers = reference.points.iter().zip(&given.points);
        let statuses = reference.status.iter().zip(&given.status);
        for (index, ((query, (expected, found)), (status, given))) in
            queries.iter().zip(answers).zip(statuses).enumerate()
        {
            if status != given {
                return Err(format!("query {index}: the status is {given:?}, not {status:?}"));
            }
            if expected.to_words() != found.to_words() {
                differing += 1;
                if !self.is_near(query, expected, found) {
                    let point = query.point.to_array();
                    return Err(format!(
                        "query {index} (point {point:?}): the answers differ by more than rounding: expected {expected:?}, given {found:?}"
                    ));
                }
            }
        }
        Ok(differing)
    }

    /// Whether two answers are as near as rounding allows, and the found one is of a triangle that is that near.
    fn is_near(&self, query: &PointQuery, expected: &ClosestPoint, found: &ClosestPoint) -> bool {
        let (true, Some(corners)) = (expected.is_found(), self.corners.get(&found.id())) else {
            return false;
        };
        let point = query.point.as_dvec3();
        let distance = f64::from(expected.distance);
        let room = TOLERANCE * distance.max(self.size);
        // Comparisons that a NaN fails.
        let is_near = |other: f64| (other - distance).abs() <= room;
        let [a, b, c] = *corners;
        let (u, v) = (f64::from(found.barycentrics.x), f64::from(found.barycentrics.y));
        let weighted = a + (b - a) * u + (c - a) * v;
        is_near(f64::from(found.distance))
            && is_near(Measured::new(point, corners).distance)
            && found.point.as_dvec3().distance(weighted) <= room
            && is_near(found.point.as_dvec3().distance(point))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec2;
    use ropewalk::{BuildOptions, Scene, Status, TraceOptions, Walk};
    use ropewalk_testkit::{meshes, points};

    #[test]
    fn every_kind_of_wrong_answer_is_found_out() {
        let scene = Scene::from_mesh(meshes::soup(200, 0.3, 8));
        let flat = scene.flatten().unwrap();
        let queries = points::around(&scene.bounds(), 50, 3);
        let bvh = scene.build(&BuildOptions::default()).unwrap();
        let right = bvh.closest_points(Walk::default(), &queries, TraceOptions::default()).unwrap();
        let (exact, relaxed) = (Judge::new(&flat, &[Device::Cpu]), Relaxed::new(&flat));
        let judge = |given: &PointAnswers<_>| {
            let exact = exact.compare(&Device::Cpu, &queries, &right, given).ok();
            (exact, relaxed.compare(&queries, &right, given).ok())
        };
        assert_eq!(judge(&right), (Some(0), Some(0)));
        let spoil = |change: &dyn Fn(&mut PointAnswers<Vec<ClosestPoint>>)| {
            let mut wrong = right.clone();
            change(&mut wrong);
            judge(&wrong)
        };
        // What rounding may do is the CPU's mistake all the same.
        assert_eq!(spoil(&|wrong| wrong.points[7].distance *= 1.000_001), (None, Some(1)));
        assert_eq!(spoil(&|wrong| wrong.points[7].point.x += 1e-6), (None, Some(1)));
        let wrong = [
            spoil(&|wrong| wrong.points[7] = ClosestPoint::NONE),
            spoil(&|wrong| wrong.points[7].distance *= 1.01),
            spoil(&|wrong| wrong.points[7].distance = f32::NAN),
            spoil(&|wrong| wrong.points[7].point.x += 0.01),
            spoil(&|wrong| wrong.points[7].barycentrics = Vec2::splat(0.9)),
            spoil(&|wrong| wrong.points[7].primitive_index = (wrong.points[7].primitive_index + 1) % 200),
            spoil(&|wrong| wrong.points[7].primitive_index = 200),
            spoil(&|wrong| wrong.points[7].instance_index = 1),
            spoil(&|wrong| wrong.points.swap(3, 7)),
            spoil(&|wrong| wrong.points.truncate(49)),
            spoil(&|wrong| wrong.status.truncate(49)),
            spoil(&|wrong| wrong.status[7] = Status::INVALID_RAY),
        ];
        assert_eq!(wrong, [(None, None); 12]);
    }
}
