//! What every way to follow a scene must keep, on easy and on hard boxes.

use super::*;
use crate::{BuildOptions, Builder, Mesh, Scene};
use glam::Vec3;
use proptest::prelude::*;

/// A simple generator, the same everywhere.
struct Random(u64);

impl Random {
    fn number(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1 << 24) as f32
    }

    fn point(&mut self) -> Vec3 {
        Vec3::new(self.number(), self.number(), self.number())
    }
}

/// Boxes around random points, every thirtieth of them large.
fn scattered(count: usize, seed: u64) -> Vec<Aabb> {
    let mut random = Random(seed);
    let side = (count as f32).cbrt();
    let of = |entry: usize| {
        let low = random.point() * side;
        let scale = if entry % 30 == 7 { 0.3 * side } else { 0.8 };
        Aabb::new(low, low + random.point() * scale)
    };
    (0..count).map(of).collect()
}

/// Boxes that are hard to tell apart, to sum up, or to keep a tree over them flat.
fn hard_cases() -> Vec<(&'static str, Vec<Aabb>)> {
    let unit = Aabb::new(Vec3::ZERO, Vec3::ONE);
    let point = |place: Vec3| Aabb::new(place, place);
    let growing = |levels: i32| (0..levels).map(move |level| 1.9_f32.powi(level - levels / 2));
    vec![
        ("none", vec![]),
        ("one", vec![unit]),
        ("two", vec![unit, point(Vec3::ONE * 2.0)]),
        ("two equal", vec![unit; 2]),
        ("equal", vec![unit; 3000]),
        ("one point", vec![point(Vec3::splat(3.0)); 700]),
        ("points in a line", (0..3000).map(|i| point(Vec3::X * i as f32)).collect()),
        ("points in a plane", scattered(900, 3).iter().map(|b| point(b.min.with_y(0.0))).collect()),
        ("a chain", growing(130).map(|size| Aabb::new(Vec3::splat(size), Vec3::splat(size * 1.8))).collect()),
        ("a chain in a line", growing(130).map(|size| point(Vec3::X * size)).collect()),
        (
            "around each other",
            growing(130).map(|size| Aabb::new(Vec3::splat(-size), Vec3::splat(size))).collect(),
        ),
        ("long chains", growing(130).flat_map(|size| vec![point(Vec3::new(size, -size, 1.0)); 30]).collect()),
        (
            "huge",
            (0..500).map(|i| Aabb::new(Vec3::splat(-3e38), Vec3::splat(3e38 - i as f32 * 1e34))).collect(),
        ),
        ("tiny", (0..500).map(|i| Aabb::new(Vec3::ZERO, Vec3::splat(i as f32 * 1e-45))).collect()),
        ("scattered", scattered(1000, 1)),
        ("many", scattered(30_000, 2)),
    ]
}

/// Checks the rules, and that each leaf has its entry's box and each inner node the union of its children's.
fn check(name: &str, top: &TopLevel, boxes: &[Aabb]) {
    assert_eq!(top.validate(), Ok(()), "{name}");
    assert_eq!(top.nodes().len(), (2 * boxes.len()).saturating_sub(1), "{name}");
    assert_eq!(top.entries(), boxes.len(), "{name}");
    assert!(top.depth() <= MAX_DEPTH, "{name}");
    assert!(top.cost().is_finite(), "{name}");
    for (index, node) in top.nodes().iter().enumerate() {
        let expected = if node.is_leaf() {
            boxes[node.link as usize]
        } else {
            top.nodes()[index + 1].bounds().union(top.nodes()[node.link as usize].bounds())
        };
        assert_eq!(node.bounds(), expected, "{name}: node {index}");
    }
}

#[test]
fn hard_cases_keep_the_rules() {
    for (name, boxes) in hard_cases() {
        let mut top = TopLevel::build(&boxes).unwrap();
        check(name, &top, &boxes);
        assert_eq!(top.drift(), 1.0, "{name}");
        // Everything somewhere else, and other neighbours.
        let mut moved = scattered(boxes.len(), 17);
        top.refit(&moved).unwrap();
        check(name, &top, &moved);
        let cost = top.cost();
        top.restructure(0.0);
        check(name, &top, &moved);
        assert!(top.cost() <= cost, "{name}");
        // And as hard cases to refit to.
        moved.reverse();
        top.rebuild(&moved).unwrap();
        top.refit(&boxes).unwrap();
        check(name, &top, &boxes);
        top.restructure(0.0);
        check(name, &top, &boxes);
    }
}

#[test]
fn what_was_there_before_does_not_matter() {
    let mut top = TopLevel::default();
    for (name, boxes) in hard_cases() {
        top.rebuild(&boxes).unwrap();
        assert_eq!(top.nodes(), TopLevel::build(&boxes).unwrap().nodes(), "{name}");
        let all = 0..top.nodes().len();
        assert_eq!(top.changed(), if boxes.is_empty() { &[] } else { std::slice::from_ref(&all) }, "{name}");
        top.forget_changes();
        assert!(top.changed().is_empty());
    }
}

#[test]
fn memory_is_kept_from_frame_to_frame() {
    let mut top = TopLevel::build(&scattered(3000, 1)).unwrap();
    let place = top.nodes().as_ptr();
    for frame in 2..9 {
        top.rebuild(&scattered(3000 - 100 * frame as usize, frame)).unwrap();
        top.refit(&scattered(top.entries(), frame + 1)).unwrap();
        top.restructure(0.0);
        assert_eq!(top.nodes().as_ptr(), place);
    }
}

#[cfg(feature = "parallel")]
#[test]
fn threads_do_not_matter() {
    let boxes = scattered(60_000, 5);
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| TopLevel::build(&boxes).unwrap())
    };
    let one = with(1);
    for threads in [2, 3, 7] {
        assert_eq!(one.nodes(), with(threads).nodes(), "{threads} threads");
    }
}

#[test]
fn bad_boxes_are_errors_that_change_nothing() {
    let good = scattered(40, 9);
    let mut top = TopLevel::build(&good).unwrap();
    let nodes = top.nodes().to_vec();
    let one = Vec3::ONE;
    for bad in
        [Aabb::EMPTY, Aabb::new(one, Vec3::ZERO), Aabb::new(one * f32::NAN, one), Aabb::new(-one, one / 0.0)]
    {
        let mut boxes = good.clone();
        boxes[23] = bad;
        assert_eq!(top.rebuild(&boxes), Err(TopLevelError::Box { entry: 23 }));
        assert_eq!(top.refit(&boxes), Err(TopLevelError::Box { entry: 23 }));
        assert_eq!(top.nodes(), nodes);
    }
    assert_eq!(top.refit(&good[1..]), Err(TopLevelError::OtherCount { was: 40, is: 39 }));
    assert_eq!((top.nodes(), top.drift()), (nodes.as_slice(), 1.0));
    check("after errors", &top, &good);
}

/// The sweep builder's tree with leaves of one: each box is that of a triangle with two of its corners.
fn sweep_cost(boxes: &[Aabb]) -> f64 {
    let corners = |b: &Aabb| [b.min, b.max, Vec3::new(b.min.x, b.max.y, b.min.z)];
    let positions = boxes.iter().flat_map(corners).collect();
    let triangles = (0..boxes.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let options = BuildOptions { builder: Builder::SweepSah, max_leaf: 1, ..BuildOptions::default() };
    let bvh = Scene::from_mesh(Mesh::new(positions, triangles)).build(&options).unwrap();
    assert_eq!(bvh.nodes().len(), 2 * boxes.len() - 1);
    bvh.report().sah_cost
}

#[test]
fn trees_are_as_good_as_those_of_the_sweep() {
    for (count, seed) in [(10, 1), (100, 2), (1000, 3), (10_000, 4)] {
        let boxes = scattered(count, seed);
        let (cost, sweep) = (TopLevel::build(&boxes).unwrap().cost(), sweep_cost(&boxes));
        assert!(cost < sweep * 1.05, "{count}: {cost} and {sweep}");
    }
}

/// Of three and four entries no tree is better: compared with all of them.
#[test]
fn small_trees_are_the_best() {
    fn best(boxes: &[Aabb]) -> f64 {
        let area = |boxes: &[Aabb]| {
            let size = boxes.iter().fold(Aabb::EMPTY, |sum, &one| sum.union(one)).size().as_dvec3();
            size.x * size.y + size.y * size.z + size.z * size.x
        };
        if boxes.len() == 1 {
            return area(boxes);
        }
        let sides = (1..1_u32 << (boxes.len() - 1)).map(|members| {
            let side = |bit| -> Vec<Aabb> {
                boxes
                    .iter()
                    .enumerate()
                    .filter(|(i, _)| members >> i & 1 == bit)
                    .map(|(_, &one)| one)
                    .collect()
            };
            best(&side(0)) + best(&side(1))
        });
        area(boxes) + sides.fold(f64::INFINITY, f64::min)
    }
    for count in 2..=4 {
        for seed in 0..300 {
            let boxes = scattered(count, seed);
            let top = TopLevel::build(&boxes).unwrap();
            check("small", &top, &boxes);
            let cost = top.cost() * cost::half_area(&top.nodes()[0]);
            let best = best(&boxes);
            assert!((cost - best).abs() < 1e-5 * best, "{count} {seed}: {cost} instead of {best}");
        }
    }
}

#[test]
fn a_refit_tells_what_changed() {
    let mut boxes = scattered(4000, 6);
    let mut top = TopLevel::build(&boxes).unwrap();
    top.forget_changes();
    assert!(top.refit(&boxes).unwrap().is_empty(), "nothing moved");
    for entry in [17, 1717, 3999] {
        let before = top.nodes().to_vec();
        boxes[entry] = Aabb::new(boxes[entry].min, boxes[entry].max + 0.5);
        let changed = top.refit(&boxes).unwrap().to_vec();
        check("one moved", &top, &boxes);
        check_changes(&before, top.nodes(), &changed);
        assert!(changed.iter().map(ExactSizeIterator::len).sum::<usize>() < 1500, "{changed:?}");
        top.forget_changes();
    }
}

/// Every node that is another lies in a range; ranges are in order, do not meet, and begin and end with changes.
fn check_changes(before: &[Node], after: &[Node], changed: &[Range<usize>]) {
    assert!(changed.windows(2).all(|two| two[0].end < two[1].start), "{changed:?}");
    for (index, (was, is)) in before.iter().zip(after).enumerate() {
        assert!(was == is || changed.iter().any(|range| range.contains(&index)), "{index} {changed:?}");
    }
    assert!(changed.iter().all(|range| range.end <= after.len()));
}

#[test]
fn restructuring_mends_what_moved_and_nothing_else() {
    let mut boxes = scattered(5000, 8);
    // Entries whose centres lie in one corner of the scene are mixed up among each other.
    let corner: Vec<usize> = (0..boxes.len()).filter(|&i| boxes[i].center().max_element() < 6.0).collect();
    let mut top = TopLevel::build(&boxes).unwrap();
    let built = top.cost();
    assert_eq!(top.restructure(0.0), Restructuring::default(), "just built");
    let of: Vec<Aabb> = corner.iter().rev().map(|&entry| boxes[entry]).collect();
    corner.iter().zip(of).for_each(|(&entry, moved)| boxes[entry] = moved);
    top.refit(&boxes).unwrap();
    let (refitted, drift) = (top.cost(), top.drift());
    assert!(drift > 1.1, "{drift}");
    top.forget_changes();
    let before = top.nodes().to_vec();
    let report = top.restructure(TopLevel::TOLERANCE);
    check("restructured", &top, &boxes);
    check_changes(&before, top.nodes(), top.changed());
    assert!(report.taken > 0 && report.taken <= report.rebuilt, "{report:?}");
    assert!(report.entries < 2500, "a part of the tree: {report:?}, {} moved", corner.len());
    assert!(top.cost() < built + 0.3 * (refitted - built), "{built} {refitted} {}", top.cost());
    // What was mended is not mended again.
    let again = top.restructure(TopLevel::TOLERANCE);
    assert!(again.entries < report.entries / 4, "{again:?} after {report:?}");
}

#[test]
fn a_scene_that_is_mixed_up_is_built_anew() {
    let mut boxes = scattered(2000, 4);
    let mut top = TopLevel::build(&boxes).unwrap();
    boxes.reverse();
    top.refit(&boxes).unwrap();
    assert!(top.drift() > 2.0);
    let report = top.restructure(TopLevel::TOLERANCE);
    assert_eq!((report.rebuilt, report.taken, report.entries), (1, 1, 2000));
    check("mixed up", &top, &boxes);
    assert!((top.drift() - 1.0).abs() < 0.02, "{}", top.drift());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    /// Coordinates from few values, so that ties and flat boxes are common.
    #[test]
    fn any_boxes_keep_the_rules(
        boxes in proptest::collection::vec((any::<[i8; 3]>(), any::<[u8; 3]>()), 0..600),
        coarse in 0..7_u32,
        moves in proptest::collection::vec((any::<proptest::sample::Index>(), any::<[i8; 3]>()), 0..40),
        tolerance in 0.0..0.2_f32,
    ) {
        let step = |value: i32| (value >> coarse) as f32;
        let mut boxes: Vec<Aabb> = boxes
            .iter()
            .map(|(low, size)| {
                let low = Vec3::from(low.map(|v| step(v.into())));
                Aabb::new(low, low + Vec3::from(size.map(|v| step(v.into()))))
            })
            .collect();
        let mut top = TopLevel::build(&boxes).unwrap();
        check("built", &top, &boxes);
        if boxes.is_empty() {
            return Ok(());
        }
        top.forget_changes();
        let before = top.nodes().to_vec();
        for (entry, offset) in &moves {
            let entry = entry.index(boxes.len());
            let offset = Vec3::from(offset.map(|v| step(v.into())));
            boxes[entry] = Aabb::new(boxes[entry].min + offset, boxes[entry].max + offset);
        }
        top.refit(&boxes).unwrap();
        check("refitted", &top, &boxes);
        let cost = top.cost();
        top.restructure(tolerance);
        check("restructured", &top, &boxes);
        check_changes(&before, top.nodes(), top.changed());
        prop_assert!(top.cost() <= cost * (1.0 + 1e-12));
    }
}
