//! The tables against what they are made of: textures one by one, places as the studio finds them, indices that lead nowhere.

use super::{Looks, layout, texture};
use crate::{Ground, Stage, StageOptions};
use glam::{Affine3A, Quat, Vec2, Vec3, Vec4};
use ropewalk::{BuildOptions, FlatTriangle, Hit, Mesh, PreparedRay, Ray, Scene, Transform};
use ropewalk_scene::{
    CornerAttribute, Filter, Material, MaterialAssignment, Model, Surface, Texture, TextureUse, Wrap,
};

/// A fixed sequence of numbers from 0 to 1.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / 16_777_216.0
    }

    fn vector(&mut self) -> Vec3 {
        Vec3::new(self.next(), self.next(), self.next()) * 2.0 - 1.0
    }
}

fn stage(model: Model) -> Stage {
    Stage::new(model, &StageOptions { ground: Ground::Off, crease: 0.0, up: None })
}

fn looks(model: Model) -> Looks {
    Looks::new(&stage(model), &[1, 2, 3], &[0; 16]).unwrap()
}

fn picture(width: u32, height: u32, seed: u64, is_srgb: bool) -> Texture {
    let mut numbers = Numbers(seed);
    let texels = (0..width * height).map(|_| [0; 4].map(|_: i32| (numbers.next() * 255.9) as u8)).collect();
    Texture { name: format!("{width}x{height}"), width, height, texels, is_srgb }
}

/// One texel as the file means it, at whole texels anywhere: the definition of wrapping.
fn texel(texture: &Texture, wrap: [Wrap; 2], at: [i64; 2]) -> [f64; 4] {
    let size = [i64::from(texture.width), i64::from(texture.height)];
    let place = [0, 1].map(|axis| match wrap[axis] {
        Wrap::Repeat => at[axis].rem_euclid(size[axis]),
        Wrap::Clamp => at[axis].clamp(0, size[axis] - 1),
        Wrap::Mirror => {
            let within = at[axis].rem_euclid(2 * size[axis]);
            within.min(2 * size[axis] - 1 - within)
        }
    });
    let bytes = texture.texels[(place[1] * size[0] + place[0]) as usize];
    std::array::from_fn(|channel| {
        let value = f64::from(bytes[channel]) / 255.0;
        if texture.is_srgb && channel < 3 { crate::decode_srgb(value) } else { value }
    })
}

/// A texture by itself, in f64, with nothing around it.
fn separate(texture: &Texture, use_: &TextureUse, uv: Vec2) -> [f64; 4] {
    let size = [f64::from(texture.width), f64::from(texture.height)];
    let at = [0, 1].map(|axis| {
        (f64::from(use_.scale[axis]) * f64::from(uv[axis]) + f64::from(use_.offset[axis])) * size[axis]
    });
    if use_.filter == Filter::Nearest {
        return texel(texture, use_.wrap, at.map(|place| place.floor() as i64));
    }
    let low = at.map(|place| (place - 0.5).floor());
    let share = [at[0] - 0.5 - low[0], at[1] - 0.5 - low[1]];
    let corner = |x: i64, y: i64| texel(texture, use_.wrap, [low[0] as i64 + x, low[1] as i64 + y]);
    let mix = |a: [f64; 4], b: [f64; 4], share: f64| {
        std::array::from_fn::<f64, 4, _>(|channel| a[channel] * (1.0 - share) + b[channel] * share)
    };
    mix(mix(corner(0, 0), corner(1, 0), share[0]), mix(corner(0, 1), corner(1, 1), share[0]), share[1])
}

/// Materials that use textures in every way, one description each.
fn textured() -> (Model, Vec<TextureUse>) {
    let textures = vec![
        picture(7, 5, 1, true),
        picture(1, 1, 2, false),
        picture(16, 3, 3, false),
        picture(2, 31, 4, true),
        picture(64, 64, 5, true),
        picture(3, 64, 6, false),
    ];
    let mut model = Model { textures, ..Model::default() };
    let mut uses = Vec::new();
    let wraps = [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp];
    for texture in 0..6 {
        for (index, filter) in [Filter::Nearest, Filter::Linear].into_iter().enumerate() {
            for u in 0..3 {
                let v = (u + index) % 3;
                let use_ = TextureUse {
                    wrap: [wraps[u], wraps[v]],
                    filter,
                    scale: Vec2::new(1.0, [1.0, -2.0, 0.5][u]),
                    offset: Vec2::new([0.0, 0.25, -3.0][u], 0.125),
                    ..TextureUse::plain(texture)
                };
                model.materials.push(Material { base_color_texture: Some(use_), ..Material::default() });
                uses.push(use_);
            }
        }
    }
    (model, uses)
}

#[test]
fn the_atlas_gives_what_separate_textures_give() {
    let (model, uses) = textured();
    let looks = looks(model.clone());
    let mut numbers = Numbers(9);
    for (description, use_) in uses.iter().enumerate() {
        let texture = &model.textures[use_.texture as usize];
        let mut places: Vec<Vec2> =
            (0..400).map(|_| Vec2::new(numbers.next(), numbers.next()) * 8.0 - 4.0).collect();
        // Borders of the picture and of its texels, and their middles, where f32 computes without rounding.
        places.extend((-40..40).map(|step| Vec2::splat(step as f32 / 16.0)));
        for uv in places {
            let found = texture::look_up(&looks, description as u32, uv).unwrap().to_array();
            let wanted = separate(texture, use_, uv);
            let is_close = |wanted: &[f64; 4]| {
                (0..4).all(|channel| (f64::from(found[channel]) - wanted[channel]).abs() < 1e-4)
            };
            // At the very border of two texels either is the nearest one: f32 may round to the other side.
            let nudge = Vec2::splat(4e-6);
            let beside = || {
                use_.filter == Filter::Nearest
                    && [nudge, -nudge, Vec2::new(4e-6, -4e-6), Vec2::new(-4e-6, 4e-6)]
                        .iter()
                        .any(|&nudge| is_close(&separate(texture, use_, uv + nudge)))
            };
            assert!(is_close(&wanted) || beside(), "{use_:?} at {uv}: {found:?}, not {wanted:?}");
        }
    }
    // The comparison itself must object.
    let other = TextureUse { offset: Vec2::splat(0.5), ..uses[3] };
    let differs = |uv: Vec2| {
        let found = texture::look_up(&looks, 3, uv).unwrap().to_array();
        let wanted = separate(&model.textures[0], &other, uv);
        (0..4).any(|channel| (f64::from(found[channel]) - wanted[channel]).abs() > 1e-3)
    };
    assert!((0..100).map(|step| Vec2::splat(step as f32 * 0.017)).any(differs));
}

#[test]
fn an_atlas_of_many_gives_the_bits_of_an_atlas_of_one() {
    let (model, uses) = textured();
    let together = looks(model.clone());
    let mut numbers = Numbers(10);
    for (description, use_) in uses.iter().enumerate() {
        let alone = Model {
            textures: vec![model.textures[use_.texture as usize].clone()],
            materials: vec![Material {
                base_color_texture: Some(TextureUse { texture: 0, ..*use_ }),
                ..Material::default()
            }],
            ..Model::default()
        };
        let alone = looks(alone);
        for _ in 0..200 {
            let uv = Vec2::new(numbers.next(), numbers.next()) * 20.0 - 10.0;
            let (a, b) =
                (texture::look_up(&together, description as u32, uv), texture::look_up(&alone, 0, uv));
            assert_eq!(a.unwrap().to_array().map(f32::to_bits), b.unwrap().to_array().map(f32::to_bits));
        }
    }
}

#[test]
fn coordinates_that_are_none_do_no_harm() {
    let (model, uses) = textured();
    let looks = looks(model);
    let odd =
        [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e30, -1e30, 8_388_607.5, -8_388_607.5, -1e-30, -0.0];
    for description in 0..uses.len() as u32 {
        for u in odd {
            for v in odd {
                let found = texture::look_up(&looks, description, Vec2::new(u, v)).unwrap();
                assert!(found.cmpge(Vec4::ZERO).all() && found.cmple(Vec4::splat(1.0001)).all(), "{u} {v}");
            }
        }
    }
    assert_eq!(texture::look_up(&looks, layout::NOTHING, Vec2::ZERO), None);
}

/// A lumpy mesh with normals of its own, placed somewhere, turned and stretched.
fn lumpy(transform: Affine3A) -> Model {
    let mut numbers = Numbers(3);
    let positions: Vec<Vec3> = (0..60).map(|_| numbers.vector()).collect();
    let triangles: Vec<[u32; 3]> = (0..20).map(|index| [3 * index, 3 * index + 1, 3 * index + 2]).collect();
    let mesh = Mesh::new(positions.clone(), triangles.clone());
    let normals = triangles
        .iter()
        .flat_map(|triangle| {
            let [a, b, c] = triangle.map(|index| positions[index as usize]);
            [(b - a).cross(c - a).normalize(); 3]
        })
        .map(|normal| normal * 3.0 + numbers.vector() * 0.5)
        .collect();
    let mut scene = Scene::default();
    let object = scene.add_object(mesh);
    scene.add_instance(object, Transform::new(transform).unwrap());
    let surface =
        Surface { normals: Some(CornerAttribute { values: normals, indices: None }), ..Surface::default() };
    Model { scene, surfaces: vec![vec![surface]], materials: vec![Material::default()], ..Model::default() }
}

#[test]
fn places_are_those_that_the_studio_finds() {
    let turned = Affine3A::from_scale_rotation_translation(
        Vec3::new(2.0, -0.5, 1.0),
        Quat::from_rotation_x(0.7) * Quat::from_rotation_z(2.0),
        Vec3::new(3.0, -4.0, 10.0),
    );
    for transform in [Affine3A::IDENTITY, turned] {
        let stage = stage(lumpy(transform));
        let looks = Looks::new(&stage, &[], &[]).unwrap();
        let bvh = stage.scene().build(&BuildOptions::default()).unwrap();
        let mut numbers = Numbers(11);
        let mut compared = 0;
        for _ in 0..4000 {
            let target = transform.transform_point3(numbers.vector() * 0.7);
            let origin = target + numbers.vector() * 9.0;
            let ray = Ray::new(origin, (target - origin) * 0.3);
            let hit = bvh.closest(&ray);
            if !hit.is_hit() {
                continue;
            }
            compared += 1;
            let place = looks.place(&ray, &hit).unwrap();
            let point = stage.surface_point(&ray, &hit).unwrap();
            let near = |a: Vec3, b: Vec3, what: &str| assert!(a.distance(b) < 2e-5, "{what}: {a}, not {b}");
            near(place.position, point.position, "position");
            near(place.geometric_normal, point.geometric_normal, "normal of the triangle");
            near(place.normal, point.normal, "normal");
            near(place.to_eye, point.view, "to the eye");
            near(place.origin_outside, point.origin, "origin");
            assert_eq!(place.front, hit.front_face);
        }
        assert!(compared > 500, "{compared}");
    }
}

#[test]
fn rays_leave_a_triangle_on_both_sides_without_meeting_it() {
    let mut numbers = Numbers(7);
    let (mut met, mut met_without_step, mut left) = (0, 0, 0);
    for round in 0..60_000 {
        let place = numbers.vector() * 10.0_f32.powi(round % 9 - 3);
        let size = 10.0_f32.powi(round / 9 % 7 - 4);
        let vertices = [0; 3].map(|_| place + numbers.vector() * size);
        let mesh = Mesh::new(vertices.to_vec(), vec![[0, 1, 2]]);
        let model = Model { scene: Scene::from_mesh(mesh), ..Model::default() };
        let looks = if round % 20 == 0 || left == 0 { Some(looks(model)) } else { None };
        let Some(looks) = looks else { continue };
        let (u, v) = (numbers.next(), numbers.next());
        let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
        let hit = Hit {
            t: 1.0,
            barycentrics: Vec2::new(u, v),
            primitive_index: 0,
            geometry_index: 0,
            instance_index: 0,
            front_face: true,
        };
        let along = numbers.vector();
        let Some(at) = looks.place(&Ray::new(Vec3::ZERO, along), &hit) else { continue };
        let flat = along - at.geometric_normal * along.dot(at.geometric_normal);
        let rise = if round % 40 == 0 { 1e-4 * numbers.next() } else { numbers.next() };
        let flat_triangle = FlatTriangle {
            v0: vertices[0].into(),
            primitive: 0,
            v1: vertices[1].into(),
            geometry_and_mirror: 0,
            v2: vertices[2].into(),
            instance_and_mask: 0xff00_0000,
        };
        let meets = |origin: Vec3, dir: Vec3| {
            let prepared = PreparedRay::new(&Ray::new(origin, dir));
            prepared.is_some_and(|ray| flat_triangle.intersect(&ray, f32::INFINITY).is_some())
        };
        left += 2;
        met += usize::from(meets(at.origin_outside, flat + at.geometric_normal * rise));
        met += usize::from(meets(at.origin_inside, flat - at.geometric_normal * rise));
        met_without_step += usize::from(meets(at.position, flat + at.geometric_normal * rise));
    }
    assert!(left > 5000, "{left}");
    assert_eq!(met, 0, "of {left} rays");
    assert!(met_without_step > 50, "without a step the test must find specks, not {met_without_step}");
}

#[test]
fn indices_that_lead_nowhere_give_nothing() {
    let mut model = lumpy(Affine3A::IDENTITY);
    model.scene.objects[0].geometries[0].triangles.push([0, 1, 60]);
    model.surfaces[0][0].materials = MaterialAssignment::PerTriangle(vec![7; 21]);
    model.scene.add_instance(5, Transform::IDENTITY);
    let looks = looks(model);
    let ray = Ray::new(Vec3::Z * 5.0, Vec3::NEG_Z);
    let hit = Hit {
        t: 1.0,
        barycentrics: Vec2::splat(0.2),
        primitive_index: 0,
        geometry_index: 0,
        instance_index: 0,
        front_face: true,
    };
    let place = looks.place(&ray, &hit).expect("a material that is not there is a plain one");
    assert_eq!(place.material.base_color, Material::default().base_color);
    for wrong in [
        Hit { primitive_index: 20, ..hit },
        Hit { primitive_index: 21, ..hit },
        Hit { geometry_index: 1, ..hit },
        Hit { instance_index: 1, ..hit },
        Hit { instance_index: 2, ..hit },
        Hit { primitive_index: u32::MAX, geometry_index: u32::MAX, instance_index: u32::MAX, ..hit },
        Hit::MISS,
    ] {
        assert!(looks.place(&ray, &wrong).is_none(), "{wrong:?}");
        assert!(!looks.is_cut_out(&wrong));
    }
}

#[test]
fn nonsense_becomes_numbers() {
    let nan = f32::NAN;
    let mut model = lumpy(Affine3A::IDENTITY);
    model.materials[0] = Material {
        base_color: Vec3::new(nan, -3.0, f32::INFINITY),
        emissive: Vec3::new(nan, f32::INFINITY, -1.0),
        ambient: Some(Vec3::splat(nan)),
        specular: Some(Vec3::new(-1.0, nan, 1e30)),
        roughness: nan,
        metallic: f32::INFINITY,
        transmission: nan,
        ior: nan,
        alpha_cutoff: nan,
        opacity: nan,
        base_color_texture: Some(TextureUse::plain(99)),
        emissive_texture: Some(TextureUse {
            scale: Vec2::NAN,
            offset: Vec2::INFINITY,
            ..TextureUse::plain(0)
        }),
        ..Material::default()
    };
    model.textures = vec![
        picture(2, 2, 1, true),
        Texture { texels: Vec::new(), ..picture(3, 3, 1, true) },
        Texture { width: 0, ..picture(3, 3, 1, true) },
        Texture { width: u32::MAX, height: u32::MAX, ..picture(1, 1, 1, true) },
    ];
    model.materials[0].metallic_roughness_texture = Some(TextureUse::plain(1));
    if let Some(normals) = &mut model.surfaces[0][0].normals {
        normals.values[0] = Vec3::NAN;
        normals.values[4] = Vec3::ZERO;
    }
    let looks = looks(model);
    let ray = Ray::new(Vec3::Z * 5.0, Vec3::NEG_Z);
    for primitive_index in 0..20 {
        let hit = Hit {
            t: 1.0,
            barycentrics: Vec2::splat(0.2),
            primitive_index,
            geometry_index: 0,
            instance_index: 0,
            front_face: true,
        };
        let place = looks.place(&ray, &hit).unwrap();
        let material = &place.material;
        for color in [material.base_color, material.ambient, material.specular] {
            assert!(color.is_finite() && color.min_element() >= 0.0 && color.max_element() <= 1.0, "{color}");
        }
        assert!(material.emissive.is_finite() && material.emissive.min_element() >= 0.0);
        assert!(material.ior >= 1.0 && material.roughness == 1.0 && material.metallic == 1.0);
        assert!((place.normal.length() - 1.0).abs() < 1e-5 && place.origin_outside.is_finite());
        if primitive_index < 2 {
            assert_eq!(place.normal, place.geometric_normal, "a normal that is none is not used");
        }
    }
}

#[test]
fn masks_are_cut_out_where_alpha_says() {
    let mut texture = picture(2, 1, 1, true);
    texture.texels = vec![[255, 255, 255, 40], [255, 255, 255, 200]];
    let mesh = Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]);
    let coordinates = CornerAttribute { values: vec![Vec2::ZERO, Vec2::X, Vec2::Y], indices: None };
    let surface = Surface { texture_coordinates: Some(coordinates), ..Surface::default() };
    let use_ = TextureUse { filter: Filter::Nearest, ..TextureUse::plain(0) };
    let material = Material { base_color_texture: Some(use_), alpha_cutoff: 0.5, ..Material::default() };
    let model = |material| Model {
        scene: Scene::from_mesh(mesh.clone()),
        surfaces: vec![vec![surface.clone()]],
        materials: vec![material],
        textures: vec![texture.clone()],
        ..Model::default()
    };
    let hit = |u: f32| Hit {
        t: 1.0,
        barycentrics: Vec2::new(u, 0.1),
        primitive_index: 0,
        geometry_index: 0,
        instance_index: 0,
        front_face: true,
    };
    let masked = looks(model(material.clone()));
    assert!(masked.has_cut_outs());
    assert!(masked.is_cut_out(&hit(0.3)) && !masked.is_cut_out(&hit(0.7)));
    let whole = looks(model(Material { alpha_cutoff: 0.0, ..material.clone() }));
    assert!(!whole.has_cut_outs() && !whole.is_cut_out(&hit(0.3)));
    let faint = looks(model(Material { opacity: 0.5, ..material }));
    assert!(faint.is_cut_out(&hit(0.7)), "opacity and texture are multiplied");
}

#[test]
fn a_new_pose_changes_only_what_moved_and_is_what_new_looks_are() {
    let mut model = lumpy(Affine3A::IDENTITY);
    model.scene.add_instance(0, Transform::from_translation(Vec3::X));
    let object = model.scene.add_object(model.scene.objects[0].geometries[0].clone());
    model.surfaces.push(model.surfaces[0].clone());
    model.scene.add_instance(object, Transform::from_translation(Vec3::Y));
    let mut looks = Looks::new(&stage(model.clone()), &[5, 6], &[7]).unwrap();
    assert_eq!(looks.update(&stage(model.clone())), Some(Vec::new()), "nothing has moved");

    model.scene.instances[1].transform = Transform::from_translation(Vec3::X * 2.0);
    let changed = looks.update(&stage(model.clone())).unwrap();
    let row = looks.word(layout::INSTANCES) as usize + layout::INSTANCE;
    assert_eq!(changed, vec![row + 3..row + 4], "one number of one instance");

    for vertex in &mut model.scene.objects[1].geometries[0].positions {
        *vertex *= 1.5;
    }
    let before = looks.clone();
    let changed = looks.update(&stage(model.clone())).unwrap();
    let fresh = Looks::new(&stage(model.clone()), &[5, 6], &[7]).unwrap();
    assert_eq!(looks.words(), fresh.words());
    assert!(!changed.is_empty());
    for (index, (old, new)) in before.words().iter().zip(looks.words()).enumerate() {
        assert!(old == new || changed.iter().any(|range| range.contains(&index)), "word {index}");
    }
    model.scene.add_instance(0, Transform::IDENTITY);
    assert_eq!(looks.update(&stage(model)), None, "another stage");
}
