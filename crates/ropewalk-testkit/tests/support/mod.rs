//! Devices that are broken on purpose, and what the suite must say of them.

mod caught;

pub(crate) use caught::demand_caught;

use ropewalk::catalogue::Row;
use ropewalk::{Bvh, DeviceKind, Query, Ray, Structure, StructureSpec, TraceOptions, Traced, Walk};
use ropewalk_testkit::cases::Case;

use ropewalk_testkit::conformance::{Accuracy, Device, Report, Suite};

/// What a device is asked.
#[derive(Clone, Copy)]
pub(crate) struct Asked<'a> {
    pub(crate) walk: Walk,
    pub(crate) query: Query,
    pub(crate) rays: &'a [Ray],
    pub(crate) options: TraceOptions,
}

impl Asked<'_> {
    /// What the CPU answers.
    pub(crate) fn soundly(&self, structure: &Structure) -> Result<Traced, String> {
        let Self { walk, query, rays, options } = *self;
        structure.trace(walk, query, rays, options).map_err(|error| error.to_string())
    }
}

/// A device that answers as a function does.
struct Answering<F> {
    structure: Option<Structure>,
    answer: F,
}

/// A device that answers as `answer` does.
pub(crate) fn answering(answer: impl FnMut(&Structure, &Asked<'_>) -> Result<Traced, String>) -> impl Device {
    Answering { structure: None, answer }
}

impl<F: FnMut(&Structure, &Asked<'_>) -> Result<Traced, String>> Device for Answering<F> {
    fn prepare(&mut self, structure: &Structure) -> Result<(), String> {
        self.structure = Some(structure.clone());
        Ok(())
    }

    fn trace(
        &mut self,
        walk: Walk,
        query: Query,
        rays: &[Ray],
        options: TraceOptions,
    ) -> Result<Traced, String> {
        let structure = self.structure.as_ref().ok_or("nothing prepared")?;
        (self.answer)(structure, &Asked { walk, query, rays, options })
    }
}

/// The tree of a structure that must be one.
pub(crate) fn bvh(structure: &Structure) -> Result<&Bvh, String> {
    match structure {
        Structure::Bvh(bvh) => Ok(bvh),
        other => Err(format!("only a BVH, not a {}", other.kind())),
    }
}

/// A row of the default tree on the CPU.
pub(crate) fn row(walk: Walk, query: Query) -> Row {
    Row { structure: StructureSpec::default(), walk, query, device: DeviceKind::Cpu }
}

/// What the suite says of a device that answers the rows over a case.
pub(crate) fn run(case: &str, rows: &[Row], accuracy: Accuracy, mut device: impl Device) -> Report {
    let case = Case::named(case).unwrap_or_else(|| panic!("there is no case {case}"));
    Suite::of(vec![case], accuracy).run(rows, &mut device, &mut |_, _| {})
}
