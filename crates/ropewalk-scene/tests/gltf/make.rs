//! Small documents, made for one test each.

use std::fmt::Write;

/// The bytes of numbers.
pub(crate) fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}

/// The bytes of indices of 16 bits.
pub(crate) fn shorts(values: &[u16]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}

/// Bytes as a data URI with percent codes.
pub(crate) fn data(bytes: &[u8]) -> String {
    bytes.iter().fold("data:,".to_owned(), |mut text, byte| {
        write!(text, "%{byte:02x}").unwrap();
        text
    })
}

/// A document with one buffer that is one view, and the given accessors, primitive and nodes; the nodes are the
/// roots of no scene, so all that are no child are shown.
pub(crate) fn document(bytes: &[u8], view: &str, accessors: &str, primitive: &str, nodes: &str) -> String {
    let (uri, length) = (data(bytes), bytes.len());
    let view_comma = if view.is_empty() { "" } else { "," };
    format!(
        r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"uri":"{uri}","byteLength":{length}}}],
        "bufferViews":[{{"buffer":0,"byteLength":{length}{view_comma}{view}}}],"accessors":[{accessors}],
        "meshes":[{{"primitives":[{{{primitive}}}]}}],"nodes":[{nodes}]}}"#
    )
}

/// An accessor of positions as f32.
pub(crate) fn positions(count: usize) -> String {
    format!(r#"{{"bufferView":0,"componentType":5126,"type":"VEC3","count":{count}}}"#)
}

/// A document of one triangle, shown by these nodes.
pub(crate) fn triangle(nodes: &str) -> String {
    let corners = floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    document(&corners, "", &positions(3), r#""attributes":{"POSITION":0}"#, nodes)
}

/// A GLB of a document and its block of bytes.
pub(crate) fn glb(json: &str, binary: &[u8]) -> Vec<u8> {
    let mut chunks = Vec::new();
    for (kind, content, padding) in [(b"JSON", json.as_bytes(), b' '), (b"BIN\0", binary, 0)] {
        let mut content = content.to_vec();
        content.resize(content.len().next_multiple_of(4), padding);
        chunks.extend((content.len() as u32).to_le_bytes());
        chunks.extend(kind);
        chunks.extend(content);
    }
    let length = 12 + chunks.len() as u32;
    [b"glTF".as_slice(), &2_u32.to_le_bytes(), &length.to_le_bytes(), &chunks].concat()
}

/// The document and the block of bytes of a GLB with both; `None` for other files.
pub(crate) fn split_glb(bytes: &[u8]) -> Option<(&str, &[u8])> {
    let length = u32::from_le_bytes(*bytes.get(12..)?.first_chunk()?) as usize;
    let (json, rest) = bytes.strip_prefix(b"glTF")?.get(16..)?.split_at_checked(length)?;
    Some((std::str::from_utf8(json).ok()?, rest.get(8..).unwrap_or_default()))
}
