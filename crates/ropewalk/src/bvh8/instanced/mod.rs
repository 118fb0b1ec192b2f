//! Two levels of packed trees: a tree for each object, and one over their instances.
//!
//! An object is built once, in its own space. An instance places it: a ray is taken to the object's space by an inverse that was
//! worked out when the instance was placed ([`Placed`], 96 bytes), and led through the object's tree by the same steps that lead it
//! through the top one. That is a packed tree too, of nodes without leaves: a leaf's word names the instance itself ([`top`]).
//! After Wald, Benthin, Slusallek 2003.
//!
//! **Hits** are those of [`crate::TwoLevel`] whose objects lie in their own spaces (`oriented` off), to the bit: an instance's box
//! decides where in it a hit can be, as `two_level/enter.rs` says.
//!
//! **Cost**: 96 bytes an instance, and some 45 for the top level. To place instances anew takes a fifth of a microsecond each, on one thread.
//!
//! **Invariants**: each instance whose object has triangles is placed once, and stands in one leaf, whose box is its own. All objects' trees
//! have the same form.

mod drawn;
mod place;
mod top;
mod validate;

use super::simd::Detected;
use super::{Bvh8, Bvh8Options, Form, SimdLevel};
use crate::clock::Clock;
use crate::two_level::{Placed, alone};
use crate::{Aabb, BuildError, BuildReport, Instance, Monitor, NoMonitor, Scene};
use std::sync::Arc;
pub(super) use top::Top;

/// Objects with packed trees of their own, under a packed tree over their instances.
///
/// ```
/// use ropewalk::{Bvh8Options, Instance, Mesh, Ray, Scene, Transform, glam::Vec3};
/// let mut scene = Scene::default();
/// let object = scene.add_object(Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]));
/// let mut instanced = scene.build_instanced(&Bvh8Options::default())?;
/// let at = |step: u8| Instance::new(object, Transform::from_translation(Vec3::Z * f32::from(step)));
/// instanced.place(&(0..100).map(at).collect::<Vec<_>>())?;
/// let hit = instanced.closest(&Ray::new(Vec3::new(0.2, 0.2, 100.5), -Vec3::Z));
/// assert_eq!((hit.t, hit.instance_index), (1.5, 99));
/// # Ok::<(), ropewalk::BuildError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Instanced {
    objects: Vec<Arc<Bvh8>>,
    instances: Vec<Instance>,
    /// The instances that rays can enter, by growing index.
    placed: Vec<Placed>,
    top: Top,
    pub(super) level: Detected,
    report: BuildReport,
}

impl Instanced {
    /// The objects' trees, each in its own space.
    #[must_use]
    pub fn objects(&self) -> &[Arc<Bvh8>] {
        &self.objects
    }

    /// The instances, by their index.
    #[must_use]
    pub fn instances(&self) -> &[Instance] {
        &self.instances
    }

    /// The instances that rays can enter: those whose objects have triangles.
    #[must_use]
    pub fn placed(&self) -> &[Placed] {
        &self.placed
    }

    /// The vector instructions that walks use.
    #[must_use]
    pub const fn level(&self) -> SimdLevel {
        self.level.level()
    }

    /// The same, walked with other vector instructions; with the best where the machine does not have them.
    #[must_use]
    pub fn at(self, level: SimdLevel) -> Self {
        Self { level: Detected::or_best(Some(level)), ..self }
    }

    /// How both levels were built: sums over the objects, each counted once, and the nodes of the top level; the depth is that of the
    /// deepest path through both, the cost that of the top level.
    #[must_use]
    pub const fn report(&self) -> &BuildReport {
        &self.report
    }

    /// The box around everything.
    #[must_use]
    pub const fn bounds(&self) -> Aabb {
        self.top.bounds
    }

    /// Whether some triangle of an object stands in more than one leaf.
    #[must_use]
    pub fn has_repeats(&self) -> bool {
        self.objects.iter().any(|object| object.has_repeats())
    }

    pub(super) const fn top(&self) -> &Top {
        &self.top
    }

    /// How the objects' trees lie in memory: all alike.
    pub(super) fn form(&self) -> Form {
        self.objects.first().map_or(Form::Full, |object| object.form)
    }
}

impl Scene {
    /// Builds a packed tree for each object, and one over all instances.
    ///
    /// # Errors
    /// When the scene is out of range.
    pub fn build_instanced(&self, options: &Bvh8Options) -> Result<Instanced, BuildError> {
        self.build_instanced_monitored(options, &NoMonitor)
    }

    /// Builds a packed tree for each object, and one over all instances, under the eyes of a monitor that may cancel it. The monitor
    /// hears of one object after the other.
    ///
    /// # Errors
    /// When the scene is out of range, or the monitor cancels.
    pub fn build_instanced_monitored(
        &self,
        options: &Bvh8Options,
        monitor: &dyn Monitor,
    ) -> Result<Instanced, BuildError> {
        let clock = Clock::start();
        self.check_instances()?;
        let mut objects = Vec::with_capacity(self.objects.len());
        for object in &self.objects {
            objects.push(Arc::new(alone(object).build_packed_monitored(options, monitor)?));
        }
        let level = Detected::or_best(options.level);
        let mut instanced = Instanced {
            objects,
            instances: Vec::new(),
            placed: Vec::new(),
            top: Top::default(),
            level,
            report: BuildReport::default(),
        };
        instanced.place(&self.instances)?;
        instanced.report.build_time = clock.elapsed();
        Ok(instanced)
    }
}
