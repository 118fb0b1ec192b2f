//! The scenes of the collection, with their exact counts.

use crate::check;
use crate::common::{objects, scene, triangles};
use ropewalk::glam::Vec3;
use ropewalk_scene::load::load;
use ropewalk_scene::{Light, MaterialAssignment};

struct Counts {
    instances: usize,
    objects: usize,
    geometries: usize,
    unique_triangles: usize,
    triangles: usize,
    vertices: usize,
    materials: usize,
    cameras: usize,
}

#[rustfmt::skip]
const SCENES: [(&str, Counts); 10] = [
    ("car_lamborghini/lamborghini.glb", Counts { instances: 46, objects: 46, geometries: 46,
        unique_triangles: 145_917, triangles: 145_917, vertices: 79_406, materials: 46, cameras: 0 }),
    ("car_ldraw/car_ldraw_instanced.glb", Counts { instances: 61, objects: 32, geometries: 32,
        unique_triangles: 15_147, triangles: 25_767, vertices: 9_839, materials: 7, cameras: 0 }),
    ("car_ldraw/vintage_car_40448_instanced.glb", Counts { instances: 200, objects: 86, geometries: 86,
        unique_triangles: 50_192, triangles: 105_806, vertices: 32_199, materials: 18, cameras: 0 }),
    ("chess34_ccby/chess34_fantasy.glb", Counts { instances: 34, objects: 14, geometries: 14,
        unique_triangles: 22_180, triangles: 45_992, vertices: 10_888, materials: 4, cameras: 0 }),
    ("duck/Duck.glb", Counts { instances: 1, objects: 1, geometries: 1,
        unique_triangles: 4_212, triangles: 4_212, vertices: 2_399, materials: 1, cameras: 1 }),
    ("engine_2cylinder/2CylinderEngine.glb", Counts { instances: 67, objects: 29, geometries: 34,
        unique_triangles: 75_730, triangles: 121_496, vertices: 55_843, materials: 34, cameras: 1 }),
    ("fox/Fox.glb", Counts { instances: 1, objects: 1, geometries: 1,
        unique_triangles: 576, triangles: 576, vertices: 1_728, materials: 1, cameras: 0 }),
    ("milktruck/CesiumMilkTruck.glb", Counts { instances: 3, objects: 2, geometries: 4,
        unique_triangles: 2_856, triangles: 3_624, vertices: 2_978, materials: 4, cameras: 0 }),
    // The file has no material: the default one is added.
    ("suzanne/monkey.glb", Counts { instances: 1, objects: 1, geometries: 1,
        unique_triangles: 968, triangles: 968, vertices: 1_966, materials: 1, cameras: 0 }),
    ("odd/gltf/pins.glb", Counts { instances: 7, objects: 2, geometries: 2,
        unique_triangles: 1_838, triangles: 3_408, vertices: 903, materials: 2, cameras: 0 }),
];

#[test]
fn every_scene_has_its_exact_counts() {
    for (file, counts) in &SCENES {
        let Some(path) = scene(file) else { return };
        let model = load(&path).unwrap_or_else(|error| panic!("{error}"));
        let objects_of = || model.scene.objects.iter();
        assert_eq!(model.scene.instances.len(), counts.instances, "{file}");
        assert_eq!(objects(&model), counts.objects, "{file}");
        assert_eq!(
            objects_of().map(|object| object.geometries.len()).sum::<usize>(),
            counts.geometries,
            "{file}"
        );
        assert_eq!(
            objects_of().map(ropewalk::Object::triangle_count).sum::<usize>(),
            counts.unique_triangles,
            "{file}"
        );
        assert_eq!(triangles(&model), counts.triangles, "{file}");
        assert_eq!(model.report.vertices, counts.vertices, "{file}");
        assert_eq!(model.materials.len(), counts.materials, "{file}");
        assert_eq!(model.cameras.len(), counts.cameras, "{file}");
        assert_eq!((model.report.format.as_str(), model.up), ("GLB", Some(Vec3::Y)), "{file}");
        assert_eq!(model.report.skipped, [], "{file}");
        check(&model, file);
    }
}

#[test]
fn what_is_not_read_is_noted() {
    for (file, notes) in [
        ("fox/Fox.glb", &["1 skinned meshes", "3 animations"][..]),
        ("milktruck/CesiumMilkTruck.glb", &["1 animations: not read"]),
        ("odd/gltf/singleBlendshapeCube_sparse.glb", &["1 primitives: morph targets", "1 animations"]),
        ("car_ldraw/car_ldraw_instanced.glb", &[]),
    ] {
        let Some(path) = scene(file) else { return };
        let found = load(&path).unwrap().report.notes;
        assert!(
            notes.iter().all(|note| found.iter().any(|found| found.starts_with(note))),
            "{file}: {found:?}"
        );
        assert!(!notes.is_empty() || found.len() <= 1, "{file}: {found:?}");
    }
}

#[test]
fn the_duck_has_its_looks() {
    let Some(path) = scene("duck/Duck.glb") else {
        return;
    };
    let model = load(&path).unwrap();
    let surface = &model.surfaces[0][0];
    assert_eq!(surface.normals.as_ref().unwrap().values.len(), 2_399);
    assert_eq!(surface.texture_coordinates.as_ref().unwrap().values.len(), 2_399);
    assert_eq!(surface.materials, MaterialAssignment::One(0));
    assert_eq!(model.materials[0].base_color, Vec3::ONE, "it has a texture and no factor");
    assert_eq!(model.object_names, ["LOD3spShape"]);
    let camera = &model.cameras[0];
    assert!((camera.vertical_fov - 0.660_593_15).abs() < 1e-6);
    assert!(camera.forward.dot(camera.up).abs() < 1e-6);
    let bounds = model.scene.bounds();
    assert!(
        (bounds.center() - camera.position).normalize().dot(camera.forward) > 0.9,
        "the camera sees the duck"
    );
    assert!(model.lights.iter().all(|light| matches!(light, Light::Sun { .. })));
}
