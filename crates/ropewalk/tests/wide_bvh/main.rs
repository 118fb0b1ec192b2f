//! Wide BVHs: the answers of every walk against the binary tree's, the restart trail against the full stack event by
//! event, trails with known faults that must be found out, and what width saves.

mod deep;
mod faults;
mod hits;
mod recorder;
mod scenes;
mod sequence;
mod work;
