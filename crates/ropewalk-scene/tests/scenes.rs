//! Every scene of the collection that is kept beside the project, with its exact counts.

mod common;

use common::{objects, scene, triangles};

/// File, triangles, objects, vertices, materials in use.
const SCENES: &[(&str, usize, usize, usize, usize)] = &[
    ("armadillo/armadillo.obj.gz", 86_482, 1, 43_243, 1),
    // The eight cylinders of the museum have 64 triangles each; the triangles that change are an object.
    ("bart_kitchen/kitchen.aff", 110_561, 6, 63_706, 28),
    ("bart_museum/museum5.aff", 10_284 + 8 * 64 + 1_024, 2, 8_667, 14),
    ("bart_robot/Robot.aff", 71_708, 161, 134_127, 141),
    ("car_ldraw/car_ldraw.obj", 25_767, 61, 16_909, 7),
    ("chess34_cc0/chess34.obj", 20_648, 34, 10_470, 4),
    ("cornell_box/cornell_box_embree.obj", 34, 7, 76, 3),
    ("cornell_box/hiprt/cornellBox.obj", 32, 8, 64, 5),
    ("cornell_box/tinyobj/cornell_box.obj", 36, 8, 76, 4),
    ("crytek_sponza/crytek_sponza.obj.gz", 262_205, 381, 165_046, 24),
    ("happy_buddha/buddha_100k.obj.gz", 100_000, 1, 49_990, 1),
    ("happy_buddha/buddha_standin_293232_le.ply.gz", 293_232, 1, 146_606, 1),
    ("kitchen_obvhs/kitchen_56939.obj.gz", 56_939, 278, 74_303, 33),
    ("legocar_tinybvh/legocar.obj", 10_992, 26, 5_968, 8),
    ("sibenik/sibenik_73564.obj.gz", 73_564, 1, 40_259, 14),
    ("sponza_dabrovic/sponza_66447.obj.gz", 66_447, 33, 60_848, 1),
    ("stanford_bunny/bun_zipper.ply.gz", 69_451, 1, 35_947, 1),
    ("stanford_bunny/bunny_ground_69453_be.ply", 69_453, 1, 35_951, 1),
    ("stanford_dragon/dragon_vrip_871414_le.ply.gz", 871_414, 1, 437_645, 1),
    ("stanford_dragon/dragon_vrip_res3.ply.gz", 47_794, 1, 22_998, 1),
    ("stanford_dragon/dragon_vrip_res4.ply.gz", 11_102, 1, 5_205, 1),
    ("stanford_dragon/ground.obj", 2, 1, 4, 1),
    ("stl_parts/ADIS16480.stl.gz", 7_436, 1, 3 * 7_436, 1),
    ("stl_parts/featuretype.STL", 3_476, 1, 3 * 3_476, 1),
    ("stl_parts/pr2_head_pan_ascii.stl", 1_000, 1, 3_000, 1),
    ("stl_parts/pr2_head_pan_bin.stl", 1_000, 1, 3_000, 1),
    ("suzanne/cornellbox_suzanne.obj", 980, 7, 531, 1),
    ("suzanne/suzanne.obj", 968, 1, 507, 1),
    ("suzanne/suzanne_ground_970.obj", 970, 2, 511, 2),
    ("teapot/Utah_teapot_solid_bin.stl", 9_438, 1, 3 * 9_438, 1),
    ("teapot/teapot_6320.obj", 6_320, 1, 3_644, 1),
    ("teapot/teapot_mitsuba.ply", 2_256, 1, 1_177, 1),
    ("toczek2010_cubes/cubes.obj", 222, 6, 124, 2),
    ("unc_cloth_ball/cloth_ball92.ply.gz", 92_230, 1, 46_598, 1),
    ("unc_cloth_ball/cloth_ball93.ply.gz", 92_230, 1, 46_598, 1),
    ("utah_hand/hand_00.obj.gz", 15_855, 1, 9_284, 2),
];

#[test]
fn every_scene_has_its_exact_counts() {
    for &(file, expected_triangles, expected_objects, vertices, materials) in SCENES {
        let Some(path) = scene(file) else { return };
        let model = ropewalk_scene::load::load(&path).unwrap_or_else(|error| panic!("{error}"));
        let counts = (triangles(&model), objects(&model), model.report.vertices, model.materials.len());
        assert_eq!(counts, (expected_triangles, expected_objects, vertices, materials), "{file}");
        // The hand was written for an early version of OBJ.
        let outlines = if file.starts_with("utah_hand") { 720 } else { 0 };
        let skipped = (model.report.skipped_count(), common::skipped(&model, "outlines"));
        assert_eq!(skipped, (outlines, outlines), "{file}");
        common::check(&model, file);
    }
}

#[test]
fn the_triangles_without_area_are_those_that_are_known() {
    // The collection's notes count 26 in the kitchen, in f64: one of its needles gains an area when it is rounded.
    for (file, without_area) in [
        ("crytek_sponza/crytek_sponza.obj.gz", 1),
        ("kitchen_obvhs/kitchen_56939.obj.gz", 25),
        ("sibenik/sibenik_73564.obj.gz", 8),
        ("sponza_dabrovic/sponza_66447.obj.gz", 1),
    ] {
        let Some(path) = scene(file) else { return };
        let report = ropewalk_scene::load::load(&path).unwrap().scene.flatten().unwrap().report;
        let found = report.degenerate + report.collinear;
        assert_eq!((found, report.not_finite, report.out_of_range), (without_area, 0, 0), "{file}");
    }
}
