//! Binary STL: 80 bytes of anything, a count, and 50 bytes a facet.

use super::Solid;
use crate::load::source::Source;
use crate::{LoadError, LoadReport};
use glam::{DVec3, Vec3};

/// Reads the facets.
pub(super) fn read(source: &Source, report: &mut LoadReport) -> Result<Solid, LoadError> {
    report.format = "STL binary".into();
    let bytes = source.bytes.as_slice();
    let header = bytes.split_at_checked(80).and_then(|(_, rest)| rest.split_first_chunk::<4>());
    let Some((count, rest)) = header else {
        let what = "the file ends before its count of facets; it is neither a text that begins with 'solid' nor binary";
        return Err(source.malformed(format!("byte {}", bytes.len()), what));
    };
    let count = u32::from_le_bytes(*count) as usize;
    let (facets, _) = rest.as_chunks::<50>();
    let Some(facets) = facets.get(..count) else {
        let what = format!("{count} facets are promised, but the file ends after {}", facets.len());
        return Err(source.malformed("byte 80", what));
    };
    let left = rest.len() - facets.as_flattened().len();
    if left > 0 {
        report.notes.push(format!("{left} bytes after the last facet are not read"));
    }
    if facets.iter().any(|facet| facet[48..] != [0, 0]) {
        report.notes.push("the attribute bytes of facets, which may be colours, are not read".into());
    }
    report.vertices = 3 * facets.len();
    Ok(Solid { name: String::new(), facets: facets.iter().map(corners).collect() })
}

/// The corners stand behind the normal.
fn corners(facet: &[u8; 50]) -> [DVec3; 3] {
    let (words, _) = facet.as_chunks::<4>();
    let number = |index: usize| f32::from_le_bytes(words[index]);
    [3, 6, 9].map(|at| Vec3::new(number(at), number(at + 1), number(at + 2)).as_dvec3())
}
