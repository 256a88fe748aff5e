//! The time that a search may take.

#![allow(clippy::disallowed_methods, reason = "a budget is time on the machine at hand")]

use super::super::policy::SHARE;
use std::time::{Duration, Instant};

/// When a search, or a step of it, must come to an end.
#[derive(Clone, Copy, Debug, Default)]
pub struct Deadline(Option<Instant>);

impl Deadline {
    /// So long from now; never where nothing is said.
    pub fn after(budget: Option<Duration>) -> Self {
        Deadline(budget.and_then(|b| Instant::now().checked_add(b)))
    }

    /// That of one step: a part of what is left.
    pub fn of_step(self) -> Self {
        let now = Instant::now();
        Deadline(self.0.map(|end| now + end.saturating_duration_since(now).mul_f64(SHARE)))
    }

    /// Whether it has come.
    pub fn is_over(self) -> bool {
        self.0.is_some_and(|end| Instant::now() >= end)
    }
}
