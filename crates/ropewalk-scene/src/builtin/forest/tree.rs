//! Trees: limbs as tapered tubes that fork, with leaves on the last of them; and firs, with whorls of boughs.

use super::super::shape::Solid;
use super::super::shape::sweep::walls;
use super::foliage::{Card, Foliage};
use super::{Random, unit_vector};
use glam::{DVec2, DVec3};
use rand::RngExt;
use std::f64::consts::TAU;

/// A tree in the making: its wood is made of closed tubes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tree {
    pub(crate) wood: Solid,
    pub(crate) leaves: Foliage,
}

/// What makes one kind of broad-leaved tree differ from another.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Habit {
    pub(crate) trunk_height: f64,
    pub(crate) trunk_radius: f64,
    /// The share of the trunk below the first limb.
    pub(crate) bare: f64,
    /// How often limbs fork.
    pub(crate) levels: u32,
    /// Limbs on a limb.
    pub(crate) forks: u32,
    /// The angle between a limb and what it grows from, in radians.
    pub(crate) spread: f64,
    /// The length of a limb as a share of what it grows from.
    pub(crate) shortening: f64,
    /// How far limbs wander from their way.
    pub(crate) crooked: f64,
    /// What pulls limbs up, or down when negative.
    pub(crate) rise: f64,
    pub(crate) leaves_per_twig: u32,
    pub(crate) leaf_length: f64,
    pub(crate) bark: u32,
    pub(crate) greens: [u32; 3],
}

/// The middle line of a tube.
struct Limb {
    /// Points and radii.
    line: Vec<(DVec3, f64)>,
}

impl Limb {
    /// Grows from a point in some steps, wandering.
    fn grow(
        (from, radius): (DVec3, f64),
        way: DVec3,
        steps: u32,
        habit: &Habit,
        random: &mut Random,
    ) -> Self {
        let (mut point, mut direction) = (from, way.normalize());
        let mut line = vec![(point, radius)];
        for step in 1..=steps {
            direction += unit_vector(random) * habit.crooked + DVec3::Y * (habit.rise / f64::from(steps));
            direction = direction.normalize();
            point += direction * (way.length() / f64::from(steps));
            line.push((point, radius * (1.0 - 0.72 * f64::from(step) / f64::from(steps))));
        }
        Self { line }
    }

    /// A place along the limb: the point, the direction there and the radius.
    fn at(&self, share: f64) -> (DVec3, DVec3, f64) {
        let place = share.clamp(0.0, 0.999) * (self.line.len() - 1) as f64;
        let index = place as usize;
        let (a, b) = (self.line[index], self.line[index + 1]);
        let rest = place - index as f64;
        (a.0.lerp(b.0, rest), (b.0 - a.0).normalize(), a.1 + (b.1 - a.1) * rest)
    }

    /// The tube around the line, closed by a cone at either end.
    fn tube(&self, solid: &mut Solid, sides: u32, material: u32) {
        tube(solid, &self.line, sides, material);
    }
}

/// A closed tube around a line of points and radii.
pub(crate) fn tube(solid: &mut Solid, line: &[(DVec3, f64)], sides: u32, material: u32) {
    let [first, .., last] = line else { return };
    let direction =
        |i: usize| (line[(i + 1).min(line.len() - 1)].0 - line[i.saturating_sub(1)].0).normalize();
    // Carried along the line, so that the tube does not twist.
    let mut across = direction(0).any_orthonormal_vector();
    let mut rings = Vec::new();
    for (i, &(center, radius)) in line.iter().enumerate() {
        let along = direction(i);
        across = (across - along * across.dot(along)).normalize();
        let up = along.cross(across);
        let points = (0..sides).map(|k| {
            let turn = DVec2::from_angle(TAU * f64::from(k) / f64::from(sides)) * radius;
            center + across * turn.x + up * turn.y
        });
        rings.push(solid.ring(points));
    }
    walls(solid, &rings, material);
    let foot = solid.vertex(first.0 - direction(0) * first.1 * 0.3);
    let tip = solid.vertex(last.0 + direction(line.len() - 1) * last.1);
    if let [bottom, .., top] = rings.as_slice() {
        solid.cone_below(bottom, foot, material);
        solid.cone(top, tip, material);
    }
}

/// A broad-leaved tree, its foot at the origin.
pub(crate) fn broad_leaved(habit: &Habit, random: &mut Random) -> Tree {
    let mut tree = Tree::default();
    let mut trunk = Limb::grow(
        (DVec3::Y * -0.3, habit.trunk_radius),
        DVec3::Y * habit.trunk_height,
        5,
        &Habit { crooked: habit.crooked * 0.4, ..*habit },
        random,
    );
    // Roots widen the foot.
    trunk.line[0].1 *= 1.5;
    trunk.tube(&mut tree.wood, 9, habit.bark);
    let crown = DVec3::Y * (habit.trunk_height * (0.45 + 0.55 * habit.bare));
    let limbs = habit.forks * 2;
    let start = random.random_range(0.0..TAU);
    for i in 0..limbs {
        let share = habit.bare + (1.0 - habit.bare) * (f64::from(i) + 0.5) / f64::from(limbs);
        // The golden angle puts no limb above another one.
        let around = start + 2.399_963 * f64::from(i);
        fork(&mut tree, &trunk, share, around, habit.levels, habit, crown, random);
    }
    fork(&mut tree, &trunk, 0.99, 0.0, habit.levels - 1, &Habit { spread: 0.2, ..*habit }, crown, random);
    tree
}

/// Grows a limb out of another one, and limbs or leaves on it.
#[expect(clippy::too_many_arguments, reason = "a recursion whose state has no better home")]
fn fork(
    tree: &mut Tree,
    parent: &Limb,
    share: f64,
    around: f64,
    levels: u32,
    habit: &Habit,
    crown: DVec3,
    random: &mut Random,
) {
    let (from, along, radius) = parent.at(share);
    let side = along.any_orthonormal_vector();
    let (sin, cos) = around.sin_cos();
    let out = side * cos + along.cross(side) * sin;
    let spread = habit.spread * random.random_range(0.8..1.2);
    let direction = along * spread.cos() + out * spread.sin();
    let length = habit.trunk_height
        * habit.shortening.powi((habit.levels - levels + 1) as i32)
        * random.random_range(0.8..1.15)
        * (1.1 - 0.4 * share);
    // Thin limbs are many: they get fewer sides and bends.
    let limb = Limb::grow((from, radius * 0.62), direction * length, levels + 1, habit, random);
    limb.tube(&mut tree.wood, if levels == 1 { 3 } else { 2 + levels }, habit.bark);
    if levels > 1 {
        for i in 0..habit.forks {
            let share = 0.35 + 0.63 * (f64::from(i) + 0.5) / f64::from(habit.forks);
            let around = around + 2.399_963 * f64::from(i + 1);
            fork(tree, &limb, share, around, levels - 1, habit, crown, random);
        }
    } else {
        for _ in 0..habit.leaves_per_twig {
            let (foot, ..) = limb.at(random.random_range(0.15..1.0));
            leaf(tree, foot, habit, crown, random);
        }
    }
}

fn leaf(tree: &mut Tree, twig: DVec3, habit: &Habit, crown: DVec3, random: &mut Random) {
    let foot = twig + unit_vector(random) * (habit.leaf_length * random.random_range(0.2..1.6));
    let length = habit.leaf_length * random.random_range(0.75..1.3);
    let along = (unit_vector(random) + DVec3::Y * -0.25).normalize() * length;
    let across = along.cross(unit_vector(random)).normalize() * (0.34 * length);
    let outward = (foot - crown).normalize() + DVec3::Y * 0.35;
    let material = habit.greens[random.random_range(0..3)];
    tree.leaves.card(&Card { foot, along, across, fold: 0.25, material }, outward);
}

/// A fir: a straight trunk with whorls of boughs that hang, needles on both sides of each.
pub(crate) fn fir(height: f64, bark: u32, greens: [u32; 3], random: &mut Random) -> Tree {
    let mut tree = Tree::default();
    let radius = |y: f64| 0.028 * (height - y) + 0.012;
    let line: Vec<(DVec3, f64)> = (0..=8)
        .map(|i| height * f64::from(i) / 8.0 - 0.3)
        .map(|y| (DVec3::new(0.03 * (1.7 * y).sin(), y, 0.03 * (2.3 * y).cos()), radius(y)))
        .collect();
    tube(&mut tree.wood, &line, 8, bark);
    let mut y = 0.13 * height;
    let mut turn = 0.0;
    while y < height - 0.35 {
        let reach = (0.30 * (height - y) + 0.12) * random.random_range(0.9..1.1);
        let boughs = 5 + (reach * 1.6) as u32;
        for i in 0..boughs {
            let angle = turn + TAU * (f64::from(i) + random.random_range(-0.15..0.15)) / f64::from(boughs);
            bough(&mut tree, y, angle, reach * random.random_range(0.85..1.1), bark, greens, random);
        }
        turn += 0.7;
        y += 0.18 + 0.065 * (height - y);
    }
    for i in 0..24 {
        let foot = DVec3::Y * (height - 0.4 + 0.025 * f64::from(i));
        needles(&mut tree, foot, DVec3::Y * 0.6, 0.26, greens, random);
    }
    tree
}

/// A bough from the trunk at a height.
fn bough(tree: &mut Tree, y: f64, angle: f64, reach: f64, bark: u32, greens: [u32; 3], random: &mut Random) {
    let out = DVec3::new(angle.cos(), 0.0, angle.sin());
    // It leaves the trunk upwards, bends down under its weight, and looks up again at its tip.
    let at = |share: f64| {
        let drop = reach * (0.10 * share - 0.62 * share * share + 0.26 * share.powi(3));
        DVec3::Y * (y + drop) + out * (reach * share)
    };
    let line: Vec<(DVec3, f64)> = (0..=3)
        .map(|i| f64::from(i) / 3.0)
        .map(|share| (at(share), 0.02 * (1.1 - share) * (0.4 + reach)))
        .collect();
    tube(&mut tree.wood, &line, 3, bark);
    let cards = (7.0 * reach) as u32 + 3;
    for i in 0..cards {
        let share = 0.18 + 0.82 * (f64::from(i) + 0.5) / f64::from(cards);
        let (foot, along) = (at(share), (at(share + 0.05) - at(share)).normalize());
        for side in [-1.0, 1.0] {
            let aside = along.cross(DVec3::Y).normalize() * side;
            needles(
                tree,
                foot,
                along + aside * 0.9 - DVec3::Y * 0.25,
                0.30 * (1.25 - 0.5 * share),
                greens,
                random,
            );
        }
    }
}

fn needles(
    tree: &mut Tree,
    foot: DVec3,
    direction: DVec3,
    length: f64,
    greens: [u32; 3],
    random: &mut Random,
) {
    let along = (direction.normalize() + unit_vector(random) * 0.3).normalize()
        * (length * random.random_range(0.8..1.3));
    let across = along.cross(DVec3::Y + unit_vector(random) * 0.5).normalize() * (0.24 * length);
    let outward = DVec3::new(foot.x, 0.0, foot.z).normalize_or_zero() * 0.7 + DVec3::Y;
    let material = greens[random.random_range(0..3)];
    tree.leaves.card(&Card { foot, along, across, fold: -0.2, material }, outward);
}

/// A fallen log along x, lying on y = 0, its ends sawn.
pub(crate) fn log(length: f64, radius: f64, bark: u32, wood: u32) -> Solid {
    let mut solid = Solid::default();
    let rings: Vec<_> = (0..=6)
        .map(|i| {
            let share = f64::from(i) / 6.0;
            let x = (share - 0.5) * length;
            let size = radius * (1.0 - 0.18 * share);
            let points = (0..14).map(|k| {
                let angle = TAU * f64::from(k) / 14.0;
                let bumpy = size
                    * (1.0 + 0.06 * (3.0 * angle + 2.0 * x).sin() + 0.04 * (5.0 * angle - 3.0 * x).cos());
                DVec3::new(x, radius * 0.8 + bumpy * angle.sin(), -bumpy * angle.cos())
            });
            solid.ring(points.collect::<Vec<_>>())
        })
        .collect();
    walls(&mut solid, &rings, bark);
    if let [first, .., last] = rings.as_slice() {
        let middle = |ring: &[u32], solid: &Solid| {
            ring.iter().map(|&vertex| solid.positions[vertex as usize]).sum::<DVec3>() / ring.len() as f64
        };
        let (near, far) = (middle(first, &solid), middle(last, &solid));
        let near = solid.vertex(near);
        solid.cone_below(first, near, wood);
        let far = solid.vertex(far);
        solid.cone(last, far, wood);
    }
    solid
}

#[cfg(test)]
mod tests {
    use super::super::super::shape::check::volume;
    use super::*;

    #[test]
    fn wood_is_closed() {
        let mut random = super::super::random(7);
        for tree in [broad_leaved(&super::super::OAK, &mut random), fir(7.0, 0, [1, 2, 3], &mut random)] {
            let volume = volume(&tree.wood).unwrap();
            assert!(volume > 0.05 && volume < 20.0, "{volume}");
            assert!(tree.leaves.solid.triangles.len() > 1000);
        }
        assert!((volume(&log(3.0, 0.3, 0, 1)).unwrap() - 0.82 * TAU * 0.045 * 3.0).abs() < 0.1);
    }
}
