//! Forecast of relations that only time changes between events: when they change next, and when they change back.
//!
//! IDA finds a root only where a function has different signs at the two ends of a step. A step may be longer than a
//! peak and contain both of its ends. The driver asks [`CrossingForecast::next`] for a time within the next peak, where
//! the integrator must stop; one end of the peak it then finds itself. Steps that are short enough stay as they are.
//!
//! The search uses interval bounds (`bounds`) of the difference of both sides and of its slope over a stretch of time.
//! Where they cannot exclude a zero, the stretch is halved, down to the rounding of time. So no change is missed.
//! Where a function has no bounds (a user's function), or the pieces become too many, the difference is sampled: at
//! [`SAMPLES`] values over the run, and at least at [`FEWEST`] between events.

mod bounds;
mod tape;

use super::modes::{RootFunctions, same_time};
use crate::lower::ExecutableSystem;
use bounds::{IntervalEnclosure, RealInterval};
use bramah_expr::function::Function;
use bramah_model::structure::CrossingKind;
use tape::{RelationTape, TapeWriter};

/// Stretches shorter than this part of the time are not halved.
const SHORTEST: f64 = 1e-12;
/// The same near time 0, as a part of the run.
const SHORTEST_OF_RUN: f64 = 1e-15;
/// Stretches that may be examined in a run for each relation ...
const PIECES: u64 = 1_000_000;
/// ... and more for each change that is found.
const PIECES_PER_CHANGE: u64 = 1000;
/// Values over the run where bounds cannot be used.
const SAMPLES: f64 = 10_000.0;
/// Values between two known events at least.
const FEWEST: f64 = 8.0;
/// Where in a peak the integrator stops: near its end, so that few steps are disturbed.
const WITHIN: f64 = 0.9;
/// Steps of the golden-section search for the top of a hump.
const TOWARDS_TOP: u32 = 20;

/// The relations of time of a system and their next changes.
#[derive(Debug)]
pub struct CrossingForecast<'a> {
    /// The user's functions, which the relations may call.
    functions: &'a [Function],
    /// The relations.
    watched: Vec<WatchedRelation>,
    /// Length of the run in seconds.
    span: f64,
}

/// A relation of time, and what is known of its next change. Times are in seconds.
#[derive(Debug)]
struct WatchedRelation {
    /// Its root function.
    root: usize,
    /// The difference of its sides as a function of time.
    tape: RelationTape,
    /// Values at the last event with which the rest was found.
    held: Vec<f64>,
    /// The shift of the root function, whose sign is the present side.
    shift: f64,
    /// Time from which the following is valid.
    from: f64,
    /// The next change, once it is found.
    change: Option<f64>,
    /// Up to here there is no change, or after `change` no change back.
    clear: f64,
    /// A time between the change and the change back, once both are found.
    within: Option<f64>,
    /// Number of stretches that may still be examined.
    pieces: u64,
}

impl<'a> CrossingForecast<'a> {
    /// Finds all relations that depend on time alone.
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

    /// The first time after `t` that must not be passed without an event; `until` when there is none before.
    ///
    /// `roots` and `values` must be as the last event has left them.
    pub fn next(&mut self, roots: &RootFunctions, values: &[f64], t: f64, until: f64) -> f64 {
        let mut first = until;
        for watched in &mut self.watched {
            watched.look(roots.shift(watched.root), values, t);
            first = first.min(watched.next(self.functions, self.span, t, first));
        }
        first
    }

    /// Writes the directions of the root functions that have changed at `t`, and returns whether any has.
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

/// Whether the time `t` is at or behind `at`.
fn reached(at: f64, t: f64) -> bool {
    at <= t || same_time(at, t)
}

impl WatchedRelation {
    /// Nothing is known yet.
    fn new(root: usize, tape: RelationTape) -> Self {
        let pieces = if tape.bounded { PIECES } else { 0 };
        // of no side yet
        let (shift, from, clear) = (f64::NAN, 0.0, 0.0);
        WatchedRelation { root, tape, held: Vec::new(), shift, from, clear, change: None, within: None, pieces }
    }

    /// Discards what is known when the side or a value at the event has changed, or when the change has passed.
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

    /// A time within the next peak after `t` that ends before `until`; infinite when there is none.
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

    /// The next change, or the change back, after `clear` and not after `until`.
    fn search(&mut self, functions: &[Function], span: f64, until: f64) -> Option<f64> {
        // a little behind, so that the change found before is not found again
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

/// One search over a stretch of time.
struct CrossingSearch<'a> {
    /// The difference as a function of time.
    tape: &'a RelationTape,
    /// The user's functions.
    functions: &'a [Function],
    /// Values at the last event.
    held: &'a [f64],
    /// Shift of the root function; its sign is the side from which the change is searched.
    shift: f64,
    /// Length of the run in seconds.
    span: f64,
    /// Workspace for values of the steps of the tape.
    values: Vec<f64>,
    /// Workspace for bounds of the steps of the tape.
    bounds: Vec<IntervalEnclosure>,
}

impl CrossingSearch<'_> {
    /// How far the difference is from its change; negative behind it.
    fn distance(&mut self, t: f64) -> f64 {
        let difference = self.tape.at(self.functions, self.held, t, &mut self.values);
        (difference + self.shift) * self.shift.signum()
    }

    /// Whether the relation has changed at `t`.
    fn changed(&mut self, t: f64) -> bool {
        self.distance(t) < 0.0
    }

    /// The first change between two times; `None` when there is none.
    fn first(&mut self, from: f64, to: f64, pieces: &mut u64) -> Option<f64> {
        if self.changed(from) {
            return Some(from);
        }
        let mut stack = vec![to];
        let mut a = from;
        while let Some(&b) = stack.last() {
            // too many pieces: the rest is sampled
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

    /// What bounds say of a stretch at whose beginning the relation has not changed.
    fn judge(&mut self, a: f64, b: f64) -> CrossingCheck {
        let IntervalEnclosure { value, slope } =
            self.tape.over(self.held, RealInterval { lo: a, hi: b }, &mut self.bounds);
        let falls = self.shift > 0.0;
        // the nearest that the difference may come to its change
        let reach = |value: RealInterval| if falls { value.lo + self.shift } else { -value.hi - self.shift };
        if reach(value) > 0.0 {
            return CrossingCheck::Clear;
        }
        // monotonic: the end of the stretch decides
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
        // mean value form: the value at the middle and the bounds of the slope are often narrower
        let centre = self.tape.at(self.functions, self.held, middle, &mut self.values);
        let aside = slope.mul(RealInterval::new(a - middle, b - middle));
        let straight = RealInterval::new(centre + aside.lo, centre + aside.hi);
        let rounding = 64.0 * f64::EPSILON * self.size();
        if reach(straight) > rounding { CrossingCheck::Clear } else { CrossingCheck::Unsure }
    }

    /// The largest absolute value of the last evaluation, by which rounding is measured.
    fn size(&self) -> f64 {
        self.values.iter().fold(0.0, |size: f64, x| size.max(x.abs()))
    }

    /// The first time behind the change, to the rounding of time. `before` lies before the change, `behind` after it.
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
            // the last sample is nearer to a change than both neighbours: a narrow hump may lie between them
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

    /// A time behind the change near the top of a hump, by golden-section search; `None` when the hump is too low.
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

/// What bounds say of a stretch of time.
enum CrossingCheck {
    /// There is no change in it.
    Clear,
    /// It changes at this time.
    Changes(f64),
    /// The bounds are too wide.
    Unsure,
}
