//! One run from its start to its end.

mod event;
pub mod exchange;
mod failure;
mod legs;
mod outside;
mod remember;
mod tangents;

use super::algebraic::{self, AlgebraicSolver};
use super::continuity::ContinuityMonitor;
use super::events::{EventHandler, EventOutcome};
use super::foresight::CrossingForecast;
use super::ida::{Ida, IdaFailure, IntegratorTolerances};
use super::linear::Lu;
use super::model::IntegrationModel;
use super::modes::{CrossingModes, RootFunctions, follows_time};
use super::monitor::{AssertionReports, ChatterMonitor, ImpactAccumulation};
use super::newton::VariableScales;
use super::output::OutputGrid;
use super::past::{DelayBuffers, DelayHistory};
use super::restart::IntegratorRestart;
use super::schedule::SampleClocks;
use super::settings::{End, Settings, Statistics};
use super::state::State;
use super::{Control, RecordedInput, RowSink, RunResult, initialize, report};
use crate::lower::{ExecutableSystem, Program, SparsityPattern, ValueLayout};
use bramah_model::structure::{CrossingKind, StateChoice};
use bramah_syntax::diag::{Code, Diagnostic};
use std::ops::ControlFlow;
use std::time::{Duration, Instant};
use tangents::TangentPropagator;

/// The clock, for the statistics' seconds alone: nothing else depends on it.
#[allow(clippy::disallowed_methods, reason = "solve_s and initialize_s are measured where they pass")]
fn now() -> Instant {
    Instant::now()
}

/// Steps between two looks at the outside when no row is due.
const PAUSE: u32 = 200;
/// The same where states may have to be changed in time.
const PAUSE_WITH_SELECTIONS: u32 = 10;

/// What the corrector may leave, in tolerances, where there are algebraic unknowns: what it leaves in them goes on into
/// the derivatives and looks like an error of integration. Down to 1e-6 a tenth of it changes neither errors nor work;
/// below, where orders are high, it fails the error test over and over (the transistor amplifier at 1e-8: 41,000 steps
/// and 35,000 failures with 0.1, 4,600 steps with 0.001, and an error fifty times smaller).
fn algebraic_corrector(tolerance: f64) -> f64 {
    0.1 * (1e6 * tolerance).clamp(0.01, 1.0)
}

/// The share in the error test of what has no error.
const NOTHING: f64 = 1e-30;

/// Why a run ends before its stop time.
pub struct EarlyStop {
    /// How.
    pub end: End,
    /// What to say.
    pub diagnostics: Vec<Diagnostic>,
}

impl EarlyStop {
    fn new(end: End, diagnostic: Diagnostic) -> Self {
        EarlyStop { end, diagnostics: vec![diagnostic] }
    }

    /// With what functions outside the equations have said.
    fn with_troubles(mut self, system: &ExecutableSystem) -> Self {
        let mut troubles = report::troubles(system);
        if let Some(first) = self.diagnostics.first_mut() {
            troubles.retain(|trouble| !first.message.starts_with(trouble));
            first.notes.extend(troubles);
        }
        self
    }
}

type StopResult = Result<(), EarlyStop>;

/// Where a run starts when not at its initial values.
pub enum RunOrigin<'a> {
    /// At a saved state.
    State(&'a State),
    /// Where the same run stopped for other states; its rows go on as if nothing had happened.
    Switch(&'a State, OutputGrid),
}

/// Why a run stands before its end, and how it goes on.
pub struct StateSwitch {
    /// The states to go on with; `None` at a checkpoint.
    pub choice: Option<StateChoice>,
    /// The rows that are out.
    pub grid: OutputGrid,
}

/// A run, or the part of it up to a checkpoint or a change of states.
pub struct RunSegment {
    /// What it came to.
    pub run: RunResult,
    /// Set when the run is to go on.
    pub switch: Option<StateSwitch>,
}

/// What caused an event.
#[derive(Clone, Copy, PartialEq)]
enum EventCause {
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
    system: &'a ExecutableSystem,
    settings: &'a Settings,
    /// None when the caller steps from outside.
    control: Option<&'a mut Control<'c>>,
    sink: Option<&'a mut dyn RowSink>,
    /// Where the integrator must not pass.
    until: f64,
    /// Present from the start on; before that the model stands alone.
    ida: Option<Ida<IntegrationModel<'a>>>,
    scales: VariableScales,
    modes: CrossingModes,
    events: EventHandler,
    clocks: SampleClocks,
    grid: OutputGrid,
    /// The first row is out already.
    silent: bool,
    /// Pauses in a row between which time hardly moved.
    creep: u32,
    /// Where algebraic unknowns were last solved anew without an event.
    renewed: f64,
    /// How often.
    renewals: u32,
    /// When a loop jumped to another root last, and how many tolerances ahead it was sought.
    jumped: (f64, f64),
    /// Whether algebraic unknowns are left out of the error test.
    tests_states_only: bool,
    /// Other states to go on with.
    choice: Option<StateChoice>,
    program: Program,
    slots: Vec<usize>,
    row: Vec<f64>,
    restart: IntegratorRestart,
    continuity: ContinuityMonitor,
    /// Sensitivities, where they are asked for.
    carried: Option<Box<TangentPropagator>>,
    /// Length of the last step before an event.
    last_step: f64,
    algebraic: AlgebraicSolver,
    chatter: ChatterMonitor,
    accumulation: ImpactAccumulation,
    reported: AssertionReports,
    /// Inputs that change at the next event, as slots and values.
    pending: Vec<(usize, f64)>,
    t: f64,
    /// The next time at which a relation of time changes.
    next_crossing: f64,
    /// Other relations of time.
    foresight: CrossingForecast<'a>,
    roots: Vec<i32>,
    statistics: Statistics,
    diagnostics: Vec<Diagnostic>,
}

/// Runs a system from its initial values, or from a saved state, until a time at most.
pub fn run<'a>(
    system: &'a ExecutableSystem,
    settings: &'a Settings,
    inputs: &[RecordedInput],
    from: Option<RunOrigin<'_>>,
    until: f64,
    sink: &'a mut dyn RowSink,
    control: &'a mut Control<'_>,
) -> RunSegment {
    let clock = now();
    let resumed = from.is_some();
    let (mut driver, model, solved) = prepare(system, settings, inputs, from, Some(sink), Some(control));
    driver.until = until;
    driver.complete(model, solved, resumed, clock)
}

/// A run that stands at its start, to be taken further from outside.
///
/// # Errors
/// As a run that ends there.
pub fn start<'a>(
    system: &'a ExecutableSystem,
    settings: &'a Settings,
    inputs: &[RecordedInput],
    from: Option<&State>,
) -> Result<Driver<'a, 'a>, EarlyStop> {
    let resumed = from.is_some();
    let (mut driver, mut model, solved) = prepare(system, settings, inputs, from.map(RunOrigin::State), None, None);
    solved.map_err(|d| stop_at_start(d).with_troubles(system))?;
    // the caller says how far each step goes: a state from behind the stop time is a start like others
    driver.until = driver.until.max(driver.t + (settings.stop_time - settings.start_time).abs());
    driver.begin(&mut model, resumed)?;
    driver.integrator(model)?;
    Ok(driver)
}

fn stop_at_start(diagnostic: Diagnostic) -> EarlyStop {
    let end = match diagnostic.code {
        Code::NonFinite => End::NonFinite,
        Code::AssertionFailed => End::Assertion,
        _ => End::StepTooSmall,
    };
    EarlyStop::new(end, diagnostic)
}

/// A driver, its model, and whether the model's values at the start were found.
fn prepare<'a, 'c>(
    system: &'a ExecutableSystem,
    settings: &'a Settings,
    inputs: &[RecordedInput],
    from: Option<RunOrigin<'_>>,
    sink: Option<&'a mut dyn RowSink>,
    control: Option<&'a mut Control<'c>>,
) -> (Driver<'a, 'c>, IntegrationModel<'a>, Result<(), Diagnostic>) {
    let mut values = initialize::prepare(system, settings);
    let (from, grid) = match from {
        None => (None, None),
        Some(RunOrigin::State(state)) => (Some(state), None),
        Some(RunOrigin::Switch(state, grid)) => (Some(state), Some(grid)),
    };
    let start = from.map_or(settings.start_time, |s| s.time);
    values[ValueLayout::TIME] = start;
    let mut playback = super::inputs::InputPlayback::new(inputs, &system.layout);
    playback.seek(start, &mut values);
    let scales = VariableScales::new(system, &values);
    let mut modes = CrossingModes::new(system, settings.tolerance);
    let past = from.map_or_else(DelayHistory::default, |s| s.past.clone());
    let delays = DelayBuffers::new(system, &values, past);
    let solved = match from {
        Some(state) => {
            state.restore(system, &mut values);
            system.parameters_changed(&mut values);
            modes.after = true;
            Ok(Vec::new())
        }
        None => initialize::check_parameters(system, settings, &values)
            .and_then(|()| {
                let found = initialize::solve(system, &scales, &mut modes, &mut values);
                found.map_err(|f| report::block_failure(system, Code::InitialFailed, &f, &values, "at the start"))
            })
            .and_then(|()| initialize::check_starts(system, &scales, &values)),
    };
    let (solved, missed) = match solved {
        Ok(missed) => (Ok(()), missed),
        Err(d) => (Err(d), Vec::new()),
    };
    let solved = solved.and(delays.map(|delays| playback.delays = delays).map_err(|(i, time)| {
        let origin = system.dae.delays[i].origin;
        let text = format!("the time of a `delay` must be positive, and is {} s", report::number(time));
        report::at_origin(&system.dae, Code::OutOfRange, text, origin, "here")
    }));
    if playback.delays.past().is_empty() {
        playback.delays.start(system, start, &mut values);
    }
    if from.is_some() {
        playback.seek(start, &mut values);
    }
    let mut restart = IntegratorRestart::new(system, &scales, settings.tolerance);
    if from.is_some() {
        restart.resume(system, &mut values);
    }
    let asked = settings.tangents.as_ref().filter(|_| !system.columns.is_empty());
    let carried =
        asked.map(|asked| Box::new(TangentPropagator::new(system, asked, &settings.wanted, restart.nominal())));
    let directions = settings.tangents.as_ref().map_or(0, |asked| asked.starts.len());
    let roots = RootFunctions::new(system);
    let driver = Driver {
        carried,
        last_step: 0.0,
        algebraic: AlgebraicSolver::new(system, restart.nominal(), settings.tolerance),
        restart,
        continuity: ContinuityMonitor::new(system, &scales, settings.tolerance),
        events: EventHandler::new(system, &scales, &modes),
        program: system.observe_only(&settings.wanted),
        slots: settings.wanted.iter().map(|&v| system.layout.var(v)).collect(),
        row: vec![0.0; settings.wanted.len() * (1 + directions)],
        silent: grid.is_some(),
        grid: grid.unwrap_or_else(|| {
            OutputGrid::new(start, settings.stop_time, settings.interval).with_event_rows(settings.most_event_rows)
        }),
        choice: None,
        creep: 0,
        renewed: f64::NEG_INFINITY,
        renewals: 0,
        jumped: (f64::NEG_INFINITY, 0.0),
        tests_states_only: false,
        accumulation: ImpactAccumulation::default(),
        chatter: ChatterMonitor::new(settings.stop_time - settings.start_time, settings.events_at_once),
        reported: AssertionReports::new(system),
        pending: Vec::new(),
        t: start,
        until: settings.stop_time,
        next_crossing: f64::INFINITY,
        foresight: CrossingForecast::new(system, &roots, settings.stop_time - settings.start_time),
        roots: Vec::new(),
        statistics: Statistics::default(),
        diagnostics: missed,
        clocks: SampleClocks::default(),
        ida: None,
        system,
        settings,
        control,
        sink,
        scales,
        modes,
    };
    let model = IntegrationModel { system, values, roots, playback, trap: None, slopes: None };
    (driver, model, solved)
}

impl<'a> Driver<'a, '_> {
    fn complete(
        mut self,
        mut model: IntegrationModel<'a>,
        solved: Result<(), Diagnostic>,
        resumed: bool,
        clock: Instant,
    ) -> RunSegment {
        let end = match solved {
            Err(diagnostic) => Err(stop_at_start(diagnostic)),
            Ok(()) => self.begin(&mut model, resumed),
        };
        self.statistics.initialize_s = clock.elapsed().as_secs_f64();
        let clock = now();
        let before = self.writing();
        let (end, values) = match end.and_then(|()| self.integrator(model.clone())) {
            Err(stop) => (Err(stop), model.values),
            Ok(()) => {
                let end = self.integrate();
                let values = self.last_values();
                (end, values)
            }
        };
        self.statistics.solve_s = clock.elapsed().saturating_sub(self.writing() - before).as_secs_f64();
        let past =
            self.ida.as_ref().map_or_else(DelayHistory::default, |ida| ida.watch().playback.delays.past().clone());
        self.finish(end, &values, past)
    }

    fn writing(&self) -> Duration {
        self.sink.as_ref().map_or(Duration::ZERO, |sink| sink.writing())
    }

    fn finish(mut self, end: StopResult, values: &[f64], past: DelayHistory) -> RunSegment {
        let stands = end.is_ok() && (self.choice.is_some() || self.pauses());
        let end = match end {
            Ok(()) => End::Reached,
            Err(stop) => {
                let stop = stop.with_troubles(self.system);
                self.diagnostics.extend(stop.diagnostics);
                stop.end
            }
        };
        self.count_work();
        self.note_thinned();
        let run = RunResult {
            end,
            time: self.t,
            diagnostics: self.diagnostics,
            statistics: self.statistics,
            state: State::save(self.system, self.t, values, past),
        };
        RunSegment { run, switch: stands.then_some(StateSwitch { choice: self.choice, grid: self.grid }) }
    }

    /// Whether the run goes on behind where this leg ends.
    fn pauses(&self) -> bool {
        self.until < self.settings.stop_time
    }

    /// Brings the statistics up to date.
    fn count_work(&mut self) {
        self.statistics.unknowns = self.system.columns.len();
        self.statistics.states = self.system.columns.iter().filter(|c| c.is_state()).count();
        if let Some(ida) = &self.ida {
            let work = ida.work();
            self.statistics.steps = work.steps;
            self.statistics.residual_evaluations = work.residuals + self.algebraic.effort.residuals;
            self.statistics.jacobian_evaluations = work.jacobians + self.algebraic.effort.jacobians;
            self.statistics.factorizations = work.factorizations;
            self.statistics.error_test_failures = work.error_test_failures;
            self.statistics.crossing_evaluations = work.crossings;
        }
    }

    /// The event iteration at the start, and the first row.
    fn begin(&mut self, model: &mut IntegrationModel<'a>, resumed: bool) -> StopResult {
        let system = self.system;
        let mut outcome = EventOutcome::default();
        if !resumed {
            // what fires at `initial()`, with the values that initialization has found
            model.values[ValueLayout::INITIAL] = 1.0;
            self.events.act(system, &mut model.values, &mut outcome);
            model.values[ValueLayout::INITIAL] = 0.0;
        }
        self.events.settle_pre(&mut model.values);
        self.clocks = SampleClocks::new(system, &model.values, self.t).map_err(|i| {
            let sample = &system.dae.samples[i];
            let text = "the interval of `sample` is not positive";
            let reported = report::at_origin(&system.dae, Code::EventFailed, text, sample.origin, "here");
            EarlyStop::new(
                End::StepTooSmall,
                reported.help("give the parameters of the interval positive values, in seconds"),
            )
        })?;
        if resumed {
            self.clocks.skip(self.t);
        }
        let events = &self.events;
        self.clocks.ring(self.t, |i| events.raise(i, &mut model.values));
        let mut at_start = self.iterate(model, EventCause::Start)?;
        // what happens at the start may change what the past begins with
        if !resumed && model.playback.delays.start(system, self.t, &mut model.values) {
            at_start = self.iterate(model, EventCause::Start)?;
        }
        outcome.terminate = outcome.terminate.or(at_start.terminate);
        outcome.failed.extend(at_start.failed);
        self.start_tangents(model)?;
        if !self.silent {
            self.tangent_cells(model);
            self.write_row(model)?;
            self.grid.pass(self.t);
        }
        self.judge(model, &outcome)
    }

    /// Writes the wanted values that stand in their slots.
    fn write_row(&mut self, model: &mut IntegrationModel<'a>) -> StopResult {
        if let Some(relation) = self.accumulation.watched()
            && let Some(d) = self.accumulation.judge(self.system, self.t, self.distance(relation, &model.values))
        {
            return Err(EarlyStop::new(End::Chattering, d));
        }
        if self.sink.is_none() {
            return Ok(());
        }
        for (cell, &slot) in self.row.iter_mut().zip(&self.slots) {
            *cell = model.values[slot];
        }
        if self.row.iter().any(|v| !v.is_finite()) {
            return Err(self.non_finite_row(model));
        }
        match self.sink.as_mut().map(|sink| sink.row(self.t, &self.row)) {
            Some(ControlFlow::Break(())) => Err(self.interrupted()),
            _ => Ok(()),
        }
    }

    /// How far the sides of a relation are apart.
    fn distance(&self, relation: u32, values: &[f64]) -> f64 {
        match self.system.dae.crossings[relation as usize].kind {
            CrossingKind::Relation(_, left, right) => self.system.eval(left, values) - self.system.eval(right, values),
            _ => 0.0,
        }
    }

    /// Makes the integrator from the values of the start.
    fn integrator(&mut self, mut model: IntegrationModel<'a>) -> StopResult {
        let system = self.system;
        let still = system.columns.is_empty();
        // without unknowns IDA still finds the roots of functions of time: it integrates a constant
        let pattern =
            if still { SparsityPattern { n: 1, colptr: vec![0, 1], rowidx: vec![0] } } else { system.pattern.clone() };
        let nominal = self.restart.nominal();
        let tolerances = IntegratorTolerances {
            relative: self.settings.tolerance,
            absolute: nominal.iter().map(|n| n * self.settings.tolerance).collect(),
            share: if still { vec![1.0] } else { self.shares() },
        };
        let mut lu = Lu::new(&pattern, nominal);
        lu.may_keep(self.events.kept().is_some());
        self.restart.gather(system, &mut model.values);
        let roots = model.roots.len();
        let start = (self.t, self.restart.y(), self.restart.yp());
        let ida = Ida::new(model, &pattern, lu, roots, &tolerances, start);
        let mut ida = ida.map_err(|f| self.refused(&f))?;
        // a caller who steps may go on from behind the stop time
        let ahead = self.settings.stop_time - self.t;
        let span = if ahead > 0.0 { ahead } else { self.settings.stop_time - self.settings.start_time };
        let unseen = system.dae.states.is_empty() || follows_time(&system.dae);
        let longest = self.settings.longest_step.min(if unseen { span / 500.0 } else { f64::INFINITY });
        let recorded = &ida.watch().playback.delays;
        let (known, delays) = (recorded.longest_step(), !recorded.is_empty());
        ida.set_longest_step(longest.min(known));
        if !self.restart.is_explicit() {
            ida.set_corrector_tolerance(algebraic_corrector(self.settings.tolerance));
        }
        ida.pause_after(match () {
            // each step is recorded
            () if delays => 1,
            () if system.dae.selections.is_empty() => PAUSE,
            () => PAUSE_WITH_SELECTIONS,
        });
        self.ida = Some(ida);
        if !self.hand_over_tangents(true) {
            return Err(self.refused(&IdaFailure::Code(0)));
        }
        self.first_step(EventCause::Start);
        Ok(())
    }

    /// How errors of the unknowns count: those of states that stand still do not.
    fn shares(&self) -> Vec<f64> {
        let mut shares = algebraic::shares(self.system);
        let still = self.settings.tangents.iter().flat_map(|t| &t.still);
        let places: Vec<usize> = still.filter_map(|&v| super::tangents::column(self.system, v)).map(|c| c.0).collect();
        let n = shares.len() as f64;
        let part = (n / (n - places.len() as f64).max(1.0)).sqrt();
        shares.iter_mut().for_each(|s| *s *= part);
        places.into_iter().for_each(|j| shares[j] = NOTHING);
        shares
    }

    fn ida(&mut self) -> &mut Ida<IntegrationModel<'a>> {
        self.ida.as_mut().expect("made before the first step")
    }

    fn last_values(&mut self) -> Vec<f64> {
        let t = self.t;
        self.with_model(|driver, model, y, yp| {
            let (y, yp) = driver.algebraic.solve(model, t, y, yp);
            model.observe(t, y, yp);
            model.values.clone()
        })
    }

    /// Runs `act` with the model and the integrator's values at hand.
    fn with_model<T>(&mut self, act: impl FnOnce(&mut Self, &mut IntegrationModel<'a>, &[f64], &[f64]) -> T) -> T {
        let mut ida = self.ida.take().expect("made before the first step");
        let (model, y, yp) = ida.parts();
        let result = act(self, model, y, yp);
        self.ida = Some(ida);
        result
    }
}
