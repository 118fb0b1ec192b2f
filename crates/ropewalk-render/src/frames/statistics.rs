//! What a frame took.

use super::structure::Followed;
use crate::statistics::Statistics;
use serde::Serialize;
use std::time::Duration;

/// What a frame took: for tables, and as a line of JSON.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct FrameStatistics {
    /// Its number in the animation.
    pub frame: u32,
    /// Its time.
    pub time: f64,
    /// Instances that were moved, hidden or shown since the frame that was rendered before.
    pub instances_moved: usize,
    /// Objects whose structure followed their shape.
    pub objects_refitted: usize,
    /// Objects whose structure was built anew.
    pub objects_rebuilt: usize,
    /// Milliseconds for the pose and the structure, while the frame before was rendered.
    pub update_ms: f64,
    /// Bytes that were sent to a graphics adapter for the structure.
    pub upload_bytes: u64,
    /// Milliseconds that this took.
    pub upload_ms: f64,
    /// Milliseconds for the picture.
    pub render_ms: f64,
    /// Rays from the eye.
    pub primary_rays: u64,
    /// Rays to lights.
    pub shadow_rays: u64,
    /// Short rays into the sky.
    pub ambient_rays: u64,
    /// Rays into mirrors.
    pub reflected_rays: u64,
    /// Rays through glass.
    pub refracted_rays: u64,
    /// Rays that were not followed since they would have gone too deep.
    pub cut_by_depth: u64,
    /// Rays that were not followed since they would have carried too little light.
    pub cut_by_weight: u64,
    /// Rays without a complete answer.
    pub incomplete_rays: u64,
    /// The memory of the program that is in use, where the system tells.
    pub resident_bytes: Option<u64>,
}

impl FrameStatistics {
    pub(super) fn follow(&mut self, followed: Followed, time: Duration) {
        let Followed { instances_moved, objects_refitted, objects_rebuilt } = followed;
        (self.instances_moved, self.objects_refitted) = (instances_moved, objects_refitted);
        self.objects_rebuilt = objects_rebuilt;
        self.update_ms = milliseconds(time);
    }

    pub(super) fn render(&mut self, statistics: &Statistics, time: Duration) {
        self.render_ms = milliseconds(time);
        self.primary_rays = statistics.primary_rays;
        self.shadow_rays = statistics.shadow_rays;
        self.ambient_rays = statistics.ambient_rays;
        self.reflected_rays = statistics.reflected_rays;
        self.refracted_rays = statistics.refracted_rays;
        self.cut_by_depth = statistics.cut_by_depth;
        self.cut_by_weight = statistics.cut_by_weight;
        self.incomplete_rays = statistics.incomplete.rays;
    }
}

pub(super) fn milliseconds(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}

/// How much memory of this program is in use, where the system tells (Linux does).
#[must_use]
pub fn resident_bytes() -> Option<u64> {
    resident(&std::fs::read_to_string("/proc/self/status").ok()?)
}

fn resident(status: &str) -> Option<u64> {
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kibibytes.checked_mul(1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_is_read_where_the_system_tells() {
        assert_eq!(resident("Name:\tx\nVmRSS:\t    1234 kB\nVmData: 5 kB\n"), Some(1234 * 1024));
        for other in ["", "VmRSS:\t12 MB\n", "VmRSS: many kB\n", "VmRSS: 99999999999999999999 kB\n"] {
            assert_eq!(resident(other), None, "{other}");
        }
        #[cfg(target_os = "linux")]
        assert!(resident_bytes().is_some_and(|bytes| bytes > 100_000));
    }
}
