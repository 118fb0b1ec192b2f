//! Foreign engines in the arena of `ropewalk-lab`: `ropewalk bench --peers`.
//!
//! | file | engine | from |
//! |---|---|---|
//! | `obvhs` | obvhs 0.4.0: binary BVH and CWBVH | crates.io |
//! | `bvh` | bvh 0.13.0 | crates.io |
//! | `parry` | parry3d 0.31.1 | crates.io |
//! | `tinybvh` | tinybvh, the header inside tinybvh-rs 0.1.0-beta.3: BVH4_CPU and BVH8_CPU | compiled by `build.rs` |
//! | `embree` | Embree 3 and 4 | opened at run time |
//! | `instruments` | processor time and allocated bytes | the system |
//! | `flush` | denormals as zeros while peers trace | |
//!
//! Whether a peer is there is a value: [`engines`] gives those that are, and says why others are not. Built for the
//! processor at hand (`RUSTFLAGS="-C target-cpu=native"`) the peers from crates.io are at their best; Embree and tinybvh are
//! so in any build.
//!
//! **Unsafe code** stands in `instruments`, `flush`, `tinybvh` and `embree`, which says at each place why it is sound.

mod bvh;
mod embree;
mod flush;
mod instruments;
mod obvhs;
mod parry;
mod tinybvh;

pub use instruments::{CountingAllocator, SystemInstruments};

use ropewalk_lab::arena::Engine;
use std::path::PathBuf;

/// Where libraries are looked for first.
#[derive(Clone, Debug, Default)]
pub struct Places {
    /// Embree 3, `libembree3.so.3` or so.
    pub embree3: Option<PathBuf>,
    /// Embree 4, `libembree4.so.4` or so.
    pub embree4: Option<PathBuf>,
}

/// A peer that is not there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Absent {
    /// Its name.
    pub name: &'static str,
    /// Why.
    pub why: String,
}

/// The peers of this machine.
#[derive(Default)]
pub struct Peers {
    /// Those that can be measured, with each of their presets.
    pub engines: Vec<Box<dyn Engine>>,
    /// The others.
    pub absent: Vec<Absent>,
}

/// Finds every peer that there is.
#[must_use]
pub fn engines(places: &Places) -> Peers {
    let mut peers = Peers::default();
    embree::find(places, &mut peers);
    tinybvh::find(&mut peers);
    peers.engines.extend(obvhs::engines());
    peers.engines.extend(parry::engines());
    peers.engines.extend(bvh::engines());
    peers
}
