//! Which nodes have changed: ranges for partial uploads.

use std::ops::Range;

/// Two changes with no more unchanged nodes between them are one range. 64 nodes are 2 KiB, which are copied in less than the
/// microsecond that one more write to a GPU buffer costs.
const GAP: usize = 64;

/// Ranges of nodes, in order, further than [`GAP`] apart.
#[derive(Clone, Debug, Default)]
pub(super) struct Changes {
    ranges: Vec<Range<usize>>,
    /// Those before this place are in order; after it new ones wait to be merged.
    merged: usize,
}

impl Changes {
    pub(super) fn ranges(&self) -> &[Range<usize>] {
        &self.ranges
    }

    pub(super) fn clear(&mut self) {
        self.ranges.clear();
        self.merged = 0;
    }

    /// All of so many nodes have changed.
    pub(super) fn set_all(&mut self, nodes: usize) {
        self.clear();
        if nodes > 0 {
            self.ranges.push(0..nodes);
        }
        self.merged = self.ranges.len();
    }

    /// Nodes have changed. Until [`Changes::merge`] the list is not in order.
    #[inline(always)]
    pub(super) fn add(&mut self, range: Range<usize>) {
        let waiting = self.ranges.get_mut(self.merged..).unwrap_or_default();
        match waiting.last_mut() {
            Some(last) if is_near(last, &range) => {
                *last = last.start.min(range.start)..last.end.max(range.end);
            }
            _ => self.ranges.push(range),
        }
    }

    /// Puts the list in order.
    pub(super) fn merge(&mut self) {
        self.ranges.sort_unstable_by_key(|range| range.start);
        self.ranges.dedup_by(|next, last| {
            let near = is_near(last, next);
            if near {
                last.end = last.end.max(next.end);
            }
            near
        });
        self.merged = self.ranges.len();
    }
}

fn is_near(a: &Range<usize>, b: &Range<usize>) -> bool {
    a.start <= b.end.saturating_add(GAP) && b.start <= a.end.saturating_add(GAP)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_in_order_and_apart() {
        let mut changes = Changes::default();
        for place in [900, 899, 890, 500, 10] {
            changes.add(place..place + 1);
        }
        changes.merge();
        assert_eq!(changes.ranges(), [10..11, 500..501, 890..901]);
        // What comes later joins what was there.
        changes.add(2000..2001);
        changes.add(40..550);
        changes.merge();
        assert_eq!(changes.ranges(), [10..550, 890..901, 2000..2001]);
        changes.set_all(7);
        changes.add(3..4);
        changes.merge();
        assert_eq!(changes.ranges(), std::slice::from_ref(&(0..7)));
        changes.clear();
        assert!(changes.ranges().is_empty());
    }
}
