//! Where samples lie: in a pixel, on a light, in the sky. Fixed patterns, no random numbers: the same picture
//! every time, on every machine.
//!
//! **In a pixel.** The canonical correlated multi-jittered pattern (Kensler 2013, without its shuffles): `n * n`
//! cells, one sample in each, and no two samples share a row or a column of the `n * n` by `n * n` grid, so an
//! edge close to an axis is drawn with `n * n` shades and not with `n`.
//!
//! **On lights and in the sky.** A Hammersley set over the samples of a pixel, shifted from pixel to pixel along
//! Roberts' R2 and R3 lattices. Neighbouring pixels get shifts that lie far apart, so that what noise is left is
//! fine-grained. The shifts are whole numbers modulo 2^32: exact everywhere.

use glam::{Vec2, Vec3};

/// Half the width of the filter, in pixels: a tent that reaches this far on either side of the pixel's middle.
/// The box filter (0.5, flat) shows stairs on slanted edges, a tent of 1.0 is soft; this lies between.
const FILTER_RADIUS: f32 = 0.8;

/// The place of sample `index` of `side * side`, in pixels from the pixel's corner. Samples are placed as the
/// filter weighs, so their plain mean is the filtered value.
pub(crate) fn subpixel(index: u32, side: u32) -> Vec2 {
    let n = side as f32;
    let (i, j) = ((index % side) as f32, (index / side) as f32);
    let x = (i + (j + 0.5) / n) / n;
    let y = (j + (i + 0.5) / n) / n;
    Vec2::new(0.5 + FILTER_RADIUS * tent(x), 0.5 + FILTER_RADIUS * tent(y))
}

/// Takes the unit interval to `[-1, 1]`, spread like a tent.
fn tent(uniform: f32) -> f32 {
    if uniform < 0.5 { (2.0 * uniform).sqrt() - 1.0 } else { 1.0 - (2.0 - 2.0 * uniform).sqrt() }
}

/// What a family of samples is for: each has its own lattice, or they would be correlated.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Purpose {
    /// The disc of a light.
    Light,
    /// The sky.
    Sky,
}

/// A point of the unit square: number `index` of `count`, for one pixel.
pub(crate) fn point(purpose: Purpose, pixel: (u32, u32), index: u32, count: u32) -> Vec2 {
    // The fractions, times 2^32, of the powers of the plastic number and of its three-dimensional sister.
    let lattice: [[u32; 2]; 2] = match purpose {
        Purpose::Sky => [[0xc13f_a9a9, 0x91e1_0da5], [0xd1b5_4a32, 0xabc9_8388]],
        Purpose::Light => [[0x91e1_0da5, 0xc13f_a9a9], [0x8cb9_2ba7, 0xd1b5_4a32]],
    };
    let shift = |[x, y]: [u32; 2]| pixel.0.wrapping_mul(x).wrapping_add(pixel.1.wrapping_mul(y));
    Vec2::new(
        unit(along(index, count).wrapping_add(shift(lattice[0]))),
        unit(index.reverse_bits().wrapping_add(shift(lattice[1]))),
    )
}

/// The middle of part `index` of `count`, as a fraction of 2^32, in words that a GPU has: a long division with two
/// digits of 16 bits. A count above 65,536 counts as that; there are at most 5,120 samples of a pixel.
fn along(index: u32, count: u32) -> u32 {
    let count = count.clamp(1, 1 << 16);
    let first = ((index % count) << 16) + (1 << 15);
    let second = (first % count) << 16;
    ((first / count) << 16) + second / count
}

/// A number from 0 to 1, below 1: number `index` for one pixel, evenly spread over both.
pub(crate) fn fraction(pixel: (u32, u32), index: u32) -> f32 {
    // The golden ratio along the index; R2, turned, from pixel to pixel.
    let shift = pixel.1.wrapping_mul(0xc13f_a9a9).wrapping_sub(pixel.0.wrapping_mul(0x91e1_0da5));
    unit(index.wrapping_mul(0x9e37_79b9).wrapping_add(shift))
}

/// A whole number as a fraction of 2^32, below 1.
pub(crate) fn unit(bits: u32) -> f32 {
    // 24 bits are what a f32 holds exactly.
    (bits >> 8) as f32 * (1.0 / 16_777_216.0)
}

/// The point on the unit circle a given turn along, from polynomials: `sin` and `cos` of the platform may differ
/// in the last bit, and a stored picture would then fit one platform only.
fn circle(turn: f32) -> Vec2 {
    let quarters = turn * 4.0;
    let quarter = quarters.floor();
    // The angle within its quarter, from the quarter's middle: -0.5 to 0.5 quarters.
    let angle = (quarters - quarter - 0.5) * std::f32::consts::FRAC_PI_2;
    let square = angle * angle;
    let cos = 1.0 - square * (0.5 - square * (1.0 / 24.0));
    let sin = angle * (1.0 - square * (1.0 / 6.0 - square * (1.0 / 120.0)));
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let (x, y) = ((cos - sin) * half, (cos + sin) * half);
    match quarter as i32 & 3 {
        0 => Vec2::new(x, y),
        1 => Vec2::new(-y, x),
        2 => Vec2::new(-x, -y),
        _ => Vec2::new(y, -x),
    }
}

/// Spreads the unit square evenly over the unit disc.
pub(crate) fn disc(square: Vec2) -> Vec2 {
    circle(square.y) * square.x.sqrt()
}

/// A direction of the hemisphere around `normal`, more often near the normal, as the cosine weighs.
pub(crate) fn cosine_direction(normal: Vec3, square: Vec2) -> Vec3 {
    let disc = disc(square);
    let (tangent, bitangent) = frame(normal);
    let height = (1.0 - disc.length_squared()).max(0.0).sqrt();
    tangent * disc.x + bitangent * disc.y + normal * height
}

/// Two unit vectors that make a right-handed frame with a unit vector (Duff et al. 2017).
pub(crate) fn frame(normal: Vec3) -> (Vec3, Vec3) {
    let sign = 1.0_f32.copysign(normal.z);
    let a = -1.0 / (sign + normal.z);
    let b = normal.x * normal.y * a;
    (
        Vec3::new(1.0 + sign * normal.x * normal.x * a, sign * b, -sign * normal.x),
        Vec3::new(b, sign + normal.y * normal.y * a, -normal.y),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn subpixels_are_stratified_around_the_middle() {
        assert_eq!(subpixel(0, 1), Vec2::splat(0.5));
        for side in [2_u32, 3, 4, 7] {
            let count = side * side;
            let mut columns: Vec<f32> = (0..count).map(|index| subpixel(index, side).x).collect();
            let mean = columns.iter().sum::<f32>() / count as f32;
            assert!((mean - 0.5).abs() < 1e-5, "{side}: {mean}");
            columns.sort_by(f32::total_cmp);
            assert!(columns.windows(2).all(|pair| pair[0] < pair[1]), "no two samples share a column");
        }
    }

    #[test]
    fn the_division_in_words_is_exact() {
        for count in (1..70).chain([81, 255, 1000, 1024, 4096, 5119, 65_535, 65_536]) {
            for index in (0..count).step_by(1 + count as usize / 100).chain([count - 1, count, 3 * count + 1])
            {
                let wide = ((u64::from(index) << 32) + (1 << 31)) / u64::from(count);
                assert_eq!(along(index, count), wide as u32, "{index} of {count}");
            }
        }
    }

    #[test]
    fn the_circle_is_one() {
        for step in 0..1000 {
            let turn = step as f32 / 1000.0;
            let (sin, cos) = (turn * std::f32::consts::TAU).sin_cos();
            assert!(circle(turn).distance(Vec2::new(cos, sin)) < 1e-3, "{turn}");
        }
    }

    #[test]
    fn directions_lie_in_the_hemisphere_and_follow_the_cosine() {
        for normal in [Vec3::Y, -Vec3::Z, Vec3::new(0.6, 0.0, -0.8), Vec3::new(-0.36, 0.48, 0.8)] {
            let mut mean = 0.0;
            for index in 0..256 {
                let direction = cosine_direction(normal, point(Purpose::Sky, (3, 8), index, 256));
                assert!((direction.length() - 1.0).abs() < 2e-3, "{direction}");
                assert!(direction.dot(normal) >= -1e-6);
                mean += direction.dot(normal) / 256.0;
            }
            assert!((mean - 2.0 / 3.0).abs() < 0.01, "the mean cosine is two thirds, not {mean}");
        }
    }

    #[test]
    fn a_frame_is_orthonormal() {
        for normal in [Vec3::X, Vec3::Y, Vec3::Z, -Vec3::Z, Vec3::new(0.6, -0.48, 0.64)] {
            let (a, b) = frame(normal);
            assert!((a.length() - 1.0).abs() < 1e-5 && (b.length() - 1.0).abs() < 1e-5);
            assert!(a.dot(b).abs() < 1e-5 && (a.cross(b) - normal).length() < 1e-5);
        }
    }
}
