//! Kernels that are broken on purpose: the comparison must notice each of them, or it proves nothing.

use super::machine::exact_tracer;
use super::scene::Set;
use super::trees::{by_recursion, difference};
use crate::Ground;
use crate::gpu::TreeKernel;
use crate::gpu::source::library;
use crate::integrator::TreeSettings;
use ropewalk::{BuildOptions, Structure, Walk};
use ropewalk_gpu::shader::ShaderLibrary;

/// A file, what stands in it, and what is put there instead.
type Damage = (&'static str, &'static str, &'static str);

const DAMAGES: &[Damage] = &[
    // No step off the surface.
    ("looks_place", "place.origin_outside = position + outward * step;", "place.origin_outside = position;"),
    // Rays to lights in the other order: nothing but the last bits of sums.
    ("ray_tree_node", "has_shadows && !is_open)", "false)"),
    // A mirror in a mirror that loses nothing.
    ("ray_tree_node", "site.weight * mirror_weight(", "mirror_weight("),
    // Glass that bends from inside as it does from outside.
    ("bsdf", "bsdf.eta = select(ior, 1.0 / ior, front);", "bsdf.eta = 1.0 / ior;"),
    ("looks_texture", "place = 2 * size - 1 - place;", "place = place - size;"),
    ("bsdf_fresnel", "let fifth = square * square * rest;", "let fifth = square * rest;"),
    // Holes that are none.
    ("ray_tree", "return !is_cut_out(hit);", "return true;"),
    ("ray_tree_node", "(*node).cut_by_weight += 1u;", ""),
    // Light that passes no pane.
    ("ray_tree", "onwards.ray.t_min = next_up(hit.t);", "onwards.ray.t_max = hit.t;"),
];

/// An error where the sound shaders differ, or a damage does not.
fn judge(damages: &[Damage], differs: impl Fn(ShaderLibrary) -> Option<String>) -> Result<(), String> {
    if let Some(difference) = differs(library()) {
        return Err(format!("the sound shaders: {difference}"));
    }
    let mut unnoticed = Vec::new();
    for &(file, sound, broken) in damages {
        let text = library().text(file).unwrap_or_default().to_string();
        if !text.contains(sound) {
            return Err(format!("'{sound}' stands no longer in {file}"));
        }
        if differs(library().with(file, text.replace(sound, broken))).is_none() {
            unnoticed.push(format!("{file}: '{broken}' for '{sound}'"));
        }
    }
    if unnoticed.is_empty() { Ok(()) } else { Err(format!("not noticed:\n{}", unnoticed.join("\n"))) }
}

#[test]
fn every_damage_is_noticed() {
    let Some(tracer) = exact_tracer() else { return };
    let set = Set::new(true, TreeSettings::default(), Ground::On);
    let structure = Structure::Bvh(set.stage.scene().build(&BuildOptions::default()).unwrap());
    let uploaded = tracer.upload(&structure).unwrap();
    let roots = set.roots(&structure, Walk::default(), [32, 24]);
    let expected = by_recursion(&set, &structure, &roots);
    let differs = |library: ShaderLibrary| {
        let kernel = TreeKernel::of_library(library, tracer, &set.looks, set.most_waiting()).unwrap();
        match kernel.follow(&uploaded, Walk::default(), &roots, false) {
            Ok(found) => difference(&expected, &found),
            Err(error) => Some(error.to_string()),
        }
    };
    if let Err(wrong) = judge(DAMAGES, differs) {
        panic!("{wrong}");
    }
}

/// The judge itself objects to a comparison that sees nothing, to one that sees ghosts, and to damage of nothing.
#[test]
fn a_comparison_that_is_no_good_is_found() {
    const DAMAGE: Damage = ("ray_tree", "fn arrive", "fn arrives");
    let sees = |library: ShaderLibrary| library.text(DAMAGE.0)?.contains(DAMAGE.2).then(String::new);
    assert_eq!(judge(&[DAMAGE], sees), Ok(()));
    assert!(judge(&[DAMAGE], |_| None).unwrap_err().contains("not noticed"));
    assert!(judge(&[DAMAGE], |_| Some("ghosts".into())).unwrap_err().contains("sound shaders: ghosts"));
    assert!(judge(&[("ray_tree", DAMAGE.2, "")], sees).unwrap_err().contains("no longer"));
}
