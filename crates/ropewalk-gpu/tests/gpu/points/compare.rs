//! What it means that a device agrees with the CPU about point queries.

use ropewalk::{Bvh, ClosestPoint, NearestLists, PointAnswers, PointQuery};

/// The largest difference of distances on a device that does not round as the CPU does, relative to the distance and to
/// the size of the scene: beside a face, the distance is a difference of numbers as large as its triangle.
const TOLERANCE: f32 = 1e-5;

/// How equal two answers must be.
#[derive(Clone, Copy, Debug)]
pub(super) enum Agreement {
    /// Every word.
    Exact,
    /// Distances are near each other, in a scene of this size; which of two triangles that are as near is left open.
    Near(f32),
}

impl Agreement {
    pub(super) fn new(is_exact: bool, bvh: &Bvh) -> Self {
        if is_exact || bvh.triangles().is_empty() {
            return Self::Exact;
        }
        let bounds = bvh.bounds();
        Self::Near(bounds.size().max_element().max(bounds.min.abs().max(bounds.max.abs()).max_element()))
    }
}

/// Compares closest points, and tells the first difference.
pub(super) fn compare_closest(
    queries: &[PointQuery],
    cpu: &PointAnswers<Vec<ClosestPoint>>,
    gpu: &PointAnswers<Vec<ClosestPoint>>,
    agreement: Agreement,
) -> Result<(), String> {
    for (index, point) in gpu.points.iter().enumerate() {
        if !point.is_found() && point.to_words() != ClosestPoint::NONE.to_words() {
            return Err(format!("query {index} finds nothing, but answers {point:?}"));
        }
    }
    let lists = |answers: &PointAnswers<Vec<ClosestPoint>>| {
        let mut lists = NearestLists { offsets: vec![0], points: vec![] };
        for point in &answers.points {
            lists.points.extend(point.is_found().then_some(*point));
            lists.offsets.push(lists.points.len() as u64);
        }
        PointAnswers { points: lists, status: answers.status.clone(), counters: answers.counters.clone() }
    };
    compare_nearest(queries, &lists(cpu), &lists(gpu), agreement)
}

/// Compares lists of the nearest, and tells the first difference.
pub(super) fn compare_nearest(
    queries: &[PointQuery],
    cpu: &PointAnswers<NearestLists>,
    gpu: &PointAnswers<NearestLists>,
    agreement: Agreement,
) -> Result<(), String> {
    for (side, answers) in [("CPU", cpu), ("device", gpu)] {
        let (offsets, lens) = (&answers.points.offsets, (answers.status.len(), answers.points.offsets.len()));
        if lens != (queries.len(), queries.len() + 1)
            || offsets.last().copied() != Some(answers.points.points.len() as u64)
        {
            return Err(format!("the {side} answers {} and {} of {} queries", lens.0, lens.1, queries.len()));
        }
        if answers.counters.as_ref().is_some_and(|counters| counters.len() != queries.len()) {
            return Err(format!("the {side} has not a counter for each query"));
        }
    }
    if cpu.counters.is_some() != gpu.counters.is_some() {
        return Err("one side has counters".into());
    }
    for (index, query) in queries.iter().enumerate() {
        let fail = |what: &str, cpu: &dyn std::fmt::Debug, gpu: &dyn std::fmt::Debug| {
            Err(format!("the {what} of query {index}, {query:?}: CPU {cpu:?}, device {gpu:?}"))
        };
        if cpu.status[index] != gpu.status[index] {
            return fail("status", &cpu.status[index], &gpu.status[index]);
        }
        let (a, b) = (cpu.points.of(index), gpu.points.of(index));
        let same = match agreement {
            Agreement::Exact => a.iter().map(ClosestPoint::to_words).eq(b.iter().map(ClosestPoint::to_words)),
            Agreement::Near(size) => is_near(a, b, query.radius, size),
        };
        if !same {
            return fail("answer", &a, &b);
        }
        if let (Agreement::Exact, Some(a), Some(b)) = (agreement, &cpu.counters, &gpu.counters)
            && a[index] != b[index]
        {
            return fail("work", &a[index], &b[index]);
        }
    }
    Ok(())
}

/// Pairs of near distances; what only one side found lies at the radius.
fn is_near(a: &[ClosestPoint], b: &[ClosestPoint], radius: f32, size: f32) -> bool {
    let near = |a: f32, b: f32| a == b || (a - b).abs() <= TOLERANCE * a.max(b).max(size);
    let paired = a.len().min(b.len());
    let rest = a[paired..].iter().chain(&b[paired..]);
    a.iter().zip(b).all(|(a, b)| near(a.distance, b.distance))
        && rest.into_iter().all(|point| near(point.distance, radius))
}

#[cfg(test)]
mod tests {
    use super::*;
    use ropewalk::glam::{Vec2, Vec3};
    use ropewalk::{Counters, Status};

    const POINT: ClosestPoint = ClosestPoint {
        distance: 2.0,
        point: Vec3::new(1.0, 0.0, 3.0),
        barycentrics: Vec2::new(0.25, 0.0),
        primitive_index: 3,
        geometry_index: 0,
        instance_index: 1,
    };

    fn queries() -> [PointQuery; 2] {
        [PointQuery::new(Vec3::ZERO).within(5.0); 2]
    }

    fn answers(point: ClosestPoint) -> PointAnswers<Vec<ClosestPoint>> {
        PointAnswers {
            points: vec![ClosestPoint::NONE, point],
            status: vec![Status::COMPLETE; 2],
            counters: Some(vec![Counters::default(); 2]),
        }
    }

    fn compare(gpu: &PointAnswers<Vec<ClosestPoint>>, agreement: Agreement) -> Result<(), String> {
        compare_closest(&queries(), &answers(POINT), gpu, agreement)
    }

    #[test]
    fn equal_answers_agree() {
        for agreement in [Agreement::Exact, Agreement::Near(1.0)] {
            assert_eq!(compare(&answers(POINT), agreement), Ok(()));
        }
        let rounded = ClosestPoint { distance: 2.000_01, primitive_index: 4, ..POINT };
        assert_eq!(compare(&answers(rounded), Agreement::Near(1.0)), Ok(()));
        // One side finds what lies at the radius.
        let mut queries = queries();
        queries[1].radius = 2.000_001;
        let gpu = answers(ClosestPoint::NONE);
        assert_eq!(compare_closest(&queries, &answers(POINT), &gpu, Agreement::Near(1.0)), Ok(()));
    }

    /// Fed with wrong answers of every kind, it must object.
    #[test]
    fn wrong_answers_are_found() {
        let harms: [fn(&mut ClosestPoint); 8] = [
            |point| point.distance = point.distance.next_up(),
            |point| point.point.y = -0.0,
            |point| point.barycentrics.x = point.barycentrics.x.next_up(),
            |point| point.barycentrics.y = -0.0,
            |point| point.primitive_index = 4,
            |point| point.geometry_index = 4,
            |point| point.instance_index = 4,
            |point| *point = ClosestPoint::NONE,
        ];
        for harm in harms {
            let mut point = POINT;
            harm(&mut point);
            assert!(compare(&answers(point), Agreement::Exact).is_err(), "{point:?}");
        }
        for agreement in [Agreement::Exact, Agreement::Near(1.0)] {
            for distance in [2.001, f32::NAN] {
                assert!(compare(&answers(ClosestPoint { distance, ..POINT }), agreement).is_err());
            }
            let stale = ClosestPoint { primitive_index: ClosestPoint::NONE.primitive_index, ..POINT };
            for point in [ClosestPoint::NONE, stale] {
                assert!(compare(&answers(point), agreement).is_err());
            }
            let status = vec![Status::COMPLETE, Status::STEP_BUDGET];
            assert!(compare(&PointAnswers { status, ..answers(POINT) }, agreement).is_err());
            for counters in [None, Some(vec![])] {
                assert!(compare(&PointAnswers { counters, ..answers(POINT) }, agreement).is_err());
            }
            let points = vec![ClosestPoint::NONE];
            assert!(compare(&PointAnswers { points, ..answers(POINT) }, agreement).is_err());
            let lists = |ends: [u64; 2], points| PointAnswers {
                points: NearestLists { offsets: vec![0, ends[0], ends[1]], points },
                status: vec![Status::COMPLETE; 2],
                counters: None,
            };
            let two = || vec![POINT, ClosestPoint { distance: 3.0, ..POINT }];
            let compare = |gpu| compare_nearest(&queries(), &lists([0, 2], two()), &gpu, agreement);
            assert_eq!(compare(lists([0, 2], two())), Ok(()));
            for wrong in [lists([1, 2], two()), lists([0, 1], vec![POINT]), lists([0, 2], vec![POINT; 2])] {
                assert!(compare(wrong).is_err());
            }
        }
        let mut more = answers(POINT);
        more.counters = Some(vec![Counters::default(), Counters { inner_visits: 1, ..Counters::default() }]);
        assert!(compare(&more, Agreement::Exact).unwrap_err().contains("work of query 1"));
    }
}
