//! Trees of rays: all orders give the same bits, limits are counted, and light does what it does.

mod common;

use common::{Open, bare, build, floor, look, matt, mirrors_and_glass, model, render, sphere};
use ropewalk::glam::{Affine3A, Vec3};
use ropewalk::{StructureSpec, Transform};
use ropewalk_gpu::{Device, DeviceChoice, adapters};
use ropewalk_render::{
    CameraChoice, Ground, Integrator, Kept, LightChoice, Picture, Primary, RenderSettings, Renderer, Stage,
    StageOptions, Trace, TreeOrder, TreeSettings,
};
use ropewalk_scene::{Light, Material, Model};
use std::ops::ControlFlow;

fn of_the_still_life() -> RenderSettings {
    RenderSettings {
        width: 64,
        height: 48,
        samples: 4,
        ambient_rays: 8,
        integrator: Integrator::RayTree,
        camera: look(Vec3::new(0.4, 2.2, 6.0), Vec3::new(0.0, 0.7, 0.0), 40.0),
        ..RenderSettings::default()
    }
}

fn with(settings: &RenderSettings, tree: TreeSettings) -> RenderSettings {
    RenderSettings { tree, ..settings.clone() }
}

/// The pictures of all orders, which must be the same to the bit; the first.
fn in_all_orders(stage: &Stage, tracer: &dyn Trace, settings: &RenderSettings) -> Picture {
    let [recursive, stack, wavefront] = [TreeOrder::Recursive, TreeOrder::Stack, TreeOrder::Wavefront]
        .map(|order| render(stage, tracer, &with(settings, TreeSettings { order, ..settings.tree })));
    for (name, other) in [("stack", &stack), ("wavefront", &wavefront)] {
        let different = differing(&recursive, other);
        assert_eq!(different, 0, "{name}: {different} pixels differ from the recursion's");
        let counts = |picture: &Picture| {
            let statistics = &picture.statistics;
            [
                statistics.shadow_rays,
                statistics.ambient_rays,
                statistics.reflected_rays,
                statistics.refracted_rays,
                statistics.cut_by_depth,
                statistics.cut_by_weight,
            ]
        };
        assert_eq!(counts(&recursive), counts(other), "{name}");
    }
    recursive
}

fn differing(a: &Picture, b: &Picture) -> usize {
    let bits = |color: &[f32; 3]| color.map(f32::to_bits);
    a.film.color.iter().zip(&b.film.color).filter(|(a, b)| bits(a) != bits(b)).count()
}

#[test]
fn recursion_stack_and_wavefront_give_the_same_bits() {
    for mut model in [mirrors_and_glass(), common::still_life()] {
        for background in [None, Some(Vec3::new(0.1, 0.2, 0.4))] {
            model.background = background;
            model.ambient = background;
            let stage = Stage::new(model.clone(), &StageOptions::default());
            let structure = build(stage.scene());
            // What the paper measures, and a tree without an end but its depth.
            let plain = TreeSettings::default();
            let nothing = TreeSettings { shadows: false, reflections: false, refractions: false, ..plain };
            for tree in [
                nothing,
                TreeSettings { shadows: true, ..nothing },
                TreeSettings { reflections: true, bounces: 1, ..nothing },
                TreeSettings { bounces: 5, ..plain },
                TreeSettings { bounces: 7, smallest_weight: 0.0, ..plain },
                TreeSettings { bounces: 0, ..plain },
            ] {
                let settings = RenderSettings { width: 40, height: 30, ..of_the_still_life() };
                let picture = in_all_orders(&stage, &structure, &with(&settings, tree));
                assert!(picture.statistics.incomplete.is_none() && picture.statistics.not_finite == 0);
            }
        }
    }
}

#[test]
fn the_still_life_with_mirrors_looks_as_it_did() {
    let stage = Stage::new(mirrors_and_glass(), &StageOptions::default());
    let settings = RenderSettings { width: 96, height: 72, samples: 9, ..of_the_still_life() };
    let picture = render(&stage, &build(stage.scene()), &settings);
    common::check_stored("mirrors-and-glass", &picture);
}

#[test]
fn a_wrong_order_is_noticed() {
    let stage = bare(mirrors_and_glass());
    let structure = build(stage.scene());
    let settings = of_the_still_life();
    let a = render(&stage, &structure, &settings);
    let mut b = a.clone();
    b.film.color[700][1] = f32::from_bits(b.film.color[700][1].to_bits() ^ 1);
    assert_eq!((differing(&a, &a), differing(&a, &b)), (0, 1));
}

#[test]
fn every_structure_gives_the_same_tree() {
    let stage = bare(mirrors_and_glass());
    let settings = RenderSettings { width: 40, height: 30, ..of_the_still_life() };
    let wanted = render(&stage, &build(stage.scene()), &settings);
    for (spec, walk) in [
        ("wide-bvh", "stack"),
        ("kd-tree", "stack"),
        ("two-level", "stack"),
        ("list:heads=regular,frustum-grid=8", "list"),
    ] {
        let structure =
            spec.parse::<StructureSpec>().unwrap().build(stage.scene(), &ropewalk::NoMonitor).unwrap();
        let picture =
            render(&stage, &structure, &RenderSettings { walk: walk.parse().unwrap(), ..settings.clone() });
        let different = differing(&wanted, &picture);
        // Two levels place triangles by a ray turned into the object's space: the same hits, t within rounding.
        let most = if spec == "two-level" { 40 * 30 / 20 } else { 0 };
        assert!(different <= most, "{spec}: {different} pixels differ");
    }
}

/// The software adapter, where there is one.
fn software() -> Option<Device> {
    let Some(software) = adapters().into_iter().find(|adapter| adapter.is_software) else {
        assert!(std::env::var_os("CI").is_none(), "there is no software adapter, and CI wants one");
        println!("skipped: there is no software adapter here");
        return None;
    };
    Some(Device::open(&DeviceChoice::GpuIndex(software.index)).expect("the adapter opens").device)
}

#[test]
fn every_device_gives_the_same_tree() {
    let Some(device) = software() else { return };
    let stage = Stage::new(mirrors_and_glass(), &StageOptions::default());
    let on_cpu = build(stage.scene());
    let on_gpu = device.prepare(build(stage.scene())).expect("the scene fits");
    let settings = RenderSettings { width: 40, height: 30, ..of_the_still_life() };
    let wanted = render(&stage, &on_cpu, &settings);
    for order in [TreeOrder::Auto, TreeOrder::Stack, TreeOrder::Wavefront] {
        let tree = TreeSettings { order, ..settings.tree };
        let picture = render(&stage, &on_gpu, &with(&settings, tree));
        let different = differing(&wanted, &picture);
        assert_eq!(different, 0, "{order}: {different} pixels differ; {:?}", picture.notes);
        assert_eq!(wanted.statistics.reflected_rays, picture.statistics.reflected_rays, "{order}");
        assert_eq!(wanted.statistics.cut_by_depth, picture.statistics.cut_by_depth, "{order}");
    }
    let tree = TreeSettings { order: TreeOrder::Recursive, ..settings.tree };
    let error =
        Renderer::new(&stage, &on_gpu).render(&with(&settings, tree), &|_, _| ControlFlow::Continue(()));
    assert!(error.unwrap_err().to_string().contains("wavefront"));
}

#[test]
fn what_is_cut_off_is_counted_and_said() {
    let stage = bare(mirrors_and_glass());
    let structure = build(stage.scene());
    let settings = of_the_still_life();
    let cut = |tree: TreeSettings| {
        let picture = render(&stage, &structure, &with(&settings, tree));
        let told = picture.notes.iter().any(|note| note.contains("bounces"));
        assert_eq!(told, picture.statistics.cut_by_depth > 0, "{:?}", picture.notes);
        (picture.statistics.cut_by_depth, picture.statistics.cut_by_weight)
    };
    let plain = TreeSettings { smallest_weight: 0.0, ..TreeSettings::default() };
    let depths: Vec<(u64, u64)> = (0..4).map(|bounces| cut(TreeSettings { bounces, ..plain })).collect();
    assert!(depths.iter().all(|&(by_depth, by_weight)| by_depth > 0 && by_weight == 0), "{depths:?}");
    let (_, by_weight) = cut(TreeSettings { smallest_weight: 0.1, ..plain });
    assert!(by_weight > 0);
    assert_eq!(cut(TreeSettings { reflections: false, refractions: false, ..plain }), (0, 0));
}

/// The middle pixel of a picture.
fn middle(picture: &Picture) -> Vec3 {
    let (width, height) = (picture.film.width as usize, picture.film.height as usize);
    picture.film.color[height / 2 * width + width / 2].into()
}

fn small(camera: CameraChoice) -> RenderSettings {
    RenderSettings {
        width: 15,
        height: 15,
        samples: 1,
        ambient_rays: 0,
        integrator: Integrator::RayTree,
        camera,
        ..RenderSettings::default()
    }
}

/// Something that gives off light and sends none on.
fn glowing(color: Vec3) -> Material {
    Material { emissive: color, specular: Some(Vec3::ZERO), ..matt(0.0, 0.0, 0.0) }
}

#[test]
fn a_mirror_shows_what_stands_before_it() {
    let glow = Vec3::new(0.5, 0.25, 0.125);
    let silver = Material { metallic: 1.0, roughness: 0.0, ..matt(1.0, 1.0, 1.0) };
    // The eye looks down at 45 degrees into a level mirror, and so up at a lid.
    let mut lid = floor(Vec3::new(0.0, 3.0, -4.0), 3.0);
    lid.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
    let stage = bare(model(vec![(floor(Vec3::ZERO, 1.0), silver), (lid, glowing(glow))], Vec::new()));
    let structure = build(stage.scene());
    let settings = small(look(Vec3::new(0.0, 2.0, 2.0), Vec3::ZERO, 20.0));
    let picture = in_all_orders(&stage, &structure, &settings);
    // The mirror's highlight of the sun has a faint tail that reaches here.
    assert!(middle(&picture).distance(glow) < 5e-3, "{}", middle(&picture));
    assert!(picture.statistics.reflected_rays > 0 && picture.statistics.refracted_rays == 0);
    let without = TreeSettings { reflections: false, ..settings.tree };
    let picture = render(&stage, &structure, &with(&settings, without));
    assert!(middle(&picture).distance(glow) > 0.05, "the surroundings stand in its place");
    assert_eq!(picture.statistics.reflected_rays, 0);
}

#[test]
fn a_pane_bends_nothing_and_a_slab_shifts() {
    let glow = Vec3::new(0.5, 0.25, 0.125);
    let wall = |at: f32| {
        let mut wall = floor(Vec3::ZERO, 50.0);
        for vertex in &mut wall.positions {
            *vertex = Vec3::new(vertex.x + at, vertex.z, -20.0);
        }
        wall
    };
    // The wall begins at x = 0: rays through the middle pixel stop being on it when they are shifted to the left.
    let see = |ior: f32| {
        let glass = Material { transmission: 1.0, roughness: 0.0, ior, ..matt(1.0, 1.0, 1.0) };
        let ball = sphere(Vec3::ZERO, 1.0, 5);
        let stage = bare(model(vec![(ball, glass), (wall(50.0), glowing(glow))], Vec::new()));
        let structure = build(stage.scene());
        let eye = Vec3::new(0.5, 0.0, 6.0);
        let picture = in_all_orders(&stage, &structure, &small(look(eye, eye + Vec3::NEG_Z, 2.0)));
        assert!(picture.statistics.refracted_rays > 0);
        middle(&picture)
    };
    assert!(see(1.0).distance(glow) < 2e-3, "what does not bend is not seen: {}", see(1.0));
    // A ball of glass turns the picture round: through its right half the left is seen, which is not the wall.
    assert!(see(1.5).distance(glow) > 0.1, "{}", see(1.5));
}

#[test]
fn all_light_is_mirrored_inside_of_glass_beyond_the_critical_angle() {
    let glow = Vec3::new(0.5, 0.25, 0.125);
    let glass = Material { transmission: 1.0, roughness: 0.0, ior: 1.5, ..matt(1.0, 1.0, 1.0) };
    // From within, below a level surface of glass whose front is up: the eye sees its lower side.
    let mirrored = |height: f32| {
        let parts = vec![
            (floor(Vec3::ZERO, 9.0), glass.clone()),
            // Below, behind the eye's back: seen only in the mirror.
            (floor(Vec3::new(0.0, -4.0, 0.0), 40.0), glowing(glow)),
        ];
        let stage = bare(model(parts, Vec::new()));
        let structure = build(stage.scene());
        let picture = in_all_orders(
            &stage,
            &structure,
            &small(look(Vec3::new(0.0, -1.0, 2.0), Vec3::new(0.0, height, 2.0 - 1.0), 1.0)),
        );
        (middle(&picture), picture.statistics.refracted_rays)
    };
    // sin of the critical angle is 2 / 3. Rising by 1 over 1 is 45 degrees: beyond it. Steeper is not.
    let (color, through) = mirrored(0.0);
    assert!(color.distance(glow) < 1e-3, "{color}");
    assert_eq!(through, 0, "nothing goes through");
    let (color, through) = mirrored(2.0);
    assert!(color.distance(glow) > 0.05 && through > 0, "{color}");
}

#[test]
fn lights_throw_shadows_that_can_be_switched_off() {
    let parts = vec![
        (floor(Vec3::ZERO, 9.0), matt(0.8, 0.8, 0.8)),
        (floor(Vec3::new(0.0, 1.0, 0.0), 0.5), matt(0.8, 0.8, 0.8)),
    ];
    let mut model = model(parts, vec![Light::Sun { direction: Vec3::NEG_Y, color: Vec3::ONE }]);
    model.ambient = Some(Vec3::ZERO);
    model.background = Some(Vec3::ZERO);
    let stage = bare(model);
    let structure = build(stage.scene());
    let settings = small(look(Vec3::new(3.0, 0.9, 0.0), Vec3::ZERO, 2.0));
    let dark = in_all_orders(&stage, &structure, &settings);
    assert_eq!(middle(&dark), Vec3::ZERO);
    let lit =
        in_all_orders(&stage, &structure, &with(&settings, TreeSettings { shadows: false, ..settings.tree }));
    assert!(middle(&lit).x > 0.2);
    assert_eq!(lit.statistics.shadow_rays, 0);
    assert!(dark.statistics.shadow_rays > 0);
}

/// A floor under some panes, lit from above; the middle pixel shows what arrives below them.
fn below_panes(panes: usize, ior: f32, bounces: u32) -> (Vec3, Picture) {
    let glass = Material { transmission: 0.5, ior, specular: Some(Vec3::ZERO), ..matt(1.0, 0.5, 0.25) };
    let mut parts = vec![(floor(Vec3::ZERO, 9.0), matt(0.8, 0.8, 0.8))];
    parts.extend((0..panes).map(|pane| (floor(Vec3::Y * (1.0 + 0.1 * pane as f32), 0.5), glass.clone())));
    let mut model = model(parts, vec![Light::Sun { direction: Vec3::NEG_Y, color: Vec3::ONE }]);
    (model.ambient, model.background) = (Some(Vec3::ZERO), Some(Vec3::ZERO));
    let stage = bare(model);
    let settings = small(look(Vec3::new(3.0, 0.9, 0.0), Vec3::ZERO, 2.0));
    let tree = TreeSettings { bounces, ..settings.tree };
    let picture = in_all_orders(&stage, &build(stage.scene()), &with(&settings, tree));
    (middle(&picture), picture)
}

#[test]
fn panes_let_light_through_and_keep_their_share() {
    let (open, _) = below_panes(0, 1.0, 5);
    let (one, _) = below_panes(1, 1.0, 5);
    let (two, picture) = below_panes(2, 1.0, 5);
    let share = Vec3::new(0.5, 0.25, 0.125);
    assert!(one.distance(open * share) < 1e-3 * open.x, "{one}, not {}", open * share);
    assert!(two.distance(open * share * share) < 1e-3 * open.x, "{two}");
    assert!(picture.statistics.shadow_rays > 3 * 15 * 15 / 2, "each ray behind a pane is counted");
    assert_eq!(below_panes(1, 1.5, 5).0, Vec3::ZERO, "where bent light goes is not known");
    let (blocked, picture) = below_panes(40, 1.0, 5);
    assert_eq!(blocked, Vec3::ZERO);
    assert!(picture.statistics.cut_by_depth > 0, "what is stopped is counted");
}

#[test]
fn light_falls_through_holes_and_the_eye_sees_through_them() {
    let stage = bare(mirrors_and_glass());
    let structure = build(stage.scene());
    // Straight at the lattice: some pixels see it, some see through.
    let settings = RenderSettings {
        camera: look(Vec3::new(-2.4, 0.7, 4.0), Vec3::new(-1.5, 0.65, 1.5), 25.0),
        ..of_the_still_life()
    };
    let with_holes = in_all_orders(&stage, &structure, &settings);
    let mut closed = mirrors_and_glass();
    closed.materials[6].alpha_cutoff = 0.0;
    let closed = bare(closed);
    let without = in_all_orders(&closed, &build(closed.scene()), &settings);
    assert!(differing(&with_holes, &without) > 200);
    assert!(with_holes.film.coverage.iter().all(|&share| share <= 1.0));
}

#[test]
fn the_added_ground_shows_the_shadow_and_nothing_else() {
    let parts = || vec![(sphere(Vec3::Y, 1.0, 3), matt(0.5, 0.5, 0.5))];
    let settings = RenderSettings {
        width: 80,
        height: 45,
        samples: 4,
        integrator: Integrator::RayTree,
        ..RenderSettings::default()
    };
    let with_ground = Stage::new(model(parts(), Vec::new()), &StageOptions::default());
    let without = bare(model(parts(), Vec::new()));
    let a = in_all_orders(&with_ground, &build(with_ground.scene()), &settings);
    let b = in_all_orders(&without, &build(without.scene()), &settings);
    let darker = a.film.color.iter().zip(&b.film.color).filter(|(a, b)| a[1] < b[1] * 0.8).count();
    let brighter = a.film.color.iter().zip(&b.film.color).filter(|(a, b)| a[1] > b[1] * 1.001).count();
    assert!(darker > 100, "the shadow covers {darker} pixels");
    assert_eq!(brighter, 0);
    assert_eq!(a.film.coverage, b.film.coverage);
    // A matt thing on it looks as the studio shows it.
    let studio = render(
        &with_ground,
        &build(with_ground.scene()),
        &RenderSettings { integrator: Integrator::Studio, ..settings },
    );
    let far = a
        .film
        .color
        .iter()
        .zip(&studio.film.color)
        .filter(|(a, b)| Vec3::from(**a).distance(Vec3::from(**b)) > 0.02)
        .count();
    assert_eq!(far, 0, "{far} pixels are not the studio's");
}

#[test]
fn drawn_first_hits_give_the_picture_of_traced_ones() {
    let stage = bare(mirrors_and_glass());
    let structure = build(stage.scene());
    let settings = of_the_still_life();
    let traced = render(&stage, &structure, &settings);
    let drawn = render(&stage, &structure, &RenderSettings { primary: Primary::Rasterised, ..settings });
    assert_eq!(differing(&traced, &drawn), 0);
}

#[test]
fn a_convex_thing_never_shadows_itself_at_any_scale_and_place() {
    let way = Vec3::new(-0.3, -0.5, -0.8).normalize();
    for (center, radius) in [
        (Vec3::ZERO, 1.0),
        (Vec3::ZERO, 1e-4),
        (Vec3::ZERO, 1e6),
        (Vec3::new(1e5, -2e5, 3e4), 50.0),
        (Vec3::splat(1e4), 1.0),
    ] {
        for crease in [0.0, 0.7] {
            let parts = vec![(sphere(center, radius, 4), matt(0.5, 0.5, 0.5))];
            let lights = vec![Light::Sun { direction: way, color: Vec3::ONE }];
            let options = StageOptions { ground: Ground::Off, crease, ..StageOptions::default() };
            let stage = Stage::new(model(parts, lights), &options);
            let settings = RenderSettings {
                width: 120,
                height: 120,
                ..small(look(center + Vec3::Z * radius * 5.0, center, 26.0))
            };
            let lit = render(&stage, &build(stage.scene()), &settings);
            let open = render(&stage, &Open(build(stage.scene())), &settings);
            let specks = differing(&lit, &open);
            assert_eq!(specks, 0, "{specks} at {center}, radius {radius}, crease {crease}");
        }
    }
}

#[test]
fn glass_and_mirrors_look_the_same_at_any_scale_and_place() {
    let shot = |scale: f32, offset: Vec3| {
        let mut model = mirrors_and_glass();
        for instance in &mut model.scene.instances {
            let map = Affine3A::from_translation(offset) * Affine3A::from_scale(Vec3::splat(scale));
            instance.transform = Transform::new(map).unwrap();
        }
        for light in &mut model.lights {
            if let Light::Point { position, color } = light {
                *position = *position * scale + offset;
                *color *= scale * scale;
            }
        }
        let stage = bare(model);
        let camera =
            look(Vec3::new(0.4, 2.2, 6.0) * scale + offset, Vec3::new(0.0, 0.7, 0.0) * scale + offset, 40.0);
        render(&stage, &build(stage.scene()), &RenderSettings { camera, ..of_the_still_life() })
    };
    let wanted = shot(1.0, Vec3::ZERO);
    for (scale, offset) in [(1e-3, Vec3::ZERO), (1e4, Vec3::ZERO), (1.0, Vec3::new(300.0, -200.0, 100.0))] {
        let picture = shot(scale, offset);
        let is_far = |(a, b): &(&[f32; 3], &[f32; 3])| Vec3::from(**a).distance(Vec3::from(**b)) > 0.1;
        let far = wanted.film.color.iter().zip(&picture.film.color).filter(is_far).count();
        // Samples at edges fall to either side, and glass shows many edges.
        assert!(far < 64 * 48 / 50, "scale {scale}, offset {offset}: {far} pixels are not the same");
    }
}

#[test]
fn nonsense_reaches_the_film_as_numbers() {
    let nan = f32::NAN;
    let nonsense = Material {
        base_color: Vec3::splat(nan),
        emissive: Vec3::splat(f32::INFINITY),
        specular: Some(Vec3::new(nan, -1.0, f32::INFINITY)),
        ambient: Some(Vec3::splat(nan)),
        roughness: nan,
        metallic: nan,
        transmission: f32::INFINITY,
        ior: 0.0,
        ..Material::default()
    };
    let mut model = mirrors_and_glass();
    model.materials[1] = nonsense.clone();
    model.materials[2] = Material { mirrors_sharply: true, ior: f32::INFINITY, ..nonsense };
    model.lights.push(Light::Sun { direction: Vec3::NAN, color: Vec3::ONE });
    model.lights.push(Light::Point { position: Vec3::Z * 2.0, color: Vec3::splat(f32::INFINITY) });
    model.background = Some(Vec3::new(nan, -1.0, f32::INFINITY));
    model.ambient = Some(Vec3::splat(nan));
    let stage = bare(model);
    let structure = build(stage.scene());
    let picture =
        in_all_orders(&stage, &structure, &RenderSettings { width: 40, height: 30, ..of_the_still_life() });
    assert!(picture.film.color.iter().flatten().all(|value| value.is_finite()));
    assert_eq!(picture.statistics.not_finite, 0);
    assert!(picture.statistics.incomplete.is_none(), "{}", picture.statistics.incomplete);
    assert!(picture.notes.iter().any(|note| note.contains("2 lights")), "{:?}", picture.notes);
}

#[test]
fn a_closed_even_surrounding_shows_no_white_thing_at_all_where_nothing_is_in_the_way() {
    let white = Material { roughness: 0.0, metallic: 1.0, ..matt(1.0, 1.0, 1.0) };
    let glass = Material { transmission: 1.0, roughness: 0.0, ..matt(1.0, 1.0, 1.0) };
    for material in [white, glass] {
        let stage = bare(model(vec![(sphere(Vec3::ZERO, 1.0, 3), material)], Vec::new()));
        let structure = build(stage.scene());
        let settings = RenderSettings {
            light: LightChoice::Even(Vec3::splat(0.5)),
            tree: TreeSettings { bounces: 12, smallest_weight: 0.0, ..TreeSettings::default() },
            ..small(look(Vec3::Z * 5.0, Vec3::ZERO, 30.0))
        };
        let picture = in_all_orders(&stage, &structure, &settings);
        for color in &picture.film.color {
            assert!(Vec3::from(*color).distance(Vec3::splat(0.5)) < 2e-3, "{color:?}");
        }
    }
}

#[test]
fn what_is_kept_on_a_device_from_pose_to_pose_changes_no_picture() {
    let Some(device) = software() else { return };
    let settings = RenderSettings { width: 32, height: 24, ..of_the_still_life() };
    let kept = Kept::default();
    let mut model: Model = mirrors_and_glass();
    for step in 0..3 {
        model.scene.instances[1].transform = Transform::from_translation(Vec3::Z * 0.2 * step as f32);
        if step == 2 {
            model.scene.objects[3].geometries[0].positions.iter_mut().for_each(|vertex| vertex.y *= 1.5);
        }
        let stage = bare(model.clone());
        let on_gpu = device.prepare(build(stage.scene())).expect("the scene fits");
        let go = |_, _| ControlFlow::Continue(());
        let with_kept = Renderer::new(&stage, &on_gpu).keeping(&kept).render(&settings, &go).unwrap();
        let fresh = render(&stage, &build(stage.scene()), &settings);
        assert_eq!(differing(&with_kept, &fresh), 0, "step {step}");
    }
}

#[test]
fn what_is_kept_from_pose_to_pose_changes_no_picture() {
    let settings = RenderSettings { width: 40, height: 30, ..of_the_still_life() };
    let kept = Kept::default();
    let mut model: Model = mirrors_and_glass();
    for step in 0..3 {
        model.scene.instances[2].transform = Transform::from_translation(Vec3::X * 0.3 * step as f32);
        model.lights[0] =
            Light::Point { position: Vec3::new(-4.0, 6.0 + step as f32, 5.0), color: Vec3::ONE };
        let stage = bare(model.clone());
        let structure = build(stage.scene());
        let go = |_, _| ControlFlow::Continue(());
        let with_kept = Renderer::new(&stage, &structure).keeping(&kept).render(&settings, &go).unwrap();
        let fresh = render(&stage, &structure, &settings);
        assert_eq!(differing(&with_kept, &fresh), 0, "step {step}");
    }
    // Another stage altogether: nothing of the old one is used.
    let stage = bare(common::still_life());
    let structure = build(stage.scene());
    let go = |_, _| ControlFlow::Continue(());
    let with_kept = Renderer::new(&stage, &structure).keeping(&kept).render(&settings, &go).unwrap();
    assert_eq!(differing(&with_kept, &render(&stage, &structure, &settings)), 0);
}

#[test]
fn layers_say_what_surfaces_are() {
    let stage = Stage::new(mirrors_and_glass(), &StageOptions::default());
    let structure = build(stage.scene());
    let settings = RenderSettings { layers: true, ..of_the_still_life() };
    let picture = render(&stage, &structure, &settings);
    let layers = picture.film.layers.as_ref().expect("they were asked for");
    let mut seen = 0;
    for (pixel, ids) in layers.ids.iter().enumerate() {
        let normal = Vec3::from(layers.normal[pixel]);
        if picture.film.coverage[pixel] == 1.0 {
            seen += 1;
            assert!(ids[0] < 7 && normal.length() > 0.1 && normal.length() < 1.001);
            assert!(Vec3::from(layers.albedo[pixel]).max_element() > 0.0);
        } else if picture.film.coverage[pixel] == 0.0 {
            assert_eq!((*ids, normal), ([u32::MAX; 3], Vec3::ZERO));
        }
    }
    assert!(seen > 500);
    assert!(render(&stage, &structure, &of_the_still_life()).film.layers.is_none());
}
