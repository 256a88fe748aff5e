//! Continuing after an event: whether IDA keeps its past, and the length of the first step after a restart.
//!
//! At a stop time IDA stands exactly at the event. If the unknowns did not jump, and the change of the derivatives is
//! within what the error test detects anyway, IDA continues without a restart. Most samples of a recorded input are
//! of this kind. Otherwise IDA restarts with order 1. The first step follows from an estimate of the second derivative,
//! because IDA's own choice (half a tolerance of change) is about a thousand times too short.

use super::ida::{DaeEquations, Ida};
use super::model::IntegrationModel;
use super::newton::VariableScales;
use crate::lower::{ColumnRole, ExecutableSystem, UnknownColumn};

/// A jump of an unknown, in tolerances, that needs no restart.
const SMALL_JUMP: f64 = 1.0;
/// A change of the derivatives over the next step, in tolerances, that needs no restart.
const SMALL_KINK: f64 = 0.3;
/// The same over the part of a step that was made beyond a root with the old equations.
const SMALL_TAIL: f64 = 0.1;
/// The error of the first step after an event, in tolerances.
const FIRST_ERROR: f64 = 0.3;
/// The error of the first step of a run, in tolerances. No earlier step shows how long a step can be there.
const START_ERROR: f64 = 0.1;

/// Halvings of the time ahead in the search for a turn of a crossing function.
const HALVINGS: i32 = 20;

/// Unknowns and derivatives around an event. All vectors have one entry per column, or one where there is no column.
#[derive(Debug, Default)]
pub struct IntegratorRestart {
    /// Nominal values of the unknowns.
    nominal: Vec<f64>,
    /// Relative tolerance of the run.
    tolerance: f64,
    /// Unknowns after the event, with which IDA restarts.
    y: Vec<f64>,
    /// Derivatives after the event; 0 for algebraic unknowns until [`Self::learn_slopes`].
    yp: Vec<f64>,
    /// Unknowns just before the event.
    old: Vec<f64>,
    /// Derivatives just before the event, from the equations.
    old_slopes: Vec<f64>,
    /// Slot of each unknown, and of its derivative if it is differential or follows from a conserved quantity.
    slots: Vec<(usize, Option<usize>)>,
    /// Whether the equations give the derivative of every unknown, so that there are no algebraic unknowns.
    explicit: bool,
    /// For each conserved quantity its value in the integrator before the event, and its value by the states then.
    held: Vec<(f64, f64)>,
    /// The Euler correction of the last first step; 0 for algebraic unknowns once their slopes are known.
    correction: Vec<f64>,
    /// Length of the steps before the last restart, in seconds; 0 when there was none.
    usual_step: f64,
    /// Length of the Euler step behind `correction`, in seconds.
    probe: f64,
}

impl IntegratorRestart {
    /// Buffers for the unknowns of a system; for one dummy unknown if the system has none.
    pub fn new(system: &ExecutableSystem, scales: &VariableScales, tolerance: f64) -> Self {
        let mut nominal: Vec<f64> = system.columns.iter().map(|c| scales.nominal[c.variable.index()]).collect();
        let layout = &system.layout;
        let der = |c: &UnknownColumn| if c.role == ColumnRole::Algebraic { None } else { layout.der(c.variable) };
        let slots = system.columns.iter().map(|c| (layout.var(c.variable), der(c))).collect();
        if nominal.is_empty() {
            nominal.push(1.0);
        }
        let n = nominal.len();
        let zeros = || vec![0.0; n];
        IntegratorRestart {
            nominal,
            tolerance,
            y: zeros(),
            yp: zeros(),
            old: zeros(),
            old_slopes: zeros(),
            slots,
            explicit: system.gives_rates(),
            held: vec![(0.0, 0.0); system.integrals.len()],
            correction: Vec::new(),
            usual_step: 0.0,
            probe: 1.0,
        }
    }

    /// Nominal values of the unknowns.
    pub fn nominal(&self) -> &[f64] {
        &self.nominal
    }

    /// Whether there are no algebraic unknowns.
    pub fn is_explicit(&self) -> bool {
        self.explicit
    }

    /// The unknowns gathered last.
    pub fn y(&self) -> &[f64] {
        &self.y
    }

    /// The derivatives gathered last.
    pub fn yp(&self) -> &[f64] {
        &self.yp
    }

    /// Copies unknowns and derivatives from their slots after an event or the start.
    ///
    /// A conserved quantity changes only by what the event has changed of its states. It keeps the difference between
    /// the integrator's value and the value by the states, so that corrector errors do not accumulate in it.
    pub fn gather(&mut self, system: &ExecutableSystem, values: &mut [f64]) {
        system.quantities(values);
        for (i, &(slot, der)) in self.slots.iter().enumerate() {
            self.y[i] = values[slot];
            self.yp[i] = der.map_or(0.0, |d| values[d]);
        }
        for (integral, &(kept, before)) in system.integrals.iter().zip(&self.held) {
            let value = kept + (values[integral.slot as usize] - before);
            self.y[integral.column] = value;
            values[self.slots[integral.column].0] = value;
        }
    }

    /// Stores unknowns and derivatives just before an event. `values` must be observed there.
    pub fn before(&mut self, system: &ExecutableSystem, values: &mut [f64], y: &[f64]) {
        self.hold(system, values, |column, _| y[column]);
        self.old.copy_from_slice(y);
        for (old, &(_, der)) in self.old_slopes.iter_mut().zip(&self.slots) {
            *old = der.map_or(0.0, |d| values[d]);
        }
    }

    /// Takes the conserved quantities of a saved state as the values of the integrator.
    pub fn resume(&mut self, system: &ExecutableSystem, values: &mut [f64]) {
        self.hold(system, values, |_, saved| saved);
    }

    /// Stores for each quantity the value to keep and the value by the states.
    fn hold(&mut self, system: &ExecutableSystem, values: &mut [f64], kept: impl Fn(usize, f64) -> f64) {
        system.quantities(values);
        for (held, integral) in self.held.iter_mut().zip(&system.integrals) {
            let saved = values[self.slots[integral.column].0];
            *held = (kept(integral.column, saved), values[integral.slot as usize]);
        }
    }

    /// The reciprocal tolerance of an unknown.
    fn weight(&self, i: usize) -> f64 {
        1.0 / (self.tolerance * (self.y[i].abs() + self.nominal[i]))
    }

    /// Root mean square of the entries in tolerances, like IDA's norm.
    fn norm(&self, entry: impl Fn(usize) -> f64) -> f64 {
        let n = self.y.len();
        let sum: f64 = (0..n).map(|i| (entry(i) * self.weight(i)).powi(2)).sum();
        (sum / n as f64).sqrt()
    }

    /// Whether IDA's past is still valid after an event at a stop time; `next` is the next stop in seconds.
    pub fn past_serves(&self, ida: &Ida<IntegrationModel<'_>>, t: f64, next: f64) -> bool {
        // the first step after the event, during which a kink of the derivatives acts
        let h = ida.step_lengths().1.abs().min(next - t);
        let kink = self.norm(|i| self.yp[i] - self.old_slopes[i]);
        self.jump() <= SMALL_JUMP && kink * h <= SMALL_KINK * f64::from(ida.order() + 1)
    }

    /// Whether IDA's past is still valid after a root. IDA has already stepped beyond it with the old equations.
    pub fn past_serves_ahead(&mut self, ida: &mut Ida<IntegrationModel<'_>>, t: f64, changed: bool) -> bool {
        // Algebraic unknowns satisfy their equations only to a tolerance. With IDA's values a crossing may seem passed
        // that the exact values of the event still have ahead. IDA would never report it, so only explicit systems may
        // continue.
        if !changed {
            return self.explicit && self.jump() <= SMALL_JUMP;
        }
        let kink = self.norm(|i| self.yp[i] - self.old_slopes[i]);
        let tail = (ida.internal_time() - t).abs();
        if !self.explicit || self.jump() > 0.0 || kink * tail > SMALL_TAIL {
            return false;
        }
        // the changed equations must agree with the end of IDA's step
        let mut residual = std::mem::take(&mut self.correction);
        let agrees = ida.residual_ahead(&mut residual) && self.norm(|i| residual[i]) * tail <= SMALL_TAIL;
        self.correction = residual;
        agrees
    }

    /// The largest jump of an unknown at the event, in tolerances.
    fn jump(&self) -> f64 {
        (0..self.y.len()).map(|i| ((self.y[i] - self.old[i]) * self.weight(i)).abs()).fold(0.0, f64::max)
    }

    /// Records how long the steps were before a restart.
    pub fn remember_step(&mut self, ida: &Ida<IntegrationModel<'_>>) {
        // a short step just before the event must not shorten all later restarts
        self.usual_step = ida.step_lengths().0.max(0.5 * self.usual_step);
    }

    /// Restarts IDA at `t` from the gathered values and sets the first step; false when IDA refuses.
    ///
    /// `room` is the time until the next stop and `longest` the longest step, both in seconds. `start` is true at the
    /// start of a run, where IDA is new. `root` is true after a root.
    pub fn restart(
        &mut self,
        ida: &mut Ida<IntegrationModel<'_>>,
        t: f64,
        room: f64,
        longest: f64,
        start: bool,
        root: bool,
    ) -> bool {
        let error = if start { START_ERROR } else { FIRST_ERROR };
        let mut h = self.first_step(ida, t, room.min(longest), room, error);
        // after a root a function may cross back within the first step
        if root {
            h = self.see_return(ida, t, h);
        }
        if !start && ida.restart(t, &self.y, &self.yp).is_err() {
            return false;
        }
        ida.set_first_step(h);
        true
    }

    /// Shortens the first step so that it does not pass over two crossings of one function.
    ///
    /// The function may cross zero and come back (a small bounce of a ball), or leave zero and return (a contact that
    /// slips for a moment). A straight first step would miss the first case and repeat the second one again and again.
    /// The step is at most a quarter of the shortest such time.
    fn see_return(&mut self, ida: &mut Ida<IntegrationModel<'_>>, t: f64, h: f64) -> f64 {
        let count = ida.equations().roots.len();
        let at = |ahead: f64| {
            let mut g = vec![0.0; count];
            self.crossings_after(ida, t, ahead, &mut g);
            g
        };
        // from four steps ahead down to 4 h / 2^20
        let times: Vec<f64> = (0..=HALVINGS).map(|k| 4.0 * h * 0.5_f64.powi(k)).collect();
        let trajectories: Vec<Vec<f64>> = std::iter::once(0.0).chain(times.iter().copied()).map(at).collect();
        let turns = (0..count).filter_map(|i| turn(trajectories[0][i], |k| trajectories.get(k + 1).map(|g| g[i])));
        turns.max().map_or(h, |k| 0.25 * times[k])
    }

    /// The crossing functions a time `h` ahead, on a parabola through the present values and derivatives.
    fn crossings_after(&self, ida: &mut Ida<IntegrationModel<'_>>, t: f64, h: f64, g: &mut [f64]) {
        // correction = h^2 y'' to first order, so y'' = correction / probe^2
        let bend = |i: usize| self.correction.get(i).map_or(0.0, |c| c / (self.probe * self.probe));
        let y: Vec<f64> = (0..self.y.len()).map(|i| self.y[i] + h * (self.yp[i] + 0.5 * h * bend(i))).collect();
        ida.equations().crossings(t + h, &y, &self.yp, g);
    }

    /// Takes the derivatives of algebraic unknowns from the Euler step, because IDA's predictor uses them.
    ///
    /// Their corrections become 0: what remains of `correction` estimates the second derivatives of the states. Not
    /// used at the start, where nothing tells how far a straight line is valid.
    fn learn_slopes(&mut self, probe: f64, correction: &mut [f64]) {
        for (i, _) in self.slots.iter().enumerate().filter(|(_, (_, der))| der.is_none()) {
            self.yp[i] = correction[i] / probe;
            correction[i] = 0.0;
        }
    }

    /// The length of a step of order 1 with this error in tolerances, in seconds; at most `longest`.
    fn first_step(&mut self, ida: &mut Ida<IntegrationModel<'_>>, t: f64, longest: f64, room: f64, error: f64) -> f64 {
        let speed = self.norm(|i| self.yp[i]);
        let usual = if self.usual_step > 0.0 { self.usual_step } else { 1e-3 * room };
        // moves the unknowns by about one tolerance, but stays above the rounding of t
        let probe = (1.0 / speed).min(0.1 * usual).min(0.01 * room).max(1e-10 * t.abs());
        // at the start: no unknown shall move by more than its own size in one step
        let sensible = if self.usual_step > 0.0 { f64::INFINITY } else { 1.0 / (self.tolerance * speed) };
        let most = (10.0 * usual).min(longest).min(sensible);
        if self.slots.is_empty() || probe.is_nan() || probe <= 0.0 {
            return most;
        }
        let mut correction = std::mem::take(&mut self.correction);
        let known = ida.euler_correction(t, probe, &self.y, &self.yp, self.explicit, &mut correction);
        let h = if known {
            if error == FIRST_ERROR {
                self.learn_slopes(probe, &mut correction);
            }
            let bend = self.norm(|i| correction[i]) / (probe * probe);
            // the error of a step of order 1 is h^2 y'' / 2
            (2.0 * error / bend).sqrt().min(most)
        } else {
            (0.5 / speed).min(most)
        };
        self.correction = correction;
        self.probe = probe;
        if h > 0.0 { h } else { most }
    }
}

/// The index of the first of ever shorter times ahead at which a function is seen to turn back.
///
/// The function turns when it is on the other side of zero now than later, or farther from zero than now although it
/// crosses later. `ahead(k)` is the function at time k; `None` ends the times. `None` as the result: no turn.
fn turn(now: f64, ahead: impl Fn(usize) -> Option<f64>) -> Option<usize> {
    let here = |g: f64| g.signum() == now.signum();
    let returns = here(ahead(0)?);
    let (k, g) = (1..).map_while(|k| Some((k, ahead(k)?))).find(|(_, g)| here(*g) != returns)?;
    (returns || g.abs() > now.abs()).then_some(k)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A parabola from `now` with this slope and bend, at times of 1, 1/2, 1/4, ...
    fn parabola(now: f64, slope: f64, bend: f64) -> Option<usize> {
        turn(now, |k| {
            let t = 0.5_f64.powi(i32::try_from(k).expect("small"));
            (k < 12).then_some(now + slope * t + 0.5 * bend * t * t)
        })
    }

    #[test]
    fn turns_of_crossing_functions_are_seen() {
        // up through zero and back down at 0.1: first seen above at 1/16
        assert_eq!(parabola(-1e-12, 0.05, -1.0), Some(4));
        // away from zero, and back at 0.1
        assert_eq!(parabola(-1e-12, -0.05, 1.0), Some(4));
        // straight through zero, straight away from it, towards it from afar
        assert_eq!(parabola(-1e-12, 0.05, 0.0), None);
        assert_eq!(parabola(-1e-12, -0.05, 0.0), None);
        assert_eq!(parabola(-0.5, 0.1, 2.0), None);
    }
}
