//! Arrays in numpy's file formats: rays and points in (`.npy`), hits and answers out (`.npz`).

pub(crate) mod answers_file;
pub(crate) mod header;
pub(crate) mod hits_file;
pub(crate) mod npz;
pub(crate) mod points_file;
pub(crate) mod rays_file;
pub(crate) mod rows;
