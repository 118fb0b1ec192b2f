//! A scene that changes: parts move, come, go, and take other shapes, and the next frame sees all of it at once.
//!
//! Changes are noted, checked at once, and seen after [`TwoLevel::commit`], which brings the top level up to date: built anew, as
//! the paper does each frame; refitted, where little moved; or refitted and then restructured where that made it bad (Yoon,
//! Curtis, Manocha 2007). A change that cannot be made is an error that names what is wrong, and changes nothing.
//!
//! **Cost.** Of a commit what the top level takes (`ropewalk lab two-level` prints it) and 96 bytes written for each instance that
//! moved.

use super::build::placed;
use super::{ObjectStructure, Opening, Placed, TwoLevel};
use crate::clock::Clock;
use crate::refit::RefitReport;
use crate::{
    BuildError, FlatTriangle, Instance, Monitor, Object, SceneError, Transform, TransformError, UpdateError,
};
use glam::Affine3A;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;
use thiserror::Error;

/// Why a scene was not changed.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum ChangeError {
    /// There is no such instance, or it was removed.
    #[error("there is no instance {instance}: it was never added, or it was removed")]
    NoSuchInstance {
        /// The instance.
        instance: u32,
    },
    /// There is no such object, or it was removed.
    #[error("instance {instance} is to place object {object}, which was never added, or was removed")]
    InstanceOfNothing {
        /// The instance that was to be added.
        instance: u32,
        /// The object.
        object: u32,
    },
    /// There is no such object, or it was removed.
    #[error("there is no object {object}: it was never added, or it was removed")]
    NoSuchObject {
        /// The object.
        object: u32,
    },
    /// The object has nothing to hit.
    #[error(
        "instance {instance} is to place object {object}, which has no triangle that a ray could hit: give it one first"
    )]
    EmptyObject {
        /// The instance that places it, or was to.
        instance: u32,
        /// The object.
        object: u32,
    },
    /// The object is still placed.
    #[error("object {object} is placed by instance {instance}: remove that first")]
    InUse {
        /// The object.
        object: u32,
        /// An instance of it.
        instance: u32,
    },
    /// An instance cannot be placed so.
    #[error("instance {instance}: {why}")]
    Transform {
        /// The instance.
        instance: u32,
        /// What is wrong with its transform.
        why: TransformError,
    },
    /// More instances than an index can count.
    #[error("instance {instance} is one more than the {limit} that can be told apart: merge some objects")]
    TooManyInstances {
        /// The index that it would have had.
        instance: u32,
        /// How many there may be.
        limit: usize,
    },
    /// A structure was not built.
    #[error("object {object}: {why}")]
    Build {
        /// The object.
        object: u32,
        /// Why.
        why: BuildError,
    },
    /// A structure could not follow its object.
    #[error("object {object}: {why}")]
    Update {
        /// The object.
        object: u32,
        /// Why.
        why: UpdateError,
    },
}

/// How a commit brings the top level up to date.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TopUpdate {
    /// Built from scratch: the paper's way.
    #[default]
    Rebuild,
    /// The same tree, with other boxes.
    Refit,
    /// The same tree with other boxes, and what that made bad built anew.
    Restructure,
}

/// What a commit did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CommitReport {
    /// Instances whose place was written.
    pub placed: usize,
    /// Whether the top level was built from scratch; always where instances came or went, or opened objects have other
    /// shapes.
    pub is_rebuilt: bool,
    /// The expected cost of a random ray in the top level, by the surface area heuristic.
    pub cost: f64,
    /// How many times its cost when it was built that is.
    pub drift: f64,
    /// The time that it took; zero where there is no clock (wasm32).
    pub time: Duration,
}

/// What was changed and is not seen yet.
#[derive(Clone, Debug, Default)]
pub(super) struct Pending {
    /// Objects with other structures; `None` for those that go.
    objects: BTreeMap<u32, Option<Arc<ObjectStructure>>>,
    /// Instances that moved; some may stand here twice.
    moved: Vec<u32>,
    /// Whether instances came or went.
    membership: bool,
}

impl TwoLevel {
    /// Adds an object, with the structure that the options give it; its index.
    ///
    /// # Errors
    /// When its structure cannot be built.
    pub fn add_object(&mut self, object: &Object, monitor: &dyn Monitor) -> Result<u32, ChangeError> {
        let index = self.object_count();
        let structure = self.structure(index, object, monitor)?;
        self.pending.objects.insert(index, Some(Arc::new(structure)));
        Ok(index)
    }

    /// Removes an object that no instance places.
    ///
    /// # Errors
    /// When there is none, or it is placed.
    pub fn remove_object(&mut self, object: u32) -> Result<(), ChangeError> {
        self.object(object).ok_or(ChangeError::NoSuchObject { object })?;
        if let Some(instance) = self.instance_of(object) {
            return Err(ChangeError::InUse { object, instance });
        }
        self.pending.objects.insert(object, None);
        Ok(())
    }

    /// Gives an object another shape: its structure is built anew. To go on meanwhile see
    /// [`super::BackgroundBuild`].
    ///
    /// # Errors
    /// When there is no such object, it has no triangles although it is placed, or its structure cannot be built.
    pub fn replace_object(
        &mut self,
        object: u32,
        shape: &Object,
        monitor: &dyn Monitor,
    ) -> Result<(), ChangeError> {
        self.object(object).ok_or(ChangeError::NoSuchObject { object })?;
        let structure = self.structure(object, shape, monitor)?;
        self.adopt_object(object, Arc::new(structure))
    }

    /// Moves the vertices of an object: its structure stays as it is but for its boxes, which get worse the more the
    /// object deforms; the report says how much. Kd-trees cannot follow, since their splits are planes in space.
    ///
    /// # Errors
    /// When there is no such object, it has other triangles now, or its structure cannot follow.
    pub fn refit_object(&mut self, object: u32, shape: &Object) -> Result<RefitReport, ChangeError> {
        let structure = self.object(object).ok_or(ChangeError::NoSuchObject { object })?;
        let mut structure = ObjectStructure::clone(structure);
        let report = structure.refit(shape).map_err(|why| ChangeError::Update { object, why })?;
        self.adopt_object(object, Arc::new(structure))?;
        Ok(report)
    }

    /// Gives an object a structure that was built elsewhere, such as that of a [`super::BackgroundBuild`].
    ///
    /// # Errors
    /// When there is no such object, or the structure is empty, or its bounds cannot be placed, and an instance places it.
    pub fn adopt_object(&mut self, object: u32, structure: Arc<ObjectStructure>) -> Result<(), ChangeError> {
        self.object(object).ok_or(ChangeError::NoSuchObject { object })?;
        for (index, instance) in self.instances.iter().enumerate() {
            if let Some(instance) = instance.as_ref().filter(|instance| instance.object == object) {
                self.check_place(index as u32, instance, &structure)?;
            }
        }
        self.pending.objects.insert(object, Some(structure));
        Ok(())
    }

    /// Places an object; the index of the instance.
    ///
    /// # Errors
    /// When there is no such object, it has no triangles, it cannot be placed so, or there are too many instances.
    pub fn add_instance(&mut self, object: u32, to_world: Affine3A, mask: u32) -> Result<u32, ChangeError> {
        let index = self.instances.len() as u32;
        let limit = FlatTriangle::INSTANCE_LIMIT;
        if self.instances.len() >= limit {
            return Err(ChangeError::TooManyInstances { instance: index, limit });
        }
        let structure =
            self.object(object).ok_or(ChangeError::InstanceOfNothing { instance: index, object })?;
        let transform = transform(index, to_world)?;
        let instance = Instance { object, transform, mask };
        self.check_place(index, &instance, structure)?;
        self.instances.push(Some(instance));
        self.pending.membership = true;
        Ok(index)
    }

    /// Removes an instance. Its index is not given to another.
    ///
    /// # Errors
    /// When there is none.
    pub fn remove_instance(&mut self, instance: u32) -> Result<(), ChangeError> {
        let place = self.instances.get_mut(instance as usize).filter(|place| place.is_some());
        *place.ok_or(ChangeError::NoSuchInstance { instance })? = None;
        self.pending.membership = true;
        Ok(())
    }

    /// Moves an instance.
    ///
    /// # Errors
    /// When there is none, or it cannot be placed so: a transform with a component that is not finite, or without an inverse.
    pub fn set_transform(&mut self, instance: u32, to_world: Affine3A) -> Result<(), ChangeError> {
        let &was = self.instance(instance).ok_or(ChangeError::NoSuchInstance { instance })?;
        let is = Instance { transform: transform(instance, to_world)?, ..was };
        let object = was.object;
        let structure = self.object(object).ok_or(ChangeError::InstanceOfNothing { instance, object })?;
        if !structure.is_empty() {
            self.check_place(instance, &is, structure)?;
        }
        self.instances[instance as usize] = Some(is);
        self.pending.moved.push(instance);
        Ok(())
    }

    /// Lets other rays see an instance.
    ///
    /// # Errors
    /// When there is none.
    pub fn set_mask(&mut self, instance: u32, mask: u32) -> Result<(), ChangeError> {
        let &was = self.instance(instance).ok_or(ChangeError::NoSuchInstance { instance })?;
        self.instances[instance as usize] = Some(Instance { mask, ..was });
        self.pending.moved.push(instance);
        Ok(())
    }

    /// Lets rays see what was changed, all at once.
    ///
    /// ```
    /// use ropewalk::two_level::{TopUpdate, TwoLevelOptions};
    /// use ropewalk::{Mesh, Ray, Scene, glam::{Affine3A, Vec3}};
    /// let mesh = Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]);
    /// let mut scene = Scene::from_mesh(mesh).build_two_level(&TwoLevelOptions::default())?;
    /// scene.set_transform(0, Affine3A::from_translation(Vec3::X * 10.0))?;
    /// let ray = Ray::new(Vec3::new(10.2, 0.2, 1.0), -Vec3::Z);
    /// assert!(!scene.any(&ray));
    /// scene.commit(TopUpdate::Rebuild)?;
    /// assert!(scene.any(&ray));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// When an instance cannot be placed, which was refused when it was changed.
    pub fn commit(&mut self, update: TopUpdate) -> Result<CommitReport, SceneError> {
        let clock = Clock::start();
        let Pending { objects, mut moved, mut membership } = std::mem::take(&mut self.pending);
        let shapes_changed = !objects.is_empty();
        if shapes_changed {
            let has_place = |(place, _): &(usize, &u32)| {
                self.instances[*place].as_ref().is_some_and(|instance| objects.contains_key(&instance.object))
            };
            let indices: Vec<u32> = (0..self.instances.len() as u32).collect();
            moved.extend(indices.iter().enumerate().filter(has_place).map(|(_, &index)| index));
            for (index, structure) in objects {
                let index = index as usize;
                if index >= self.objects.len() {
                    self.objects.resize(index + 1, None);
                }
                // One that was empty may have places now, or the other way round.
                let is_empty = |of: &Option<Arc<ObjectStructure>>| of.as_ref().is_none_or(|of| of.is_empty());
                membership |= is_empty(&self.objects[index]) != is_empty(&structure);
                self.objects[index] = structure;
            }
        }
        let mut written = moved.len();
        if membership {
            self.place_all()?;
            written = self.placed.len();
        } else {
            for index in moved {
                self.place(index)?;
            }
        }
        // The nodes at which opened objects begin are those of their old structures.
        let is_opened = self.options.opening != Opening::Never;
        let is_rebuilt = membership || update == TopUpdate::Rebuild || is_opened && shapes_changed;
        if is_rebuilt {
            self.rebuild_top()?;
        } else {
            self.refit_top(update == TopUpdate::Restructure)?;
        }
        if shapes_changed || membership {
            self.measure();
        }
        let (cost, drift) = (self.top.cost(), self.top.drift());
        Ok(CommitReport { placed: written, is_rebuilt, cost, drift, time: clock.elapsed() })
    }

    /// Writes where an instance is.
    fn place(&mut self, index: u32) -> Result<(), SceneError> {
        let Some(&place) = self.places.get(index as usize).filter(|&&place| place != Self::NOWHERE) else {
            return Ok(());
        };
        let Some(instance) = self.instance(index).copied() else { return Ok(()) };
        let Some(Some(object)) = self.objects.get(instance.object as usize) else { return Ok(()) };
        let placed = placed(index as usize, &instance, object)?;
        self.placed[place as usize] = placed;
        Ok(())
    }

    /// The structure of an object, as it will be seen.
    fn object(&self, object: u32) -> Option<&Arc<ObjectStructure>> {
        match self.pending.objects.get(&object) {
            Some(pending) => pending.as_ref(),
            None => self.objects.get(object as usize)?.as_ref(),
        }
    }

    /// Objects that were ever added.
    fn object_count(&self) -> u32 {
        let pending = self.pending.objects.last_key_value().map_or(0, |(&last, _)| last + 1);
        pending.max(self.objects.len() as u32)
    }

    /// Some instance of an object.
    fn instance_of(&self, object: u32) -> Option<u32> {
        let places =
            |instance: &Option<Instance>| instance.as_ref().is_some_and(|instance| instance.object == object);
        self.instances.iter().position(places).map(|place| place as u32)
    }

    fn structure(
        &self,
        object: u32,
        shape: &Object,
        monitor: &dyn Monitor,
    ) -> Result<ObjectStructure, ChangeError> {
        let bottom = self.options.bottoms.of(object as usize);
        ObjectStructure::build(shape, bottom, self.options.oriented, monitor)
            .map_err(|why| ChangeError::Build { object, why })
    }

    fn check_place(
        &self,
        index: u32,
        instance: &Instance,
        structure: &ObjectStructure,
    ) -> Result<(), ChangeError> {
        if structure.is_empty() {
            return Err(ChangeError::EmptyObject { instance: index, object: instance.object });
        }
        Placed::new(index, instance.object, instance.mask, &instance.transform, structure)
            .map(drop)
            .map_err(|why| ChangeError::Transform { instance: index, why })
    }
}

fn transform(instance: u32, to_world: Affine3A) -> Result<Transform, ChangeError> {
    Transform::new(to_world).map_err(|why| ChangeError::Transform { instance, why })
}
