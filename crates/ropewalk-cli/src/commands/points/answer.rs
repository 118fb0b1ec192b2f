//! Answering a batch of points, whatever is asked.

use super::Arguments;
use super::question::Question;
use crate::arrays::answers_file::PointsAnswer;
use crate::commands::complete;
use crate::failure::Failure;
use crate::output::note;
use crate::table::thousands;
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use ropewalk::{
    CounterTotals, NearestLists, PointQuery, PointSearch, SignedDistance, Structure, SurfaceError,
    TraceOptions,
};
use ropewalk_gpu::{GpuPoints, Traceable};
use std::time::{Duration, Instant};

/// The answers of a batch, and what they took.
#[derive(Debug)]
pub(super) struct Answered {
    pub(super) answer: PointsAnswer,
    /// What the walk did, where it was counted.
    pub(super) totals: Option<CounterTotals>,
    /// The time of a graphics device's kernels, where it measures them.
    pub(super) device_time: Option<Duration>,
    /// The closed surface, where one was needed.
    pub(super) surface: Option<ClosedSurface>,
    /// The time of the search alone.
    pub(super) time: Duration,
}

/// What is known of a closed surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct ClosedSurface {
    /// Negative where the surface is inside out.
    pub(super) volume: f64,
    /// The time that it took to find how its triangles are connected.
    pub(super) time: Duration,
}

/// Answers a batch. The scene's zero lies at `origin`, which errors need that name a place.
pub(super) fn answer(
    arguments: &Arguments,
    traceable: &Traceable,
    origin: DVec3,
    points: &[PointQuery],
) -> Result<Answered, Failure> {
    match arguments.query {
        Question::Search(search) => answer_search(arguments, search, traceable, points),
        Question::SignedDistance => answer_side(arguments, traceable, origin, |solid| {
            PointsAnswer::Signed(points.par_iter().map(|query| solid.closest(query.point)).collect())
        }),
        Question::Inside => answer_side(arguments, traceable, origin, |solid| {
            PointsAnswer::Inside(points.par_iter().map(|query| solid.contains(query.point)).collect())
        }),
    }
}

fn answer_search(
    arguments: &Arguments,
    search: PointSearch,
    traceable: &Traceable,
    points: &[PointQuery],
) -> Result<Answered, Failure> {
    let options = TraceOptions { counters: arguments.stats };
    let start = Instant::now();
    let (answer, totals, device_time) = match search {
        PointSearch::Closest => {
            let GpuPoints { answers, device_time } =
                traceable.closest_points_timed(arguments.walk(), points, options)?;
            complete::check(&answers.status, "points")?;
            let totals = answers.counters.map(|counters| counters.iter().collect());
            (PointsAnswer::Closest(answers.points), totals, device_time)
        }
        PointSearch::Nearest => {
            let (lists, totals, device_time) = nearest(arguments, traceable, points, options)?;
            (PointsAnswer::Nearest(lists), totals, device_time)
        }
    };
    Ok(Answered { answer, totals, device_time, surface: None, time: start.elapsed() })
}

/// Answers, of 36 bytes each, that a piece of a batch has at most: with a large `k` a batch is answered in pieces, so
/// that lists that memory does not hold are an error before they are a catastrophe.
const ANSWERS_AT_A_TIME: usize = 1 << 24;

/// More points than this in a piece keep no more threads at work.
const POINTS_AT_A_TIME: usize = 1 << 18;

/// How many points to answer at a time, when each gets at most `k` of so many triangles.
fn piece(k: usize, triangles: usize) -> usize {
    (ANSWERS_AT_A_TIME / k.min(triangles).max(1)).clamp(1, POINTS_AT_A_TIME)
}

type Nearest = (NearestLists, Option<CounterTotals>, Option<Duration>);

fn nearest(
    arguments: &Arguments,
    traceable: &Traceable,
    points: &[PointQuery],
    options: TraceOptions,
) -> Result<Nearest, Failure> {
    let k = arguments.k();
    let mut lists = NearestLists { offsets: vec![0], points: Vec::new() };
    let (mut totals, mut device_time) = (options.counters.then(CounterTotals::default), None);
    for points in points.chunks(piece(k, traceable.structure().triangles().len())) {
        let GpuPoints { answers, device_time: time } =
            traceable.nearest_points_timed(arguments.walk(), k, points, options)?;
        complete::check(&answers.status, "points")?;
        append(&mut lists, &answers.points)?;
        if let Some(totals) = &mut totals {
            answers.counters.iter().flatten().for_each(|counters| *totals += counters);
        }
        if let Some(time) = time {
            *device_time.get_or_insert(Duration::ZERO) += time;
        }
    }
    Ok((lists, totals, device_time))
}

fn append(lists: &mut NearestLists, more: &NearestLists) -> Result<(), Failure> {
    let before = lists.points.len() as u64;
    lists.points.try_reserve(more.points.len()).map_err(|_| {
        Failure::failed(format!(
            "there is no memory for {} answers: ask with a smaller --k, with a --max-distance, or about fewer points \
             at a time",
            lists.points.len() + more.points.len()
        ))
    })?;
    lists.points.extend(&more.points);
    lists.offsets.extend(more.offsets.iter().skip(1).map(|end| before + end));
    Ok(())
}

fn answer_side(
    arguments: &Arguments,
    traceable: &Traceable,
    origin: DVec3,
    ask: impl FnOnce(&SignedDistance<'_>) -> PointsAnswer,
) -> Result<Answered, Failure> {
    let structure = traceable.structure();
    let Structure::Bvh(bvh) = structure else {
        // Refused before it was built; said again by the one who knows what to say.
        let device = traceable.device().kind();
        arguments.query.check(structure.kind(), arguments.walk(), device, arguments.k())?;
        return Err(Failure::usage(format!("--query {} needs --structure bvh", arguments.query)));
    };
    let start = Instant::now();
    let solid = SignedDistance::new(bvh)
        .map_err(|error| Failure::failed(format!("{}: {}", arguments.scene, told(&error, origin))))?;
    let surface = ClosedSurface { volume: solid.volume(), time: start.elapsed() };
    if surface.volume < 0.0 {
        note(
            "the triangles face inwards, so what they enclose counts as outside: turn them for the other signs",
        );
    }
    let start = Instant::now();
    let answer = ask(&solid);
    Ok(Answered { answer, totals: None, device_time: None, surface: Some(surface), time: start.elapsed() })
}

/// Why a surface has no inside, in the words of the command line and at its place in the world.
fn told(error: &SurfaceError, origin: DVec3) -> String {
    let SurfaceError { edges, open, flipped, crowded, from, to, left_out, .. } = error;
    let defects = [
        (open, "have a triangle on one side only"),
        (flipped, "lie between two triangles that face opposite ways"),
        (crowded, "have more than two triangles"),
    ];
    let defects: Vec<String> = defects
        .into_iter()
        .filter(|(count, _)| **count > 0)
        .map(|(count, what)| format!("{} {what}", thousands(*count)))
        .collect();
    let left_out = match left_out {
        0 => String::new(),
        count => format!(", and {} damaged triangles were left out", thousands(*count)),
    };
    // In f64 only where that says more: its digits of a f32 are many and tell nothing.
    let in_world = |end: &Vec3| {
        if origin == DVec3::ZERO { end.to_string() } else { (origin + end.as_dvec3()).to_string() }
    };
    let (from, to) = (in_world(from), in_world(to));
    format!(
        "the surface has no inside: of its {} edges {}; one of them runs from {from} to {to}{left_out}. Close the \
         holes, turn triangles so that all face outwards, remove what is there twice, or ask with --query \
         closest-point for the distance without a sign",
        thousands(*edges),
        defects.join(" and ")
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use ropewalk::{BuildOptions, ClosestPoint, Mesh, Scene};

    #[test]
    fn pieces_hold_what_memory_holds() {
        assert_eq!(piece(8, 1_000_000), POINTS_AT_A_TIME);
        assert_eq!(piece(usize::MAX, 0), POINTS_AT_A_TIME);
        assert_eq!(piece(usize::MAX, 12), POINTS_AT_A_TIME);
        assert_eq!(piece(1 << 14, usize::MAX), 1 << 10);
        assert_eq!(piece(usize::MAX, usize::MAX), 1);
    }

    #[test]
    fn pieces_are_one_list_in_the_end() {
        let points = |count: u32| -> Vec<ClosestPoint> {
            (0..count).map(|primitive_index| ClosestPoint { primitive_index, ..ClosestPoint::NONE }).collect()
        };
        let mut lists = NearestLists { offsets: vec![0], points: vec![] };
        append(&mut lists, &NearestLists { offsets: vec![0, 2, 2], points: points(2) }).unwrap();
        append(&mut lists, &NearestLists { offsets: vec![0], points: vec![] }).unwrap();
        append(&mut lists, &NearestLists { offsets: vec![0, 0, 3], points: points(3) }).unwrap();
        assert_eq!(lists.offsets, [0, 2, 2, 2, 5]);
        assert_eq!(lists.points, [points(2), points(3)].concat());
    }

    #[test]
    fn an_open_surface_is_told_at_its_place_with_what_is_wrong_alone() {
        let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
        let open = Mesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2]]);
        let bvh = Scene::from_mesh(open).build(&BuildOptions::default()).unwrap();
        let mut error = SignedDistance::new(&bvh).unwrap_err();
        let text = told(&error, DVec3::splat(1e8));
        assert!(text.contains("of its 6 edges 3 have a triangle on one side only; one"), "{text}");
        assert!(text.contains("10000000"), "{text}");
        assert!(!text.contains("more than two") && !text.contains("left out"), "{text}");
        (error.crowded, error.left_out) = (1234, 2);
        let text = told(&error, DVec3::ZERO);
        assert!(text.contains("side only and 1,234 have more than two triangles; one"), "{text}");
        assert!(text.contains(", and 2 damaged triangles were left out. Close"), "{text}");
    }
}
