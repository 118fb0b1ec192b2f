//! One ray or many through lists.

use super::{Starts, TraversalList};
use crate::batch::{Batch, Question, TraceOptions, Traced, Traversal, answer_each, trace_entries};
use crate::bvh::walk::{AnyHit, ClosestHit, Collect};
use crate::{CatalogueError, Hit, NoProbe, PreparedRay, Probe, Query, Ray, TraceError, Walk};

trace_entries!(TraversalList, List);

impl TraversalList {
    /// The closest hit of a ray; [`Hit::MISS`] where there is none or the ray is not valid.
    #[must_use]
    pub fn closest(&self, ray: &Ray) -> Hit {
        Listed(self).summary::<ClosestHit, NoProbe>(ray).0
    }

    /// Whether a ray hits anything in its window; false where the ray is not valid.
    #[must_use]
    pub fn any(&self, ray: &Ray) -> bool {
        Listed(self).summary::<AnyHit, NoProbe>(ray).0
    }

    /// How many hits a ray has in its window; 0 where the ray is not valid.
    #[must_use]
    pub fn count(&self, ray: &Ray) -> u32 {
        Listed(self).count(ray)
    }

    /// Replaces `hits` by every hit of a ray in its window, sorted by `t`, ties by id. None is left out: there
    /// is no most.
    pub fn all(&self, ray: &Ray, hits: &mut Vec<Hit>) {
        hits.clear();
        Listed(self).append_all(ray, hits, NoProbe);
    }

    /// The closest hits of many rays, into `hits`. Only the first `min(rays.len(), hits.len())` are traced.
    pub fn closest_batch(&self, rays: &[Ray], hits: &mut [Hit]) {
        answer_each(rays, hits, |ray| self.closest(ray));
    }

    /// Whether each of many rays hits anything, into `hits`. Only the first `min(rays.len(), hits.len())` are traced.
    pub fn any_batch(&self, rays: &[Ray], hits: &mut [bool]) {
        answer_each(rays, hits, |ray| self.any(ray));
    }

    fn trace_batch(&self, walk: Walk, batch: Batch<'_>) -> Result<Traced, TraceError> {
        match walk {
            Walk::List => Ok(Listed(self).trace(batch)),
            Walk::BruteForce => Ok(Unordered(self).trace(batch)),
            // The catalogue has refused them.
            _ => Err(CatalogueError(format!("the walk '{walk}' goes through trees only")).into()),
        }
    }

    /// Traces a batch by the walk of lists, each ray from its heads on.
    ///
    /// ```
    /// use ropewalk::traversal_list::{Heads, ListOptions, Starts};
    /// use ropewalk::{Mesh, Query, Ray, Scene, TraceOptions, glam::Vec3};
    /// let mesh = Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]);
    /// let options = ListOptions { heads: Heads::Regular, ..ListOptions::default() };
    /// let list = Scene::from_mesh(mesh).build_list(&options)?;
    /// // A ray that leaves the triangle 0.
    /// let rays = [Ray::new(Vec3::new(0.2, 0.2, 0.0), Vec3::Z).window(1e-3, 9.0)];
    /// let rows = list.polygon_starts(&rays, &[0]);
    /// if let Some(table) = list.polygon_heads() {
    ///     let starts = Starts { table, rows: &rows };
    ///     let traced = list.trace_from(Query::Any, &rays, starts, TraceOptions { counters: true })?;
    ///     assert_eq!(traced.answer.rays_that_hit(), 0);
    /// }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// When the heads are of other lists, or there is not a row for each ray.
    pub fn trace_from(
        &self,
        query: Query,
        rays: &[Ray],
        starts: Starts<'_>,
        options: TraceOptions,
    ) -> Result<Traced, TraceError> {
        self.check_starts(rays, starts)?;
        let started = |(index, ray)| Started { ray, heads: starts.of(index) };
        let questions: Vec<Started<'_>> = rays.iter().enumerate().map(started).collect();
        Ok(ListedFrom(self).trace(Batch { query, rays: &questions, options, keep: None }))
    }

    /// Tests every triangle and no volume.
    #[inline(always)]
    pub(crate) fn visit_all<C: Collect, P: Probe>(
        &self,
        ray: &PreparedRay,
        mut collect: C,
        mut probe: P,
    ) -> (C, P) {
        for triangle in self.triangles() {
            probe.primitive_test();
            if let Some(hit) = self.hit(&triangle, ray, collect.t_max())
                && collect.offer(hit).is_break()
            {
                break;
            }
        }
        (collect, probe)
    }

    /// Refuses heads that cannot be meant.
    ///
    /// # Errors
    /// When they are of other lists, or there is not a row for each ray.
    pub fn check_starts(&self, rays: &[Ray], starts: Starts<'_>) -> Result<(), TraceError> {
        let (width, lists) = (starts.table.width(), self.starts.len() - 1);
        if width != lists {
            let what = format!(
                "the heads are of {width} lists, and there are {lists}: they are of another structure"
            );
            return Err(CatalogueError(what).into());
        }
        if !starts.table.is_of(self) {
            let what = "the heads are of lists of other lengths: they are of another structure";
            return Err(CatalogueError(what.into()).into());
        }
        if starts.rows.len() != rays.len() {
            let what = format!("there are {} rays and rows of heads for {}", rays.len(), starts.rows.len());
            return Err(CatalogueError(what).into());
        }
        let rows = starts.table.rows();
        let beyond = |&&row: &&u32| row != Starts::FROM_THE_FIRST && row as usize >= rows;
        if let Some(row) = starts.rows.iter().find(beyond) {
            let what = format!("a ray begins with the heads of row {row}, and there are {rows} rows");
            return Err(CatalogueError(what).into());
        }
        Ok(())
    }
}

/// Lists, with the way to walk them.
#[derive(Clone, Copy)]
struct Listed<'a>(&'a TraversalList);

impl Traversal for Listed<'_> {
    #[inline(always)]
    fn visit<C: Collect, P: Probe>(&self, _: &Ray, ray: &PreparedRay, collect: C, probe: P) -> (C, P) {
        self.0.visit(ray, None, collect, probe)
    }

    fn has_repeats(&self) -> bool {
        self.0.has_repeats()
    }
}

/// A ray, and where it begins.
#[derive(Clone, Copy)]
struct Started<'a> {
    ray: &'a Ray,
    heads: Option<&'a [u32]>,
}

impl Question for Started<'_> {
    #[inline(always)]
    fn ray(&self) -> &Ray {
        self.ray
    }
}

/// Lists, walked from heads on.
#[derive(Clone, Copy)]
struct ListedFrom<'a>(&'a TraversalList);

impl<'q> Traversal<Started<'q>> for ListedFrom<'_> {
    #[inline(always)]
    fn visit<C: Collect, P: Probe>(
        &self,
        started: &Started<'q>,
        ray: &PreparedRay,
        collect: C,
        probe: P,
    ) -> (C, P) {
        self.0.visit(ray, started.heads, collect, probe)
    }

    fn has_repeats(&self) -> bool {
        self.0.has_repeats()
    }
}

/// Every triangle, and no volume.
#[derive(Clone, Copy)]
struct Unordered<'a>(&'a TraversalList);

impl Traversal for Unordered<'_> {
    #[inline(always)]
    fn visit<C: Collect, P: Probe>(&self, _: &Ray, ray: &PreparedRay, collect: C, probe: P) -> (C, P) {
        self.0.visit_all(ray, collect, probe)
    }

    /// Each triangle has one number.
    fn has_repeats(&self) -> bool {
        false
    }
}
