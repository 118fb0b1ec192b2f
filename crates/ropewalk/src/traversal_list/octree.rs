//! The hierarchy of Toczek 2010, section 2.2: a node's triangles in eight groups about the centre of their box, and those
//! that are big beside the node as children of the node itself.
//!
//! **What the paper leaves open** (ALGORITHMS: C4): how big is big ([`super::ListOptions::big`]); the group of a barycentre
//! that lies exactly on a middle plane (the upper one); and what ends it when all triangles fall into one group, which would
//! go on for ever. Then up to [`FEW`] triangles become leaves, and more are halved by their barycentres along the longest
//! axis; so is everything below [`DEEPEST_OCTREE`]. A group of one triangle is the triangle itself.
//!
//! Side by side where there are threads; the same tree for any number of them.

use super::hierarchy::{Child, Group};
use super::{ListOptions, Reach};
use crate::parallel::join;
use crate::progress::Progress;
use crate::{Aabb, FlatTriangle};
use glam::Vec3;

/// Triangles in one group that are not divided any further.
const FEW: usize = 4;
/// From here on groups are halved, so that no input makes a tree of more than 32 levels more.
const DEEPEST_OCTREE: u32 = 64;
/// Fewer triangles than this are not worth a thread of their own.
const WORTH_A_THREAD: usize = 2048;

/// A triangle on its way down.
#[derive(Clone, Copy)]
struct Item {
    index: u32,
    bounds: Aabb,
    barycenter: Vec3,
    /// Of the sphere about the middle of its box.
    radius: f32,
}

/// Builds the hierarchy; `None` where there are no triangles. Where the monitor cancels, what comes is not whole.
pub(super) fn build(
    triangles: &[FlatTriangle],
    options: &ListOptions,
    progress: &Progress<'_>,
) -> Option<Child> {
    let item = |(index, triangle): (usize, &FlatTriangle)| {
        let bounds = triangle.triangle().bounds();
        let [a, b, c] = triangle.triangle().vertices;
        let radius = [a, b, c].map(|vertex| vertex.distance(bounds.center())).into_iter().fold(0.0, f32::max);
        Item { index: index as u32, bounds, barycenter: (a + b + c) / 3.0, radius }
    };
    let mut items: Vec<Item> = triangles.iter().enumerate().map(item).collect();
    let division = Division { triangles, big: options.big as f32 / 100.0, reach: options.reach, progress };
    (!items.is_empty()).then(|| division.divide(&mut items, 0))
}

/// What holds for the whole division.
struct Division<'a> {
    triangles: &'a [FlatTriangle],
    /// The share of its node's radius from which on a triangle is big.
    big: f32,
    reach: Reach,
    progress: &'a Progress<'a>,
}

impl Division<'_> {
    fn divide(&self, items: &mut [Item], depth: u32) -> Child {
        if let [only] = items {
            self.progress.add(1);
            return Child::Triangle(only.index);
        }
        let bounds = items.iter().map(|item| item.bounds).fold(Aabb::EMPTY, Aabb::union);
        let vertices = items.iter().flat_map(|item| self.triangles[item.index as usize].triangle().vertices);
        let boxes = items.iter().map(|item| item.bounds);
        let sphere = self.reach.sphere(bounds.center(), boxes, vertices);
        let big_ones = partition(items, |item| item.radius >= self.big * sphere.radius);
        let (large, small) = items.split_at_mut(big_ones);
        self.progress.add(large.len());
        let mut children: Vec<Child> = large.iter().map(|item| Child::Triangle(item.index)).collect();
        // A cancelled build comes home with what it has.
        if !self.progress.is_cancelled() {
            let groups = groups(small, bounds.center(), depth);
            children.extend(each(groups, &|group| self.divide(group, depth + 1)));
        }
        Child::Group(Box::new(Group { number: 0, bounds, sphere, children }))
    }
}

/// Moves those for which it holds to the front, all in their order; how many they are.
fn partition(items: &mut [Item], holds: impl Fn(&Item) -> bool) -> usize {
    items.sort_by_key(|item| !holds(item));
    items.partition_point(holds)
}

/// The parts into which the triangles are divided, none empty and none all of them unless there is one.
fn groups(items: &mut [Item], center: Vec3, depth: u32) -> Vec<&mut [Item]> {
    if items.len() <= 1 {
        return if items.is_empty() { Vec::new() } else { vec![items] };
    }
    let group = |item: &Item| item.barycenter.cmpge(center).bitmask();
    let is_one = items.iter().all(|item| group(item) == group(&items[0]));
    if depth >= DEEPEST_OCTREE || is_one {
        return fall_back(items);
    }
    items.sort_by_key(group);
    items.chunk_by_mut(|a, b| group(a) == group(b)).collect()
}

/// One by one where they are few, else halves.
fn fall_back(items: &mut [Item]) -> Vec<&mut [Item]> {
    if items.len() <= FEW {
        return items.chunks_mut(1).collect();
    }
    let spread =
        items.iter().fold(Aabb::EMPTY, |bounds, item| bounds.union(Aabb::of_points([item.barycenter])));
    let size = spread.size();
    let axis = if size.x >= size.y && size.x >= size.z {
        0
    } else if size.y >= size.z {
        1
    } else {
        2
    };
    items.sort_by(|a, b| a.barycenter[axis].total_cmp(&b.barycenter[axis]).then(a.index.cmp(&b.index)));
    let (low, high) = items.split_at_mut(items.len() / 2);
    vec![low, high]
}

/// What `make` makes of each group, in their order.
fn each(mut groups: Vec<&mut [Item]>, make: &(impl Fn(&mut [Item]) -> Child + Sync)) -> Vec<Child> {
    if groups.len() <= 1 || groups.iter().map(|group| group.len()).sum::<usize>() < WORTH_A_THREAD {
        return groups.into_iter().map(make).collect();
    }
    let behind = groups.split_off(groups.len() / 2);
    let (mut first, second) = join(|| each(groups, make), || each(behind, make));
    first.extend(second);
    first
}
