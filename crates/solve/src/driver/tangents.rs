//! Sensitivities along a run: their start, their cells in rows, and their jumps at events.
//!
//! At an event the time tau moves by dtau along a direction. A state goes from x- to x+ = R(x-, tau). Its sensitivity
//! after the event is dx+ = dR - x'+ dtau, where R moves along dx- + x'- dtau. Without `reinit` this is
//! dx- + (x'- - x'+) dtau. Where a crossing g causes the event, dtau = -dg / (dg/dt), both along the solution.
//! Source: S. Galan, W. F. Feehery, P. I. Barton, Applied Numerical Mathematics 31 (1999) 17. Between events IDAS
//! integrates the sensitivities (`ida/sensitivity.rs`).

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

/// Length of a difference along a direction, as a part of the sizes of the unknowns.
const REACH: f64 = 1e-5;
/// A change of the derivatives over the next step, in tolerances, that the corrector can absorb without a restart.
const SMALL_KINK: f64 = 0.3;

/// The sensitivities of a run and the workspace to move them over events.
pub struct TangentPropagator {
    /// For each direction the derivatives of all unknowns, one per column.
    values: Vec<Vec<f64>>,
    /// For each direction the time derivatives of `values`.
    rates: Vec<Vec<f64>>,
    /// The unknowns at which `values` and `rates` are taken.
    y: Vec<f64>,
    /// The derivatives of the unknowns there.
    yp: Vec<f64>,
    /// For each wanted variable its column and sign. `None` where it is no unknown and is computed by differences.
    sources: Vec<Option<(usize, f64)>>,
    /// Nominal values of the unknowns.
    nominal: Vec<f64>,
    /// For each column whether it is a state.
    states: Vec<bool>,
    /// For each direction the change dtau of the time of the present event.
    shift: Vec<f64>,
    /// The time derivatives of the sensitivities before the event.
    before: Vec<Vec<f64>>,
    /// Factors of the matrix with held states, see [`TangentPropagator::prepare`].
    lu: Lu,
    /// Entries of that matrix in the order of the pattern.
    matrix: Vec<f64>,
    /// Whether the present event changed states or equations, so that IDA must restart.
    broken: bool,
}

/// Slots and modes before an event, with which it can be repeated nearby. `None` without sensitivities.
pub type PendingEvent = Option<(Vec<f64>, CrossingModes)>;

/// The time derivative of the solution.
struct SolutionPoint {
    /// The time derivatives of all unknowns.
    y: Vec<f64>,
    /// The second derivatives of the states; 0 for other columns.
    yp: Vec<f64>,
}

impl TangentPropagator {
    /// Sensitivities at the start: the derivatives of states are as asked, everything else is 0 until completed.
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

    /// Number of directions.
    pub fn count(&self) -> usize {
        self.values.len()
    }

    /// Whether unknowns that the equations leave open may keep their value ([`Lu::may_keep`]).
    pub fn may_keep(&mut self, allowed: bool) {
        self.lu.may_keep(allowed);
    }

    /// Sets the point at which the sensitivities are taken.
    fn stand(&mut self, y: &[f64], yp: &[f64]) {
        self.y.copy_from_slice(y);
        self.yp.copy_from_slice(yp);
    }

    /// Factorizes the matrix for [`TangentPropagator::complete`] at the present point; false when it is singular.
    ///
    /// It is the Jacobian with cj = `HOLD_STATES`, as in the algebraic solver: states stay, and their derivatives and
    /// all algebraic unknowns are solved for.
    fn prepare(&mut self, model: &mut IntegrationModel<'_>, t: f64) -> bool {
        // the equations may have changed at an event although the point is the same
        model.forget();
        model.differentiate(t, &self.y, &self.yp) == EvaluationStatus::Done
            && model.jacobian(t, HOLD_STATES, &self.y, &self.yp, &mut self.matrix) == EvaluationStatus::Done
            && self.lu.factor(&self.matrix).is_ok()
    }

    /// Computes from the sensitivities of the states those of all other unknowns and of the derivatives.
    ///
    /// The result satisfies dF/dy s + dF/dy' s' + own = 0. `own` is the explicit change of the equations, for example
    /// with time. False when a value is not finite.
    fn complete(&mut self, model: &IntegrationModel<'_>, values: &mut [f64], rates: &mut [f64], own: &[f64]) -> bool {
        // unknowns to be solved start at 0, so that the first residual is the right-hand side
        for (j, state) in self.states.iter().enumerate() {
            rates[j] = 0.0;
            values[j] = if *state { values[j] } else { 0.0 };
        }
        let mut left = vec![0.0; values.len()];
        // the second pass removes the rounding of the first one
        for _ in 0..2 {
            model.along(values, rates, &mut left);
            left.iter_mut().zip(own).for_each(|(l, o)| *l += o);
            if !self.lu.solve(&mut left) {
                return false;
            }
            for (j, state) in self.states.iter().enumerate() {
                if *state {
                    // the matrix was made with cj = HOLD_STATES, so a correction of a state is one of its derivative
                    rates[j] -= HOLD_STATES * left[j];
                } else {
                    values[j] -= left[j];
                }
            }
        }
        values.iter().chain(&*rates).all(|v| v.is_finite())
    }

    /// [`TangentPropagator::complete`] for all directions.
    fn complete_all(&mut self, model: &IntegrationModel<'_>) -> bool {
        let (mut values, mut rates) = (std::mem::take(&mut self.values), std::mem::take(&mut self.rates));
        let own = vec![0.0; self.y.len()];
        let done = values.iter_mut().zip(&mut rates).all(|(s, sp)| self.complete(model, s, sp, &own));
        (self.values, self.rates) = (values, rates);
        done
    }

    /// The time derivative of the solution itself: the direction along which time advances.
    ///
    /// The explicit time dependence of the equations is a central difference. `None` where it is not finite.
    fn trajectory(&mut self, model: &mut IntegrationModel<'_>, t: f64, step: f64) -> Option<SolutionPoint> {
        let n = self.y.len();
        let (mut up, mut own) = (vec![0.0; n], vec![0.0; n]);
        // short against the step, but well above the rounding of t
        let dt = (1e-4 * step).max(1e-11 * t.abs()).max(f64::MIN_POSITIVE.sqrt());
        let known = model.residual(t - dt, &self.y, &self.yp, &mut own) == EvaluationStatus::Done
            && model.residual(t + dt, &self.y, &self.yp, &mut up) == EvaluationStatus::Done;
        own.iter_mut().zip(&up).for_each(|(d, u)| *d = (u - *d) / (2.0 * dt));
        let (mut y, mut yp) = (self.yp.clone(), vec![0.0; n]);
        (known && self.complete(model, &mut y, &mut yp, &own)).then_some(SolutionPoint { y, yp })
    }

    /// The factor by which a direction is followed for a difference quotient.
    ///
    /// It moves the unknown with the largest relative change by [`REACH`] of its size.
    fn reach(&self, values: &[f64]) -> f64 {
        let part = |j: usize| values[j].abs() / (self.y[j].abs() + self.nominal[j]);
        let most = (0..values.len()).map(part).fold(0.0, f64::max);
        // a direction of zeros moves nothing: any factor will do
        if most > 0.0 { REACH / most } else { 1.0 }
    }

    /// The unknowns and derivatives at the distance `by` along a direction.
    fn moved(&self, by: f64, values: &[f64], rates: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let add = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a + by * b).collect();
        (add(&self.y, values), add(&self.yp, rates))
    }

    /// The directional derivative of the crossing function `raw`, while time changes by `dt` per unit of the direction.
    ///
    /// It is a central difference. `raw` is an index of the unshifted crossing functions.
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

/// The end of a run whose sensitivities cannot be continued.
fn lost(text: &str, t: f64) -> EarlyStop {
    let text = format!("{text} at {} s", bramah_results::number::rounded(t, 6));
    EarlyStop::new(End::NonFinite, Diagnostic::new(Code::NonFinite, text))
}

impl<'a> Driver<'a, '_> {
    /// Completes the sensitivities at the start from those of the states.
    pub(super) fn start_tangents(&mut self, model: &mut IntegrationModel<'a>) -> StopResult {
        let Some(mut carried) = self.carried.take() else { return Ok(()) };
        self.restart.gather(self.system, &mut model.values);
        carried.stand(self.restart.y(), self.restart.yp());
        let done = carried.prepare(model, self.t) && carried.complete_all(model);
        self.carried = Some(carried);
        if done { Ok(()) } else { Err(lost("the equations do not determine the sensitivities", self.t)) }
    }

    /// Sets the point of a row for the sensitivities.
    pub(super) fn tangents_stand(&mut self, y: &[f64], yp: &[f64]) {
        if let Some(carried) = &mut self.carried {
            carried.stand(y, yp);
        }
    }

    /// Reads the sensitivities at the present time from IDAS. Does nothing without sensitivities.
    pub(super) fn take_tangents(&mut self) {
        let t = self.t;
        let (Some(carried), Some(ida)) = (&mut self.carried, &mut self.ida) else { return };
        ida.tangents_at(t, 0, &mut carried.values);
        // derivatives are needed only for wanted variables that are no unknowns
        if carried.sources.iter().any(Option::is_none) {
            ida.tangents_at(t, 1, &mut carried.rates);
        }
    }

    /// Fills the cells after the wanted values of a row: for each direction the derivative of each wanted variable.
    ///
    /// `model.values` must hold the values of the row, and holds them again afterwards.
    pub(super) fn tangent_cells(&mut self, model: &mut IntegrationModel<'a>) {
        let Some(carried) = self.carried.take() else { return };
        let wanted = self.slots.len();
        // variables that are no unknowns are differentiated by central differences along the direction
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
            // unknowns have exact sensitivities, which replace the differences
            for (cell, source) in cells.iter_mut().zip(&carried.sources) {
                if let Some((j, sign)) = source {
                    *cell = sign * values[*j];
                }
            }
        }
        // the slots hold values beside the solution: those of the row are restored
        if computed {
            model.load(self.t, &carried.y, &carried.yp);
            self.program.run(&mut model.values);
        }
        self.carried = Some(carried);
    }

    /// Before an event: completes the sensitivities and computes for each direction the change dtau of its time.
    ///
    /// `y` are the unknowns just before the event, and the slots must be observed there. Events of known time have
    /// dtau = 0. `Err` when the crossing has no derivative with respect to time, or when the equations are singular.
    pub(super) fn tangents_before(
        &mut self,
        model: &mut IntegrationModel<'a>,
        cause: EventCause,
        y: &[f64],
    ) -> StopResult {
        let Some(mut carried) = self.carried.take() else { return Ok(()) };
        let (t, step) = (self.t, self.last_step);
        // derivatives from the equations, not from IDA's interpolation
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
            // a crossing that only touches zero has no differentiable time
            let speed = speed.filter(|s| s.is_finite() && *s != 0.0);
            done = speed.is_some();
            for k in 0..carried.count() {
                let by = carried.crossing(model, t, raw, 0.0, &carried.values[k], &carried.rates[k]);
                // dtau = -dg / (dg/dt)
                carried.shift[k] = if by == 0.0 { 0.0 } else { -by / speed.unwrap_or(f64::NAN) };
            }
        }
        self.carried = Some(carried);
        if done { Ok(()) } else { Err(lost("the sensitivities end", t)) }
    }

    /// Copies slots and modes before an event for [`Driver::repeat`]. `None` without sensitivities.
    pub(super) fn ready(&self, model: &IntegrationModel<'a>) -> PendingEvent {
        self.carried.as_ref().map(|_| (model.values.clone(), self.modes.clone()))
    }

    /// After an event whose new unknowns have been gathered: computes the sensitivities behind it.
    ///
    /// The formula is that of the module documentation. `Err` when the equations behind the event are singular.
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
            // the state at the event itself moves along dx- + x'- dtau
            let direction: Vec<f64> = carried.values[k].iter().zip(&carried.yp).map(|(s, yp)| s + shift * yp).collect();
            let mut behind = direction.clone();
            // with `reinit` the new states are a function of the old ones, differentiated by repeating the event
            if outcome.reinitialised {
                done &= self.repeat(&carried, &ready, &direction, shift, &mut behind);
            }
            for (j, behind) in behind.iter().enumerate().filter(|(j, _)| carried.states[*j]) {
                // back from the moved time of the event to the present time: - x'+ dtau
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

    /// Differentiates the states after an event along `direction` and `dt`, by repeating the event iteration on both
    /// sides.
    ///
    /// The derivatives of all columns go into `out`. False when an iteration fails.
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

    /// Whether the interpolation of the sensitivities is still valid after an event, so that IDAS need not restart.
    pub(super) fn tangents_go_on(&self) -> bool {
        let (Some(carried), Some(ida)) = (&self.carried, &self.ida) else { return true };
        let step = ida.step_lengths().1.abs();
        // the same measure as for the unknowns in `restart`
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

    /// Gives the sensitivities to IDAS, for the first time or after a restart; false when it refuses.
    pub(super) fn hand_over_tangents(&mut self, first: bool) -> bool {
        let (Some(carried), Some(ida)) = (&self.carried, &mut self.ida) else { return true };
        let (values, rates) = (&carried.values, &carried.rates);
        let controlled = self.settings.tangents.as_ref().is_some_and(|asked| asked.controlled);
        if first { ida.begin_tangents(values, rates, controlled) } else { ida.restart_tangents(values, rates) }.is_ok()
    }
}
