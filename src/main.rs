//! The `bramah` command. See `bramah::cli`.

#![allow(clippy::print_stderr, reason = "the one place beside `cli` that may")]

/// Reading, sorting and compiling a model allocates many small things, and the system's allocator asks the kernel for
/// memory 500 times on the way: a tenth of a short run.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> std::process::ExitCode {
    let worker = std::thread::Builder::new()
        .name("bramah".to_owned())
        .stack_size(bramah::internals::compile::STACK)
        .spawn(bramah::internals::cli::main);
    match worker.map(std::thread::JoinHandle::join) {
        Ok(Ok(code)) => code,
        // The panic hook has said what happened.
        Ok(Err(_)) => std::process::ExitCode::from(101),
        Err(error) => {
            eprintln!("error: no thread can be started: {error}");
            std::process::ExitCode::from(2)
        }
    }
}
