//! Every short stack there is: `0..=16` entries, in every register, over every builder and width, for every case.
//!
//! The rows of the catalogue hold some sizes only, and the oracle judges those. Here every size is compared with the
//! ordered stack over the same tree: answers to the bit, and counters as [`super::relations`] says.

use super::{Cpu, Device, Failure, refusal, relations};
use crate::cases::{Case, Tree};
use crate::compare::same_bits;
use rayon::prelude::*;
use ropewalk::bvh::StackOrder;
use ropewalk::catalogue::{Row, StackMemory, TrailOptions, TrailRegister, is_offered};
use ropewalk::wide_bvh::Width;
use ropewalk::{
    BuildOptions, Builder, DeviceKind, Query, Structure, StructureSpec, TraceOptions, Traced, Walk,
    WideOptions,
};
use std::ops::RangeInclusive;

/// What is tried.
#[derive(Clone, Debug)]
pub struct ShortStacks {
    /// What is built, besides with the depth caps of each case, and its chains.
    pub structures: Vec<StructureSpec>,
    /// Entries of the short stack.
    pub sizes: RangeInclusive<u32>,
    /// Where the trail is kept.
    pub registers: Vec<TrailRegister>,
    /// Where a GPU keeps the short stack.
    pub memories: Vec<StackMemory>,
    /// What is asked.
    pub queries: Vec<Query>,
}

impl ShortStacks {
    /// Everything that a kind of device offers.
    #[must_use]
    pub fn every(device: DeviceKind) -> Self {
        let builds = [Builder::BinnedSah, Builder::SweepSah, Builder::Sbvh]
            .map(|builder| BuildOptions { builder, ..BuildOptions::default() });
        let wide = |width| {
            move |build| StructureSpec::WideBvh(WideOptions { width, build, ..WideOptions::default() })
        };
        let structures = builds
            .map(StructureSpec::Bvh)
            .into_iter()
            .chain(builds.map(wide(Width::Four)))
            .chain(builds.map(wide(Width::Eight)));
        let mut memories = vec![StackMemory::Private];
        if device == DeviceKind::Gpu {
            memories.push(StackMemory::Workgroup);
        }
        Self {
            structures: structures.collect(),
            sizes: 0..=TrailOptions::MAX_SHORT_STACK,
            // `auto` is one of these.
            registers: vec![TrailRegister::Array, TrailRegister::U32, TrailRegister::U64],
            memories,
            queries: vec![Query::Closest, Query::Any],
        }
    }

    fn walks(&self) -> impl Iterator<Item = TrailOptions> + '_ {
        self.sizes.clone().flat_map(move |short_stack| {
            self.registers.iter().flat_map(move |&register| {
                self.memories.iter().map(move |&memory| TrailOptions { short_stack, register, memory })
            })
        })
    }
}

/// What was compared, and what was wrong.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Compared {
    /// Batches whose answers were compared with those of the ordered stack.
    pub batches: usize,
    /// Batches that were rightly refused, their trees being deeper than the register.
    pub refused: usize,
    /// What was wrong.
    pub failures: Vec<Failure>,
}

impl Compared {
    /// Adds what came of other cases.
    #[must_use]
    pub fn and(mut self, other: Self) -> Self {
        self.batches += other.batches;
        self.refused += other.refused;
        self.failures.extend(other.failures);
        self
    }
}

/// Compares every short stack with the ordered stack of the same device, for one case. The device must round every
/// operation correctly: a software adapter, or the CPU.
#[must_use]
pub fn every_short_stack(
    device: &mut dyn Device,
    kind: DeviceKind,
    case: &Case,
    tried: &ShortStacks,
) -> Compared {
    let mut compared = Compared::default();
    for &structure in &tried.structures {
        for tree in case.trees(structure) {
            let result = tree.build(case).and_then(|structure| {
                device.prepare(&structure)?;
                one_structure(device, kind, case, (tree, &structure), tried, &mut compared)
            });
            if let Err(what) = result {
                compared.failures.push(Failure { case: case.name, structure: tree, what });
            }
        }
    }
    compared
}

/// The same for many cases on the CPU, spread over the threads of the caller's pool.
#[must_use]
pub fn every_short_stack_on_cpu(cases: &[Case], tried: &ShortStacks) -> Compared {
    let compared: Vec<Compared> = cases
        .par_iter()
        .with_max_len(1)
        .map(|case| every_short_stack(&mut Cpu::default(), DeviceKind::Cpu, case, tried))
        .collect();
    compared.into_iter().fold(Compared::default(), Compared::and)
}

fn one_structure(
    device: &mut dyn Device,
    kind: DeviceKind,
    case: &Case,
    (tree, structure): (Tree, &Structure),
    tried: &ShortStacks,
    compared: &mut Compared,
) -> Result<(), String> {
    let full = Walk::Stack(StackOrder::Ordered);
    let options = TraceOptions { counters: true };
    for &query in &tried.queries {
        let mut rows: Vec<(Row, Traced)> = Vec::new();
        let mut ask = |walk: Walk| device.trace(walk, query, &case.rays, options);
        rows.push((Row { structure: tree.spec, walk: full, query, device: kind }, ask(full)?));
        for walk in tried.walks().map(Walk::RestartTrail) {
            if !is_offered(structure.kind(), walk, query, kind) {
                continue;
            }
            match (ask(walk), refusal(structure, walk)) {
                (Ok(traced), None) => {
                    compared.batches += 1;
                    rows.push((Row { structure: tree.spec, walk, query, device: kind }, traced));
                }
                (Err(why), Some(due)) if why == due => compared.refused += 1,
                (Ok(_), Some(due)) => return Err(format!("it answers where it must refuse: {due}")),
                (Err(why), _) => return Err(format!("{walk}: {why}")),
            }
        }
        let mut fail = |what: String| {
            compared.failures.push(Failure { case: case.name, structure: tree, what });
        };
        let (_, reference) = &rows[0];
        for (row, traced) in &rows[1..] {
            if let Err(mismatch) = same_bits(&case.rays, reference, traced, false) {
                fail(format!("{} against the ordered stack: {mismatch}", row.walk));
            }
        }
        let runs: Vec<_> =
            rows.iter().enumerate().map(|(index, (row, traced))| (index, *row, traced)).collect();
        for (row, what) in relations::relations(structure.kind(), case, &runs) {
            fail(format!("{}: {what}", rows[row].0.walk));
        }
    }
    Ok(())
}
