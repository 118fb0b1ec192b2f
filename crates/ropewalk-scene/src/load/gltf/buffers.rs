//! The bytes behind a document: read when first asked for, so that a missing file of animations costs no geometry.

use super::document::{Document, get};
use super::uri::Uri;
use crate::LoadError;
use crate::load::source::Source;
use std::borrow::Cow;
use std::cell::OnceCell;
use std::collections::HashMap;

/// The buffers of a document.
pub(super) struct Buffers<'a> {
    pub(super) source: &'a Source,
    pub(super) document: &'a Document,
    binary: Option<&'a [u8]>,
    /// A slot a buffer.
    loaded: Vec<OnceCell<Cow<'a, [u8]>>>,
    /// The first buffer of each URI: a document may name one file a thousand times.
    first: HashMap<&'a str, usize>,
}

/// A part of a buffer.
#[derive(Clone, Copy, Debug)]
pub(super) struct View<'b> {
    pub(super) bytes: &'b [u8],
    /// From one element to the next; 0 where they lie side by side.
    pub(super) stride: u64,
}

impl<'a> Buffers<'a> {
    pub(super) fn new(source: &'a Source, document: &'a Document, binary: Option<&'a [u8]>) -> Self {
        let mut first = HashMap::new();
        for (index, buffer) in document.buffers.iter().enumerate() {
            if let Some(uri) = &buffer.uri {
                first.entry(uri.as_str()).or_insert(index);
            }
        }
        let loaded = document.buffers.iter().map(|_| OnceCell::new()).collect();
        Self { source, document, binary, loaded, first }
    }

    /// How many bytes have been read so far, the document's own file included.
    pub(super) fn loaded_bytes(&self) -> u64 {
        let buffers = self.loaded.iter().filter_map(OnceCell::get).map(|bytes| match bytes {
            Cow::Borrowed(_) => 0,
            Cow::Owned(bytes) => bytes.len() as u64,
        });
        buffers.sum::<u64>() + self.source.bytes.len() as u64
    }

    /// The bytes of a buffer view from an offset on.
    pub(super) fn view(&self, index: u64, offset: u64) -> Result<View<'_>, LoadError> {
        let malformed = |what: String| self.source.malformed(format!("bufferViews[{index}]"), what);
        let view = get(&self.document.buffer_views, index)
            .ok_or_else(|| malformed("there is no such view".into()))?;
        let buffer = self.buffer(view.buffer)?;
        let bytes = range(buffer, view.byte_offset, view.byte_length).ok_or_else(|| {
            let (length, offset, number) = (view.byte_length, view.byte_offset, view.buffer);
            malformed(format!(
                "it spans {length} bytes from byte {offset} of buffer {number}, which holds {}",
                buffer.len()
            ))
        })?;
        let bytes = range(bytes, offset, (bytes.len() as u64).saturating_sub(offset))
            .ok_or_else(|| malformed(format!("an accessor begins at byte {offset} of {}", bytes.len())))?;
        Ok(View { bytes, stride: view.byte_stride })
    }

    fn buffer(&self, index: u64) -> Result<&[u8], LoadError> {
        let malformed = |what: String| self.source.malformed(format!("buffers[{index}]"), what);
        let buffer =
            get(&self.document.buffers, index).ok_or_else(|| malformed("there is no such buffer".into()))?;
        let slot = match &buffer.uri {
            Some(uri) => self.first.get(uri.as_str()).copied(),
            None => usize::try_from(index).ok(),
        };
        let slot = slot.and_then(|slot| self.loaded.get(slot));
        let slot = slot.ok_or_else(|| malformed("there is no such buffer".into()))?;
        if let Some(bytes) = slot.get() {
            return Ok(bytes);
        }
        let bytes = match (&buffer.uri, self.binary) {
            (Some(uri), _) => Cow::Owned(self.fetch(uri).map_err(malformed)?),
            // Only the first buffer may stand for the block that comes with a GLB.
            (None, Some(binary)) if index == 0 => Cow::Borrowed(binary),
            (None, _) => {
                let what =
                    "it has no uri, and the file brings no bytes for it; export the scene with its buffers";
                return Err(malformed(what.into()));
            }
        };
        Ok(slot.get_or_init(|| bytes))
    }

    /// The bytes that a URI names.
    pub(super) fn fetch(&self, uri: &str) -> Result<Vec<u8>, String> {
        let name = match Uri::parse(uri)? {
            Uri::Data(bytes) => return Ok(bytes),
            Uri::File(name) => name,
        };
        // Some writers do not encode names: a file may really be called `a%20b.bin`.
        let found = self.source.sibling(&name).or_else(|error| {
            if name == uri { Err(error) } else { self.source.sibling(uri).map_err(|_| error) }
        });
        found.map(|file| file.bytes).map_err(|error| error.to_string())
    }
}

fn range(bytes: &[u8], offset: u64, length: u64) -> Option<&[u8]> {
    let offset = usize::try_from(offset).ok()?;
    bytes.get(offset..)?.get(..usize::try_from(length).ok()?)
}
