//! What a walk of a wide tree does, event by event, with rays that get shorter in several ways.

use ropewalk::bvh::walk::{ClosestHit, Summary, TriangleVisitor, Visitor};
use ropewalk::wide_bvh::walk::WideWalk;
use ropewalk::{NoProbe, PreparedRay, WideBvh};
use ropewalk_testkit::recorder::{Events, Recorder};
use std::ops::ControlFlow;

/// How a ray gets shorter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Shorten {
    /// By the hits that it meets.
    Hits,
    /// By that, and to so much of its length at each leaf, whatever is in it: what a visitor may do that knows more than
    /// the tree. Then even boxes on the current path may come to lie behind its end.
    EachLeaf(f32),
}

/// Limits what a visitor is interested in.
struct Shortened<V> {
    visitor: V,
    limit: f32,
    shorten: Shorten,
}

impl<V: Visitor> Visitor for Shortened<V> {
    fn t_max(&self) -> f32 {
        self.limit.min(self.visitor.t_max())
    }

    fn inner_visit(&mut self, node: u32) {
        self.visitor.inner_visit(node);
    }

    fn stack_depth(&mut self, entries: usize) {
        self.visitor.stack_depth(entries);
    }

    fn restart(&mut self) {
        self.visitor.restart();
    }

    fn leaf(&mut self, first: u32, count: u32) -> ControlFlow<()> {
        self.visitor.leaf(first, count)?;
        if let Shorten::EachLeaf(factor) = self.shorten {
            self.limit *= factor;
        }
        ControlFlow::Continue(())
    }
}

/// The words of the closest hit, and what happened on the way to it.
pub(crate) fn record<W: WideWalk>(
    bvh: &WideBvh,
    walk: W,
    ray: &PreparedRay,
    shorten: Shorten,
) -> ([u32; 7], Events) {
    let far = bvh.bounds().size().length() * 3.0;
    let mut recorder = Recorder::new(Shortened {
        visitor: TriangleVisitor {
            triangles: bvh.triangles(),
            ray,
            collect: ClosestHit::new(ray),
            probe: NoProbe,
        },
        limit: if shorten == Shorten::Hits { f32::INFINITY } else { far },
        shorten,
    });
    bvh.lead(walk, ray, &mut recorder);
    let (Shortened { visitor, .. }, events) = recorder.finish();
    (visitor.collect.answer().to_words(), events)
}
