//! In which order the children of a node are pushed, for each octant of directions: farthest first.
//!
//! By the middles of the boxes along the diagonal of the octant (Dietrich, Günther, Slusallek 2007); see [`super::node`] for how
//! the order lies in a node. The order decides how soon a walk finds what it looks for, never what it finds.
//!
//! Four octants are sorted at once, one a lane, by a network without a branch ([`super::network`]); the opposite octant has the
//! same order backwards.

use super::network::sorted;
use super::tree::WIDTH;

/// Octants that do not run backwards along z. Each of the others is the opposite of one of them.
const LANES: usize = 4;
/// The bits of a place, which are the lowest of its key: so no two keys are the same, and ties go by place. The middles
/// that differ in these bits alone are a millionth apart.
const PLACE: i32 = WIDTH as i32 - 1;

/// The places of a node in the order in which rays of each octant push them, packed. The boxes of the first `filled` places count:
/// those that hold nothing are never hit, and come first or last.
#[inline(always)]
pub(super) fn push_order(bounds: &[[f32; WIDTH]; 6], filled: usize) -> [u32; WIDTH] {
    let mut middles = [[0.0; WIDTH]; 3];
    for axis in 0..3 {
        for place in 0..WIDTH {
            middles[axis][place] = bounds[axis][place] + bounds[axis + 3][place];
        }
    }
    let mut keys = [[0; LANES]; WIDTH];
    for (place, key) in keys.iter_mut().enumerate() {
        *key = keys_of(&middles, place, filled);
    }
    let nearest_first = sorted(keys, exchange);
    // From octant beside octant to place beside place.
    let mut places = [[0; WIDTH]; LANES];
    for (turn, keys) in nearest_first.iter().enumerate() {
        for (octant, key) in keys.iter().enumerate() {
            places[octant][turn] = (PLACE - (key & PLACE)) as u32;
        }
    }
    let mut order = [0; WIDTH];
    for (octant, places) in places.iter().enumerate() {
        for (turn, word) in order.iter_mut().enumerate() {
            *word |= places[WIDTH - 1 - turn] << (3 * octant) | places[turn] << (3 * (7 - octant));
        }
    }
    order
}

/// How far a box lies along the diagonals of the octants, as numbers that are ordered so.
#[inline(always)]
fn keys_of(middles: &[[f32; WIDTH]; 3], place: usize, filled: usize) -> [i32; LANES] {
    let [x, y, z] = [middles[0][place], middles[1][place], middles[2][place]];
    let along = [x + y + z, -x + y + z, x - y + z, -x - y + z];
    let mut keys = [0; LANES];
    for octant in 0..LANES {
        let bits = along[octant].to_bits() as i32;
        // The order of the bits as a number is that of the values once those of negative ones are turned round.
        let ordered = bits ^ ((bits >> 31) & i32::MAX);
        // The middle of a box that holds nothing is no number.
        let ordered = if place < filled { ordered } else { i32::MAX };
        keys[octant] = (ordered & !PLACE) | (PLACE - place as i32);
    }
    keys
}

#[inline(always)]
fn exchange(a: [i32; LANES], b: [i32; LANES]) -> [[i32; LANES]; 2] {
    let [mut low, mut high] = [a, b];
    for lane in 0..LANES {
        low[lane] = if b[lane] < a[lane] { b[lane] } else { a[lane] };
        high[lane] = if b[lane] < a[lane] { a[lane] } else { b[lane] };
    }
    [low, high]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The places of each octant, sorted plainly.
    fn sorted(bounds: &[[f32; WIDTH]; 6], filled: usize, octant: usize) -> Vec<f32> {
        let mut keys: Vec<f32> = (0..filled).map(|place| key(bounds, place, octant)).collect();
        keys.sort_by(|a, b| b.total_cmp(a));
        keys
    }

    fn key(bounds: &[[f32; WIDTH]; 6], place: usize, octant: usize) -> f32 {
        let middle = |axis: usize| bounds[axis][place] + bounds[axis + 3][place];
        let sign = |axis: usize| if octant >> axis & 1 == 0 { 1.0 } else { -1.0 };
        middle(0) * sign(0) + middle(1) * sign(1) + middle(2) * sign(2)
    }

    #[test]
    fn every_octant_pushes_the_farthest_first() {
        for case in 0..200u32 {
            // Few different numbers, so that there are ties.
            let number =
                |row: usize, place: usize| ((case * 7919 + row as u32 * 31 + place as u32 * 17) % 13) as f32;
            let mut bounds: [[f32; WIDTH]; 6] = std::array::from_fn(|row| {
                std::array::from_fn(|place| number(row % 3, place) + (row / 3) as f32)
            });
            let filled = case as usize % (WIDTH + 1);
            for (row, numbers) in bounds.iter_mut().enumerate() {
                numbers[filled..].fill(if row < 3 { f32::INFINITY } else { f32::NEG_INFINITY });
            }
            let order = push_order(&bounds, filled);
            for octant in 0..8 {
                let places = order.map(|word| (word >> (3 * octant) & 7) as usize);
                let mut all = places;
                all.sort_unstable();
                assert_eq!(all, [0, 1, 2, 3, 4, 5, 6, 7], "case {case}, octant {octant}");
                let pushed = places.iter().filter(|place| **place < filled);
                let keys: Vec<f32> = pushed.map(|&place| key(&bounds, place, octant)).collect();
                assert_eq!(keys, sorted(&bounds, filled, octant), "case {case}, octant {octant}");
            }
        }
    }
}
