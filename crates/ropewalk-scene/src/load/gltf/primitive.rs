//! Primitives: what becomes one geometry of an object.
//!
//! Files like to share one large vertex array among many primitives. A geometry keeps only the vertices that its
//! triangles use when the array holds more than three a triangle, so memory grows with the triangles alone; and
//! the triangles of a file have a [budget](Budget), because a few bytes can ask for the same ones again and again.

use super::accessor::Accessor;
use super::buffers::Buffers;
use super::document::{Primitive, get};
use super::topology::Topology;
use crate::{CornerAttribute, LoadError, LoadReport, MaterialAssignment, Surface};
use glam::{Vec2, Vec3};
use ropewalk::Mesh;

/// What the primitives of one file are read with.
pub(super) struct PrimitiveReader<'b, 'a> {
    buffers: &'b Buffers<'a>,
    budget: Budget,
    /// Whether a primitive had no material, so that the one behind those of the file is used.
    pub(super) uses_default_material: bool,
}

/// How much geometry a file may unfold to.
#[derive(Debug, Default)]
struct Budget {
    used: u64,
}

impl Budget {
    /// A thousand differently coloured copies of a part of 10,000 triangles, all sharing their arrays, take 250 MB.
    const ALWAYS: u64 = 512 << 20;
    /// Vertices of 6 bytes and indices of 1 become 32 and 4 bytes; every part may be used a few times.
    const RATIO: u64 = 64;

    /// Takes room for `bytes` of geometry out of a file of `loaded` bytes; an error says how much there may be.
    fn take(&mut self, bytes: u64, loaded: u64) -> Result<(), String> {
        let limit = loaded.saturating_mul(Self::RATIO).saturating_add(Self::ALWAYS);
        self.used = self.used.saturating_add(bytes);
        if self.used <= limit {
            return Ok(());
        }
        Err(format!(
            "the geometry takes more than {limit} bytes, the limit for a file of {loaded}: \
             its primitives ask for the same data too often; place one mesh by many nodes instead"
        ))
    }
}

/// The bytes of a triangle, and of a vertex with its normal and texture coordinates.
const TRIANGLE_BYTES: u64 = size_of::<[u32; 3]>() as u64;
const VERTEX_BYTES: u64 = (size_of::<Vec3>() * 2 + size_of::<Vec2>()) as u64;

impl<'b, 'a> PrimitiveReader<'b, 'a> {
    pub(super) fn new(buffers: &'b Buffers<'a>) -> Self {
        Self { buffers, budget: Budget::default(), uses_default_material: false }
    }

    /// Reads a primitive, and says which vertices of its arrays it kept. One that has no triangles becomes an empty mesh, so that geometries keep their numbers.
    pub(super) fn read(
        &mut self,
        primitive: &Primitive,
        place: &str,
        report: &mut LoadReport,
    ) -> Result<(Mesh, Surface, Kept), LoadError> {
        let mut surface = Surface { materials: self.material(primitive), ..Surface::default() };
        let topology = match Topology::of(primitive.mode.unwrap_or(4)) {
            Ok(topology) => topology,
            Err(what) => {
                report.skip(what, || place.into());
                return Ok((Mesh::default(), surface, Kept::All(0)));
            }
        };
        // Opened before it is known whether there are vertices: a wrong reference is an error in any case.
        let indices = primitive.indices.map(|index| self.open::<1>(index)).transpose()?;
        let Some(position) = primitive.attributes.position else {
            report.skip("primitives without POSITION", || place.into());
            return Ok((Mesh::default(), surface, Kept::All(0)));
        };
        self.refuse_compressed(primitive, position, place)?;
        let positions = self.open::<3>(position)?;
        let mut triangles = self.triangles(topology, indices.as_ref(), positions.count(), place, report)?;
        let kept = Kept::of(&mut triangles, positions.count());
        let room = VERTEX_BYTES.saturating_mul(kept.len() as u64);
        self.take(room, place)?;

        let mesh = Mesh::new(kept.values(|vertex| Vec3::from(positions.vector(vertex))), triangles);
        surface.normals = self
            .attribute(primitive.attributes.normal, positions.count(), "normals", report)
            .map(|normals: Accessor<'_, 3>| {
                let mut values = kept.values(|vertex| Vec3::from(normals.vector(vertex)));
                for value in values.iter_mut().filter(|value| !value.is_finite()) {
                    report.skip("normals that are not finite", || place.into());
                    *value = Vec3::ZERO;
                }
                CornerAttribute { values, indices: None }
            });
        let coordinates = primitive.attributes.texture_coordinates;
        surface.texture_coordinates = self
            .attribute(coordinates, positions.count(), "texture coordinates", report)
            .map(|coordinates: Accessor<'_, 2>| CornerAttribute {
                values: kept.values(|vertex| Vec2::from(coordinates.vector(vertex))),
                indices: None,
            });
        Ok((mesh, surface, kept))
    }

    fn material(&mut self, primitive: &Primitive) -> MaterialAssignment {
        self.uses_default_material |= primitive.material.is_none();
        let material = primitive.material.unwrap_or(self.buffers.document.materials.len() as u64);
        // The reference is checked, and a list of 2³² materials fits no file that is read.
        MaterialAssignment::One(u32::try_from(material).unwrap_or(0))
    }

    fn open<const WIDTH: usize>(&self, index: u64) -> Result<Accessor<'b, WIDTH>, LoadError> {
        Accessor::open(self.buffers, index)
    }

    fn malformed(&self, place: &str, what: impl Into<String>) -> LoadError {
        self.buffers.source.malformed(place, what)
    }

    fn take(&mut self, bytes: u64, place: &str) -> Result<(), LoadError> {
        self.budget.take(bytes, self.buffers.loaded_bytes()).map_err(|what| self.malformed(place, what))
    }

    /// Compressed geometry may come with a plain copy. Where it does not, the accessors would read as zeros.
    fn refuse_compressed(&self, primitive: &Primitive, position: u64, place: &str) -> Result<(), LoadError> {
        let is_plain = get(&self.buffers.document.accessors, position)
            .is_some_and(|accessor| accessor.buffer_view.is_some() || accessor.sparse.is_some());
        if primitive.extensions.draco.is_none() || is_plain {
            return Ok(());
        }
        let what =
            "it is stored with KHR_draco_mesh_compression alone, which is not read; export it uncompressed";
        Err(self.malformed(place, what))
    }

    /// The triangles whose corners are vertices; the others are counted.
    fn triangles(
        &mut self,
        topology: Topology,
        indices: Option<&Accessor<'_, 1>>,
        vertices: usize,
        place: &str,
        report: &mut LoadReport,
    ) -> Result<Vec<[u32; 3]>, LoadError> {
        let Some(indices) = indices else {
            let count = topology.triangle_count(vertices);
            Self::check_corners(topology, vertices, place, report);
            self.take(TRIANGLE_BYTES.saturating_mul(count as u64), place)?;
            // An accessor's count fits 32 bits.
            return Ok((0..count)
                .map(|triangle| topology.corners(triangle).map(|corner| corner as u32))
                .collect());
        };
        let Some(restart) = indices.restart() else {
            return Err(self.malformed(place, "its indices are not of an unsigned whole type"));
        };
        let count = topology.triangle_count(indices.count());
        Self::check_corners(topology, indices.count(), place, report);
        self.take(TRIANGLE_BYTES.saturating_mul(count as u64), place)?;
        let mut triangles = Vec::with_capacity(count);
        for triangle in 0..count {
            let corners = topology.corners(triangle).map(|corner| indices.index(corner));
            let at = || format!("{place} triangle {triangle}");
            if corners.contains(&restart) {
                report.skip("triangles with a primitive restart value as an index", at);
            } else if corners.iter().any(|&corner| corner as usize >= vertices) {
                report.skip("triangles with an index out of range", at);
            } else {
                triangles.push(corners);
            }
        }
        Ok(triangles)
    }

    fn check_corners(topology: Topology, corners: usize, place: &str, report: &mut LoadReport) {
        if topology == Topology::List && !corners.is_multiple_of(3) {
            report.skip("ends of triangle lists with fewer than three corners", || place.into());
        }
    }

    /// An attribute that a mesh can do without: one that cannot be read is left out and counted.
    fn attribute<const WIDTH: usize>(
        &self,
        index: Option<u64>,
        vertices: usize,
        what: &str,
        report: &mut LoadReport,
    ) -> Option<Accessor<'b, WIDTH>> {
        match self.open::<WIDTH>(index?) {
            Ok(accessor) if accessor.count() == vertices => Some(accessor),
            Ok(accessor) => {
                let count = accessor.count();
                report.skip(&format!("{what} that are not one a vertex"), || {
                    format!("{count} for {vertices} vertices")
                });
                None
            }
            Err(error) => {
                report.skip(&format!("{what} that cannot be read"), || error.to_string());
                None
            }
        }
    }
}

/// Which vertices of an array a geometry keeps.
#[derive(Debug)]
pub(super) enum Kept {
    /// The first so many: all of them.
    All(usize),
    /// These, in ascending order.
    Some(Vec<u32>),
}

impl Kept {
    /// Chooses the vertices, and makes the triangles' indices lead into them.
    fn of(triangles: &mut [[u32; 3]], vertices: usize) -> Self {
        if vertices <= triangles.len().saturating_mul(3) {
            return Self::All(vertices);
        }
        let mut used: Vec<u32> = triangles.iter().flatten().copied().collect();
        used.sort_unstable();
        used.dedup();
        for corner in triangles.iter_mut().flatten() {
            // Every corner is in the list.
            *corner = used.binary_search(corner).unwrap_or(0) as u32;
        }
        Self::Some(used)
    }

    fn len(&self) -> usize {
        match self {
            Self::All(count) => *count,
            Self::Some(used) => used.len(),
        }
    }

    /// The last vertex that is kept.
    pub(super) fn last(&self) -> Option<usize> {
        match self {
            Self::All(count) => count.checked_sub(1),
            Self::Some(used) => used.last().map(|&vertex| vertex as usize),
        }
    }

    pub(super) fn values<T>(&self, value: impl Fn(usize) -> T) -> Vec<T> {
        match self {
            Self::All(count) => (0..*count).map(value).collect(),
            Self::Some(used) => used.iter().map(|&vertex| value(vertex as usize)).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vertices_that_no_triangle_uses_are_dropped_when_they_are_many() {
        let mut triangles = vec![[70, 3, 9], [9, 3, 50]];
        let kept = Kept::of(&mut triangles, 100);
        assert_eq!(kept.values(|vertex| vertex), [3, 9, 50, 70]);
        assert_eq!(triangles, [[3, 0, 1], [1, 0, 2]]);
        let mut triangles = vec![[0, 1, 2], [2, 1, 5]];
        assert_eq!(Kept::of(&mut triangles, 6).len(), 6);
        assert_eq!(triangles, [[0, 1, 2], [2, 1, 5]]);
        assert_eq!(Kept::of(&mut [], 1 << 30).len(), 0);
    }

    #[test]
    fn the_budget_is_kept_over_all_primitives() {
        let mut budget = Budget::default();
        assert!(budget.take(Budget::ALWAYS, 0).is_ok());
        assert!(budget.take(640, 10).is_ok());
        assert!(budget.take(1, 10).unwrap_err().contains("limit"));
        assert!(Budget::default().take(u64::MAX, 1).is_err());
    }
}
