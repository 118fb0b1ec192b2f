//! How much the pictures of a file may unfold to.
//!
//! A header of a few bytes can claim a picture of gigabytes, and PNG and JPEG pack an even colour a thousandfold. What a
//! header claims is taken from the budget before the picture is decoded, whether it turns out to be sound or not.

/// Texels taken so far.
#[derive(Debug, Default)]
pub(super) struct Budget {
    taken: u64,
    /// The bytes of all pictures so far.
    bytes: u64,
}

impl Budget {
    /// Texels that a picture may always have, in however few bytes: 4096 by 4096, 64 MiB.
    const ALONE: u64 = 16 << 20;
    /// Texels that the pictures of a file may always have together: eight of that size.
    const ALWAYS: u64 = 128 << 20;
    /// Photographs take a byte for 1 to 20 texels, drawings one for up to 100; no PNG of four bytes a texel takes less than one
    /// for 258.
    const RATIO: u64 = 256;
    /// The most that all pictures of a file may ever have, 4 GiB: several headers may stand for the same bytes.
    const MOST: u64 = 1 << 30;
    /// The longest side that is read; also what GPUs take.
    pub(super) const LONGEST: u32 = 16384;

    /// The most texels of a picture that is stored in `bytes` bytes.
    pub(super) fn most(bytes: usize) -> u64 {
        (bytes as u64).saturating_mul(Self::RATIO).saturating_add(Self::ALONE).min(Self::MOST)
    }

    /// Takes room for a picture that is stored in `bytes` bytes; an error says why there is none.
    pub(super) fn take(&mut self, width: u32, height: u32, bytes: usize) -> Result<(), String> {
        if width == 0 || height == 0 {
            return Err(format!("a picture of {width} by {height} texels is empty"));
        }
        if width.max(height) > Self::LONGEST {
            let longest = Self::LONGEST;
            return Err(format!(
                "a picture of {width} by {height} texels is larger than {longest} a side, the limit; scale it down"
            ));
        }
        let most = Self::most(bytes);
        if u64::from(width) * u64::from(height) > most {
            return Err(format!(
                "a picture of {width} by {height} texels has more than {most}, the limit for {bytes} bytes; scale it down"
            ));
        }
        self.bytes = self.bytes.saturating_add(bytes as u64);
        self.take_more(width, height)
    }

    /// Takes room for a picture that is made of others.
    pub(super) fn take_more(&mut self, width: u32, height: u32) -> Result<(), String> {
        let taken = self.taken.saturating_add(u64::from(width) * u64::from(height));
        let limit = self.bytes.saturating_mul(Self::RATIO).saturating_add(Self::ALWAYS).min(Self::MOST);
        if taken > limit {
            return Err(format!(
                "the pictures have more than {limit} texels together, the limit for {} bytes of them; scale them down",
                self.bytes
            ));
        }
        self.taken = taken;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_kept_over_all_pictures() {
        let mut budget = Budget::default();
        for _ in 0..8 {
            assert_eq!(budget.take(4096, 4096, 0), Ok(()));
        }
        assert!(budget.take(1, 1, 0).unwrap_err().contains("limit for 0 bytes of them"));
        assert_eq!(budget.take(1, 254, 1), Ok(()));
        assert!(budget.take_more(3, 1).is_err());
        assert_eq!(budget.take_more(2, 1), Ok(()));
        // One picture alone.
        assert!(Budget::default().take(4096, 4097, 15).unwrap_err().contains("limit for 15 bytes;"));
        assert_eq!(Budget::default().take(4096, 4097, 16), Ok(()));
        let mut budget = Budget::default();
        let taken = (0..10).take_while(|_| budget.take(16384, 16384, 1 << 30).is_ok()).count();
        assert_eq!(taken, 4, "whatever the files hold");
        for (width, height, word) in [(16385, 1, "16384"), (0, 1, "empty"), (1, u32::MAX, "16384")] {
            assert!(Budget::default().take(width, height, 100).unwrap_err().contains(word));
        }
    }
}
