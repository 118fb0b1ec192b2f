//! A tree of rays for each sample (Whitted 1980): at each place that a ray finds, a ray to every light, one into the
//! mirror, and one through the glass, which find places in turn.
//!
//! [`node`] is the one piece of shading: from a place to its own light and the rays that leave it, in a fixed order. Three
//! orders of tracing share it:
//!
//! * [`recursive`], the plain reference: each ray is followed before the next one is looked at;
//! * [`stack`], listing 1 of Reichl et al. 2010: rays of all kinds come from one stack and are treated alike, and the
//!   most that the stack can hold is known beforehand. On a graphics device it is one kernel;
//! * [`wavefront`]: all rays of a generation at once, sorted, in batches that a device answers.
//!
//! **The same picture.** Light is added up depth first: a node's own light, then what its rays bring, one after the other.
//! The recursion does that by itself; the stack, since children are pushed in reverse; the wavefront remembers every
//! addend and adds them in that order at the end. So all give the same bits.
//!
//! **Panes.** Rays to lights go on behind clear surfaces that bend nothing, less what the glass keeps; a city under a roof of
//! glass would lie in the dark without. Glass that bends throws a shadow, since nobody knows where its light goes.
//!
//! **Limits.** A ray that would go deeper than asked, or that carries less than the smallest weight, is not followed, and is
//! counted. In place of one cut off by depth stand the surroundings, as if nothing were in its way.

mod batches;
mod node;
mod recursive;
mod request;
mod stack;
#[cfg(test)]
mod tests;
mod wavefront;

pub(crate) use node::{Kind, Sample, Tree, TreeRay};
pub(crate) use request::Request;

use crate::error::RenderError;
use crate::integrator::TreeOrder;
use crate::statistics::Incomplete;
use crate::tracing::Tracing;
use glam::Vec3;
use ropewalk::{Hit, Ray};

/// What following the trees of some samples took, and what was cut off.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Tally {
    pub(crate) shadow_rays: u64,
    pub(crate) sky_rays: u64,
    pub(crate) reflected_rays: u64,
    pub(crate) refracted_rays: u64,
    /// Rays of paths in a direction of many.
    pub(crate) scattered_rays: u64,
    /// Paths that chance ended.
    pub(crate) ended_by_chance: u64,
    /// Addends of paths that were cut down in brightness.
    pub(crate) clipped: u64,
    pub(crate) cut_by_depth: u64,
    pub(crate) cut_by_weight: u64,
    pub(crate) incomplete: Incomplete,
}

impl Tally {
    pub(crate) fn add(&mut self, other: &Self) {
        self.shadow_rays += other.shadow_rays;
        self.sky_rays += other.sky_rays;
        self.reflected_rays += other.reflected_rays;
        self.refracted_rays += other.refracted_rays;
        self.scattered_rays += other.scattered_rays;
        self.ended_by_chance += other.ended_by_chance;
        self.clipped += other.clipped;
        self.cut_by_depth += other.cut_by_depth;
        self.cut_by_weight += other.cut_by_weight;
        self.incomplete.add(&other.incomplete);
    }

    /// Counts a ray that is about to be traced.
    fn count(&mut self, kind: Kind) {
        match kind {
            Kind::Primary => {}
            Kind::Light => self.shadow_rays += 1,
            Kind::Sky => self.sky_rays += 1,
            Kind::Mirrored => self.reflected_rays += 1,
            Kind::Refracted => self.refracted_rays += 1,
        }
    }
}

/// A sample's light.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Followed {
    pub(crate) color: Vec3,
    /// Whether an answer was missing.
    pub(crate) is_broken: bool,
}

/// The first ray of a sample and what it found.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Root {
    pub(crate) sample: Sample,
    pub(crate) ray: Ray,
    pub(crate) hit: Hit,
}

/// Follows the trees of samples on the CPU, rays being traced by whatever `tracing` names. `Auto` is the wavefront.
pub(crate) fn follow(
    tree: &Tree<'_>,
    tracing: &Tracing<'_>,
    order: TreeOrder,
    roots: &[Root],
) -> Result<(Vec<Followed>, Tally), RenderError> {
    match order {
        TreeOrder::Recursive => recursive::follow(tree, tracing, roots),
        TreeOrder::Stack => stack::follow(tree, tracing, roots),
        TreeOrder::Auto | TreeOrder::Wavefront => wavefront::follow(tree, tracing, roots),
    }
}
