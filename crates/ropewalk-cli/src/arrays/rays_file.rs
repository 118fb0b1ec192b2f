//! Rays from an `.npy` file: float32 or float64 of either byte order, in C or in Fortran order, shape `(N, 6)` =
//! origin and direction, or `(N, 8)` with `t_min` and `t_max`.
//!
//! The scene's own origin is taken off in f64, before a ray's origin is rounded to f32: rays near a scene that is
//! far from zero keep their accuracy. A file in C order is converted piece by piece while it is read, so that it
//! is never in memory as a whole; a row costs 24 to 64 bytes of reading and 36 bytes of memory.

use super::header::{Header, read_exact};
use crate::failure::Failure;
use glam::DVec3;
use rayon::prelude::*;
use ropewalk::{LARGEST_DIRECTION, Ray, SMALLEST_DIRECTION};
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::{Path, PathBuf};

/// Rows that are read and converted at a time: a few MiB.
const PIECE: usize = 1 << 16;

/// What is done with rays that cannot be traced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum InvalidRays {
    /// The file is refused.
    Refuse,
    /// They are kept; tracing answers them with a miss.
    Keep,
}

/// A file of rays whose header was read and makes sense.
#[derive(Debug)]
pub(crate) struct RaysFile<R> {
    path: PathBuf,
    reader: R,
    layout: Layout,
}

/// How the rows stand in the file.
#[derive(Clone, Copy, Debug)]
struct Layout {
    number: Number,
    rows: usize,
    columns: usize,
    /// Column after column instead of row after row.
    fortran_order: bool,
}

/// What a file held.
#[derive(Debug)]
pub(crate) struct Rays {
    /// The rays, in the space of the scene.
    pub(crate) rays: Vec<Ray>,
    /// How many of them cannot be traced.
    pub(crate) invalid: usize,
    /// Bytes after the last row, which were not looked at.
    pub(crate) unread: u64,
}

impl RaysFile<BufReader<File>> {
    /// Opens a file and checks what it claims to hold.
    pub(crate) fn open(path: &Path) -> Result<Self, Failure> {
        let failure = |what: &dyn std::fmt::Display| Failure::failed(format!("{}: {what}", path.display()));
        let metadata = std::fs::metadata(path).map_err(|error| match error.kind() {
            std::io::ErrorKind::NotFound => failure(&"there is no such file"),
            _ => failure(&error),
        })?;
        if !metadata.is_file() {
            return Err(failure(&"this is no regular file; rays are read from an .npy file"));
        }
        let file = File::open(path).map_err(|error| failure(&error))?;
        Self::new(path, BufReader::with_capacity(1 << 16, file), metadata.len())
            .map_err(|what| failure(&what))
    }
}

impl<R: Read> RaysFile<R> {
    fn new(path: &Path, mut reader: R, file_length: u64) -> Result<Self, String> {
        let header = Header::read(&mut reader)?;
        let layout = Layout::of(&header, file_length)?;
        Ok(Self { path: path.into(), reader, layout })
    }

    /// Reads the rays for a scene whose zero lies at `origin`.
    pub(crate) fn read(mut self, origin: DVec3, invalid_rays: InvalidRays) -> Result<Rays, Failure> {
        let failure = |what: String| Failure::failed(format!("{}: {what}", self.path.display()));
        let rays = self.layout.read(&mut self.reader, origin).map_err(failure)?;
        let invalid = rays.par_iter().filter(|ray| !ray.is_valid()).count();
        if invalid > 0 && invalid_rays == InvalidRays::Refuse {
            let (row, reason) = first_invalid(&rays).unwrap_or((0, "it is not valid"));
            let count = rays.len();
            return Err(failure(format!(
                "{invalid} of {count} rays cannot be traced; the first is row {row}: {reason} \
                 (--allow-invalid-rays answers them with misses)"
            )));
        }
        let unread = std::io::copy(&mut self.reader, &mut std::io::sink()).unwrap_or(0);
        Ok(Rays { rays, invalid, unread })
    }
}

impl Layout {
    fn of(header: &Header, file_length: u64) -> Result<Self, String> {
        let number = Number::of(&header.descr)?;
        let (rows, columns) = match header.shape[..] {
            [rows, 6] => (rows, 6),
            [rows, 8] => (rows, 8),
            _ => return Err(wrong_shape(&header.shape)),
        };
        // What the file claims is believed only when it is that long.
        let bytes = rows.checked_mul((columns * number.size) as u64);
        match (bytes, usize::try_from(rows)) {
            (Some(bytes), Ok(rows)) if bytes <= file_length => {
                Ok(Self { number, rows, columns, fortran_order: header.fortran_order })
            }
            _ => Err(format!("it is cut off: it is too short for its {rows} rows")),
        }
    }

    fn read(self, reader: &mut impl Read, origin: DVec3) -> Result<Vec<Ray>, String> {
        let Self { number, rows, columns, fortran_order } = self;
        let row_bytes = columns * number.size;
        let cut = format!("it is cut off: it ends before the last of its {rows} rows");
        let mut rays = Vec::new();
        rays.try_reserve_exact(rows).map_err(|_| format!("there is no memory for {rows} rays"))?;
        if fortran_order {
            let mut bytes = vec![0; rows * row_bytes];
            read_exact(reader, &mut bytes, &cut)?;
            let element = |row: usize, column: usize| number.read(&bytes, column * rows + row);
            let convert = |row: usize| ray(columns, origin, |column| element(row, column));
            (0..rows).into_par_iter().map(convert).collect_into_vec(&mut rays);
        } else {
            let mut bytes = vec![0; PIECE.min(rows) * row_bytes];
            for first in (0..rows).step_by(PIECE) {
                let piece = &mut bytes[..PIECE.min(rows - first) * row_bytes];
                read_exact(reader, piece, &cut)?;
                let convert = |row: &[u8]| ray(columns, origin, |column| number.read(row, column));
                rays.par_extend(piece.par_chunks_exact(row_bytes).map(convert));
            }
        }
        Ok(rays)
    }
}

fn wrong_shape(shape: &[u64]) -> String {
    let lengths: Vec<String> = shape.iter().map(u64::to_string).collect();
    format!("its shape is ({}); rays have the shape (N, 6) or (N, 8)", lengths.join(", "))
}

fn ray(columns: usize, scene_origin: DVec3, value: impl Fn(usize) -> f64) -> Ray {
    let origin = DVec3::new(value(0), value(1), value(2)) - scene_origin;
    let dir = DVec3::new(value(3), value(4), value(5));
    let ray = Ray::new(origin.as_vec3(), dir.as_vec3());
    if columns == 8 { ray.window(value(6) as f32, value(7) as f32) } else { ray }
}

/// How a number stands in the file.
#[derive(Clone, Copy, Debug)]
struct Number {
    size: usize,
    big_endian: bool,
}

impl Number {
    fn of(descr: &str) -> Result<Self, String> {
        let (order, kind) = descr.split_at_checked(1).unwrap_or(("", descr));
        let big_endian = match order {
            "<" => false,
            ">" => true,
            "=" | "|" => cfg!(target_endian = "big"),
            _ => return Err(wrong_type(descr)),
        };
        match kind {
            "f4" => Ok(Self { size: 4, big_endian }),
            "f8" => Ok(Self { size: 8, big_endian }),
            _ => Err(wrong_type(descr)),
        }
    }

    /// The number at `index`; NaN where the bytes end.
    fn read(self, bytes: &[u8], index: usize) -> f64 {
        let bytes = bytes.get(index * self.size..(index + 1) * self.size).unwrap_or(&[]);
        match (<[u8; 4]>::try_from(bytes), <[u8; 8]>::try_from(bytes)) {
            (Ok(bytes), _) if self.big_endian => f32::from_be_bytes(bytes).into(),
            (Ok(bytes), _) => f32::from_le_bytes(bytes).into(),
            (_, Ok(bytes)) if self.big_endian => f64::from_be_bytes(bytes),
            (_, Ok(bytes)) => f64::from_le_bytes(bytes),
            _ => f64::NAN,
        }
    }
}

fn wrong_type(descr: &str) -> String {
    format!("its numbers are of type '{descr}'; float32 and float64 can be read")
}

fn first_invalid(rays: &[Ray]) -> Option<(usize, &'static str)> {
    let (row, ray) = rays.iter().enumerate().find(|(_, ray)| !ray.is_valid())?;
    let largest = ray.dir.abs().max_element();
    let reason = if !ray.origin.is_finite() {
        "its origin is NaN or infinite"
    } else if !ray.dir.is_finite() {
        "its direction is NaN or infinite"
    } else if largest == 0.0 {
        "its direction is zero"
    } else if !(SMALLEST_DIRECTION..=LARGEST_DIRECTION).contains(&largest) {
        "the largest component of its direction is outside of 2^-60 to 2^60"
    } else if ray.t_max.is_nan() {
        "its t_max is NaN"
    } else {
        "its t_min is negative or NaN"
    };
    Some((row, reason))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn file(descr: &str, fortran_order: bool, shape: &[u64], body: &[u8]) -> Result<Rays, String> {
        file_at(DVec3::ZERO, descr, fortran_order, shape, body)
    }

    fn file_at(
        origin: DVec3,
        descr: &str,
        fortran_order: bool,
        shape: &[u64],
        body: &[u8],
    ) -> Result<Rays, String> {
        let mut bytes = Header { descr: descr.into(), fortran_order, shape: shape.into() }.to_bytes();
        bytes.extend(body);
        let file = RaysFile::new(Path::new("rays.npy"), bytes.as_slice(), bytes.len() as u64)?;
        file.read(origin, InvalidRays::Keep).map_err(|failure| failure.message().to_owned())
    }

    fn numbers<const N: usize>(count: usize, bytes: impl Fn(f64) -> [u8; N]) -> Vec<u8> {
        (0..count).flat_map(|index| bytes(index as f64)).collect()
    }

    #[test]
    fn every_order_and_size_is_the_same_rays() {
        let little = file("<f4", false, &[2, 6], &numbers(12, |x| (x as f32).to_le_bytes())).unwrap();
        assert_eq!(little.rays[1], Ray::new(Vec3::new(6.0, 7.0, 8.0), Vec3::new(9.0, 10.0, 11.0)));
        let big = file(">f4", false, &[2, 6], &numbers(12, |x| (x as f32).to_be_bytes())).unwrap();
        let double = file("<f8", false, &[2, 6], &numbers(12, f64::to_le_bytes)).unwrap();
        let big_double = file(">f8", false, &[2, 6], &numbers(12, f64::to_be_bytes)).unwrap();
        // The value at column c of row r is 6 r + c; in Fortran order it stands at place 2 c + r.
        let turned = numbers(12, |x| (x % 2.0 * 6.0 + (x / 2.0).floor()).to_le_bytes());
        let fortran = file("<f8", true, &[2, 6], &turned).unwrap();
        for other in [big, double, big_double, fortran] {
            assert_eq!(other.rays, little.rays);
        }
    }

    #[test]
    fn windows_are_read_and_the_scene_origin_taken_off_in_f64() {
        let row: Vec<u8> = [1e8 + 0.25, 2.0, 3.0, 0.0, 0.0, 1.0, 0.5, f64::INFINITY]
            .into_iter()
            .flat_map(f64::to_le_bytes)
            .collect();
        let read = file_at(DVec3::new(1e8, 0.0, 0.0), "<f8", false, &[1, 8], &row).unwrap();
        assert_eq!(read.rays, [Ray::new(Vec3::new(0.25, 2.0, 3.0), Vec3::Z).window(0.5, f32::INFINITY)]);
    }

    #[test]
    fn more_rows_than_a_piece_keep_their_order() {
        let rows = PIECE + 3;
        let read =
            file("<f4", false, &[rows as u64, 6], &numbers(rows * 6, |x| (x as f32).to_le_bytes())).unwrap();
        assert_eq!(read.rays.len(), rows);
        assert_eq!(read.rays[rows - 1].origin.x, ((rows - 1) * 6) as f32);
        assert_eq!(read.rays[PIECE].origin.x, (PIECE * 6) as f32);
    }

    #[test]
    fn what_is_no_rays_is_refused() {
        let body = numbers(12, |x| (x as f32).to_le_bytes());
        let refused = |descr: &str, shape: &[u64]| file(descr, false, shape, &body).unwrap_err();
        assert!(refused("<f4", &[12]).contains("(N, 6)"));
        assert!(refused("<f4", &[3, 4]).contains("(3, 4)"));
        assert!(refused("<i4", &[2, 6]).contains("'<i4'"));
        assert!(refused("|O", &[2, 6]).contains("float32"));
        assert!(refused("", &[2, 6]).contains("float32"));
        assert!(refused("\u{e9}f4", &[2, 6]).contains("float32"));
        assert!(refused("<f4", &[3, 6]).contains("cut off"));
        assert!(refused("<f4", &[u64::MAX, 6]).contains("cut off"));
        assert_eq!(file("<f4", false, &[0, 6], &[]).unwrap().rays, []);
        assert_eq!(file("<f4", false, &[1, 6], &body).unwrap().unread, 24);
    }

    #[test]
    fn rays_that_cannot_be_traced_are_counted_and_named() {
        let good = Ray::new(Vec3::ZERO, Vec3::X);
        let named =
            |ray: Ray| first_invalid(&[good, ray, good]).map(|(row, reason)| (row, reason.to_owned()));
        assert_eq!(named(good), None);
        for (ray, reason) in [
            (Ray { dir: Vec3::ZERO, ..good }, "direction is zero"),
            (Ray { dir: Vec3::NAN, ..good }, "direction is NaN"),
            (Ray { dir: Vec3::splat(1e-30), ..good }, "2^-60"),
            (Ray { origin: Vec3::INFINITY, ..good }, "origin"),
            (good.window(-1.0, 1.0), "t_min"),
            (good.window(0.0, f32::NAN), "t_max"),
        ] {
            let (row, told) = named(ray).unwrap();
            assert_eq!(row, 1);
            assert!(told.contains(reason), "{told}");
        }
        let zero = file("<f4", false, &[2, 6], &[0; 48]).unwrap();
        assert_eq!(zero.invalid, 2);
    }
}
