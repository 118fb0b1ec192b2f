//! From linear light to the bytes of a picture: exposure, a shoulder for highlights, and the sRGB transfer
//! function of IEC 61966-2-1.

use glam::Vec3;
use std::sync::LazyLock;

/// Values below this leave the shoulder as they came: mid tones are shown as they were computed.
const SHOULDER: f32 = 0.6;

/// Rolls off what is brighter than [`SHOULDER`] towards 1 without a kink, so that highlights keep their form.
pub(crate) fn shoulder(value: f32) -> f32 {
    let over = (value - SHOULDER) / (1.0 - SHOULDER);
    if over > 0.0 { SHOULDER + (1.0 - SHOULDER) * over / (1.0 + over) } else { value }
}

/// What [`shoulder`] makes of each component of an exposed colour.
pub(crate) fn filmic(color: Vec3, exposure: f32) -> Vec3 {
    // 2^stops from f64: correctly rounded on every platform at hand.
    let exposed = color * f64::from(exposure).exp2() as f32;
    Vec3::new(shoulder(exposed.x), shoulder(exposed.y), shoulder(exposed.z))
}

/// The linear value of an sRGB value, both from 0 to 1.
///
/// ```
/// assert_eq!(ropewalk_render::decode_srgb(1.0), 1.0);
/// ```
#[must_use]
pub fn decode_srgb(encoded: f64) -> f64 {
    if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

/// The linear values half-way between neighbouring bytes: 255 thresholds.
static THRESHOLDS: LazyLock<[f32; 255]> =
    LazyLock::new(|| std::array::from_fn(|byte| decode_srgb((byte as f64 + 0.5) / 255.0) as f32));

/// The sRGB byte that is closest to a linear value; what lies outside of 0 to 1, and what is no number, is clamped.
///
/// By bisection in a table of thresholds: exact, and the same on every platform.
///
/// ```
/// use ropewalk_render::encode_srgb8;
/// assert_eq!([0.0, 0.2158605, 1.0, 7.0, -1.0, f32::NAN].map(encode_srgb8), [0, 128, 255, 255, 0, 0]);
/// ```
#[must_use]
pub fn encode_srgb8(linear: f32) -> u8 {
    THRESHOLDS.partition_point(|&threshold| threshold <= linear) as u8
}

/// The linear value of each byte.
static BYTES: LazyLock<[f32; 256]> =
    LazyLock::new(|| std::array::from_fn(|byte| decode_srgb(byte as f64 / 255.0) as f32));

/// One of the two sRGB bytes around a linear value, the upper one where `threshold` is below the value's place
/// between them. With thresholds that differ from pixel to pixel, soft gradients show no bands.
pub(crate) fn dither_srgb8(linear: f32, threshold: f32) -> u8 {
    let above = BYTES.partition_point(|&byte| byte <= linear).min(255);
    let Some(below) = above.checked_sub(1) else { return 0 };
    let place = (linear - BYTES[below]) / (BYTES[above] - BYTES[below]).max(f32::MIN_POSITIVE);
    (if place > threshold { above } else { below }) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_byte_survives_the_round_trip() {
        for byte in 0..=255_u8 {
            assert_eq!(encode_srgb8(decode_srgb(f64::from(byte) / 255.0) as f32), byte);
        }
    }

    #[test]
    fn dithering_is_right_on_the_mean() {
        for linear in [0.0, 0.001, 0.2, 0.5, 0.999, 1.0] {
            let mean =
                (0..1000).map(|i| f32::from(dither_srgb8(linear, (i as f32 + 0.5) / 1000.0))).sum::<f32>()
                    / 1000.0;
            assert!((mean - f32::from(encode_srgb8(linear))).abs() <= 0.51, "{linear}: {mean}");
        }
        for byte in 0..=255_u8 {
            let linear = decode_srgb(f64::from(byte) / 255.0) as f32;
            assert_eq!(dither_srgb8(linear, 0.0), byte, "what is a byte stays one");
        }
        assert_eq!([-1.0, 7.0, f32::NAN].map(|linear| dither_srgb8(linear, 0.5)), [0, 255, 0]);
    }

    #[test]
    fn the_nearest_byte_is_taken() {
        for step in 0..=10_000 {
            let linear = step as f32 / 10_000.0;
            let exact = if linear <= 0.003_130_8 {
                f64::from(linear) * 12.92
            } else {
                1.055 * f64::from(linear).powf(1.0 / 2.4) - 0.055
            };
            let error = (f64::from(encode_srgb8(linear)) - exact * 255.0).abs();
            assert!(error <= 0.501, "{linear}: off by {error}");
        }
    }

    #[test]
    fn the_shoulder_is_smooth_monotone_and_stays_below_one() {
        assert_eq!(shoulder(0.3), 0.3);
        assert_eq!(shoulder(SHOULDER), SHOULDER);
        let slope = (shoulder(SHOULDER + 1e-3) - SHOULDER) / 1e-3;
        assert!((slope - 1.0).abs() < 0.01, "no kink: {slope}");
        let values: Vec<f32> = (0..100).map(|step| shoulder(step as f32 * 0.1)).collect();
        assert!(values.windows(2).all(|pair| pair[0] < pair[1]) && values[99] < 1.0);
        assert!((filmic(Vec3::splat(0.1), 1.0) - Vec3::splat(0.2)).length() < 1e-6);
    }
}
