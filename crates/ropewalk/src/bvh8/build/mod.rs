//! Builders of eight-wide trees, and what they share: [`reference`] has what they sort instead of triangles, [`draft`] how
//! the binary splits of a small range become wide nodes.
//!
//! Every builder makes a [`super::tree::Tree`], the same one for any number of threads and on any processor.

pub(crate) mod binned;
#[cfg(test)]
pub(crate) mod check;
pub(crate) mod draft;
pub(crate) mod extent;
pub(crate) mod morton;
pub(crate) mod reference;
pub(crate) mod reinserted;
