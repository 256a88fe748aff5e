//! Stacks that are deep enough.

/// Bytes of a thread that compiles: deeply nested models recurse, and the stacks that threads have by themselves are too
/// small for the deepest that are accepted.
pub const STACK: usize = 1 << 28;

/// Acts on a thread with a deep stack; the caller's may be of any size.
pub fn deep<T: Send>(act: impl FnOnce() -> T + Send) -> T {
    std::thread::scope(|scope| {
        let thread = std::thread::Builder::new().stack_size(STACK).spawn_scoped(scope, act);
        let thread = thread.expect("a thread can be started");
        thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    })
}
