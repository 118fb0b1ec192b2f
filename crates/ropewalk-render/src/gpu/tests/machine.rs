//! The adapter that the tests run on: one that rounds as IEEE 754 says, as lavapipe does.

use ropewalk_gpu::{Gpu, Tracer, adapters, wgpu};
use std::sync::LazyLock;

static TRACER: LazyLock<Option<Tracer>> = LazyLock::new(|| {
    (0..adapters().len())
        .filter_map(|index| Gpu::open(index).ok())
        .find(|gpu| gpu.is_software() && gpu.info().backend == wgpu::Backend::Vulkan)
        .map(Tracer::new)
});

/// The tracer of an adapter whose bits are the CPU's; without one the test is skipped, but not where `CI` is set.
pub(super) fn exact_tracer() -> Option<&'static Tracer> {
    if TRACER.is_none() {
        assert!(std::env::var_os("CI").is_none(), "CI is set and there is no exact adapter");
        println!("skipped: no adapter that rounds as the CPU does");
    }
    TRACER.as_ref()
}
