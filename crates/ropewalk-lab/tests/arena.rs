//! The arena as a whole, with engines of this process: who lies about one ray is found out, who fails is told, and what was
//! measured until a stop is kept.

use ropewalk::{Hit, Scene};
use ropewalk_lab::arena::{
    self, ArenaClass, ArenaError, ArenaSettings, Engine, EngineError, Grade, Mode, RaySet, RowKind, Shape,
    Stage, Tracer, WallClock,
};
use ropewalk_testkit::meshes;
use std::ops::{ControlFlow, Range};
use std::sync::atomic::{AtomicUsize, Ordering};

const RAYS: usize = 3_000;

/// Our own engine, but of the ray number `lie` it says that it hits nothing.
struct Liar {
    honest: Box<dyn Engine>,
    lie: Option<usize>,
}

struct LiarTracer {
    honest: Box<dyn Tracer>,
    lie: Option<usize>,
}

impl Engine for Liar {
    fn name(&self) -> &str {
        "liar"
    }

    fn preset(&self) -> &str {
        if self.lie.is_some() { "one ray" } else { "unable" }
    }

    fn is_peer(&self) -> bool {
        true
    }

    fn grade(&self) -> Grade {
        Grade::Balanced
    }

    fn build(&self, shape: &Shape, threads: usize) -> Result<Box<dyn Tracer>, EngineError> {
        if self.lie.is_none() {
            return Err(self.error("it cannot"));
        }
        Ok(Box::new(LiarTracer { honest: self.honest.build(shape, threads)?, lie: self.lie }))
    }
}

impl Tracer for LiarTracer {
    fn bytes(&self) -> Option<usize> {
        self.honest.bytes()
    }

    fn modes(&self) -> &[Mode] {
        self.honest.modes()
    }

    fn closest(&self, mode: Mode, rays: &RaySet, range: Range<usize>, hits: &mut [Hit]) {
        self.honest.closest(mode, rays, range.clone(), hits);
        if let Some(lie) = self.lie.filter(|lie| range.contains(lie)) {
            hits[lie - range.start] = Hit::MISS;
        }
    }

    fn any(&self, mode: Mode, rays: &RaySet, range: Range<usize>, hits: &mut [bool]) {
        self.honest.any(mode, rays, range, hits);
    }
}

fn stage() -> Stage {
    let shape = Shape::new(&Scene::from_mesh(meshes::icosphere(4))).unwrap();
    Stage { name: "ball".into(), shape, turn: None, viewpoint: None }
}

fn settings() -> ArenaSettings {
    ArenaSettings {
        kinds: vec![RowKind::Trace, RowKind::Build, RowKind::Refit],
        classes: vec![ArenaClass::Primary, ArenaClass::Shadow],
        threads: vec![1, 2],
        rounds: 2,
        build_rounds: 1,
        rays: RAYS,
        seed: 1,
    }
}

fn honest() -> Box<dyn Engine> {
    arena::ours::engines().remove(0)
}

#[test]
fn who_lies_about_one_ray_is_found_out_and_who_fails_is_told() {
    // The middle of a picture 55 pixels wide: the ball is there.
    let lie = 27 * 55 + 27;
    let engines: Vec<Box<dyn Engine>> = vec![
        honest(),
        Box::new(Liar { honest: honest(), lie: Some(lie) }),
        Box::new(Liar { honest: honest(), lie: None }),
    ];
    let go_on = |_: &str| ControlFlow::Continue(());
    let record = arena::run(&stage(), &engines, &settings(), &WallClock::new(), &go_on).unwrap();
    assert_eq!(record.failures, ["liar unable: it cannot"]);
    for row in record.rows.iter().filter(|row| row.kind == RowKind::Trace) {
        let verdict = row.agreement.unwrap();
        let lies = usize::from(row.engine == "liar" && row.rays == "primary");
        assert_eq!((verdict.missed, verdict.differing, verdict.suspect()), (lies, lies, lies), "{row:?}");
        assert!(row.mrays_per_s.is_some_and(|rate| rate > 0.0));
        assert!(row.ratio_to_best_peer.is_some() && row.best_peer.as_ref().unwrap().contains("liar"));
    }
    let count = |kind| record.rows.iter().filter(|row| row.kind == kind).count();
    // Two engines, two ways, two classes, two numbers of threads.
    assert_eq!((count(RowKind::Trace), count(RowKind::Build), count(RowKind::Refit)), (16, 4, 2));
    assert_eq!(record.wrong_answers_of_ours().count(), 0);
    let text = arena::markdown(&[record]);
    assert!(text.contains("primary: 1 missed"), "{text}");
}

#[test]
fn a_stopped_run_keeps_what_is_whole() {
    let steps = AtomicUsize::new(0);
    let stop = |_: &str| match steps.fetch_add(1, Ordering::Relaxed) {
        // One engine is built; of the first class one way is compared and timed twice, the other likewise.
        count if count < 9 => ControlFlow::Continue(()),
        _ => ControlFlow::Break(()),
    };
    let record = arena::run(&stage(), &[honest()], &settings(), &WallClock::new(), &stop).unwrap();
    assert_eq!(record.rows.len(), 2, "{record:?}");
    assert!(record.rows.iter().all(|row| row.threads == 1 && row.ratio_to_best_peer.is_none()));
}

/// Engines that have a level over copies place them, and find the same among them.
#[test]
fn copies_are_placed_and_traced_alike() {
    let engines: Vec<Box<dyn Engine>> =
        arena::ours::engines().into_iter().filter(|engine| engine.grade() == Grade::Balanced).collect();
    let settings =
        ArenaSettings { kinds: vec![RowKind::TopLevel], threads: vec![1], rounds: 1, ..settings() };
    let go_on = |_: &str| ControlFlow::Continue(());
    let record = arena::run(&stage(), &engines, &settings, &WallClock::new(), &go_on).unwrap();
    assert_eq!(record.failures, [""; 0]);
    for name in ["ropewalk bvh8", "ropewalk wide-bvh"] {
        let rows = |kind| record.rows.iter().filter(|row| row.engine == name && row.kind == kind).count();
        // Two numbers of copies; two sets of rays, in two ways.
        assert_eq!((rows(RowKind::TopLevel), rows(RowKind::Trace)), (2, 4), "{name}");
    }
}

#[test]
fn an_empty_scene_is_an_error() {
    let shape = Shape::new(&Scene::default()).unwrap();
    let stage = Stage { name: "nothing".into(), shape, turn: None, viewpoint: None };
    let go_on = |_: &str| ControlFlow::Continue(());
    let nothing = arena::run(&stage, &[honest()], &settings(), &WallClock::new(), &go_on);
    assert!(matches!(nothing, Err(ArenaError::Empty)));
}
