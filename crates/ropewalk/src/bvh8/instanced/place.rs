//! Placing instances: inverses, boxes and a new tree over them.

use super::{Instanced, Top};
use crate::bvh8::Bvh8;
use crate::memory::with_capacity;
use crate::parallel::extend;
use crate::two_level::{Placed, image};
use crate::{
    Aabb, BuildError, BuildReport, FlatTriangle, InputReport, Instance, SceneError, Transform, TransformError,
};
use glam::{Mat3, Vec3};

/// Stands for an instance whose object has no triangles, or that cannot be placed.
const NOT_PLACED: Placed = Placed {
    axis_x: [0.0; 3],
    object: u32::MAX,
    axis_y: [0.0; 3],
    instance_and_mask: 0,
    axis_z: [0.0; 3],
    reserved_0: 0,
    origin: [0.0; 3],
    reserved_1: 0,
    min: [0.0; 3],
    reserved_2: 0,
    max: [0.0; 3],
    reserved_3: 0,
};

impl Instanced {
    /// Places these instances instead of those before, with a new top level: 10,000 of them in two milliseconds, on one
    /// thread.
    ///
    /// # Errors
    /// When an instance names no object, there are more of them than can be told apart, or a transform shrinks or magnifies so much that no
    /// ray could be taken to the object's space. Then nothing has changed.
    pub fn place(&mut self, instances: &[Instance]) -> Result<(), BuildError> {
        let limit = FlatTriangle::INSTANCE_LIMIT;
        if instances.len() > limit {
            return Err(SceneError::TooManyInstances { instances: instances.len(), limit }.into());
        }
        let mut placed = with_capacity(instances.len());
        extend(&mut placed, instances, |index, instance| match self.placed_at(index, instance) {
            Ok(Some(placed)) => placed,
            _ => NOT_PLACED,
        });
        // Rare, and asked once more what it was.
        if placed.iter().any(is_not_placed) {
            for (index, instance) in instances.iter().enumerate() {
                self.placed_at(index, instance)?;
            }
            placed.retain(|placed| !is_not_placed(placed));
        }
        self.top = Top::over(&placed)?;
        self.placed = placed;
        self.instances.clear();
        self.instances.extend_from_slice(instances);
        self.measure();
        Ok(())
    }

    /// An instance in its place; `None` where its object has no triangles.
    fn placed_at(&self, index: usize, instance: &Instance) -> Result<Option<Placed>, SceneError> {
        let Some(object) = self.objects.get(instance.object as usize) else {
            let (object, objects) = (instance.object, self.objects.len());
            return Err(SceneError::NoSuchObject { instance: index, object, objects });
        };
        if object.is_empty() {
            return Ok(None);
        }
        let transform = |why: TransformError| SceneError::Transform { instance: index, why };
        let place = (index as u32, instance.object, instance.mask);
        placed(place, &instance.transform, object).map(Some).map_err(transform)
    }

    /// Sums up the reports of the objects and of the top level.
    fn measure(&mut self) {
        let mut report = BuildReport { build_time: self.report.build_time, ..BuildReport::default() };
        for object in &self.objects {
            report.add_object(object.report());
        }
        let top = self.top.report;
        report.nodes += top.nodes;
        report.bytes += self.top.bytes() + size_of_val(self.placed.as_slice());
        report.depth += top.depth;
        report.sah_cost = top.sah_cost;
        report.input = self.input();
        self.report = report;
    }

    /// What was wrong with the triangles, instances counted.
    fn input(&self) -> InputReport {
        let mut sum = InputReport::default();
        for instance in &self.instances {
            sum += self.objects[instance.object as usize].report().input;
        }
        sum
    }
}

fn is_not_placed(placed: &Placed) -> bool {
    placed.object == NOT_PLACED.object
}

/// The box around a placed object, a little larger than rounding needs.
pub(super) fn world_bounds(transform: &Transform, object: &Bvh8) -> Aabb {
    let to_world = transform.to_world();
    image(&Mat3::from(to_world.matrix3), to_world.translation.into(), &object.bounds())
}

fn placed(
    (instance, object, mask): (u32, u32, u32),
    transform: &Transform,
    bvh: &Bvh8,
) -> Result<Placed, TransformError> {
    let to_object = transform.to_object();
    let matrix = to_object.matrix3;
    let map = [matrix.x_axis, matrix.y_axis, matrix.z_axis, to_object.translation].map(Vec3::from);
    Placed::of_map(instance, object, mask, map, &world_bounds(transform, bvh))
}
