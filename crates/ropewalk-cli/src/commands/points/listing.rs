//! The catalogue of points, as `ropewalk list` shows it.

use super::question::Question;
use crate::families::{Family, grouped};
use ropewalk::catalogue::StructureKind;
use ropewalk::{DeviceKind, Walk};
use serde::Serialize;
use std::fmt::Write;

/// One row of the catalogue of points.
#[derive(Clone, Copy, Debug, PartialEq)]
struct PointRow {
    structure: StructureKind,
    walk: Walk,
    question: Question,
    device: DeviceKind,
}

/// A row, for scripts: as those of rays.
#[derive(Debug, Serialize)]
pub(crate) struct PointRowRecord {
    structure: &'static str,
    walk: String,
    query: &'static str,
    device: String,
    about: &'static str,
}

fn rows() -> Vec<PointRow> {
    let mut rows = Vec::new();
    for device in [DeviceKind::Cpu, DeviceKind::Gpu] {
        for structure in StructureKind::EVERY {
            for walk in Walk::EVERY {
                for question in Question::EVERY {
                    if question.check(structure, walk, device, 1).is_ok() {
                        rows.push(PointRow { structure, walk, question, device });
                    }
                }
            }
        }
    }
    rows
}

/// Every row of the catalogue of points, for the JSON document.
pub(crate) fn records() -> Vec<PointRowRecord> {
    let record = |row: PointRow| PointRowRecord {
        structure: row.structure.name(),
        walk: row.walk.to_string(),
        query: row.question.name(),
        device: row.device.to_string(),
        about: row.walk.about(),
    };
    rows().into_iter().map(record).collect()
}

/// The catalogue of points with its heading, walks of one name in one line.
pub(crate) fn text() -> String {
    let mut text = String::from("Points, for `ropewalk points`:\n");
    for family in families() {
        let _ = writeln!(text, "{}", block(&family));
    }
    text
}

fn families() -> Vec<Family> {
    let of_kind = |kind: StructureKind| {
        grouped(kind, |walk, device| {
            let answers = |question: &Question| question.check(kind, walk, device, 1).is_ok();
            Question::EVERY.into_iter().filter(answers).map(Question::name).collect()
        })
    };
    StructureKind::EVERY.into_iter().flat_map(of_kind).collect()
}

fn block(family: &Family) -> String {
    let queries = |names: &[&str]| if names.is_empty() { "-".to_owned() } else { names.join(" ") };
    let (cpu, gpu) = (queries(&family.cpu), queries(&family.gpu));
    format!("  {} {}\n    CPU {cpu:<46}  GPU {gpu}", family.structure, family.walk)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ropewalk::point::catalogue;

    #[test]
    fn the_rows_are_those_of_the_catalogue_and_the_sides() {
        let (searches, sides): (Vec<_>, Vec<_>) =
            rows().into_iter().partition(|row| matches!(row.question, Question::Search(_)));
        let expected: Vec<_> = catalogue::rows()
            .into_iter()
            .map(|row| PointRow {
                structure: row.structure,
                walk: row.walk,
                question: Question::Search(row.search),
                device: row.device,
            })
            .collect();
        assert_eq!(searches, expected);
        assert_eq!(sides.len(), 2);
        assert_eq!(records().len(), searches.len() + sides.len());
    }

    #[test]
    fn every_row_is_printed_and_nothing_else() {
        let text = text();
        for row in rows() {
            let of: Vec<Family> = families()
                .into_iter()
                .filter(|family| family.structure == row.structure.name() && family.walks.contains(&row.walk))
                .collect();
            let [family] = &of[..] else { panic!("{row:?} is in {} families", of.len()) };
            let names = if row.device == DeviceKind::Cpu { &family.cpu } else { &family.gpu };
            assert!(names.contains(&row.question.name()), "{row:?}");
            assert!(text.contains(&block(family)), "{row:?} is not in {text}");
        }
        assert_eq!(text.lines().count(), 1 + 2 * families().len());
    }
}
