//! Affine placements of objects in a scene.

use crate::error::TransformError;
use crate::{Aabb, Ray};
use glam::{Affine3A, DAffine3, Vec3};

/// An affine map that can be undone: rotation, any scale, mirroring, shear, translation.
///
/// ```
/// use ropewalk::{Transform, glam::{Affine3A, Vec3}};
/// let mirror = Transform::new(Affine3A::from_scale(Vec3::new(-1.0, 1.0, 1.0))).unwrap();
/// assert!(mirror.mirrors());
/// assert!(Transform::new(Affine3A::from_scale(Vec3::new(0.0, 1.0, 1.0))).is_err());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform {
    to_world: Affine3A,
    to_object: Affine3A,
}

impl Transform {
    /// The transform that leaves everything where it is.
    pub const IDENTITY: Self = Self { to_world: Affine3A::IDENTITY, to_object: Affine3A::IDENTITY };

    /// Takes a map from the object's space to the scene's.
    ///
    /// # Errors
    /// When a component is NaN or infinite, or the map flattens space so that it has no inverse.
    pub fn new(to_world: Affine3A) -> Result<Self, TransformError> {
        if !to_world.is_finite() {
            return Err(TransformError::NotFinite);
        }
        // In f64, where the determinant of no sensible f32 matrix underflows.
        let wide = DAffine3::from_mat3_translation(
            to_world.matrix3.as_dmat3(),
            Vec3::from(to_world.translation).as_dvec3(),
        );
        if wide.matrix3.determinant() == 0.0 {
            return Err(TransformError::Singular);
        }
        let inverse = wide.inverse();
        let to_object =
            Affine3A::from_mat3_translation(inverse.matrix3.as_mat3(), inverse.translation.as_vec3());
        if !to_object.is_finite() {
            return Err(TransformError::Singular);
        }
        Ok(Self { to_world, to_object })
    }

    /// A translation by finite lengths.
    #[must_use]
    pub fn from_translation(offset: Vec3) -> Self {
        Self { to_world: Affine3A::from_translation(offset), to_object: Affine3A::from_translation(-offset) }
    }

    /// The map from the object's space to the scene's.
    #[must_use]
    pub const fn to_world(&self) -> &Affine3A {
        &self.to_world
    }

    /// The map from the scene's space to the object's.
    #[must_use]
    pub const fn to_object(&self) -> &Affine3A {
        &self.to_object
    }

    /// Whether the map turns right hands into left hands.
    #[must_use]
    pub fn mirrors(&self) -> bool {
        self.to_world.matrix3.as_dmat3().determinant() < 0.0
    }

    /// A point of the object in the scene.
    #[must_use]
    pub fn point(&self, point: Vec3) -> Vec3 {
        self.to_world.transform_point3(point)
    }

    /// A normal of the object in the scene, not of unit length.
    #[must_use]
    pub fn normal(&self, normal: Vec3) -> Vec3 {
        self.to_object.matrix3.transpose() * normal
    }

    /// The box around the image of a box.
    #[must_use]
    pub fn bounds(&self, bounds: &Aabb) -> Aabb {
        if bounds.is_empty() {
            return Aabb::EMPTY;
        }
        let corners = (0..8).map(|corner| {
            let pick =
                |axis: usize| if corner >> axis & 1 == 0 { bounds.min[axis] } else { bounds.max[axis] };
            self.point(Vec3::new(pick(0), pick(1), pick(2)))
        });
        Aabb::of_points(corners)
    }

    /// A ray of the scene in the object's space. The direction is not renormalised: `t` means the same in both.
    #[must_use]
    pub fn ray_to_object(&self, ray: &Ray) -> Ray {
        Ray {
            origin: self.to_object.transform_point3(ray.origin),
            dir: self.to_object.transform_vector3(ray.dir),
            ..*ray
        }
    }
}

impl Default for Transform {
    fn default() -> Self {
        Self::IDENTITY
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_undone_is_refused() {
        assert_eq!(Transform::new(Affine3A::from_scale(Vec3::ZERO)), Err(TransformError::Singular));
        let nan = Affine3A::from_translation(Vec3::new(f32::NAN, 0.0, 0.0));
        assert_eq!(Transform::new(nan), Err(TransformError::NotFinite));
        assert_eq!(
            Transform::new(Affine3A::from_scale(Vec3::splat(1e-39))),
            Err(TransformError::Singular),
            "its inverse overflows"
        );
        assert!(Transform::new(Affine3A::from_scale(Vec3::splat(1e-20))).is_ok());
    }

    #[test]
    fn normals_stay_upright_under_uneven_scale() {
        let squash = Transform::new(Affine3A::from_scale(Vec3::new(1.0, 0.1, 1.0))).unwrap();
        let edge = squash.to_world().transform_vector3(Vec3::new(1.0, -1.0, 0.0));
        assert!(squash.normal(Vec3::new(1.0, 1.0, 0.0)).dot(edge).abs() < 1e-6);
    }

    #[test]
    fn the_ray_parameter_is_shared() {
        let place = Transform::new(
            Affine3A::from_scale(Vec3::new(3.0, -2.0, 0.5)) * Affine3A::from_translation(Vec3::ONE),
        )
        .unwrap();
        let ray = Ray::new(Vec3::new(1.0, 2.0, 3.0), Vec3::new(0.3, -0.2, 0.9));
        let there = place.ray_to_object(&ray);
        assert!((place.point(there.at(2.5)) - ray.at(2.5)).length() < 1e-5);
    }
}
