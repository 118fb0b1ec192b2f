//! Rays from an `.npy` file: shape `(N, 6)` = origin and direction, or `(N, 8)` with `t_min` and `t_max`.
//!
//! A row costs 24 to 64 bytes of reading and 36 bytes of memory.

use super::rows::{FileRow, Refusal, Row, RowsFile};
use glam::DVec3;
use ropewalk::{LARGEST_DIRECTION, Ray, SMALLEST_DIRECTION};

/// A file of rays whose header was read and makes sense.
pub(crate) type RaysFile = RowsFile<Ray>;

impl FileRow for Ray {
    const THINGS: &'static str = "rays";
    const COLUMNS: &'static [usize] = &[6, 8];
    const REFUSAL: Refusal =
        Refusal { cannot: "cannot be traced", way_out: "--allow-invalid-rays answers them with misses" };

    fn read(row: &Row<'_>, scene_origin: DVec3) -> Self {
        let ray = Self::new((row.vector(0) - scene_origin).as_vec3(), row.vector(3).as_vec3());
        if row.columns() == 8 { ray.window(row.value(6) as f32, row.value(7) as f32) } else { ray }
    }

    fn defect(&self) -> Option<&'static str> {
        if self.is_valid() {
            return None;
        }
        let largest = self.dir.abs().max_element();
        Some(if !self.origin.is_finite() {
            "its origin is NaN or infinite"
        } else if !self.dir.is_finite() {
            "its direction is NaN or infinite"
        } else if largest == 0.0 {
            "its direction is zero"
        } else if !(SMALLEST_DIRECTION..=LARGEST_DIRECTION).contains(&largest) {
            "the largest component of its direction is outside of 2^-60 to 2^60"
        } else if self.t_max.is_nan() {
            "its t_max is NaN"
        } else {
            "its t_min is negative or NaN"
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::header::Header;
    use super::super::rows::{InvalidRows, PIECE, Rows, first_invalid};
    use super::*;
    use glam::Vec3;
    use std::path::Path;

    fn file(descr: &str, fortran_order: bool, shape: &[u64], body: &[u8]) -> Result<Rows<Ray>, String> {
        file_at(DVec3::ZERO, descr, fortran_order, shape, body)
    }

    fn file_at(
        origin: DVec3,
        descr: &str,
        fortran_order: bool,
        shape: &[u64],
        body: &[u8],
    ) -> Result<Rows<Ray>, String> {
        let mut bytes = Header { descr: descr.into(), fortran_order, shape: shape.into() }.to_bytes();
        bytes.extend(body);
        let file = RowsFile::<Ray, _>::new(Path::new("rays.npy"), bytes.as_slice(), bytes.len() as u64)?;
        file.read(origin, InvalidRows::Keep).map_err(|failure| failure.message().to_owned())
    }

    fn numbers<const N: usize>(count: usize, bytes: impl Fn(f64) -> [u8; N]) -> Vec<u8> {
        (0..count).flat_map(|index| bytes(index as f64)).collect()
    }

    #[test]
    fn every_order_and_size_is_the_same_rays() {
        let little = file("<f4", false, &[2, 6], &numbers(12, |x| (x as f32).to_le_bytes())).unwrap();
        assert_eq!(little.rows[1], Ray::new(Vec3::new(6.0, 7.0, 8.0), Vec3::new(9.0, 10.0, 11.0)));
        let big = file(">f4", false, &[2, 6], &numbers(12, |x| (x as f32).to_be_bytes())).unwrap();
        let double = file("<f8", false, &[2, 6], &numbers(12, f64::to_le_bytes)).unwrap();
        let big_double = file(">f8", false, &[2, 6], &numbers(12, f64::to_be_bytes)).unwrap();
        // The value at column c of row r is 6 r + c; in Fortran order it stands at place 2 c + r.
        let turned = numbers(12, |x| (x % 2.0 * 6.0 + (x / 2.0).floor()).to_le_bytes());
        let fortran = file("<f8", true, &[2, 6], &turned).unwrap();
        for other in [big, double, big_double, fortran] {
            assert_eq!(other.rows, little.rows);
        }
    }

    #[test]
    fn windows_are_read_and_the_scene_origin_taken_off_in_f64() {
        let row: Vec<u8> = [1e8 + 0.25, 2.0, 3.0, 0.0, 0.0, 1.0, 0.5, f64::INFINITY]
            .into_iter()
            .flat_map(f64::to_le_bytes)
            .collect();
        let read = file_at(DVec3::new(1e8, 0.0, 0.0), "<f8", false, &[1, 8], &row).unwrap();
        assert_eq!(read.rows, [Ray::new(Vec3::new(0.25, 2.0, 3.0), Vec3::Z).window(0.5, f32::INFINITY)]);
    }

    #[test]
    fn more_rows_than_a_piece_keep_their_order() {
        let rows = PIECE + 3;
        let read =
            file("<f4", false, &[rows as u64, 6], &numbers(rows * 6, |x| (x as f32).to_le_bytes())).unwrap();
        assert_eq!(read.rows.len(), rows);
        assert_eq!(read.rows[rows - 1].origin.x, ((rows - 1) * 6) as f32);
        assert_eq!(read.rows[PIECE].origin.x, (PIECE * 6) as f32);
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
        assert_eq!(file("<f4", false, &[0, 6], &[]).unwrap().rows, []);
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
