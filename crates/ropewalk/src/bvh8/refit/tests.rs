//! Parts are cut by numbers of nodes alone, so that not only corners and boxes but sums, too, are the same for any number of threads.

use super::BLOCKS;
use crate::bvh8::Preset;
use crate::{Bvh8Options, Mesh, Scene};
use glam::Vec3;

/// Triangles here and there, of several sizes; `phase` bends them.
fn soup(triangles: u16, phase: f32) -> Scene {
    let mut mesh = Mesh::default();
    for index in 0..triangles {
        let step = f32::from(index);
        let place = Vec3::new((step * 0.37).sin(), (step * 0.71).cos(), (step * 0.013 + phase).sin());
        let size = 0.02 + 0.1 * (step * 1.7 + phase).cos().abs();
        let first = mesh.positions.len() as u32;
        mesh.positions.extend([Vec3::X, Vec3::Y, Vec3::Z].map(|corner| place * 3.0 + corner * size));
        mesh.triangles.push([first, first + 1, first + 2]);
    }
    Scene::from_mesh(mesh)
}

#[test]
fn any_number_of_threads_makes_the_same_bytes() {
    let (scene, moved) = (soup(60_000, 0.0), soup(60_000, 0.8));
    for preset in Preset::EVERY.into_iter().filter(|preset| preset.can_refit()) {
        let built = scene.build_packed(&Bvh8Options { preset, level: None }).unwrap();
        assert!(built.blocks.len() > 2 * BLOCKS, "{preset:?}: {} blocks", built.blocks.len());
        let refitted = |threads| {
            let mut tree = built.clone();
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let cost = pool.install(|| tree.refit(&moved)).unwrap().cost;
            (tree.arena.words().to_vec(), tree.bounds(), tree.report().input, cost.to_bits())
        };
        let of_one = refitted(1);
        assert!(of_one.0 != built.arena.words());
        for threads in [2, 3] {
            assert!(refitted(threads) == of_one, "{preset:?}: {threads} threads");
        }
    }
}
