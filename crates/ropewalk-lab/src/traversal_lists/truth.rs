//! The answers of a scene's triangles, with two sides and with one.
//!
//! They come from the ordered stack over a tree of its own. With one side a ray's answer is the first of all its hits that
//! is a hit of a front: no walk of one-sided triangles takes part in it.
//!
//! **Brute force** confirms both: a part of the rays is held against every triangle, as many as a budget allows.

use rayon::prelude::*;
use ropewalk::{
    Answer, Bvh, FlatTriangle, Hit, PreparedRay, Query, Ray, Scene, Status, Structure, TraceError,
    TraceOptions, Traced, Walk,
};
use ropewalk::{BuildError, BuildOptions};

/// How many sides triangles have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sides {
    One,
    Two,
}

/// Answers rays.
#[derive(Clone, Debug)]
pub(super) struct Truth {
    tree: Structure,
    /// By their numbers.
    triangles: Vec<FlatTriangle>,
}

impl Truth {
    pub(super) fn new(scene: &Scene) -> Result<Self, BuildError> {
        let triangles = scene.flatten()?.triangles;
        let tree: Bvh = scene.build(&BuildOptions::default())?;
        Ok(Self { tree: Structure::Bvh(tree), triangles })
    }

    /// The triangles by their numbers.
    pub(super) fn triangles(&self) -> &[FlatTriangle] {
        &self.triangles
    }

    /// The number of the triangle of a hit.
    pub(super) fn number_of(&self, hit: &Hit) -> Option<u32> {
        let id = |triangle: &FlatTriangle| (triangle.instance(), triangle.geometry(), triangle.primitive);
        self.triangles.binary_search_by_key(&hit.id(), id).ok().map(|number| number as u32)
    }

    /// Answers [`Query::Closest`] and [`Query::Any`].
    pub(super) fn answer(&self, sides: Sides, query: Query, rays: &[Ray]) -> Result<Traced, TraceError> {
        let trace = |query| self.tree.trace(Walk::default(), query, rays, TraceOptions::default());
        if sides == Sides::Two {
            return trace(query);
        }
        let all = trace(Query::All)?;
        let Answer::All(lists) = &all.answer else { return Ok(all) };
        let first_front = |(index, ray): (usize, &Ray)| {
            let ray = PreparedRay::new(ray)?;
            lists.of(index).iter().copied().find(|hit| {
                let triangle = self.number_of(hit).and_then(|number| self.triangles.get(number as usize));
                triangle.is_some_and(|triangle| triangle.intersect_front(&ray, ray.t_max).is_some())
            })
        };
        let hits: Vec<Option<Hit>> = rays.par_iter().enumerate().map(first_front).collect();
        Ok(Traced { answer: answer(query, &hits), status: all.status, counters: None })
    }

    /// Holds answers against every triangle, for rays spread over the batch, of which `budget` tests can be made; how many,
    /// or the first wrong one.
    pub(super) fn confirm(
        &self,
        query: Query,
        rays: &[Ray],
        two_sided: &Traced,
        one_sided: &Traced,
        budget: usize,
    ) -> Result<usize, String> {
        let most = (budget / self.triangles.len().max(1)).max(1);
        let step = rays.len().div_ceil(most).max(1);
        let chosen: Vec<usize> = (0..rays.len()).step_by(step).collect();
        let both: Vec<[Option<Hit>; 2]> =
            chosen.par_iter().map(|&index| self.by_force(&rays[index])).collect();
        let asked: Vec<Ray> = chosen.iter().map(|&index| rays[index]).collect();
        for (side, given) in [two_sided, one_sided].into_iter().enumerate() {
            let hits: Vec<Option<Hit>> = both.iter().map(|hits| hits[side]).collect();
            let status = |ray: &Ray| if ray.is_valid() { Status::COMPLETE } else { Status::INVALID_RAY };
            let expected = Traced {
                answer: answer(query, &hits),
                status: asked.iter().map(status).collect(),
                counters: None,
            };
            ropewalk_testkit::compare::same_bits(&asked, &expected, &part(given, &chosen), false)
                .map_err(|mismatch| mismatch.to_string())?;
        }
        Ok(chosen.len())
    }

    /// The first hit of triangles of two sides, and of one.
    fn by_force(&self, ray: &Ray) -> [Option<Hit>; 2] {
        let Some(ray) = PreparedRay::new(ray) else { return [None; 2] };
        let mut first: [Option<Hit>; 2] = [None; 2];
        for triangle in &self.triangles {
            let Some(hit) = triangle.intersect(&ray, ray.t_max) else { continue };
            let front = triangle.intersect_front(&ray, ray.t_max);
            for (first, hit) in first.iter_mut().zip([Some(hit), front]) {
                if hit.is_some_and(|hit| first.is_none_or(|first| hit.precedes(&first))) {
                    *first = hit;
                }
            }
        }
        first
    }
}

/// The answers of some rays of a batch.
fn part(traced: &Traced, chosen: &[usize]) -> Traced {
    let answer = match &traced.answer {
        Answer::Closest(hits) => Answer::Closest(pick(hits, chosen)),
        Answer::Any(hits) => Answer::Any(pick(hits, chosen)),
        other => other.clone(),
    };
    Traced { answer, status: pick(&traced.status, chosen), counters: None }
}

fn pick<T: Copy>(all: &[T], chosen: &[usize]) -> Vec<T> {
    chosen.iter().filter_map(|&index| all.get(index).copied()).collect()
}

fn answer(query: Query, first: &[Option<Hit>]) -> Answer {
    if query == Query::Any {
        Answer::Any(first.iter().map(Option::is_some).collect())
    } else {
        Answer::Closest(first.iter().map(|hit| hit.unwrap_or(Hit::MISS)).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use ropewalk_testkit::meshes;

    fn rays() -> Vec<Ray> {
        let mut random = ropewalk_testkit::random::Random::new(3);
        (0..500)
            .map(|_| Ray::new((random.direction() * 2.0).as_vec3(), random.direction().as_vec3()))
            .chain([Ray::new(Vec3::ZERO, Vec3::ZERO)])
            .collect()
    }

    /// Of one side a ray that starts within a sphere hits nothing, one from outside the same as of two.
    #[test]
    fn one_side_is_seen_from_outside_alone() {
        let truth = Truth::new(&Scene::from_mesh(meshes::icosphere(2))).unwrap();
        let rays =
            [Ray::new(Vec3::new(0.1, 0.2, 3.0), -Vec3::Z), Ray::new(Vec3::ZERO, Vec3::new(0.1, 0.2, 1.0))];
        let of = |sides, query| truth.answer(sides, query, &rays).unwrap().answer;
        let (Answer::Closest(two), Answer::Closest(one)) =
            (of(Sides::Two, Query::Closest), of(Sides::One, Query::Closest))
        else {
            panic!("other answers");
        };
        assert!(two[0].is_hit() && two[0] == one[0] && two[1].is_hit() && one[1] == Hit::MISS);
        assert_eq!(of(Sides::One, Query::Any), Answer::Any(vec![true, false]));
        assert_eq!(truth.number_of(&two[0]), Some(two[0].primitive_index));
        assert_eq!(truth.number_of(&Hit::MISS), None);
    }

    #[test]
    fn brute_force_confirms_what_is_right_and_finds_what_is_wrong() {
        let truth = Truth::new(&Scene::from_mesh(meshes::soup(300, 0.4, 2))).unwrap();
        let rays = rays();
        for query in [Query::Closest, Query::Any] {
            let two = truth.answer(Sides::Two, query, &rays).unwrap();
            let one = truth.answer(Sides::One, query, &rays).unwrap();
            assert_ne!(two.answer, one.answer);
            let all = 300 * rays.len();
            assert_eq!(truth.confirm(query, &rays, &two, &one, all), Ok(rays.len()));
            assert!(truth.confirm(query, &rays, &one, &one, all).is_err());
            assert!(truth.confirm(query, &rays, &two, &two, all).is_err());
            // A budget for ten rays, and none.
            let few = truth.confirm(query, &rays, &two, &one, 10 * 300).unwrap();
            assert!((8..=10).contains(&few), "{few}");
            assert_eq!(truth.confirm(query, &rays, &two, &one, 0), Ok(1));
        }
    }
}
