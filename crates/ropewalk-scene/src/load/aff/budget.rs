//! How much a file may unfold to. A few bytes can include a file again and again, or ask for a sphere of a thousand
//! triangles, so both the text that is read and the memory that is taken are counted and end at a limit.

/// What was loaded, and what became of it.
#[derive(Debug, Default)]
pub(super) struct Budget {
    /// The bytes of all files, each counted once.
    loaded: u64,
    text: u64,
    memory: u64,
}

impl Budget {
    /// The largest scene of the benchmark reads 11 MB of text, out of 2.4 MB of files. Reading this much takes seconds.
    const TEXT_ALWAYS: u64 = 256 << 20;
    const TEXT_RATIO: u64 = 8;
    /// What an include costs beside its bytes: to find a file takes as long as to read this many.
    const INCLUDE: u64 = 1024;
    /// 10,000 spheres, or a part of 10,000 triangles included 700 times.
    const MEMORY_ALWAYS: u64 = 512 << 20;
    /// A vertex is at least 6 bytes of text and becomes 36, a triangle 40; parts may be included a few times.
    const MEMORY_RATIO: u64 = 16;

    /// A file was loaded.
    pub(super) fn load(&mut self, bytes: usize) {
        self.loaded = self.loaded.saturating_add(bytes as u64);
    }

    /// A file is read, perhaps not for the first time; an error says how much may be.
    pub(super) fn read(&mut self, bytes: usize) -> Result<(), String> {
        let limit = self.loaded.saturating_mul(Self::TEXT_RATIO).saturating_add(Self::TEXT_ALWAYS);
        self.text = self.text.saturating_add(bytes as u64).saturating_add(Self::INCLUDE);
        if self.text <= limit {
            return Ok(());
        }
        Err(format!(
            "the includes unfold to more than {limit} bytes of text, the limit for files of {} bytes: \
             include fewer files, or split the scene",
            self.loaded
        ))
    }

    /// Memory is taken; an error says how much may be.
    pub(super) fn take(&mut self, bytes: usize) -> Result<(), String> {
        let limit = self.loaded.saturating_mul(Self::MEMORY_RATIO).saturating_add(Self::MEMORY_ALWAYS);
        self.memory = self.memory.saturating_add(bytes as u64);
        if self.memory <= limit {
            return Ok(());
        }
        Err(format!(
            "the scene takes more than {limit} bytes, the limit for files of {} bytes: \
             include fewer files, use fewer spheres, or split the scene",
            self.loaded
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_grow_with_what_is_loaded() {
        let mut budget = Budget::default();
        assert_eq!(budget.take(512 << 20), Ok(()));
        assert!(budget.take(1).unwrap_err().contains("limit for files of 0 bytes"));
        budget.load(1);
        assert_eq!(budget.take(15), Ok(()));
        assert!(budget.take(1).is_err());
    }

    #[test]
    fn empty_includes_are_not_free() {
        let mut budget = Budget::default();
        assert_eq!((0..256 << 10).try_for_each(|_| budget.read(0)), Ok(()));
        assert!(budget.read(0).unwrap_err().contains("bytes of text"));
    }
}
