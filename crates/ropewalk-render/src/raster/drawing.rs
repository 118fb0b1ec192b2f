//! The triangles of a structure, by instance, ready to be drawn.
//!
//! They are taken from the structure itself, in the frames in which its walks test them: of a structure of one level the scene's
//! space, of two levels the objects' own frames, each once however often it is placed. So what is drawn is what is traced.
//!
//! **Cost.** A copy of the triangles, 48 bytes each, and on a graphics adapter another one there.

use super::adapter::AdapterDrawing;
use super::{Rasterised, Request, software};
use crate::error::RenderError;
use crate::trace::Trace;
use glam::DVec3;
use ropewalk::two_level::{EnteredInstance, Placed};
use ropewalk::{Aabb, FlatTriangle, Hit, PreparedRay, Ray, Structure, Traced};
use std::ops::Range;

/// The triangles of a structure, ready to be drawn on the device that traces it.
pub(crate) struct Drawing<'a> {
    pub(super) structure: &'a Structure,
    /// By part, then geometry and primitive.
    pub(super) triangles: Vec<FlatTriangle>,
    /// The instances that there are to draw.
    pub(super) parts: Vec<Part>,
    adapter: Option<AdapterDrawing>,
}

/// An instance as it is drawn.
#[derive(Clone, Debug)]
pub(super) struct Part {
    /// Its triangles.
    pub(super) triangles: Range<usize>,
    /// From the scene to the frame of the triangles: the images of the axes, and of zero.
    pub(super) axes: [DVec3; 3],
    pub(super) origin: DVec3,
    /// The box around them, in their frame.
    pub(super) bounds: Aabb,
    /// The box in the scene.
    pub(super) world: Aabb,
    /// The place among a two-level structure's instances; `None` where the frame is the scene.
    pub(super) place: Option<u32>,
    /// The mask in the top 8 bits.
    pub(super) instance_and_mask: u32,
    /// Whether what runs counter-clockwise in the frame is seen clockwise from its front.
    pub(super) mirrors: bool,
}

impl<'a> Drawing<'a> {
    /// Takes the triangles of the structure that a device traces.
    ///
    /// # Errors
    /// When the device does not say what it traces, or the triangles do not fit it.
    pub(crate) fn new(tracer: &'a dyn Trace) -> Result<Self, RenderError> {
        let structure = tracer.structure().ok_or_else(|| {
            RenderError::Raster(
                "this device does not show its triangles: take primary hits by rays (traced)".into(),
            )
        })?;
        let mut drawing = Self { structure, triangles: Vec::new(), parts: Vec::new(), adapter: None };
        match structure {
            Structure::TwoLevel(scene) => {
                let objects = scene.objects().iter().map(|object| match object {
                    Some(object) => (object.triangles(), object.bounds()),
                    None => (Vec::new(), Aabb::EMPTY),
                });
                drawing.take_objects(objects, scene.placed())?;
            }
            Structure::Instanced(scene) => {
                let objects = scene.objects().iter().enumerate();
                let objects = objects.map(|(index, object)| (scene.triangles_of(index), object.bounds()));
                drawing.take_objects(objects, scene.placed())?;
            }
            flat => drawing.take_instances(flat),
        }
        if let Some(gpu) = tracer.gpu() {
            drawing.adapter = Some(AdapterDrawing::new(gpu, &drawing)?);
        }
        Ok(drawing)
    }

    /// Of a structure of one level.
    fn take_instances(&mut self, structure: &Structure) {
        let mut triangles = structure.triangles().into_owned();
        let id = |triangle: &FlatTriangle| (triangle.instance(), triangle.geometry(), triangle.primitive);
        triangles.sort_unstable_by_key(id);
        // Spatial splits have put some into several leaves.
        triangles.dedup_by_key(|triangle| id(triangle));
        let mut first = 0;
        for of_instance in triangles.chunk_by(|a, b| a.instance() == b.instance()) {
            let bounds = of_instance.iter().map(|it| it.triangle().bounds()).fold(Aabb::EMPTY, Aabb::union);
            self.parts.push(Part {
                triangles: first..first + of_instance.len(),
                axes: DVec3::AXES,
                origin: DVec3::ZERO,
                bounds,
                world: bounds,
                place: None,
                instance_and_mask: of_instance[0].instance_and_mask,
                mirrors: of_instance[0].is_mirrored(),
            });
            first += of_instance.len();
        }
        self.triangles = triangles;
    }

    /// Of two levels: the triangles of each object with the box around them, and where objects are.
    fn take_objects(
        &mut self,
        objects: impl Iterator<Item = (Vec<FlatTriangle>, Aabb)>,
        placed: &[Placed],
    ) -> Result<(), RenderError> {
        let mut ranges = Vec::new();
        for (triangles, bounds) in objects {
            let first = self.triangles.len();
            self.triangles.extend(triangles);
            ranges.push((first..self.triangles.len(), bounds));
        }
        for (place, placed) in (0..).zip(placed) {
            let Some((range, bounds)) = ranges.get(placed.object as usize) else {
                return Err(RenderError::Raster(format!("instance {} names no object", placed.instance())));
            };
            let (axes, origin) = map_of(placed);
            self.parts.push(Part {
                triangles: range.clone(),
                axes,
                origin,
                bounds: *bounds,
                world: placed.bounds(),
                place: Some(place),
                instance_and_mask: placed.instance_and_mask,
                mirrors: glam::DMat3::from_cols(axes[0], axes[1], axes[2]).determinant() < 0.0,
            });
        }
        Ok(())
    }

    /// The hits of a run's rays. `trace` answers the closest hits of rays, with the same holes.
    ///
    /// # Errors
    /// When the device fails.
    pub(crate) fn hits(
        &self,
        request: &Request<'_>,
        trace: &dyn Fn(&[Ray]) -> Result<Traced, RenderError>,
    ) -> Result<Rasterised, RenderError> {
        let expected = request.pixels.len().checked_mul(request.subpixels.len());
        if request.width == 0 || expected != Some(request.rays.len()) {
            return Err(RenderError::Raster(format!(
                "{} rays are not those of {} pixels with {} samples each",
                request.rays.len(),
                request.pixels.len(),
                request.subpixels.len()
            )));
        }
        if request.rays.is_empty() {
            return Ok(Rasterised { hits: Vec::new(), status: Vec::new(), traced_instead: 0 });
        }
        match &self.adapter {
            Some(adapter) => adapter.hits(self, request, trace),
            None => Ok(software::hits(self, request)),
        }
    }

    /// The frame of a part, as a ray enters it.
    #[inline]
    pub(super) fn enter(&self, part: &Part, question: &Ray, ray: &PreparedRay) -> Option<EnteredInstance> {
        match (self.structure, part.place) {
            (Structure::TwoLevel(scene), Some(place)) => scene.entered(place, question, ray),
            (Structure::Instanced(scene), Some(place)) => scene.entered(place, question, ray),
            _ => None,
        }
    }

    /// What a walk finds of a triangle in the scene's space.
    #[inline(always)]
    pub(super) fn intersect(&self, triangle: &FlatTriangle, ray: &PreparedRay, t_max: f32) -> Option<Hit> {
        if self.structure.is_one_sided() {
            triangle.intersect_front(ray, t_max)
        } else {
            triangle.intersect(ray, t_max)
        }
    }
}

impl Part {
    /// Whether rays of a mask see it.
    pub(super) const fn is_seen_by(&self, mask: u32) -> bool {
        self.instance_and_mask & mask << 24 != 0
    }
}

/// The map from the scene to the frame of a placed object.
fn map_of(placed: &Placed) -> ([DVec3; 3], DVec3) {
    let wide = |v: [f32; 3]| glam::Vec3::from(v).as_dvec3();
    ([placed.axis_x, placed.axis_y, placed.axis_z].map(wide), wide(placed.origin))
}
