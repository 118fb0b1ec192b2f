//! Walks with known faults, which a comparison of hits must find out (ALGORITHMS: C6), and rays that show them.

use super::support::{blocks, builds};
use ropewalk::aabb::{PAD_ENTRY, PAD_EXIT, slab_test};
use ropewalk::bvh::walk::{ClosestHit, Collect, Summary, Visitor};
use ropewalk::glam::Vec3;
use ropewalk::kd_tree::walk::{Course, KdWalk, ReferenceVisitor, Restart, Ropes, Stack};
use ropewalk::kd_tree::{KdPlace, OUTSIDE};
use ropewalk::{KdTree, NoProbe, PreparedRay, Ray, Scene};
use ropewalk_testkit::random::Random;

/// None.
const SOUND: u8 = 0;
/// Ends at the first leaf with a hit.
const FIRST_LEAF: u8 = 1;
/// Takes the near child alone where the ray begins on the plane.
const NEAR_ON_PLANE: u8 = 2;
/// Ends, rather than goes on with the next entry, where an entry is culled.
const ENDS_AT_CULL: u8 = 3;
/// Compares without padding.
const NO_PADDING: u8 = 4;
/// In a plane takes the near child alone.
const NEAR_IN_PLANE: u8 = 5;

/// The stack walk with a fault.
#[derive(Clone, Copy)]
struct Faulty<const FAULT: u8>;

/// Near and far child, where the near one ends, and where the far one begins.
fn crossing(tree: &KdTree, index: u32, ray: &PreparedRay, pads: [f32; 2]) -> (u32, u32, f32, f32) {
    let node = tree.nodes()[index as usize];
    let (axis, inverse) = (node.axis(), ray.inverse[node.axis()]);
    let low = (node.split() - ray.origin_low[axis]) * inverse;
    let high = (node.split() - ray.origin_high[axis]) * inverse;
    if inverse < 0.0 {
        (node.upper(), index + 1, low * pads[1], high * pads[0])
    } else {
        (index + 1, node.upper(), high * pads[1], low * pads[0])
    }
}

fn whole(tree: &KdTree, ray: &PreparedRay) -> (f32, f32) {
    let span = slab_test(ray, tree.bounds().min.extend(1.0), tree.bounds().max.extend(1.0), ray.t_max);
    (span.entry, span.exit)
}

impl<const FAULT: u8> KdWalk for Faulty<FAULT> {
    fn walk<V: Visitor>(self, tree: &KdTree, ray: &PreparedRay, visitor: &mut V) -> Course {
        let pads = if FAULT == NO_PADDING { [1.0, 1.0] } else { [PAD_ENTRY, PAD_EXIT] };
        let (enter, exit) = whole(tree, ray);
        let mut stack = vec![(0, enter, exit)];
        while let Some((mut current, mut enter, mut exit)) = stack.pop() {
            if enter > visitor.t_max() {
                if FAULT == ENDS_AT_CULL {
                    return Course::Own;
                }
                continue;
            }
            if enter > exit {
                continue;
            }
            while !tree.nodes()[current as usize].is_leaf() {
                let (near, far, near_exit, far_entry) = crossing(tree, current, ray, pads);
                let axis = tree.nodes()[current as usize].axis();
                let split = tree.nodes()[current as usize].split();
                let is_parallel = ray.origin_low[axis] != ray.origin_high[axis];
                let on_plane = ray.origin[axis] == split;
                let near_alone = on_plane
                    && ((FAULT == NEAR_ON_PLANE && !is_parallel) || (FAULT == NEAR_IN_PLANE && is_parallel));
                let (near_exit, far_enter) = (exit.min(near_exit), enter.max(far_entry));
                if near_alone {
                    current = near;
                } else if enter > near_exit {
                    (current, enter) = (far, far_enter);
                } else {
                    if far_enter <= exit {
                        stack.push((far, far_enter, exit));
                    }
                    (current, exit) = (near, near_exit);
                }
            }
            let leaf = tree.nodes()[current as usize];
            let before = visitor.t_max();
            if visitor.leaf(leaf.first(), leaf.count()).is_break()
                || (FAULT == FIRST_LEAF && visitor.t_max() < before)
            {
                return Course::Own;
            }
        }
        Course::Own
    }
}

/// kd-restart, without asking whether the next leaf is certain.
#[derive(Clone, Copy)]
struct HastyRestart;

impl KdWalk for HastyRestart {
    fn walk<V: Visitor>(self, tree: &KdTree, ray: &PreparedRay, visitor: &mut V) -> Course {
        let (first, last) = whole(tree, ray);
        let mut done = f32::NEG_INFINITY;
        // More leaves than any ray meets.
        for _ in 0..2000 {
            let (mut current, mut enter, mut exit) = (0, first, last);
            while !tree.nodes()[current as usize].is_leaf() {
                let (near, far, near_exit, far_entry) = crossing(tree, current, ray, [PAD_ENTRY, PAD_EXIT]);
                if enter > near_exit || (near_exit <= done && far_entry <= exit) {
                    (current, enter) = (far, enter.max(far_entry));
                } else {
                    (current, exit) = (near, exit.min(near_exit));
                }
            }
            let leaf = tree.nodes()[current as usize];
            if enter > visitor.t_max() || visitor.leaf(leaf.first(), leaf.count()).is_break() || exit >= last
            {
                break;
            }
            done = exit;
        }
        Course::Own
    }
}

/// Ropes, without asking whether the next leaf is certain.
#[derive(Clone, Copy)]
struct HastyRopes;

impl KdWalk for HastyRopes {
    fn walk<V: Visitor>(self, tree: &KdTree, ray: &PreparedRay, visitor: &mut V) -> Course {
        let (mut at, mut current) = (whole(tree, ray).0, 0);
        for _ in 0..2000 {
            while !tree.nodes()[current as usize].is_leaf() {
                let (near, far, near_exit, _) = crossing(tree, current, ray, [PAD_ENTRY, PAD_EXIT]);
                current = if near_exit <= at { far } else { near };
            }
            let leaf = tree.nodes()[current as usize];
            if at * PAD_ENTRY > visitor.t_max() || visitor.leaf(leaf.first(), leaf.count()).is_break() {
                break;
            }
            let place: KdPlace = tree.places()[current as usize];
            let exits = (0..3).map(|axis| {
                let upper = ray.inverse[axis] >= 0.0;
                let exit = if upper {
                    (place.max[axis] - ray.origin_high[axis]) * ray.inverse[axis]
                } else {
                    (place.min[axis] - ray.origin_low[axis]) * ray.inverse[axis]
                };
                (exit * PAD_EXIT, 2 * axis + usize::from(upper))
            });
            let Some((exit, face)) = exits.min_by(|a, b| a.0.total_cmp(&b.0)) else { break };
            at = exit;
            current = tree.ropes()[place.leaf as usize][face];
            if current == OUTSIDE || at >= ray.t_max {
                break;
            }
        }
        Course::Own
    }
}

fn hit<W: KdWalk>(tree: &KdTree, walk: W, ray: &PreparedRay) -> [u32; 7] {
    let mut visitor = ReferenceVisitor { tree, ray, collect: ClosestHit::new(ray), probe: NoProbe };
    walk.walk(tree, ray, &mut visitor);
    visitor.collect.answer().to_words()
}

fn by_force(tree: &KdTree, ray: &PreparedRay) -> [u32; 7] {
    let mut closest = ClosestHit::new(ray);
    for triangle in tree.triangles() {
        if let Some(hit) = triangle.intersect(ray, closest.t_max()) {
            let _ = closest.offer(hit);
        }
    }
    closest.answer().to_words()
}

fn tree() -> KdTree {
    Scene::from_mesh(blocks()).build_kd(&builds()[1]).unwrap()
}

/// In planes, from planes, and through the corners of blocks.
fn awkward() -> Vec<PreparedRay> {
    let mut random = Random::new(3);
    let mut ray = |index: usize| {
        let corner = (random.in_cube() * 5.0).round().as_vec3();
        let dir = match index % 4 {
            0 => Vec3::AXES[index / 4 % 3],
            1 => Vec3::new(1.0, 1.0, -1.0),
            2 => Vec3::new(-1.0, 0.0, 1.0),
            _ => random.direction().as_vec3(),
        };
        let back = [0.0, 1.0, 7.5, 20.0][index / 7 % 4];
        PreparedRay::new(&Ray::new(corner - dir * back, dir)).unwrap()
    };
    (0..4000).map(&mut ray).collect()
}

/// How many rays lose their hit.
fn lost<W: KdWalk>(walk: W) -> usize {
    let tree = tree();
    awkward().iter().filter(|ray| hit(&tree, walk, ray) != by_force(&tree, ray)).count()
}

#[test]
fn walks_with_known_faults_are_found_out() {
    assert_eq!(lost(Faulty::<SOUND>), 0, "the scaffold itself is sound");
    assert_eq!((lost(Stack), lost(Restart), lost(Ropes)), (0, 0, 0));
    let faulty = [
        ("ends at the first leaf with a hit", lost(Faulty::<FIRST_LEAF>)),
        ("near alone from the plane", lost(Faulty::<NEAR_ON_PLANE>)),
        ("near alone in the plane", lost(Faulty::<NEAR_IN_PLANE>)),
        ("ends where an entry is culled", lost(Faulty::<ENDS_AT_CULL>)),
        ("no padding", lost(Faulty::<NO_PADDING>)),
        ("a hasty restart", lost(HastyRestart)),
        ("hasty ropes", lost(HastyRopes)),
    ];
    println!("lost of 4000: {faulty:?}");
    for (fault, lost) in faulty {
        assert!(lost > 0, "{fault} was not found out");
    }
}

/// Rays that show what certainty is for: in a plane, through corners of blocks, and through edges.
#[test]
fn rays_that_are_lost_without_certainty() {
    let tree = tree();
    let ray =
        |origin: [f32; 3], dir: [f32; 3]| PreparedRay::new(&Ray::new(origin.into(), dir.into())).unwrap();
    let lost_by_restart = [
        ray([0.0, -1.0, -24.0], [0.0, 0.0, 1.0]),
        ray([-6.5, -4.5, 7.5], [1.0, 1.0, -1.0]),
        ray([3.0, 4.0, 2.0], [-1.0, 0.0, 1.0]),
    ];
    let lost_by_ropes = [
        ray([-1.0, 4.0, 0.0], [1.0, 0.0, 0.0]),
        ray([-20.0, -23.0, 18.0], [1.0, 1.0, -1.0]),
        ray([5.5, -3.0, -8.5], [-1.0, 0.0, 1.0]),
    ];
    for ray in lost_by_restart {
        assert_ne!(hit(&tree, HastyRestart, &ray), by_force(&tree, &ray));
        assert_eq!(hit(&tree, Restart, &ray), by_force(&tree, &ray));
    }
    for ray in lost_by_ropes {
        assert_ne!(hit(&tree, HastyRopes, &ray), by_force(&tree, &ray));
        assert_eq!(hit(&tree, Ropes, &ray), by_force(&tree, &ray));
    }
}

/// The hasty walks are right where nothing is in doubt: it is the doubt that makes them wrong.
#[test]
fn haste_does_no_harm_to_plain_rays() {
    let tree = tree();
    let mut random = Random::new(4);
    for _ in 0..2000 {
        let (origin, dir) = (random.in_cube() * 12.0, random.direction());
        let ray = PreparedRay::new(&Ray::new(origin.as_vec3(), dir.as_vec3())).unwrap();
        let expected = by_force(&tree, &ray);
        assert_eq!((hit(&tree, HastyRestart, &ray), hit(&tree, HastyRopes, &ray)), (expected, expected));
    }
}
