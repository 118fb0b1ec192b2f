//! The built-in scenes: counts, closed solids, and the same bits on every run.

use ropewalk::glam::{DVec3, Vec3};
use ropewalk::{Mesh, Triangle};
use ropewalk_scene::builtin::{NAMES, builtin};
use ropewalk_scene::{Light, LoadError, MaterialAssignment, Model};
use std::collections::{HashMap, HashSet};

fn scene(name: &str) -> Model {
    builtin(name).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// The volume inside a mesh, or what keeps it from being closed.
fn volume(mesh: &Mesh) -> Result<f64, String> {
    let mut edges: HashMap<(u32, u32), u32> = HashMap::new();
    let mut volume = 0.0;
    for (index, &[a, b, c]) in mesh.triangles.iter().enumerate() {
        for edge in [(a, b), (b, c), (c, a)] {
            *edges.entry(edge).or_default() += 1;
        }
        let Some(triangle) = mesh.triangle(index) else { return Err("an index points nowhere".into()) };
        let [a, b, c] = triangle.vertices.map(Vec3::as_dvec3);
        volume += a.dot(b.cross(c)) / 6.0;
    }
    for (&(from, to), &count) in &edges {
        if count != 1 || edges.get(&(to, from)) != Some(&1) {
            return Err(format!("edge {from}-{to} has not one face on either side"));
        }
    }
    Ok(volume)
}

/// A number that any bit of a model's geometry changes (FNV-1a).
fn fingerprint(model: &Model) -> u64 {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    let mut add = |word: u32| hash = (hash ^ u64::from(word)).wrapping_mul(0x0100_0000_01b3);
    for mesh in model.scene.objects.iter().flat_map(|object| &object.geometries) {
        mesh.positions.iter().flat_map(Vec3::to_array).for_each(|value| add(value.to_bits()));
        mesh.triangles.iter().flatten().for_each(|&vertex| add(vertex));
    }
    for instance in &model.scene.instances {
        add(instance.object);
        for value in instance.transform.to_world().to_cols_array() {
            add(value.to_bits());
        }
    }
    hash
}

#[test]
fn the_check_for_closed_meshes_objects_to_open_ones() {
    let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
    let faces = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    let tetrahedron = Mesh::new(corners, faces);
    assert!((volume(&tetrahedron).unwrap() - 1.0 / 6.0).abs() < 1e-12);
    let mut open = tetrahedron.clone();
    open.triangles.pop();
    assert!(volume(&open).is_err());
    let mut turned = tetrahedron.clone();
    turned.triangles[0].swap(0, 1);
    assert!(volume(&turned).is_err());
    let mut broken = tetrahedron;
    broken.triangles[0][0] = 9;
    assert!(volume(&broken).is_err());
}

#[test]
fn an_unknown_name_is_answered_with_the_known_ones() {
    for name in ["", "Assembly", "teapot", "assembly "] {
        let Err(error) = builtin(name) else { panic!("'{name}' is no scene") };
        assert!(matches!(error, LoadError::NoSuchBuiltin { .. }));
        let text = error.to_string();
        assert!(NAMES.iter().all(|(known, _)| text.contains(known)), "{text}");
    }
    assert_eq!(NAMES.map(|(name, _)| name), ["assembly", "cornell", "cubes", "forest"]);
}

/// Triangles with instances counted, triangles stored, vertices stored, objects, instances.
fn counts(model: &Model) -> [usize; 5] {
    let meshes = || model.scene.objects.iter().flat_map(|object| &object.geometries);
    [
        model.scene.triangle_count(),
        meshes().map(|mesh| mesh.triangles.len()).sum(),
        meshes().map(|mesh| mesh.positions.len()).sum(),
        model.scene.objects.len(),
        model.scene.instances.len(),
    ]
}

#[test]
fn counts_are_exact() {
    assert_eq!(counts(&scene("cubes")), [222, 222, 124, 6, 6]);
    assert_eq!(counts(&scene("cornell")), [40_972, 40_972, 20_508, 8, 8]);
    let assembly = counts(&scene("assembly"));
    assert!(assembly[0] >= 200_000 && assembly[3] >= 12 && assembly[4] >= 100);
    assert_eq!(assembly, ASSEMBLY);
    let forest = counts(&scene("forest"));
    assert!(forest[0] >= 180_000);
    assert_eq!(forest, FOREST);
}

const ASSEMBLY: [usize; 5] = [406_094, 211_050, 105_554, 45, 174];
const FOREST: [usize; 5] = [732_732, 71_914, 64_945, 17, 1_618];

#[test]
fn the_same_bits_on_every_run() {
    for (name, _) in NAMES {
        let (one, other) = (scene(name), scene(name));
        assert_eq!(fingerprint(&one), fingerprint(&other), "{name}");
        assert_eq!(one.scene, other.scene);
        assert_eq!(one.surfaces, other.surfaces);
        let mut moved = other;
        let Some(position) = moved.scene.objects[0].geometries[0].positions.first_mut() else { continue };
        position.x = f32::from_bits(position.x.to_bits() ^ 1);
        assert_ne!(fingerprint(&one), fingerprint(&moved), "the fingerprint sees a single bit");
    }
}

#[test]
fn every_triangle_has_an_area_and_a_place() {
    for (name, _) in NAMES {
        let model = scene(name);
        let flat = model.scene.flatten().unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(flat.report.skipped(), 0, "{name}: {:?}", flat.report);
        assert_eq!(flat.triangles.len(), model.scene.triangle_count());
        let bounds = model.scene.bounds();
        assert!(bounds.min.is_finite() && bounds.max.is_finite());
        let degenerate = Triangle { vertices: [Vec3::ZERO, Vec3::X, Vec3::X * 2.0] };
        assert!(!degenerate.has_area(), "the measure objects");
        assert!(flat.triangles.iter().all(|triangle| triangle.triangle().has_area()));
    }
}

#[test]
fn no_instance_stands_twice() {
    for (name, _) in NAMES {
        let model = scene(name);
        let mut seen = HashSet::new();
        for instance in &model.scene.instances {
            let bits = instance.transform.to_world().to_cols_array().map(f32::to_bits);
            assert!(seen.insert((instance.object, bits)), "{name}: a second one of {}", instance.object);
        }
        let used: HashSet<u32> = model.scene.instances.iter().map(|instance| instance.object).collect();
        assert_eq!(used.len(), model.scene.objects.len(), "{name}: every object is placed");
    }
}

#[test]
fn solids_are_closed_and_not_inside_out() {
    for (name, open) in [("assembly", vec!["ground"]), ("cubes", vec!["Ground"])] {
        let model = scene(name);
        for (object, part) in model.scene.objects.iter().zip(&model.object_names) {
            for mesh in &object.geometries {
                match volume(mesh) {
                    Ok(volume) => assert!(volume > 0.0, "{name}: {part}: {volume}"),
                    Err(error) => assert!(open.contains(&part.as_str()), "{name}: {part}: {error}"),
                }
            }
        }
        for instance in &model.scene.instances {
            assert!(!instance.transform.mirrors(), "{name}: a mirrored part is another part");
        }
    }
}

#[test]
fn normals_and_materials_fit_the_triangles() {
    for (name, _) in NAMES {
        let model = scene(name);
        assert_eq!(model.object_names.len(), model.scene.objects.len());
        assert_eq!(model.object_names.iter().collect::<HashSet<_>>().len(), model.object_names.len());
        assert_eq!(model.surfaces.len(), model.scene.objects.len());
        let mut used = HashSet::new();
        for (object, surfaces) in model.scene.objects.iter().zip(&model.surfaces) {
            assert_eq!(object.geometries.len(), surfaces.len());
            for (mesh, surface) in object.geometries.iter().zip(surfaces) {
                if let MaterialAssignment::PerTriangle(materials) = &surface.materials {
                    assert_eq!(materials.len(), mesh.triangles.len());
                }
                for (index, &vertices) in mesh.triangles.iter().enumerate() {
                    used.insert(surface.materials.of(index));
                    let (Some(normals), Some(triangle)) = (&surface.normals, mesh.triangle(index)) else {
                        continue;
                    };
                    let face = triangle.normal().normalize();
                    for normal in normals.corners(index, vertices).unwrap() {
                        assert!((normal.length() - 1.0).abs() < 1e-3, "{name}: {normal}");
                        assert!(normal.dot(face) > 0.0, "{name}: a normal behind its face");
                    }
                }
            }
        }
        let all: HashSet<u32> = (0..model.materials.len() as u32).collect();
        assert_eq!(used, all, "{name}: every material is used, and no other");
    }
}

#[test]
fn a_camera_looks_at_it_and_a_sun_shines_down() {
    for (name, _) in NAMES.into_iter().filter(|&(name, _)| name != "cornell") {
        let model = scene(name);
        assert_eq!(model.up, Some(Vec3::Y));
        let [camera] = model.cameras.as_slice() else { panic!("{name}: one camera") };
        assert!(
            camera.position.y > 0.5
                && camera.forward.y < 0.2
                && camera.forward.cross(camera.up).length() > 0.1
        );
        assert!(camera.vertical_fov > 0.2 && camera.vertical_fov < 1.2);
        let [Light::Sun { direction, color }] = model.lights.as_slice() else { panic!("{name}: one sun") };
        assert!(
            direction.y < 0.0 && direction.x > 0.0 && direction.z < 0.0,
            "from the left, from above, from the front"
        );
        assert!(color.min_element() > 0.0 && color.x > color.z, "a warm one");
    }
}

/// All walls and the lamp look at the middle of the room, the spheres stand in it, and the camera sees it.
#[test]
fn the_cornell_box_is_lit_from_within() {
    let model = scene("cornell");
    let middle = Vec3::Y;
    for (index, name) in model.object_names.iter().enumerate() {
        let mesh = &model.scene.objects[index].geometries[0];
        if name.ends_with("sphere") {
            assert!(volume(mesh).unwrap() > 0.0, "{name}");
            continue;
        }
        for triangle in 0..mesh.triangles.len() {
            let triangle = mesh.triangle(triangle).unwrap();
            assert!(triangle.normal().dot(middle - triangle.vertices[0]) > 0.0, "{name}");
        }
    }
    let bounds = model.scene.bounds();
    assert_eq!((bounds.min, bounds.max), (Vec3::new(-1.0, 0.0, -1.0), Vec3::new(1.0, 2.0, 1.0)));
    let [Light::Point { position, color }] = model.lights.as_slice() else { panic!("{:?}", model.lights) };
    assert!(position.y < 1.99 && color.min_element() > 0.0, "below the lamp");
    let shining: Vec<_> = model.materials.iter().filter(|material| material.emissive != Vec3::ZERO).collect();
    assert_eq!((shining.len(), shining[0].name.as_str()), (1, "lamp"));
    assert!(model.materials.iter().any(|material| material.transmission == 1.0 && material.ior == 1.5));
    assert!(model.materials.iter().any(|material| material.metallic == 1.0 && material.roughness == 0.0));
    assert_eq!(model.background, Some(Vec3::ZERO));
}

/// The machine lies within the picture, and its outermost points are not far from the frame.
#[test]
fn the_machine_fills_the_picture() {
    let model = scene("assembly");
    let camera = &model.cameras[0];
    let forward = camera.forward.normalize();
    let right = forward.cross(camera.up).normalize();
    let up = right.cross(forward);
    let half = (camera.vertical_fov / 2.0).tan();
    let mut reach = Vec3::ZERO;
    for instance in &model.scene.instances {
        if model.object_names[instance.object as usize] == "ground" {
            continue;
        }
        for position in &model.scene.objects[instance.object as usize].geometries[0].positions {
            let seen = instance.transform.point(*position) - camera.position;
            let depth = seen.dot(forward) * half;
            reach = reach.max(Vec3::new(seen.dot(right).abs() / depth, seen.dot(up).abs() / depth, 0.0));
        }
    }
    assert!(reach.y < 1.0 && reach.y > 0.85, "{reach}");
    assert!(reach.x < 16.0 / 9.0, "{reach}");
}

/// Where the gears are: the first three axes are the shafts', one beside the other.
#[test]
fn parts_turn_about_their_shafts() {
    let model = scene("assembly");
    let place = |name: &str| {
        let object =
            model.object_names.iter().position(|other| other == name).unwrap_or_else(|| panic!("no {name}"));
        let instance =
            model.scene.instances.iter().find(|instance| instance.object as usize == object).unwrap();
        instance.transform.point(Vec3::ZERO).as_dvec3()
    };
    let across = |a: DVec3, b: DVec3| (a - b).truncate().length();
    for (gear, shaft) in [
        ("helical pinion", "input shaft"),
        ("helical wheel", "middle shaft"),
        ("spur pinion", "middle shaft"),
        ("spur wheel", "output shaft"),
    ] {
        assert!(across(place(gear), place(shaft)) < 1e-6, "{gear}");
    }
    // Module times half the number of teeth of both.
    assert!((across(place("helical pinion"), place("helical wheel")) - 0.05 * 65.0 / 2.0).abs() < 1e-6);
    assert!((across(place("spur pinion"), place("spur wheel")) - 0.06 * 60.0 / 2.0).abs() < 1e-6);
}
