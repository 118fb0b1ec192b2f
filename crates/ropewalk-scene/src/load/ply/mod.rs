//! PLY, the polygon file format: a header of text that describes a body of text or of binary numbers.
//!
//! Read are the elements `vertex` (position, normal, texture coordinate), `face` (polygons) and `tristrips` (strips,
//! restarted by negative indices). Everything else is passed over and named in a note. The vertices keep the numbers
//! that they have in the file. A count is believed only when the bytes that are left can hold it.
//!
//! The cost is one pass over the bytes: some ten nanoseconds a value in a binary body, a hundred in a text.

mod assemble;
mod body;
mod header;
mod values;

use super::source::Source;
use crate::{LoadError, Model};
use header::Encoding;
use values::{Binary, Text, Values};

/// Reads a PLY file.
pub(crate) fn load(source: &Source) -> Result<Model, LoadError> {
    let header = header::parse(source)?;
    let format = format!("PLY {}", header.encoding.name());
    let (body, rest) = match header.encoding {
        Encoding::Text => read(&header, Text::new(source, header.length, header.lines + 1)),
        Encoding::LittleEndian => read(&header, Binary::<false>::new(source, header.length)),
        Encoding::BigEndian => read(&header, Binary::<true>::new(source, header.length)),
    }?;
    let mut model = assemble::assemble(body);
    model.report.format = format;
    if rest > 0 {
        model.report.notes.push(format!("{rest} bytes after the last element are not read"));
    }
    Ok(model)
}

/// The body, and how many bytes were left over.
fn read(header: &header::Header, mut values: impl Values) -> Result<(body::Body, usize), LoadError> {
    let body = body::read(header, &mut values)?;
    Ok((body, values.bytes_left()))
}
