//! The `bramah` command: starts `bramah::cli` on a thread with a deep stack and returns its exit code.

#![allow(clippy::print_stderr, reason = "the one place beside `cli` that may")]

/// Compiling a model allocates many small objects. The system's allocator asks the kernel for memory about 500 times,
/// which takes a tenth of a short run.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

/// Exit codes are those of `bramah::cli`; 101 after a panic, 2 when no thread can be started.
fn main() -> std::process::ExitCode {
    // Deeply nested models recurse deeper than the stack of the main thread allows.
    let worker = std::thread::Builder::new()
        .name("bramah".to_owned())
        .stack_size(bramah::internals::compile::STACK)
        .spawn(bramah::internals::cli::main);
    match worker.map(std::thread::JoinHandle::join) {
        Ok(Ok(code)) => code,
        // The panic hook has printed the message.
        Ok(Err(_)) => std::process::ExitCode::from(101),
        Err(error) => {
            eprintln!("error: no thread can be started: {error}");
            std::process::ExitCode::from(2)
        }
    }
}
