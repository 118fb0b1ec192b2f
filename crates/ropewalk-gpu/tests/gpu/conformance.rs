//! The conformance suite on every adapter: its cases, its oracle and its comparators, which know nothing of this
//! crate.

use crate::machine::on_every_adapter;
use ropewalk::traversal_list::Starts;
use ropewalk::{DeviceKind, Query, Ray, Structure, TraceOptions, Traced, Walk, catalogue};
use ropewalk_gpu::{GpuError, GpuStructure, Tracer};
use ropewalk_testkit::conformance::{Accuracy, Device, RowResult, Suite};

/// A tracer with the structure that the suite prepared last.
struct Judged {
    tracer: Tracer,
    structure: Option<GpuStructure>,
}

impl Device for Judged {
    fn prepare(&mut self, structure: &Structure) -> Result<(), String> {
        self.structure = Some(self.tracer.upload(structure).map_err(|error| error.to_string())?);
        Ok(())
    }

    fn trace(
        &mut self,
        walk: Walk,
        query: Query,
        rays: &[Ray],
        options: TraceOptions,
    ) -> Result<Traced, String> {
        let structure = self.structure.as_ref().ok_or("no structure is prepared")?;
        let traced = self.tracer.trace(structure, walk, query, rays, options);
        traced.map(|answer| answer.traced).map_err(|error: GpuError| error.to_string())
    }

    fn trace_from(
        &mut self,
        query: Query,
        rays: &[Ray],
        starts: Starts<'_>,
        options: TraceOptions,
    ) -> Result<Option<Traced>, String> {
        let structure = self.structure.as_ref().ok_or("no structure is prepared")?;
        let traced = self.tracer.trace_from(structure, query, rays, starts, options);
        traced.map(|answer| Some(answer.traced)).map_err(|error: GpuError| error.to_string())
    }
}

#[test]
fn every_row_of_the_catalogue_conforms() {
    let rows: Vec<_> = catalogue::rows().into_iter().filter(|row| row.device == DeviceKind::Gpu).collect();
    on_every_adapter(|machine| {
        let accuracy = if machine.is_exact() { Accuracy::Exact } else { Accuracy::Relaxed };
        let mut judged = Judged { tracer: machine.trusted.clone(), structure: None };
        let report = Suite::new(accuracy).run(&rows, &mut judged, &mut |_, _| {});
        assert!(report.is_passed(), "{report}");
        let has_heads = |row: &&RowResult| row.from_heads > 0;
        assert!(report.rows.iter().filter(has_heads).count() >= 8, "heads were not asked for: {report}");
    });
}
