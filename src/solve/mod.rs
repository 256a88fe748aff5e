//! From a lowered system to a trajectory: initialization, integration by SUNDIALS IDA, events.
//!
//! [`simulate`] is the entry. A run that fails returns what it has and says why in its diagnostics.

mod algebraic;
mod blocks;
pub(crate) mod driver;
mod events;
pub mod ida;
mod initialize;
mod inputs;
pub mod linear;
mod model;
mod modes;
mod monitor;
mod newton;
mod output;
mod point;
mod report;
mod restart;
mod schedule;
mod selection;
mod settings;
mod state;

pub use inputs::{Input, Interpolation};
pub use output::{Sink, signals};
pub use point::Point;
pub use settings::{End, Settings, Statistics};
pub use state::State;

use crate::diag::Diagnostic;
use crate::lower::System;
use crate::structure::StateChoice;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

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
    pub progress: Option<&'a mut dyn FnMut(&Progress) -> bool>,
    /// Analyses the model anew with other states, when those chosen have become singular. Called once for each choice.
    pub reselect: Option<&'a mut dyn FnMut(&StateChoice) -> Option<Arc<System>>>,
}

/// What a run came to. The rows are in the sink.
#[derive(Clone, Debug)]
pub struct Run {
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
/// Where the chosen states become singular and `control.reselect` is given, the run goes on with others.
pub fn simulate(
    system: &System,
    settings: &Settings,
    inputs: &[Input],
    from: Option<&State>,
    sink: &mut dyn Sink,
    control: &mut Control<'_>,
) -> Run {
    let mut leg = driver::run(system, settings, inputs, from.map(driver::From::State), sink, control);
    let mut known: Vec<(StateChoice, Arc<System>)> = Vec::new();
    let mut present: Option<Arc<System>> = None;
    while let Some(switch) = leg.switch.take() {
        let found = known.iter().find(|(choice, _)| *choice == switch.choice).map(|(_, system)| system.clone());
        let found = found.or_else(|| {
            let made = control.reselect.as_mut().and_then(|analyze| analyze(&switch.choice))?;
            known.push((switch.choice.clone(), made.clone()));
            Some(made)
        });
        match found {
            Some(next) => present = Some(next),
            // no other states: go on with these as long as it lasts
            None => control.reselect = None,
        }
        let before = leg.run;
        let from = driver::From::Switch(&before.state, switch.grid);
        leg = driver::run(present.as_deref().unwrap_or(system), settings, inputs, Some(from), sink, control);
        leg.run.statistics.add(&before.statistics);
        leg.run.diagnostics.splice(0..0, before.diagnostics);
    }
    leg.run
}

#[cfg(test)]
mod tests;
