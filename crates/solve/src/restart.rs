//! Going on after an event: whether the integrator may keep its past, and how long its first step may be.
//!
//! At a stop time IDA stands exactly at the event. If the unknowns did not jump and the change of the derivatives is
//! within what the error test sees anyway, stepping on costs nothing; most samples of a recorded input are like that.
//! Else IDA restarts with order one, with a first step from the second derivative (IDA's own choice, half a tolerance
//! of change, is about a thousand times too short).

use super::ida::{DaeEquations, Ida};
use super::model::IntegrationModel;
use super::newton::VariableScales;
use crate::lower::{ColumnRole, ExecutableSystem, UnknownColumn};

/// A jump of an unknown, in tolerances, that does not need a restart.
const SMALL_JUMP: f64 = 1.0;
/// A change of the derivatives over the next step, in tolerances, that the error test may deal with.
const SMALL_KINK: f64 = 0.3;
/// The same over the part of a step that was made beyond a root with the old equations.
const SMALL_TAIL: f64 = 0.1;
/// The error of the first step after an event, in tolerances.
const FIRST_ERROR: f64 = 0.3;
/// The same at the start, where no step tells yet how much of it is to come.
const START_ERROR: f64 = 0.1;

/// How many times shorter, in powers of two, a turn of a crossing function may be than the first step.
const HALVINGS: i32 = 20;

/// Buffers for the unknowns around an event.
#[derive(Debug, Default)]
pub struct IntegratorRestart {
    nominal: Vec<f64>,
    tolerance: f64,
    y: Vec<f64>,
    yp: Vec<f64>,
    old: Vec<f64>,
    old_slopes: Vec<f64>,
    /// Slot of each unknown, and of its derivative if it is a state.
    slots: Vec<(usize, Option<usize>)>,
    /// The derivative of every unknown is given: no algebraic unknowns.
    explicit: bool,
    /// Of each conserved quantity what the integrator had before the event, and what it was by the states then.
    held: Vec<(f64, f64)>,
    correction: Vec<f64>,
    usual_step: f64,
    /// Length of the Euler step behind `correction`.
    probe: f64,
}

impl IntegratorRestart {
    /// For the unknowns of a system; one dummy if it has none.
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

    /// Sizes of the unknowns.
    pub fn nominal(&self) -> &[f64] {
        &self.nominal
    }

    /// True when there are no algebraic unknowns.
    pub fn is_explicit(&self) -> bool {
        self.explicit
    }

    /// The gathered unknowns.
    pub fn y(&self) -> &[f64] {
        &self.y
    }

    /// Their derivatives.
    pub fn yp(&self) -> &[f64] {
        &self.yp
    }

    /// Takes the unknowns from their slots after an event or the start. A conserved quantity changes by what the event has
    /// changed of the states behind it: it does not lose what the corrector left in them.
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

    /// Remembers the unknowns and the equations' derivatives just before an event.
    pub fn before(&mut self, system: &ExecutableSystem, values: &mut [f64], y: &[f64]) {
        self.hold(system, values, |column, _| y[column]);
        self.old.copy_from_slice(y);
        for (old, &(_, der)) in self.old_slopes.iter_mut().zip(&self.slots) {
            *old = der.map_or(0.0, |d| values[d]);
        }
    }

    /// Takes the conserved quantities of a saved state for what the integrator had.
    pub fn resume(&mut self, system: &ExecutableSystem, values: &mut [f64]) {
        self.hold(system, values, |_, saved| saved);
    }

    fn hold(&mut self, system: &ExecutableSystem, values: &mut [f64], kept: impl Fn(usize, f64) -> f64) {
        system.quantities(values);
        for (held, integral) in self.held.iter_mut().zip(&system.integrals) {
            let saved = values[self.slots[integral.column].0];
            *held = (kept(integral.column, saved), values[integral.slot as usize]);
        }
    }

    fn weight(&self, i: usize) -> f64 {
        1.0 / (self.tolerance * (self.y[i].abs() + self.nominal[i]))
    }

    /// Root mean square in tolerances, as IDA measures.
    fn norm(&self, entry: impl Fn(usize) -> f64) -> f64 {
        let n = self.y.len();
        let sum: f64 = (0..n).map(|i| (entry(i) * self.weight(i)).powi(2)).sum();
        (sum / n as f64).sqrt()
    }

    /// Whether the integrator's past still serves at a stop time; `next` is the next one.
    pub fn past_serves(&self, ida: &Ida<IntegrationModel<'_>>, t: f64, next: f64) -> bool {
        let h = ida.step_lengths().1.abs().min(next - t);
        let kink = self.norm(|i| self.yp[i] - self.old_slopes[i]);
        self.jump() <= SMALL_JUMP && kink * h <= SMALL_KINK * f64::from(ida.order() + 1)
    }

    /// The same at a root, beyond which the integrator has already stepped with the old equations: true when the new
    /// ones agree there.
    pub fn past_serves_ahead(&mut self, ida: &mut Ida<IntegrationModel<'_>>, t: f64, changed: bool) -> bool {
        if !changed {
            // Algebraic unknowns are met to a tolerance only: seen through them a crossing lies behind already, and
            // would never be found, that the exact values of the event still have ahead.
            return self.explicit && self.jump() <= SMALL_JUMP;
        }
        let kink = self.norm(|i| self.yp[i] - self.old_slopes[i]);
        let tail = (ida.internal_time() - t).abs();
        if !self.explicit || self.jump() > 0.0 || kink * tail > SMALL_TAIL {
            return false;
        }
        let mut residual = std::mem::take(&mut self.correction);
        let agrees = ida.residual_ahead(&mut residual) && self.norm(|i| residual[i]) * tail <= SMALL_TAIL;
        self.correction = residual;
        agrees
    }

    /// The largest jump of an unknown at the event, in tolerances.
    fn jump(&self) -> f64 {
        (0..self.y.len()).map(|i| ((self.y[i] - self.old[i]) * self.weight(i)).abs()).fold(0.0, f64::max)
    }

    /// Keeps in mind how long steps were before a restart.
    pub fn remember_step(&mut self, ida: &Ida<IntegrationModel<'_>>) {
        self.usual_step = ida.step_lengths().0.max(0.5 * self.usual_step);
    }

    /// Restarts at `t` from the gathered values; `room` is left until the next event. False when IDA refuses.
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
        if root {
            h = self.see_return(ida, t, h);
        }
        if !start && ida.restart(t, &self.y, &self.yp).is_err() {
            return false;
        }
        ida.set_first_step(h);
        true
    }

    /// A step that does not leap over what a crossing function does beside going on: crossing zero and coming back, as
    /// after the small bounce of a ball, or leaving zero and returning to it, as where a contact slips for a moment. The
    /// straight line of the first step would miss the one, and take the other back at once, over and over. At most a
    /// quarter of the shortest of these times.
    fn see_return(&mut self, ida: &mut Ida<IntegrationModel<'_>>, t: f64, h: f64) -> f64 {
        let count = ida.equations().roots.len();
        let at = |ahead: f64| {
            let mut g = vec![0.0; count];
            self.crossings_after(ida, t, ahead, &mut g);
            g
        };
        let times: Vec<f64> = (0..=HALVINGS).map(|k| 4.0 * h * 0.5_f64.powi(k)).collect();
        let trajectories: Vec<Vec<f64>> = std::iter::once(0.0).chain(times.iter().copied()).map(at).collect();
        let turns = (0..count).filter_map(|i| turn(trajectories[0][i], |k| trajectories.get(k + 1).map(|g| g[i])));
        turns.max().map_or(h, |k| 0.25 * times[k])
    }

    /// The crossing functions a time `h` ahead, by a parabola through the values and derivatives now.
    fn crossings_after(&self, ida: &mut Ida<IntegrationModel<'_>>, t: f64, h: f64, g: &mut [f64]) {
        let bend = |i: usize| self.correction.get(i).map_or(0.0, |c| c / (self.probe * self.probe));
        let y: Vec<f64> = (0..self.y.len()).map(|i| self.y[i] + h * (self.yp[i] + 0.5 * h * bend(i))).collect();
        ida.equations().crossings(t + h, &y, &self.yp, g);
    }

    /// The slopes of algebraic unknowns, from what they moved in the Euler step: IDA predicts with them. What is left of
    /// the correction is the bend of the states. Not at the start, where nothing tells how far a straight line serves.
    fn learn_slopes(&mut self, probe: f64, correction: &mut [f64]) {
        for (i, _) in self.slots.iter().enumerate().filter(|(_, (_, der))| der.is_none()) {
            self.yp[i] = correction[i] / probe;
            correction[i] = 0.0;
        }
    }

    /// The step with this error, in tolerances, with order one; at most `longest`.
    fn first_step(&mut self, ida: &mut Ida<IntegrationModel<'_>>, t: f64, longest: f64, room: f64, error: f64) -> f64 {
        let speed = self.norm(|i| self.yp[i]);
        let usual = if self.usual_step > 0.0 { self.usual_step } else { 1e-3 * room };
        // moves the unknowns by about one tolerance
        let probe = (1.0 / speed).min(0.1 * usual).min(0.01 * room).max(1e-10 * t.abs());
        // nothing is known of the start's surroundings: no unknown shall leave its own size at once
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
            (2.0 * error / bend).sqrt().min(most)
        } else {
            (0.5 / speed).min(most)
        };
        self.correction = correction;
        self.probe = probe;
        if h > 0.0 { h } else { most }
    }
}

/// The first of shorter and shorter times ahead at which a function, `now` and at these times, is seen to turn: on the
/// other side of zero though it is on this one later, or farther on this side than now though it is on the other later.
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
