//! The vertices that all lists share: each vertex of each mesh of each instance once, as far as triangles use it.
//!
//! By index and not by place: two vertices in one place may part when the scene moves ([`super::update`]).

use crate::{FlatTriangle, Scene};

/// A vertex that no triangle has used yet.
const UNUSED: u32 = u32::MAX;

/// The vertices of triangles of a scene, and for each triangle which are its own.
pub(super) fn share(scene: &Scene, triangles: &[FlatTriangle]) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    let mut vertices = Vec::new();
    let mut corners = Vec::with_capacity(triangles.len());
    // Where the vertices of the present mesh went. Only what was used is cleared, so that many instances of a large mesh
    // of which they show little take no longer than they should.
    let mut places: Vec<u32> = Vec::new();
    let mut used: Vec<u32> = Vec::new();
    for part in triangles.chunk_by(|a, b| (a.instance(), a.geometry()) == (b.instance(), b.geometry())) {
        let mesh = mesh_of(scene, &part[0]);
        for index in used.drain(..) {
            places[index as usize] = UNUSED;
        }
        for triangle in part {
            let indices = mesh.and_then(|mesh| mesh.triangles.get(triangle.primitive as usize));
            let positions = [triangle.v0, triangle.v1, triangle.v2];
            let mut own = [0; 3];
            for (corner, (own, position)) in own.iter_mut().zip(positions).enumerate() {
                // A triangle that is not the scene's, which cannot be, would get vertices of its own.
                let place = indices.map(|indices| indices[corner] as usize);
                if let Some(place) = place {
                    if places.len() <= place {
                        places.resize(place + 1, UNUSED);
                    }
                    if places[place] != UNUSED {
                        *own = places[place];
                        continue;
                    }
                    places[place] = vertices.len() as u32;
                    used.push(place as u32);
                }
                *own = vertices.len() as u32;
                vertices.push(position);
            }
            corners.push(own);
        }
    }
    (vertices, corners)
}

fn mesh_of<'a>(scene: &'a Scene, triangle: &FlatTriangle) -> Option<&'a crate::Mesh> {
    let instance = scene.instances.get(triangle.instance() as usize)?;
    scene.objects.get(instance.object as usize)?.geometries.get(triangle.geometry() as usize)
}
