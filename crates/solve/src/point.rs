//! Consistent values at single times, without integration: at the start, and at any states given later.
//!
//! The analyses (linear models, operating points) set states and inputs and read derivatives.

use super::events::{EventFailure, EventHandler};
use super::modes::CrossingModes;
use super::newton::VariableScales;
use super::settings::Settings;
use super::{initialize, report};
use crate::lower::{ExecutableSystem, ValueLayout};
use bramah_expr::VarId;
use bramah_syntax::diag::{Code, Diagnostic};
use std::sync::Arc;

/// A system with values that satisfy all its equations at one time.
#[derive(Debug)]
pub struct ConsistentPoint {
    /// The lowered model.
    system: Arc<ExecutableSystem>,
    /// Sizes and bounds of all variables.
    scales: VariableScales,
    /// Modes of crossings.
    modes: CrossingModes,
    /// The event iteration.
    events: EventHandler,
    /// All values, by the slots of `ExecutableSystem::layout`.
    pub values: Vec<f64>,
}

impl ConsistentPoint {
    /// Solves the initial system at `time` in seconds, with these values of parameters.
    ///
    /// # Errors
    /// The initial system or the events at the start cannot be solved (E400 and following).
    pub fn start(
        system: Arc<ExecutableSystem>,
        time: f64,
        parameters: Vec<(VarId, f64)>,
    ) -> Result<Self, Box<Diagnostic>> {
        let settings = Settings { start_time: time, parameters, ..Settings::default() };
        let mut values = initialize::prepare(&system, &settings);
        let scales = VariableScales::new(&system, &values);
        let mut modes = CrossingModes::new(&system, settings.tolerance);
        initialize::solve(&system, &scales, &mut modes, &mut values)
            .map_err(|f| report::block_failure(&system, Code::InitialFailed, &f, &values, "at the start"))?;
        let events = EventHandler::new(&system, &scales, &modes);
        events.settle_pre(&mut values);
        let mut point = ConsistentPoint { system, scales, modes, events, values };
        point.settle(time)?;
        Ok(point)
    }

    /// The lowered model.
    pub fn system(&self) -> &Arc<ExecutableSystem> {
        &self.system
    }

    /// The nominal value of a variable, positive.
    pub fn nominal(&self, v: VarId) -> f64 {
        self.scales.nominal[v.index()]
    }

    /// Computes everything that follows from time, states and inputs in `values`, including discrete variables.
    ///
    /// # Errors
    /// An algebraic loop has no solution there, or discrete values contradict each other.
    pub fn settle(&mut self, time: f64) -> Result<(), Box<Diagnostic>> {
        self.values[ValueLayout::TIME] = time;
        let ConsistentPoint { system, scales, modes, events, values } = self;
        events.iterate(system, scales, modes, values).map(|_| ()).map_err(|failure| {
            let when = format!("at time {} s", report::number(time));
            Box::new(match failure {
                EventFailure::Blocks(f) => report::block_failure(system, Code::EventFailed, &f, values, &when),
                EventFailure::Endless(v) => report::changing(system, Code::EventFailed, &v, &when),
            })
        })
    }
}
