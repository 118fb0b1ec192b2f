//! Whether a walk on a device answers as the reference does: the condition for timing it.
//!
//! The comparators are those of the conformance suite. The CPU and software adapters must give the same bits;
//! hardware the same triangles, and `t` within 1e-5, ties and edges aside, of which the f64 oracle decides.

use ropewalk::{FlatScene, Ray, Traced};
use ropewalk_gpu::Device;
use ropewalk_testkit::compare::{Summary, nearly, same_bits};
use ropewalk_testkit::oracle::Oracle;
use serde::Serialize;

/// How the answers of a lane compare with the reference's.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Agreement {
    /// Rays that were compared.
    pub rays: usize,
    /// Rays at ties and edges whose answers differ and are right all the same.
    pub differing: usize,
    /// The classes whose answers are wrong; they are not timed.
    pub failed: Vec<Disagreement>,
}

/// A class with a wrong answer.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Disagreement {
    /// The kind of rays.
    pub class: String,
    /// The first wrong answer.
    pub what: String,
}

/// Compares answers as exactly as a device can give them.
#[derive(Clone, Debug)]
pub(crate) struct Judge {
    /// For hardware; without it answers must be the same bits.
    oracle: Option<Oracle>,
}

impl Judge {
    /// For devices of which one may be hardware.
    pub(crate) fn new(scene: &FlatScene, devices: &[Device]) -> Self {
        let oracle = || Oracle::new(scene).with_rounding(Oracle::RELAXED);
        Self { oracle: devices.iter().any(is_hardware).then(oracle) }
    }

    /// What was seen, or what is wrong with the first wrong answer.
    pub(crate) fn compare(
        &self,
        device: &Device,
        rays: &[Ray],
        reference: &Traced,
        given: &Traced,
    ) -> Result<Summary, String> {
        let compared = match &self.oracle {
            Some(oracle) if is_hardware(device) => nearly(oracle, rays, reference, given),
            _ => same_bits(rays, reference, given, false),
        };
        compared.map_err(|mismatch| mismatch.to_string())
    }
}

/// Whether a device may fuse a product with a sum and divide by an approximate reciprocal.
pub(crate) fn is_hardware(device: &Device) -> bool {
    match device {
        Device::Cpu => false,
        Device::Gpu(tracer) => !tracer.gpu().is_software(),
    }
}

impl Agreement {
    /// Whether everything may be timed.
    #[must_use]
    pub fn holds(&self) -> bool {
        self.failed.is_empty()
    }

    /// Takes down how a batch compared; says whether it may be timed.
    pub(super) fn note(&mut self, class: &str, compared: Result<Summary, String>) -> bool {
        match compared {
            Ok(summary) => {
                self.rays += summary.rays;
                self.differing += summary.differing;
                true
            }
            Err(what) => {
                self.failed.push(Disagreement { class: class.into(), what });
                false
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ropewalk::glam::Vec3;
    use ropewalk::{Answer, Hit, Mesh, Query, Scene, StructureSpec, TraceOptions, Walk};

    #[test]
    fn a_wrong_answer_is_not_timed() {
        let scene = Scene::from_mesh(Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]));
        let structure = StructureSpec::default().build(&scene, &ropewalk::NoMonitor).unwrap();
        let rays = [Ray::new(Vec3::new(0.2, 0.2, 1.0), Vec3::NEG_Z), Ray::new(Vec3::ONE, Vec3::NEG_Z)];
        let good = structure.trace(Walk::default(), Query::Closest, &rays, TraceOptions::default()).unwrap();
        let judge = Judge::new(&scene.flatten().unwrap(), &[Device::Cpu]);
        let mut agreement = Agreement::default();
        assert!(agreement.note("good", judge.compare(&Device::Cpu, &rays, &good, &good)));
        let Answer::Closest(hits) = &good.answer else { panic!("{good:?}") };
        let off = Hit { t: hits[0].t.next_up(), ..hits[0] };
        for wrong in [vec![Hit::MISS, Hit::MISS], vec![off, Hit::MISS], vec![hits[0]]] {
            let wrong = Traced { answer: Answer::Closest(wrong), ..good.clone() };
            assert!(!agreement.note("wrong", judge.compare(&Device::Cpu, &rays, &good, &wrong)));
        }
        assert!(!agreement.holds());
        assert_eq!((agreement.rays, agreement.failed.len()), (2, 3));
    }
}
