//! A scene that moved, without a new build: corners and boxes are made anew in their places, and the tree stays.
//!
//! Three passes at the speed of memory. The scene is checked and its vertices placed ([`moved`]): after that nothing can fail, so that
//! a scene that does not fit changes nothing. Then all blocks of the arena are written, from the last to the first, because children
//! lie behind their parents ([`blocks`]): corners of triangles, boxes of leaves and of nodes, and the order in which children are
//! pushed. Threads take [`BLOCKS`] of them at a time; a node whose child lies in another thread's part waits for the end.
//!
//! Boxes hold whole triangles afterwards, spatial splits or not. The same for any number of threads, sums included: parts
//! are cut by numbers of blocks alone.
//!
//! Memory: 16 bytes a vertex, while it goes on.

mod blocks;
mod moved;
#[cfg(all(test, feature = "parallel"))]
mod tests;

use super::{Bvh8, Form};
use crate::clock::Clock;
use crate::refit::RefitReport;
use crate::{Aabb, Scene, UpdateError};
use blocks::Blocks;
use moved::Moved;

/// Blocks that a thread takes at a time: half a megabyte of leaves and nodes.
const BLOCKS: usize = 512;

impl Bvh8 {
    /// Moves the triangles to where a scene has them: the one that the tree was built of, with other positions, transforms
    /// or masks. A tenth of the time of a build, and beyond some thousand triangles on all threads.
    ///
    /// ```
    /// use ropewalk::{Bvh8Options, Mesh, Ray, Scene, glam::Vec3};
    /// let mesh = Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]);
    /// let mut scene = Scene::from_mesh(mesh);
    /// let mut bvh = scene.build_packed(&Bvh8Options::default())?;
    /// scene.objects[0].geometries[0].positions[0] = Vec3::NEG_Y;
    /// let report = bvh.refit(&scene)?;
    /// assert!(bvh.any(&Ray::new(Vec3::new(0.2, -0.3, 5.0), -Vec3::Z)) && report.drift() > 0.9);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// When the scene has other triangles, or the tree is compact. Then nothing has changed.
    pub fn refit(&mut self, scene: &Scene) -> Result<RefitReport, UpdateError> {
        if self.form != Form::Full {
            return Err(UpdateError::SharedVertices);
        }
        let clock = Clock::start();
        let moved = Moved::of(self, scene)?;
        self.names.follow(scene);
        let cost_before = self.report.sah_cost;
        let (bounds, half_areas) =
            Blocks { moved: &moved, level: self.level }.write(&mut self.arena, &self.blocks);
        let root_area = f64::from(bounds.half_area());
        self.bounds = if self.is_empty() { Aabb::EMPTY } else { bounds };
        self.report.input = moved.report;
        self.report.sah_cost = if root_area > 0.0 { (root_area + half_areas) / root_area } else { 0.0 };
        Ok(RefitReport { cost_before, cost: self.report.sah_cost, time: clock.elapsed() })
    }
}
