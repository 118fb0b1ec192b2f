//! Two levels: the same hits whatever the top level, the bottom structures and the walk; scenes that change; bad input.

mod background;
mod changes;
mod errors;
mod hits;
mod support;
