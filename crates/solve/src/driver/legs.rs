//! Integration between events: steps of IDA, rows on the grid, interrupts, and restarts where IDA finds no step.
//!
//! `integrate` and `reach` call `leg` until the segment ends. Each leg ends at an event, at a kink of an input, or
//! at the end. A step fails when the corrector does not converge or when the error test keeps failing; the functions
//! `begin_anew`, `renew`, `jump` and `test_states_only` then try to continue.

use super::{Driver, EventCause, StopResult};
use crate::Progress;
use crate::ida::{AdvanceReturn, DaeEquations, IdaFailure};
use crate::lower::ColumnRole;
use crate::model::IntegrationModel;
use crate::modes::same_time;
use crate::report;
use crate::selection;
use bramah_expr::ExprNode;

/// Time moves by less than this part of the run between two pauses: the step size counts as collapsed.
const CREEPING: f64 = 1e-11;
/// Number of such pauses in a row after which the driver acts. The run would not end within days.
const PATIENCE: u32 = 20;

/// The shortest step, as a part of the present time. A shorter one would not change the time in 64 bits.
///
/// It is not relative to the length of the run, because fast processes may begin at any time.
const SHORTEST_STEP: f64 = 1e-15;

/// Restarts without an event at most, in one segment.
const MOST_RENEWALS: u32 = 1000;

/// How far ahead another root of a loop is searched at most, in tolerances of the states.
const FARTHEST_JUMP: f64 = 100.0;
/// A jump of an unknown by more tolerances than this is reported.
const NOTICEABLE: f64 = 1e4;

impl<'a> Driver<'a, '_> {
    /// Integrates to the end of the segment. At the end of the run it handles the event of `terminal()`, if used.
    pub(super) fn integrate(&mut self) -> StopResult {
        self.reach()?;
        // another segment follows: `terminal()` becomes true only at the end of the run
        if self.choice.is_some() || self.pauses() {
            return Ok(());
        }
        if self.uses_terminal() { self.event(EventCause::Terminal) } else { Ok(()) }
    }

    /// Integrates until `self.until`, or until other states are needed.
    pub(super) fn reach(&mut self) -> StopResult {
        while self.t < self.until && !same_time(self.t, self.until) && self.choice.is_none() {
            self.leg()?;
        }
        Ok(())
    }

    /// Whether any expression of the model contains `terminal()`.
    pub(super) fn uses_terminal(&self) -> bool {
        let exprs = &self.system.dae.exprs;
        let ids = (0..u32::try_from(exprs.len()).unwrap_or(u32::MAX)).map(bramah_expr::ExprId);
        ids.into_iter().any(|e| exprs.node(e) == ExprNode::Terminal)
    }

    /// The next event of known time in seconds: a sample, a relation of time, or a jump of an input.
    pub(super) fn next_event(&mut self) -> f64 {
        let known = self.clocks.next().min(self.next_crossing);
        let t = self.t;
        known.min(self.ida().equations().playback.next_jump(t))
    }

    /// The time that the integrator must not pass: the next event, a kink of an input, or the end of the segment.
    ///
    /// The forecast may shorten it where a function of time has a peak that one step could pass over.
    pub(super) fn next_stop(&mut self) -> f64 {
        let t = self.t;
        let kink = self.ida().equations().playback.next_kink(t);
        let known = self.next_event().min(kink).min(self.until);
        let Driver { ida, foresight, .. } = self;
        let model = ida.as_mut().expect("made before the first step").equations();
        foresight.next(&model.roots, &model.values, t, known)
    }

    /// Integrates to the next event, kink of an input, or end of the segment, and writes the rows on the way.
    pub(super) fn leg(&mut self) -> StopResult {
        let (event, to) = (self.next_event(), self.next_stop());
        self.ida().set_stop(to);
        self.bound_steps();
        let span = self.settings.stop_time - self.settings.start_time;
        // IDA interpolates rows within its steps; only stops and roots end a step
        loop {
            let row = self.grid.next();
            // a row at the stop itself is written by the event or the kink there
            let target = if row < to && !same_time(row, to) { row } else { to };
            let before = self.unrecorded(target);
            match self.ida().advance(before.unwrap_or(target)) {
                // the end of a step before the next one is made: the delays must record it, but no row is due
                Ok((AdvanceReturn::Output, t)) if before.is_some() => {
                    self.t = t;
                    self.remember();
                }
                Ok((AdvanceReturn::Output, t)) => {
                    self.t = t;
                    self.remember();
                    self.output()?;
                    if self.states_fail() {
                        return Ok(());
                    }
                }
                Ok((AdvanceReturn::Pause, t)) => {
                    self.creep = if t - self.t < CREEPING * span { self.creep + 1 } else { 0 };
                    self.t = t;
                    self.remember();
                    // the shortest step is relative to the time, which has moved on
                    self.bound_steps();
                    self.look_outside()?;
                    // IDA would go on with tiny steps for ever: treated like an error test that fails
                    if self.creep >= PATIENCE {
                        self.begin_anew(IdaFailure::ErrorTest, to)?;
                    }
                    if self.states_fail() {
                        return Ok(());
                    }
                }
                // the stop time itself, so that comparisons with known times are exact
                Ok((AdvanceReturn::Stop, _)) => {
                    self.t = to;
                    self.remember();
                    self.roots.clear();
                    return if event <= to || same_time(event, to) {
                        self.event(EventCause::Time)
                    // both are evaluated (`|`, not `||`), because each notes the functions that have crossed
                    } else if self.changes_by_time() | self.crosses_at_the_end() {
                        self.event(EventCause::Root)
                    } else {
                        self.pass_kink()
                    };
                }
                Ok((AdvanceReturn::Root, t)) => {
                    self.t = t;
                    self.remember();
                    self.find_roots();
                    // adds functions that cross at the same time, when this is the end of the run
                    self.crosses_at_the_end();
                    return self.event(EventCause::Root);
                }
                Err((failure, t)) => {
                    self.t = t;
                    self.begin_anew(failure, to)?;
                }
            }
        }
    }

    /// Whether a relation of time has changed where the integrator stands, without having been located by IDA.
    ///
    /// Notes the functions in `self.roots`.
    fn changes_by_time(&mut self) -> bool {
        let count = self.ida().equations().roots.len();
        self.foresight.note(self.t, count, &mut self.roots)
    }

    /// Whether a function crosses zero at the stop time, within the error of the solution.
    ///
    /// The error of the solution decides on which side of the stop time IDA finds such a crossing, so it is handled as
    /// an event at the stop time. The test extrapolates the unknowns by a straight line a little beyond the end.
    /// Functions found are added to `self.roots`.
    fn crosses_at_the_end(&mut self) -> bool {
        let (t, stop, tolerance) = (self.t, self.settings.stop_time, self.settings.tolerance);
        if !same_time(t, stop) {
            return false;
        }
        // as far beyond the end as the tolerance is a part of the run
        let beyond = tolerance * (stop - self.settings.start_time);
        let (mut earlier, mut rates) = (Vec::new(), Vec::new());
        let step = self.ida().step_lengths().0;
        let known = self.ida().at(t - step, &mut earlier, &mut rates);
        let (model, y, yp) = self.ida().parts();
        let ahead: Vec<f64> = y.iter().zip(yp).map(|(y, rate)| y + beyond * rate).collect();
        let mut trajectory = |t: f64, y: &[f64]| {
            let mut g = vec![0.0; model.roots.len()];
            model.crossings(t, y, yp, &mut g);
            g
        };
        // the mode records how far the function came from: `near` below compares with it
        let before = if known { trajectory(t - step, &earlier) } else { Vec::new() };
        let (now, then) = (trajectory(t, y), trajectory(t + beyond, &ahead));
        let crossings: Vec<usize> = (0..now.len()).map(|i| model.roots.crossing(i)).collect();
        before.iter().zip(&crossings).for_each(|(g, &c)| self.modes.seen(c, *g));
        self.roots.resize(now.len(), 0);
        for (i, root) in self.roots.iter_mut().enumerate().filter(|(_, root)| **root == 0) {
            // only functions that are close to zero now, in their own scale, count as crossing at the end
            if now[i] * then[i] < 0.0 && self.modes.near(crossings[i], now[i]) {
                *root = if then[i] > 0.0 { 1 } else { -1 };
            }
        }
        self.roots.iter().any(|&d| d != 0)
    }

    /// After IDA has found no step: restarts it with algebraic unknowns solved anew, if that may help.
    ///
    /// Returns the failure of the run as `Err` when nothing could be tried.
    fn begin_anew(&mut self, failure: IdaFailure, to: f64) -> StopResult {
        let renewed = match failure {
            // first the same root with algebraic unknowns solved anew, then another root
            IdaFailure::Convergence => self.renew() || self.jump(),
            // a collapsed error test needs both: consistent algebraic unknowns, and a test of the states alone
            IdaFailure::ErrorTest => self.tests_too_much() && self.renew() && self.test_states_only(),
            _ => false,
        };
        if !renewed {
            return Err(self.failed(failure));
        }
        self.creep = 0;
        self.ida().set_stop(to);
        self.bound_steps();
        Ok(())
    }

    /// Solves the algebraic unknowns anew at the present time and restarts IDA; true when it does.
    ///
    /// Algebraic unknowns may drift from their equations within what the error test allows. Where a vanishing flow
    /// determines a pressure, as between closed valves, that drift is large. Not tried twice at the same time, nor with
    /// sensitivities.
    fn renew(&mut self) -> bool {
        if self.carried.is_some() || self.t <= self.renewed || self.renewals >= MOST_RENEWALS {
            return false;
        }
        self.renewed = self.t;
        self.renewals += 1;
        self.statistics.restarts += 1;
        self.go_on_from(self.t, 0.0)
    }

    /// Moves a loop to another root when its present root ends; true when IDA has restarted there.
    ///
    /// A root ends where it meets another one and both vanish (a fold: a snap-through, a comparator with positive
    /// feedback). The states stay. The other root is searched a little ahead, where the old one no longer exists: where
    /// the states will have moved by their tolerance, and farther after each attempt that was not enough.
    fn jump(&mut self) -> bool {
        let (last, reach) = self.jumped;
        // no progress since the last jump: searched four times as far ahead
        let reach = if self.t <= last { 4.0 * reach } else { 1.0 };
        if self.carried.is_some() || reach > FARTHEST_JUMP || self.renewals >= MOST_RENEWALS {
            return false;
        }
        let Some(ahead) = self.ahead(reach) else { return false };
        self.jumped = (ahead, reach);
        self.renewals += 1;
        self.statistics.restarts += 1;
        self.events.may_jump(true);
        let began = self.go_on_from(ahead, ahead - self.t);
        self.events.may_jump(false);
        began
    }

    /// Solves everything anew at `t` and restarts IDA there; true when it does.
    ///
    /// The states are moved along their derivatives over the time `by`, in seconds.
    fn go_on_from(&mut self, t: f64, by: f64) -> bool {
        let system = self.system;
        // unknowns before the jump and their tolerances, for the message
        let before = self.ida().y().to_vec();
        let mut weights = Vec::new();
        self.ida().weights(&mut weights);
        self.t = t;
        let solved = self.with_model(|driver, model, y, yp| {
            let state = |j: usize| if system.columns[j].is_state() { by * yp[j] } else { 0.0 };
            let moved: Vec<f64> = y.iter().enumerate().map(|(j, y)| y + state(j)).collect();
            model.observe(t, &moved, yp);
            // conserved quantities keep the values that the integrator had
            driver.restart.before(system, &mut model.values, &moved);
            let solved = driver.iterate(model, EventCause::Time).is_ok();
            driver.restart.gather(system, &mut model.values);
            solved
        });
        let began = solved && self.first_step(EventCause::Time);
        if began && self.events.searched() {
            self.report_jump(&before, &weights);
        }
        began
    }

    /// Reports, once a run, the unknown that jumped most in units of its tolerance.
    fn report_jump(&mut self, before: &[f64], weights: &[f64]) {
        let now = self.ida().y().to_vec();
        let size = |j: usize| ((now[j] - before[j]) * weights[j]).abs();
        let farthest = (0..now.len()).max_by(|&a, &b| size(a).total_cmp(&size(b)));
        if let Some(j) = farthest.filter(|&j| size(j) > NOTICEABLE)
            && self.reported.first_jump()
        {
            self.diagnostics.push(report::root_jumped(self.system, self.t, j, before[j], now[j]));
        }
    }

    /// The time at which the fastest state will have moved by `tolerances`; `None` when that is after the next stop.
    fn ahead(&mut self, tolerances: f64) -> Option<f64> {
        let stop = self.next_stop();
        let mut weights = Vec::new();
        self.ida().weights(&mut weights);
        let yp = self.ida().yp().to_vec();
        let states = (0..yp.len()).filter(|&j| self.system.columns[j].is_state());
        let speed = states.fold(0.0_f64, |most, j| most.max((weights[j] * yp[j]).abs()));
        let span = self.settings.stop_time - self.settings.start_time;
        // where no state moves, time itself moves by the tolerance times the length of the run
        let ahead = self.t + tolerances * (1.0 / speed).min(self.settings.tolerance * span);
        (ahead > self.t && ahead < stop).then_some(ahead)
    }

    /// Whether an error test that keeps failing may measure algebraic unknowns only.
    ///
    /// An algebraic unknown that follows from a derivative, as the flow into a stiff volume, contains the corrector's
    /// error divided by the step. That quotient grows as steps shrink, so short steps fail the test for ever. It is not
    /// the error of the solution, which lies in the states. Source: L. Petzold, Differential/algebraic equations are
    /// not ODE's, SIAM J. Sci. Stat. Comput. 3 (1982). False where an equation determines no unknown: then the failure
    /// is real.
    fn tests_too_much(&mut self) -> bool {
        let y = self.ida().y().to_vec();
        !self.tests_states_only && self.idle_equation(self.t, &y).is_none()
    }

    /// Leaves algebraic unknowns out of the error test until the next event; false when there are none.
    fn test_states_only(&mut self) -> bool {
        let algebraic: Vec<bool> = self.system.columns.iter().map(|c| c.role == ColumnRole::Algebraic).collect();
        self.tests_states_only = algebraic.contains(&true) && self.ida().leave_out(&algebraic).is_ok();
        self.tests_states_only
    }

    /// Sets IDA's shortest step for the present time.
    fn bound_steps(&mut self) {
        let shortest = SHORTEST_STEP * self.t.abs();
        self.ida().set_shortest_step(shortest);
    }

    /// Whether other states must be chosen (dynamic state selection). Stores the choice in `self.choice`.
    pub(super) fn states_fail(&mut self) -> bool {
        if self.system.dae.selections.is_empty() || self.control.as_ref().is_none_or(|c| c.reselect.is_none()) {
            return false;
        }
        let t = self.t;
        self.choice = self.with_model(|driver, model, y, yp| {
            model.observe(t, y, yp);
            selection::better_choice(driver.system, &driver.scales, &model.values)
        });
        self.choice.is_some()
    }

    /// Passes a kink of an input, or the end of a segment, without an event.
    pub(super) fn pass_kink(&mut self) -> StopResult {
        let t = self.t;
        let row = self.grid.next();
        // a row due exactly here was left to this function by `leg`
        if row <= t || same_time(row, t) {
            self.output()?;
        }
        let (model, ..) = self.ida().parts();
        let IntegrationModel { playback, values, .. } = model;
        // switches the inputs to their next piece
        playback.seek(t, values);
        self.remember_bend();
        Ok(())
    }

    /// Writes a row on the grid at the present time, and checks the assertions there.
    pub(super) fn output(&mut self) -> StopResult {
        let t = self.t;
        self.take_tangents();
        self.with_model(|driver, model, y, yp| {
            // interpolated unknowns do not satisfy the algebraic equations exactly
            let (y, yp) = driver.algebraic.solve(model, t, y, yp);
            model.load(t, y, yp);
            driver.program.run(&mut model.values);
            // the sensitivities belong to the solved unknowns, not to the interpolated ones
            if driver.carried.is_some() {
                let (y, yp) = (y.to_vec(), yp.to_vec());
                driver.tangents_stand(&y, &yp);
                driver.tangent_cells(model);
            }
            driver.write_row(model)?;
            driver.check_asserts(model)
        })?;
        self.grid.pass(t);
        self.look_outside()
    }

    /// Checks the interrupt flag and reports progress; `Err` when the caller ends the run.
    pub(super) fn look_outside(&mut self) -> StopResult {
        let progress = Progress { time: self.t, events: self.statistics.events };
        let Some(control) = &mut self.control else { return Ok(()) };
        if control.interrupt.is_some_and(|flag| flag.load(std::sync::atomic::Ordering::Relaxed)) {
            return Err(self.interrupted());
        }
        let go_on = control.progress.as_mut().is_none_or(|report| report(&progress));
        if go_on { Ok(()) } else { Err(self.interrupted()) }
    }
}
