//! The scenes of the benchmark at several times. The expected values come from an evaluation in f64 of its own.

use super::assemble::assemble;
use super::document::{Document, standing};
use super::parse::parse;
use crate::Model;
use crate::load::source::Source;
use glam::DVec3;
use std::path::Path;

/// `None`, with a message, where the collection is not there.
fn document(name: &str) -> Option<Document> {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/scenes"));
    if !folder.is_dir() {
        println!("skipped: there is no scene collection at {}", folder.display());
        return None;
    }
    Some(parse(&Source::open(&folder.join(name)).unwrap()).unwrap())
}

const ROBOT: &str = "bart_robot/Robot.aff";
const KITCHEN: &str = "bart_kitchen/kitchen.aff";
const MUSEUM: &str = "bart_museum/museum5.aff";

/// The distance from a point to the nearest vertex of an object at a time.
fn nearest(document: &Document, path: &str, time: f64, at: DVec3) -> f64 {
    let standings = document.standings(time);
    let mut nearest = f64::INFINITY;
    for (node, part) in &document.rigid {
        if node.map_or("", |node| document.nodes[node].path.as_str()) != path {
            continue;
        }
        let to_world = standing(&standings, *node).to_world;
        for &position in &part.positions {
            nearest = nearest.min(to_world.transform_point3(position).distance(at));
        }
    }
    nearest
}

/// Path, time, and where a vertex is then.
type Positions = [(&'static str, f64, [f64; 3])];

const ROBOT_POSITIONS: &Positions = &[
    ("robot_transl1/step_transl1/robot_rot1", -5.0, [-3.89074, 3.81149, -235.03835]),
    ("robot_transl1/step_transl1/robot_rot1", 0.0, [-3.89074, 3.81149, -235.03835]),
    ("robot_transl1/step_transl1/robot_rot1", 12.5, [-6.62145, 3.88927, -172.59883]),
    ("robot_transl1/step_transl1/robot_rot1", 25.0, [-6.27137, 4.03371, -110.17974]),
    ("robot_transl1/step_transl1/robot_rot1", 37.5, [-5.09052, 4.11149, -47.69822]),
    ("robot_transl1/step_transl1/robot_rot1", 45.9, [-3.78335, 3.91075, -5.70118]),
    ("robot_transl1/step_transl1/robot_rot1", 46.0198, [-3.77666, 3.90415, -5.10222]),
    ("robot_transl1/step_transl1/robot_rot1", 50.0, [-3.83844, 3.81149, -5.10222]),
    (TOES_1, 0.0, [-8.24764, 0.52669, -235.31134]),
    (TOES_1, 12.5, [-10.99284, 0.80853, -172.40110]),
    (TOES_1, 25.0, [-10.68813, 0.47619, -112.90088]),
    (TOES_1, 50.0, [-8.20380, 0.52669, -5.12989]),
    // The times of this track go back.
    ("robot_transl1/step_transl1/robot_rot1/gun_lift1/gun_rot1", 46.0, [-1.16968, 5.10732, -2.30130]),
    ("robot_transl1/step_transl1/robot_rot1/gun_lift1/gun_rot1", 47.75, [-0.91869, 5.29364, -2.20871]),
    ("robot_transl1/step_transl1/robot_rot1/gun_lift1/gun_rot1", 48.25, [-1.80473, 4.97862, -2.19051]),
    ("robot_transl2/step_transl2/robot_rot2/grip_lift2/grip_rot2", 0.0, [-1.26922, 6.97722, -230.31726]),
    ("robot_transl2/step_transl2/robot_rot2/grip_lift2/grip_rot2", 12.5, [0.97328, 5.59477, -166.47727]),
    ("robot_transl2/step_transl2/robot_rot2/grip_lift2/grip_rot2", 25.0, [-0.33323, 7.21847, -105.48790]),
    ("robot_transl2/step_transl2/robot_rot2/grip_lift2/grip_rot2", 50.0, [-1.01950, 7.20356, -2.81776]),
    ("robot_transl4/step_transl4/robot_rot4/body_lift4/head_rot4", 0.0, [-43.64996, 7.62131, -148.65525]),
    ("robot_transl4/step_transl4/robot_rot4/body_lift4/head_rot4", 12.5, [-35.19765, 9.07740, -146.95611]),
    ("robot_transl4/step_transl4/robot_rot4/body_lift4/head_rot4", 25.0, [-8.02378, 7.62131, -122.61309]),
    ("robot_transl4/step_transl4/robot_rot4/body_lift4/head_rot4", 50.0, [-3.18386, 7.69293, -8.63891]),
    ("robot_transl8/step_transl8/robot_rot8/gun_lift8/gun_rot8", 0.0, [-51.77754, 4.15642, 71.31092]),
    ("robot_transl8/step_transl8/robot_rot8/gun_lift8/gun_rot8", 12.5, [-14.45247, 4.91652, 73.85867]),
    ("robot_transl8/step_transl8/robot_rot8/gun_lift8/gun_rot8", 25.0, [-8.62315, 5.56583, 45.10357]),
    ("robot_transl8/step_transl8/robot_rot8/gun_lift8/gun_rot8", 50.0, [-9.33958, 5.01069, 1.82066]),
    (TOES_10, 0.0, [-21.42237, 1.02850, -82.98542]),
    (TOES_10, 25.0, [-2.80986, 1.00971, -64.70896]),
    (TOES_10, 37.5, [-8.04044, 2.02046, -4.48758]),
    ("", 0.0, [156.4, 0.0, -391.0]),
];
const TOES_1: &str =
    "robot_transl1/step_transl1/robot_rot1/ro_leg_rot1/ru_leg_rot1/r_heel_rot1/r_middle_rot1/r_toes_rot1";
const TOES_10: &str = "robot_transl10/step_transl10/robot_rot10/lo_leg_rot10/lu_leg_rot10/l_heel_rot10/l_middle_rot10/l_toes_rot10";

const KITCHEN_POSITIONS: &Positions = &[
    ("toycar", 0.0, [4.42116, 0.09724, 2.81732]),
    ("toycar", 5.0, [3.71209, 0.09724, 2.81266]),
    ("toycar", 9.5, [2.78525, 0.09724, 0.53657]),
    ("toycar", 15.0, [1.76049, 0.09724, 1.40214]),
    ("toycar", 19.8, [2.82121, 0.09724, 3.61250]),
    ("toycar", 20.0, [2.81732, 0.09724, 3.41442]),
    ("toycar/front_wheel_left/rotating_wheel_left", 0.0, [4.34243, 0.02060, 2.79930]),
    ("toycar/front_wheel_left/rotating_wheel_left", 7.15, [3.22364, 0.05083, 1.64880]),
    ("toycar/front_wheel_left/rotating_wheel_left", 7.165, [3.21663, 0.02153, 1.53706]),
    ("toycar/front_wheel_left/rotating_wheel_left", 12.34, [2.50600, 0.04646, 1.70536]),
    ("toycar/front_wheel_right/rotating_wheel_right", 12.34, [2.44075, 0.05196, 1.63819]),
    ("toycar/rotating_wheel_left", 12.34, [2.61349, 0.04646, 1.58599]),
    ("toycar/rotating_wheel_right", 12.34, [2.54740, 0.05196, 1.51560]),
    ("toycar/rotating_wheel_right", 20.0, [2.70224, 0.05164, 3.36006]),
    ("", 0.0, [1.30465, 0.16374, 1.13676]),
    ("", 0.0, [1.4, 0.0, 1.45]),
    ("", 0.0, [0.6, 0.84, 3.63]),
];

#[test]
fn vertices_are_where_they_are_known_to_be() {
    for (name, positions) in [(ROBOT, ROBOT_POSITIONS), (KITCHEN, KITCHEN_POSITIONS)] {
        let Some(document) = document(name) else { return };
        for &(path, time, at) in positions {
            let distance = nearest(&document, path, time, DVec3::from(at));
            assert!(distance < 1e-4, "{path} at {time}: {distance} away");
            // The comparison sees a thousandth of what the parts are wide.
            let elsewhere = DVec3::from(at) + DVec3::new(3e-4, -2e-4, 3e-4);
            assert!(nearest(&document, path, time, elsewhere) > 1e-4, "{path} at {time}");
        }
    }
}

#[test]
fn animated_triangles_are_where_they_are_known_to_be() {
    let Some(document) = document(MUSEUM) else { return };
    let [(None, triangles)] = document.deforming.as_slice() else { panic!("one object changes its shape") };
    assert_eq!(triangles.len(), 1024);
    for (index, time, corner, normal, corner_2) in [
        (
            0,
            0.0,
            [-0.4474, 1.549_333, 0.085_189],
            [-0.71836, -0.32243, -0.61644],
            [-0.434_044, 1.522_456, 0.083_665],
        ),
        (
            0,
            0.5,
            [-0.284_235, 2.460_123, 0.121_097],
            [0.98353, -0.05865, 0.17094],
            [-0.258_568, 2.515_739, 0.036_593],
        ),
        (0, 2.5, [0.48094, 2.98094, 0.48094], [0.57214, 0.57994, 0.57994], [0.438_739, 2.938_739, 0.501_416]),
        (0, 5.0, [0.0, 1.5, 0.0], [0.29402, -0.36758, -0.88229], [0.046_875, 1.575, -0.015_625]),
        (
            511,
            1.25,
            [0.177_619, 3.187_143, 0.114_311],
            [0.99891, -0.04334, -0.01751],
            [0.176_779, 3.056_128, 0.075_924],
        ),
        (
            511,
            3.9,
            [0.669_033, 2.624_752, -0.28306],
            [0.63092, -0.52927, -0.56728],
            [0.721_188, 2.633_812, -0.271_188],
        ),
        (
            1023,
            0.5,
            [0.005_015, 2.16923, 0.135_951],
            [-0.60724, -0.64093, 0.46954],
            [-0.005_222, 2.148_871, 0.055_922],
        ),
        (
            1023,
            2.5,
            [0.438_739, 1.998_584, -0.438_739],
            [0.54472, -0.63088, -0.55251],
            [0.48094, 2.01906, -0.48094],
        ),
    ] {
        let corners = triangles[index].triangle.at(time).unwrap();
        assert!(corners[0].0.distance(DVec3::from(corner)) < 1e-5, "{index} at {time}");
        assert!(corners[0].1.normalize().distance(DVec3::from(normal)) < 2e-5, "{index} at {time}");
        assert!(corners[2].0.distance(DVec3::from(corner_2)) < 1e-5, "{index} at {time}");
    }
    // At 3 they lie on a sphere, at 2 in a cube.
    let corners = |time| triangles.iter().flat_map(move |one| one.triangle.at(time).unwrap());
    let relative = |time| corners(time).map(|(position, _)| position - DVec3::new(0.0, 2.5, 0.0));
    assert!(relative(3.0).all(|at| (at.length() - 0.8).abs() < 1e-6));
    assert!(relative(2.0).all(|at| at.abs().max_element() < 0.5 + 1e-6));
}

/// Scene, time, and the smallest and largest coordinates of all triangles, their area, and the mean of their corners.
type Whole = (&'static str, f64, [f64; 3], [f64; 3], f64, [f64; 3]);

const WHOLES: &[Whole] = &[
    (
        ROBOT,
        0.0,
        [-164.148, -0.6198, -435.355],
        [164.148, 535.355, 250.097],
        1_846_573.53,
        [-7.7481, 10.1690, -47.2571],
    ),
    (
        ROBOT,
        25.0,
        [-164.148, -0.1358, -435.355],
        [164.148, 535.355, 250.097],
        1_846_573.53,
        [-0.8769, 10.3537, -32.0647],
    ),
    (
        ROBOT,
        50.0,
        [-164.148, -0.3996, -435.355],
        [164.148, 535.355, 250.097],
        1_846_573.53,
        [0.8821, 10.3085, -4.9769],
    ),
    (KITCHEN, 0.0, [-2.0, -1.1, -3.75], [6.0, 2.9, 4.33], 213.6868, [2.3632, 0.5091, 1.2136]),
    (KITCHEN, 10.0, [-2.0, -1.1, -3.75], [6.0, 2.9, 4.33], 213.6868, [2.2478, 0.5091, 1.0737]),
    (KITCHEN, 20.0, [-2.0, -1.1, -3.75], [6.0, 2.9, 4.33], 213.6106, [2.2525, 0.5091, 1.2561]),
    (MUSEUM, -1.0, [-5.0, -1.0678, -9.9384], [5.0; 3], 467.9525, [-0.0804, 0.8443, -0.2470]),
    (MUSEUM, 2.0, [-5.0, -1.0678, -9.9384], [5.0; 3], 470.3870, [-0.0806, 0.9326, -0.2470]),
    (MUSEUM, 5.0, [-5.0, -1.0678, -9.9384], [5.0; 3], 468.7956, [-0.0297, 0.9794, -0.2485]),
];

/// The first value that is not as expected.
fn difference(model: &Model, whole: &Whole) -> Option<String> {
    let &(.., min, max, area, mean) = whole;
    let (mut found_min, mut found_max) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let (mut found_area, mut sum, mut count) = (0.0, DVec3::ZERO, 0.0);
    for instance in &model.scene.instances {
        let map = instance.transform.to_world();
        for mesh in &model.scene.objects[instance.object as usize].geometries {
            for triangle in 0..mesh.triangles.len() {
                let vertices = mesh.triangle(triangle).unwrap().vertices;
                let [a, b, c] = vertices.map(|at| map.transform_point3(at).as_dvec3() + model.scene.origin);
                found_min = found_min.min(a).min(b).min(c);
                found_max = found_max.max(a).max(b).max(c);
                found_area += (b - a).cross(c - a).length() / 2.0;
                sum += a + b + c;
                count += 3.0;
            }
        }
    }
    // Four digits are given, and the model holds f32.
    let near = |one: DVec3, other: [f64; 3]| one.distance(DVec3::from(other)) < 2e-4;
    if !near(found_min, min) || !near(found_max, max) {
        return Some(format!("bounds {found_min} {found_max}"));
    }
    if (found_area / area - 1.0).abs() > 1e-6 {
        return Some(format!("area {found_area}"));
    }
    let found_mean = sum / count;
    (!near(found_mean, mean)).then(|| format!("mean {found_mean}"))
}

#[test]
fn whole_scenes_have_the_bounds_areas_and_means_that_are_known() {
    for whole in WHOLES {
        let Some(mut document) = document(whole.0) else { return };
        // The expected values leave the cylinders of the museum out.
        if whole.0 == MUSEUM {
            document = without_cones();
        }
        let model = assemble(document, whole.1);
        assert_eq!(difference(&model, whole), None, "{} at {}", whole.0, whole.1);
    }
}

/// The museum, its cylinders made comments.
fn without_cones() -> Document {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/scenes/bart_museum"));
    let copy = tempfile::tempdir().unwrap();
    for entry in std::fs::read_dir(folder).unwrap().map(Result::unwrap) {
        if !entry.file_name().to_string_lossy().ends_with(".aff") {
            continue;
        }
        let text = std::fs::read_to_string(entry.path()).unwrap();
        let lines: Vec<String> = text
            .lines()
            .map(|line| if line.trim_start().starts_with("c ") { format!("# {line}") } else { line.into() })
            .collect();
        std::fs::write(copy.path().join(entry.file_name()), lines.join("\n")).unwrap();
    }
    let document = parse(&Source::open(&copy.path().join("museum5.aff")).unwrap()).unwrap();
    assert_eq!(document.cones, 0);
    document
}

#[test]
fn the_comparison_of_wholes_objects() {
    let Some(document) = document(KITCHEN) else { return };
    let model = assemble(document, 10.0);
    let whole = &WHOLES[4];
    assert_eq!(difference(&model, whole), None);
    let mut flat = model.clone();
    flat.scene.objects[0].geometries[0].triangles.truncate(100_000);
    assert!(difference(&flat, whole).is_some());
    let mut moved = model.clone();
    moved.scene.origin.y += 0.001;
    assert!(difference(&moved, whole).is_some());
    let mut still = model;
    still.scene.instances[1].transform = ropewalk::Transform::IDENTITY;
    assert!(difference(&still, whole).is_some());
}

#[test]
fn cameras_look_where_they_are_known_to_look() {
    for (name, time, eye, forward, up) in [
        (ROBOT, 0.0, [-3.5, 2.0, -203.0], [0.05881, 0.09871, -0.99338], [-0.00584, 0.99512, 0.09853]),
        (
            ROBOT,
            7.0,
            [-2.09375, 8.70833, -182.92917],
            [0.06752, -0.16210, -0.98446],
            [0.00061, 0.98672, -0.16243],
        ),
        (
            ROBOT,
            13.0,
            [-2.08089, 11.33512, -165.35840],
            [-0.98237, -0.11573, 0.14682],
            [-0.12873, 0.98825, -0.08235],
        ),
        (ROBOT, 25.0, [-3.0, 26.0, -26.0], [0.05234, 0.0, 0.99863], [0.0, 1.0, 0.0]),
        (ROBOT, 33.0, [0.0, 23.0, 106.0], [-0.28418, -0.17950, -0.94182], [-0.05189, 0.98376, -0.17183]),
        (ROBOT, 50.0, [0.0, 80.0, 0.0], [-0.14145, -0.98505, 0.09829], [-0.93672, 0.16530, 0.30859]),
        (KITCHEN, 0.0, [3.75, 2.3, 3.6], [-0.31346, -0.41981, -0.85176], [-0.12700, 0.90744, -0.40052]),
        (
            KITCHEN,
            7.5,
            [3.87402, 0.19120, 1.04723],
            [-0.99917, 0.02169, 0.03441],
            [0.02202, 0.99971, 0.00939],
        ),
        (
            KITCHEN,
            11.25,
            [2.54539, 0.34830, 1.09915],
            [-0.99085, -0.09617, 0.09473],
            [-0.09371, 0.99515, 0.03002],
        ),
        (
            KITCHEN,
            20.0,
            [3.27488, 0.33454, 2.98028],
            [-0.71736, -0.46255, 0.52100],
            [-0.35973, 0.88633, 0.29158],
        ),
        (MUSEUM, -1.0, [0.0, 1.8, -9.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]),
        (MUSEUM, 0.0, [1.75, 2.1875, -2.38958], [-0.65868, 0.00934, 0.75237], [0.02419, 0.99967, 0.00877]),
        (MUSEUM, 1.0, [1.9375, 2.8, 2.44375], [-0.69625, -0.17575, -0.69595], [-0.07390, 0.98196, -0.17404]),
        (
            MUSEUM,
            3.8,
            [-0.27045, 1.62990, -4.66550],
            [0.02245, 0.19351, 0.98084],
            [-0.02461, 0.98090, -0.19296],
        ),
        (
            MUSEUM,
            5.0,
            [0.09517, 1.74933, -5.98824],
            [0.19035, -0.10134, -0.97647],
            [-0.01331, 0.99430, -0.10578],
        ),
    ] {
        let Some(document) = document(name) else { return };
        let view = document.view.as_ref().unwrap();
        let camera = view.camera(time, document.keyframes.get("camera"), DVec3::ZERO).unwrap();
        let near = |one: glam::Vec3, other: [f64; 3]| one.as_dvec3().distance(DVec3::from(other)) < 3e-5;
        assert!(near(camera.position, eye), "{name} at {time}: {camera:?}");
        assert!(near(camera.forward, forward) && near(camera.up, up), "{name} at {time}: {camera:?}");
    }
}

#[test]
fn single_tracks_have_the_values_that_are_known() {
    for (name, track, time, value) in [
        (ROBOT, "robot_transl1", 3.0, [-5.613_768, 0.0, -221.012_455]),
        (ROBOT, "robot_transl1", 12.5, [-7.655_794, 0.0, -173.552_856]),
        (ROBOT, "robot_transl1", 30.0, [-7.052_995, 0.0, -86.084_609]),
        (KITCHEN, "toycar", 4.0, [4.152_388, 0.0, 2.761_433]),
        (KITCHEN, "toycar", 12.34, [2.535_170, 0.0, 1.602_914]),
        (KITCHEN, "toycar", 19.8, [2.753_200, 0.0, 3.600_192]),
        (MUSEUM, "camera", 2.2, [-3.287_430, 2.157_987, 1.679_131]),
    ] {
        let Some(document) = document(name) else { return };
        let found = document.keyframes[track].translation.as_ref().unwrap().at(time);
        assert!(found.distance(DVec3::from(value)) < 2e-6, "{track} at {time}: {found}");
        if track == "toycar" && time == 19.8 {
            let scale = document.keyframes[track].scale.as_ref().unwrap();
            assert!(scale.at(19.8).distance(DVec3::new(0.542_004, 1.0, 1.0)) < 2e-6);
            assert_eq!(scale.at(3.0), DVec3::ONE);
        }
    }
}

/// The first instance or vertex that is not where it is in a model of the time itself.
fn pose_difference(name: &str, times: &[f64]) -> Option<String> {
    let animated = super::motion::animated(document(name)?);
    let span = animated.span().expect("it moves");
    for &time in times {
        let mut posed = animated.model().clone();
        animated.pose(time).unwrap().apply(&mut posed);
        let expected = assemble(document(name)?, time);
        if posed.cameras != expected.cameras {
            return Some(format!("{:?} at {time}", posed.cameras));
        }
        if posed.scene.instances != expected.scene.instances {
            return Some(format!("instances at {time}"));
        }
        let place = |light: &crate::Light| match *light {
            crate::Light::Point { position, .. } | crate::Light::Lamp { position, .. } => position,
            crate::Light::Sun { direction, .. } => direction,
        };
        assert!(posed.lights.iter().map(place).eq(expected.lights.iter().map(place)));
        if posed.scene.objects != expected.scene.objects || posed.surfaces != expected.surfaces {
            return Some(format!("shapes at {time}"));
        }
        assert!(animated.pose(time).unwrap() == animated.pose(time).unwrap());
        // The other way round the comparison must object, where anything moves.
        let other = assemble(document(name)?, span.start);
        if time != span.start && other.scene == posed.scene {
            return Some(format!("nothing moves by {time}"));
        }
    }
    None
}

#[test]
fn poses_are_what_assembling_a_time_makes() {
    for (name, times) in [
        (ROBOT, &[0.0, 12.5, 37.5, 50.0][..]),
        (KITCHEN, &[0.0, 7.165, 12.34, 19.8]),
        (MUSEUM, &[-1.0, 0.5, 2.5, 3.9]),
    ] {
        assert_eq!(pose_difference(name, times), None, "{name}");
    }
}

#[test]
fn spans_are_the_files() {
    for (name, start, end, frames, instances) in
        [(ROBOT, 0.0, 50.0, 800, 161), (KITCHEN, 0.0, 20.0, 800, 6), (MUSEUM, -1.0, 5.0, 300, 2)]
    {
        let Some(document) = document(name) else { return };
        let animated = super::motion::animated(document);
        assert_eq!(animated.span(), Some(crate::Span { start, end, frames }), "{name}");
        assert_eq!(animated.model().scene.instances.len(), instances, "{name}");
    }
}
