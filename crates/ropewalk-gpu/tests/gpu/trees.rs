//! Trees that no builder makes: chains of an exact depth, binary and wide; and wide trees of the usual scenes.

use crate::rays::Random;
use crate::scenes::{Case, instances, lattice, soup, sphere};
use ropewalk::bvh::{Builder, Node};
use ropewalk::wide_bvh::{Collapse, EMPTY, WideOptions, Width};
use ropewalk::{Aabb, BuildOptions, Bvh, FlatTriangle, Mesh, Scene, Structure, WideBvh, glam::Vec3};

/// Deep binary trees: one for each register at its limit, and one a level deeper than 32 bits.
pub(crate) fn chains() -> Vec<Case> {
    let case = |name, bvh| Case { name, structure: Structure::Bvh(bvh) };
    vec![
        case("chain of depth 31", chain(31)),
        case("chain of depth 32", chain(32)),
        case("chain of depth 63", chain(63)),
        case("two chains of depth 63", two_chains(63)),
        case("chain of depth 64", chain(64)),
    ]
}

/// Binary trees with spatial splits: triangles stand in several leaves.
pub(crate) fn split() -> Vec<Case> {
    let options = BuildOptions { builder: Builder::Sbvh, max_leaf: 2, ..BuildOptions::default() };
    let bvh = Scene::from_mesh(soup(400)).build(&options).unwrap();
    assert!(bvh.has_repeats(), "no triangle was split");
    vec![Case { name: "soup with spatial splits", structure: Structure::Bvh(bvh) }]
}

/// Wide trees: of usual scenes, with spatial splits, and chains at the limits of the registers.
pub(crate) fn wide(width: Width) -> Vec<Case> {
    let plain = WideOptions { width, ..WideOptions::default() };
    let leaves = |max_leaf| BuildOptions { max_leaf, ..BuildOptions::default() };
    let sbvh = BuildOptions { builder: Builder::Sbvh, ..leaves(2) };
    let case = |name, scene: Scene, build, collapse| Case {
        name,
        structure: Structure::WideBvh(scene.build_wide(&WideOptions { build, collapse, ..plain }).unwrap()),
    };
    let chain = |name, levels| Case { name, structure: Structure::WideBvh(wide_chain(width, levels)) };
    let parted = |name, stem, levels| Case {
        name,
        structure: Structure::WideBvh(parted_wide_chain(width, stem, levels)),
    };
    vec![
        case("empty", Scene::default(), leaves(4), Collapse::Area),
        case("one leaf", Scene::from_mesh(soup(2)), leaves(4), Collapse::Area),
        case("soup", Scene::from_mesh(soup(400)), leaves(1), Collapse::Area),
        case("lattice", Scene::from_mesh(lattice()), leaves(2), Collapse::Sah),
        case("sphere", Scene::from_mesh(sphere(16)), leaves(4), Collapse::Sah),
        case("instances", instances(), leaves(4), Collapse::Area),
        case("soup with spatial splits", Scene::from_mesh(soup(400)), sbvh, Collapse::Area),
        // In the upper and in the lower word of 16 levels.
        parted("wide chain of 16 levels, parted early", 3, 16),
        parted("wide chain of 16 levels, parted late", 9, 16),
        parted("wide chain of 17 levels, parted", 5, 17),
        chain("wide chain of 64 levels", 64),
    ]
}

/// Large triangles all over each other, so that a ray hits most boxes of a chain.
fn triangles(count: usize) -> Vec<FlatTriangle> {
    let mut random = Random::new(count as u64);
    let mut mesh = Mesh::default();
    for index in 0..count as u32 {
        let center = random.vector() * 0.5;
        mesh.positions.extend([(); 3].map(|()| center + random.vector() * Vec3::new(0.8, 0.7, 0.6)));
        mesh.triangles.push([3 * index, 3 * index + 1, 3 * index + 2]);
    }
    Scene::from_mesh(mesh).flatten().unwrap().triangles
}

fn bounds(triangles: &[FlatTriangle]) -> Aabb {
    triangles.iter().map(|triangle| triangle.triangle().bounds()).fold(Aabb::EMPTY, Aabb::union)
}

fn leaf(triangles: &[FlatTriangle], index: usize) -> Node {
    Node::leaf(&triangles[index].triangle().bounds(), index as u32, 1)
}

/// A binary tree in which each inner node has a leaf, first or second, down to this depth.
pub(crate) fn chain(depth: u32) -> Bvh {
    let triangles = triangles(depth as usize + 1);
    let mut nodes = Vec::new();
    append_chain(&mut nodes, &triangles, 0, depth);
    in_leaf_order(nodes, &triangles)
}

/// A root with two chains below: what is known of the levels of the one must be forgotten in the other.
fn two_chains(depth: u32) -> Bvh {
    let triangles = triangles(2 * depth as usize);
    let mut nodes = vec![Node::inner(&bounds(&triangles), 2 * depth)];
    append_chain(&mut nodes, &triangles, 0, depth - 1);
    append_chain(&mut nodes, &triangles, depth as usize, depth - 1);
    in_leaf_order(nodes, &triangles)
}

/// Appends a chain over the triangles from `first` on.
fn append_chain(nodes: &mut Vec<Node>, triangles: &[FlatTriangle], first: usize, depth: u32) {
    let mut random = Random::new(first as u64 + 3);
    let end = first + depth as usize;
    let leaf_first: Vec<bool> = (0..depth).map(|_| random.below(2) == 0).collect();
    for (level, &leaf_is_first) in leaf_first.iter().enumerate() {
        let here = nodes.len() as u32;
        // A leaf, or all that is below this level, comes before the second child.
        let between = if leaf_is_first { 1 } else { 2 * (depth - level as u32) - 1 };
        nodes.push(Node::inner(&bounds(&triangles[first + level..=end]), here + 1 + between));
        if leaf_is_first {
            nodes.push(leaf(triangles, first + level));
        }
    }
    nodes.push(leaf(triangles, end));
    let behind = leaf_first.iter().enumerate().rev().filter(|(_, leaf_is_first)| !**leaf_is_first);
    nodes.extend(behind.map(|(level, _)| leaf(triangles, first + level)));
}

/// A valid tree has its triangles in the order of its leaves.
fn in_leaf_order(mut nodes: Vec<Node>, triangles: &[FlatTriangle]) -> Bvh {
    let mut ordered = Vec::with_capacity(triangles.len());
    for node in nodes.iter_mut().filter(|node| node.is_leaf()) {
        ordered.push(triangles[node.link as usize]);
        node.link = ordered.len() as u32 - 1;
    }
    Bvh::from_parts(nodes, ordered).unwrap()
}

/// How many leaves a node of a wide chain has, beside its inner child.
#[derive(Clone, Copy)]
pub(crate) enum Leaves {
    /// As many as there is room for.
    All,
    /// One or two, so that walks with many restarts are short enough for a driver that counts iterations.
    Few,
}

/// A wide tree of so many levels in which each node has one inner child, in any place, and few leaves besides.
pub(crate) fn wide_chain(width: Width, levels: u32) -> WideBvh {
    wide_chain_with(width, levels, Leaves::Few)
}

/// The same with any number of leaves.
pub(crate) fn wide_chain_with(width: Width, levels: u32, leaves: Leaves) -> WideBvh {
    let mut chain = WideChain::new(width, leaves, levels);
    chain.append(0, levels);
    chain.finish()
}

/// A chain that parts into two below `stem` levels: what is known of the levels of the one must be forgotten in the
/// other.
fn parted_wide_chain(width: Width, stem: u32, levels: u32) -> WideBvh {
    let mut chain = WideChain::new(width, Leaves::Few, 2 * levels);
    let branch = levels - stem - 1;
    for _ in 0..stem {
        chain.node(&[None, Some(chain.wide_nodes() + 1)]);
    }
    let fork = chain.wide_nodes();
    chain.node(&[Some(fork + 1), Some(fork + 1 + branch)]);
    chain.append(stem + 1, levels);
    chain.append(stem + 1, levels);
    chain.finish()
}

/// A wide tree in the making.
struct WideChain {
    width: Width,
    leaves: Leaves,
    random: Random,
    triangles: Vec<FlatTriangle>,
    places: Vec<Node>,
    /// Triangles in leaves.
    used: usize,
}

impl WideChain {
    fn new(width: Width, leaves: Leaves, most_levels: u32) -> Self {
        let triangles = triangles(most_levels as usize * width.children());
        Self { width, leaves, random: Random::new(5), triangles, places: Vec::new(), used: 0 }
    }

    fn wide_nodes(&self) -> u32 {
        (self.places.len() / self.width.children()) as u32
    }

    /// A node with these children: inner ones with their nodes, or leaves.
    fn node(&mut self, children: &[Option<u32>]) {
        for child in children {
            self.places.push(match *child {
                Some(node) => Node::inner(&Aabb::EMPTY, node),
                None => {
                    self.used += 1;
                    leaf(&self.triangles, self.used - 1)
                }
            });
        }
        let nothing = Node { count: 0, link: EMPTY, ..Node::inner(&Aabb::new(Vec3::ZERO, Vec3::ZERO), 0) };
        self.places.resize(self.places.len().next_multiple_of(self.width.children()), nothing);
    }

    /// The levels of a chain from `first` on.
    fn append(&mut self, first: u32, end: u32) {
        for level in first..end {
            let is_last = level + 1 == end;
            let leaves = match self.leaves {
                Leaves::Few => 1 + level as usize % 2,
                Leaves::All => self.width.children() - usize::from(!is_last),
            };
            let mut children = vec![None; leaves];
            if !is_last {
                children.insert(self.random.below(leaves + 1), Some(self.wide_nodes() + 1));
            }
            self.node(&children);
        }
    }

    /// The tree, with the boxes of its inner nodes: children come after their parents.
    fn finish(mut self) -> WideBvh {
        let children = self.width.children();
        self.triangles.truncate(self.used);
        for place in (0..self.places.len()).rev() {
            let Node { link, count, .. } = self.places[place];
            if count == 0 && link != EMPTY {
                let below = &self.places[link as usize * children..][..children];
                let holds = |node: &&Node| node.count != 0 || node.link != EMPTY;
                let bounds = below.iter().filter(holds).map(Node::bounds).fold(Aabb::EMPTY, Aabb::union);
                self.places[place] = Node::inner(&bounds, link);
            }
        }
        WideBvh::from_parts(self.width, self.places, self.triangles).unwrap()
    }
}

/// The trees are as deep as their names say, and have all that a chain has.
#[test]
fn chains_are_as_deep_as_they_are_called() {
    for depth in [2, 31, 63, 64] {
        assert_eq!((chain(depth).report().depth, chain(depth).report().leaves), (depth, depth as usize + 1));
        assert_eq!(
            (two_chains(depth).report().depth, two_chains(depth).report().leaves),
            (depth, 2 * depth as usize)
        );
        for width in [Width::Four, Width::Eight] {
            let full = wide_chain_with(width, depth, Leaves::All);
            let stack = depth * (width.children() as u32 - 1);
            assert_eq!((full.report().depth, full.stack_entries()), (depth, stack));
            assert_eq!(wide_chain(width, depth).report().depth, depth);
            assert_eq!(parted_wide_chain(width, depth - 2, depth).report().depth, depth);
        }
    }
}
