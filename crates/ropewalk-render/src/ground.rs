//! A ground that catches the shadow of a model that has none of its own.
//!
//! It is real geometry, one large quad just below the model, so that every device and walk treats it like
//! anything else. It is drawn as the background, darkened where light or sky do not reach it: nothing of it is
//! seen but the shadow. Towards its rim the darkening fades, so no edge is ever seen.
//!
//! Its instance carries the single mask bit [`MASK`]: views that show data, and cameras below it, leave that bit
//! out of their rays.

use crate::error::RenderError;
use crate::sampling;
use crate::stage::for_each_point;
use glam::{Vec2, Vec3};
use ropewalk::{Instance, Mesh, Scene, Transform};
use ropewalk_scene::{Material, MaterialAssignment, Model, Surface};
use std::fmt;
use std::str::FromStr;

/// The mask bit of the ground.
pub(crate) const MASK: u32 = 0x80;
/// The quad reaches this many times the model's own radius and height.
const REACH: f32 = 4.0;
/// The share of the reach up to which shadows are whole.
const WHOLE: f32 = 0.45;
/// The gap below the model as a share of its size: unseen, and far above what rounding moves.
const GAP: f32 = 1.0 / 4096.0;

/// Whether there is a ground to catch shadows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Ground {
    /// Always.
    On,
    /// Never.
    Off,
    /// Where the model has none of its own.
    #[default]
    Auto,
}

impl Ground {
    const EVERY: [Self; 3] = [Self::On, Self::Off, Self::Auto];
}

impl fmt::Display for Ground {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(match self {
            Self::On => "on",
            Self::Off => "off",
            Self::Auto => "auto",
        })
    }
}

impl FromStr for Ground {
    type Err = RenderError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Self::EVERY
            .into_iter()
            .find(|ground| ground.to_string() == text)
            .ok_or_else(|| RenderError::Word(format!("the ground can be on, off or auto, not '{text}'")))
    }
}

/// Where the added ground is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Catcher {
    pub(crate) instance: u32,
    pub(crate) center: Vec3,
    up: Vec3,
    pub(crate) reach: f32,
}

impl Catcher {
    /// How much of a shadow is drawn at a point of the ground: 1 near the model, 0 at the rim.
    pub(crate) fn strength(&self, point: Vec3) -> f32 {
        let share = point.distance(self.center) / self.reach;
        let fade = ((1.0 - share) / (1.0 - WHOLE)).clamp(0.0, 1.0);
        fade * fade * (3.0 - 2.0 * fade)
    }

    /// Whether an eye looks at the ground from its upper side.
    pub(crate) fn is_seen_from(&self, eye: Vec3) -> bool {
        (eye - self.center).dot(self.up) > 0.0
    }
}

/// The extents of a scene along up and two level directions.
struct Extents {
    axes: [Vec3; 3],
    low: Vec3,
    high: Vec3,
}

impl Extents {
    fn of(scene: &Scene, up: Vec3) -> Self {
        let (a, b) = sampling::frame(up);
        let axes = [a, b, up];
        let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for_each_point(scene, scene.instances.len(), |point| {
            let place = Vec3::from(axes.map(|axis| point.dot(axis)));
            low = low.min(place);
            high = high.max(place);
        });
        Self { axes, low, high }
    }

    fn level(&self, place: Vec3) -> Vec2 {
        Vec2::new(place.dot(self.axes[0]), place.dot(self.axes[1]))
    }
}

/// Whether a scene stands on a ground of its own: level triangles at its very bottom cover half of its plan, and
/// what rises above them does not reach as far as they do.
///
/// When in doubt there is none: a ground below a ground is hidden by it.
pub(crate) fn has_ground(scene: &Scene, up: Vec3) -> bool {
    let extents = Extents::of(scene, up);
    let size = extents.high - extents.low;
    let bottom = extents.low.z + 0.02 * size.z;
    let mut level_area = 0.0_f64;
    let (mut low, mut high) = (Vec2::INFINITY, Vec2::NEG_INFINITY);
    let mut corners = Vec::with_capacity(3);
    for_each_point(scene, scene.instances.len(), |point| {
        corners.push(point);
        if let [a, b, c] = corners[..] {
            let heights = [a, b, c].map(|corner| corner.dot(up));
            if heights.iter().all(|&height| height <= bottom) {
                // The area of the triangle's plan: what stands upright has none.
                level_area += f64::from((b - a).cross(c - a).dot(up).abs()) * 0.5;
            } else if heights.iter().any(|&height| height > extents.low.z + 0.1 * size.z) {
                for place in [a, b, c].map(|corner| extents.level(corner)) {
                    low = low.min(place);
                    high = high.max(place);
                }
            }
            corners.clear();
        }
    });
    let plan = f64::from(size.x) * f64::from(size.y);
    let risen = (high - low).max(Vec2::ZERO);
    level_area >= 0.5 * plan && f64::from(risen.x) * f64::from(risen.y) <= 0.85 * plan
}

/// Adds the ground as the last object and instance of a model that is not empty.
pub(crate) fn add(model: &mut Model, up: Vec3) -> Catcher {
    let extents = Extents::of(&model.scene, up);
    let size = extents.high - extents.low;
    let middle = (extents.low + extents.high) * 0.5;
    let largest = extents.low.abs().max(extents.high.abs()).max_element();
    let length = size.length().max(largest * 1e-4).max(1e-6);
    let height = extents.low.z - (length * GAP).max(largest * 4e-6);
    let center = extents.axes[0] * middle.x + extents.axes[1] * middle.y + up * height;
    let reach = REACH * (0.5 * size.x.hypot(size.y) + size.z).max(length * 0.5);
    let corner = |x: f32, y: f32| center + (extents.axes[0] * x + extents.axes[1] * y) * reach;
    let quad = vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
    let object = model.scene.add_object(Mesh::new(quad, vec![[0, 1, 2], [0, 2, 3]]));
    let instance = model.scene.instances.len() as u32;
    model.scene.instances.push(Instance { mask: MASK, ..Instance::new(object, Transform::IDENTITY) });
    let material = model.materials.len() as u32;
    model.materials.push(Material { name: "ground".into(), ..Material::default() });
    model.surfaces.push(vec![Surface { materials: MaterialAssignment::One(material), ..Surface::default() }]);
    if !model.object_names.is_empty() {
        model.object_names.push("ground".into());
    }
    Catcher { instance, center, up, reach }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Stage, StageOptions};

    fn cube(scene: &mut Scene, low: Vec3, high: Vec3) {
        let points = (0..8)
            .map(|corner| {
                let pick = |axis: usize| if corner >> axis & 1 == 0 { low[axis] } else { high[axis] };
                Vec3::new(pick(0), pick(1), pick(2))
            })
            .collect();
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        let object = scene.add_object(Mesh::new(points, triangles));
        scene.add_instance(object, Transform::IDENTITY);
    }

    fn plate(scene: &mut Scene, half: f32, height: f32) {
        let points = [(-half, -half), (-half, half), (half, half), (half, -half)];
        let points = points.map(|(x, z)| Vec3::new(x, height, z)).to_vec();
        let object = scene.add_object(Mesh::new(points, vec![[0, 1, 2], [0, 2, 3]]));
        scene.add_instance(object, Transform::IDENTITY);
    }

    #[test]
    fn a_ground_is_told_from_a_flat_bottom() {
        let mut alone = Scene::default();
        cube(&mut alone, Vec3::new(-1.0, 0.0, -1.0), Vec3::ONE);
        assert!(!has_ground(&alone, Vec3::Y), "the bottom of a cube is no ground");
        let mut standing = alone.clone();
        plate(&mut standing, 4.0, 0.0);
        assert!(has_ground(&standing, Vec3::Y));
        assert!(!has_ground(&standing, Vec3::Z), "seen with another up it is a wall");
        let mut hovering = alone.clone();
        plate(&mut hovering, 4.0, 0.5);
        assert!(!has_ground(&hovering, Vec3::Y));
        let mut room = Scene::default();
        cube(&mut room, Vec3::new(-9.0, 0.0, -9.0), Vec3::new(9.0, 5.0, 9.0));
        assert!(!has_ground(&room, Vec3::Y));
        assert!(!has_ground(&Scene::default(), Vec3::Y));
    }

    #[test]
    fn the_added_ground_lies_below_and_comes_last() {
        for (up, offset) in [(Vec3::Y, 0.0), (Vec3::Z, 0.0), (Vec3::Y, 1e5), (Vec3::new(0.6, 0.8, 0.0), 3.0)]
        {
            let mut scene = Scene::default();
            let low = Vec3::splat(offset);
            cube(&mut scene, low, low + Vec3::new(2.0, 3.0, 1.0));
            let model = Model { scene, ..Model::default() };
            let stage = Stage::new(model, &StageOptions { up: Some(up), ..Default::default() });
            let catcher = stage.catcher().expect("a cube has no ground");
            assert_eq!(catcher.instance, 1);
            let ground = &stage.scene().objects[1].geometries[0];
            let mut lowest = f32::INFINITY;
            stage.for_each_point(|point| lowest = lowest.min((point - catcher.center).dot(up)));
            assert!(lowest > 0.0 && lowest < 2.0, "{up}: the model stands {lowest} above the ground");
            assert!(ground.positions.iter().all(|corner| (*corner - catcher.center).dot(up).abs() < 0.05));
            let normal = ground.triangle(0).unwrap().normal();
            assert!(normal.normalize().dot(up) > 0.99, "its front is up");
            assert_eq!(catcher.strength(catcher.center), 1.0);
            assert_eq!(catcher.strength(catcher.center + ground.positions[0] - ground.positions[1]), 0.0);
            assert!(catcher.is_seen_from(catcher.center + up) && !catcher.is_seen_from(catcher.center - up));
        }
    }

    #[test]
    fn words_are_read_back() {
        for ground in Ground::EVERY {
            assert_eq!(ground.to_string().parse::<Ground>().unwrap(), ground);
        }
        assert!("yes".parse::<Ground>().unwrap_err().to_string().contains("on, off or auto"));
    }
}
