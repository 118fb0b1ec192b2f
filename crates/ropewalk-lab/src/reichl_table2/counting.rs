//! What the walks of a picture do: a structure that counts all that it is asked.

use ropewalk::{CounterTotals, Keep, Query, Ray, Structure, TraceOptions, Traced, Walk};
use ropewalk_render::{Begin, Trace};
use std::error::Error;
use std::sync::{Mutex, PoisonError};

/// A structure on the CPU that adds up what its walks do.
pub(super) struct Counting<'a> {
    structure: &'a Structure,
    totals: Mutex<CounterTotals>,
}

impl<'a> Counting<'a> {
    pub(super) fn new(structure: &'a Structure) -> Self {
        Self { structure, totals: Mutex::default() }
    }

    /// What was done since this was asked last.
    pub(super) fn take(&self) -> CounterTotals {
        std::mem::take(&mut *self.totals.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Adds up what a batch did, and gives it back as it was asked for.
    fn count(&self, mut traced: Traced, asked: TraceOptions) -> Traced {
        let mut totals = self.totals.lock().unwrap_or_else(PoisonError::into_inner);
        traced.counters.iter().flatten().for_each(|counters| *totals += counters);
        traced.counters = traced.counters.filter(|_| asked.counters);
        traced
    }
}

impl Trace for Counting<'_> {
    fn trace_batch(
        &self,
        walk: Walk,
        query: Query,
        rays: &[Ray],
        options: TraceOptions,
    ) -> Result<Traced, Box<dyn Error + Send + Sync>> {
        let traced = self.structure.trace(walk, query, rays, TraceOptions { counters: true })?;
        Ok(self.count(traced, options))
    }

    fn trace_filtered(
        &self,
        walk: Walk,
        query: Query,
        rays: &[Ray],
        _begin: &Begin<'_>,
        keep: Keep<'_>,
        options: TraceOptions,
    ) -> Result<Traced, Box<dyn Error + Send + Sync>> {
        let counted = TraceOptions { counters: true };
        let traced = self.structure.trace_filtered(walk, query, rays, counted, keep)?;
        Ok(self.count(traced, options))
    }

    fn structure(&self) -> Option<&Structure> {
        Some(self.structure)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use ropewalk::{Mesh, NoMonitor, Scene, StructureSpec};

    #[test]
    fn what_is_asked_is_counted_once() {
        let mesh = Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]);
        let structure = StructureSpec::default().build(&Scene::from_mesh(mesh), &NoMonitor).unwrap();
        let counting = Counting::new(&structure);
        let rays = [Ray::new(Vec3::new(0.2, 0.2, 1.0), Vec3::NEG_Z); 3];
        let (walk, plain) = (Walk::default(), TraceOptions::default());
        let traced = counting.trace_batch(walk, Query::Closest, &rays, plain).unwrap();
        assert!(traced.counters.is_none() && traced.answer.rays_that_hit() == 3);
        counting.trace_batch(walk, Query::Any, &rays[..1], plain).unwrap();
        let totals = counting.take();
        assert_eq!((totals.rays, totals.primitive_tests), (4, 4));
        assert_eq!(counting.take(), CounterTotals::default());
    }
}
