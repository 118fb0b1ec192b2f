//! What two levels cost: the tables of Reichl et al. 2010, on any scene.
//!
//! A scene is seen by one camera. Three classes of rays are traced: those of the camera, those from the front of what it sees to a
//! light, and those that bounce off there. Each goes through two levels, with every structure that objects can have, in oriented
//! boxes and without; and through one kd-tree and one BVH over the flattened scene. Counts are exact and the same on every
//! machine.
//!
//! | table | what |
//! |---|---|
//! | depths | the paper's Table 1: the deepest stack of a ray in the top level and in the objects, average, maximum and variance |
//! | objects | the objects' structures that a ray enters, with oriented boxes and without |
//! | speed | two levels over one kd-tree and one BVH, by a model of what nodes cost and by the clock: the paper's Table 2 |
//! | heat | the paper's Figure 9: a picture of the structures that the rays of each pixel enter |
//! | rebuild | how long the top level takes, for 100 to 100,000 objects that move |
//!
//! **Order of work.** All answers are held against those of one BVH over the flattened scene before anything is counted. A ray that
//! is taken to an object is rounded otherwise than one that is not, so the same bits cannot be asked: the triangle must be
//! the same and `t` within rounding, but where a ray grazes an edge, or triangles lie in one place, of which an oracle in f64
//! decides. How many such rays there are is counted. Any other difference is an error.
//!
//! **Denominators.** Averages are over all rays of a class, those that hit nothing too, which pull them down; where it matters, the
//! average over those that hit stands beside. Where large objects are opened, each part that is entered counts.
//!
//! | file | what |
//! |---|---|
//! | `sight` | the camera and the light |
//! | `turned` | the same scene of parts that were modelled askew |
//! | `batches` | the rays of a class, their pixels and their answers |
//! | `setting` | what is built and how it is walked |
//! | `work` | what a ray did: a probe that tells the levels apart |
//! | `depths` | average, maximum, variance |
//! | `node_cost` | a model of what a ray costs |
//! | `agreement` | whether answers are right |
//! | `lane` | a setting on a device |
//! | `experiment` | the runs |
//! | `rows` | from counts and times to rows |
//! | `heat` | Figure 9 |
//! | `rebuild` | the top level, by the number of objects |
//! | `paper` | what the paper prints |
//! | `record` | rows, for JSON and CSV |
//! | `report`, `tables` | everything in markdown |
//! | `plot` | speeds, objects and times, as SVG |

mod agreement;
mod batches;
mod depths;
mod experiment;
mod heat;
mod lane;
mod node_cost;
mod paper;
mod plot;
mod rebuild;
mod record;
mod report;
mod rows;
mod setting;
mod sight;
mod tables;
mod turned;
mod work;

pub use depths::Depths;
pub use experiment::{TwoLevelSettings, run};
pub use heat::{Band, HeatMap};
pub use paper::{PAPER, PaperScene};
pub use plot::{plot_objects, plot_rebuilds, plot_speeds};
pub use rebuild::{REBUILD_COUNTS, rebuild};
pub use record::{RebuildRow, TwoLevelFindings, TwoLevelRow, TwoLevelScene, write_csv, write_rebuild_csv};
pub use report::markdown;
pub use sight::Sight;
pub use turned::turned;
