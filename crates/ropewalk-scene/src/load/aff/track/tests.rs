use super::*;
use std::f64::consts::FRAC_1_SQRT_2;

fn keys(rows: &[[f64; 7]]) -> Vec<Key<DVec3>> {
    let key = |&[time, x, y, z, tension, continuity, bias]: &[f64; 7]| Key {
        time,
        value: DVec3::new(x, y, z),
        tension,
        continuity,
        bias,
    };
    rows.iter().map(key).collect()
}

fn turns(rows: &[[f64; 8]]) -> RotationTrack {
    let key = |&[time, x, y, z, degrees, tension, continuity, bias]: &[f64; 8]| Key {
        time,
        value: (DVec3::new(x, y, z), degrees),
        tension,
        continuity,
        bias,
    };
    RotationTrack::new(&rows.iter().map(key).collect::<Vec<_>>()).unwrap()
}

const CURVE: [[f64; 7]; 5] = [
    [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [2.0, 3.0, 2.0, 0.0, 0.5, 0.25, -0.5],
    [4.0, 4.0, 1.0, 1.0, 0.0, 0.0, 1.0],
    [5.0, 4.0, 0.0, 0.0, 0.0, 0.0, 0.0],
];

const TURNS: [[f64; 8]; 5] = [
    [0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [2.0, 0.0, 1.0, 0.0, 90.0, 0.0, 0.0, 0.0],
    [3.0, 1.0, 0.0, 0.0, 90.0, 0.5, 0.0, 0.0],
    [4.0, 1.0, 0.0, 0.0, 90.0, 0.0, 0.0, 0.0],
];

#[test]
fn tangents_have_the_values_worked_out_by_hand() {
    let keys = keys(&CURVE);
    let tangents = |time: f64| {
        let segment = Segment::at(&keys, time).unwrap();
        let [a, b, c, d] = segment.keys.map(|key| key.value);
        segment.tangents([b - a, c - b, d - c])
    };
    let near = |one: DVec3, other: [f64; 3]| one.distance(DVec3::from(other)) < 1e-7;
    let (outgoing, incoming) = tangents(1.0);
    assert!(near(outgoing, [1.5, 1.0, 0.0]) && near(incoming, [0.4375, -0.1875, 0.3125]));
    let (outgoing, incoming) = tangents(3.0);
    assert!(near(outgoing, [0.791_666_7, 0.041_666_7, 0.375]));
    assert!(near(incoming, [4.0 / 3.0, -4.0 / 3.0, 4.0 / 3.0]));
}

#[test]
fn positions_run_along_the_curve() {
    let track = VectorTrack::new(keys(&CURVE)).unwrap();
    for (time, x, y, z) in [
        (-7.0, 1.0, 0.0, 0.0),
        (0.5, 1.0, 0.0, 0.0),
        (1.0, 1.0, 0.0, 0.0),
        (1.25, 1.502_929_69, 0.461_914_06, -0.014_648_44),
        (1.5, 2.132_812_5, 1.148_437_5, -0.039_062_5),
        (2.0, 3.0, 2.0, 0.0),
        (2.5, 3.205_078_12, 1.912_109_38, 0.146_484_38),
        (3.0, 3.432_291_67, 1.671_875, 0.380_208_33),
        (4.0, 4.0, 1.0, 1.0),
        (9.0, 4.0, 1.0, 1.0),
    ] {
        let found = track.at(time);
        assert!(found.distance(DVec3::new(x, y, z)) < 1e-8, "{time}: {found}");
    }
}

#[test]
fn rotations_run_along_the_curve() {
    let track = turns(&TURNS);
    for (time, w, x, y, z) in [
        (1.0, 1.0, 0.0, 0.0, 0.0),
        (1.5, 0.908_076, -0.066_483, 0.413_496, 0.0),
        (2.0, FRAC_1_SQRT_2, 0.0, FRAC_1_SQRT_2, 0.0),
        (2.25, 0.737_023, 0.191_896, 0.648_053, 0.0),
        (2.5, 0.778_203, 0.449_343, 0.438_738, 0.0),
        (3.0, FRAC_1_SQRT_2, FRAC_1_SQRT_2, 0.0, 0.0),
        (8.0, FRAC_1_SQRT_2, FRAC_1_SQRT_2, 0.0, 0.0),
    ] {
        let found = track.at(time);
        let expected = Quaternion { w, v: DVec3::new(x, y, z) };
        let distance = (found.w - w).abs() + found.v.distance(expected.v);
        assert!(distance < 2e-6, "{time}: {found:?}");
    }
}

#[test]
fn inner_keys_are_reached() {
    let keys = keys(&CURVE);
    let track = VectorTrack::new(keys.clone()).unwrap();
    for key in keys.get(1..4).unwrap() {
        assert!(track.at(key.time).distance(key.value) < 1e-12);
    }
    let track = turns(&TURNS);
    for key in track.keys.get(1..4).unwrap() {
        assert!((track.at(key.time).dot(key.value).abs() - 1.0).abs() < 1e-12);
    }
}

#[test]
fn times_that_go_back_take_the_first_segment_that_ends_later() {
    let mut rows = [[0.0; 7]; 8];
    for (row, (time, x)) in rows.iter_mut().zip([
        (0.0, 0.0),
        (1.0, 1.0),
        (2.0, 2.0),
        (5.0, 3.0),
        (3.0, 9.0),
        (4.0, 9.0),
        (6.0, 6.0),
        (7.0, 7.0),
    ]) {
        (row[0], row[1]) = (time, x);
    }
    let keys = keys(&rows);
    let start = |time: f64| Segment::at(&keys, time).unwrap().start;
    assert_eq!([1.5, 2.0, 3.5, 4.9, 5.0, 6.0].map(start), [1, 2, 2, 2, 5, 5]);
    assert!(VectorTrack::new(keys).unwrap().at(3.5).is_finite());
}

#[test]
fn equal_times_make_no_nan() {
    let mut rows = CURVE;
    for row in &mut rows {
        row[0] = 1.0;
    }
    let track = VectorTrack::new(keys(&rows)).unwrap();
    for time in [0.0, 1.0, 2.0] {
        assert!(track.at(time).is_finite());
    }
}

#[test]
fn three_keys_are_too_few() {
    assert_eq!(VectorTrack::new(keys(&CURVE[..3])), None);
    assert_eq!(RotationTrack::new(&[]), None);
}

#[test]
fn visibility_holds_until_the_next_key() {
    let track = VisibilityTrack(vec![(0.5, false), (2.0, true)]);
    assert_eq!([0.0, 0.5, 1.9, 2.0, 9.0].map(|time| track.at(time)), [true, false, false, true, true]);
}
