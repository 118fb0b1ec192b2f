//! The memory that Embree's functions read and write, after its headers `rtcore_ray.h`, `rtcore_common.h` and
//! `rtcore_scene.h` (3.13 and 4.4), and the functions themselves.

use std::ffi::{c_char, c_int, c_uint, c_void};

pub(super) type Device = *mut c_void;
pub(super) type Scene = *mut c_void;
pub(super) type Geometry = *mut c_void;

pub(super) const INVALID: u32 = u32::MAX;
pub(super) const GEOMETRY_TRIANGLE: c_uint = 0;
pub(super) const GEOMETRY_INSTANCE: c_uint = 121;
pub(super) const BUFFER_INDEX: c_uint = 0;
pub(super) const BUFFER_VERTEX: c_uint = 1;
pub(super) const FORMAT_UINT3: c_uint = 0x5003;
pub(super) const FORMAT_FLOAT3: c_uint = 0x9003;
pub(super) const FORMAT_FLOAT3X4_COLUMN_MAJOR: c_uint = 0x9234;
pub(super) const QUALITY_LOW: c_uint = 0;
pub(super) const QUALITY_MEDIUM: c_uint = 1;
pub(super) const QUALITY_HIGH: c_uint = 2;
pub(super) const QUALITY_REFIT: c_uint = 3;
pub(super) const SCENE_DYNAMIC: c_uint = 1;
pub(super) const SCENE_COMPACT: c_uint = 2;
pub(super) const SCENE_ROBUST: c_uint = 4;

/// A ray.
#[repr(C, align(16))]
#[derive(Clone, Copy)]
pub(super) struct RtcRay {
    pub(super) origin: [f32; 3],
    pub(super) t_near: f32,
    pub(super) dir: [f32; 3],
    pub(super) time: f32,
    pub(super) t_far: f32,
    pub(super) mask: u32,
    pub(super) id: u32,
    pub(super) flags: u32,
}

/// A ray and its hit. Version 3 knows nothing of `instance_primitive`, and writes nothing there.
#[repr(C, align(16))]
#[derive(Clone, Copy)]
pub(super) struct RtcRayHit {
    pub(super) ray: RtcRay,
    pub(super) normal: [f32; 3],
    pub(super) u: f32,
    pub(super) v: f32,
    pub(super) primitive: u32,
    pub(super) geometry: u32,
    pub(super) instance: u32,
    pub(super) instance_primitive: u32,
}

/// A packet of rays, lane by lane.
#[repr(C, align(64))]
#[derive(Clone, Copy)]
pub(super) struct RtcRays<const N: usize> {
    pub(super) origin: [[f32; N]; 3],
    pub(super) t_near: [f32; N],
    pub(super) dir: [[f32; N]; 3],
    pub(super) time: [f32; N],
    pub(super) t_far: [f32; N],
    pub(super) mask: [u32; N],
    pub(super) id: [u32; N],
    pub(super) flags: [u32; N],
}

/// A packet of rays and their hits.
#[repr(C, align(64))]
#[derive(Clone, Copy)]
pub(super) struct RtcRayHits<const N: usize> {
    pub(super) rays: RtcRays<N>,
    pub(super) normal: [[f32; N]; 3],
    pub(super) u: [f32; N],
    pub(super) v: [f32; N],
    pub(super) primitive: [u32; N],
    pub(super) geometry: [u32; N],
    pub(super) instance: [u32; N],
    pub(super) instance_primitive: [u32; N],
}

/// Which lanes are rays: -1, or 0.
#[repr(C, align(64))]
#[derive(Clone, Copy)]
pub(super) struct Valid<const N: usize>(pub(super) [c_int; N]);

/// What version 4 takes along with rays; as `rtcInitIntersectArguments` makes it.
#[repr(C)]
pub(super) struct Arguments4 {
    pub(super) flags: u32,
    pub(super) feature_mask: u32,
    pub(super) context: *mut c_void,
    pub(super) filter: *const c_void,
    pub(super) function: *const c_void,
    pub(super) min_width_distance_factor: f32,
}

/// `RTC_RAY_QUERY_FLAG_COHERENT` of version 4.
const COHERENT_4: u32 = 1 << 16;
/// `RTC_INTERSECT_CONTEXT_FLAG_COHERENT` of version 3.
const COHERENT_3: u32 = 1;

impl Arguments4 {
    pub(super) fn coherent() -> Self {
        Self {
            flags: COHERENT_4,
            feature_mask: u32::MAX,
            context: std::ptr::null_mut(),
            filter: std::ptr::null(),
            function: std::ptr::null(),
            min_width_distance_factor: 0.0,
        }
    }
}

/// The context of version 3, with room to spare for what a library may have been configured to put there.
#[repr(C, align(16))]
pub(super) struct Context3 {
    flags: u32,
    filter: *const c_void,
    instance: u32,
    spare: [u32; 16],
}

impl Context3 {
    pub(super) fn new(coherent: bool) -> Self {
        let flags = if coherent { COHERENT_3 } else { 0 };
        Self { flags, filter: std::ptr::null(), instance: INVALID, spare: [0; 16] }
    }
}

pub(super) type MemoryMonitor = unsafe extern "C" fn(*mut c_void, isize, bool) -> bool;

macro_rules! functions {
    ($( $name:ident : $symbol:literal = fn($($argument:ty),*) $(-> $result:ty)? ; )*) => {
        /// The functions that both versions have.
        #[derive(Clone, Copy)]
        pub(super) struct Functions {
            $( pub(super) $name: unsafe extern "C" fn($($argument),*) $(-> $result)?, )*
        }

        impl Functions {
            /// # Safety
            /// The library is Embree 3 or 4, and stays open as long as the functions are used.
            pub(super) unsafe fn load(library: &libloading::Library) -> Result<Self, libloading::Error> {
                // SAFETY: the types are those of the headers; the caller says that it is the library.
                unsafe { Ok(Self { $( $name: *library.get($symbol)?, )* }) }
            }
        }
    };
}

functions! {
    new_device: b"rtcNewDevice\0" = fn(*const c_char) -> Device;
    release_device: b"rtcReleaseDevice\0" = fn(Device);
    device_property: b"rtcGetDeviceProperty\0" = fn(Device, c_uint) -> isize;
    device_error: b"rtcGetDeviceError\0" = fn(Device) -> c_uint;
    set_memory_monitor: b"rtcSetDeviceMemoryMonitorFunction\0" = fn(Device, MemoryMonitor, *mut c_void);
    new_scene: b"rtcNewScene\0" = fn(Device) -> Scene;
    release_scene: b"rtcReleaseScene\0" = fn(Scene);
    set_scene_flags: b"rtcSetSceneFlags\0" = fn(Scene, c_uint);
    set_scene_quality: b"rtcSetSceneBuildQuality\0" = fn(Scene, c_uint);
    // Not `rtcCommitScene`: that works in the task arena of the calling thread, whose worker TBB then lets spin on the second core
    // while others are measured. Joined, it works in the arena of the device.
    commit_scene: b"rtcJoinCommitScene\0" = fn(Scene);
    new_geometry: b"rtcNewGeometry\0" = fn(Device, c_uint) -> Geometry;
    release_geometry: b"rtcReleaseGeometry\0" = fn(Geometry);
    set_geometry_quality: b"rtcSetGeometryBuildQuality\0" = fn(Geometry, c_uint);
    set_shared_buffer: b"rtcSetSharedGeometryBuffer\0"
        = fn(Geometry, c_uint, c_uint, c_uint, *const c_void, usize, usize, usize);
    update_buffer: b"rtcUpdateGeometryBuffer\0" = fn(Geometry, c_uint, c_uint);
    commit_geometry: b"rtcCommitGeometry\0" = fn(Geometry);
    attach_geometry: b"rtcAttachGeometry\0" = fn(Scene, Geometry) -> c_uint;
    set_instanced_scene: b"rtcSetGeometryInstancedScene\0" = fn(Geometry, Scene);
    set_transform: b"rtcSetGeometryTransform\0" = fn(Geometry, c_uint, c_uint, *const c_void);
}

/// The queries of version 3.
#[derive(Clone, Copy)]
pub(super) struct Queries3 {
    pub(super) intersect1: unsafe extern "C" fn(Scene, *mut Context3, *mut RtcRayHit),
    pub(super) occluded1: unsafe extern "C" fn(Scene, *mut Context3, *mut RtcRay),
    pub(super) intersect8: unsafe extern "C" fn(*const Valid<8>, Scene, *mut Context3, *mut RtcRayHits<8>),
    pub(super) occluded8: unsafe extern "C" fn(*const Valid<8>, Scene, *mut Context3, *mut RtcRays<8>),
    pub(super) intersect16: unsafe extern "C" fn(*const Valid<16>, Scene, *mut Context3, *mut RtcRayHits<16>),
    pub(super) occluded16: unsafe extern "C" fn(*const Valid<16>, Scene, *mut Context3, *mut RtcRays<16>),
}

/// The queries of version 4.
#[derive(Clone, Copy)]
pub(super) struct Queries4 {
    pub(super) intersect1: unsafe extern "C" fn(Scene, *mut RtcRayHit, *mut Arguments4),
    pub(super) occluded1: unsafe extern "C" fn(Scene, *mut RtcRay, *mut Arguments4),
    pub(super) intersect8: unsafe extern "C" fn(*const Valid<8>, Scene, *mut RtcRayHits<8>, *mut Arguments4),
    pub(super) occluded8: unsafe extern "C" fn(*const Valid<8>, Scene, *mut RtcRays<8>, *mut Arguments4),
    pub(super) intersect16:
        unsafe extern "C" fn(*const Valid<16>, Scene, *mut RtcRayHits<16>, *mut Arguments4),
    pub(super) occluded16: unsafe extern "C" fn(*const Valid<16>, Scene, *mut RtcRays<16>, *mut Arguments4),
}

/// The queries of either version.
#[derive(Clone, Copy)]
pub(super) enum Queries {
    Three(Queries3),
    Four(Queries4),
}

macro_rules! load {
    ($library:expr, $type:ident) => {
        $type {
            intersect1: *$library.get(b"rtcIntersect1\0")?,
            occluded1: *$library.get(b"rtcOccluded1\0")?,
            intersect8: *$library.get(b"rtcIntersect8\0")?,
            occluded8: *$library.get(b"rtcOccluded8\0")?,
            intersect16: *$library.get(b"rtcIntersect16\0")?,
            occluded16: *$library.get(b"rtcOccluded16\0")?,
        }
    };
}

impl Queries {
    /// # Safety
    /// The library is Embree of this version, and stays open as long as the functions are used.
    pub(super) unsafe fn load(
        library: &libloading::Library,
        version: u32,
    ) -> Result<Self, libloading::Error> {
        // SAFETY: the types are those of the headers of this version; the caller says that it is.
        unsafe {
            Ok(match version {
                3 => Self::Three(load!(library, Queries3)),
                _ => Self::Four(load!(library, Queries4)),
            })
        }
    }
}
