//! What can go wrong on a graphics adapter, said before wgpu would panic over it.

use crate::AdapterSummary;
use crate::shader::AssemblyError;
use ropewalk::{CatalogueError, TraceError};
use thiserror::Error;

/// Why nothing was traced on an adapter.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum GpuError {
    /// There is no adapter at all.
    #[error(
        "no graphics adapter was found: install a Vulkan driver (Mesa's lavapipe needs no graphics card) or use the device cpu"
    )]
    NoAdapter,
    /// The adapter that was asked for is not there.
    #[error("there is no adapter '{wanted}'; there is {}", list(there))]
    NoSuchAdapter {
        /// The number, or the part of a name, that was asked for.
        wanted: String,
        /// The adapters that are there.
        there: Vec<AdapterSummary>,
    },
    /// The text names no device.
    #[error("there is no device '{0}'; the devices are auto, cpu, gpu, gpu:NUMBER and gpu:PART-OF-A-NAME")]
    NoSuchDevice(String),
    /// The adapter is there but gives no device.
    #[error("the adapter '{adapter}' gives no device: {reason}")]
    NoDevice {
        /// The adapter's name.
        adapter: String,
        /// What the driver said.
        reason: String,
    },
    /// A device's limit is below what every kernel needs.
    #[error(
        "the device allows {there} for {limit}, the kernels need {needed}: ask for a device with higher limits"
    )]
    LimitTooLow {
        /// The limit's name in wgpu.
        limit: &'static str,
        /// The least that the kernels need.
        needed: u64,
        /// What the device allows.
        there: u64,
    },
    /// A structure does not fit a buffer of the device.
    #[error(
        "the {what} need {needed} bytes, but the device allows {limit} bytes for {limit_name}: {way_out}"
    )]
    TooLarge {
        /// What does not fit.
        what: &'static str,
        /// Bytes that it needs.
        needed: u64,
        /// Bytes that the device allows.
        limit: u64,
        /// The limit's name in wgpu.
        limit_name: &'static str,
        /// What can be done.
        way_out: &'static str,
    },
    /// The device's memory is full.
    #[error(
        "the device has no memory left for {what} ({needed} bytes): free other structures, or trace on the CPU"
    )]
    OutOfMemory {
        /// What was to be stored.
        what: &'static str,
        /// Bytes that it needs.
        needed: u64,
    },
    /// The structure lies on another device than the tracer's.
    #[error("the structure was uploaded to another device: upload it with the tracer that traces it")]
    OtherDevice,
    /// The combination is not in the catalogue.
    #[error(transparent)]
    Catalogue(#[from] CatalogueError),
    /// The CPU did not trace.
    #[error(transparent)]
    Trace(TraceError),
    /// A shader could not be put together.
    #[error("a shader could not be put together: {0}")]
    Shader(#[from] AssemblyError),
    /// The device is gone.
    #[error("the device was lost: {0}; open it again")]
    DeviceLost(String),
    /// The device answered without writing every ray's result.
    #[error("the device left ray {ray} without an answer: it was reset, or its driver cut the work short")]
    Unanswered {
        /// The first such ray.
        ray: usize,
    },
    /// The same, of a point query.
    #[error(
        "the device left query {query} without an answer: it was reset, or its driver cut the work short"
    )]
    UnansweredQuery {
        /// The first such query.
        query: usize,
    },
    /// The search for a head did not come to its end.
    #[error(
        "the device left row {row} of the heads without an answer: its driver cut the search short; build the lists with heads on the CPU (list:heads=regular)"
    )]
    NoHead {
        /// The first such row.
        row: usize,
    },
    /// A point query wants more triangles than a kernel's list has room for.
    #[error(
        "k-nearest with k = {k}: a graphics adapter finds the nearest {limit} at most: ask for fewer, or use the device cpu"
    )]
    TooManyNearest {
        /// How many were asked for.
        k: usize,
        /// The most there may be.
        limit: usize,
    },
    /// The items of a program are not whole.
    #[error("{words} words are no items of {item_words} words each: give whole items to the program")]
    BrokenItems {
        /// Words that were given.
        words: usize,
        /// Words of an item.
        item_words: usize,
    },
    /// A table has no such words.
    #[error(
        "words {first} to {end} are to be written to a table of {there} words: write within it, or make another"
    )]
    OutsideTable {
        /// The first word.
        first: usize,
        /// The one behind the last.
        end: usize,
        /// The words of the table.
        there: usize,
    },
    /// An item of a program takes more turns than it may.
    #[error("item {item} is not done after {turns} turns: allow more, or let the program end")]
    Unfinished {
        /// The first such item.
        item: usize,
        /// The turns that it took.
        turns: u64,
    },
    /// wgpu or the driver refused something.
    #[error("the device refused {what}: {reason}")]
    Refused {
        /// What was attempted.
        what: &'static str,
        /// What wgpu or the driver said.
        reason: String,
    },
}

impl From<TraceError> for GpuError {
    fn from(error: TraceError) -> Self {
        match error {
            TraceError::Catalogue(error) => Self::Catalogue(error),
            other => Self::Trace(other),
        }
    }
}

fn list(adapters: &[AdapterSummary]) -> String {
    if adapters.is_empty() {
        return "none".into();
    }
    adapters.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
}
