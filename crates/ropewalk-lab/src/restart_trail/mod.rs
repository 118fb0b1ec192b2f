//! What it costs to do without a stack: the comparison of Laine 2010, section 3, on any scene.
//!
//! For each builder, leaf cap and class of rays, the restart trail with short stacks of several sizes is held against
//! the full stack on the same rays: inner visits, leaf visits, primitive tests and restarts a ray, and the ratio of the
//! inner visits. Counts are exact and the same on every machine. On request the rates are measured too, each walk once
//! a round, on every device, as medians of the ratios to the full stack's time.
//!
//! **Order of work.** A walk whose answers differ from the full stack's, in one bit on the CPU and on software
//! adapters, is an error: nothing is counted of it.
//!
//! | file | what |
//! |---|---|
//! | `rays` | six views of a scene, and the rays of a class from all of them |
//! | `experiment` | the runs |
//! | `as_printed` | the walk without culling at pop |
//! | `record` | a row, for JSON and CSV |
//! | `bands` | what the paper and the reference measurements say |
//! | `report` | tables in markdown |
//! | `plot` | the ratios over the size of the stack |

mod as_printed;
mod bands;
mod experiment;
mod plot;
mod rays;
mod record;
mod report;

pub use bands::{Band, PUBLISHED, REFERENCE, Reference, WANTED, is_within};
pub use experiment::{TrailSettings, run};
pub use plot::plot;
pub use rays::{Seen, with_ground};
pub use record::{TrailRow, write_csv};
pub use report::markdown;
