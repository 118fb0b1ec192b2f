//! How large a tile may be, by the limits of the device and by what is good for it.

use super::exchange::TIMESTAMP_BYTES;
use crate::shader::Kernel;
use crate::{Gpu, GpuError};

/// Bytes of hits that a tile of an all-hits batch aims at: a million hits. With two tiles under way, and as much
/// again to read each back, they take 128 MiB. One ray may need more, and gets it.
pub(super) const HIT_BYTES: u64 = 32 << 20;

/// The name of the limits that bound a buffer of rays or results.
const LIMIT_NAME: &str = "max_storage_buffer_binding_size and max_buffer_size";

/// The most that a tile may have.
#[derive(Clone, Copy, Debug)]
pub(super) struct TileLimits {
    /// Rays; at least one.
    pub(super) rays: usize,
    /// Bytes of results.
    pub(super) result_bytes: u64,
}

impl TileLimits {
    /// What the options or the kind of device say, and what every limit of the device allows.
    /// `record_words` are those of a ray or of its results, whichever are more.
    pub(super) fn new(gpu: &Gpu, record_words: usize, wanted: Option<u32>) -> Result<Self, GpuError> {
        let limits = gpu.device().limits();
        let wanted = match wanted {
            Some(wanted) => u64::from(wanted.max(1)),
            None if gpu.is_software() => 1 << 15,
            None => 1 << 18,
        };
        // What is read back has the timestamps behind it.
        let largest = limits
            .max_storage_buffer_binding_size
            .min(limits.max_buffer_size.saturating_sub(TIMESTAMP_BYTES));
        let bytes = (record_words * size_of::<u32>()) as u64;
        let by_groups =
            u64::from(limits.max_compute_workgroups_per_dimension) * u64::from(crate::gpu::WORKGROUP_SIZE);
        match wanted.min(largest / bytes).min(by_groups) {
            0 => Err(GpuError::TooLarge {
                what: "rays of the smallest batch",
                needed: bytes + TIMESTAMP_BYTES,
                limit: largest,
                limit_name: LIMIT_NAME,
                way_out: "ask for a device with higher limits",
            }),
            rays => Ok(Self { rays: rays as usize, result_bytes: largest }),
        }
    }

    /// The end of the tile that begins with the ray `first` of those with `hits` each: as many rays as fit. One ray's
    /// hits fit where the structure does, since a hit has fewer bytes than its triangle, but for a few bytes.
    pub(super) fn tile_end(&self, kernel: Kernel, hits: &[u32], first: usize) -> Result<usize, GpuError> {
        let ray_bytes = (kernel.result_words() * size_of::<u32>()) as u64;
        let hit_bytes = (Kernel::HIT_WORDS * size_of::<u32>()) as u64;
        let mut bytes = 0;
        for (index, &count) in hits.iter().enumerate().skip(first).take(self.rays) {
            let more = ray_bytes + hit_bytes * u64::from(count);
            if more > self.result_bytes {
                return Err(GpuError::TooLarge {
                    what: "hits of one ray",
                    needed: more,
                    limit: self.result_bytes,
                    limit_name: LIMIT_NAME,
                    way_out: "shorten the ray's window, ask for the count alone, or trace on the CPU",
                });
            }
            bytes += more;
            if index > first && bytes > self.result_bytes.min(HIT_BYTES) {
                return Ok(index);
            }
        }
        Ok(hits.len().min(first + self.rays))
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::shader::Tree;
    use ropewalk::{Query, Walk};

    pub(in crate::tracer) const ALL: Kernel = Kernel {
        tree: Tree::Binary,
        walk: Walk::Recursive,
        query: Query::All,
        counters: false,
        stack_entries: 8,
        starts: 0,
    };

    /// Tiles of rays with so many hits each.
    fn tiles(limits: TileLimits, hits: &[u32]) -> Result<Vec<usize>, GpuError> {
        let mut ends = vec![];
        while ends.last().copied().unwrap_or(0) < hits.len() {
            ends.push(limits.tile_end(ALL, hits, ends.last().copied().unwrap_or(0))?);
        }
        Ok(ends)
    }

    #[test]
    fn tiles_are_cut_where_their_hits_would_not_fit() {
        // A ray takes 16 bytes, a hit 32.
        let limits = TileLimits { rays: 3, result_bytes: 160 };
        assert_eq!(tiles(limits, &[1, 1, 1, 1]).unwrap(), [3, 4], "no more rays than a tile has");
        assert_eq!(tiles(limits, &[2, 2, 1, 4, 1]).unwrap(), [2, 3, 4, 5]);
        assert_eq!(tiles(limits, &[]).unwrap(), []);
        let large = TileLimits { rays: 100, result_bytes: u64::MAX };
        let most = (HIT_BYTES / 32) as u32;
        assert_eq!(
            tiles(large, &[most, 1, most, most * 4, 1]).unwrap(),
            [1, 2, 3, 4, 5],
            "one ray may have more"
        );
    }

    #[test]
    fn hits_that_fit_no_tile_are_an_error() {
        let error = tiles(TileLimits { rays: 3, result_bytes: 160 }, &[1, 5]).unwrap_err();
        assert!(
            matches!(error, GpuError::TooLarge { what: "hits of one ray", needed: 176, limit: 160, .. }),
            "{error:?}"
        );
        assert!(error.to_string().contains("CPU"), "{error}");
    }
}
