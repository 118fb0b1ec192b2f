//! tinybvh, compiled from its header by `build.rs`, where there was one: its two layouts for processors, with binned and
//! with spatial splits.
//!
//! Builds run with denormals on: with denormals flushed it builds broken trees. It is told to use threads or not to; how many
//! it uses is its own choice. Memory is counted in the wrapper.

#[cfg(has_tinybvh)]
mod compiled;

use crate::Peers;

/// Adds its presets, or why they are not there.
#[cfg(has_tinybvh)]
pub(crate) fn find(peers: &mut Peers) {
    if std::arch::is_x86_feature_detected!("avx2")
        && std::arch::is_x86_feature_detected!("fma")
        && std::arch::is_x86_feature_detected!("bmi2")
    {
        peers.engines.extend(compiled::engines());
    } else {
        absent(peers, "this processor has no AVX2 with FMA");
    }
}

/// Adds why it is not there.
#[cfg(not(has_tinybvh))]
pub(crate) fn find(peers: &mut Peers) {
    absent(peers, "its header or a C++ compiler was not there when this program was built");
}

fn absent(peers: &mut Peers, why: &str) {
    peers.absent.push(crate::Absent { name: "tinybvh", why: why.into() });
}
