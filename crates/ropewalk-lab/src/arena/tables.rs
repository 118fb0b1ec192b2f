//! The arena in tables of Markdown.
//!
//! One table a scene and number of threads: an engine with its preset a line, a class of rays a column, the rate and behind it
//! the ratio to the best peer. Builds, refits and top levels stand in tables of their own. Lines without a wrong answer say
//! nothing of it; others say how many of how many rays.

use super::{ArenaClass, Row, RowKind, StageRecord};
use std::fmt::Write;

/// All tables of some scenes.
#[must_use]
pub fn markdown(records: &[StageRecord]) -> String {
    let mut text = String::new();
    for record in records {
        let _ = writeln!(text, "### {} ({} triangles)\n", record.scene, record.triangles);
        let mut threads: Vec<usize> = record.rows.iter().map(|row| row.threads).collect();
        threads.sort_unstable();
        threads.dedup();
        for threads in threads {
            let rows: Vec<&Row> = record.rows.iter().filter(|row| row.threads == threads).collect();
            let heading = if threads == 1 { "1 thread".into() } else { format!("{threads} threads") };
            for table in [rays(&rows), builds(&rows), moves(&rows)].into_iter().flatten() {
                let _ = writeln!(text, "{heading}, {table}");
            }
        }
        for failure in &record.failures {
            let _ = writeln!(text, "* {failure}");
        }
        if !record.failures.is_empty() {
            text.push('\n');
        }
    }
    text
}

/// A table of rates, if there are any.
fn rays(rows: &[&Row]) -> Option<String> {
    let traced: Vec<&Row> = rows
        .iter()
        .copied()
        .filter(|row| row.kind == RowKind::Trace && row.rays.parse::<ArenaClass>().is_ok())
        .collect();
    let mut columns: Vec<&str> = Vec::new();
    let mut lines: Vec<(&str, &str, &str)> = Vec::new();
    for row in &traced {
        if !columns.contains(&row.rays.as_str()) {
            columns.push(&row.rays);
        }
        let line = (row.engine.as_str(), row.preset.as_str(), row.mode);
        if !lines.contains(&line) {
            lines.push(line);
        }
    }
    if lines.is_empty() {
        return None;
    }
    let mut text = "Mrays/s (times the best peer):\n\n| engine | preset | rays by |".to_owned();
    columns.iter().for_each(|column| text.extend([" ", column, " |"]));
    text.push_str(" wrong answers |\n|---|---|---|");
    columns.iter().for_each(|_| text.push_str("---:|"));
    text.push_str("---|\n");
    for line in lines {
        let of_line: Vec<&Row> = traced
            .iter()
            .copied()
            .filter(|row| (row.engine.as_str(), row.preset.as_str(), row.mode) == line)
            .collect();
        let _ = write!(text, "| {} | {} | {} |", line.0, line.1, line.2);
        for column in &columns {
            let cell = of_line.iter().find(|row| row.rays == **column).map_or("-".into(), |row| cell(row));
            let _ = write!(text, " {cell} |");
        }
        let _ = writeln!(text, " {} |", wrong(&of_line));
    }
    Some(text)
}

pub(super) fn cell(row: &Row) -> String {
    let rate = row.mrays_per_s.map_or("-".into(), figures);
    match row.ratio_to_best_peer {
        Some(ratio) => format!("{rate} ({ratio:.2})"),
        None => rate,
    }
}

/// Who lost or invented hits, by class.
fn wrong(rows: &[&Row]) -> String {
    let told: Vec<String> = rows
        .iter()
        .filter_map(|row| {
            let verdict = row.agreement?;
            let parts: Vec<String> = [
                (verdict.missed, "missed"),
                (verdict.invented, "invented"),
                (verdict.wrong_t, "wrong t"),
                (verdict.open, "open"),
            ]
            .into_iter()
            .filter(|(count, _)| *count > 0)
            .map(|(count, what)| format!("{count} {what}"))
            .collect();
            (!parts.is_empty()).then(|| format!("{}: {}", row.rays, parts.join(", ")))
        })
        .collect();
    told.join("; ")
}

/// A table of builds, if there are any.
fn builds(rows: &[&Row]) -> Option<String> {
    let built: Vec<&&Row> = rows.iter().filter(|row| row.kind == RowKind::Build).collect();
    if built.is_empty() {
        return None;
    }
    let mut text = "builds:\n\n| engine | preset | ms | times as fast as the best peer of its grade | bytes a triangle | at most while building |\n|---|---|---:|---|---:|---:|\n".to_owned();
    for row in built {
        let bytes = |bytes: Option<f64>| bytes.map_or("-".into(), |bytes| format!("{bytes:.1}"));
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {} | {} |",
            row.engine,
            row.preset,
            figures(row.ms),
            compared(row),
            bytes(row.bytes_per_triangle),
            bytes(row.peak_bytes_per_triangle)
        );
    }
    Some(text)
}

/// A table of refits, top levels and rays among copies, if there are any.
fn moves(rows: &[&Row]) -> Option<String> {
    let moved: Vec<&&Row> = rows
        .iter()
        .filter(|row| match row.kind {
            RowKind::Refit | RowKind::TopLevel => true,
            RowKind::Trace => row.rays.parse::<ArenaClass>().is_err(),
            RowKind::Build => false,
        })
        .collect();
    if moved.is_empty() {
        return None;
    }
    let mut text = "what moves:\n\n| task | engine | preset | rays by | ms | Mrays/s | times as fast as the best peer |\n|---|---|---|---|---:|---:|---|\n".to_owned();
    for row in moved {
        let task = match row.kind {
            RowKind::Refit => "refit",
            RowKind::TopLevel => "top level, ",
            _ => "",
        };
        let _ = writeln!(
            text,
            "| {task}{} | {} | {} | {} | {} | {} | {} |",
            row.rays,
            row.engine,
            row.preset,
            row.mode,
            figures(row.ms),
            row.mrays_per_s.map_or("-".into(), figures),
            compared(row)
        );
    }
    Some(text)
}

fn compared(row: &Row) -> String {
    match (row.ratio_to_best_peer, row.spread, &row.best_peer) {
        (Some(ratio), Some(spread), Some(peer)) => {
            format!("{ratio:.2} ({:.2} to {:.2}) of {peer}", spread.min, spread.max)
        }
        _ => "-".into(),
    }
}

/// Three figures are all that such a measurement is good for.
pub(super) fn figures(number: f64) -> String {
    match number {
        number if number < 1.0 => format!("{number:.3}"),
        number if number < 10.0 => format!("{number:.2}"),
        number if number < 100.0 => format!("{number:.1}"),
        number => format!("{number:.0}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Spread;
    use crate::arena::Verdict;

    fn row() -> Row {
        Row {
            kind: RowKind::Trace,
            scene: "room".into(),
            engine: "ours".into(),
            preset: "balanced".into(),
            peer: false,
            rays: "primary".into(),
            api: "batch",
            mode: "batch",
            threads: 1,
            mrays_per_s: Some(12.345),
            ms: 81.0,
            bytes_per_triangle: None,
            peak_bytes_per_triangle: None,
            ratio_to_best_peer: Some(1.8),
            best_peer: Some("theirs".into()),
            spread: Some(Spread { median: 1.8, min: 1.7, max: 1.9 }),
            agreement: Some(Verdict { rays: 1000, ..Verdict::default() }),
        }
    }

    #[test]
    fn known_numbers_stand_where_they_belong() {
        let wrong = Verdict { rays: 1000, differing: 4, missed: 3, wrong_t: 1, ..Verdict::default() };
        let rows = vec![
            row(),
            Row { rays: "shadow".into(), mrays_per_s: Some(100.4), ratio_to_best_peer: Some(0.5), ..row() },
            Row {
                engine: "theirs".into(),
                peer: true,
                agreement: Some(wrong),
                mrays_per_s: Some(0.5),
                ..row()
            },
            Row {
                kind: RowKind::Build,
                rays: String::new(),
                ms: 7.891,
                mrays_per_s: None,
                bytes_per_triangle: Some(69.96),
                peak_bytes_per_triangle: Some(101.0),
                ..row()
            },
            Row {
                kind: RowKind::TopLevel,
                rays: "1000 copies".into(),
                ms: 0.25,
                mrays_per_s: None,
                mode: "",
                ..row()
            },
        ];
        let failures = vec!["theirs: no refit".into()];
        let record = StageRecord { scene: "room".into(), triangles: 12, rounds: 3, rows, failures };
        let text = markdown(&[record]);
        for line in [
            "### room (12 triangles)",
            "1 thread, Mrays/s (times the best peer):",
            "| engine | preset | rays by | primary | shadow | wrong answers |",
            "| ours | balanced | batch | 12.3 (1.80) | 100 (0.50) |  |",
            "| theirs | balanced | batch | 0.500 (1.80) | - | primary: 3 missed, 1 wrong t |",
            "| ours | balanced | 7.89 | 1.80 (1.70 to 1.90) of theirs | 70.0 | 101.0 |",
            "| top level, 1000 copies | ours | balanced |  | 0.250 | - | 1.80 (1.70 to 1.90) of theirs |",
            "* theirs: no refit",
        ] {
            assert!(text.lines().any(|found| found == line), "{line}\n{text}");
        }
        assert_eq!(markdown(&[]), "");
    }
}
