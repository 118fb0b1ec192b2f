//! Rays that begin at a head of a traversal list instead of its first element.
//!
//! Of every list with heads: rays that leave the triangles that the case's rays hit ([`surfaces`]), from the heads of these;
//! and the rays of two cameras, from the heads of the whole screen and of its cells ([`cameras`]). Answers must be those of
//! the same structure's brute force, to the bit on exact devices; on a GPU the counters must be those of the CPU.
//!
//! **But for what f32 loses.** Of a triangle whose plane is lost to rounding or to the smallest numbers, brute force may say
//! that it is met where it is not, behind the ray's origin even, and heads may pass it by. So where answers differ, they are
//! asked again without the rays of which the oracle knows such a triangle.
//!
//! **Counters.** From the element `h` of a list of `n` a walk visits at most `n - h`, and none where there is no head.
//! Summed over a batch, heads of triangles cost little more than they save. They may cost something, since what is entered
//! below an ancestor is visited by rays that would have missed the ancestor (ALGORITHMS: T8).

mod cameras;
mod surfaces;

use super::checks::Bench;
use super::{Accuracy, Device};
use crate::cases::Tree;
use crate::compare::Mismatch;
use crate::oracle::Oracle;
use ropewalk::catalogue::Row;
use ropewalk::traversal_list::{HeadTable, Heads, NO_HEAD, Starts, list_of};
use ropewalk::{
    Counters, DeviceKind, PreparedRay, Ray, StructureSpec, TraceOptions, Traced, TraversalList, Walk,
};

/// Rays that begin at heads.
struct Batch {
    /// What they are, in words.
    what: &'static str,
    rays: Vec<Ray>,
    tables: Vec<HeadTable>,
    /// The rows of the rays in each table.
    rows: Vec<Vec<u32>>,
    /// How much more than without heads they may visit in all, in percent, and besides two elements a ray on lists of few.
    /// `None` where there is no telling.
    slack: Option<u64>,
}

impl Batch {
    /// The same without the rays that come by a triangle of which f32 loses `t`.
    fn without_lost(&self, oracle: &Oracle) -> Self {
        let is_clear = |ray: &Ray| oracle.candidates(ray).iter().all(|candidate| !candidate.t_is_lost);
        let kept: Vec<usize> = (0..self.rays.len()).filter(|&index| is_clear(&self.rays[index])).collect();
        let rows = self.rows.iter().map(|rows| kept.iter().map(|&index| rows[index]).collect());
        Self {
            rays: kept.iter().map(|&index| self.rays[index]).collect(),
            tables: self.tables.clone(),
            rows: rows.collect(),
            ..*self
        }
    }
}

/// What a batch is compared with: brute force, and the counters of the walk from the first elements on.
struct Reference {
    forced: Traced,
    whole: Traced,
}

/// Judges the rows of a list that its own walk answers. `listed` are their indices.
pub(super) fn judge(
    bench: &mut Bench<'_>,
    list: &TraversalList,
    (tree, listed): (Tree, &[usize]),
    device: &mut dyn Device,
) {
    let options = list.options();
    if listed.is_empty() || (options.heads == Heads::Disabled && options.frustum_grid == 0) {
        return;
    }
    let case = &bench.judged.case;
    let batches = [surfaces::batch(list, case), cameras::batch(list, case)];
    for batch in batches.into_iter().flatten() {
        for &row in listed {
            let of = bench.rows[row];
            let compared = of_row(bench, list, of, &batch, device).or_else(|why| {
                let clear = batch.without_lost(bench.truth(StructureSpec::List(*list.options())).0);
                if clear.rays.len() == batch.rays.len() {
                    return Err(why);
                }
                of_row(bench, list, of, &clear, device)
            });
            match compared {
                Ok(rays) => bench.report.rows[row].from_heads += rays,
                Err(why) => bench.fail(row, tree, format!("{}: {why}", batch.what)),
            }
        }
    }
}

/// How many rays were compared; none where the device does not offer heads.
fn of_row(
    bench: &Bench<'_>,
    list: &TraversalList,
    row: Row,
    batch: &Batch,
    device: &mut dyn Device,
) -> Result<usize, String> {
    let trace =
        |walk, options| list.trace(walk, row.query, &batch.rays, options).map_err(|error| error.to_string());
    let reference = Reference {
        forced: trace(Walk::BruteForce, TraceOptions::default())?,
        whole: trace(Walk::List, TraceOptions { counters: true })?,
    };
    let mut compared = 0;
    for (table, rows) in batch.tables.iter().zip(&batch.rows) {
        let starts = Starts { table, rows };
        if !of_table(bench, list, row, (batch, starts), &reference, device)? {
            break;
        }
        compared += batch.rays.len();
    }
    Ok(compared)
}

/// Whether the device offers heads.
fn of_table(
    bench: &Bench<'_>,
    list: &TraversalList,
    row: Row,
    (batch, starts): (&Batch, Starts<'_>),
    reference: &Reference,
    device: &mut dyn Device,
) -> Result<bool, String> {
    let rays = &batch.rays;
    let counted = TraceOptions { counters: true };
    let Some(given) = device.trace_from(row.query, rays, starts, counted)? else { return Ok(false) };
    let Some(plain) = device.trace_from(row.query, rays, starts, TraceOptions::default())? else {
        return Err("heads are offered with counters only".into());
    };
    let words = |what: &'static str| move |mismatch: Mismatch| format!("{what}: {mismatch}");
    let agree = |pair, counters| bench.agree(row.structure, rays, pair, counters);
    agree((&reference.forced, &given), false).map_err(words("from heads against brute force"))?;
    agree((&given, &plain), false).map_err(words("without counters"))?;
    if row.device == DeviceKind::Gpu && bench.accuracy == Accuracy::Exact {
        let twin = list.trace_from(row.query, rays, starts, counted).map_err(|error| error.to_string())?;
        agree((&twin, &given), true).map_err(words("from heads against its twin on the cpu"))?;
    }
    work(list, (batch, starts), &given, &reference.whole)?;
    Ok(true)
}

/// Checks what rays from heads did, beside what they did from the first elements on.
fn work(
    list: &TraversalList,
    (batch, starts): (&Batch, Starts<'_>),
    given: &Traced,
    whole: &Traced,
) -> Result<(), String> {
    let rays = &batch.rays;
    let (Some(given), Some(whole)) = (&given.counters, &whole.counters) else {
        return Err("counters were asked for and are not there".into());
    };
    let elements = |counted: &Counters| u64::from(counted.inner_visits) + u64::from(counted.primitive_tests);
    for (index, (ray, counted)) in rays.iter().zip(given).enumerate() {
        let most = reach(list, ray, starts.of(index));
        if elements(counted) > most {
            return Err(format!("ray {index}: from its heads there are {most} elements, not {counted:?}"));
        }
        let others = Counters { inner_visits: 0, primitive_tests: 0, ..*counted };
        if others != Counters::default() {
            return Err(format!("ray {index}: a list has nothing else to count: {counted:?}"));
        }
    }
    let sum = |counters: &[Counters]| counters.iter().map(elements).sum::<u64>();
    let (given, whole) = (sum(given), sum(whole));
    let most = |slack| whole + whole * slack / 100 + 2 * rays.len() as u64;
    if batch.slack.is_none_or(|slack| given <= most(slack)) {
        return Ok(());
    }
    Err(format!("{} rays visit {given} elements from heads, and {whole} from the first", rays.len()))
}

/// The elements of a ray's lists from its heads on.
fn reach(list: &TraversalList, ray: &Ray, heads: Option<&[u32]>) -> u64 {
    let Some(prepared) = PreparedRay::new(ray) else { return 0 };
    let directions = list.options().directions;
    let own = list_of(directions, &prepared);
    let of_layer = |layer: usize| {
        let elements = list.list_of_layer(layer, own).len() as u64;
        let head = heads.map_or(0, |heads| heads[layer * directions.lists() + own]);
        if head == NO_HEAD { 0 } else { elements.saturating_sub(u64::from(head)) }
    };
    (0..list.layers()).map(of_layer).sum()
}
