//! Handles Ctrl-C during runs.
//!
//! The first Ctrl-C sets a flag. The solver polls it, ends at the next step and keeps its rows. A second Ctrl-C ends
//! the process at once with exit code 130, the usual one for this signal.

use std::sync::atomic::{AtomicBool, Ordering};

/// Set by the first Ctrl-C; never reset.
static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Installs the handler and returns the flag that Ctrl-C sets. May be called several times.
pub(super) fn flag() -> &'static AtomicBool {
    let handler = || {
        // `swap` returns the old value: true means that this is the second Ctrl-C.
        if INTERRUPTED.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
    };
    // A second installation fails because the handler is already there. If the first one failed, Ctrl-C ends the
    // process as usual.
    let _ = ctrlc::set_handler(handler);
    &INTERRUPTED
}
