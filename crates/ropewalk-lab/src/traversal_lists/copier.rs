//! The copy of a structure's lists in memory: what the upload to a device would have to move.

use ropewalk::TraversalList;
use ropewalk::traversal_list::{Element, HeadTable, Identity};

/// Room for a copy, which is made before anything is timed.
pub(super) struct Copier {
    elements: Vec<Element>,
    vertices: Vec<[f32; 3]>,
    identities: Vec<Identity>,
    heads: Vec<u32>,
}

impl Copier {
    pub(super) fn new(list: &TraversalList) -> Self {
        Self {
            elements: list.elements().to_vec(),
            vertices: list.vertices().to_vec(),
            identities: list.identities().to_vec(),
            heads: list.polygon_heads().map_or_else(Vec::new, |heads| heads.heads().to_vec()),
        }
    }

    /// Copies elements, vertices, who the triangles are, and heads of polygons.
    pub(super) fn copy(&mut self, list: &TraversalList) {
        renew(&mut self.elements, list.elements());
        renew(&mut self.vertices, list.vertices());
        renew(&mut self.identities, list.identities());
        renew(&mut self.heads, list.polygon_heads().map_or(&[], HeadTable::heads));
        // The compiler must not find out that nobody reads it.
        std::hint::black_box(&mut *self);
    }

    /// How much it copies.
    pub(super) fn bytes(&self) -> usize {
        size_of_val(self.elements.as_slice())
            + size_of_val(self.vertices.as_slice())
            + size_of_val(self.identities.as_slice())
            + size_of_val(self.heads.as_slice())
    }
}

/// A copy into room that is there.
fn renew<T: Copy>(room: &mut Vec<T>, from: &[T]) {
    room.clear();
    room.extend_from_slice(from);
}

#[cfg(test)]
mod tests {
    use super::*;
    use ropewalk::{ListOptions, Scene};
    use ropewalk_testkit::meshes;

    #[test]
    fn a_copy_is_all_of_it() {
        let options =
            ListOptions { heads: ropewalk::traversal_list::Heads::Simple, ..ListOptions::default() };
        let list = Scene::from_mesh(meshes::icosphere(1)).build_list(&options).unwrap();
        let mut copier = Copier::new(&list);
        copier.elements.clear();
        copier.copy(&list);
        assert_eq!(copier.elements, list.elements());
        assert_eq!(copier.bytes(), list.elements().len() * 20 + 42 * 12 + 80 * 12 + 80 * 8 * 4);
    }
}
