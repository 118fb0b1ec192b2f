//! Validation objects to what breaks a rule of compact trees.

use crate::bvh8::{Bvh8, Form, Preset};
use crate::{Bvh8Options, Mesh, Scene};
use glam::Vec3;

/// A fan around an axis: every triangle shares vertices with its neighbours.
fn fan() -> Bvh8 {
    let mut mesh = Mesh::new(vec![Vec3::new(0.3, 0.1, 0.5)], Vec::new());
    for index in 0..60u8 {
        let turn = f32::from(index) * 0.1;
        mesh.positions.push(Vec3::new(turn.cos(), turn.sin(), 0.02 * f32::from(index)));
        if index > 0 {
            mesh.triangles.push([0, u32::from(index), u32::from(index) + 1]);
        }
    }
    let options = Bvh8Options { preset: Preset::Compact, level: None };
    Scene::from_mesh(mesh).build_packed(&options).unwrap()
}

/// What validation says of a tree of which a word has been changed.
fn spoilt(spoil: impl Fn(&mut [u32], usize)) -> String {
    let mut tree = fan();
    assert_eq!(tree.validate(), Ok(()));
    let Form::Compact { vertices, count } = tree.form else { panic!("the tree is not compact") };
    assert_eq!(count, 61);
    spoil(tree.arena.words_mut(), vertices);
    tree.validate().unwrap_err().what
}

#[test]
fn every_fault_is_seen() {
    // The root's steps are the fourth word; the smallest of all makes boxes of nothing.
    let narrow = spoilt(|words, _| words[3] = 108 | 108 << 10 | 108 << 20);
    assert!(narrow.contains("leaves"), "{narrow}");
    // A vertex far away.
    let far = spoilt(|words, vertices| words[vertices] = 1e3f32.to_bits());
    assert!(far.contains("leaves"), "{far}");
    // In the place of another.
    let twice = spoilt(|words, vertices| words.copy_within(vertices + 3..vertices + 6, vertices));
    assert!(twice.contains("twice") || twice.contains("leaves"), "{twice}");
    // The first leaf of the root lies right behind it: its first triangle begins in the middle of a vertex.
    let between = spoilt(|words, _| words[32] += 1);
    assert!(between.contains("none"), "{between}");
    // Its order, of which the first two lines' last eight words are made.
    let order = spoilt(|words, _| words[24] = words[25]);
    assert!(order.contains("order"), "{order}");
}
