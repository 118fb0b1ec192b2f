//! Events: where the part of a triangle in a cell begins and ends along an axis (Wald and Havran 2006).
//!
//! An event is one 64-bit number, whose order as a number is that of the sweep: by place, then ends before what lies in
//! the plane before beginnings, then by triangle. No two events are the same, so every sort has one result.
//!
//! | bits | what |
//! |---|---|
//! | 63 to 32 | the place: a f32 whose bits were turned so that they sort as a number |
//! | 31, 30 | 0 it ends, 1 it lies in the plane, 2 it begins |
//! | 29 to 0 | the triangle, counted within the node |

use crate::Aabb;

/// What happens.
pub(super) const END: u32 = 0;
pub(super) const PLANAR: u32 = 1;
pub(super) const START: u32 = 2;

/// The triangle's bits.
const TRIANGLE: u64 = (1 << 30) - 1;

/// An event.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Event(u64);

impl Event {
    #[inline(always)]
    pub(super) fn new(place: f32, kind: u32, triangle: u32) -> Self {
        // Of -0 and 0 one, so that they are one place.
        let bits = (place + 0.0).to_bits();
        let ordered = if bits >> 31 == 0 { bits | 1 << 31 } else { !bits };
        Self(u64::from(ordered) << 32 | u64::from(kind) << 30 | u64::from(triangle))
    }

    #[inline(always)]
    pub(super) const fn place(self) -> f32 {
        let ordered = (self.0 >> 32) as u32;
        f32::from_bits(if ordered >> 31 == 1 { ordered ^ 1 << 31 } else { !ordered })
    }

    /// The bits of the place, equal for equal places.
    #[inline(always)]
    pub(super) const fn place_key(self) -> u32 {
        (self.0 >> 32) as u32
    }

    #[inline(always)]
    pub(super) const fn kind(self) -> u32 {
        (self.0 >> 30) as u32 & 3
    }

    #[inline(always)]
    pub(super) const fn triangle(self) -> usize {
        (self.0 & TRIANGLE) as usize
    }

    /// The same event of a triangle that is counted otherwise.
    #[inline(always)]
    pub(super) const fn of(self, triangle: u32) -> Self {
        Self(self.0 & !TRIANGLE | triangle as u64)
    }
}

/// Adds the events of a box, of each axis to its list.
#[inline(always)]
pub(super) fn add(events: &mut [Vec<Event>; 3], bounds: &Aabb, triangle: u32) {
    for (axis, events) in events.iter_mut().enumerate() {
        let (from, to) = (bounds.min[axis], bounds.max[axis]);
        if from == to {
            events.push(Event::new(from, PLANAR, triangle));
        } else {
            events.push(Event::new(from, START, triangle));
            events.push(Event::new(to, END, triangle));
        }
    }
}

/// Merges a sorted list into another one.
pub(super) fn merge(into: &mut Vec<Event>, other: &[Event]) {
    let Some(&filler) = other.first() else { return };
    let mut left = into.len();
    let mut right = other.len();
    into.resize(left + right, filler);
    // From the end on, into the places that became free.
    let mut to = into.len();
    while right > 0 {
        to -= 1;
        if left > 0 && into[left - 1] > other[right - 1] {
            left -= 1;
            into[to] = into[left];
        } else {
            right -= 1;
            into[to] = other[right];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn events_sort_by_place_then_kind_then_triangle() {
        let places = [-1e30, -2.0, -1e-40, 0.0, 1e-40, 1.0, 3e12];
        let mut events = Vec::new();
        for place in places {
            for kind in [END, PLANAR, START] {
                for triangle in [0, 1, (1 << 30) - 1] {
                    events.push(Event::new(place, kind, triangle));
                }
            }
        }
        assert!(events.is_sorted_by(|a, b| a < b));
        for event in &events {
            assert!(places.contains(&event.place()) && event.kind() <= START);
        }
        assert_eq!(Event::new(-0.0, END, 3), Event::new(0.0, END, 3));
        let moved = Event::new(5.0, START, 7).of(9);
        assert_eq!((moved.place(), moved.kind(), moved.triangle()), (5.0, START, 9));
    }

    #[test]
    fn merging_keeps_the_order() {
        let list = |numbers: &[u32]| -> Vec<Event> {
            numbers.iter().map(|&number| Event::new(1.0, END, number)).collect()
        };
        for (a, b) in [(&[1, 4, 6][..], &[0, 2, 3, 9][..]), (&[], &[1, 2]), (&[1, 2], &[]), (&[5], &[1, 9])] {
            let mut merged = list(a);
            merge(&mut merged, &list(b));
            let mut all = [a, b].concat();
            all.sort_unstable();
            assert_eq!(merged, list(&all));
        }
    }
}
