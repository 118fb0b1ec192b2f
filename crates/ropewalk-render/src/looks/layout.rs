//! The words of [`Looks`](super::Looks): which word stands where. The shaders read the same words.
//!
//! Everything is a table of rows of a fixed number of words. Floats stand as their bits. An index of
//! [`NOTHING`] leads nowhere. All offsets count words from the start of the whole; all other indices count rows of
//! their table. Everything that a row names has been checked when it was packed: an index is in its table or `NOTHING`,
//! a number is finite.
//!
//! **Header**, [`HEADER`] words, at 0. Pairs are the offset of a table and the number of its rows.
//!
//! | word | what |
//! |---|---|
//! | 0, 1 | instances, [`INSTANCE`] words a row, numbered as [`Hit::instance_index`](ropewalk::Hit) |
//! | 2, 3 | geometries, [`GEOMETRY`] words a row |
//! | 4, 5 | triangles, [`TRIANGLE`] words a row |
//! | 6, 7 | vertices, 3 words a row, in the object's space |
//! | 8, 9 | normals, 3 words a row, in the object's space, of unit length |
//! | 10, 11 | coordinates, 2 words a row |
//! | 12, 13 | materials, [`MATERIAL`] words a row |
//! | 14, 15 | texture descriptions, [`TEXTURE`] words a row |
//! | 16, 17 | 512 floats: the value of a byte as sRGB, then its value as it is (a byte over 255) |
//! | 18, 19 | light, as `light` lays it out: its offset, and the number of its words |
//! | 20, 21 | what the picture asks for, as `ray_tree` lays it out: its offset, and the number of its words |
//! | 22 | texels in a row of the atlas |
//! | 23 | rows of the atlas |
//! | 24 | flags: [`HAS_CUT_OUTS`] when some material has holes, [`HAS_PANES`] when some lets light through unbent |
//! | 25 | the instance of the ground that catches shadows, or `NOTHING` |
//! | 26, 27, 28 | the middle of that ground |
//! | 29 | how far it reaches |
//! | 30, 31 | 0 |
//!
//! **Instance**: 0 to 11 three rows of object-to-world, each x, y, z, and the translation; 12 to 20 three rows of the
//! matrix that takes normals to the scene, scaled so that its largest element is 1; 21 the first geometry; 22 the number
//! of geometries; 23 is 0.
//!
//! **Geometry**: 0 the first triangle, 1 the number of triangles, 2 and 3 are 0.
//!
//! **Triangle**: 0 to 2 the vertices, all three `NOTHING` where one is not there; 3 to 5 the normals, all three `NOTHING`
//! where there are none or one is no direction; 6 to 8 the coordinates, all three `NOTHING` where there are none; 9 the
//! material.
//!
//! **Material**: 0 to 2 base color, 3 opacity; 4 to 6 emissive, 7 alpha cutoff; 8 to 10 ambient, 11 flags
//! ([`GIVES_AMBIENT`], [`GIVES_SPECULAR`], [`MIRRORS_SHARPLY`]); 12 to 14 specular, 15 index of refraction; 16 roughness,
//! 17 metallic, 18 transmission, 19 the reflectance at normal incidence that follows from the index of refraction; 20 to 22
//! the texture descriptions of base color, emissive, and metallic and roughness, or `NOTHING`; 23 is 0.
//!
//! **Texture description**: 0, 1 the column and the row of its first texel in the atlas; 2, 3 its width and height; 4
//! flags: bits 0 and 1 the wrap along u, bits 2 and 3 the wrap along v ([`REPEAT`], [`MIRROR`], [`CLAMP`]),
//! [`IS_LINEAR`], [`IS_SRGB`]; 5, 6 scale; 7, 8 offset; 9 to 11 are 0.
//!
//! **Texels**: red in the lowest byte, then green, blue, alpha. Texel (x, y) of the atlas is number
//! `y * (word 22) + x`.

/// The index that leads nowhere.
pub(crate) const NOTHING: u32 = u32::MAX;

/// Words of the header.
pub(crate) const HEADER: usize = 32;
/// Words of an instance.
pub(crate) const INSTANCE: usize = 24;
/// Words of a geometry.
pub(crate) const GEOMETRY: usize = 4;
/// Words of a triangle.
pub(crate) const TRIANGLE: usize = 10;
/// Words of a material.
pub(crate) const MATERIAL: usize = 24;
/// Words of a texture description.
pub(crate) const TEXTURE: usize = 12;

/// Header: where the pair of a table stands.
pub(crate) const INSTANCES: usize = 0;
/// See [`INSTANCES`].
pub(crate) const GEOMETRIES: usize = 2;
/// See [`INSTANCES`].
pub(crate) const TRIANGLES: usize = 4;
/// See [`INSTANCES`].
pub(crate) const VERTICES: usize = 6;
/// See [`INSTANCES`].
pub(crate) const NORMALS: usize = 8;
/// See [`INSTANCES`].
pub(crate) const COORDINATES: usize = 10;
/// See [`INSTANCES`].
pub(crate) const MATERIALS: usize = 12;
/// See [`INSTANCES`].
pub(crate) const TEXTURES: usize = 14;
/// See [`INSTANCES`].
pub(crate) const BYTES: usize = 16;
/// See [`INSTANCES`].
pub(crate) const LIGHT: usize = 18;
/// See [`INSTANCES`].
pub(crate) const REQUEST: usize = 20;
/// Header: texels in a row of the atlas, and its rows.
pub(crate) const ATLAS: usize = 22;
/// Header: flags.
pub(crate) const FLAGS: usize = 24;
/// Header: the instance of the ground that catches shadows, its middle, its reach.
pub(crate) const CATCHER: usize = 25;

/// Header flag: some material has holes.
pub(crate) const HAS_CUT_OUTS: u32 = 1;
/// Header flag: some material lets light through without bending it.
pub(crate) const HAS_PANES: u32 = 2;

/// Material flag: the file says how much ambient light is sent on; else the base color counts.
pub(crate) const GIVES_AMBIENT: u32 = 1;
/// Material flag: the file gives the reflectance at normal incidence as a color.
pub(crate) const GIVES_SPECULAR: u32 = 2;
/// Material flag: surroundings are mirrored sharply whatever the roughness.
pub(crate) const MIRRORS_SHARPLY: u32 = 4;

/// Wrap: the picture again.
pub(crate) const REPEAT: u32 = 0;
/// Wrap: the picture mirrored every other time.
pub(crate) const MIRROR: u32 = 1;
/// Wrap: its last texels.
pub(crate) const CLAMP: u32 = 2;
/// Texture flag: a mixture of the four texels around, else the nearest.
pub(crate) const IS_LINEAR: u32 = 16;
/// Texture flag: red, green and blue are sRGB.
pub(crate) const IS_SRGB: u32 = 32;
