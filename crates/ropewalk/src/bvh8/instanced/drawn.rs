//! Triangles of objects and rays in instances, for those who find out by other means than a walk which triangles a ray may meet.

use super::Instanced;
use crate::two_level::EnteredInstance;
use crate::{FlatTriangle, PreparedRay, Ray};

impl Instanced {
    /// The triangles of all objects, each once, in the objects' spaces.
    #[must_use]
    pub fn triangles(&self) -> Vec<FlatTriangle> {
        (0..self.objects.len()).flat_map(|object| self.triangles_of(object)).collect()
    }

    /// The triangles of an object in its space, each once, by geometry and primitive. None where there is no such object.
    #[must_use]
    pub fn triangles_of(&self, object: usize) -> Vec<FlatTriangle> {
        let mut triangles = self.objects.get(object).map_or_else(Vec::new, |object| object.triangles());
        let name = |triangle: &FlatTriangle| (triangle.geometry(), triangle.primitive);
        triangles.sort_unstable_by_key(name);
        // Spatial splits have put some into several leaves.
        triangles.dedup_by_key(|triangle| name(triangle));
        triangles
    }

    /// Takes a ray to the space of an instance's object, by its place among [`Instanced::placed`]. `None` where the ray does not meet
    /// the instance's box, or does not see it. The ray must be that of which the prepared one was made.
    #[inline]
    #[must_use]
    pub fn entered(&self, place: u32, question: &Ray, ray: &PreparedRay) -> Option<EnteredInstance> {
        EnteredInstance::two_sided(self.placed.get(place as usize)?, question, ray)
    }
}
