//! Threads with stacks that are deep enough to compile.
//!
//! The parser and the instance recurse as deeply as a model is nested.

/// The size in bytes of the stack of a thread that compiles. The default size of threads is too small for the deepest
/// models that are accepted. The operating system provides memory only for what is used.
pub const STACK: usize = 1 << 28;

/// Runs a function on a thread with a deep stack and returns its result; the caller's stack may be of any size. A panic
/// of the function continues in the caller.
pub fn deep<T: Send>(act: impl FnOnce() -> T + Send) -> T {
    std::thread::scope(|scope| {
        let thread = std::thread::Builder::new().stack_size(STACK).spawn_scoped(scope, act);
        let thread = thread.expect("a thread can be started");
        thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    })
}
