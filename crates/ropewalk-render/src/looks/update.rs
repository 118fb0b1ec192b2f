//! New poses: instances moved, vertices and normals of deformed objects written anew, everything else kept.

use super::layout::{self, INSTANCE};
use super::{Looks, pack};
use crate::stage::Stage;
use glam::Vec3;
use std::ops::Range;

impl Looks {
    /// Takes over the instances and the deformed objects of a stage that is the one these looks were made of in another
    /// pose. Returns the ranges of words that have changed, in order, or `None` when it is not the same stage: then the
    /// looks must be made anew.
    pub(crate) fn update(&mut self, stage: &Stage) -> Option<Vec<Range<usize>>> {
        let model = stage.model();
        let scene = &model.scene;
        let same = scene.instances.len() == self.word(layout::INSTANCES + 1) as usize
            && scene.objects.len() + 1 == self.first_parts.len()
            && model.surfaces.len() == scene.objects.len()
            // One plain material more: see the packing.
            && model.materials.len() + 1 == self.word(layout::MATERIALS + 1) as usize;
        if !same {
            return None;
        }
        for (object, bounds) in scene.objects.iter().zip(self.first_parts.windows(2)) {
            let parts = self.parts.get(bounds[0]..bounds[1])?;
            let is_same = |(mesh, part): (&ropewalk::Mesh, &pack::Part)| {
                mesh.positions.len() == part.vertices && mesh.triangles.len() == part.triangles
            };
            if object.geometries.len() != parts.len() || !object.geometries.iter().zip(parts).all(is_same) {
                return None;
            }
        }
        let mut changed = Vec::new();
        let instances = self.word(layout::INSTANCES) as usize;
        for (index, instance) in scene.instances.iter().enumerate() {
            let row = pack::instance_row(instance, &self.first_parts);
            self.replace(instances + index * INSTANCE, &row, &mut changed);
        }
        let (vertices, normals) = (self.word(layout::VERTICES) as usize, self.word(layout::NORMALS) as usize);
        let mut row = Vec::new();
        for (number, (object, surfaces)) in scene.objects.iter().zip(&model.surfaces).enumerate() {
            for (geometry, mesh) in object.geometries.iter().enumerate() {
                let part = *self.parts.get(self.first_parts[number] + geometry)?;
                row.clear();
                mesh.positions.iter().for_each(|&vertex| pack::push_vector(&mut row, pack::finite(vertex)));
                self.replace(vertices + 3 * part.first_vertex, &row, &mut changed);
                let Some(values) = surfaces.get(geometry).and_then(|surface| surface.normals.as_ref()) else {
                    continue;
                };
                if values.values.len() != part.normals {
                    return None;
                }
                row.clear();
                for &normal in &values.values {
                    pack::push_vector(&mut row, pack::direction(normal).unwrap_or(Vec3::ZERO));
                }
                self.replace(normals + 3 * part.first_normal, &row, &mut changed);
            }
        }
        Some(changed)
    }

    /// Writes words, and notes the range of those that differ. Ranges that touch are joined.
    fn replace(&mut self, start: usize, words: &[u32], changed: &mut Vec<Range<usize>>) {
        let Some(place) = self.words.get_mut(start..start + words.len()) else { return };
        let Some(first) = place.iter().zip(words).position(|(old, new)| old != new) else { return };
        let last = place.iter().zip(words).rposition(|(old, new)| old != new).unwrap_or(first);
        place[first..=last].copy_from_slice(&words[first..=last]);
        let range = start + first..start + last + 1;
        match changed.last_mut() {
            Some(before) if before.end == range.start => before.end = range.end,
            _ => changed.push(range),
        }
    }
}
