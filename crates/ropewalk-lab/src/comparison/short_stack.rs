//! The walks of a comparison, by the size of their stack.

use ropewalk::Walk;
use ropewalk::catalogue::TrailOptions;
use serde::{Serialize, Serializer};
use std::fmt;

/// How many entries a stack may hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ShortStack {
    /// The restart trail with so many.
    Entries(u32),
    /// The stack walk, which never drops any.
    Full,
}

impl ShortStack {
    /// The stack that a walk has: any but the restart trail has a full one.
    #[must_use]
    pub const fn of(walk: Walk) -> Self {
        match walk {
            Walk::RestartTrail(options) => Self::Entries(options.short_stack),
            _ => Self::Full,
        }
    }

    /// Its entries, where there is a limit.
    #[must_use]
    pub const fn entries(self) -> Option<u32> {
        match self {
            Self::Entries(entries) => Some(entries),
            Self::Full => None,
        }
    }
}

impl fmt::Display for ShortStack {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Entries(entries) => formatter.pad(&entries.to_string()),
            Self::Full => formatter.pad("full"),
        }
    }
}

impl Serialize for ShortStack {
    /// A number, or the word `full`.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Entries(entries) => serializer.serialize_u32(*entries),
            Self::Full => serializer.serialize_str("full"),
        }
    }
}

/// The full stack, and after it the restart trail with each short stack.
pub(crate) fn walks(short_stacks: &[u32]) -> Vec<Walk> {
    let trail = |&short_stack| Walk::RestartTrail(TrailOptions { short_stack, ..TrailOptions::default() });
    std::iter::once(Walk::default()).chain(short_stacks.iter().map(trail)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stack_is_a_number_or_a_word() {
        let json = serde_json::to_value([ShortStack::Entries(3), ShortStack::Full]).unwrap();
        assert_eq!(json, serde_json::json!([3, "full"]));
        assert!(ShortStack::Entries(16) < ShortStack::Full);
    }

    #[test]
    fn the_full_stack_goes_first() {
        let stacks: Vec<_> = walks(&[0, 4]).into_iter().map(ShortStack::of).collect();
        assert_eq!(stacks, [ShortStack::Full, ShortStack::Entries(0), ShortStack::Entries(4)]);
        assert_eq!(stacks.iter().map(|stack| stack.entries()).collect::<Vec<_>>(), [None, Some(0), Some(4)]);
    }
}
