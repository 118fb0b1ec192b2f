//! A scene that moved, without a new build: triangles and boxes are made anew in their places, and the tree stays.
//!
//! Boxes hold whole triangles afterwards, spatial splits or not. One pass from the last node to the first: children come
//! after their parents.

use super::{BuildReport, Bvh, Node};
use crate::clock::Clock;
use crate::refit::{RefitReport, moved};
use crate::{Aabb, Scene, UpdateError};

impl Bvh {
    /// Moves the triangles to where a scene has them: the one that the tree was built of, with other positions or
    /// transforms.
    ///
    /// ```
    /// use ropewalk::{BuildOptions, Mesh, Ray, Scene, glam::Vec3};
    /// let mesh = Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]);
    /// let mut scene = Scene::from_mesh(mesh);
    /// let mut bvh = scene.build(&BuildOptions::default())?;
    /// scene.objects[0].geometries[0].positions[0] = Vec3::NEG_Y;
    /// let report = bvh.refit(&scene)?;
    /// assert!(bvh.any(&Ray::new(Vec3::new(0.2, -0.3, 5.0), -Vec3::Z)) && report.drift() >= 1.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// When the scene has other triangles. Then nothing has changed.
    pub fn refit(&mut self, scene: &Scene) -> Result<RefitReport, UpdateError> {
        let clock = Clock::start();
        let (triangles, input) = moved(&self.triangles, self.report.triangles, scene)?;
        self.triangles = triangles;
        for place in (0..self.nodes.len()).rev() {
            let node = self.nodes[place];
            let bounds = if node.is_leaf() {
                let leaf = &self.triangles[node.link as usize..][..node.count as usize];
                leaf.iter().map(|triangle| triangle.triangle().bounds()).fold(Aabb::EMPTY, Aabb::union)
            } else {
                self.nodes[place + 1].bounds().union(self.nodes[node.link as usize].bounds())
            };
            self.nodes[place] = Node { min: bounds.min.into(), max: bounds.max.into(), ..node };
        }
        let was = self.report;
        let measured = BuildReport::measure(&self.nodes, &self.triangles, was.triangles);
        let (flatten_time, build_time) = (was.flatten_time, was.build_time);
        self.report = BuildReport { input, flatten_time, build_time, ..measured };
        Ok(RefitReport { cost_before: was.sah_cost, cost: self.report.sah_cost, time: clock.elapsed() })
    }
}
