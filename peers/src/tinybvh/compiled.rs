//! The wrapper's functions, and the engine over them.

use crate::flush::Flushed;
use ropewalk::glam::{Affine3A, Mat4, Vec3A};
use ropewalk::{Hit, Ray};
use ropewalk_lab::arena::{Engine, EngineError, Grade, Mode, RaySet, Refitter, Shape, TopLevel, Tracer};
use std::ffi::c_void;
use std::mem::offset_of;
use std::ops::Range;
use std::ptr::NonNull;
use std::sync::Arc;

/// Where the fields of answers lie, `stride` bytes apart.
#[repr(C)]
struct Output {
    t: *mut u8,
    uv: *mut u8,
    primitive: *mut u8,
    instance: *mut u8,
    stride: usize,
}

unsafe extern "C" {
    fn ropewalk_tinybvh_bytes() -> i64;
    fn ropewalk_tinybvh_peak() -> i64;
    fn ropewalk_tinybvh_reset_peak();
    fn ropewalk_tinybvh_build(
        width: u32,
        quality: bool,
        threaded: bool,
        vertices: *const f32,
        triangles: u32,
    ) -> *mut c_void;
    fn ropewalk_tinybvh_free(tree: *mut c_void);
    fn ropewalk_tinybvh_size(tree: *mut c_void) -> u64;
    fn ropewalk_tinybvh_closest(tree: *mut c_void, rays: *const Ray, count: usize, output: *const Output);
    fn ropewalk_tinybvh_any(tree: *mut c_void, rays: *const Ray, count: usize, hits: *mut bool);
    fn ropewalk_tinybvh_refit(tree: *mut c_void);
    fn ropewalk_tinybvh_copies(tree: *mut c_void) -> *mut c_void;
    fn ropewalk_tinybvh_free_copies(copies: *mut c_void);
    fn ropewalk_tinybvh_place(copies: *mut c_void, places: *const f32, count: usize);
    fn ropewalk_tinybvh_among(copies: *mut c_void, rays: *const Ray, count: usize, output: *const Output);
}

impl Output {
    /// Into the hits themselves.
    fn of(hits: &mut [Hit]) -> Self {
        let base: *mut u8 = hits.as_mut_ptr().cast();
        let field = |offset: usize| base.wrapping_add(offset);
        Self {
            t: field(offset_of!(Hit, t)),
            uv: field(offset_of!(Hit, barycentrics)),
            primitive: field(offset_of!(Hit, primitive_index)),
            instance: field(offset_of!(Hit, instance_index)),
            stride: size_of::<Hit>(),
        }
    }
}

const _: () = assert!(size_of::<Ray>() == 36, "the wrapper's rays are 36 bytes");

pub(super) fn engines() -> Vec<Box<dyn Engine>> {
    let engine = |preset, grade, width, quality| Box::new(TinyBvh { preset, grade, width, quality });
    vec![
        engine("bvh4-cpu binned", Grade::Balanced, 4, false),
        engine("bvh4-cpu sbvh", Grade::High, 4, true),
        engine("bvh8-cpu binned", Grade::Balanced, 8, false),
        engine("bvh8-cpu sbvh", Grade::High, 8, true),
    ]
}

struct TinyBvh {
    preset: &'static str,
    grade: Grade,
    width: u32,
    quality: bool,
}

impl TinyBvh {
    fn tree(&self, corners: Arc<[Vec3A]>, threads: usize) -> Result<Tree, EngineError> {
        let triangles = u32::try_from(corners.len() / 3).unwrap_or(u32::MAX);
        // Its own limit: 28 bits of a child word, in units of cache lines. It would end the program beyond.
        if triangles == 0 || triangles > 1 << 25 {
            return Err(self.error(format!("{triangles} triangles; it takes 1 to {}", 1 << 25)));
        }
        // SAFETY: counters without arguments.
        let before = unsafe {
            ropewalk_tinybvh_reset_peak();
            ropewalk_tinybvh_bytes()
        };
        // SAFETY: `corners` holds three times four floats a triangle, and the tree keeps it alive.
        let pointer = unsafe {
            ropewalk_tinybvh_build(self.width, self.quality, threads > 1, corners.as_ptr().cast(), triangles)
        };
        // SAFETY: a counter without arguments.
        let peak = unsafe { ropewalk_tinybvh_peak() } - before;
        let pointer = NonNull::new(pointer).ok_or_else(|| self.error("it built nothing"))?;
        Ok(Tree { pointer, corners, peak: usize::try_from(peak).unwrap_or(0) })
    }
}

impl Engine for TinyBvh {
    fn name(&self) -> &str {
        "tinybvh 1.6.8"
    }

    fn preset(&self) -> &str {
        self.preset
    }

    fn is_peer(&self) -> bool {
        true
    }

    fn grade(&self) -> Grade {
        self.grade
    }

    fn build(&self, shape: &Shape, threads: usize) -> Result<Box<dyn Tracer>, EngineError> {
        Ok(Box::new(self.tree(shape.aligned_corners(), threads)?))
    }

    fn refitter(&self, shape: &Shape, threads: usize) -> Option<Result<Box<dyn Refitter>, EngineError>> {
        // A tree with spatial splits cannot follow.
        if self.quality {
            return None;
        }
        // Its own copy, into which the moved corners are written.
        let tree = self.tree(shape.aligned_corners().iter().copied().collect(), threads);
        Some(tree.map(|tree| Box::new(Moving(tree)) as Box<dyn Refitter>))
    }

    fn top_level(&self, object: &Shape, threads: usize) -> Option<Result<Box<dyn TopLevel>, EngineError>> {
        if self.quality {
            return None;
        }
        let copies = |tree: Tree| {
            // SAFETY: the tree is alive, and `Copies` keeps it so.
            let pointer = unsafe { ropewalk_tinybvh_copies(tree.pointer.as_ptr()) };
            let pointer = NonNull::new(pointer).ok_or_else(|| self.error("it placed nothing"))?;
            Ok(Box::new(Copies { pointer, _tree: tree }) as Box<dyn TopLevel>)
        };
        Some(self.tree(object.aligned_corners(), threads).and_then(copies))
    }
}

/// A tree of the wrapper, and what it was built of, which it points into.
struct Tree {
    pointer: NonNull<c_void>,
    corners: Arc<[Vec3A]>,
    peak: usize,
}

// SAFETY: the pointer is the only one to its tree. Through `&self` it is only traced, which changes nothing of it.
unsafe impl Send for Tree {}
// SAFETY: as above.
unsafe impl Sync for Tree {}

impl Drop for Tree {
    fn drop(&mut self) {
        // SAFETY: made by `ropewalk_tinybvh_build`, freed once.
        unsafe { ropewalk_tinybvh_free(self.pointer.as_ptr()) };
    }
}

impl Tracer for Tree {
    fn bytes(&self) -> Option<usize> {
        // SAFETY: the tree is alive.
        usize::try_from(unsafe { ropewalk_tinybvh_size(self.pointer.as_ptr()) }).ok()
    }

    fn peak_bytes(&self) -> Option<usize> {
        Some(self.peak)
    }

    fn modes(&self) -> &[Mode] {
        &[Mode::Single]
    }

    fn closest(&self, _: Mode, rays: &RaySet, range: Range<usize>, hits: &mut [Hit]) {
        let Some(rays) = rays.rays.get(range) else { return };
        let _flushed = Flushed::new();
        let count = rays.len().min(hits.len());
        // SAFETY: `count` rays are read and as many hits written, at the offsets of their own fields.
        unsafe {
            ropewalk_tinybvh_closest(self.pointer.as_ptr(), rays.as_ptr(), count, &Output::of(hits));
        }
    }

    fn any(&self, _: Mode, rays: &RaySet, range: Range<usize>, hits: &mut [bool]) {
        let Some(rays) = rays.rays.get(range) else { return };
        let _flushed = Flushed::new();
        let count = rays.len().min(hits.len());
        // SAFETY: `count` rays are read and as many `bool`s written, each 0 or 1.
        unsafe { ropewalk_tinybvh_any(self.pointer.as_ptr(), rays.as_ptr(), count, hits.as_mut_ptr()) };
    }
}

struct Moving(Tree);

impl Refitter for Moving {
    fn refit(&mut self, moved: &Shape) -> Result<(), EngineError> {
        let to = moved.aligned_corners();
        match Arc::get_mut(&mut self.0.corners) {
            Some(own) if own.len() == to.len() => own.copy_from_slice(&to),
            _ => {
                return Err(EngineError {
                    engine: "tinybvh".into(),
                    what: "these are other triangles".into(),
                });
            }
        }
        // SAFETY: the tree is alive and nobody else has it; its vertices lie where they were.
        unsafe { ropewalk_tinybvh_refit(self.0.pointer.as_ptr()) };
        Ok(())
    }
}

struct Copies {
    pointer: NonNull<c_void>,
    /// Freed after what points to it.
    _tree: Tree,
}

// SAFETY: as for `Tree`; `place` needs `&mut self`.
unsafe impl Send for Copies {}
// SAFETY: as above.
unsafe impl Sync for Copies {}

impl Drop for Copies {
    fn drop(&mut self) {
        // SAFETY: made by `ropewalk_tinybvh_copies`, freed once.
        unsafe { ropewalk_tinybvh_free_copies(self.pointer.as_ptr()) };
    }
}

impl TopLevel for Copies {
    fn place(&mut self, places: &[Affine3A]) -> Result<(), EngineError> {
        if places.is_empty() {
            return Err(EngineError { engine: "tinybvh".into(), what: "it needs one copy at least".into() });
        }
        // Row by row, where ours are column by column.
        let rows: Vec<Mat4> = places.iter().map(|place| Mat4::from(*place).transpose()).collect();
        // SAFETY: 16 floats a place are read; nobody else has the copies.
        unsafe { ropewalk_tinybvh_place(self.pointer.as_ptr(), rows.as_ptr().cast(), rows.len()) };
        Ok(())
    }

    fn modes(&self) -> &[Mode] {
        &[Mode::Single]
    }

    fn closest(&self, _: Mode, rays: &RaySet, range: Range<usize>, hits: &mut [Hit]) {
        let Some(rays) = rays.rays.get(range) else { return };
        let _flushed = Flushed::new();
        let count = rays.len().min(hits.len());
        // SAFETY: as in `Tree::closest`.
        unsafe { ropewalk_tinybvh_among(self.pointer.as_ptr(), rays.as_ptr(), count, &Output::of(hits)) };
    }
}
