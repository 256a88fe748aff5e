//! Handling of one event: its causes, the event iteration, assertions, and how the integrator continues.
//!
//! `legs` stops the integrator at a root, a known time or the end and calls `Driver::event`. The event iteration (MLS
//! 8.6) solves the event system until no `pre` value changes. Rows just before and just after the event are written
//! where the settings ask for them. IDA then keeps its past where that is still valid, or restarts with order 1.

use super::{Driver, EarlyStop, EventCause, StopResult};
use crate::events::{EventFailure, EventOutcome};
use crate::ida::IdaFailure;
use crate::lower::ValueLayout;
use crate::model::IntegrationModel;
use crate::modes::same_time;
use crate::report;
use crate::schedule::next_time_crossing;
use crate::settings::End;
use bramah_model::structure::EventActionKind;
use bramah_syntax::diag::{Code, Diagnostic};

impl<'a> Driver<'a, '_> {
    /// Runs the event iteration at the present time and puts every root function on its side of zero.
    ///
    /// `model.values` must hold the values just before the event, with the effects of `cause` applied. They hold the
    /// values after it on return. `Err` when a block has no solution, or when discrete values change from pass to pass
    /// without end.
    pub(super) fn iterate(
        &mut self,
        model: &mut IntegrationModel<'a>,
        cause: EventCause,
    ) -> Result<EventOutcome, EarlyStop> {
        let (system, t) = (self.system, self.t);
        let mut outcome =
            self.events.iterate(system, &self.scales, &self.modes, &mut model.values).map_err(|failure| {
                let when = match cause {
                    EventCause::Start => "at the start".to_string(),
                    _ => format!("at the event at time {} s", report::number(t)),
                };
                let diagnostic = match failure {
                    EventFailure::Blocks(f) => {
                        report::block_failure(system, Code::EventFailed, &f, &model.values, &when)
                    }
                    EventFailure::Endless(variables) => report::changing(system, Code::EventFailed, &variables, &when),
                };
                let end = match diagnostic.code {
                    Code::NonFinite => End::NonFinite,
                    _ => End::StepTooSmall,
                };
                EarlyStop::new(end, diagnostic)
            })?;
        // the Jacobians used until the next event must be as permissive as those of the event system
        self.keep_open();
        outcome.refused = self.modes.refused(&model.values);
        // forced modes apply to this event only
        self.modes.release();
        // root functions start from the new values, so that IDA does not find the same crossing again
        if !model.roots.is_empty() {
            system.crossings_from(&mut model.values, model.roots.raw());
            model.roots.settle(system, &mut self.modes, &model.values);
        }
        self.next_crossing = next_time_crossing(system, &model.values, t);
        Ok(outcome)
    }

    /// Lets unknowns that the event system leaves undetermined keep their value until the next event.
    ///
    /// All factorizations of the run must then allow it: those of the algebraic solver and of the sensitivities here,
    /// that of IDA in `go_on`. A warning reports the first such unknown of a run.
    fn keep_open(&mut self) {
        let kept = self.events.kept();
        self.algebraic.may_keep(kept.is_some());
        if let Some(carried) = &mut self.carried {
            carried.may_keep(kept.is_some());
        }
        if let Some((switches, unknown)) = kept
            && self.reported.first_shared()
        {
            let warning = report::shared_load(self.system, switches, unknown, self.t);
            self.diagnostics.push(warning);
        }
    }

    /// Handles assertions and `terminate` of an event, after its rows are written.
    ///
    /// `Err` ends the run: an assertion of level error does not hold, or the model called `terminate`.
    pub(super) fn judge(&mut self, model: &mut IntegrationModel<'a>, outcome: &EventOutcome) -> StopResult {
        for (action, text) in &outcome.failed {
            if let EventActionKind::Assert(assert) = &self.system.dae.actions[*action].kind {
                let first = self.reported.first_action(*action);
                self.assertion(assert.warning, first, assert.origin, text)?;
            }
        }
        self.check_asserts(model)?;
        match &outcome.terminate {
            Some(message) => Err(EarlyStop { end: End::Terminated(message.clone()), diagnostics: Vec::new() }),
            None => Ok(()),
        }
    }

    /// Checks all assertions outside `when`, with all explicit variables that they read.
    ///
    /// The slots of the unknowns must be loaded. Called at events and at rows of the grid.
    pub(super) fn check_asserts(&mut self, model: &mut IntegrationModel<'a>) -> StopResult {
        let system = self.system;
        if system.dae.asserts.is_empty() {
            return Ok(());
        }
        system.asserts.program.run(&mut model.values);
        for (i, assert) in system.dae.asserts.iter().enumerate() {
            if model.values[system.asserts.holds[i]] == 0.0 {
                let first = self.reported.first(i);
                let text = report::message_text(system, &assert.message, &model.values);
                self.assertion(assert.warning, first, assert.origin, &text)?;
            }
        }
        Ok(())
    }

    /// Reports an assertion that does not hold.
    ///
    /// An error (`warning` is false) ends the run. A warning is recorded when it is the `first` one of this assertion.
    pub(super) fn assertion(
        &mut self,
        warning: bool,
        first: bool,
        origin: bramah_model::flat::ElementOrigin,
        text: &str,
    ) -> StopResult {
        let code = if warning { Code::AssertionWarning } else { Code::AssertionFailed };
        let text = format!("{text} (at time {} s)", report::number(self.t));
        let diagnostic = report::at_origin(&self.system.dae, code, text, origin, "does not hold").advised();
        if !warning {
            return Err(EarlyStop::new(End::Assertion, diagnostic));
        }
        if first {
            self.diagnostics.push(diagnostic);
        }
        Ok(())
    }

    /// Handles an event at the present time.
    ///
    /// For `EventCause::Root` the directions of the root functions are in `self.roots`. The order is: values before the
    /// event, row, direct effects of the cause, event iteration, sensitivities, row, assertions, restart of IDA.
    pub(super) fn event(&mut self, cause: EventCause) -> StopResult {
        self.statistics.events += 1;
        // also removes the directions of an earlier root
        let crossing = self.first_crossing(cause);
        let t = self.t;
        self.last_step = self.ida().step_lengths().0;
        self.take_tangents();
        // the values just before the event: row, `pre` values and sensitivities refer to them
        let outcome = self.with_model(|driver, model, y, yp| {
            let (y, yp) = driver.algebraic.solve(model, t, y, yp);
            model.observe(t, y, yp);
            driver.restart.before(driver.system, &mut model.values, y);
            driver.continuity.remember(&model.values);
            // the sensitivities evaluate the equations at other points, so the values are restored after them
            if driver.carried.is_some() {
                let (y, yp) = (y.to_vec(), yp.to_vec());
                driver.tangents_before(model, cause, &y)?;
                model.observe(t, &y, &yp);
            }
            // where events are dense, only the first ones of each output interval have rows
            let recorded = driver.settings.event_rows && driver.grid.records_event();
            if recorded {
                driver.tangent_cells(model);
                driver.write_row(model)?;
            }
            let before = model.sources();
            driver.prepare_event(model, cause);
            // values and modes before the iteration, so that the sensitivities can repeat it nearby
            let ready = driver.ready(model);
            let outcome = driver.iterate(model, cause)?;
            // a jump of a differentiated variable without `reinit` needs an impulse that no equation contains
            if !outcome.reinitialised
                && let Some(jump) = driver.continuity.jump(&model.values)
            {
                return Err(EarlyStop::new(End::StepTooSmall, report::jump(driver.system, t, &jump)));
            }
            driver.restart.gather(driver.system, &mut model.values);
            driver.remember_event(model, cause, &outcome, &before);
            driver.tangents_after(model, &outcome, ready)?;
            // a row due at the event shows the values after it
            if recorded || same_time(driver.grid.next(), t) {
                driver.tangent_cells(model);
                driver.write_row(model)?;
            }
            driver.grid.pass(t);
            Ok(outcome)
        })?;
        // rows come first, so that the trajectory shows what the assertion or `terminate` refers to
        self.with_model(|driver, model, _, _| driver.judge(model, &outcome))?;
        if cause != EventCause::Terminal {
            self.go_on(cause, &outcome)?;
            let span = self.settings.stop_time - self.settings.start_time;
            // direction of the crossing that caused the event, for the detection of impacts
            let upwards = self.roots.iter().find(|d| **d != 0).is_some_and(|d| *d > 0);
            // event times that get closer and closer, like those of a bouncing ball
            if self.accumulation.note(span, t, crossing.map(|c| (c, upwards)))
                && let Some(c) = crossing
            {
                let distance = self.with_model(|driver, model, _, _| driver.distance(c, &model.values));
                self.accumulation.stands(distance);
            }
            // too many events in a short time end the run
            if self.chatter.note(t, crossing) {
                return Err(EarlyStop::new(End::Chattering, self.chatter.report(self.system, t)));
            }
        }
        self.look_outside()
    }

    /// Adds a diagnostic when some events have no rows because too many of them lie between two rows of the grid.
    pub(super) fn note_thinned(&mut self) {
        let Some(recorded) = self.grid.thinned() else { return };
        let text = format!("not every event has rows: of each output interval the first {recorded} have");
        self.diagnostics.push(
            Diagnostic::new(Code::EventsThinned, text)
                .note("events follow each other so closely that their rows would fill the disk")
                .help("`--event-rows all` records every event, `--event-rows none` only the rows of the grid"),
        );
    }

    /// Copies the directions of the crossings that IDA has found into `self.roots`, one entry per root function.
    pub(super) fn find_roots(&mut self) {
        let mut roots = std::mem::take(&mut self.roots);
        roots.clear();
        roots.extend_from_slice(self.ida().found());
        self.roots = roots;
    }

    /// The first crossing that caused the event, as an index into `Dae::crossings`.
    ///
    /// `None` for events without a root. Their stale directions are removed.
    fn first_crossing(&mut self, cause: EventCause) -> Option<u32> {
        // directions of an earlier root must not be handled again
        if cause != EventCause::Root {
            self.roots.clear();
        }
        let first = self.roots.iter().position(|&d| d != 0)?;
        u32::try_from(self.ida().equations().roots.crossing(first)).ok()
    }

    /// Applies the direct effects of the cause: forced modes, samples, jumps of inputs, `terminal()`.
    ///
    /// Everything else follows in the event iteration.
    pub(super) fn prepare_event(&mut self, model: &mut IntegrationModel<'a>, cause: EventCause) {
        let t = self.t;
        let IntegrationModel { values, playback, roots, .. } = model;
        match cause {
            EventCause::Root => {
                for (function, &direction) in self.roots.iter().enumerate().filter(|(_, d)| **d != 0) {
                    // at the root the function is zero only up to rounding: IDA's direction decides about the side
                    self.modes.force(self.system, roots.crossing(function), direction, values);
                }
            }
            EventCause::Terminal => values[ValueLayout::TERMINAL] = 1.0,
            EventCause::Time => {
                playback.seek(t, values);
                let events = &self.events;
                self.clocks.ring(t, |i| events.raise(i, values));
                for (slot, value) in self.pending.drain(..) {
                    values[slot] = value;
                }
            }
            EventCause::Start => {}
        }
    }

    /// Continues after an event: with IDA's past where it is still valid, otherwise by a restart with order 1.
    ///
    /// A restart costs several small steps, so that keeping the past matters for models with many samples.
    pub(super) fn go_on(&mut self, cause: EventCause, outcome: &EventOutcome) -> StopResult {
        let t = self.t;
        let next = self.next_stop();
        let open = self.events.kept().is_some();
        let ida = self.ida.as_mut().expect("made before the first step");
        ida.may_keep(open);
        // A crossing that IDA's interpolation shows as passed, but that the event has not accepted, would not be found
        // again.
        let serves = !outcome.reinitialised
            && !outcome.refused
            && match cause {
                EventCause::Root => self.restart.past_serves_ahead(ida, t, outcome.changed),
                _ => self.restart.past_serves(ida, t, next),
            };
        // the interpolation of the sensitivities must be valid too
        if serves && self.tangents_go_on() {
            return Ok(());
        }
        self.restart.remember_step(self.ida.as_ref().expect("made before the first step"));
        self.statistics.restarts += 1;
        self.first_step(cause).then_some(()).ok_or_else(|| self.refused(&IdaFailure::Code(0)))
    }

    /// Restarts IDA from the gathered values and chooses the first step; false when IDA refuses.
    ///
    /// At the start of a run IDA is new and is not restarted.
    pub(super) fn first_step(&mut self, cause: EventCause) -> bool {
        let t = self.t;
        let room = self.next_stop() - t;
        let ida = self.ida.as_mut().expect("made before the first step");
        let (start, root) = (cause == EventCause::Start, cause == EventCause::Root);
        // a new piece of the solution: the error test covers all unknowns again
        if std::mem::take(&mut self.tests_states_only) && ida.leave_out(&[]).is_err() {
            return false;
        }
        let longest = self.settings.longest_step.min(ida.watch().playback.delays.longest_step());
        self.restart.restart(ida, t, room, longest, start, root) && (start || self.hand_over_tangents(false))
    }
}
