//! The words of one AFF file, with the line of each.
//!
//! Words stand between blanks; a brace is a word of its own, also when it is glued to another. `#` and `%` begin a
//! comment, which ends with the line. Line ends mean nothing else, so lines are counted only when one is asked for, each
//! once.

use crate::LoadError;
use crate::load::source::Source;
use crate::load::text::{number, quoted};
use glam::{DVec2, DVec3};
use std::cell::Cell;

/// Reads word after word.
pub(super) struct Tokens<'a> {
    source: &'a Source,
    /// Where the last word begins, and where it ends.
    start: usize,
    end: usize,
    /// Up to where lines have been counted, and how many ended there.
    counted: Cell<(usize, usize)>,
}

impl<'a> Tokens<'a> {
    pub(super) const fn new(source: &'a Source) -> Self {
        Self { source, start: 0, end: 0, counted: Cell::new((0, 0)) }
    }

    /// The file.
    pub(super) const fn source(&self) -> &'a Source {
        self.source
    }

    /// The next word.
    pub(super) fn next_word(&mut self) -> Option<&'a [u8]> {
        let (start, end) = self.following(true)?;
        (self.start, self.end) = (start, end);
        self.source.bytes.get(start..end)
    }

    /// The next word, which stays the next.
    pub(super) fn peek(&self) -> Option<&'a [u8]> {
        let (start, end) = self.following(true)?;
        self.source.bytes.get(start..end)
    }

    /// The next word if it stands on the line of the last; it stays the next.
    pub(super) fn peek_on_line(&self) -> Option<&'a [u8]> {
        let (start, end) = self.following(false)?;
        self.source.bytes.get(start..end)
    }

    /// Where the next word begins and ends. A comment is over at the end of its line, so it ends a line too.
    fn following(&self, beyond_line: bool) -> Option<(usize, usize)> {
        let bytes = &self.source.bytes;
        let mut start = self.end;
        loop {
            match *bytes.get(start)? {
                b'\n' | b'\r' | b'#' | b'%' if !beyond_line => return None,
                b'#' | b'%' => {
                    let is_end = |&byte: &u8| byte == b'\n' || byte == b'\r';
                    start += bytes.get(start..)?.iter().position(is_end)?;
                }
                byte if byte.is_ascii_whitespace() => start += 1,
                b'{' | b'}' => return Some((start, start + 1)),
                _ => break,
            }
        }
        let ends = |byte: &u8| byte.is_ascii_whitespace() || b"{}#%".contains(byte);
        let rest = bytes.get(start..)?;
        Some((start, start + rest.iter().position(ends).unwrap_or(rest.len())))
    }

    /// The line of the last word, from 1.
    pub(super) fn line(&self) -> usize {
        let (from, ended) = self.counted.get();
        let bytes = &self.source.bytes;
        // A line ends with `\n`, `\r\n` or `\r`, as in the other text formats.
        let ends_line = |&at: &usize| match bytes.get(at) {
            Some(b'\n') => true,
            Some(b'\r') => bytes.get(at + 1) != Some(&b'\n'),
            _ => false,
        };
        let ended = ended + (from..self.start).filter(ends_line).count();
        self.counted.set((self.start.max(from), ended));
        ended + 1
    }

    /// The file and line of the last word, for the report.
    pub(super) fn place(&self) -> String {
        let name = self.source.path.file_name().unwrap_or_default().to_string_lossy();
        format!("{name}, line {}", self.line())
    }

    /// The error that something is wrong at the last word.
    pub(super) fn malformed(&self, what: impl Into<String>) -> LoadError {
        self.source.malformed(format!("line {}", self.line()), what)
    }

    /// A word that must be there.
    pub(super) fn word(&mut self, expected: &str) -> Result<&'a [u8], LoadError> {
        self.next_word().ok_or_else(|| self.malformed(format!("the file ends where {expected} must stand")))
    }

    /// A name: any word but a brace.
    pub(super) fn name(&mut self, expected: &str) -> Result<String, LoadError> {
        match self.word(expected)? {
            brace @ (b"{" | b"}") => {
                Err(self.malformed(format!("{} stands where {expected} must stand", quoted(brace))))
            }
            name => Ok(String::from_utf8_lossy(name).into_owned()),
        }
    }

    /// A word that must be this one.
    pub(super) fn expect(&mut self, expected: &str) -> Result<(), LoadError> {
        let words = format!("'{expected}'");
        let found = self.word(&words)?;
        if found == expected.as_bytes() {
            return Ok(());
        }
        Err(self.malformed(format!("{} stands where {words} must stand", quoted(found))))
    }

    /// Takes the next word if it is this one.
    pub(super) fn take(&mut self, word: &[u8]) -> bool {
        let is_next = self.peek() == Some(word);
        if is_next {
            self.next_word();
        }
        is_next
    }

    /// A finite number.
    pub(super) fn number(&mut self) -> Result<f64, LoadError> {
        let word = self.word("a number")?;
        finite(word)
            .ok_or_else(|| self.malformed(format!("{} stands where a number must stand", quoted(word))))
    }

    /// Whether the next word is a number.
    pub(super) fn number_is_next(&self) -> bool {
        self.peek().is_some_and(|word| finite(word).is_some())
    }

    pub(super) fn vector(&mut self) -> Result<DVec3, LoadError> {
        Ok(DVec3::new(self.number()?, self.number()?, self.number()?))
    }

    pub(super) fn pair(&mut self) -> Result<DVec2, LoadError> {
        Ok(DVec2::new(self.number()?, self.number()?))
    }

    /// A whole number that is not negative.
    pub(super) fn integer(&mut self) -> Result<u32, LoadError> {
        let word = self.word("a whole number")?;
        let value = std::str::from_utf8(word).ok().and_then(|word| word.parse().ok());
        value.ok_or_else(|| {
            self.malformed(format!("{} stands where a whole number from 0 must stand", quoted(word)))
        })
    }

    /// How many rows of `width` words follow. There can be no more than the rest of the file has room for, at two
    /// bytes a word: memory may be taken for that many.
    pub(super) fn count(&mut self, width: usize, what: &str) -> Result<usize, LoadError> {
        let count = self.integer()? as usize;
        let bytes = self.source.bytes.len() - self.end;
        if count.saturating_mul(width) <= bytes.div_ceil(2) {
            return Ok(count);
        }
        Err(self.malformed(format!("{count} {what} are promised, but only {bytes} bytes are left")))
    }

    /// An index below `count`.
    pub(super) fn index(&mut self, count: usize, what: &str) -> Result<u32, LoadError> {
        let index = self.integer()?;
        if (index as usize) < count {
            return Ok(index);
        }
        Err(self.malformed(format!("there is no {what} {index}: the mesh has {count}, counted from 0")))
    }
}

fn finite(word: &[u8]) -> Option<f64> {
    // Only what begins like a number: the parser of the language would take `nan` and `infinity` too.
    let first = word.first()?;
    let is_number = first.is_ascii_digit() || b"+-.".contains(first);
    number(word).filter(|value| is_number && value.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn source(text: &[u8]) -> Source {
        Source { path: "x.aff".into(), bytes: text.to_vec() }
    }

    #[test]
    fn words_braces_comments_and_lines() {
        let source = source(b"a{b }%c\xf6 }\r\n # d\n\te#f\r{ -.5\x0c6");
        let mut tokens = Tokens::new(&source);
        let mut found = Vec::new();
        while let Some(word) = tokens.next_word() {
            found.push((String::from_utf8_lossy(word).into_owned(), tokens.line()));
        }
        let expected = [("a", 1), ("{", 1), ("b", 1), ("}", 1), ("e", 3), ("{", 4), ("-.5", 4), ("6", 4)];
        assert_eq!(found, expected.map(|(word, line)| (word.to_owned(), line)));
    }

    #[test]
    fn the_rest_of_a_line_ends_with_it() {
        for (text, expected) in [("s 1", Some(b"1".as_slice())), ("s\n1", None), ("s #1\n2", None)] {
            let source = source(text.as_bytes());
            let mut tokens = Tokens::new(&source);
            tokens.next_word();
            assert_eq!(tokens.peek_on_line(), expected, "{text}");
        }
    }

    #[test]
    fn numbers_are_finite_and_counts_fit() {
        let read = |text: &str| Tokens::new(&source(text.as_bytes())).number().map_err(|e| e.to_string());
        for (text, value) in [("-.077", -0.077), ("-0.", 0.0), ("1.9E-4", 1.9e-4), ("+3", 3.0)] {
            assert_eq!(read(text), Ok(value));
        }
        for text in ["", "\n\n", "nan", "inf", "-inf", "1e309", "x", "{", "0x1"] {
            assert!(read(text).unwrap_err().contains("a number must stand"), "{text}");
        }
        let count = |text: &str| Tokens::new(&source(text.as_bytes())).count(3, "rows").is_ok();
        assert!(count("1 1 2 3") && count("0"));
        for text in ["4000000000 1", "2 1 2 3", "-1", "1.5", "99999999999999999999"] {
            assert!(!count(text), "{text}");
        }
    }
}
