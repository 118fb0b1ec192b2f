//! The README tells what is: its table is the catalogue, and its example compiles and holds.

use ropewalk::catalogue::{Row, rows};
use ropewalk::{DeviceKind, Query};
use std::path::PathBuf;

const BEGIN: &str = "<!-- catalogue -->\n";
const END: &str = "<!-- /catalogue -->";

/// With this variable set the README's table is written anew.
const UPDATE: &str = "ROPEWALK_UPDATE_README";

fn readme() -> PathBuf {
    [env!("CARGO_MANIFEST_DIR"), "..", "..", "README.md"].iter().collect()
}

/// The table between the marks, and what stands before and behind.
fn split(text: &str) -> Option<(&str, &str, &str)> {
    let (before, rest) = text.split_once(BEGIN)?;
    let (table, behind) = rest.split_once(END)?;
    Some((before, table, behind))
}

fn table(rows: &[Row]) -> String {
    let mut text =
        String::from("| structure | walk | on the CPU | on a GPU | what it is |\n|---|---|---|---|---|\n");
    let mut seen = Vec::new();
    for row in rows {
        let key = (row.structure.to_string(), row.walk);
        if seen.contains(&key) {
            continue;
        }
        let queries = |device: DeviceKind| {
            let offered = |query: &Query| {
                rows.iter().any(|other| {
                    (other.structure, other.walk, other.device) == (row.structure, row.walk, device)
                        && other.query == *query
                })
            };
            let names: Vec<&str> = Query::EVERY.into_iter().filter(offered).map(Query::name).collect();
            if names.is_empty() { "-".into() } else { names.join(", ") }
        };
        let (cpu, gpu) = (queries(DeviceKind::Cpu), queries(DeviceKind::Gpu));
        text += &format!("| `{}` | `{}` | {cpu} | {gpu} | {} |\n", key.0, key.1, row.walk.about());
        seen.push(key);
    }
    text
}

#[test]
fn the_table_is_the_catalogue() {
    let text = std::fs::read_to_string(readme()).expect("the README is there");
    let (before, stands, behind) = split(&text).expect("the README has the marks of the table");
    let expected = table(&rows());
    if std::env::var_os(UPDATE).is_some() {
        std::fs::write(readme(), format!("{before}{BEGIN}{expected}{END}{behind}"))
            .expect("the README can be written");
    } else {
        assert_eq!(stands, expected, "set {UPDATE}=1 to write the table anew");
    }
}

#[test]
fn a_row_too_few_would_be_seen() {
    let all = rows();
    assert_ne!(table(&all), table(&all[..all.len() - 1]));
    assert_ne!(table(&all), table(&all[1..]));
}

/// The README's example, as it stands there.
#[test]
fn the_example_holds() {
    let text = std::fs::read_to_string(readme()).expect("the README is there");
    let example =
        text.split("```rust\n").nth(1).and_then(|rest| rest.split("```").next()).expect("an example");
    let body = include_str!("../../ropewalk/src/lib.rs");
    for line in
        example.lines().map(str::trim).filter(|line| line.starts_with("let ") || line.starts_with("assert"))
    {
        assert!(
            body.contains(line),
            "the example in the library's documentation, which is run, lacks: {line}"
        );
    }
}
