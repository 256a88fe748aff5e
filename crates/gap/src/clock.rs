//! The time budget of a search.
//!
//! The crate never reads a clock itself: the caller passes a closure that says how much time has passed ([`Budget`]).
//! The search turns it into [`Deadline`]s for the complete search and for single steps.
//! The rules (60 s, or 500 simulations of a slow model) are those of `docs/gap_method.md`, "Order of the hypotheses".

use crate::policy::{BUDGET, ROUND, RUNS, SHARE};
use rayon::prelude::*;
use std::fmt;
use std::time::Duration;

/// How long a search may take, measured by a clock of the caller.
#[derive(Clone, Copy)]
pub struct Budget<'a> {
    /// Time allowed. `None` means [`BUDGET`] seconds, or the time of [`RUNS`] simulations where that is longer.
    pub time: Option<Duration>,
    /// Time since the search began.
    pub gone: &'a (dyn Fn() -> Duration + Sync),
}

impl fmt::Debug for Budget<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Budget").field("time", &self.time).finish_non_exhaustive()
    }
}

/// The moment at which a search, or one step of it, must end. Without a budget it never comes.
#[derive(Clone, Copy, Default)]
pub struct Deadline<'a>(Option<DeadlineClock<'a>>);

/// A deadline together with the caller's clock.
#[derive(Clone, Copy)]
struct DeadlineClock<'a> {
    /// Time at which the deadline comes, counted from the beginning of the search.
    time: Duration,
    /// Time since the search began.
    gone: &'a (dyn Fn() -> Duration + Sync),
}

impl fmt::Debug for Deadline<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Deadline").field(&self.0.map(|due| due.time)).finish()
    }
}

impl<'a> Deadline<'a> {
    /// Deadline of a budget.
    /// `run` simulates all recordings once. It is called only where the budget has no time, to measure how slow the
    /// model is.
    pub fn of(budget: Option<Budget<'a>>, run: impl FnOnce()) -> Self {
        let due = |Budget { time, gone }: Budget<'a>| {
            let usual = || {
                let begun = gone();
                run();
                (gone().saturating_sub(begun) * RUNS).max(Duration::from_secs_f64(BUDGET))
            };
            DeadlineClock { time: time.unwrap_or_else(usual), gone }
        };
        Deadline(budget.map(due))
    }

    /// Deadline of one step, which may take the part [`SHARE`] of the time that is left.
    pub fn of_step(self) -> Self {
        let step = |due: DeadlineClock<'a>| {
            let now = (due.gone)();
            DeadlineClock { time: now + due.time.saturating_sub(now).mul_f64(SHARE), ..due }
        };
        Deadline(self.0.map(step))
    }

    /// Whether the deadline has passed.
    pub fn is_over(self) -> bool {
        self.0.is_some_and(|due| (due.gone)() >= due.time)
    }

    /// Maps `one` over `all`, [`ROUND`] items in parallel at a time, until the deadline.
    /// The first round always runs, so that at least some result exists.
    /// Results come first, items for which the time was too short second; both keep their order.
    pub fn rounds<T: Send, R: Send>(self, all: Vec<T>, one: impl Fn(T) -> R + Sync) -> (Vec<R>, Vec<T>) {
        let mut rest = all.into_iter();
        let mut found = Vec::new();
        while rest.len() > 0 && (found.is_empty() || !self.is_over()) {
            let round: Vec<T> = rest.by_ref().take(ROUND).collect();
            found.par_extend(round.into_par_iter().map(&one));
        }
        (found, rest.collect())
    }
}
