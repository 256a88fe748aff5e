//! Threads of the package's own.

use std::num::NonZero;

/// Deeply nested models recurse; the interpreter's stack is too small for the deepest that are accepted.
const STACK: usize = 1 << 28;

/// Acts on a thread with a deep stack.
pub fn deep<T: Send>(act: impl FnOnce() -> T + Send) -> T {
    std::thread::scope(|scope| {
        let thread = std::thread::Builder::new().stack_size(STACK).spawn_scoped(scope, act);
        let thread = thread.expect("a thread can be started");
        thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    })
}

/// Acts with a pool that ends afterwards: threads of a pool that lasts are not there any more after a fork, and whoever
/// waits for them waits for ever.
pub fn pooled<T: Send>(act: impl FnOnce() -> T + Send) -> T {
    let threads = std::thread::available_parallelism().map_or(1, NonZero::get);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).stack_size(STACK).build();
    pool.expect("threads can be started").install(act)
}
