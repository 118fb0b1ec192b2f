//! Spheres and cones as triangles.
//!
//! Both have 32 sides. A circle and its polygon of 32 sides are 0.5% of the radius apart at most: less than a pixel
//! where the circle is 400 pixels wide, as wide as the few round things of the benchmark get. Normals are those of the
//! true surface, so that only outlines show the sides. A sphere takes 960 triangles, a cylinder 64.

use super::shape::{Shape, Values};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

const SIDES: u32 = 32;

/// A sphere; a negative radius turns it inside out. `None` for one of radius 0.
pub(super) fn sphere(center: DVec3, radius: f64) -> Option<Shape> {
    const RINGS: u32 = SIDES / 2;
    if radius == 0.0 {
        return None;
    }
    let mut normals = vec![DVec3::Y];
    for ring in 1..RINGS {
        let (sine, cosine) = (PI * f64::from(ring) / f64::from(RINGS)).sin_cos();
        normals.extend((0..SIDES).map(|side| around(side, DVec3::Z, DVec3::X) * sine + DVec3::Y * cosine));
    }
    let south = normals.len() as u32;
    normals.push(DVec3::NEG_Y);
    let vertex = |ring: u32, side: u32| match ring {
        0 => 0,
        RINGS => south,
        _ => 1 + (ring - 1) * SIDES + side % SIDES,
    };
    let mut triangles = Vec::with_capacity((2 * SIDES * (RINGS - 1)) as usize);
    for (ring, side) in (0..RINGS).flat_map(|ring| (0..SIDES).map(move |side| (ring, side))) {
        let (a, b) = (vertex(ring, side), vertex(ring, side + 1));
        let (c, d) = (vertex(ring + 1, side), vertex(ring + 1, side + 1));
        if ring > 0 {
            triangles.push([a, c, b]);
        }
        if ring + 1 < RINGS {
            triangles.push([b, c, d]);
        }
    }
    let positions = normals.iter().map(|normal| center + *normal * radius.abs()).collect();
    Some(faced(positions, normals, triangles, radius < 0.0))
}

/// The side of a cone, cut off or not, or of a cylinder; negative radii turn it inside out. `None` without length or
/// width.
pub(super) fn cone(base: DVec3, base_radius: f64, apex: DVec3, apex_radius: f64) -> Option<Shape> {
    let length = base.distance(apex);
    let along = (apex - base).try_normalize()?;
    let (low, high) = (base_radius.abs(), apex_radius.abs());
    if low == 0.0 && high == 0.0 {
        return None;
    }
    let (x, y) = along.any_orthonormal_pair();
    let mut shape = (Vec::new(), Vec::new(), Vec::new());
    for side in 0..SIDES {
        let outward = around(side, x, y);
        shape.0.extend([base + outward * low, apex + outward * high]);
        shape.1.extend([(outward * length + along * (low - high)).normalize_or_zero(); 2]);
        let (a, b) = (2 * side, 2 * ((side + 1) % SIDES));
        if low > 0.0 {
            shape.2.push([a, b, b + 1]);
        }
        if high > 0.0 {
            shape.2.push([a, b + 1, a + 1]);
        }
    }
    Some(faced(shape.0, shape.1, shape.2, base_radius + apex_radius < 0.0))
}

/// The direction to one side of a circle.
fn around(side: u32, x: DVec3, y: DVec3) -> DVec3 {
    let (sine, cosine) = (TAU * f64::from(side) / f64::from(SIDES)).sin_cos();
    x * cosine + y * sine
}

fn faced(
    positions: Vec<DVec3>,
    mut normals: Vec<DVec3>,
    mut triangles: Vec<[u32; 3]>,
    is_inside_out: bool,
) -> Shape {
    if is_inside_out {
        normals.iter_mut().for_each(|normal| *normal = -*normal);
        triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
    }
    let normals = Some(Values { values: normals, indices: triangles.clone() });
    Shape { positions, triangles, normals, ..Shape::default() }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The area, and whether every triangle faces the way of its normals.
    fn measure(shape: &Shape) -> (f64, bool) {
        let normals = shape.normals.as_ref().unwrap();
        let mut area = 0.0;
        let mut agrees = true;
        for triangle in &shape.triangles {
            let [a, b, c] = triangle.map(|vertex| shape.positions[vertex as usize]);
            let doubled = (b - a).cross(c - a);
            area += doubled.length() / 2.0;
            let facing = triangle.map(|vertex| normals.values[vertex as usize].dot(doubled));
            agrees &= facing.iter().all(|&facing| facing > 0.0);
        }
        (area, agrees)
    }

    #[test]
    fn a_sphere_lies_on_the_sphere_and_faces_outward() {
        let center = DVec3::new(1.0, 2.0, 3.0);
        for radius in [2.0, -2.0] {
            let shape = sphere(center, radius).unwrap();
            assert_eq!((shape.triangles.len(), shape.positions.len()), (960, 482));
            assert!(shape.positions.iter().all(|at| (at.distance(center) - 2.0).abs() < 1e-12));
            let (area, agrees) = measure(&shape);
            assert!(agrees && (area / (16.0 * PI) - 1.0).abs() < 0.01, "{area}");
            let normal = shape.normals.unwrap().values[0];
            assert_eq!(normal, if radius > 0.0 { DVec3::Y } else { DVec3::NEG_Y });
        }
        assert_eq!(sphere(center, 0.0), None);
    }

    #[test]
    fn cones_have_no_caps_and_face_outward() {
        let (base, apex) = (DVec3::ZERO, DVec3::new(0.0, 3.0, 4.0));
        for (low, high, triangles) in
            [(2.0, 2.0, 64), (2.0, 1.0, 64), (1.0, 2.0, 64), (2.0, 0.0, 32), (0.0, 2.0, 32)]
        {
            let shape = cone(base, low, apex, high).unwrap();
            assert_eq!(shape.triangles.len(), triangles);
            let (area, agrees) = measure(&shape);
            let slant = f64::hypot(5.0, low - high);
            assert!(agrees && (area / (PI * (low + high) * slant) - 1.0).abs() < 0.01, "{area}");
            let inside_out = cone(base, -low, apex, -high).unwrap();
            assert_eq!(inside_out.normals.unwrap().values[0], -shape.normals.unwrap().values[0]);
        }
        assert_eq!(cone(base, 1.0, base, 1.0), None);
        assert_eq!(cone(base, 0.0, apex, 0.0), None);
    }
}
