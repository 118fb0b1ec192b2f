//! What the comparisons of short stacks with the full stack share, whatever is asked of the trees.
//!
//! | file | what |
//! |---|---|
//! | `trees` | which trees are walked |
//! | `short_stack` | the walks, by the size of their stack |
//! | `cost` | means of the counts, rounds, rates and ratios |
//! | `columns` | rows as CSV |
//! | `error` | why there is no comparison |

mod columns;
mod cost;
mod error;
mod short_stack;
mod trees;

pub(crate) use columns::{Column, maybe, write_columns};
pub(crate) use cost::{Means, Rates, time};
pub use error::ComparisonError;
pub use short_stack::ShortStack;
pub(crate) use short_stack::walks;
pub use trees::TreeSettings;
pub(crate) use trees::builder_name;
