//! The comparison in markdown, scene after scene.

use super::bytes_table::{memory, table_3};
use super::cells::near_reference;
use super::elements_table::{Part, table_of};
use super::record::{CopyRow, ListComparison, ListRow, ListScene};
use std::fmt::Write;

/// Tables of all rows.
#[must_use]
pub fn markdown(comparison: &ListComparison) -> String {
    let mut text = String::new();
    for scene in &comparison.scenes {
        let rows: Vec<&ListRow> = comparison.rows.iter().filter(|row| row.scene == scene.scene).collect();
        heading(&mut text, scene);
        let mut devices: Vec<&str> = rows.iter().map(|row| row.device.as_str()).collect();
        devices.sort_unstable();
        devices.dedup();
        for device in devices {
            let of_device = || rows.iter().copied().filter(|row| row.device == device);
            let _ = writeln!(text, "### On {device}\n");
            for part in Part::EVERY {
                let rows: Vec<&ListRow> = of_device().filter(|row| part.has(row)).collect();
                if !rows.is_empty() {
                    table_of(&mut text, part, &rows);
                }
            }
            let copies: Vec<&CopyRow> = comparison
                .copies
                .iter()
                .filter(|row| row.scene == scene.scene && row.device == device)
                .collect();
            table_3(&mut text, &copies);
        }
        memory(&mut text, &rows);
    }
    near_reference(&mut text, comparison);
    text
}

fn heading(text: &mut String, scene: &ListScene) {
    let ListScene { scene, triangles, view, frame, rays, brute_force_rays } = scene;
    let _ = writeln!(text, "## {scene}\n");
    let _ = writeln!(text, "{triangles} triangles without a ground.\n");
    let _ = writeln!(
        text,
        "* Six views of {view} pixels a side for counts{}.",
        match frame {
            Some(frame) => format!("; frames of {frame}, the paper's have 1024"),
            None => String::new(),
        }
    );
    let _ = writeln!(
        text,
        "* Rays that every setting answers as the ordered stack does, of two sides or of one: {rays}."
    );
    let _ = writeln!(text, "* Of these held against every triangle, to the bit: {brute_force_rays}.\n");
}

#[cfg(test)]
mod tests {
    use super::super::cells::KNOWN;
    use super::*;
    use crate::traversal_lists::Table;
    use crate::traversal_lists::record::tests::row;

    #[test]
    fn a_scene_has_its_tables_and_what_is_far_off_is_marked() {
        let frame = |setting: &str, elements: f64, fps: f64| ListRow {
            fps: Some(fps),
            ..row(setting, "frame", elements)
        };
        let rows = vec![
            ListRow { fps: None, ..row("1 heads", "primary", 51.0) },
            frame("1 heads", 60.0, 4.0),
            row("6 all", "primary", 50.5),
            row("6 all", "shadow", 57.0),
            frame("6 all", 45.0, 5.0),
            ListRow {
                table: Table::AsPrinted,
                ground: false,
                lost_hits: 17,
                deviation_percent: None,
                ..row("6 as printed", "shadow", 40.0)
            },
            ListRow {
                spheres: Some("vertices"),
                lost_hits: 3,
                reference_elements: Some(1010),
                ..row("6 all", "primary", 50.1)
            },
            ListRow {
                heads: "disabled",
                frustum_grid: 0,
                spheres: Some("vertices"),
                ..row("1", "primary", 60.0)
            },
            ListRow { scene: "elsewhere".into(), deviation_percent: None, ..row("nowhere", "primary", 1.0) },
        ];
        let scene = ListScene {
            scene: rows[0].scene.clone(),
            triangles: 69_451,
            view: 144,
            frame: Some(512),
            rays: 500,
            brute_force_rays: 200,
        };
        let copy = CopyRow {
            scene: rows[0].scene.clone(),
            triangles: 69_453,
            setting: "6 all".into(),
            device: "cpu".into(),
            bytes: 10_900_000,
            copy_ms: 2.0,
            frame_ms: 200.0,
            ratio_percent: 1.0,
            paper_copy_ms: Some(18.2),
            paper_frame_ms: Some(167.0),
            paper_ratio_percent: Some(10.9),
        };
        let mut comparison = ListComparison { scenes: vec![scene], rows, copies: vec![copy] };
        let text = markdown(&comparison);
        assert!(text.contains("| 6 all | 50.5 (+1.0 %) | 57.0 (+14.0 %)! | - | 12.3 (12.0) % | 45.00 | 5.00 | 2.50 | 6.01 | 11.52 |"), "{text}");
        assert!(text.contains("2 of 3 within 5 percent, the farthest +14.0 percent"), "{text}");
        assert!(
            text.contains("6 all over 1 with heads: -25.0 % elements a ray, +25.0 % frames a second"),
            "{text}"
        );
        assert!(text.contains("| 6 as printed | - | 40.0 | - | 12.3 (12.0) % | 17 |"), "{text}");
        assert!(
            text.contains("| 6 all | 10900000 | 2.000 | 200.0 | 1.0 % | 18.2 | 167.0 | 10.9 % |"),
            "{text}"
        );
        assert!(text.contains("| columns | 6 all | 1000 | 20 | 20000 | 3000 | 2400 |"), "{text}");
        assert!(text.contains("| columns, vertices | 6 all | 1000 (-0.99 %) | 20 |"), "{text}");
        assert!(text.contains("| 6 all | 50.1 (+0.2 %) | - | - | 12.3 (12.0) % | 3 |"), "{text}");
        let boxes = "| boxes | 0 of 0 within 5 percent | 2 of 3 within 5 percent | 2 of 3 within 5 percent | +14.0 % | 0 |";
        let vertices = "| vertices | 0 of 1 within 5 percent | 1 of 1 within 5 percent | 1 of 2 within 5 percent | +20.0 % | 3 |";
        assert!(text.contains(boxes) && text.contains(vertices) && text.contains(KNOWN), "{text}");
        assert!(
            text.contains("against every triangle, to the bit: 200") && !text.contains("nowhere"),
            "{text}"
        );
        comparison.rows.retain(|row| row.rays != "frame");
        comparison.copies.clear();
        let text = markdown(&comparison);
        assert!(!text.contains("fps") && !text.contains("Table 3"), "{text}");
        assert_eq!(markdown(&ListComparison::default()), "");
    }
}
