//! The adapters that the tests run on.

use ropewalk_gpu::{Gpu, Tracer, TracerOptions, adapters, wgpu};
use std::sync::LazyLock;

/// An adapter with a tracer of each kind on it.
pub(crate) struct Machine {
    pub(crate) trusted: Tracer,
    pub(crate) checked: Tracer,
}

impl Machine {
    pub(crate) fn gpu(&self) -> &Gpu {
        self.trusted.gpu()
    }

    /// Whether this device rounds every operation as IEEE 754 says, as the CPU does. Graphics cards fuse
    /// multiplications with additions and divide by approximate reciprocals; llvmpipe's OpenGL reassociates.
    pub(crate) fn is_exact(&self) -> bool {
        self.gpu().is_software() && self.gpu().info().backend == wgpu::Backend::Vulkan
    }

    /// Another tracer on the same device.
    pub(crate) fn tracer(&self, change: impl FnOnce(&mut TracerOptions)) -> Tracer {
        let mut options = TracerOptions::default();
        change(&mut options);
        Tracer::with_options(self.gpu().clone(), options)
    }
}

static MACHINES: LazyLock<Vec<Machine>> = LazyLock::new(|| {
    let open = |index| {
        let gpu = Gpu::open(index).expect("an adapter that is listed opens");
        let mut options = TracerOptions::default();
        options.checked = true;
        Machine { trusted: Tracer::new(gpu.clone()), checked: Tracer::with_options(gpu, options) }
    };
    (0..adapters().len()).map(open).collect()
});

/// Runs a test on every adapter.
pub(crate) fn on_every_adapter(test: impl Fn(&Machine)) {
    if MACHINES.is_empty() {
        assert!(std::env::var_os("CI").is_none(), "CI is set and there is no adapter");
        println!("skipped: no adapter");
        return;
    }
    for machine in MACHINES.iter() {
        println!("on {}", machine.gpu().describe());
        test(machine);
    }
}
