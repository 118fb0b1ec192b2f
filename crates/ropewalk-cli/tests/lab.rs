//! `ropewalk lab`: what is printed, what is written, and how wrong words are answered.

mod support;

use support::{Folder, run};

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
    ] {
        run(&format!("lab {words}")).failure(2).mentions(right);
    }
}

#[test]
fn a_folder_that_cannot_be_made_is_known_before_the_work() {
    let folder = Folder::new();
    let file = folder.write("file", "in the way");
    run(&format!("lab restart-trail builtin:cubes -o {file}/below")).failure(1).mentions("cannot be made");
}
