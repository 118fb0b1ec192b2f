//! `ropewalk lab`: what is printed, what is written, and how wrong words are answered.

mod support;

use support::{Folder, has_adapter, run};

#[test]
fn the_restart_trail_is_compared_with_the_full_stack() {
    let folder = Folder::new();
    let target = folder.text("tables");
    let few = "--rays 600 --rounds 0 --builder sweep --leaf-cap 4";
    let document = run(&format!("lab restart-trail builtin:cubes --json --ground -o {target} {few}"));
    let document = document.success().json();
    let rows = document["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 4 * 8, "four classes of rays, seven short stacks and the full one");
    assert!(document["command"].as_str().unwrap().starts_with("ropewalk lab restart-trail"));
    for row in rows {
        for field in ["scene", "builder", "rays", "device"] {
            assert!(row[field].is_string(), "{field}: {row}");
        }
        for field in ["max_leaf", "inner_visits", "leaf_visits", "primitive_tests", "restarts", "ratio_inner"]
        {
            assert!(row[field].is_number(), "{field}: {row}");
        }
        assert!(row["short_stack"] == "full" || row["short_stack"].is_u64(), "{row}");
        assert!(row["rays_per_s"].is_null(), "nothing was timed");
        assert_eq!(row["triangles"], 224);
    }
    let file = |ending: &str| std::fs::read_to_string(format!("{target}/restart-trail.{ending}")).unwrap();
    for ending in ["json", "csv", "md", "svg"] {
        assert!(file(ending).contains("builtin:cubes"), "{ending}");
    }
    assert_eq!(file("csv").lines().count(), rows.len() + 1);
}

#[test]
fn closest_points_are_compared_with_brute_force_and_the_oracle() {
    let folder = Folder::new();
    let target = folder.text("tables");
    let few = "--points 2000 --rounds 0 --leaf-cap 4";
    // A scene that is named twice is asked once.
    let scenes = "builtin:cubes builtin:forest builtin:cubes --brute-force 300";
    let document = run(&format!("lab closest-point {scenes} --json -o {target} {few}")).success().json();
    assert!(document["command"].as_str().unwrap().starts_with("ropewalk lab closest-point"));
    let scenes = document["scenes"].as_array().unwrap();
    assert_eq!(scenes.len(), 2);
    for scene in scenes {
        assert_eq!((&scene["points"], &scene["seed"]), (&2000.into(), &1.into()), "{scene}");
        assert_eq!((&scene["brute_force_points"], &scene["oracle_points"]), (&300.into(), &2000.into()));
        assert_eq!(scene["differences"], 0);
    }
    let rows = document["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 2 * 2 * 3, "two builders, two short stacks and the full one");
    for (row, walk) in rows.iter().zip(["stack", "short-stack=0", "short-stack=4"].iter().cycle()) {
        for field in ["scene", "builder", "device"] {
            assert!(row[field].is_string(), "{field}: {row}");
        }
        assert!(row["walk"].as_str().unwrap().contains(walk), "{row}");
        for field in ["triangles", "max_leaf", "inner_visits", "leaf_visits", "primitive_tests", "restarts"] {
            assert!(row[field].is_number(), "{field}: {row}");
        }
        assert_eq!((&row["points"], &row["differing"]), (&2000.into(), &0.into()), "{row}");
        assert!(row["ratio_inner"].as_f64().unwrap() >= 1.0, "{row}");
        assert!(row["points_per_s"].is_null(), "nothing was timed");
    }
    assert!(rows[1]["restarts"].as_f64().unwrap() > rows[2]["restarts"].as_f64().unwrap());
    let file = |ending: &str| std::fs::read_to_string(format!("{target}/closest-point.{ending}")).unwrap();
    for ending in ["json", "csv", "md"] {
        assert!(file(ending).contains("builtin:forest"), "{ending}");
    }
    assert_eq!(file("csv").lines().count(), rows.len() + 1);
    assert_eq!(std::fs::read_dir(target).unwrap().count(), 3);
}

#[test]
fn closest_points_are_printed_as_tables_and_timed() {
    let line = "lab closest-point builtin:cubes --points 200 --short-stack 2 --builder sbvh --rounds 1";
    let text = run(line).success().out;
    assert!(text.contains("## builtin:cubes\n") && text.contains("### On cpu"), "{text}");
    assert!(text.contains("oracle: 200 of 200") && text.contains("the bit: 200 of 200.\n"), "{text}");
    assert!(text.contains("(seed 1)") && text.contains("| sbvh | 8 |"), "{text}");
    let document = run(&format!("{line} --json --seed 5")).success().json();
    assert_eq!(document["scenes"][0]["seed"], 5);
    assert_eq!(document["scenes"][0]["brute_force_points"], 200);
    assert!(document["rows"][0]["points_per_s"].as_f64().unwrap() > 0.0);
    assert_eq!(document["rows"][0]["ratio_time"]["median"], 1.0);
}

#[test]
fn closest_points_are_the_same_on_an_adapter() {
    if !has_adapter() {
        return;
    }
    let few = "--points 500 --rounds 0 --builder sweep --leaf-cap 4 --json";
    let line = format!("lab closest-point builtin:cubes --device cpu --device gpu {few}");
    let document = run(&line).success().json();
    let rows = document["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 2 * 3);
    let (cpu, gpu) = rows.split_at(3);
    let listed = run("list --json").success().json();
    let adapters = listed["adapters"].as_array().unwrap();
    for (cpu, gpu) in cpu.iter().zip(gpu) {
        assert_ne!(cpu["device"], gpu["device"]);
        assert_eq!(cpu["walk"], gpu["walk"]);
        // Hardware may round otherwise.
        if adapters.iter().all(|adapter| adapter["software"] == true) {
            for field in ["differing", "inner_visits", "leaf_visits", "primitive_tests", "restarts"] {
                assert_eq!(cpu[field], gpu[field], "{field}");
            }
        }
    }
}

#[test]
fn traversal_lists_are_compared_option_by_option() {
    let folder = Folder::new();
    let target = folder.text("tables");
    let few = "--view 16 --frustum-grid 4 --rounds 0";
    let document =
        run(&format!("lab traversal-lists builtin:cubes --json -o {target} {few}")).success().json();
    assert!(document["command"].as_str().unwrap().starts_with("ropewalk lab traversal-lists"));
    // The scene's own ground makes place for the one that all scenes have.
    assert_eq!(document["scenes"][0]["triangles"], 220);
    assert!(document["scenes"][0]["brute_force_rays"].as_u64().unwrap() > 6 * 16 * 16);
    let rows = document["rows"].as_array().unwrap();
    assert_eq!(rows.len(), (2 * 7 + 16 + 2 + 4) * 3, "four tables, three classes of rays");
    for row in rows {
        for field in ["scene", "source", "bounds", "cull", "heads", "rays", "device", "table", "setting"] {
            assert!(row[field].is_string(), "{field}: {row}");
        }
        for field in ["triangles", "frustum_grid", "elements_per_ray", "culled_share", "list_bytes"] {
            assert!(row[field].is_number(), "{field}: {row}");
        }
        assert!(row["fps"].is_null() && row["rays_per_s"].is_null(), "nothing was timed");
        assert_eq!(row["triangles"], if row["ground"] == true { 222 } else { 220 });
        if row["walk"] == "list" {
            assert!(row["directions"].is_u64() && row["order"].is_string(), "{row}");
            assert_eq!(row["list_bytes"].as_u64().unwrap(), 20 * row["elements"].as_u64().unwrap());
        }
    }
    let file = |ending: &str| std::fs::read_to_string(format!("{target}/traversal-lists.{ending}")).unwrap();
    for ending in ["json", "csv", "md", "svg"] {
        assert!(file(ending).contains("builtin:cubes"), "{ending}");
    }
    assert_eq!(file("csv").lines().count(), rows.len() + 1);
}

#[test]
fn frames_of_traversal_lists_are_timed_and_copies_too() {
    let few = "--view 8 --frustum-grid 2 --frame 16 --rounds 1 --table columns --table best";
    let line = format!("lab traversal-lists builtin:cubes {few}");
    let text = run(&line).success().out;
    for part in
        ["### On cpu", "Lists and options (on the ground)", "Table 3", "### Memory", "| ordered stack |"]
    {
        assert!(text.contains(part), "{part}: {text}");
    }
    let document = run(&format!("{line} --json")).success().json();
    let rows = document["rows"].as_array().unwrap();
    let timed = rows.iter().filter(|row| row["rays"] == "frame");
    assert_eq!(timed.clone().count(), 4 + 4);
    assert!(timed.clone().all(|row| row["fps"].as_f64().unwrap() > 0.0));
    let of_paper: Vec<_> = timed.filter(|row| row["paper_fps"].is_number()).collect();
    assert_eq!(of_paper.len(), 1, "the paper has six lists with all options");
    assert_eq!(of_paper[0]["paper_fps"], 31.36);
    assert_eq!(document["copies"].as_array().unwrap().len(), 4);
}

#[test]
fn two_levels_are_compared_with_one() {
    let folder = Folder::new();
    let target = folder.text("tables");
    let line = format!(
        "lab two-level builtin:assembly --json -o {target} --size 24 --rounds 0 --bottom kd-tree --bottom list"
    );
    let document = run(&line).success().json();
    assert!(document["command"].as_str().unwrap().starts_with("ropewalk lab two-level"));
    assert!(document["machine"]["ropewalk"].is_string());
    let rows = document["rows"].as_array().unwrap();
    assert_eq!(rows.len(), (3 + 2 * 2 + 3) * 3, "three single structures, two kinds, a ring, two openings");
    for row in rows {
        for field in ["scene", "structure", "rays", "device"] {
            assert!(row[field].is_string(), "{field}: {row}");
        }
        for field in ["objects", "triangles", "ray_count", "cost", "cost_relative_to_single_kd"] {
            assert!(row[field].is_number(), "{field}: {row}");
        }
        for field in ["rays_per_s", "relative_to_single_kd", "relative_to_single_bvh"] {
            assert!(row[field].is_null(), "nothing was timed: {row}");
        }
        let of_two_levels = row["structure"].as_str().unwrap().starts_with("two-level");
        for field in ["bottom", "oriented_boxes", "objects_entered"] {
            assert_eq!(!row[field].is_null(), of_two_levels, "{field}: {row}");
        }
        let has_ring = of_two_levels && row["bottom"] == "kd-tree";
        assert_eq!(row["smart_stack_max_bytes"].is_u64(), has_ring, "{row}");
        let has =
            |level: &str| ["avg", "max", "var"].map(|of| row[format!("{level}_depth_{of}")].is_number());
        assert_eq!(has("bvh"), [!row["structure"].as_str().unwrap().starts_with("kd-tree"); 3], "{row}");
        assert_eq!(has("kd"), [row["structure"] != "bvh"; 3], "{row}");
    }
    let heat = document["heat"].as_array().unwrap();
    assert_eq!(heat.len(), 4, "primary and shadow rays, with oriented boxes and without");
    for map in heat {
        let pixels: u64 =
            ["none", "blue", "green", "red", "white"].iter().map(|band| map[band].as_u64().unwrap()).sum();
        assert_eq!(pixels, 24 * 24, "{map}");
    }
    assert_eq!(document["rebuilds"], serde_json::json!([]), "nothing was timed");
    let file = |name: &str| std::fs::read(format!("{target}/{name}")).unwrap();
    for name in ["two-level.json", "two-level.csv", "two-level.md", "two-level.svg", "two-level-objects.svg"]
    {
        assert!(String::from_utf8(file(name)).unwrap().contains("builtin:assembly"), "{name}");
    }
    assert_eq!(String::from_utf8(file("two-level.csv")).unwrap().lines().count(), rows.len() + 1);
    for rays in ["primary", "shadow"] {
        for boxes in ["oriented", "not-oriented"] {
            let picture = file(&format!("two-level-heat-1-assembly-{rays}-{boxes}.png"));
            assert!(picture.starts_with(b"\x89PNG"), "{rays}, {boxes}");
        }
    }
    assert_eq!(std::fs::read_dir(target).unwrap().count(), 5 + 4);
}

#[test]
fn frames_of_two_levels_are_put_beside_those_of_one() {
    let folder = Folder::new();
    let target = folder.text("tables");
    let line = format!("lab reichl-table2 builtin:assembly --json -o {target} --size 24 --rounds 0");
    let document = run(&line).success().json();
    assert!(document["command"].as_str().unwrap().starts_with("ropewalk lab reichl-table2"));
    let rows = document["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 4 * 2, "four configurations, two structures");
    for row in rows {
        for field in ["scene", "configuration", "structure", "device", "walk"] {
            assert!(row[field].is_string(), "{field}: {row}");
        }
        for field in ["size", "rays", "inner_visits", "primitive_tests", "primitive_tests_relative"] {
            assert!(row[field].is_number(), "{field}: {row}");
        }
        for field in ["frames_per_s", "relative_to_single_kd", "paper_frames_per_s"] {
            assert!(row[field].is_null(), "nothing was timed, and the paper has no such scene: {row}");
        }
    }
    let primary = document["primary"].as_array().unwrap();
    assert_eq!(primary.len(), 2);
    for row in primary {
        assert_eq!((&row["rays"], &row["different"]), (&(24 * 24).into(), &0.into()), "{row}");
    }
    let file = |name: &str| std::fs::read_to_string(format!("{target}/{name}")).unwrap();
    for name in ["reichl-table2.json", "reichl-table2.csv", "reichl-table2.md", "reichl-table2-primary.csv"] {
        assert!(file(name).contains("builtin:assembly"), "{name}");
    }
    assert_eq!(file("reichl-table2.csv").lines().count(), rows.len() + 1);
    assert_eq!(std::fs::read_dir(target).unwrap().count(), 4);
    let text = run("lab reichl-table2 builtin:cubes --size 16 --rounds 1 --threads 1").success().out;
    for part in ["## builtin:cubes", "### Table 2", "reflect only", "drawn beside traced"] {
        assert!(text.contains(part), "{part}: {text}");
    }
}

/// Of parts that lie askew in their own space far fewer are entered in oriented boxes.
#[test]
fn oriented_boxes_help_turned_parts() {
    let few = "--size 24 --rounds 0 --bottom kd-tree --turned --json";
    let document = run(&format!("lab two-level builtin:assembly {few}")).success().json();
    assert_eq!(document["scenes"][0]["scene"], "builtin:assembly, turned");
    let entered = |structure: &str, rays: &str| {
        let of = |row: &&serde_json::Value| {
            row["structure"] == structure && row["rays"] == rays && row["walk"] == "stack:order=ordered"
        };
        document["rows"].as_array().unwrap().iter().find(of).unwrap()["objects_entered"].as_f64().unwrap()
    };
    for rays in ["primary", "shadow", "diffuse"] {
        let (with, without) = (entered("two-level", rays), entered("two-level:oriented=no", rays));
        assert!(with < 0.7 * without, "{rays}: {with} with oriented boxes, {without} without");
    }
}

#[test]
fn two_levels_are_timed_and_the_top_level_rebuilt() {
    let folder = Folder::new();
    let target = folder.text("tables");
    let few = "--size 16 --rounds 1 --bottom bvh --rebuild 100 --rebuild 1000 --camera frame:azimuth=10";
    let line = format!("lab two-level builtin:cubes builtin:forest {few}");
    let text = run(&line).success().out;
    for part in [
        "## builtin:cubes",
        "### Table 1",
        "### Speed on cpu",
        "### Heat maps",
        "## Rebuilding the top level",
        "| 1000 |",
        "| 9.8 |",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let document = run(&format!("{line} --json -o {target}")).success().json();
    assert!(document["rows"].as_array().unwrap().iter().all(|row| row["rays_per_s"].as_f64().unwrap() > 0.0));
    let rebuilds = document["rebuilds"].as_array().unwrap();
    assert_eq!(rebuilds.len(), 2, "once, not for each scene");
    for (row, objects) in rebuilds.iter().zip([100, 1000]) {
        assert_eq!(row["objects"], objects);
        assert!(row["rebuild_ms"].as_f64().unwrap() > 0.0 && row["refit_ms"].as_f64().unwrap() > 0.0);
        assert_eq!(row["upload_bytes"], 32 * (2 * objects - 1) + 96 * objects);
    }
    let file = |name: &str| std::fs::read_to_string(format!("{target}/{name}")).unwrap();
    assert_eq!(file("two-level-rebuild.csv").lines().count(), 3);
    assert!(file("two-level-rebuild.svg").contains("milliseconds"));
}

#[test]
fn tables_are_printed_and_rates_measured() {
    let line = "lab restart-trail builtin:cubes --short-stack 0 --class primary --rays 100 --rounds 1";
    let text = run(line).success().out;
    assert!(text.contains("## builtin:cubes on cpu"), "{text}");
    assert!(text.contains("| sbvh | 8 |"), "{text}");
    let document = run(&format!("{line} --json")).success().json();
    assert!(document["rows"][0]["rays_per_s"].as_f64().unwrap() > 0.0);
}

#[test]
fn wrong_words_are_answered_with_the_right_ones() {
    for (words, right) in [
        ("restart-trial", "restart-trail"),
        ("restart-trail --builder sah", "binned, sweep, sbvh"),
        ("restart-trail --short-stack 17", "0..=16"),
        ("restart-trail --class inside", "ambient-occlusion"),
        ("restart-trail --duplication 500 builtin:cubes --rounds 0", "400"),
        ("closest-points", "closest-point"),
        ("closest-point --builder sah", "binned, sweep, sbvh"),
        ("closest-point --short-stack 17", "0..=16"),
        ("closest-point --points 0", "1..=16777216"),
        ("closest-point --brute-force -1", "--brute-force"),
        ("closest-point --brute-force all", "all"),
        ("closest-point --seed x", "--seed"),
        ("closest-point --class primary", "--class"),
        ("closest-point --device cuda", "auto, cpu, gpu"),
        ("closest-point --duplication 500 builtin:cubes --rounds 0 --points 10", "400"),
        ("closest-point builtin:pyramids", "assembly"),
        ("traversal-lists --table 1", "table-1"),
        ("traversal-lists --frustum-grid 65", "1..=64"),
        ("traversal-lists --view 0", "1..=512"),
        ("traversal-lists --brute-force 0", "1..=100000"),
        ("traversal-lists --builder sweep", "--builder"),
        ("two-levels", "two-level"),
        ("two-level --size 0", "1..=2048"),
        ("two-level --bottom octree", "kd-tree"),
        ("two-level --bottom two-level", "kd-tree"),
        ("two-level --bottom list:cull=exact,directions=6", "one side"),
        ("two-level --rebuild 0", "1..=1000000"),
        ("two-level --camera look:eye=1/2/3", "target=X/Y/Z"),
        ("reichl-table2 --size 0", "1..=4096"),
        ("reichl-table2 --camera nowhere builtin:cubes --rounds 0", "nowhere"),
        ("two-level --camera nowhere builtin:cubes --rounds 0", "nowhere"),
    ] {
        run(&format!("lab {words}")).failure(2).mentions(right);
    }
}

#[test]
fn a_folder_that_cannot_be_made_is_known_before_the_work() {
    let folder = Folder::new();
    let file = folder.write("file", "in the way");
    for experiment in ["restart-trail", "closest-point", "traversal-lists", "two-level", "reichl-table2"] {
        run(&format!("lab {experiment} builtin:cubes -o {file}/below")).failure(1).mentions("cannot be made");
        run(&format!("lab {experiment} {file}.ply")).failure(1).mentions("file.ply");
    }
}
