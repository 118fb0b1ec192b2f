//! kd-trees: their shape, and every walk of them against brute force, against a BVH, and against each other.

mod faults;
mod hits;
mod planes;
mod sequence;
mod shape;
mod support;
