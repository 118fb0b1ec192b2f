//! Everything in markdown, scene after scene.

use super::record::{TwoLevelFindings, TwoLevelRow, TwoLevelScene};
use super::tables;
use std::fmt::Write;

/// Tables of all rows.
#[must_use]
pub fn markdown(findings: &TwoLevelFindings) -> String {
    let mut text = String::new();
    for scene in &findings.scenes {
        heading(&mut text, scene);
        let rows: Vec<&TwoLevelRow> = findings.rows.iter().filter(|row| row.scene == scene.scene).collect();
        let mut devices: Vec<&str> = rows.iter().map(|row| row.device.as_str()).collect();
        devices.dedup();
        let of = |device: &str| -> Vec<&TwoLevelRow> {
            rows.iter().copied().filter(|row| row.device == device).collect()
        };
        // Counts are the same on every device.
        if let Some(device) = devices.first() {
            tables::depths(&mut text, &scene.scene, &of(device));
            tables::objects(&mut text, &scene.scene, &of(device));
        }
        for device in devices {
            tables::speeds(&mut text, &scene.scene, device, &of(device));
        }
        let maps: Vec<_> = findings.heat.iter().filter(|map| map.scene == scene.scene).collect();
        tables::heat(&mut text, &maps);
    }
    tables::rebuilds(&mut text, &findings.rebuilds);
    text
}

fn heading(text: &mut String, scene: &TwoLevelScene) {
    let TwoLevelScene { scene: name, objects, shapes, triangles, turned, size, differing, .. } = scene;
    let _ = writeln!(text, "## {name}\n");
    let _ = writeln!(text, "{objects} objects of {shapes} shapes, {triangles} triangles.\n");
    let _ = writeln!(
        text,
        "* Oriented boxes: {turned} of the shapes lie in a frame of their own; the boxes of all objects in the scene have {:.1} % of the area that they have without.",
        100.0 * scene.box_area_ratio
    );
    let rays: Vec<String> = scene.rays.iter().map(|(class, count)| format!("{count} {class}")).collect();
    let _ = writeln!(text, "* Rays of a picture of {size} by {size} pixels: {}.", rays.join(", "));
    let _ = writeln!(
        text,
        "* All rows answer as one BVH over the flattened scene does, but for {differing} answers at grazes and where triangles lie in one place, of which an oracle in f64 or the triangle itself says that they are right too."
    );
    for missing in &scene.not_offered {
        let _ = writeln!(text, "* Not offered: {missing}.");
    }
    let _ = writeln!(text);
}

#[cfg(test)]
mod tests {
    use super::super::heat::HeatMap;
    use super::super::record::tests::{rebuild_row, row};
    use super::*;

    #[test]
    fn a_scene_has_all_its_tables() {
        let smart = TwoLevelRow { walk: "smart-stack".into(), ..row(Some("kd-tree"), true, "shadow", 1.2) };
        let mut rows = vec![
            row(None, false, "primary", 0.0),
            row(Some("kd-tree"), true, "primary", 1.1),
            row(Some("kd-tree"), false, "primary", 2.4),
            row(Some("kd-tree"), true, "shadow", 1.2),
            row(Some("kd-tree"), false, "shadow", 3.6),
            smart,
            TwoLevelRow { device: "another".into(), ..row(Some("kd-tree"), true, "primary", 1.1) },
        ];
        for row in &mut rows {
            row.scene = "cars/car.glb".into();
        }
        let scene = TwoLevelScene {
            scene: "cars/car.glb".into(),
            objects: 12,
            shapes: 5,
            triangles: 3400,
            turned: 3,
            box_area_ratio: 0.875,
            size: 64,
            rays: vec![("primary", 4096), ("shadow", 900)],
            differing: 17,
            not_offered: vec!["list on another".into()],
        };
        let names = ("cars/car.glb", "shadow", "kd-tree".into());
        let map = HeatMap::new(names, true, 2, &[0, 1, 2], &[1, 5, 3]);
        let rebuilds = vec![rebuild_row(100, 0.03), rebuild_row(1000, 0.3)];
        let mut findings = TwoLevelFindings { scenes: vec![scene], rows, heat: vec![map], rebuilds };
        let text = markdown(&findings);
        for part in [
            "12 objects of 5 shapes, 3400 triangles",
            "87.5 % of the area",
            "4096 primary, 900 shadow",
            "but for 17 answers",
            "Not offered: list on another.",
            "| kd-tree | yes | primary | 1.500 | 4 | 0.750 | 2.500 | 9 | 1.250 | 120 |",
            "| the paper's Chevy | | primary | 0.72 | 5 | 1.1 | 0.22 | 5 | 0.37 | |",
            "| kd-tree | shadow | 3.600 | 1.200 | 0.333 | 4.500 | 1.500 |",
            "The paper's Chevy: 3.44 kd-trees a shadow ray",
            "### Speed on cpu",
            "### Speed on another",
            "| two-level, smart-stack |",
            "| the paper's Chevy | shadow, reflections, 5 bounces | | | | | | | | | | 42.1 %, 50.5 %, 42.6 % | |",
            "| shadow | yes | 1 | 2 (66.7 %) | 1 (33.3 %) | 0 (0.0 %) | 0 (0.0 %) |",
            "| 1000 | 0.300 | 9.8 |",
        ] {
            assert!(text.contains(part), "{part}: {text}");
        }
        // Nothing is said of what was not measured.
        findings.rebuilds.clear();
        findings.heat.clear();
        for row in &mut findings.rows {
            row.rays_per_s = None;
            row.relative_to_single_kd = None;
        }
        let text = markdown(&findings);
        assert!(!text.contains("Rebuild") && !text.contains("Heat") && text.contains("| - |"), "{text}");
        assert_eq!(markdown(&TwoLevelFindings::default()), "");
    }
}
