//! Answers about points as an `.npz` file.
//!
//! | query | arrays |
//! |---|---|
//! | closest-point | `distance` float32 (inf where nothing is within reach), `point` float64 `(N, 3)` (NaN there), `primitive`, `geometry`, `instance` uint32 (4294967295 there), `uv` float32 `(N, 2)` |
//! | k-nearest | `offsets` uint64 of N + 1, and the arrays of `closest-point`: the answers to point i are those from `offsets[i]` to `offsets[i + 1]`, sorted by `distance` |
//! | signed-distance | the arrays of `closest-point`, with `distance` negative inside, and `normal` float32 `(N, 3)`, outwards (NaN where there is no answer) |
//! | inside | `inside` bool |
//!
//! `point` is float64 in every file: where a scene is stored relative to an origin, the sum of both has more digits
//! than a float32, and a type that depended on the scene would surprise whoever reads the next one. Where nothing was
//! found it is NaN and not zero, which is a place like any other.

use super::npz::NpzWriter;
use glam::{DVec3, Vec3};
use ropewalk::{ClosestPoint, NearestLists, SurfacePoint};
use std::io::{self, Seek, Write};

/// What a batch of points is answered, in the order of the points and in the space of the scene.
#[derive(Clone, Debug)]
pub(crate) enum PointsAnswer {
    /// The closest point of each.
    Closest(Vec<ClosestPoint>),
    /// The nearest points of each.
    Nearest(NearestLists),
    /// The closest point of a closed surface; `None` where there is no answer.
    Signed(Vec<Option<SurfacePoint>>),
    /// Whether each is inside of a closed surface.
    Inside(Vec<bool>),
}

impl PointsAnswer {
    /// How many points have anything within reach; `None` where that was not asked.
    pub(crate) fn found(&self) -> Option<usize> {
        match self {
            Self::Closest(points) => Some(points.iter().filter(|point| point.is_found()).count()),
            Self::Nearest(lists) => Some(lists.offsets.windows(2).filter(|pair| pair[0] < pair[1]).count()),
            Self::Signed(points) => Some(points.iter().flatten().count()),
            Self::Inside(_) => None,
        }
    }

    /// How many points are inside; `None` where that was not asked.
    pub(crate) fn inside(&self) -> Option<usize> {
        match self {
            Self::Closest(_) | Self::Nearest(_) => None,
            Self::Signed(points) => {
                Some(points.iter().flatten().filter(|point| point.signed_distance <= 0.0).count())
            }
            Self::Inside(inside) => Some(inside.iter().filter(|&&inside| inside).count()),
        }
    }
}

/// Writes the answer, for a scene whose zero lies at `origin`.
pub(crate) fn write(writer: impl Write + Seek, origin: DVec3, answer: &PointsAnswer) -> io::Result<()> {
    let mut npz = NpzWriter::new(writer);
    match answer {
        PointsAnswer::Closest(points) => write_points(&mut npz, origin, points, |it| (it.distance, *it))?,
        PointsAnswer::Nearest(lists) => {
            npz.array("offsets", lists.offsets.iter().copied())?;
            write_points(&mut npz, origin, &lists.points, |it| (it.distance, *it))?;
        }
        PointsAnswer::Signed(points) => {
            write_points(&mut npz, origin, points, |it| {
                it.map_or((f32::INFINITY, ClosestPoint::NONE), |it| (it.signed_distance, it.closest))
            })?;
            let normal = |it: &Option<SurfacePoint>| it.map_or(Vec3::NAN, |it| it.normal).to_array();
            npz.rows("normal", points.iter().map(normal))?;
        }
        PointsAnswer::Inside(inside) => npz.array("inside", inside.iter().copied())?,
    }
    npz.finish()
}

/// Writes what all answers have in common: the distance, and the closest point with its triangle.
fn write_points<T>(
    npz: &mut NpzWriter<impl Write + Seek>,
    origin: DVec3,
    answers: &[T],
    parts: impl Fn(&T) -> (f32, ClosestPoint),
) -> io::Result<()> {
    let closest = || answers.iter().map(|answer| parts(answer).1);
    let in_world = |closest: ClosestPoint| {
        let place = if closest.is_found() { origin + closest.point.as_dvec3() } else { DVec3::NAN };
        place.to_array()
    };
    npz.array("distance", answers.iter().map(|answer| parts(answer).0))?;
    npz.rows("point", closest().map(in_world))?;
    npz.array("primitive", closest().map(|closest| closest.primitive_index))?;
    npz.array("geometry", closest().map(|closest| closest.geometry_index))?;
    npz.array("instance", closest().map(|closest| closest.instance_index))?;
    npz.rows("uv", closest().map(|closest| closest.barycentrics.to_array()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec2;
    use npyz::NpyFile;
    use ropewalk::Feature;
    use std::io::{Cursor, Read};

    const FAR: DVec3 = DVec3::new(1e8, 0.0, -1e8);

    struct Archive(zip::ZipArchive<Cursor<Vec<u8>>>);

    impl Archive {
        fn of(answer: &PointsAnswer) -> Self {
            let mut bytes = Cursor::new(Vec::new());
            write(&mut bytes, FAR, answer).unwrap();
            Self(zip::ZipArchive::new(bytes).unwrap())
        }

        fn array<T: npyz::Deserialize>(&mut self, name: &str) -> (Vec<u64>, Vec<T>) {
            let mut bytes = Vec::new();
            self.0.by_name(&format!("{name}.npy")).unwrap().read_to_end(&mut bytes).unwrap();
            let file = NpyFile::new(bytes.as_slice()).unwrap();
            (file.shape().to_vec(), file.into_vec().unwrap())
        }
    }

    fn found() -> ClosestPoint {
        ClosestPoint {
            distance: 2.5,
            point: Vec3::new(0.125, 2.0, -0.25),
            barycentrics: Vec2::new(0.25, 0.5),
            primitive_index: 7,
            geometry_index: 1,
            instance_index: 3,
        }
    }

    #[test]
    fn another_reader_finds_the_closest_points() {
        let answer = PointsAnswer::Closest(vec![found(), ClosestPoint::NONE]);
        assert_eq!((answer.found(), answer.inside()), (Some(1), None));
        let mut file = Archive::of(&answer);
        assert_eq!(file.array("distance"), (vec![2], vec![2.5_f32, f32::INFINITY]));
        let (shape, point) = file.array::<f64>("point");
        assert_eq!((shape, &point[..3]), (vec![2, 3], [1e8 + 0.125, 2.0, -1e8 - 0.25].as_slice()));
        assert!(point[3..].iter().all(|number| number.is_nan()));
        assert_eq!(file.array("primitive"), (vec![2], vec![7, u32::MAX]));
        assert_eq!(file.array("geometry"), (vec![2], vec![1, u32::MAX]));
        assert_eq!(file.array("instance"), (vec![2], vec![3, u32::MAX]));
        assert_eq!(file.array("uv"), (vec![2, 2], vec![0.25_f32, 0.5, 0.0, 0.0]));
        assert_eq!(file.0.len(), 6);
    }

    #[test]
    fn another_reader_finds_the_lists() {
        let answer = PointsAnswer::Nearest(NearestLists { offsets: vec![0, 0, 1], points: vec![found()] });
        assert_eq!((answer.found(), answer.inside()), (Some(1), None));
        let mut file = Archive::of(&answer);
        assert_eq!(file.array("offsets"), (vec![3], vec![0_u64, 0, 1]));
        assert_eq!(file.array("distance"), (vec![1], vec![2.5_f32]));
        assert_eq!(file.0.len(), 7);
    }

    #[test]
    fn another_reader_finds_the_sides() {
        let inside =
            SurfacePoint { signed_distance: -2.5, normal: Vec3::Y, feature: Feature::Edge, closest: found() };
        let answer = PointsAnswer::Signed(vec![Some(inside), None]);
        assert_eq!((answer.found(), answer.inside()), (Some(1), Some(1)));
        let mut file = Archive::of(&answer);
        assert_eq!(file.array("distance"), (vec![2], vec![-2.5_f32, f32::INFINITY]));
        let (shape, normal) = file.array::<f32>("normal");
        assert_eq!((shape, &normal[..3]), (vec![2, 3], [0.0, 1.0, 0.0].as_slice()));
        assert!(normal[3..].iter().all(|number| number.is_nan()));
        assert_eq!(file.array("primitive"), (vec![2], vec![7, u32::MAX]));
        assert_eq!(file.0.len(), 7);

        let answer = PointsAnswer::Inside(vec![true, false, true]);
        assert_eq!((answer.found(), answer.inside()), (None, Some(2)));
        let mut file = Archive::of(&answer);
        assert_eq!(file.array("inside"), (vec![3], vec![true, false, true]));
        assert_eq!(file.0.len(), 1);
    }
}
