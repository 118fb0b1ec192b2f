//! Walks through the packed tree: one ray, and several in turn.
//!
//! A step takes the top of a ray's stack. Of a node all eight boxes are tested at once, and the hit ones pushed in the order of the
//! ray's octant without a branch; of a leaf all triangles. A closer hit
//! removes from the stack what lies behind it, so that what is popped needs no test.

mod batch;
mod boxes;
mod brute_force;
mod instanced;
mod interleave;
mod one_by_one;
mod packet;
mod ray;
mod single;
mod sink;
mod stack;
mod triangles;

pub(super) use boxes::Boxes;
pub(super) use stack::Stack;
