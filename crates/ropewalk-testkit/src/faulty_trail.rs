//! Restart trails with known faults, which a comparison of walks must find out: the formulas that Laine 2010 prints
//! (ALGORITHMS: C2), and trails that remember too little of where pops led.

use ropewalk::bvh::walk::Trail;

/// It forgets to which levels pops led: answers stay right, leaves are entered twice.
pub const NO_POP_LEVEL: u8 = 0;
/// It remembers the level of the last pop alone, as the paper has it: leaves are entered twice where a hit may lie in front
/// of the box that it was found in.
pub const LAST_POP_LEVEL: u8 = 4;
/// It clears the bits below a level as the paper prints it.
pub const PRINTED_CLEARING: u8 = 1;
/// It finds the lowest bit as the paper prints it, which misses bit 0.
pub const PRINTED_LOWEST_BIT: u8 = 2;
/// None.
pub const SOUND: u8 = 3;

/// More pops than any walk of the tests has.
const MOST_POPS: u32 = 200_000;

/// A trail in registers of 64 bits with one of the faults of this file.
#[derive(Clone, Copy, Debug)]
pub struct Faulty<const FAULT: u8> {
    trail: u64,
    level: u64,
    far: u64,
    pops: u32,
}

impl<const FAULT: u8> Trail for Faulty<FAULT> {
    const LEVELS: u32 = 63;

    fn new() -> Self {
        Self { trail: 0, level: 1 << 63, far: 0, pops: 0 }
    }

    fn descend(&mut self) {
        self.level >>= 1;
    }

    fn is_near_done(&self) -> bool {
        self.trail & self.level != 0
    }

    fn set_single(&mut self) {
        self.trail |= self.level;
    }

    fn is_far_level(&self) -> bool {
        FAULT != NO_POP_LEVEL && self.far & self.level != 0
    }

    fn finish(&mut self) -> bool {
        self.trail = match FAULT {
            PRINTED_CLEARING => (self.trail & !self.level).wrapping_add(self.level),
            _ => (self.trail & self.level.wrapping_neg()).wrapping_add(self.level),
        };
        self.level = if FAULT == PRINTED_LOWEST_BIT {
            let half = self.trail >> 1;
            (half.wrapping_sub(1) ^ half).wrapping_add(1)
        } else {
            self.trail & self.trail.wrapping_neg()
        };
        let before = if FAULT == LAST_POP_LEVEL { 0 } else { self.far & self.level.wrapping_neg() };
        self.far = before | self.level;
        // A trail may lead in circles without ever coming to a leaf, where a visitor could end it.
        self.pops += 1;
        self.trail >> 63 == 0 && self.pops < MOST_POPS
    }

    fn restart(&mut self) {
        self.level = 1 << 63;
    }
}
