//! Functions of the caller's that a run calls: they may end it, and a panic of theirs becomes an error.

use bramah_solve::RowSink;
use bramah_syntax::diag::{Code, Diagnostic};
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// What a callback did beside its work.
#[derive(Debug, Default)]
pub(super) struct CallbackStatus {
    /// It asked for the end.
    pub stopped: bool,
    /// The text of its panic.
    pub panic: Option<String>,
}

impl CallbackStatus {
    /// Calls it; true when the run may go on.
    pub fn call(&mut self, callback: impl FnOnce() -> bool) -> bool {
        // A panic must not unwind through the C code of the integrator.
        match catch_unwind(AssertUnwindSafe(callback)) {
            Ok(go_on) => {
                self.stopped |= !go_on;
                go_on
            }
            Err(payload) => {
                // The payload of `panic!` is a `String` or a `&str`.
                let text = payload.downcast_ref::<String>().cloned();
                let text = text.or_else(|| payload.downcast_ref::<&str>().map(ToString::to_string));
                self.panic = Some(text.unwrap_or_else(|| "no message".to_owned()));
                false
            }
        }
    }

    /// E508, if it panicked.
    pub fn complaint(&self, time: f64) -> Option<Diagnostic> {
        let text = self.panic.as_ref()?;
        Some(Diagnostic::new(Code::CallbackPanicked, format!("the callback panicked at time {time} s: {text}")))
    }
}

/// Hands rows to a function.
pub(super) struct RowCallback<'f> {
    /// Takes the time and the values.
    pub on_row: &'f mut (dyn FnMut(f64, &[f64]) -> ControlFlow<()> + Send),
    /// How it behaved.
    pub conduct: CallbackStatus,
}

impl RowSink for RowCallback<'_> {
    fn row(&mut self, time: f64, values: &[f64]) -> ControlFlow<()> {
        let RowCallback { on_row, conduct } = self;
        if conduct.call(|| on_row(time, values).is_continue()) {
            ControlFlow::Continue(())
        } else {
            ControlFlow::Break(())
        }
    }
}
