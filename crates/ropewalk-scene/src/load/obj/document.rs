//! What an OBJ file says, before anything is made of it.

use crate::LoadReport;
use glam::{DVec3, Vec2, Vec3};
use std::collections::HashSet;

/// An index that is not there.
pub(super) const NONE: u32 = u32::MAX;

/// The statements of a file.
#[derive(Debug, Default)]
pub(super) struct Document {
    pub(super) positions: Vec<DVec3>,
    /// Positions whose numbers could not be read.
    pub(super) unreadable: HashSet<u32>,
    pub(super) normals: Vec<Vec3>,
    pub(super) texture_coordinates: Vec<Vec2>,
    /// The corners of all faces, face after face.
    pub(super) corners: Vec<Corner>,
    pub(super) faces: Vec<Face>,
    /// The names of the objects that have faces.
    pub(super) objects: Vec<String>,
    /// The names that `usemtl` used before a face.
    pub(super) materials: Vec<String>,
    /// What stands behind each `mtllib`.
    pub(super) libraries: Vec<String>,
    pub(super) report: LoadReport,
}

/// A corner of a face: indices from 0, not yet checked to be there; [`NONE`] where the file gives none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Corner {
    pub(super) vertex: u32,
    pub(super) texture_coordinate: u32,
    pub(super) normal: u32,
}

/// A polygon of at least three corners.
#[derive(Clone, Copy, Debug)]
pub(super) struct Face {
    /// Where its corners end; they begin where those of the face before end.
    pub(super) end: usize,
    pub(super) line: usize,
    /// An index into [`Document::objects`].
    pub(super) object: u32,
    /// An index into [`Document::materials`], or [`NONE`].
    pub(super) material: u32,
}

impl Document {
    /// Each face with its corners.
    pub(super) fn faces(&self) -> impl Iterator<Item = (&Face, &[Corner])> {
        let mut start = 0;
        self.faces.iter().map(move |face| {
            let corners = self.corners.get(start..face.end).unwrap_or_default();
            start = face.end;
            (face, corners)
        })
    }
}
