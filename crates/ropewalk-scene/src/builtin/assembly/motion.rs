//! The machine runs, comes apart, and goes together again.
//!
//! First the crank is turned: every part of a shaft turns about its axis as [`train::angles`] says, and the balls of the bearings
//! roll. Then the parts fly apart in the order in which they would be taken off, along the axes on which they sit; they stay so
//! for a while, and come back. The camera steps back to see them.
//!
//! **Invariant.** Where nothing has moved yet, every part stands to the bit where the still machine has it.

use super::train::{self, Angles};
use super::{INPUT_ANGLE, at};
use crate::animation::{Clip, Motion, Pose, Span};
use crate::builtin::stage::affine;
use crate::{Camera, Light};
use glam::{DAffine3, DVec3, Vec3};
use std::f64::consts::TAU;

/// For so many seconds the crank is turned, the parts fly apart, stay apart, and come back.
const TURNING: f64 = 4.0;
const PARTING: f64 = 1.5;
const APART: f64 = 1.0;
const JOINING: f64 = 1.5;
/// How often the crank is turned.
const TURNS: f64 = 2.0;
/// How much further than the machine's the distance of the camera is from the parts, and how much higher it looks.
const STEP_BACK: f32 = 0.8;
const LOOK_UP: f32 = 1.6;

/// A shaft.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Shaft {
    Input,
    Middle,
    Output,
}

impl Shaft {
    fn angle(self, angles: &Angles) -> f64 {
        match self {
            Self::Input => angles.input,
            Self::Middle => angles.middle,
            Self::Output => angles.output,
        }
    }

    fn x(self) -> f64 {
        match self {
            Self::Input => train::INPUT_X,
            Self::Middle => train::MIDDLE_X,
            Self::Output => train::OUTPUT_X,
        }
    }
}

/// How a part is held, and where it goes when the machine comes apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Mount {
    /// The shaft about whose axis it turns, and its share of the shaft's turn.
    turns: Option<(Shaft, f64)>,
    /// Where it goes, in the machine's space.
    away: DVec3,
    /// How far it is pulled out of its seat, along its own y axis.
    pulled: f64,
}

impl Mount {
    /// What stays where it is.
    pub(super) const FIXED: Self = Self { turns: None, away: DVec3::ZERO, pulled: 0.0 };

    /// What does not turn, and goes away like this.
    pub(super) const fn still(x: f64, y: f64, z: f64) -> Self {
        Self { turns: None, away: DVec3::new(x, y, z), pulled: 0.0 }
    }

    /// What turns with a shaft.
    pub(super) const fn on(shaft: Shaft, y: f64, z: f64) -> Self {
        Self { turns: Some((shaft, 1.0)), ..Self::still(0.0, y, z) }
    }

    /// What turns by a share of the shaft's turn.
    pub(super) const fn rolling(shaft: Shaft, share: f64, y: f64, z: f64) -> Self {
        Self { turns: Some((shaft, share)), ..Self::still(0.0, y, z) }
    }

    /// The same, pulled out along its own y axis too.
    pub(super) const fn pulled(self, pulled: f64) -> Self {
        Self { pulled, ..self }
    }

    /// Where the part is, in the machine's space.
    fn place(&self, placement: &DAffine3, moment: &Moment) -> DAffine3 {
        let mut place = *placement;
        if let Some((shaft, share)) = self.turns {
            let turn = share * (shaft.angle(&moment.angles) - shaft.angle(&train::angles(INPUT_ANGLE)));
            if turn != 0.0 {
                place = at(shaft.x(), 0.0, 0.0)
                    * DAffine3::from_rotation_z(turn)
                    * at(-shaft.x(), 0.0, 0.0)
                    * place;
            }
        }
        if moment.apart > 0.0 {
            place = DAffine3::from_translation(self.away * moment.apart)
                * place
                * DAffine3::from_translation(DVec3::Y * (self.pulled * moment.apart));
        }
        place
    }
}

/// What the machine does at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Moment {
    angles: Angles,
    /// From 0 for together to 1 for apart.
    apart: f64,
}

impl Moment {
    fn at(time: f64) -> Self {
        let phase = |from: f64, length: f64| {
            let share = ((time - from) / length).clamp(0.0, 1.0);
            share * share * (3.0 - 2.0 * share)
        };
        let turned = phase(0.0, TURNING) * TURNS * TAU;
        let apart = phase(TURNING, PARTING) - phase(TURNING + PARTING + APART, JOINING);
        Self { angles: train::angles(INPUT_ANGLE + turned), apart }
    }
}

/// The parts of the machine, in the order of their instances.
#[derive(Clone, Debug)]
pub(super) struct Machine {
    /// From the machine's space to the scene.
    pub(super) lift: DAffine3,
    /// Where each part is when nothing has moved, in the machine's space.
    pub(super) parts: Vec<(DAffine3, Mount)>,
    /// What stands beside the machine, behind its parts.
    pub(super) others: Vec<DAffine3>,
    pub(super) camera: Camera,
    pub(super) light: Light,
    /// What the camera looks at.
    pub(super) target: Vec3,
}

/// What the machine does, and how long.
pub(super) fn clip() -> Clip {
    let span = Span::of_seconds(0.0, TURNING + PARTING + APART + JOINING);
    Clip { name: "run and come apart".into(), span }
}

impl Motion for Machine {
    fn pose(&self, _clip: usize, time: f64) -> Pose {
        let time = if time.is_nan() { 0.0 } else { time };
        let moment = Moment::at(time);
        let parts = self.parts.iter().map(|(part, mount)| affine(&(self.lift * mount.place(part, &moment))));
        let transforms: Vec<_> = parts.chain(self.others.iter().map(affine)).collect();
        let apart = moment.apart as f32;
        let mut camera = self.camera.clone();
        if apart > 0.0 {
            let way = camera.position - self.target;
            camera.position = self.target + way * (1.0 + STEP_BACK * apart) + Vec3::Y * (LOOK_UP * apart);
        }
        Pose {
            time,
            visible: vec![true; transforms.len()],
            transforms,
            cameras: vec![camera],
            lights: vec![self.light.clone()],
            shapes: Vec::new(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_machine_turns_then_parts_then_joins() {
        let start = Moment::at(0.0);
        assert_eq!(start, Moment { angles: train::angles(INPUT_ANGLE), apart: 0.0 });
        assert_eq!(Moment::at(-5.0), start);
        let turned = Moment::at(TURNING);
        assert!((turned.angles.input - INPUT_ANGLE - TURNS * TAU).abs() < 1e-12 && turned.apart == 0.0);
        let apart = Moment::at(TURNING + PARTING + APART / 2.0);
        assert_eq!((apart.angles, apart.apart), (turned.angles, 1.0));
        let end = clip().span.end;
        assert_eq!(Moment::at(end), turned);
        assert_eq!(Moment::at(2.0 * end), turned);
    }

    #[test]
    fn a_turning_part_is_where_the_train_says() {
        let moment = Moment::at(1.7);
        for shaft in [Shaft::Input, Shaft::Middle, Shaft::Output] {
            let start = shaft.angle(&train::angles(INPUT_ANGLE));
            let on_shaft = |angle| super::super::on_shaft(shaft.x(), angle, 0.3);
            let found = Mount::on(shaft, 1.0, 2.0).place(&on_shaft(start), &moment);
            assert!(found.abs_diff_eq(on_shaft(shaft.angle(&moment.angles)), 1e-12), "{shaft:?}");
            assert!(!found.abs_diff_eq(on_shaft(start), 1e-3), "the comparison objects");
        }
    }

    /// Gears in mesh let as many teeth pass the line between their axes, one way and the other.
    #[test]
    fn the_teeth_stay_in_mesh() {
        let first = Moment::at(0.0).angles;
        for step in 1..50 {
            let angles = Moment::at(f64::from(step) * TURNING / 50.0).angles;
            for (teeth, turn, mate, mate_turn) in [
                (
                    train::INPUT_PINION,
                    angles.input - first.input,
                    train::MIDDLE_WHEEL,
                    angles.middle - first.middle,
                ),
                (
                    train::MIDDLE_PINION,
                    angles.middle - first.middle,
                    train::OUTPUT_WHEEL,
                    angles.output - first.output,
                ),
            ] {
                let passed = (turn * f64::from(teeth.count) + mate_turn * f64::from(mate.count)) / TAU;
                assert!((passed - passed.round()).abs() < 1e-9 && turn != 0.0, "{step}: {passed}");
            }
        }
    }
}
