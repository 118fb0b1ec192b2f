//! Animations and skins: the scenes of the collection, small documents with known answers, and broken ones.

use crate::common::scene;
use crate::make::{data, floats, shorts};
use ropewalk::glam::{Affine3A, Vec3};
use ropewalk_scene::load::{load_animated, load_animated_bytes};
use ropewalk_scene::{Animated, LoadError};
use std::f32::consts::{FRAC_1_SQRT_2, SQRT_2};
use std::path::Path;

/// What a document is made of, so that a test can break one part.
struct Parts {
    channels: String,
    samplers: String,
    skin: String,
    nodes: String,
    attributes: String,
    times: [f32; 2],
    rotations: [f32; 8],
    joints: [u16; 12],
    weights: [f32; 12],
}

/// A triangle of which the first corner follows joint 0, the second joint 1, the third both by half. Joint 1 stands at
/// (1, 0, 0) and is turned by a quarter about z from 1 to 3 seconds; its inverse bind matrix takes that place to zero.
fn parts() -> Parts {
    Parts {
        channels: r#"{"sampler":0,"target":{"node":2,"path":"rotation"}}"#.into(),
        samplers: r#"{"input":3,"output":4}"#.into(),
        skin: r#"{"joints":[1,2],"inverseBindMatrices":5}"#.into(),
        nodes: r#"{"mesh":0,"skin":0,"translation":[7,7,7]},{"children":[2]},{"translation":[1,0,0]}"#.into(),
        attributes: r#""POSITION":0,"JOINTS_0":1,"WEIGHTS_0":2"#.into(),
        times: [1.0, 3.0],
        rotations: [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, FRAC_1_SQRT_2, FRAC_1_SQRT_2],
        joints: [0, 9, 9, 9, 1, 9, 9, 9, 0, 1, 9, 9],
        weights: [1.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.5, 0.5, 0.0, 0.0],
    }
}

impl Parts {
    fn text(&self) -> String {
        let identity = [1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1.];
        let mut moved = identity;
        moved[12] = -1.0;
        let blocks = [
            floats(&[0., 0., 0., 2., 0., 0., 2., 1., 0.]),
            shorts(&self.joints),
            floats(&self.weights),
            floats(&self.times),
            floats(&self.rotations),
            floats(&[identity, moved].concat()),
        ];
        let kinds = [
            (5126, "VEC3", 3),
            (5123, "VEC4", 3),
            (5126, "VEC4", 3),
            (5126, "SCALAR", 2),
            (5126, "VEC4", 2),
            (5126, "MAT4", 2),
        ];
        let (mut accessors, mut offset) = (Vec::new(), 0);
        for (block, (component, kind, count)) in blocks.iter().zip(kinds) {
            accessors.push(format!(
                r#"{{"bufferView":0,"byteOffset":{offset},"componentType":{component},"type":"{kind}","count":{count}}}"#
            ));
            offset += block.len();
        }
        let (accessors, bytes) = (accessors.join(","), blocks.concat());
        let Self { channels, samplers, skin, nodes, attributes, .. } = self;
        format!(
            r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"uri":"{}","byteLength":{offset}}}],
            "bufferViews":[{{"buffer":0,"byteLength":{offset}}}],"accessors":[{accessors}],
            "meshes":[{{"primitives":[{{"attributes":{{{attributes}}}}}]}}],"nodes":[{nodes}],"skins":[{skin}],
            "animations":[{{"name":"turn","channels":[{channels}],"samplers":[{samplers}]}}]}}"#,
            data(&bytes)
        )
    }

    fn load(&self) -> Animated {
        load_animated_bytes(Path::new("x.gltf"), self.text().into()).unwrap_or_else(|error| panic!("{error}"))
    }
}

fn corners(animated: &Animated, time: f64) -> Vec<Vec3> {
    let mut model = animated.model().clone();
    animated.pose(time).unwrap().apply(&mut model);
    let instance = &model.scene.instances[0];
    let mesh = &model.scene.objects[instance.object as usize].geometries[0];
    mesh.positions.iter().map(|&position| instance.transform.point(position)).collect()
}

fn near(found: &[Vec3], expected: [Vec3; 3]) -> bool {
    found.len() == 3 && found.iter().zip(expected).all(|(one, other)| one.distance(other) < 1e-6)
}

#[test]
fn vertices_follow_their_joints() {
    let animated = parts().load();
    assert!(animated.model().report.skipped.is_empty(), "{:?}", animated.model().report);
    let clip = animated.clip().unwrap();
    assert_eq!(
        (clip.name.as_str(), clip.span.start, clip.span.end, clip.span.frames),
        ("turn", 1.0, 3.0, 49)
    );
    let rest = [Vec3::ZERO, Vec3::X * 2.0, Vec3::new(2.0, 1.0, 0.0)];
    // Where the node of the mesh stands has no say.
    for time in [-1.0, 1.0] {
        assert!(near(&corners(&animated, time), rest), "{:?}", corners(&animated, time));
    }
    // A quarter about (1, 0, 0) takes (2, 0, 0) to (1, 1, 0) and (2, 1, 0) to (0, 1, 0), of which the third goes half the way.
    let turned = [Vec3::ZERO, Vec3::new(1.0, 1.0, 0.0), Vec3::new(1.0, 1.0, 0.0)];
    for time in [3.0, 30.0] {
        assert!(near(&corners(&animated, time), turned), "{:?}", corners(&animated, time));
    }
    let half = corners(&animated, 2.0);
    let eighth = Vec3::new(1.0 + SQRT_2 / 2.0, SQRT_2 / 2.0, 0.0);
    assert!(half[1].distance(eighth) < 1e-6 && !near(&half, rest), "{half:?}");
}

#[test]
fn two_skinned_nodes_of_one_mesh_are_two_objects() {
    let mut parts = parts();
    parts.nodes += r#",{"mesh":0,"skin":0},{"mesh":0}"#;
    let animated = parts.load();
    let scene = &animated.model().scene;
    let objects: Vec<u32> = scene.instances.iter().map(|instance| instance.object).collect();
    assert_eq!(objects, [1, 2, 0]);
    assert_eq!(animated.model().surfaces.len(), 3);
    assert_eq!(animated.pose(3.0).unwrap().shapes.len(), 2);
}

fn skipped(parts: &Parts) -> Vec<String> {
    let animated = parts.load();
    // What is left of it has a pose at every time.
    for time in [-1.0, 2.0, 9.0, f64::NAN, f64::INFINITY] {
        let pose = animated.pose(time).unwrap();
        assert_eq!(pose.transforms.len(), animated.model().scene.instances.len());
        assert!(pose.transforms.iter().all(|transform: &Affine3A| transform.is_finite()));
    }
    animated.model().report.skipped.iter().map(|row| row.what.clone()).collect()
}

#[test]
fn channels_that_cannot_be_read_are_left_out_and_counted() {
    let channel = |channel: &str| Parts { channels: channel.into(), ..parts() };
    let sampler = |sampler: &str| Parts { samplers: sampler.into(), ..parts() };
    for (broken, what) in [
        (channel(r#"{"sampler":1,"target":{"node":2,"path":"rotation"}}"#), "samplers that are not there"),
        (channel(r#"{"sampler":0,"target":{"node":3,"path":"rotation"}}"#), "nodes that are not there"),
        (channel(r#"{"sampler":0,"target":{"node":2,"path":"scale"}}"#), "cannot be read"),
        (channel(r#"{"sampler":0,"target":{"node":2,"path":"weights"}}"#), "morph weights"),
        (channel(r#"{"sampler":0,"target":{"node":2,"path":"pointer"}}"#), "properties that are not read"),
        (channel(r#"{"sampler":18446744073709551615,"target":{"node":2,"path":"rotation"}}"#), "not there"),
        (sampler(r#"{"input":9,"output":4}"#), "cannot be read"),
        (sampler(r#"{"input":4,"output":4}"#), "cannot be read"),
        (sampler(r#"{"input":3,"output":4,"interpolation":"CUBICSPLINE"}"#), "another number of values"),
        (sampler(r#"{"input":3,"output":4,"interpolation":"BOUNCE"}"#), "unknown interpolation"),
        (sampler(r#"{"input":3,"output":2}"#), "another number of values"),
        (Parts { times: [3.0, 1.0], ..parts() }, "do not rise"),
        (Parts { times: [1.0, 1.0], ..parts() }, "do not rise"),
        (Parts { times: [f32::NAN, 1.0], ..parts() }, "do not rise"),
        (Parts { rotations: [f32::NAN; 8], ..parts() }, "values that are no numbers"),
    ] {
        let found = skipped(&broken);
        assert!(
            found.iter().any(|row| row.starts_with("animation channels") && row.contains(what)),
            "{found:?} {what}"
        );
    }
    assert!(skipped(&channel(r#"{"sampler":0,"target":{"path":"rotation"}}"#)).is_empty());
    // A rotation of length zero hides what it turns; here nothing but joints.
    assert!(skipped(&Parts { rotations: [0.0; 8], ..parts() }).is_empty());
}

#[test]
fn skins_that_cannot_be_read_are_left_out_and_counted() {
    let skin = |skin: &str| Parts { skin: skin.into(), ..parts() };
    let attributes = |attributes: &str| Parts { attributes: attributes.into(), ..parts() };
    let mut far = parts();
    far.joints[4] = 2;
    for (broken, what) in [
        (skin(r#"{"joints":[]}"#), "without joints"),
        (skin(r#"{"joints":[1,99]}"#), "not in the scene"),
        (skin(r#"{"joints":[1,2],"inverseBindMatrices":4}"#), "matrices cannot be read"),
        (skin(r#"{"joints":[1,2],"inverseBindMatrices":77}"#), "matrices cannot be read"),
        (skin(r#"{"joints":[1,2,1],"inverseBindMatrices":5}"#), "fewer matrices than joints"),
        (far, "joints out of range"),
        (Parts { weights: [f32::NAN; 12], ..parts() }, "weights that are no numbers"),
        (Parts { weights: [-1.0; 12], ..parts() }, "weights that are no numbers"),
        (attributes(r#""POSITION":0"#), "without joints or weights"),
        (attributes(r#""POSITION":0,"JOINTS_0":0,"WEIGHTS_0":2"#), "joints cannot be read"),
        (attributes(r#""POSITION":0,"JOINTS_0":4,"WEIGHTS_0":2"#), "fewer joints or weights"),
    ] {
        let found = skipped(&broken);
        assert!(found.iter().any(|row| row.starts_with("skins") && row.contains(what)), "{found:?} {what}");
    }
    // Without any weight a vertex follows its first joint.
    assert!(skipped(&Parts { weights: [0.0; 12], ..parts() }).is_empty());
    assert!(skipped(&skin(r#"{"joints":[1,2]}"#)).is_empty());
}

#[test]
fn keys_that_unfold_too_far_are_left_out() {
    // A thousand channels of sixteen million zeros each, out of a few bytes.
    let mut parts = parts();
    let channel = r#"{"sampler":0,"target":{"node":2,"path":"translation"}}"#;
    parts.channels = [channel; 1000].join(",");
    parts.samplers = r#"{"input":6,"output":7}"#.into();
    let zeros = r#",{"componentType":5126,"type":"SCALAR","count":1600000000},{"componentType":5126,"type":"VEC3","count":1600000000}]"#;
    let text =
        parts.text().replacen("],\n            \"meshes\"", &format!("{zeros},\n            \"meshes\""), 1);
    assert!(text.contains("1600000000"));
    let animated = load_animated_bytes(Path::new("x.gltf"), text.into()).unwrap();
    let [row] = animated.model().report.skipped.as_slice() else { panic!("{:?}", animated.model().report) };
    assert!(row.what.contains("more keys") && row.count == 1000, "{row:?}");
}

#[test]
fn what_is_no_animation_is_an_error_of_its_own() {
    let broken = parts().text().replacen(r#""animations":["#, r#""animations":[7,"#, 1);
    let error = load_animated_bytes(Path::new("x.gltf"), broken.clone().into()).unwrap_err();
    assert!(
        matches!(error, LoadError::Malformed { .. }) && error.to_string().contains("what moves"),
        "{error}"
    );
    // A cycle of nodes ends.
    let mut cycle = parts();
    cycle.nodes = r#"{"mesh":0,"skin":0},{"children":[2]},{"children":[1,0]}"#.into();
    assert!(cycle.load().pose(2.0).is_some());
}

#[test]
fn the_wheels_of_the_milk_truck_turn() {
    let Some(path) = scene("milktruck/CesiumMilkTruck.glb") else { return };
    let animated = load_animated(&path).unwrap();
    assert_eq!(animated.clips().len(), 1);
    let span = animated.span().unwrap();
    let at = |time: f64| animated.pose(time).unwrap().transforms;
    let (start, later) = (at(span.start), at(span.start + 0.3 * (span.end - span.start)));
    let turned: Vec<bool> = start.iter().zip(&later).map(|(one, other)| one != other).collect();
    assert_eq!(turned.iter().filter(|&&turned| turned).count(), 2, "{turned:?}");
    for (index, _) in turned.iter().enumerate().filter(|&(_, &turned)| turned) {
        assert_eq!(start[index].translation, later[index].translation, "about its axle");
        let [one, other] = [start[index], later[index]].map(|map| map.matrix3.determinant());
        assert!((one / other - 1.0).abs() < 1e-4, "without changing its size");
    }
}

#[test]
fn the_fox_surveys_walks_and_runs() {
    let Some(path) = scene("fox/Fox.glb") else { return };
    let mut animated = load_animated(&path).unwrap();
    let names: Vec<&str> = animated.clips().iter().map(|clip| clip.name.as_str()).collect();
    assert_eq!(names, ["Survey", "Walk", "Run"]);
    assert!(animated.model().report.skipped.is_empty(), "{:?}", animated.model().report);
    let mut shapes = Vec::new();
    for clip in ["Survey", "Walk", "Run"] {
        animated.choose_clip(clip).unwrap();
        let span = animated.span().unwrap();
        for step in 0..5 {
            let pose = animated.pose(span.start + f64::from(step) * 0.2 * (span.end - span.start)).unwrap();
            let [shape] = pose.shapes.as_slice() else { panic!("one skin") };
            let positions = &shape.geometries[0].positions;
            assert_eq!(positions.len(), 1_728);
            // The fox is 154 units long and stays whole: no vertex leaves it, and its feet stay near the ground.
            let low = positions.iter().copied().reduce(Vec3::min).unwrap();
            let high = positions.iter().copied().reduce(Vec3::max).unwrap();
            assert!(
                low.y > -10.0 && high.y < 120.0 && (high - low).max_element() < 200.0,
                "{clip} {low} {high}"
            );
            assert!((high - low).max_element() > 100.0, "{clip} {low} {high}");
            shapes.push(positions.clone());
        }
    }
    for (index, shape) in shapes.iter().enumerate().skip(1) {
        assert!(shape != &shapes[index - 1], "{index}: it moves");
    }
}

/// Damage anywhere in the text: an error or a scene whose poses are whole, never a panic.
#[test]
fn damaged_documents_do_no_harm() {
    use rand::{RngExt, SeedableRng};
    let text = parts().text();
    let numbers = ["-1", "0", "2", "99", "4294967296", "18446744073709551616", "1e999", "null", "{}", "\"\""];
    let mut random = rand_pcg::Pcg32::seed_from_u64(6);
    let (mut errors, mut scenes) = (0, 0);
    // The bytes of the buffer are a text of their own, in which damage is a wrong digit at most.
    let start = text.find("\"bufferViews\"").unwrap();
    for _ in 0..4000 {
        let mut damaged = text.clone();
        let at = random.random_range(start..text.len());
        let digits = damaged[at..].bytes().take_while(u8::is_ascii_digit).count();
        if digits > 0 {
            let number = numbers[random.random_range(0..numbers.len())];
            damaged.replace_range(at..at + digits, number);
        } else {
            damaged.replace_range(at..=at, ["", " ", ",", "[", "7"][random.random_range(0..5)]);
        }
        let Ok(animated) = load_animated_bytes(Path::new("x.gltf"), damaged.into()) else {
            errors += 1;
            continue;
        };
        scenes += 1;
        for pose in [0.0, 2.0, f64::NEG_INFINITY].into_iter().filter_map(|time| animated.pose(time)) {
            let model = animated.model();
            assert_eq!(pose.transforms.len(), model.scene.instances.len());
            assert_eq!((pose.cameras.len(), pose.lights.len()), (model.cameras.len(), model.lights.len()));
            for shape in &pose.shapes {
                let meshes = &model.scene.objects[shape.object as usize].geometries;
                let counts = shape.geometries.iter().map(|geometry| geometry.positions.len());
                assert!(counts.eq(meshes.iter().map(|mesh| mesh.positions.len())));
            }
        }
    }
    assert!(errors > 200 && scenes > 200, "{errors} errors, {scenes} scenes");
}
