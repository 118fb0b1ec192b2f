//! Whole pictures: stored references, both devices, early ends, empty scenes.
//!
//! With `ROPEWALK_UPDATE_IMAGES=1` the stored pictures are written anew; look at them before they are kept.

mod common;

use common::{build, render, still_life};
use ropewalk::glam::Vec3;
use ropewalk::{NoMonitor, StructureSpec, Walk};
use ropewalk_gpu::{Device, DeviceChoice, adapters};
use ropewalk_render::{
    CameraChoice, Picture, RenderError, RenderSettings, Renderer, Stage, StageOptions, View, image_file,
};
use ropewalk_scene::{Model, builtin};
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};

fn settings(view: View) -> RenderSettings {
    RenderSettings { width: 64, height: 36, samples: 4, view, ..RenderSettings::default() }
}

fn stored(name: &str) -> PathBuf {
    [env!("CARGO_MANIFEST_DIR"), "tests", "images", &format!("{name}.png")].iter().collect()
}

/// Compares a picture with the stored one, byte by byte.
fn compare(name: &str, width: u32, height: u32, bytes: &[u8]) -> Result<(), String> {
    let path = stored(name);
    if std::env::var_os("ROPEWALK_UPDATE_IMAGES").is_some_and(|value| value == "1") {
        image_file::write_png(&path, width, height, bytes).map_err(|error| error.to_string())?;
    }
    let expected = image::open(&path).map_err(|error| format!("{}: {error}", path.display()))?.to_rgb8();
    if (expected.width(), expected.height()) != (width, height) {
        return Err(format!("{name} is {}x{}, not {width}x{height}", expected.width(), expected.height()));
    }
    let different = expected.as_raw().iter().zip(bytes).filter(|(a, b)| a != b).count();
    if different == 0 { Ok(()) } else { Err(format!("{name}: {different} bytes differ")) }
}

fn check(name: &str, picture: &Picture) {
    if let Err(what) = compare(name, picture.film.width, picture.film.height, &picture.to_srgb8()) {
        panic!("{what}");
    }
}

#[test]
fn the_still_life_looks_as_it_did() {
    let stage = Stage::new(still_life(), &StageOptions::default());
    let structure = build(stage.scene());
    for view in View::EVERY {
        check(view.name(), &render(&stage, &structure, &settings(view)));
    }
}

/// Heads, of the screen and of triangles, and layers change how rays are led and no pixel; what is lit from its front alone
/// has one side as well as two.
#[test]
fn lists_with_heads_draw_the_same_picture() {
    let stage = Stage::new(still_life(), &StageOptions::default());
    let settings = RenderSettings { walk: Walk::List, ..settings(View::Shaded) };
    for keys in
        ["heads=regular,frustum-grid=8", "heads=simple,bounds=aabb,directions=6,moving=1", "frustum-grid=3"]
    {
        let spec: StructureSpec = format!("list:{keys}").parse().unwrap();
        let structure = spec.build(stage.scene(), &NoMonitor).unwrap();
        check("shaded", &render(&stage, &structure, &settings));
    }
    let visits = |keys: &str| {
        let structure = format!("list:{keys}").parse::<StructureSpec>().unwrap();
        let structure = structure.build(stage.scene(), &NoMonitor).unwrap();
        let settings = RenderSettings { view: View::Visits, ..settings.clone() };
        let counters = render(&stage, &structure, &settings).statistics.counters.unwrap();
        counters.inner_visits + counters.primitive_tests
    };
    let (whole, cells) = (visits("directions=6"), visits("directions=6,frustum-grid=16"));
    assert!(cells < whole, "{cells} visits with heads and {whole} without");
}

#[test]
fn the_cubes_look_as_they_did() {
    let stage = Stage::new(builtin::builtin("cubes").unwrap(), &StageOptions::default());
    check("cubes", &render(&stage, &build(stage.scene()), &settings(View::Shaded)));
}

#[test]
fn a_wrong_picture_is_noticed() {
    // Nothing may be written here, whatever the environment says.
    if std::env::var_os("ROPEWALK_UPDATE_IMAGES").is_some() {
        println!("skipped: the stored pictures are being written");
        return;
    }
    let right = image::open(stored("shaded")).unwrap().to_rgb8().into_raw();
    assert_eq!(compare("shaded", 64, 36, &right), Ok(()));
    let mut wrong = right.clone();
    wrong[1000] ^= 1;
    assert!(compare("shaded", 64, 36, &wrong).unwrap_err().contains("1 bytes differ"));
    assert!(compare("shaded", 36, 64, &right).unwrap_err().contains("64x36"));
    assert!(compare("no-such-picture", 64, 36, &right).is_err());
}

#[test]
fn every_device_gives_the_same_picture() {
    let software = adapters().into_iter().find(|adapter| adapter.is_software);
    let Some(software) = software else {
        assert!(std::env::var_os("CI").is_none(), "there is no software adapter, and CI wants one");
        println!("skipped: there is no software adapter here");
        return;
    };
    let device = Device::open(&DeviceChoice::GpuIndex(software.index)).expect("the adapter opens").device;
    for model in [still_life(), builtin::builtin("cubes").unwrap()] {
        let stage = Stage::new(model, &StageOptions::default());
        let on_cpu = build(stage.scene());
        let on_gpu = device.prepare(build(stage.scene())).expect("the scene fits");
        for view in View::EVERY {
            let (a, b) = (render(&stage, &on_cpu, &settings(view)), render(&stage, &on_gpu, &settings(view)));
            let different = a.film.color.iter().zip(&b.film.color).filter(|(a, b)| a != b).count();
            assert_eq!(different, 0, "{view}: {different} pixels differ");
            let depths = a.film.depth.iter().zip(&b.film.depth).filter(|(a, b)| a != b).count();
            assert_eq!(depths, 0, "{view}: {depths} depths differ");
            assert!(a.film == b.film, "{view}: coverage or visits differ");
            assert_eq!(a.to_srgb8(), b.to_srgb8());
            assert_eq!(a.statistics.counters, b.statistics.counters);
        }
    }
}

#[test]
fn an_early_end_keeps_the_finished_rows() {
    let stage = Stage::new(still_life(), &StageOptions::default());
    let structure = build(stage.scene());
    // 256 samples: a batch is 512 pixels, two rows.
    let settings =
        RenderSettings { width: 256, height: 12, samples: 256, ambient_rays: 0, ..RenderSettings::default() };
    let whole = render(&stage, &structure, &settings);
    assert!(!whole.partial && whole.finished_rows == 12);
    let calls = AtomicUsize::new(0);
    let stop_after_two = |done: usize, total: usize| {
        assert_eq!(total, 12);
        assert_eq!(done, 2 * (calls.load(Ordering::Relaxed) + 1));
        if calls.fetch_add(1, Ordering::Relaxed) == 1 {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    };
    let part = Renderer::new(&stage, &structure).render(&settings, &stop_after_two).unwrap();
    assert!(part.partial);
    assert_eq!(part.finished_rows, 4);
    assert_eq!(part.film.color[..4 * 256], whole.film.color[..4 * 256]);
    assert!(part.film.color[4 * 256..].iter().all(|&color| color == [0.0; 3]));
    // To be told to stop when all is done is no early end.
    let last = Renderer::new(&stage, &structure)
        .render(&settings, &|done, total| {
            if done == total { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })
        .unwrap();
    assert!(!last.partial);
}

#[test]
fn an_empty_scene_is_a_background_with_a_note() {
    let stage = Stage::new(Model::default(), &StageOptions::default());
    let structure = build(stage.scene());
    for view in View::EVERY {
        let picture = render(&stage, &structure, &settings(view));
        assert!(picture.notes.iter().any(|note| note.contains("no triangle")));
        assert!(picture.film.coverage.iter().all(|&share| share == 0.0));
        assert_eq!(picture.to_srgb8().len(), 64 * 36 * 3);
    }
}

#[test]
fn cameras_that_are_not_there_are_errors() {
    let stage = Stage::new(builtin::builtin("cubes").unwrap(), &StageOptions::default());
    let structure = build(stage.scene());
    let with = |camera: CameraChoice| {
        let settings = RenderSettings { camera, ..settings(View::Shaded) };
        Renderer::new(&stage, &structure).render(&settings, &|_, _| ControlFlow::Continue(()))
    };
    let error = with("nowhere".parse().unwrap()).unwrap_err();
    assert!(matches!(error, RenderError::Camera(_)) && error.to_string().contains("'nowhere'"));
    let same = CameraChoice::Look { eye: Vec3::ONE, target: Vec3::ONE, up: None, vertical_fov: None };
    assert!(with(same).unwrap_err().to_string().contains("eye and target must differ"));
    assert!(with("0".parse().unwrap()).is_ok());
    for inside in ["inside", "inside:fov=90", "frame:azimuth=180,elevation=-20"] {
        assert!(with(inside.parse().unwrap()).is_ok());
    }
}

#[test]
fn a_picture_goes_to_files_of_both_kinds() {
    let folder = tempfile::tempdir().unwrap();
    let stage = Stage::new(still_life(), &StageOptions::default());
    let picture = render(&stage, &build(stage.scene()), &settings(View::Shaded));
    for name in ["a.png", "a.exr"] {
        let path = folder.path().join(name);
        picture.save(&path).unwrap();
        assert!(std::fs::metadata(&path).unwrap().len() > 100);
    }
    let error = picture.save(&folder.path().join("a.bmp")).unwrap_err().to_string();
    assert!(error.contains("a.bmp") && error.contains(".png"), "{error}");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
}

#[test]
fn the_camera_inside_stands_in_the_room() {
    use common::{bare, floor, matt, model, sphere};
    // A closed shell seen from within, with things in it.
    let parts = vec![
        (sphere(Vec3::new(0.0, 4.0, 0.0), 10.0, 3), matt(0.6, 0.6, 0.6)),
        (floor(Vec3::ZERO, 9.0), matt(0.4, 0.5, 0.4)),
        (sphere(Vec3::new(3.0, 1.0, -4.0), 1.0, 2), matt(0.8, 0.3, 0.2)),
    ];
    let stage = bare(model(parts, Vec::new()));
    let structure = build(stage.scene());
    let settings = RenderSettings { camera: "inside".parse().unwrap(), ..settings(View::Shaded) };
    let picture = render(&stage, &structure, &settings);
    assert!(picture.camera.position.distance(Vec3::new(0.0, 4.0, 0.0)) < 10.0);
    assert!(picture.film.coverage.iter().all(|&share| share == 1.0), "there is a wall behind every pixel");
    // The sun does not get in, but the lamp beside the eye does.
    let mean = picture.film.color.iter().map(|color| color[1]).sum::<f32>() / picture.film.pixels() as f32;
    assert!(mean > 0.15, "{mean} is too dark to see anything");
}
