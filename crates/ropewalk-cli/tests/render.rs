//! Pictures.

mod support;

use support::{Folder, has_adapter, run};

fn render(folder: &Folder, name: &str, options: &str) -> Vec<u8> {
    // Without metadata, so that only the pictures are compared.
    let line = "render builtin:cubes --size 48x32 --samples 4 --metadata none";
    run(&format!("{line} -o {} {options}", folder.text(name))).success();
    std::fs::read(folder.path(name)).unwrap()
}

#[test]
fn both_devices_make_the_same_picture() {
    let folder = Folder::new();
    for view in ["shaded", "normals", "depth", "ids", "visits"] {
        let options = format!("--view {view} --device");
        let cpu = render(&folder, "cpu.png", &format!("{options} cpu"));
        assert!(cpu.starts_with(b"\x89PNG"));
        if has_adapter() {
            assert!(render(&folder, "gpu.png", &format!("{options} gpu")) == cpu, "{view}");
        }
    }
}

#[test]
fn the_picture_depends_on_what_is_asked_and_not_on_threads() {
    let folder = Folder::new();
    let plain = render(&folder, "a.png", "");
    assert!(render(&folder, "b.png", "--threads 1") == plain);
    assert!(render(&folder, "b.png", "--walk stack:order=culled --structure bvh:leaf-order=left") == plain);
    for options in [
        "--camera look:eye=5/5/5,target=0/0/0",
        "--camera frame:azimuth=100",
        "--light sun:1/-1/0",
        "--light point:3/6/2",
        "--exposure -1",
        "--up z --camera frame",
        "--view ids",
    ] {
        assert!(render(&folder, "b.png", options) != plain, "{options}");
    }
    assert!(render(&folder, "c.exr", "").starts_with(&[0x76, 0x2f, 0x31, 0x01]));
    assert_eq!(folder.names(), ["a.png", "b.png", "c.exr"]);
}

#[test]
fn the_statistics_are_one_document() {
    let folder = Folder::new();
    let line = format!("render builtin:cubes -o {} --size 40x30 --samples 4 --json", folder.text("a.png"));
    let document = run(&line).success().json();
    assert_eq!(document["primary_rays"], 40 * 30 * 4);
    assert_eq!((&document["partial"], &document["incomplete_rays"]), (&false.into(), &0.into()));
    assert_eq!(document["camera"]["position"].as_array().unwrap().len(), 3);
    let document = run(&format!("{line} --view visits")).success().json();
    assert!(document["visits"]["inner_visits_per_ray"].as_f64().unwrap() > 0.0);
    assert!(document["legend"]["high"].as_f64().unwrap() > 0.0);
}

#[test]
fn nothing_to_see_is_an_error_and_not_a_black_picture() {
    let folder = Folder::new();
    let scene = folder.write("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\np 1 2 3\n");
    let line = format!("render {scene} -o {} --size 8x8", folder.text("a.png"));
    let outcome = run(&line);
    assert_eq!(outcome.code, Some(1), "{outcome:?}");
    assert!(outcome.err.contains("nothing to render"), "{outcome:?}");
    run(&format!("render builtin:cubes -o {} --camera nobody", folder.text("a.png")))
        .failure(2)
        .mentions("nobody");
    assert_eq!(folder.names(), ["points.obj"]);
}

/// The first ctrl-C keeps what is finished. The picture is far too large to be finished before.
#[cfg(target_os = "linux")]
#[test]
fn ctrl_c_keeps_the_rows_that_are_finished() {
    use std::process::{Command, Stdio};
    use std::thread::sleep;
    use std::time::Duration;
    let folder = Folder::new();
    let mut child = Command::new(env!("CARGO_BIN_EXE_ropewalk"))
        .args(["render", "builtin:cubes", "--device", "cpu", "--size", "2000x4000", "--samples", "256"])
        .args(["--view", "normals", "-o", &folder.text("a.png")])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // The system tells which signals a process listens to; ctrl-C is signal 2.
    let status = format!("/proc/{}/status", child.id());
    let listens = || {
        let text = std::fs::read_to_string(&status).unwrap_or_default();
        let caught = text.lines().find_map(|line| line.strip_prefix("SigCgt:"));
        caught.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).is_some_and(|mask| mask & 2 != 0)
    };
    while !listens() {
        assert!(child.try_wait().unwrap().is_none(), "it ended by itself");
        sleep(Duration::from_millis(10));
    }
    // Time for some rows. On a machine too busy to finish one there is nothing to keep, which it says.
    sleep(Duration::from_secs(2));
    Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    let output = child.wait_with_output().unwrap();
    let err = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{err}");
    assert!(err.contains("stopped by ctrl-C"), "{err}");
    let kept = if err.contains("a.png holds the ") { vec!["a.png".to_owned()] } else { vec![] };
    assert_eq!(folder.names(), kept, "{err}");
}

/// The rows that are finished are saved while the others are rendered. The picture is far too large to be finished before.
#[cfg(target_os = "linux")]
#[test]
fn what_is_finished_is_saved_in_between() {
    use std::process::{Command, Stdio};
    use std::time::{Duration, Instant};
    let folder = Folder::new();
    let mut child = Command::new(env!("CARGO_BIN_EXE_ropewalk"))
        .args(["render", "builtin:cubes", "--device", "cpu", "--size", "600x4000", "--samples", "256"])
        .args(["--save-every", "0", "-o", &folder.text("a.png")])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let start = Instant::now();
    while !folder.path("a.png").exists() {
        assert!(child.try_wait().unwrap().is_none(), "it ended by itself");
        assert!(start.elapsed() < Duration::from_secs(200), "nothing is saved");
        std::thread::sleep(Duration::from_millis(10));
    }
    // It does not get to clear up what it was about to write.
    child.kill().unwrap();
    child.wait().unwrap();
    let file = std::fs::read(folder.path("a.png")).unwrap();
    assert!(file.starts_with(b"\x89PNG") && file.ends_with(b"IEND\xae\x42\x60\x82"), "it is whole");
    run(&format!("render builtin:cubes -o {} --save-every 1 --time 1", folder.text("b.png")))
        .failure(2)
        .mentions("--save-every");
}
