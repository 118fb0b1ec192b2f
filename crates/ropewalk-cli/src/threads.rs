//! `--threads`: the pool in which the CPU works.

use crate::failure::Failure;

/// The most threads that may be asked for: far more than pay, far fewer than a system refuses.
pub(crate) const MOST_THREADS: i64 = 1024;

/// Runs `work` in a pool of so many threads; in a pool of all the machine's where no number is given.
pub(crate) fn run<T: Send>(
    threads: Option<u16>,
    work: impl FnOnce() -> Result<T, Failure> + Send,
) -> Result<T, Failure> {
    match threads {
        None => work(),
        Some(threads) => rayon::ThreadPoolBuilder::new()
            .num_threads(threads.into())
            .build()
            .map_err(|error| Failure::failed(format!("{threads} threads cannot be started: {error}")))?
            .install(work),
    }
}
