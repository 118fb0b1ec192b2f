//! Known values, shadows without specks, and what must not be lost on the way to the film.

mod common;

use common::{Open, bare, build, floor, look, matt, model, render, sphere};
use ropewalk::glam::Vec3;
use ropewalk::{Query, Ray, Status, Structure, TraceOptions, Traced, Walk};
use ropewalk_render::{CameraChoice, Picture, RenderSettings, Renderer, Stage, StageOptions, Trace, View};
use ropewalk_scene::{Light, Material};
use std::error::Error;
use std::f32::consts::PI;
use std::ops::ControlFlow;

fn small(camera: CameraChoice) -> RenderSettings {
    RenderSettings { width: 33, height: 33, samples: 1, ambient_rays: 0, camera, ..RenderSettings::default() }
}

fn pixel(picture: &Picture, x: usize, y: usize) -> Vec3 {
    Vec3::from(picture.film.color[y * picture.film.width as usize + x])
}

fn sun(direction: Vec3) -> Vec<Light> {
    vec![Light::Sun { direction, color: Vec3::ONE }]
}

/// The sun's part of a picture's light: with the sun from behind there is none, so the difference is the sun's.
fn sunlight(
    mesh: impl Fn() -> Vec<(ropewalk::Mesh, Material)>,
    camera: &CameraChoice,
    at: (usize, usize),
) -> Vec3 {
    let shot = |direction: Vec3| {
        let stage = bare(model(mesh(), sun(direction)));
        let structure = build(stage.scene());
        pixel(&render(&stage, &structure, &small(camera.clone())), at.0, at.1)
    };
    shot(Vec3::NEG_Z) - shot(Vec3::Z)
}

#[test]
fn a_sphere_at_normal_incidence_has_the_known_radiance() {
    let camera = look(Vec3::new(0.0, 0.0, 10.0), Vec3::ZERO, 20.0);
    let parts = || vec![(sphere(Vec3::ZERO, 1.0, 5), matt(0.2, 0.4, 0.1))];
    let middle = sunlight(parts, &camera, (16, 16));
    // The file's sun is scaled to the irradiance of the default one; white light stays white.
    let irradiance = 0.92 * PI;
    let expected = Vec3::new(0.2, 0.4, 0.1) / PI * irradiance;
    assert!(middle.distance(expected) < 1e-3 * expected.length(), "{middle}, not {expected}");
    // Half-way to the rim the cosine law: the sphere's rim is at sin(a) = 1 / 10.
    let (x, y) = (21, 16);
    let across = (x as f32 + 0.5 - 16.5) / 16.5 * 10.0_f32.to_radians().tan();
    // The ray meets the sphere where the quadratic says.
    let direction = Vec3::new(across, 0.0, -1.0).normalize();
    let along = 10.0 * -direction.z - (100.0 * direction.z * direction.z - 99.0).sqrt();
    let cos = 10.0 + direction.z * along;
    let aside = sunlight(parts, &camera, (x, y));
    assert!(aside.distance(expected * cos) < 5e-3 * expected.length(), "{aside}, not {}", expected * cos);
}

#[test]
fn light_that_is_given_off_is_seen() {
    let lamp = Material { emissive: Vec3::new(2.0, 1.0, 0.5), ..matt(0.0, 0.0, 0.0) };
    let stage = bare(model(vec![(sphere(Vec3::ZERO, 1.0, 1), lamp)], sun(Vec3::NEG_Z)));
    let structure = build(stage.scene());
    let picture = render(&stage, &structure, &small(look(Vec3::Z * 10.0, Vec3::ZERO, 20.0)));
    assert_eq!(pixel(&picture, 16, 16), Vec3::new(2.0, 1.0, 0.5));
}

/// The share of a convex thing's sunlit pixels that are in shadow: there must be none.
fn specks(center: Vec3, radius: f32, crease: f32) -> usize {
    let way = Vec3::new(-0.3, -0.5, -0.8).normalize();
    let parts = vec![(sphere(center, radius, 4), matt(0.5, 0.5, 0.5))];
    let stage = Stage::new(
        model(parts, sun(way)),
        &StageOptions { ground: ropewalk_render::Ground::Off, crease, ..StageOptions::default() },
    );
    let structure = build(stage.scene());
    let settings = RenderSettings {
        width: 200,
        height: 200,
        ..small(look(center + Vec3::Z * radius * 5.0, center, 26.0))
    };
    let lit = render(&stage, &structure, &settings);
    let unlit = render(&stage, &Open(build(stage.scene())), &settings);
    lit.film.color.iter().zip(&unlit.film.color).filter(|(lit, unlit)| lit != unlit).count()
}

#[test]
fn a_convex_thing_never_shadows_itself_at_any_scale_and_place() {
    for (center, radius) in [
        (Vec3::ZERO, 1.0),
        (Vec3::ZERO, 1e-4),
        (Vec3::ZERO, 1e6),
        (Vec3::new(1e5, -2e5, 3e4), 50.0),
        (Vec3::splat(1e4), 1.0),
    ] {
        assert_eq!(specks(center, radius, 0.0), 0, "flat, {center}, {radius}");
        assert_eq!(specks(center, radius, 0.7), 0, "smooth, {center}, {radius}");
    }
}

#[test]
fn a_floor_far_away_is_all_lit() {
    for (center, half) in
        [(Vec3::new(1e5, 1e5, 1e5), 1e4), (Vec3::new(1e5, 0.0, -1e5), 3.0), (Vec3::ZERO, 1e5)]
    {
        let stage =
            bare(model(vec![(floor(center, half), matt(0.5, 0.5, 0.5))], sun(Vec3::new(0.9, -0.1, 0.2))));
        let structure = build(stage.scene());
        let settings = small(look(center + Vec3::new(0.0, half * 3.0, half * 0.1), center, 25.0));
        let lit = render(&stage, &structure, &settings);
        let open = render(&stage, &Open(build(stage.scene())), &settings);
        assert!(lit.film.coverage.iter().filter(|&&share| share > 0.0).count() > 200);
        assert_eq!(lit.film.color, open.film.color, "{center} {half}");
    }
}

#[test]
fn no_light_leaks_through_a_thin_gap() {
    for (scale, offset) in
        [(1.0, Vec3::ZERO), (1e-3, Vec3::ZERO), (1e4, Vec3::ZERO), (1.0, Vec3::new(50.0, 20.0, -70.0))]
    {
        // A lid, a thousandth of its size above the floor; the eye looks up through the floor's edge... from below
        // nothing is seen of the gap, so the eye stands beside it and looks at the floor under the lid.
        let lid = floor(offset + Vec3::Y * 1e-3 * scale, scale);
        let ground = floor(offset, 4.0 * scale);
        let stage =
            bare(model(vec![(ground, matt(0.5, 0.5, 0.5)), (lid, matt(0.5, 0.5, 0.5))], sun(Vec3::NEG_Y)));
        let structure = build(stage.scene());
        // Rays that start on the floor under the lid, as the renderer starts them, are seen by looking from
        // within the gap straight down.
        let eye = offset + Vec3::new(0.0, 0.5e-3, 0.0) * scale;
        let settings = small(look(eye, offset, 60.0));
        let lit = render(&stage, &structure, &settings);
        let open = render(&stage, &Open(build(stage.scene())), &settings);
        let shadowed =
            lit.film.color.iter().zip(&open.film.color).filter(|(lit, open)| lit[0] < open[0] * 0.8).count();
        assert_eq!(shadowed, 33 * 33, "scale {scale}, offset {offset}");
    }
}

#[test]
fn the_added_ground_shows_the_shadow_and_nothing_else() {
    let parts = || vec![(sphere(Vec3::Y, 1.0, 3), matt(0.5, 0.5, 0.5))];
    let settings = RenderSettings { width: 160, height: 90, samples: 4, ..RenderSettings::default() };
    let with = Stage::new(model(parts(), Vec::new()), &StageOptions::default());
    let without = bare(model(parts(), Vec::new()));
    let a = render(&with, &build(with.scene()), &settings);
    let b = render(&without, &build(without.scene()), &settings);
    let darker = a.film.color.iter().zip(&b.film.color).filter(|(a, b)| a[1] < b[1] * 0.8).count();
    let brighter = a.film.color.iter().zip(&b.film.color).filter(|(a, b)| a[1] > b[1] * 1.001).count();
    assert!(darker > 500, "the shadow covers {darker} pixels");
    assert_eq!(brighter, 0);
    assert_eq!(a.film.coverage, b.film.coverage, "the ground counts as background");
    assert_eq!(a.film.depth, b.film.depth);
    for view in [View::Normals, View::Depth, View::Ids] {
        let settings = RenderSettings { view, ..settings.clone() };
        let a = render(&with, &build(with.scene()), &settings);
        let b = render(&without, &build(without.scene()), &settings);
        assert_eq!(a.film, b.film, "{view} shows no added ground");
    }
    // From below the ground is not in the way.
    let below = RenderSettings { camera: look(Vec3::new(0.0, -5.0, 3.0), Vec3::Y, 40.0), ..settings };
    let a = render(&with, &build(with.scene()), &below);
    assert!(a.film.coverage.iter().filter(|&&share| share > 0.0).count() > 500);
}

#[test]
fn materials_of_nonsense_reach_the_film_as_numbers() {
    let nan = f32::NAN;
    let nonsense = Material {
        base_color: Vec3::splat(nan),
        emissive: Vec3::splat(f32::INFINITY),
        roughness: nan,
        metallic: nan,
        transmission: nan,
        ior: nan,
        ..Material::default()
    };
    let lights = vec![
        Light::Sun { direction: Vec3::NAN, color: Vec3::ONE },
        Light::Point { position: Vec3::Z * 2.0, color: Vec3::splat(f32::INFINITY) },
    ];
    let stage = bare(model(vec![(sphere(Vec3::ZERO, 1.0, 2), nonsense)], lights));
    let structure = build(stage.scene());
    let picture =
        render(&stage, &structure, &RenderSettings { width: 40, height: 30, ..RenderSettings::default() });
    assert!(picture.film.color.iter().flatten().all(|value| value.is_finite()));
    assert_eq!(picture.statistics.not_finite, 0);
    assert!(picture.notes.iter().any(|note| note.contains("2 lights")), "{:?}", picture.notes);
}

#[test]
fn materials_that_are_not_there_are_drawn_plain() {
    let mut model = model(vec![(sphere(Vec3::ZERO, 1.0, 2), matt(0.5, 0.5, 0.5))], Vec::new());
    model.materials.clear();
    model.surfaces.clear();
    let stage = bare(model);
    let picture = render(&stage, &build(stage.scene()), &small(CameraChoice::Automatic));
    assert!(picture.film.coverage[16 * 33 + 16] > 0.0);
}

#[test]
fn the_render_does_not_depend_on_the_number_of_threads() {
    let stage = Stage::new(common::still_life(), &StageOptions::default());
    let structure = build(stage.scene());
    let settings = RenderSettings { width: 64, height: 36, samples: 4, ..RenderSettings::default() };
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let stop = |_, _| ControlFlow::Continue(());
            Renderer::new(&stage, &structure).render(&settings, &stop).unwrap().film
        })
    };
    assert_eq!(with(1), with(4));
}

#[test]
fn incomplete_answers_are_counted_and_magenta() {
    /// Fails every seventh ray of a query.
    struct Failing(Structure, Query);
    impl Trace for Failing {
        fn trace_batch(
            &self,
            walk: Walk,
            query: Query,
            rays: &[Ray],
            options: TraceOptions,
        ) -> Result<Traced, Box<dyn Error + Send + Sync>> {
            let mut traced = self.0.trace(walk, query, rays, options)?;
            if query == self.1 {
                traced.status.iter_mut().step_by(7).for_each(|status| *status = Status::STACK_OVERFLOW);
            }
            Ok(traced)
        }
    }
    let stage = bare(common::still_life());
    for query in [Query::Closest, Query::Any] {
        let failing = Failing(build(stage.scene()), query);
        let picture = render(&stage, &failing, &small(CameraChoice::Automatic));
        let magenta = picture.film.color.iter().filter(|&&color| color == [1.0, 0.0, 1.0]).count() as u64;
        let incomplete = picture.statistics.incomplete;
        assert!(magenta > 10 && magenta <= incomplete.rays, "{magenta} of {}", incomplete.rays);
        assert_eq!(incomplete.stack_overflow, incomplete.rays);
        let note = picture.notes.iter().find(|note| note.contains("ran out of stack"));
        assert!(note.is_some(), "{:?}", picture.notes);
    }
}

#[test]
fn a_device_that_answers_something_else_is_an_error() {
    struct Short(Structure);
    impl Trace for Short {
        fn trace_batch(
            &self,
            walk: Walk,
            query: Query,
            rays: &[Ray],
            options: TraceOptions,
        ) -> Result<Traced, Box<dyn Error + Send + Sync>> {
            Ok(self.0.trace(walk, query, &rays[..rays.len() - 1], options)?)
        }
    }
    let stage = bare(common::still_life());
    let short = Short(build(stage.scene()));
    let answer = Renderer::new(&stage, &short)
        .render(&small(CameraChoice::Automatic), &|_, _| ControlFlow::Continue(()));
    assert!(answer.unwrap_err().to_string().contains("another question"));
}
