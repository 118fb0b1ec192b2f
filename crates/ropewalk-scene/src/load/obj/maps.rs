//! The pictures of MTL: `map_Kd`, `map_Ke` and `map_d`, in files beside the MTL file: PNG, JPEG or binary PPM.
//!
//! The v of OBJ runs upwards and the rows of a picture downwards, so v is turned. `map_d` makes holes where it is darker than
//! half: its brightness, or its alpha where it has one, becomes the alpha of the colour's picture, which must be of the same
//! size and be looked up in the same way. Where both name one file its alpha counts. The other maps are not read.

use crate::load::source::Source;
use crate::load::text::{number, words};
use crate::load::textures::{Colors, Textures};
use crate::{Material, TextureUse, Wrap};
use glam::{Vec2, Vec3};
use std::collections::HashMap;
use std::path::Path;
use std::rc::Rc;

/// More pictures than any scene has; a file may not make the program ask the file system without end.
const MOST: usize = 4096;

/// The maps of one material.
#[derive(Debug, Default)]
pub(super) struct Maps {
    /// The MTL file.
    pub(super) library: Option<Rc<Path>>,
    color: Option<Map>,
    emission: Option<Map>,
    opacity: Option<Map>,
    /// Whether the colours that pictures multiply are given.
    pub(super) has_color: bool,
    pub(super) has_emission: bool,
}

/// A picture and how it is looked up.
#[derive(Clone, Debug, PartialEq)]
struct Map {
    name: String,
    scale: Vec2,
    offset: Vec2,
    wrap: Wrap,
}

impl Maps {
    /// Takes a map; false for one that is not read.
    pub(super) fn set(&mut self, keyword: &[u8], text: &[u8]) -> bool {
        let slot = match keyword {
            b"map_kd" => &mut self.color,
            b"map_ke" => &mut self.emission,
            b"map_d" => &mut self.opacity,
            _ => return false,
        };
        *slot = Map::parse(text);
        true
    }
}

impl Map {
    /// What stands behind the keyword: options, and the name of a file, which may have blanks.
    fn parse(text: &[u8]) -> Option<Self> {
        let mut map = Self { name: String::new(), scale: Vec2::ONE, offset: Vec2::ZERO, wrap: Wrap::Repeat };
        let mut rest = text.trim_ascii();
        while rest.starts_with(b"-") {
            let (option, mut behind) = split(rest);
            let (least, most) = match option {
                b"-s" | b"-o" | b"-t" => (1, 3),
                b"-mm" => (2, 2),
                b"-clamp" | b"-blendu" | b"-blendv" | b"-cc" | b"-imfchan" | b"-type" | b"-bm"
                | b"-boost" | b"-texres" => (1, 1),
                // A name may begin with a dash.
                _ => break,
            };
            let mut values = [None; 3];
            for place in 0..most {
                let (word, next) = split(behind);
                let value = number(word).map(|value| value as f32).filter(|value| value.is_finite());
                if place >= least && (value.is_none() || next.is_empty()) {
                    break;
                }
                if option == b"-clamp" && word.eq_ignore_ascii_case(b"on") {
                    map.wrap = Wrap::Clamp;
                }
                if let Some(slot) = values.get_mut(place) {
                    *slot = value;
                }
                behind = next;
            }
            let [u, v, _] = values;
            match option {
                b"-s" => map.scale = Vec2::new(u.unwrap_or(1.0), v.unwrap_or(1.0)),
                b"-o" => map.offset = Vec2::new(u.unwrap_or(0.0), v.unwrap_or(0.0)),
                _ => {}
            }
            rest = behind;
        }
        map.name = String::from_utf8_lossy(rest).into_owned();
        (!map.name.is_empty()).then_some(map)
    }

    /// The way to look a picture up whose rows run downwards.
    fn of(&self, texture: u32) -> TextureUse {
        TextureUse {
            wrap: [self.wrap; 2],
            scale: self.scale * Vec2::new(1.0, -1.0),
            offset: Vec2::new(self.offset.x, 1.0 - self.offset.y),
            ..TextureUse::plain(texture)
        }
    }

    fn is_looked_up_like(&self, other: &Self) -> bool {
        (self.scale, self.offset, self.wrap) == (other.scale, other.offset, other.wrap)
    }
}

/// The first word, and what is behind it.
fn split(text: &[u8]) -> (&[u8], &[u8]) {
    let word = words(text).next().unwrap_or_default();
    let text = text.trim_ascii_start();
    (word, text.get(word.len()..).unwrap_or_default().trim_ascii_start())
}

/// Reads the pictures of materials, each file once for each use.
#[derive(Debug, Default)]
pub(super) struct MapReader {
    pub(super) textures: Textures,
    read: HashMap<(Rc<Path>, String), Option<u32>>,
    /// By the pictures of colour and opacity.
    joined: HashMap<(Option<u32>, u32), Option<u32>>,
}

impl MapReader {
    /// Gives a material its pictures.
    pub(super) fn add(&mut self, maps: &Maps, material: &mut Material) {
        let Some(library) = &maps.library else { return };
        if let Some(map) = &maps.color
            && let Some(texture) = self.file(library, map)
        {
            material.base_color_texture = Some(map.of(texture));
            // Some exporters write black beside a picture, or nothing.
            if !maps.has_color || material.base_color == Vec3::ZERO {
                material.base_color = Vec3::ONE;
            }
        }
        if let Some(map) = &maps.emission
            && let Some(texture) = self.file(library, map)
        {
            material.emissive_texture = Some(map.of(texture));
            if !maps.has_emission {
                material.emissive = Vec3::ONE;
            }
        }
        if let Some(map) = &maps.opacity
            && let Some(mask) = self.file(library, map)
        {
            let color = material.base_color_texture.map(|color| color.texture);
            let fits = maps.color.as_ref().is_none_or(|color| color.is_looked_up_like(map));
            let texture = if fits { self.join(color, mask) } else { None };
            match texture {
                Some(texture) => {
                    material.base_color_texture = Some(map.of(texture));
                    material.alpha_cutoff = 0.5;
                }
                None if color == Some(mask) => {}
                None => self.textures.refuse(&map.name, "map_d does not fit the picture of map_Kd"),
            }
        }
    }

    fn file(&mut self, library: &Rc<Path>, map: &Map) -> Option<u32> {
        let key = (Rc::clone(library), map.name.clone());
        if let Some(&texture) = self.read.get(&key) {
            return texture;
        }
        let source = Source { path: library.to_path_buf(), bytes: Vec::new() };
        let texture = if self.read.len() >= MOST {
            self.textures
                .refuse(&map.name, &format!("the materials name more than {MOST} pictures, the limit"));
            None
        } else {
            match source.sibling(&map.name) {
                Ok(file) => self.textures.decode(&map.name, &file.bytes, Colors::Shown),
                Err(error) => {
                    self.textures.refuse(&map.name, &error.to_string());
                    None
                }
            }
        };
        self.read.insert(key, texture);
        texture
    }

    /// The picture of a colour, white where there is none, with the alpha of a mask.
    fn join(&mut self, color: Option<u32>, mask: u32) -> Option<u32> {
        if let Some(&joined) = self.joined.get(&(color, mask)) {
            return joined;
        }
        let joined = self.textures.with_alpha(color, mask);
        self.joined.insert((color, mask), joined);
        joined
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(text: &str) -> Option<(String, Vec2, Vec2, Wrap)> {
        Map::parse(text.as_bytes()).map(|map| (map.name, map.scale, map.offset, map.wrap))
    }

    #[test]
    fn options_stand_before_the_name() {
        let (one, zero) = (Vec2::ONE, Vec2::ZERO);
        for (text, name, scale, offset, wrap) in [
            ("a b.png", "a b.png", one, zero, Wrap::Repeat),
            ("-s 2 3 1 -o .5 x.png", "x.png", Vec2::new(2.0, 3.0), Vec2::new(0.5, 0.0), Wrap::Repeat),
            ("-clamp on -mm 0 1 -bm 2 -imfchan l x.png ", "x.png", one, zero, Wrap::Clamp),
            ("-clamp off -t 1 2 x", "x", one, zero, Wrap::Repeat),
            // A name may be a number.
            ("-s 2 7", "7", Vec2::new(2.0, 1.0), zero, Wrap::Repeat),
            ("-odd.png", "-odd.png", one, zero, Wrap::Repeat),
        ] {
            assert_eq!(map(text), Some((name.into(), scale, offset, wrap)), "{text}");
        }
        for text in ["", "  ", "-s", "-s 1", "-clamp on"] {
            assert_eq!(map(text), None, "{text}");
        }
    }

    #[test]
    fn v_is_turned() {
        let map = Map::parse(b"-s 2 4 -o .25 .5 x.png").unwrap();
        let texture = map.of(3);
        let look_up = |uv: Vec2| texture.offset + texture.scale * uv;
        assert_eq!(look_up(Vec2::ZERO), Vec2::new(0.25, 0.5));
        assert_eq!(look_up(Vec2::new(1.0, 0.25)), Vec2::new(2.25, -0.5));
        let plain = Map::parse(b"x.png").unwrap().of(0);
        assert_eq!((plain.scale, plain.offset), (Vec2::new(1.0, -1.0), Vec2::new(0.0, 1.0)));
    }
}
