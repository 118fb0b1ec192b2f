//! From the text of an AFF file, and of those that it includes, to a [`Document`].
//!
//! The current material and level of detail live on beyond the ends of blocks and files; transforms end with their
//! block, and a block ends in the file that began it. Depths and amounts are limited, since files can include each
//! other without end.

use super::blocks::{Blocks, Place};
use super::budget::Budget;
use super::document::{Deforming, Document};
use super::includes::Includes;
use super::keyframes;
use super::looks::{Finish, PlacedLight, View};
use super::part::Part;
use super::shape::{Shape, ShapeReader, animated_triangle};
use super::tokens::Tokens;
use super::{pictures, round};
use crate::load::source::Source;
use crate::load::text::quoted;
use crate::{LoadError, Material, TextureUse};
use std::collections::HashMap;

/// All words that begin a statement.
const STATEMENTS: [&[u8]; 24] = [
    b"v", b"b", b"l", b"la", b"am", b"a", b"f", b"fm", b"c", b"s", b"p", b"pp", b"tt", b"ttp", b"tpa", b"m",
    b"i", b"d", b"x", b"xs", b"k", b"tess", b"{", b"}",
];

/// Reads a file and what it includes.
pub(super) fn parse(source: &Source) -> Result<Document, LoadError> {
    refuse_sense8(source)?;
    let mut parser = Parser::new();
    parser.document.report.format = format(source).into();
    parser.budget.load(source.bytes.len());
    parser.file(source)?;
    let Parser { mut document, blocks, shapes, first_guess, .. } = parser;
    document.nodes = blocks.into_nodes();
    document.textures = shapes.textures;
    document.pictures = pictures::read(source, &mut document);
    if let Some(first) = first_guess {
        let guesses = shapes.guesses;
        document.report.notes.push(format!(
            "{guesses} polygons cross themselves or are too long and were cut into fans; the first ends in {first}"
        ));
    }
    Ok(document)
}

/// Which of the two names the file goes by.
fn format(source: &Source) -> &'static str {
    let name = source.path.to_string_lossy().to_ascii_lowercase();
    if name.ends_with(".nff") || name.ends_with(".nff.gz") { "NFF" } else { "AFF" }
}

/// The format of WorldToolKit goes by the same name, but has its own as its first word.
fn refuse_sense8(source: &Source) -> Result<(), LoadError> {
    let first = source.bytes.split(u8::is_ascii_whitespace).find(|word| !word.is_empty());
    if !first.is_some_and(|word| word.eq_ignore_ascii_case(b"nff")) {
        return Ok(());
    }
    let what = "this is NFF of Sense8's WorldToolKit, another format than the Neutral File Format; convert it to OBJ";
    Err(LoadError::UnknownFormat { path: source.path.clone(), what: what.into() })
}

struct Parser {
    document: Document,
    budget: Budget,
    shapes: ShapeReader,
    first_guess: Option<String>,
    includes: Includes,
    blocks: Blocks,
    finish: Finish,
    /// Where it was set.
    finish_place: String,
    /// Its index, once a shape uses it, and the picture on that.
    material: Option<(Option<u32>, u32)>,
    material_of: HashMap<([u64; 12], Option<u32>), u32>,
    level: u32,
    rigid_of: HashMap<Option<usize>, usize>,
    deforming_of: HashMap<Option<usize>, usize>,
}

impl Parser {
    fn new() -> Self {
        Self {
            document: Document::default(),
            budget: Budget::default(),
            shapes: ShapeReader::new(),
            first_guess: None,
            includes: Includes::default(),
            blocks: Blocks::default(),
            finish: Finish::NONE,
            finish_place: "default".into(),
            material: None,
            material_of: HashMap::new(),
            level: 0,
            rigid_of: HashMap::new(),
            deforming_of: HashMap::new(),
        }
    }

    fn file(&mut self, source: &Source) -> Result<(), LoadError> {
        let mut tokens = Tokens::new(source);
        let outside = self.blocks.depth();
        self.includes.enter(source);
        while let Some(word) = tokens.next_word() {
            if word == b"}" && self.blocks.depth() == outside {
                return Err(tokens.malformed("'}' stands where no block of this file is open"));
            }
            self.statement(&mut tokens, word)?;
        }
        if let Some(line) = self.blocks.innermost_line().filter(|_| self.blocks.depth() > outside) {
            return Err(
                tokens.malformed(format!("the file ends in the block of line {line}; '}}' is missing"))
            );
        }
        self.includes.leave();
        Ok(())
    }

    fn statement(&mut self, tokens: &mut Tokens<'_>, word: &[u8]) -> Result<(), LoadError> {
        match word {
            b"v" => {
                let place = tokens.place();
                self.document.view = Some(View::read(tokens, place)?);
            }
            b"l" | b"la" => self.light(tokens, word == b"la")?,
            b"b" => self.document.background = Some(tokens.vector()?),
            b"am" => self.document.ambient = Some(tokens.vector()?),
            b"a" => {
                self.document.start = tokens.number()?;
                self.document.end = tokens.number()?;
                self.document.frames = tokens.integer()?;
            }
            b"fm" => {
                let place = tokens.place();
                self.set_finish(Finish::read_fm(tokens)?, place);
            }
            b"f" => {
                let place = tokens.place();
                self.set_finish(Finish::read_f(tokens)?, place);
                skip_extras(tokens);
            }
            b"m" => {
                let shape = self.shapes.mesh(tokens)?;
                self.stored_shape(tokens, &shape)?;
            }
            b"p" | b"pp" => {
                let shape = self.shapes.polygon(tokens, word == b"pp")?;
                if self.shapes.guesses == 1 {
                    self.first_guess.get_or_insert_with(|| tokens.place());
                }
                self.stored_shape(tokens, &shape)?;
            }
            b"tt" | b"ttp" => {
                let shape = self.shapes.textured_triangle(tokens, word == b"ttp")?;
                self.stored_shape(tokens, &shape)?;
            }
            b"tpa" => self.deforming(tokens)?,
            b"s" => {
                let shape = round::sphere(tokens.vector()?, tokens.number()?);
                skip_extras(tokens);
                self.document.spheres += usize::from(shape.is_some());
                self.round_shape(tokens, shape.as_ref(), "spheres of radius 0")?;
            }
            b"c" => {
                let (base, base_radius) = (tokens.vector()?, tokens.number()?);
                let shape = round::cone(base, base_radius, tokens.vector()?, tokens.number()?);
                self.document.cones += usize::from(shape.is_some());
                self.round_shape(tokens, shape.as_ref(), "cones without length or width")?;
            }
            b"i" => self.include(tokens)?,
            b"d" => self.level = tokens.integer()?,
            b"x" => self.blocks.begin_animated(tokens, &mut self.budget)?,
            b"xs" => self.blocks.begin_static(tokens)?,
            b"}" => self.blocks.end(),
            b"k" => {
                let name = tokens.name("the name of what moves")?;
                let keyframes = keyframes::read(tokens)?;
                // Of several with one name the last counts.
                self.document.keyframes.insert(name, keyframes);
            }
            // How finely some programs are to divide round shapes.
            b"tess" => while tokens.peek_on_line().is_some_and(|_| tokens.next_word().is_some()) {},
            b"{" => return Err(tokens.malformed("'{' stands where no 'x', 'xs' or 'k' comes before it")),
            _ => {
                let what = format!("{} begins no statement of AFF or NFF", quoted(word));
                return Err(tokens.malformed(what));
            }
        }
        Ok(())
    }

    fn take(&mut self, tokens: &Tokens<'_>, bytes: usize) -> Result<(), LoadError> {
        self.budget.take(bytes).map_err(|what| tokens.malformed(what))
    }

    fn light(&mut self, tokens: &mut Tokens<'_>, has_name: bool) -> Result<(), LoadError> {
        self.take(tokens, size_of::<PlacedLight>())?;
        let Place { node, to_node } = self.blocks.here();
        self.document.lights.push(PlacedLight::read(tokens, has_name, node, to_node)?);
        Ok(())
    }

    fn set_finish(&mut self, finish: Finish, place: String) {
        (self.finish, self.finish_place) = (finish, place);
        self.material = None;
    }

    /// The index of the current material with a picture. The first place of equal ones gives them their name.
    fn material(&mut self, texture: Option<u32>) -> u32 {
        if let Some((_, material)) = self.material.filter(|&(current, _)| current == texture) {
            return material;
        }
        let Self { document, finish, finish_place, material_of, .. } = self;
        let material = *material_of.entry((finish.key(), texture)).or_insert_with(|| {
            let base_color_texture = texture.map(TextureUse::plain);
            let material = finish.material(finish_place.clone());
            document.materials.push(Material { base_color_texture, ..material });
            document.materials.len() as u32 - 1
        });
        self.material = Some((texture, material));
        material
    }

    fn stored_shape(&mut self, tokens: &Tokens<'_>, shape: &Shape) -> Result<(), LoadError> {
        self.document.report.vertices += shape.positions.len();
        self.add(tokens, shape)
    }

    fn round_shape(
        &mut self,
        tokens: &Tokens<'_>,
        shape: Option<&Shape>,
        without: &str,
    ) -> Result<(), LoadError> {
        if let Some(shape) = shape {
            return self.add(tokens, shape);
        }
        self.document.report.skip(without, || tokens.place());
        Ok(())
    }

    fn add(&mut self, tokens: &Tokens<'_>, shape: &Shape) -> Result<(), LoadError> {
        if shape.triangles.is_empty() {
            return Ok(());
        }
        let material = self.material(shape.texture);
        let Place { node, to_node } = self.blocks.here();
        let rigid = &mut self.document.rigid;
        let index = *self.rigid_of.entry(node).or_insert_with(|| {
            rigid.push((node, Part::default()));
            rigid.len() - 1
        });
        let Some((_, part)) = rigid.get_mut(index) else { return Ok(()) };
        let bytes = part.add(shape, &to_node, material).map_err(|what| tokens.malformed(what))?;
        self.take(tokens, bytes)
    }

    fn deforming(&mut self, tokens: &mut Tokens<'_>) -> Result<(), LoadError> {
        let triangle = animated_triangle(tokens)?;
        self.take(tokens, size_of::<Deforming>() + size_of_val(triangle.0.as_slice()))?;
        self.document.report.vertices += 3;
        let material = self.material(None);
        let Place { node, to_node } = self.blocks.here();
        let deforming = &mut self.document.deforming;
        let index = *self.deforming_of.entry(node).or_insert_with(|| {
            deforming.push((node, Vec::new()));
            deforming.len() - 1
        });
        if let Some((_, triangles)) = deforming.get_mut(index) {
            triangles.push(Deforming { triangle, to_node, material });
        }
        Ok(())
    }

    fn include(&mut self, tokens: &mut Tokens<'_>) -> Result<(), LoadError> {
        let level = tokens.integer()?;
        let name = tokens.name("the name of a file")?;
        if level > self.level {
            return Ok(());
        }
        let source = self.includes.source(tokens, name, &mut self.budget)?;
        self.budget.read(source.bytes.len()).map_err(|what| tokens.malformed(what))?;
        self.file(&source)
    }
}

/// Passes over what some programs write behind a statement, to the end of the line.
fn skip_extras(tokens: &mut Tokens<'_>) {
    while tokens.peek_on_line().is_some_and(|word| !STATEMENTS.contains(&word)) {
        tokens.next_word();
    }
}

#[cfg(test)]
mod tests;
