//! What a walk does, event by event: equal answers alone would not show a walk that goes astray.

use ropewalk::bvh::walk::Visitor;
use std::collections::HashSet;
use std::ops::ControlFlow;

/// What a walk does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Event {
    /// The boxes of this node's children are tested.
    Inner(u32),
    /// The leaf whose first primitive this is is entered.
    Leaf(u32),
    /// The stack holds so many entries after a push.
    Depth(usize),
    /// The walk goes back to the root.
    Restart,
}

/// Writes down what a walk shows to another visitor, and ends a walk that does not end by itself.
#[derive(Debug)]
pub struct Recorder<V> {
    visitor: V,
    events: Vec<Event>,
}

impl<V> Recorder<V> {
    /// More events than any walk of the tests has.
    pub const ENOUGH: usize = 200_000;

    /// Nothing has happened yet.
    pub const fn new(visitor: V) -> Self {
        Self { visitor, events: Vec::new() }
    }

    /// The visitor, and what happened.
    pub fn finish(self) -> (V, Events) {
        (self.visitor, Events(self.events))
    }
}

impl<V: Visitor> Visitor for Recorder<V> {
    /// When there have been enough, nothing is of interest any more: what a walk that does not end comes to know at its
    /// next restart.
    fn t_max(&self) -> f32 {
        if self.events.len() > Self::ENOUGH { f32::NEG_INFINITY } else { self.visitor.t_max() }
    }

    fn inner_visit(&mut self, node: u32) {
        self.events.push(Event::Inner(node));
        self.visitor.inner_visit(node);
    }

    fn stack_depth(&mut self, entries: usize) {
        self.events.push(Event::Depth(entries));
        self.visitor.stack_depth(entries);
    }

    fn restart(&mut self) {
        self.events.push(Event::Restart);
        self.visitor.restart();
    }

    fn leaf(&mut self, first: u32, count: u32) -> ControlFlow<()> {
        self.events.push(Event::Leaf(first));
        self.visitor.leaf(first, count)?;
        if self.events.len() > Self::ENOUGH { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

/// What happened, in its order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Events(pub Vec<Event>);

impl Events {
    /// Whether the walk came to its end by itself.
    #[must_use]
    pub fn ends(&self) -> bool {
        self.0.len() <= Recorder::<()>::ENOUGH
    }

    /// How often nodes were visited.
    #[must_use]
    pub fn inner_visits(&self) -> usize {
        self.0.iter().filter(|event| matches!(event, Event::Inner(_))).count()
    }

    /// How often the walk went back to the root.
    #[must_use]
    pub fn restarts(&self) -> usize {
        self.0.iter().filter(|&&event| event == Event::Restart).count()
    }

    /// The first primitives of the leaves, in the order in which they were entered.
    #[must_use]
    pub fn leaves(&self) -> Vec<u32> {
        let leaf = |event: &Event| if let Event::Leaf(first) = event { Some(*first) } else { None };
        self.0.iter().filter_map(leaf).collect()
    }

    /// Nodes and leaves, each node at its first visit only.
    #[must_use]
    pub fn first_visits(&self) -> Vec<Event> {
        let mut seen = HashSet::new();
        let is_new = |event: &&Event| match event {
            Event::Inner(node) => seen.insert(*node),
            Event::Leaf(_) => true,
            Event::Depth(_) | Event::Restart => false,
        };
        self.0.iter().filter(is_new).copied().collect()
    }

    /// Whether a leaf was entered more than once.
    #[must_use]
    pub fn enters_a_leaf_twice(&self) -> bool {
        let mut seen = HashSet::new();
        self.leaves().into_iter().any(|leaf| !seen.insert(leaf))
    }

    /// All that is wrong with a walk with a short stack, whose answer and events these are, when `full` is what the full
    /// stack did. Where the short stack `keeps_all` or there is no restart, every event must be the full stack's.
    #[must_use]
    pub fn faults<A: PartialEq>(full: &(A, Self), given: &(A, Self), keeps_all: bool) -> Vec<Fault> {
        let ((full_answer, full), (answer, given)) = (full, given);
        let mut faults = Vec::new();
        let mut note = |fault, is_there| {
            if is_there {
                faults.push(fault);
            }
        };
        note(Fault::DoesNotEnd, !given.ends());
        note(Fault::AnotherAnswer, answer != full_answer);
        note(Fault::LeafTwice, given.enters_a_leaf_twice());
        let same_order = given.leaves() == full.leaves() && given.first_visits() == full.first_visits();
        note(Fault::AnotherOrder, !same_order);
        note(Fault::NotTheFullStack, (keeps_all || given.restarts() == 0) && given != full);
        faults
    }
}

/// What may be wrong with a walk.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Fault {
    /// It does not end.
    DoesNotEnd,
    /// It answers otherwise.
    AnotherAnswer,
    /// It enters a leaf twice.
    LeafTwice,
    /// It enters other leaves or nodes, or in another order.
    AnotherOrder,
    /// With a stack that keeps all, or without any restart, it does anything but what the full stack does.
    NotTheFullStack,
}
