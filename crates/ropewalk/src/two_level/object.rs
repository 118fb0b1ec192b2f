//! An object: a bottom structure, in the frame in which it was built.
//!
//! The frame is a rotation of the object's space (Gottschalk, in [`super::oriented_box`]) where the box of the triangles is
//! smaller in it, and the object's space itself where it is not, or where nobody asked for frames.

use super::{Bottom, BottomSpec, oriented_box};
use crate::refit::RefitReport;
use crate::{Aabb, BuildError, BuildReport, Monitor, Object, Scene, Transform, UpdateError};
use glam::{DMat3, Mat3, Vec3};

/// What instances of an object share.
#[derive(Clone, Debug)]
pub struct ObjectStructure {
    bottom: Bottom,
    frame: Mat3,
    /// The box of the triangles in the frame.
    bounds: Aabb,
    /// The box of the same triangles in the object's space.
    own_bounds: Aabb,
}

impl ObjectStructure {
    /// Builds the bottom structure of an object; with `oriented`, in the frame of its oriented box.
    ///
    /// # Errors
    /// When an option is out of range or the monitor cancels.
    pub fn build(
        object: &Object,
        bottom: BottomSpec,
        oriented: bool,
        monitor: &dyn Monitor,
    ) -> Result<Self, BuildError> {
        let mut scene = alone(object);
        let triangles = scene.flatten()?.triangles;
        let corners = || triangles.iter().flat_map(|triangle| triangle.triangle().vertices);
        let own_bounds = Aabb::of_points(corners());
        let frame = if oriented { oriented_box::frame_of(&triangles) } else { Mat3::IDENTITY };
        turn(&mut scene, frame);
        let bottom = Bottom::build(bottom, &scene, monitor)?;
        let bounds = bottom.bounds();
        Ok(Self { bottom, frame, bounds, own_bounds })
    }

    /// Moves the triangles to where another shape of the object has them, in the same frame.
    ///
    /// # Errors
    /// When that has other triangles, or the structure cannot follow. Then nothing has changed.
    pub(super) fn refit(&mut self, shape: &Object) -> Result<RefitReport, UpdateError> {
        let mut scene = alone(shape);
        let own_bounds = scene.bounds();
        turn(&mut scene, self.frame);
        let report = self.bottom.refit(&scene)?;
        self.bounds = self.bottom.bounds();
        self.own_bounds = own_bounds;
        Ok(report)
    }

    /// The structure over its triangles.
    #[must_use]
    pub fn bottom(&self) -> &Bottom {
        &self.bottom
    }

    /// The rotation from the object's space to the frame in which the structure lies.
    #[must_use]
    pub const fn frame(&self) -> Mat3 {
        self.frame
    }

    /// Whether the frame is another than the object's own space.
    #[must_use]
    pub fn is_turned(&self) -> bool {
        self.frame != Mat3::IDENTITY
    }

    /// The box of the triangles in the frame: the oriented box.
    #[must_use]
    pub const fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// How the structure was built.
    #[must_use]
    pub fn report(&self) -> &BuildReport {
        self.bottom.report()
    }

    /// Whether there is nothing to hit.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.bounds.is_empty()
    }

    /// The box around a placed object: what the images of both boxes have in common, a little larger than rounding needs.
    #[must_use]
    pub fn world_bounds(&self, transform: &Transform) -> Aabb {
        let matrix = Mat3::from(transform.to_world().matrix3);
        let own = image(&matrix, transform.to_world().translation.into(), &self.own_bounds);
        if !self.is_turned() {
            return own;
        }
        let turned = self.part_bounds(transform, &self.bounds);
        Aabb::new(own.min.max(turned.min), own.max.min(turned.max))
    }

    /// The box around a placed part of the frame, a little larger than rounding needs.
    pub(super) fn part_bounds(&self, transform: &Transform, part: &Aabb) -> Aabb {
        let matrix = Mat3::from(transform.to_world().matrix3);
        // A rotation's inverse is its transpose. In f64, so that the image is of the same placement.
        let from_frame = match self.is_turned() {
            true => (matrix.as_dmat3() * self.frame.as_dmat3().transpose()).as_mat3(),
            false => matrix,
        };
        image(&from_frame, transform.to_world().translation.into(), part)
    }

    /// From the scene to the frame: the linear part and the translation.
    pub(super) fn local(&self, transform: &Transform) -> [Vec3; 4] {
        let to_object = transform.to_object();
        let (matrix, translation) = (Mat3::from(to_object.matrix3), Vec3::from(to_object.translation));
        if !self.is_turned() {
            return [matrix.x_axis, matrix.y_axis, matrix.z_axis, translation];
        }
        let frame: DMat3 = self.frame.as_dmat3();
        let turned = (frame * matrix.as_dmat3()).as_mat3();
        [turned.x_axis, turned.y_axis, turned.z_axis, (frame * translation.as_dvec3()).as_vec3()]
    }
}

/// A scene of one object, placed as it is.
pub(crate) fn alone(object: &Object) -> Scene {
    let mut scene = Scene::default();
    let index = scene.add_object(object.clone());
    scene.add_instance(index, Transform::IDENTITY);
    scene
}

/// Turns all objects of a scene.
fn turn(scene: &mut Scene, frame: Mat3) {
    if frame != Mat3::IDENTITY {
        let meshes = scene.objects.iter_mut().flat_map(|object| &mut object.geometries);
        meshes.flat_map(|mesh| &mut mesh.positions).for_each(|position| *position = frame * *position);
    }
}

/// The box around the image of a box, from its middle and its half sizes, wider by more than all of this is rounded: a corner
/// is a sum of four terms, each of which is rounded three times at most, and the vertices of a turned frame were rounded
/// themselves. 16 times the unit roundoff of the sum of magnitudes is about twice that.
pub(crate) fn image(matrix: &Mat3, translation: Vec3, bounds: &Aabb) -> Aabb {
    if bounds.is_empty() {
        return Aabb::EMPTY;
    }
    let largest = bounds.min.abs().max(bounds.max.abs());
    let magnitude = matrix.abs() * largest + translation.abs();
    let slack = magnitude * (16.0 * f32::EPSILON / 2.0);
    let (center, half) = (bounds.center(), bounds.max * 0.5 - bounds.min * 0.5);
    let middle = *matrix * center + translation;
    let reach = matrix.abs() * half + slack;
    Aabb::new(middle - reach, middle + reach)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Mesh, NoMonitor};
    use glam::{Affine3A, Quat};

    fn needle() -> Object {
        let along = Quat::from_rotation_z(0.7) * Vec3::X;
        Object::from(Mesh::new(vec![-along, along, Vec3::Z * 0.01], vec![[0, 1, 2]]))
    }

    /// Random rotations, uneven scales and mirrors: no vertex lies outside, and no box is larger than that of the corners.
    #[test]
    fn a_placed_object_lies_in_its_box() {
        for oriented in [false, true] {
            let object =
                ObjectStructure::build(&needle(), BottomSpec::default(), oriented, &NoMonitor).unwrap();
            assert_eq!(object.is_turned(), oriented);
            for step in 0..200u16 {
                let turn = f32::from(step);
                let scale = Vec3::new(1.0 + turn, 0.01, -1.0);
                let map = Affine3A::from_translation(Vec3::splat(turn * 100.0))
                    * Affine3A::from_quat(Quat::from_euler(glam::EulerRot::XYZ, turn, 0.3 * turn, 2.0))
                    * Affine3A::from_scale(scale);
                let transform = Transform::new(map).unwrap();
                let bounds = object.world_bounds(&transform);
                for vertex in &needle().geometries[0].positions {
                    let placed = Aabb::of_points([transform.point(*vertex)]);
                    assert!(bounds.contains(&placed), "{step}: {bounds:?} {placed:?}");
                }
            }
        }
    }
}
