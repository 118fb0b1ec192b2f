//! Text as bytes: encodings, lines, words, numbers. Shared by the text formats.
//!
//! Texts are read as bytes, since a scene's names may be in any encoding while its numbers never leave ASCII. A line
//! ends with `\n`, `\r\n` or `\r`.

/// Makes UTF-8 without a byte order mark of a text that begins with a byte order mark, UTF-8 or UTF-16.
pub(crate) fn without_byte_order_mark(mut bytes: Vec<u8>) -> Vec<u8> {
    let read: fn([u8; 2]) -> u16 = match bytes.as_slice() {
        [0xef, 0xbb, 0xbf, ..] => {
            bytes.drain(..3);
            return bytes;
        }
        [0xff, 0xfe, ..] => u16::from_le_bytes,
        [0xfe, 0xff, ..] => u16::from_be_bytes,
        _ => return bytes,
    };
    let (pairs, _) = bytes[2..].as_chunks::<2>();
    let units = pairs.iter().map(|&pair| read(pair));
    let text: String =
        char::decode_utf16(units).map(|unit| unit.unwrap_or(char::REPLACEMENT_CHARACTER)).collect();
    text.into_bytes()
}

/// Lines, with backslashes at their ends read as "goes on in the next line".
pub(crate) struct Lines<'a> {
    rest: &'a [u8],
    next_number: usize,
    joined: Vec<u8>,
}

impl<'a> Lines<'a> {
    pub(crate) const fn new(text: &'a [u8]) -> Self {
        Self { rest: text, next_number: 1, joined: Vec::new() }
    }

    /// The next line as it stands, without its end.
    fn physical(&mut self) -> Option<&'a [u8]> {
        if self.rest.is_empty() {
            return None;
        }
        let length =
            self.rest.iter().position(|&byte| byte == b'\n' || byte == b'\r').unwrap_or(self.rest.len());
        let (line, end) = self.rest.split_at(length);
        let end_length = if end.starts_with(b"\r\n") { 2 } else { end.len().min(1) };
        self.rest = &end[end_length..];
        self.next_number += 1;
        Some(line)
    }

    /// The next line with those that it goes on in, and the number of the first. A comment does not go on.
    pub(crate) fn next_joined(&mut self) -> Option<(usize, &[u8])> {
        let number = self.next_number;
        let line = self.physical()?;
        let is_comment = line.trim_ascii_start().starts_with(b"#");
        let Some(mut part) = line.strip_suffix(b"\\").filter(|_| !is_comment) else {
            return Some((number, line));
        };
        self.joined.clear();
        loop {
            self.joined.extend(part);
            self.joined.push(b' ');
            let Some(next) = self.physical() else { break };
            match next.strip_suffix(b"\\") {
                Some(more) => part = more,
                None => {
                    self.joined.extend(next);
                    break;
                }
            }
        }
        Some((number, &self.joined))
    }
}

/// The words of a line.
pub(crate) fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty())
}

/// A word as a number. `nan` and `inf` are numbers here; `1.#IND` and `3.1+e2` are not.
pub(crate) fn number(word: &[u8]) -> Option<f64> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// Bytes for a message: as text, and short.
pub(crate) fn quoted(bytes: &[u8]) -> String {
    const LONGEST: usize = 40;
    let text = String::from_utf8_lossy(bytes.get(..LONGEST).unwrap_or(bytes));
    let dots = if bytes.len() > LONGEST { "..." } else { "" };
    format!("'{}{dots}'", text.escape_debug())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(text: &str) -> Vec<(usize, String)> {
        let mut lines = Lines::new(text.as_bytes());
        let mut found = Vec::new();
        while let Some((number, line)) = lines.next_joined() {
            found.push((number, String::from_utf8_lossy(line).into_owned()));
        }
        found
    }

    #[test]
    fn lines_end_in_three_ways() {
        let expected = ["a", "b", "", "c", "d"].map(String::from);
        let found = all("a\nb\r\n\nc\rd");
        assert_eq!(found.iter().map(|(_, line)| line.clone()).collect::<Vec<_>>(), expected);
        assert_eq!(found.iter().map(|(number, _)| *number).collect::<Vec<_>>(), [1, 2, 3, 4, 5]);
    }

    #[test]
    fn lines_go_on_after_a_backslash() {
        let found = all("f 1 \\\r\n2\\\n3\n# c:\\\nv\nend\\");
        let expected = [(1, "f 1  2 3"), (4, "# c:\\"), (5, "v"), (6, "end ")]
            .map(|(number, line)| (number, line.into()));
        assert_eq!(found, expected);
    }

    #[test]
    fn numbers_as_exporters_write_them() {
        for (word, value) in
            [(".5", 0.5), ("-.5", -0.5), ("2.", 2.0), ("+1e2", 100.0), ("1e-005", 1e-5), ("2.E1", 20.0)]
        {
            assert_eq!(number(word.as_bytes()), Some(value));
        }
        for word in ["3.1+e2", "1,5", "", "-", "1.#IND", "0x1", "1e"] {
            assert_eq!(number(word.as_bytes()), None, "{word}");
        }
        assert!(number(b"nan").is_some_and(f64::is_nan));
    }

    #[test]
    fn byte_order_marks_are_read() {
        let big = [0xfe, 0xff, 0, b'v', 0xd8, 0x00, 0, b'\n'];
        assert_eq!(without_byte_order_mark(big.to_vec()), "v\u{fffd}\n".as_bytes());
        let little = [0xff, 0xfe, b'v', 0, 0x3d, 0xd8, 0x00, 0xde, 7];
        assert_eq!(without_byte_order_mark(little.to_vec()), "v\u{1f600}".as_bytes());
        assert_eq!(without_byte_order_mark(b"\xef\xbb\xbfv".to_vec()), b"v");
        assert_eq!(without_byte_order_mark(b"\xefv".to_vec()), b"\xefv");
    }

    #[test]
    fn messages_stay_short() {
        assert_eq!(quoted(b"a\xff\n"), "'a\u{fffd}\\n'");
        assert!(quoted(&[b'x'; 1000]).len() < 60);
    }
}
