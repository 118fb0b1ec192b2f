//! STL as text: `solid NAME`, `facet normal`, `outer loop`, `vertex`, and the ends of them, in any case.

use super::Solid;
use crate::load::polygon::Cutter;
use crate::load::source::Source;
use crate::load::text::{Lines, number, quoted, words};
use crate::{LoadError, LoadReport};
use glam::DVec3;

/// Reads the solids, empty ones too.
pub(super) fn read(source: &Source, report: &mut LoadReport) -> Result<Vec<Solid>, LoadError> {
    report.format = "STL ascii".into();
    let mut reader =
        Reader { report, solids: Vec::new(), corners: Vec::new(), cutter: Cutter::new(), inside: None };
    let mut lines = Lines::new(&source.bytes);
    let mut last_line = 0;
    while let Some((line, text)) = lines.next_joined() {
        last_line = line;
        reader.line(line, text).map_err(|what| source.malformed(format!("line {line}"), what))?;
    }
    match reader.inside {
        None => {}
        Some(Part::Solid) => reader.report.notes.push("the last solid has no 'endsolid'".into()),
        Some(Part::Facet) => {
            return Err(source.malformed(format!("line {last_line}"), "the file ends within a facet"));
        }
    }
    Ok(reader.solids)
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Part {
    Solid,
    Facet,
}

struct Reader<'a> {
    report: &'a mut LoadReport,
    solids: Vec<Solid>,
    /// Of the facet that is open.
    corners: Vec<DVec3>,
    cutter: Cutter,
    inside: Option<Part>,
}

impl Reader<'_> {
    /// A line may hold several statements; only names end with the line.
    fn line(&mut self, line: usize, text: &[u8]) -> Result<(), String> {
        let mut words = words(text);
        while let Some(word) = words.next() {
            match word.to_ascii_lowercase().as_slice() {
                b"solid" => {
                    self.end_facet(line);
                    let name: Vec<&[u8]> = words.by_ref().collect();
                    let name = String::from_utf8_lossy(&name.join(&b' ')).into_owned();
                    self.solids.push(Solid { name, facets: Vec::new() });
                    self.inside = Some(Part::Solid);
                }
                b"endsolid" => {
                    self.end_facet(line);
                    self.inside = None;
                    return Ok(());
                }
                b"facet" => {
                    self.end_facet(line);
                    self.inside = Some(Part::Facet);
                }
                // Three numbers that nobody needs; some writers put words like -nan(ind) here.
                b"normal" => drop(words.by_ref().take(3).count()),
                b"outer" | b"loop" | b"endloop" => {}
                b"vertex" => {
                    let mut coordinate = || {
                        let word = words.next().ok_or("a vertex needs three numbers")?;
                        number(word).ok_or_else(|| format!("{} is no number", quoted(word)))
                    };
                    self.corners.push(DVec3::new(coordinate()?, coordinate()?, coordinate()?));
                    self.report.vertices += 1;
                }
                b"endfacet" => self.end_facet(line),
                _ => return Err(format!("{} is no word of STL", quoted(word))),
            }
        }
        Ok(())
    }

    fn end_facet(&mut self, line: usize) {
        if self.inside != Some(Part::Facet) && self.corners.is_empty() {
            return;
        }
        self.inside = Some(Part::Solid);
        if self.corners.len() < 3 {
            self.report.skip("facets with fewer than three vertices", || format!("line {line}"));
        } else {
            if self.solids.is_empty() {
                self.solids.push(Solid::default());
            }
            let pieces = self.cutter.cut(&self.corners);
            let facets =
                pieces.triangles.iter().map(|piece| piece.map(|corner| self.corners[corner as usize]));
            if let Some(solid) = self.solids.last_mut() {
                solid.facets.extend(facets);
            }
        }
        self.corners.clear();
    }
}
