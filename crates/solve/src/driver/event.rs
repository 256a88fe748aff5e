//! What happens at an event: causes, iteration, assertions, and how the integrator goes on.

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
    /// Runs the event iteration and puts root functions on the right side.
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
        self.keep_open();
        outcome.refused = self.modes.refused(&model.values);
        self.modes.release();
        if !model.roots.is_empty() {
            system.crossings_from(&mut model.values, model.roots.raw());
            model.roots.settle(system, &mut self.modes, &model.values);
        }
        self.next_crossing = next_time_crossing(system, &model.values, t);
        Ok(outcome)
    }

    /// What an event left open keeps its value until the next one. A warning says so once.
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

    /// Assertions and `terminate` of an event whose rows are out.
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

    /// An event where the integrator stands; what has crossed is noted already.
    pub(super) fn event(&mut self, cause: EventCause) -> StopResult {
        self.statistics.events += 1;
        let crossing = self.first_crossing(cause);
        let t = self.t;
        self.last_step = self.ida().step_lengths().0;
        self.take_tangents();
        let outcome = self.with_model(|driver, model, y, yp| {
            let (y, yp) = driver.algebraic.solve(model, t, y, yp);
            model.observe(t, y, yp);
            driver.restart.before(driver.system, &mut model.values, y);
            driver.continuity.remember(&model.values);
            if driver.carried.is_some() {
                let (y, yp) = (y.to_vec(), yp.to_vec());
                driver.tangents_before(model, cause, &y)?;
                model.observe(t, &y, &yp);
            }
            let recorded = driver.settings.event_rows && driver.grid.records_event();
            if recorded {
                driver.tangent_cells(model);
                driver.write_row(model)?;
            }
            let before = model.sources();
            driver.prepare_event(model, cause);
            let ready = driver.ready(model);
            let outcome = driver.iterate(model, cause)?;
            if !outcome.reinitialised
                && let Some(jump) = driver.continuity.jump(&model.values)
            {
                return Err(EarlyStop::new(End::StepTooSmall, report::jump(driver.system, t, &jump)));
            }
            driver.restart.gather(driver.system, &mut model.values);
            driver.remember_event(model, cause, &outcome, &before);
            driver.tangents_after(model, &outcome, ready)?;
            if recorded || same_time(driver.grid.next(), t) {
                driver.tangent_cells(model);
                driver.write_row(model)?;
            }
            driver.grid.pass(t);
            Ok(outcome)
        })?;
        self.with_model(|driver, model, _, _| driver.judge(model, &outcome))?;
        if cause != EventCause::Terminal {
            self.go_on(cause, &outcome)?;
            let span = self.settings.stop_time - self.settings.start_time;
            let upwards = self.roots.iter().find(|d| **d != 0).is_some_and(|d| *d > 0);
            if self.accumulation.note(span, t, crossing.map(|c| (c, upwards)))
                && let Some(c) = crossing
            {
                let distance = self.with_model(|driver, model, _, _| driver.distance(c, &model.values));
                self.accumulation.stands(distance);
            }
            if self.chatter.note(t, crossing) {
                return Err(EarlyStop::new(End::Chattering, self.chatter.report(self.system, t)));
            }
        }
        self.look_outside()
    }

    /// Says that not every event has rows.
    pub(super) fn note_thinned(&mut self) {
        let Some(recorded) = self.grid.thinned() else { return };
        let text = format!("not every event has rows: of each output interval the first {recorded} have");
        self.diagnostics.push(
            Diagnostic::new(Code::EventsThinned, text)
                .note("events follow each other so closely that their rows would fill the disk")
                .help("`--event-rows all` records every event, `--event-rows none` only the rows of the grid"),
        );
    }

    /// Notes which root functions have crossed.
    pub(super) fn find_roots(&mut self) {
        let mut roots = std::mem::take(&mut self.roots);
        roots.clear();
        roots.extend_from_slice(self.ida().found());
        self.roots = roots;
    }

    /// The first crossing among those that cause the event.
    fn first_crossing(&mut self, cause: EventCause) -> Option<u32> {
        if cause != EventCause::Root {
            self.roots.clear();
        }
        let first = self.roots.iter().position(|&d| d != 0)?;
        u32::try_from(self.ida().equations().roots.crossing(first)).ok()
    }

    /// What the event's cause changes at once.
    pub(super) fn prepare_event(&mut self, model: &mut IntegrationModel<'a>, cause: EventCause) {
        let t = self.t;
        let IntegrationModel { values, playback, roots, .. } = model;
        match cause {
            EventCause::Root => {
                for (function, &direction) in self.roots.iter().enumerate().filter(|(_, d)| **d != 0) {
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

    /// Continues after an event: with the integrator's past where it is still true, else afresh.
    pub(super) fn go_on(&mut self, cause: EventCause, outcome: &EventOutcome) -> StopResult {
        let t = self.t;
        let next = self.next_stop();
        let open = self.events.kept().is_some();
        let ida = self.ida.as_mut().expect("made before the first step");
        ida.may_keep(open);
        // what was seen crossed in the integrator's past would never be seen again
        let serves = !outcome.reinitialised
            && !outcome.refused
            && match cause {
                EventCause::Root => self.restart.past_serves_ahead(ida, t, outcome.changed),
                _ => self.restart.past_serves(ida, t, next),
            };
        if serves && self.tangents_go_on() {
            return Ok(());
        }
        self.restart.remember_step(self.ida.as_ref().expect("made before the first step"));
        self.statistics.restarts += 1;
        self.first_step(cause).then_some(()).ok_or_else(|| self.refused(&IdaFailure::Code(0)))
    }

    /// Restarts from the gathered values with a first step of sensible length; false when IDA refuses.
    pub(super) fn first_step(&mut self, cause: EventCause) -> bool {
        let t = self.t;
        let room = self.next_stop() - t;
        let ida = self.ida.as_mut().expect("made before the first step");
        let (start, root) = (cause == EventCause::Start, cause == EventCause::Root);
        if std::mem::take(&mut self.tests_states_only) && ida.leave_out(&[]).is_err() {
            return false;
        }
        let longest = self.settings.longest_step.min(ida.watch().playback.delays.longest_step());
        self.restart.restart(ida, t, room, longest, start, root) && (start || self.hand_over_tangents(false))
    }
}
