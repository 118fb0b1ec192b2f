//! Packets: 64 or 8 rays that run side by side, led through the tree as one (Wald et al. 2001; Boulos, Wald, Shirley 2006).
//!
//! Rays of a picture or towards a lamp, as they come in a batch, mostly pass the same nodes. Where all of them have the same octant and
//! the same largest axis, a node's boxes are tested against intervals of origins and inverse directions, which is the test
//! of one ray with other constants; each operation is monotone, so what one of the rays enters the packet enters, rounding or not. At
//! a leaf the intervals of each eight rays are tested against its box, all at once, then the rays of those that remain, and then those
//! against its triangles.
//!
//! Where 64 rays do not run alike, eight packets of 8 are tried. **A packet that spreads is given up**: one that has done as much
//! work as its rays would one by one hands them over, and a chunk in which packets cost too much tries no more: such rays go one by one
//! ([`super::one_by_one`]), all others in turn ([`super::interleave`]). **Hits** are those of one ray, bit for bit.
//!
//! **Cost.** 4.8 KiB for the rays, and two stacks.

mod lead;
mod rays;

use super::Stack;
use super::interleave::Goal;
use super::single::Place;
use super::sink::is_blind_to;
use super::stack::ROOM;
use crate::Ray;
use crate::bvh8::arena::Reader;
use crate::bvh8::simd::{Level, Task};
use crate::bvh8::tree::WIDTH;
use lead::lead;
use rays::Packet;
use std::ops::Range;

/// Rays of a packet at most.
const RAYS: usize = 64;
/// Rays of a small one.
const FEW: usize = WIDTH;
const GROUPS: usize = RAYS / WIDTH;
/// Rays of a chunk at most.
pub(super) const CHUNK: usize = 64 * RAYS;
/// What a packet may cost a ray before it is given up: a node is 1, and so is a triangle for eight rays. Pictures cost 1 to 2; one by
/// one a ray costs what 10 to 15 of these do.
const MOST_WORK: usize = 12;
/// What the packets of a chunk may cost a ray on average.
const WORTH: usize = 6;
/// As if so many rays had cost nothing before, so that one bad packet ends nothing.
const CREDIT: usize = 4 * RAYS;

/// The rays of a chunk that were not led.
pub(super) struct Left {
    /// Which, in their order.
    pub(super) runs: Vec<Range<usize>>,
    /// Whether they run side by side, though it was not worth leading them so.
    pub(super) run_alike: bool,
}

/// Leads the packets of a chunk of at most [`CHUNK`] rays.
pub(super) struct Packets<'a, 'b, R, G: Goal> {
    pub(super) place: Place<'a, R>,
    pub(super) rays: &'b [Ray],
    /// As many as there are rays.
    pub(super) answers: &'b mut [G::Answer],
}

impl<'a, R: Reader<'a>, G: Goal> Task for Packets<'a, '_, R, G> {
    type Output = Left;

    #[inline(always)]
    fn run<L: Level>(self, level: L) -> Left {
        let Self { place, rays, answers } = self;
        let mut left: Vec<Range<usize>> = Vec::new();
        let mut packet = Packet::EMPTY;
        let mut sinks = [G::sink(0.0); RAYS];
        let mut stack = Stack::new();
        let mut parents = [0; ROOM];
        let mut spent = 0;
        let end = rays.len().min(CHUNK);
        let (mut first, mut count) = (0, RAYS);
        while first + FEW <= end && spent <= WORTH * (first + CREDIT) {
            // A whole packet where one begins; the rest of it, or of the chunk, in small ones.
            if first + count > end {
                count = FEW;
            }
            let (mut led, mut gave_up) = (false, false);
            if packet.take(level, &rays[first..first + count]) {
                for (ray, sink) in sinks.iter_mut().enumerate().take(count) {
                    let (group, lane) = (ray / WIDTH, ray % WIDTH);
                    *sink = G::sink(packet.t_max[group][lane]);
                    if is_blind_to(packet.masks[ray], place.names) {
                        packet.t_max[group][lane] = f32::NEG_INFINITY;
                    }
                }
                let work = lead(level, place, &mut packet, &mut sinks, &mut stack, &mut parents);
                led = work.is_some();
                spent += work.unwrap_or(MOST_WORK * count);
                gave_up = !led;
            }
            if led {
                for (answer, sink) in answers[first..first + count].iter_mut().zip(&sinks) {
                    *answer = G::answer(Some(sink), place.names);
                }
            } else if count == RAYS && !gave_up {
                count = FEW;
                continue;
            } else {
                leave(&mut left, first..first + count);
            }
            first += count;
            if first % RAYS == 0 {
                count = RAYS;
            }
        }
        // Only packets cost anything, so rays whose packets cost too much run alike.
        let run_alike = first + FEW <= end;
        leave(&mut left, first..rays.len());
        Left { runs: left, run_alike }
    }
}

/// Notes rays that are left.
fn leave(left: &mut Vec<Range<usize>>, rays: Range<usize>) {
    match left.last_mut() {
        Some(last) if last.end == rays.start => last.end = rays.end,
        _ => left.push(rays),
    }
}
