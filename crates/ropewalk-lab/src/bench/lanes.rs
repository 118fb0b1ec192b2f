//! A lane: a walk on a device, with a number of threads. It answers batches, and keeps how long it took.

use super::agreement::Judge;
use super::batches::Batch;
use super::{Agreement, BenchError, BenchSettings, LaneRecord, RateRecord, Work};
use crate::Spread;
use rayon::{ThreadPool, ThreadPoolBuilder};
use ropewalk::{CounterTotals, Query, Structure, TraceOptions, Traced, Walk, catalogue};
use ropewalk_gpu::{Device, GpuError, Traceable};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// A pool of threads.
#[derive(Debug)]
pub(super) struct Pool(ThreadPool);

impl Pool {
    pub(super) fn threads(&self) -> usize {
        self.0.current_num_threads()
    }

    pub(super) fn install<T: Send>(&self, work: impl FnOnce() -> T + Send) -> T {
        self.0.install(work)
    }
}

/// Makes a pool of each size.
pub(super) fn pools(sizes: &[usize]) -> Result<Vec<Pool>, BenchError> {
    let pool = |&threads: &usize| {
        let built = ThreadPoolBuilder::new().num_threads(threads).build();
        built.map(Pool).map_err(|error| BenchError::Threads { threads, reason: error.to_string() })
    };
    sizes.iter().map(pool).collect()
}

/// The measurements of one batch.
#[derive(Clone, Debug, Default)]
struct Samples {
    /// Whether the answers were right.
    agrees: bool,
    /// What the walk did, counted once.
    totals: Option<CounterTotals>,
    wall: Vec<f64>,
    device: Vec<f64>,
}

#[derive(Debug)]
pub(super) struct Lane<'a> {
    walk: Walk,
    traceable: Traceable,
    pool: Option<&'a Pool>,
    agreement: Agreement,
    samples: Vec<Samples>,
}

/// Every walk on every device that the catalogue has; CPU lanes once for each pool.
pub(super) fn make<'a>(
    settings: &BenchSettings,
    pools: &'a [Pool],
    structure: &Arc<Structure>,
) -> Result<Vec<Lane<'a>>, BenchError> {
    let mut lanes = Vec::new();
    for device in &settings.devices {
        let traceable = device.prepare(Arc::clone(structure))?;
        let pools: Vec<Option<&Pool>> = match device {
            Device::Cpu => pools.iter().map(Some).collect(),
            Device::Gpu(_) => vec![None],
        };
        let offered = |walk: &&Walk| {
            let of = |&query: &Query| catalogue::is_offered(structure.kind(), **walk, query, device.kind());
            Query::EVERY.iter().any(of)
        };
        for &walk in settings.walks.iter().filter(offered) {
            for &pool in &pools {
                lanes.push(Lane {
                    walk,
                    traceable: traceable.clone(),
                    pool,
                    agreement: Agreement::default(),
                    samples: Vec::new(),
                });
            }
        }
    }
    Ok(lanes)
}

impl Lane<'_> {
    /// Answers a batch once with counters and once without, and compares both. A query that the catalogue does not
    /// have is left out.
    pub(super) fn verify(&mut self, judge: &Judge, batch: &Batch) -> Result<(), BenchError> {
        let mut samples = Samples::default();
        let (structure, device) = (self.traceable.structure(), self.traceable.device());
        if catalogue::is_offered(structure.kind(), self.walk, batch.query, device.kind()) {
            let counted = self.trace(batch, TraceOptions { counters: true })?.0;
            let plain = self.trace(batch, TraceOptions::default())?.0;
            samples.totals = counted.totals();
            let device = self.traceable.device();
            let compared = judge
                .compare(device, &batch.rays, &batch.expected, &counted)
                .and_then(|_| judge.compare(device, &batch.rays, &batch.expected, &plain));
            samples.agrees = self.agreement.note(batch.class.name(), compared);
        }
        self.samples.push(samples);
        Ok(())
    }

    /// Answers a batch and keeps the time, where its answers were right.
    pub(super) fn measure(&mut self, index: usize, batch: &Batch) -> Result<(), BenchError> {
        if !self.samples.get(index).is_some_and(|samples| samples.agrees) {
            return Ok(());
        }
        let (_, wall, device) = self.trace(batch, TraceOptions::default())?;
        if let Some(samples) = self.samples.get_mut(index) {
            samples.wall.push(wall.as_secs_f64());
            samples.device.extend(device.map(|time| time.as_secs_f64()));
        }
        Ok(())
    }

    fn trace(
        &self,
        batch: &Batch,
        options: TraceOptions,
    ) -> Result<(Traced, Duration, Option<Duration>), GpuError> {
        let work = || {
            let start = Instant::now();
            let (traced, device) =
                self.traceable.trace_timed(self.walk, batch.query, &batch.rays, options)?;
            Ok((traced, start.elapsed(), device))
        };
        match self.pool {
            Some(pool) => pool.install(work),
            None => work(),
        }
    }

    /// What is kept of the first `rounds` rounds.
    pub(super) fn record(&self, batches: &[Batch], rounds: usize) -> LaneRecord {
        let rates = batches.iter().zip(&self.samples).filter_map(|(batch, samples)| {
            let rays = batch.rays.len() as f64;
            let rate = |times: &[f64]| {
                // A clock that shows no time shows no rate.
                let times: Vec<f64> = times.iter().copied().take(rounds).filter(|&time| time > 0.0).collect();
                Spread::of(&times).map(|spread| spread.map(|seconds| rays / seconds / 1e6))
            };
            Some(RateRecord {
                class: batch.class.to_string(),
                mrays_per_second: rate(&samples.wall)?,
                device_mrays_per_second: rate(&samples.device),
                work: samples.totals.as_ref().map(work),
            })
        });
        LaneRecord {
            device: self.traceable.device().to_string(),
            threads: self.pool.map(Pool::threads),
            walk: self.walk.to_string(),
            agreement: self.agreement.clone(),
            rates: rates.collect(),
        }
    }
}

fn work(totals: &CounterTotals) -> Work {
    let mean = |sum: u64| if totals.rays == 0 { 0.0 } else { sum as f64 / totals.rays as f64 };
    Work {
        inner_visits: mean(totals.inner_visits),
        leaf_visits: mean(totals.leaf_visits),
        primitive_tests: mean(totals.primitive_tests),
        deepest_stack: totals.stack_depth,
    }
}
