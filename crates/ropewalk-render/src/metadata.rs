//! What a picture file says about itself: pairs of a keyword and a text, in the order in which they were added.
//!
//! Nothing is added by itself, above all no time: equal pictures with equal metadata are equal files, to the byte.

/// What a picture file says about itself. PNG files carry it as international text chunks, EXR files as the attribute
/// `comments`, a line a pair.
///
/// ```
/// let metadata = ropewalk_render::Metadata::default().with("Software", "ropewalk").with("Scene", "builtin:cubes");
/// assert_eq!(metadata.pairs().len(), 2);
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Metadata(Vec<(String, String)>);

impl Metadata {
    /// The longest keyword that PNG allows.
    const LONGEST_KEYWORD: usize = 79;

    /// The same with one more pair. A keyword keeps what PNG allows in it, letters of ASCII and single blanks between them; one of
    /// which nothing is left adds nothing. Control characters of a text become blanks.
    #[must_use]
    pub fn with(mut self, keyword: &str, text: &str) -> Self {
        let words: Vec<String> = keyword
            .split_whitespace()
            .map(|word| word.chars().filter(char::is_ascii_graphic).collect())
            .filter(|word: &String| !word.is_empty())
            .collect();
        let keyword: String = words.join(" ").chars().take(Self::LONGEST_KEYWORD).collect();
        let keyword = keyword.trim_end();
        if !keyword.is_empty() {
            let text = text.chars().map(|character| if character.is_control() { ' ' } else { character });
            self.0.push((keyword.into(), text.collect()));
        }
        self
    }

    /// The pairs.
    #[must_use]
    pub fn pairs(&self) -> &[(String, String)] {
        &self.0
    }

    /// All pairs as text, a line a pair.
    pub(crate) fn lines(&self) -> String {
        let lines: Vec<String> = self.0.iter().map(|(keyword, text)| format!("{keyword}: {text}")).collect();
        lines.join("\n")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_no_file_takes_is_left_out() {
        let long = "x".repeat(200);
        let metadata = Metadata::default()
            .with("  a\tb\u{e4} ", "1\n2")
            .with("\u{1}", "3")
            .with("", "4")
            .with(&long, "5");
        assert_eq!(metadata.pairs()[0], ("a b".to_owned(), "1 2".to_owned()));
        assert_eq!((metadata.pairs().len(), metadata.pairs()[1].0.len()), (2, 79));
        assert_eq!(metadata.lines().lines().next(), Some("a b: 1 2"));
    }
}
