//! Progress of a long run, on a terminal only.

use std::io::IsTerminal;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// Runs that are over sooner show nothing.
const QUIET: Duration = Duration::from_millis(700);
/// Parts into which the run is cut for the bar.
const PARTS: u64 = 10_000;

/// A line with simulated time, events and the expected rest.
#[derive(Debug)]
pub(super) struct SimulationBar {
    bar: Option<ProgressBar>,
    start: f64,
    length: f64,
    begun: Instant,
}

impl SimulationBar {
    /// For a run from `start` to `stop`; nothing is shown where stderr is no terminal.
    pub fn new(start: f64, stop: f64) -> Self {
        let bar = std::io::stderr()
            .is_terminal()
            .then(|| ProgressBar::with_draw_target(Some(PARTS), ProgressDrawTarget::hidden()));
        if let Some(bar) = &bar {
            let style = ProgressStyle::with_template("{bar:30} {percent:>3} %  {msg}  rest {eta}");
            bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()).progress_chars("=> "));
        }
        SimulationBar { bar, start, length: (stop - start).max(f64::MIN_POSITIVE), begun: Instant::now() }
    }

    /// Notes how far the run is.
    pub fn show(&self, time: f64, steps: Option<u64>, events: u64) {
        let Some(bar) = &self.bar else { return };
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

    /// Removes the line.
    pub fn clear(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
