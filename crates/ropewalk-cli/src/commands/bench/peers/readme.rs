//! A file of which a part, between two marks, is written by the program.

use crate::failure::Failure;
use crate::output::OutputFile;
use std::io::Write as _;
use std::path::Path;

const BEGIN: &str = "<!-- peers -->\n";
const END: &str = "<!-- /peers -->";

/// A file with both marks.
#[derive(Debug)]
pub(super) struct Readme {
    file: OutputFile,
    before: String,
    behind: String,
}

impl Readme {
    /// Reads the file, before anything is measured for it.
    pub(super) fn new(name: &Path) -> Result<Self, Failure> {
        let file = OutputFile::new(name)?;
        let failure = |what: &dyn std::fmt::Display| Failure::failed(format!("{}: {what}", name.display()));
        let text = std::fs::read_to_string(name).map_err(|error| failure(&error))?;
        let (before, rest) =
            text.split_once(BEGIN).ok_or_else(|| failure(&"it has no line <!-- peers -->"))?;
        let (_, behind) = rest
            .split_once(END)
            .ok_or_else(|| failure(&"it has no line <!-- /peers --> behind <!-- peers -->"))?;
        Ok(Self { file, before: before.into(), behind: behind.into() })
    }

    /// Replaces what stands between the marks.
    pub(super) fn write(&self, heading: &str, tables: &str) -> Result<(), Failure> {
        let Self { before, behind, .. } = self;
        self.file.write(|out| write!(out, "{before}{BEGIN}{heading}{tables}{END}{behind}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_stands_between_the_marks_is_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("README.md");
        std::fs::write(&path, "a\n<!-- peers -->\nold\n<!-- /peers -->\nb\n").unwrap();
        Readme::new(&path).unwrap().write("how\n\n", "new\n").unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        assert_eq!(text, "a\n<!-- peers -->\nhow\n\nnew\n<!-- /peers -->\nb\n");
    }

    #[test]
    fn a_file_without_marks_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("README.md");
        for (text, missing) in [("a\n", "<!-- peers -->"), ("<!-- peers -->\nb\n", "<!-- /peers -->")] {
            std::fs::write(&path, text).unwrap();
            assert!(Readme::new(&path).unwrap_err().message().contains(missing));
        }
        assert!(Readme::new(&folder.path().join("nowhere.md")).is_err());
    }
}
