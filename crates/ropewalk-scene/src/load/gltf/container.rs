//! The two wrappings of glTF: a JSON text, or a GLB, which holds the text and a block of bytes in one file.

use crate::LoadError;
use crate::load::source::Source;

/// The parts of a file.
#[derive(Debug)]
pub(super) struct Container<'a> {
    /// `glTF` or `GLB`.
    pub(super) format: &'static str,
    /// The document.
    pub(super) json: &'a [u8],
    /// The bytes that come with it, only in a GLB.
    pub(super) binary: Option<&'a [u8]>,
}

const HEADER: usize = 12;
const JSON: u32 = u32::from_le_bytes(*b"JSON");
const BINARY: u32 = u32::from_le_bytes(*b"BIN\0");

impl<'a> Container<'a> {
    pub(super) fn open(source: &'a Source) -> Result<Self, LoadError> {
        let bytes = source.bytes.as_slice();
        if bytes.starts_with(b"glTF") {
            return Self::open_binary(source);
        }
        let json = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        Ok(Self { format: "glTF", json, binary: None })
    }

    fn open_binary(source: &'a Source) -> Result<Self, LoadError> {
        let bytes = source.bytes.as_slice();
        let (Some(version), Some(length)) = (word(bytes, 4), word(bytes, 8)) else {
            return Err(source.malformed("byte 0", "the file ends within the GLB header"));
        };
        if version != 2 {
            return Err(
                source.malformed("byte 4", format!("this is GLB version {version}; version 2 is read"))
            );
        }
        let Some(content) = bytes.get(HEADER..length as usize) else {
            let what = format!("the GLB header says {length} bytes, the file holds {}", bytes.len());
            return Err(source.malformed("byte 8", what));
        };
        let mut chunks = Chunks { content, at: 0 };
        let Some((JSON, json)) = chunks.next(source)? else {
            let place = format!("byte {HEADER}");
            return Err(source.malformed(place, "the first chunk of a GLB must be JSON"));
        };
        // Chunks of unknown kinds are to be passed over.
        let mut binary = None;
        while let (None, Some((kind, chunk))) = (binary, chunks.next(source)?) {
            binary = (kind == BINARY).then_some(chunk);
        }
        // The text should be padded with blanks; some writers pad it with zeros.
        let padding = json.iter().rev().take_while(|&&byte| byte == 0).count();
        Ok(Self { format: "GLB", json: json.get(..json.len() - padding).unwrap_or(json), binary })
    }
}

struct Chunks<'a> {
    content: &'a [u8],
    at: usize,
}

impl<'a> Chunks<'a> {
    /// The kind and content of the next chunk; `None` at the end.
    fn next(&mut self, source: &Source) -> Result<Option<(u32, &'a [u8])>, LoadError> {
        let (Some(length), Some(kind)) = (word(self.content, self.at), word(self.content, self.at + 4))
        else {
            return Ok(None);
        };
        let rest = self.content.get(self.at + 8..).unwrap_or_default();
        let Some(chunk) = rest.get(..length as usize) else {
            let what = format!("a chunk says {length} bytes, {} are left", rest.len());
            return Err(source.malformed(format!("byte {}", HEADER + self.at), what));
        };
        self.at += 8 + chunk.len();
        Ok(Some((kind, chunk)))
    }
}

fn word(bytes: &[u8], at: usize) -> Option<u32> {
    bytes.get(at..)?.first_chunk().map(|word| u32::from_le_bytes(*word))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chunk(kind: &[u8; 4], content: &[u8]) -> Vec<u8> {
        [&(content.len() as u32).to_le_bytes(), kind.as_slice(), content].concat()
    }

    fn file(chunks: &[Vec<u8>]) -> Source {
        let content = chunks.concat();
        let length = (HEADER + content.len()) as u32;
        let bytes = [b"glTF".as_slice(), &2_u32.to_le_bytes(), &length.to_le_bytes(), &content].concat();
        Source { path: "x.glb".into(), bytes }
    }

    #[test]
    fn unknown_chunks_are_passed_over() {
        let source = file(&[chunk(b"JSON", b"{}  "), chunk(b"ELSE", b"1234"), chunk(b"BIN\0", b"5678")]);
        let container = Container::open(&source).unwrap();
        assert_eq!((container.json, container.binary), (b"{}  ".as_slice(), Some(b"5678".as_slice())));
        let source = file(&[chunk(b"JSON", b"{}\0\0")]);
        let container = Container::open(&source).unwrap();
        assert_eq!((container.json, container.binary), (b"{}".as_slice(), None));
    }

    #[test]
    fn a_wrong_wrapping_is_an_error_with_its_place() {
        let refused = |source: Source| Container::open(&source).unwrap_err().to_string();
        assert!(refused(file(&[chunk(b"BIN\0", b"1234")])).contains("byte 12"));
        let mut source = file(&[chunk(b"JSON", b"{}  "), chunk(b"BIN\0", b"1234")]);
        source.bytes[24] = 5;
        assert!(refused(source).contains("byte 24: a chunk says 5 bytes, 4 are left"));
        let mut source = file(&[chunk(b"JSON", b"{}  ")]);
        source.bytes[8] = 3;
        assert!(refused(source).contains("the GLB header says 3 bytes, the file holds 24"));
        let mut source = file(&[chunk(b"JSON", b"{}  ")]);
        source.bytes[4] = 1;
        assert!(refused(source).contains("version 1"));
    }
}
