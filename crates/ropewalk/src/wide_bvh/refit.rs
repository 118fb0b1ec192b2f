//! A scene that moved, without a new build: as [`crate::Bvh::refit`], for wide nodes.

use super::{Node, WideBvh, bounds_of, is_empty};
use crate::clock::Clock;
use crate::refit::{RefitReport, moved};
use crate::{Aabb, Scene, UpdateError};

impl WideBvh {
    /// Moves the triangles to where a scene has them: the one that the tree was built of, with other positions or
    /// transforms.
    ///
    /// # Errors
    /// When the scene has other triangles. Then nothing has changed.
    pub fn refit(&mut self, scene: &Scene) -> Result<RefitReport, UpdateError> {
        let clock = Clock::start();
        let (triangles, input) = moved(&self.triangles, self.report.triangles, scene)?;
        let cost_before = self.report.sah_cost;
        let width = self.width.children();
        let mut children = std::mem::take(&mut self.children);
        // Wide nodes come after those that lead to them.
        for place in (0..children.len()).rev() {
            let child = children[place];
            if is_empty(&child) {
                continue;
            }
            let bounds = if child.is_leaf() {
                let leaf = &triangles[child.link as usize..][..child.count as usize];
                leaf.iter().map(|triangle| triangle.triangle().bounds()).fold(Aabb::EMPTY, Aabb::union)
            } else {
                bounds_of(&children[child.link as usize * width..][..width])
            };
            children[place] = Node { min: bounds.min.into(), max: bounds.max.into(), ..child };
        }
        let mut report = self.report;
        report.input = input;
        *self = Self::measured(self.width, children, triangles, report);
        Ok(RefitReport { cost_before, cost: self.report.sah_cost, time: clock.elapsed() })
    }
}
