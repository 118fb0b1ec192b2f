//! Scenes that move: times, numbered frames, shares of them, and what is said about them.

mod support;

use support::{Folder, Outcome, has_adapter, run, scenes};

const SMALL: &str = "--size 24x16 --samples 1 --device cpu";

fn frames(folder: &Folder, name: &str, options: &str) -> Outcome {
    run(&format!("render builtin:assembly -o {} {SMALL} {options}", folder.text(name)))
}

fn bytes(folder: &Folder, name: &str) -> Vec<u8> {
    std::fs::read(folder.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// A triangle that flies along x while its lamp stays, for 2 seconds.
fn flyer(folder: &Folder) -> String {
    folder.write(
        "flyer.aff",
        "v from 0 0 5 at 0 0 0 up 0 1 0 angle 40 hither 1 resolution 4 4\nl 0 5 5\n\
         x flies { p 3 -1 -1 0 1 -1 0 0 1 0 }\n\
         k flies { transl 4 0 0 0 0 0 0 0 0 0 0 0 0 0 0 2 1 0 0 0 0 0 2 1 0 0 0 0 0 }\na 0 2 5\n",
    )
}

#[test]
fn shares_together_are_all_frames_to_the_byte() {
    let folder = Folder::new();
    frames(&folder, "all.png", "--frames 30..33").success();
    for shard in ["0/2", "1/2"] {
        frames(&folder, "share.png", &format!("--frames 30..33 --shard {shard}")).success();
    }
    assert_eq!(
        folder.names(),
        [
            "all.0030.png",
            "all.0031.png",
            "all.0032.png",
            "share.0030.png",
            "share.0031.png",
            "share.0032.png"
        ]
    );
    for frame in ["0030", "0031", "0032"] {
        let [all, share] = ["all", "share"].map(|name| bytes(&folder, &format!("{name}.{frame}.png")));
        assert!(all == share, "{frame}");
    }
    assert!(bytes(&folder, "all.0030.png") != bytes(&folder, "all.0032.png"), "it moves");
}

#[test]
fn a_frame_does_not_depend_on_the_device_or_the_frames_before() {
    let folder = Folder::new();
    frames(&folder, "a.png", "--frames 110..112").success();
    frames(&folder, "b.png", "--frames 111").success();
    frames(&folder, "c_%d.png", "--frames 111..=111 --structure two-level:bottom=bvh --threads 1").success();
    let expected = bytes(&folder, "a.0111.png");
    assert!(bytes(&folder, "b.0111.png") == expected);
    assert!(bytes(&folder, "c_111.png") == expected);
    // Frame 111 of 193 in 8 seconds.
    frames(&folder, "d.png", "--time 4.625").success();
    assert!(bytes(&folder, "d.png") == expected, "a time and its frame are one picture");
    // Another structure rounds otherwise; what is seen is the same.
    frames(&folder, "e.png", "--frames 111 --view ids").success();
    frames(&folder, "f.png", "--frames 111 --view ids --structure bvh").success();
    assert!(bytes(&folder, "e.0111.png") == bytes(&folder, "f.0111.png"));
    if has_adapter() {
        let line =
            format!("render builtin:assembly -o {} --size 24x16 --samples 1", folder.text("gpu_#.png"));
        run(&format!("{line} --frames 110..112 --device gpu")).success();
        assert!(bytes(&folder, "gpu_111.png") == expected);
    }
}

/// What deforms is refitted from frame to frame, and built anew where that made it bad: nobody sees when.
#[test]
fn frames_of_what_deforms_do_not_depend_on_the_frames_before() {
    let Some(scenes) = scenes() else { return };
    let folder = Folder::new();
    let museum = scenes.join("bart_museum/museum5.aff");
    for structure in ["", "--structure two-level", "--structure two-level:bottom=bvh"] {
        let render = |name: &str, options: &str| {
            let output = folder.text(name);
            run(&format!("render {} -o {output} {SMALL} {structure} {options}", museum.display())).success();
        };
        render("all.png", "--frames 60..70");
        render("one.png", "--frames 69");
        render("two.png", "--frames 60..70 --shard 1/4");
        let last = bytes(&folder, "all.0069.png");
        assert!(
            last == bytes(&folder, "one.0069.png") && last == bytes(&folder, "two.0069.png"),
            "{structure}"
        );
        assert!(last != bytes(&folder, "all.0060.png"));
    }
}

#[test]
fn each_frame_is_a_line_of_json() {
    let folder = Folder::new();
    let outcome = frames(&folder, "a.png", "--frames 0..=2 --json").success();
    let lines: Vec<serde_json::Value> =
        outcome.out.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(lines.len(), 3);
    for (number, line) in lines.iter().enumerate() {
        assert_eq!(line["frame"], number);
        assert!((line["time"].as_f64().unwrap() - number as f64 / 24.0).abs() < 1e-9);
        assert_eq!(line["primary_rays"], 24 * 16);
        assert!(line["output"].as_str().unwrap().ends_with(&format!("a.{number:04}.png")));
        let moved = line["instances_moved"].as_u64().unwrap();
        assert_eq!(moved > 50, number > 0, "{line}");
        assert_eq!((&line["objects_rebuilt"], &line["incomplete_rays"]), (&0.into(), &0.into()));
        if cfg!(target_os = "linux") {
            assert!(line["resident_bytes"].as_u64().unwrap() > 1 << 20);
        }
    }
    let table = frames(&folder, "b.png", "--frames 0..2").success().out;
    assert_eq!(table.lines().count(), 3, "{table}");
}

#[test]
fn what_makes_no_frames_says_what_does() {
    let folder = Folder::new();
    frames(&folder, "a.png", "--frames 5..5").failure(2).mentions("A..B");
    frames(&folder, "a.png", "--frames 0..1000").failure(2).mentions("0..193");
    frames(&folder, "a.png", "--frames 0..2 --shard 2/2").failure(2).mentions("I/N");
    frames(&folder, "a.png", "--shard 0/2").failure(2).mentions("--frames");
    frames(&folder, "a.png", "--frames 0..2 --time 1").failure(2).mentions("--time");
    frames(&folder, "a.png", "--time NaN").failure(2).mentions("2.5");
    frames(&folder, "a.png", "--clip walk").failure(2).mentions("run and come apart");
    frames(&folder, "a%d#.png", "--frames 0..2").failure(2).mentions("%04d");
    frames(&folder, "a.png", "--layers").failure(2).mentions(".exr");
    frames(&folder, "a.png", "--integrator photons").failure(2).mentions("ray-tree");
    frames(&folder, "a.png", "--bounces 17").failure(2).mentions("16");
    let still = format!("render builtin:cubes -o {} {SMALL}", folder.text("a.png"));
    run(&format!("{still} --frames ..")).failure(2).mentions("stands still");
    run(&format!("{still} --time 1")).failure(2).mentions("stands still");
    assert!(folder.names().is_empty(), "{:?}", folder.names());
}

#[test]
fn times_of_a_file_are_its_own() {
    let folder = Folder::new();
    let scene = flyer(&folder);
    let line = format!("render {scene} {SMALL} --view ids --metadata none");
    run(&format!("{line} -o {} --frames ..", folder.text("f.png"))).success();
    run(&format!("{line} -o {} --time 1.5", folder.text("t.png"))).success();
    run(&format!("{line} -o {}", folder.text("s.png"))).success();
    assert!(bytes(&folder, "t.png") == bytes(&folder, "f.0003.png"));
    assert!(bytes(&folder, "s.png") == bytes(&folder, "f.0000.png"));
    assert!(bytes(&folder, "t.png") != bytes(&folder, "s.png"));
    assert!(!folder.names().contains(&"f.0005.png".to_owned()));
}

#[test]
fn clips_are_chosen() {
    let Some(scenes) = scenes() else { return };
    let folder = Folder::new();
    let fox = scenes.join("fox/Fox.glb");
    let render = |name: &str, options: &str| {
        let line =
            format!("render {} -o {} {SMALL} --metadata none {options}", fox.display(), folder.text(name));
        run(&line).success();
        bytes(&folder, name)
    };
    let survey = render("a.png", "--time 0.5");
    assert!(render("b.png", "--time 0.5 --clip Survey") == survey);
    assert!(render("c.png", "--time 0.5 --clip 2") == render("d.png", "--time 0.5 --clip Run"));
    assert!(render("e.png", "--time 0.5 --clip Walk") != survey);
}

#[test]
fn files_say_how_they_were_made() {
    let folder = Folder::new();
    let text = |options: &str| {
        frames(&folder, "a.png", options).success();
        String::from_utf8_lossy(&bytes(&folder, "a.png")).into_owned()
    };
    let plain = text("");
    assert!(plain.contains("Software") && plain.contains("builtin:assembly") && !plain.contains("Command"));
    assert!(text("") == plain && text("--threads 1") == plain);
    let full = text("--metadata full");
    assert!(full.contains("--metadata full") && full.contains("Creation Time") && full.contains("Device"));
    assert!(!text("--metadata none").contains("Software"));
}

#[test]
fn layers_are_written_beside_the_picture() {
    let folder = Folder::new();
    frames(&folder, "plain.exr", "").success();
    frames(&folder, "layers.exr", "--layers").success();
    let [plain, layers] = ["plain.exr", "layers.exr"].map(|name| bytes(&folder, name));
    let names = |file: &[u8], name: &str| file.windows(name.len()).any(|window| window == name.as_bytes());
    for name in ["albedo.R", "normal.X", "ids.primitive"] {
        assert!(names(&layers, name) && !names(&plain, name), "{name}");
    }
    assert!(names(&plain, "coverage") && names(&plain, "builtin:assembly"));
}

/// Ctrl-C finishes the frame at hand. There are far too many to be finished before.
#[cfg(target_os = "linux")]
#[test]
fn ctrl_c_keeps_the_frames_that_are_finished() {
    use std::io::{BufRead, BufReader};
    use std::process::{Command, Stdio};
    let folder = Folder::new();
    let mut child = Command::new(env!("CARGO_BIN_EXE_ropewalk"))
        .args(["render", "builtin:assembly", "--device", "cpu", "--size", "64x48", "--samples", "1"])
        .args(["--frames", "..", "--json", "-o", &folder.text("a.png")])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
    assert!(lines.next().unwrap().unwrap().starts_with('{'), "the first frame is there, and it listens");
    Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    let told = 1 + lines.count();
    let output = child.wait_with_output().unwrap();
    let err = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{err}");
    assert!(err.contains(&format!("stopped by ctrl-C: {told} of 193 frames are finished")), "{err}");
    assert_eq!(folder.names().len(), told, "each frame that is told of is a file");
}
