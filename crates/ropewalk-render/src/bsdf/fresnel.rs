//! How much a surface mirrors at an angle: Fresnel's equations for glass, Schlick's curve (1994) for all else.

use glam::{Vec2, Vec3};

/// The share of light that the border of two clear media mirrors, by Fresnel's equations for unpolarised light.
///
/// `cos` is the cosine to the normal, from 0 to 1; `eta` the index of refraction on this side over that on the
/// other. 1 where all of it is mirrored (total internal reflection), 0 where the two are the same medium.
pub(crate) fn fresnel_of_border(cos: f32, eta: f32) -> f32 {
    if eta == 1.0 {
        return 0.0;
    }
    let square = sine_behind_squared(cos, eta);
    if square >= 1.0 {
        return 1.0;
    }
    let cos_behind = (1.0 - square).sqrt();
    let across = (eta * cos - cos_behind) / (eta * cos + cos_behind);
    let along = (eta * cos_behind - cos) / (eta * cos_behind + cos);
    let both = Vec2::new(across, along);
    both.dot(both) * 0.5
}

/// The share that is mirrored at normal incidence.
pub(crate) fn fresnel_at_normal(eta: f32) -> f32 {
    let share = (eta - 1.0) / (eta + 1.0);
    share * share
}

/// The squared sine, behind the border, of a ray whose cosine on this side is `cos` (Snell's law); 1 and more where
/// there is no such ray.
pub(crate) fn sine_behind_squared(cos: f32, eta: f32) -> f32 {
    eta * eta * ((1.0 - cos) * (1.0 + cos))
}

/// The direction behind the border of a ray along the unit vector `dir`, which comes to the side that the unit
/// normal points to; `None` where all light is mirrored.
pub(crate) fn refract(dir: Vec3, normal: Vec3, eta: f32) -> Option<Vec3> {
    // Unbent to the bit: thin glass must not shift what is behind it.
    if eta == 1.0 {
        return Some(dir);
    }
    let cos = (-dir.dot(normal)).clamp(0.0, 1.0);
    let square = sine_behind_squared(cos, eta);
    if square >= 1.0 {
        return None;
    }
    let along = eta * cos - (1.0 - square).sqrt();
    Some(super::arithmetic::unit(super::arithmetic::sum_of_two(dir, eta, normal, along)))
}

/// Schlick's curve: `at_normal` for a ray along the normal, rising to `grazing` where that is more.
pub(crate) fn schlick(at_normal: Vec3, grazing: f32, cos: f32) -> Vec3 {
    let rest = 1.0 - cos.clamp(0.0, 1.0);
    let square = rest * rest;
    let fifth = square * square * rest;
    at_normal + (Vec3::splat(grazing) - at_normal).max(Vec3::ZERO) * fifth
}

/// The mean of [`schlick`] over the hemisphere, weighed with the cosine.
pub(crate) fn schlick_mean(at_normal: Vec3, grazing: f32) -> Vec3 {
    at_normal + (Vec3::splat(grazing) - at_normal).max(Vec3::ZERO) * (1.0 / 21.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn glass_mirrors_as_fresnel_says() {
        // Along the normal 4 percent from both sides; at Brewster's angle half of one polarisation.
        for eta in [1.5_f32, 1.0 / 1.5] {
            assert!((fresnel_of_border(1.0, eta) - 0.04).abs() < 1e-6);
            assert!((fresnel_at_normal(eta) - 0.04).abs() < 1e-6);
        }
        let brewster = 1.5_f32.atan();
        let across = (1.5_f32.powi(2) - 1.0) / (1.5_f32.powi(2) + 1.0);
        assert!((fresnel_of_border(brewster.cos(), 1.0 / 1.5) - 0.5 * across * across).abs() < 1e-6);
        assert!((fresnel_of_border(0.0, 1.0 / 1.5) - 1.0).abs() < 1e-6);
        assert_eq!(fresnel_of_border(0.0, 1.0), 0.0);
    }

    #[test]
    fn all_light_is_mirrored_from_the_critical_angle_on() {
        for ior in [1.1_f32, 1.5, 2.4] {
            let critical = (1.0 / ior).asin();
            for (angle, is_total) in [(critical - 1e-3, false), (critical + 1e-3, true)] {
                let dir = Vec3::new(angle.sin(), 0.0, -angle.cos());
                assert_eq!(refract(dir, Vec3::Z, ior).is_none(), is_total, "{ior} at {angle}");
                assert_eq!(fresnel_of_border(angle.cos(), ior) == 1.0, is_total, "{ior} at {angle}");
                // From outside there is no such angle.
                assert!(refract(dir, Vec3::Z, 1.0 / ior).is_some());
            }
        }
    }

    #[test]
    fn snells_law_holds_and_the_way_back_is_the_way() {
        for ior in [1.0_f32, 1.2, 1.5, 2.4] {
            for step in 0..90 {
                let angle = (step as f32).to_radians();
                let dir = Vec3::new(angle.sin(), 0.0, -angle.cos());
                let into = refract(dir, Vec3::Z, 1.0 / ior).unwrap();
                assert!((into.length() - 1.0).abs() < 1e-6);
                assert!((into.x * ior - dir.x).abs() < 1e-6, "{ior} at {step}");
                let back = refract(-into, Vec3::NEG_Z, ior).unwrap();
                assert!(back.distance(-dir) < 2e-3 && (step > 80 || back.distance(-dir) < 1e-5));
                // What goes in from one side is what goes in from the other.
                let (front, behind) =
                    (fresnel_of_border(angle.cos(), 1.0 / ior), fresnel_of_border(-into.z, ior));
                assert!((front - behind).abs() < 1e-4 + 0.02 * f32::from(step > 85), "{front} and {behind}");
            }
        }
        let dir = Vec3::new(0.6, 0.1, -0.7);
        assert_eq!(refract(dir, Vec3::Z, 1.0), Some(dir), "not even rounded");
    }

    #[test]
    fn the_mean_of_schlick_is_its_integral() {
        let (at_normal, grazing) = (Vec3::new(0.04, 0.5, 1.0), 0.9);
        let count = 10_000;
        let mut sum = Vec3::ZERO;
        for step in 0..count {
            // The square of the cosine is even when directions are weighed with the cosine.
            let cos = ((step as f32 + 0.5) / count as f32).sqrt();
            sum += schlick(at_normal, grazing, cos) / count as f32;
        }
        assert!(sum.distance(schlick_mean(at_normal, grazing)) < 1e-4, "{sum}");
        assert_eq!(schlick(at_normal, grazing, 1.0), at_normal);
        assert_eq!(schlick(at_normal, grazing, 0.0), Vec3::new(0.9, 0.9, 1.0));
    }
}
