//! The conformance suite on every adapter: its cases, its oracle and its comparators, which know nothing of this
//! crate.

use crate::machine::on_every_adapter;
use ropewalk::catalogue::Row;
use ropewalk::traversal_list::Starts;
use ropewalk::{DeviceKind, Query, Ray, Structure, StructureKind, TraceOptions, Traced, Walk, catalogue};
use ropewalk_gpu::{GpuError, GpuStructure, Tracer};
use ropewalk_testkit::conformance::{Accuracy, Device, RowResult, Suite};

/// Entries of a stack that is large enough for nearly all cases.
const USUAL_STACK: u32 = 64;

/// On lavapipe a pass of 1,656 rays takes 8.5 ms, and there are 17,572 of them over trees, most of restart trails: in turns it is
/// about half of that.
const TURNS: usize = 3;

/// Tracers with the structure that the suite prepared last.
struct Judged {
    /// With a stack of the size that the structure needs: each size is another kernel.
    fitting: Tracer,
    /// With one size for all structures that need no more: a software adapter takes longer to compile a kernel than to run it. That
    /// the size fits is the business of the twins.
    usual: Tracer,
    structure: Option<(GpuStructure, bool)>,
}

impl Judged {
    fn prepared(&self) -> Result<(&Tracer, &GpuStructure), String> {
        let (structure, is_usual) = self.structure.as_ref().ok_or("no structure is prepared")?;
        Ok((if *is_usual { &self.usual } else { &self.fitting }, structure))
    }
}

/// The most entries that a stack can hold.
fn stack_entries(structure: &Structure) -> u32 {
    match structure {
        Structure::WideBvh(bvh) => bvh.stack_entries(),
        Structure::TwoLevel(scene) => {
            let bottoms = scene.objects().iter().flatten().map(|object| object.bottom().stack_entries());
            scene.top().depth() + bottoms.fold(0, u32::max)
        }
        _ => structure.report().depth,
    }
}

impl Device for Judged {
    fn prepare(&mut self, structure: &Structure) -> Result<(), String> {
        let is_usual = stack_entries(structure) <= USUAL_STACK;
        let tracer = if is_usual { &self.usual } else { &self.fitting };
        self.structure = Some((tracer.upload(structure).map_err(|error| error.to_string())?, is_usual));
        Ok(())
    }

    fn trace(
        &mut self,
        walk: Walk,
        query: Query,
        rays: &[Ray],
        options: TraceOptions,
    ) -> Result<Traced, String> {
        let (tracer, structure) = self.prepared()?;
        let traced = tracer.trace(structure, walk, query, rays, options);
        traced.map(|answer| answer.traced).map_err(|error: GpuError| error.to_string())
    }

    fn trace_from(
        &mut self,
        query: Query,
        rays: &[Ray],
        starts: Starts<'_>,
        options: TraceOptions,
    ) -> Result<Option<Traced>, String> {
        let (tracer, structure) = self.prepared()?;
        let traced = tracer.trace_from(structure, query, rays, starts, options);
        traced.map(|answer| Some(answer.traced)).map_err(|error: GpuError| error.to_string())
    }
}

/// Judges all rows of some kinds of structures; apart from each other, so that they run side by side.
fn conform(kinds: &[StructureKind]) {
    let is_meant = |row: &Row| row.device == DeviceKind::Gpu && kinds.contains(&row.structure.kind());
    let rows: Vec<Row> = catalogue::rows().into_iter().filter(is_meant).collect();
    assert!(!rows.is_empty());
    on_every_adapter(|machine| {
        let accuracy = if machine.is_exact() { Accuracy::Exact } else { Accuracy::Relaxed };
        let usual = machine.tracer(|options| options.stack_entries = Some(USUAL_STACK));
        let mut judged = Judged { fitting: machine.trusted.clone(), usual, structure: None };
        // What a software adapter computes to the bit, the CPU's twin has been judged by on all pairs.
        let turns = if machine.is_exact() { TURNS } else { 1 };
        let report = Suite::new(accuracy).in_turns(turns).run(&rows, &mut judged, &mut |_, _| {});
        assert!(report.is_passed(), "{report}");
        let has_heads = |row: &&RowResult| row.from_heads > 0;
        let wanted = if kinds.contains(&StructureKind::List) { 8 } else { 0 };
        assert!(report.rows.iter().filter(has_heads).count() >= wanted, "heads were not asked for: {report}");
    });
}

const TREES: &[StructureKind] = &[StructureKind::Bvh, StructureKind::WideBvh];
const LISTS_AND_CELLS: &[StructureKind] = &[StructureKind::List, StructureKind::KdTree];
const LEVELS: &[StructureKind] = &[StructureKind::TwoLevel];

#[test]
fn every_row_of_trees_conforms() {
    conform(TREES);
}

#[test]
fn every_row_of_lists_and_cells_conforms() {
    conform(LISTS_AND_CELLS);
}

#[test]
fn every_row_of_levels_conforms() {
    conform(LEVELS);
}

#[test]
fn no_kind_of_structure_is_left_out() {
    for row in catalogue::rows().iter().filter(|row| row.device == DeviceKind::Gpu) {
        let kind = row.structure.kind();
        assert_eq!(
            [TREES, LISTS_AND_CELLS, LEVELS].iter().filter(|some| some.contains(&kind)).count(),
            1,
            "{kind:?}"
        );
    }
}
