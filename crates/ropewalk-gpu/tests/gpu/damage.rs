//! Shaders that are broken on purpose: a comparison must notice each of them, or it proves nothing.

use crate::machine::{Machine, on_every_adapter};
use ropewalk_gpu::shader::ShaderLibrary;
use ropewalk_gpu::{GpuStructure, Tracer, TracerOptions};

/// A file, what stands in it, and what is put there instead.
pub(crate) type Damage = (&'static str, &'static str, &'static str);

/// Compares the CPU with a tracer of the sound shaders, of which `differs` must tell no difference, and with one of each
/// damage, of which it must tell one.
pub(crate) fn notice_each(
    what: &str,
    stack_entries: u32,
    damages: &[Damage],
    upload: impl Fn(&Machine) -> Vec<GpuStructure>,
    differs: impl Fn(&Tracer, &[GpuStructure]) -> Option<String>,
) {
    on_every_adapter(|machine| {
        // Elsewhere rounding hides small damage, and the comparison is a looser one.
        if !machine.is_exact() {
            return;
        }
        // One stack size for all scenes, so that each damage is compiled once; a budget that no sound walk uses up
        // here, and that ends a broken one soon.
        let mut how = TracerOptions::default();
        how.stack_entries = Some(stack_entries);
        how.step_budget = Some(20_000);
        let uploaded = upload(machine);
        let judged = judge(damages, |library| {
            differs(&Tracer::with_library(machine.gpu().clone(), how.clone(), library), &uploaded)
        });
        if let Err(wrong) = judged {
            panic!("{what}: {wrong}");
        }
    });
}

/// An error where the sound shaders differ, or a damage does not.
fn judge(damages: &[Damage], differs: impl Fn(ShaderLibrary) -> Option<String>) -> Result<(), String> {
    if let Some(difference) = differs(ShaderLibrary::shipped()) {
        return Err(format!("the sound shaders: {difference}"));
    }
    let mut unnoticed = Vec::new();
    for &(file, sound, broken) in damages {
        let library = ShaderLibrary::shipped();
        let text = library.text(file).unwrap_or_default();
        if !text.contains(sound) {
            return Err(format!("'{sound}' stands no longer in {file}"));
        }
        let text = text.replace(sound, broken);
        if differs(library.with(file, text)).is_none() {
            unnoticed.push(format!("{file}: '{broken}' for '{sound}'"));
        }
    }
    if unnoticed.is_empty() { Ok(()) } else { Err(format!("not noticed:\n{}", unnoticed.join("\n"))) }
}

/// The judge itself objects to a comparison that sees nothing, to one that sees ghosts, and to damage of nothing.
#[test]
fn a_comparison_that_is_no_good_is_found() {
    const DAMAGE: Damage = ("shared/aabb", "fn slab_test", "fn slab_tests");
    let sees = |library: ShaderLibrary| library.text(DAMAGE.0)?.contains(DAMAGE.2).then(String::new);
    assert_eq!(judge(&[DAMAGE], sees), Ok(()));
    assert!(judge(&[DAMAGE], |_| None).unwrap_err().contains("not noticed"));
    assert!(judge(&[DAMAGE], |_| Some("ghosts".into())).unwrap_err().contains("sound shaders: ghosts"));
    assert!(judge(&[("shared/aabb", DAMAGE.2, "")], sees).unwrap_err().contains("no longer"));
    assert!(judge(&[("shared/none", "x", "y")], sees).unwrap_err().contains("no longer"));
}
