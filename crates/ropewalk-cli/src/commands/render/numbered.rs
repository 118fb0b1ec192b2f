//! The names of numbered files.
//!
//! The number stands where the name has a place for it: `%04d` (or `%d`) or a run of `#`, each for a digit; else before the
//! ending, with four digits: `out.png` becomes `out.0001.png`. Numbers with more digits than there is room for are written in
//! full, so no two frames share a file.

use crate::failure::Failure;
use std::path::{Path, PathBuf};

/// A name with a place for a number.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Numbered {
    folder: PathBuf,
    before: String,
    digits: usize,
    behind: String,
}

impl Numbered {
    /// The most digits that a name may ask for.
    const MOST_DIGITS: usize = 20;

    /// Finds the place of the number in a file's name.
    pub(super) fn new(path: &Path) -> Result<Self, Failure> {
        let wrong = |what: &str| Failure::usage(format!("{}: {what}", path.display()));
        let name = path.file_name().and_then(|name| name.to_str());
        let name = name.ok_or_else(|| wrong("numbered files need a name that is text"))?;
        let folder = path.parent().map(Path::to_path_buf).unwrap_or_default();
        let (before, digits, behind) = match (percent(name), hashes(name)) {
            (Some(_), Some(_)) => {
                return Err(wrong("the name has two places for a number; leave one, %04d or ####"));
            }
            (Some(place), None) | (None, Some(place)) => place,
            (None, None) => match name.rfind('.').filter(|&dot| dot > 0) {
                Some(dot) => (format!("{}.", &name[..dot]), 4, name[dot..].to_owned()),
                None => (format!("{name}."), 4, String::new()),
            },
        };
        if percent(&behind).is_some() || hashes(&behind).is_some() {
            return Err(wrong("the name has two places for a number; leave one, %04d or ####"));
        }
        if digits > Self::MOST_DIGITS {
            return Err(wrong("the number may have 20 digits at most"));
        }
        Ok(Self { folder, before, digits, behind })
    }

    /// The file of a frame.
    pub(super) fn file(&self, frame: u32) -> PathBuf {
        let Self { folder, before, digits, behind } = self;
        folder.join(format!("{before}{frame:0digits$}{behind}"))
    }
}

/// What stands around the first `%d` or `%04d`, and how many digits that asks for.
fn percent(name: &str) -> Option<(String, usize, String)> {
    let mut from = 0;
    while let Some(found) = name[from..].find('%') {
        let start = from + found;
        let rest = &name[start + 1..];
        let count = rest.bytes().take_while(u8::is_ascii_digit).count();
        if let Some(behind) = rest[count..].strip_prefix('d') {
            let digits = if count == 0 { Some(1) } else { rest[..count].parse().ok() };
            return Some((name[..start].into(), digits.unwrap_or(usize::MAX), behind.into()));
        }
        from = start + 1;
    }
    None
}

/// What stands around the first run of `#`, and how long that is.
fn hashes(name: &str) -> Option<(String, usize, String)> {
    let start = name.find('#')?;
    let count = name[start..].bytes().take_while(|&byte| byte == b'#').count();
    Some((name[..start].into(), count, name[start + count..].into()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_stand_where_the_name_has_a_place() {
        for (name, file) in [
            ("a/out.png", "a/out.0012.png"),
            ("out.final.exr", "out.final.0012.exr"),
            (".png", ".png.0012"),
            ("f%03d.png", "f012.png"),
            ("%d.png", "12.png"),
            ("100%-%2d.png", "100%-12.png"),
            ("f_######.png", "f_000012.png"),
            ("f#.png", "f12.png"),
            ("50%.png", "50%.0012.png"),
        ] {
            assert_eq!(Numbered::new(Path::new(name)).unwrap().file(12), Path::new(file), "{name}");
        }
        assert_eq!(Numbered::new(Path::new("o.png")).unwrap().file(123_456), Path::new("o.123456.png"));
    }

    #[test]
    fn names_without_one_place_are_refused() {
        for name in
            ["%d-%d.png", "#-#.png", "%d#.png", "%99999999999999999999999d.png", "%21d.png", "..", "/"]
        {
            let failure = Numbered::new(Path::new(name)).unwrap_err();
            assert_eq!(failure.message().lines().count(), 1, "{name}");
        }
    }
}
