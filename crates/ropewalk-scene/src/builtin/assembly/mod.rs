//! A two-stage reducer, cut open: the scene that shows what ropewalk can do.
//!
//! Three shafts in ball bearings, a pair of helical and a pair of spur gears, a split housing whose cover
//! is cut so that one looks at the wheels, and all that holds it together. Equal parts share one object. The
//! measures that parts have in common stand with their owner: axes, teeth and ratios in [`train`], walls and bolt
//! places in [`housing`], so that a part is where it belongs when one of them changes.
//!
//! One unit is a decimetre. The machine is built with the axes at y = 0 and then lifted onto the ground, y = 0.

mod bearing;
mod fasteners;
mod fittings;
mod gear;
mod housing;
mod motion;
mod palette;
mod shafts;
mod teeth;
mod train;

use super::shape::Solid;
use super::shape::primitives::ground_square;
use super::stage::{Stage, camera};
use crate::animation::Animated;
use crate::{Light, Model};
use bearing::Bearing;
use fasteners::{dowel_pin, hexagon_bolt, hexagon_nut, key, socket_screw, washer, washer_height};
use fittings::{CAP, CAP_SCREW, CRANK_WIDTH, PLATE, PLATE_SCREW};
use gear::{Body, Gear};
use glam::{DAffine3, DVec3, Vec3};
use housing::{BOSS_END, END, FEET_BOTTOM, FEET_TOP, FLANGE_BOLT, FLANGE_HEIGHT, FOOT_BOLT};
use motion::{Machine, Mount, Shaft};
use palette::{BLUED, BRIGHT, BRONZE, DARK, GROUND, STEEL, ZINC};
use std::f64::consts::PI;
use std::sync::Arc;
use train::{FIRST_STAGE_Z, INPUT_X, MIDDLE_X, OUTPUT_X, SECOND_STAGE_Z};

/// How far the input shaft is turned, in radians.
const INPUT_ANGLE: f64 = 0.35;

/// The thickness of the rubber under the feet.
const PAD: f64 = 0.05;

/// The scene.
pub(crate) fn assembly() -> Model {
    build().0
}

/// The scene with its motion.
pub(crate) fn animated() -> Animated {
    let (model, machine) = build();
    Animated::new(model, vec![motion::clip()], Arc::new(machine))
}

fn build() -> (Model, Machine) {
    let mut assembly = Assembly {
        stage: Stage::new(palette::materials()),
        lift: DAffine3::from_translation(DVec3::Y * (PAD - FEET_BOTTOM)),
        mount: Mount::FIXED,
        parts: Vec::new(),
    };
    assembly.housing();
    assembly.train();
    assembly.bearings();
    assembly.flange_bolts();
    assembly.feet();
    assembly.end_caps();
    assembly.fittings();
    assembly.crank();
    let ground = assembly.stage.flat_part("ground", &ground_square(40.0, GROUND));
    assembly.stage.place(ground, &DAffine3::IDENTITY);
    let target = [0.02, 1.5, 0.2];
    let camera = camera("three-quarter", [-5.4, 6.2, 9.4], target, 29.0);
    let light =
        Light::Sun { direction: Vec3::new(0.66, -1.0, -0.55), color: Vec3::new(1.0, 0.95, 0.86) * 2.6 };
    let machine = Machine {
        lift: assembly.lift,
        parts: assembly.parts,
        others: vec![DAffine3::IDENTITY],
        camera: camera.clone(),
        light: light.clone(),
        target: target.into(),
    };
    (assembly.stage.finish(camera, light), machine)
}

/// How far parts go when the machine comes apart: what lies in the trough is lifted out of it, the cover above that; then all
/// slides along the shafts, what sits further out further.
const TRAIN_UP: f64 = 1.4;
const COVER_UP: f64 = 3.2;
const GEAR_OFF: f64 = 1.6;
const BEARING_OFF: f64 = 2.3;
const CAP_OFF: f64 = 1.2;
const CRANK_OFF: f64 = 3.3;
const KEY_OUT: f64 = 0.35;

/// The machine in the making.
struct Assembly {
    stage: Stage,
    lift: DAffine3,
    /// How what is placed now is held.
    mount: Mount,
    /// What was placed, without the lift.
    parts: Vec<(DAffine3, Mount)>,
}

/// A shift along the shafts from a place in the plane across them.
fn at(x: f64, y: f64, z: f64) -> DAffine3 {
    DAffine3::from_translation(DVec3::new(x, y, z))
}

/// A turn about the axis of a shaft at x, and a place along it.
fn on_shaft(x: f64, angle: f64, z: f64) -> DAffine3 {
    at(x, 0.0, z) * DAffine3::from_rotation_z(angle)
}

/// Turns what looks along z so that it looks up.
fn upward() -> DAffine3 {
    DAffine3::from_rotation_x(-PI / 2.0)
}

impl Assembly {
    fn place(&mut self, object: u32, placement: DAffine3) {
        self.stage.place(object, &(self.lift * placement));
        self.parts.push((placement, self.mount));
    }

    fn single(&mut self, name: &str, solid: &Solid, placement: DAffine3) {
        let object = self.stage.part(name, solid);
        self.place(object, placement);
    }

    fn housing(&mut self) {
        self.single("housing trough", &housing::trough(), DAffine3::IDENTITY);
        self.mount = Mount::still(0.0, COVER_UP, 0.0);
        self.single("housing cover, cut", &housing::cover(), DAffine3::IDENTITY);
    }

    /// Shafts, gears and keys: all that turns.
    fn train(&mut self) {
        let angles = train::angles(INPUT_ANGLE);
        self.mount = Mount::on(Shaft::Input, TRAIN_UP, 0.0);
        self.single("input shaft", &shafts::input(), on_shaft(INPUT_X, angles.input, 0.0));
        self.mount = Mount::on(Shaft::Middle, TRAIN_UP, 0.0);
        self.single("middle shaft", &shafts::middle(), on_shaft(MIDDLE_X, angles.middle, 0.0));
        self.mount = Mount::on(Shaft::Output, TRAIN_UP, 0.0);
        self.single("output shaft", &shafts::output(), on_shaft(OUTPUT_X, angles.output, 0.0));
        let pinion = Gear {
            teeth: train::INPUT_PINION,
            width: 0.58,
            helix: train::HELIX,
            bore: 0.29,
            key: 0.09,
            body: Body::Plain,
            paint: (STEEL, BRIGHT),
        };
        let wheel = Gear {
            teeth: train::MIDDLE_WHEEL,
            width: 0.54,
            // The mate of a gear with this helix, at the same speed of the pitch circles.
            helix: -train::HELIX,
            bore: 0.31,
            key: 0.1,
            body: Body::Web {
                rim: 0.95,
                hub: 0.46,
                hub_width: 0.6,
                web_width: 0.2,
                holes: 6,
                hole_radius: 0.14,
                hole_circle: 0.705,
            },
            paint: (BRONZE, BRONZE),
        };
        // Off the back ends of their shafts.
        self.mount = Mount::on(Shaft::Input, TRAIN_UP, -GEAR_OFF);
        self.single("helical pinion", &pinion.solid(), on_shaft(INPUT_X, angles.input, FIRST_STAGE_Z));
        self.mount = Mount::on(Shaft::Middle, TRAIN_UP, -GEAR_OFF);
        self.single("helical wheel", &wheel.solid(), on_shaft(MIDDLE_X, angles.middle, FIRST_STAGE_Z));
        let pinion = Gear {
            teeth: train::MIDDLE_PINION,
            width: 0.78,
            helix: 0.0,
            bore: 0.29,
            key: 0.09,
            body: Body::Plain,
            paint: (STEEL, BRIGHT),
        };
        let wheel = Gear {
            teeth: train::OUTPUT_WHEEL,
            width: 0.7,
            helix: 0.0,
            bore: 0.39,
            key: 0.12,
            body: Body::Web {
                rim: 1.08,
                hub: 0.58,
                hub_width: 0.84,
                web_width: 0.24,
                holes: 8,
                hole_radius: 0.15,
                hole_circle: 0.83,
            },
            paint: (STEEL, BRIGHT),
        };
        // Off the front ends.
        self.mount = Mount::on(Shaft::Middle, TRAIN_UP, GEAR_OFF);
        self.single("spur pinion", &pinion.solid(), on_shaft(MIDDLE_X, angles.middle, SECOND_STAGE_Z));
        self.mount = Mount::on(Shaft::Output, TRAIN_UP, GEAR_OFF);
        self.single("spur wheel", &wheel.solid(), on_shaft(OUTPUT_X, angles.output, SECOND_STAGE_Z));
        let small = self.stage.part("key 9 mm", &key(0.09, 0.5, 0.2, 0.32, DARK));
        self.mount = Mount::on(Shaft::Input, TRAIN_UP, 0.0).pulled(KEY_OUT);
        self.place(small, on_shaft(INPUT_X, angles.input, FIRST_STAGE_Z));
        self.mount = Mount::on(Shaft::Middle, TRAIN_UP, 0.0).pulled(KEY_OUT);
        self.place(small, on_shaft(MIDDLE_X, angles.middle, SECOND_STAGE_Z + 0.16));
        self.single(
            "key 10 mm",
            &key(0.1, 0.56, 0.22, 0.345, DARK),
            on_shaft(MIDDLE_X, angles.middle, FIRST_STAGE_Z),
        );
        self.mount = Mount::on(Shaft::Output, TRAIN_UP, 0.0).pulled(KEY_OUT);
        self.single(
            "key 12 mm",
            &key(0.12, 0.8, 0.29, 0.434, DARK),
            on_shaft(OUTPUT_X, angles.output, SECOND_STAGE_Z),
        );
    }

    fn bearings(&mut self) {
        let angles = train::angles(INPUT_ANGLE);
        for (name, bearing, shafts) in [
            (
                "6310",
                Bearing::SMALL,
                vec![(Shaft::Input, INPUT_X, angles.input), (Shaft::Middle, MIDDLE_X, angles.middle)],
            ),
            ("6313", Bearing::LARGE, vec![(Shaft::Output, OUTPUT_X, angles.output)]),
        ] {
            let inner = self.stage.part(&format!("bearing {name} inner ring"), &bearing.inner_ring());
            let outer = self.stage.part(&format!("bearing {name} outer ring"), &bearing.outer_ring());
            let cage = self.stage.part(&format!("bearing {name} cage half"), &bearing.cage_half());
            let ball = self.stage.part(&format!("bearing {name} ball"), &bearing.ball());
            for (shaft, x, angle) in shafts {
                for side in [-1.0, 1.0] {
                    let z = side * (housing::INSIDE + 0.19);
                    let away = |further: f64| side * (BEARING_OFF + further);
                    self.mount = Mount::on(shaft, TRAIN_UP, away(0.0));
                    self.place(inner, on_shaft(x, angle, z));
                    self.mount = Mount::still(0.0, TRAIN_UP, away(0.5));
                    if bearing == Bearing::LARGE && side > 0.0 {
                        // Cut open, so that one sees the balls run.
                        let name = format!("bearing {name} outer ring, cut");
                        self.single(&name, &bearing.open_outer_ring(1.2, 2.7), on_shaft(x, 0.0, z));
                    } else {
                        self.place(outer, on_shaft(x, 0.0, z));
                    }
                    // Balls and cage roll: they turn by the share of the inner ring's way that falls to it.
                    let share = bearing.bore / (bearing.bore + bearing.outer);
                    let rolled = angle * share;
                    self.mount = Mount::rolling(shaft, share, TRAIN_UP, away(0.25));
                    self.place(cage, on_shaft(x, rolled, z));
                    self.place(cage, on_shaft(x, rolled, z) * DAffine3::from_rotation_x(PI));
                    for place in bearing.ball_places(rolled) {
                        self.place(ball, at(x, 0.0, z) * DAffine3::from_translation(place));
                    }
                }
            }
        }
        let sleeve = self.stage.part("spacer sleeve", &Bearing::SMALL.spacer(0.14));
        self.mount = Mount::on(Shaft::Input, TRAIN_UP, BEARING_OFF - 0.3);
        self.place(sleeve, at(INPUT_X, 0.0, 0.79));
        self.mount = Mount::on(Shaft::Middle, TRAIN_UP, BEARING_OFF - 0.3);
        self.place(sleeve, at(MIDDLE_X, 0.0, 0.79));
    }

    /// Bolts, washers and nuts around the split. Where the cover is cut away, so are its bolts.
    fn flange_bolts(&mut self) {
        let thick = washer_height(FLANGE_BOLT);
        let length = 2.0 * (FLANGE_HEIGHT + thick) + 1.6 * FLANGE_BOLT + 0.05;
        let bolt = self.stage.part("bolt M10", &hexagon_bolt(FLANGE_BOLT, length, ZINC));
        let nut = self.stage.part("nut M10", &hexagon_nut(FLANGE_BOLT, ZINC));
        let ring = self.stage.part("washer 10", &washer(FLANGE_BOLT, ZINC));
        for (i, place) in housing::flange_bolts().into_iter().enumerate() {
            let spot = DVec3::new(place.x, 0.0, place.y);
            if housing::section().beyond(spot) > -3.0 * FLANGE_BOLT {
                continue;
            }
            // Nobody tightens all heads to one direction.
            let turn = DAffine3::from_rotation_z(1.3 * i as f64);
            let level = |y: f64| at(place.x, y, place.y) * upward();
            self.mount = Mount::still(0.0, COVER_UP + 0.3, 0.0);
            self.place(ring, level(FLANGE_HEIGHT));
            self.mount = Mount::still(0.0, COVER_UP + 0.7, 0.0);
            self.place(bolt, level(FLANGE_HEIGHT + thick) * turn);
            self.mount = Mount::still(0.0, -0.3, 0.0);
            self.place(ring, level(-FLANGE_HEIGHT - thick));
            self.mount = Mount::still(0.0, -0.6, 0.0);
            self.place(nut, level(-FLANGE_HEIGHT - thick - 1.6 * FLANGE_BOLT) * turn);
        }
        self.mount = Mount::still(0.0, 0.6, 0.0);
        let pin = self.stage.part("dowel pin", &dowel_pin(0.038, 0.34, BRIGHT));
        for place in housing::flange_pins() {
            self.place(pin, at(place.x, -0.02, place.y) * upward());
        }
    }

    fn feet(&mut self) {
        let thick = washer_height(FOOT_BOLT);
        let bolt =
            self.stage.part("bolt M15", &hexagon_bolt(FOOT_BOLT, FEET_TOP - FEET_BOTTOM + thick, ZINC));
        let ring = self.stage.part("washer 15", &washer(FOOT_BOLT, ZINC));
        let pad = self.stage.part("rubber pad", &fittings::pad(PAD));
        for (i, place) in housing::foot_bolts().into_iter().enumerate() {
            let turn = DAffine3::from_rotation_z(0.9 * i as f64);
            self.mount = Mount::still(0.0, 0.35, 0.0);
            self.place(ring, at(place.x, FEET_TOP, place.y) * upward());
            self.mount = Mount::still(0.0, 0.7, 0.0);
            self.place(bolt, at(place.x, FEET_TOP + thick, place.y) * upward() * turn);
            self.mount = Mount::FIXED;
            self.place(pad, at(place.x, FEET_BOTTOM - PAD, place.y - 0.13 * place.y.signum()) * upward());
        }
    }

    /// The caps over the bearings: whole ones at the back, the lower half of one at the front.
    fn end_caps(&mut self) {
        let back = |x: f64| at(x, 0.0, -BOSS_END) * DAffine3::from_rotation_y(PI);
        let screw = self.stage.part("socket screw M7", &socket_screw(CAP_SCREW, 0.2, BLUED));
        let small = self.stage.part("end cap, small", &fittings::end_cap(&Bearing::SMALL, 0.0));
        let large = self.stage.part("end cap, large", &fittings::end_cap(&Bearing::LARGE, 0.0));
        let half = self.stage.part("end cap, cut", &fittings::half_cap(&Bearing::SMALL, 0.0));
        let front = at(MIDDLE_X, 0.0, BOSS_END);
        for (cap, bearing, place) in [
            (small, Bearing::SMALL, back(INPUT_X)),
            (small, Bearing::SMALL, back(MIDDLE_X)),
            (large, Bearing::LARGE, back(OUTPUT_X)),
            (half, Bearing::SMALL, front),
        ] {
            let side = if cap == half { 1.0 } else { -1.0 };
            self.mount = Mount::still(0.0, 0.0, side * CAP_OFF);
            self.place(cap, place);
            self.mount = Mount::still(0.0, 0.0, side * (CAP_OFF + 0.5));
            for spot in fittings::cap_screws(&bearing) {
                if cap == half && spot.y > 0.0 {
                    continue;
                }
                self.place(screw, place * at(spot.x, spot.y, CAP));
            }
        }
    }

    /// Plates, plugs and glasses on the housing.
    fn fittings(&mut self) {
        self.mount = Mount::still(0.0, 0.0, 0.8);
        self.single("sight glass", &fittings::sight_glass(), at(-2.42, -1.12, END));
        self.single("drain plug", &fittings::plug(), at(0.2, -1.52, END));
        self.single("name plate", &fittings::name_plate(), at(-1.45, -1.42, END));
        // On the cover's roof, which slopes.
        let (x, z) = (0.45, -0.72);
        let rise = housing::cover_height(x + 0.3) - housing::cover_height(x - 0.3);
        let slope = DAffine3::from_rotation_z(rise.atan2(0.6));
        let roof = |x: f64, z: f64| at(x, housing::cover_height(x), z) * slope * upward();
        self.mount = Mount::still(0.0, COVER_UP + 0.6, 0.0);
        self.single("inspection plate", &fittings::inspection_plate(), roof(x, z));
        self.mount = Mount::still(0.0, COVER_UP + 1.0, 0.0);
        let screw = self.stage.part("socket screw M6", &socket_screw(PLATE_SCREW, 0.1, BLUED));
        for spot in fittings::plate_screws() {
            self.place(screw, roof(x, z) * at(spot.x, spot.y, PLATE));
        }
        self.mount = Mount::still(0.0, COVER_UP + 0.6, 0.0);
        self.single("breather", &fittings::breather(), roof(-0.6, -0.8));
        let eye = self.stage.part("lifting eye", &fittings::lifting_eye());
        self.place(eye, roof(1.35, -0.65) * DAffine3::from_rotation_z(0.5));
    }

    /// The crank on the input shaft, with its washer and nut.
    fn crank(&mut self) {
        let angles = train::angles(INPUT_ANGLE);
        let crank = on_shaft(INPUT_X, angles.input + PI * 0.86, 1.58);
        self.mount = Mount::on(Shaft::Input, TRAIN_UP, CRANK_OFF);
        self.single("crank arm", &fittings::crank_arm(), crank);
        self.mount = Mount::on(Shaft::Input, TRAIN_UP, CRANK_OFF + 0.6);
        self.single(
            "crank grip",
            &fittings::crank_grip(),
            crank * at(fittings::CRANK_LENGTH, 0.0, CRANK_WIDTH),
        );
        let front = 1.58 + CRANK_WIDTH + 0.05;
        let shaft = |z: f64| on_shaft(INPUT_X, angles.input, z);
        self.mount = Mount::on(Shaft::Input, TRAIN_UP, CRANK_OFF + 0.6);
        self.single("washer 26", &washer(shafts::CRANK_THREAD, ZINC), shaft(front));
        self.mount = Mount::on(Shaft::Input, TRAIN_UP, CRANK_OFF + 0.9);
        let nut = hexagon_nut(shafts::CRANK_THREAD, BLUED);
        self.single("nut M26", &nut, shaft(front + washer_height(shafts::CRANK_THREAD)));
    }
}
