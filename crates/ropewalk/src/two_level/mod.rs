//! Two levels: objects with structures of their own, under a hierarchy that is rebuilt when they move (Reichl, Dünger,
//! Schiewe, Klemmer, Hartleb, Lux 2010; Wald, Benthin, Slusallek 2003).
//!
//! An object's structure, a kd-tree or any other, is built once, in the frame in which its box is smallest. An instance places
//! an object: a ray is taken to the object's frame, never the object to the scene. The top level is a binary BVH with one
//! instance a leaf; it is small, so a frame in which objects moved builds it anew, or moves its boxes, and sends what changed.
//!
//! | file | concept |
//! |---|---|
//! | `options` | what is made |
//! | `oriented_box` | the frame of an object |
//! | `bottom`, `object` | an object's structure, in its frame |
//! | `instance` | an object in its place, 96 bytes |
//! | `top_level` | the hierarchy over instances: built, refitted, restructured |
//! | `opening` | parts of large objects as entries of the top level |
//! | `build` | from a scene to both levels |
//! | `change` | a scene that changes, frame by frame |
//! | `background` | a structure that is built while frames go on |
//! | `enter` | what a hit is: a ray in an object's frame |
//! | `single` | one triangle of one instance, for those who come to it by another way |
//! | `walk`, `merged`, `trace` | the loops, and one ray or many |
//! | `smart_stack` | one ring for the stacks of both levels |
//! | `validate` | the rules of the structure |
//!
//! **Cost.** 32 bytes a node of the top level, of which there are `2 n - 1` for `n` instances, 96 bytes an instance, and what the
//! objects' structures take, once each however often they are placed.
//!
//! **Invariants** of every [`TwoLevel`], checked by [`TwoLevel::validate`]: the top level has its own (see
//! [`TopLevel::validate`]); each instance that is in the scene and not empty has one leaf, whose box holds the instance's,
//! or with [`Opening`] a leaf for each of its parts; and its box holds the images of all its triangles.

mod background;
mod bottom;
mod build;
mod change;
mod enter;
mod instance;
mod merged;
mod object;
mod opening;
mod options;
pub mod oriented_box;
mod single;
mod smart_stack;
pub mod top_level;
mod trace;
mod validate;
mod walk;

pub use background::BackgroundBuild;
pub use bottom::Bottom;
pub use change::{ChangeError, CommitReport, TopUpdate};
pub use instance::{DIRECTION_STEP, Placed};
pub use object::ObjectStructure;
pub use options::{BottomSpec, Bottoms, Opening, TwoLevelOptions};
pub use single::EnteredInstance;
pub use smart_stack::SmartStack;
pub use top_level::TopLevel;

pub(crate) use enter::{Moved, Moving};
pub(crate) use object::{alone, image};

use crate::{Aabb, BuildReport, FlatTriangle, Instance};
use bytemuck::{Pod, Zeroable};
use enter::Instances;
use std::sync::Arc;

/// What a leaf of the top level leads to.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
pub struct Entry {
    /// The place among [`TwoLevel::placed`].
    pub place: u32,
    /// The node of the object's structure at which rays begin: 0, its root, where the object was not opened.
    pub node: u32,
}

/// Objects with structures of their own, under a hierarchy over their instances.
///
/// ```
/// use ropewalk::two_level::TwoLevelOptions;
/// use ropewalk::{Mesh, Ray, Scene, Transform, glam::Vec3};
/// let mut scene = Scene::default();
/// let object = scene.add_object(Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]));
/// for step in 0..100 {
///     scene.add_instance(object, Transform::from_translation(Vec3::Z * step as f32));
/// }
/// let two_level = scene.build_two_level(&TwoLevelOptions::default())?;
/// assert_eq!(two_level.top().nodes().len(), 2 * 100 - 1);
/// let hit = two_level.closest(&Ray::new(Vec3::new(0.2, 0.2, 100.5), -Vec3::Z));
/// assert_eq!((hit.t, hit.instance_index), (1.5, 99));
/// # Ok::<(), ropewalk::BuildError>(())
/// ```
#[derive(Clone, Debug)]
pub struct TwoLevel {
    options: TwoLevelOptions,
    /// By index; `None` where one was removed.
    objects: Vec<Option<Arc<ObjectStructure>>>,
    /// By index; `None` where one was removed.
    instances: Vec<Option<Instance>>,
    /// The instances that rays can enter.
    placed: Vec<Placed>,
    /// The place among these of each instance, or [`TwoLevel::NOWHERE`].
    places: Vec<u32>,
    /// What each leaf of the top level leads to.
    entries: Vec<Entry>,
    /// The boxes of these.
    boxes: Vec<Aabb>,
    top: TopLevel,
    /// By what share of the coordinates rays are wider for the top level: see [`opening`].
    width: f32,
    report: BuildReport,
    pending: change::Pending,
}

impl TwoLevel {
    /// The place of an instance that no ray can enter.
    const NOWHERE: u32 = u32::MAX;

    /// How it was made.
    #[must_use]
    pub const fn options(&self) -> &TwoLevelOptions {
        &self.options
    }

    /// Whether triangles have one side.
    #[must_use]
    pub const fn is_one_sided(&self) -> bool {
        self.options.is_one_sided()
    }

    /// The objects, by their index; `None` where one was removed.
    #[must_use]
    pub fn objects(&self) -> &[Option<Arc<ObjectStructure>>] {
        &self.objects
    }

    /// An instance; `None` where there is none of that index, or it was removed.
    #[must_use]
    pub fn instance(&self, index: u32) -> Option<&Instance> {
        self.instances.get(index as usize)?.as_ref()
    }

    /// The instances that rays can enter: those that are there and have triangles.
    #[must_use]
    pub fn placed(&self) -> &[Placed] {
        &self.placed
    }

    /// What each leaf of the top level leads to: the leaf's link is the place here.
    #[must_use]
    pub fn entries(&self) -> &[Entry] {
        &self.entries
    }

    /// The hierarchy over the instances.
    #[must_use]
    pub const fn top(&self) -> &TopLevel {
        &self.top
    }

    /// By what share of the coordinates rays are wider for the boxes of the top level; 0 where no object was opened.
    #[must_use]
    pub const fn width(&self) -> f32 {
        self.width
    }

    /// How both levels were built: sums over the objects, each counted once, and the nodes of the top level; the depth is
    /// that of the deepest path through both.
    #[must_use]
    pub const fn report(&self) -> &BuildReport {
        &self.report
    }

    /// Whether some object's structure may meet a triangle several times.
    #[must_use]
    pub fn has_repeats(&self) -> bool {
        self.objects.iter().flatten().any(|object| object.bottom().has_repeats())
    }

    /// The triangles of all objects, each once, in the objects' frames.
    #[must_use]
    pub fn triangles(&self) -> Vec<FlatTriangle> {
        let mut triangles = Vec::with_capacity(self.report.triangles);
        for object in self.objects.iter().flatten() {
            object.bottom().append_triangles(&mut triangles);
        }
        triangles
    }

    /// The box around everything.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.placed.iter().map(Placed::bounds).fold(Aabb::EMPTY, Aabb::union)
    }

    #[inline(always)]
    fn instances(&self) -> Instances<'_> {
        Instances { objects: &self.objects, placed: &self.placed }
    }
}
