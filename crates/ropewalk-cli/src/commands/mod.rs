//! The commands: a file each, with its arguments, its examples and what it prints.

pub(crate) mod bench;
pub(crate) mod complete;
pub(crate) mod info;
pub(crate) mod lab;
pub(crate) mod list;
pub(crate) mod points;
pub(crate) mod render;
pub(crate) mod trace;
pub(crate) mod verify;
pub(crate) mod welcome;
