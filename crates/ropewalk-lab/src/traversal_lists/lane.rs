//! A setting on a device: where its rays begin, what they cost, and how long a frame takes.

use super::batches::{Batch, Begin, Part};
use super::settings::Setting;
use super::verdict::{Verdict, lost};
use crate::bench::is_hardware;
use crate::comparison::ComparisonError;
use ropewalk::traversal_list::{Frustum, HeadTable, Heads, Starts};
use ropewalk::{CounterTotals, Structure, TraceOptions, Traced, Walk};
use ropewalk_gpu::{Device, GpuError, Traceable};
use std::sync::Arc;
use std::time::Instant;

/// A setting on a device.
pub(super) struct Lane<'a> {
    pub(super) setting: &'a Setting,
    pub(super) structure: Arc<Structure>,
    pub(super) traceable: Traceable,
    /// Where the rays of each part of each batch begin.
    starts: Vec<Vec<Option<PartStarts>>>,
}

/// Where the rays of a part begin.
struct PartStarts {
    /// The heads of a view's cells; without, those of the polygons.
    cells: Option<HeadTable>,
    rows: Vec<u32>,
}

/// What the rays of a batch cost.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Cost {
    pub(super) totals: CounterTotals,
    /// Rays with another answer than they must have.
    pub(super) lost: usize,
}

impl<'a> Lane<'a> {
    pub(super) fn new(
        setting: &'a Setting,
        device: &Device,
        structure: Arc<Structure>,
        batches: &[Batch],
    ) -> Result<Self, GpuError> {
        let traceable = device.prepare(Arc::clone(&structure))?;
        let of_part = |part: &Part| PartStarts::of(setting, &structure, part);
        let starts = batches
            .iter()
            .map(|batch| {
                let is_asked = setting.asks(batch.class);
                batch.parts.iter().map(|part| is_asked.then(|| of_part(part)).flatten()).collect()
            })
            .collect();
        Ok(Self { setting, structure, traceable, starts })
    }

    /// How the structure is walked.
    pub(super) fn walk(&self) -> Walk {
        self.structure.kind().default_walk()
    }

    /// Bytes of all heads: of the polygons, and of the cells of one view.
    pub(super) fn heads_bytes(&self) -> usize {
        let polygons = match (self.setting.lists(), &*self.structure) {
            (Some(_), Structure::List(list)) => list.polygon_heads().map_or(0, HeadTable::bytes),
            _ => 0,
        };
        let cells = self.starts.iter().flatten().flatten().find_map(|starts| starts.cells.as_ref());
        polygons + cells.map_or(0, HeadTable::bytes)
    }

    /// Counts what the rays of a batch cost, once their answers are known to be right.
    pub(super) fn count(
        &self,
        index: usize,
        batch: &Batch,
        verdict: &Verdict,
    ) -> Result<Cost, ComparisonError> {
        let is_one_sided = self.structure.is_one_sided();
        let mut cost = Cost::default();
        for (place, part) in batch.parts.iter().enumerate() {
            let traced = self.trace(index, place, part, TraceOptions { counters: true })?;
            if self.setting.loses_hits() {
                let reference = if is_one_sided { &part.one_sided } else { &part.two_sided };
                cost.lost += lost(reference, &traced, is_hardware(self.traceable.device()));
            } else {
                verdict.compare(self.traceable.device(), part, is_one_sided, &traced).map_err(|what| {
                    ComparisonError::Disagrees {
                        walk: self.walk().to_string(),
                        device: self.traceable.device().to_string(),
                        structure: self.setting.structure.to_string(),
                        asked: format!("{} rays, '{}'", batch.class.name(), self.setting.name),
                        what,
                    }
                })?;
            }
            let totals = traced.totals().unwrap_or_default();
            cost.totals.rays += totals.rays;
            cost.totals.inner_visits += totals.inner_visits;
            cost.totals.primitive_tests += totals.primitive_tests;
        }
        Ok(cost)
    }

    /// The seconds of a batch, its parts one after the other.
    pub(super) fn time(&self, index: usize, batch: &Batch) -> Result<f64, GpuError> {
        let start = Instant::now();
        for (place, part) in batch.parts.iter().enumerate() {
            self.trace(index, place, part, TraceOptions::default())?;
        }
        Ok(start.elapsed().as_secs_f64())
    }

    fn trace(
        &self,
        batch: usize,
        place: usize,
        part: &Part,
        options: TraceOptions,
    ) -> Result<Traced, GpuError> {
        let starts = self.starts.get(batch).and_then(|parts| parts.get(place)).and_then(Option::as_ref);
        if let (Some(PartStarts { cells, rows }), Structure::List(list)) = (starts, &*self.structure)
            && let Some(table) = cells.as_ref().or(list.polygon_heads())
        {
            let starts = Starts { table, rows };
            return self.traceable.trace_from(part.query, &part.rays, starts, options);
        }
        self.traceable.trace(self.walk(), part.query, &part.rays, options)
    }
}

impl PartStarts {
    /// `None` where the setting has no heads for such rays.
    fn of(setting: &Setting, structure: &Structure, part: &Part) -> Option<Self> {
        let (Some(options), Structure::List(list)) = (setting.lists(), structure) else { return None };
        match &part.begin {
            Begin::Eye { frustum, cells } if options.frustum_grid > 0 => {
                let frustum = Frustum { cells: options.frustum_grid, ..*frustum };
                Some(Self { cells: Some(list.frustum_heads(&frustum)), rows: cells.clone() })
            }
            Begin::Triangles(numbers) if options.heads != Heads::Disabled => {
                Some(Self { cells: None, rows: list.polygon_starts(&part.rays, numbers) })
            }
            _ => None,
        }
    }
}
