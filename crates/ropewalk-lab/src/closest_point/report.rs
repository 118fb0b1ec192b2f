//! The comparison as tables in markdown: one a scene and device, a line a tree and walk.

use super::record::{PointComparison, PointRow, PointScene};
use std::fmt::Write;

/// Tables of all rows.
#[must_use]
pub fn markdown(comparison: &PointComparison) -> String {
    let mut text = String::new();
    for scene in &comparison.scenes {
        confirmed(&mut text, scene);
        let rows: Vec<&PointRow> = comparison.rows.iter().filter(|row| row.scene == scene.scene).collect();
        let mut devices: Vec<&str> = rows.iter().map(|row| row.device.as_str()).collect();
        devices.sort_unstable();
        devices.dedup();
        for device in devices {
            table(&mut text, device, rows.iter().copied().filter(|row| row.device == device));
        }
    }
    text
}

/// What was asked, and who says that the answers are right.
fn confirmed(text: &mut String, scene: &PointScene) {
    let PointScene { scene, triangles, points, seed, brute_force_points, oracle_points, differences } = scene;
    let _ = writeln!(text, "## {scene}\n");
    let _ = writeln!(text, "{points} points (seed {seed}) around {triangles} triangles.\n");
    let _ = writeln!(text, "* Right by the f64 oracle: {oracle_points} of {points}.");
    let rest = if brute_force_points < points { "; the rest was not asked" } else { "" };
    let _ = writeln!(text, "* Equal to brute force to the bit: {brute_force_points} of {points}{rest}.");
    let _ = writeln!(
        text,
        "* Differences of the walks below: {differences}{}.\n",
        if *differences > 0 { ", within the rounding of graphics hardware" } else { "" }
    );
}

fn table<'a>(text: &mut String, device: &str, rows: impl Iterator<Item = &'a PointRow>) {
    let _ = writeln!(text, "### On {device}\n");
    let _ = writeln!(text, "Means a point, beside those of the full stack over the same tree.\n");
    let _ = writeln!(
        text,
        "| builder | leaf cap | references | walk | inner | leaf | tests | restarts | inner over full | Mpoints/s | time over full |"
    );
    let _ = writeln!(text, "|---|---:|---:|---|---:|---:|---:|---:|---:|---:|---:|");
    for row in rows {
        let growth = 100.0 * (row.references as f64 / row.triangles.max(1) as f64 - 1.0);
        let rate = row.points_per_s.map_or_else(|| "-".into(), |rate| format!("{:.3}", rate / 1e6));
        let time = row.ratio_time.map_or_else(|| "-".into(), |ratio| format!("{:.2}", ratio.median));
        let _ = writeln!(
            text,
            "| {} | {} | {growth:+.1} % | {} | {:.2} | {:.2} | {:.2} | {:.2} | {:.3} | {rate} | {time} |",
            row.builder,
            row.max_leaf,
            row.walk,
            row.inner_visits,
            row.leaf_visits,
            row.primitive_tests,
            row.restarts,
            row.ratio_inner
        );
    }
    let _ = writeln!(text);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::closest_point::record::tests::row;

    #[test]
    fn a_scene_has_what_confirms_it_and_a_table_a_device() {
        let rows = vec![
            row("stack", 1.0),
            row("restart-trail:short-stack=0", 1.5),
            PointRow { device: "another".into(), points_per_s: None, ratio_time: None, ..row("stack", 1.0) },
            PointRow { scene: "elsewhere".into(), ..row("nowhere", 1.0) },
        ];
        let scene = PointScene {
            scene: rows[0].scene.clone(),
            triangles: 10,
            points: 200,
            seed: 7,
            brute_force_points: 100,
            oracle_points: 200,
            differences: 0,
        };
        let text = markdown(&PointComparison { scenes: vec![scene.clone()], rows });
        assert!(text.contains("200 points (seed 7) around 10 triangles"), "{text}");
        assert!(
            text.contains("oracle: 200 of 200")
                && text.contains("the bit: 100 of 200; the rest was not asked.\n"),
            "{text}"
        );
        assert!(text.contains("walks below: 0.\n"), "{text}");
        let line = "| sbvh | 4 | +20.0 % | restart-trail:short-stack=0 | 30.00 | 2.00 | 5.00 | 1.50 | 1.500 | 0.250 | 1.25 |";
        assert!(text.contains(line), "{text}");
        assert!(text.contains("### On another") && text.contains("| 1.000 | - | - |"), "{text}");
        assert!(!text.contains("nowhere"), "{text}");
        let hardware = PointScene { differences: 3, ..scene };
        let text = markdown(&PointComparison { scenes: vec![hardware], rows: Vec::new() });
        assert!(text.contains("walks below: 3, within the rounding"), "{text}");
        assert_eq!(markdown(&PointComparison::default()), "");
    }
}
