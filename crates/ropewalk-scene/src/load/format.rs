//! Which format a file has: told by the content where that is certain, then by the name, then by the words of a text.
//!
//! OBJ has no magic number: any text of OBJ's words is OBJ, but NFF shares some of them, so there the name goes first.

use super::source::Source;
use crate::LoadError;
use std::path::Path;

/// The formats that are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Format {
    /// Wavefront OBJ.
    Obj,
    /// Polygon file format, the Stanford one.
    Ply,
    /// Stereolithography.
    Stl,
    /// glTF 2.0, as text or binary.
    Gltf,
    /// The Animated File Format of BART, or the Neutral File Format that it extends.
    Aff,
}

impl Format {
    /// The format of a file's content.
    pub(crate) fn of(source: &Source) -> Result<Self, LoadError> {
        let unknown = |what: String| LoadError::UnknownFormat { path: source.path.clone(), what };
        if source.bytes.is_empty() {
            return Err(unknown("the file is empty".into()));
        }
        if let Some(format) = by_content(&source.bytes) {
            return Ok(format);
        }
        let ending = ending(&source.path);
        match ending.as_str() {
            "obj" => Ok(Self::Obj),
            "ply" => Ok(Self::Ply),
            "stl" => Ok(Self::Stl),
            "gltf" | "glb" => Ok(Self::Gltf),
            "aff" | "nff" => Ok(Self::Aff),
            _ if is_obj_text(&source.bytes) => Ok(Self::Obj),
            _ => Err(unknown(format!("neither the content nor the name is that of {KNOWN}, gzipped or not"))),
        }
    }
}

const KNOWN: &str = "OBJ, PLY, STL, glTF, GLB, AFF or NFF";

/// The ending of the name in lower case, without a `.gz` behind it.
fn ending(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    let name = name.strip_suffix(".gz").unwrap_or(&name);
    name.rsplit_once('.').map_or("", |(_, ending)| ending).to_owned()
}

fn by_content(bytes: &[u8]) -> Option<Format> {
    if bytes.starts_with(b"glTF") {
        return Some(Format::Gltf);
    }
    if bytes.starts_with(b"ply") && bytes.get(3).is_some_and(u8::is_ascii_whitespace) {
        return Some(Format::Ply);
    }
    // Before the texts: a binary STL may begin with any word.
    if has_the_size_of_binary_stl(bytes) {
        return Some(Format::Stl);
    }
    let text = bytes.trim_ascii_start();
    if text.starts_with(b"{") {
        return Some(Format::Gltf);
    }
    let mut words = text.split(u8::is_ascii_whitespace);
    let first = words.next().unwrap_or_default();
    first.eq_ignore_ascii_case(b"solid").then_some(Format::Stl)
}

/// Whether the size is just that of the facets which the count at byte 80 promises. In a text these four bytes
/// would promise more than 7 GB.
pub(crate) fn has_the_size_of_binary_stl(bytes: &[u8]) -> bool {
    let Some((_, rest)) = bytes.split_at_checked(80) else {
        return false;
    };
    let Some((count, facets)) = rest.split_first_chunk::<4>() else {
        return false;
    };
    let count = u64::from(u32::from_le_bytes(*count));
    count > 0 && facets.len() as u64 == count * 50
}

/// Whether a text has a vertex line of OBJ among its first lines, and nothing that is no line of OBJ before it.
fn is_obj_text(bytes: &[u8]) -> bool {
    const WORDS: [&[u8]; 12] =
        [b"#", b"mtllib", b"usemtl", b"o", b"g", b"s", b"v", b"vn", b"vt", b"vp", b"mg", b"call"];
    for line in bytes.split(|&byte| byte == b'\n' || byte == b'\r').take(1000) {
        let mut words = line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
        match words.next() {
            None => {}
            Some(b"v") => return words.filter(|word| is_number(word)).count() >= 3,
            Some(word) if word.starts_with(b"#") || WORDS.contains(&word) => {}
            Some(_) => return false,
        }
    }
    false
}

fn is_number(word: &[u8]) -> bool {
    std::str::from_utf8(word).is_ok_and(|word| word.parse::<f64>().is_ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn format(name: &str, content: impl AsRef<[u8]>) -> Result<Format, String> {
        let source = Source { path: name.into(), bytes: content.as_ref().to_vec() };
        Format::of(&source).map_err(|error| error.to_string())
    }

    fn binary_stl(header: &[u8], facets: u32) -> Vec<u8> {
        let mut bytes = header.to_vec();
        bytes.resize(80, b' ');
        bytes.extend(facets.to_le_bytes());
        bytes.resize(84 + 50 * facets as usize, 0);
        bytes
    }

    #[test]
    fn content_goes_before_the_name() {
        assert_eq!(format("x.obj", "ply\nformat ascii 1.0\n"), Ok(Format::Ply));
        assert_eq!(format("x.ply", "glTF\x02\0\0\0"), Ok(Format::Gltf));
        assert_eq!(format("x", "  {\"asset\":{}}"), Ok(Format::Gltf));
        assert_eq!(format("x.obj", "SOLID name\nfacet"), Ok(Format::Stl));
        assert_eq!(format("x", binary_stl(b"solid", 3)), Ok(Format::Stl));
        assert_eq!(format("x", binary_stl(b"v 1 2 3", 3)), Ok(Format::Stl));
        assert_eq!(format("x", "# text\nmtllib a.mtl\nv 1 2 3\n"), Ok(Format::Obj));
    }

    #[test]
    fn then_the_name() {
        assert_eq!(format("x.OBJ.gz", "nothing"), Ok(Format::Obj));
        assert_eq!(format("x.stl", "\0\0"), Ok(Format::Stl));
        assert_eq!(format("x.ply", "plywood"), Ok(Format::Ply));
        assert_eq!(format("x.nff", "v 1 2 3\n"), Ok(Format::Aff));
        assert_eq!(format("x.aff.gz", "v\n"), Ok(Format::Aff));
    }

    #[test]
    fn what_is_not_known_says_what_is() {
        for (name, content, word) in
            [("x.txt", "v 1 2\n", "OBJ, PLY"), ("x.png", "\u{89}PNG", "OBJ, PLY"), ("x.obj", "", "empty")]
        {
            let error = format(name, content).unwrap_err();
            assert!(error.contains(name) && error.contains(word), "{error}");
        }
    }
}
