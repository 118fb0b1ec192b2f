//! `ropewalk list`: the catalogue, and the adapters of this machine.

use crate::failure::Failure;
use crate::output;
use crate::table::{Align, Table};
use clap::Args;
use ropewalk::catalogue::{self, Row};
use ropewalk::{BuildOptions, DeviceKind, StructureSpec, Walk};
use ropewalk_gpu::AdapterSummary;
use serde::Serialize;
use std::fmt::Write;

const EXAMPLES: &str = "\
Structures and walks are written NAME[:key=value,...] as they stand in the
list, for --structure and --walk.

Examples:
  ropewalk list
  ropewalk list --json
  ropewalk render part.stl --walk stack:order=culled --device gpu:0";

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
    rows: Vec<RowRecord>,
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
    let rows = catalogue::rows();
    let adapters = ropewalk_gpu::adapters();
    if arguments.json {
        output::print_json(&Document {
            version: env!("CARGO_PKG_VERSION"),
            rows: rows.iter().map(RowRecord::from).collect(),
            adapters: adapters.iter().map(AdapterRecord::from).collect(),
        })
    } else {
        output::print(&text(&rows, &adapters))
    }
}

fn text(rows: &[Row], adapters: &[AdapterSummary]) -> String {
    let mut table = Table::new(&[
        ("structure", Align::Left),
        ("walk", Align::Left),
        ("queries on the CPU", Align::Left),
        ("on a GPU", Align::Left),
        ("what it is", Align::Left),
    ]);
    for (structure, walk) in combinations(rows) {
        let queries = |device: DeviceKind| {
            let names: Vec<&str> = rows
                .iter()
                .filter(|row| row.structure == structure && row.walk == walk && row.device == device)
                .map(|row| row.query.name())
                .collect();
            if names.is_empty() { "-".to_owned() } else { names.join(" ") }
        };
        table.row([
            structure.to_string(),
            walk.to_string(),
            queries(DeviceKind::Cpu),
            queries(DeviceKind::Gpu),
            walk.about().into(),
        ]);
    }
    let plain = BuildOptions::default();
    let mut text = table.to_string();
    let _ = writeln!(
        text,
        "\nKeys of bvh: max-leaf={} (1 to 255), max-depth={} (1 to {}), bins={} (2 to {}), leaf-order=split (or left)",
        plain.max_leaf,
        plain.max_depth,
        ropewalk::bvh::MAX_DEPTH,
        plain.bins,
        BuildOptions::MAX_BINS
    );
    let _ = writeln!(
        text,
        "Without --structure and --walk: {} and {}",
        StructureSpec::default(),
        Walk::default()
    );
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

/// The pairs of a structure and a walk, each once, in the catalogue's order.
fn combinations(rows: &[Row]) -> Vec<(StructureSpec, Walk)> {
    let mut pairs = Vec::new();
    for row in rows {
        if !pairs.contains(&(row.structure, row.walk)) {
            pairs.push((row.structure, row.walk));
        }
    }
    pairs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_is_printed() {
        let rows = catalogue::rows();
        let text = text(&rows, &[]);
        for row in &rows {
            let line = text
                .lines()
                .filter(|line| {
                    let mut words = line.split_whitespace();
                    words.next() == Some(row.structure.to_string().as_str())
                        && words.next() == Some(row.walk.to_string().as_str())
                })
                .collect::<Vec<_>>();
            assert_eq!(line.len(), 1, "{row:?}");
            assert!(line[0].split_whitespace().any(|word| word == row.query.name()), "{row:?}");
        }
    }
}
