//! The answers that all walks are held to, and how they are confirmed.

use crate::bench::{Progress, Watch};
use crate::comparison::ComparisonError;
use rayon::prelude::*;
use ropewalk::{
    BuildOptions, Bvh, ClosestPoint, PointAnswers, PointQuery, StructureSpec, TraceError, TraceOptions, Walk,
};
use ropewalk_gpu::{Device, GpuError};
use ropewalk_testkit::points::{PointMismatch, PointOracle, closest_against_oracle, same_closest_points};

/// Points between two looks at whether to stop: of a large scene brute force takes some seconds for them.
const STEP: usize = 256;

/// Points that a thread takes at a time from brute force, where each takes long.
const PIECE: usize = 4;

/// Points, and what the full stack over the default tree answers on the CPU.
#[derive(Clone, Debug)]
pub(super) struct Reference {
    pub(super) queries: Vec<PointQuery>,
    pub(super) answers: PointAnswers<Vec<ClosestPoint>>,
}

impl Reference {
    /// Answers the points over the tree of [`BuildOptions::default`].
    pub(super) fn new(bvh: &Bvh, queries: Vec<PointQuery>) -> Result<Self, ComparisonError> {
        let answers =
            bvh.closest_points(Walk::default(), &queries, TraceOptions::default()).map_err(GpuError::from)?;
        Ok(Self { queries, answers })
    }

    /// Lets the oracle look at every answer; says how many there are.
    pub(super) fn confirm_by_oracle(
        &self,
        oracle: &PointOracle,
        watch: &Watch<'_>,
    ) -> Result<usize, ComparisonError> {
        self.confirm("the f64 oracle", self.queries.len(), watch, |queries, answers| {
            Ok(closest_against_oracle(oracle, queries, answers))
        })
    }

    /// Lets brute force answer the first `count` points too; says how many there are.
    pub(super) fn confirm_by_brute_force(
        &self,
        bvh: &Bvh,
        count: usize,
        watch: &Watch<'_>,
    ) -> Result<usize, ComparisonError> {
        self.confirm("brute force", count, watch, |queries, answers| {
            let expected = brute_force(bvh, queries).map_err(GpuError::from)?;
            Ok(same_closest_points(queries, &expected, answers, false))
        })
    }

    /// Holds the first `count` answers against somebody, a step after the other.
    fn confirm(
        &self,
        by: &str,
        count: usize,
        watch: &Watch<'_>,
        look: impl Fn(
            &[PointQuery],
            &PointAnswers<Vec<ClosestPoint>>,
        ) -> Result<Result<(), PointMismatch>, ComparisonError>,
    ) -> Result<usize, ComparisonError> {
        let total = count.min(self.queries.len());
        let what = format!("{total} points by {by}");
        for first in (0..total).step_by(STEP) {
            if watch(Progress { what: &what, done: first, total }).is_break() {
                return Err(ComparisonError::Stopped);
            }
            let part = first..total.min(first + STEP);
            let answers = PointAnswers {
                points: self.answers.points[part.clone()].to_vec(),
                status: self.answers.status[part.clone()].to_vec(),
                counters: None,
            };
            look(&self.queries[part], &answers)?.map_err(|PointMismatch { query, why }| {
                let query = query.map(|(index, query)| (first + index, query));
                ComparisonError::Disagrees {
                    walk: Walk::default().to_string(),
                    device: Device::Cpu.to_string(),
                    structure: StructureSpec::Bvh(BuildOptions::default()).to_string(),
                    asked: format!("closest points against {by}"),
                    what: PointMismatch { query, why }.to_string(),
                }
            })?;
        }
        Ok(total)
    }
}

/// What brute force answers. The batches of the library are cut for walks, which are a thousand times as fast: here they
/// would leave all but one thread idle.
fn brute_force(bvh: &Bvh, queries: &[PointQuery]) -> Result<PointAnswers<Vec<ClosestPoint>>, TraceError> {
    let pieces: Vec<_> = queries
        .par_chunks(PIECE)
        .map(|piece| bvh.closest_points(Walk::BruteForce, piece, TraceOptions::default()))
        .collect::<Result<_, _>>()?;
    let mut answers = PointAnswers { points: Vec::new(), status: Vec::new(), counters: None };
    for piece in pieces {
        answers.points.extend(piece.points);
        answers.status.extend(piece.status);
    }
    Ok(answers)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ropewalk::Scene;
    use ropewalk_testkit::{meshes, points};
    use std::ops::ControlFlow;
    use std::sync::atomic::{AtomicUsize, Ordering};

    const COUNT: usize = 2 * STEP + 100;

    fn soup() -> (Bvh, PointOracle, Reference) {
        let scene = Scene::from_mesh(meshes::soup(300, 0.3, 8));
        let bvh = scene.build(&BuildOptions::default()).unwrap();
        let oracle = PointOracle::of_scene(&scene).unwrap();
        let queries = points::around(&scene.bounds(), COUNT, 3);
        let reference = Reference::new(&bvh, queries).unwrap();
        (bvh, oracle, reference)
    }

    fn on(_: Progress<'_>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    #[test]
    fn right_answers_are_confirmed() {
        let (bvh, oracle, reference) = soup();
        assert_eq!(reference.confirm_by_oracle(&oracle, &on).unwrap(), COUNT);
        for (wanted, done) in [(0, 0), (STEP + 1, STEP + 1), (COUNT, COUNT), (usize::MAX, COUNT)] {
            assert_eq!(reference.confirm_by_brute_force(&bvh, wanted, &on).unwrap(), done);
        }
    }

    #[test]
    fn a_wrong_answer_is_named_wherever_it_stands() {
        let (bvh, oracle, reference) = soup();
        for place in [0, STEP - 1, STEP, COUNT - 1] {
            let mut wrong = reference.clone();
            wrong.answers.points[place] = reference.answers.points[(place + 1) % COUNT];
            let by_oracle = wrong.confirm_by_oracle(&oracle, &on).unwrap_err().to_string();
            let by_brute_force = wrong.confirm_by_brute_force(&bvh, COUNT, &on).unwrap_err().to_string();
            for (text, by) in [(by_oracle, "the f64 oracle"), (by_brute_force, "brute force")] {
                assert!(text.contains(&format!("against {by}: query {place} (point [")), "{text}");
                assert!(text.starts_with("stack") && text.contains("on cpu, bvh"), "{text}");
            }
            // What is not asked is not looked at.
            assert_eq!(wrong.confirm_by_brute_force(&bvh, place, &on).unwrap(), place);
        }
        // One bit is too far for brute force, and within the rounding that the oracle allows.
        let mut wrong = reference;
        wrong.answers.points[STEP].distance = wrong.answers.points[STEP].distance.next_up();
        assert!(wrong.confirm_by_brute_force(&bvh, COUNT, &on).is_err());
        assert!(wrong.confirm_by_oracle(&oracle, &on).is_ok());
    }

    #[test]
    fn it_stops_within_the_points() {
        let (bvh, oracle, reference) = soup();
        let asked = AtomicUsize::new(0);
        let watch = |_: Progress<'_>| {
            let is_second = asked.fetch_add(1, Ordering::Relaxed) % 2 == 1;
            if is_second { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let stopped = [
            reference.confirm_by_oracle(&oracle, &watch),
            reference.confirm_by_brute_force(&bvh, COUNT, &watch),
        ];
        assert!(stopped.iter().all(|result| matches!(result, Err(ComparisonError::Stopped))));
        assert_eq!(asked.into_inner(), 4);
    }
}
