//! The README tells what is: its tables are those of `ropewalk list`, and its example compiles and holds.

mod support;

use ropewalk::catalogue::rows;
use serde_json::Value;
use std::path::PathBuf;
use support::run;

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

/// The catalogue in families, as the program prints it.
fn table(list: &Value) -> String {
    let mut text =
        String::from("| structure | walk | on the CPU | on a GPU | what it is |\n|---|---|---|---|---|\n");
    let word = |value: &Value| value.as_str().expect("a word").replace('|', "\\|");
    for family in list["walks"].as_array().expect("a list") {
        let queries = |device: &str| {
            let names: Vec<String> = family[device].as_array().expect("a list").iter().map(word).collect();
            if names.is_empty() { "-".to_owned() } else { names.join(", ") }
        };
        text += &format!(
            "| `{}` | `{}` | {} | {} | {} |\n",
            word(&family["structure"]),
            word(&family["walk"]),
            queries("cpu"),
            queries("gpu"),
            word(&family["about"])
        );
    }
    text += "\n| structure | key | when it is left out | what it means |\n|---|---|---|---|\n";
    let kinds = list["structures"].as_array().expect("a list");
    let keys_of = |kind: &Value| kind["keys"].as_array().expect("a list").clone();
    for (index, kind) in kinds.iter().enumerate() {
        let name = word(&kind["structure"]);
        // What a kind before it has as well stands there.
        let known = |key: &Value| kinds[..index].iter().find(|kind| keys_of(kind).contains(key));
        for key in keys_of(kind).iter().filter(|key| known(key).is_none()) {
            let [key, values, default, about] =
                ["key", "values", "default", "about"].map(|part| word(&key[part]));
            text += &format!("| `{name}` | `{key}={values}` | {default} | {about} |\n");
        }
        if let Some(other) = keys_of(kind).iter().find_map(known) {
            text += &format!("| `{name}` | all keys of `{}` | | |\n", word(&other["structure"]));
        }
    }
    text += "\n| structure | what it is | tried by the conformance suite as |\n|---|---|---|\n";
    for kind in kinds {
        let tried = kind["tried"].as_array().expect("a list").iter();
        let tried: Vec<String> = tried.map(|spec| format!("`{}`", word(spec))).collect();
        let [name, about] = ["structure", "about"].map(|part| word(&kind[part]));
        text += &format!("| `{name}` | {about} | {} |\n", tried.join(" "));
    }
    text
}

#[test]
fn the_table_is_the_catalogue() {
    let text = std::fs::read_to_string(readme()).expect("the README is there");
    let (before, stands, behind) = split(&text).expect("the README has the marks of the table");
    let expected = table(&run("list --json").success().json());
    if std::env::var_os(UPDATE).is_some() {
        std::fs::write(readme(), format!("{before}{BEGIN}{expected}{END}{behind}"))
            .expect("the README can be written");
    } else {
        assert_eq!(stands, expected, "set {UPDATE}=1 to write the table anew");
    }
}

#[test]
fn a_row_too_few_would_be_seen() {
    let list = run("list --json").success().json();
    let all = table(&list);
    for (part, rows) in [("walks", 10), ("structures", 2)] {
        let count = list[part].as_array().unwrap().len();
        assert!(count >= rows, "{part}: {count}");
        for index in 0..count {
            let mut less = list.clone();
            less[part].as_array_mut().unwrap().remove(index);
            assert_ne!(table(&less), all, "{part} {index}");
        }
    }
    for row in rows() {
        assert!(all.contains(&format!("`{}`", row.structure)), "{row:?}");
    }
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
