//! What one walk may count. Where a mistake does not show in the hits (a leaf entered twice, nothing culled), it
//! shows here; what must hold between walks stands in [`super::relations`].
//!
//! Nothing for a ray that is not valid; no triangle, leaf or node more often than there are of them; no stack deeper
//! than the tree, or than it was made; brute force tests every triangle exactly once. A restart trail may come by a
//! node again after each restart, restarts at most once for each child that is not the first of its node, and enters
//! no leaf twice. A list has no leaves and no stack: each element counts as a node or as a test. A triangle that spatial splits put into several leaves may be tested once in each.

use ropewalk::catalogue::Row;
use ropewalk::{Answer, Counters, Query, Ray, Structure, Traced, Walk};

/// Checks the counters of one row by themselves.
///
/// # Errors
/// Says what cannot be.
pub fn check(structure: &Structure, row: Row, rays: &[Ray], traced: &Traced) -> Result<(), String> {
    let Some(counters) = &traced.counters else {
        return Err("counters were asked for and are not there".into());
    };
    if counters.len() != rays.len() || traced.answer.len() != rays.len() {
        return Err(format!("{} rays have {} counters", rays.len(), counters.len()));
    }
    for (index, (ray, counted)) in rays.iter().zip(counters).enumerate() {
        let checked = if ray.is_valid() {
            check_ray(structure, row, is_hit(&traced.answer, index), counted)
        } else if *counted == Counters::default() {
            Ok(())
        } else {
            Err("work was done for a ray that is not valid")
        };
        checked.map_err(|what| format!("ray {index}: {what}: {counted:?}"))?;
    }
    Ok(())
}

fn check_ray(structure: &Structure, row: Row, hit: bool, counted: &Counters) -> Result<(), &'static str> {
    let report = structure.report();
    let inner_nodes = report.nodes - report.leaves;
    let restarts = counted.restarts as usize;
    if counted.primitive_tests as usize > report.references {
        return Err("more triangles were tested than there are");
    }
    // A list has triangles where a tree has leaves.
    let leaves = if matches!(structure, Structure::List(_)) { 0 } else { report.leaves };
    if counted.leaf_visits as usize > leaves {
        return Err("more leaves were entered than there are");
    }
    if counted.inner_visits as usize > inner_nodes.saturating_mul(restarts + 1) {
        return Err("more inner nodes were visited than there are");
    }
    if counted.stack_depth > deepest_stack(structure, row.walk) {
        return Err("the stack was deeper than the tree, or than it was made");
    }
    if counted.leaf_visits > counted.primitive_tests || (hit && counted.primitive_tests == 0) {
        return Err("a leaf was entered or a hit found without a test");
    }
    if counted.objects_entered > 0 {
        return Err("a walk over one structure enters no object");
    }
    match row.walk {
        // Every child but the root, less the first of each node.
        Walk::RestartTrail(_) if restarts > report.leaves.saturating_sub(1) => {
            return Err("there are more restarts than branches");
        }
        Walk::RestartTrail(_) => {}
        _ if restarts > 0 => return Err("a walk with a full stack restarts nowhere"),
        _ => {}
    }
    if row.walk == Walk::BruteForce {
        let everything =
            counted.primitive_tests as usize == report.references && counted.leaf_visits as usize == leaves;
        let may_stop = row.query == Query::Any && hit;
        if counted.inner_visits > 0 || !(everything || may_stop) {
            return Err("brute force tests every triangle once and no box");
        }
    } else if (counted.inner_visits == 0) != (inner_nodes == 0) {
        return Err("a walk begins at the root's children, if it has any");
    }
    Ok(())
}

/// The most entries that the stack of a walk can hold: one a level in a binary tree.
fn deepest_stack(structure: &Structure, walk: Walk) -> u32 {
    let of_tree = match structure {
        Structure::WideBvh(bvh) => bvh.stack_entries(),
        Structure::List(_) => 0,
        _ => structure.report().depth,
    };
    match walk {
        Walk::RestartTrail(options) => of_tree.min(options.short_stack),
        _ => of_tree,
    }
}

fn is_hit(answer: &Answer, index: usize) -> bool {
    match answer {
        Answer::Closest(hits) => hits[index].is_hit(),
        Answer::Any(hits) => hits[index],
        Answer::Count(counts) => counts[index] > 0,
        Answer::All(lists) => !lists.of(index).is_empty(),
    }
}
