//! What a README tells of the arena: the best of ours beside the best peers, scene by scene.
//!
//! Two tables for each number of threads: rates of one preset, by the classes of rays; builds of all its engine's presets, with
//! bytes, refits and top levels. In brackets stands the ratio to the best peer, as in the long tables.

use super::tables::{cell, figures};
use super::{ArenaClass, Row, RowKind, StageRecord};
use std::fmt::Write;

/// The tables of an engine over some scenes; rates are those of one of its presets.
#[must_use]
pub fn summary(records: &[StageRecord], engine: &str, preset: &str) -> String {
    let mut threads: Vec<usize> =
        records.iter().flat_map(|record| &record.rows).map(|row| row.threads).collect();
    threads.sort_unstable();
    threads.dedup();
    let mut text = String::new();
    for threads in threads {
        let heading = if threads == 1 { "One thread".into() } else { format!("{threads} threads") };
        if let Some(table) = rates(records, engine, preset, threads) {
            let _ = write!(
                text,
                "{heading}, `{preset}`, millions of rays a second (times the best peer):\n\n{table}\n"
            );
        }
        if let Some(table) = builds(records, engine, threads) {
            let _ = write!(
                text,
                "{heading}, milliseconds (times as fast as the best peer of its grade), and bytes a triangle:\n\n{table}\n"
            );
        }
    }
    text
}

/// Rates: a line a scene and way to hand over rays, a column a class.
fn rates(records: &[StageRecord], engine: &str, preset: &str, threads: usize) -> Option<String> {
    let mut text = "| scene | rays by |".to_owned();
    ArenaClass::EVERY.iter().for_each(|class| text.extend([" ", class.name(), " |"]));
    text.push_str("\n|---|---|");
    ArenaClass::EVERY.iter().for_each(|_| text.push_str("---:|"));
    text.push('\n');
    let empty = text.len();
    for record in records {
        for api in ["single", "batch"] {
            let found = ArenaClass::EVERY.map(|class| {
                record.rows.iter().find(|row| {
                    is_of(row, engine, threads)
                        && row.kind == RowKind::Trace
                        && (row.preset.as_str(), row.api, row.rays.as_str()) == (preset, api, class.name())
                })
            });
            if found.iter().all(Option::is_none) {
                continue;
            }
            let _ = write!(text, "| {} | {api} |", record.scene);
            for row in found {
                let _ = write!(text, " {} |", row.map_or("-".into(), cell));
            }
            text.push('\n');
        }
    }
    (text.len() > empty).then_some(text)
}

/// Builds: a line a scene, a column a preset; the best refit and the largest top level behind them.
fn builds(records: &[StageRecord], engine: &str, threads: usize) -> Option<String> {
    let of_engine = |record: &StageRecord| -> Vec<Row> {
        record.rows.iter().filter(|row| is_of(row, engine, threads)).cloned().collect()
    };
    let mut presets: Vec<String> = Vec::new();
    for row in records.iter().flat_map(of_engine).filter(|row| row.kind == RowKind::Build) {
        if !presets.contains(&row.preset) {
            presets.push(row.preset);
        }
    }
    if presets.is_empty() {
        return None;
    }
    let mut text = "| scene |".to_owned();
    presets.iter().for_each(|preset| text.extend([" ", preset, " |"]));
    text.push_str(" refit | 10000 copies |\n|---|");
    (0..presets.len() + 2).for_each(|_| text.push_str("---:|"));
    text.push('\n');
    for record in records {
        let rows = of_engine(record);
        let _ = write!(text, "| {} |", record.scene);
        for preset in &presets {
            let row = rows.iter().find(|row| row.kind == RowKind::Build && row.preset == *preset);
            let bytes = row.and_then(|row| row.bytes_per_triangle);
            let bytes = bytes.map_or(String::new(), |bytes| format!(", {bytes:.0} B"));
            let _ = write!(text, " {}{bytes} |", row.map_or("-".into(), time));
        }
        let fastest = |wanted: &dyn Fn(&&Row) -> bool| {
            rows.iter().filter(wanted).min_by(|a, b| a.ms.total_cmp(&b.ms)).map_or("-".into(), time)
        };
        let refit = fastest(&|row| row.kind == RowKind::Refit);
        let copies = fastest(&|row| row.kind == RowKind::TopLevel && row.rays == "10000 copies");
        let _ = writeln!(text, " {refit} | {copies} |");
    }
    Some(text)
}

fn is_of(row: &Row, engine: &str, threads: usize) -> bool {
    row.engine == engine && row.threads == threads
}

fn time(row: &Row) -> String {
    let ms = figures(row.ms);
    row.ratio_to_best_peer.map_or(ms.clone(), |ratio| format!("{ms} ({ratio:.2})"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(kind: RowKind, preset: &str, rays: &str, api: &'static str) -> Row {
        Row {
            kind,
            scene: "room".into(),
            engine: "ours".into(),
            preset: preset.into(),
            peer: false,
            rays: rays.into(),
            api,
            mode: api,
            threads: 1,
            mrays_per_s: Some(12.34),
            ms: 8.1,
            bytes_per_triangle: Some(55.4),
            peak_bytes_per_triangle: None,
            ratio_to_best_peer: Some(1.25),
            best_peer: Some("theirs".into()),
            spread: None,
            agreement: None,
        }
    }

    #[test]
    fn the_rows_of_one_engine_are_put_in_order() {
        let rows = vec![
            row(RowKind::Trace, "high", "primary", "single"),
            row(RowKind::Trace, "high", "shadow", "batch"),
            row(RowKind::Trace, "low", "shadow", "single"),
            row(RowKind::Build, "high", "", ""),
            Row { ms: 2.0, ..row(RowKind::Build, "fast", "", "") },
            row(RowKind::Refit, "high", "", ""),
            Row { ms: 3.0, ratio_to_best_peer: None, ..row(RowKind::Refit, "fast", "", "") },
            Row { engine: "theirs".into(), ms: 1.0, ..row(RowKind::Refit, "fast", "", "") },
            row(RowKind::TopLevel, "high", "1000 copies", ""),
        ];
        let record =
            StageRecord { scene: "room".into(), triangles: 1, rounds: 1, rows, failures: Vec::new() };
        let text = summary(&[record], "ours", "high");
        for line in [
            "One thread, `high`, millions of rays a second (times the best peer):",
            "| room | single | 12.3 (1.25) | - | - | - | - |",
            "| room | batch | - | - | - | 12.3 (1.25) | - |",
            "| scene | high | fast | refit | 10000 copies |",
            "| room | 8.10 (1.25), 55 B | 2.00 (1.25), 55 B | 3.00 | - |",
        ] {
            assert!(text.lines().any(|found| found == line), "{line}\n{text}");
        }
        assert_eq!(summary(&[], "ours", "high"), "");
    }
}
