use super::*;
use glam::DMat3;
use proptest::prelude::*;
use std::collections::BTreeMap;

/// What is wrong with the triangles of a simple polygon.
fn defect(polygon: &[DVec3], triangles: &[[u32; 3]]) -> Option<String> {
    if triangles.len() + 2 != polygon.len() {
        return Some(format!("{} triangles of {} corners", triangles.len(), polygon.len()));
    }
    // What is inside is shared by two triangles, once each way; what is left is the outline.
    let corners = polygon.len() as u32;
    let mut sides: BTreeMap<[u32; 2], i32> = BTreeMap::new();
    for &[a, b, c] in triangles {
        for [from, to] in [[a, b], [b, c], [c, a]] {
            *sides.entry([from, to]).or_default() += 1;
            *sides.entry([to, from]).or_default() -= 1;
        }
    }
    for (&[from, to], &balance) in &sides {
        let expected = i32::from((from + 1) % corners == to) - i32::from((to + 1) % corners == from);
        if balance != expected {
            return Some(format!("the side {from} to {to} is there {balance} times, not {expected}"));
        }
    }
    let whole = newell_normal(polygon);
    let mut area = 0.0;
    for triangle in triangles {
        let part = newell_normal(&triangle.map(|corner| polygon[corner as usize]));
        if part.dot(whole) < -1e-6 * whole.length_squared() {
            return Some(format!("{triangle:?} winds the other way"));
        }
        area += part.length();
    }
    let error = (area - whole.length()).abs();
    (error > 1e-6 * whole.length()).then(|| format!("the area is {area}, not {}", whole.length()))
}

fn flat(corners: &[(f64, f64)]) -> Vec<DVec3> {
    corners.iter().map(|&(x, y)| DVec3::new(x, y, 0.0)).collect()
}

fn cut(polygon: &[DVec3]) -> (Vec<[u32; 3]>, bool) {
    let mut cutter = Cutter::new();
    let pieces = cutter.cut(polygon);
    (pieces.triangles.to_vec(), pieces.is_guess)
}

/// A simple polygon around the origin of a tilted plane far away.
fn star(radii: &[f64], tilt: DVec3, offset: DVec3) -> Vec<DVec3> {
    let (x, y) = tilt.normalize().any_orthonormal_pair();
    let plane = DMat3::from_cols(x, y, DVec3::ZERO);
    let step = TAU / radii.len() as f64;
    let corner = |(index, radius): (usize, &f64)| {
        let (sin, cos) = (index as f64 * step).sin_cos();
        plane * DVec3::new(radius * cos, radius * sin, 0.0) + offset
    };
    radii.iter().enumerate().map(corner).collect()
}

#[test]
fn the_checker_objects() {
    let square = flat(&[(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]);
    assert_eq!(defect(&square, &[[0, 1, 2], [0, 2, 3]]), None);
    for wrong in [&[[0, 1, 2]][..], &[[0, 1, 2], [0, 3, 2]], &[[0, 1, 2], [0, 1, 3]], &[[0, 1, 2]; 3]] {
        assert!(defect(&square, wrong).is_some(), "{wrong:?}");
    }
    let dart = flat(&[(0.0, 0.0), (2.0, 1.0), (0.0, 2.0), (1.0, 1.0)]);
    assert!(defect(&dart, &[[0, 1, 2], [0, 2, 3]]).is_some(), "a fan of a dart leaves its outline");
}

#[test]
fn convex_polygons_become_fans() {
    let radii = [1.0; 9];
    for tilt in [DVec3::Z, DVec3::NEG_Z, DVec3::X, DVec3::NEG_Y, DVec3::new(1.0, -2.0, 0.5)] {
        for corners in 3..9 {
            let polygon = star(&radii[..corners], tilt, DVec3::new(14_678.0, 0.0, 9_605.0));
            let fan: Vec<_> = (2..corners as u32).map(|corner| [0, corner - 1, corner]).collect();
            assert_eq!(cut(&polygon), (fan, false));
        }
    }
    let straight = flat(&[(0.0, 0.0), (1.0, -1e-7), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0), (0.0, 1.0)]);
    assert_eq!(cut(&straight).0[0], [0, 1, 2], "corners on a straight edge do not make it concave");
}

#[test]
fn concave_quads_are_cut_along_the_inner_diagonal() {
    let dart = [(0.0, 0.0), (2.0, 1.0), (0.0, 2.0), (1.0, 1.0)];
    for turn in 0..4 {
        let mut corners = dart;
        corners.rotate_left(turn);
        let polygon = flat(&corners);
        let (triangles, is_guess) = cut(&polygon);
        assert_eq!((defect(&polygon, &triangles), is_guess), (None, false), "{turn}");
        corners.reverse();
        let polygon = flat(&corners);
        assert_eq!(defect(&polygon, &cut(&polygon).0), None, "{turn}, clockwise");
    }
}

#[test]
fn outlines_without_a_right_answer_become_fans_and_say_so() {
    let bow_tie = flat(&[(0.0, 0.0), (2.0, 2.0), (2.0, 0.0), (0.0, 1.0)]);
    assert_eq!(cut(&bow_tie), (vec![[0, 1, 2], [0, 2, 3]], true));
    let no_normal = flat(&[(0.0, 0.0), (1.0, 1.0), (1.0, 0.0), (0.0, 1.0)]);
    assert_eq!(cut(&no_normal), (vec![[0, 1, 2], [0, 2, 3]], true));
    let pentagram = [0.0f64, 2.0, 4.0, 1.0, 3.0].map(|step| (step / 5.0 * TAU).sin_cos());
    assert_eq!(cut(&flat(&pentagram)), (vec![[0, 1, 2], [0, 2, 3], [0, 3, 4]], true));
}

#[test]
fn anything_is_cut_into_something() {
    let nan = [DVec3::ZERO, DVec3::X, DVec3::NAN, DVec3::Y, DVec3::Z];
    let infinite = [DVec3::ZERO, DVec3::X, DVec3::INFINITY, DVec3::Y, DVec3::MAX];
    for polygon in [nan, infinite, [DVec3::ONE; 5], [0.0, 3.0, 1.0, 2.0, 9.0].map(DVec3::splat)] {
        assert_eq!(cut(&polygon), (vec![[0, 1, 2], [0, 2, 3], [0, 3, 4]], false));
    }
    assert_eq!(cut(&[]).0.len() + cut(&[DVec3::ONE]).0.len() + cut(&[DVec3::X, DVec3::Y]).0.len(), 0);
}

#[test]
fn folded_quads_have_two_triangles() {
    for height in [1e-6, 0.1, 1.0, 50.0] {
        let folded = [DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, height), DVec3::Y];
        assert_eq!(cut(&folded), (vec![[0, 1, 2], [0, 2, 3]], false));
    }
}

#[test]
fn the_check_of_the_area_objects() {
    let mut cutter = Cutter::new();
    let polygon = flat(&[(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (2.0, 1.0), (0.0, 4.0)]);
    assert!(!cutter.cut(&polygon).is_guess && cutter.keeps_the_area());
    cutter.fan(5);
    assert!(!cutter.keeps_the_area(), "a fan about the first corner leaves the outline");
}

#[test]
fn slits_lead_to_holes() {
    // A square with a square hole, as exporters that know no holes write it: there along a slit, around, and back.
    let slit = [(0.0, 0.0), (6.0, 0.0), (6.0, 6.0), (0.0, 6.0), (0.0, 0.0)];
    let hole = [(2.0, 2.0), (2.0, 4.0), (4.0, 4.0), (4.0, 2.0), (2.0, 2.0)];
    let corners = [&slit[..], &hole[..]].concat();
    for turn in 0..corners.len() {
        let mut corners = corners.clone();
        corners.rotate_left(turn);
        let polygon = flat(&corners);
        let (triangles, is_guess) = cut(&polygon);
        assert_eq!((defect(&polygon, &triangles), is_guess), (None, false), "{turn}");
    }
}

#[test]
fn the_budget_ends() {
    let radii: Vec<f64> = (0..1000).map(|index| f64::from(1 + index % 2)).collect();
    let polygon = star(&radii, DVec3::Z, DVec3::ZERO);
    let mut cutter = Cutter::new();
    assert!(!cutter.cut(&polygon).is_guess);
    let cost = BUDGET - cutter.budget;
    assert!((500..1_000_000).contains(&cost), "{cost} looks");
    cutter.budget = cost * 5 / 2;
    let guesses = [0; 4].map(|_| cutter.cut(&polygon).is_guess);
    assert_eq!(guesses, [false, false, true, true]);
    assert_eq!(cutter.cut(&polygon).triangles.len(), 998, "a fan still");
}

proptest! {
    #[test]
    fn simple_polygons_keep_their_area(
        radii in prop::collection::vec(0.1..10.0f64, 3..60),
        tilt in prop::array::uniform3(-1.0..1.0f64),
        offset in prop::array::uniform3(-20_000.0..20_000.0f64),
    ) {
        let tilt = DVec3::from(tilt) + DVec3::new(0.0, 0.0, 1e-3);
        let polygon = star(&radii, tilt, offset.into());
        let (triangles, is_guess) = cut(&polygon);
        prop_assert!(!is_guess);
        prop_assert_eq!(defect(&polygon, &triangles), None);
    }

    #[test]
    fn steps_with_corners_on_straight_edges_keep_their_area(
        heights in prop::collection::vec(0..4u8, 2..30),
        turn in 0..60usize,
    ) {
        // A skyline: neighbours of equal height leave corners on a straight edge.
        let mut corners = vec![(heights.len() as f64, -1.0), (heights.len() as f64, 0.0)];
        for (index, &height) in heights.iter().enumerate().rev() {
            let (left, height) = (index as f64, f64::from(height) + 0.5);
            corners.extend([(left + 1.0, height), (left, height)]);
        }
        corners.extend([(0.0, 0.0), (0.0, -1.0)]);
        corners.dedup();
        let turn = turn % corners.len();
        corners.rotate_left(turn);
        let polygon = flat(&corners);
        let (triangles, is_guess) = cut(&polygon);
        prop_assert!(!is_guess);
        prop_assert_eq!(defect(&polygon, &triangles), None);
    }

    #[test]
    fn any_outline_becomes_two_triangles_less_than_corners(
        corners in prop::collection::vec(prop::array::uniform3(-3..3i8), 3..40),
    ) {
        let polygon: Vec<DVec3> = corners.iter().map(|corner| DVec3::from(corner.map(f64::from))).collect();
        let (triangles, _) = cut(&polygon);
        prop_assert_eq!(triangles.len(), polygon.len() - 2);
        prop_assert!(triangles.iter().flatten().all(|&corner| (corner as usize) < polygon.len()));
    }
}
