//! The covariance of a surface, and its eigenvectors.
//!
//! Over a triangle of area `a` with vertices `p`, `q`, `r` and centre `m` the products `x xᵀ` sum up to
//! `a / 12 (9 m mᵀ + p pᵀ + q qᵀ + r rᵀ)`, exactly.

use super::refine::frame;
use glam::{DMat3, DVec3};

/// Sums over triangles.
#[derive(Clone, Copy, Default)]
pub(super) struct Moments {
    surface: Sum,
    /// The same of the vertices, each counting the same: of a surface without area it is all there is.
    vertices: Sum,
}

#[derive(Clone, Copy)]
struct Sum {
    weight: f64,
    first: DVec3,
    second: DMat3,
}

impl Default for Sum {
    fn default() -> Self {
        Self { weight: 0.0, first: DVec3::ZERO, second: DMat3::ZERO }
    }
}

impl Sum {
    fn covariance(&self) -> DMat3 {
        let mean = self.first / self.weight;
        self.second * self.weight.recip() - outer(mean)
    }
}

impl Moments {
    pub(super) fn add(&mut self, triangle: &[DVec3; 3]) {
        let [p, q, r] = *triangle;
        let area = (q - p).cross(r - p).length() * 0.5;
        let middle = (p + q + r) / 3.0;
        let of_vertices = outer(p) + outer(q) + outer(r);
        self.surface.weight += area;
        self.surface.first += middle * area;
        self.surface.second += (outer(middle) * 9.0 + of_vertices) * (area / 12.0);
        self.vertices.weight += 3.0;
        self.vertices.first += p + q + r;
        self.vertices.second += of_vertices;
    }

    /// A frame along the eigenvectors; `None` where there is nothing to measure.
    pub(super) fn axes(&self) -> Option<DMat3> {
        let sum = if self.surface.weight > 0.0 { &self.surface } else { &self.vertices };
        let covariance = sum.covariance();
        if !covariance.is_finite() {
            return None;
        }
        let axes = eigenvectors(covariance);
        frame(axes.x_axis, axes.z_axis)
    }
}

fn outer(v: DVec3) -> DMat3 {
    DMat3::from_cols(v * v.x, v * v.y, v * v.z)
}

/// The eigenvectors of a symmetric matrix, as columns, by Jacobi's rotations: each makes one element off the diagonal zero.
fn eigenvectors(mut matrix: DMat3) -> DMat3 {
    let mut vectors = DMat3::IDENTITY;
    // Each sweep squares what is off the diagonal; six are usual.
    for _ in 0..32 {
        let off = matrix.y_axis.x.abs() + matrix.z_axis.x.abs() + matrix.z_axis.y.abs();
        let on = matrix.x_axis.x.abs() + matrix.y_axis.y.abs() + matrix.z_axis.z.abs();
        if off <= 1e-18 * on {
            break;
        }
        for (row, column) in [(0, 1), (0, 2), (1, 2)] {
            let element = matrix.col(column)[row];
            if element == 0.0 {
                continue;
            }
            let half_difference = (matrix.col(column)[column] - matrix.col(row)[row]) * 0.5;
            // The smaller of the two angles that do it.
            let length = half_difference.hypot(element);
            let tangent = element / (half_difference + length.copysign(half_difference));
            let cosine = (1.0 + tangent * tangent).sqrt().recip();
            let sine = tangent * cosine;
            let mut rotation = DMat3::IDENTITY;
            rotation.col_mut(row)[row] = cosine;
            rotation.col_mut(column)[column] = cosine;
            rotation.col_mut(column)[row] = sine;
            rotation.col_mut(row)[column] = -sine;
            matrix = rotation.transpose() * matrix * rotation;
            vectors *= rotation;
        }
    }
    vectors
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eigenvectors_make_a_matrix_diagonal() {
        let values = [[2.0, 3.0, 7.0], [1.0, 1.0, 4.0], [0.0, 0.0, 5.0], [1e-20, 1.0, 1e9], [3.0, 3.0, 3.0]];
        for (step, [x, y, z]) in values.into_iter().enumerate() {
            let turn = DMat3::from_euler(glam::EulerRot::XYZ, 0.3, 1.1 * step as f64, -0.7);
            let matrix = turn * DMat3::from_diagonal(DVec3::new(x, y, z)) * turn.transpose();
            let vectors = eigenvectors(matrix);
            assert!((vectors.transpose() * vectors).abs_diff_eq(DMat3::IDENTITY, 1e-12));
            let diagonal = vectors.transpose() * matrix * vectors;
            for (row, column) in [(0, 1), (0, 2), (1, 2)] {
                assert!(diagonal.col(column)[row].abs() < 1e-12 * (x + y + z), "{diagonal}");
            }
        }
    }

    /// Cutting a triangle changes nothing; the sums are those of many small ones.
    #[test]
    fn the_surface_counts_and_not_how_it_is_cut() {
        let [a, b, c] = [DVec3::new(1.0, 2.0, 3.0), DVec3::new(4.0, 0.0, -1.0), DVec3::new(-2.0, 5.0, 0.5)];
        let mut whole = Moments::default();
        whole.add(&[a, b, c]);
        let mut cut = Moments::default();
        let steps = 16;
        let at = |i: i32, j: i32| a + (b - a) * f64::from(i) / 16.0 + (c - a) * f64::from(j) / 16.0;
        for i in 0..steps {
            for j in 0..steps - i {
                cut.add(&[at(i, j), at(i + 1, j), at(i, j + 1)]);
                if i + j < steps - 1 {
                    cut.add(&[at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
                }
            }
        }
        assert!((whole.surface.weight - cut.surface.weight).abs() < 1e-12);
        assert!(whole.surface.covariance().abs_diff_eq(cut.surface.covariance(), 1e-12));
    }
}
