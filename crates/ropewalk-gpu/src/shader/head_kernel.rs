//! The kernels of heads: where rays may begin that stay within half-spaces.

use super::assembly::{AssemblyError, Definitions};
use super::constants::{constants, float};
use super::library::ShaderLibrary;
use ropewalk::traversal_list::{Bounds, heads};

/// What the rows of heads are about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum HeadRows {
    /// Triangles, and rays that leave them.
    Polygons,
    /// Cells of the screen, and primary rays.
    Cells,
}

impl HeadRows {
    /// Words of a row's record: a triangle's number and its vertices' indices, or four half-spaces.
    #[must_use]
    pub const fn record_words(self) -> usize {
        match self {
            Self::Polygons => 4,
            Self::Cells => 4 * HeadKernel::HALF_SPACE_WORDS,
        }
    }

    /// The half-spaces of a row's own.
    const fn own_half_spaces(self) -> usize {
        match self {
            Self::Polygons => 1,
            Self::Cells => 4,
        }
    }
}

/// One combination of the kernel of heads.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct HeadKernel {
    /// What bounds the inner nodes of the lists.
    pub bounds: Bounds,
    /// What a row of heads is about.
    pub rows: HeadRows,
}

impl HeadKernel {
    /// Words of a half-space: a normal, where it begins, and the normal's length.
    pub const HALF_SPACE_WORDS: usize = 5;
    /// The most half-spaces that hold the directions of a list.
    pub const MOST_FACETS: usize = 5;
    /// Words of each list before the rows: how many half-spaces, the list's direction, the half-spaces, two that are left over,
    /// and the share by which a triangle's own half-space is moved outwards.
    pub const LIST_WORDS: usize = 32;
    /// Words that are written a head: the head, counted from its list's first element, and the status.
    pub const RESULT_WORDS: usize = 2;

    /// A name for labels and messages.
    #[must_use]
    pub fn label(&self) -> String {
        let bounds = if self.bounds == Bounds::Sphere { "sphere" } else { "aabb" };
        let rows = match self.rows {
            HeadRows::Polygons => "polygons",
            HeadRows::Cells => "cells",
        };
        format!("list:bounds={bounds} heads of {rows}")
    }

    /// What the shader's conditions and constants are.
    #[must_use]
    pub fn definitions(&self) -> Definitions {
        let outside = match self.bounds {
            Bounds::Sphere => "shared/outside_spheres",
            Bounds::Aabb => "shared/outside_boxes",
        };
        let rows = match self.rows {
            HeadRows::Polygons => "shared/heads_polygon",
            HeadRows::Cells => "shared/heads_frustum",
        };
        constants()
            .text("OUTSIDE", outside)
            .text("ROWS", rows)
            .text("HEAD_LIST_WORDS", Self::LIST_WORDS)
            .text("HEAD_PAD", float(heads::PAD))
            .text("MOST_HALF_SPACES", Self::MOST_FACETS + self.rows.own_half_spaces())
    }

    /// The kernel's WGSL.
    ///
    /// # Errors
    /// When a shader is missing from the library.
    pub fn source(&self, library: &ShaderLibrary) -> Result<String, AssemblyError> {
        library.assemble("kernel/heads", &self.definitions())
    }

    /// Every kernel that can be asked for.
    #[must_use]
    pub fn every() -> Vec<Self> {
        let of = |bounds| [HeadRows::Polygons, HeadRows::Cells].map(|rows| Self { bounds, rows });
        [Bounds::Sphere, Bounds::Aabb].into_iter().flat_map(of).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ropewalk::traversal_list::{Directions, along};

    /// What is counted out for the half-spaces of a list is enough for every list.
    #[test]
    fn there_is_room_for_the_half_spaces_of_any_list() {
        const WORDS: usize = 4 + HeadKernel::MOST_FACETS * HeadKernel::HALF_SPACE_WORDS;
        const { assert!(WORDS < HeadKernel::LIST_WORDS) };
        for (_, directions) in Directions::NAMES.iter().copied() {
            for along in along(directions) {
                assert!(heads::facets(directions, along).len() <= HeadKernel::MOST_FACETS);
            }
        }
    }
}
