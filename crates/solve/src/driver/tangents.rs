//! Sensitivities along a run: their start, their cells in rows, and how they jump at events.
//!
//! With the time tau of an event moving by dtau, a state x that goes from x- to x+ = R(x-, tau) has behind it the
//! sensitivity dx+ = dR - x'+ dtau, where R moves along dx- + x'- dtau; without `reinit` this is dx- + (x'- - x'+) dtau.
//! Where a crossing g causes the event, dtau = -dg / (dg/dt), both along the solution. Source: S. Galan, W. F. Feehery,
//! P. I. Barton, Applied Numerical Mathematics 31 (1999) 17.

use super::{Driver, EarlyStop, EventCause, StopResult};
use crate::TangentRequest;
use crate::algebraic::{HOLD_STATES, holding};
use crate::events::EventOutcome;
use crate::ida::{DaeEquations, DifferentiableEquations, EvaluationStatus};
use crate::linear::Lu;
use crate::lower::{ExecutableSystem, UnknownColumn, ValueLayout};
use crate::model::IntegrationModel;
use crate::modes::CrossingModes;
use crate::settings::End;
use crate::tangents::column;
use bramah_expr::VarId;
use bramah_syntax::diag::{Code, Diagnostic};

/// Reach of differences along a direction, as a part of the unknowns' sizes.
const REACH: f64 = 1e-5;
/// A change of rates over the next step, in tolerances, that the corrector may deal with.
const SMALL_KINK: f64 = 0.3;

/// What is carried along.
pub struct TangentPropagator {
    /// Per direction the derivatives of all unknowns.
    values: Vec<Vec<f64>>,
    /// And of their rates.
    rates: Vec<Vec<f64>>,
    /// Where they belong: unknowns and derivatives.
    y: Vec<f64>,
    yp: Vec<f64>,
    /// Per wanted variable its column and sign, if it is an unknown.
    sources: Vec<Option<(usize, f64)>>,
    nominal: Vec<f64>,
    states: Vec<bool>,
    /// By how much the time of the present event moves, per direction.
    shift: Vec<f64>,
    /// Their rates before the event.
    before: Vec<Vec<f64>>,
    lu: Lu,
    matrix: Vec<f64>,
    /// The present event made states jump, or changed the equations.
    broken: bool,
}

/// An event about to be carried out: values and forced modes, to carry it out again beside.
pub type PendingEvent = Option<(Vec<f64>, CrossingModes)>;

/// A solution and its trajectory in time: unknowns, derivatives.
struct SolutionPoint {
    y: Vec<f64>,
    yp: Vec<f64>,
}

impl TangentPropagator {
    pub fn new(
        system: &ExecutableSystem,
        asked: &TangentRequest,
        wanted: &[VarId],
        nominal: &[f64],
    ) -> TangentPropagator {
        let n = system.columns.len();
        let start = |direction: &Vec<(VarId, f64)>| {
            let mut values = vec![0.0; n];
            for &(v, by) in direction {
                if let Some((j, sign)) = column(system, v) {
                    values[j] = sign * by;
                }
            }
            values
        };
        let count = asked.starts.len();
        let solved: Vec<bool> = system.columns.iter().map(|c| !c.is_state()).collect();
        TangentPropagator {
            values: asked.starts.iter().map(start).collect(),
            rates: vec![vec![0.0; n]; count],
            y: vec![0.0; n],
            yp: vec![0.0; n],
            sources: wanted.iter().map(|&v| column(system, v)).collect(),
            nominal: nominal.to_vec(),
            states: system.columns.iter().map(|c| c.is_state()).collect(),
            shift: vec![0.0; count],
            before: vec![vec![0.0; n]; count],
            lu: holding(system, nominal, &solved),
            matrix: vec![0.0; system.pattern.nnz()],
            broken: false,
        }
    }

    /// How many directions.
    pub fn count(&self) -> usize {
        self.values.len()
    }

    /// Whether what the equations leave open may keep its value ([`Lu::may_keep`]).
    pub fn may_keep(&mut self, allowed: bool) {
        self.lu.may_keep(allowed);
    }

    /// Notes where the values belong.
    fn stand(&mut self, y: &[f64], yp: &[f64]) {
        self.y.copy_from_slice(y);
        self.yp.copy_from_slice(yp);
    }

    /// Makes the matrix for [`TangentPropagator::complete`] where the values belong; false when it is singular.
    fn prepare(&mut self, model: &mut IntegrationModel<'_>, t: f64) -> bool {
        model.forget();
        model.differentiate(t, &self.y, &self.yp) == EvaluationStatus::Done
            && model.jacobian(t, HOLD_STATES, &self.y, &self.yp, &mut self.matrix) == EvaluationStatus::Done
            && self.lu.factor(&self.matrix).is_ok()
    }

    /// From the derivatives of states those of everything else, so that they satisfy the equations; `own` is what the
    /// equations change by themselves.
    fn complete(&mut self, model: &IntegrationModel<'_>, values: &mut [f64], rates: &mut [f64], own: &[f64]) -> bool {
        for (j, state) in self.states.iter().enumerate() {
            rates[j] = 0.0;
            values[j] = if *state { values[j] } else { 0.0 };
        }
        let mut left = vec![0.0; values.len()];
        // the second pass takes away what rounding left
        for _ in 0..2 {
            model.along(values, rates, &mut left);
            left.iter_mut().zip(own).for_each(|(l, o)| *l += o);
            if !self.lu.solve(&mut left) {
                return false;
            }
            for (j, state) in self.states.iter().enumerate() {
                if *state {
                    rates[j] -= HOLD_STATES * left[j];
                } else {
                    values[j] -= left[j];
                }
            }
        }
        values.iter().chain(&*rates).all(|v| v.is_finite())
    }

    /// The same for all directions.
    fn complete_all(&mut self, model: &IntegrationModel<'_>) -> bool {
        let (mut values, mut rates) = (std::mem::take(&mut self.values), std::mem::take(&mut self.rates));
        let own = vec![0.0; self.y.len()];
        let done = values.iter_mut().zip(&mut rates).all(|(s, sp)| self.complete(model, s, sp, &own));
        (self.values, self.rates) = (values, rates);
        done
    }

    /// How the solution itself goes on in time: rates of all unknowns, and theirs.
    fn trajectory(&mut self, model: &mut IntegrationModel<'_>, t: f64, step: f64) -> Option<SolutionPoint> {
        let n = self.y.len();
        let (mut up, mut own) = (vec![0.0; n], vec![0.0; n]);
        let dt = (1e-4 * step).max(1e-11 * t.abs()).max(f64::MIN_POSITIVE.sqrt());
        let known = model.residual(t - dt, &self.y, &self.yp, &mut own) == EvaluationStatus::Done
            && model.residual(t + dt, &self.y, &self.yp, &mut up) == EvaluationStatus::Done;
        own.iter_mut().zip(&up).for_each(|(d, u)| *d = (u - *d) / (2.0 * dt));
        let (mut y, mut yp) = (self.yp.clone(), vec![0.0; n]);
        (known && self.complete(model, &mut y, &mut yp, &own)).then_some(SolutionPoint { y, yp })
    }

    /// How far to go along a direction for a difference.
    fn reach(&self, values: &[f64]) -> f64 {
        let part = |j: usize| values[j].abs() / (self.y[j].abs() + self.nominal[j]);
        let most = (0..values.len()).map(part).fold(0.0, f64::max);
        if most > 0.0 { REACH / most } else { 1.0 }
    }

    /// The unknowns and derivatives some way along a direction.
    fn moved(&self, by: f64, values: &[f64], rates: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let add = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a + by * b).collect();
        (add(&self.y, values), add(&self.yp, rates))
    }

    /// How a crossing changes along a direction, with time by `dt`.
    fn crossing(
        &self,
        model: &mut IntegrationModel<'_>,
        t: f64,
        raw: usize,
        dt: f64,
        values: &[f64],
        rates: &[f64],
    ) -> f64 {
        let reach = self.reach(values);
        let mut at = |by: f64| {
            let (y, yp) = self.moved(by, values, rates);
            model.raw_crossing(t + by * dt, &y, &yp, raw)
        };
        (at(reach) - at(-reach)) / (2.0 * reach)
    }
}

fn lost(text: &str, t: f64) -> EarlyStop {
    let text = format!("{text} at {} s", bramah_results::number::rounded(t, 6));
    EarlyStop::new(End::NonFinite, Diagnostic::new(Code::NonFinite, text))
}

impl<'a> Driver<'a, '_> {
    /// At the start, from the derivatives of the states.
    pub(super) fn start_tangents(&mut self, model: &mut IntegrationModel<'a>) -> StopResult {
        let Some(mut carried) = self.carried.take() else { return Ok(()) };
        self.restart.gather(self.system, &mut model.values);
        carried.stand(self.restart.y(), self.restart.yp());
        let done = carried.prepare(model, self.t) && carried.complete_all(model);
        self.carried = Some(carried);
        if done { Ok(()) } else { Err(lost("the equations do not determine the sensitivities", self.t)) }
    }

    /// Where a row stands.
    pub(super) fn tangents_stand(&mut self, y: &[f64], yp: &[f64]) {
        if let Some(carried) = &mut self.carried {
            carried.stand(y, yp);
        }
    }

    /// Takes those of a row from the integrator.
    pub(super) fn take_tangents(&mut self) {
        let t = self.t;
        let (Some(carried), Some(ida)) = (&mut self.carried, &mut self.ida) else { return };
        ida.tangents_at(t, 0, &mut carried.values);
        if carried.sources.iter().any(Option::is_none) {
            ida.tangents_at(t, 1, &mut carried.rates);
        }
    }

    /// Fills the cells behind the wanted values of a row at these unknowns.
    pub(super) fn tangent_cells(&mut self, model: &mut IntegrationModel<'a>) {
        let Some(carried) = self.carried.take() else { return };
        let wanted = self.slots.len();
        let computed = carried.sources.iter().any(Option::is_none);
        for k in 0..carried.count() {
            let cells = &mut self.row[wanted * (k + 1)..wanted * (k + 2)];
            let (values, rates) = (&carried.values[k], &carried.rates[k]);
            if computed {
                let reach = carried.reach(values);
                for (by, sign) in [(reach, 1.0), (-reach, -1.0)] {
                    let (y, yp) = carried.moved(by, values, rates);
                    model.load(self.t, &y, &yp);
                    self.program.run(&mut model.values);
                    let share = sign / (2.0 * reach);
                    let add = |(c, &slot): (&mut f64, &usize)| {
                        *c = share * model.values[slot] + if sign > 0.0 { 0.0 } else { *c };
                    };
                    cells.iter_mut().zip(&self.slots).for_each(add);
                }
            }
            for (cell, source) in cells.iter_mut().zip(&carried.sources) {
                if let Some((j, sign)) = source {
                    *cell = sign * values[*j];
                }
            }
        }
        if computed {
            model.load(self.t, &carried.y, &carried.yp);
            self.program.run(&mut model.values);
        }
        self.carried = Some(carried);
    }

    /// Before an event: completes the sensitivities at the solution and tells by how much the event moves in time.
    pub(super) fn tangents_before(
        &mut self,
        model: &mut IntegrationModel<'a>,
        cause: EventCause,
        y: &[f64],
    ) -> StopResult {
        let Some(mut carried) = self.carried.take() else { return Ok(()) };
        let (t, step) = (self.t, self.last_step);
        let rates: Vec<f64> = {
            let layout = &self.system.layout;
            let rate =
                |c: &UnknownColumn| layout.der(c.variable).filter(|_| c.is_state()).map_or(0.0, |d| model.values[d]);
            self.system.columns.iter().map(rate).collect()
        };
        carried.stand(y, &rates);
        carried.broken = false;
        carried.shift.fill(0.0);
        let mut done = carried.prepare(model, t) && carried.complete_all(model);
        carried.before.clone_from(&carried.rates);
        let root = self.roots.iter().position(|&d| d != 0).filter(|_| cause == EventCause::Root && done);
        if let Some(function) = root {
            let raw = model.roots.raw_index(function);
            let trajectory = carried.trajectory(model, t, step);
            let speed = trajectory.map(|c| carried.crossing(model, t, raw, 1.0, &c.y, &c.yp));
            let speed = speed.filter(|s| s.is_finite() && *s != 0.0);
            done = speed.is_some();
            for k in 0..carried.count() {
                let by = carried.crossing(model, t, raw, 0.0, &carried.values[k], &carried.rates[k]);
                carried.shift[k] = if by == 0.0 { 0.0 } else { -by / speed.unwrap_or(f64::NAN) };
            }
        }
        self.carried = Some(carried);
        if done { Ok(()) } else { Err(lost("the sensitivities end", t)) }
    }

    /// What is needed to carry the event out again beside: only where states may be set.
    pub(super) fn ready(&self, model: &IntegrationModel<'a>) -> PendingEvent {
        self.carried.as_ref().map(|_| (model.values.clone(), self.modes.clone()))
    }

    /// After an event whose new unknowns have been gathered: the sensitivities behind it.
    pub(super) fn tangents_after(
        &mut self,
        model: &mut IntegrationModel<'a>,
        outcome: &EventOutcome,
        ready: PendingEvent,
    ) -> StopResult {
        let (Some(mut carried), Some(ready)) = (self.carried.take(), ready) else { return Ok(()) };
        let t = self.t;
        carried.broken = outcome.changed || outcome.reinitialised;
        let mut done = true;
        for k in 0..carried.count() {
            let shift = carried.shift[k];
            let direction: Vec<f64> = carried.values[k].iter().zip(&carried.yp).map(|(s, yp)| s + shift * yp).collect();
            let mut behind = direction.clone();
            if outcome.reinitialised {
                done &= self.repeat(&carried, &ready, &direction, shift, &mut behind);
            }
            for (j, behind) in behind.iter().enumerate().filter(|(j, _)| carried.states[*j]) {
                let after = behind - shift * self.restart.yp()[j];
                carried.values[k][j] =
                    if shift == 0.0 && !outcome.reinitialised { carried.values[k][j] } else { after };
            }
        }
        carried.stand(self.restart.y(), self.restart.yp());
        done = done && carried.prepare(model, t) && carried.complete_all(model);
        self.carried = Some(carried);
        if done { Ok(()) } else { Err(lost("the sensitivities end", t)) }
    }

    /// How the states behind an event move with those before it and its time, by carrying it out beside.
    fn repeat(
        &mut self,
        carried: &TangentPropagator,
        ready: &(Vec<f64>, CrossingModes),
        direction: &[f64],
        dt: f64,
        out: &mut [f64],
    ) -> bool {
        let system = self.system;
        let reach = carried.reach(direction);
        let slots: Vec<usize> = system.columns.iter().map(|c| system.layout.var(c.variable)).collect();
        let mut at = |by: f64| {
            let mut values = ready.0.clone();
            values[ValueLayout::TIME] += by * dt;
            for (j, &slot) in slots.iter().enumerate().filter(|(j, _)| carried.states[*j]) {
                values[slot] = carried.y[j] + by * direction[j];
            }
            let done = self.events.iterate(system, &self.scales, &ready.1, &mut values).is_ok();
            (done, values)
        };
        let ((up_done, up), (down_done, down)) = (at(reach), at(-reach));
        out.iter_mut().zip(&slots).for_each(|(o, &slot)| *o = (up[slot] - down[slot]) / (2.0 * reach));
        up_done && down_done
    }

    /// Whether the integrator's past serves for the sensitivities too.
    pub(super) fn tangents_go_on(&self) -> bool {
        let (Some(carried), Some(ida)) = (&self.carried, &self.ida) else { return true };
        let step = ida.step_lengths().1.abs();
        let allowed = SMALL_KINK * f64::from(ida.order() + 1) * self.settings.tolerance;
        let kink = |k: usize| {
            let of = |j: usize| {
                let change = carried.rates[k][j] - carried.before[k][j];
                let size = carried.values[k][j].abs() + carried.nominal[j];
                if carried.states[j] { (change * step / size).powi(2) } else { 0.0 }
            };
            ((0..carried.y.len()).map(of).sum::<f64>() / carried.y.len() as f64).sqrt()
        };
        !carried.broken && (0..carried.count()).all(|k| kink(k) <= allowed)
    }

    /// Begins or restarts the integrator's sensitivities with those carried; false when it refuses.
    pub(super) fn hand_over_tangents(&mut self, first: bool) -> bool {
        let (Some(carried), Some(ida)) = (&self.carried, &mut self.ida) else { return true };
        let (values, rates) = (&carried.values, &carried.rates);
        let controlled = self.settings.tangents.as_ref().is_some_and(|asked| asked.controlled);
        if first { ida.begin_tangents(values, rates, controlled) } else { ida.restart_tangents(values, rates) }.is_ok()
    }
}
