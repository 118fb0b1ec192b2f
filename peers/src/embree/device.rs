//! Devices: a number of threads, a set of instructions, and a count of the bytes that their scenes take.
//!
//! Embree's threads belong to the process, and of all devices the largest number counts. So devices of another number of
//! threads are let go before one is made; scenes keep their own alive.

use super::abi;
use super::library::Library;
use std::ffi::{CString, c_void};
use std::sync::atomic::{AtomicI64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// Bytes of a device's scenes.
#[derive(Debug, Default)]
pub(super) struct Bytes {
    current: AtomicI64,
    peak: AtomicI64,
}

impl Bytes {
    pub(super) fn current(&self) -> i64 {
        self.current.load(Ordering::SeqCst)
    }

    pub(super) fn peak(&self) -> i64 {
        self.peak.load(Ordering::SeqCst)
    }

    pub(super) fn reset_peak(&self) {
        self.peak.store(self.current(), Ordering::SeqCst);
    }

    fn count(&self, bytes: i64) {
        let now = self.current.fetch_add(bytes, Ordering::SeqCst) + bytes;
        self.peak.fetch_max(now, Ordering::SeqCst);
    }
}

/// Embree's memory monitor.
unsafe extern "C" fn monitor(bytes: *mut c_void, count: isize, _post: bool) -> bool {
    // SAFETY: `Device::new` gave the address of a `Bytes` that lives until after the device was released.
    unsafe { &*bytes.cast::<Bytes>() }.count(count as i64);
    true
}

pub(super) struct Device {
    pub(super) library: Arc<Library>,
    pub(super) pointer: abi::Device,
    pub(super) bytes: Box<Bytes>,
}

// SAFETY: Embree's devices may be used from any thread.
unsafe impl Send for Device {}
// SAFETY: as above.
unsafe impl Sync for Device {}

impl Device {
    fn new(library: &Arc<Library>, threads: usize, options: &str) -> Result<Self, String> {
        let text = format!("threads={threads},set_affinity=0,start_threads=0,hugepages=1{options}");
        let text = CString::new(text).map_err(|error| error.to_string())?;
        // SAFETY: a text that ends with a zero; the library is open.
        let pointer = unsafe { (library.functions.new_device)(text.as_ptr()) };
        if pointer.is_null() {
            return Err("it makes no device on this processor".into());
        }
        let bytes = Box::<Bytes>::default();
        let address: *const Bytes = &raw const *bytes;
        // SAFETY: the address is that of a box that the device owns and that is dropped after it was released.
        unsafe { (library.functions.set_memory_monitor)(pointer, monitor, address.cast_mut().cast()) };
        Ok(Self { library: Arc::clone(library), pointer, bytes })
    }

    /// The last error of the device, if there was one.
    pub(super) fn check(&self) -> Result<(), String> {
        // SAFETY: the device is alive.
        match unsafe { (self.library.functions.device_error)(self.pointer) } {
            0 => Ok(()),
            4 => Err("out of memory".into()),
            code => Err(format!("error {code}")),
        }
    }

    /// Major, minor and patch.
    pub(super) fn version(&self) -> String {
        // SAFETY: the device is alive; properties 1 to 3 are the version's parts.
        let part = |property| unsafe { (self.library.functions.device_property)(self.pointer, property) };
        format!("{}.{}.{}", part(1), part(2), part(3))
    }
}

impl Drop for Device {
    fn drop(&mut self) {
        // SAFETY: made by `new_device`, released once; scenes hold the device, so none is left.
        unsafe { (self.library.functions.release_device)(self.pointer) };
    }
}

type Kept = (usize, &'static str, Arc<Device>);

/// The devices of a library that are in use.
pub(super) struct Devices {
    library: Arc<Library>,
    kept: Mutex<Vec<Kept>>,
}

impl Devices {
    pub(super) fn new(library: Library) -> Self {
        Self { library: Arc::new(library), kept: Mutex::default() }
    }

    pub(super) fn library(&self) -> &Library {
        &self.library
    }

    /// The device of so many threads and these options, and none of another number of threads.
    pub(super) fn get(&self, threads: usize, options: &'static str) -> Result<Arc<Device>, String> {
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        kept.retain(|(of, ..)| *of == threads);
        if let Some((.., device)) = kept.iter().find(|(_, with, _)| *with == options) {
            return Ok(Arc::clone(device));
        }
        let device = Arc::new(Device::new(&self.library, threads, options)?);
        kept.push((threads, options, Arc::clone(&device)));
        Ok(device)
    }
}
