//! An object's structure, built while the scene goes on being traced.
//!
//! The build works on a copy of the object and ends in an [`ObjectStructure`] that nobody else knows. It comes into the
//! scene in one place and at one time: when the owner of the scene [polls](BackgroundBuild::poll) it, [adopts](super::TwoLevel::adopt_object)
//! it and commits. So a frame sees the old structure or the new one, never a part of both: what two threads share is a
//! flag and one place for the result, behind a lock.
//!
//! The object may have moved on meanwhile: then refit what was built to what it has become
//! ([`super::TwoLevel::refit_object`]) before the commit (Ize, Wald, Parker 2007).

use super::{BottomSpec, ObjectStructure};
use crate::parallel::spawn;
use crate::{BuildError, Monitor, Object};
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// A structure that is being built.
///
/// Dropped, it tells the build to stop, and forgets what comes of it.
///
/// ```
/// use ropewalk::two_level::{BackgroundBuild, BottomSpec, TopUpdate, TwoLevelOptions};
/// use ropewalk::{Mesh, Ray, Scene, glam::Vec3};
/// let mesh = |size| Mesh::new(vec![Vec3::ZERO, Vec3::X * size, Vec3::Y * size], vec![[0, 1, 2]]);
/// let mut scene = Scene::from_mesh(mesh(1.0)).build_two_level(&TwoLevelOptions::default())?;
/// let mut build = BackgroundBuild::start(mesh(5.0).into(), BottomSpec::default(), true);
/// let structure = loop {
///     // ... frames are traced here ...
///     if let Some(built) = build.poll() {
///         break built?;
///     }
/// };
/// scene.adopt_object(0, structure)?;
/// scene.commit(TopUpdate::Refit)?;
/// assert!(scene.any(&Ray::new(Vec3::new(2.0, 2.0, 1.0), -Vec3::Z)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct BackgroundBuild {
    shared: Arc<Shared>,
}

#[derive(Debug, Default)]
struct Shared {
    is_cancelled: AtomicBool,
    built: Mutex<Option<Result<Arc<ObjectStructure>, BuildError>>>,
}

impl BackgroundBuild {
    /// Begins to build in the caller's thread pool; without the feature `parallel`, builds at once.
    #[must_use]
    pub fn start(object: Object, bottom: BottomSpec, oriented: bool) -> Self {
        let shared = Arc::new(Shared::default());
        let of_build = Arc::clone(&shared);
        spawn(move || {
            let watch = Watch(&of_build.is_cancelled);
            let built = ObjectStructure::build(&object, bottom, oriented, &watch).map(Arc::new);
            *of_build.built.lock().unwrap_or_else(PoisonError::into_inner) = Some(built);
        });
        Self { shared }
    }

    /// What was built, once, when it is ready.
    pub fn poll(&mut self) -> Option<Result<Arc<ObjectStructure>, BuildError>> {
        self.shared.built.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}

impl Drop for BackgroundBuild {
    fn drop(&mut self) {
        self.shared.is_cancelled.store(true, Ordering::Relaxed);
    }
}

/// Cancels a build that nobody waits for any more.
struct Watch<'a>(&'a AtomicBool);

impl Monitor for Watch<'_> {
    fn progress(&self, _done: usize, _total: usize) -> ControlFlow<()> {
        if self.0.load(Ordering::Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}
