//! Modes of crossings and the root functions given to IDA.
//!
//! A mode is the discrete variable that stands for a relation, a `floor` or a relation of time between events. A
//! relation `a > b` is watched through `d = a - b`. IDA disables a root function that is exactly zero after a restart,
//! and results would be silently wrong. The function given to IDA is therefore `d`, shifted beyond the threshold, away
//! from the present side. It is never zero after a restart, and when IDA reports a root, `d` has really changed its
//! side.

use crate::lower::{ExecutableSystem, ValueLayout};
use bramah_expr::{ExprId, RelationalOp, VarId};
use bramah_model::structure::{BltBlock, CrossingKind, Dae, ExplicitAssignment, Unknown, ZeroCrossing};
use rustc_hash::FxHashSet;

/// Shift of root functions beyond the threshold, in units of the size of the difference.
const SHIFT: f64 = 1e-12;
/// The shift where the difference has always been zero.
const SMALLEST_SHIFT: f64 = 1e-300;
/// Error of the solution in tolerances: at a root reported by IDA the difference may be this far on the old side.
const NEAR: f64 = 10.0;
/// Two times are the same when they differ by less than this part of the larger one.
const SAME_TIME: f64 = 1e-12;
/// The variable is no mode.
const NONE: u32 = u32::MAX;

/// Whether two finite times are the same up to rounding.
pub fn same_time(a: f64, b: f64) -> bool {
    a == b || (a - b).abs() <= SAME_TIME * a.abs().max(b.abs()) && a.is_finite() && b.is_finite()
}

/// The state of all crossings. Vectors are indexed like `Dae::crossings`, if not stated otherwise.
#[derive(Clone, Debug)]
pub struct CrossingModes {
    /// For each variable the crossing that it is the mode of, or `NONE`.
    crossing_of: Vec<u32>,
    /// The slot of each mode.
    slots: Vec<usize>,
    /// The value that a mode keeps during an event because IDA has seen it cross; NaN where there is none.
    forced: Vec<f64>,
    /// Whether an entry of `forced` is set.
    any_forced: bool,
    /// The largest absolute difference seen so far, from which the shift follows.
    size: Vec<f64>,
    /// Relative tolerance of the run.
    tolerance: f64,
    /// Whether relations of time hold as just after the event. True at events, false in the initial system.
    pub after: bool,
}

impl CrossingModes {
    /// All crossings, none of them forced.
    pub fn new(system: &ExecutableSystem, tolerance: f64) -> Self {
        let crossings = &system.dae.crossings;
        let mut crossing_of = vec![NONE; system.dae.variables.len()];
        for (c, crossing) in (0..).zip(crossings) {
            crossing_of[crossing.mode.index()] = c;
        }
        CrossingModes {
            crossing_of,
            slots: crossings.iter().map(|c| system.layout.var(c.mode)).collect(),
            forced: vec![f64::NAN; crossings.len()],
            any_forced: false,
            size: vec![0.0; crossings.len()],
            tolerance,
            after: false,
        }
    }

    /// The crossing that a variable is the mode of; `None` where it is no mode.
    pub fn crossing(&self, v: VarId) -> Option<u32> {
        let c = self.crossing_of[v.index()];
        (c != NONE).then_some(c)
    }

    /// Gives a crossing the value to which IDA has seen it cross; `direction` is 1 or -1.
    pub fn force(&mut self, system: &ExecutableSystem, crossing: usize, direction: i32, values: &[f64]) {
        let now = values[self.slots[crossing]];
        self.forced[crossing] = match system.dae.crossings[crossing].kind {
            CrossingKind::Floor(_) => now + f64::from(direction.signum()),
            _ => f64::from(now == 0.0),
        };
        self.any_forced = true;
    }

    /// Lets a crossing keep a value within the error of the solution, as if IDA had seen it cross to it.
    pub fn hold(&mut self, crossing: u32, value: f64) {
        self.forced[crossing as usize] = value;
        self.any_forced = true;
    }

    /// Whether a crossing has a forced value.
    pub fn forces(&self) -> bool {
        self.any_forced
    }

    /// Whether a crossing ended the event with another value than its forced one.
    pub fn refused(&self, values: &[f64]) -> bool {
        self.any_forced && self.forced.iter().zip(&self.slots).any(|(f, &s)| !f.is_nan() && *f != values[s])
    }

    /// Removes all forced values, at the end of an event.
    pub fn release(&mut self) {
        if self.any_forced {
            self.forced.fill(f64::NAN);
            self.any_forced = false;
        }
    }

    /// The mode of a crossing, given the value that its equation has just computed.
    ///
    /// A forced value replaces it within the error of the solution, and a relation of time holds as just after its
    /// time.
    pub fn correct(&self, system: &ExecutableSystem, crossing: u32, computed: f64, values: &[f64]) -> f64 {
        let c = crossing as usize;
        match system.dae.crossings[c].kind {
            CrossingKind::Time(rel, at) if self.after && computed != f64::from(after(rel)) => {
                let at = system.eval(at, values);
                if same_time(values[ValueLayout::TIME], at) { f64::from(after(rel)) } else { computed }
            }
            CrossingKind::Relation(_, left, right) if self.wants(c, computed) => {
                let (left, right) = (system.eval(left, values), system.eval(right, values));
                // the sides themselves count too: their difference has rounding error of their size
                let size = self.size[c].max(left.abs()).max(right.abs());
                self.keep(c, computed, (left - right).abs(), size)
            }
            CrossingKind::Floor(argument) if self.wants(c, computed) => {
                let argument = system.eval(argument, values);
                // distance to the nearer bound of the interval of the forced value
                let distance = (argument - self.forced[c]).abs().min((argument - self.forced[c] - 1.0).abs());
                self.keep(c, computed, distance, argument.abs().max(1.0))
            }
            _ => computed,
        }
    }

    /// Whether a forced value differs from the computed one.
    fn wants(&self, c: usize, computed: f64) -> bool {
        self.any_forced && !self.forced[c].is_nan() && self.forced[c] != computed
    }

    /// The forced value while the difference is within the error of the solution, else the computed one.
    fn keep(&self, c: usize, computed: f64, distance: f64, size: f64) -> f64 {
        if distance <= NEAR * self.tolerance * size { self.forced[c] } else { computed }
    }

    /// Records a difference for the size of a crossing.
    pub fn seen(&mut self, crossing: usize, difference: f64) {
        if difference.is_finite() {
            self.size[crossing] = self.size[crossing].max(difference.abs());
        }
    }

    /// Whether a difference is within the error of the solution, according to the differences seen so far.
    pub fn near(&self, crossing: usize, difference: f64) -> bool {
        difference.abs() <= NEAR * self.tolerance * self.size[crossing]
    }
}

/// Whether a crossing depends on time in a way that no state follows.
///
/// The error test does not see such a function, and a long step could contain two of its roots.
pub fn follows_time(dae: &Dae) -> bool {
    let watched = |c: &ZeroCrossing| match c.kind {
        CrossingKind::Relation(_, left, right) => Some([left, right]),
        CrossingKind::Floor(argument) => Some([argument, argument]),
        CrossingKind::Time(..) => None,
    };
    let watched: Vec<ExprId> = dae.crossings.iter().filter_map(watched).flatten().collect();
    if watched.is_empty() {
        return false;
    }
    let mut moved: FxHashSet<VarId> = dae.delays.iter().map(|d| d.variable).collect();
    // time itself, a delayed value, or an explicit variable made of these
    let moves = |e: ExprId, moved: &FxHashSet<VarId>| {
        let on = dae.exprs.dependencies(&[e]);
        on.time || on.vars.iter().any(|v| moved.contains(v))
    };
    for block in &dae.continuous {
        if let BltBlock::Assign(ExplicitAssignment { unknown: Unknown::Var(v), value, .. }) = block
            && moves(*value, &moved)
        {
            moved.insert(*v);
        }
    }
    watched.iter().any(|&e| moves(e, &moved))
}

/// Whether a relation of time holds just after the time that it compares with.
pub fn after(rel: RelationalOp) -> bool {
    matches!(rel, RelationalOp::Gt | RelationalOp::Ge | RelationalOp::Ne)
}

/// The root functions given to IDA: one for each relation, two for each `floor`.
#[derive(Clone, Debug, Default)]
pub struct RootFunctions {
    /// The functions, in the order of IDA.
    functions: Vec<RootFunction>,
    /// The unshifted differences, one per entry of `ExecutableSystem::root_crossings`.
    raw: Vec<f64>,
}

/// One root function: `raw - base + shift`.
#[derive(Clone, Copy, Debug)]
struct RootFunction {
    /// Index into `ExecutableSystem::root_crossings`.
    raw: usize,
    /// Index into `Dae::crossings`.
    crossing: usize,
    /// Subtracted: 0 for relations, a bound of the present interval for `floor`.
    base: f64,
    /// Added: away from zero, on the present side.
    shift: f64,
    /// For `floor`: whether it watches the upper bound.
    upper: bool,
}

impl RootFunctions {
    /// The root functions of all crossings that need one.
    pub fn new(system: &ExecutableSystem) -> Self {
        let mut functions = Vec::new();
        for (raw, &crossing) in system.root_crossings.iter().enumerate() {
            let one = RootFunction { raw, crossing, base: 0.0, shift: 0.0, upper: false };
            functions.push(one);
            if matches!(system.dae.crossings[crossing].kind, CrossingKind::Floor(_)) {
                functions.push(RootFunction { upper: true, ..one });
            }
        }
        RootFunctions { functions, raw: vec![0.0; system.root_crossings.len()] }
    }

    /// Number of root functions.
    pub fn len(&self) -> usize {
        self.functions.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.functions.is_empty()
    }

    /// The crossing behind a function, as an index into `Dae::crossings`.
    pub fn crossing(&self, function: usize) -> usize {
        self.functions[function].crossing
    }

    /// The entry of [`Self::raw`] behind a function.
    pub fn raw_index(&self, function: usize) -> usize {
        self.functions[function].raw
    }

    /// The shift of a function: positive where the difference is watched from above.
    pub fn shift(&self, function: usize) -> f64 {
        self.functions[function].shift
    }

    /// The unshifted differences, to be filled by the system before [`Self::write`] or [`Self::settle`].
    pub fn raw(&mut self) -> &mut [f64] {
        &mut self.raw
    }

    /// Computes the functions from the unshifted differences.
    pub fn write(&self, g: &mut [f64]) {
        for (g, f) in g.iter_mut().zip(&self.functions) {
            *g = self.raw[f.raw] - f.base + f.shift;
        }
    }

    /// After a start or event: shifts each function so that it lies on the side that its mode says.
    ///
    /// The unshifted differences must be up to date.
    pub fn settle(&mut self, system: &ExecutableSystem, modes: &mut CrossingModes, values: &[f64]) {
        for f in &mut self.functions {
            let mode = values[modes.slots[f.crossing]];
            let side = match system.dae.crossings[f.crossing].kind {
                CrossingKind::Floor(_) => {
                    f.base = mode + f64::from(u8::from(f.upper));
                    if f.upper { -1.0 } else { 1.0 }
                }
                CrossingKind::Relation(rel, ..) => side(rel, mode != 0.0, self.raw[f.raw]),
                CrossingKind::Time(..) => 1.0,
            };
            let d = self.raw[f.raw] - f.base;
            modes.seen(f.crossing, d);
            let shift = SHIFT * modes.size[f.crossing].max(f.base.abs()) + SMALLEST_SHIFT;
            // where the difference lies on the wrong side, it is mirrored to the right one
            f.shift = side * if d * side < 0.0 { 2.0 * d.abs() + shift } else { shift };
        }
    }
}

/// The side of zero on which `left - right` lies (1 or -1), given whether the relation holds.
fn side(rel: RelationalOp, holds: bool, difference: f64) -> f64 {
    match rel {
        RelationalOp::Gt | RelationalOp::Ge if holds => 1.0,
        RelationalOp::Lt | RelationalOp::Le if !holds => 1.0,
        RelationalOp::Gt | RelationalOp::Ge | RelationalOp::Lt | RelationalOp::Le => -1.0,
        RelationalOp::Eq | RelationalOp::Ne => {
            if difference >= 0.0 {
                1.0
            } else {
                -1.0
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_include_the_threshold_where_the_relation_does() {
        // d = 0: `>=` holds and lies above, `>` does not hold and lies below
        assert_eq!(side(RelationalOp::Ge, true, 0.0), 1.0);
        assert_eq!(side(RelationalOp::Gt, false, 0.0), -1.0);
        assert_eq!(side(RelationalOp::Le, true, 0.0), -1.0);
        assert_eq!(side(RelationalOp::Lt, false, 0.0), 1.0);
    }

    #[test]
    fn times_merge_within_rounding() {
        assert!(same_time(0.1 + 0.2, 0.3));
        assert!(!same_time(0.3, 0.3 + 1e-9));
    }
}
