//! A colour ramp for heat maps: dark violet, blue, green, yellow, white.
//!
//! Built in OKLab (Ottosson 2020), where equal steps look equal: lightness rises evenly from end to end, so the
//! map still reads when it is printed in grey, and hue only helps.

use glam::Vec3;

/// Lightness, and the two colour axes a (green to red) and b (blue to yellow), at equal distances.
const ANCHORS: [Vec3; 6] = [
    Vec3::new(0.18, 0.030, -0.060),
    Vec3::new(0.34, 0.020, -0.130),
    Vec3::new(0.50, -0.060, -0.070),
    Vec3::new(0.66, -0.110, 0.060),
    Vec3::new(0.82, -0.060, 0.140),
    Vec3::new(0.97, -0.010, 0.040),
];

/// The linear colour of a value from 0 to 1; what lies outside is clamped.
pub(crate) fn color(value: f32) -> Vec3 {
    let last = ANCHORS.len() - 1;
    let place = if value.is_nan() { 0.0 } else { value.clamp(0.0, 1.0) * last as f32 };
    let index = (place as usize).min(last - 1);
    oklab_to_linear(ANCHORS[index].lerp(ANCHORS[index + 1], place - index as f32))
        .clamp(Vec3::ZERO, Vec3::ONE)
}

/// Linear sRGB of an OKLab colour; components may leave 0 to 1.
pub(crate) fn oklab_to_linear(lab: Vec3) -> Vec3 {
    let l = lab.x + 0.396_337_78 * lab.y + 0.215_803_76 * lab.z;
    let m = lab.x - 0.105_561_346 * lab.y - 0.063_854_17 * lab.z;
    let s = lab.x - 0.089_484_18 * lab.y - 1.291_485_5 * lab.z;
    let (l, m, s) = (l * l * l, m * m * m, s * s * s);
    Vec3::new(
        4.076_741_7 * l - 3.307_711_6 * m + 0.230_969_94 * s,
        -1.268_438 * l + 2.609_757_4 * m - 0.341_319_4 * s,
        -0.004_196_086 * l - 0.703_418_6 * m + 1.707_614_7 * s,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grey_is_grey() {
        let grey = oklab_to_linear(Vec3::new(0.6, 0.0, 0.0));
        assert!((grey - Vec3::splat(0.216)).abs().max_element() < 1e-4, "{grey}");
    }

    #[test]
    fn luminance_rises_and_the_anchors_are_displayable() {
        for lab in ANCHORS {
            let linear = oklab_to_linear(lab);
            assert!(linear.min_element() > -0.02 && linear.max_element() < 1.02, "{lab} is {linear}");
        }
        let luminance = |value| color(value).dot(Vec3::new(0.2126, 0.7152, 0.0722));
        let values: Vec<f32> = (0..=100).map(|step| luminance(step as f32 / 100.0)).collect();
        assert!(values.windows(2).all(|pair| pair[0] < pair[1]), "{values:?}");
        assert_eq!(color(f32::NAN), color(0.0));
        assert_eq!(color(7.0), color(1.0));
    }
}
