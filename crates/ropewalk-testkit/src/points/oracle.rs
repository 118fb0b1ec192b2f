//! Every triangle of a scene in f64, and what is wrong with an answer.
//!
//! Nothing is trusted of the library's trees. So that many points can be asked of large scenes, neighbouring triangles
//! stand in blocks of [`BLOCK`] with a ball around each block: a block whose ball is farther than something that was
//! measured already is passed over. A point asks every block.

use super::measure::Measured;
use super::queries::wide;
use glam::{DVec3, Vec3};
use ropewalk::{ClosestPoint, FlatScene, PointQuery, Scene, SceneError};
use std::collections::HashMap;

/// Triangles in a block.
const BLOCK: usize = 64;

/// Who a triangle is: instance, geometry, primitive.
type Id = (u32, u32, u32);

#[derive(Clone, Copy, Debug)]
struct Named {
    corners: [DVec3; 3],
    id: Id,
    /// In the top 8 bits, as in [`ropewalk::FlatTriangle`].
    mask: u32,
}

impl Named {
    fn is_seen(&self, query: &PointQuery) -> bool {
        self.mask & (query.mask << 24) != 0
    }
}

#[derive(Clone, Copy, Debug)]
struct Ball {
    center: DVec3,
    radius: f64,
}

/// The triangles of a scene in f64.
#[derive(Clone, Debug)]
pub struct PointOracle {
    triangles: Vec<Named>,
    blocks: Vec<Ball>,
    places: HashMap<Id, usize>,
    /// The triangles of exactly the same vertices in the same order, by the first one's corners, sorted by id.
    twins: HashMap<[[u64; 3]; 3], Vec<usize>>,
}

impl PointOracle {
    /// The oracle of flattened triangles.
    #[must_use]
    pub fn new(scene: &FlatScene) -> Self {
        let mut triangles: Vec<Named> = scene
            .triangles
            .iter()
            .map(|triangle| Named {
                corners: triangle.triangle().vertices.map(Vec3::as_dvec3),
                id: (triangle.instance(), triangle.geometry(), triangle.primitive),
                mask: triangle.instance_and_mask & 0xff00_0000,
            })
            .collect();
        let bounds = scene.triangles.iter().map(|triangle| triangle.triangle().bounds());
        let bounds = bounds.fold(ropewalk::Aabb::EMPTY, ropewalk::Aabb::union);
        let (low, size) = (bounds.min.as_dvec3(), bounds.size().as_dvec3().max_element());
        triangles.sort_by_cached_key(|triangle| (morton((triangle.corners[0] - low) / size), triangle.id));
        let blocks = triangles.chunks(BLOCK).map(ball).collect();
        let places = triangles.iter().enumerate().map(|(place, triangle)| (triangle.id, place)).collect();
        let mut twins: HashMap<_, Vec<usize>> = HashMap::new();
        for (place, triangle) in triangles.iter().enumerate() {
            twins.entry(bits(&triangle.corners)).or_default().push(place);
        }
        Self { triangles, blocks, places, twins }
    }

    /// The oracle of a scene's triangles.
    ///
    /// # Errors
    /// When the scene cannot be flattened.
    pub fn of_scene(scene: &Scene) -> Result<Self, SceneError> {
        Ok(Self::new(&scene.flatten()?))
    }

    /// The number of triangles.
    #[must_use]
    pub fn triangle_count(&self) -> usize {
        self.triangles.len()
    }

    /// Beyond this no right closest point lies: the least of the upper bounds of all triangles that the query sees,
    /// infinite where it sees none.
    #[must_use]
    pub fn certain_within(&self, query: &PointQuery) -> f64 {
        let point = wide(query);
        let mut least = f64::INFINITY;
        let mut order: Vec<(f64, usize)> = self.block_distances(point).collect();
        // The nearest block first; after it the order matters little.
        if let Some(nearest) = (0..order.len()).min_by(|&a, &b| order[a].0.total_cmp(&order[b].0)) {
            order.swap(0, nearest);
        }
        for (distance, block) in order {
            if distance <= least {
                for triangle in self.block(block).filter(|triangle| triangle.is_seen(query)) {
                    least = least.min(Measured::new(point, &triangle.corners).high);
                }
            }
        }
        least
    }

    /// What is wrong with an answer to "what is closest?", if anything is.
    #[must_use]
    pub fn closest_objection(&self, query: &PointQuery, answer: &ClosestPoint) -> Option<String> {
        if !query.is_valid() {
            return (answer.to_words() != ClosestPoint::NONE.to_words())
                .then(|| "the query is not valid, so nothing can be found".into());
        }
        let certain = self.certain_within(query);
        if !answer.is_found() {
            if answer.to_words() != ClosestPoint::NONE.to_words() {
                return Some("nothing was found, but fields are left over".into());
            }
            return (certain.is_finite() && certain <= f64::from(query.radius))
                .then(|| format!("there is something at {certain:e} at most, within the radius"));
        }
        if let Some(objection) = self.objection(query, answer) {
            return Some(objection);
        }
        if f64::from(answer.distance) > certain {
            return Some(format!("something is nearer, at {certain:e} at most"));
        }
        self.twin_before(query, answer)
            .map(|twin| format!("the same triangle with the smaller id {twin:?} goes first"))
    }

    /// What is wrong with an answer to "which `k` are nearest?", if anything is.
    #[must_use]
    pub fn nearest_objection(
        &self,
        query: &PointQuery,
        k: usize,
        answers: &[ClosestPoint],
    ) -> Option<String> {
        if !query.is_valid() {
            return (!answers.is_empty()).then(|| "the query is not valid, so nothing can be found".into());
        }
        if answers.len() > k {
            return Some(format!("{} are listed where {k} were asked for", answers.len()));
        }
        if let Some(objection) = answers.iter().find_map(|answer| self.objection(query, answer)) {
            return Some(objection);
        }
        if let Some(pair) = answers.windows(2).find(|pair| !pair[0].precedes(&pair[1])) {
            return Some(format!("{:?} does not go before {:?}", pair[0].id(), pair[1].id()));
        }
        let listed: std::collections::HashSet<Id> = answers.iter().map(ClosestPoint::id).collect();
        if listed.len() < answers.len() {
            return Some("a triangle is listed twice".into());
        }
        let before = answers.iter().find_map(|answer| {
            self.twins_before(query, answer).into_iter().find(|twin| !listed.contains(twin))
        });
        if let Some(twin) = before {
            return Some(format!("the same triangle with the smaller id {twin:?} is not listed"));
        }
        // Nothing that is certainly nearer than the last one, or than the radius where there was room, may lack.
        let is_full = answers.len() == k;
        let limit = match answers.last() {
            Some(last) if is_full => f64::from(last.distance).next_down(),
            None if is_full => return None,
            _ => f64::from(query.radius),
        };
        let point = wide(query);
        let lacking = self.block_distances(point).filter(|&(distance, _)| distance <= limit).find_map(
            |(_, block)| {
                self.block(block).find(|triangle| {
                    triangle.is_seen(query)
                        && !listed.contains(&triangle.id)
                        && Measured::new(point, &triangle.corners).high <= limit
                })
            },
        )?;
        Some(format!("{:?} is nearer than {limit:e} and is not listed", lacking.id))
    }

    /// What is wrong with an answer by itself, whatever else there is.
    fn objection(&self, query: &PointQuery, answer: &ClosestPoint) -> Option<String> {
        let Some(triangle) = self.places.get(&answer.id()).map(|&place| &self.triangles[place]) else {
            return Some(format!("there is no triangle {:?}", answer.id()));
        };
        if !triangle.is_seen(query) {
            return Some(format!("the query does not see instance {}", answer.instance_index));
        }
        // Comparisons that a NaN fails.
        let is_within = answer.distance <= query.radius;
        if !is_within {
            return Some(format!("{:e} is beyond the radius", answer.distance));
        }
        let point = wide(query);
        let measured = Measured::new(point, &triangle.corners);
        let distance = f64::from(answer.distance);
        if !(measured.low..=measured.high).contains(&distance) {
            return Some(format!(
                "the distance of {:?} is {:e}, between {:e} and {:e}",
                answer.id(),
                measured.distance,
                measured.low,
                measured.high
            ));
        }
        let position = answer.point.as_dvec3();
        let off = super::measure::distance(position, &triangle.corners);
        let is_on_triangle = off <= measured.spread;
        if !is_on_triangle {
            return Some(format!("the point is {off:e} off the triangle; {:e} is right", measured.spread));
        }
        let error = measured.high - measured.distance + measured.spread;
        let is_at_distance = (position.distance(point) - measured.distance).abs() <= error;
        if !is_at_distance {
            return Some(format!("the point is not at the distance {:e}", measured.distance));
        }
        let (u, v) = (f64::from(answer.barycentrics.x), f64::from(answer.barycentrics.y));
        let slip = 4.0 / f64::from(1 << 24);
        let is_inside = u >= 0.0 && v >= 0.0 && u + v <= 1.0 + slip;
        if !is_inside {
            return Some(format!("the weights {u} and {v} are not of a point of the triangle"));
        }
        let [a, b, c] = triangle.corners;
        let off = (a + (b - a) * u + (c - a) * v).distance(position);
        (off > measured.spread).then(|| format!("the weights are of a point {off:e} away"))
    }

    fn twin_before(&self, query: &PointQuery, answer: &ClosestPoint) -> Option<Id> {
        self.twins_before(query, answer).into_iter().next()
    }

    /// The triangles of the same shape with smaller ids that the query sees.
    fn twins_before(&self, query: &PointQuery, answer: &ClosestPoint) -> Vec<Id> {
        let Some(&place) = self.places.get(&answer.id()) else { return Vec::new() };
        let twins = self.twins.get(&bits(&self.triangles[place].corners));
        twins
            .into_iter()
            .flatten()
            .map(|&twin| &self.triangles[twin])
            .filter(|twin| twin.id < answer.id() && twin.is_seen(query))
            .map(|twin| twin.id)
            .collect()
    }

    fn block(&self, block: usize) -> impl Iterator<Item = &Named> {
        self.triangles.iter().skip(block * BLOCK).take(BLOCK)
    }

    /// How far each block is at least.
    fn block_distances(&self, point: DVec3) -> impl Iterator<Item = (f64, usize)> {
        let distance = move |ball: &Ball| point.distance(ball.center) - ball.radius;
        self.blocks.iter().map(distance).enumerate().map(|(block, distance)| (distance, block))
    }
}

/// A ball around triangles, a little too large.
fn ball(triangles: &[Named]) -> Ball {
    let corners = || triangles.iter().flat_map(|triangle| triangle.corners);
    let low = corners().fold(DVec3::INFINITY, DVec3::min);
    let high = corners().fold(DVec3::NEG_INFINITY, DVec3::max);
    let center = (low + high) * 0.5;
    let radius = corners().map(|corner| corner.distance(center)).fold(0.0, f64::max);
    // The size of the coordinates counts for the rounding of far blocks.
    Ball { center, radius: (radius + center.length() * 1e-15) * (1.0 + 1e-9) }
}

/// The bits of three coordinates in [0, 1], interleaved.
fn morton(place: DVec3) -> u64 {
    let [x, y, z] = place.to_array().map(|part| (part.clamp(0.0, 1.0) * 1_048_575.0) as u64);
    (0..20).fold(0, |code, bit| {
        code | (x >> bit & 1) << (3 * bit) | (y >> bit & 1) << (3 * bit + 1) | (z >> bit & 1) << (3 * bit + 2)
    })
}

fn bits(corners: &[DVec3; 3]) -> [[u64; 3]; 3] {
    corners.map(|corner| corner.to_array().map(f64::to_bits))
}
