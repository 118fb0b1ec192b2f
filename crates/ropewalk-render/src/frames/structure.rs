//! A structure that follows a scene from pose to pose.
//!
//! Two levels follow by what changed: instances are moved, hidden or shown, deformed objects are refitted while that leaves their
//! boxes good and built anew where not, and the top level is built anew, as Reichl et al. 2010 do each frame. Every other
//! structure is built anew as a whole.
//!
//! **Invariant.** What is answered does not depend on the poses before: a structure that has followed has the hits, to the bit, of
//! one that is built for the pose. A refit keeps the frame in which an object's structure lies, and another frame rounds
//! otherwise; so objects in oriented boxes are never refitted, but built anew.
//!
//! **Cost.** Two levels keep a copy of each object that deforms; other structures keep one of the scene, since the stage is being
//! rendered while the next frame is prepared.

use super::error::FramesError;
use ropewalk::two_level::{ChangeError, TopUpdate, TwoLevel};
use ropewalk::{NoMonitor, Object, Ray, Scene, Structure, StructureSpec, Transform};
use ropewalk_scene::{Model, Pose};
use std::collections::{BTreeMap, BTreeSet};

/// Where the expected cost of a refitted object has grown to so many times that of its build it is built anew: the rule that
/// `ropewalk::refit` gives.
const WORST_DRIFT: f64 = 1.5;

/// What following a pose took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Followed {
    pub(super) instances_moved: usize,
    pub(super) objects_refitted: usize,
    pub(super) objects_rebuilt: usize,
}

/// A structure that follows.
pub(super) enum Follower {
    TwoLevel {
        levels: Box<TwoLevel>,
        /// The objects that deform.
        shapes: BTreeMap<u32, Object>,
        /// What each of them cost when it was built, once it has been refitted since.
        costs: BTreeMap<u32, f64>,
    },
    Anew {
        spec: StructureSpec,
        scene: Scene,
    },
}

impl Follower {
    /// Takes over the structure of a scene of which some objects will deform.
    pub(super) fn new(spec: StructureSpec, structure: &Structure, scene: &Scene, deforming: &[u32]) -> Self {
        match structure {
            Structure::TwoLevel(levels) => {
                let object = |&index: &u32| Some((index, scene.objects.get(index as usize)?.clone()));
                Self::TwoLevel {
                    levels: Box::new(levels.clone()),
                    shapes: deforming.iter().filter_map(object).collect(),
                    costs: BTreeMap::new(),
                }
            }
            _ => Self::Anew { spec, scene: scene.clone() },
        }
    }

    /// The structure of a pose.
    pub(super) fn follow(&mut self, pose: &Pose) -> Result<(Structure, Followed), FramesError> {
        match self {
            Self::TwoLevel { levels, shapes, costs } => {
                let followed = follow(levels, shapes, costs, pose)?;
                Ok((Structure::TwoLevel(TwoLevel::clone(levels)), followed))
            }
            Self::Anew { spec, scene } => {
                let before: Vec<(Transform, u32)> =
                    scene.instances.iter().map(|instance| (instance.transform, instance.mask)).collect();
                // Surfaces have no say in what is hit.
                let mut model = Model { scene: std::mem::take(scene), ..Model::default() };
                pose.apply(&mut model);
                *scene = model.scene;
                let after = scene.instances.iter().map(|instance| (instance.transform, instance.mask));
                let instances_moved =
                    before.into_iter().zip(after).filter(|(one, other)| one != other).count();
                let structure = spec.build(scene, &NoMonitor)?;
                let objects_rebuilt = scene.objects.len();
                Ok((structure, Followed { instances_moved, objects_refitted: 0, objects_rebuilt }))
            }
        }
    }
}

fn follow(
    levels: &mut TwoLevel,
    shapes: &mut BTreeMap<u32, Object>,
    costs: &mut BTreeMap<u32, f64>,
    pose: &Pose,
) -> Result<Followed, FramesError> {
    let mut followed = Followed::default();
    let mut collapsed = BTreeSet::new();
    for shape in &pose.shapes {
        let Some(object) = shapes.get_mut(&shape.object) else { continue };
        let mut has_changed = false;
        for (mesh, shape) in object.geometries.iter_mut().zip(&shape.geometries) {
            if mesh.positions.len() == shape.positions.len() && mesh.positions != shape.positions {
                mesh.positions.clone_from(&shape.positions);
                has_changed = true;
            }
        }
        if !has_changed {
            continue;
        }
        let index = shape.object;
        let is_good = !levels.options().oriented
            && levels.refit_object(index, object).is_ok_and(|report| {
                let built = *costs.entry(index).or_insert(report.cost_before);
                report.cost <= WORST_DRIFT * built
            });
        if is_good {
            followed.objects_refitted += 1;
            continue;
        }
        // A kd-tree cannot follow, an object that has lost triangles to a point has others, and one that was refitted often
        // is bad by now.
        costs.remove(&index);
        match levels.replace_object(index, object, &NoMonitor) {
            Ok(()) => followed.objects_rebuilt += 1,
            // Nothing of it is left to be hit: its instances are hidden until it has a size again.
            Err(ChangeError::EmptyObject { .. }) => {
                collapsed.insert(index);
            }
            Err(error) => return Err(error.into()),
        }
    }
    for (index, (&to_world, &is_visible)) in (0_u32..).zip(pose.transforms.iter().zip(&pose.visible)) {
        let Some(&was) = levels.instance(index) else { continue };
        let mask = if is_visible && !collapsed.contains(&was.object) { Ray::ALL } else { 0 };
        let moves = *was.transform.to_world() != to_world;
        if moves {
            levels.set_transform(index, to_world)?;
        }
        if was.mask != mask {
            levels.set_mask(index, mask)?;
        }
        followed.instances_moved += usize::from(moves || was.mask != mask);
    }
    levels.commit(TopUpdate::Rebuild)?;
    Ok(followed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ropewalk::glam::{Affine3A, Vec3};
    use ropewalk::two_level::{BottomSpec, Bottoms, TwoLevelOptions};
    use ropewalk::{Answer, Mesh, Query, TraceOptions};
    use ropewalk_scene::animation::{GeometryShape, ObjectShape};

    /// A strip of triangles that waves, and a triangle that flies, over a ground that is no part of the pose.
    fn scene() -> Scene {
        let mut scene = Scene::default();
        let strip: Vec<Vec3> = (0..40).map(|i| Vec3::new((i / 2) as f32, (i % 2) as f32, 0.0)).collect();
        let strip = scene.add_object(Mesh::new(strip, (0..38).map(|i| [i, i + 1, i + 2]).collect()));
        let flyer = scene.add_object(Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]));
        for object in [strip, flyer, flyer] {
            scene.add_instance(object, Transform::IDENTITY);
        }
        scene
    }

    fn pose(time: f64) -> Pose {
        let t = time as f32;
        let place =
            |i: i32| Vec3::new((i / 2) as f32, (i % 2) as f32 * (1.0 - 0.2 * t), t * ((i % 7) as f32 - 3.0));
        let fly = |z: f32| Affine3A::from_translation(Vec3::new(3.0 * t, 0.0, z));
        Pose {
            time,
            transforms: vec![Affine3A::IDENTITY, fly(1.0 + t), fly(-1.0)],
            visible: vec![true, t != 2.0, true],
            shapes: vec![ObjectShape {
                object: 0,
                geometries: vec![GeometryShape { positions: (0..40).map(place).collect(), normals: None }],
            }],
            ..Pose::default()
        }
    }

    fn hits(structure: &Structure) -> Vec<ropewalk::Hit> {
        let rays: Vec<Ray> = (0..400)
            .map(|i| Ray::new(Vec3::new((i % 40) as f32 * 0.5, (i / 40) as f32 * 0.11, 30.0), -Vec3::Z))
            .collect();
        let traced =
            structure.trace(structure.kind().default_walk(), Query::Closest, &rays, TraceOptions::default());
        let Answer::Closest(hits) = traced.unwrap().answer else { panic!("closest was asked") };
        hits
    }

    #[test]
    fn what_has_followed_answers_as_what_is_built_for_the_pose() {
        let two_level = |bottom: BottomSpec, oriented| {
            let bottoms = Bottoms::Each(bottom);
            StructureSpec::TwoLevel(TwoLevelOptions { bottoms, oriented, ..Default::default() })
        };
        let bvh = two_level(BottomSpec::Bvh(Default::default()), false);
        let turned = two_level(BottomSpec::Bvh(Default::default()), true);
        let kd_tree = two_level(BottomSpec::default(), false);
        let mut seen = Vec::new();
        for (spec, refits) in
            [(bvh, true), (turned, false), (kd_tree, false), (StructureSpec::default(), false)]
        {
            let mut follower =
                Follower::new(spec, &spec.build(&scene(), &NoMonitor).unwrap(), &scene(), &[0]);
            let mut refitted = 0;
            // Forth and back, with a time at which the strip is flattened to a line.
            for time in [0.0, 0.1, 0.2, 1.0, 2.0, 5.0, 1.0, 0.1] {
                let (structure, followed) = follower.follow(&pose(time)).unwrap();
                let mut model = Model { scene: scene(), ..Model::default() };
                pose(time).apply(&mut model);
                let expected = hits(&spec.build(&model.scene, &NoMonitor).unwrap());
                assert!(hits(&structure) == expected, "{spec} at {time}");
                refitted += followed.objects_refitted;
                seen.push(expected);
            }
            assert_eq!(refitted > 0, refits, "{spec}");
        }
        assert!(seen[0] != seen[3], "the comparison sees motion");
    }

    #[test]
    fn only_what_moves_is_counted() {
        let spec = StructureSpec::TwoLevel(TwoLevelOptions::default());
        let mut follower = Follower::new(spec, &spec.build(&scene(), &NoMonitor).unwrap(), &scene(), &[0]);
        follower.follow(&pose(1.0)).unwrap();
        let (_, followed) = follower.follow(&pose(1.0)).unwrap();
        assert_eq!(followed, Followed::default());
        let (_, followed) = follower.follow(&pose(2.0)).unwrap();
        assert_eq!((followed.instances_moved, followed.objects_rebuilt), (2, 1));
    }
}
