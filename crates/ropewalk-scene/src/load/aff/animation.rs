//! What moves with time: animated blocks by their tracks, animated triangles by their keys.

use super::track::{RotationTrack, VectorTrack, VisibilityTrack};
use glam::{DAffine3, DMat3, DVec3};

/// The tracks of one name, at most one of each kind.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Keyframes {
    pub(super) translation: Option<VectorTrack>,
    pub(super) rotation: Option<RotationTrack>,
    pub(super) scale: Option<VectorTrack>,
    pub(super) visibility: Option<VisibilityTrack>,
}

impl Keyframes {
    /// How many tracks there are.
    pub(super) fn tracks(&self) -> usize {
        [self.translation.is_some(), self.rotation.is_some(), self.scale.is_some(), self.visibility.is_some()]
            .into_iter()
            .filter(|&is_there| is_there)
            .count()
    }

    /// From the space of the block to that around it: scale, then rotation, then translation.
    pub(super) fn transform(&self, time: f64) -> DAffine3 {
        let scale = self.scale.as_ref().map_or(DVec3::ONE, |track| track.at(time));
        let rotation = self.rotation(time).unwrap_or(DMat3::IDENTITY);
        let translation = self.translation.as_ref().map_or(DVec3::ZERO, |track| track.at(time));
        DAffine3::from_mat3_translation(rotation * DMat3::from_diagonal(scale), translation)
    }

    /// The rotation at a time, where there is a track of it.
    pub(super) fn rotation(&self, time: f64) -> Option<DMat3> {
        self.rotation.as_ref().map(|track| track.at(time).to_matrix())
    }

    /// Whether the block is shown at a time.
    pub(super) fn is_visible(&self, time: f64) -> bool {
        self.visibility.as_ref().is_none_or(|track| track.at(time))
    }
}

/// The corners of a triangle, each with its position and normal.
pub(super) type Corners = [(DVec3, DVec3); 3];

/// A triangle whose corners go from key to key in straight lines.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct AnimatedTriangle(pub(super) Vec<(f64, Corners)>);

impl AnimatedTriangle {
    /// The corners at a time; `None` without keys. Normals are interpolated as they are and need not have unit length.
    pub(super) fn at(&self, time: f64) -> Option<Corners> {
        let (Some(&(start, first)), Some(&(_, last))) = (self.0.first(), self.0.last()) else {
            return None;
        };
        if time <= start {
            return Some(first);
        }
        let pair = self.0.windows(2).find_map(|pair| match *pair {
            [from, to] if from.0 <= time && time < to.0 => Some((from, to)),
            _ => None,
        });
        let Some(((start, from), (end, to))) = pair else {
            return Some(last);
        };
        let along = (time - start) / (end - start);
        let between = |one: DVec3, other: DVec3| one + (other - one) * along;
        let [(a, normal_a), (b, normal_b), (c, normal_c)] = from;
        let [(d, normal_d), (e, normal_e), (f, normal_f)] = to;
        Some([
            (between(a, d), between(normal_a, normal_d)),
            (between(b, e), between(normal_b, normal_e)),
            (between(c, f), between(normal_c, normal_f)),
        ])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_go_straight_from_key_to_key() {
        let corners = |at: f64| [(DVec3::splat(at), DVec3::X * (at + 1.0)); 3];
        let triangle = AnimatedTriangle(vec![(0.0, corners(0.0)), (1.0, corners(2.0)), (3.0, corners(4.0))]);
        for (time, at) in
            [(-1.0, 0.0), (0.0, 0.0), (0.5, 1.0), (1.0, 2.0), (2.5, 3.5), (3.0, 4.0), (9.0, 4.0)]
        {
            assert_eq!(triangle.at(time), Some(corners(at)), "{time}");
        }
        assert_eq!(AnimatedTriangle(Vec::new()).at(0.0), None);
        let one = AnimatedTriangle(vec![(1.0, corners(5.0))]);
        assert_eq!((one.at(0.0), one.at(2.0)), (Some(corners(5.0)), Some(corners(5.0))));
    }
}
