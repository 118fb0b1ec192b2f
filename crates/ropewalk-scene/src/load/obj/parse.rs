//! From the text of an OBJ file to a [`Document`].

use super::document::{Corner, Document, Face, NONE};
use crate::LoadError;
use crate::load::source::Source;
use crate::load::text::{Lines, number, quoted, words};
use glam::{DVec3, Vec2, Vec3};
use std::collections::HashMap;

/// Statements that change nothing here: smoothing, display, free-form attributes, crease tags of subdivision surfaces.
const PASSED_OVER: [&[u8]; 29] = [
    b"s",
    b"t",
    b"mg",
    b"lod",
    b"bevel",
    b"c_interp",
    b"d_interp",
    b"shadow_obj",
    b"trace_obj",
    b"ctech",
    b"stech",
    b"usemap",
    b"maplib",
    b"vp",
    b"cstype",
    b"deg",
    b"bmat",
    b"step",
    b"parm",
    b"trim",
    b"hole",
    b"scrv",
    b"sp",
    b"end",
    b"con",
    b"bsp",
    b"bzp",
    b"cdc",
    b"res",
];

/// Reads the statements.
pub(super) fn parse(source: &Source) -> Result<Document, LoadError> {
    let mut parser = Parser::default();
    parser.document.report.format = "OBJ".into();
    let mut lines = Lines::new(&source.bytes);
    while let Some((line, text)) = lines.next_joined() {
        let mut words = words(text);
        let Some(keyword) = words.next() else { continue };
        parser.statement(line, keyword, text, words);
    }
    let Parser { document, unknown, statements, .. } = parser;
    match unknown {
        Some((line, word)) if statements == 0 => {
            let what = format!("{} begins no statement of OBJ, and no other line does", quoted(&word));
            Err(source.malformed(format!("line {line}"), what))
        }
        _ => Ok(document),
    }
}

#[derive(Default)]
struct Parser {
    document: Document,
    /// The names of the current object and group.
    object_name: String,
    group_name: String,
    /// The current object, once it has a face.
    object: Option<u32>,
    material_name: Option<String>,
    material: Option<u32>,
    objects: HashMap<(String, String), u32>,
    materials: HashMap<String, u32>,
    /// How many statements were understood.
    statements: usize,
    /// The first that was not.
    unknown: Option<(usize, Vec<u8>)>,
}

impl Parser {
    fn statement<'a>(
        &mut self,
        line: usize,
        keyword: &[u8],
        text: &[u8],
        words: impl Iterator<Item = &'a [u8]>,
    ) {
        if keyword.starts_with(b"#") {
            return;
        }
        let values = words.take_while(|word| !word.starts_with(b"#"));
        self.statements += 1;
        match keyword {
            b"v" => self.vertex(line, values),
            b"vt" => self.texture_coordinate(line, values),
            b"vn" => self.normal(line, values),
            b"f" => self.face(line, values),
            b"o" => {
                self.object_name = rest(text, keyword);
                self.group_name.clear();
                self.object = None;
            }
            b"g" => {
                self.group_name = rest(text, keyword);
                self.object = None;
            }
            b"usemtl" => {
                self.material_name = Some(rest(text, keyword));
                self.material = None;
            }
            b"mtllib" => self.document.libraries.push(rest(text, keyword)),
            b"l" => self.skip("line elements", line),
            // Other programs pass over these too: they are no faces.
            b"fo" => self.skip("outlines of faces, which the format has given up", line),
            b"p" => self.skip("point elements", line),
            b"curv" | b"curv2" | b"surf" => self.skip("free-form curves and surfaces", line),
            b"call" | b"csh" => self.skip("calls of other files and commands", line),
            _ if PASSED_OVER.contains(&keyword) => {}
            _ => {
                self.statements -= 1;
                self.unknown.get_or_insert_with(|| (line, keyword.to_vec()));
                self.skip("lines that begin with an unknown word", line);
            }
        }
    }

    fn skip(&mut self, what: &str, line: usize) {
        self.document.report.skip(what, || format!("line {line}"));
    }

    fn vertex<'a>(&mut self, line: usize, mut values: impl Iterator<Item = &'a [u8]>) {
        let index = self.document.positions.len() as u32;
        let mut next = || values.next().and_then(number);
        let position = match (next(), next(), next()) {
            (Some(x), Some(y), Some(z)) => DVec3::new(x, y, z),
            _ => {
                self.document.unreadable.insert(index);
                self.skip("vertices with fewer than three readable numbers", line);
                DVec3::NAN
            }
        };
        self.document.positions.push(position);
        self.document.report.vertices += 1;
    }

    fn texture_coordinate<'a>(&mut self, line: usize, mut values: impl Iterator<Item = &'a [u8]>) {
        let u = values.next().and_then(number);
        // One number is a coordinate on a curve; v is 0 then.
        let v = values.next().map_or(Some(0.0), number);
        let (Some(u), Some(v)) = (u, v) else {
            self.skip("texture coordinates with an unreadable number", line);
            self.document.texture_coordinates.push(Vec2::ZERO);
            return;
        };
        self.document.texture_coordinates.push(Vec2::new(u as f32, v as f32));
    }

    fn normal<'a>(&mut self, line: usize, mut values: impl Iterator<Item = &'a [u8]>) {
        let mut next = || values.next().and_then(number);
        let normal = match (next(), next(), next()) {
            (Some(x), Some(y), Some(z)) => DVec3::new(x, y, z).as_vec3(),
            _ => {
                self.skip("normals with fewer than three readable numbers", line);
                Vec3::ZERO
            }
        };
        self.document.normals.push(normal);
    }

    fn face<'a>(&mut self, line: usize, values: impl Iterator<Item = &'a [u8]>) {
        let start = self.document.corners.len();
        let mut problem = None;
        for word in values {
            match self.corner(word) {
                Ok(corner) => self.document.corners.push(corner),
                Err(reason) => {
                    problem = Some(reason);
                    break;
                }
            }
        }
        let end = self.document.corners.len();
        if problem.is_none() && end - start < 3 {
            problem = Some("faces with fewer than three vertices");
        }
        if let Some(reason) = problem {
            self.document.corners.truncate(start);
            self.skip(reason, line);
            return;
        }
        let (object, material) = (self.current_object(), self.current_material());
        self.document.faces.push(Face { end, line, object, material });
    }

    fn corner(&self, word: &[u8]) -> Result<Corner, &'static str> {
        let document = &self.document;
        let mut fields = word.split(|&byte| byte == b'/');
        let vertex = fields.next().and_then(integer).ok_or("faces with an unreadable index")?;
        let mut optional = |count: usize| match fields.next() {
            None | Some(b"") => Ok(NONE),
            // One that leads nowhere costs the face no more than its texture coordinate or normal.
            Some(field) => integer(field)
                .map(|index| resolve(index, count).unwrap_or(NONE - 1))
                .ok_or("faces with an unreadable index"),
        };
        Ok(Corner {
            texture_coordinate: optional(document.texture_coordinates.len())?,
            normal: optional(document.normals.len())?,
            vertex: resolve(vertex, document.positions.len()).ok_or(super::assemble::NO_SUCH_VERTEX)?,
        })
    }

    fn current_object(&mut self) -> u32 {
        let Self { document, objects, object_name, group_name, .. } = self;
        *self.object.get_or_insert_with(|| {
            *objects.entry((object_name.clone(), group_name.clone())).or_insert_with(|| {
                document.objects.push(match (object_name.as_str(), group_name.as_str()) {
                    (object, "") => object.into(),
                    ("", group) => group.into(),
                    (object, group) if object == group => object.into(),
                    (object, group) => format!("{object}/{group}"),
                });
                document.objects.len() as u32 - 1
            })
        })
    }

    fn current_material(&mut self) -> u32 {
        let Self { document, materials, material_name, .. } = self;
        let Some(name) = material_name else { return NONE };
        *self.material.get_or_insert_with(|| {
            *materials.entry(name.clone()).or_insert_with(|| {
                document.materials.push(name.clone());
                document.materials.len() as u32 - 1
            })
        })
    }
}

/// What stands behind the keyword, blanks within kept.
fn rest(text: &[u8], keyword: &[u8]) -> String {
    let text = text.trim_ascii();
    String::from_utf8_lossy(text.strip_prefix(keyword).unwrap_or(text).trim_ascii()).into_owned()
}

/// A decimal integer; one too large for 64 bits leads nowhere all the same.
fn integer(word: &[u8]) -> Option<i64> {
    let (is_negative, digits) = match word {
        [b'-', digits @ ..] => (true, digits),
        [b'+', digits @ ..] | digits => (false, digits),
    };
    if digits.is_empty() {
        return None;
    }
    let size = digits.iter().try_fold(0i64, |size, digit| {
        digit.is_ascii_digit().then(|| size.saturating_mul(10).saturating_add(i64::from(digit - b'0')))
    })?;
    Some(if is_negative { -size } else { size })
}

/// From an index of OBJ to one from 0: 1 is the first, -1 the last so far. None where it cannot lead anywhere.
fn resolve(index: i64, count: usize) -> Option<u32> {
    let from_zero =
        if index < 0 { i64::try_from(count).ok()?.checked_add(index)? } else { index.checked_sub(1)? };
    u32::try_from(from_zero).ok().filter(|&index| index < NONE - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn indices_count_from_both_ends() {
        assert_eq!(resolve(1, 5), Some(0));
        assert_eq!(resolve(-1, 5), Some(4));
        assert_eq!(resolve(-5, 5), Some(0));
        assert_eq!(resolve(9, 5), Some(8), "may come later in the file");
        for nowhere in [0, -6, i64::MIN + 1, i64::MAX, i64::from(NONE)] {
            assert_eq!(resolve(nowhere, 5), None);
        }
    }

    #[test]
    fn integers_are_digits() {
        assert_eq!(integer(b"-12"), Some(-12));
        assert_eq!(integer(b"+7"), Some(7));
        assert_eq!(integer(b"99999999999999999999"), Some(i64::MAX));
        for word in ["", "-", "1.0", "x", "--1", "1 "] {
            assert_eq!(integer(word.as_bytes()), None);
        }
    }
}
