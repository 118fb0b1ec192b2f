//! Everything in markdown, scene after scene.

use super::record::{PrimaryRow, ReichlTable2Findings, ReichlTable2Row, ReichlTable2Scene};
use std::fmt::Write;

/// Tables of all rows.
#[must_use]
pub fn markdown(findings: &ReichlTable2Findings) -> String {
    let mut text = String::new();
    for scene in &findings.scenes {
        heading(&mut text, scene);
        let rows: Vec<&ReichlTable2Row> =
            findings.rows.iter().filter(|row| row.scene == scene.scene).collect();
        let mut devices: Vec<&str> = rows.iter().map(|row| row.device.as_str()).collect();
        devices.dedup();
        // Counts are the same on every device.
        if let Some(&device) = devices.first() {
            counts(&mut text, rows.iter().copied().filter(|row| row.device == device));
        }
        for device in devices {
            frames(&mut text, device, rows.iter().copied().filter(|row| row.device == device));
            let of = |row: &&PrimaryRow| row.scene == scene.scene && row.device == device;
            primary(&mut text, findings.primary.iter().filter(of));
        }
    }
    text
}

fn heading(text: &mut String, scene: &ReichlTable2Scene) {
    let ReichlTable2Scene { scene: name, objects, triangles, lights, size, paper_scene } = scene;
    let _ = writeln!(text, "## {name}\n");
    let stands = paper_scene.map_or_else(String::new, |paper| format!(" Beside the paper's {paper}."));
    let _ = writeln!(
        text,
        "{objects} objects, {triangles} triangles, {lights} lights of the file, {size} by {size} pixels.{stands}\n"
    );
}

fn number(value: Option<f64>, digits: usize) -> String {
    value.map_or_else(|| "-".into(), |value| format!("{value:.digits$}"))
}

fn percent(value: Option<f64>) -> String {
    value.map_or_else(|| "-".into(), |value| format!("{:.1} %", 100.0 * value))
}

/// The paper's Table 2.
fn frames<'a>(text: &mut String, device: &str, rows: impl Iterator<Item = &'a ReichlTable2Row>) {
    let _ = writeln!(text, "### Table 2: frames a second on {device}\n");
    let _ = writeln!(
        text,
        "Primary hits are drawn. 100 % is the speed of one kd-tree in the same round. Pixels that differ are those that show it, beside one kd-tree on the CPU.\n"
    );
    let _ = writeln!(
        text,
        "| configuration | structure | frames/s | over kd | the paper's frames/s | the paper's over kd | pixels that differ |"
    );
    let _ = writeln!(text, "|---|---|---:|---:|---:|---:|---:|");
    for row in rows {
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {} | {} | {} |",
            row.configuration,
            row.structure,
            number(row.frames_per_s, 3),
            percent(row.relative_to_single_kd),
            number(row.paper_frames_per_s, 2),
            percent(row.paper_relative),
            row.different_pixels,
        );
    }
    let _ = writeln!(text);
}

/// What the walks do.
fn counts<'a>(text: &mut String, rows: impl Iterator<Item = &'a ReichlTable2Row>) {
    let _ = writeln!(text, "### What a ray costs\n");
    let _ = writeln!(
        text,
        "Rays behind the primary hits; of primary shading the primary rays, if they are traced. Counts are a ray.\n"
    );
    let _ = writeln!(
        text,
        "| configuration | structure | rays | inner nodes | over kd | triangles tested | over kd | leaves | objects entered |"
    );
    let _ = writeln!(text, "|---|---|---:|---:|---:|---:|---:|---:|---:|");
    for row in rows {
        let _ = writeln!(
            text,
            "| {} | {} | {} | {:.2} | {} | {:.2} | {} | {:.2} | {} |",
            row.configuration,
            row.structure,
            row.rays,
            row.inner_visits,
            number(row.inner_visits_relative, 3),
            row.primitive_tests,
            number(row.primitive_tests_relative, 3),
            row.leaf_visits,
            number(row.objects_entered, 3),
        );
    }
    let _ = writeln!(text);
}

/// Drawn beside traced.
fn primary<'a>(text: &mut String, rows: impl Iterator<Item = &'a PrimaryRow>) {
    let mut rows = rows.peekable();
    let Some(first) = rows.peek() else { return };
    let _ = writeln!(text, "### Primary hits, drawn beside traced\n");
    let _ = writeln!(
        text,
        "{} rays. Materials count as if they had no holes. The paper: up to {} times as fast.\n",
        first.rays, first.paper_gain
    );
    let _ = writeln!(
        text,
        "| structure | hits | other hits | other last bits | traced instead | traced, ms | drawn, ms | gain | made ready once, ms |"
    );
    let _ = writeln!(text, "|---|---:|---:|---:|---:|---:|---:|---:|---:|");
    for row in rows {
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {} | {} | {} | {} | {} |",
            row.structure,
            row.hits,
            row.different,
            row.rounded,
            row.traced_instead,
            number(row.traced_ms, 2),
            number(row.rasterised_ms, 2),
            number(row.gain, 2),
            number(row.preparation_ms, 2),
        );
    }
    let _ = writeln!(text);
}
