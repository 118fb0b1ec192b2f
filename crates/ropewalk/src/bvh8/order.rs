//! In which order the children of a node are pushed, for each octant of directions: farthest first.
//!
//! By the middles of the boxes along the diagonal of the octant (Dietrich, Günther, Slusallek 2007); see [`super::node`] for how
//! the order lies in a node. The order decides how soon a walk finds what it looks for, never what it finds.
//!
//! A place's turn is the number of places that lie farther, counted by comparing all with all, eight lanes at a time and without a
//! branch; the opposite octant has the same order backwards.

use super::tree::WIDTH;

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
    let mut order = [0; WIDTH];
    for octant in 0..4 {
        let places = farthest_first(&keys(&middles, octant, filled));
        add(&mut order, places, octant);
        add(&mut order, places.swap_bytes(), 7 - octant);
    }
    order
}

/// How far each box lies along the diagonal of an octant that does not run backwards along z.
#[inline(always)]
fn keys(middles: &[[f32; WIDTH]; 3], octant: u32, filled: usize) -> [f32; WIDTH] {
    let sign = |axis: u32| if octant >> axis & 1 == 0 { 1.0 } else { -1.0 };
    let (sign_x, sign_y) = (sign(0), sign(1));
    let mut keys = [0.0; WIDTH];
    for place in 0..WIDTH {
        let key = middles[0][place] * sign_x + middles[1][place] * sign_y + middles[2][place];
        // The middle of a box that holds nothing is no number, which no comparison could place.
        keys[place] = if place < filled { key } else { f32::INFINITY };
    }
    keys
}

/// The places by falling keys, ties by place, a byte each, the first one lowest.
#[inline(always)]
fn farthest_first(keys: &[f32; WIDTH]) -> u64 {
    let mut turns = [0u32; WIDTH];
    for other in 0..WIDTH {
        for place in 0..WIDTH {
            let is_farther = keys[other] > keys[place];
            let is_before = keys[other] == keys[place] && other < place;
            turns[place] += u32::from(is_farther | is_before);
        }
    }
    let mut places = 0;
    for (place, turn) in turns.into_iter().enumerate() {
        places |= (place as u64) << (8 * turn);
    }
    places
}

#[inline(always)]
fn add(order: &mut [u32; WIDTH], places: u64, octant: u32) {
    for (word, place) in order.iter_mut().zip(places.to_le_bytes()) {
        *word |= u32::from(place) << (3 * octant);
    }
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
