//! Traversal lists in every way in which they can be made, against brute force and against each other.

mod cull;
mod heads;
mod hits;
mod layers;
mod support;
mod update;
