//! Frames a second of two levels beside one kd-tree: Table 2 of Reichl et al. 2010, on any scene.
//!
//! A picture is rendered by a tree of rays in four configurations: primary hits shaded alone; with shadows; with reflections; and
//! with everything, five bounces deep. Primary hits are drawn and not traced, as in the paper; how much that gains stands in a
//! table of its own.
//!
//! **Order of work.** The pictures of both structures are held against each other before anything is timed. A ray that is taken to
//! an object is rounded otherwise than one that is not, so pixels may differ where a ray grazes an edge; how many do is counted,
//! and more than a few are an error (`agreement`). Then the rounds: each renders every lane once, one after the other, so that
//! a machine that slows down slows all alike.
//!
//! **Counts** are those of the walks of the rays behind the primary hits, of primary shading alone those of the primary rays if
//! they are traced. They are the same on every machine.
//!
//! | file | what |
//! |---|---|
//! | `configuration` | what of the tree of rays is followed |
//! | `counting` | what the walks of a picture do |
//! | `agreement` | whether pictures are the same |
//! | `experiment` | the runs |
//! | `paper` | what the paper prints |
//! | `record` | rows, for JSON and CSV |
//! | `report` | everything in markdown |

mod agreement;
mod configuration;
mod counting;
mod experiment;
mod paper;
mod record;
mod report;

pub use configuration::Configuration;
pub use experiment::{ReichlTable2Settings, run};
pub use record::{
    PrimaryRow, ReichlTable2Findings, ReichlTable2Row, ReichlTable2Scene, write_csv, write_primary_csv,
};
pub use report::markdown;
