//! How long the top level takes, by the number of objects that move: built from scratch, refitted, restructured, in one thread.
//!
//! Boxes of many sizes stand in a cube that grows with their number, so that as many overlap whatever the number. In each round
//! every box turns anew and moves by up to a quarter of its own size from where it first stood. Refitting and restructuring begin with the tree of the first
//! place and go on with what they made of it.

use super::paper::REBUILD_1000_MS;
use super::record::RebuildRow;
use crate::Spread;
use crate::bench::{Progress, Watch};
use crate::comparison::ComparisonError;
use glam::{Affine3A, DVec3, Vec3};
use rayon::ThreadPoolBuilder;
use ropewalk::two_level::{Placed, TopLevel, TopUpdate};
use ropewalk::{Aabb, BuildError, Mesh, Scene, SceneError, Transform, TwoLevel, TwoLevelOptions};
use ropewalk_testkit::random::Random;
use std::time::Instant;

/// The numbers of objects.
pub const REBUILD_COUNTS: [u32; 7] = [100, 300, 1_000, 3_000, 10_000, 30_000, 100_000];

/// Small numbers of objects are built more often, until about so many objects were: a clock ticks in steps.
const OBJECTS_A_ROUND: usize = 10_000;

/// Measures the top level over each number of objects, each `rounds` times at least.
///
/// # Errors
/// When the thread cannot be started, or the caller stops it.
pub fn rebuild(counts: &[u32], rounds: usize, watch: &Watch<'_>) -> Result<Vec<RebuildRow>, ComparisonError> {
    let pool = ThreadPoolBuilder::new().num_threads(1).build();
    let pool = pool.map_err(|error| ComparisonError::Threads { reason: error.to_string() })?;
    let mut rows = Vec::new();
    for (done, &count) in counts.iter().enumerate() {
        let what = format!("rebuilding the top level over {count} objects");
        if watch(Progress { what: &what, done, total: counts.len() }).is_break() {
            return Err(ComparisonError::Stopped);
        }
        rows.push(pool.install(|| of_count(count.max(1) as usize, rounds.max(1)))?);
    }
    Ok(rows)
}

/// How a top level follows its boxes.
type Follow = fn(&mut TopLevel, &[Aabb]) -> Result<(), BuildError>;

/// Where boxes stand, and how large they are.
struct Crowd {
    places: Vec<DVec3>,
    sizes: Vec<f64>,
    random: Random,
}

impl Crowd {
    fn new(count: usize) -> Self {
        let mut random = Random::new(count as u64);
        // A quarter of the space is full: about as crowded as parts of an assembly.
        let side = (4.0 * count as f64).cbrt();
        let places = (0..count).map(|_| random.in_cube() * (0.5 * side)).collect();
        let sizes = (0..count).map(|_| random.between(0.2, 1.6)).collect();
        Self { places, sizes, random }
    }

    /// All in other places.
    fn moved(&mut self) -> Vec<Affine3A> {
        let Self { places, sizes, random } = self;
        let one = |(place, &size): (&DVec3, &f64)| {
            let place = *place + random.in_cube() * (0.25 * size);
            let turn =
                glam::Quat::from_axis_angle(random.direction().as_vec3(), random.between(0.0, 6.0) as f32);
            Affine3A::from_scale_rotation_translation(Vec3::splat(size as f32), turn, place.as_vec3())
        };
        places.iter().zip(sizes.iter()).map(one).collect()
    }
}

/// A box from 0 to 1.
fn cube() -> Mesh {
    let corner = |index: u8| Vec3::from([0, 1, 2].map(|axis| f32::from(index >> axis & 1)));
    let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Mesh::new((0..8).map(corner).collect(), triangles)
}

fn of_count(count: usize, rounds: usize) -> Result<RebuildRow, ComparisonError> {
    let mut crowd = Crowd::new(count);
    let mut scene = Scene::default();
    let object = scene.add_object(cube());
    for map in crowd.moved() {
        let transform = Transform::new(map).map_err(|why| SceneError::Transform { instance: 0, why });
        scene.add_instance(object, transform.map_err(BuildError::from)?);
    }
    let mut whole = scene.build_two_level(&TwoLevelOptions::default())?;
    let mut refitted = whole.top().clone();
    let mut restructured = whole.top().clone();
    let mut rebuilt = whole.top().clone();
    let repeats = rounds * (OBJECTS_A_ROUND / count).clamp(1, 20);
    let mut times: [Vec<f64>; 4] = Default::default();
    let mut nodes = [0; 3];
    let mut costs = [0.0; 3];
    for _ in 0..repeats {
        let maps = crowd.moved();
        let start = Instant::now();
        set(&mut whole, &maps)?;
        times[3].push(milliseconds(start));
        let boxes: Vec<_> = whole.placed().iter().map(Placed::bounds).collect();
        let follow: [(&mut TopLevel, Follow); 3] = [
            (&mut rebuilt, |top, boxes| Ok(top.rebuild(boxes).map_err(SceneError::from)?)),
            (&mut refitted, |top, boxes| Ok(top.refit(boxes).map(drop).map_err(SceneError::from)?)),
            (&mut restructured, |top, boxes| {
                top.refit(boxes).map_err(SceneError::from)?;
                top.restructure(TopLevel::TOLERANCE);
                Ok(())
            }),
        ];
        for (place, (top, follow)) in follow.into_iter().enumerate() {
            top.forget_changes();
            let start = Instant::now();
            follow(top, &boxes)?;
            times[place].push(milliseconds(start));
            nodes[place] = top.changed().iter().map(ExactSizeIterator::len).sum();
            costs[place] = top.cost();
        }
    }
    let [rebuild_ms, refit_ms, restructure_ms, frame_ms] =
        times.map(|times| Spread::of(&times).map_or(0.0, |spread| spread.median));
    let upload = |nodes: usize| size_of::<ropewalk::bvh::Node>() * nodes + size_of::<Placed>() * count;
    let ratio = |cost: f64| if costs[0] > 0.0 { cost / costs[0] } else { 1.0 };
    Ok(RebuildRow {
        objects: count,
        rebuild_ms,
        refit_ms,
        upload_bytes: upload(nodes[0]),
        restructure_ms,
        frame_ms,
        refit_upload_bytes: upload(nodes[1]),
        restructure_upload_bytes: upload(nodes[2]),
        refit_cost_ratio: ratio(costs[1]),
        restructure_cost_ratio: ratio(costs[2]),
        paper_rebuild_ms: (count == 1000).then_some(REBUILD_1000_MS),
        rounds: repeats,
        threads: rayon::current_num_threads(),
        device: "cpu",
    })
}

/// A frame: everything is set, and seen.
fn set(scene: &mut TwoLevel, maps: &[Affine3A]) -> Result<(), ComparisonError> {
    for (instance, &map) in maps.iter().enumerate() {
        scene.set_transform(instance as u32, map)?;
    }
    scene.commit(TopUpdate::Rebuild).map_err(BuildError::from)?;
    Ok(())
}

fn milliseconds(start: Instant) -> f64 {
    1e3 * start.elapsed().as_secs_f64()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::ops::ControlFlow;

    #[test]
    fn each_number_of_objects_has_its_row() {
        let rows = rebuild(&[1, 100, 1000], 1, &|_| ControlFlow::Continue(())).unwrap();
        assert_eq!(rows.iter().map(|row| row.objects).collect::<Vec<_>>(), [1, 100, 1000]);
        for row in &rows {
            // All nodes are new, and all objects moved.
            assert_eq!(row.upload_bytes, 32 * (2 * row.objects - 1) + 96 * row.objects);
            assert!(row.refit_upload_bytes <= row.upload_bytes && row.refit_upload_bytes >= 96 * row.objects);
            assert!(row.restructure_cost_ratio <= 1.05 * row.refit_cost_ratio, "{row:?}");
            assert_eq!((row.threads, row.paper_rebuild_ms.is_some()), (1, row.objects == 1000));
        }
        assert!(rows[2].refit_cost_ratio >= 1.0);
        let stopped = rebuild(&[1], 1, &|_| ControlFlow::Break(()));
        assert!(matches!(stopped, Err(ComparisonError::Stopped)));
    }
}
