//! `ropewalk list`: the catalogue, and the adapters of this machine.

use super::points::listing;
use crate::failure::Failure;
use crate::families::{Family, KeyRecord, KindRecord, families, kinds};
use crate::output;
use clap::Args;
use ropewalk::StructureSpec;
use ropewalk::catalogue::{self, Row};
use ropewalk_gpu::AdapterSummary;
use serde::Serialize;
use std::fmt::Write;

const EXAMPLES: &str = "\
Structures and walks are written NAME[:key=value,...], for --structure and
--walk. In the list, values of a key stand with | or .. between them, and what
may be left out in brackets; behind a key of a structure stands what it means.
--json lists every single row that the conformance suite tries.

Examples:
  ropewalk list
  ropewalk list --json
  ropewalk render part.stl --walk restart-trail:short-stack=2 --device gpu:0
  ropewalk info part.stl --structure wide-bvh:width=4,builder=sbvh
  ropewalk info part.stl --structure list:preset=best
  ropewalk info part.stl --structure list:directions=6,cull=exact,heads=simple";

/// The arguments of `ropewalk list`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// Print one JSON document
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Serialize)]
struct Document {
    version: &'static str,
    /// Every kind of structure, with its keys.
    structures: Vec<KindRecord>,
    /// The walks of each kind, in families.
    walks: Vec<Family>,
    /// Every row that the conformance suite tries.
    rows: Vec<RowRecord>,
    /// The same for `ropewalk points`.
    point_rows: Vec<listing::PointRowRecord>,
    adapters: Vec<AdapterRecord>,
}

#[derive(Debug, Serialize)]
struct RowRecord {
    structure: String,
    walk: String,
    query: String,
    device: String,
    about: &'static str,
}

/// An adapter, for scripts.
#[derive(Debug, Serialize)]
pub(crate) struct AdapterRecord {
    /// How it is written after `--device`.
    device: String,
    name: String,
    backend: String,
    driver: String,
    software: bool,
}

impl From<&AdapterSummary> for AdapterRecord {
    fn from(adapter: &AdapterSummary) -> Self {
        Self {
            device: format!("gpu:{}", adapter.index),
            name: adapter.name.clone(),
            backend: adapter.backend.to_string(),
            driver: adapter.driver.clone(),
            software: adapter.is_software,
        }
    }
}

impl From<&Row> for RowRecord {
    fn from(row: &Row) -> Self {
        Self {
            structure: row.structure.to_string(),
            walk: row.walk.to_string(),
            query: row.query.to_string(),
            device: row.device.to_string(),
            about: row.walk.about(),
        }
    }
}

/// Runs the command.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let adapters = ropewalk_gpu::adapters();
    if arguments.json {
        output::print_json(&Document {
            version: env!("CARGO_PKG_VERSION"),
            structures: kinds(),
            walks: families(),
            rows: catalogue::rows().iter().map(RowRecord::from).collect(),
            point_rows: listing::records(),
            adapters: adapters.iter().map(AdapterRecord::from).collect(),
        })
    } else {
        output::print(&text(&adapters))
    }
}

fn text(adapters: &[AdapterSummary]) -> String {
    let (kinds, families) = (kinds(), families());
    let mut text = String::new();
    for (index, kind) in kinds.iter().enumerate() {
        if index > 0 {
            text.push('\n');
        }
        structure(&mut text, kind, &kinds[..index]);
        text.push_str(&walks(&families, kind.structure));
    }
    let structure = StructureSpec::default();
    let walk = structure.kind().default_walk();
    let _ = writeln!(text, "\nWithout --structure and --walk: {structure} and {walk}");
    let _ = write!(text, "\n{}", listing::text());
    if adapters.is_empty() {
        text.push_str("\nNo graphics adapter was found; every query runs on the CPU.\n");
    } else {
        text.push_str("\nAdapters, for --device:\n");
        for adapter in adapters {
            let _ = writeln!(text, "  {adapter}");
        }
    }
    text
}

/// A kind of structure with its keys, and what the conformance suite tries. Keys that kinds before it have as well are not
/// explained again.
fn structure(text: &mut String, kind: &KindRecord, before: &[KindRecord]) {
    let _ = writeln!(text, "{}: {}", kind.structure, kind.about);
    let known = |key: &KeyRecord| before.iter().find(|kind| kind.keys.contains(key));
    let of_others: Vec<&str> = kind.keys.iter().filter_map(known).map(|kind| kind.structure).collect();
    let _ = writeln!(text, "  keys [default]:");
    for key in kind.keys.iter().filter(|key| known(key).is_none()) {
        let written = format!("{}={} [{}]", key.key, key.values, key.default);
        let _ = writeln!(text, "    {written:<49} {}", key.about);
    }
    if let Some(other) = of_others.first() {
        let _ = writeln!(text, "    and all keys of {other}");
    }
    wrapped(text, "  as it is tried:", kind.tried.iter().cloned());
}

/// Words after a heading, as many a line as there is room for.
fn wrapped(text: &mut String, heading: &str, words: impl Iterator<Item = String>) {
    const WIDTH: usize = 110;
    let mut line = heading.to_owned();
    for word in words {
        if line.len() + 1 + word.len() > WIDTH {
            let _ = writeln!(text, "{line}");
            line = " ".repeat(heading.len());
        }
        let _ = write!(line, " {word}");
    }
    let _ = writeln!(text, "{line}");
}

/// What a line holds behind an indent of four.
const ROOM: usize = 116;

/// A walk a block, because the keys of some fill a line.
fn walks(families: &[Family], structure: &str) -> String {
    let mut text = String::new();
    let queries = |names: &[&str]| if names.is_empty() { "-".to_owned() } else { names.join(" ") };
    for family in families.iter().filter(|family| family.structure == structure) {
        let (cpu, gpu) = (queries(&family.cpu), queries(&family.gpu));
        let queries = format!("CPU {cpu:<21} GPU {gpu}");
        // In one line where there is room, so that the list stays short.
        let line = format!("{queries:<51} {}", family.about);
        let words = if line.len() <= ROOM { line } else { format!("{queries}\n    {}", family.about) };
        let _ = writeln!(text, "  {}\n    {words}", family.walk);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_structure_and_every_family_is_printed() {
        let text = format!("\n{}", text(&[]));
        for spec in StructureSpec::every() {
            let words = text.split_whitespace().filter(|word| *word == spec.to_string());
            assert!(words.count() >= 1, "{spec}");
        }
        for family in families() {
            let queries = |names: &[&str]| if names.is_empty() { "-".to_owned() } else { names.join(" ") };
            let (cpu, gpu) = (queries(&family.cpu), queries(&family.gpu));
            let beside = format!("\n  {}\n    CPU {cpu:<21} GPU {gpu:<21} {}\n", family.walk, family.about);
            let below = format!("\n  {}\n    CPU {cpu:<21} GPU {gpu}\n    {}\n", family.walk, family.about);
            let blocks = [beside, below];
            let section = text.split(&format!("\n{}: ", family.structure)).nth(1).unwrap();
            let section = format!("{}\n", section.split("\n\n").next().unwrap());
            let count = blocks.iter().filter(|block| section.contains(*block)).count();
            assert_eq!(count, 1, "{} is not in {section}", blocks[0]);
        }
        for kind in kinds() {
            for key in kind.keys {
                assert!(text.contains(&format!(" {}={} [{}]", key.key, key.values, key.default)), "{key:?}");
            }
        }
    }

    #[test]
    fn the_text_is_short_enough_to_be_read() {
        let text = text(&[]);
        // Three screens.
        assert!(text.lines().count() < 140, "{} lines", text.lines().count());
        for line in text.lines() {
            assert!(line.chars().count() <= 120, "{line}");
        }
    }

    #[test]
    fn long_lines_are_broken_between_words() {
        let mut text = String::new();
        wrapped(&mut text, "heading:", (0..30).map(|number| format!("number-{number}")));
        assert!(text.lines().count() > 1 && text.lines().all(|line| line.len() <= 110), "{text}");
        assert_eq!(text.split_whitespace().count(), 31);
    }
}
