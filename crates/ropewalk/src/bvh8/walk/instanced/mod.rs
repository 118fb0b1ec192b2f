//! Walks through two levels: a ray's way through the top tree, and inside of an instance through the object's.
//!
//! Each level has a stack of its own, because `t` is bounded otherwise inside an instance ([`crate::two_level::Moving`]). One ray walks
//! the object from inside the walk above ([`alone`]), and so do the rays of a batch one after the other, while the objects fit the
//! cache. Beyond, a batch leads several in turn ([`many`]), as [`super::interleave`] says: each makes a step, of a node or a leaf of the
//! level in which it is ([`course`]).

mod alone;
mod course;
mod find;
mod levels;
mod many;
#[cfg(test)]
mod tests;
mod trace;
