//! The time that a search may take. Only the caller has a clock.

use super::policy::{BUDGET, ROUND, RUNS, SHARE};
use rayon::prelude::*;
use std::fmt;
use std::time::Duration;

/// The time that a search may take, on the clock of whoever asks for it.
#[derive(Clone, Copy)]
pub struct Budget<'a> {
    /// How long; where nothing is said a minute, and longer for a slow model.
    pub time: Option<Duration>,
    /// How long ago the search began.
    pub gone: &'a (dyn Fn() -> Duration + Sync),
}

impl fmt::Debug for Budget<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Budget").field("time", &self.time).finish_non_exhaustive()
    }
}

/// When a search, or a step of it, must come to an end; never where there is no budget.
#[derive(Clone, Copy, Default)]
pub struct Deadline<'a>(Option<DeadlineClock<'a>>);

#[derive(Clone, Copy)]
struct DeadlineClock<'a> {
    time: Duration,
    gone: &'a (dyn Fn() -> Duration + Sync),
}

impl fmt::Debug for Deadline<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Deadline").field(&self.0.map(|due| due.time)).finish()
    }
}

impl<'a> Deadline<'a> {
    /// That of a budget; `run` simulates all recordings once, where it has to be known how long that takes.
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

    /// That of one step: a part of what is left.
    pub fn of_step(self) -> Self {
        let step = |due: DeadlineClock<'a>| {
            let now = (due.gone)();
            DeadlineClock { time: now + due.time.saturating_sub(now).mul_f64(SHARE), ..due }
        };
        Deadline(self.0.map(step))
    }

    /// Whether it has come.
    pub fn is_over(self) -> bool {
        self.0.is_some_and(|due| (due.gone)() >= due.time)
    }

    /// What comes of some things, a few at a time until the time is over, but of the first ones at least; and the others.
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
