//! How long it takes to follow what moves: triangles that bend (refits), and copies of an object that go elsewhere (top
//! levels); and how many rays a second copies answer.

use super::building::time;
use super::record::{Peers, Sample, row};
use super::tracing::{Course, timed};
use super::{
    Answers, ArenaClass, Engine, EngineError, Mode, RaySet, Refitter, Row, RowKind, Shape, TopLevel,
};
use ropewalk::glam::{Affine3A, DVec3, Quat, Vec3};
use ropewalk::{Aabb, Hit};
use ropewalk_testkit::random::Random;
use ropewalk_testkit::rays::View;
use std::ops::ControlFlow;

/// How many copies are placed.
pub(super) const COPIES: [usize; 2] = [1_000, 10_000];
/// How many copies are traced.
pub(super) const TRACED_COPIES: usize = 1_000;
/// How far two values of `t` may lie apart, relative: engines take rays to copies and back in different ways.
const T_TOLERANCE: f32 = 1e-3;

/// Times refits: the shape bends one way and another, round after round.
pub(super) fn refits(
    course: &Course<'_>,
    engines: &[&dyn Engine],
    shape: &Shape,
    failures: &mut Vec<String>,
    go_on: &dyn Fn() -> ControlFlow<()>,
) -> Option<Vec<Row>> {
    let Ok(bent) = [0.2, 0.7].map(|phase| shape.bent(phase)).into_iter().collect::<Result<Vec<_>, _>>()
    else {
        failures.push(format!("{}: it cannot be bent", course.scene));
        return Some(Vec::new());
    };
    // A vertex that moved may leave two corners of a triangle at one point: then there is another number of triangles.
    let bent: Vec<&Shape> =
        bent.iter().filter(|bent| bent.flat().triangles.len() == shape.flat().triangles.len()).collect();
    if bent.is_empty() {
        return Some(Vec::new());
    }
    // What engines share of a shape is made now, and is no part of a refit.
    for shape in &bent {
        let _ = (shape.aligned_positions(), shape.aligned_corners());
    }
    let mut moving: Vec<(&dyn Engine, Box<dyn Refitter>)> = Vec::new();
    for engine in engines {
        match course.pool.install(|| engine.refitter(shape, course.threads)) {
            Some(Ok(refitter)) => moving.push((*engine, refitter)),
            Some(Err(error)) => failures.push(error.to_string()),
            None => {}
        }
    }
    let mut samples: Vec<Sample> = moving.iter().map(|(engine, _)| sample(*engine, Peers::All)).collect();
    // The first refit of all warms up.
    for round in 0..=course.rounds {
        for ((_, refitter), sample) in moving.iter_mut().zip(&mut samples) {
            go_on().is_continue().then_some(())?;
            let moved = bent[round % bent.len()];
            let (seconds, done) = measured(course, || refitter.refit(moved));
            match done {
                Err(error) => failures.push(error.to_string()),
                Ok(()) if round > 0 => sample.seconds.push(seconds),
                Ok(()) => {}
            }
        }
    }
    let row =
        |index: usize| row(RowKind::Refit, course.scene, course.threads, moving[index].0, &samples, index);
    Some((0..moving.len()).filter_map(row).collect())
}

/// Times top levels over copies of the shape, and rays among the copies.
pub(super) fn top_levels(
    course: &Course<'_>,
    engines: &[&dyn Engine],
    shape: &Shape,
    rays: usize,
    failures: &mut Vec<String>,
    go_on: &dyn Fn() -> ControlFlow<()>,
) -> Option<Vec<Row>> {
    let mut levels: Vec<(&dyn Engine, Box<dyn TopLevel>)> = Vec::new();
    for engine in engines {
        match course.pool.install(|| engine.top_level(shape, course.threads)) {
            Some(Ok(level)) => levels.push((*engine, level)),
            Some(Err(error)) => failures.push(error.to_string()),
            None => {}
        }
    }
    let mut rows = Vec::new();
    for count in COPIES.into_iter().rev() {
        let frames = [0, 1].map(|frame| places(&shape.bounds(), count, frame));
        let mut samples: Vec<Sample> = levels.iter().map(|(engine, _)| sample(*engine, Peers::All)).collect();
        for round in 0..=course.rounds {
            for ((_, level), sample) in levels.iter_mut().zip(&mut samples) {
                go_on().is_continue().then_some(())?;
                let (seconds, done) = measured(course, || level.place(&frames[round % 2]));
                match done {
                    Err(error) => failures.push(error.to_string()),
                    Ok(()) if round > 0 => sample.seconds.push(seconds),
                    Ok(()) => {}
                }
            }
        }
        let what = format!("{count} copies");
        rows.extend((0..levels.len()).filter_map(|index| {
            let (kind, engine) = (RowKind::TopLevel, levels[index].0);
            let row = row(kind, course.scene, course.threads, engine, &samples, index)?;
            Some(Row { rays: what.clone(), ..row })
        }));
        if count == TRACED_COPIES {
            rows.extend(rays_among_copies(course, &mut levels, &shape.bounds(), rays, failures, go_on)?);
        }
    }
    Some(rows)
}

/// Primary rays of a camera before the copies, and random chords through them. The answers are compared with those of the first
/// engine, which is ours; more than one in ten thousand that differ is worth a note.
fn rays_among_copies(
    course: &Course<'_>,
    levels: &mut [(&dyn Engine, Box<dyn TopLevel>)],
    bounds: &Aabb,
    rays: usize,
    failures: &mut Vec<String>,
    go_on: &dyn Fn() -> ControlFlow<()>,
) -> Option<Vec<Row>> {
    let places = places(bounds, TRACED_COPIES, 0);
    for (_, level) in levels.iter_mut() {
        if let Err(error) = level.place(&places) {
            failures.push(error.to_string());
        }
    }
    let around = Aabb::of_points(places.iter().map(|place| place.transform_point3(bounds.center())));
    let mut random = Random::new(5);
    let chords = (0..rays).map(|_| {
        let [from, to] = [0, 1].map(|_| random.in_box(&around, 1.2));
        let dir = (to - from).try_normalize().unwrap_or(DVec3::X);
        ropewalk::Ray::new((from - dir * 0.1).as_vec3(), dir.as_vec3())
    });
    // Both are handed over one by one: packets among copies are not measured.
    let sets = [
        ("primary among copies", RaySet::new(ArenaClass::Diffuse, View::of_bounds(&around).rays(rays))),
        ("chords among copies", RaySet::new(ArenaClass::Diffuse, chords.collect())),
    ];
    let mut rows = Vec::new();
    for (name, set) in &sets {
        let lanes: Vec<(usize, Mode)> = levels
            .iter()
            .enumerate()
            .flat_map(|(index, (_, level))| level.modes().iter().map(move |&mode| (index, mode)))
            .filter(|(_, mode)| !mode.is_packet())
            .collect();
        let mut samples: Vec<Sample> =
            lanes.iter().map(|&(index, mode)| sample(levels[index].0, Peers::Rays(mode))).collect();
        let mut answers = Answers::poisoned(set);
        let mut expected: Vec<Hit> = Vec::new();
        for round in 0..=course.rounds {
            for (&(index, mode), sample) in lanes.iter().zip(&mut samples) {
                go_on().is_continue().then_some(())?;
                let (engine, level) = &levels[index];
                let seconds = timed(course, mode, &mut answers.hits, &|range, out: &mut [Hit]| {
                    level.closest(mode, set, range, out);
                });
                if round > 0 {
                    sample.seconds.push(seconds);
                } else if expected.is_empty() {
                    expected.clone_from(&answers.hits);
                } else {
                    let differing = expected.iter().zip(&answers.hits).filter(|(a, b)| differs(a, b)).count();
                    if differing * 10_000 > set.rays.len() {
                        let (engine, all) = (engine.name(), set.rays.len());
                        failures.push(format!("{engine}: {name}: {differing} of {all} rays differ"));
                    }
                }
            }
        }
        let scene = format!("{TRACED_COPIES} x {}", course.scene);
        rows.extend(lanes.iter().enumerate().filter_map(|(at, &(index, mode))| {
            let row = row(RowKind::Trace, &scene, course.threads, levels[index].0, &samples, at)?;
            let mrays_per_s = Some(set.rays.len() as f64 / row.ms / 1e3);
            Some(Row { rays: (*name).into(), api: mode.api(), mode: mode.name(), mrays_per_s, ..row })
        }));
    }
    Some(rows)
}

fn differs(a: &Hit, b: &Hit) -> bool {
    a.is_hit() != b.is_hit() || (a.is_hit() && ((a.t - b.t).abs() > T_TOLERANCE * a.t.abs() || b.t.is_nan()))
}

/// So many places of a body in a cube of cells, turned and shaken; another frame shakes them otherwise.
fn places(bounds: &Aabb, count: usize, frame: u64) -> Vec<Affine3A> {
    let side = (1..).find(|side: &usize| side.saturating_pow(3) >= count).unwrap_or(1);
    let size = (bounds.max - bounds.min).length().max(f32::MIN_POSITIVE);
    let mut random = Random::new(17 + frame);
    (0..count)
        .map(|index| {
            let cell =
                Vec3::new((index % side) as f32, (index / side % side) as f32, (index / side / side) as f32);
            let at = (cell + random.in_cube().as_vec3() * 0.2) * size;
            let axis = random.in_cube();
            let turn = Quat::from_xyzw(axis.x as f32, axis.y as f32, axis.z as f32, 1.0).normalize();
            Affine3A::from_rotation_translation(turn, at) * Affine3A::from_translation(-bounds.center())
        })
        .collect()
}

fn measured(
    course: &Course<'_>,
    work: impl FnOnce() -> Result<(), EngineError> + Send,
) -> (f64, Result<(), EngineError>) {
    course.pool.install(|| {
        let mut done = Ok(());
        let seconds = time(course, || done = work());
        (seconds, done)
    })
}

fn sample(engine: &dyn Engine, peers: Peers) -> Sample {
    let mode = if let Peers::Rays(mode) = peers { format!(", {mode}") } else { String::new() };
    Sample {
        peers,
        label: format!("{} {}{mode}", engine.name(), engine.preset()),
        is_standard: engine.is_peer(),
        seconds: Vec::new(),
    }
}
