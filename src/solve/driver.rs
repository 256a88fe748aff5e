//! One run from its start to its end: steps, rows, events.

use super::events::{EventFailure, Events, Outcome};
use super::ida::{Failure, Ida, Reached, Tolerances};
use super::linear::Lu;
use super::model::Model;
use super::modes::{Modes, RootFunctions, same_time};
use super::monitor::{Chatter, Told};
use super::newton::Scales;
use super::output::Grid;
use super::restart::Restart;
use super::schedule::{Clocks, next_time_crossing};
use super::settings::{End, Settings, Statistics};
use super::state::State;
use super::{Control, Input, Progress, Run, Sink, initialize, report, selection};
use crate::diag::{Code, Diagnostic};
use crate::expr::Node;
use crate::lower::{Layout, Pattern, Program, System};
use crate::structure::{ActionKind, StateChoice};
use std::ops::ControlFlow;
use std::time::Instant;

/// The clock, for the statistics' seconds alone: nothing else depends on it.
#[allow(clippy::disallowed_methods, reason = "solve_s and initialize_s are measured where they pass")]
fn now() -> Instant {
    Instant::now()
}

/// Steps between two looks at the outside when no row is due.
const PAUSE: u32 = 200;
/// When time moves by less than this part of the run from pause to pause, so many times in a row, the step size counts
/// as collapsed: the run would not end within days.
const CREEPING: f64 = 1e-11;
const PATIENCE: u32 = 20;
/// The same where states may have to be changed in time.
const PAUSE_WITH_SELECTIONS: u32 = 10;

/// Why a run ends before its stop time.
pub struct Stop {
    /// How.
    pub end: End,
    /// What to say.
    pub diagnostics: Vec<Diagnostic>,
}

impl Stop {
    fn new(end: End, diagnostic: Diagnostic) -> Self {
        Stop { end, diagnostics: vec![diagnostic] }
    }
}

type Flow = Result<(), Stop>;

/// Where a run starts when not at its initial values.
pub enum From<'a> {
    /// At a saved state.
    State(&'a State),
    /// Where the same run stopped for other states; its rows go on as if nothing had happened.
    Switch(&'a State, Grid),
}

/// A request for other states.
pub struct Switch {
    /// What to prefer.
    pub choice: StateChoice,
    /// The rows that are out.
    pub grid: Grid,
}

/// A run, or the part of it up to a change of states.
pub struct Leg {
    /// What it came to.
    pub run: Run,
    /// Set when the run is to go on with other states.
    pub switch: Option<Switch>,
}

/// What caused an event.
#[derive(Clone, Copy, PartialEq)]
enum Cause {
    /// The start of the run.
    Start,
    /// A known time.
    Time,
    /// A sign change found by IDA.
    Root,
    /// The end of the run.
    Terminal,
}

/// A run under way.
pub struct Driver<'a, 'c> {
    system: &'a System,
    settings: &'a Settings,
    control: &'a mut Control<'c>,
    sink: &'a mut dyn Sink,
    /// Present from the start on; before that the model stands alone.
    ida: Option<Ida<Model<'a>>>,
    scales: Scales,
    modes: Modes,
    events: Events,
    clocks: Clocks,
    grid: Grid,
    /// The first row is out already.
    silent: bool,
    /// Pauses in a row between which time hardly moved.
    creep: u32,
    /// Other states to go on with.
    choice: Option<StateChoice>,
    program: Program,
    slots: Vec<usize>,
    row: Vec<f64>,
    restart: Restart,
    chatter: Chatter,
    told: Told,
    t: f64,
    /// The next time at which a relation of time changes.
    next_crossing: f64,
    roots: Vec<i32>,
    statistics: Statistics,
    diagnostics: Vec<Diagnostic>,
}

/// Runs a system from its initial values, or from a saved state.
pub fn run<'a>(
    system: &'a System,
    settings: &'a Settings,
    inputs: &[Input],
    from: Option<From<'_>>,
    sink: &'a mut dyn Sink,
    control: &'a mut Control<'_>,
) -> Leg {
    let clock = now();
    let mut values = initialize::prepare(system, settings);
    let (from, grid) = match from {
        None => (None, None),
        Some(From::State(state)) => (Some(state), None),
        Some(From::Switch(state, grid)) => (Some(state), Some(grid)),
    };
    let start = from.map_or(settings.start_time, |s| s.time);
    values[Layout::TIME] = start;
    let mut playback = super::inputs::Playback::new(inputs, &system.layout);
    playback.seek(start, &mut values);
    let scales = Scales::new(system, &values);
    let mut modes = Modes::new(system, settings.tolerance);
    let solved = match from {
        Some(state) => {
            state.restore(system, &mut values);
            playback.seek(start, &mut values);
            modes.after = true;
            Ok(())
        }
        None => initialize::solve(system, &scales, &mut modes, &mut values)
            .map_err(|f| report::block_failure(system, Code::InitialFailed, &f, &values, "at the start"))
            .and_then(|()| initialize::check_starts(system, &scales, &values)),
    };
    let driver = Driver {
        events: Events::new(system, &scales, &modes),
        restart: Restart::new(system, &scales, settings.tolerance),
        program: system.observe_only(&settings.wanted),
        slots: settings.wanted.iter().map(|&v| system.layout.var(v)).collect(),
        row: vec![0.0; settings.wanted.len()],
        silent: grid.is_some(),
        grid: grid.unwrap_or_else(|| Grid::new(start, settings.stop_time, settings.interval)),
        choice: None,
        creep: 0,
        chatter: Chatter::new(settings.stop_time - settings.start_time, settings.events_at_once),
        told: Told::new(system),
        t: start,
        next_crossing: f64::INFINITY,
        roots: Vec::new(),
        statistics: Statistics::default(),
        diagnostics: Vec::new(),
        clocks: Clocks::default(),
        ida: None,
        system,
        settings,
        control,
        sink,
        scales,
        modes,
    };
    let model = Model { system, values, roots: RootFunctions::new(system), playback, trap: None };
    driver.complete(model, solved, from.is_some(), clock)
}

impl<'a> Driver<'a, '_> {
    fn complete(mut self, mut model: Model<'a>, solved: Result<(), Diagnostic>, resumed: bool, clock: Instant) -> Leg {
        let end = match solved {
            Err(diagnostic) => {
                let end = if diagnostic.code == Code::NonFinite { End::NonFinite } else { End::StepTooSmall };
                Err(Stop::new(end, diagnostic))
            }
            Ok(()) => self.begin(&mut model, resumed),
        };
        self.statistics.initialize_s = clock.elapsed().as_secs_f64();
        let clock = now();
        let before = self.sink.writing();
        let (end, values) = match end.and_then(|()| self.integrator(model.clone())) {
            Err(stop) => (Err(stop), model.values),
            Ok(()) => {
                let end = self.integrate();
                let values = self.last_values();
                (end, values)
            }
        };
        self.statistics.solve_s = clock.elapsed().saturating_sub(self.sink.writing() - before).as_secs_f64();
        self.finish(end, &values)
    }

    fn finish(mut self, end: Flow, values: &[f64]) -> Leg {
        let end = match end {
            Ok(()) => End::Reached,
            Err(stop) => {
                self.diagnostics.extend(stop.diagnostics);
                stop.end
            }
        };
        self.statistics.unknowns = self.system.columns.len();
        self.statistics.states = self.system.columns.iter().filter(|c| c.state).count();
        if let Some(ida) = &self.ida {
            let work = ida.work();
            self.statistics.steps = work.steps;
            self.statistics.residual_evaluations = work.residuals;
            self.statistics.jacobian_evaluations = work.jacobians;
            self.statistics.factorizations = work.factorizations;
            self.statistics.error_test_failures = work.error_test_failures;
            self.statistics.crossing_evaluations = work.crossings;
        }
        let run = Run {
            end,
            time: self.t,
            diagnostics: self.diagnostics,
            statistics: self.statistics,
            state: State::save(self.system, self.t, values),
        };
        let grid = self.grid;
        Leg { run, switch: self.choice.map(|choice| Switch { choice, grid }) }
    }

    /// The event iteration at the start, and the first row.
    fn begin(&mut self, model: &mut Model<'a>, resumed: bool) -> Flow {
        let system = self.system;
        let mut outcome = Outcome::default();
        if !resumed {
            // what fires at `initial()`, with the values that initialization has found
            model.values[Layout::INITIAL] = 1.0;
            self.events.act(system, &mut model.values, &mut outcome);
            model.values[Layout::INITIAL] = 0.0;
        }
        self.events.settle_pre(&mut model.values);
        self.clocks = Clocks::new(system, &model.values, self.t).map_err(|i| {
            let sample = &system.dae.samples[i];
            let text = "the interval of `sample` is not positive";
            Stop::new(End::StepTooSmall, report::at_origin(&system.dae, Code::EventFailed, text, sample.origin, "here"))
        })?;
        if resumed {
            self.clocks.skip(self.t);
        }
        let events = &self.events;
        self.clocks.ring(self.t, |i| events.raise(i, &mut model.values));
        let at_start = self.iterate(model, Cause::Start)?;
        outcome.terminate = outcome.terminate.or(at_start.terminate);
        outcome.failed.extend(at_start.failed);
        if !self.silent {
            self.write_row(model)?;
            self.grid.pass(self.t);
        }
        self.judge(model, &outcome)
    }

    /// Runs the event iteration and puts root functions on the right side.
    fn iterate(&mut self, model: &mut Model<'a>, cause: Cause) -> Result<Outcome, Stop> {
        let (system, t) = (self.system, self.t);
        let outcome = self.events.iterate(system, &self.scales, &self.modes, &mut model.values).map_err(|failure| {
            let when = match cause {
                Cause::Start => "at the start".to_string(),
                _ => format!("at the event at time {} s", report::number(t)),
            };
            let diagnostic = match failure {
                EventFailure::Blocks(f) => report::block_failure(system, Code::EventFailed, &f, &model.values, &when),
                EventFailure::Endless(variables) => report::changing(system, Code::EventFailed, &variables, &when),
            };
            let end = match diagnostic.code {
                Code::NonFinite => End::NonFinite,
                _ => End::StepTooSmall,
            };
            Stop::new(end, diagnostic)
        })?;
        self.modes.release();
        if !model.roots.is_empty() {
            system.crossings_from(&mut model.values, model.roots.raw());
            model.roots.settle(system, &mut self.modes, &model.values);
        }
        self.next_crossing = next_time_crossing(system, &model.values, t);
        Ok(outcome)
    }

    /// Assertions and `terminate` of an event whose rows are out.
    fn judge(&mut self, model: &mut Model<'a>, outcome: &Outcome) -> Flow {
        for (action, text) in &outcome.failed {
            if let ActionKind::Assert(assert) = &self.system.dae.actions[*action].kind {
                let first = self.told.first_action(*action);
                self.assertion(assert.warning, first, assert.origin, text)?;
            }
        }
        self.check_asserts(model)?;
        match &outcome.terminate {
            Some(message) => Err(Stop { end: End::Terminated(message.clone()), diagnostics: Vec::new() }),
            None => Ok(()),
        }
    }

    fn check_asserts(&mut self, model: &mut Model<'a>) -> Flow {
        let system = self.system;
        if system.dae.asserts.is_empty() {
            return Ok(());
        }
        system.asserts.program.run(&mut model.values);
        for (i, assert) in system.dae.asserts.iter().enumerate() {
            if model.values[system.asserts.holds[i]] == 0.0 {
                let first = self.told.first(i);
                let text = report::message_text(system, &assert.message, &model.values);
                self.assertion(assert.warning, first, assert.origin, &text)?;
            }
        }
        Ok(())
    }

    fn assertion(&mut self, warning: bool, first: bool, origin: crate::flat::Origin, text: &str) -> Flow {
        let code = if warning { Code::AssertionWarning } else { Code::AssertionFailed };
        let text = format!("{text} (at time {} s)", report::number(self.t));
        let diagnostic = report::at_origin(&self.system.dae, code, text, origin, "does not hold");
        if !warning {
            return Err(Stop::new(End::Assertion, diagnostic));
        }
        if first {
            self.diagnostics.push(diagnostic);
        }
        Ok(())
    }

    /// Writes the wanted values that stand in their slots.
    fn write_row(&mut self, model: &mut Model<'a>) -> Flow {
        for (cell, &slot) in self.row.iter_mut().zip(&self.slots) {
            *cell = model.values[slot];
        }
        if self.row.iter().any(|v| !v.is_finite()) {
            return Err(self.non_finite_row(model));
        }
        match self.sink.row(self.t, &self.row) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(self.interrupted()),
        }
    }

    fn non_finite_row(&self, model: &Model<'a>) -> Stop {
        let trap = report::find_trap(self.system, &model.values);
        let mut diagnostic = report::non_finite(self.system, self.t, trap);
        if let Some(i) = self.row.iter().position(|v| !v.is_finite()) {
            let variable = &self.system.dae.variables[self.settings.wanted[i].index()];
            diagnostic = diagnostic.note(format!("`{}` is {} then", variable.name, self.row[i]));
        }
        Stop::new(End::NonFinite, diagnostic)
    }

    fn interrupted(&self) -> Stop {
        let text = format!("interrupted at time {} s", report::number(self.t));
        Stop::new(End::Interrupted, Diagnostic::new(Code::Interrupted, text))
    }

    /// Makes the integrator from the values of the start.
    fn integrator(&mut self, model: Model<'a>) -> Flow {
        let system = self.system;
        let still = system.columns.is_empty();
        // without unknowns IDA still finds the roots of functions of time: it integrates a constant
        let pattern =
            if still { Pattern { n: 1, colptr: vec![0, 1], rowidx: vec![0] } } else { system.pattern.clone() };
        let nominal = self.restart.nominal();
        let tolerances = Tolerances {
            relative: self.settings.tolerance,
            absolute: nominal.iter().map(|n| n * self.settings.tolerance).collect(),
        };
        let lu = Lu::new(&pattern, nominal);
        self.restart.gather(system, &model.values);
        let roots = model.roots.len();
        let start = (self.t, self.restart.y(), self.restart.yp());
        let ida = Ida::new(model, &pattern, lu, roots, &tolerances, start);
        let mut ida = ida.map_err(|f| self.refused(&f))?;
        let span = self.settings.stop_time - self.t;
        let longest = if still { span / 500.0 } else { self.settings.longest_step };
        ida.set_longest_step(longest);
        ida.set_shortest_step(1e-15 * span.abs().max(self.t.abs()));
        ida.pause_after(if system.dae.selections.is_empty() { PAUSE } else { PAUSE_WITH_SELECTIONS });
        self.ida = Some(ida);
        self.first_step(Cause::Start);
        Ok(())
    }

    fn refused(&self, failure: &Failure) -> Stop {
        let text = format!("the integrator refused to start at time {} s: {failure:?}", report::number(self.t));
        Stop::new(End::StepTooSmall, Diagnostic::new(Code::StepTooSmall, text))
    }

    fn ida(&mut self) -> &mut Ida<Model<'a>> {
        self.ida.as_mut().expect("made before the first step")
    }

    fn last_values(&mut self) -> Vec<f64> {
        let t = self.t;
        let (model, y, yp) = self.ida().parts();
        model.observe(t, y, yp);
        model.values.clone()
    }

    fn integrate(&mut self) -> Flow {
        let stop = self.settings.stop_time;
        while self.t < stop && !same_time(self.t, stop) {
            self.leg()?;
            if self.choice.is_some() {
                return Ok(());
            }
        }
        if self.uses_terminal() { self.event(Cause::Terminal) } else { Ok(()) }
    }

    fn uses_terminal(&self) -> bool {
        let exprs = &self.system.dae.exprs;
        let ids = (0..u32::try_from(exprs.len()).unwrap_or(u32::MAX)).map(crate::expr::ExprId);
        ids.into_iter().any(|e| exprs.node(e) == Node::Terminal)
    }

    /// The next event of known time.
    fn next_event(&mut self) -> f64 {
        let known = self.clocks.next().min(self.next_crossing);
        let t = self.t;
        known.min(self.ida().equations().playback.next_jump(t))
    }

    /// Where the integrator must stop next: an event, a bend of an input, the end.
    fn next_stop(&mut self) -> f64 {
        let t = self.t;
        let kink = self.ida().equations().playback.next_kink(t);
        self.next_event().min(kink).min(self.settings.stop_time)
    }

    /// Integrates to the next event, or the next bend of an input.
    fn leg(&mut self) -> Flow {
        let (event, to) = (self.next_event(), self.next_stop());
        self.ida().set_stop(to);
        let span = self.settings.stop_time - self.settings.start_time;
        loop {
            let row = self.grid.next();
            let target = if row < to && !same_time(row, to) { row } else { to };
            match self.ida().advance(target) {
                Ok((Reached::Output, t)) => {
                    self.t = t;
                    self.output()?;
                    if self.states_fail() {
                        return Ok(());
                    }
                }
                Ok((Reached::Pause, t)) => {
                    self.creep = if t - self.t < CREEPING * span { self.creep + 1 } else { 0 };
                    self.t = t;
                    self.look_outside()?;
                    if self.creep >= PATIENCE {
                        return Err(self.failed(Failure::ErrorTest));
                    }
                    if self.states_fail() {
                        return Ok(());
                    }
                }
                Ok((Reached::Stop, _)) => {
                    self.t = to;
                    return if event <= to || same_time(event, to) {
                        self.event(Cause::Time)
                    } else {
                        self.pass_kink()
                    };
                }
                Ok((Reached::Root, t)) => {
                    self.t = t;
                    return self.event(Cause::Root);
                }
                Err((failure, t)) => {
                    self.t = t;
                    return Err(self.failed(failure));
                }
            }
        }
    }

    /// Whether other states should be chosen; notes which.
    fn states_fail(&mut self) -> bool {
        if self.system.dae.selections.is_empty() || self.control.reselect.is_none() {
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
    fn pass_kink(&mut self) -> Flow {
        let t = self.t;
        let row = self.grid.next();
        if row <= t || same_time(row, t) {
            self.output()?;
        }
        let (model, ..) = self.ida().parts();
        let Model { playback, values, .. } = model;
        playback.seek(t, values);
        Ok(())
    }

    /// A row on the grid.
    fn output(&mut self) -> Flow {
        let t = self.t;
        self.with_model(|driver, model, y, yp| {
            model.load(t, y, yp);
            driver.program.run(&mut model.values);
            driver.write_row(model)?;
            driver.check_asserts(model)
        })?;
        self.grid.pass(t);
        self.look_outside()
    }

    /// Runs `act` with the model and the integrator's values at hand.
    fn with_model<T>(&mut self, act: impl FnOnce(&mut Self, &mut Model<'a>, &[f64], &[f64]) -> T) -> T {
        let mut ida = self.ida.take().expect("made before the first step");
        let (model, y, yp) = ida.parts();
        let result = act(self, model, y, yp);
        self.ida = Some(ida);
        result
    }

    /// Interruption and progress.
    fn look_outside(&mut self) -> Flow {
        if self.control.interrupt.is_some_and(|flag| flag.load(std::sync::atomic::Ordering::Relaxed)) {
            return Err(self.interrupted());
        }
        let progress = Progress { time: self.t, events: self.statistics.events };
        let go_on = self.control.progress.as_mut().is_none_or(|report| report(&progress));
        if go_on { Ok(()) } else { Err(self.interrupted()) }
    }

    /// An event where the integrator stands.
    fn event(&mut self, cause: Cause) -> Flow {
        self.statistics.events += 1;
        let crossing = self.find_roots(cause);
        let t = self.t;
        let outcome = self.with_model(|driver, model, y, yp| {
            model.observe(t, y, yp);
            driver.restart.before(driver.system, &model.values, y);
            if driver.settings.event_rows {
                driver.write_row(model)?;
            }
            driver.prepare_event(model, cause);
            let outcome = driver.iterate(model, cause)?;
            if driver.settings.event_rows || same_time(driver.grid.next(), t) {
                driver.write_row(model)?;
            }
            driver.grid.pass(t);
            driver.restart.gather(driver.system, &model.values);
            Ok(outcome)
        })?;
        self.with_model(|driver, model, _, _| driver.judge(model, &outcome))?;
        if cause != Cause::Terminal {
            self.go_on(cause, &outcome)?;
            if self.chatter.note(t, crossing) {
                return Err(Stop::new(End::Chattering, self.chatter.report(self.system, t)));
            }
        }
        self.look_outside()
    }

    /// Notes which root functions have crossed; the first crossing among them.
    fn find_roots(&mut self, cause: Cause) -> Option<u32> {
        self.roots.clear();
        if cause != Cause::Root {
            return None;
        }
        let mut roots = std::mem::take(&mut self.roots);
        roots.extend_from_slice(self.ida().found());
        self.roots = roots;
        let first = self.roots.iter().position(|&d| d != 0)?;
        u32::try_from(self.ida().equations().roots.crossing(first)).ok()
    }

    /// What the event's cause changes at once.
    fn prepare_event(&mut self, model: &mut Model<'a>, cause: Cause) {
        let t = self.t;
        let Model { values, playback, roots, .. } = model;
        match cause {
            Cause::Root => {
                for (function, &direction) in self.roots.iter().enumerate().filter(|(_, d)| **d != 0) {
                    self.modes.force(self.system, roots.crossing(function), direction, values);
                }
            }
            Cause::Terminal => values[Layout::TERMINAL] = 1.0,
            Cause::Time => {
                playback.seek(t, values);
                let events = &self.events;
                self.clocks.ring(t, |i| events.raise(i, values));
            }
            Cause::Start => {}
        }
    }

    /// Continues after an event: with the integrator's past where it is still true, else afresh.
    fn go_on(&mut self, cause: Cause, outcome: &Outcome) -> Flow {
        let t = self.t;
        let next = self.next_stop();
        let ida = self.ida.as_mut().expect("made before the first step");
        let serves = !outcome.reinitialised
            && match cause {
                Cause::Root => self.restart.past_serves_ahead(ida, t, outcome.changed),
                _ => self.restart.past_serves(ida, t, next),
            };
        if serves {
            return Ok(());
        }
        self.restart.remember_step(ida);
        self.statistics.restarts += 1;
        self.first_step(cause).then_some(()).ok_or_else(|| self.refused(&Failure::Code(0)))
    }

    /// Restarts from the gathered values with a first step of sensible length; false when IDA refuses.
    fn first_step(&mut self, cause: Cause) -> bool {
        let t = self.t;
        let room = self.next_stop() - t;
        let ida = self.ida.as_mut().expect("made before the first step");
        let (start, root) = (cause == Cause::Start, cause == Cause::Root);
        self.restart.restart(ida, t, room, self.settings.longest_step, start, root)
    }

    /// What IDA's failure means for the user.
    fn failed(&mut self, failure: Failure) -> Stop {
        let (system, t) = (self.system, self.t);
        if let Failure::Panic(text) = failure {
            std::panic::resume_unwind(Box::new(text));
        }
        // what was reached is kept
        let reached = self.with_model(|driver, model, y, yp| {
            model.load(t, y, yp);
            driver.program.run(&mut model.values);
            driver.write_row(model)
        });
        if let Err(stop) = reached {
            return stop;
        }
        if failure == Failure::NonFinite {
            return self.non_finite(t);
        }
        let ida = self.ida();
        let mut errors = Vec::new();
        ida.weighted_errors(&mut errors);
        let (h, y) = (ida.step_lengths().0, ida.y().to_vec());
        errors.truncate(system.columns.len());
        let why = match failure {
            Failure::ErrorTest => "the error test fails however small the step".to_string(),
            Failure::Convergence => "the equations cannot be solved for a step".to_string(),
            Failure::Singular(Some(s)) if s.column < system.columns.len() => {
                let v = system.columns[s.column].variable;
                format!("the equations do not determine `{}` there", system.dae.variables[v.index()].name)
            }
            Failure::Singular(_) => "the equations became singular".to_string(),
            Failure::TooMuchAccuracy => "the tolerance is finer than numbers of 64 bits allow".to_string(),
            other => format!("{other:?}"),
        };
        Stop::new(End::StepTooSmall, report::step_collapse(system, t, h, &why, &errors, &y))
    }

    fn non_finite(&mut self, t: f64) -> Stop {
        let system = self.system;
        let model = self.ida().equations();
        let (at, trap) = match model.trap.take() {
            Some((at, y, yp)) => {
                model.observe(at, &y, &yp);
                (at, report::find_trap(system, &model.values))
            }
            None => (t, None),
        };
        Stop::new(End::NonFinite, report::non_finite(system, at, trap))
    }
}
