//! What a user meets first: help, the catalogue, and what happens to a wrong word.

mod support;

use ropewalk::catalogue;
use support::{Folder, has_adapter, run};

#[test]
fn no_argument_says_what_to_try_first() {
    let outcome = run("").success();
    for word in ["render", "info", "verify", "bench", "--help"] {
        assert!(outcome.out.contains(word), "{word}: {outcome:?}");
    }
    assert_eq!(outcome.err, "");
}

#[test]
fn every_command_has_help_with_examples() {
    assert!(run("--help").success().out.contains("Exit codes"));
    assert!(run("--version").success().out.starts_with("ropewalk "));
    let experiments = ["lab restart-trail", "lab closest-point"];
    let commands = ["render", "trace", "points", "info", "list", "verify", "bench", "lab"];
    for command in commands.into_iter().chain(experiments) {
        let outcome = run(&format!("{command} --help")).success();
        // The usage line and at least two worked examples.
        let examples = outcome.out.matches(&format!("ropewalk {command}")).count();
        assert!(examples >= 3, "{command} shows {examples} examples");
        // What follows the options is laid out by hand: it must fit the narrowest usual terminal.
        let (_, text) = outcome.out.split_once("Print help").unwrap();
        assert!(text.lines().all(|line| line.chars().count() <= 80), "{command}: {text}");
    }
}

#[test]
fn the_list_has_every_row() {
    let document = run("list --json").success().json();
    let rows = document["rows"].as_array().unwrap();
    assert_eq!(rows.len(), catalogue::rows().len());
    for (row, listed) in catalogue::rows().iter().zip(rows) {
        assert_eq!(listed["structure"], row.structure.to_string());
        assert_eq!(listed["walk"], row.walk.to_string());
        assert_eq!(listed["query"], row.query.to_string());
        assert_eq!(listed["device"], row.device.to_string());
        assert!(!listed["about"].as_str().unwrap().is_empty());
    }
    // The text has families of walks instead, which together hold every row: so the documents' own list says.
    let text = run("list").success().out;
    for row in catalogue::rows() {
        let structure = row.structure.to_string();
        assert!(text.split_whitespace().any(|word| word == structure), "{structure}");
        let device = row.device.to_string();
        let of = document["walks"].as_array().unwrap().iter().filter(|family| {
            let pattern = family["walk"].as_str().unwrap();
            let name = pattern.split(['[', ':']).next().unwrap();
            let queries = family[device.as_str()].as_array().unwrap();
            family["structure"] == row.structure.kind().name()
                && name == row.walk.name()
                && queries.iter().any(|query| query == row.query.name())
                && text.contains(&format!("\n  {pattern}\n"))
        });
        assert!(of.count() >= 1, "{row:?}");
    }
    if has_adapter() {
        assert!(text.contains("gpu:0"), "{text}");
    }
}

#[test]
fn wrong_words_are_answered_in_one_line_with_the_right_ones() {
    run("rendr").failure(2).mentions("render");
    run("render --frobnicate").failure(2).mentions("--frobnicate");
    run("trace --rays a.npy").failure(2).mentions("--output");
    run("info builtin:pyramids").failure(2).mentions("assembly");
    run("info --structure octree").failure(2).mentions("kd-tree");
    run("info --structure kd-tree:depth=3").failure(2).mentions("max-depth");
    run("info builtin:cubes --structure kd-tree:max-depth=99").failure(2).mentions("between 1 and 60");
    run("info --structure two-level:bottom=grid").failure(2).mentions("kd-tree, bvh, wide-bvh, list, mixed");
    run("info builtin:cubes --structure two-level:opening=by-cost,parts=99")
        .failure(2)
        .mentions("between 2 and 64");
    run("trace --rays a --output b --walk smart-stack:bytes=20").failure(2).mentions("24 to 256");
    run("render --structure two-level --walk ropes").failure(2).mentions("smart-stack");
    run("info --structure bvh:leaf=1").failure(2).mentions("max-leaf");
    run("info --structure bvh:width=4").failure(2).mentions("reinsertion");
    run("info --structure bvh:builder=best").failure(2).mentions("binned, sweep, sbvh");
    run("info --structure wide-bvh:width=6").failure(2).mentions("4, 8");
    run("info --structure wide-bvh:collapse=all").failure(2).mentions("area, sah");
    run("info --structure wide-bvh:leaf=1").failure(2).mentions("collapse");
    run("info builtin:cubes --structure bvh:reinsertion=99").failure(2).mentions("between 0 and 32");
    run("info builtin:cubes --structure wide-bvh:duplication=999").failure(2).mentions("between 0 and 400");
    run("trace --rays a --output b --walk restart-trail:short-stack=17").failure(2).mentions("0 to 16");
    run("trace --rays a --output b --walk restart-trail:register=u16").failure(2).mentions("u64");
    run("trace --rays a --output b --walk restart-trail:stack=4").failure(2).mentions("short-stack");
    run("bench --walk restart-trail:memory=shared").failure(2).mentions("private, workgroup");
    run("info builtin:cubes --structure bvh:max-leaf=0").failure(2).mentions("between 1 and 255");
    run("render --structure wide-bvh --walk list").failure(2).mentions("stack");
    run("render --device cuda").failure(2).mentions("auto, cpu, gpu");
    run("render --camera look:eye=1/2/3").failure(2).mentions("target");
    run("render --view shiny").failure(2).mentions("normals");
    run("render --light lamp").failure(2).mentions("sun:X/Y/Z");
    run("render --samples 3").failure(2).mentions("1, 4, 9");
    run("render --threads 0").failure(2).mentions("1..=1024");
    run("bench --walk fast").failure(2).mentions("stack");
    run("bench --rounds 0").failure(2);
}

#[test]
fn sizes_and_names_of_pictures_are_checked_first() {
    let folder = Folder::new();
    for size in ["0x0", "0x720", "999999x999999", "65536x65536", "12", "ax3", "99999999999999x1"] {
        run(&format!("render -o {} --size {size}", folder.text("a.png"))).failure(2);
    }
    run(&format!("render -o {}", folder.text("a.jpg"))).failure(2).mentions(".png");
    run(&format!("render -o {}", folder.text("no/such/folder/a.png"))).failure(1).mentions("no/such/folder");
    run(&format!("render -o {}", folder.text(""))).failure(2);
    std::fs::create_dir(folder.path("b.png")).unwrap();
    run(&format!("render -o {}", folder.text("b.png"))).failure(1).mentions("folder");
    assert_eq!(folder.names(), ["b.png"]);
}

#[test]
fn an_adapter_that_is_not_there_is_an_error() {
    let folder = Folder::new();
    for device in ["gpu:99", "gpu:no-such-card", "gpu:99999999999999999999999"] {
        let line = format!("render builtin:cubes -o {} --size 8x8 --device {device}", folder.text("a.png"));
        run(&line).failure(1);
    }
    assert!(folder.names().is_empty());
    run("verify --device gpu:99").failure(1);
    run("bench builtin:cubes --device gpu:99").failure(1);
}

#[test]
fn what_no_device_answers_is_wrong_usage() {
    let folder = Folder::new();
    let (scene, rays) = (folder.two_triangles(), folder.rays("rays.npy", 6, &[0.0; 6]));
    let trace = format!("trace {scene} --rays {rays} -o {}", folder.text("hits.npz"));
    let gpu = format!("{trace} --query all --device gpu");
    run(&format!("{gpu} --walk brute-force")).failure(2).mentions("restart-trail:short-stack=0");
    run(&format!("{gpu} --walk stack:order=culled")).failure(2).mentions("stack:order=ordered");
    let wide = format!("{trace} --structure wide-bvh");
    run(&format!("{wide} --walk recursive")).failure(2).mentions("stack:order=ordered");
    run(&format!("{wide} --walk restart-trail:register=u32 --device cpu"))
        .failure(2)
        .mentions("register=u64");
    let trail = format!("{trace} --walk restart-trail:memory=workgroup --device cpu");
    run(&trail).failure(2).mentions("restart-trail:short-stack=4");
    run(&format!("{trace} --query all --walk recursive")).failure(2).mentions("stack:order=ordered");
    run(&format!("{trace} --query first")).failure(2).mentions("closest");
}
