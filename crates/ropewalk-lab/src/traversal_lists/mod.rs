//! What traversal lists cost, with each of their options: the tables of Toczek, Houzet and Mancini 2010, on any scene.
//!
//! A scene stands on the paper's ground of two triangles and is seen from six places around it. Three classes of rays are
//! traced: those of the camera, those from the front of what it sees to a point light, and those that bounce off there.
//! For each setting of the lists the elements a ray are counted; counts are exact and the same on every machine. On
//! request whole frames, camera rays and shadow rays of one view, are timed too.
//!
//! | table | settings | scene |
//! |---|---|---|
//! | `columns` | 1, 2, 6 and 8 lists, without options and with all: the reference measurements (ALGORITHMS: 4.2) and the paper's Table 2 | on the ground |
//! | `table-1` | the paper's Table 1: order, culling, heads and frustum culling in all 16 combinations, six lists | without ground |
//! | `as-printed` | the paper's rule of culling, with the hits that it loses | without ground |
//! | `best` | the best lists that are known, and the same tree walked in other ways | on the ground |
//!
//! Table 3, the time to copy the lists beside that of a frame, comes with the frames of `columns`.
//!
//! **Order of work.** The reference answers come from the ordered stack over another tree, of triangles with two sides and
//! with one, and are held against every triangle, ray by ray, as far as a budget reaches. A setting whose answers
//! differ in one bit, on the CPU and on software adapters, is an error: nothing is counted of it. The paper's rule of
//! culling and spheres that hold vertices alone may lose hits, which are counted.
//!
//! **Spheres.** Those of this project hold the triangles' boxes, those of the paper and of the reference the vertices. The
//! columns are counted with both ([`ropewalk::traversal_list::Reach`]).
//!
//! | file | what |
//! |---|---|
//! | `stage` | the scene and its ground |
//! | `orbit` | six views and a light |
//! | `batches` | the rays of a class, and where each begins |
//! | `truth` | the answers of triangles with two sides and with one |
//! | `verdict` | whether a setting answers so |
//! | `settings` | the settings of each table |
//! | `lane` | a setting on a device: counts and times |
//! | `copier` | the copy of lists in memory |
//! | `experiment` | the runs |
//! | `rows` | from counts and times to rows |
//! | `paper` | what the paper prints |
//! | `reference` | what the reference measurements say |
//! | `record` | a row, for JSON and CSV |
//! | `report` | everything in markdown |
//! | `elements_table` | elements a ray and rates, a line a setting |
//! | `bytes_table` | copies and memory |
//! | `cells` | how many counts are near the reference's |
//! | `plot` | elements a ray by setting |

mod batches;
mod bytes_table;
mod cells;
mod copier;
mod elements_table;
mod experiment;
mod lane;
mod orbit;
mod paper;
mod plot;
mod record;
mod reference;
mod report;
mod rows;
mod settings;
mod stage;
mod truth;
mod verdict;

pub use experiment::{ListSettings, run};
pub use paper::{PaperCopy, PaperFrame, PaperRow, TABLE_1, TABLE_2, TABLE_3};
pub use plot::plot;
pub use record::{CopyRow, ListComparison, ListRow, ListScene, write_csv};
pub use reference::{REFERENCE, Reference};
pub use report::markdown;
pub use settings::Table;
