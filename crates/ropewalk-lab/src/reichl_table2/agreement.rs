//! Whether pictures are the same.
//!
//! Two structures over the flattened scene give the same bits. Of two levels rays are rounded otherwise: where a ray grazes an edge
//! or two surfaces lie in one place the last bit decides, and curved mirrors magnify what is left of that from bounce to bounce.
//! Such pixels lie by themselves. A structure that loses triangles, or a walk that does, changes areas.
//!
//! **Measured** at 512 by 512 pixels, two levels beside one kd-tree, pixels that differ by more than [`SHADES`]: of the robots, whose
//! bodies are curved mirrors, 30 of primary shading, 30 with shadows, 1,568 with reflections, and 3,835 of five bounces, which is one
//! in 68; of a car 1; of the kitchen and two chess sets none.

use ropewalk_render::Picture;

/// By how many of 256 shades a pixel must differ so that it shows: one more than what dithering makes of nothing.
const SHADES: u8 = 2;
/// One pixel in so many may differ visibly where no ray is mirrored, and where some are.
const ONE_IN: [usize; 2] = [500, 40];

/// How many pixels differ visibly; or what is wrong where there are too many of them for pictures with mirrors or without.
pub(super) fn compare(expected: &Picture, given: &Picture, has_mirrors: bool) -> Result<usize, String> {
    let size = |picture: &Picture| (picture.film.width, picture.film.height);
    if size(expected) != size(given) || expected.partial || given.partial {
        return Err("the pictures are not of one size, or not finished".into());
    }
    let incomplete = given.statistics.incomplete;
    if !incomplete.is_none() {
        return Err(incomplete.to_string());
    }
    let one_in = ONE_IN[usize::from(has_mirrors)];
    compare_shades(&expected.to_srgb8(), &given.to_srgb8(), expected.film.width as usize, one_in)
}

fn compare_shades(expected: &[u8], given: &[u8], width: usize, one_in: usize) -> Result<usize, String> {
    let differs = |(a, b): (&[u8], &[u8])| a.iter().zip(b).any(|(a, b)| a.abs_diff(*b) > SHADES);
    let pixels = || expected.chunks_exact(3).zip(given.chunks_exact(3));
    let different = pixels().filter(|&pair| differs(pair)).count();
    let count = expected.len() / 3;
    // Of a picture of a few pixels one may differ.
    if different > (count / one_in).max(1) {
        let first = pixels().position(differs).unwrap_or(0);
        let of = |picture: &[u8]| picture.get(3 * first..3 * first + 3).unwrap_or_default().to_vec();
        return Err(format!(
            "{different} of {count} pixels differ; the first is {},{}: {:?}, not {:?}",
            first % width.max(1),
            first / width.max(1),
            of(given),
            of(expected)
        ));
    }
    Ok(different)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Single pixels may differ; an area may not.
    #[test]
    fn a_wrong_picture_is_noticed() {
        let right: Vec<u8> = (0..100 * 100 * 3).map(|index| (index % 251) as u8).collect();
        assert_eq!(compare_shades(&right, &right, 100, 200), Ok(0));
        let with = |pixels: usize, step: u8| {
            let mut wrong = right.clone();
            wrong[3000..3000 + 3 * pixels].iter_mut().for_each(|shade| *shade = shade.wrapping_add(step));
            compare_shades(&right, &wrong, 100, 200)
        };
        assert_eq!(with(9000, 2), Ok(0), "no eye sees that");
        assert_eq!(with(50, 100), Ok(50));
        let why = with(51, 100).unwrap_err();
        assert!(why.contains("51 of 10000") && why.contains("0,10"), "{why}");
    }
}
