//! Openers that halve boxes, and some that should not be trusted.

use super::*;
use glam::Vec3;

/// Boxes that are halved along their longest axis, down to a depth: the parts of part `n` are `2 n` and `2 n + 1`.
struct Halves {
    levels: u32,
}

impl Openable for Halves {
    fn open(&self, entry: &OpenEntry) -> Option<[OpenEntry; 2]> {
        if entry.node.ilog2() >= self.levels {
            return None;
        }
        let size = entry.bounds.size();
        let axis = (0..3).max_by(|&a, &b| size[a].total_cmp(&size[b]))?;
        let (mut below, mut above) = (*entry, *entry);
        let middle = entry.bounds.center()[axis];
        (below.bounds.max[axis], above.bounds.min[axis]) = (middle, middle);
        (below.node, above.node) = (2 * entry.node, 2 * entry.node + 1);
        Some([below, above])
    }
}

fn whole(instance: u32, min: Vec3, max: Vec3) -> OpenEntry {
    OpenEntry { instance, node: 1, bounds: Aabb::new(min, max) }
}

/// A floor, and small things that stand on it and reach into its box.
fn on_a_floor() -> Vec<OpenEntry> {
    let thing = |i: u32| {
        let low = Vec3::new((i % 20) as f32, 0.0, (i / 20) as f32) + 0.1;
        whole(i, low, low + Vec3::new(0.6, 2.0, 0.6))
    };
    let mut entries: Vec<OpenEntry> = (0..400).map(thing).collect();
    entries.push(whole(400, Vec3::ZERO, Vec3::new(20.0, 1.0, 20.0)));
    entries
}

/// Whether every instance is there, with parts that make up the whole, none twice.
fn check(before: &[OpenEntry], after: &[OpenEntry]) {
    for entry in before {
        let mut parts: Vec<u32> =
            after.iter().filter(|part| part.instance == entry.instance).map(|part| part.node).collect();
        parts.sort_unstable();
        let share: f64 = parts.iter().map(|&node| 0.5_f64.powi(node.ilog2() as i32)).sum();
        assert!(parts.windows(2).all(|two| two[0] != two[1]) && share == 1.0, "{entry:?}: {parts:?}");
    }
    assert!(after.iter().all(|part| before.iter().any(|entry| entry.instance == part.instance)));
}

#[test]
fn what_others_stand_in_is_opened() {
    let entries = on_a_floor();
    let opened = rebraid(entries.clone(), 30, &Halves { levels: 8 });
    check(&entries, &opened);
    assert_eq!(opened.len(), 431);
    assert_eq!(opened.iter().filter(|part| part.instance == 400).count(), 31, "the floor alone");
    assert_eq!(opened, rebraid(entries, 30, &Halves { levels: 8 }));
}

#[test]
fn what_stands_alone_and_is_solid_stays_whole() {
    let apart = |i: u32| whole(i, Vec3::X * 3.0 * i as f32, Vec3::X * 3.0 * i as f32 + 1.0);
    let mut entries: Vec<OpenEntry> = (0..300).map(apart).collect();
    assert_eq!(rebraid(entries.clone(), 1000, &Halves { levels: 8 }), entries);
    // Parts of one instance are no neighbours.
    entries.iter_mut().for_each(|entry| entry.instance = 7);
    entries.push(OpenEntry { node: 2, ..entries[5] });
    assert_eq!(rebraid(entries.clone(), 1000, &Halves { levels: 8 }), entries);
}

/// A beam across the scene in steps: the boxes of its halves are half as large in all directions.
#[test]
fn what_is_thin_and_askew_is_opened_although_it_is_alone() {
    struct Diagonal;
    impl Openable for Diagonal {
        fn open(&self, entry: &OpenEntry) -> Option<[OpenEntry; 2]> {
            let (middle, mut below, mut above) = (entry.bounds.center(), *entry, *entry);
            (below.bounds.max, above.bounds.min) = (middle, middle);
            (below.node, above.node) = (2 * entry.node, 2 * entry.node + 1);
            (entry.node < 64).then_some([below, above])
        }
    }
    let entries = vec![whole(0, Vec3::ZERO, Vec3::ONE * 8.0)];
    let opened = rebraid(entries.clone(), 12, &Diagonal);
    check(&entries, &opened);
    assert_eq!(opened.len(), 13);
    let area = |entries: &[OpenEntry]| entries.iter().map(|entry| entry.bounds.half_area()).sum::<f32>();
    assert!(area(&opened) < 0.12 * area(&entries));
}

/// A foot and a pole, halved: the halves are larger than the whole, what they consist of is not.
#[test]
fn what_lies_below_large_halves_is_seen() {
    struct Lamp;
    impl Openable for Lamp {
        fn open(&self, entry: &OpenEntry) -> Option<[OpenEntry; 2]> {
            let part = |node, min: [f32; 3], max: [f32; 3]| OpenEntry {
                node,
                bounds: Aabb::new(min.into(), max.into()),
                ..*entry
            };
            match entry.node {
                1 => Some([part(2, [0.0; 3], [5.0, 10.0, 10.0]), part(3, [5.0, 0.0, 0.0], [10.0; 3])]),
                2 => Some([part(4, [0.0; 3], [5.0, 0.1, 10.0]), part(5, [0.0; 3], [0.1, 10.0, 0.1])]),
                3 => Some([part(6, [5.0, 0.0, 0.0], [10.0, 0.1, 10.0]), part(7, [9.9; 3], [10.0; 3])]),
                _ => None,
            }
        }
    }
    let entries = vec![whole(0, Vec3::ZERO, Vec3::ONE * 10.0)];
    let opened = rebraid(entries.clone(), 9, &Lamp);
    check(&entries, &opened);
    assert_eq!(opened.len(), 4);
}

#[test]
fn budgets_are_kept() {
    let same = vec![
        whole(0, Vec3::ZERO, Vec3::ONE),
        whole(1, Vec3::ZERO, Vec3::ONE),
        whole(2, Vec3::ZERO, Vec3::ONE),
    ];
    for entries in [on_a_floor(), same, on_a_floor()[399..].to_vec(), vec![]] {
        for budget in [0, 1, 2, 7, 50, usize::MAX] {
            let opened = rebraid(entries.clone(), budget, &Halves { levels: 6 });
            check(&entries, &opened);
            assert!(opened.len() - entries.len() <= budget);
        }
    }
}

#[test]
fn subdividing_is_blind() {
    let entries = on_a_floor();
    for (parts, expected) in [(0, 1), (1, 1), (2, 2), (7, 7), (64, 64), (usize::MAX, 64)] {
        let opened = subdivide(entries.clone(), parts, &Halves { levels: 6 });
        check(&entries, &opened);
        assert_eq!(opened.len(), expected * entries.len());
    }
}

/// An opener that gives what cannot be built over, or never ends, does no harm.
#[test]
fn bad_openers_do_no_harm() {
    struct Nowhere;
    impl Openable for Nowhere {
        fn open(&self, entry: &OpenEntry) -> Option<[OpenEntry; 2]> {
            Some([*entry, OpenEntry { bounds: Aabb::EMPTY, ..*entry }])
        }
    }
    struct Endless;
    impl Openable for Endless {
        fn open(&self, entry: &OpenEntry) -> Option<[OpenEntry; 2]> {
            Some([*entry, *entry])
        }
    }
    let mut entries = on_a_floor();
    entries.push(OpenEntry { bounds: Aabb::EMPTY, ..entries[3] });
    assert_eq!(rebraid(entries.clone(), 90, &Nowhere).len(), entries.len());
    assert_eq!(subdivide(entries.clone(), 9, &Nowhere), entries);
    assert!(rebraid(entries.clone(), 90, &Endless).len() <= entries.len() + 90);
    assert_eq!(subdivide(entries[..2].to_vec(), 9, &Endless).len(), 18);
}
