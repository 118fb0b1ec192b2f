//! Triangles out of a row of corners: lists, strips and fans, in the order and winding of the glTF specification.

/// How corners make triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Topology {
    List,
    Strip,
    Fan,
}

impl Topology {
    /// The topology of a primitive's mode; an error names what else it is.
    pub(super) const fn of(mode: u64) -> Result<Self, &'static str> {
        match mode {
            0 => Err("primitives made of points"),
            1..=3 => Err("primitives made of lines"),
            4 => Ok(Self::List),
            5 => Ok(Self::Strip),
            6 => Ok(Self::Fan),
            _ => Err("primitives of an unknown mode"),
        }
    }

    /// How many triangles so many corners make.
    pub(super) const fn triangle_count(self, corners: usize) -> usize {
        match self {
            Self::List => corners / 3,
            Self::Strip | Self::Fan => corners.saturating_sub(2),
        }
    }

    /// The corners of a triangle. Every other one of a strip is turned, so that all face the same way.
    pub(super) const fn corners(self, triangle: usize) -> [usize; 3] {
        match self {
            Self::List => [3 * triangle, 3 * triangle + 1, 3 * triangle + 2],
            Self::Strip => [triangle, triangle + 1 + triangle % 2, triangle + 2 - triangle % 2],
            Self::Fan => [triangle + 1, triangle + 2, 0],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangles(topology: Topology, corners: usize) -> Vec<[usize; 3]> {
        (0..topology.triangle_count(corners)).map(|triangle| topology.corners(triangle)).collect()
    }

    #[test]
    fn orders_of_the_specification() {
        assert_eq!(triangles(Topology::List, 7), [[0, 1, 2], [3, 4, 5]]);
        assert_eq!(triangles(Topology::Strip, 5), [[0, 1, 2], [1, 3, 2], [2, 3, 4]]);
        assert_eq!(triangles(Topology::Fan, 5), [[1, 2, 0], [2, 3, 0], [3, 4, 0]]);
        for topology in [Topology::List, Topology::Strip, Topology::Fan] {
            assert!((0..3).all(|corners| topology.triangle_count(corners) == 0));
        }
    }
}
