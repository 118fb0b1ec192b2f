//! The nearest point of a triangle, its foot.
//!
//! **The least of seven.** The foot is the nearest vertex, the nearest inner point of one of three edges, or an inner
//! point of the face. Each that exists is computed by itself, as a point *of the triangle*, and the nearest wins. To
//! decide the region first and then compute (Ericson 2005) is shorter, but where a needle's regions are decided by
//! rounding, the decision throws the right point away. Here, what rounding spoils in one candidate, another one
//! bounds: a face whose inner point is noise lies between two edges that are near each other.
//!
//! **Digits.** Everything starts from the vertex that is nearest to the point, so the error is one of the distance to
//! that vertex and not of the triangle's size: a point a millimetre from the corner of a field has an exact distance.
//! The face's normal is the cross product of the two shorter edges, and its weights are worked out once more from
//! what the first attempt left over: a needle's first weights have few right digits.
//!
//! **Range.** The weights are quotients of products of four lengths. The lengths are scaled by a power of two, which
//! is exact, so that the triangle is about one unit large.

/// Writes the search for the foot in f32 and in f64.
macro_rules! foot {
    ($name:ident, $scalar:ty, $vector:ty, $exponent_bits:expr, $twice_one:expr) => {
        /// The foot on a triangle: `vertices[vertex]` and two weights, of the next vertex and of the one after that.
        #[derive(Clone, Copy, Debug)]
        pub(super) struct $name {
            /// The vertex from which the foot is measured.
            pub(super) vertex: usize,
            /// The weights of the vertices `vertex + 1` and `vertex + 2`. Both zero: the foot is the vertex. One of
            /// them zero: it is inside of that edge. Otherwise it is inside of the face.
            pub(super) along: [$scalar; 2],
            /// From the point to the foot.
            #[allow(dead_code, reason = "only the sign, which is found in f64, asks for it")]
            pub(super) offset: $vector,
            /// Its squared length.
            pub(super) square: $scalar,
        }

        impl $name {
            /// Finds the foot of a point on a triangle of any shape, points and lines included.
            #[inline(always)]
            pub(super) fn find(point: $vector, vertices: [$vector; 3]) -> Self {
                let corners = vertices.map(|vertex| vertex - point);
                let edges = [vertices[1] - vertices[0], vertices[2] - vertices[1], vertices[0] - vertices[2]];
                let squares = corners.map(|corner| corner.dot(corner));
                let lengths = edges.map(|edge| edge.dot(edge));
                let nearest = match squares {
                    [a, b, c] if a <= b && a <= c => 0,
                    [_, b, c] if b <= c => 1,
                    _ => 2,
                };
                let mut best = Self {
                    vertex: nearest,
                    along: [0.0; 2],
                    offset: corners[nearest],
                    square: squares[nearest],
                };
                for edge in 0..3 {
                    best.keep_nearer(Self::on_edge(edge, &corners, &squares, &edges, &lengths));
                }
                best.keep_nearer(Self::on_face(nearest, &corners, &edges, &lengths));
                best
            }

            /// Of two equally near, the one with fewer weights.
            #[inline(always)]
            fn keep_nearer(&mut self, other: Option<Self>) {
                if let Some(other) = other
                    && other.square < self.square
                {
                    *self = other;
                }
            }

            /// The foot inside of an edge, measured from its nearer end.
            #[inline(always)]
            fn on_edge(
                edge: usize,
                corners: &[$vector; 3],
                squares: &[$scalar; 3],
                edges: &[$vector; 3],
                lengths: &[$scalar; 3],
            ) -> Option<Self> {
                let end = (edge + 1) % 3;
                let backwards = squares[end] < squares[edge];
                let (vertex, way) = if backwards { (end, -edges[edge]) } else { (edge, edges[edge]) };
                let weight = -corners[vertex].dot(way) / lengths[edge];
                // An edge without length gives NaN, which is refused here.
                if !(weight > 0.0 && weight < 1.0) {
                    return None;
                }
                let offset = corners[vertex] + way * weight;
                let along = if backwards { [0.0, weight] } else { [weight, 0.0] };
                Some(Self { vertex, along, offset, square: offset.dot(offset) })
            }

            /// The foot inside of the face.
            #[inline(always)]
            fn on_face(
                vertex: usize,
                corners: &[$vector; 3],
                edges: &[$vector; 3],
                lengths: &[$scalar; 3],
            ) -> Option<Self> {
                let extent = edges[0].abs().max(edges[1].abs()).max(edges[2].abs());
                let scale =
                    <$scalar>::from_bits($twice_one - (extent.max_element().to_bits() & $exponent_bits));
                let [ab, bc, ca] = edges.map(|edge| edge * scale);
                let normal = if lengths[0] >= lengths[1] && lengths[0] >= lengths[2] {
                    bc.cross(ca)
                } else if lengths[1] >= lengths[2] {
                    ca.cross(ab)
                } else {
                    ab.cross(bc)
                };
                let (one, other) = (edges[vertex], -edges[(vertex + 2) % 3]);
                let (one_scaled, other_scaled) = (one * scale, other * scale);
                let area = normal.dot(normal);
                // Quotients, and not products with the same reciprocal: graphics drivers would take that factor out of
                // the sums below, and round in another way.
                let weights = |way: $vector| {
                    (normal.dot(way.cross(other_scaled)) / area, normal.dot(one_scaled.cross(way)) / area)
                };
                let way = corners[vertex] * -scale;
                let (first, second) = weights(way);
                let (more_first, more_second) = weights(way - (one_scaled * first + other_scaled * second));
                let (first, second) = (first + more_first, second + more_second);
                // A triangle without area gives NaN or infinities, which are refused here.
                if !(first > 0.0 && second > 0.0 && first + second < 1.0) {
                    return None;
                }
                let offset = corners[vertex] + (one * first + other * second);
                Some(Self { vertex, along: [first, second], offset, square: offset.dot(offset) })
            }

            /// The weights of the three vertices.
            #[inline(always)]
            pub(super) fn weights(&self) -> [$scalar; 3] {
                let [first, second] = self.along;
                // In this order, since graphics drivers move a constant to the end of a sum.
                let rest = 1.0 - (first + second);
                match self.vertex {
                    0 => [rest, first, second],
                    1 => [second, rest, first],
                    _ => [first, second, rest],
                }
            }

            /// The foot itself.
            #[inline(always)]
            pub(super) fn position(&self, vertices: &[$vector; 3]) -> $vector {
                let from = vertices[self.vertex];
                let one = vertices[(self.vertex + 1) % 3] - from;
                let other = vertices[(self.vertex + 2) % 3] - from;
                from + (one * self.along[0] + other * self.along[1])
            }
        }
    };
}

foot!(Foot, f32, glam::Vec3, 0xff_u32 << 23, 254_u32 << 23);
foot!(WideFoot, f64, glam::DVec3, 0x7ff_u64 << 52, 2046_u64 << 52);

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DVec3, Vec3};

    /// How far a triangle in f32 is, and the same in f64.
    fn both(point: Vec3, vertices: [Vec3; 3]) -> (f64, f64) {
        let narrow = Foot::find(point, vertices);
        let wide = WideFoot::find(point.as_dvec3(), vertices.map(Vec3::as_dvec3));
        let weights = narrow.weights();
        assert!(weights.iter().all(|weight| (0.0..=1.0).contains(weight)), "{weights:?}");
        (f64::from(narrow.square).sqrt(), wide.square.sqrt())
    }

    #[test]
    fn every_region_is_found() {
        let vertices = [DVec3::ZERO, DVec3::X * 4.0, DVec3::Y * 4.0];
        for (point, weights) in [
            (DVec3::new(-1.0, -1.0, 1.0), [1.0, 0.0, 0.0]),
            (DVec3::new(6.0, -1.0, 1.0), [0.0, 1.0, 0.0]),
            (DVec3::new(-1.0, 6.0, 1.0), [0.0, 0.0, 1.0]),
            (DVec3::new(1.0, -3.0, 1.0), [0.75, 0.25, 0.0]),
            (DVec3::new(3.0, -3.0, 1.0), [0.25, 0.75, 0.0]),
            (DVec3::new(-2.0, 1.0, 1.0), [0.75, 0.0, 0.25]),
            (DVec3::new(4.0, 2.0, 1.0), [0.0, 0.75, 0.25]),
            (DVec3::new(1.0, 1.0, -7.0), [0.5, 0.25, 0.25]),
        ] {
            for turn in 0..3 {
                let turned: [DVec3; 3] = std::array::from_fn(|index| vertices[(index + turn) % 3]);
                let expected: [f64; 3] = std::array::from_fn(|index| weights[(index + turn) % 3]);
                let foot = WideFoot::find(point, turned);
                assert_eq!(foot.weights(), expected, "{point}");
                assert_eq!(foot.position(&turned) - point, foot.offset);
                let narrow = Foot::find(point.as_vec3(), turned.map(DVec3::as_vec3));
                assert_eq!(narrow.weights().map(f64::from), expected);
            }
        }
    }

    /// Beside the corner of a triangle a hundred thousand large, a thousandth away.
    #[test]
    fn a_large_triangle_costs_no_digits() {
        for turn in 0..3 {
            let corners = [Vec3::new(3.0, 2.0, 1.0), Vec3::new(1e5, 4e3, 50.0), Vec3::new(2e3, 9e4, -60.0)];
            let vertices = std::array::from_fn(|index| corners[(index + turn) % 3]);
            let point = corners[0] + Vec3::new(1e-3, 1e-3, 1e-3);
            let (narrow, wide) = both(point, vertices);
            assert!((narrow / wide - 1.0).abs() < 1e-6, "{narrow} {wide}");
        }
    }

    /// Needles and caps of every thinness, points at every distance: the error is one of the size, never more.
    #[test]
    fn needles_are_as_good_as_others() {
        let mut state = 7u32;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / (1 << 23) as f32 - 1.0
        };
        let mut worst = 0.0f64;
        for round in 0..200_000 {
            let mut vector = || Vec3::new(next(), next(), next());
            let (a, long, thin) = (vector(), vector(), vector() * 10f32.powi(-(round % 8)));
            let lean = (vector().x + 1.0) * 0.5;
            let vertices = [a, a + long, a + long * lean + thin];
            let point = vertices[0]
                + long * vector().x
                + thin * vector().y * 2.0
                + vector() * 10f32.powi(-(round / 8 % 8));
            let (narrow, wide) = both(point, vertices);
            let nearest = vertices.iter().map(|vertex| vertex.distance(point)).fold(f32::INFINITY, f32::min);
            let longest = long.length().max(vertices[2].distance(a)).max(vertices[2].distance(vertices[1]));
            worst = worst.max((narrow - wide).abs() / f64::from(nearest + longest));
        }
        let roundings = worst * f64::from(1 << 24);
        println!("the worst error is {roundings:.1} half units of the sizes in play");
        assert!(roundings < 16.0, "{roundings}");
    }

    #[test]
    fn any_size_has_a_foot() {
        for exponent in [-15, -9, 0, 9, 12] {
            let size = 10f32.powi(exponent);
            let vertices = [Vec3::ZERO, Vec3::X, Vec3::Y].map(|vertex| vertex * size);
            for (point, weights) in [
                (Vec3::new(0.25, 0.25, 1.0), [0.5, 0.25, 0.25]),
                (Vec3::new(0.5, -1.0, 0.0), [0.5, 0.5, 0.0]),
                (Vec3::new(3.0, -1.0, 2.0), [0.0, 1.0, 0.0]),
            ] {
                let foot = Foot::find(point * size, vertices);
                for (weight, expected) in foot.weights().into_iter().zip(weights) {
                    assert!((weight - expected).abs() < 1e-6, "{size:e} {point}: {foot:?}");
                }
            }
        }
    }

    #[test]
    fn a_triangle_without_area_has_a_foot() {
        let point = Vec3::new(0.5, 1.0, 0.0);
        for vertices in [[0.0, 1.0, 2.0], [0.0, 2.0, 1.0], [1.0, 0.0, 2.0], [0.0, 1.0, 1.0], [0.5; 3]] {
            let foot = Foot::find(point, vertices.map(|x| Vec3::X * x));
            assert_eq!(foot.square, 1.0, "{vertices:?}: {foot:?}");
        }
    }
}
