//! What the ratios should be: the paper's figures, bands that a correct walk keeps to, and reference measurements.

use ropewalk::Builder;
use ropewalk_testkit::rays::RayClass;

/// Between which ratios a short stack of a size should lie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Band {
    /// Entries of the short stack.
    pub short_stack: u32,
    /// The smallest ratio.
    pub low: f64,
    /// The largest ratio.
    pub high: f64,
}

const fn band(short_stack: u32, low: f64, high: f64) -> Band {
    Band { short_stack, low, high }
}

/// The ratios that Laine 2010 gives for Fairy Forest and Conference: rounded, over several views, with leaves and rays
/// that the paper does not name.
pub const PUBLISHED: [Band; 3] = [band(0, 2.2, 2.4), band(1, 1.3, 1.4), band(3, 1.05, 1.08)];

/// The ratios that scenes, leaf caps and rays of all kinds keep to: few nodes and early ends make them small,
/// leaves of one triangle large.
pub const WANTED: [Band; 4] = [band(0, 1.6, 3.2), band(1, 1.1, 1.7), band(3, 1.0, 1.14), band(8, 1.0, 1.005)];

/// Whether a ratio lies in its band; `None` where there is no band for that size. The ends are rounded to two places,
/// and so is the ratio.
#[must_use]
pub fn is_within(bands: &[Band], short_stack: u32, ratio: f64) -> Option<bool> {
    let band = bands.iter().find(|band| band.short_stack == short_stack)?;
    Some(ratio >= band.low - 0.005 && ratio <= band.high + 0.005)
}

/// Ratios of another implementation for the same scene, kind of tree and class of rays. Its rays are not known to the
/// ray, so that its absolute counts need not come back; ratios should, nearly.
#[derive(Clone, Copy, Debug)]
pub struct Reference {
    /// Triangles of the scene, a ground included: what tells scenes apart whatever their files are called.
    pub triangles: usize,
    /// What made the tree.
    pub builder: Builder,
    /// Its leaf cap.
    pub max_leaf: u32,
    /// The rays.
    pub class: RayClass,
    /// Inner visits a ray of the full stack.
    pub inner_visits: Option<f64>,
    /// Size of the stack and ratio of the inner visits.
    pub ratios: &'static [(u32, f64)],
}

const fn reference(
    triangles: usize,
    builder: Builder,
    max_leaf: u32,
    class: RayClass,
    inner_visits: Option<f64>,
    ratios: &'static [(u32, f64)],
) -> Reference {
    Reference { triangles, builder, max_leaf, class, inner_visits, ratios }
}

const BUNNY: usize = 69_451;
const BUNNY_ON_GROUND: usize = 69_453;
const KITCHEN: usize = 56_939;
const SPONZA: usize = 66_447;

use Builder::{Sbvh, SweepSah};
use RayClass::{AmbientOcclusion, DiffuseBounce, Primary};

/// Measured with single-threaded prototypes, whose hits were checked against brute force, over full-sweep SAH trees.
pub const REFERENCE: [Reference; 14] = [
    reference(
        BUNNY_ON_GROUND,
        SweepSah,
        8,
        Primary,
        Some(4.5),
        &[(0, 1.62), (1, 1.18), (2, 1.08), (3, 1.03), (4, 1.01), (5, 1.0), (8, 1.0)],
    ),
    reference(
        BUNNY_ON_GROUND,
        SweepSah,
        8,
        DiffuseBounce,
        Some(7.1),
        &[(0, 1.77), (1, 1.21), (2, 1.08), (3, 1.035), (4, 1.014), (5, 1.005), (8, 1.0)],
    ),
    reference(
        BUNNY,
        SweepSah,
        1,
        Primary,
        Some(5.3),
        &[(0, 2.13), (1, 1.25), (2, 1.11), (3, 1.05), (4, 1.02), (8, 1.0)],
    ),
    reference(
        BUNNY,
        SweepSah,
        1,
        AmbientOcclusion,
        Some(6.8),
        &[(0, 2.15), (1, 1.32), (2, 1.10), (3, 1.03), (4, 1.01), (8, 1.0)],
    ),
    reference(
        BUNNY,
        SweepSah,
        1,
        DiffuseBounce,
        Some(7.8),
        &[(0, 2.25), (1, 1.37), (2, 1.14), (3, 1.06), (4, 1.03), (8, 1.0)],
    ),
    reference(
        KITCHEN,
        SweepSah,
        8,
        Primary,
        Some(26.6),
        &[(0, 1.95), (1, 1.24), (2, 1.09), (3, 1.033), (4, 1.009), (5, 1.002), (8, 1.0)],
    ),
    reference(
        KITCHEN,
        SweepSah,
        8,
        AmbientOcclusion,
        Some(20.9),
        &[(0, 1.74), (1, 1.17), (2, 1.05), (3, 1.017), (4, 1.004), (5, 1.0), (8, 1.0)],
    ),
    reference(
        KITCHEN,
        SweepSah,
        8,
        DiffuseBounce,
        Some(33.1),
        &[(0, 2.04), (1, 1.29), (2, 1.10), (3, 1.042), (4, 1.015), (5, 1.005), (8, 1.0)],
    ),
    reference(
        KITCHEN,
        SweepSah,
        1,
        Primary,
        Some(30.6),
        &[(0, 2.48), (1, 1.46), (2, 1.20), (3, 1.087), (4, 1.04), (5, 1.015), (8, 1.001)],
    ),
    reference(
        KITCHEN,
        SweepSah,
        1,
        DiffuseBounce,
        Some(37.5),
        &[(0, 2.53), (1, 1.49), (2, 1.20), (3, 1.082), (4, 1.04), (5, 1.015), (8, 1.001)],
    ),
    reference(
        KITCHEN,
        Sbvh,
        8,
        Primary,
        Some(23.6),
        &[(0, 1.85), (1, 1.22), (2, 1.06), (3, 1.014), (4, 1.003), (5, 1.001), (8, 1.0)],
    ),
    reference(
        KITCHEN,
        Sbvh,
        8,
        DiffuseBounce,
        Some(26.2),
        &[(0, 1.92), (1, 1.24), (2, 1.07), (3, 1.020), (4, 1.003), (5, 1.001), (8, 1.0)],
    ),
    reference(
        SPONZA,
        SweepSah,
        4,
        Primary,
        Some(34.8),
        &[(0, 2.11), (1, 1.33), (2, 1.11), (3, 1.049), (5, 1.009), (8, 1.0)],
    ),
    reference(
        SPONZA,
        SweepSah,
        4,
        DiffuseBounce,
        Some(35.6),
        &[(0, 2.19), (1, 1.33), (2, 1.12), (3, 1.048), (5, 1.007), (8, 1.0)],
    ),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ratio_outside_is_told_from_one_inside() {
        assert_eq!(is_within(&WANTED, 0, 2.3), Some(true));
        assert_eq!(is_within(&WANTED, 0, 3.3), Some(false));
        assert_eq!(is_within(&WANTED, 0, 1.5), Some(false));
        assert_eq!(is_within(&WANTED, 3, 1.2), Some(false));
        assert_eq!(is_within(&WANTED, 8, 1.02), Some(false));
        assert_eq!(is_within(&WANTED, 2, 9.0), None);
        assert_eq!(is_within(&PUBLISHED, 1, 1.35), Some(true));
        assert_eq!(is_within(&PUBLISHED, 1, 1.45), Some(false));
    }

    #[test]
    fn the_reference_keeps_its_own_bands() {
        for reference in &REFERENCE {
            for &(short_stack, ratio) in reference.ratios {
                assert_ne!(is_within(&WANTED, short_stack, ratio), Some(false), "{reference:?}");
            }
        }
    }
}
