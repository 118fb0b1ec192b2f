//! Arrays in numpy's file formats: rays in (`.npy`), hits out (`.npz`).

pub(crate) mod header;
pub(crate) mod hits_file;
pub(crate) mod npz;
pub(crate) mod rays_file;
