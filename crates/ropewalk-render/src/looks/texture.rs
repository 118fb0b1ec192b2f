//! Textures in one atlas: where a texture coordinate leads, and what stands there. The twin of `looks_texture` in the
//! shaders.
//!
//! Coordinates are wrapped in whole texels of the texture before the atlas is read. So no texel of a neighbour is ever
//! mixed in, and the atlas gives what separate textures give, at borders too.
//!
//! A coordinate that is no number, or so large (2^23) that it has no fraction left, counts as 0.

use super::layout::{self, TEXTURE};
use super::{Looks, shaded::mix};
use glam::{Vec2, Vec4};

/// Coordinates from this size on are whole numbers.
const NO_FRACTION_BITS: u32 = 0x4b00_0000;

/// The coordinate, or 0 where it is no number or has no fraction.
fn tamed(coordinate: f32) -> f32 {
    // By the bits: a shader may take for granted that nothing is NaN.
    if coordinate.to_bits() & 0x7fff_ffff < NO_FRACTION_BITS { coordinate } else { 0.0 }
}

/// The coordinate in texels, within the first period of the picture.
fn in_texels(coordinate: f32, wrap: u32, size: u32) -> f32 {
    let size = size as f32;
    if wrap == layout::REPEAT {
        return (coordinate - coordinate.floor()) * size;
    }
    if wrap == layout::MIRROR {
        let half = coordinate * 0.5;
        return ((half - half.floor()) * 2.0) * size;
    }
    coordinate.clamp(0.0, 1.0) * size
}

/// The texel of the picture for one that lies at most a texel outside of its first period.
fn wrapped(texel: i32, wrap: u32, size: u32) -> u32 {
    let size = size as i32;
    if wrap == layout::REPEAT {
        if texel < 0 {
            return (texel + size) as u32;
        }
        if texel >= size {
            return (texel - size) as u32;
        }
        return texel as u32;
    }
    if wrap == layout::MIRROR {
        let mut place = texel;
        if place < 0 {
            place += 2 * size;
        }
        if place >= 2 * size {
            place -= 2 * size;
        }
        if place >= size {
            place = 2 * size - 1 - place;
        }
        return place as u32;
    }
    texel.max(0).min(size - 1) as u32
}

/// What texture description number `description` gives at `uv`: red, green, blue, linear, and alpha. `None` for
/// [`layout::NOTHING`].
pub(crate) fn look_up(looks: &Looks, description: u32, uv: Vec2) -> Option<Vec4> {
    if description == layout::NOTHING {
        return None;
    }
    let at = looks.row(layout::TEXTURES, description, TEXTURE);
    let (width, height) = (looks.word(at + 2), looks.word(at + 3));
    let flags = looks.word(at + 4);
    let (wrap_u, wrap_v) = (flags & 3, (flags >> 2) & 3);
    let u = tamed(looks.float(at + 5) * tamed(uv.x) + looks.float(at + 7));
    let v = tamed(looks.float(at + 6) * tamed(uv.y) + looks.float(at + 8));
    let x = in_texels(u, wrap_u, width);
    let y = in_texels(v, wrap_v, height);
    let texel = |x: i32, y: i32| {
        let column = looks.word(at) + wrapped(x, wrap_u, width);
        let row = looks.word(at + 1) + wrapped(y, wrap_v, height);
        decoded(looks, column, row, flags & layout::IS_SRGB != 0)
    };
    if flags & layout::IS_LINEAR == 0 {
        return Some(texel(x.floor() as i32, y.floor() as i32));
    }
    // The middle of texel i lies at i + 0.5.
    let (left, low) = (x - 0.5, y - 0.5);
    let (column, row) = (left.floor(), low.floor());
    let (across, along) = (left - column, low - row);
    let (column, row) = (column as i32, row as i32);
    let first = mixed(texel(column, row), texel(column + 1, row), across);
    let second = mixed(texel(column, row + 1), texel(column + 1, row + 1), across);
    Some(mixed(first, second, along))
}

fn mixed(a: Vec4, b: Vec4, share: f32) -> Vec4 {
    Vec4::new(mix(a.x, b.x, share), mix(a.y, b.y, share), mix(a.z, b.z, share), mix(a.w, b.w, share))
}

/// A texel of the atlas as linear numbers.
fn decoded(looks: &Looks, column: u32, row: u32, is_srgb: bool) -> Vec4 {
    let index = row as usize * looks.word(layout::ATLAS) as usize + column as usize;
    let texel = looks.texels().get(index).copied().unwrap_or(0);
    let table = looks.word(layout::BYTES) as usize;
    let plain = table + 256;
    let color = if is_srgb { table } else { plain };
    Vec4::new(
        looks.float(color + (texel & 0xff) as usize),
        looks.float(color + (texel >> 8 & 0xff) as usize),
        looks.float(color + (texel >> 16 & 0xff) as usize),
        looks.float(plain + (texel >> 24) as usize),
    )
}
