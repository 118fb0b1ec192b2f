//! A visitor that writes down what a walk does.

use ropewalk::bvh::walk::{ClosestHit, Collect, Summary, Visitor};
use ropewalk::wide_bvh::walk::WideWalk;
use ropewalk::{FlatTriangle, Hit, PreparedRay, WideBvh};
use std::ops::ControlFlow;

/// What a walk does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Event {
    Inner(u32),
    Leaf(u32),
    /// The stack after a push.
    Depth(usize),
    Restart,
}

/// How a ray gets shorter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Shorten {
    /// By the hits that it meets.
    Hits,
    /// By that, and to so much of its length at each leaf, whatever is in it: what a visitor may do that knows more than
    /// the tree. Then even boxes on the current path may come to lie behind its end.
    EachLeaf(f32),
}

/// Records events, tests triangles, and stops a walk that does not end.
struct Recorder<'a> {
    triangles: &'a [FlatTriangle],
    ray: &'a PreparedRay,
    closest: ClosestHit,
    limit: f32,
    shorten: Shorten,
    events: Vec<Event>,
}

/// More than any walk of these tests takes.
const ENOUGH: usize = 20_000;

impl Visitor for Recorder<'_> {
    fn t_max(&self) -> f32 {
        // A ray that ends before it begins hits no box: what a walk that does not end comes to at its next restart.
        if self.events.len() > ENOUGH { f32::NEG_INFINITY } else { self.limit.min(self.closest.t_max()) }
    }

    fn inner_visit(&mut self, node: u32) {
        self.events.push(Event::Inner(node));
    }

    fn stack_depth(&mut self, entries: usize) {
        self.events.push(Event::Depth(entries));
    }

    fn restart(&mut self) {
        self.events.push(Event::Restart);
    }

    fn leaf(&mut self, first: u32, count: u32) -> ControlFlow<()> {
        self.events.push(Event::Leaf(first));
        for triangle in &self.triangles[first as usize..][..count as usize] {
            if let Some(hit) = triangle.intersect(self.ray, self.closest.t_max()) {
                self.closest.offer(hit)?;
            }
        }
        if let Shorten::EachLeaf(factor) = self.shorten {
            self.limit *= factor;
        }
        if self.events.len() > ENOUGH { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

/// What a walk did, and what it found.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Record {
    pub(crate) hit: Hit,
    pub(crate) events: Vec<Event>,
}

impl Record {
    pub(crate) fn of<W: WideWalk>(bvh: &WideBvh, walk: W, ray: &PreparedRay, shorten: Shorten) -> Self {
        let far = bvh.bounds().size().length() * 3.0;
        let mut recorder = Recorder {
            triangles: bvh.triangles(),
            ray,
            closest: ClosestHit::new(ray),
            limit: if shorten == Shorten::Hits { f32::INFINITY } else { far },
            shorten,
            events: Vec::new(),
        };
        bvh.lead(walk, ray, &mut recorder);
        Self { hit: recorder.closest.answer(), events: recorder.events }
    }

    pub(crate) fn ends(&self) -> bool {
        self.events.len() <= ENOUGH
    }

    pub(crate) fn inner_visits(&self) -> usize {
        self.events.iter().filter(|event| matches!(event, Event::Inner(_))).count()
    }

    pub(crate) fn restarts(&self) -> usize {
        self.events.iter().filter(|&&event| event == Event::Restart).count()
    }

    /// The leaves, in the order in which they were entered.
    pub(crate) fn leaves(&self) -> Vec<u32> {
        let leaf = |event: &Event| if let Event::Leaf(first) = event { Some(*first) } else { None };
        self.events.iter().filter_map(leaf).collect()
    }

    /// The nodes and leaves, each inner node at its first visit only.
    pub(crate) fn first_visits(&self) -> Vec<Event> {
        let mut seen = std::collections::HashSet::new();
        let is_new = |event: &&Event| match event {
            Event::Inner(node) => seen.insert(*node),
            Event::Leaf(_) => true,
            Event::Depth(_) | Event::Restart => false,
        };
        self.events.iter().filter(is_new).copied().collect()
    }

    pub(crate) fn enters_a_leaf_twice(&self) -> bool {
        let mut leaves = self.leaves();
        leaves.sort_unstable();
        leaves.windows(2).any(|pair| pair[0] == pair[1])
    }
}
