//! The tables of elements a ray and of rates, a line a setting.

use super::Table;
use super::cells::{Cells, NEAR};
use super::record::ListRow;
use super::settings::VERTICES;
use std::fmt::Write;

/// The classes of which elements are counted.
const CLASSES: [&str; 3] = ["primary", "shadow", "diffuse"];

/// The rows of a table that are printed together.
#[derive(Clone, Copy)]
pub(super) struct Part {
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
    pub(super) const EVERY: [Self; 7] = [
        Self::of(Table::Columns, true, false),
        Self::of(Table::Columns, true, true),
        Self::of(Table::Columns, false, false),
        Self::of(Table::Columns, false, true),
        Self::of(Table::Table1, false, false),
        Self::of(Table::AsPrinted, false, false),
        Self::of(Table::Best, true, false),
    ];

    pub(super) fn has(self, row: &ListRow) -> bool {
        let vertices = row.spheres == Some(VERTICES);
        (row.table, row.ground, vertices) == (self.table, self.ground, self.vertices)
    }

    /// Whether hits may be lost.
    fn loses_hits(self) -> bool {
        self.vertices || self.table == Table::AsPrinted
    }
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

/// Writes the table of some rows.
pub(super) fn table_of(text: &mut String, part: Part, rows: &[&ListRow]) {
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
