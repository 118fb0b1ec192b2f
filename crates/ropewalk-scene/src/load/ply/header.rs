//! The header of a PLY file: which elements the body holds, and how they are written.

use crate::LoadError;
use crate::load::source::Source;
use crate::load::text::{quoted, words};

/// How the numbers of the body are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Text,
    LittleEndian,
    BigEndian,
}

impl Encoding {
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Text => "ascii",
            Self::LittleEndian => "binary little endian",
            Self::BigEndian => "binary big endian",
        }
    }
}

/// The type of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scalar {
    Int8,
    Uint8,
    Int16,
    Uint16,
    Int32,
    Uint32,
    Float32,
    Float64,
}

impl Scalar {
    fn of_name(name: &[u8]) -> Option<Self> {
        Some(match name {
            b"char" | b"int8" => Self::Int8,
            b"uchar" | b"uint8" => Self::Uint8,
            b"short" | b"int16" => Self::Int16,
            b"ushort" | b"uint16" => Self::Uint16,
            b"int" | b"int32" => Self::Int32,
            b"uint" | b"uint32" => Self::Uint32,
            b"float" | b"float32" => Self::Float32,
            b"double" | b"float64" => Self::Float64,
            _ => return None,
        })
    }

    /// Bytes in a binary body.
    pub(super) const fn size(self) -> usize {
        match self {
            Self::Int8 | Self::Uint8 => 1,
            Self::Int16 | Self::Uint16 => 2,
            Self::Int32 | Self::Uint32 | Self::Float32 => 4,
            Self::Float64 => 8,
        }
    }

    const fn is_integer(self) -> bool {
        !matches!(self, Self::Float32 | Self::Float64)
    }
}

/// One number, or a list with its length before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    One(Scalar),
    List { length: Scalar, item: Scalar },
}

#[derive(Clone, Debug)]
pub(super) struct Property {
    pub(super) name: String,
    pub(super) kind: Kind,
}

#[derive(Clone, Debug)]
pub(super) struct Element {
    pub(super) name: String,
    /// How many the file promises.
    pub(super) count: u64,
    pub(super) properties: Vec<Property>,
}

#[derive(Clone, Debug)]
pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
    /// Bytes up to the body.
    pub(super) length: usize,
    /// Lines up to the body.
    pub(super) lines: usize,
}

/// Reads the header.
pub(super) fn parse(source: &Source) -> Result<Header, LoadError> {
    let bytes = source.bytes.as_slice();
    if !bytes.starts_with(b"ply") {
        return Err(source.malformed("line 1", "a PLY file begins with 'ply'"));
    }
    // The first line shows how lines end: after a lone `\r`, a `\n` belongs to the body.
    let end = match bytes.iter().position(|&byte| byte == b'\n' || byte == b'\r') {
        Some(at) if bytes.get(at) == Some(&b'\r') && bytes.get(at + 1) != Some(&b'\n') => b'\r',
        _ => b'\n',
    };
    let mut encoding = None;
    let mut elements: Vec<Element> = Vec::new();
    let mut length = 0;
    for (index, line) in bytes.split_inclusive(|&byte| byte == end).enumerate() {
        length += line.len();
        let number = index + 1;
        let wrong = |what: String| source.malformed(format!("line {number}"), what);
        let line = line.trim_ascii();
        let words: Vec<&[u8]> = words(line).take(6).collect();
        match words.as_slice() {
            [] | [b"comment" | b"obj_info" | b"ply", ..] => {}
            [b"format", name, ..] => {
                let known = "ascii, binary_little_endian and binary_big_endian";
                let unknown = || wrong(format!("there is no format {}; there are {known}", quoted(name)));
                encoding = Some(read_encoding(name).ok_or_else(unknown)?);
            }
            [b"element", name, count, ..] => elements.push(Element {
                name: String::from_utf8_lossy(name).into_owned(),
                count: read_count(count)
                    .ok_or_else(|| wrong(format!("{} is no count of elements", quoted(count))))?,
                properties: Vec::new(),
            }),
            [b"property", rest @ ..] => {
                let property = read_property(rest)
                    .ok_or_else(|| wrong(format!("{} is no property of PLY", quoted(line))))?;
                let element =
                    elements.last_mut().ok_or_else(|| wrong("a property before any element".into()))?;
                element.properties.push(property);
            }
            [b"end_header", ..] => {
                let encoding = encoding.ok_or_else(|| wrong("the header names no format".into()))?;
                return Ok(Header { encoding, elements, length, lines: number });
            }
            _ => return Err(wrong(format!("{} is no line of a PLY header", quoted(line)))),
        }
    }
    Err(source.malformed(format!("byte {}", bytes.len()), "the file ends before 'end_header'"))
}

fn read_encoding(name: &[u8]) -> Option<Encoding> {
    match name {
        b"ascii" => Some(Encoding::Text),
        b"binary_little_endian" => Some(Encoding::LittleEndian),
        b"binary_big_endian" => Some(Encoding::BigEndian),
        _ => None,
    }
}

fn read_count(word: &[u8]) -> Option<u64> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

fn read_property(words: &[&[u8]]) -> Option<Property> {
    let (kind, name) = match words {
        [b"list", length, item, name, ..] => {
            let length = Scalar::of_name(length).filter(|length| length.is_integer())?;
            (Kind::List { length, item: Scalar::of_name(item)? }, name)
        }
        [scalar, name, ..] => (Kind::One(Scalar::of_name(scalar)?), name),
        _ => return None,
    };
    Some(Property { name: String::from_utf8_lossy(name).into_owned(), kind })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn header(text: &str) -> Result<Header, String> {
        parse(&Source { path: "x.ply".into(), bytes: text.into() }).map_err(|error| error.to_string())
    }

    #[test]
    fn lines_end_in_three_ways() {
        for end in ["\n", "\r\n", "\r"] {
            let text = [
                "ply",
                "format ascii 1.0",
                "comment \u{e9}",
                "element vertex 2",
                "property float x",
                "end_header",
            ]
            .join(end)
                + end;
            let header = header(&format!("{text}\nbody")).unwrap();
            assert_eq!((header.length, header.lines), (text.len(), 6), "{end:?}");
            assert_eq!(header.elements[0].properties[0].kind, Kind::One(Scalar::Float32));
        }
    }

    #[test]
    fn errors_name_the_line() {
        for (text, words) in [
            ("ply\n", "byte 4: the file ends before"),
            ("ply\nend_header\n", "line 2: the header names no format"),
            ("ply\nformat binary 1.0\n", "line 2: there is no format 'binary'"),
            ("ply\nformat ascii 1.0\nelement vertex -1\n", "line 3: '-1' is no count"),
            ("ply\nproperty float x\n", "line 2: a property before"),
            ("ply\nelement a 1\nproperty list float int x\n", "line 3: 'property list float int x'"),
            ("ply\nelement a 1\nproperty real x\n", "is no property"),
            ("ply\nbanana\n", "line 2: 'banana' is no line"),
        ] {
            let error = header(text).unwrap_err();
            assert!(error.contains(words), "{error}");
        }
    }
}
