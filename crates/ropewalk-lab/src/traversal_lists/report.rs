//! The comparison as tables in markdown.

use super::Table;
use super::cells::{Cells, NEAR, near_reference};
use super::record::{CopyRow, ListComparison, ListRow, ListScene};
use super::settings::VERTICES;
use std::fmt::Write;

/// The classes of which elements are counted.
const CLASSES: [&str; 3] = ["primary", "shadow", "diffuse"];
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

/// The rows of a table that are printed together.
#[derive(Clone, Copy)]
struct Part {
    table: Table,
    ground: bool,
    /// Of spheres that hold vertices alone.
    vertices: bool,
}

impl Part {
    const fn of(table: Table, ground: bool, vertices: bool) -> Self {
        Self { table, ground, vertices }
    }

    /// In the order in which they are printed.
    const EVERY: [Self; 7] = [
        Self::of(Table::Columns, true, false),
        Self::of(Table::Columns, true, true),
        Self::of(Table::Columns, false, false),
        Self::of(Table::Columns, false, true),
        Self::of(Table::Table1, false, false),
        Self::of(Table::AsPrinted, false, false),
        Self::of(Table::Best, true, false),
    ];

    fn has(self, row: &ListRow) -> bool {
        let vertices = row.spheres == Some(VERTICES);
        (row.table, row.ground, vertices) == (self.table, self.ground, self.vertices)
    }

    /// Whether hits may be lost.
    fn loses_hits(self) -> bool {
        self.vertices || self.table == Table::AsPrinted
    }
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

/// The rows of a setting, in the order of the settings.
fn by_setting<'a>(rows: &[&'a ListRow]) -> Vec<Vec<&'a ListRow>> {
    let mut names: Vec<&str> = Vec::new();
    for row in rows {
        if !names.contains(&row.setting.as_str()) {
            names.push(&row.setting);
        }
    }
    names.iter().map(|name| rows.iter().copied().filter(|row| row.setting == *name).collect()).collect()
}

fn of_class<'a>(rows: &[&'a ListRow], class: &str) -> Option<&'a ListRow> {
    rows.iter().copied().find(|row| row.rays == class)
}

fn table_of(text: &mut String, part: Part, rows: &[&ListRow]) {
    let Part { table, ground, vertices } = part;
    let place = if ground { "on the ground" } else { "without ground" };
    let title = match table {
        Table::Columns if vertices => "Lists and options, spheres of vertices alone",
        Table::Columns => "Lists and options",
        Table::Table1 => "Table 1: six lists, option by option",
        Table::AsPrinted => "The paper's rule of culling, which loses hits",
        Table::Best => "The best lists, and the same tree walked otherwise",
    };
    let _ = writeln!(text, "#### {title} ({place})\n");
    let is_timed = rows.iter().any(|row| row.fps.is_some());
    let _ = write!(text, "| setting | primary | shadow | diffuse | left out |");
    if part.loses_hits() {
        let _ = write!(text, " lost hits |");
    }
    if is_timed {
        let _ = write!(text, " frame: elements | fps | Mrays/s | paper: fps | paper: Mrays/s |");
    }
    let _ = writeln!(text);
    let lost = usize::from(part.loses_hits());
    let _ =
        writeln!(text, "|---|---:|---:|---:|---:|{}", "---:|".repeat(lost + if is_timed { 5 } else { 0 }));
    for rows in by_setting(rows) {
        line(text, part, &rows, is_timed);
    }
    let _ = writeln!(text);
    notes(text, part, rows, is_timed);
}

fn line(text: &mut String, part: Part, rows: &[&ListRow], is_timed: bool) {
    let Some(first) = rows.first() else { return };
    let _ = write!(text, "| {} |", first.setting);
    for class in CLASSES {
        let cell = of_class(rows, class).map_or_else(
            || "-".into(),
            |row| match row.deviation_percent {
                Some(deviation) => {
                    let mark = if deviation.abs() > NEAR { "!" } else { "" };
                    format!("{:.1} ({deviation:+.1} %){mark}", row.elements_per_ray)
                }
                None => format!("{:.1}", row.elements_per_ray),
            },
        );
        let _ = write!(text, " {cell} |");
    }
    let reference =
        first.reference_culled_share.map(|share| format!(" ({:.1})", 100.0 * share)).unwrap_or_default();
    let _ = write!(text, " {:.1}{reference} % |", 100.0 * first.culled_share);
    if part.loses_hits() {
        let _ = write!(text, " {} |", rows.iter().map(|row| row.lost_hits).sum::<usize>());
    }
    if is_timed {
        let frame = of_class(rows, "frame");
        let cell = |value: Option<f64>| value.map_or_else(|| "-".into(), |value| format!("{value:.2}"));
        let _ = write!(
            text,
            " {} | {} | {} | {} | {} |",
            cell(frame.map(|row| row.elements_per_ray)),
            cell(frame.and_then(|row| row.fps)),
            cell(frame.and_then(|row| row.rays_per_s).map(|rays| rays / 1e6)),
            cell(frame.and_then(|row| row.paper_fps)),
            cell(frame.and_then(|row| row.paper_rays_per_s).map(|rays| rays / 1e6)),
        );
    }
    let _ = writeln!(text);
}

/// What must be said of a table.
fn notes(text: &mut String, part: Part, rows: &[&ListRow], is_timed: bool) {
    let cells = Cells::of(rows.iter().copied());
    if cells.count > 0 {
        let _ = writeln!(
            text,
            "Elements a ray, in brackets how far they are from the reference measurements: {cells}, the farthest {:+.1} percent.\n",
            cells.farthest
        );
    }
    match part.table {
        Table::Columns if is_timed && part.ground => {
            gain(text, rows);
            let _ = writeln!(
                text,
                "Frames are one view's camera rays and then its shadow rays; the paper's are of a GeForce GTX 280 with six lists (Table 2). Its nodes a second are left out: they make 1,077 to 1,159 nodes a ray for every scene, more than the cubes' lists have elements.\n"
            );
        }
        Table::Table1 if is_timed => {
            let _ = writeln!(
                text,
                "The paper's own nodes a second for these rows are noise about 2^31 a frame, and so are the effects of options that it reads from them, 19.8 percent at most; elements a ray here are exact.\n"
            );
        }
        Table::Best => {
            let _ = writeln!(
                text,
                "Of the stack, the boxes and triangles that are tested: two boxes an inner visit. The best lists have triangles of one side, the others of two.\n"
            );
        }
        _ => {}
    }
}

/// What six and eight lists gain over one, all with every option that they have.
fn gain(text: &mut String, rows: &[&ListRow]) {
    let frame = |setting: &str| rows.iter().find(|row| row.setting == setting && row.rays == "frame");
    let Some(one) = frame("1 heads") else { return };
    for setting in ["6 all", "8 all"] {
        let Some(more) = frame(setting) else { continue };
        let (Some(before), Some(after)) = (one.fps, more.fps) else { continue };
        let _ = writeln!(
            text,
            "{setting} over 1 with heads: {:+.1} % elements a ray, {:+.1} % frames a second{}.\n",
            100.0 * (more.elements_per_ray / one.elements_per_ray - 1.0),
            100.0 * (after / before - 1.0),
            if setting == "6 all" { " (the paper: 5 to 15 % more frames)" } else { "" }
        );
    }
}

fn table_3(text: &mut String, copies: &[&CopyRow]) {
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

fn memory(text: &mut String, rows: &[&ListRow]) {
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

#[cfg(test)]
mod tests {
    use super::super::cells::KNOWN;
    use super::*;
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
