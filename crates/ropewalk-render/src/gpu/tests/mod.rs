//! The kernel's parts and the whole of it against the CPU, bit for bit, and damaged kernels that must be noticed.

mod damages;
mod machine;
mod parts;
mod scene;
mod trees;
