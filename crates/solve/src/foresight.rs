//! Relations that time alone changes between events: where they change next, and where they change back, is known ahead of
//! the integrator. Its steps may be longer than a peak; it must not step over both ends of one. One end it sees by itself,
//! so steps that are short enough stay what they are.
//!
//! Bounds of the difference of both sides, and of its slope, over a stretch of time tell whether it can have a zero there;
//! where it can, the stretch is halved, down to the rounding of time. So no change is missed. Where a function has no
//! bounds (a user's one), or the pieces become too many, the difference is sampled: its changes and its narrow humps are
//! found from [`SAMPLES`] values over the run, at least [`FEWEST`] between events.

mod bounds;
mod tape;

use super::modes::{RootFunctions, same_time};
use crate::lower::ExecutableSystem;
use bounds::{IntervalEnclosure, RealInterval};
use bramah_expr::function::Function;
use bramah_model::structure::CrossingKind;
use tape::{RelationTape, TapeWriter};

/// Stretches shorter than this part of the time are not halved: times so close are the same.
const SHORTEST: f64 = 1e-12;
/// The same near time 0, in lengths of the run.
const SHORTEST_OF_RUN: f64 = 1e-15;
/// Stretches that are looked at in a run, and more for each change that is found.
const PIECES: u64 = 1_000_000;
const PIECES_PER_CHANGE: u64 = 1000;
/// Values over the run where bounds do not serve.
const SAMPLES: f64 = 10_000.0;
/// The same between two known events.
const FEWEST: f64 = 8.0;
/// Where in a peak the integrator must not pass without having seen its beginning: near its end, to disturb few steps.
const WITHIN: f64 = 0.9;
/// Steps towards the top of a hump.
const TOWARDS_TOP: u32 = 20;

/// What is watched ahead.
#[derive(Debug)]
pub struct CrossingForecast<'a> {
    functions: &'a [Function],
    watched: Vec<WatchedRelation>,
    /// Length of the run.
    span: f64,
}

/// A relation of time, and what is known of its next change.
#[derive(Debug)]
struct WatchedRelation {
    /// Among the root functions.
    root: usize,
    tape: RelationTape,
    /// The values at events with which the rest was found.
    held: Vec<f64>,
    /// Added to the difference, as in the root function.
    shift: f64,
    /// What is known begins here.
    from: f64,
    /// The next change, once it is found.
    change: Option<f64>,
    /// No change before this time, or no change back.
    clear: f64,
    /// Between the change and the one back, once both are found.
    within: Option<f64>,
    /// Stretches that may still be looked at.
    pieces: u64,
}

impl<'a> CrossingForecast<'a> {
    /// For all relations of time alone.
    pub fn new(system: &'a ExecutableSystem, roots: &RootFunctions, span: f64) -> Self {
        let writer = TapeWriter::new(system);
        let watched = (0..roots.len()).filter_map(|root| {
            let CrossingKind::Relation(_, left, right) = system.dae.crossings[roots.crossing(root)].kind else {
                return None;
            };
            Some(WatchedRelation::new(root, writer.difference(left, right)?))
        });
        CrossingForecast { functions: &system.dae.exprs.functions, watched: watched.collect(), span: span.abs() }
    }

    /// The first time after `t` that must not be passed without an event, within a peak; `until` if there is none before.
    /// `roots` and `values` are as the last event has left them.
    pub fn next(&mut self, roots: &RootFunctions, values: &[f64], t: f64, until: f64) -> f64 {
        let mut first = until;
        for watched in &mut self.watched {
            watched.look(roots.shift(watched.root), values, t);
            first = first.min(watched.next(self.functions, self.span, t, first));
        }
        first
    }

    /// Notes in which directions root functions have changed at `t`; whether any has.
    pub fn note(&self, t: f64, count: usize, directions: &mut Vec<i32>) -> bool {
        let due = self.watched.iter().filter(|w| w.within.is_some_and(|within| reached(within, t)));
        let mut any = false;
        for watched in due {
            any = true;
            directions.resize(count, 0);
            directions[watched.root] = if watched.shift > 0.0 { -1 } else { 1 };
        }
        any
    }
}

fn reached(at: f64, t: f64) -> bool {
    at <= t || same_time(at, t)
}

impl WatchedRelation {
    fn new(root: usize, tape: RelationTape) -> Self {
        let pieces = if tape.bounded { PIECES } else { 0 };
        // of no side yet
        let (shift, from, clear) = (f64::NAN, 0.0, 0.0);
        WatchedRelation { root, tape, held: Vec::new(), shift, from, clear, change: None, within: None, pieces }
    }

    /// Keeps what is known while it holds: the side and the values at events have not changed.
    fn look(&mut self, shift: f64, values: &[f64], t: f64) {
        let passed = self.change.is_some_and(|change| reached(change, t));
        let same = self.shift.signum() == shift.signum() && self.held.len() == self.tape.held.len();
        let held = || self.tape.held.iter().map(|&slot| values[slot]);
        if same && !passed && self.from <= t && held().zip(&self.held).all(|(now, then)| now == *then) {
            return;
        }
        self.held = held().collect();
        (self.shift, self.from, self.clear) = (shift, t, t);
        (self.change, self.within) = (None, None);
    }

    /// A time within the next peak after `t` that ends before `until`, or infinity.
    fn next(&mut self, functions: &[Function], span: f64, t: f64, until: f64) -> f64 {
        while self.within.is_none() && self.clear < until && until.is_finite() {
            self.clear = self.clear.max(t);
            match (self.search(functions, span, until), self.change) {
                (None, _) => self.clear = until,
                (Some(change), None) => (self.change, self.clear) = (Some(change), change),
                (Some(back), Some(change)) => self.within = Some(change + WITHIN * (back - change)),
            }
        }
        self.within.unwrap_or(f64::INFINITY)
    }

    /// The next change, or the one back, behind what is clear and not behind `until`.
    fn search(&mut self, functions: &[Function], span: f64, until: f64) -> Option<f64> {
        let from = self.clear + 2.0 * SHORTEST * self.clear.abs().max(SHORTEST_OF_RUN / SHORTEST * span);
        if from >= until {
            return None;
        }
        let shift = if self.change.is_none() { self.shift } else { -self.shift };
        let (tape, held, values, bounds) = (&self.tape, &self.held, Vec::new(), Vec::new());
        let found =
            CrossingSearch { tape, functions, held, shift, span, values, bounds }.first(from, until, &mut self.pieces);
        if found.is_some() && self.pieces > 0 {
            self.pieces += PIECES_PER_CHANGE;
        }
        found
    }
}

/// One search.
struct CrossingSearch<'a> {
    tape: &'a RelationTape,
    functions: &'a [Function],
    held: &'a [f64],
    shift: f64,
    span: f64,
    values: Vec<f64>,
    bounds: Vec<IntervalEnclosure>,
}

impl CrossingSearch<'_> {
    /// How far the difference is from its change: negative behind it.
    fn distance(&mut self, t: f64) -> f64 {
        let difference = self.tape.at(self.functions, self.held, t, &mut self.values);
        (difference + self.shift) * self.shift.signum()
    }

    fn changed(&mut self, t: f64) -> bool {
        self.distance(t) < 0.0
    }

    fn first(&mut self, from: f64, to: f64, pieces: &mut u64) -> Option<f64> {
        if self.changed(from) {
            return Some(from);
        }
        let mut stack = vec![to];
        let mut a = from;
        while let Some(&b) = stack.last() {
            if *pieces == 0 {
                return self.sample(a, to);
            }
            *pieces -= 1;
            match self.judge(a, b) {
                CrossingCheck::Clear => {
                    stack.pop();
                    a = b;
                }
                CrossingCheck::Changes(t) => return Some(t),
                CrossingCheck::Unsure => stack.push(a + 0.5 * (b - a)),
            }
        }
        None
    }

    /// What bounds tell of a stretch at whose beginning nothing has changed.
    fn judge(&mut self, a: f64, b: f64) -> CrossingCheck {
        let IntervalEnclosure { value, slope } =
            self.tape.over(self.held, RealInterval { lo: a, hi: b }, &mut self.bounds);
        let falls = self.shift > 0.0;
        // the nearest that the difference may come to its change
        let reach = |value: RealInterval| if falls { value.lo + self.shift } else { -value.hi - self.shift };
        if reach(value) > 0.0 {
            return CrossingCheck::Clear;
        }
        if !slope.holds_zero() {
            let away = (slope.lo > 0.0) == falls;
            return match () {
                () if away || !self.changed(b) => CrossingCheck::Clear,
                () => CrossingCheck::Changes(self.bisect(a, b)),
            };
        }
        let middle = a + 0.5 * (b - a);
        if b - a <= SHORTEST * b.abs().max(SHORTEST_OF_RUN / SHORTEST * self.span) || middle <= a || middle >= b {
            return if self.changed(b) { CrossingCheck::Changes(b) } else { CrossingCheck::Clear };
        }
        let centre = self.tape.at(self.functions, self.held, middle, &mut self.values);
        let aside = slope.mul(RealInterval::new(a - middle, b - middle));
        let straight = RealInterval::new(centre + aside.lo, centre + aside.hi);
        let rounding = 64.0 * f64::EPSILON * self.size();
        if reach(straight) > rounding { CrossingCheck::Clear } else { CrossingCheck::Unsure }
    }

    /// The largest value that the last evaluation met: what rounding is measured by.
    fn size(&self) -> f64 {
        self.values.iter().fold(0.0, |size: f64, x| size.max(x.abs()))
    }

    /// The change between a time before it and one behind it: the first time behind it, to the rounding of time.
    fn bisect(&mut self, mut before: f64, mut behind: f64) -> f64 {
        loop {
            let middle = before + 0.5 * (behind - before);
            if middle <= before || middle >= behind {
                return behind;
            }
            if self.changed(middle) {
                behind = middle;
            } else {
                before = middle;
            }
        }
    }

    /// The first change that samples show.
    fn sample(&mut self, from: f64, to: f64) -> Option<f64> {
        let count = ((to - from) / self.span * SAMPLES).clamp(FEWEST, SAMPLES).ceil();
        let time = |k: f64| if k >= count { to } else { from + (to - from) * (k / count) };
        let (mut earlier, mut before) = (f64::NAN, f64::INFINITY);
        let mut last = self.distance(from);
        let mut k = 1.0;
        while k <= count {
            let now = self.distance(time(k));
            if now < 0.0 {
                return Some(self.bisect(time(k - 1.0), time(k)));
            }
            if last < before
                && last < now
                && earlier.is_finite()
                && let Some(top) = self.top(earlier, time(k))
            {
                return Some(self.bisect(earlier, top));
            }
            (earlier, before, last) = (time(k - 1.0), last, now);
            k += 1.0;
        }
        None
    }

    /// A time of change near the top of a hump that samples have missed, by the golden section.
    fn top(&mut self, mut a: f64, mut b: f64) -> Option<f64> {
        let part = 0.5 * (5.0_f64.sqrt() - 1.0);
        let (mut c, mut d) = (b - part * (b - a), a + part * (b - a));
        let (mut at_c, mut at_d) = (self.distance(c), self.distance(d));
        for _ in 0..TOWARDS_TOP {
            if at_c < 0.0 || at_d < 0.0 {
                return Some(if at_c < 0.0 { c } else { d });
            }
            if at_c < at_d {
                (b, d, at_d) = (d, c, at_c);
                c = b - part * (b - a);
                at_c = self.distance(c);
            } else {
                (a, c, at_c) = (c, d, at_d);
                d = a + part * (b - a);
                at_d = self.distance(d);
            }
        }
        None
    }
}

/// What is known of a stretch of time.
enum CrossingCheck {
    Clear,
    Changes(f64),
    Unsure,
}
