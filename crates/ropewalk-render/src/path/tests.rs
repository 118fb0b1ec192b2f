//! Furnaces, both ways to a light, noise, and equal bits.

use super::*;
use crate::lights::LightChoice;
use crate::ray_tree::{Request, Sample};
use crate::settings::RenderSettings;
use crate::{Ground, StageOptions, TreeSettings};
use glam::Vec2;
use ropewalk::{Mesh, NoMonitor, Structure, StructureSpec, Transform, Walk};
use ropewalk_scene::{Camera, Light, Material, MaterialAssignment, Model, Surface};

/// A ball of squares around the origin, smooth.
fn ball(radius: f32) -> Mesh {
    const ROWS: u32 = 24;
    const COLUMNS: u32 = 48;
    let mut positions = Vec::new();
    for row in 0..=ROWS {
        for column in 0..COLUMNS {
            let (sin_row, cos_row) = (row as f32 / ROWS as f32 * std::f32::consts::PI).sin_cos();
            let (sin, cos) = (column as f32 / COLUMNS as f32 * std::f32::consts::TAU).sin_cos();
            positions.push(Vec3::new(sin_row * cos, cos_row, sin_row * sin) * radius);
        }
    }
    let mut triangles = Vec::new();
    for row in 0..ROWS {
        for column in 0..COLUMNS {
            let next = (column + 1) % COLUMNS;
            let (a, b) = (row * COLUMNS + column, row * COLUMNS + next);
            let (c, d) = (a + COLUMNS, b + COLUMNS);
            triangles.extend([[a, b, c], [b, d, c]]);
        }
    }
    Mesh::new(positions, triangles)
}

/// A square in the plane of x and y, its front towards `+z`.
fn square(middle: Vec3, half: f32) -> Mesh {
    let corner = |x: f32, y: f32| middle + Vec3::new(x, y, 0.0) * half;
    let corners = vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
    Mesh::new(corners, vec![[0, 1, 2], [0, 2, 3]])
}

fn stage(parts: Vec<(Mesh, Material)>, lights: Vec<Light>) -> Stage {
    let mut model = Model { lights, ..Model::default() };
    for (index, (mesh, material)) in parts.into_iter().enumerate() {
        let object = model.scene.add_object(mesh);
        model.scene.add_instance(object, Transform::IDENTITY);
        model.materials.push(material);
        let materials = MaterialAssignment::One(index as u32);
        model.surfaces.push(vec![Surface { materials, ..Surface::default() }]);
    }
    Stage::new(model, &StageOptions { ground: Ground::Off, ..StageOptions::default() })
}

/// Everything that paths need, with parallel rays down on the middle of the scene.
struct Setting {
    stage: Stage,
    structure: Structure,
    lights: Lights,
    looks: Looks,
    paths: PathTracer,
    half: f32,
}

impl Setting {
    fn new(stage: Stage, choice: &LightChoice, bounces: u32, half: f32) -> Self {
        let structure = StructureSpec::default().build(stage.scene(), &NoMonitor).unwrap();
        let camera = Camera {
            name: String::new(),
            position: Vec3::Z * 50.0,
            forward: Vec3::NEG_Z,
            up: Vec3::Y,
            vertical_fov: 0.5,
        };
        let lights = Lights::new(&stage, &camera, choice, false);
        let request = Request::new(&stage, &RenderSettings::default());
        let looks = Looks::new(&stage, &lights.words(), &request.words()).unwrap();
        let tree = TreeSettings { bounces, ..TreeSettings::default() };
        let paths = PathTracer::new(&stage, &lights, &RenderSettings { tree, ..RenderSettings::default() });
        Self { stage, structure, lights, looks, paths, half }
    }

    fn roots(&self, pixels: u32, samples: u32) -> Vec<Root> {
        let mut samples_and_rays = Vec::new();
        for pixel in 0..pixels * pixels {
            let (x, y) = (pixel % pixels, pixel / pixels);
            for index in 0..samples {
                let inside = Sequence::new((x, y), index).square(999);
                let place = (Vec2::new(x as f32, y as f32) + inside) / pixels as f32 * 2.0 - 1.0;
                let ray = Ray::new((place * self.half).extend(20.0), Vec3::NEG_Z);
                samples_and_rays.push((Sample { pixel: (x, y), index, behind: Vec3::ONE }, ray));
            }
        }
        let rays: Vec<Ray> = samples_and_rays.iter().map(|(_, ray)| *ray).collect();
        let left = vec![None; rays.len()];
        let (hits, _) = self.tracing().closest_of(&rays, &Begin::OnTriangles(&left)).unwrap();
        let roots = samples_and_rays.into_iter().zip(hits);
        roots.map(|((sample, ray), hit)| Root { sample, ray, hit }).collect()
    }

    fn tracing(&self) -> Tracing<'_> {
        Tracing { tracer: &self.structure, walk: Walk::default(), looks: Some(&self.looks) }
    }

    fn follow(&self, pixels: u32, samples: u32) -> (Vec<Followed>, Tally) {
        let roots = self.roots(pixels, samples);
        self.paths.follow(&self.looks, &self.lights, &self.tracing(), &roots).unwrap()
    }

    /// The pixels' means of brightness.
    fn pixels(&self, pixels: u32, samples: u32) -> Vec<f64> {
        let (followed, _) = self.follow(pixels, samples);
        let of_pixel = |chunk: &[Followed]| {
            chunk.iter().map(|one| f64::from(one.color.element_sum()) / 3.0).sum::<f64>() / chunk.len() as f64
        };
        followed.chunks(samples as usize).map(of_pixel).collect()
    }
}

fn white(material: Material) -> Material {
    Material { base_color: Vec3::ONE, ..material }
}

#[test]
fn a_white_furnace_hides_every_material_that_conserves_energy() {
    let plain = Material::default;
    let all = [
        ("matt", plain()),
        ("polished plastic", Material { roughness: 0.0, ..plain() }),
        ("mirror", Material { roughness: 0.0, metallic: 1.0, ..plain() }),
        ("satin metal", Material { roughness: 0.3, metallic: 1.0, ..plain() }),
        ("rough metal", Material { roughness: 1.0, metallic: 1.0, ..plain() }),
        ("glass", Material { roughness: 0.0, transmission: 1.0, ior: 1.5, ..plain() }),
        ("thin glass", Material { roughness: 0.0, transmission: 1.0, ior: 1.0, ..plain() }),
        ("an old mirror", Material { mirrors_sharply: true, specular: Some(Vec3::ONE), ..plain() }),
    ];
    for (name, material) in all {
        let parts = vec![
            (ball(1.0), white(material.clone())),
            // Behind it a wall of the same, so that light goes to and fro.
            (square(Vec3::new(0.0, 0.0, -1.5), 3.0), white(material)),
        ];
        let setting = Setting::new(stage(parts, Vec::new()), &LightChoice::Even(Vec3::ONE), 16, 1.4);
        let (followed, tally) = setting.follow(24, 16);
        let mean = followed.iter().map(|one| f64::from(one.color.element_sum()) / 3.0).sum::<f64>()
            / followed.len() as f64;
        let darkest = setting.pixels(24, 16).into_iter().fold(f64::INFINITY, f64::min);
        println!("{name}: mean {mean:.4}, darkest pixel {darkest:.3}, {} cut", tally.cut_by_depth);
        assert!((mean - 1.0).abs() < 0.01, "{name}: {mean}");
        assert!(followed.iter().all(|one| !one.is_broken && one.color.is_finite()), "{name}");
    }
    // The test can tell: grey is seen.
    let grey = vec![(ball(1.0), Material { base_color: Vec3::splat(0.9), ..plain() })];
    let setting = Setting::new(stage(grey, Vec::new()), &LightChoice::Even(Vec3::ONE), 16, 0.7);
    let mean = setting.pixels(8, 16).iter().sum::<f64>() / 64.0;
    assert!((mean - 0.9).abs() < 0.01, "{mean}");
}

/// A matt floor, a shining square above it, and something in between.
fn lamp_over_floor(material: Material) -> Stage {
    let lamp = Material { emissive: Vec3::splat(5.0), base_color: Vec3::ZERO, ..Material::default() };
    stage(
        vec![
            (square(Vec3::ZERO, 4.0), material),
            (square(Vec3::new(3.0, 0.0, 2.0), 1.0), lamp),
            (ball(0.4), Material::default()),
        ],
        Vec::new(),
    )
}

#[test]
fn both_ways_to_a_lamp_find_the_same_light() {
    let satin = Material { metallic: 1.0, roughness: 0.35, ..Material::default() };
    let pane = || Material { transmission: 0.8, ior: 1.0, roughness: 0.0, ..Material::default() };
    let behind_a_pane = stage(
        vec![
            (square(Vec3::ZERO, 4.0), Material::default()),
            (square(Vec3::new(1.0, 0.0, 1.0), 3.0), pane()),
            (
                square(Vec3::new(3.0, 0.0, 2.0), 1.0),
                Material { emissive: Vec3::splat(5.0), base_color: Vec3::ZERO, ..Material::default() },
            ),
        ],
        Vec::new(),
    );
    let stages = [lamp_over_floor(Material::default()), lamp_over_floor(satin), behind_a_pane];
    for stage in stages {
        let mut setting = Setting::new(stage, &LightChoice::Even(Vec3::ZERO), 6, 1.5);
        let mean = |setting: &Setting, samples: u32| {
            let pixels = setting.pixels(12, samples);
            pixels.iter().sum::<f64>() / pixels.len() as f64
        };
        let asked = mean(&setting, 64);
        setting.paths.emitters = Emitters::default();
        let found = mean(&setting, 1024);
        println!("asked {asked:.4}, found {found:.4}");
        assert!(asked > 0.02 && (asked / found - 1.0).abs() < 0.04, "{asked} and {found}");
    }
}

#[test]
fn a_floor_under_a_lamp_is_as_bright_as_its_solid_angle_says() {
    let lamp = Material { emissive: Vec3::splat(2.0), base_color: Vec3::ZERO, ..Material::default() };
    let parts = vec![
        (square(Vec3::ZERO, 4.0), white(Material::default())),
        // Far above and large, out of the way of the eye, which looks from below the lamp.
        (square(Vec3::new(0.0, 0.0, 30.0), 20.0), lamp),
    ];
    let setting = Setting::new(stage(parts, Vec::new()), &LightChoice::Even(Vec3::ZERO), 0, 0.01);
    let mean = setting.pixels(8, 64).iter().sum::<f64>() / 64.0;
    // The share of the hemisphere, weighed with the cosine, of a square seen from its axis.
    let ratio = 20.0_f64 / 30.0;
    let side = (1.0 + ratio * ratio).sqrt();
    let share = 4.0 / std::f64::consts::PI * (ratio / side) * (ratio / side).atan();
    assert!((mean - 2.0 * share).abs() < 0.01, "{mean} and {}", 2.0 * share);
}

#[test]
fn the_error_falls_as_it_should() {
    let sun = Light::Sun { direction: Vec3::new(0.3, 0.2, -1.0), color: Vec3::ONE };
    let parts = vec![
        (square(Vec3::ZERO, 4.0), Material::default()),
        (ball(0.7), Material { roughness: 0.4, metallic: 1.0, ..Material::default() }),
    ];
    let setting = Setting::new(stage(parts, vec![sun]), &LightChoice::Automatic, 4, 1.2);
    let truth = setting.pixels(10, 4096);
    let error = |samples: u32| {
        let squares: f64 = setting
            .pixels(10, samples)
            .iter()
            .zip(&truth)
            .map(|(pixel, truth)| (pixel - truth).powi(2))
            .sum();
        (squares / truth.len() as f64).sqrt()
    };
    let (few, many) = (error(16), error(64));
    println!("error with 16 samples {few:.5}, with 64 {many:.5}");
    assert!(many < 0.55 * few, "{few} and {many}");

    // The noise that samples tell of themselves is no smaller than the error, and falls too.
    let told = |samples: u32| {
        let (followed, _) = setting.follow(10, samples);
        let mut noise = Noise::default();
        for chunk in followed.chunks(samples as usize) {
            let colors: Vec<Vec3> = chunk.iter().map(|one| one.color).collect();
            noise.add((0, 0), &colors);
        }
        noise.mean()
    };
    let (told_few, told_many) = (told(16), told(64));
    assert!(
        told_few > 0.5 * few && told_many > 0.5 * many && told_many < 0.6 * told_few,
        "{told_few} {told_many}"
    );
}

#[test]
fn the_same_bits_for_any_number_of_threads() {
    let setting = Setting::new(lamp_over_floor(Material::default()), &LightChoice::Automatic, 5, 1.5);
    let bits = |threads: usize| -> Vec<u32> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let (followed, _) = pool.install(|| setting.follow(24, 4));
        followed.iter().flat_map(|one| one.color.to_array().map(f32::to_bits)).collect()
    };
    let one = bits(1);
    assert!(one == bits(2) && one == bits(5));
    let other = Setting::new(lamp_over_floor(Material::default()), &LightChoice::Automatic, 0, 1.5);
    let (followed, _) = other.follow(24, 4);
    let different: Vec<u32> =
        followed.iter().flat_map(|one| one.color.to_array().map(f32::to_bits)).collect();
    assert!(one != different, "the test can tell");
}

#[test]
fn what_is_cut_off_is_counted() {
    let parts = vec![(square(Vec3::ZERO, 4.0), white(Material::default()))];
    let setting = Setting::new(stage(parts.clone(), Vec::new()), &LightChoice::Even(Vec3::ONE), 0, 1.0);
    let (followed, tally) = setting.follow(4, 4);
    assert_eq!((tally.cut_by_depth, tally.scattered_rays), (64, 0));
    assert!(followed.iter().all(|one| one.color == Vec3::ZERO), "nothing shines here but the surroundings");
    // A deep gap between grey walls: chance ends what grows dim.
    let grey = Material { base_color: Vec3::splat(0.3), ..Material::default() };
    let walls = vec![(square(Vec3::ZERO, 9.0), grey.clone()), (square(Vec3::new(6.0, 0.0, 0.3), 5.0), grey)];
    let setting = Setting::new(stage(walls, Vec::new()), &LightChoice::Even(Vec3::ONE), 16, 0.99);
    let (_, tally) = setting.follow(16, 16);
    assert!(tally.ended_by_chance > 0, "{tally:?}");
    assert_eq!(setting.stage.ground_instance(), None);
}

#[test]
fn a_scene_without_light_and_hits_that_lead_nowhere_are_no_trouble() {
    let parts = vec![(square(Vec3::ZERO, 4.0), Material::default())];
    let setting = Setting::new(stage(parts, Vec::new()), &LightChoice::Even(Vec3::ZERO), 3, 1.0);
    let (followed, _) = setting.follow(4, 1);
    assert!(followed.iter().all(|one| one.color == Vec3::ZERO && !one.is_broken));
    let mut roots = setting.roots(2, 1);
    roots[1].hit.primitive_index = 77;
    let tracing = setting.tracing();
    let (followed, tally) = setting.paths.follow(&setting.looks, &setting.lights, &tracing, &roots).unwrap();
    assert_eq!(followed.iter().map(|one| one.is_broken).collect::<Vec<_>>(), [false, true, false, false]);
    assert_eq!(tally.incomplete.rays, 1);
    assert!(setting.paths.follow(&setting.looks, &setting.lights, &tracing, &[]).unwrap().0.is_empty());
}

#[test]
fn of_many_lights_one_is_asked_and_all_count() {
    let suns = [Vec3::new(0.5, 0.0, -1.0), Vec3::new(-0.2, 0.9, -1.0), Vec3::new(0.0, -0.3, -1.0)];
    let color = |index: usize| Vec3::new(1.0, 0.3 + 0.3 * index as f32, 0.1);
    let suns = suns.iter().enumerate();
    let lights = suns.map(|(index, &direction)| Light::Sun { direction, color: color(index) }).collect();
    let parts = vec![(square(Vec3::ZERO, 4.0), Material::default()), (ball(0.5), Material::default())];
    let mut setting = Setting::new(stage(parts, lights), &LightChoice::Automatic, 0, 1.2);
    let (radiance, scattered, ambient) = (Vec3::ZERO, Vec3::ZERO, Vec3::ZERO);
    setting.lights.environment = crate::light::Environment::Even { radiance, scattered, ambient };
    let mean = |setting: &Setting| setting.pixels(12, 64).iter().sum::<f64>() / 144.0;
    let all = mean(&setting);
    let sources = setting.lights.sources.clone();
    assert_eq!(sources.len(), 3);
    let mut sum = 0.0;
    for source in sources {
        setting.lights.sources = vec![source];
        sum += mean(&setting);
    }
    assert!((all / sum - 1.0).abs() < 0.01, "{all} and {sum}");
}

#[test]
fn light_that_is_too_bright_is_cut_down_and_counted() {
    let lamp = Material { emissive: Vec3::splat(500.0), ..Material::default() };
    let parts =
        vec![(square(Vec3::ZERO, 2.0), Material::default()), (square(Vec3::new(0.0, 0.0, 0.5), 0.5), lamp)];
    let setting = Setting::new(stage(parts, Vec::new()), &LightChoice::Even(Vec3::ZERO), 2, 1.5);
    let (followed, tally) = setting.follow(12, 4);
    assert!(tally.clipped > 0);
    let brightest = followed.iter().map(|one| one.color.max_element()).fold(0.0, f32::max);
    assert!((brightest - 500.0).abs() < 20.0, "what the eye sees straight is whole: {brightest}");
}

#[test]
fn the_studios_lamp_counts_once() {
    let satin = Material { metallic: 1.0, roughness: 0.4, ..white(Material::default()) };
    for material in [white(Material::default()), satin] {
        let mut setting = Setting::new(
            stage(vec![(square(Vec3::ZERO, 4.0), material)], Vec::new()),
            &LightChoice::Automatic,
            2,
            1.0,
        );
        setting.lights.sources.clear();
        // The lamp stands where the light comes from: high up, for a floor in this plane.
        let key = Vec3::new(0.3, -0.2, 0.9).normalize();
        let sky = crate::sky::Sky::new(Vec3::Z, key);
        setting.lights.environment = crate::light::Environment::Studio(sky);
        let mean = setting.pixels(8, 256).iter().sum::<f64>() / 64.0;
        // The same floor by steps alone.
        let root = setting.roots(1, 1)[0];
        let place = setting.looks.place(&root.ray, &root.hit).unwrap();
        let bsdf = crate::bsdf::Bsdf::new(&place.material, place.front);
        let (mut wanted, count) = (0.0, 65_536);
        for index in 0..count {
            let sequence = Sequence::new((0, 0), index);
            let energy = &setting.paths.energy;
            let step = bsdf.step(energy, Vec3::Z, Vec3::Z, sequence.number(0), sequence.square(1));
            let light = step.map_or(Vec3::ZERO, |step| step.weight * sky.reflected(step.direction, 0.0));
            wanted += f64::from(light.element_sum()) / 3.0 / f64::from(count);
        }
        println!("mean {mean:.4}, by steps {wanted:.4}");
        assert!((mean / wanted - 1.0).abs() < 0.01, "{mean} and {wanted}");
    }
}
