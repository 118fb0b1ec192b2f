//! What a list may leave out: triangles of one side of which no ray of the list's directions sees the front.
//!
//! A ray sees the front of a triangle when its direction `d` runs against the normal `n`: `d . n < 0`. The directions of a
//! list form a cone, so all of them run along the normal when those of its edges do.
//!
//! * Eight lists: the cone is an octant, and the condition that no component of `n` has another sign. A closed condition: an
//!   axis-aligned face is left out of four lists of eight. One normal of 8 satisfies it.
//! * Six lists: the edges are `(±axis, ±1, ±1)`, so that the component along the axis must be at least the sum of the two
//!   others' magnitudes. That is `4 acos(-1/3) - 2 pi` of the sphere, 10.82 % of all normals, and not the sixth part of
//!   which the paper speaks: its rule, the largest component, takes a cone for its own dual, and loses hits
//!   (ALGORITHMS: C3; measured there: 0.198 % of the pairs of a direction and a normal in front of it).
//! * Two lists: the half-space leaves only the two normals along its axis. One list: none.
//!
//! **To the bit.** Rays are asked by [`FlatTriangle::intersect_front`], which adds the products of the direction's and the
//! normal's components. Where all are known to be positive or zero, so is the sum, however rounded. For six lists one product
//! outweighs the two others; it comes last, and rounding is monotone, so it outweighs their rounded sum, too: faces at 45
//! degrees need no margin. The condition is asked of every normal by which the test may go.

use super::{Cull, Directions, along};
use crate::FlatTriangle;
use glam::Vec3;

/// What one list leaves out.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hidden {
    cull: Cull,
    directions: Directions,
    /// The direction of the list.
    along: Vec3,
}

impl Hidden {
    pub(super) fn new(cull: Cull, directions: Directions, list: usize) -> Self {
        Self { cull, directions, along: along(directions)[list] }
    }

    /// Whether the list leaves a triangle out.
    pub(super) fn hides(&self, triangle: &FlatTriangle) -> bool {
        match self.cull {
            Cull::None => false,
            Cull::Exact => triangle
                .normals()
                .into_iter()
                .all(|normal| goes_with_all(self.directions, self.along, normal)),
            Cull::AsPrinted => {
                let [normal, ..] = triangle.normals();
                is_of(self.directions, self.along, normal)
            }
        }
    }
}

/// Whether no direction of the list that is ordered along `along` runs against a normal.
pub(super) fn goes_with_all(directions: Directions, along: Vec3, normal: Vec3) -> bool {
    let with = normal * along;
    match directions {
        Directions::One => false,
        Directions::Two => with.x >= 0.0 && normal.y == 0.0 && normal.z == 0.0,
        Directions::Six => {
            let others = (normal * (Vec3::ONE - along.abs())).abs().element_sum();
            with.element_sum() >= others
        }
        Directions::Eight => with.min_element() >= 0.0,
    }
}

/// Whether a normal belongs to the set of directions itself.
fn is_of(directions: Directions, along: Vec3, normal: Vec3) -> bool {
    let with = normal * along;
    match directions {
        Directions::One => false,
        Directions::Two => with.x > 0.0,
        Directions::Six => with.element_sum() > 0.0 && with.element_sum() >= normal.abs().max_element(),
        Directions::Eight => with.min_element() >= 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::traversal_list::list_of;
    use crate::triangle::{permute, slope};
    use crate::{PreparedRay, Ray};

    /// The shares of evenly spread normals, which are solid angles.
    #[test]
    fn each_rule_leaves_out_its_solid_angle() {
        // A spiral over the sphere.
        let count = 40_000;
        let normals: Vec<Vec3> = (0..count)
            .map(|index| {
                let z = 1.0 - f64::from(2 * index + 1) / f64::from(count);
                let (sin, cos) = (f64::from(index) * 2.399_963_229_728_653).sin_cos();
                let radius = (1.0 - z * z).sqrt();
                Vec3::new((cos * radius) as f32, (sin * radius) as f32, z as f32)
            })
            .collect();
        let share = |directions: Directions, rule: fn(Directions, Vec3, Vec3) -> bool| {
            let lists = along(directions);
            let all: usize = lists
                .iter()
                .map(|&along| normals.iter().filter(|&&normal| rule(directions, along, normal)).count())
                .sum();
            all as f64 / (count as usize * lists.len()) as f64
        };
        let near = |share: f64, expected: f64| {
            assert!((share - expected).abs() < 1e-3, "{share} is not {expected}");
        };
        let cone = 4.0 * (-1.0_f64 / 3.0).acos() - std::f64::consts::TAU;
        near(share(Directions::Six, goes_with_all), cone / (4.0 * std::f64::consts::PI));
        near(share(Directions::Six, goes_with_all), 0.1082);
        near(share(Directions::Eight, goes_with_all), 0.125);
        near(share(Directions::Six, is_of), 1.0 / 6.0);
        near(share(Directions::One, goes_with_all), 0.0);
        near(share(Directions::Two, goes_with_all), 0.0);
    }

    /// No direction of a list runs against a normal that the list leaves out; by the printed rule some do.
    #[test]
    fn the_exact_rule_leaves_out_nothing_that_is_seen_and_the_printed_one_does() {
        let mut state = 11u32;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / (1 << 23) as f32 - 1.0
        };
        // Components that are often equal or zero.
        let mut component = move || match next() {
            x if x < -0.5 => 0.0,
            x if x < -0.2 => 1.0,
            x if x < 0.1 => -1.0,
            x => x * 2.0 - 1.1,
        };
        let (mut culled, mut lost) = (0, 0);
        for _ in 0..200_000 {
            let mut vector = || Vec3::new(component(), component(), component());
            let (dir, normal) = (vector(), vector());
            let Some(ray) = PreparedRay::new(&Ray::new(Vec3::ZERO, dir)) else { continue };
            for directions in [Directions::Two, Directions::Six, Directions::Eight] {
                let along = along(directions)[list_of(directions, &ray)];
                if goes_with_all(directions, along, normal) {
                    culled += 1;
                    let slope = slope(&ray, permute(&ray, &normal.to_array()).into());
                    let along = if ray.forward { slope } else { -slope };
                    assert!(along >= 0.0, "{directions:?}: {dir} {normal}");
                }
                lost += usize::from(is_of(directions, along, normal) && dir.dot(normal) < 0.0);
            }
        }
        assert!(culled > 1000 && lost > 100, "{culled} culled, {lost} lost by the printed rule");
    }
}
