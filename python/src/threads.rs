//! Threads of the package's own.

use bramah::internals::compile::STACK;
use std::num::NonZero;

/// Acts with a pool that ends afterwards: threads of a pool that lasts are not there any more after a fork, and whoever
/// waits for them waits for ever.
pub fn pooled<T: Send>(act: impl FnOnce() -> T + Send) -> T {
    let threads = std::thread::available_parallelism().map_or(1, NonZero::get);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).stack_size(STACK).build();
    pool.expect("threads can be started").install(act)
}
