//! Monitors of a run: events that make no progress in time, impacts that accumulate, and which warnings were reported.
//!
//! The driver notes every event in them. [`ChatterMonitor`] and [`ImpactAccumulation`] end a run with E502.

use super::report::at_origin;
use crate::lower::ExecutableSystem;
use bramah_syntax::diag::{Code, Diagnostic};
use rustc_hash::FxHashMap;
use std::collections::VecDeque;

/// This many events in a row, all from crossings ...
const SLIDING_EVENTS: usize = 2000;
/// ... within this part of the run count as chattering.
const SLIDING_WINDOW: f64 = 1e-4;
/// The part of the run within which only `Settings::events_at_once` events of any kind may happen.
const INSTANT: f64 = 1e-9;

/// Recent events, to recognize chattering.
#[derive(Debug)]
pub struct ChatterMonitor {
    /// Length of the run in seconds.
    span: f64,
    /// Number of events that are allowed within [`INSTANT`] of the run.
    at_once: usize,
    /// Time and crossing of the last events; `None` for events of known time.
    recent: VecDeque<(f64, Option<u32>)>,
}

impl ChatterMonitor {
    /// A monitor for a run of `span` seconds.
    pub fn new(span: f64, at_once: u32) -> Self {
        ChatterMonitor { span, at_once: at_once.max(1) as usize, recent: VecDeque::new() }
    }

    /// Notes an event; true when the events make no progress any more.
    pub fn note(&mut self, t: f64, crossing: Option<u32>) -> bool {
        self.recent.push_back((t, crossing));
        if self.recent.len() > SLIDING_EVENTS.max(self.at_once) {
            self.recent.pop_front();
        }
        // many events of any kind at once, or a relation that crosses back and forth; fast clocks alone are no
        // chattering
        self.within(self.at_once, INSTANT * self.span, t)
            || (crossing.is_some()
                && self.within(SLIDING_EVENTS, SLIDING_WINDOW * self.span, t)
                && self.recent.iter().all(|e| e.1.is_some()))
    }

    /// Whether the last `count` events happened within `window` seconds.
    fn within(&self, count: usize, window: f64, t: f64) -> bool {
        self.recent.len() >= count && t - self.recent[self.recent.len() - count].0 <= window
    }

    /// E502, with the relation that crossed most often.
    pub fn report(&self, system: &ExecutableSystem, t: f64) -> Diagnostic {
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

/// Impacts accumulate when this many intervals between events of one relation are each shorter than the one before ...
const SHRINKING: u32 = 10;
/// ... and the last one is below this part of the run. Example: a ball that bounces.
const ACCUMULATED: f64 = 1e-6;

/// A relation has been passed when its sides are farther apart than at the last event by this factor ...
const PASSED: f64 = 1e6;
/// ... and by this much in the unit of the relation ...
const APART: f64 = 1e-9;
/// ... this many of the last intervals after the last event.
const INTERVALS: f64 = 100.0;

/// Detects impacts that follow each other ever faster (Zeno behaviour).
///
/// At their limit the relation is no longer seen to change, and the body passes through what held it back.
#[derive(Debug, Default)]
pub struct ImpactAccumulation {
    /// By relation and direction: time of the last event, the interval before it, and how many intervals have shrunk.
    seen: FxHashMap<(u32, bool), (f64, f64, u32)>,
    /// Set when impacts have accumulated.
    limit: Option<AccumulationLimit>,
}

/// Impacts that have accumulated.
#[derive(Clone, Copy, Debug)]
struct AccumulationLimit {
    /// The relation, as an index into `Dae::crossings`.
    relation: u32,
    /// Time of the last impact in seconds.
    time: f64,
    /// Interval between the last two impacts in seconds.
    interval: f64,
    /// Difference of the sides of the relation after the last impact.
    distance: f64,
}

impl ImpactAccumulation {
    /// Notes an event of a relation and its direction. True when impacts have accumulated.
    ///
    /// `None` is an event without a crossing; it ends the observation.
    pub fn note(&mut self, span: f64, t: f64, crossing: Option<(u32, bool)>) -> bool {
        let Some(key) = crossing else {
            self.limit = None;
            return false;
        };
        // an event of another relation ends the observation of this one
        if self.limit.is_some_and(|l| l.relation != key.0) {
            self.limit = None;
        }
        let seen = self.seen.entry(key).or_insert((t, f64::INFINITY, 0));
        let interval = t - seen.0;
        let shrunk = if interval < seen.1 { seen.2 + 1 } else { 0 };
        *seen = (t, if interval > 0.0 { interval } else { f64::INFINITY }, shrunk);
        let accumulated = shrunk >= SHRINKING && interval <= ACCUMULATED * span;
        if accumulated {
            self.limit = Some(AccumulationLimit { relation: key.0, time: t, interval, distance: 0.0 });
        }
        accumulated
    }

    /// Records how far the sides of the relation are apart after the event noted last.
    pub fn stands(&mut self, distance: f64) {
        if let Some(limit) = &mut self.limit {
            limit.distance = distance.abs();
        }
    }

    /// The relation whose impacts have accumulated; `None` when there is none.
    pub fn watched(&self) -> Option<u32> {
        self.limit.map(|l| l.relation)
    }

    /// E502 when a relation whose impacts had accumulated has been passed; `None` otherwise.
    pub fn judge(&self, system: &ExecutableSystem, t: f64, distance: f64) -> Option<Diagnostic> {
        let limit = self.limit?;
        if t - limit.time <= INTERVALS * limit.interval || distance.abs() <= APART.max(PASSED * limit.distance) {
            return None;
        }
        let dae = &system.dae;
        let crossing = &dae.crossings[limit.relation as usize];
        let name = &dae.variables[crossing.mode.index()].name;
        let at = super::report::number(limit.time);
        let text = format!("`{name}` does not change after time {at} s, and what it held back goes on through it");
        Some(
            at_origin(dae, Code::Chattering, text, crossing.origin, "this relation")
                .note(format!("events followed each other faster and faster up to time {at} s"))
                .help("let the body come to rest: a state of rest that the `when` enters below a small speed, or a stiff stop with damping instead of `reinit`"),
        )
    }
}

/// Which warnings have been reported. Each is reported once in a run.
#[derive(Debug, Default)]
pub struct AssertionReports {
    /// For each entry of `Dae::asserts`.
    asserts: Vec<bool>,
    /// For each entry of `Dae::actions`.
    actions: Vec<bool>,
    /// A load that is shared in no unique way.
    shared: bool,
    /// A loop that has jumped to another root.
    jumped: bool,
}

impl AssertionReports {
    /// Nothing is reported yet.
    pub fn new(system: &ExecutableSystem) -> Self {
        let (asserts, actions) = (system.dae.asserts.len(), system.dae.actions.len());
        AssertionReports { asserts: vec![false; asserts], actions: vec![false; actions], shared: false, jumped: false }
    }

    /// True the first time that this `assert` outside `when` is reported.
    pub fn first(&mut self, assert: usize) -> bool {
        !std::mem::replace(&mut self.asserts[assert], true)
    }

    /// True the first time that a load is shared in no unique way.
    pub fn first_shared(&mut self) -> bool {
        !std::mem::replace(&mut self.shared, true)
    }

    /// True the first time that a loop jumps.
    pub fn first_jump(&mut self) -> bool {
        !std::mem::replace(&mut self.jumped, true)
    }

    /// True the first time that the `assert` of this action is reported.
    pub fn first_action(&mut self, action: usize) -> bool {
        !std::mem::replace(&mut self.actions[action], true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_events_at_once_are_chattering() {
        let mut chatter = ChatterMonitor::new(1.0, 200);
        assert!((0..199).all(|_| !chatter.note(0.5, None)));
        assert!(chatter.note(0.5, None));
    }

    #[test]
    fn a_fast_clock_is_not() {
        let mut chatter = ChatterMonitor::new(10.0, 200);
        assert!((0..10_000).all(|k| !chatter.note(f64::from(k) * 1e-7, None)));
    }

    #[test]
    fn a_relation_that_slides_is() {
        let mut chatter = ChatterMonitor::new(10.0, 200);
        let first = (0..10_000).find(|&k| chatter.note(f64::from(k) * 1e-7, Some(3)));
        assert_eq!(first, Some(1999));
    }
}
