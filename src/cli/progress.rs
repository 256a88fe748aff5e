//! The progress bar of a run, shown only on a terminal.
//!
//! `simulate` creates one for each run and reports the simulated time. The bar stays hidden for short runs, so that it
//! does not flicker.

use std::io::IsTerminal;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// The bar appears after this time.
const QUIET: Duration = Duration::from_millis(700);
/// Length of the bar in its own units. Simulated time is scaled to it, because the bar counts whole numbers.
const PARTS: u64 = 10_000;

/// A bar with the simulated time, the number of events and the expected remaining time.
#[derive(Debug)]
pub(super) struct SimulationBar {
    /// The bar; `None` when stderr is not a terminal.
    bar: Option<ProgressBar>,
    /// Start of the run in seconds.
    start: f64,
    /// Length of the run in seconds, greater than zero.
    length: f64,
    /// When the bar was created.
    begun: Instant,
}

impl SimulationBar {
    /// The bar of a run from `start` to `stop` in seconds. It is hidden at first.
    pub fn new(start: f64, stop: f64) -> Self {
        let bar = std::io::stderr()
            .is_terminal()
            .then(|| ProgressBar::with_draw_target(Some(PARTS), ProgressDrawTarget::hidden()));
        if let Some(bar) = &bar {
            let style = ProgressStyle::with_template("{bar:30} {percent:>3} %  {msg}  rest {eta}");
            bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()).progress_chars("=> "));
        }
        // A run of length zero must not divide by zero.
        SimulationBar { bar, start, length: (stop - start).max(f64::MIN_POSITIVE), begun: Instant::now() }
    }

    /// Shows the simulated time in seconds, the number of steps where known, and the number of events.
    pub fn show(&self, time: f64, steps: Option<u64>, events: u64) {
        let Some(bar) = &self.bar else { return };
        // A hidden bar still waits for its delay. It is then redrawn at most 5 times a second.
        if bar.is_hidden() {
            if self.begun.elapsed() < QUIET {
                return;
            }
            bar.set_draw_target(ProgressDrawTarget::stderr_with_hz(5));
        }
        let part = ((time - self.start) / self.length).clamp(0.0, 1.0);
        bar.set_position((part * PARTS as f64) as u64);
        let steps = steps.map(|n| format!("  {n} steps")).unwrap_or_default();
        bar.set_message(format!("t = {time:.4} s{steps}  {events} events"));
    }

    /// Removes the bar from the terminal.
    pub fn clear(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
