//! The words of a sample on its way to the kernel, and of its light on the way back.
//!
//! | word of an item | what |
//! |---|---|
//! | 0 to 8 | the first ray: origin, start, direction, end, mask |
//! | 9 to 11 | the pixel's column and row, the number of the sample |
//! | 12 to 14 | what the eye sees here when the ray leaves the scene |
//! | 15 | 1 where the ray's hit is known |
//! | 16 to 22 | that hit: t, barycentrics, primitive, geometry, instance, whether the front is hit |
//!
//! | word of an answer | what |
//! |---|---|
//! | 0 to 2 | the light |
//! | 3 to 6 | rays to lights, into the sky, from mirrors, through glass |
//! | 7, 8 | rays cut off by depth, by weight |
//! | 9 | hits whose indices lead nowhere |

use crate::ray_tree::{Followed, Root, Tally};
use glam::Vec3;
use ropewalk::{Hit, Ray, Status};

/// Words of an item.
pub(super) const ITEM_WORDS: usize = 23;
/// Words of an answer.
pub(super) const RESULT_WORDS: usize = 10;

/// The words of a ray.
pub(super) fn ray_words(ray: &Ray) -> [u32; 9] {
    bytemuck::cast(*ray)
}

/// The words of a hit.
pub(super) fn hit_words(hit: &Hit) -> [u32; 7] {
    [
        hit.t.to_bits(),
        hit.barycentrics.x.to_bits(),
        hit.barycentrics.y.to_bits(),
        hit.primitive_index,
        hit.geometry_index,
        hit.instance_index,
        u32::from(hit.front_face),
    ]
}

/// The words of a sample.
pub(super) fn words(root: &Root, is_known: bool) -> [u32; ITEM_WORDS] {
    let mut words = [0; ITEM_WORDS];
    let sample = &root.sample;
    words[..9].copy_from_slice(&ray_words(&root.ray));
    words[9..12].copy_from_slice(&[sample.pixel.0, sample.pixel.1, sample.index]);
    words[12..15].copy_from_slice(&sample.behind.to_array().map(f32::to_bits));
    words[15] = u32::from(is_known);
    words[16..].copy_from_slice(&hit_words(&root.hit));
    words
}

/// Reads an answer, and counts what it counts.
pub(super) fn read(words: &[u32], status: Status, tally: &mut Tally) -> Followed {
    let word = |at: usize| words.get(at).copied().unwrap_or(0);
    let count = |at: usize| u64::from(word(at));
    let lost = count(9);
    tally.shadow_rays += count(3);
    tally.sky_rays += count(4);
    tally.reflected_rays += count(5);
    tally.refracted_rays += count(6);
    tally.cut_by_depth += count(7);
    tally.cut_by_weight += count(8);
    tally.incomplete.count(status);
    if lost > 0 {
        tally.incomplete.count_lost(lost);
    }
    let color = Vec3::from([0, 1, 2].map(|axis| f32::from_bits(word(axis))));
    Followed { color, is_broken: lost > 0 || !status.is_complete() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ray_tree::Sample;

    #[test]
    fn words_stand_where_the_table_says() {
        let ray = Ray::new(Vec3::new(1.0, 2.0, 3.0), Vec3::new(4.0, 5.0, 6.0)).window(0.5, 8.0).with_mask(7);
        let sample = Sample { pixel: (10, 11), index: 12, behind: Vec3::new(13.0, 14.0, 15.0) };
        let words = words(&Root { sample, ray, hit: Hit { t: 2.0, primitive_index: 3, ..Hit::MISS } }, true);
        let bits = |values: &[f32]| values.iter().map(|value| value.to_bits()).collect::<Vec<u32>>();
        assert_eq!(words[..8], bits(&[1.0, 2.0, 3.0, 0.5, 4.0, 5.0, 6.0, 8.0]));
        assert_eq!(words[8..12], [7, 10, 11, 12]);
        assert_eq!(words[12..15], bits(&[13.0, 14.0, 15.0]));
        assert_eq!((words[15], words[16], words[19]), (1, 2.0_f32.to_bits(), 3));
        let mut tally = Tally::default();
        let mut answer = [0, 0, 0, 1, 2, 3, 4, 5, 6, 0];
        answer[1] = 0.5_f32.to_bits();
        let followed = read(&answer, Status::COMPLETE, &mut tally);
        assert_eq!((followed.color, followed.is_broken), (Vec3::new(0.0, 0.5, 0.0), false));
        assert_eq!(
            [tally.shadow_rays, tally.sky_rays, tally.reflected_rays, tally.refracted_rays],
            [1, 2, 3, 4]
        );
        assert_eq!((tally.cut_by_depth, tally.cut_by_weight, tally.incomplete.rays), (5, 6, 0));
        answer[9] = 2;
        assert!(read(&answer, Status::COMPLETE, &mut tally).is_broken);
        assert!(read(&[0; 10], Status::STEP_BUDGET, &mut tally).is_broken);
        assert_eq!((tally.incomplete.no_such_triangle, tally.incomplete.step_budget), (2, 1));
    }
}
