//! Scenes: triangles that are built, that move, or that are placed many times.

use super::abi::{self, Functions};
use super::device::Device;
use ropewalk::glam::{Affine3A, Vec3A};
use ropewalk_lab::arena::Shape;
use std::sync::Arc;

/// What is built how.
#[derive(Clone, Copy, Debug)]
pub(super) struct Recipe {
    pub(super) quality: u32,
    pub(super) flags: u32,
    /// Whether triangles may move afterwards.
    pub(super) refits: bool,
}

/// A committed scene and the memory that it reads.
pub(super) struct Scene {
    pub(super) device: Arc<Device>,
    pub(super) pointer: abi::Scene,
    /// The geometry of the triangles; the scene owns it.
    geometry: abi::Geometry,
    positions: Arc<[Vec3A]>,
    _indices: Box<[[u32; 3]]>,
    pub(super) kept: usize,
    pub(super) peak: usize,
}

// SAFETY: a committed scene may be traced from any thread; what changes it needs `&mut self`.
unsafe impl Send for Scene {}
// SAFETY: as above.
unsafe impl Sync for Scene {}

impl Scene {
    /// Builds the triangles of a shape.
    pub(super) fn new(device: Arc<Device>, shape: &Shape, recipe: Recipe) -> Result<Self, String> {
        let functions = device.library.functions;
        // Where triangles move, the scene has its own copy of them.
        let positions = if recipe.refits {
            shape.aligned_positions().iter().copied().collect()
        } else {
            shape.aligned_positions()
        };
        let indices: Box<[[u32; 3]]> = shape.triangles().into();
        let before = device.bytes.current();
        device.bytes.reset_peak();
        // SAFETY: the device is alive. Both buffers are as long as is said, are kept by the scene, and the last vertex may be
        // read 16 bytes wide, as shared buffers must allow.
        let (pointer, geometry) = unsafe {
            let scene = (functions.new_scene)(device.pointer);
            (functions.set_scene_flags)(scene, recipe.flags);
            (functions.set_scene_quality)(scene, recipe.quality);
            let geometry = (functions.new_geometry)(device.pointer, abi::GEOMETRY_TRIANGLE);
            let quality = if recipe.refits { abi::QUALITY_REFIT } else { recipe.quality };
            (functions.set_geometry_quality)(geometry, quality);
            let (at, stride) = (positions.as_ptr().cast(), size_of::<Vec3A>());
            let count = positions.len();
            (functions.set_shared_buffer)(
                geometry,
                abi::BUFFER_VERTEX,
                0,
                abi::FORMAT_FLOAT3,
                at,
                0,
                stride,
                count,
            );
            let (at, count) = (indices.as_ptr().cast(), indices.len());
            (functions.set_shared_buffer)(
                geometry,
                abi::BUFFER_INDEX,
                0,
                abi::FORMAT_UINT3,
                at,
                0,
                12,
                count,
            );
            (functions.commit_geometry)(geometry);
            (functions.attach_geometry)(scene, geometry);
            (functions.release_geometry)(geometry);
            (functions.commit_scene)(scene);
            (scene, geometry)
        };
        let bytes = |bytes: i64| usize::try_from(bytes - before).unwrap_or(0);
        let (kept, peak) = (bytes(device.bytes.current()), bytes(device.bytes.peak()));
        let scene = Self { device, pointer, geometry, positions, _indices: indices, kept, peak };
        scene.device.check()?;
        Ok(scene)
    }

    /// Takes new places of the vertices and brings the boxes up to date.
    pub(super) fn refit(&mut self, positions: &[Vec3A]) -> Result<(), String> {
        let functions = self.functions();
        match Arc::get_mut(&mut self.positions) {
            Some(own) if own.len() == positions.len() => own.copy_from_slice(positions),
            _ => return Err("these are other triangles".into()),
        }
        // SAFETY: scene and geometry are alive, nobody traces, and the buffer lies where it was.
        unsafe {
            (functions.update_buffer)(self.geometry, abi::BUFFER_VERTEX, 0);
            (functions.commit_geometry)(self.geometry);
            (functions.commit_scene)(self.pointer);
        }
        self.device.check()
    }

    pub(super) fn functions(&self) -> Functions {
        self.device.library.functions
    }
}

impl Drop for Scene {
    fn drop(&mut self) {
        // SAFETY: made by `new_scene`, released once, before the memory that it reads.
        unsafe { (self.functions().release_scene)(self.pointer) };
    }
}

/// Copies of a scene in a scene of their own.
pub(super) struct Placed {
    pub(super) object: Scene,
    pub(super) pointer: abi::Scene,
    /// The instances; the scene owns them.
    instances: Vec<abi::Geometry>,
}

// SAFETY: as for `Scene`.
unsafe impl Send for Placed {}
// SAFETY: as for `Scene`.
unsafe impl Sync for Placed {}

impl Placed {
    pub(super) fn new(object: Scene, recipe: Recipe) -> Self {
        // SAFETY: the device is alive, and the object holds it.
        let pointer = unsafe { Self::empty(&object, recipe) };
        // SAFETY: just made. From now on rays may enter it: they find nothing.
        unsafe { (object.functions().commit_scene)(pointer) };
        Self { object, pointer, instances: Vec::new() }
    }

    /// # Safety
    /// The object's device is alive.
    unsafe fn empty(object: &Scene, recipe: Recipe) -> abi::Scene {
        let functions = object.functions();
        // SAFETY: the caller's promise.
        unsafe {
            let scene = (functions.new_scene)(object.device.pointer);
            (functions.set_scene_flags)(scene, recipe.flags);
            (functions.set_scene_quality)(scene, recipe.quality);
            scene
        }
    }

    /// Places the copies and builds the hierarchy over them.
    pub(super) fn place(&mut self, places: &[Affine3A], recipe: Recipe) -> Result<(), String> {
        let functions = self.object.functions();
        let device = self.object.device.pointer;
        if self.instances.len() > places.len() {
            // SAFETY: made by `empty`, released once; its instances go with it.
            unsafe { (functions.release_scene)(self.pointer) };
            // SAFETY: the object is alive.
            self.pointer = unsafe { Self::empty(&self.object, recipe) };
            self.instances.clear();
        }
        for (index, place) in places.iter().enumerate() {
            let columns: [f32; 12] = place.to_cols_array();
            // SAFETY: scenes and device are alive; twelve floats are read at once.
            unsafe {
                let instance = match self.instances.get(index) {
                    Some(&instance) => instance,
                    None => {
                        let instance = (functions.new_geometry)(device, abi::GEOMETRY_INSTANCE);
                        (functions.set_instanced_scene)(instance, self.object.pointer);
                        (functions.attach_geometry)(self.pointer, instance);
                        (functions.release_geometry)(instance);
                        self.instances.push(instance);
                        instance
                    }
                };
                let format = abi::FORMAT_FLOAT3X4_COLUMN_MAJOR;
                (functions.set_transform)(instance, 0, format, columns.as_ptr().cast());
                (functions.commit_geometry)(instance);
            }
        }
        // SAFETY: the scene is alive and nobody traces.
        unsafe { (functions.commit_scene)(self.pointer) };
        self.object.device.check()
    }
}

impl Drop for Placed {
    fn drop(&mut self) {
        // SAFETY: made by `empty`, released once, before the object.
        unsafe { (self.object.functions().release_scene)(self.pointer) };
    }
}
