//! What surrounds the scene: a soft studio in place of a sky. Bright above, darker below, a wide lamp where the
//! main light is. It gives form to what the lights do not reach and gives metal something to mirror.

use glam::{Vec2, Vec3};

/// The mean radiance of the upper half, and of the lower half: light thrown back by the floor.
const UPPER: Vec3 = Vec3::new(0.40, 0.44, 0.50);
const LOWER: Vec3 = Vec3::new(0.19, 0.18, 0.17);
/// What a mirror sees at the horizon, overhead, and of the lamp.
const HORIZON: Vec3 = Vec3::new(0.82, 0.85, 0.88);
const ZENITH: Vec3 = Vec3::new(0.36, 0.42, 0.50);
const LAMP: Vec3 = Vec3::new(1.30, 1.26, 1.18);
/// How wide a sharp mirror sees the lamp: one less the cosine to its rim.
pub(crate) const LAMP_SIZE: f32 = 0.10;
/// The background at the top and at the bottom of the picture.
const BACKGROUND_TOP: Vec3 = Vec3::new(0.24, 0.28, 0.33);
const BACKGROUND_BOTTOM: Vec3 = Vec3::new(0.62, 0.635, 0.65);

/// The surroundings of a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Sky {
    pub(crate) up: Vec3,
    /// To the main light.
    pub(crate) key: Vec3,
    /// Where it is set, the radiance from all sides, instead of the studio.
    pub(crate) even: Option<Vec3>,
}

impl Sky {
    /// What the kernel's twin of [`reflected`](Self::reflected) and [`diffuse`](Self::diffuse) computes with.
    pub(crate) const COLORS: [Vec3; 5] = [LOWER, UPPER, HORIZON, ZENITH, LAMP];

    /// With what is up, and the direction to the main light, both of unit length.
    pub(crate) fn new(up: Vec3, key: Vec3) -> Self {
        Self { up, key, even: None }
    }

    /// The mean radiance that a matt surface sees.
    pub(crate) fn diffuse(&self, normal: Vec3) -> Vec3 {
        if let Some(even) = self.even {
            return even;
        }
        LOWER.lerp(UPPER, 0.5 + 0.5 * normal.dot(self.up))
    }

    /// The radiance that a surface of some roughness sees in its mirror direction.
    pub(crate) fn reflected(&self, direction: Vec3, roughness: f32) -> Vec3 {
        if let Some(even) = self.even {
            return even;
        }
        let height = direction.dot(self.up).clamp(-1.0, 1.0);
        let above = HORIZON.lerp(ZENITH, height.max(0.0).sqrt());
        let blur = 0.06 + 0.7 * roughness;
        let sharp = LOWER.lerp(above, smooth_step(-blur, blur, height));
        let lamp_size = LAMP_SIZE + 0.6 * roughness;
        // The wider the lamp is blurred, the fainter.
        let lamp = smooth_step(1.0 - lamp_size, 1.0 - 0.3 * lamp_size, direction.dot(self.key))
            * (LAMP_SIZE / lamp_size);
        sharp.lerp(self.diffuse(direction), roughness * roughness) + LAMP * lamp
    }

    /// What is seen behind everything at a place of the picture, from 0 to 1 both ways.
    pub(crate) fn background(place: Vec2) -> Vec3 {
        let down = place.y * place.y * (3.0 - 2.0 * place.y);
        // A little darker towards the corners: the eye stays with the object.
        let from_middle = (place - Vec2::splat(0.5)).length_squared();
        BACKGROUND_TOP.lerp(BACKGROUND_BOTTOM, down) * (1.0 - 0.22 * from_middle)
    }
}

/// From 0 to 1 between two edges, level at both.
fn smooth_step(from: f32, to: f32, value: f32) -> f32 {
    let share = ((value - from) / (to - from)).clamp(0.0, 1.0);
    share * share * (3.0 - 2.0 * share)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_comes_from_above() {
        let sky = Sky::new(Vec3::Z, Vec3::new(0.6, 0.0, 0.8));
        assert!(sky.diffuse(Vec3::Z).x > sky.diffuse(Vec3::X).x);
        assert!(sky.diffuse(Vec3::X).x > sky.diffuse(Vec3::NEG_Z).x);
        for roughness in [0.0, 0.5, 1.0] {
            let at = |direction: Vec3| sky.reflected(direction, roughness);
            assert!(at(Vec3::new(0.6, 0.0, 0.8)).x > at(Vec3::new(-0.6, 0.0, 0.8)).x, "the lamp is mirrored");
            assert!(at(Vec3::NEG_Z).is_finite() && at(Vec3::NEG_Z).min_element() > 0.0);
        }
        assert!(Sky::background(Vec2::new(0.5, 0.9)).x > Sky::background(Vec2::new(0.5, 0.1)).x);
    }
}
