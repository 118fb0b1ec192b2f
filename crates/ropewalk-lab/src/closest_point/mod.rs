//! Whether closest points are right, and what it costs to find them without a stack: a use of restart trails that
//! Laine 2010 leaves as future work.
//!
//! Random points around a scene are answered by the full stack and by restart trails with short stacks, over trees of
//! several builders and leaf caps, on every device.
//!
//! **Order of work.** The full stack over the default tree on the CPU gives the answers that everybody is held to. An
//! oracle in f64 looks at each of them. Then every walk of every tree answers on every device: to the bit alike on the
//! CPU and on software adapters, within what rounding may do on graphics hardware. At last brute force, which asks
//! every triangle and so takes most of the time, answers as many points as wanted, to the bit alike. The first answer
//! that is wrong is an error: nothing is counted of such a scene.
//!
//! | file | what |
//! |---|---|
//! | `experiment` | the runs |
//! | `reference` | the answers that all are held to, and how they are confirmed |
//! | `judge` | whether a device answers as the reference does |
//! | `record` | a scene and a row, for JSON and CSV |
//! | `report` | tables in markdown |

mod experiment;
mod judge;
mod record;
mod reference;
mod report;

pub use experiment::{PointSettings, run};
pub use record::{PointComparison, PointRow, PointScene, write_csv};
pub use report::markdown;
