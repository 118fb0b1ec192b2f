//! Table 2 on the scenes that the paper has, or that stand for its: where they are.

mod common;

use ropewalk_lab::reichl_table2::{ReichlTable2Findings, ReichlTable2Settings, run};
use ropewalk_render::{Ground, Stage, StageOptions};
use std::ops::ControlFlow;

/// Counts of a scene in a small picture; `None`, with a word, where the scene is not there.
fn counted(name: &str) -> Option<ReichlTable2Findings> {
    let model = common::model(name)?;
    let stage = Stage::new(model, &StageOptions { ground: Ground::Off, ..StageOptions::default() });
    let settings = ReichlTable2Settings { size: 96, ..ReichlTable2Settings::new() };
    Some(run(name, &stage, &settings, &|_| ControlFlow::Continue(())).expect("the pictures are the same"))
}

/// The pictures of both structures are the same, what is drawn is what is traced, and two levels cost what they should: in the robots'
/// room, where objects overlap, more than one tree, and for the chess set, where they stand apart, less.
#[test]
fn two_levels_cost_what_the_scene_makes_of_them() {
    let bands = [
        ("bart_robot/Robot.aff", [1.0, 1.5]),
        ("bart_kitchen/kitchen.aff", [0.8, 1.1]),
        ("car_ldraw/car_ldraw_instanced.glb", [0.5, 2.5]),
        ("chess34_ccby/chess34_fantasy.glb", [0.5, 1.0]),
    ];
    for (name, [least, most]) in bands {
        let Some(found) = counted(name) else { continue };
        assert!(found.scenes[0].paper_scene.is_some(), "{name}");
        for row in found.rows.iter().filter(|row| row.structure == "two-level" && row.rays > 0) {
            let ratio = row.inner_visits_relative.unwrap();
            println!("{name}, {}: {ratio:.3} of one kd-tree's nodes", row.configuration);
            assert!((least..=most).contains(&ratio), "{name}, {}: {ratio}", row.configuration);
            assert!(row.paper_relative.is_some(), "{name}");
        }
        for row in &found.primary {
            assert_eq!((row.different, row.rounded, row.traced_instead), (0, 0, 0), "{name}: {row:?}");
            assert!(row.hits > 500, "{name}: {row:?}");
        }
    }
}
