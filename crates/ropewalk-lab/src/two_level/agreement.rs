//! Whether a setting answers as the flattened BVH does, up to rounding.
//!
//! Rays are taken to objects, and objects may be turned, so `t` is rounded otherwise, and where triangles meet or lie in one
//! place another may be named. What is asked: the same triangle, and the hit in the same place within [`TOLERANCE`]; or another
//! one that is in that place too; or else an oracle in f64 that finds nothing to object to either. All but the first are counted.

use super::batches::{Batch, Flat};
use crate::bench::is_hardware;
use glam::{DMat3, DVec3, Vec3};
use rayon::prelude::*;
use ropewalk::{Answer, FlatScene, Hit, Instance, Ray, Scene, Status, Traced};
use ropewalk_gpu::Device;
use ropewalk_testkit::compare::objection;
use ropewalk_testkit::oracle::{Candidate, Oracle};
use ropewalk_testkit::points::Measured;
use std::collections::HashMap;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// How far two hits may be apart to be in one place, as a part of the largest number in play: the scene's and the origin's
/// coordinates and the way to the hit. It is what the project promises for hits on graphics hardware.
const TOLERANCE: f64 = 1e-5;

/// Compares answers.
pub(super) struct Judge<'a> {
    flat: &'a Flat,
    oracle: Oracle,
    size: f64,
    /// What the oracle said of a ray of a batch, by their indices: most settings disagree on the same ones.
    asked: Mutex<Asked>,
}

type Asked = HashMap<(usize, usize), Vec<Candidate>>;

/// How two answers compare.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Verdict {
    Same,
    /// Another triangle in the same place.
    Beside,
    /// The oracle must say.
    Unclear,
}

impl<'a> Judge<'a> {
    pub(super) fn new(flat: &'a Flat, scene: &Scene, whole: &FlatScene, devices: &[Device]) -> Self {
        let bounds = flat.bounds();
        let size = f64::from(bounds.min.abs().max(bounds.max.abs()).max_element());
        let rounding = if devices.iter().any(is_hardware) { Oracle::RELAXED } else { 1.0 };
        let oracle = Oracle::new(whole).with_rounding(rounding).taking_rays(taking_rays(scene));
        Self { flat, oracle, size, asked: Mutex::default() }
    }

    /// How many rays of the batch of that index have another answer that is right too; or what is wrong with the first wrong
    /// answer.
    pub(super) fn compare(&self, index: usize, batch: &Batch, given: &Traced) -> Result<usize, String> {
        let rays = &batch.rays;
        let same_kind = given.answer.query() == batch.expected.answer.query();
        if given.answer.len() != rays.len() || given.status.len() != rays.len() || !same_kind {
            let (count, query) = (given.answer.len(), given.answer.query());
            return Err(format!("there are {count} answers of '{}' for {} rays", query.name(), rays.len()));
        }
        for (place, (ray, &status)) in rays.iter().zip(&given.status).enumerate() {
            let expected = if ray.is_valid() { Status::COMPLETE } else { Status::INVALID_RAY };
            if status != expected {
                return Err(format!("ray {place}: the status is {status:?}, not {expected:?}"));
            }
        }
        let verdict = |place: usize| match (&batch.expected.answer, &given.answer) {
            (Answer::Closest(a), Answer::Closest(b)) => self.closest(&rays[place], &a[place], &b[place]),
            (Answer::Any(a), Answer::Any(b)) if a[place] == b[place] => Verdict::Same,
            _ => Verdict::Unclear,
        };
        let verdicts: Vec<Verdict> =
            (0..rays.len()).into_par_iter().with_min_len(1024).map(verdict).collect();
        let beside = verdicts.iter().filter(|&&verdict| verdict == Verdict::Beside).count();
        let unclear: Vec<usize> =
            (0..rays.len()).filter(|&place| verdicts[place] == Verdict::Unclear).collect();
        self.ask(index, rays, &unclear);
        let asked = self.asked();
        for &place in &unclear {
            let candidates = asked.get(&(index, place)).map_or(&[][..], Vec::as_slice);
            let of = |answer: &Answer| objection(&rays[place], candidates, answer, place);
            let of_reference =
                || of(&batch.expected.answer).map(|why| format!("the flattened BVH itself is wrong: {why}"));
            if let Some(why) = of(&given.answer).or_else(of_reference) {
                let (expected, given) = (told(&batch.expected.answer, place), told(&given.answer, place));
                let Ray { origin, dir, .. } = rays[place];
                return Err(format!(
                    "ray {place} (origin {:?}, dir {:?}): {why}; the flattened BVH says {expected}, this {given}",
                    origin.to_array(),
                    dir.to_array()
                ));
            }
        }
        Ok(beside + unclear.len())
    }

    /// Nothing panics while it is held, so it is whole whatever the lock says.
    fn asked(&self) -> MutexGuard<'_, Asked> {
        self.asked.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Asks the oracle of rays of which it has not said anything.
    fn ask(&self, index: usize, rays: &[Ray], places: &[usize]) {
        let mut asked = self.asked();
        let new: Vec<usize> =
            places.iter().copied().filter(|&place| !asked.contains_key(&(index, place))).collect();
        let said: Vec<_> = new.par_iter().map(|&place| self.oracle.candidates(&rays[place])).collect();
        asked.extend(new.into_iter().map(|place| (index, place)).zip(said));
    }

    fn closest(&self, ray: &Ray, expected: &Hit, given: &Hit) -> Verdict {
        if expected.to_words() == given.to_words() {
            return Verdict::Same;
        }
        if !expected.is_hit() || !given.is_hit() {
            return Verdict::Unclear;
        }
        let (origin, dir) = (ray.origin.as_dvec3(), ray.dir.as_dvec3());
        let (a, b) = (f64::from(expected.t), f64::from(given.t));
        let largest = self.size.max(origin.abs().max_element()).max(a * dir.length());
        let room = TOLERANCE * largest;
        // A NaN is not near.
        let is_near = (a - b).abs() * dir.length() <= room;
        if !is_near {
            return Verdict::Unclear;
        }
        if expected.id() == given.id() {
            return if expected.front_face == given.front_face { Verdict::Same } else { Verdict::Unclear };
        }
        let place: DVec3 = origin + dir * b;
        let is_there = self.flat.triangle(given).is_some_and(|triangle| {
            let corners = triangle.triangle().vertices.map(Vec3::as_dvec3);
            Measured::new(place, &corners).distance <= room
        });
        if is_there { Verdict::Beside } else { Verdict::Unclear }
    }
}

fn told(answer: &Answer, place: usize) -> String {
    match answer {
        Answer::Closest(hits) => hits.get(place).map(|hit| format!("{hit:?}")),
        Answer::Any(hits) => hits.get(place).map(bool::to_string),
        _ => None,
    }
    .unwrap_or_else(|| "nothing".into())
}

/// How many times a ray's error is what it is otherwise, where rays are taken to objects: origin and direction are rounded by some
/// units more, and the inverse of a transform makes that larger by as much as its longest axis is longer than its shortest.
fn taking_rays(scene: &Scene) -> f64 {
    let stretch = |instance: &Instance| {
        let matrix = instance.transform.to_world().matrix3.as_dmat3();
        let norm = |matrix: DMat3| matrix.to_cols_array().map(|it| it * it).iter().sum::<f64>().sqrt();
        norm(matrix) * norm(matrix.inverse())
    };
    8.0 * scene.instances.iter().map(stretch).fold(1.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::super::batches::{make, tests as scenes};
    use super::*;
    use ropewalk::{NoMonitor, StructureSpec, TraceOptions};

    #[test]
    fn every_kind_of_wrong_answer_is_found() {
        let scene = scenes::balls();
        let flat = scenes::flat(&scene);
        let judge = Judge::new(&flat, &scene, &scene.flatten().unwrap(), &[Device::Cpu]);
        let batches = make(&flat, &scenes::sight(), 40).unwrap();
        let spec: StructureSpec = "two-level".parse().unwrap();
        let structure = spec.build(&scene, &NoMonitor).unwrap();
        for (index, batch) in batches.iter().enumerate() {
            let trace = || {
                let walk = structure.kind().default_walk();
                structure.trace(walk, batch.query(), &batch.rays, TraceOptions::default()).unwrap()
            };
            let differing = judge.compare(index, batch, &trace()).unwrap();
            assert!(100 * differing <= batch.rays.len(), "{differing}");
            let wrong = |change: &dyn Fn(&mut Traced)| {
                let mut given = trace();
                change(&mut given);
                judge.compare(index, batch, &given)
            };
            assert!(wrong(&|given| given.status[5] = Status::INVALID_RAY).unwrap_err().contains("ray 5"));
            assert!(wrong(&|given| given.answer = Answer::Count(vec![0; batch.rays.len()])).is_err());
            match &batch.expected.answer {
                Answer::Closest(hits) => {
                    let is_within = |hits: &[Hit]| hits.iter().all(Hit::is_hit);
                    let within = hits.windows(5).position(is_within).map(|first| first + 2);
                    let place = within.or_else(|| hits.iter().position(Hit::is_hit)).unwrap();
                    let hit = hits[place];
                    for other in [
                        Hit::MISS,
                        Hit { t: hit.t * 1.01, ..hit },
                        Hit { t: f32::NAN, ..hit },
                        Hit { primitive_index: hit.primitive_index ^ 64, ..hit },
                        Hit { instance_index: 77, ..hit },
                    ] {
                        let result = wrong(&|given| {
                            if let Answer::Closest(hits) = &mut given.answer {
                                hits[place] = other;
                            }
                        });
                        assert!(result.unwrap_err().contains(&format!("ray {place} (")), "{other:?}");
                    }
                    let shorter = wrong(&|given| {
                        if let Answer::Closest(hits) = &mut given.answer {
                            hits.pop();
                        }
                    });
                    assert!(shorter.unwrap_err().contains("answers"));
                }
                Answer::Any(hits) => {
                    let place = hits.len() / 2;
                    let result =
                        wrong(&|given| given.answer = Answer::Any(hits.iter().map(|it| !it).collect()));
                    assert!(result.is_err(), "{place}");
                }
                other => panic!("{other:?}"),
            }
        }
        // The oracle was asked of no ray twice, and says the same of it.
        assert!(judge.asked().keys().all(|&(index, place)| place < batches[index].rays.len()));
    }
}
