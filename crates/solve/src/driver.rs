//! One segment of a run: initialization, then integration by IDA from event to event until `until`.
//!
//! A system, settings, recorded inputs and an origin enter [`run`]; a [`RunSegment`] leaves it. [`start`] makes a
//! driver that the caller advances step by step. `legs` integrates between events, `event` handles them, `outside` is
//! the interface for stepping, `exchange` leaves the integration to the caller, `tangents` carries sensitivities,
//! `remember` records what `delay` reads, `failure` explains why a run stops.

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

/// The clock. Only the seconds of the statistics depend on it, never a result.
#[allow(clippy::disallowed_methods, reason = "solve_s and initialize_s are measured where they pass")]
fn now() -> Instant {
    Instant::now()
}

/// Steps of IDA after which [`Ida::advance`] returns although no row is due, so that interrupts are noticed.
const PAUSE: u32 = 200;
/// The same for models with dynamic state selection: the states are checked at each pause.
const PAUSE_WITH_SELECTIONS: u32 = 10;

/// The tolerance of IDA's corrector, in units of the error tolerance, for systems with algebraic unknowns.
///
/// An error that the corrector leaves in an algebraic unknown enters the derivatives and looks like an integration
/// error. Down to a tolerance of 1e-6 the factor 0.1 changes neither errors nor work. Below, where orders are high, the
/// error test fails again and again with it. The transistor amplifier at 1e-8 takes 41,000 steps and 35,000 failures
/// with 0.1, and 4,600 steps with 0.001 at a fiftieth of the error.
fn algebraic_corrector(tolerance: f64) -> f64 {
    0.1 * (1e6 * tolerance).clamp(0.01, 1.0)
}

/// The weight in the error test of a state that is constant and has no error. IDA requires weights above zero.
const NOTHING: f64 = 1e-30;

/// Why a run ends before its stop time.
pub struct EarlyStop {
    /// The kind of end.
    pub end: End,
    /// Messages for the user. Empty where the model itself ended the run by `terminate`.
    pub diagnostics: Vec<Diagnostic>,
}

impl EarlyStop {
    /// A stop with one message.
    fn new(end: End, diagnostic: Diagnostic) -> Self {
        EarlyStop { end, diagnostics: vec![diagnostic] }
    }

    /// Adds messages of external functions (tables, C code) as notes to the first diagnostic.
    fn with_troubles(mut self, system: &ExecutableSystem) -> Self {
        let mut troubles = report::troubles(system);
        if let Some(first) = self.diagnostics.first_mut() {
            // a message that is the text of the diagnostic itself is not repeated
            troubles.retain(|trouble| !first.message.starts_with(trouble));
            first.notes.extend(troubles);
        }
        self
    }
}

/// `Err` ends the run early.
type StopResult = Result<(), EarlyStop>;

/// Where a run starts, if not at its initial values.
pub enum RunOrigin<'a> {
    /// At a saved state. Its rows begin at the time of the state.
    State(&'a State),
    /// Where the previous segment of the same run ended. The rows continue on its grid, without a row at the start.
    Switch(&'a State, OutputGrid),
}

/// Why a segment ended before the end of the run, and what the next segment needs.
pub struct StateSwitch {
    /// The states for the next segment; `None` at a checkpoint.
    pub choice: Option<StateChoice>,
    /// The output grid, which knows how many rows have been written.
    pub grid: OutputGrid,
}

/// A run, or the part of it up to a checkpoint or a change of states.
pub struct RunSegment {
    /// Outcome of this segment alone.
    pub run: RunResult,
    /// Set when another segment must follow.
    pub switch: Option<StateSwitch>,
}

/// What caused an event.
#[derive(Clone, Copy, PartialEq)]
enum EventCause {
    /// The start of the run, where the event iteration runs once.
    Start,
    /// A known time: a sample, a relation of time, a jump of an input, or an input set by the caller.
    Time,
    /// A sign change of a crossing function, found by IDA or at a stop.
    Root,
    /// The end of the run, where `terminal()` is true.
    Terminal,
}

/// A run in progress: the integrator, the discrete state, the output and all monitors.
pub struct Driver<'a, 'c> {
    /// The kernels and the sorted DAE.
    system: &'a ExecutableSystem,
    /// Tolerance, times, wanted variables.
    settings: &'a Settings,
    /// Interrupt, progress and reselection. `None` when the caller steps from outside.
    control: Option<&'a mut Control<'c>>,
    /// Receives the rows. `None` when the caller steps from outside.
    sink: Option<&'a mut dyn RowSink>,
    /// End of this segment in seconds. The integrator never passes it.
    until: f64,
    /// The integrator, which owns the model. `None` until [`Driver::integrator`] has made it.
    ida: Option<Ida<IntegrationModel<'a>>>,
    /// Nominal values, minima and maxima of all variables.
    scales: VariableScales,
    /// The side of zero on which each crossing function stands.
    modes: CrossingModes,
    /// The event iteration and its workspace.
    events: EventHandler,
    /// Next times of all `sample` operators.
    clocks: SampleClocks,
    /// Times at which rows are due.
    grid: OutputGrid,
    /// No row is written at the start, because the previous segment wrote it.
    silent: bool,
    /// Number of consecutive pauses between which time hardly moved.
    creep: u32,
    /// Time at which algebraic unknowns were last solved anew without an event, in seconds.
    renewed: f64,
    /// Number of restarts without an event.
    renewals: u32,
    /// Time of the last jump of a loop to another root, and how far ahead that root was searched, in tolerances.
    jumped: (f64, f64),
    /// Whether the error test leaves out algebraic unknowns until the next event.
    tests_states_only: bool,
    /// Other states with which the next segment must continue.
    choice: Option<StateChoice>,
    /// Computes the wanted variables from the unknowns.
    program: Program,
    /// Slots of the wanted variables, in the order of the row.
    slots: Vec<usize>,
    /// One row: the wanted values, then for each direction of sensitivity their derivatives.
    row: Vec<f64>,
    /// Values around an event, and the decision whether IDA restarts.
    restart: IntegratorRestart,
    /// Checks that differentiated variables do not jump at events without `reinit`.
    continuity: ContinuityMonitor,
    /// Sensitivities. `None` where the settings ask for none.
    carried: Option<Box<TangentPropagator>>,
    /// Length of the last step before an event, in seconds.
    last_step: f64,
    /// Solves the algebraic equations at interpolated points, so that rows satisfy them.
    algebraic: AlgebraicSolver,
    /// Detects too many events in a short time.
    chatter: ChatterMonitor,
    /// Detects impacts whose times accumulate (Zeno behaviour).
    accumulation: ImpactAccumulation,
    /// Which warnings have been reported; each is reported once.
    reported: AssertionReports,
    /// Slots and new values of inputs that change at the next event.
    pending: Vec<(usize, f64)>,
    /// Present time in seconds.
    t: f64,
    /// The next time at which a relation of time alone changes, in seconds.
    next_crossing: f64,
    /// Forecast of all other crossing functions that depend on time alone.
    foresight: CrossingForecast<'a>,
    /// Direction of each root function at the present event: 1 rising, -1 falling, 0 not crossed.
    roots: Vec<i32>,
    /// Counts of work.
    statistics: Statistics,
    /// Warnings so far.
    diagnostics: Vec<Diagnostic>,
}

/// Runs a system from its initial values, or from `from`, until the time `until` at most.
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

/// Initializes a run that the caller then advances with [`Driver::advance`].
///
/// # Errors
/// Initialization or the first event iteration failed.
pub fn start<'a>(
    system: &'a ExecutableSystem,
    settings: &'a Settings,
    inputs: &[RecordedInput],
    from: Option<&State>,
) -> Result<Driver<'a, 'a>, EarlyStop> {
    let resumed = from.is_some();
    let (mut driver, mut model, solved) = prepare(system, settings, inputs, from.map(RunOrigin::State), None, None);
    solved.map_err(|d| stop_at_start(d).with_troubles(system))?;
    // the caller chooses each target: a state saved after the stop time is a valid start too
    driver.until = driver.until.max(driver.t + (settings.stop_time - settings.start_time).abs());
    driver.begin(&mut model, resumed)?;
    driver.integrator(model)?;
    Ok(driver)
}

/// Turns a failed initialization into the end of the run.
fn stop_at_start(diagnostic: Diagnostic) -> EarlyStop {
    let end = match diagnostic.code {
        Code::NonFinite => End::NonFinite,
        Code::AssertionFailed => End::Assertion,
        _ => End::StepTooSmall,
    };
    EarlyStop::new(end, diagnostic)
}

/// Makes a driver and its model, and solves the initial system unless a state is given.
///
/// The third element is `Err` when no consistent values were found. Driver and model are returned then too, since the
/// result of the run reports the values reached.
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
    // time and inputs must be in place before nominal values are evaluated
    playback.seek(start, &mut values);
    let scales = VariableScales::new(system, &values);
    let mut modes = CrossingModes::new(system, settings.tolerance);
    let past = from.map_or_else(DelayHistory::default, |s| s.past.clone());
    let delays = DelayBuffers::new(system, &values, past);
    let solved = match from {
        Some(state) => {
            state.restore(system, &mut values);
            system.parameters_changed(&mut values);
            // relations of time hold as just after their time, as at events
            modes.after = true;
            Ok(Vec::new())
        }
        // a new run: asserted parameters, then the initial system, then redundant fixed starts
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
    // the first failure is reported: initialization before the delays
    let solved = solved.and(delays.map(|delays| playback.delays = delays).map_err(|(i, time)| {
        let origin = system.dae.delays[i].origin;
        let text = format!("the time of a `delay` must be positive, and is {} s", report::number(time));
        report::at_origin(&system.dae, Code::OutOfRange, text, origin, "here")
    }));
    // a saved state brings its own history of delays
    if playback.delays.past().is_empty() {
        playback.delays.start(system, start, &mut values);
    }
    // restoring the state has overwritten the slots of inputs
    if from.is_some() {
        playback.seek(start, &mut values);
    }
    let mut restart = IntegratorRestart::new(system, &scales, settings.tolerance);
    if from.is_some() {
        restart.resume(system, &mut values);
    }
    // without unknowns there is nothing to be sensitive
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
    /// Runs the first event iteration and the integration, and collects the result.
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
        // time spent in the sink (files, callbacks) is not time of the solver
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

    /// Time spent in the sink so far.
    fn writing(&self) -> Duration {
        self.sink.as_ref().map_or(Duration::ZERO, |sink| sink.writing())
    }

    /// Ends the segment: collects diagnostics and counts, saves the state, and says whether another segment follows.
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

    /// Whether this segment ends at a checkpoint before the stop time.
    fn pauses(&self) -> bool {
        self.until < self.settings.stop_time
    }

    /// Copies the counters of IDA and of the algebraic solver into the statistics.
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

    /// The event iteration at the start, the first row, and the checks of assertions there.
    fn begin(&mut self, model: &mut IntegrationModel<'a>, resumed: bool) -> StopResult {
        let system = self.system;
        let mut outcome = EventOutcome::default();
        // actions that fire at `initial()` use the values of initialization, before any `pre` changes
        if !resumed {
            model.values[ValueLayout::INITIAL] = 1.0;
            self.events.act(system, &mut model.values, &mut outcome);
            model.values[ValueLayout::INITIAL] = 0.0;
        }
        // from here on `pre(v)` equals `v`
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
            // samples at or before the time of a saved state have been handled already
            self.clocks.skip(self.t);
        }
        let events = &self.events;
        self.clocks.ring(self.t, |i| events.raise(i, &mut model.values));
        let mut at_start = self.iterate(model, EventCause::Start)?;
        // actions at the start may change the values with which the delay history begins
        if !resumed && model.playback.delays.start(system, self.t, &mut model.values) {
            at_start = self.iterate(model, EventCause::Start)?;
        }
        outcome.terminate = outcome.terminate.or(at_start.terminate);
        outcome.failed.extend(at_start.failed);
        // the row below holds sensitivities too
        self.start_tangents(model)?;
        if !self.silent {
            self.tangent_cells(model);
            self.write_row(model)?;
            self.grid.pass(self.t);
        }
        self.judge(model, &outcome)
    }

    /// Writes one row from the slots of the wanted variables.
    ///
    /// Fails when impacts have accumulated, when a value is not finite, or when the sink ends the run.
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
            // a row with NaN or infinity never reaches the sink
            return Err(self.non_finite_row(model));
        }
        match self.sink.as_mut().map(|sink| sink.row(self.t, &self.row)) {
            Some(ControlFlow::Break(())) => Err(self.interrupted()),
            _ => Ok(()),
        }
    }

    /// Left minus right side of a relation, in the unit of its sides; 0 for other crossings.
    fn distance(&self, relation: u32, values: &[f64]) -> f64 {
        match self.system.dae.crossings[relation as usize].kind {
            CrossingKind::Relation(_, left, right) => self.system.eval(left, values) - self.system.eval(right, values),
            _ => 0.0,
        }
    }

    /// Creates IDA from consistent values and sets tolerances, step bounds and the first step.
    fn integrator(&mut self, mut model: IntegrationModel<'a>) -> StopResult {
        let system = self.system;
        let still = system.columns.is_empty();
        // without unknowns IDA integrates one constant, so that roots of functions of time are still found
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
        // y and y' come from the slots that initialization has filled
        self.restart.gather(system, &mut model.values);
        let roots = model.roots.len();
        let start = (self.t, self.restart.y(), self.restart.yp());
        let ida = Ida::new(model, &pattern, lu, roots, &tolerances, start);
        let mut ida = ida.map_err(|f| self.refused(&f))?;
        // a caller who steps may continue after the stop time
        let ahead = self.settings.stop_time - self.t;
        let span = if ahead > 0.0 { ahead } else { self.settings.stop_time - self.settings.start_time };
        let unseen = system.dae.states.is_empty() || follows_time(&system.dae);
        // with nothing to control its error, the step would grow over whole peaks of functions of time
        let longest = self.settings.longest_step.min(if unseen { span / 500.0 } else { f64::INFINITY });
        let recorded = &ida.watch().playback.delays;
        let (known, delays) = (recorded.longest_step(), !recorded.is_empty());
        // a step longer than the shortest delay would read values that are not recorded yet
        ida.set_longest_step(longest.min(known));
        // IDA's default of 0.33 is enough where every unknown has its own derivative
        if !self.restart.is_explicit() {
            ida.set_corrector_tolerance(algebraic_corrector(self.settings.tolerance));
        }
        ida.pause_after(match () {
            // each step must be recorded for the delays
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

    /// The weight of each unknown's error in the error test. States that are constant count as nothing.
    fn shares(&self) -> Vec<f64> {
        let mut shares = algebraic::shares(self.system);
        let still = self.settings.tangents.iter().flat_map(|t| &t.still);
        let places: Vec<usize> = still.filter_map(|&v| super::tangents::column(self.system, v)).map(|c| c.0).collect();
        let n = shares.len() as f64;
        // IDA averages over all n unknowns: without this factor constant states would dilute the error of the others
        let part = (n / (n - places.len() as f64).max(1.0)).sqrt();
        shares.iter_mut().for_each(|s| *s *= part);
        places.into_iter().for_each(|j| shares[j] = NOTHING);
        shares
    }

    /// The integrator. Panics before [`Driver::integrator`] has made it.
    fn ida(&mut self) -> &mut Ida<IntegrationModel<'a>> {
        self.ida.as_mut().expect("made before the first step")
    }

    /// All slots at the present time, with algebraic unknowns solved.
    fn last_values(&mut self) -> Vec<f64> {
        let t = self.t;
        self.with_model(|driver, model, y, yp| {
            let (y, yp) = driver.algebraic.solve(model, t, y, yp);
            model.observe(t, y, yp);
            model.values.clone()
        })
    }

    /// Runs `act` with the driver, the model, and the unknowns and derivatives of IDA.
    fn with_model<T>(&mut self, act: impl FnOnce(&mut Self, &mut IntegrationModel<'a>, &[f64], &[f64]) -> T) -> T {
        // the integrator owns the model: it is taken out, so that `act` may borrow the driver too
        let mut ida = self.ida.take().expect("made before the first step");
        let (model, y, yp) = ida.parts();
        let result = act(self, model, y, yp);
        self.ida = Some(ida);
        result
    }
}
