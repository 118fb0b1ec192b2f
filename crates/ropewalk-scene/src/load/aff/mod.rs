//! AFF, the Animated File Format of BART, "A Benchmark for Animated Ray Tracing" (Lext, Assarsson and Möller 2001),
//! and NFF, the Neutral File Format 3.1 (Haines 1987) that it extends.
//!
//! * **Objects.** Each animated block (`x`) that holds shapes is an object with one instance, placed where its tracks
//!   and those of the blocks around it put it when the animation starts. A block without a track of its own is an
//!   object too: the file says that it may move. Blocks of one name at one place are one object. Static blocks (`xs`)
//!   become part of the vertices. All that stands in no animated block is one object, the background, without a name;
//!   it is stored as it stands in the world.
//! * **Animated triangles** (`tpa`) change their shape: those of a block are one object beside its rigid one.
//! * **Round shapes** are made of triangles ([`round`]); what a statement gives otherwise stays as it is, with the
//!   polygons cut as those of all formats.
//! * **Includes** are read relative to the file that includes them, gzipped or not, as often as they stand there.
//!   A file that is missing is an error.
//! * **Looks.** A material with a picture on it is another material than without. The colour of the highlight is also
//!   what mirrors ([`looks`]). Pictures are read from `TextureFiles` beside the main file ([`pictures`]) and multiply the
//!   diffuse colour; their first row lies at `v = 0`. The camera, the lights, the background and the ambient light come
//!   along.
//! * **NFF** of other programs may leave away the last numbers of a material, and write more behind it and behind
//!   spheres. Sense8's NFF is another format and is refused.
//! * **Motion** ([`motion`]) is that of the tracks, from key to key, as the benchmark's own programs have it ([`track`]): of
//!   objects, the camera, lights with a name, and animated triangles.
//!
//! The cost is one pass over the text with its includes unfolded, and one over the triangles. How much a file may
//! unfold to is limited ([`budget`]), and so are the depths of includes ([`includes`]) and blocks ([`blocks`]).

mod animation;
mod assemble;
mod blocks;
mod budget;
mod document;
mod includes;
mod keyframes;
mod looks;
mod motion;
mod parse;
mod part;
mod pictures;
mod quaternion;
mod round;
mod shape;
mod tokens;
mod track;

#[cfg(test)]
mod scene_tests;

use super::source::Source;
use crate::{Animated, LoadError, Model};

/// Reads an AFF or NFF file, with what it includes, as at the start of its animation.
pub(crate) fn load(source: &Source) -> Result<Model, LoadError> {
    let document = parse::parse(source)?;
    let time = document.start;
    Ok(assemble::assemble(document, time))
}

/// Reads an AFF or NFF file, with what it includes, and all its motion.
pub(crate) fn load_animated(source: &Source) -> Result<Animated, LoadError> {
    Ok(motion::animated(parse::parse(source)?))
}
