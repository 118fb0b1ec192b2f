//! A stage in another pose.

use crate::smooth;
use crate::stage::Stage;
use ropewalk_scene::Pose;

impl Stage {
    /// Brings the model into a pose: its instances, cameras, lights and shapes. The added ground stays last.
    ///
    /// Bounds, ground and what is up stay those of the model that the stage was set for: they say how bright the lights of a file
    /// are and where an automatic camera stands, which must not jump from frame to frame.
    pub fn pose(&mut self, pose: &Pose) {
        pose.apply(self.model_mut());
        let crease = self.crease();
        if crease <= 0.0 {
            return;
        }
        let model = self.model_mut();
        for shape in &pose.shapes {
            let index = shape.object as usize;
            let (Some(object), Some(surfaces)) =
                (model.scene.objects.get(index), model.surfaces.get_mut(index))
            else {
                continue;
            };
            let parts = object.geometries.iter().zip(surfaces).zip(&shape.geometries);
            // The file has no normals where a shape brings none: those that are there were made by the stage.
            for ((mesh, surface), _) in parts.filter(|(_, shape)| shape.normals.is_none()) {
                surface.normals = Some(smooth::corner_normals(mesh, crease));
            }
        }
    }
}
