//! What delays will read: recorded step by step, and at events.

use super::{Driver, EventCause};
use crate::events::EventOutcome;
use crate::model::IntegrationModel;
use crate::past::points;

impl<'a> Driver<'a, '_> {
    /// Where the integrator has to be asked before it is asked for what lies at `target`: at the end of its last step,
    /// for a further one makes it forget what that step was.
    pub(super) fn unrecorded(&mut self, target: f64) -> Option<f64> {
        let t = self.t;
        let ida = self.ida();
        let end = ida.internal_time();
        (!ida.equations().playback.delays.is_empty() && end > t && end < target).then_some(end)
    }

    /// Records the trajectory of what is delayed from where it is known to where the run stands, all within one step.
    pub(super) fn remember(&mut self) {
        let to = self.t;
        let Some(from) = self.ida().equations().playback.delays.known_to().filter(|from| *from < to) else { return };
        let mut rows = Vec::new();
        for t in points(from, to) {
            let (mut y, mut yp) = (Vec::new(), Vec::new());
            let known = self.ida().at(t, &mut y, &mut yp);
            debug_assert!(known, "within the last step");
            rows.push(self.with_model(|driver, model, _, _| {
                let (y, yp) = driver.algebraic.solve(model, t, &y, &yp);
                model.observe(t, y, yp);
                model.sources()
            }));
        }
        self.ida().equations().playback.delays.remember(from, to, &rows);
    }

    /// Records that an event took what is delayed from these values to those of the model.
    pub(super) fn remember_event(
        &mut self,
        model: &mut IntegrationModel<'a>,
        cause: EventCause,
        outcome: &EventOutcome,
        before: &[f64],
    ) {
        if before.is_empty() || !(cause == EventCause::Time || outcome.changed || outcome.reinitialised) {
            return;
        }
        let after = model.sources();
        model.playback.delays.event(self.t, before, &after, self.settings.tolerance);
    }

    /// At a time that no step passes.
    pub(super) fn remember_bend(&mut self) {
        let t = self.t;
        self.with_model(|driver, model, y, yp| {
            if !model.playback.delays.is_empty() {
                let (y, yp) = driver.algebraic.solve(model, t, y, yp);
                model.observe(t, y, yp);
                let sources = model.sources();
                model.playback.delays.pass(t, &sources);
            }
        });
    }
}
