//! Leaves, needles and blades of grass: folded cards of two triangles, seen from both sides.

use super::super::shape::Solid;
use crate::CornerAttribute;
use glam::{DVec3, Vec3};

/// Cards in the making, with a shading normal a vertex.
#[derive(Clone, Debug, Default)]
pub(crate) struct Foliage {
    pub(crate) solid: Solid,
    normals: Vec<Vec3>,
}

/// A card: a kite from its foot along `along`, widest at two fifths of its length.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Card {
    pub(crate) foot: DVec3,
    /// From foot to tip.
    pub(crate) along: DVec3,
    /// From the middle to one side; not parallel to `along`.
    pub(crate) across: DVec3,
    /// How far the sides stand out of the plane, as a share of the breadth.
    pub(crate) fold: f64,
    pub(crate) material: u32,
}

impl Foliage {
    /// Adds a card. Its front looks towards `outward`, as do the normals for the most part: a crown is lit as a
    /// whole, with the leaves as a ripple on it.
    pub(crate) fn card(&mut self, card: &Card, outward: DVec3) {
        let normal = card.along.cross(card.across).normalize_or_zero();
        let (across, normal) =
            if normal.dot(outward) >= 0.0 { (card.across, normal) } else { (-card.across, -normal) };
        let middle = card.foot + card.along * 0.4;
        let lift = normal * (card.fold * across.length());
        let corners = [card.foot, middle - across + lift, card.foot + card.along, middle + across + lift];
        let [foot, right, tip, left] = corners.map(|corner| self.solid.vertex(corner));
        self.solid.triangle([foot, right, tip], card.material);
        self.solid.triangle([foot, tip, left], card.material);
        let shading = (normal * 0.45 + outward.normalize_or_zero() * 0.8).normalize_or_zero().as_vec3();
        self.normals.extend([shading; 4]);
    }

    /// The shading normals.
    pub(crate) fn normals(&self) -> CornerAttribute<Vec3> {
        CornerAttribute { values: self.normals.clone(), indices: None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cards_look_outwards() {
        let mut foliage = Foliage::default();
        for outward in [DVec3::Z, -DVec3::Z, DVec3::new(0.3, 0.1, 0.5)] {
            let card =
                Card { foot: DVec3::ONE, along: DVec3::X, across: DVec3::Y * 0.3, fold: 0.2, material: 0 };
            foliage.card(&card, outward);
            for triangle in foliage.solid.triangles.iter().rev().take(2) {
                let [a, b, c] = triangle.map(|vertex| foliage.solid.positions[vertex as usize]);
                assert!((b - a).cross(c - a).dot(outward) > 0.0);
            }
            let normal = foliage.normals.last().copied().unwrap_or_default();
            assert!(normal.as_dvec3().dot(outward) > 0.0);
        }
    }
}
