//! Points from an `.npy` file: shape `(N, 3)` = x, y, z, or `(N, 4)` with the largest distance.
//!
//! A row costs 12 to 32 bytes of reading and 20 bytes of memory.

use super::rows::{FileRow, Refusal, Row, RowsFile};
use glam::DVec3;
use ropewalk::PointQuery;
use ropewalk::point::LARGEST_POINT;

/// A file of points whose header was read and makes sense.
pub(crate) type PointsFile = RowsFile<PointQuery>;

impl FileRow for PointQuery {
    const THINGS: &'static str = "points";
    const COLUMNS: &'static [usize] = &[3, 4];
    const REFUSAL: Refusal = Refusal {
        cannot: "have no answer",
        way_out: "--allow-invalid-points answers them as if nothing was there",
    };

    fn read(row: &Row<'_>, scene_origin: DVec3) -> Self {
        let point = Self::new((row.vector(0) - scene_origin).as_vec3());
        if row.columns() == 4 { point.within(row.value(3) as f32) } else { point }
    }

    fn defect(&self) -> Option<&'static str> {
        if self.is_valid() {
            return None;
        }
        Some(if !self.point.is_finite() {
            "a coordinate is NaN or infinite"
        } else if self.point.abs().max_element() > LARGEST_POINT {
            "a coordinate is beyond 2^60"
        } else {
            "its largest distance is negative or NaN"
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::header::Header;
    use super::super::rows::{InvalidRows, Rows, first_invalid};
    use super::*;
    use glam::Vec3;
    use std::path::Path;

    fn file(
        origin: DVec3,
        descr: &str,
        fortran_order: bool,
        shape: &[u64],
        body: &[u8],
    ) -> Result<Rows<PointQuery>, String> {
        let mut bytes = Header { descr: descr.into(), fortran_order, shape: shape.into() }.to_bytes();
        bytes.extend(body);
        let file = RowsFile::<PointQuery, _>::new(Path::new("points.npy"), &*bytes, bytes.len() as u64)?;
        file.read(origin, InvalidRows::Keep).map_err(|failure| failure.message().to_owned())
    }

    #[test]
    fn both_orders_are_the_same_points() {
        let rows: Vec<u8> = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0].into_iter().flat_map(f64::to_le_bytes).collect();
        let columns: Vec<u8> =
            [1.0f32, 4.0, 2.0, 5.0, 3.0, 6.0].into_iter().flat_map(f32::to_be_bytes).collect();
        let points = [1.0, 4.0].map(|x| PointQuery::new(Vec3::new(x, x + 1.0, x + 2.0)));
        assert_eq!(file(DVec3::ZERO, "<f8", false, &[2, 3], &rows).unwrap().rows, points);
        assert_eq!(file(DVec3::ZERO, ">f4", true, &[2, 3], &columns).unwrap().rows, points);
    }

    #[test]
    fn distances_are_read_and_the_scene_origin_taken_off_in_f64() {
        let row: Vec<u8> = [2.0, 1e8 + 0.25, 3.0, 0.5].into_iter().flat_map(f64::to_le_bytes).collect();
        let read = file(DVec3::new(0.0, 1e8, 0.0), "<f8", false, &[1, 4], &row).unwrap();
        assert_eq!(read.rows, [PointQuery::new(Vec3::new(2.0, 0.25, 3.0)).within(0.5)]);
    }

    #[test]
    fn what_is_no_points_is_refused() {
        let refused = |shape: &[u64]| file(DVec3::ZERO, "<f4", false, shape, &[0; 48]).unwrap_err();
        assert!(refused(&[2, 6]).contains("(2, 6); points have the shape (N, 3) or (N, 4)"));
        assert!(refused(&[12]).contains("(N, 3)"));
        assert!(refused(&[5, 3]).contains("cut off"));
        assert!(file(DVec3::ZERO, "<u4", false, &[4, 3], &[0; 48]).unwrap_err().contains("'<u4'"));
    }

    #[test]
    fn points_without_an_answer_are_named() {
        let good = PointQuery::new(Vec3::new(LARGEST_POINT, 0.0, -0.0)).within(0.0);
        let named = |point| first_invalid(&[good, point, good]);
        assert_eq!(named(good), None);
        for (point, reason) in [
            (PointQuery::new(Vec3::new(0.0, f32::NAN, 0.0)), "NaN"),
            (PointQuery::new(Vec3::new(0.0, 0.0, f32::NEG_INFINITY)), "infinite"),
            (PointQuery::new(Vec3::splat(1e30)), "2^60"),
            (good.within(-1.0), "distance"),
            (good.within(f32::NAN), "distance"),
        ] {
            assert!(!point.is_valid());
            let (row, told) = named(point).unwrap();
            assert!(row == 1 && told.contains(reason), "{told}");
        }
    }
}
