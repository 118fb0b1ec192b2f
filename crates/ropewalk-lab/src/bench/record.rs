//! What is kept of a benchmark: plain data for JSON and for tables.

use crate::Spread;
use crate::bench::Agreement;
use serde::Serialize;

/// One scene.
#[derive(Clone, Debug, Serialize)]
pub struct SceneRecord {
    /// Its file or name.
    pub scene: String,
    /// Triangles with instances counted.
    pub triangles: usize,
    /// References to triangles in the leaves: more than there are triangles where spatial splits put some into several.
    pub references: usize,
    /// What was built.
    pub structure: String,
    /// Its nodes.
    pub nodes: usize,
    /// Of these, leaves.
    pub leaves: usize,
    /// The depth of the deepest leaf.
    pub depth: u32,
    /// The expected cost of a random ray by the surface area heuristic.
    pub sah_cost: f64,
    /// Its size.
    pub bytes: usize,
    /// Its size a triangle.
    pub bytes_per_triangle: f64,
    /// How long it took to build, by number of threads.
    pub builds: Vec<BuildRecord>,
    /// Whole rounds that were measured.
    pub rounds: usize,
    /// Whether fewer rounds were measured than asked for.
    pub stopped: bool,
    /// The rays.
    pub classes: Vec<ClassRecord>,
    /// The rates.
    pub lanes: Vec<LaneRecord>,
}

/// How long a build took.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct BuildRecord {
    /// Threads of the CPU.
    pub threads: usize,
    /// The builder's own time in seconds.
    pub build_seconds: Spread,
    /// The time to place all triangles in the scene's space, in seconds.
    pub flatten_seconds: Spread,
}

/// A batch of rays.
#[derive(Clone, Debug, Serialize)]
pub struct ClassRecord {
    /// The kind of rays.
    pub class: String,
    /// What is asked of them.
    pub query: String,
    /// How many there are.
    pub rays: usize,
    /// How many hit something.
    pub rays_that_hit: usize,
}

/// A walk on a device.
#[derive(Clone, Debug, Serialize)]
pub struct LaneRecord {
    /// `cpu`, or the adapter with its interface and driver.
    pub device: String,
    /// Threads of the CPU; `None` for a graphics adapter.
    pub threads: Option<usize>,
    /// How rays go through the structure.
    pub walk: String,
    /// Whether it answers as the reference does.
    pub agreement: Agreement,
    /// How fast it is, by ray class; classes whose answers disagree are left out.
    pub rates: Vec<RateRecord>,
}

/// How fast a walk answers a class of rays.
#[derive(Clone, Debug, Serialize)]
pub struct RateRecord {
    /// The kind of rays.
    pub class: String,
    /// Million rays a second, from the call to the answers in memory.
    pub mrays_per_second: Spread,
    /// Million rays a second of the device's own time, without transfers, where it can be measured.
    pub device_mrays_per_second: Option<Spread>,
    /// What the walk did a ray.
    pub work: Option<Work>,
}

/// What a walk did: means over the rays of a batch. Exact, and the same on every machine.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Work {
    /// Nodes whose children's boxes were tested.
    pub inner_visits: f64,
    /// Leaves entered.
    pub leaf_visits: f64,
    /// Triangles tested.
    pub primitive_tests: f64,
    /// The most entries that any ray's stack held.
    pub deepest_stack: u32,
}
