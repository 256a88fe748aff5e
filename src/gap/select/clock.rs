//! The time that a search may take. Only the caller has a clock.

use super::super::policy::{ROUND, SHARE};
use rayon::prelude::*;
use std::fmt;
use std::time::Duration;

/// The time that a search may take, on the clock of whoever asks for it.
#[derive(Clone, Copy)]
pub struct Budget<'a> {
    /// How long.
    pub time: Duration,
    /// How long ago the search began.
    pub gone: &'a (dyn Fn() -> Duration + Sync),
}

impl fmt::Debug for Budget<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Budget").field("time", &self.time).finish_non_exhaustive()
    }
}

/// When a search, or a step of it, must come to an end; never where there is no budget.
#[derive(Clone, Copy, Debug, Default)]
pub struct Deadline<'a>(Option<Budget<'a>>);

impl<'a> Deadline<'a> {
    /// That of a budget.
    pub fn of(budget: Option<Budget<'a>>) -> Self {
        Deadline(budget)
    }

    /// That of one step: a part of what is left.
    pub fn of_step(self) -> Self {
        let step = |b: Budget<'a>| {
            let now = (b.gone)();
            Budget { time: now + b.time.saturating_sub(now).mul_f64(SHARE), ..b }
        };
        Deadline(self.0.map(step))
    }

    /// Whether it has come.
    pub fn is_over(self) -> bool {
        self.0.is_some_and(|b| (b.gone)() >= b.time)
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
