//! Part by part: places and materials, surfaces, lights and samples.

use super::machine::exact_tracer;
use super::scene::{Random, Set, materials, place_items};
use crate::Ground;
use crate::bsdf::{Bsdf, arithmetic, fresnel};
use crate::gpu::item::ITEM_WORDS;
use crate::gpu::source::{library, of};
use crate::integrator::TreeSettings;
use crate::looks::{Looks, Shaded};
use crate::sampling::{self, Purpose};
use glam::Vec3;
use ropewalk::{BuildOptions, Structure, TraceOptions, Walk};
use ropewalk_gpu::{Program, ProgramOptions};

/// What every root of a part has: no turn traces anything.
const FRAME: &str = "
#import ray_tree_node
fn accepts(hit: Hit) -> bool { return true; }
fn begin(index: u32) {}
fn item_float(index: u32, word: u32) -> f32 { return bitcast<f32>(records[#{ITEM_WORDS}u * index + word]); }
fn item_vec(index: u32, word: u32) -> vec3<f32> {
    return vec3<f32>(item_float(index, word), item_float(index, word + 1u), item_float(index, word + 2u));
}
fn put(index: u32, word: u32, value: f32) { results[result_at(index, word)] = bitcast<u32>(value); }
fn put3(index: u32, word: u32, v: vec3<f32>) {
    put(index, word, v.x);
    put(index, word + 1u, v.y);
    put(index, word + 2u, v.z);
}
";

/// Runs a part for items, on a structure of its own.
fn run(text: &str, item_words: usize, result_words: usize, looks: &Looks, items: &[u32]) -> Option<Vec<u32>> {
    let tracer = exact_tracer()?;
    let library = library().with("part", format!("{FRAME}{text}"));
    let source = of(library, "part").with_words(item_words, result_words, 1);
    let program = Program::new(tracer, source, ProgramOptions::default()).unwrap();
    let structure = Structure::Bvh(ropewalk::Scene::default().build(&BuildOptions::default()).unwrap());
    let uploaded = tracer.upload(&structure).unwrap();
    let tables = program.tables(looks.words(), looks.texels()).unwrap();
    let answer = program.run(&uploaded, Walk::default(), &tables, items, TraceOptions::default());
    Some(answer.unwrap().words)
}

/// Fails where words differ, and says which ones, how often, and by how much.
fn demand_same(names: &[(&str, usize)], expected: &[u32], found: &[u32]) {
    let size: usize = names.iter().map(|(_, words)| words).sum();
    assert_eq!(expected.len(), found.len());
    let mut text = String::new();
    let mut at = 0;
    for (name, words) in names {
        let differ: Vec<(usize, u32, u32)> = (0..expected.len() / size)
            .flat_map(|row| (0..*words).map(move |word| row * size + at + word))
            .map(|word| (word / size, expected[word], found[word]))
            .filter(|(_, a, b)| a != b)
            .collect();
        if let Some((row, a, b)) = differ.first() {
            let (count, a, b) = (differ.len(), f32::from_bits(*a), f32::from_bits(*b));
            text += &format!("{name}: {count} words, the first in row {row}: {a:e} and {b:e}\n");
        }
        at += words;
    }
    assert!(text.is_empty(), "{text}");
}

fn bits(vectors: &[Vec3]) -> impl Iterator<Item = u32> {
    vectors.iter().flat_map(Vec3::to_array).map(f32::to_bits).collect::<Vec<_>>().into_iter()
}

fn shaded_words(shaded: &Shaded) -> Vec<u32> {
    let numbers = [shaded.roughness, shaded.metallic, shaded.transmission, shaded.ior].map(f32::to_bits);
    bits(&[shaded.base_color, shaded.emissive, shaded.ambient, shaded.specular])
        .chain(numbers)
        .chain([u32::from(shaded.gives_specular), u32::from(shaded.mirrors_sharply)])
        .collect()
}

#[test]
fn places_and_materials_are_the_cpus() {
    let set = Set::new(true, TreeSettings::default(), Ground::On);
    let structure = Structure::Bvh(set.stage.scene().build(&BuildOptions::default()).unwrap());
    let mut roots = set.roots(&structure, Walk::default(), [192, 128]);
    roots.retain(|root| root.hit.is_hit());
    assert!(roots.len() > 12_000);
    let mut seen: Vec<u32> = roots.iter().map(|root| root.hit.instance_index).collect();
    seen.sort_unstable();
    seen.dedup();
    assert_eq!(seen.len(), set.stage.scene().instances.len(), "every instance is seen: {seen:?}");
    let text = "
fn item_word(index: u32, word: u32) -> u32 { return records[#{ITEM_WORDS}u * index + word]; }
fn turn(index: u32) -> bool {
    let ray = Ray(item_vec(index, 0u), 0.0, item_vec(index, 4u), batch.infinity, 0xffu);
    let hit = Hit(item_float(index, 16u), item_float(index, 17u), item_float(index, 18u), item_word(index, 19u),
        item_word(index, 20u), item_word(index, 21u), item_word(index, 22u) != 0u);
    let rows = rows_of(hit);
    if !rows.is_there { return false; }
    let uv = uv_of(rows.triangle, vec2<f32>(hit.u, hit.v));
    let place = place_of(ray, hit, rows, uv, shaded_material(looks_word(rows.triangle + 9u), uv));
    put3(index, 0u, place.position);
    put3(index, 3u, place.origin_outside);
    put3(index, 6u, place.origin_inside);
    put3(index, 9u, place.geometric_normal);
    put3(index, 12u, place.normal);
    put3(index, 15u, place.to_eye);
    put(index, 18u, place.uv.x);
    put(index, 19u, place.uv.y);
    results[result_at(index, 20u)] = u32(place.front) + 2u * u32(place.is_catcher) + 4u * u32(is_cut_out(hit));
    put3(index, 21u, place.material.base_color);
    put3(index, 24u, place.material.emissive);
    put3(index, 27u, place.material.ambient);
    put3(index, 30u, place.material.specular);
    put(index, 33u, place.material.roughness);
    put(index, 34u, place.material.metallic);
    put(index, 35u, place.material.transmission);
    put(index, 36u, place.material.ior);
    results[result_at(index, 37u)] = u32(place.material.gives_specular);
    results[result_at(index, 38u)] = u32(place.material.mirrors_sharply);
    put(index, 39u, catcher_strength(place.position));
    return false;
}
";
    let names = [
        ("position", 3),
        ("origin outside", 3),
        ("origin inside", 3),
        ("geometric normal", 3),
        ("normal", 3),
        ("to eye", 3),
        ("uv", 2),
        ("flags", 1),
        ("base color", 3),
        ("emissive", 3),
        ("ambient", 3),
        ("specular", 3),
        ("numbers", 4),
        ("kinds", 2),
        ("catcher", 1),
    ];
    let Some(found) = run(text, ITEM_WORDS, 40, &set.looks, &place_items(&roots)) else { return };
    let expected: Vec<u32> = roots
        .iter()
        .flat_map(|root| {
            let place = set.looks.place(&root.ray, &root.hit).unwrap();
            let flags = u32::from(place.front)
                + 2 * u32::from(place.is_catcher)
                + 4 * u32::from(set.looks.is_cut_out(&root.hit));
            bits(&[
                place.position,
                place.origin_outside,
                place.origin_inside,
                place.geometric_normal,
                place.normal,
                place.to_eye,
            ])
            .chain([place.uv.x.to_bits(), place.uv.y.to_bits(), flags])
            .chain(shaded_words(&place.material))
            .chain([set.looks.catcher_strength(place.position).to_bits()])
            .collect::<Vec<_>>()
        })
        .collect();
    demand_same(&names, &expected, &found);
}

#[test]
fn surfaces_send_light_on_as_the_cpus() {
    for is_studio in [true, false] {
        let set = Set::new(is_studio, TreeSettings::default(), Ground::Off);
        let mut random = Random::new(11);
        let mut items = Vec::new();
        let mut expected = Vec::new();
        for round in 0..3000 {
            let base = &materials()[round % materials().len()];
            let shaded = Shaded {
                base_color: random.color(),
                emissive: Vec3::ZERO,
                ambient: random.color(),
                roughness: if round % 5 == 0 { 0.0 } else { random.number() },
                metallic: if round % 3 == 0 { random.number() } else { base.metallic },
                transmission: base.transmission,
                ior: 1.0 + (round % 4) as f32 * 0.3,
                specular: random.color(),
                gives_specular: base.specular.is_some(),
                mirrors_sharply: base.mirrors_sharply,
            };
            let front = round % 2 == 0;
            let (normal, to_eye, to_light) = (random.direction(), random.direction(), random.direction());
            let to_eye = if to_eye.dot(normal) < 0.0 { -to_eye } else { to_eye };
            items.extend(shaded_words(&shaded));
            items.push(u32::from(front));
            items.extend(bits(&[normal, to_eye, to_light]));
            let bsdf = Bsdf::new(&shaded, front);
            let cos = normal.dot(to_eye);
            let environment = &set.lights.environment;
            expected.extend(bits(&[
                bsdf.diffuse,
                bsdf.specular,
                bsdf.through,
                Vec3::new(bsdf.grazing, bsdf.roughness, bsdf.eta),
                bsdf.direct(normal, to_eye, to_light),
                bsdf.fresnel(cos),
                bsdf.mirror_weight(cos),
                bsdf.through_weight(cos),
                bsdf.surroundings(normal, to_eye, environment, round % 7 > 2),
                fresnel::refract(-to_eye, normal, bsdf.eta).unwrap_or(Vec3::ZERO),
                arithmetic::mirrored(normal, to_eye),
                environment.radiance(to_light),
                environment.mirrored(to_light, shaded.roughness),
                environment.scattered(normal),
            ]));
        }
        let text = "
fn turn(index: u32) -> bool {
    var shaded: Shaded;
    shaded.base_color = item_vec(index, 0u);
    shaded.emissive = item_vec(index, 3u);
    shaded.ambient = item_vec(index, 6u);
    shaded.specular = item_vec(index, 9u);
    shaded.roughness = item_float(index, 12u);
    shaded.metallic = item_float(index, 13u);
    shaded.transmission = item_float(index, 14u);
    shaded.ior = item_float(index, 15u);
    shaded.gives_specular = records[#{ITEM_WORDS}u * index + 16u] != 0u;
    shaded.mirrors_sharply = records[#{ITEM_WORDS}u * index + 17u] != 0u;
    let bsdf = new_bsdf(shaded, records[#{ITEM_WORDS}u * index + 18u] != 0u);
    let normal = item_vec(index, 19u);
    let to_eye = item_vec(index, 22u);
    let to_light = item_vec(index, 25u);
    let cos_eye = dot(normal, to_eye);
    put3(index, 0u, bsdf.diffuse);
    put3(index, 3u, bsdf.specular);
    put3(index, 6u, bsdf.through);
    put3(index, 9u, vec3<f32>(bsdf.grazing, bsdf.roughness, bsdf.eta));
    put3(index, 12u, direct(bsdf, normal, to_eye, to_light));
    put3(index, 15u, fresnel(bsdf, cos_eye));
    put3(index, 18u, mirror_weight(bsdf, cos_eye));
    put3(index, 21u, through_weight(bsdf, cos_eye));
    put3(index, 24u, surroundings(bsdf, normal, to_eye, index % 7u > 2u));
    put3(index, 27u, refract_ray(-to_eye, normal, bsdf.eta));
    put3(index, 30u, mirrored(normal, to_eye));
    put3(index, 33u, environment_radiance(to_light));
    put3(index, 36u, environment_mirrored(to_light, shaded.roughness));
    put3(index, 39u, environment_scattered(normal));
    return false;
}
";
        let names = [
            "diffuse",
            "specular",
            "through",
            "grazing, roughness, eta",
            "direct",
            "fresnel",
            "mirror weight",
            "through weight",
            "surroundings",
            "refract",
            "mirrored",
            "radiance",
            "environment mirrored",
            "environment scattered",
        ];
        let Some(found) = run(text, 28, 42, &set.looks, &items) else { return };
        demand_same(&names.map(|name| (name, 3)), &expected, &found);
    }
}

#[test]
fn lights_and_samples_are_the_cpus() {
    let set = Set::new(true, TreeSettings::default(), Ground::Off);
    let sources = &set.lights.sources;
    assert!(sources.len() > 1);
    let mut random = Random::new(5);
    let (mut items, mut expected) = (Vec::new(), Vec::new());
    for round in 0..3000_u32 {
        let (place, normal) = (random.vector() * 3.0, random.direction());
        let pixel = ((random.number() * 4096.0) as u32, round * 7919);
        let count = 1 + round % 64;
        let index = round % count;
        let source = round as usize % sources.len();
        items.extend(bits(&[place, normal]));
        items.extend([pixel.0, pixel.1, index, count, source as u32]);
        let square = sampling::point(Purpose::Light, pixel, index, count);
        let sky = sampling::point(Purpose::Sky, pixel, index, count);
        let incoming = sources[source].towards(place, square).unwrap();
        expected.extend(bits(&[
            Vec3::new(square.x, square.y, sampling::fraction(pixel, index)),
            Vec3::new(sky.x, sky.y, incoming.distance),
            sampling::disc(square).extend(0.0),
            sampling::frame(normal).0,
            sampling::frame(normal).1,
            sampling::cosine_direction(normal, sky),
            incoming.to_light,
            incoming.light,
        ]));
    }
    let text = "
fn turn(index: u32) -> bool {
    let at = #{ITEM_WORDS}u * index + 6u;
    let pixel = vec2<u32>(records[at], records[at + 1u]);
    let square = light_point(pixel, records[at + 2u], records[at + 3u]);
    let sky = sky_point(pixel, records[at + 2u], records[at + 3u]);
    let normal = item_vec(index, 3u);
    let incoming = light_towards(records[at + 4u], item_vec(index, 0u), square);
    let frame = frame_of(normal);
    put3(index, 0u, vec3<f32>(square, pixel_fraction(pixel, records[at + 2u])));
    put3(index, 3u, vec3<f32>(sky, incoming.distance));
    put3(index, 6u, vec3<f32>(disc(square), 0.0));
    put3(index, 9u, frame.tangent);
    put3(index, 12u, frame.bitangent);
    put3(index, 15u, cosine_direction(normal, sky));
    put3(index, 18u, incoming.to_light);
    put3(index, 21u, incoming.light);
    return false;
}
";
    let names =
        ["light point", "sky point", "disc", "tangent", "bitangent", "cosine direction", "to light", "light"];
    let Some(found) = run(text, 11, 24, &set.looks, &items) else { return };
    demand_same(&names.map(|name| (name, 3)), &expected, &found);
}
