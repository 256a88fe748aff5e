//! Stepping from outside: the caller sets inputs, advances the time, and reads values and state.
//!
//! These are the methods of a [`Driver`] made by [`super::start`]. The `circuit` crate builds its `Stepping` on them.

use super::{Driver, EventCause, StopResult};
use crate::{State, Statistics};
use bramah_syntax::diag::Diagnostic;

impl Driver<'_, '_> {
    /// Present time in seconds.
    pub fn time(&self) -> f64 {
        self.t
    }

    /// The value in a slot as last observed; NaN before the integrator exists.
    pub fn value(&self, slot: usize) -> f64 {
        self.ida.as_ref().map_or(f64::NAN, |ida| ida.watch().values[slot])
    }

    /// Sets input slots, integrates to `t`, and observes all variables there.
    ///
    /// A changed input is an event at the present time. `t` must lie ahead of the present time.
    ///
    /// # Errors
    /// The run ended before `t`.
    pub fn advance(&mut self, inputs: &[(usize, f64)], t: f64) -> StopResult {
        self.go_to(inputs, t).map_err(|stop| stop.with_troubles(self.system))
    }

    /// As [`Driver::advance`], without the messages of external functions.
    fn go_to(&mut self, inputs: &[(usize, f64)], t: f64) -> StopResult {
        // first, because whether IDA's past is still valid depends on how far the next step may go
        self.until = t;
        let model = self.ida().equations();
        // an input set by the caller is no longer played back from its recording
        inputs.iter().for_each(|&(slot, _)| model.playback.release(slot));
        let values = &model.values;
        // equal values cost no event and no restart
        if inputs.iter().any(|&(slot, value)| values[slot] != value) {
            self.pending.clear();
            self.pending.extend_from_slice(inputs);
            self.event(EventCause::Time)?;
        }
        self.reach()?;
        self.observe();
        Ok(())
    }

    /// Computes all variables at the present time into their slots.
    pub fn observe(&mut self) {
        let t = self.t;
        self.with_model(|driver, model, y, yp| {
            let (y, yp) = driver.algebraic.solve(model, t, y, yp);
            model.observe(t, y, yp);
        });
    }

    /// The state from which another run can continue at the present time.
    pub fn state(&mut self) -> State {
        let (system, t) = (self.system, self.t);
        let model = self.ida().equations();
        State::save(system, t, &model.values, model.playback.delays.past().clone())
    }

    /// Counts of the work done so far. The seconds in it are not measured here.
    pub fn statistics(&mut self) -> Statistics {
        self.count_work();
        self.statistics
    }

    /// Removes and returns the warnings recorded since the last call.
    pub fn warnings(&mut self) -> Vec<Diagnostic> {
        std::mem::take(&mut self.diagnostics)
    }
}
