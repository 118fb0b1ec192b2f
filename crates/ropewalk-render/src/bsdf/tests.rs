//! Energy, reciprocity, and materials of nonsense.

use super::*;
use crate::light::Environment;
use crate::path::sequence::{Sequence, cosine_direction};
use crate::sampling::{self, Purpose};

const MATERIALS: [(&str, Shaded); 8] = [
    ("matt", plain(0.0, 1.0)),
    ("plastic", plain(0.0, 0.3)),
    ("polished plastic", plain(0.0, 0.0)),
    ("satin metal", plain(1.0, 0.3)),
    ("rough metal", plain(1.0, 1.0)),
    ("half metal", plain(0.5, 0.5)),
    ("glass", Shaded { transmission: 1.0, ..plain(0.0, 0.0) }),
    (
        "an old mirror",
        Shaded {
            mirrors_sharply: true,
            gives_specular: true,
            specular: Vec3::new(0.2, 0.5, 1.0),
            transmission: 0.3,
            ..plain(0.0, 0.4)
        },
    ),
];

const fn plain(metallic: f32, roughness: f32) -> Shaded {
    Shaded {
        base_color: Vec3::ONE,
        emissive: Vec3::ZERO,
        ambient: Vec3::ZERO,
        roughness,
        metallic,
        transmission: 0.0,
        ior: 1.5,
        specular: Vec3::ZERO,
        gives_specular: false,
        mirrors_sharply: false,
    }
}

fn direction(cos: f32, turn: f32) -> Vec3 {
    let sin = (1.0 - cos * cos).sqrt();
    let (y, x) = (turn * std::f32::consts::TAU).sin_cos();
    Vec3::new(x * sin, y * sin, cos)
}

/// The part of a white sky that goes to the eye by `direct`.
fn sent_on(bsdf: &Bsdf, to_eye: Vec3) -> Vec3 {
    let count = 20_000;
    let mut sum = Vec3::ZERO;
    for index in 0..count {
        let square = sampling::point(Purpose::Sky, (0, 0), index, count);
        let light = sampling::cosine_direction(Vec3::Z, square);
        sum += bsdf.direct(Vec3::Z, to_eye, light) / (light.z.max(1e-4) * count as f32);
    }
    sum
}

#[test]
fn no_more_light_leaves_than_arrives() {
    for (name, shaded) in MATERIALS {
        for front in [true, false] {
            let bsdf = Bsdf::new(&shaded, front);
            for cos in [1.0, 0.8, 0.5, 0.2, 0.05] {
                let to_eye = direction(cos, 0.3);
                let sum = sent_on(&bsdf, to_eye);
                assert!(sum.max_element() < 1.01, "{name} from {cos}: {sum}");
                let rays = bsdf.mirror_weight(cos) + bsdf.through_weight(cos);
                assert!(rays.max_element() <= 1.0001, "{name} from {cos}: {rays}");
                if bsdf.is_sharp {
                    let sum = bsdf.diffuse * (Vec3::ONE - bsdf.fresnel(cos)) + rays;
                    assert!(sum.max_element() <= 1.0001, "{name} from {cos}: {sum}");
                }
                let white =
                    Environment::Even { radiance: Vec3::ONE, scattered: Vec3::ONE, ambient: Vec3::ONE };
                for follows in [true, false] {
                    let around = bsdf.surroundings(Vec3::Z, to_eye, &white, follows);
                    let sum = around + if follows { rays } else { bsdf.through_weight(cos) };
                    assert!(sum.max_element() <= 1.0001, "{name} from {cos}: {sum}");
                    assert!(around.min_element() >= 0.0);
                }
            }
        }
    }
}

#[test]
fn matt_white_and_clear_glass_send_on_all() {
    let matt = Bsdf::new(&plain(0.0, 1.0), true);
    for cos in [1.0, 0.5, 0.1] {
        let sum = sent_on(&matt, direction(cos, 0.1));
        assert!((sum - Vec3::ONE).abs().max_element() < 1e-3, "{sum}");
    }
    for front in [true, false] {
        let glass = Bsdf::new(&Shaded { transmission: 1.0, ..plain(0.0, 0.0) }, front);
        for cos in [1.0, 0.7, 0.5, 0.1, 0.0] {
            let sum = glass.mirror_weight(cos) + glass.through_weight(cos);
            assert!((sum - Vec3::ONE).abs().max_element() < 1e-6, "{sum}");
            let exact = fresnel_of_border(cos, glass.eta);
            assert!((glass.fresnel(cos).x - exact).abs() < 1e-6, "{cos}");
        }
    }
}

#[test]
fn light_takes_the_same_way_back() {
    for (name, shaded) in MATERIALS {
        let bsdf = Bsdf::new(&shaded, true);
        for step in 0..40 {
            let a = direction(0.05 + 0.9 * (step % 7) as f32 / 6.0, step as f32 * 0.17);
            let b = direction(0.05 + 0.9 * (step % 5) as f32 / 4.0, step as f32 * 0.29);
            let there = bsdf.direct(Vec3::Z, a, b) / b.z;
            let back = bsdf.direct(Vec3::Z, b, a) / a.z;
            let scale = there.max(back).max_element().max(1.0);
            assert!((there - back).abs().max_element() < 1e-4 * scale, "{name}: {there} and {back}");
        }
    }
}

#[test]
fn thin_glass_goes_straight_and_mirrors_what_the_file_says() {
    let thin = Shaded {
        ior: 1.0,
        transmission: 0.7,
        gives_specular: true,
        specular: Vec3::splat(0.35),
        mirrors_sharply: true,
        ..plain(0.0, 0.3)
    };
    let bsdf = Bsdf::new(&thin, true);
    assert_eq!(bsdf.eta, 1.0);
    for cos in [1.0, 0.5, 0.0] {
        assert!(bsdf.mirror_weight(cos).distance(Vec3::splat(0.35)) < 1e-6);
        assert!(bsdf.through_weight(cos).distance(Vec3::splat(0.65 * 0.7)) < 1e-6);
    }
}

#[test]
fn rougher_surfaces_follow_less() {
    let followed = |roughness| Bsdf::new(&plain(1.0, roughness), true).followed();
    assert_eq!((followed(0.0), followed(1.0)), (1.0, 0.0));
    assert!(followed(0.1) > 0.6 && followed(0.3) < 0.3);
    let sharp = Shaded { mirrors_sharply: true, ..plain(1.0, 0.6) };
    assert_eq!(Bsdf::new(&sharp, true).followed(), 1.0);
}

#[test]
fn materials_of_nonsense_give_numbers() {
    let nonsense = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1.0, 0.0, 1.0, 1e30, f32::MIN_POSITIVE];
    for (index, &a) in nonsense.iter().enumerate() {
        for (other, &b) in nonsense.iter().enumerate() {
            let shaded = Shaded {
                base_color: Vec3::new(a, b, 0.5),
                emissive: Vec3::splat(a),
                ambient: Vec3::new(b, a, b),
                roughness: b,
                metallic: a,
                transmission: if index % 2 == 0 { b } else { 0.5 },
                ior: a,
                specular: Vec3::new(b, 0.5, a),
                gives_specular: other % 2 == 0,
                mirrors_sharply: index % 3 == 0,
            };
            for front in [true, false] {
                let bsdf = Bsdf::new(&shaded, front);
                let white =
                    Environment::Even { radiance: Vec3::ONE, scattered: Vec3::ONE, ambient: Vec3::ONE };
                for (to_eye, to_light) in [
                    (Vec3::Z, Vec3::Z),
                    (Vec3::Z, -Vec3::Z),
                    (Vec3::X, Vec3::new(0.6, 0.0, 0.8)),
                    (-Vec3::Z, Vec3::Z),
                ] {
                    let all = [
                        bsdf.direct(Vec3::Z, to_eye, to_light),
                        bsdf.mirror_weight(to_eye.z),
                        bsdf.through_weight(to_eye.z),
                        bsdf.surroundings(Vec3::Z, to_eye, &white, true),
                    ];
                    for value in all {
                        assert!(value.is_finite() && value.min_element() >= -1e-6, "{value} of {shaded:?}");
                    }
                }
            }
        }
    }
}

/// The light of a white sky that steps bring, and by evaluation over the hemisphere (plus what has one direction).
fn by_steps(bsdf: &Bsdf, energy: &Energy, to_eye: Vec3, count: u32) -> Vec3 {
    let mut sum = Vec3::ZERO;
    for index in 0..count {
        let sequence = Sequence::new((3, 5), index);
        let step = bsdf.step(energy, Vec3::Z, to_eye, sequence.number(0), sequence.square(1));
        sum += step.map_or(Vec3::ZERO, |step| step.weight) / count as f32;
    }
    sum
}

fn by_evaluation(bsdf: &Bsdf, energy: &Energy, to_eye: Vec3, count: u32) -> Vec3 {
    let mut sum = Vec3::ZERO;
    for index in 0..count {
        let light = cosine_direction(Vec3::Z, Sequence::new((3, 5), index).square(0));
        let cos = light.z.max(1e-6);
        sum += bsdf.evaluate(energy, Vec3::Z, to_eye, light) * std::f32::consts::PI / (cos * count as f32);
    }
    sum
}

#[test]
fn steps_bring_what_evaluation_says_and_never_more_than_there_is() {
    let energy = Energy::new();
    for (name, shaded) in MATERIALS {
        for front in [true, false] {
            let bsdf = Bsdf::new(&shaded, front);
            for cos in [1.0, 0.8, 0.5, 0.2, 0.05] {
                let to_eye = direction(cos, 0.3);
                let steps = by_steps(&bsdf, &energy, to_eye, 4096);
                assert!(steps.max_element() < 1.02, "{name} from {cos}: {steps}");
                let mut sum = by_evaluation(&bsdf, &energy, to_eye, 16_384);
                if !bsdf.is_rough() {
                    sum += bsdf.fresnel(cos) + bsdf.through_weight(cos);
                }
                // By the cosine, a highlight at a grazing angle is seldom met.
                let close = if cos < 0.1 { 0.08 } else { 0.03 };
                assert!((sum - steps).abs().max_element() < close, "{name} from {cos}: {sum} and {steps}");
            }
        }
    }
}

#[test]
fn white_materials_that_conserve_energy_do() {
    let energy = Energy::new();
    let all = [
        ("matt", plain(0.0, 1.0)),
        ("polished plastic", plain(0.0, 0.0)),
        ("glass", Shaded { transmission: 1.0, ..plain(0.0, 0.0) }),
        ("mirror", plain(1.0, 0.0)),
        ("satin metal", plain(1.0, 0.3)),
        ("metal", plain(1.0, 0.6)),
        ("rough metal", plain(1.0, 1.0)),
    ];
    for (name, shaded) in all {
        for front in [true, false] {
            for cos in [1.0, 0.7, 0.4, 0.15] {
                let sum = by_steps(&Bsdf::new(&shaded, front), &energy, direction(cos, 0.7), 4096);
                assert!((sum - Vec3::ONE).abs().max_element() < 0.02, "{name} from {cos}: {sum}");
            }
        }
    }
}

#[test]
fn chances_add_up_to_what_has_no_single_direction() {
    let energy = Energy::new();
    for (name, shaded) in MATERIALS {
        let bsdf = Bsdf::new(&shaded, true);
        let to_eye = direction(0.6, 0.1);
        let (mut sum, mut spread) = (0.0, 0);
        let count = 65_536;
        for index in 0..count {
            let sequence = Sequence::new((9, 5), index);
            let square = sequence.square(0);
            // Even over the hemisphere.
            let light = direction(square.x, square.y);
            sum += bsdf.chance(&energy, Vec3::Z, to_eye, light) * std::f32::consts::TAU / count as f32;
            let step = bsdf.step(&energy, Vec3::Z, to_eye, sequence.number(1), sequence.square(2));
            spread += u32::from(step.is_some_and(|step| step.chance.is_some()));
        }
        // Facets that mirror below the surface end the path: their chance is missing from both.
        let share = spread as f32 / count as f32;
        assert!((sum - share).abs() < 0.03, "{name}: {sum} and {share}");
    }
}
