//! The memory of the restart trail of wide trees: four bits a level.
//!
//! Level 0 is the root's. A level has the number of finished children of its node on the current path, and whether the
//! child that the walk is in is the last one ("no more"): see [`super::restart_trail`] for what they are good for.

use crate::wide_bvh::MAX_LEVELS;

/// The trail, and the level of the current node.
pub trait Trail: Copy {
    /// The most wide nodes on a path that the trail can lead along.
    const LEVELS: u32;

    /// Nothing done, at the root.
    fn new() -> Self;
    /// Which of the current node's `hit` children, nearest first, is the next to visit; `hit` or more where none is.
    fn next(&self, hit: usize) -> usize;
    /// Notes that the child of the current node that is visited next is the last one.
    fn set_last(&mut self);
    /// Goes down to a child of the current node.
    fn descend(&mut self);
    /// Notes that the current node is finished, and goes up to the nearest node above it that has more children to
    /// visit; whether there is one. What was known of the levels below it is forgotten.
    fn finish(&mut self) -> bool;
    /// Goes to the root, to be led down again.
    fn restart(&mut self);
}

/// The bit "no more" of a level, above the three of the number.
const LAST: u32 = 8;
const NUMBER: u32 = 7;
/// Bits a level.
const BITS: u32 = 4;

/// The trail in eight words of eight levels: any tree. The upper levels have the higher bits.
#[derive(Clone, Copy, Debug)]
pub struct ArrayTrail {
    words: [u32; Self::WORDS],
    level: u32,
}

impl ArrayTrail {
    const A_WORD: u32 = u32::BITS / BITS;
    const WORDS: usize = (MAX_LEVELS / Self::A_WORD) as usize;
    /// The bits "no more" of a word.
    const LASTS: u32 = 0x8888_8888;

    /// The word of a level, and where in it the level's bits begin.
    #[inline(always)]
    const fn place(level: u32) -> (usize, u32) {
        let below = Self::A_WORD - 1 - level % Self::A_WORD;
        ((level / Self::A_WORD) as usize, below * BITS)
    }
}

impl Trail for ArrayTrail {
    const LEVELS: u32 = MAX_LEVELS;

    #[inline(always)]
    fn new() -> Self {
        Self { words: [0; Self::WORDS], level: 0 }
    }

    #[inline(always)]
    fn next(&self, _hit: usize) -> usize {
        let (word, shift) = Self::place(self.level);
        (self.words[word] >> shift & NUMBER) as usize
    }

    #[inline(always)]
    fn set_last(&mut self) {
        let (word, shift) = Self::place(self.level);
        self.words[word] |= LAST << shift;
    }

    #[inline(always)]
    fn descend(&mut self) {
        self.level += 1;
    }

    #[inline(always)]
    fn finish(&mut self) -> bool {
        if self.level == 0 {
            return false;
        }
        let (mut word, shift) = Self::place(self.level - 1);
        let mut open = !self.words[word] & Self::LASTS & u32::MAX << shift;
        while open == 0 {
            if word == 0 {
                return false;
            }
            word -= 1;
            open = !self.words[word] & Self::LASTS;
        }
        // The lowest bit is the deepest level's.
        let unit = (open & open.wrapping_neg()) / LAST;
        self.words[word] = (self.words[word] & unit.wrapping_neg()) + unit;
        self.words[word + 1..].fill(0);
        self.level = (word as u32 + 1) * Self::A_WORD - 1 - unit.trailing_zeros() / BITS;
        true
    }

    #[inline(always)]
    fn restart(&mut self) {
        self.level = 0;
    }
}

/// The trail in one word of 64 bits, for trees of 16 levels. The upper levels have the higher bits.
#[derive(Clone, Copy, Debug)]
pub struct TrailU64 {
    trail: u64,
    /// Where the bits of the level above the current one begin: 64 at the root, 0 below the deepest level.
    above: u32,
}

impl TrailU64 {
    /// The bits "no more".
    const LASTS: u64 = 0x8888_8888_8888_8888;
}

impl Trail for TrailU64 {
    const LEVELS: u32 = u64::BITS / BITS;

    #[inline(always)]
    fn new() -> Self {
        Self { trail: 0, above: u64::BITS }
    }

    #[inline(always)]
    fn next(&self, _hit: usize) -> usize {
        (self.trail >> (self.above - BITS) & u64::from(NUMBER)) as usize
    }

    #[inline(always)]
    fn set_last(&mut self) {
        self.trail |= u64::from(LAST) << (self.above - BITS);
    }

    #[inline(always)]
    fn descend(&mut self) {
        self.above -= BITS;
    }

    #[inline(always)]
    fn finish(&mut self) -> bool {
        let levels_above = u64::MAX.checked_shl(self.above).unwrap_or(0);
        let open = !self.trail & Self::LASTS & levels_above;
        if open == 0 {
            return false;
        }
        // The lowest bit is the deepest level's. Clears the levels below it, and adds one to its number.
        let unit = (open & open.wrapping_neg()) / u64::from(LAST);
        self.trail = (self.trail & unit.wrapping_neg()) + unit;
        self.above = unit.trailing_zeros() + BITS;
        true
    }

    #[inline(always)]
    fn restart(&mut self) {
        self.above = u64::BITS;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The trail as it is described: a number and a flag a level.
    #[derive(Clone, Debug)]
    struct Model {
        levels: Vec<(usize, bool)>,
        level: usize,
    }

    impl Model {
        fn finish(&mut self) -> bool {
            let Some(open) = (0..self.level).rev().find(|&level| !self.levels[level].1) else {
                return false;
            };
            self.levels[open].0 += 1;
            self.levels[open + 1..].fill((0, false));
            self.level = open;
            true
        }
    }

    /// Random descents, finishes and restarts, as a walk through random nodes makes them.
    fn follow_the_model<T: Trail + std::fmt::Debug>(levels: usize, seed: u32) {
        let mut state = seed;
        let mut random = |end: u32| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            ((state >> 16) * end) >> 16
        };
        for _ in 0..50 {
            let mut model = Model { levels: vec![(0, false); levels], level: 0 };
            let mut trail = T::new();
            for step in 0..2000 {
                let mut finish = model.level == levels;
                if !finish {
                    let number = model.levels[model.level].0;
                    assert_eq!(trail.next(8), number, "step {step}: {model:?} {trail:?}");
                    match random(8) {
                        0 => finish = true,
                        choice => {
                            // A node has 8 children: the eighth is the last.
                            if choice < 3 || number == 7 {
                                trail.set_last();
                                model.levels[model.level].1 = true;
                            }
                            trail.descend();
                            model.level += 1;
                        }
                    }
                }
                if finish {
                    let more = model.finish();
                    assert_eq!(trail.finish(), more, "step {step}: {model:?} {trail:?}");
                    if !more {
                        break;
                    }
                    assert_eq!(trail.next(8), model.levels[model.level].0);
                    if random(3) == 0 {
                        trail.restart();
                        model.level = 0;
                    }
                }
            }
        }
    }

    #[test]
    fn the_registers_follow_the_model() {
        for levels in [1, 2, 7, 8, 9, 15, 16] {
            follow_the_model::<TrailU64>(levels, levels as u32);
            follow_the_model::<ArrayTrail>(levels, levels as u32);
        }
        for levels in [17, 24, 25, 63, 64] {
            follow_the_model::<ArrayTrail>(levels, levels as u32);
        }
        assert_eq!((TrailU64::LEVELS, ArrayTrail::LEVELS), (16, 64));
    }

    /// All flags set but the root's: what is farthest away is found, and everything below forgotten.
    #[test]
    fn the_root_is_found_from_the_deepest_level() {
        fn from_the_bottom<T: Trail>() {
            let mut trail = T::new();
            trail.descend();
            for _ in 1..T::LEVELS {
                trail.set_last();
                trail.descend();
            }
            assert!(trail.finish());
            assert_eq!(trail.next(8), 1);
            trail.set_last();
            trail.descend();
            assert_eq!(trail.next(8), 0);
            assert!(!trail.finish(), "the root's last child is finished");
        }
        from_the_bottom::<ArrayTrail>();
        from_the_bottom::<TrailU64>();
        assert!(!ArrayTrail::new().finish() && !TrailU64::new().finish());
    }
}
