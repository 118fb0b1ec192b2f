//! Kernels of a caller's own: his WGSL in the frame of `kernel/program`, over any tree and walk.

use super::assembly::{AssemblyError, Definitions};
use super::constants::word;
use super::kernel::Kernel;
use super::library::ShaderLibrary;
use ropewalk::{Counters, Query};

/// The bind group of a program: both tables, and the scratch.
pub const PROGRAM_GROUP: u32 = 2;
/// The bit of an item's status that says that it has further turns to take.
pub const STATUS_UNFINISHED: u32 = 1 << 30;

/// Words of the counters behind an item's results.
const COUNTER_WORDS: usize = size_of::<Counters>() / size_of::<u32>();

/// A program as text: the caller's files, and how many words an item has of each kind.
///
/// The root file declares `fn begin(index: u32)` and `fn turn(index: u32) -> bool`; `kernel/program` says what they may call
/// and read. A turn that traces one ray, or a few, and keeps the rest in the scratch never meets a limit on loops or on time.
#[derive(Clone, Debug)]
pub struct ProgramSource {
    library: ShaderLibrary,
    root: String,
    definitions: Definitions,
    item_words: usize,
    result_words: usize,
    scratch_words: usize,
}

impl ProgramSource {
    /// A program whose root file is in a library that [extends](ShaderLibrary::with) the shipped one. Its rays have closest hits
    /// ([`ProgramSource::define`] chooses another collector), and its items one word of each kind.
    #[must_use]
    pub fn new(library: ShaderLibrary, root: impl Into<String>) -> Self {
        let definitions = Definitions::new();
        Self { library, root: root.into(), definitions, item_words: 1, result_words: 1, scratch_words: 1 }
    }

    /// Words of an item that it reads, that it answers, and that it keeps from turn to turn. Of none of them there may be none.
    #[must_use]
    pub fn with_words(mut self, item_words: usize, result_words: usize, scratch_words: usize) -> Self {
        self.item_words = item_words.max(1);
        self.result_words = result_words.max(1);
        self.scratch_words = scratch_words.max(1);
        self
    }

    /// Defines names for conditions and constants. `COLLECT` is the file of what becomes of hits: `shared/collect_closest` unless
    /// this says another, such as `shared/collect_filtered` with a function `accepts` of the program's.
    #[must_use]
    pub fn define(mut self, definitions: &Definitions) -> Self {
        self.definitions = self.definitions.and(definitions);
        self
    }

    /// Words of an item.
    #[must_use]
    pub const fn item_words(&self) -> usize {
        self.item_words
    }

    /// Words that the program answers an item with.
    #[must_use]
    pub const fn result_words(&self) -> usize {
        self.result_words
    }

    /// Words that the program keeps an item.
    #[must_use]
    pub const fn scratch_words(&self) -> usize {
        self.scratch_words
    }

    /// Words of the results as they lie in the buffer: the program's, the counters where there are any, and the status.
    pub(crate) const fn stored_words(&self, counters: bool) -> usize {
        self.result_words + if counters { COUNTER_WORDS } else { 0 } + 1
    }

    /// The program's WGSL over the tree and with the walk of a kernel.
    ///
    /// # Errors
    /// When a file or a constant is missing, or the catalogue has no such walk for closest hits.
    pub fn source(&self, kernel: Kernel) -> Result<String, AssemblyError> {
        let kernel = Kernel { query: Query::Closest, starts: 0, ..kernel };
        let definitions = kernel
            .definitions()
            .text("PROGRAM_GROUP", PROGRAM_GROUP)
            .text("STATUS_UNFINISHED", word(STATUS_UNFINISHED))
            .text("ITEM_WORDS", self.item_words)
            .text("RESULT_WORDS", self.stored_words(kernel.counters))
            .text("SCRATCH_WORDS", self.scratch_words)
            .text("PROGRAM", &self.root)
            .and(&self.definitions);
        self.library.assemble("kernel/program", &definitions)
    }

    /// The root file's name.
    #[must_use]
    pub fn root(&self) -> &str {
        &self.root
    }
}
