//! From the name of a triangle to the hit.

use super::NOTHING;
use crate::raster::Request;
use crate::raster::drawing::Drawing;
use crate::raster::tile::is_hole;
use ropewalk::{Hit, PreparedRay, Ray};

/// What the named triangle says of a ray.
pub(super) enum Found {
    Hit(Hit),
    Invalid,
    /// The ray misses it, or it has a hole there.
    Undecided,
}

impl Drawing<'_> {
    /// The hit of a ray with the triangle that was drawn in its pixel, or with one on which it begins: by the expressions of the
    /// walks, so to the bit what they find of it.
    pub(super) fn reconstruct(
        &self,
        name: [u32; 2],
        at_eye: &[[u32; 2]],
        ray: &Ray,
        request: &Request<'_>,
    ) -> Found {
        let Some(prepared) = PreparedRay::new(ray) else { return Found::Invalid };
        let mut best = Hit::MISS;
        if name[0] != NOTHING {
            match self.met(name, ray, &prepared).filter(|hit| !is_hole(request.is_hole, ray, hit)) {
                Some(hit) => best = hit,
                None => return Found::Undecided,
            }
        }
        for &other in at_eye {
            let hit = self.met(other, ray, &prepared).filter(|hit| !is_hole(request.is_hole, ray, hit));
            best = hit.filter(|hit| hit.precedes(&best)).unwrap_or(best);
        }
        Found::Hit(best)
    }

    /// What a ray meets of a part's triangle.
    fn met(&self, [part, triangle]: [u32; 2], ray: &Ray, prepared: &PreparedRay) -> Option<Hit> {
        let (part, triangle) = (self.parts.get(part as usize)?, self.triangles.get(triangle as usize)?);
        match part.place {
            None => self.intersect(triangle, prepared, prepared.t_max),
            Some(_) => self.enter(part, ray, prepared)?.intersect(triangle, prepared.t_max),
        }
    }
}
