//! Whether a setting answers as it must: to the bit on the CPU and on software adapters, and on hardware up to ties, edges
//! and rounding, of which oracles in f64 decide, one of two sides and one of one.

use super::batches::Part;
use crate::bench::{Judge, is_hardware};
use ropewalk::{Answer, FlatScene, Hit, Traced};
use ropewalk_gpu::Device;
use ropewalk_testkit::compare::nearly;
use ropewalk_testkit::oracle::Oracle;

/// Compares answers as exactly as a device can give them.
#[derive(Clone, Debug)]
pub(super) struct Verdict {
    judge: Judge,
    /// Of one side, for hardware.
    fronts: Option<Oracle>,
}

impl Verdict {
    /// For devices of which one may be hardware.
    pub(super) fn new(scene: &FlatScene, devices: &[Device]) -> Self {
        let fronts = || Oracle::new(scene).with_rounding(Oracle::RELAXED).one_sided();
        Self { judge: Judge::new(scene, devices), fronts: devices.iter().any(is_hardware).then(fronts) }
    }

    /// What is wrong with the first wrong answer, if any is.
    pub(super) fn compare(
        &self,
        device: &Device,
        part: &Part,
        is_one_sided: bool,
        given: &Traced,
    ) -> Result<(), String> {
        match &self.fronts {
            Some(oracle) if is_one_sided && is_hardware(device) => {
                nearly(oracle, &part.rays, &part.one_sided, given)
                    .map(drop)
                    .map_err(|mismatch| mismatch.to_string())
            }
            _ => {
                let reference = if is_one_sided { &part.one_sided } else { &part.two_sided };
                self.judge.compare(device, &part.rays, reference, given).map(drop)
            }
        }
    }
}

/// By how much of itself the `t` of a hit may be off where hardware rounds otherwise.
const ROUNDED: f32 = 1e-4;

/// How many rays have another answer than they must; of hardware, how many hit nothing or what is farther off.
pub(super) fn lost(reference: &Traced, given: &Traced, is_hardware: bool) -> usize {
    match (&reference.answer, &given.answer) {
        (Answer::Closest(expected), Answer::Closest(given)) => {
            let is_farther = |a: &Hit, b: &Hit| a.is_hit() && !(b.is_hit() && b.t <= a.t * (1.0 + ROUNDED));
            let differs = |(a, b): &(&Hit, &Hit)| match is_hardware {
                true => is_farther(a, b),
                false => a.to_words() != b.to_words(),
            };
            expected.iter().zip(given).filter(differs).count()
        }
        (Answer::Any(expected), Answer::Any(given)) => {
            expected.iter().zip(given).filter(|(a, b)| a != b).count()
        }
        _ => reference.answer.len(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::batches::Begin;
    use super::super::truth::{Sides, Truth};
    use super::*;
    use glam::Vec3;
    use ropewalk::{Query, Ray, Scene};
    use ropewalk_testkit::meshes;

    #[test]
    fn a_wrong_answer_is_found_and_counted() {
        let scene = Scene::from_mesh(meshes::icosphere(2));
        let truth = Truth::new(&scene).unwrap();
        let verdict = Verdict::new(&scene.flatten().unwrap(), &[Device::Cpu]);
        let rays = vec![
            Ray::new(Vec3::new(0.1, 0.2, 3.0), -Vec3::Z),
            Ray::new(Vec3::ZERO, Vec3::new(0.1, 0.2, 1.0)),
        ];
        let answer = |sides| truth.answer(sides, Query::Closest, &rays).unwrap();
        let (two_sided, one_sided) = (answer(Sides::Two), answer(Sides::One));
        let begin = Begin::Triangles(vec![0, 0]);
        let part = Part { query: Query::Closest, rays, begin, two_sided, one_sided };
        let compare =
            |is_one_sided, given: &Traced| verdict.compare(&Device::Cpu, &part, is_one_sided, given);
        assert_eq!(compare(false, &part.two_sided), Ok(()));
        assert_eq!(compare(true, &part.one_sided), Ok(()));
        // A back is no hit of one side, and of two it is one.
        assert!(compare(true, &part.two_sided).unwrap_err().contains("ray 1"));
        assert!(compare(false, &part.one_sided).unwrap_err().contains("ray 1"));
        let Answer::Closest(hits) = &part.two_sided.answer else { panic!("{part:?}") };
        let off = Hit { t: hits[0].t.next_up(), ..hits[0] };
        let wrong = Traced { answer: Answer::Closest(vec![off, hits[1]]), ..part.two_sided.clone() };
        assert!(compare(false, &wrong).unwrap_err().contains("ray 0"));
        let exactly = |reference: &Traced, given: &Traced| lost(reference, given, false);
        assert_eq!(exactly(&part.two_sided, &part.two_sided), 0);
        assert_eq!(exactly(&part.two_sided, &part.one_sided), 1);
        assert_eq!(exactly(&part.one_sided, &wrong), 2);
        // Of hardware neither rounding counts nor a hit too many.
        assert_eq!(lost(&part.one_sided, &wrong, true), 0);
        assert_eq!(lost(&part.two_sided, &part.one_sided, true), 1);
        let far = Hit { t: hits[0].t * 1.5, ..hits[0] };
        let far = Traced { answer: Answer::Closest(vec![far, hits[1]]), ..part.two_sided.clone() };
        assert_eq!(lost(&part.two_sided, &far, true), 1);
        let any = Traced { answer: Answer::Any(vec![true, false]), ..part.two_sided.clone() };
        let other = Traced { answer: Answer::Any(vec![true, true]), ..any.clone() };
        assert_eq!((exactly(&any, &other), exactly(&any, &part.two_sided)), (1, 2));
    }
}
