//! Sets of directions, each with a list of its own (Toczek 2010, figure 2), and the list of a ray.

use super::Directions;
use crate::PreparedRay;
use glam::Vec3;

/// The directions along which lists are ordered. List `i` serves the rays of which [`list_of`] says so.
#[must_use]
pub fn along(directions: Directions) -> Vec<Vec3> {
    let sign = |list: usize, axis: usize| if list >> axis & 1 == 0 { 1.0 } else { -1.0 };
    match directions {
        Directions::One => vec![Vec3::X],
        Directions::Two => vec![Vec3::X, Vec3::NEG_X],
        Directions::Six => Vec3::AXES.into_iter().flat_map(|axis| [axis, -axis]).collect(),
        Directions::Eight => {
            (0..8).map(|list| Vec3::new(sign(list, 0), sign(list, 1), sign(list, 2))).collect()
        }
    }
}

/// The list that serves a ray: of 2, that of its sign along x; of 6, that of its largest component; of 8, that of its
/// signs. Each direction has exactly one; zero counts as positive, and of equal components the first is the largest.
#[inline(always)]
#[must_use]
pub fn list_of(directions: Directions, ray: &PreparedRay) -> usize {
    let negative = ray.negative().map(usize::from);
    match directions {
        Directions::One => 0,
        Directions::Two => negative[0],
        Directions::Six => 2 * usize::from(ray.axes[2]) + usize::from(!ray.forward),
        Directions::Eight => negative[0] | negative[1] << 1 | negative[2] << 2,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Ray;

    fn list(lists: Directions, dir: Vec3) -> usize {
        list_of(lists, &PreparedRay::new(&Ray::new(Vec3::ZERO, dir)).unwrap())
    }

    #[test]
    fn each_direction_has_its_list() {
        for (_, lists) in Directions::NAMES.iter().copied() {
            let all = along(lists);
            assert_eq!(all.len(), lists.lists());
            for (index, &along) in all.iter().enumerate() {
                assert_eq!(list(lists, along * 3.0), index, "{lists:?}: {along}");
                // Little beside it.
                assert_eq!(list(lists, along + Vec3::new(0.1, 0.2, -0.1)), index, "{lists:?}: {along}");
            }
        }
    }

    #[test]
    fn zeros_and_ties_have_one_too() {
        assert_eq!(list(Directions::Eight, Vec3::new(-0.0, 1.0, -1.0)), 4);
        assert_eq!(list(Directions::Eight, Vec3::new(0.0, -0.0, 1.0)), 0);
        assert_eq!(list(Directions::Two, Vec3::new(-0.0, -1.0, 0.0)), 0);
        assert_eq!(list(Directions::Six, Vec3::new(-1.0, 1.0, 1.0)), 1);
        assert_eq!(list(Directions::Six, Vec3::new(0.5, -1.0, 1.0)), 3);
    }

    /// A ray of a list goes along its direction, not against it.
    #[test]
    fn a_list_is_ordered_along_its_rays() {
        let mut state = 5u32;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / (1 << 23) as f32 - 1.0
        };
        for lists in [Directions::Two, Directions::Six, Directions::Eight] {
            let all = along(lists);
            for _ in 0..2000 {
                let dir = Vec3::new(next(), next(), next());
                assert!(dir.dot(all[list(lists, dir)]) >= 0.0, "{lists:?}: {dir}");
            }
        }
    }
}
