//! The deepest wide trees there can be, and the most that a stack can be asked for.

use crate::recorder::{Shorten, record};
use crate::scenes::across;
use glam::Vec3;
use ropewalk::bvh::Node;
use ropewalk::catalogue::{TrailOptions, TrailRegister};
use ropewalk::wide_bvh::walk::{ArrayTrail, BruteForce, Ordered, RestartTrail, Trail, TrailU64};
use ropewalk::wide_bvh::{MAX_LEVELS, WideBvh, Width};
use ropewalk::{Aabb, PreparedRay, Query, Ray, TraceError, TraceOptions, Walk, glam};

/// Wide nodes in each other, each with `leaves` leaves and, but for the last, one inner child. Along x the inner child
/// comes first and the leaves behind it, so that a ray in that direction postpones them all.
fn nest(width: Width, levels: u32, leaves: u32) -> WideBvh {
    let most = levels * leaves;
    let slab =
        |from: u32, to: u32| Aabb::new(Vec3::new(from as f32, -1.0, -1.0), Vec3::new(to as f32, 1.0, 1.0));
    let (mut children, mut triangles) = (Vec::new(), Vec::new());
    for level in 0..levels {
        // The leaves of this level lie behind all of the deeper ones.
        let behind = most - (level + 1) * leaves;
        let first = children.len();
        for leaf in 0..leaves {
            let (x, triangle) = (behind + leaf, triangles.len() as u32);
            triangles.push(across(x as f32, triangle));
            children.push(Node::leaf(&slab(x, x), triangle, 1));
        }
        if level + 1 < levels {
            children.push(Node { link: level + 1, ..Node::inner(&slab(0, behind - 1), 0) });
        }
        children.resize(first + width.children(), Node { link: 0, ..Node::inner(&slab(0, 0), 0) });
    }
    WideBvh::from_parts(width, children, triangles).unwrap()
}

fn ray(dir: Vec3) -> PreparedRay {
    PreparedRay::new(&Ray::new(Vec3::new(-1.0, 0.0, 0.0) * dir.x.signum() * 1000.0, dir)).unwrap()
}

#[test]
fn the_deepest_tree_is_walked_with_every_stack() {
    for (width, leaves) in [(Width::Four, 1), (Width::Four, 3), (Width::Eight, 7)] {
        let bvh = nest(width, MAX_LEVELS, leaves);
        // The deepest node has no inner child, and one of its leaves does not wait.
        let entries = MAX_LEVELS * leaves - 1;
        assert_eq!((bvh.report().depth, bvh.stack_entries()), (MAX_LEVELS, entries));
        for dir in [Vec3::X, Vec3::NEG_X] {
            let ray = ray(dir);
            // Without hits that shorten the ray every leaf is entered.
            let all = Ray::new(Vec3::new(-1000.0, 0.0, 0.0) * dir.x, dir);
            let options = TraceOptions { counters: true };
            let traced = bvh.trace(Walk::default(), Query::Count, &[all], options).unwrap();
            assert_eq!(traced.answer, ropewalk::Answer::Count(vec![MAX_LEVELS * leaves]));
            let counters = traced.counters.unwrap()[0];
            assert_eq!((counters.inner_visits, counters.leaf_visits), (MAX_LEVELS, MAX_LEVELS * leaves));
            if dir == Vec3::X {
                assert_eq!(counters.stack_depth, entries, "more than the stack keeps in place");
            }
            for short_stack in 0..=TrailOptions::MAX_SHORT_STACK {
                let walk = Walk::RestartTrail(TrailOptions { short_stack, ..TrailOptions::default() });
                let given = bvh.trace(walk, Query::Count, &[all], options).unwrap();
                assert_eq!(given.answer, traced.answer, "{short_stack}");
                let counted = given.counters.unwrap()[0];
                assert_eq!(counted.leaf_visits, counters.leaf_visits);
            }
            let full = record(&bvh, Ordered, &ray, Shorten::Hits);
            let trail = record(&bvh, RestartTrail::<ArrayTrail, 512>::new(512), &ray, Shorten::Hits);
            assert_eq!(trail, full);
            assert_eq!(full.0, record(&bvh, BruteForce, &ray, Shorten::Hits).0);
        }
    }
}

#[test]
fn a_register_that_is_too_small_is_refused_or_replaced() {
    let walk = |register| Walk::RestartTrail(TrailOptions { register, ..TrailOptions::default() });
    for levels in [1, 2, 15, 16, 17, 63, 64] {
        let bvh = nest(Width::Four, levels, 2);
        let along = Ray::new(Vec3::new(-1.0, 0.0, 0.0), Vec3::X);
        let trace = |register| bvh.trace(walk(register), Query::Count, &[along], TraceOptions::default());
        for register in [TrailRegister::Auto, TrailRegister::Array] {
            assert_eq!(trace(register).unwrap().answer, ropewalk::Answer::Count(vec![levels * 2]));
        }
        if levels <= TrailU64::LEVELS {
            assert_eq!(trace(TrailRegister::U64), trace(TrailRegister::Auto));
        } else {
            let expected = TraceError::too_deep(walk(TrailRegister::U64), levels, 16);
            assert_eq!(trace(TrailRegister::U64), Err(expected));
        }
        // Asked for by name of the type, it makes way for the array.
        let full = record(&bvh, Ordered, &ray(Vec3::X), Shorten::Hits);
        let trail = RestartTrail::<TrailU64, 512>::new(512);
        assert_eq!(record(&bvh, trail, &ray(Vec3::X), Shorten::Hits), full, "{levels}");
    }
}
