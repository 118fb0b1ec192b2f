//! Lists of several layers against their layers one by one.
//!
//! A ray goes through its list of the second layer with what it has found in the first. So each ray must do exactly the work
//! of the first layer alone, and then that of the second alone with a window that ends at the first's closest hit; for any
//! hit, the second only where the first has none. That the ray parameter is carried on does not show in closest hits, for
//! a walk that forgets it finds the same ones and only does more.

use super::checks::Run;
use super::work::Work;
use ropewalk::catalogue::Row;
use ropewalk::traversal_list::{HeadTable, NO_HEAD, Starts};
use ropewalk::{Answer, Counters, Query, Ray, TraceOptions, Traced, TraversalList, Walk};

/// Checks the rows that the lists' own walk answers; gives back the row and what is wrong.
pub(super) fn check(list: &TraversalList, rays: &[Ray], rows: &[Row], runs: &[Run]) -> Vec<(usize, String)> {
    if list.layers() != 2 {
        return Vec::new();
    }
    let listed = runs.iter().filter(|run| rows[run.row].walk == Walk::List);
    let wrong = listed.filter_map(|run| {
        let Some(given) = &run.counted.counters else { return None };
        match apart(list, rays, rows[run.row].query) {
            Err(why) => Some((run.row, why)),
            Ok(expected) => first_difference(&expected, given).map(|what| (run.row, what)),
        }
    });
    wrong.collect()
}

fn first_difference(expected: &[Work], given: &[Counters]) -> Option<String> {
    let given: Vec<Work> = given.iter().map(Work::of).collect();
    let index = (0..expected.len()).find(|&index| given.get(index) != Some(&expected[index]))?;
    let (given, expected) = (given.get(index), expected[index]);
    Some(format!("ray {index}: two layers do {given:?}, and one after the other they do {expected:?}"))
}

/// What the layers do one after the other.
fn apart(list: &TraversalList, rays: &[Ray], query: Query) -> Result<Vec<Work>, String> {
    let first = alone(list, 0, rays, query)?;
    let narrowed = |(index, ray): (usize, &Ray)| match &first.answer {
        Answer::Closest(hits) if hits[index].is_hit() => Ray { t_max: hits[index].t, ..*ray },
        _ => *ray,
    };
    let second = alone(list, 1, &rays.iter().enumerate().map(narrowed).collect::<Vec<_>>(), query)?;
    let (Some(a), Some(b)) = (&first.counters, &second.counters) else { return Err("no counters".into()) };
    let both = a.iter().zip(b).enumerate().map(|(index, (a, b))| {
        let is_enough = matches!(&first.answer, Answer::Any(hits) if hits[index]);
        if is_enough { Work::of(a) } else { Work::of(a).plus(Work::of(b)) }
    });
    Ok(both.collect())
}

/// One layer without the other, of which there is no head.
fn alone(list: &TraversalList, layer: usize, rays: &[Ray], query: Query) -> Result<Traced, String> {
    let lists = list.options().directions.lists();
    let head = |place: usize| {
        let is_empty = list.list_of_layer(place / lists, place % lists).is_empty();
        if place / lists == layer && !is_empty { 0 } else { NO_HEAD }
    };
    let heads = (0..list.layers() * lists).map(head).collect();
    let table = HeadTable::from_heads(list, heads).map_err(|error| error.to_string())?;
    let starts = Starts { table: &table, rows: &vec![0; rays.len()] };
    let options = TraceOptions { counters: true };
    list.trace_from(query, rays, starts, options).map_err(|error| error.to_string())
}
