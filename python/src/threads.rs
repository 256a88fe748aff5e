//! The thread pool for work in parallel.

use bramah::internals::compile::STACK;
use std::num::NonZero;

/// Runs `act` with a thread pool that ends afterwards.
/// A permanent pool would not survive a fork of the process, as `multiprocessing` makes: its threads are gone in the
/// child,
/// and whoever waits for them waits forever.
pub fn pooled<T: Send>(act: impl FnOnce() -> T + Send) -> T {
    let threads = std::thread::available_parallelism().map_or(1, NonZero::get);
    // Threads of the pool compile models, which takes a deep stack.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).stack_size(STACK).build();
    pool.expect("threads can be started").install(act)
}
