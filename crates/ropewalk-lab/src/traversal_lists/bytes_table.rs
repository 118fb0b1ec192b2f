//! The tables of bytes: the copy of the lists beside a frame, and memory.

use super::record::{CopyRow, ListRow};
use super::settings::VERTICES;
use std::fmt::Write;

/// Writes Table 3.
pub(super) fn table_3(text: &mut String, copies: &[&CopyRow]) {
    if copies.is_empty() {
        return;
    }
    let _ = writeln!(text, "#### Table 3: the copy of the lists beside a frame\n");
    let _ = writeln!(
        text,
        "| setting | bytes | copy, ms | frame, ms | ratio | paper: copy | paper: frame | paper: ratio |"
    );
    let _ = writeln!(text, "|---|---:|---:|---:|---:|---:|---:|---:|");
    for row in copies {
        let cell = |value: Option<f64>| value.map_or_else(|| "-".into(), |value| format!("{value:.1}"));
        let _ = writeln!(
            text,
            "| {} | {} | {:.3} | {:.1} | {:.1} % | {} | {} | {} |",
            row.setting,
            row.bytes,
            row.copy_ms,
            row.frame_ms,
            row.ratio_percent,
            cell(row.paper_copy_ms),
            cell(row.paper_frame_ms),
            row.paper_ratio_percent.map_or_else(|| "-".into(), |ratio| format!("{ratio:.1} %")),
        );
    }
    let is_cpu = copies.iter().all(|row| row.device == "cpu");
    let what = if is_cpu {
        "On the CPU nothing is copied for a frame; this is a copy in memory."
    } else {
        "The copy is the upload to the device."
    };
    let _ =
        writeln!(text, "\n{what} It has elements, vertices, who the triangles are, and heads of polygons.\n");
}

/// Writes what each setting's lists take.
pub(super) fn memory(text: &mut String, rows: &[&ListRow]) {
    let Some(device) = rows.first().map(|row| &row.device) else { return };
    let _ = writeln!(text, "### Memory\n");
    let _ = writeln!(
        text,
        "| table | setting | elements | bytes an element | lists | vertices and names | heads |"
    );
    let _ = writeln!(text, "|---|---|---:|---:|---:|---:|---:|");
    let of_lists =
        rows.iter().filter(|row| row.elements > 0 && row.rays == "primary" && row.device == *device);
    for row in of_lists {
        let _ = writeln!(
            text,
            "| {}{}{} | {} | {}{} | {} | {} | {} | {} |",
            row.table.name(),
            if row.spheres == Some(VERTICES) { ", vertices" } else { "" },
            if row.ground { "" } else { ", no ground" },
            row.setting,
            row.elements,
            row.reference_elements.map_or_else(String::new, |reference| {
                format!(" ({:+.2} %)", 100.0 * (row.elements as f64 / reference as f64 - 1.0))
            }),
            row.list_bytes / row.elements,
            row.list_bytes,
            row.shared_bytes,
            row.heads_bytes
        );
    }
    let _ = writeln!(text);
}
