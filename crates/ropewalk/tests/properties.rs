//! Whatever the triangles, the instances and the rays: all walks over all trees answer like brute force, to the
//! bit, and brute force like the oracle.

use glam::{Affine3A, Vec3};
use proptest::prelude::*;
use ropewalk::bvh::LeafOrder;
use ropewalk::{
    BuildOptions, Builder, DeviceKind, Mesh, Query, Ray, Scene, StructureKind, TraceError, TraceOptions,
    Transform, Walk, catalogue, glam,
};
use ropewalk_testkit::compare::{across_queries, against_oracle, same_bits};
use ropewalk_testkit::oracle::Oracle;

/// Mostly from a coarse grid, so that ties, shared edges and rays in faces are common; else anything, NaN included.
fn coordinate() -> impl Strategy<Value = f32> {
    prop_oneof![
        6 => (-4i8..=4).prop_map(|n| f32::from(n) * 0.5),
        3 => -3.0f32..3.0,
        1 => prop_oneof![Just(0.0), Just(-0.0), Just(1e-20), Just(-1e-40), Just(1e9), Just(0.1)],
    ]
}

fn point() -> impl Strategy<Value = Vec3> {
    [coordinate(), coordinate(), coordinate()].prop_map(Vec3::from_array)
}

fn any_number() -> impl Strategy<Value = f32> {
    prop_oneof![10 => coordinate(), 1 => any::<f32>()]
}

fn transform() -> impl Strategy<Value = Transform> {
    (point(), prop::array::uniform9(coordinate())).prop_map(|(offset, columns)| {
        let matrix = glam::Mat3::from_cols_array(&columns);
        Transform::new(Affine3A::from_mat3_translation(matrix, offset)).unwrap_or_default()
    })
}

prop_compose! {
    fn scene()(
        positions in prop::collection::vec(point(), 3..24),
        wild in prop::option::weighted(0.1, (any::<prop::sample::Index>(), any::<f32>())),
        triangles in prop::collection::vec(prop::array::uniform3(0u32..25), 0..60),
        places in prop::collection::vec((transform(), 0u32..512), 0..3),
    ) -> Scene {
        let mut positions = positions;
        if let Some((index, value)) = wild {
            let index = index.index(positions.len());
            positions[index].y = value;
        }
        let mut scene = Scene::from_mesh(Mesh::new(positions, triangles));
        for (place, mask) in places {
            let instance = scene.add_instance(0, place) as usize;
            scene.instances[instance].mask = mask;
        }
        scene
    }
}

prop_compose! {
    fn ray()(
        origin in point(),
        dir in prop::array::uniform3(any_number()),
        window in prop_oneof![
            3 => Just((0.0, f32::INFINITY)),
            1 => (0.0f32..2.0, 0.0f32..4.0),
            1 => (any_number(), any_number()),
        ],
        mask in prop_oneof![4 => Just(0xffu32), 1 => 0u32..512],
    ) -> Ray {
        Ray::new(origin, Vec3::from_array(dir)).window(window.0, window.1).with_mask(mask)
    }
}

fn options() -> impl Strategy<Value = BuildOptions> {
    let limits = (1u32..9, 1u32..20, 2u32..33);
    let builder =
        prop_oneof![1 => Just(Builder::BinnedSah), 1 => Just(Builder::SweepSah), 2 => Just(Builder::Sbvh)];
    let duplication = prop_oneof![Just(0u32), Just(10), Just(400), 0u32..100];
    (limits, builder, duplication, 0u32..3, any::<bool>()).prop_map(
        |((max_leaf, max_depth, bins), builder, duplication, reinsertion, left)| BuildOptions {
            builder,
            max_leaf,
            max_depth,
            bins,
            duplication,
            reinsertion,
            leaf_order: if left { LeafOrder::Left } else { LeafOrder::Split },
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1500, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn all_walks_answer_like_brute_force(
        scene in scene(),
        rays in prop::collection::vec(ray(), 1..24),
        options in options(),
    ) {
        let bvh = scene.build(&options).unwrap();
        bvh.validate().map_err(|error| TestCaseError::fail(error.to_string()))?;
        let other = scene.build(&BuildOptions::default()).unwrap();
        let expectation = Oracle::of_scene(&scene).unwrap().expect(rays.clone());
        let counters = TraceOptions { counters: true };
        for query in Query::EVERY {
            let reference = bvh.trace(Walk::BruteForce, query, &rays, counters).unwrap();
            against_oracle(&expectation, &reference).map_err(|error| TestCaseError::fail(error.to_string()))?;
            for walk in Walk::EVERY {
                if catalogue::check(StructureKind::Bvh, walk, query, DeviceKind::Cpu).is_ok() {
                    for tree in [&bvh, &other] {
                        let traced = match tree.trace(walk, query, &rays, counters) {
                            Err(TraceError::TooDeep { limit, .. }) if tree.report().depth > limit => continue,
                            traced => traced.unwrap(),
                        };
                        same_bits(&rays, &reference, &traced, false)
                            .map_err(|error| TestCaseError::fail(format!("{walk}: {error}")))?;
                    }
                }
            }
        }
        let all = Query::EVERY.map(|query| bvh.trace(Walk::default(), query, &rays, counters).unwrap());
        across_queries(&rays, &all.each_ref()).map_err(|error| TestCaseError::fail(error.to_string()))?;
    }
}
