//! What went wrong with a ray, as a word: nothing is cut off silently.

use std::ops::BitOr;

/// The bits of a ray's status. Zero is a complete answer.
#[repr(transparent)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Status(pub u32);

impl Status {
    /// The answer is complete.
    pub const COMPLETE: Self = Self(0);
    /// The ray is not [valid](crate::Ray::is_valid); the answer is a miss.
    pub const INVALID_RAY: Self = Self(1);
    /// The walk took more steps than its budget and stopped: the structure is damaged.
    pub const STEP_BUDGET: Self = Self(2);
    /// The walk's stack was full: the structure is deeper than the walk was made for.
    pub const STACK_OVERFLOW: Self = Self(4);

    /// Whether the answer is complete.
    #[must_use]
    pub const fn is_complete(self) -> bool {
        self.0 == 0
    }

    /// Whether all bits of `other` are set.
    #[must_use]
    pub const fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }
}

impl BitOr for Status {
    type Output = Self;
    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}
