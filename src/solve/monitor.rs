//! Watches a run: events that make no progress in time, assertions.

use super::report::at_origin;
use crate::diag::{Code, Diagnostic};
use crate::lower::System;
use std::collections::VecDeque;

/// The same relations crossing so often within this part of the run count as chattering.
const SLIDING_EVENTS: usize = 2000;
const SLIDING_WINDOW: f64 = 1e-4;
const INSTANT: f64 = 1e-9;

/// Recent events, to recognise chattering.
#[derive(Debug)]
pub struct Chatter {
    span: f64,
    at_once: usize,
    /// Time and crossing (none for time events) of the last events.
    recent: VecDeque<(f64, Option<u32>)>,
}

impl Chatter {
    /// For a run of this length that allows so many events in a billionth of it.
    pub fn new(span: f64, at_once: u32) -> Self {
        Chatter { span, at_once: at_once.max(1) as usize, recent: VecDeque::new() }
    }

    /// Notes an event; true when events make no progress any more.
    pub fn note(&mut self, t: f64, crossing: Option<u32>) -> bool {
        self.recent.push_back((t, crossing));
        if self.recent.len() > SLIDING_EVENTS.max(self.at_once) {
            self.recent.pop_front();
        }
        self.within(self.at_once, INSTANT * self.span, t)
            || (crossing.is_some()
                && self.within(SLIDING_EVENTS, SLIDING_WINDOW * self.span, t)
                && self.recent.iter().all(|e| e.1.is_some()))
    }

    fn within(&self, count: usize, window: f64, t: f64) -> bool {
        self.recent.len() >= count && t - self.recent[self.recent.len() - count].0 <= window
    }

    /// E502, with the relation that crossed most often.
    pub fn report(&self, system: &System, t: f64) -> Diagnostic {
        let dae = &system.dae;
        let mut counts = vec![0_usize; dae.crossings.len()];
        self.recent.iter().filter_map(|e| e.1).for_each(|c| counts[c as usize] += 1);
        let since = self.recent.front().map_or(t, |e| e.0);
        let at = super::report::number(t);
        let note = format!("{} events since time {} s", self.recent.len(), super::report::number(since));
        let worst = (0..counts.len()).max_by_key(|&c| (counts[c], std::cmp::Reverse(c))).filter(|&c| counts[c] > 0);
        let diagnostic = match worst {
            Some(c) => {
                let crossing = &dae.crossings[c];
                let relation = &dae.variables[crossing.mode.index()].name;
                let text = format!("`{relation}` changes without end at time {at} s");
                at_origin(dae, Code::Chattering, text, crossing.origin, "this relation")
            }
            None => {
                Diagnostic::new(Code::Chattering, format!("time events follow each other without end at time {at} s"))
            }
        };
        diagnostic.note(note).help(
            "both sides of the relation drive the model back across it: add hysteresis, `smooth`/`noEvent`, \
             or a state between, as dry friction has with its stick mode",
        )
    }
}

/// Which assertions have been reported already.
#[derive(Debug, Default)]
pub struct Reported {
    asserts: Vec<bool>,
    actions: Vec<bool>,
}

impl Reported {
    /// None reported yet.
    pub fn new(system: &System) -> Self {
        Reported { asserts: vec![false; system.dae.asserts.len()], actions: vec![false; system.dae.actions.len()] }
    }

    /// True the first time an `assert` outside `when` is reported.
    pub fn first(&mut self, assert: usize) -> bool {
        !std::mem::replace(&mut self.asserts[assert], true)
    }

    /// True the first time an action's `assert` is reported.
    pub fn first_action(&mut self, action: usize) -> bool {
        !std::mem::replace(&mut self.actions[action], true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_events_at_once_are_chattering() {
        let mut chatter = Chatter::new(1.0, 200);
        assert!((0..199).all(|_| !chatter.note(0.5, None)));
        assert!(chatter.note(0.5, None));
    }

    #[test]
    fn a_fast_clock_is_not() {
        let mut chatter = Chatter::new(10.0, 200);
        assert!((0..10_000).all(|k| !chatter.note(f64::from(k) * 1e-7, None)));
    }

    #[test]
    fn a_relation_that_slides_is() {
        let mut chatter = Chatter::new(10.0, 200);
        let first = (0..10_000).find(|&k| chatter.note(f64::from(k) * 1e-7, Some(3)));
        assert_eq!(first, Some(1999));
    }
}
