//! Building, under a progress bar that ctrl-C stops.

use crate::failure::Failure;
use crate::progress::Progress;
use ropewalk::{BuildError, Scene, Structure, StructureSpec};

/// Builds a structure over a scene.
pub(crate) fn build(spec: &StructureSpec, scene: &Scene) -> Result<Structure, Failure> {
    let progress = Progress::bar(format!("building {spec}"));
    let monitor = |done: usize, total: usize| progress.step(done, total);
    spec.build(scene, &monitor).map_err(|error| match error {
        BuildError::Cancelled => {
            Failure::failed("stopped by ctrl-C while the structure was built: nothing is kept")
        }
        other => other.into(),
    })
}

/// Tells the user which triangles were left out of a structure.
pub(crate) fn note_defects(structure: &Structure) {
    let input = structure.report().input;
    for (count, what) in [
        (input.not_finite, "with a vertex that is NaN, infinite or too large"),
        (input.out_of_range, "with an index that leads to no vertex"),
        (input.degenerate, "with two equal vertices"),
    ] {
        if count > 0 {
            crate::output::note(&format!("left out: {count} triangles {what}"));
        }
    }
}
