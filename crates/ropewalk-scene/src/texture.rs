//! Pictures on surfaces, and how a surface looks them up.

use glam::Vec2;

/// A picture: rows from the one at `v = 0` on, four bytes a texel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Texture {
    /// The name in the file.
    pub name: String,
    /// Texels in a row; not 0.
    pub width: u32,
    /// Rows; not 0.
    pub height: u32,
    /// Red, green, blue, alpha: `width * height` of them.
    pub texels: Vec<[u8; 4]>,
    /// Whether red, green and blue are sRGB; else they are linear. Alpha is linear.
    pub is_srgb: bool,
}

/// How a surface looks a picture up: at `offset + scale * (u, v)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextureUse {
    /// The index of the picture.
    pub texture: u32,
    /// What lies outside of 0 to 1, along u and along v.
    pub wrap: [Wrap; 2],
    /// What lies between texels.
    pub filter: Filter,
    /// Multiplies the coordinates, first.
    pub scale: Vec2,
    /// Is added to them, then.
    pub offset: Vec2,
}

impl TextureUse {
    /// The picture as it is, repeated and smooth.
    #[must_use]
    pub const fn plain(texture: u32) -> Self {
        Self {
            texture,
            wrap: [Wrap::Repeat; 2],
            filter: Filter::Linear,
            scale: Vec2::ONE,
            offset: Vec2::ZERO,
        }
    }
}

/// What lies outside of a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Wrap {
    /// The picture again.
    #[default]
    Repeat,
    /// The picture, mirrored every other time.
    Mirror,
    /// Its last texels.
    Clamp,
}

/// What lies between the middles of texels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Filter {
    /// The nearest texel.
    Nearest,
    /// A mixture of the four around.
    #[default]
    Linear,
}
