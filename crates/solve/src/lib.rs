//! From a lowered system to a trajectory: initialization, integration by SUNDIALS IDA, events.
//!
//! [`simulate`] is the entry. A run that fails returns what it has and says why in its diagnostics.

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

/// Values of all variables before the start, by their slots: parameters as the settings say, guesses for all others.
pub fn guesses(system: &ExecutableSystem, settings: &Settings) -> Vec<f64> {
    initialize::prepare(system, settings)
}

/// How far a run is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Simulated time in seconds.
    pub time: f64,
    /// Events so far.
    pub events: u64,
}

/// Ways to reach into a run.
#[derive(Default)]
pub struct Control<'a> {
    /// Ends the run soon after it is set, as from Ctrl-C.
    pub interrupt: Option<&'a AtomicBool>,
    /// Called every now and then; ends the run by returning false.
    pub progress: Option<&'a mut (dyn FnMut(&Progress) -> bool + Send)>,
    /// Analyses the model anew with other states, when those chosen have become singular. Called once for each choice.
    pub reselect: Option<&'a mut (dyn FnMut(&StateChoice) -> Option<Arc<ExecutableSystem>> + Send)>,
}

/// What a run came to. The rows are in the sink.
#[derive(Clone, Debug)]
pub struct RunResult {
    /// How it ended.
    pub end: End,
    /// The time reached, in seconds.
    pub time: f64,
    /// Errors and warnings.
    pub diagnostics: Vec<Diagnostic>,
    /// The work done.
    pub statistics: Statistics,
    /// Where it ended, to go on from.
    pub state: State,
}

/// Runs a system: from its initial values, or from a saved state (then `settings.start_time` is not used).
///
/// Where the chosen states become singular and `control.reselect` is given, the run goes on with others. With
/// `settings.checkpoint_every`, the integrator begins afresh at each checkpoint, and the sink gets it.
pub fn simulate(
    system: &ExecutableSystem,
    settings: &Settings,
    inputs: &[RecordedInput],
    from: Option<&State>,
    sink: &mut dyn RowSink,
    control: &mut Control<'_>,
) -> RunResult {
    let first = settings.checkpoint(1);
    let leg = driver::run(system, settings, inputs, from.map(driver::RunOrigin::State), first, sink, control);
    let trajectory = SegmentedRun { system, settings, inputs, states: StateSystems::default(), number: 0 };
    trajectory.complete(leg, sink, control)
}

/// Goes on from a checkpoint of a run of the same system with the same settings and inputs. The rows are, bit for bit,
/// those that the whole run brings after the checkpoint.
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
    if from.settled {
        control.reselect = None;
    }
    if let Some(choice) = &from.choice {
        trajectory.states.choose(choice, control);
    }
    let grid = output::OutputGrid::after(settings.start_time, settings.stop_time, settings.interval, from.rows)
        .with_event_rows(settings.most_event_rows);
    let mut leg = trajectory.leg(driver::RunOrigin::Switch(&from.state, grid), sink, control);
    leg.run.statistics.add(&from.statistics);
    trajectory.complete(leg, sink, control)
}

/// The states chosen so far, with the systems made for them.
#[derive(Default)]
struct StateSystems {
    known: Vec<(StateChoice, Arc<ExecutableSystem>)>,
    present: Option<(StateChoice, Arc<ExecutableSystem>)>,
}

impl StateSystems {
    /// Goes on with other states if there are any, else with these as long as it lasts.
    fn choose(&mut self, choice: &StateChoice, control: &mut Control<'_>) {
        let found = self.known.iter().find(|(known, _)| known == choice).map(|(_, system)| system.clone());
        let found = found.or_else(|| {
            let made = control.reselect.as_mut().and_then(|analyze| analyze(choice))?;
            self.known.push((choice.clone(), made.clone()));
            Some(made)
        });
        match found {
            Some(next) => self.present = Some((choice.clone(), next)),
            None => control.reselect = None,
        }
    }
}

/// A run in parts: each ends at a checkpoint, or where other states are needed.
struct SegmentedRun<'a> {
    system: &'a ExecutableSystem,
    settings: &'a Settings,
    inputs: &'a [RecordedInput],
    states: StateSystems,
    /// Checkpoints made.
    number: u64,
}

impl SegmentedRun<'_> {
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

    /// From the end of the first part to the end of the run.
    fn complete(mut self, mut leg: driver::RunSegment, sink: &mut dyn RowSink, control: &mut Control<'_>) -> RunResult {
        while let Some(switch) = leg.switch.take() {
            match &switch.choice {
                Some(choice) => self.states.choose(choice, control),
                None => {
                    self.number += 1;
                    let at = self.checkpoint(&leg.run, &switch.grid, control);
                    if sink.checkpoint(&at).is_break() {
                        return RunResult { end: End::Interrupted, ..leg.run };
                    }
                }
            }
            let before = leg.run;
            leg = self.leg(driver::RunOrigin::Switch(&before.state, switch.grid), sink, control);
            leg.run.statistics.add(&before.statistics);
            // a warning is said once
            let said = |d: &Diagnostic| before.diagnostics.iter().any(|b| b.code == d.code && b.labels == d.labels);
            leg.run.diagnostics.retain(|d| d.is_error() || !said(d));
            leg.run.diagnostics.splice(0..0, before.diagnostics);
        }
        leg.run
    }

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
