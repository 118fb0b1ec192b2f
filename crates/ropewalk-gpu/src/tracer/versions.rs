//! One structure that changes while it is traced: two sets of buffers, of which one is traced and the other written
//! (Toczek 2010, sections 2 and 5).
//!
//! An upload compares the new version with what the idle set holds, writes what differs, and makes that set the current
//! one. Who took the version before keeps it whole for as long as there is a handle of it: a set that somebody still holds
//! is not written, but left to its holders, and new buffers take its place.
//!
//! **Invariants.** No buffer is written while a handle of what it holds is out. A handle is given out only of what has been
//! sent to the device as a whole; the device does one thing after the other in the order in which it was sent. An upload
//! that fails leaves the current version as it is.
//!
//! **Cost.** Twice the buffers, and on the host two versions of the structure, shared with whoever made them. An upload reads
//! both and sends what differs. wgpu has one queue, so a copy runs between kernels and not beside them; what overlaps
//! with tracing is everything else: building, comparing, and handing the bytes over.

use super::changes;
use super::content::Content;
use super::structure::{Buffers, room};
use super::{GpuStructure, Tracer};
use crate::GpuError;
use ropewalk::Structure;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// What an upload did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UploadReport {
    /// Bytes of the version.
    pub bytes: u64,
    /// Bytes of it that were sent to the device.
    pub bytes_written: u64,
    /// Whether new buffers were made: for the first versions, for one that does not fit, and where the idle set was held.
    pub is_new: bool,
    /// How long it took on the host.
    pub time: Duration,
}

/// The versions of a structure that changes. Threads may take and upload versions at the same time.
///
/// ```no_run
/// use ropewalk::{ListOptions, Query, Scene, Structure, TraceOptions, Walk};
/// use ropewalk_gpu::{Gpu, StructureVersions, Tracer};
/// use std::sync::Arc;
/// # let (scene, moved, rays) = (Scene::default(), Scene::default(), []);
/// let tracer = Tracer::new(Gpu::open(0)?);
/// let mut lists = scene.build_list(&ListOptions::default())?;
/// let versions = StructureVersions::new(&tracer, &Arc::new(Structure::List(lists.clone())))?;
/// std::thread::scope(|scope| {
///     // The frame that is traced here keeps its version, while the next one is made and sent.
///     let current = versions.current();
///     let next = scope.spawn(|| {
///         lists.update(&moved)?;
///         versions.upload(&Arc::new(Structure::List(lists)))?;
///         Ok::<(), Box<dyn std::error::Error + Send + Sync>>(())
///     });
///     tracer.trace(&current, Walk::List, Query::Closest, &rays, TraceOptions::default())?;
///     next.join().expect("it does not panic")
/// })?;
/// # Ok::<(), Box<dyn std::error::Error + Send + Sync>>(())
/// ```
#[derive(Debug)]
pub struct StructureVersions {
    tracer: Tracer,
    /// The current set and the idle one. Held while a version is uploaded.
    sets: Mutex<[Option<Set>; 2]>,
    /// A handle of the first set's version, at hand also while another is uploaded.
    current: Mutex<GpuStructure>,
}

/// Buffers and what is in them.
#[derive(Debug)]
struct Set {
    buffers: Buffers,
    version: GpuStructure,
    source: Arc<Structure>,
}

impl StructureVersions {
    /// Uploads the first version, for a tracer.
    ///
    /// # Errors
    /// When it exceeds a limit or the memory of the device.
    pub fn new(tracer: &Tracer, first: &Arc<Structure>) -> Result<Self, GpuError> {
        let explain = |error| tracer.gpu().explain(error);
        let (set, _) = place(tracer, first, None).map_err(explain)?;
        let current = Mutex::new(set.version.clone());
        Ok(Self { tracer: tracer.clone(), sets: Mutex::new([Some(set), None]), current })
    }

    /// The current version. It stays whole for as long as this handle or a clone of it is kept; give it back soon, so that its
    /// buffers can be used again.
    #[must_use]
    pub fn current(&self) -> GpuStructure {
        self.current.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Uploads another version and makes it the current one. Others may take and trace the one before meanwhile.
    ///
    /// The structure is kept for as long as its buffers are, to compare the one after the next with.
    ///
    /// # Errors
    /// When it exceeds a limit or the memory of the device, or the device fails. Then the current version stays.
    pub fn upload(&self, next: &Arc<Structure>) -> Result<UploadReport, GpuError> {
        let mut sets = self.sets.lock().unwrap_or_else(PoisonError::into_inner);
        let [current, idle] = &mut *sets;
        // Taken: when this fails, nobody knows what the buffers hold.
        let idle_set = idle.take().filter(|set| set.version.is_unshared());
        let placed = place(&self.tracer, next, idle_set);
        let (set, report) = placed.map_err(|error| self.tracer.gpu().explain(error))?;
        *self.current.lock().unwrap_or_else(PoisonError::into_inner) = set.version.clone();
        *idle = current.replace(set);
        Ok(report)
    }
}

/// Puts a version into a set that nobody holds, or into a new one.
fn place(tracer: &Tracer, next: &Arc<Structure>, idle: Option<Set>) -> Result<(Set, UploadReport), GpuError> {
    let begin = Instant::now();
    let gpu = tracer.gpu();
    let content = Content::of(next, room(gpu))?;
    let (buffers, old) = match idle {
        Some(Set { buffers, source, version: _ }) if buffers.hold(&content) => (buffers, Some(source)),
        smaller => {
            // What outgrew its buffers will grow again.
            let spare = |needed: u64| if smaller.is_some() { needed / 4 } else { 0 };
            (Buffers::new(gpu, tracer.structure_layout(), &content, spare)?, None)
        }
    };
    let old_content = old.as_deref().map(|old| Content::of(old, room(gpu))).transpose()?;
    let mut bytes_written = 0;
    for (buffer, new, old) in [
        (&buffers.nodes, &content.nodes, old_content.as_ref().map(|old| &old.nodes)),
        (&buffers.triangles, &content.triangles, old_content.as_ref().map(|old| &old.triangles)),
    ] {
        let ranges = changes::between(old, new);
        changes::write(gpu, buffer, new, &ranges)?;
        bytes_written += ranges.iter().map(|range| range.end - range.start).sum::<u64>();
    }
    let report = UploadReport {
        bytes: content.nodes.written() + content.triangles.written(),
        bytes_written,
        is_new: old.is_none(),
        time: begin.elapsed(),
    };
    let version = GpuStructure::new(gpu, &buffers, content.shape, next);
    drop(content);
    Ok((Set { buffers, version, source: Arc::clone(next) }, report))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Gpu, adapters};
    use ropewalk::glam::Vec3;
    use ropewalk::{Answer, ListOptions, Mesh, Query, Ray, Scene, TraceOptions, Walk};

    /// A tracer on the first adapter. None is an error where CI is set.
    fn tracer() -> Option<Tracer> {
        if adapters().is_empty() {
            assert!(std::env::var_os("CI").is_none(), "CI is set and there is no adapter");
            println!("skipped: no adapter");
            return None;
        }
        Some(Tracer::new(Gpu::open(0).unwrap()))
    }

    /// A triangle at a height.
    fn at(height: f32) -> Arc<Structure> {
        let corners = [Vec3::ZERO, Vec3::X, Vec3::Y].map(|corner| corner + Vec3::Z * height);
        let scene = Scene::from_mesh(Mesh::new(corners.to_vec(), vec![[0, 1, 2]]));
        Arc::new(Structure::List(scene.build_list(&ListOptions::default()).unwrap()))
    }

    /// The heights that the two halves of a frame see, when something happens between them.
    fn frame(tracer: &Tracer, version: &GpuStructure, between: impl FnOnce()) -> [f32; 2] {
        let ray = [Ray::new(Vec3::new(0.2, 0.2, 0.0), Vec3::Z)];
        let height = || {
            let traced = tracer.trace(version, Walk::List, Query::Closest, &ray, TraceOptions::default());
            let Answer::Closest(hits) = traced.unwrap().traced.answer else { panic!("closest was asked") };
            hits[0].t
        };
        let first = height();
        between();
        [first, height()]
    }

    /// A frame sees one version, whatever is uploaded meanwhile; one that is written while it is held, as the sound way never
    /// does, shows two.
    #[test]
    fn a_version_that_is_held_is_not_written() {
        let Some(tracer) = tracer() else { return };
        let versions = StructureVersions::new(&tracer, &at(1.0)).unwrap();
        let held = versions.current();
        let uploads = || {
            for height in 2..=6 {
                versions.upload(&at(height as f32)).unwrap();
            }
        };
        assert_eq!(frame(&tracer, &held, uploads), [1.0; 2]);
        assert_eq!(frame(&tracer, &versions.current(), || {}), [6.0; 2]);

        let held = versions.current();
        let over_it = || {
            let mut sets = versions.sets.lock().unwrap();
            let in_use = sets[0].take();
            sets[0] = Some(place(&tracer, &at(7.0), in_use).unwrap().0);
        };
        assert_eq!(frame(&tracer, &held, over_it), [6.0, 7.0], "two versions in one frame");
    }

    /// Who gives versions back lets their buffers be used again; who keeps one gets others made.
    #[test]
    fn buffers_are_used_again_when_nobody_holds_them() {
        let Some(tracer) = tracer() else { return };
        let versions = StructureVersions::new(&tracer, &at(1.0)).unwrap();
        let news: Vec<bool> =
            (2..6).map(|height| versions.upload(&at(height as f32)).unwrap().is_new).collect();
        assert_eq!(news, [true, false, false, false]);
        let held = versions.current();
        let news: Vec<bool> =
            (6..10).map(|height| versions.upload(&at(height as f32)).unwrap().is_new).collect();
        assert_eq!(news, [false, true, false, false], "the second would write what is held");
        drop(held);
        // What is the same is not sent again.
        let same = at(20.0);
        let first = versions.upload(&same).unwrap();
        assert!(first.bytes_written > 0 && first.bytes_written <= first.bytes);
        versions.upload(&same).unwrap();
        assert_eq!(versions.upload(&same).unwrap().bytes_written, 0);
    }
}
