//! The builder: the surface area heuristic in O(n log n), with perfect splits (Wald and Havran 2006).
//!
//! Events are sorted once, and stay sorted on the way down: a plane sends each triangle's events to one side or the other,
//! and only those of triangles that it cuts are made anew and merged in. A triangle that straddles a plane is clipped to
//! both cells, so that planes are sought where something ends *in the cell* ("perfect splits").
//!
//! **Which triangles a cell has.** The paper leaves out of a cell what the clipped triangle does not reach. Here the clipped
//! triangles steer the cost alone; a cell has every triangle whose *box* overlaps it. This is deliberate: [`super`] has
//! the reason. A triangle whose box alone overlaps the cell is *passive* there: without events, not counted in the cost,
//! in the leaf after the active ones. A split must pay for the active ones, and must not cost much more where the passive ones are
//! counted ([`SLACK`]).
//!
//! Of the references 25 percent are passive in the Stanford dragon, 36 to 46 in the bunny, the kitchen, and both Sponzas.
//!
//! **Bounds.** No leaf is deeper than [`Depth::of`](super::Depth::of) says. Triangles are taken to many leaves only while
//! there are references left of `duplication` times the number of triangles; what a cell does not use its two parts share by
//! the number of their triangles. A cell knows its own share alone, so the tree is the same for any number of threads.

pub(super) mod clip;
mod events;
mod members;
mod sah;
mod subtree;

use super::{KdNode, KdOptions, KdTree};
use crate::clock::Clock;
use crate::parallel::join;
use crate::progress::Progress;
use crate::{Aabb, BuildError, BuildReport, FlatTriangle, Monitor, Scene};
use members::{Members, Room, cut, divide};
use sah::{Costs, Plane, best_plane};
use subtree::{Layout, Subtree};

/// A cell with fewer triangles is built, with all below it, by one thread.
const SEQUENTIAL: usize = 4096;

/// By how much the cost with passive triangles may grow at a split that pays for the active ones. Without a limit there are 30 to
/// 45 percent more references for the same visits and primitive tests (bunny, kitchen, both Sponzas); with 1.0 another 25 to 30
/// percent fewer, and 3 to 15 percent more tests, twice as many in Crytek's Sponza.
const SLACK: f64 = 1.1;

/// Flattens the scene and builds the tree.
pub(super) fn build(scene: &Scene, options: &KdOptions, monitor: &dyn Monitor) -> Result<KdTree, BuildError> {
    options.check()?;
    let clock = Clock::start();
    let flat = scene.flatten()?;
    let flatten_time = clock.elapsed();
    let clock = Clock::start();
    let (bounds, layout) = build_over(&flat.triangles, options, monitor)?;
    let build_time = clock.elapsed();
    let mut tree = KdTree::assemble(layout.nodes, layout.references, flat.triangles, bounds, layout.passive);
    tree.report = BuildReport { input: flat.report, flatten_time, build_time, ..tree.report };
    Ok(tree)
}

fn build_over(
    triangles: &[FlatTriangle],
    options: &KdOptions,
    monitor: &dyn Monitor,
) -> Result<(Aabb, Layout), BuildError> {
    if triangles.is_empty() {
        return Ok((Aabb::EMPTY, Layout::default()));
    }
    let limit = KdNode::LIMIT - 1;
    if triangles.len() > limit {
        return Err(BuildError::TooMany { what: "triangles of a kd-tree", count: triangles.len(), limit });
    }
    let members = Members::all(triangles);
    let cell = members.active.iter().fold(Aabb::EMPTY, |bounds, it| bounds.union(it.bounds));
    let builder = Builder {
        triangles,
        costs: Costs::of(options),
        max_depth: options.max_depth.of(triangles.len()),
        progress: Progress::new(monitor, triangles.len()),
    };
    let most = (triangles.len() as u64 * u64::from(options.duplication)).min(u64::from(u32::MAX / 2));
    let budget = (most as usize).saturating_sub(triangles.len());
    let tree = builder.subtree(members, Task { cell, budget, primitives: triangles.len(), depth: 0 });
    builder.progress.finish()?;
    let layout = tree.into_layout().map_err(|(what, count)| BuildError::TooMany {
        what,
        count,
        limit: if what.starts_with("nodes") { limit } else { u32::MAX as usize - 1 },
    })?;
    Ok((cell, layout))
}

struct Builder<'a> {
    triangles: &'a [FlatTriangle],
    costs: Costs,
    max_depth: u32,
    progress: Progress<'a>,
}

/// What a cell is told from above.
#[derive(Clone, Copy)]
struct Task {
    cell: Aabb,
    /// How many references may be added here and below.
    budget: usize,
    /// For how many of the primitives the cell stands in the monitor's eyes.
    primitives: usize,
    depth: u32,
}

impl Task {
    /// What the parts are told: what is left of the budget and of the primitives is shared out by triangles.
    fn share(&self, cells: [Aabb; 2], parts: &[Members; 2], before: usize) -> [Self; 2] {
        let [low, all] = [parts[0].len(), parts[0].len() + parts[1].len()];
        let left = self.budget.saturating_sub(all.saturating_sub(before));
        let part_of = |whole: usize| (whole as u128 * low as u128 / all.max(1) as u128) as usize;
        let [budget, primitives] = [part_of(left), part_of(self.primitives)];
        let depth = self.depth + 1;
        [
            Self { cell: cells[0], budget, primitives, depth },
            Self { cell: cells[1], budget: left - budget, primitives: self.primitives - primitives, depth },
        ]
    }
}

impl Builder<'_> {
    /// The subtree of a cell.
    fn subtree(&self, members: Members, task: Task) -> Subtree {
        if self.progress.is_cancelled() {
            return Subtree::Whole(Layout::default());
        }
        let mut room = Room::default();
        if members.len() > SEQUENTIAL
            && let Some(plane) = self.plane(&members, &task)
        {
            let (parts, tasks) = self.split(&members, &task, &plane, &mut room);
            drop((members, room));
            let [low, high] = parts;
            let (low, high) = join(|| self.subtree(low, tasks[0]), || self.subtree(high, tasks[1]));
            return Subtree::Split { axis: plane.axis, split: plane.split, children: Box::new([low, high]) };
        }
        let mut layout = Layout::default();
        self.sequential(members, &task, &mut layout, &mut room);
        self.progress.add(task.primitives);
        Subtree::Whole(layout)
    }

    /// Appends the subtree of a cell.
    fn sequential(&self, members: Members, task: &Task, layout: &mut Layout, room: &mut Room) {
        let Some(plane) = self.plane(&members, task) else {
            layout.nodes.push(KdNode::leaf(layout.references.len() as u32, members.len() as u32));
            layout.references.extend(members.triangles());
            layout.passive += members.passive.len();
            room.give(members);
            return;
        };
        let ([low, high], tasks) = self.split(&members, task, &plane, room);
        room.give(members);
        let node = layout.nodes.len();
        layout.nodes.push(KdNode::inner(plane.axis, plane.split, 0));
        self.sequential(low, &tasks[0], layout, room);
        layout.nodes[node] = KdNode::inner(plane.axis, plane.split, layout.nodes.len() as u32);
        self.sequential(high, &tasks[1], layout, room);
    }

    /// The plane that splits a cell; `None` for a leaf.
    fn plane(&self, members: &Members, task: &Task) -> Option<Plane> {
        let (active, count) = (members.active.len(), members.len());
        if active == 0 || task.depth >= self.max_depth {
            return None;
        }
        let plane = best_plane(&members.events, active, &task.cell, &self.costs, count > SEQUENTIAL)?;
        if plane.cost >= self.costs.leaf(active) {
            return None;
        }
        let counts = members.counts(self.triangles, &plane);
        let with_passive = self.costs.of_plane(&plane, &task.cell, counts);
        let is_affordable = counts[0] + counts[1] <= count + task.budget;
        (is_affordable && with_passive < SLACK * self.costs.leaf(count)).then_some(plane)
    }

    fn split(
        &self,
        members: &Members,
        task: &Task,
        plane: &Plane,
        room: &mut Room,
    ) -> ([Members; 2], [Task; 2]) {
        let cells = cut(&task.cell, plane);
        let parts = divide(members, self.triangles, &cells, plane, room);
        let tasks = task.share(cells, &parts, members.len());
        (parts, tasks)
    }
}
