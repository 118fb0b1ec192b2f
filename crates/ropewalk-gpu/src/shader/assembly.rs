//! The preprocessor: one WGSL text from several files.
//!
//! | directive, alone on its line | means |
//! |---|---|
//! | `#import NAME` | that file stands here, unless it has been imported already |
//! | `#ifdef NAME`, `#ifndef NAME`, `#else`, `#endif` | what follows counts where NAME is defined, or is not |
//! | `#repeat NAME COUNT`, `#endrepeat` | what is between stands COUNT times, with NAME a constant: 0, 1, 2, ... |
//! | `#{NAME}`, anywhere in a line | the text of the constant NAME |
//!
//! WGSL cannot size a private array by an `override`, so stack sizes must be text. WGSL lets a declaration be
//! used before it is written, so imports may stand in any order and even form a ring. A loop that is written out has
//! names instead of an array that is indexed, which a graphics card would keep in memory; and drivers that allow so
//! many iterations do not count it.

use std::collections::{BTreeMap, BTreeSet};
use thiserror::Error;

/// The names that conditions ask for and the texts that constants have.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Definitions {
    texts: BTreeMap<String, String>,
}

impl Definitions {
    /// Nothing is defined.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Defines a name for conditions, with an empty text.
    #[must_use]
    pub fn flag(self, name: &str, defined: bool) -> Self {
        if defined { self.text(name, "") } else { self }
    }

    /// Defines a name and its text.
    #[must_use]
    pub fn text(mut self, name: &str, text: impl ToString) -> Self {
        self.texts.insert(name.into(), text.to_string());
        self
    }

    /// These and those of another; where both define a name, the other's text counts.
    #[must_use]
    pub fn and(mut self, other: &Self) -> Self {
        self.texts.extend(other.texts.iter().map(|(name, text)| (name.clone(), text.clone())));
        self
    }

    fn get(&self, name: &str) -> Option<&str> {
        self.texts.get(name).map(String::as_str)
    }
}

/// What is wrong with a shader, and where.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("{file}:{line}: {what}")]
pub struct AssemblyError {
    /// The file's name in the library.
    pub file: String,
    /// The line, from 1 on.
    pub line: usize,
    /// What is wrong.
    pub what: String,
}

/// Puts `root` and its imports together. `find` gives the text of a file.
pub(super) fn assemble<'a>(
    find: &dyn Fn(&str) -> Option<&'a str>,
    root: &str,
    definitions: &Definitions,
) -> Result<String, AssemblyError> {
    let Some(text) = find(root) else {
        return Err(AssemblyError { file: root.into(), line: 0, what: "there is no such shader".into() });
    };
    let imported = BTreeSet::from([root.to_string()]);
    let mut assembly =
        Assembly { find, definitions, imported, turns: BTreeMap::new(), output: String::new() };
    assembly.file(root, text)?;
    Ok(assembly.output)
}

struct Assembly<'f, 'a> {
    find: &'f dyn Fn(&str) -> Option<&'a str>,
    definitions: &'f Definitions,
    imported: BTreeSet<String>,
    /// The constants of the repeats that are under way, with their present values.
    turns: BTreeMap<String, u32>,
    output: String,
}

/// A condition that is not closed yet.
struct Condition {
    line: usize,
    /// Whether the lines of the present branch count, as far as this condition is concerned.
    holds: bool,
    has_else: bool,
}

impl Assembly<'_, '_> {
    fn file(&mut self, name: &str, text: &str) -> Result<(), AssemblyError> {
        let lines: Vec<(usize, &str)> = (1..).zip(text.lines()).collect();
        self.lines(name, &lines)
    }

    fn lines(&mut self, name: &str, lines: &[(usize, &str)]) -> Result<(), AssemblyError> {
        let mut conditions: Vec<Condition> = Vec::new();
        let mut rest = lines;
        while let Some((&(line, content), behind)) = rest.split_first() {
            rest = behind;
            let fail = |what: String| AssemblyError { file: name.into(), line, what };
            let counts = conditions.iter().all(|condition| condition.holds);
            let trimmed = content.trim_start();
            if !trimmed.starts_with('#') || trimmed.starts_with("#{") {
                if counts {
                    self.output.push_str(&self.fill_in(content).map_err(fail)?);
                    self.output.push('\n');
                }
                continue;
            }
            let (directive, argument) = trimmed.split_once(char::is_whitespace).unwrap_or((trimmed, ""));
            let argument = argument.trim();
            let wants_argument = matches!(directive, "#import" | "#ifdef" | "#ifndef");
            if wants_argument && argument.is_empty() {
                return Err(fail(format!("{directive} wants a name")));
            }
            if !wants_argument
                && !argument.is_empty()
                && matches!(directive, "#else" | "#endif" | "#endrepeat")
            {
                return Err(fail(format!("{directive} wants nothing after it, but '{argument}' follows")));
            }
            match directive {
                "#import" if counts => {
                    let wanted = self.fill_in(argument).map_err(fail)?;
                    let Some(text) = (self.find)(&wanted) else {
                        return Err(fail(format!("there is no shader '{wanted}' to import")));
                    };
                    if self.imported.insert(wanted.clone()) {
                        self.file(&wanted, text)?;
                    }
                }
                "#import" => {}
                "#ifdef" | "#ifndef" => {
                    let holds = self.definitions.get(argument).is_some() == (directive == "#ifdef");
                    conditions.push(Condition { line, holds, has_else: false });
                }
                "#else" => match conditions.last_mut() {
                    Some(condition) if !condition.has_else => {
                        condition.holds = !condition.holds;
                        condition.has_else = true;
                    }
                    Some(condition) => {
                        let opened = condition.line;
                        return Err(fail(format!("a second #else for the condition of line {opened}")));
                    }
                    None => return Err(fail("#else without a condition".into())),
                },
                "#endif" => {
                    if conditions.pop().is_none() {
                        return Err(fail("#endif without a condition".into()));
                    }
                }
                "#repeat" => {
                    let end =
                        end_of_repeat(rest).ok_or_else(|| fail("this repeat has no #endrepeat".into()))?;
                    let (body, behind) = rest.split_at(end);
                    rest = behind.get(1..).unwrap_or_default();
                    if counts {
                        let (constant, count) = self.turns_of(argument).map_err(fail)?;
                        for turn in 0..count {
                            self.turns.insert(constant.into(), turn);
                            self.lines(name, body)?;
                        }
                        self.turns.remove(constant);
                    }
                }
                "#endrepeat" => return Err(fail("#endrepeat without a repeat".into())),
                _ => return Err(fail(format!("'{directive}' is no directive"))),
            }
        }
        match conditions.last() {
            Some(open) => Err(AssemblyError {
                file: name.into(),
                line: open.line,
                what: "this condition has no #endif".into(),
            }),
            None => Ok(()),
        }
    }

    /// The name and the number in `NAME COUNT`.
    fn turns_of<'l>(&self, argument: &'l str) -> Result<(&'l str, u32), String> {
        let Some((constant, count)) = argument.split_once(char::is_whitespace) else {
            return Err("#repeat wants a name and a number".into());
        };
        let count = self.fill_in(count.trim())?;
        match count.parse() {
            Ok(turns) if turns <= MOST_TURNS => Ok((constant, turns)),
            _ => Err(format!("#repeat wants a number up to {MOST_TURNS}, not '{count}'")),
        }
    }

    /// Replaces every `#{NAME}`.
    fn fill_in(&self, line: &str) -> Result<String, String> {
        let mut filled = String::with_capacity(line.len());
        let mut rest = line;
        while let Some((before, after)) = rest.split_once("#{") {
            let Some((name, after)) = after.split_once('}') else {
                return Err("'#{' has no '}'".into());
            };
            filled.push_str(before);
            match (self.turns.get(name), self.definitions.get(name)) {
                (Some(turn), _) => filled.push_str(&turn.to_string()),
                (None, Some(text)) => filled.push_str(text),
                (None, None) => return Err(format!("the constant '{name}' is not defined")),
            }
            rest = after;
        }
        filled.push_str(rest);
        Ok(filled)
    }
}

/// The most turns of a repeat: more than any node has children, and few enough for a text that a mistake makes.
const MOST_TURNS: u32 = 64;

/// Where the repeat ends of which these lines are the first.
fn end_of_repeat(lines: &[(usize, &str)]) -> Option<usize> {
    let mut open = 1;
    lines.iter().position(|(_, content)| {
        match content.trim_start().split(char::is_whitespace).next() {
            Some("#repeat") => open += 1,
            Some("#endrepeat") => open -= 1,
            _ => {}
        }
        open == 0
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(files: &[(&str, &str)], definitions: &Definitions) -> Result<String, String> {
        let find = |name: &str| files.iter().find(|(file, _)| *file == name).map(|(_, text)| *text);
        assemble(&find, "root", definitions).map_err(|error| error.to_string())
    }

    #[test]
    fn each_import_comes_once_even_in_a_ring() {
        let files = [
            ("root", "#import a\n#import b\nroot"),
            ("a", "#import b\na"),
            ("b", "#import a\n#import root\nb"),
        ];
        assert_eq!(run(&files, &Definitions::new()).unwrap(), "b\na\nroot\n");
    }

    #[test]
    fn conditions_nest_and_hide_their_imports() {
        let text =
            "#ifdef A\n#ifndef B\na without b\n#else\na and b\n#import nowhere\n#endif\n#else\nno a\n#endif";
        let files = [("root", text)];
        assert_eq!(run(&files, &Definitions::new()).unwrap(), "no a\n");
        assert_eq!(
            run(&files, &Definitions::new().flag("A", true).flag("B", false)).unwrap(),
            "a without b\n"
        );
        let both = Definitions::new().flag("A", true).text("B", 1);
        assert_eq!(run(&files, &both).unwrap_err(), "root:6: there is no shader 'nowhere' to import");
    }

    #[test]
    fn constants_are_filled_in() {
        let files = [("root", "#import #{PART}\n#{A} + #{B}#{A};"), ("part", "part")];
        let definitions = Definitions::new().text("PART", "part").text("A", 1).text("B", "two");
        assert_eq!(run(&files, &definitions).unwrap(), "part\n1 + two1;\n");
    }

    #[test]
    fn repeats_nest_and_count() {
        let text = "#repeat I N\nlet a#{I};\n#repeat J 2\n#ifdef X\n#{I}#{J} #{N}\n#endif\n#endrepeat\n#endrepeat\nend";
        let definitions = Definitions::new().text("N", 2);
        let with = |count: &str| text.replace("#repeat I N", &format!("#repeat I {count}"));
        let (written, named, none) = (with("2"), with("#{N}"), with("0"));
        for text in [&written, &named] {
            assert_eq!(run(&[("root", text)], &definitions).unwrap(), "let a0;\nlet a1;\nend\n");
            let with_x = definitions.clone().flag("X", true);
            let all = "let a0;\n00 2\n01 2\nlet a1;\n10 2\n11 2\nend\n";
            assert_eq!(run(&[("root", text)], &with_x).unwrap(), all);
        }
        assert_eq!(run(&[("root", &none)], &definitions).unwrap(), "end\n");
        // The constant is gone behind the repeat, and a repeat that does not count is not looked at.
        let cases = [
            ("#repeat I 2\n#endrepeat\n#{I}", "root:3: the constant 'I' is not defined"),
            (
                "#ifdef X\n#repeat\n#{I}\n#endrepeat\n#endif\n#endrepeat",
                "root:6: #endrepeat without a repeat",
            ),
        ];
        for (text, expected) in cases {
            assert_eq!(run(&[("root", text)], &definitions).unwrap_err(), expected);
        }
    }

    #[test]
    fn what_is_wrong_is_named_with_its_place() {
        let cases = [
            ("x\n#import gone", "root:2: there is no shader 'gone' to import"),
            ("#import part\n", "part:3: the constant 'SIZE' is not defined"),
            ("#ifdef A\n\n", "root:1: this condition has no #endif"),
            ("#endif", "root:1: #endif without a condition"),
            ("\n#else", "root:2: #else without a condition"),
            ("#ifdef A\n#else\n#else\n#endif", "root:3: a second #else for the condition of line 1"),
            ("#{A", "root:1: '#{' has no '}'"),
            ("#define A", "root:1: '#define' is no directive"),
            ("\n#repeat A 2\n#repeat B 2\n#endrepeat", "root:2: this repeat has no #endrepeat"),
            ("#endrepeat", "root:1: #endrepeat without a repeat"),
            ("#repeat A\n#endrepeat", "root:1: #repeat wants a name and a number"),
            ("#repeat A B\n#endrepeat", "root:1: #repeat wants a number up to 64, not 'B'"),
            ("#repeat A 65\n#endrepeat", "root:1: #repeat wants a number up to 64, not '65'"),
            ("#repeat A -1\n#endrepeat", "root:1: #repeat wants a number up to 64, not '-1'"),
            ("#repeat A 2\n#ifdef B\n#endrepeat", "root:2: this condition has no #endif"),
            ("#ifdef", "root:1: #ifdef wants a name"),
            ("#ifdef A\n#endif A", "root:2: #endif wants nothing after it, but 'A' follows"),
        ];
        for (text, expected) in cases {
            let files = [("root", text), ("part", "\n\narray<u32, #{SIZE}>")];
            assert_eq!(run(&files, &Definitions::new()).unwrap_err(), expected);
        }
        assert_eq!(run(&[], &Definitions::new()).unwrap_err(), "root:0: there is no such shader");
    }
}
