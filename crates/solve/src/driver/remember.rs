//! Recording of the values that `delay` reads later, step by step and at events.
//!
//! `legs` calls `remember` after each return of IDA, `event` calls `remember_event`. The history itself is in `past`.

use super::{Driver, EventCause};
use crate::events::EventOutcome;
use crate::model::IntegrationModel;
use crate::past::points;

impl<'a> Driver<'a, '_> {
    /// The end of IDA's last step, if it must be recorded before IDA is asked for `target`.
    ///
    /// A further step makes IDA forget the interpolation of the last one. `None` where no delay exists or where the
    /// last step is recorded.
    pub(super) fn unrecorded(&mut self, target: f64) -> Option<f64> {
        let t = self.t;
        let ida = self.ida();
        let end = ida.internal_time();
        (!ida.equations().playback.delays.is_empty() && end > t && end < target).then_some(end)
    }

    /// Records delayed expressions from where they are known up to the present time, which lies within the same step.
    ///
    /// The trajectory is evaluated at the points of one piece of the history, with IDA's interpolation of the states.
    pub(super) fn remember(&mut self) {
        let to = self.t;
        let Some(from) = self.ida().equations().playback.delays.known_to().filter(|from| *from < to) else { return };
        let mut rows = Vec::new();
        for t in points(from, to) {
            let (mut y, mut yp) = (Vec::new(), Vec::new());
            let known = self.ida().at(t, &mut y, &mut yp);
            debug_assert!(known, "within the last step");
            rows.push(self.with_model(|driver, model, _, _| {
                // delayed algebraic variables must satisfy their equations, which interpolated values do not
                let (y, yp) = driver.algebraic.solve(model, t, &y, &yp);
                model.observe(t, y, yp);
                model.sources()
            }));
        }
        self.ida().equations().playback.delays.remember(from, to, &rows);
    }

    /// Records a jump of delayed expressions at an event, from the values `before` to those of the model.
    ///
    /// A root that changed no discrete value and set no state leaves the trajectory smooth, and is not recorded.
    pub(super) fn remember_event(
        &mut self,
        model: &mut IntegrationModel<'a>,
        cause: EventCause,
        outcome: &EventOutcome,
        before: &[f64],
    ) {
        // no delays, or an event that changed nothing
        if before.is_empty() || !(cause == EventCause::Time || outcome.changed || outcome.reinitialised) {
            return;
        }
        let after = model.sources();
        model.playback.delays.event(self.t, before, &after, self.settings.tolerance);
    }

    /// Records a kink at the present time, which no integration step passes.
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
