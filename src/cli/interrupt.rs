//! Ctrl-C: the run ends at the next step and keeps what it has; a second Ctrl-C ends the process at once.

use std::sync::atomic::{AtomicBool, Ordering};

static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Begins to listen, and hands out the flag that Ctrl-C sets.
pub(super) fn flag() -> &'static AtomicBool {
    let handler = || {
        if INTERRUPTED.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
    };
    // A handler that is already there is ours; without one Ctrl-C ends the process as usual.
    let _ = ctrlc::set_handler(handler);
    &INTERRUPTED
}
