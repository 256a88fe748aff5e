//! Consistent values at single points in time, without integrating between them: the start, and any state after that.

use super::events::{EventFailure, Events};
use super::modes::Modes;
use super::newton::Scales;
use super::settings::Settings;
use super::{initialize, report};
use crate::lower::{Layout, System};
use bramah_expr::VarId;
use bramah_syntax::diag::{Code, Diagnostic};
use std::sync::Arc;

/// A system with values that satisfy all its equations at one time.
#[derive(Debug)]
pub struct Point {
    system: Arc<System>,
    scales: Scales,
    modes: Modes,
    events: Events,
    /// All values, by the slots of `System::layout`.
    pub values: Vec<f64>,
}

impl Point {
    /// Solves the initial system at `time`, with these values of parameters.
    ///
    /// # Errors
    /// When the initial system, or the events at the start, cannot be solved (E400 and those after it).
    pub fn start(system: Arc<System>, time: f64, parameters: Vec<(VarId, f64)>) -> Result<Self, Box<Diagnostic>> {
        let settings = Settings { start_time: time, parameters, ..Settings::default() };
        let mut values = initialize::prepare(&system, &settings);
        let scales = Scales::new(&system, &values);
        let mut modes = Modes::new(&system, settings.tolerance);
        initialize::solve(&system, &scales, &mut modes, &mut values)
            .map_err(|f| report::block_failure(&system, Code::InitialFailed, &f, &values, "at the start"))?;
        let events = Events::new(&system, &scales, &modes);
        events.settle_pre(&mut values);
        let mut point = Point { system, scales, modes, events, values };
        point.settle(time)?;
        Ok(point)
    }

    /// The system.
    pub fn system(&self) -> &Arc<System> {
        &self.system
    }

    /// The usual size of a variable, positive.
    pub fn nominal(&self, v: VarId) -> f64 {
        self.scales.nominal[v.index()]
    }

    /// Computes everything that follows from time, states and inputs in `values`, discrete variables included.
    ///
    /// # Errors
    /// When an algebraic loop has no solution there, or discrete values contradict each other.
    pub fn settle(&mut self, time: f64) -> Result<(), Box<Diagnostic>> {
        self.values[Layout::TIME] = time;
        let Point { system, scales, modes, events, values } = self;
        events.iterate(system, scales, modes, values).map(|_| ()).map_err(|failure| {
            let when = format!("at time {} s", report::number(time));
            Box::new(match failure {
                EventFailure::Blocks(f) => report::block_failure(system, Code::EventFailed, &f, values, &when),
                EventFailure::Endless(v) => report::changing(system, Code::EventFailed, &v, &when),
            })
        })
    }
}
