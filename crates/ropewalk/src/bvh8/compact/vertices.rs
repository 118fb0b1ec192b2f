//! Vertices, each place once: those of the same bits are one.
//!
//! An open table of indices, by a hash of the three numbers. It is at most half full, 4 to 8 bytes for each vertex beside the 12 of
//! its own, while the tree is packed.

/// Stands for no vertex in the table.
const FREE: u32 = u32::MAX;

/// Vertices in the order in which they came.
pub(super) struct Vertices {
    places: Vec<[u32; 3]>,
    /// Indices of vertices; as many as a power of two.
    table: Vec<u32>,
}

impl Vertices {
    pub(super) fn new(expected: usize) -> Self {
        Self { places: Vec::with_capacity(expected), table: vec![FREE; (2 * expected).next_power_of_two()] }
    }

    /// The bits of their numbers.
    pub(super) fn places(&self) -> &[[u32; 3]] {
        &self.places
    }

    /// The index of a vertex, an old one where it has been before. There are fewer than 2^32 of them.
    pub(super) fn index_of(&mut self, vertex: [f32; 3]) -> u32 {
        let place = vertex.map(f32::to_bits);
        if 2 * self.places.len() >= self.table.len() {
            self.grow();
        }
        let mask = self.table.len() - 1;
        let mut slot = hash(place) & mask;
        loop {
            let index = self.table[slot];
            if index == FREE {
                let index = self.places.len() as u32;
                self.places.push(place);
                self.table[slot] = index;
                return index;
            }
            if self.places[index as usize] == place {
                return index;
            }
            slot = (slot + 1) & mask;
        }
    }

    fn grow(&mut self) {
        let mask = 2 * self.table.len() - 1;
        self.table.clear();
        self.table.resize(mask + 1, FREE);
        for (index, &place) in self.places.iter().enumerate() {
            let mut slot = hash(place) & mask;
            while self.table[slot] != FREE {
                slot = (slot + 1) & mask;
            }
            self.table[slot] = index as u32;
        }
    }
}

/// Products mix upwards, and what has been mixed is brought down. (The constants are those of SplitMix64.)
fn hash([x, y, z]: [u32; 3]) -> usize {
    let mut mixed = (u64::from(x) << 32 | u64::from(y)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    mixed = (mixed ^ mixed >> 32 ^ u64::from(z)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    (mixed ^ mixed >> 29) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vertices_of_the_same_bits_are_one() {
        let mut vertices = Vertices::new(0);
        let vertex = |index: u16| [f32::from(index % 100), f32::from(index / 100), -1.5];
        for round in 0..3 {
            for index in 0..5000 {
                assert_eq!(vertices.index_of(vertex(index)), u32::from(index), "round {round}");
            }
        }
        assert_eq!(vertices.places().len(), 5000);
        // Both zeros are kept: a triangle has the bits that it was given.
        assert_eq!(vertices.index_of([0.0, 0.0, 0.0]), 5000);
        assert_eq!(vertices.index_of([-0.0, 0.0, 0.0]), 5001);
        assert_eq!(vertices.index_of([0.0, 0.0, 0.0]), 5000);
        assert_eq!(vertices.places()[4999], vertex(4999).map(f32::to_bits));
    }
}
