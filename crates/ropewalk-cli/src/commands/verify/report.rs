//! What came of the suite, as a document and as tables.

use crate::table::{Align, Table, seconds, thousands};
use ropewalk_testkit::conformance::RowResult;
use serde::Serialize;
use std::fmt::Write;

#[derive(Debug, Serialize)]
pub(super) struct Document {
    pub(super) passed: bool,
    pub(super) devices: Vec<DeviceRecord>,
}

#[derive(Debug, Serialize)]
pub(super) struct DeviceRecord {
    pub(super) device: String,
    pub(super) passed: bool,
    /// Why the device could not be asked, where it could not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) problem: Option<String>,
    pub(super) seconds: f64,
    pub(super) rows: Vec<RowRecord>,
}

#[derive(Debug, Serialize)]
pub(super) struct RowRecord {
    pub(super) structure: String,
    pub(super) walk: String,
    pub(super) query: String,
    pub(super) passed: bool,
    pub(super) cases: usize,
    pub(super) rays: usize,
    /// Rays of which only one answer was right.
    pub(super) clear: usize,
    /// Rays at ties and edges that hardware answered differently, and rightly.
    pub(super) differing: usize,
    pub(super) failures: Vec<FailureRecord>,
}

#[derive(Debug, PartialEq, Eq, Serialize)]
pub(super) struct FailureRecord {
    pub(super) case: &'static str,
    pub(super) structure: String,
    pub(super) what: String,
}

impl From<&RowResult> for RowRecord {
    fn from(result: &RowResult) -> Self {
        Self {
            structure: result.row.structure.to_string(),
            walk: result.row.walk.to_string(),
            query: result.row.query.to_string(),
            passed: result.is_passed(),
            cases: result.cases,
            rays: result.rays,
            clear: result.clear,
            differing: result.differing,
            failures: result
                .failures
                .iter()
                .map(|failure| FailureRecord {
                    case: failure.case,
                    structure: failure.structure.to_string(),
                    what: failure.what.clone(),
                })
                .collect(),
        }
    }
}

impl Document {
    pub(super) fn to_text(&self) -> String {
        let mut text = String::new();
        for device in &self.devices {
            let verdict = match (&device.problem, device.passed) {
                (Some(problem), _) => format!("cannot be checked: {problem}"),
                (None, true) => format!("ok, in {}", seconds(device.seconds)),
                (None, false) => "FAILED".into(),
            };
            let _ = writeln!(text, "{}: {verdict}", device.device);
            if device.rows.is_empty() {
                continue;
            }
            let mut table = Table::new(&[
                ("structure", Align::Left),
                ("walk", Align::Left),
                ("query", Align::Left),
                ("rows", Align::Right),
                ("cases", Align::Right),
                ("rays", Align::Right),
                ("verdict", Align::Left),
            ]);
            for line in lines(&device.rows) {
                table.row([
                    line.structure.into(),
                    line.walk.into(),
                    line.queries.join(" "),
                    thousands(line.rows),
                    thousands(line.cases),
                    thousands(line.rays),
                    line.verdict,
                ]);
            }
            let _ = writeln!(text, "{table}");
            text.push_str(&failures(&device.rows));
        }
        text
    }

    pub(super) fn complaint(&self) -> String {
        let failed: Vec<&str> = self
            .devices
            .iter()
            .filter(|device| !device.passed)
            .map(|device| device.device.as_str())
            .collect();
        let rows = self.devices.iter().flat_map(|device| &device.rows).filter(|row| !row.passed).count();
        format!("{rows} rows failed on {}", failed.join(" and "))
    }
}

/// A line of the table: one row that failed, or all rows of a structure and a walk, whatever its keys, that did not.
struct Line<'a> {
    structure: &'a str,
    walk: &'a str,
    queries: Vec<&'a str>,
    rows: usize,
    cases: usize,
    rays: usize,
    verdict: String,
    passed: bool,
}

fn lines(rows: &[RowRecord]) -> Vec<Line<'_>> {
    let mut lines: Vec<Line<'_>> = Vec::new();
    for row in rows {
        let verdict = match row.failures.len() {
            0 if row.passed => "ok".to_owned(),
            0 => "nothing was traced".to_owned(),
            failures => format!("FAILED ({failures})"),
        };
        let name = row.walk.split(':').next().unwrap_or_default();
        let same = |line: &&mut Line<'_>| {
            line.passed && row.passed && (line.structure, line.walk) == (row.structure.as_str(), name)
        };
        if let Some(line) = lines.iter_mut().find(same) {
            if !line.queries.contains(&row.query.as_str()) {
                line.queries.push(&row.query);
            }
            line.rows += 1;
            line.cases += row.cases;
            line.rays += row.rays;
        } else {
            lines.push(Line {
                structure: &row.structure,
                walk: if row.passed { name } else { &row.walk },
                queries: vec![&row.query],
                rows: 1,
                cases: row.cases,
                rays: row.rays,
                verdict,
                passed: row.passed,
            });
        }
    }
    lines
}

/// Most rows fail for the same reasons, so each reason is told once. All failures are in the JSON document.
fn failures(rows: &[RowRecord]) -> String {
    const TOLD: usize = 10;
    let mut told: Vec<(&FailureRecord, usize)> = Vec::new();
    for failure in rows.iter().flat_map(|row| &row.failures) {
        match told.iter_mut().find(|(other, _)| other.case == failure.case && other.what == failure.what) {
            Some((_, count)) => *count += 1,
            None => told.push((failure, 1)),
        }
    }
    let mut text = String::new();
    for (failure, count) in told.iter().take(TOLD) {
        let _ =
            writeln!(text, "{count} times: case {}, {}: {}", failure.case, failure.structure, failure.what);
    }
    if told.len() > TOLD {
        let _ = writeln!(text, "and {} more, see --json", told.len() - TOLD);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(failures: Vec<FailureRecord>) -> RowRecord {
        RowRecord {
            structure: "bvh".into(),
            walk: "stack".into(),
            query: "any".into(),
            passed: failures.is_empty(),
            cases: 3,
            rays: 30,
            clear: 20,
            differing: 0,
            failures,
        }
    }

    #[test]
    fn rows_that_pass_share_a_line_and_rows_that_fail_have_their_own() {
        let named = |walk: &str, query: &str, failures| RowRecord {
            walk: walk.into(),
            query: query.into(),
            ..row(failures)
        };
        let rows = [
            named("stack:order=culled", "any", vec![]),
            named("stack:order=ordered", "any", vec![]),
            named("stack:order=ordered", "all", vec![failure("lost")]),
            named("stack:order=ordered", "count", vec![]),
            named("recursive", "any", vec![]),
        ];
        let lines = lines(&rows);
        assert_eq!(lines.len(), 3);
        assert_eq!((lines[0].walk, lines[0].rows, lines[0].rays), ("stack", 3, 90));
        assert_eq!(lines[0].queries, ["any", "count"]);
        assert_eq!((lines[1].walk, lines[1].verdict.as_str()), ("stack:order=ordered", "FAILED (1)"));
    }

    fn failure(what: &str) -> FailureRecord {
        FailureRecord { case: "soup", structure: "bvh".into(), what: what.into() }
    }

    #[test]
    fn failures_show_and_each_reason_is_told_once() {
        let rows =
            vec![row(vec![failure("lost")]), row(vec![failure("lost"), failure("found")]), row(vec![])];
        let device = DeviceRecord { device: "cpu".into(), passed: false, problem: None, seconds: 1.0, rows };
        let document = Document { passed: false, devices: vec![device] };
        let text = document.to_text();
        assert!(text.starts_with("cpu: FAILED\n"), "{text}");
        assert!(text.contains("FAILED (2)") && text.contains("2 times: case soup, bvh: lost"), "{text}");
        assert_eq!(text.matches("lost").count(), 1);
        assert_eq!(document.complaint(), "2 rows failed on cpu");
    }
}
