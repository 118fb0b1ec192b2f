//! What is asked of a ray.

use crate::CatalogueError;
use std::fmt;
use std::str::FromStr;

/// The question a batch asks of each of its rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Query {
    /// The first hit along the ray, ties by the smaller id.
    Closest,
    /// Whether there is a hit at all.
    Any,
    /// Every hit, sorted by `t`, ties by id.
    All,
    /// How many hits there are.
    Count,
}

impl Query {
    /// Every query.
    pub const EVERY: [Self; 4] = [Self::Closest, Self::Any, Self::All, Self::Count];

    /// The name on the command line and in the catalogue.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Closest => "closest",
            Self::Any => "any",
            Self::All => "all",
            Self::Count => "count",
        }
    }
}

impl fmt::Display for Query {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(self.name())
    }
}

impl FromStr for Query {
    type Err = CatalogueError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Self::EVERY.into_iter().find(|query| query.name() == text).ok_or_else(|| {
            CatalogueError(format!("there is no query '{text}'; the queries are closest, any, all, count"))
        })
    }
}
