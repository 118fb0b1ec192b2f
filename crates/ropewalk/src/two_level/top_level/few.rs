//! Subtrees of few entries: most of the time of a build goes into them, and bins see too little of them.
//!
//! Up to [`MANY`] entries are sorted along each axis once, and every plane between two of them is weighed, as the sweep
//! builder does ([`crate::bvh::Builder::SweepSah`]). The three orders are lists of bytes, which stay in the cache; a table tells who
//! belongs to the lower child, and by it the lists of the other two axes are parted. Of three and four entries the best tree is
//! found by comparing all trees: that is less work than weighing planes.

use super::build::fits;
use crate::bvh::Node;
use crate::bvh::build::reference::{Extent, Reference};

/// The most entries that are sorted: what a byte counts. Measured with 10,000 entries, a hundredth of which are large: 64 take
/// 3.0 ms and cost 3.5 percent more than the sweep's tree, 128 take 2.6 and 2.5, 256 take 2.4 and 0.9.
pub(super) const MANY: usize = 1 << u8::BITS;

/// Room to work in.
pub(super) struct Few {
    /// The places of the references, sorted along each axis.
    order: [[u8; MANY]; 3],
    keys: [u64; MANY],
    /// What the boxes from a place on cost.
    upper: [f32; MANY],
    high: [u8; MANY],
    /// Of each place 1 where it belongs to the lower child, 0 where not.
    is_low: [u8; MANY],
}

impl Default for Few {
    fn default() -> Self {
        Self {
            order: [[0; MANY]; 3],
            keys: [0; MANY],
            upper: [0.0; MANY],
            high: [0; MANY],
            is_low: [0; MANY],
        }
    }
}

/// Where to part the list of an axis.
#[derive(Clone, Copy)]
struct Cut {
    cost: f32,
    axis: usize,
    middle: usize,
}

impl Few {
    /// Builds the subtree of at most [`MANY`] references.
    pub(super) fn build(&mut self, nodes: &mut [Node], base: usize, references: &[Reference], levels: u32) {
        let count = references.len().min(MANY);
        let references = &references[..count];
        for axis in 0..3 {
            let keys = &mut self.keys[..count];
            for (place, (key, reference)) in keys.iter_mut().zip(references).enumerate() {
                // Ties by place: the entry's index gives way to it.
                *key = reference.key(axis) >> 32 << 32 | place as u64;
            }
            keys.sort_unstable();
            for (place, key) in self.order[axis].iter_mut().zip(keys) {
                *place = *key as u8;
            }
        }
        self.subtree(nodes, base, references, 0..count, levels);
    }

    /// Builds the subtree of the references at `range` of the lists.
    fn subtree(
        &mut self,
        nodes: &mut [Node],
        base: usize,
        references: &[Reference],
        range: std::ops::Range<usize>,
        levels: u32,
    ) {
        let count = range.len();
        if count <= 4 {
            let mut members = [references[0]; 4];
            for (member, &place) in members.iter_mut().zip(&self.order[0][range]) {
                *member = references[usize::from(place)];
            }
            best_of_few(nodes, base, &members[..count], levels);
            return;
        }
        let (bounds, middle) = self.part(references, range.clone(), levels);
        let Some((this, below)) = nodes.split_first_mut() else { return };
        let (near, far) = below.split_at_mut(2 * middle - 1);
        let second = base + 2 * middle;
        *this = Node::inner(&bounds.bounds(), second as u32);
        let cut = range.start + middle;
        let levels = levels.saturating_sub(1);
        self.subtree(near, base + 1, references, range.start..cut, levels);
        self.subtree(far, second, references, cut..range.end, levels);
    }

    /// Parts the lists at the best plane; tells the box of all and how many are below.
    fn part(
        &mut self,
        references: &[Reference],
        range: std::ops::Range<usize>,
        levels: u32,
    ) -> (Extent, usize) {
        let count = range.len();
        // Where no plane fits under the depth cap, the list is halved along x.
        let mut best = Cut { cost: f32::INFINITY, axis: 0, middle: count / 2 };
        let mut bounds = Extent::EMPTY;
        for axis in 0..3 {
            let order = &self.order[axis][range.clone()];
            let upper = &mut self.upper[..count];
            let mut extent = Extent::EMPTY;
            for (above, (&place, cost)) in order.iter().zip(upper.iter_mut()).rev().enumerate() {
                extent.add(&references[usize::from(place)]);
                *cost = extent.half_area() * (above + 1) as f32;
            }
            bounds = extent;
            let mut extent = Extent::EMPTY;
            for (below, (&place, &upper)) in order.iter().zip(&upper[1..]).enumerate() {
                extent.add(&references[usize::from(place)]);
                let middle = below + 1;
                let cost = extent.half_area() * middle as f32 + upper;
                let is_better = cost < best.cost
                    || cost == best.cost
                        && middle.abs_diff(count - middle) < best.middle.abs_diff(count - best.middle);
                if is_better && fits([middle, count - middle], levels) {
                    best = Cut { cost, axis, middle };
                }
            }
        }
        self.divide(best, range);
        (bounds, best.middle)
    }

    /// Puts the lower ones of a cut first in the lists of the other axes as well. All keep their order.
    fn divide(&mut self, cut: Cut, range: std::ops::Range<usize>) {
        let (lower, upper) = self.order[cut.axis][range.clone()].split_at(cut.middle);
        lower.iter().for_each(|&place| self.is_low[usize::from(place)] = 1);
        upper.iter().for_each(|&place| self.is_low[usize::from(place)] = 0);
        for (_, order) in self.order.iter_mut().enumerate().filter(|&(axis, _)| axis != cut.axis) {
            let list = &mut order[range.clone()];
            let (mut low, mut high) = (0, 0);
            // Without a branch: each is written to both, and one of the two moves on.
            for index in 0..list.len() {
                let place = list[index];
                let is_low = usize::from(self.is_low[usize::from(place)]);
                list[low] = place;
                self.high[high] = place;
                low += is_low;
                high += 1 - is_low;
            }
            list[low..].copy_from_slice(&self.high[..high]);
        }
    }
}

/// The best tree over one to four entries. What lies lower along x comes first.
fn best_of_few(nodes: &mut [Node], base: usize, members: &[Reference], levels: u32) {
    match *members {
        [a] => put(nodes, 0, leaf(&a)),
        [a, b] => pair(nodes, base, [&a, &b]),
        [a, b, c] => triple(nodes, base, [&a, &b, &c]),
        [a, b, c, d] => quadruple(nodes, base, [&a, &b, &c, &d], levels),
        _ => {}
    }
}

fn put(nodes: &mut [Node], place: usize, node: Node) {
    if let Some(slot) = nodes.get_mut(place) {
        *slot = node;
    }
}

fn extent(reference: &Reference) -> Extent {
    Extent::of(std::slice::from_ref(reference))
}

fn leaf(reference: &Reference) -> Node {
    Node::leaf(&extent(reference).bounds(), reference.index() as u32, 1)
}

fn pair(nodes: &mut [Node], base: usize, [a, b]: [&Reference; 2]) {
    put(nodes, 0, Node::inner(&extent(a).union(extent(b)).bounds(), base as u32 + 2));
    put(nodes, 1, leaf(a));
    put(nodes, 2, leaf(b));
}

/// Two of the three go together: those whose common box is the smallest.
fn triple(nodes: &mut [Node], base: usize, [a, b, c]: [&Reference; 3]) {
    let [of_a, of_b, of_c] = [a, b, c].map(extent);
    let ab = of_a.union(of_b);
    let areas = [ab, of_a.union(of_c), of_b.union(of_c)].map(|extent| extent.half_area());
    let bounds = ab.union(of_c).bounds();
    if areas[2] < areas[0] && areas[2] < areas[1] {
        put(nodes, 0, Node::inner(&bounds, base as u32 + 2));
        put(nodes, 1, leaf(a));
        pair(nodes.get_mut(2..).unwrap_or_default(), base + 2, [b, c]);
    } else {
        let (second, last) = if areas[1] < areas[0] { (c, b) } else { (b, c) };
        put(nodes, 0, Node::inner(&bounds, base as u32 + 4));
        pair(nodes.get_mut(1..).unwrap_or_default(), base + 1, [a, second]);
        put(nodes, 4, leaf(last));
    }
}

/// The ways to put four into two pairs; each also names the two pairs' places in the table of areas of [`quadruple`].
const PAIRS: [[usize; 4]; 3] = [[0, 1, 2, 3], [0, 2, 1, 3], [0, 3, 1, 2]];

/// Two pairs, or one and a triple, whichever has the smallest boxes below the root.
fn quadruple(nodes: &mut [Node], base: usize, members: [&Reference; 4], levels: u32) {
    let of = members.map(extent);
    // Areas of the three ways' first and second pairs.
    let pairs = PAIRS.map(|[a, b, c, d]| [of[a].union(of[b]), of[c].union(of[d])]);
    let areas = pairs.map(|both| both.map(|extent| extent.half_area()));
    let (mut best, mut cost) = (0, areas[0][0] + areas[0][1]);
    for (way, [first, second]) in areas.iter().enumerate().skip(1) {
        if first + second < cost {
            (best, cost) = (way, first + second);
        }
    }
    let bounds = pairs[0][0].union(pairs[0][1]).bounds();
    let mut alone = None;
    if levels > 2 {
        for out in 0..4 {
            // Of each way one pair is without `out`: three pairs, any two of which make the triple.
            let without = [0, 1, 2].map(|way| usize::from(PAIRS[way][..2].contains(&out)));
            let triple = pairs[0][without[0]].union(pairs[1][without[1]]).half_area();
            let smallest = (0..3).map(|way| areas[way][without[way]]).fold(f32::INFINITY, f32::min);
            if triple + smallest < cost {
                (alone, cost) = (Some(out), triple + smallest);
            }
        }
    }
    let second = base
        + if alone == Some(0) {
            2
        } else if alone.is_some() {
            6
        } else {
            4
        };
    put(nodes, 0, Node::inner(&bounds, second as u32));
    let below = nodes.get_mut(1..).unwrap_or_default();
    let [a, b, c, d] = members;
    match alone {
        Some(0) => {
            put(below, 0, leaf(a));
            triple(below.get_mut(1..).unwrap_or_default(), base + 2, [b, c, d]);
        }
        Some(out) => {
            let [three, last] = match out {
                1 => [[a, c, d], [b; 3]],
                2 => [[a, b, d], [c; 3]],
                _ => [[a, b, c], [d; 3]],
            };
            triple(below, base + 1, three);
            put(below, 5, leaf(last[0]));
        }
        None => {
            let [i, j, k, l] = PAIRS[best].map(|place| members[place]);
            pair(below, base + 1, [i, j]);
            pair(below.get_mut(3..).unwrap_or_default(), base + 4, [k, l]);
        }
    }
}
