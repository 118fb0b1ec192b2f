//! Who is right where an engine's answer differs from the reference's.
//!
//! The reference is our own watertight binary BVH, which the conformance suite holds to the f64 oracle. Where an engine says
//! something else, the oracle decides, and first about the two triangles that the two name: if the reference's is certain to
//! be hit and lies nearer, the engine lost it, whatever else there is. Only what these two triangles do not settle is asked
//! of all triangles, and of that only so many rays a comparison, for it takes milliseconds each; the others are counted as
//! open.
//!
//! **Tolerance.** No peer promises our `t` to the bit. Values within 1e-4 of each other, or within a millionth of the
//! scene's size, are the same.

use ropewalk::{FlatScene, Hit, Ray};
use ropewalk_testkit::oracle::{Candidate, Oracle};
use serde::Serialize;

/// How far two values of `t` may lie apart, relative.
const RELATIVE: f64 = 1e-4;
/// The same as a part of the scene's size.
const OF_SIZE: f64 = 1e-6;
/// Rays a comparison for which all triangles are asked.
const ASKED_OF_ALL: usize = 24;

/// What came of comparing an engine's answers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Verdict {
    /// Rays compared.
    pub rays: usize,
    /// Rays whose answer is not the reference's.
    pub differing: usize,
    /// Of these: a certain hit is lost.
    pub missed: usize,
    /// Of these: a hit where there is nothing.
    pub invented: usize,
    /// Of these: the ray hits, but elsewhere.
    pub wrong_t: usize,
    /// Of these: an edge, a tie or a graze, where both answers are right.
    pub both_right: usize,
    /// Of these: the reference is wrong.
    pub reference_wrong: usize,
    /// Of these: nobody decided.
    pub open: usize,
}

impl Verdict {
    /// Wrong answers of the engine.
    #[must_use]
    pub const fn wrong(&self) -> usize {
        self.missed + self.invented + self.wrong_t
    }

    /// Wrong answers, and those that may be.
    #[must_use]
    pub const fn suspect(&self) -> usize {
        self.wrong() + self.open
    }

    fn count(&mut self, finding: Finding) {
        self.differing += 1;
        *match finding {
            Finding::Missed => &mut self.missed,
            Finding::Invented => &mut self.invented,
            Finding::WrongT => &mut self.wrong_t,
            Finding::BothRight => &mut self.both_right,
            Finding::ReferenceWrong => &mut self.reference_wrong,
            Finding::Open => &mut self.open,
        } += 1;
    }
}

/// About one ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Finding {
    Missed,
    Invented,
    WrongT,
    BothRight,
    ReferenceWrong,
    Open,
}

/// Compares answers over one scene.
#[derive(Debug)]
pub struct Judge<'a> {
    flat: &'a FlatScene,
    oracle: Oracle,
    slack: f64,
}

impl<'a> Judge<'a> {
    /// For the triangles of a [`Shape`](super::Shape), whose hits number them.
    #[must_use]
    pub fn new(flat: &'a FlatScene) -> Self {
        let corners = flat.triangles.iter().flat_map(|triangle| triangle.triangle().vertices);
        let bounds = ropewalk::Aabb::of_points(corners);
        let size = if bounds.is_empty() { 0.0 } else { f64::from((bounds.max - bounds.min).length()) };
        Self { flat, oracle: Oracle::new(flat), slack: OF_SIZE * size }
    }

    /// Closest hits against the reference's.
    #[must_use]
    pub fn closest(&self, rays: &[Ray], reference: &[Hit], given: &[Hit]) -> Verdict {
        let mut verdict = Verdict { rays: rays.len(), ..Verdict::default() };
        let mut asked = 0;
        for ((ray, reference), given) in rays.iter().zip(reference).zip(given) {
            if self.is_same(reference, given) {
                continue;
            }
            let finding = self.of_two(ray, reference, given).unwrap_or_else(|| {
                asked += 1;
                if asked > ASKED_OF_ALL { Finding::Open } else { self.of_all(ray, reference, given) }
            });
            verdict.count(finding);
        }
        verdict.open += rays.len() - given.len().min(rays.len());
        verdict
    }

    /// Any hits against the reference's closest ones.
    #[must_use]
    pub fn any(&self, rays: &[Ray], reference: &[Hit], given: &[bool]) -> Verdict {
        let mut verdict = Verdict { rays: rays.len(), ..Verdict::default() };
        let mut asked = 0;
        for ((ray, reference), &given) in rays.iter().zip(reference).zip(given) {
            if given == reference.is_hit() {
                continue;
            }
            let certain = || self.candidate(ray, reference).is_some_and(|candidate| candidate.is_certain());
            if !given && certain() {
                verdict.count(Finding::Missed);
                continue;
            }
            asked += 1;
            let finding = if asked > ASKED_OF_ALL {
                Finding::Open
            } else {
                let all = self.oracle.candidates(ray);
                match (given, all.is_empty(), all.iter().any(Candidate::is_certain)) {
                    (true, true, _) => Finding::Invented,
                    (false, _, true) => Finding::Missed,
                    (true, _, true) | (false, true, _) => Finding::ReferenceWrong,
                    _ => Finding::BothRight,
                }
            };
            verdict.count(finding);
        }
        verdict.open += rays.len() - given.len().min(rays.len());
        verdict
    }

    fn is_same(&self, a: &Hit, b: &Hit) -> bool {
        a.is_hit() == b.is_hit() && (!a.is_hit() || self.is_near(f64::from(a.t), f64::from(b.t)))
    }

    /// A NaN is near nothing.
    fn is_near(&self, a: f64, b: f64) -> bool {
        (a - b).abs() <= RELATIVE * a.abs().max(b.abs()) + self.slack
    }

    /// The oracle's word on the triangle of a hit.
    fn candidate(&self, ray: &Ray, hit: &Hit) -> Option<Candidate> {
        let triangle = *self.flat.triangles.get(hit.primitive_index as usize)?;
        let alone = FlatScene { triangles: vec![triangle], ..FlatScene::default() };
        Oracle::new(&alone).candidates(ray).first().copied()
    }

    /// Whether a hit's `t` is one that its triangle may have.
    fn fits(&self, candidate: &Candidate, hit: &Hit) -> bool {
        let t = f64::from(hit.t);
        (t >= candidate.t_low && t <= candidate.t_high) || self.is_near(t, candidate.t)
    }

    /// By the triangles that the two name, if that is enough.
    fn of_two(&self, ray: &Ray, reference: &Hit, given: &Hit) -> Option<Finding> {
        let ours = self.candidate(ray, reference).filter(|ours| self.fits(ours, reference));
        let certain = ours.filter(Candidate::is_certain);
        if !given.is_hit() {
            return certain.map(|_| Finding::Missed);
        }
        let t = f64::from(given.t);
        let Some(theirs) = self.candidate(ray, given) else {
            return Some(if reference.is_hit() { Finding::WrongT } else { Finding::Invented });
        };
        if !self.fits(&theirs, given) {
            return Some(Finding::WrongT);
        }
        if certain.is_some_and(|ours| t > ours.t_high && !self.is_near(t, ours.t_high)) {
            return Some(Finding::WrongT);
        }
        let nearer = !reference.is_hit() || f64::from(reference.t) > theirs.t_high;
        (theirs.is_certain() && nearer).then_some(Finding::ReferenceWrong)
    }

    /// By all triangles.
    fn of_all(&self, ray: &Ray, reference: &Hit, given: &Hit) -> Finding {
        let all = self.oracle.candidates(ray);
        let limit = all
            .iter()
            .filter(|candidate| candidate.is_certain())
            .map(|candidate| candidate.t_high)
            .fold(f64::INFINITY, f64::min);
        let is_right = |hit: &Hit| {
            if !hit.is_hit() {
                return limit.is_infinite();
            }
            let t = f64::from(hit.t);
            all.iter().any(|candidate| self.fits(candidate, hit)) && (t <= limit || self.is_near(t, limit))
        };
        match (is_right(given), is_right(reference)) {
            (true, true) => Finding::BothRight,
            (true, false) => Finding::ReferenceWrong,
            (false, _) if !given.is_hit() => Finding::Missed,
            (false, _) if all.is_empty() => Finding::Invented,
            (false, _) => Finding::WrongT,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arena::Shape;
    use ropewalk::glam::Vec3;
    use ropewalk::{BuildOptions, Scene};
    use ropewalk_testkit::{meshes, random::Random};

    struct Case {
        shape: Shape,
        rays: Vec<Ray>,
        hits: Vec<Hit>,
    }

    fn case() -> Case {
        let shape = Shape::new(&Scene::from_mesh(meshes::icosphere(3))).unwrap();
        let bvh = shape.scene().build(&BuildOptions::default()).unwrap();
        let mut random = Random::new(3);
        // Half of them from the middle.
        let rays: Vec<Ray> = (0..1000)
            .map(|index| {
                let from = if index < 500 { (random.direction() * 3.0).as_vec3() } else { Vec3::ZERO };
                Ray::new(from, random.direction().as_vec3())
            })
            .collect();
        let hits = rays.iter().map(|ray| bvh.closest(ray)).collect();
        Case { shape, rays, hits }
    }

    #[test]
    fn right_answers_pass() {
        let Case { shape, rays, hits } = case();
        let judge = Judge::new(shape.flat());
        let any: Vec<bool> = hits.iter().map(Hit::is_hit).collect();
        for verdict in [judge.closest(&rays, &hits, &hits), judge.any(&rays, &hits, &any)] {
            assert_eq!(verdict, Verdict { rays: 1000, ..Verdict::default() });
        }
    }

    #[test]
    fn one_lie_is_found_whatever_it_is() {
        let Case { shape, rays, hits } = case();
        let judge = Judge::new(shape.flat());
        let hit = hits.iter().position(Hit::is_hit).unwrap();
        let miss = hits.iter().position(|hit| !hit.is_hit()).unwrap();
        // From the middle of the ball, where nothing is farther.
        let inside = 777;
        let lie = |at: usize, lie: Hit| {
            let mut given = hits.clone();
            given[at] = lie;
            judge.closest(&rays, &hits, &given)
        };
        let one = Verdict { rays: 1000, differing: 1, ..Verdict::default() };
        assert_eq!(lie(hit, Hit::MISS), Verdict { missed: 1, ..one });
        assert_eq!(lie(miss, Hit { t: 1.0, ..hits[hit] }), Verdict { invented: 1, ..one });
        for t in [hits[inside].t * 1.01, hits[inside].t * 0.98, f32::NAN, -1.0] {
            assert_eq!(lie(inside, Hit { t, ..hits[inside] }), Verdict { wrong_t: 1, ..one }, "{t}");
        }
        assert_eq!(lie(inside, Hit { t: f32::NAN, primitive_index: 0xdead_beef, ..Hit::MISS }).wrong(), 1);
        let any = |at: usize| {
            let mut given: Vec<bool> = hits.iter().map(Hit::is_hit).collect();
            given[at] = !given[at];
            judge.any(&rays, &hits, &given)
        };
        assert_eq!(any(hit), Verdict { missed: 1, ..one });
        assert_eq!(any(miss), Verdict { invented: 1, ..one });
    }

    #[test]
    fn the_far_side_instead_of_the_near_one_is_wrong() {
        let Case { shape, rays, hits } = case();
        let judge = Judge::new(shape.flat());
        let bvh = shape.scene().build(&BuildOptions::default()).unwrap();
        let behind = |ray: &Ray, hit: &Hit| bvh.closest(&ray.window(hit.t * 1.01, f32::INFINITY));
        let (at, far) = rays
            .iter()
            .zip(&hits)
            .map(|(ray, hit)| if hit.is_hit() { behind(ray, hit) } else { Hit::MISS })
            .enumerate()
            .find(|(_, far)| far.is_hit())
            .unwrap();
        let mut given = hits.clone();
        given[at] = far;
        assert_eq!(judge.closest(&rays, &hits, &given).wrong_t, 1);
        // And a reference that is wrong is named.
        assert_eq!(judge.closest(&rays, &given, &hits).reference_wrong, 1);
    }

    #[test]
    fn missing_answers_are_no_agreement() {
        let Case { shape, rays, hits } = case();
        let judge = Judge::new(shape.flat());
        assert_eq!(judge.closest(&rays, &hits, &hits[..900]).suspect(), 100);
        assert_eq!(judge.any(&rays, &hits, &[]).suspect(), 1000);
    }
}
