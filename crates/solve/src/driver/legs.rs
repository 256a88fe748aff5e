//! From event to event: steps, rows on the grid, and what the outside has to say between them.

use super::{Driver, EventCause, StopResult};
use crate::Progress;
use crate::ida::{AdvanceReturn, DaeEquations, IdaFailure};
use crate::lower::ColumnRole;
use crate::model::IntegrationModel;
use crate::modes::same_time;
use crate::report;
use crate::selection;
use bramah_expr::ExprNode;

/// When time moves by less than this part of the run from pause to pause, so many times in a row, the step size counts
/// as collapsed: the run would not end within days.
const CREEPING: f64 = 1e-11;
const PATIENCE: u32 = 20;

/// The shortest step, as a part of the time: a shorter one would not move it. Not of the length of the run, which says
/// nothing about how fast things begin.
const SHORTEST_STEP: f64 = 1e-15;

/// New beginnings of a run without an event.
const MOST_RENEWALS: u32 = 1000;

/// How far ahead of the place where a root ended another one is sought, in tolerances of the states.
const FARTHEST_JUMP: f64 = 100.0;
/// An unknown that moves by more tolerances has jumped.
const NOTICEABLE: f64 = 1e4;

impl<'a> Driver<'a, '_> {
    pub(super) fn integrate(&mut self) -> StopResult {
        self.reach()?;
        if self.choice.is_some() || self.pauses() {
            return Ok(());
        }
        if self.uses_terminal() { self.event(EventCause::Terminal) } else { Ok(()) }
    }

    /// Integrates until `self.until`, or to where other states are needed.
    pub(super) fn reach(&mut self) -> StopResult {
        while self.t < self.until && !same_time(self.t, self.until) && self.choice.is_none() {
            self.leg()?;
        }
        Ok(())
    }

    pub(super) fn uses_terminal(&self) -> bool {
        let exprs = &self.system.dae.exprs;
        let ids = (0..u32::try_from(exprs.len()).unwrap_or(u32::MAX)).map(bramah_expr::ExprId);
        ids.into_iter().any(|e| exprs.node(e) == ExprNode::Terminal)
    }

    /// The next event of known time.
    pub(super) fn next_event(&mut self) -> f64 {
        let known = self.clocks.next().min(self.next_crossing);
        let t = self.t;
        known.min(self.ida().equations().playback.next_jump(t))
    }

    /// Where the integrator must stop next: an event, a peak of a function of time, a bend of an input, the end.
    pub(super) fn next_stop(&mut self) -> f64 {
        let t = self.t;
        let kink = self.ida().equations().playback.next_kink(t);
        let known = self.next_event().min(kink).min(self.until);
        let Driver { ida, foresight, .. } = self;
        let model = ida.as_mut().expect("made before the first step").equations();
        foresight.next(&model.roots, &model.values, t, known)
    }

    /// Integrates to the next event, or the next bend of an input.
    pub(super) fn leg(&mut self) -> StopResult {
        let (event, to) = (self.next_event(), self.next_stop());
        self.ida().set_stop(to);
        self.bound_steps();
        let span = self.settings.stop_time - self.settings.start_time;
        loop {
            let row = self.grid.next();
            let target = if row < to && !same_time(row, to) { row } else { to };
            let before = self.unrecorded(target);
            match self.ida().advance(before.unwrap_or(target)) {
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
                    self.bound_steps();
                    self.look_outside()?;
                    if self.creep >= PATIENCE {
                        self.begin_anew(IdaFailure::ErrorTest, to)?;
                    }
                    if self.states_fail() {
                        return Ok(());
                    }
                }
                Ok((AdvanceReturn::Stop, _)) => {
                    self.t = to;
                    self.remember();
                    self.roots.clear();
                    return if event <= to || same_time(event, to) {
                        self.event(EventCause::Time)
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

    /// Whether a relation of time has changed, unseen, where the integrator stands; notes which.
    fn changes_by_time(&mut self) -> bool {
        let count = self.ida().equations().roots.len();
        self.foresight.note(self.t, count, &mut self.roots)
    }

    /// Whether something crosses where the run ends, but for the error of the solution, which decides by chance on which
    /// side of the end the integrator sees it; notes what does, beside what is noted already. By a straight line a little
    /// beyond the end.
    fn crosses_at_the_end(&mut self) -> bool {
        let (t, stop, tolerance) = (self.t, self.settings.stop_time, self.settings.tolerance);
        if !same_time(t, stop) {
            return false;
        }
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
        let before = if known { trajectory(t - step, &earlier) } else { Vec::new() };
        let (now, then) = (trajectory(t, y), trajectory(t + beyond, &ahead));
        let crossings: Vec<usize> = (0..now.len()).map(|i| model.roots.crossing(i)).collect();
        before.iter().zip(&crossings).for_each(|(g, &c)| self.modes.seen(c, *g));
        self.roots.resize(now.len(), 0);
        for (i, root) in self.roots.iter_mut().enumerate().filter(|(_, root)| **root == 0) {
            if now[i] * then[i] < 0.0 && self.modes.near(crossings[i], now[i]) {
                *root = if then[i] > 0.0 { 1 } else { -1 };
            }
        }
        self.roots.iter().any(|&d| d != 0)
    }

    /// Where there is no step, the integrator begins again, if that may help.
    fn begin_anew(&mut self, failure: IdaFailure, to: f64) -> StopResult {
        let renewed = match failure {
            IdaFailure::Convergence => self.renew() || self.jump(),
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

    /// Algebraic unknowns may have drifted from their equations within what the error test allows: where a flow of no size
    /// decides on a pressure, as between closed valves, that is far. They are solved anew, and the integrator begins again;
    /// true when it does.
    fn renew(&mut self) -> bool {
        if self.carried.is_some() || self.t <= self.renewed || self.renewals >= MOST_RENEWALS {
            return false;
        }
        self.renewed = self.t;
        self.renewals += 1;
        self.statistics.restarts += 1;
        self.go_on_from(self.t, 0.0)
    }

    /// Where the root of a loop ends, since it has met another one (a snap-through, a comparator with positive feedback), the
    /// loop jumps to a root that goes on, while the states stay. It is sought ahead, where the old root has gone: where the
    /// states will have moved by their tolerance, and farther where that was not enough.
    fn jump(&mut self) -> bool {
        let (last, reach) = self.jumped;
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

    /// Solves everything anew at `t`, to which the states are moved by their rates over `by`, and begins the integrator again
    /// there; true when it does.
    fn go_on_from(&mut self, t: f64, by: f64) -> bool {
        let system = self.system;
        let before = self.ida().y().to_vec();
        let mut weights = Vec::new();
        self.ida().weights(&mut weights);
        self.t = t;
        let solved = self.with_model(|driver, model, y, yp| {
            let state = |j: usize| if system.columns[j].is_state() { by * yp[j] } else { 0.0 };
            let moved: Vec<f64> = y.iter().enumerate().map(|(j, y)| y + state(j)).collect();
            model.observe(t, &moved, yp);
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

    /// Says once which unknown moved most, in its tolerances.
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

    /// When the states, or the time itself, will have moved by so many tolerances, if that is before the next stop.
    fn ahead(&mut self, tolerances: f64) -> Option<f64> {
        let stop = self.next_stop();
        let mut weights = Vec::new();
        self.ida().weights(&mut weights);
        let yp = self.ida().yp().to_vec();
        let states = (0..yp.len()).filter(|&j| self.system.columns[j].is_state());
        let speed = states.fold(0.0_f64, |most, j| most.max((weights[j] * yp[j]).abs()));
        let span = self.settings.stop_time - self.settings.start_time;
        let ahead = self.t + tolerances * (1.0 / speed).min(self.settings.tolerance * span);
        (ahead > self.t && ahead < stop).then_some(ahead)
    }

    /// An algebraic unknown that follows from a derivative, as the flow into a stiff volume, takes over the corrector's error
    /// divided by the step, which grows as steps shrink: once they are short, the error test finds no step any more. What it
    /// measures there is not the error of the solution, which lies in the states (L. Petzold, Differential/algebraic equations
    /// are not ODE's, SIAM J. Sci. Stat. Comput. 3, 1982). Not so where an equation leaves an unknown open.
    fn tests_too_much(&mut self) -> bool {
        let y = self.ida().y().to_vec();
        !self.tests_states_only && self.idle_equation(self.t, &y).is_none()
    }

    /// Leaves algebraic unknowns out of the error test up to the next event; false when there are none.
    fn test_states_only(&mut self) -> bool {
        let algebraic: Vec<bool> = self.system.columns.iter().map(|c| c.role == ColumnRole::Algebraic).collect();
        self.tests_states_only = algebraic.contains(&true) && self.ida().leave_out(&algebraic).is_ok();
        self.tests_states_only
    }

    fn bound_steps(&mut self) {
        let shortest = SHORTEST_STEP * self.t.abs();
        self.ida().set_shortest_step(shortest);
    }

    /// Whether other states should be chosen; notes which.
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

    /// At a bend of an input, or at the end.
    pub(super) fn pass_kink(&mut self) -> StopResult {
        let t = self.t;
        let row = self.grid.next();
        if row <= t || same_time(row, t) {
            self.output()?;
        }
        let (model, ..) = self.ida().parts();
        let IntegrationModel { playback, values, .. } = model;
        playback.seek(t, values);
        self.remember_bend();
        Ok(())
    }

    /// A row on the grid.
    pub(super) fn output(&mut self) -> StopResult {
        let t = self.t;
        self.take_tangents();
        self.with_model(|driver, model, y, yp| {
            let (y, yp) = driver.algebraic.solve(model, t, y, yp);
            model.load(t, y, yp);
            driver.program.run(&mut model.values);
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

    /// Interruption and progress.
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
