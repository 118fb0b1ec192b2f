//! From a scene to its lists.

use super::{HeadTable, Heads, Identity, ListOptions, TraversalList, layer, vertices};
use crate::clock::Clock;
use crate::{Aabb, BuildError, BuildReport, FlatScene, FlatTriangle, Monitor, NoMonitor, Scene};

impl Scene {
    /// Builds traversal lists over all instances.
    ///
    /// ```
    /// use ropewalk::{ListOptions, Mesh, Ray, Scene, glam::Vec3};
    /// let mesh = Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]);
    /// let list = Scene::from_mesh(mesh).build_list(&ListOptions::default())?;
    /// assert!(list.any(&Ray::new(Vec3::new(0.2, 0.3, 5.0), -Vec3::Z)));
    /// # Ok::<(), ropewalk::BuildError>(())
    /// ```
    ///
    /// # Errors
    /// When the scene or an option is out of range.
    pub fn build_list(&self, options: &ListOptions) -> Result<TraversalList, BuildError> {
        self.build_list_monitored(options, &NoMonitor)
    }

    /// Builds traversal lists over all instances, under the eyes of a monitor that may cancel the build of the hierarchy.
    ///
    /// # Errors
    /// When the scene or an option is out of range, or the monitor cancels.
    pub fn build_list_monitored(
        &self,
        options: &ListOptions,
        monitor: &dyn Monitor,
    ) -> Result<TraversalList, BuildError> {
        options.check()?;
        let clock = Clock::start();
        let FlatScene { triangles, report: input } = self.flatten()?;
        let flatten_time = clock.elapsed();
        let clock = Clock::start();
        let (vertices, corners) = vertices::share(self, &triangles);
        // In the order of their instances.
        let first_of = |moving| triangles.partition_point(|triangle| triangle.instance() < moving) as u32;
        let ends: Vec<u32> =
            options.moving.map(first_of).into_iter().chain([triangles.len() as u32]).collect();
        let mut list = TraversalList {
            options: *options,
            elements: Vec::new(),
            starts: vec![0],
            layers: Vec::new(),
            bounds: Aabb::EMPTY,
            largest: 0.0,
            vertices,
            corners,
            identities: triangles.iter().map(Identity::of).collect(),
            heads: None,
            report: BuildReport { input, flatten_time, triangles: triangles.len(), ..BuildReport::default() },
        };
        let mut weighted_cost = 0.0;
        let mut first = 0;
        for end in ends {
            let made = layer::make(&triangles, first..end, &list.corners, options, monitor)?;
            first = end;
            weighted_cost += made.weighted_cost;
            list.append(made)?;
        }
        list.measure(&triangles);
        // The first element of each layer is tested for every ray.
        let firsts = list.layers.iter().filter(|layer| !layer.triangles.is_empty()).count() as f64;
        let area = f64::from(list.bounds.half_area());
        list.report.sah_cost = firsts + if area > 0.0 { weighted_cost / area } else { 0.0 };
        list.report.build_time = clock.elapsed();
        Ok(list)
    }
}

impl TraversalList {
    fn append(&mut self, made: layer::Made) -> Result<(), BuildError> {
        let limit = i32::MAX as usize;
        let count = self.elements.len() + made.lists.iter().map(Vec::len).sum::<usize>();
        if count > limit {
            return Err(BuildError::TooMany { what: "elements of all lists", count, limit });
        }
        for list in made.lists {
            self.elements.extend(list);
            self.starts.push(self.elements.len() as u32);
        }
        self.report.references += made.references;
        self.report.nodes += made.layer.groups + made.references;
        self.report.depth = self.report.depth.max(made.depth);
        self.layers.push(made.layer);
        Ok(())
    }

    /// What depends on where everything is.
    pub(super) fn measure(&mut self, triangles: &[FlatTriangle]) {
        self.bounds =
            triangles.iter().map(|triangle| triangle.triangle().bounds()).fold(Aabb::EMPTY, Aabb::union);
        self.largest = if self.bounds.is_empty() {
            0.0
        } else {
            self.bounds.min.abs().max(self.bounds.max.abs()).max_element()
        };
        self.heads = match self.options.heads {
            Heads::Disabled => None,
            Heads::Simple | Heads::Regular => Some(HeadTable::of_polygons(self, self.options.heads)),
        };
        self.report.leaves = self.report.references;
        self.report.largest_leaf = u32::from(!triangles.is_empty());
        self.report.bytes = size_of_val(self.elements.as_slice())
            + size_of_val(self.vertices.as_slice())
            + size_of_val(self.identities.as_slice())
            + size_of_val(self.corners.as_slice())
            + self.heads.as_ref().map_or(0, HeadTable::bytes);
    }
}
