//! A run that is taken further from outside, step by step, with inputs set in between.

use super::{Driver, EventCause, StopResult};
use crate::{State, Statistics};
use bramah_syntax::diag::Diagnostic;

impl Driver<'_, '_> {
    /// Where the run stands, in seconds.
    pub fn time(&self) -> f64 {
        self.t
    }

    /// The value in a slot, as last observed.
    pub fn value(&self, slot: usize) -> f64 {
        self.ida.as_ref().map_or(f64::NAN, |ida| ida.watch().values[slot])
    }

    /// Sets input slots, lets everything that depends on them react at once, as at an event, integrates to `t`, which
    /// lies ahead, and observes all variables there.
    ///
    /// # Errors
    /// As a run that ends before.
    pub fn advance(&mut self, inputs: &[(usize, f64)], t: f64) -> StopResult {
        self.go_to(inputs, t).map_err(|stop| stop.with_troubles(self.system))
    }

    fn go_to(&mut self, inputs: &[(usize, f64)], t: f64) -> StopResult {
        // first: whether the integrator's past still serves depends on how far the next step may go
        self.until = t;
        let model = self.ida().equations();
        inputs.iter().for_each(|&(slot, _)| model.playback.release(slot));
        let values = &model.values;
        if inputs.iter().any(|&(slot, value)| values[slot] != value) {
            self.pending.clear();
            self.pending.extend_from_slice(inputs);
            self.event(EventCause::Time)?;
        }
        self.reach()?;
        self.observe();
        Ok(())
    }

    /// Fills the slots of all variables where the run stands.
    pub fn observe(&mut self) {
        let t = self.t;
        self.with_model(|driver, model, y, yp| {
            let (y, yp) = driver.algebraic.solve(model, t, y, yp);
            model.observe(t, y, yp);
        });
    }

    /// Everything needed to go on from here.
    pub fn state(&mut self) -> State {
        let (system, t) = (self.system, self.t);
        let model = self.ida().equations();
        State::save(system, t, &model.values, model.playback.delays.past().clone())
    }

    /// Work done so far; no seconds.
    pub fn statistics(&mut self) -> Statistics {
        self.count_work();
        self.statistics
    }

    /// Takes the warnings since the last time.
    pub fn warnings(&mut self) -> Vec<Diagnostic> {
        std::mem::take(&mut self.diagnostics)
    }
}
