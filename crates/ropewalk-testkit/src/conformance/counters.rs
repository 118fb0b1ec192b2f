//! What one walk may count. Where a mistake does not show in the hits (a leaf entered twice, nothing culled), it
//! shows here; what must hold between walks stands in [`super::relations`].
//!
//! Nothing for a ray that is not valid; no triangle, leaf or node more often than there are of them; no stack deeper
//! than the tree, or than it was made; brute force tests every triangle exactly once. A restart trail may come by a
//! node again after each restart, restarts at most once for each child that is not the first of its node, and enters
//! no leaf twice. A triangle that spatial splits put into several leaves may be tested once in each. A list has no leaves and
//! no stack: each element counts as a node or as a test, and a ray meets those of its own list of each layer alone, once.

use ropewalk::bvh8::Instanced;
use ropewalk::catalogue::Row;
use ropewalk::traversal_list::{Element, list_of};
use ropewalk::{
    Answer, Counters, PreparedRay, Query, Ray, Structure, StructureKind, Traced, TraversalList, TwoLevel,
    Walk,
};

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
    let holdings = Holdings::new(structure);
    for (index, (ray, counted)) in rays.iter().zip(counters).enumerate() {
        let checked = if let Some(ray) = PreparedRay::new(ray) {
            check_ray(structure, row, &holdings.of(&ray), is_hit(&traced.answer, index), counted)
        } else if *counted == Counters::default() {
            Ok(())
        } else {
            Err("work was done for a ray that is not valid")
        };
        checked.map_err(|what| format!("ray {index}: {what}: {counted:?}"))?;
    }
    Ok(())
}

/// What a ray may come by.
#[derive(Clone, Copy, Default)]
struct Holding {
    inner_nodes: usize,
    leaves: usize,
    /// Places of triangles.
    triangles: usize,
    /// Whether there is an inner node that each ray comes by.
    has_root: bool,
}

impl Holding {
    /// Of both levels of packed trees: each instance has what its object has.
    fn of_instances(scene: &Instanced) -> Self {
        let below: usize = scene.objects().iter().map(|object| object.report().nodes).sum();
        let top = scene.report().nodes - below;
        let mut sum = Self { inner_nodes: top, has_root: top > 0, ..Self::default() };
        for placed in scene.placed() {
            let report = scene.objects()[placed.object as usize].report();
            sum.inner_nodes += report.nodes - report.leaves;
            sum.leaves += report.leaves;
            sum.triangles += report.references;
        }
        sum
    }

    /// Of both levels: each instance has what its object has, a list all of its elements.
    fn of_levels(scene: &TwoLevel) -> Self {
        let top = scene.placed().len().saturating_sub(1);
        let mut sum = Self { inner_nodes: top, has_root: top > 0, ..Self::default() };
        for placed in scene.placed() {
            let Some(Some(object)) = scene.objects().get(placed.object as usize) else { continue };
            let report = object.report();
            sum.inner_nodes += report.nodes;
            sum.leaves += report.leaves;
            sum.triangles += report.references;
        }
        sum
    }
}

/// What the rays may come by, of lists that of each list: of all layers together.
struct Holdings<'a> {
    list: Option<&'a TraversalList>,
    each: Vec<Holding>,
}

impl<'a> Holdings<'a> {
    fn new(structure: &'a Structure) -> Self {
        let list = match structure {
            Structure::List(list) => list,
            Structure::TwoLevel(scene) => return Self { list: None, each: vec![Holding::of_levels(scene)] },
            Structure::Instanced(scene) => {
                return Self { list: None, each: vec![Holding::of_instances(scene)] };
            }
            _ => {
                let report = structure.report();
                let inner_nodes = report.nodes - report.leaves;
                let (leaves, triangles) = (report.leaves, report.references);
                let whole = Holding { inner_nodes, leaves, triangles, has_root: inner_nodes > 0 };
                return Self { list: None, each: vec![whole] };
            }
        };
        let of_list = |index: usize| {
            let mut holding = Holding::default();
            for layer in 0..list.layers() {
                let elements = list.list_of_layer(layer, index);
                let triangles = elements.iter().filter(|element| element.is_triangle()).count();
                // A hit of the first layer may be enough. A list without any element is none at all.
                if holding.inner_nodes + holding.triangles == 0 {
                    holding.has_root = elements.first().is_some_and(|first| !Element::is_triangle(first));
                }
                holding.triangles += triangles;
                holding.inner_nodes += elements.len() - triangles;
            }
            holding
        };
        let each = (0..list.options().directions.lists()).map(of_list).collect();
        Self { list: Some(list), each }
    }

    fn of(&self, ray: &PreparedRay) -> Holding {
        let index = self.list.map_or(0, |list| list_of(list.options().directions, ray));
        self.each.get(index).copied().unwrap_or_default()
    }
}

fn check_ray(
    structure: &Structure,
    row: Row,
    holding: &Holding,
    hit: bool,
    counted: &Counters,
) -> Result<(), &'static str> {
    let report = structure.report();
    let Holding { inner_nodes, leaves, .. } = *holding;
    let restarts = counted.restarts as usize;
    let kind = structure.kind();
    // Brute force goes through lists and kd-trees by the numbers of triangles, of which each has one.
    let is_list = kind == StructureKind::List;
    let by_number =
        matches!(kind, StructureKind::List | StructureKind::KdTree) && row.walk == Walk::BruteForce;
    // Where the order of cells is undecided by t, these begin again with a walk that decides it.
    let may_begin_again =
        matches!(row.walk, Walk::KdRestart | Walk::KdBacktrack | Walk::ShortStack { .. } | Walk::Ropes);
    let times = if may_begin_again { 2 } else { 1 };
    let triangles = if by_number { report.triangles } else { holding.triangles };
    if counted.primitive_tests as usize > triangles * times {
        return Err("more triangles were tested than there are");
    }
    if counted.leaf_visits as usize > leaves * times {
        return Err("more leaves were entered than there are");
    }
    // These come by a node again on their way to each leaf.
    let ways = if may_begin_again { counted.leaf_visits as usize } else { 0 };
    if counted.inner_visits as usize > inner_nodes.saturating_mul((restarts + ways + 1) * times) {
        return Err("more inner nodes were visited than there are");
    }
    if counted.stack_depth > deepest_stack(structure, row.walk) {
        return Err("the stack was deeper than the tree, or than it was made");
    }
    // Cells may be empty.
    let has_empty_leaves = matches!(kind, StructureKind::KdTree | StructureKind::TwoLevel);
    let is_leaf_without_test = counted.leaf_visits > counted.primitive_tests && !has_empty_leaves;
    if is_leaf_without_test || (hit && counted.primitive_tests == 0) {
        return Err("a leaf was entered or a hit found without a test");
    }
    let instances = match structure {
        Structure::TwoLevel(scene) => Some(scene.placed().len()),
        Structure::Instanced(scene) => Some(scene.placed().len()),
        _ => None,
    };
    match instances {
        Some(instances) if counted.objects_entered as usize > instances => {
            return Err("more objects were entered than there are");
        }
        Some(_) if hit && counted.objects_entered == 0 => return Err("a hit was found in no object"),
        None if counted.objects_entered > 0 => return Err("a walk over one structure enters no object"),
        _ => {}
    }
    match row.walk {
        // Every child but the root, less the first of each node.
        Walk::RestartTrail(_) if restarts > report.leaves.saturating_sub(1) => {
            return Err("there are more restarts than branches");
        }
        Walk::RestartTrail(_) => {}
        _ if may_begin_again && restarts <= leaves * times => {}
        _ if may_begin_again => return Err("there are more restarts than leaves"),
        _ if restarts > 0 => return Err("a walk with a full stack restarts nowhere"),
        _ => {}
    }
    if row.walk == Walk::BruteForce {
        // Of two levels the instances decide in whose boxes the ray is.
        let all_leaves = counted.leaf_visits as usize == if by_number && !is_list { 0 } else { leaves };
        let everything = counted.primitive_tests as usize == triangles && all_leaves;
        let may_stop = row.query == Query::Any && hit || instances.is_some();
        if counted.inner_visits > 0 || !(everything || may_stop) {
            return Err("brute force tests every triangle once and no box");
        }
        // The box of a kd-tree is asked for first.
    } else if counted.inner_visits == 0 && holding.has_root && kind != StructureKind::KdTree {
        return Err("a walk begins at the root's children, if it has any");
    }
    Ok(())
}

/// The most entries that the stack of a walk can hold: one a level in a binary tree.
fn deepest_stack(structure: &Structure, walk: Walk) -> u32 {
    let of_tree = match structure {
        Structure::WideBvh(bvh) => bvh.stack_entries(),
        // All children of a node may wait, before the first is taken again.
        Structure::Bvh8(bvh) => bvh.report().depth * 7 + 1,
        // Each level has a stack of its own.
        Structure::Instanced(scene) => {
            let deepest = scene.objects().iter().map(|object| object.report().depth).max().unwrap_or(0);
            deepest.max(scene.report().depth - deepest) * 7 + 1
        }
        Structure::List(_) => 0,
        Structure::TwoLevel(scene) => {
            let bottoms = scene.objects().iter().flatten().map(|object| object.bottom().stack_entries());
            bottoms.fold(scene.top().depth(), u32::max)
        }
        _ => structure.report().depth,
    };
    match walk {
        Walk::RestartTrail(options) => of_tree.min(options.short_stack),
        Walk::ShortStack { entries } => of_tree.min(entries),
        Walk::KdRestart | Walk::KdBacktrack | Walk::Ropes => 0,
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
