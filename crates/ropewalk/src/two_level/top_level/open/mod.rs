//! Opening: large objects stand in the top level with their parts, before it is built.
//!
//! An object that is as large as the scene makes every ray enter it, and is entered before what stands in its box. Its own
//! structure knows smaller boxes: those of the children of its root, of their children, and so on. An entry that is opened gives
//! way to two such boxes. A ray that meets both enters the object twice, so opening must pay.
//!
//! **By cost** ([`rebraid`], after the partial re-braiding of Benthin, Woop, Wald, Áfra 2017). What a random ray spends on entering
//! an entry goes by the entry's area, so opening is worth what the area of the parts is less than that of the whole. Each part
//! counts with the best of what opening it would give, two levels down: the halves of a lamp are larger than it is, its foot and
//! its pole are not. The nodes of the top level cost no more than before: that of the two parts takes the place of the one that was
//! opened. Where other things lie in an entry's box the order comes into it, in which rays meet things: with the parts they may
//! find a hit before they come to them. There opening is worth up to [`ORDER`] of the area more. What is worth most is
//! opened first, as long as there is room. The paper decides by the reach of an entry in the node of the top level in which it
//! is, while that is built, and opens whatever reaches over a tenth of it; here the top level is built from scratch over what is found.
//!
//! Measured with random rays, each scene with some hundred objects of 480 triangles, BVHs below: nodes and triangles a ray, where
//! entering an object counts for 10 of them. The budget was half the number of entries. By
//! areas alone nothing would be opened in any of them.
//!
//! | scene | closed | by cost | the large one blindly: 8, 32, 128 parts |
//! |---|---|---|---|
//! | a room with balls in it | 59.6 | 52.9 | 61.6, 55.2, 51.7 |
//! | hills with balls on them | 25.2 | 21.8 | 24.2, 22.7, 21.8 |
//! | needles through each other, askew | 352.4 | 352.4: none is opened | |
//! | balls that overlap | 120.2 | 120.2: none is opened | |
//!
//! **Blindly** ([`subdivide`], Reichl et al. 2010, section 5.3): into so many parts each, whether that helps or not.
//!
//! Costs a build of a top level, and per entry one search in it and up to seven openings.

#[cfg(test)]
mod tests;

use super::build::is_usable;
use super::{MAX_DEPTH, TopLevel};
use crate::Aabb;
use crate::bvh::Node;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// The part of its area that opening an entry is worth more where its box is crowded: see the table above. 0.5 also opens
/// balls that overlap at random, which costs 5 percent there, 0.25 without regard to the crowd leaves the room closed.
const ORDER: f32 = 0.3;
/// Other instances in a box that make it crowded; fewer make it less so.
const CROWD: usize = 16;
/// Levels below the parts of an entry that are looked at.
const LOOK_AHEAD: u32 = 2;

/// A part of an instance as the top level sees it: a node of its bottom structure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OpenEntry {
    /// The instance.
    pub instance: u32,
    /// The node of its structure; what the numbers mean is the opener's business.
    pub node: u32,
    /// The box in the scene.
    pub bounds: Aabb,
}

/// Knows the structures below the entries.
pub trait Openable {
    /// The two entries that an entry consists of, or `None` where it cannot be opened. Together they must contain what the entry
    /// contains.
    fn open(&self, entry: &OpenEntry) -> Option<[OpenEntry; 2]>;
}

/// Opens one, where its parts have boxes that can be built over.
fn open(openable: &dyn Openable, entry: &OpenEntry) -> Option<[OpenEntry; 2]> {
    openable.open(entry).filter(|parts| parts.iter().all(|part| is_usable(&part.bounds)))
}

/// Opens entries where that is expected to save time; the most worthwhile first. `budget` is the most entries that may be added.
#[must_use]
pub fn rebraid(entries: Vec<OpenEntry>, budget: usize, openable: &dyn Openable) -> Vec<OpenEntry> {
    let usable: Vec<OpenEntry> = entries.iter().filter(|entry| is_usable(&entry.bounds)).copied().collect();
    let boxes: Vec<Aabb> = usable.iter().map(|entry| entry.bounds).collect();
    // The only way to fail is to have more entries than can be addressed: then there should not be more of them.
    let Ok(top) = TopLevel::build(&boxes) else { return entries };
    let neighbours = Neighbours { entries: &usable, nodes: top.nodes() };
    let worth = |entry: &OpenEntry| worth(entry, openable, &neighbours);
    let mut output = entries;
    let rate = |(place, entry): (usize, &OpenEntry)| worth(entry).map(|worth| (worth, Reverse(place)));
    let mut queue: BinaryHeap<(u32, Reverse<usize>)> = output.iter().enumerate().filter_map(rate).collect();
    let mut added = 0;
    while added < budget
        && let Some((_, Reverse(place))) = queue.pop()
    {
        let Some(parts) = output.get(place).and_then(|entry| open(openable, entry)) else { continue };
        for (place, part) in [place, output.len()].into_iter().zip(parts) {
            queue.extend(worth(&part).map(|worth| (worth, Reverse(place))));
            match output.get_mut(place) {
                Some(opened) => *opened = part,
                None => output.push(part),
            }
        }
        added += 1;
    }
    output
}

/// What opening an entry is worth, as a number with an order; `None` where it is worth nothing.
fn worth(entry: &OpenEntry, openable: &dyn Openable, neighbours: &Neighbours<'_>) -> Option<u32> {
    if !is_usable(&entry.bounds) {
        return None;
    }
    let parts = open(openable, entry)?;
    let area = entry.bounds.half_area();
    let of_parts: f32 = parts.iter().map(|part| least_area(part, openable, LOOK_AHEAD)).sum();
    let mut worth = area - of_parts;
    // What is near is asked only where the answer matters.
    if worth + ORDER * area > 0.0 {
        worth += ORDER * area * neighbours.count_in(entry) as f32 / CROWD as f32;
    }
    // The bits of positive numbers have their order.
    (worth > 0.0).then_some(worth.to_bits())
}

/// The area of an entry, or of the parts that it can be opened into within some levels, where that is less.
fn least_area(entry: &OpenEntry, openable: &dyn Openable, levels: u32) -> f32 {
    let area = entry.bounds.half_area();
    if levels == 0 {
        return area;
    }
    let of_parts = open(openable, entry)
        .map(|parts| parts.iter().map(|part| least_area(part, openable, levels - 1)).sum::<f32>());
    of_parts.map_or(area, |of_parts| area.min(of_parts))
}

/// The entries before any was opened, and a tree over them.
struct Neighbours<'a> {
    entries: &'a [OpenEntry],
    nodes: &'a [Node],
}

impl Neighbours<'_> {
    /// How many boxes of other instances meet the inside of an entry's box, up to a crowd.
    fn count_in(&self, entry: &OpenEntry) -> usize {
        let mut count = 0;
        let mut pending = [0; MAX_DEPTH as usize + 1];
        let mut waiting = usize::from(!self.nodes.is_empty());
        while let Some(last) = waiting.checked_sub(1) {
            waiting = last;
            let index = pending[last];
            let Some(node) = self.nodes.get(index) else { continue };
            let bounds = node.bounds();
            let meets = bounds.min.cmplt(entry.bounds.max).all() && entry.bounds.min.cmplt(bounds.max).all();
            if !meets {
                continue;
            }
            if node.is_leaf() {
                let other = self.entries.get(node.link as usize);
                count += usize::from(other.is_some_and(|other| other.instance != entry.instance));
                if count == CROWD {
                    break;
                }
                continue;
            }
            for child in [node.link as usize, index + 1] {
                if let Some(place) = pending.get_mut(waiting) {
                    *place = child;
                    waiting += 1;
                }
            }
        }
        count
    }
}

/// Opens every entry into `parts` parts, or as many as it has: always the largest part next.
#[must_use]
pub fn subdivide(entries: Vec<OpenEntry>, parts: usize, openable: &dyn Openable) -> Vec<OpenEntry> {
    let mut output = Vec::with_capacity(entries.len());
    for entry in entries {
        let end = output.len().saturating_add(parts);
        let mut largest = BinaryHeap::from([(rank(&entry), Reverse(output.len()))]);
        output.push(entry);
        while output.len() < end
            && let Some((_, Reverse(place))) = largest.pop()
        {
            let Some([first, second]) = open(openable, &output[place]) else { continue };
            largest.push((rank(&first), Reverse(place)));
            largest.push((rank(&second), Reverse(output.len())));
            output[place] = first;
            output.push(second);
        }
    }
    output
}

/// The area as a number with an order.
fn rank(entry: &OpenEntry) -> u32 {
    // Areas are not negative, so their bits have their order.
    entry.bounds.half_area().to_bits()
}
