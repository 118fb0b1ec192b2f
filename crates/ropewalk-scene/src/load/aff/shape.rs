//! Shapes: what one statement describes, as triangles in the space that it stands in.

use super::animation::{AnimatedTriangle, Corners};
use super::tokens::Tokens;
use crate::LoadError;
use crate::load::polygon::Cutter;
use crate::load::text::quoted;
use glam::{DVec2, DVec3};
use std::collections::HashMap;

/// Triangles between vertices. All indices lead somewhere.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Shape {
    pub(super) positions: Vec<DVec3>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// Of any length but NaN.
    pub(super) normals: Option<Values<DVec3>>,
    pub(super) coordinates: Option<Values<DVec2>>,
    /// The picture on it: an index into the names that the reader keeps.
    pub(super) texture: Option<u32>,
}

/// Values at corners: three indices a triangle.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Values<T> {
    pub(super) values: Vec<T>,
    pub(super) indices: Vec<[u32; 3]>,
}

/// What a statement needs to be read.
pub(super) struct ShapeReader {
    cutter: Cutter,
    /// The textures that are named, in the order of their first use.
    pub(super) textures: Vec<String>,
    texture_of: HashMap<String, u32>,
    /// Polygons that became fans though they are concave.
    pub(super) guesses: usize,
}

impl ShapeReader {
    pub(super) fn new() -> Self {
        Self { cutter: Cutter::new(), textures: Vec::new(), texture_of: HashMap::new(), guesses: 0 }
    }

    fn texture(&mut self, tokens: &mut Tokens<'_>) -> Result<u32, LoadError> {
        let name = tokens.name("the name of a texture")?;
        if let Some(&texture) = self.texture_of.get(&name) {
            return Ok(texture);
        }
        // A name takes more than one byte of a file: there cannot be too many.
        let texture = self.textures.len() as u32;
        self.textures.push(name.clone());
        self.texture_of.insert(name, texture);
        Ok(texture)
    }

    /// `m`: lists of vertices, normals and texture coordinates, and triangles that index each of them.
    pub(super) fn mesh(&mut self, tokens: &mut Tokens<'_>) -> Result<Shape, LoadError> {
        tokens.expect("vertices")?;
        let positions = rows(tokens, 3, "vertices", Tokens::vector)?;
        let mut normals = None;
        if tokens.take(b"normals") {
            normals = Some(rows(tokens, 3, "normals", Tokens::vector)?);
        }
        let (mut coordinates, mut texture) = (None, None);
        if tokens.take(b"texturecoords") {
            let count = tokens.count(2, "texture coordinates")?;
            texture = Some(self.texture(tokens)?);
            coordinates = Some(read_rows(tokens, count, Tokens::pair)?);
        }
        let what = "'triangles', or 'normals' or 'texturecoords' before them,";
        let found = tokens.word(what)?;
        if found != b"triangles" {
            return Err(tokens.malformed(format!("{} stands where {what} must stand", quoted(found))));
        }
        let width = 3 + 3 * (usize::from(normals.is_some()) + usize::from(coordinates.is_some()));
        let count = tokens.count(width, "triangles")?;
        let mut triangles = Vec::with_capacity(count);
        let mut normals = normals.map(|values| Values { values, indices: Vec::with_capacity(count) });
        let mut coordinates = coordinates.map(|values| Values { values, indices: Vec::with_capacity(count) });
        for _ in 0..count {
            triangles.push(three_indices(tokens, positions.len(), "vertex")?);
            if let Some(normals) = &mut normals {
                normals.indices.push(three_indices(tokens, normals.values.len(), "normal")?);
            }
            if let Some(coordinates) = &mut coordinates {
                let known = coordinates.values.len();
                coordinates.indices.push(three_indices(tokens, known, "texture coordinate")?);
            }
        }
        Ok(Shape { positions, triangles, normals, coordinates, texture })
    }

    /// `p`: a polygon; `pp`: one with a normal at each corner.
    pub(super) fn polygon(&mut self, tokens: &mut Tokens<'_>, has_normals: bool) -> Result<Shape, LoadError> {
        let count = tokens.count(if has_normals { 6 } else { 3 }, "corners")?;
        if count < 3 {
            return Err(tokens.malformed(format!("a polygon of {count} corners; it must have at least 3")));
        }
        let mut shape = Shape { positions: Vec::with_capacity(count), ..Shape::default() };
        let mut normals = Vec::new();
        for _ in 0..count {
            shape.positions.push(tokens.vector()?);
            if has_normals {
                normals.push(tokens.vector()?);
            }
        }
        let pieces = self.cutter.cut(&shape.positions);
        shape.triangles = pieces.triangles.to_vec();
        self.guesses += usize::from(pieces.is_guess);
        if has_normals {
            shape.normals = Some(Values { values: normals, indices: shape.triangles.clone() });
        }
        Ok(shape)
    }

    /// `tt`: a triangle with texture coordinates; `ttp`: one with normals too.
    pub(super) fn textured_triangle(
        &mut self,
        tokens: &mut Tokens<'_>,
        has_normals: bool,
    ) -> Result<Shape, LoadError> {
        let texture = Some(self.texture(tokens)?);
        let mut shape = Shape { triangles: vec![[0, 1, 2]], texture, ..Shape::default() };
        let (mut normals, mut coordinates) = (Vec::new(), Vec::new());
        for _ in 0..3 {
            shape.positions.push(tokens.vector()?);
            if has_normals {
                normals.push(tokens.vector()?);
            }
            coordinates.push(tokens.pair()?);
        }
        shape.normals = has_normals.then(|| Values { values: normals, indices: vec![[0, 1, 2]] });
        shape.coordinates = Some(Values { values: coordinates, indices: vec![[0, 1, 2]] });
        Ok(shape)
    }
}

/// `tpa`: a triangle with keys.
pub(super) fn animated_triangle(tokens: &mut Tokens<'_>) -> Result<AnimatedTriangle, LoadError> {
    let count = tokens.count(19, "keys")?;
    if count == 0 {
        return Err(tokens.malformed("an animated triangle without keys; it must have at least one"));
    }
    let key = |tokens: &mut Tokens<'_>| {
        let mut corner = || Ok((tokens.vector()?, tokens.vector()?));
        Ok::<Corners, LoadError>([corner()?, corner()?, corner()?])
    };
    Ok(AnimatedTriangle(read_rows(tokens, count, |tokens| Ok((tokens.number()?, key(tokens)?)))?))
}

/// A count and as many rows.
fn rows<'a, T>(
    tokens: &mut Tokens<'a>,
    width: usize,
    what: &str,
    row: impl FnMut(&mut Tokens<'a>) -> Result<T, LoadError>,
) -> Result<Vec<T>, LoadError> {
    let count = tokens.count(width, what)?;
    read_rows(tokens, count, row)
}

fn read_rows<'a, T>(
    tokens: &mut Tokens<'a>,
    count: usize,
    mut row: impl FnMut(&mut Tokens<'a>) -> Result<T, LoadError>,
) -> Result<Vec<T>, LoadError> {
    // The count was held against the length of the file.
    let mut rows = Vec::with_capacity(count);
    for _ in 0..count {
        rows.push(row(tokens)?);
    }
    Ok(rows)
}

fn three_indices(tokens: &mut Tokens<'_>, count: usize, what: &str) -> Result<[u32; 3], LoadError> {
    Ok([tokens.index(count, what)?, tokens.index(count, what)?, tokens.index(count, what)?])
}
