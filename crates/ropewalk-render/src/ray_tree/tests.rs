//! The bounds of stacks and waves: that they hold, and what happens beyond them.

use super::{Followed, Request, Root, Sample, Tally, Tree, recursive, stack, wavefront};
use crate::integrator::TreeSettings;
use crate::light::Lights;
use crate::looks::Looks;
use crate::tracing::Tracing;
use crate::{Ground, LightChoice, RenderSettings, Stage, StageOptions};
use glam::Vec3;
use ropewalk::{Mesh, NoMonitor, Ray, Structure, StructureSpec, Walk};
use ropewalk_scene::{Camera, Light, Material, MaterialAssignment, Model, Surface};

/// Two panes of thick glass between two lamps, in a box of mirrors: trees that branch at every place.
fn hall() -> Stage {
    let square = |height: f32, half: f32| {
        let corner = |x: f32, z: f32| Vec3::new(x * half, height, z * half);
        let corners = vec![corner(-1.0, -1.0), corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0)];
        Mesh::new(corners, vec![[0, 1, 2], [0, 2, 3]])
    };
    let glass = Material {
        transmission: 0.9,
        roughness: 0.0,
        specular: Some(Vec3::splat(0.4)),
        ..Material::default()
    };
    let mirror =
        Material { metallic: 1.0, roughness: 0.0, base_color: Vec3::splat(0.9), ..Material::default() };
    let mut model = Model { materials: vec![glass, mirror], ..Model::default() };
    for (height, half, material) in
        [(0.0, 5.0, 1), (1.0, 3.0, 0), (1.5, 3.0, 0), (2.0, 3.0, 0), (4.0, 5.0, 1)]
    {
        let object = model.scene.add_object(square(height, half));
        model.scene.add_instance(object, ropewalk::Transform::IDENTITY);
        model
            .surfaces
            .push(vec![Surface { materials: MaterialAssignment::One(material), ..Surface::default() }]);
    }
    let lamp = |x: f32| Light::Point { position: Vec3::new(x, 3.0, 0.0), color: Vec3::ONE };
    model.lights = vec![lamp(-2.0), lamp(2.0)];
    Stage::new(model, &StageOptions { ground: Ground::Off, ..StageOptions::default() })
}

/// Everything that trees grow in.
struct Bed {
    looks: Looks,
    lights: Lights,
    request: Request,
    structure: Structure,
    roots: Vec<Root>,
}

impl Bed {
    fn new() -> Self {
        let stage = hall();
        let camera = Camera {
            name: String::new(),
            position: Vec3::new(0.0, 3.5, 3.0),
            forward: Vec3::new(0.0, -1.0, -1.0),
            up: Vec3::Y,
            vertical_fov: 1.0,
        };
        let tree = TreeSettings { bounces: 7, smallest_weight: 0.0, ..TreeSettings::default() };
        let settings = RenderSettings { samples: 4, ambient_rays: 12, tree, ..RenderSettings::default() };
        let lights = Lights::new(&stage, &camera, &LightChoice::Automatic, false);
        let request = Request::new(&stage, &settings);
        let looks = Looks::new(&stage, &lights.words(), &request.words()).unwrap();
        let structure = StructureSpec::default().build(stage.scene(), &NoMonitor).unwrap();
        let bare = Tracing { tracer: &structure, walk: Walk::default(), looks: None };
        let mut roots = Vec::new();
        for index in 0..60_u32 {
            let across = (index % 10) as f32 / 10.0 - 0.5;
            let ray = Ray::new(
                camera.position,
                camera.forward + Vec3::X * across + Vec3::Z * (index as f32 * 0.01),
            );
            let (hit, _) = bare.closest(&ray, None).unwrap();
            let sample = Sample { pixel: (index, 3), index: index % 4, behind: Vec3::splat(0.25) };
            roots.push(Root { sample, ray, hit });
        }
        Self { looks, lights, request, structure, roots }
    }

    fn tree(&self) -> Tree<'_> {
        Tree { looks: &self.looks, lights: &self.lights, request: self.request }
    }

    fn tracing(&self) -> Tracing<'_> {
        Tracing { tracer: &self.structure, walk: Walk::default(), looks: Some(&self.looks) }
    }

    fn reference(&self) -> (Vec<Followed>, Tally) {
        recursive::follow(&self.tree(), &self.tracing(), &self.roots).unwrap()
    }
}

fn same_bits(a: &[Followed], b: &[Followed]) -> bool {
    let bits = |one: &Followed| (one.color.to_array().map(f32::to_bits), one.is_broken);
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| bits(a) == bits(b))
}

#[test]
fn the_stack_is_never_fuller_than_is_known_beforehand() {
    let bed = Bed::new();
    let (wanted, tally) = bed.reference();
    assert!(
        tally.reflected_rays > 500 && tally.refracted_rays > 500 && tally.cut_by_depth > 100,
        "{tally:?}"
    );
    let most = bed.request.most_waiting(bed.lights.sources.len());
    let (followed, own) = stack::follow_within(&bed.tree(), &bed.tracing(), &bed.roots, most).unwrap();
    assert!(same_bits(&wanted, &followed));
    assert_eq!(own, tally);
    // One too small is told, not kept silent.
    let (followed, own) = stack::follow_within(&bed.tree(), &bed.tracing(), &bed.roots, 3).unwrap();
    assert!(own.incomplete.stack_overflow > 0 && followed.iter().any(|one| one.is_broken));
    assert!(!same_bits(&wanted, &followed));
}

#[test]
fn waves_that_are_cut_into_halves_give_the_same_trees() {
    let bed = Bed::new();
    let (wanted, tally) = bed.reference();
    for most in [usize::MAX, 5000, 100, 0] {
        let (followed, own) =
            wavefront::follow_within(&bed.tree(), &bed.tracing(), &bed.roots, most).unwrap();
        assert!(same_bits(&wanted, &followed), "{most}");
        assert_eq!(own, tally, "{most}");
    }
}

#[test]
fn hits_that_lead_nowhere_are_counted_and_broken() {
    let mut bed = Bed::new();
    bed.roots[7].hit.primitive_index = 99;
    let (wanted, tally) = bed.reference();
    assert!(wanted[7].is_broken && !wanted[8].is_broken);
    assert_eq!(tally.incomplete.no_such_triangle, 1);
    let (tree, tracing) = (bed.tree(), bed.tracing());
    for (followed, own) in [
        stack::follow(&tree, &tracing, &bed.roots).unwrap(),
        wavefront::follow(&tree, &tracing, &bed.roots).unwrap(),
    ] {
        assert!(same_bits(&wanted, &followed));
        assert_eq!(own, tally);
    }
}
