//! Simulation of a sorted DAE: initialization, integration by SUNDIALS IDA, events, output rows.
//!
//! A [`lower::ExecutableSystem`] (kernels made by `lower::lower`) and [`Settings`] enter. Rows leave through a
//! [`RowSink`], and a [`RunResult`] tells how the run ended. [`simulate`] runs from the start or from a saved
//! [`State`]; [`resume`] continues from a [`Checkpoint`]. A run that fails keeps the rows written so far and explains
//! the failure in its diagnostics. The crates `circuit`, `analysis`, `gap` and `fmi` call this crate.
//!
//! The order of work is: `initialize` solves the initial system, `driver` calls IDA (`ida`) from event to event,
//! `events` runs the event iteration, `restart` decides how IDA continues after an event.

pub mod lower;

mod algebraic;
mod blocks;
mod checkpoint;
mod continuity;
pub mod driver;
mod events;
mod foresight;
pub mod ida;
mod initialize;
mod inputs;
pub mod linear;
mod model;
mod modes;
mod monitor;
mod newton;
mod output;
mod past;
mod point;
mod report;
mod restart;
mod schedule;
mod selection;
mod settings;
mod stale;
mod state;
mod tangents;
mod vectors;

pub use checkpoint::Checkpoint;
pub use inputs::{Interpolation, RecordedInput, missing_inputs};
pub use output::{RowSink, signals};
pub use past::DelayHistory;
pub use point::ConsistentPoint;
pub use report::at_origin;
pub use settings::{End, Settings, Statistics};
pub use state::State;
pub use tangents::TangentRequest;

use crate::lower::ExecutableSystem;
use bramah_model::structure::StateChoice;
use bramah_syntax::diag::Diagnostic;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// The value of every slot before initialization.
///
/// Parameters have the values of the settings. All other variables have their start values as guesses. The order is
/// that of the slots of [`lower::ValueLayout`].
pub fn guesses(system: &ExecutableSystem, settings: &Settings) -> Vec<f64> {
    initialize::prepare(system, settings)
}

/// The position of a run, as reported to [`Control::progress`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Simulated time in seconds.
    pub time: f64,
    /// Number of events handled so far.
    pub events: u64,
}

/// Callbacks and flags with which the caller influences a run.
#[derive(Default)]
pub struct Control<'a> {
    /// The run ends soon after this flag is set, for example by a handler of Ctrl-C. `None`: no such flag.
    pub interrupt: Option<&'a AtomicBool>,
    /// Called at every row, at events and after a fixed number of steps. The run ends when it returns false.
    pub progress: Option<&'a mut (dyn FnMut(&Progress) -> bool + Send)>,
    /// Sorts the model again with other states when the chosen ones have become singular (dynamic state selection).
    ///
    /// Called once for each choice. `None` as the result means that the model has no such system. The run then keeps
    /// its states.
    pub reselect: Option<&'a mut (dyn FnMut(&StateChoice) -> Option<Arc<ExecutableSystem>> + Send)>,
}

/// The outcome of a run. The rows are in the sink, not here.
#[derive(Clone, Debug)]
pub struct RunResult {
    /// Why the run ended.
    pub end: End,
    /// Simulated time reached, in seconds.
    pub time: f64,
    /// Errors and warnings of the run, in the order in which they arose.
    pub diagnostics: Vec<Diagnostic>,
    /// Counts of steps, evaluations and events.
    pub statistics: Statistics,
    /// The state at the end, from which another run can start.
    pub state: State,
}

/// Runs a system from its initial values, or from a saved state `from`. With `from`, `settings.start_time` is not used.
///
/// Where the chosen states become singular and `control.reselect` is given, the run continues with other states. With
/// `settings.checkpoint_every`, the integrator restarts at each checkpoint, and the sink receives the checkpoint.
pub fn simulate(
    system: &ExecutableSystem,
    settings: &Settings,
    inputs: &[RecordedInput],
    from: Option<&State>,
    sink: &mut dyn RowSink,
    control: &mut Control<'_>,
) -> RunResult {
    // the first segment runs from the initial values up to the first checkpoint, if there are checkpoints
    let first = settings.checkpoint(1);
    let leg = driver::run(system, settings, inputs, from.map(driver::RunOrigin::State), first, sink, control);
    let trajectory = SegmentedRun { system, settings, inputs, states: StateSystems::default(), number: 0 };
    trajectory.complete(leg, sink, control)
}

/// Continues from a checkpoint of a run of the same system with the same settings and inputs.
///
/// The rows equal, bit for bit, those that the uninterrupted run writes after the checkpoint.
pub fn resume(
    system: &ExecutableSystem,
    settings: &Settings,
    inputs: &[RecordedInput],
    from: &Checkpoint,
    sink: &mut dyn RowSink,
    control: &mut Control<'_>,
) -> RunResult {
    let mut trajectory =
        SegmentedRun { system, settings, inputs, states: StateSystems::default(), number: from.number };
    // the interrupted run had found no system for a choice and had stopped asking: this one must not ask again
    if from.settled {
        control.reselect = None;
    }
    // the checkpoint was written with other states than those of `system`
    if let Some(choice) = &from.choice {
        trajectory.states.choose(choice, control);
    }
    // rows before the checkpoint are written already: the grid continues behind them
    let grid = output::OutputGrid::after(settings.start_time, settings.stop_time, settings.interval, from.rows)
        .with_event_rows(settings.most_event_rows);
    let mut leg = trajectory.leg(driver::RunOrigin::Switch(&from.state, grid), sink, control);
    leg.run.statistics.add(&from.statistics);
    trajectory.complete(leg, sink, control)
}

/// The systems made for each choice of states so far.
///
/// Dynamic state selection switches between a few choices; each is sorted and lowered once.
#[derive(Default)]
struct StateSystems {
    /// All choices analyzed in this run, with their systems.
    known: Vec<(StateChoice, Arc<ExecutableSystem>)>,
    /// The choice in use. `None`: the states of the original system.
    present: Option<(StateChoice, Arc<ExecutableSystem>)>,
}

impl StateSystems {
    /// Makes `choice` the present one. If no system exists for it, the present states stay for the rest of the run.
    fn choose(&mut self, choice: &StateChoice, control: &mut Control<'_>) {
        let found = self.known.iter().find(|(known, _)| known == choice).map(|(_, system)| system.clone());
        let found = found.or_else(|| {
            let made = control.reselect.as_mut().and_then(|analyze| analyze(choice))?;
            self.known.push((choice.clone(), made.clone()));
            Some(made)
        });
        match found {
            Some(next) => self.present = Some((choice.clone(), next)),
            // without this the run would stop again at once with the same choice
            None => control.reselect = None,
        }
    }
}

/// A run in segments. Each segment ends at a checkpoint, at a change of states, or at the end of the run.
struct SegmentedRun<'a> {
    /// The system with the original choice of states.
    system: &'a ExecutableSystem,
    /// Settings of the whole run.
    settings: &'a Settings,
    /// Recorded inputs, played back in every segment.
    inputs: &'a [RecordedInput],
    /// Systems with other states, used instead of `system` where one is present.
    states: StateSystems,
    /// Number of checkpoints made.
    number: u64,
}

impl SegmentedRun<'_> {
    /// Runs one segment, from `from` to the next checkpoint at most.
    fn leg(
        &self,
        from: driver::RunOrigin<'_>,
        sink: &mut dyn RowSink,
        control: &mut Control<'_>,
    ) -> driver::RunSegment {
        let system = self.states.present.as_ref().map_or(self.system, |(_, system)| system);
        let until = self.settings.checkpoint(self.number + 1);
        driver::run(system, self.settings, self.inputs, Some(from), until, sink, control)
    }

    /// Runs all further segments after the first one, `leg`, and returns the result of the whole run.
    fn complete(mut self, mut leg: driver::RunSegment, sink: &mut dyn RowSink, control: &mut Control<'_>) -> RunResult {
        while let Some(switch) = leg.switch.take() {
            match &switch.choice {
                // the segment ended because its states had become singular
                Some(choice) => self.states.choose(choice, control),
                // the segment ended at a checkpoint
                None => {
                    self.number += 1;
                    let at = self.checkpoint(&leg.run, &switch.grid, control);
                    // the sink ends the run, for example because it could not write the checkpoint
                    if sink.checkpoint(&at).is_break() {
                        return RunResult { end: End::Interrupted, ..leg.run };
                    }
                }
            }
            let before = leg.run;
            leg = self.leg(driver::RunOrigin::Switch(&before.state, switch.grid), sink, control);
            leg.run.statistics.add(&before.statistics);
            // each segment starts with no memory of reported warnings: those of an earlier segment are dropped here
            let said = |d: &Diagnostic| before.diagnostics.iter().any(|b| b.code == d.code && b.labels == d.labels);
            leg.run.diagnostics.retain(|d| d.is_error() || !said(d));
            // keeps the order of time: earlier segments first
            leg.run.diagnostics.splice(0..0, before.diagnostics);
        }
        leg.run
    }

    /// The checkpoint at the end of a segment: its state, and the counts needed to continue rows and statistics.
    fn checkpoint(&self, run: &RunResult, grid: &output::OutputGrid, control: &Control<'_>) -> Checkpoint {
        Checkpoint {
            state: run.state.clone(),
            number: self.number,
            statistics: run.statistics,
            rows: grid.rows(),
            choice: self.states.present.as_ref().map(|(choice, _)| choice.clone()),
            settled: control.reselect.is_none(),
        }
    }
}

#[cfg(test)]
mod tests;
