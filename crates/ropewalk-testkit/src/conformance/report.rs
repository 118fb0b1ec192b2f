//! What came of a run of the suite.

use crate::cases::Tree;
use ropewalk::catalogue::Row;
use std::fmt;

/// Something that a row got wrong.
#[derive(Clone, Debug, PartialEq)]
pub struct Failure {
    /// The name of the case.
    pub case: &'static str,
    /// The structure as it was built.
    pub structure: Tree,
    /// What is wrong.
    pub what: String,
}

impl fmt::Display for Failure {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "case {}, {}: {}", self.case, self.structure, self.what)
    }
}

/// What came of one row.
#[derive(Clone, Debug, PartialEq)]
pub struct RowResult {
    /// The row.
    pub row: Row,
    /// Cases that were traced; a case with several depth caps counts once for each. One whose tree is deeper than the
    /// walk's register, and which the walk rightly refuses, counts nowhere.
    pub cases: usize,
    /// Rays that were judged.
    pub rays: usize,
    /// Rays of which the oracle would have accepted one answer alone.
    pub clear: usize,
    /// Rays that began at a head and were compared with brute force: see [`super::Device::trace_from`].
    pub from_heads: usize,
    /// Rays at ties and edges where a real GPU answered differently and rightly.
    pub differing: usize,
    /// What was wrong; at most one entry a check and case.
    pub failures: Vec<Failure>,
}

impl RowResult {
    /// Whether nothing was wrong, and something was traced.
    #[must_use]
    pub fn is_passed(&self) -> bool {
        self.failures.is_empty() && self.cases > 0
    }
}

/// What came of a run of the suite. Printed, it is a table with the first failure of each row below it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// One entry a row, in the order in which they were given.
    pub rows: Vec<RowResult>,
}

impl Report {
    pub(super) fn new(rows: &[Row]) -> Self {
        let result = |&row: &Row| RowResult {
            row,
            cases: 0,
            rays: 0,
            clear: 0,
            from_heads: 0,
            differing: 0,
            failures: Vec::new(),
        };
        Self { rows: rows.iter().map(result).collect() }
    }

    /// Adds what came of another case for the same rows.
    pub(super) fn add(&mut self, other: Self) {
        for (result, other) in self.rows.iter_mut().zip(other.rows) {
            result.cases += other.cases;
            result.rays += other.rays;
            result.clear += other.clear;
            result.from_heads += other.from_heads;
            result.differing += other.differing;
            result.failures.extend(other.failures);
        }
    }

    /// Whether every row passed. False when there is no row: nothing was shown then.
    #[must_use]
    pub fn is_passed(&self) -> bool {
        !self.rows.is_empty() && self.rows.iter().all(RowResult::is_passed)
    }

    /// Every failure, with its row.
    pub fn failures(&self) -> impl Iterator<Item = (&Row, &Failure)> {
        self.rows.iter().flat_map(|result| result.failures.iter().map(move |failure| (&result.row, failure)))
    }

    /// Whether a case of this name found something wrong.
    #[must_use]
    pub fn is_caught_by(&self, case: &str) -> bool {
        self.failures().any(|(_, failure)| failure.case == case)
    }
}

impl fmt::Display for Report {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names: Vec<[String; 2]> = self
            .rows
            .iter()
            .map(|result| [result.row.structure.to_string(), result.row.walk.to_string()])
            .collect();
        let width = |column: usize, title: &str| {
            names.iter().map(|names| names[column].len()).max().unwrap_or(0).max(title.len())
        };
        let (structure, walk) = (width(0, "structure"), width(1, "walk"));
        writeln!(
            formatter,
            "{:<6} {:<structure$} {:<walk$} {:<7} {:>5} {:>8}  verdict",
            "device", "structure", "walk", "query", "cases", "rays"
        )?;
        for (result, names) in self.rows.iter().zip(&names) {
            let verdict = match result.failures.len() {
                0 if result.cases == 0 => "nothing traced".into(),
                0 => "ok".to_owned(),
                failures => format!("FAILED ({failures})"),
            };
            writeln!(
                formatter,
                "{:<6} {:<structure$} {:<walk$} {:<7} {:>5} {:>8}  {verdict}",
                result.row.device, names[0], names[1], result.row.query, result.cases, result.rays
            )?;
            if let Some(first) = result.failures.first() {
                writeln!(formatter, "       {first}")?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ropewalk::catalogue::rows;

    #[test]
    fn a_failure_shows() {
        let rows = rows();
        let mut report = Report::new(&rows[..2]);
        assert!(!report.is_passed(), "nothing was traced");
        assert!(!Report::default().is_passed());
        report.rows.iter_mut().for_each(|row| row.cases = 3);
        assert!(report.is_passed());
        assert_eq!(report.to_string().matches("  ok").count(), 2);
        let failure =
            Failure { case: "soup", structure: Tree::built(rows[0].structure), what: "lost".into() };
        report.rows[1].failures.push(failure);
        assert!(!report.is_passed());
        assert!(report.is_caught_by("soup") && !report.is_caught_by("room"));
        let text = report.to_string();
        assert!(text.contains("FAILED (1)") && text.contains("case soup, bvh: lost"), "{text}");
    }
}
