//! Runs of a model along recordings, sampled at the times of the measurements.
//!
//! A recording becomes [`RunInputs`]; a [`ModelRunner`] runs the model along them and returns columns of values at the
//! samples, for the output error.

use crate::study::{BoundStudy, Recording};
use bramah_circuit::compiled::CompiledModel;
use bramah_expr::VarId;
use bramah_model::structure::StateChoice;
use bramah_solve::{self as solve, Control, End, RecordedInput, RowSink, Settings, State};
use std::ops::ControlFlow;
use std::sync::Arc;

/// The inputs of a recording and the times at which values are needed.
#[derive(Clone, Debug)]
pub struct RunInputs {
    /// Times of the samples in seconds.
    pub times: Arc<[f64]>,
    /// The driven inputs over the whole recording.
    pub inputs: Vec<RecordedInput>,
    /// Distance of the output rows of a run: the median distance of the samples.
    pub interval: f64,
}

impl RunInputs {
    /// The inputs of a recording, as the study binds them.
    pub fn new(bound: &BoundStudy, recording: &Recording) -> RunInputs {
        let times: Arc<[f64]> = recording.times.as_slice().into();
        let inputs = bound.inputs.iter().zip(&recording.inputs).map(|(input, values)| RecordedInput {
            variable: input.variable,
            times: times.clone(),
            values: values.as_slice().into(),
            interpolation: input.interpolation,
        });
        let mut steps: Vec<f64> = times.windows(2).map(|w| w[1] - w[0]).collect();
        steps.sort_by(f64::total_cmp);
        RunInputs { inputs: inputs.collect(), interval: steps[steps.len() / 2], times }
    }

    /// The same inputs with the samples up to a time in seconds, at least one.
    #[must_use]
    pub fn until(&self, time: f64) -> RunInputs {
        let count = self.times.partition_point(|&t| t <= time).max(1);
        RunInputs { times: self.times[..count].into(), ..self.clone() }
    }

    /// The same inputs with the samples from `first` to `last`, both included.
    #[must_use]
    pub fn between(&self, first: usize, last: usize) -> RunInputs {
        RunInputs { times: self.times[first..=last].into(), ..self.clone() }
    }
}

/// A run that failed.
#[derive(Clone, Debug, PartialEq)]
pub struct RunFailure {
    /// The time reached, in seconds.
    pub time: f64,
    /// The message of the run's error.
    pub message: String,
}

/// Runs a model with a tolerance.
#[derive(Clone, Copy, Debug)]
pub struct ModelRunner<'a> {
    /// The model.
    pub model: &'a CompiledModel,
    /// Relative tolerance of the integration.
    pub tolerance: f64,
}

impl ModelRunner<'_> {
    /// The state at the first sample, from the model's initial equations.
    ///
    /// # Errors
    /// When they have no solution.
    pub fn start(&self, track: &RunInputs, parameters: &[(VarId, f64)]) -> Result<State, RunFailure> {
        let first = track.times[0];
        let mut rows = SampleCollector::new(&[], &[]);
        let settings = self.settings(first, first, 0.0, parameters, &[]);
        self.simulate(&settings, &track.inputs, None, &mut rows)
    }

    /// Runs from `from`, or from the model's own start. Returns one column for each of `wanted`, as long as the
    /// samples.
    ///
    /// # Errors
    /// When the run does not reach the last sample.
    pub fn run(
        &self,
        track: &RunInputs,
        parameters: &[(VarId, f64)],
        from: Option<&State>,
        wanted: &[VarId],
    ) -> Result<Vec<Vec<f64>>, RunFailure> {
        self.run_on(track, parameters, from, wanted).map(|(columns, _)| columns)
    }

    /// The same with the state at the last sample.
    ///
    /// # Errors
    /// As [`ModelRunner::run`].
    pub fn run_on(
        &self,
        track: &RunInputs,
        parameters: &[(VarId, f64)],
        from: Option<&State>,
        wanted: &[VarId],
    ) -> Result<(Vec<Vec<f64>>, State), RunFailure> {
        let mut rows = SampleCollector::new(&track.times, wanted);
        let (first, last) = (track.times[0], track.times[track.times.len() - 1]);
        let settings = self.settings(first, last, track.interval, parameters, wanted);
        let state = self.simulate(&settings, &track.inputs, from, &mut rows)?;
        Ok((rows.finish(), state))
    }

    /// The settings of a run between two times, with parameter values.
    fn settings(
        &self,
        start: f64,
        stop: f64,
        interval: f64,
        parameters: &[(VarId, f64)],
        wanted: &[VarId],
    ) -> Settings {
        Settings {
            start_time: start,
            stop_time: stop,
            interval,
            tolerance: self.tolerance,
            parameters: parameters.to_vec(),
            wanted: wanted.to_vec(),
            ..Settings::default()
        }
    }

    /// Runs and returns the state at the end.
    fn simulate(
        &self,
        settings: &Settings,
        inputs: &[RecordedInput],
        from: Option<&State>,
        rows: &mut SampleCollector<'_>,
    ) -> Result<State, RunFailure> {
        // A run may have to select other states on the way; the model then recompiles its equations for them.
        let mut reselect = |choice: &StateChoice| self.model.with_states(choice);
        let mut control = Control { reselect: Some(&mut reselect), ..Control::default() };
        let run = solve::simulate(&self.model.system, settings, inputs, from, rows, &mut control);
        if run.end == End::Reached {
            return Ok(run.state);
        }
        let said = run.diagnostics.iter().find(|d| d.is_error()).map(|d| d.message.clone());
        Err(RunFailure { time: run.time, message: said.unwrap_or_else(|| format!("it ended as {}", run.end.word())) })
    }
}

/// Collects values at given times from the rows of a run: at an event those after it, between rows by linear
/// interpolation.
pub(super) struct SampleCollector<'a> {
    /// The times wanted, ascending.
    times: &'a [f64],
    /// Index of the first time not yet filled.
    next: usize,
    /// The last row: its time and values.
    before: Option<(f64, Vec<f64>)>,
    /// One column for each variable.
    columns: Vec<Vec<f64>>,
}

impl<'a> SampleCollector<'a> {
    /// A collector for the columns of `wanted`.
    pub(super) fn new(times: &'a [f64], wanted: &[VarId]) -> Self {
        SampleCollector { times, next: 0, before: None, columns: vec![Vec::with_capacity(times.len()); wanted.len()] }
    }

    /// How close to sample `k` a row counts as at the same time, in seconds.
    fn slack(&self, k: usize) -> f64 {
        let near = if k + 1 < self.times.len() { self.times[k + 1] - self.times[k] } else { 0.0 };
        1e-6 * near.max(1e-9 * self.times[k].abs())
    }

    /// Fills the samples that lie before `time` by more than their slack, by interpolation to this row.
    fn pass(&mut self, time: f64, values: &[f64]) {
        while self.next < self.times.len() && self.times[self.next] + self.slack(self.next) < time {
            let at = self.times[self.next];
            let (t0, v0) = self.before.as_ref().map_or((time, values), |(t, v)| (*t, v.as_slice()));
            let part = if time > t0 { ((at - t0) / (time - t0)).clamp(0.0, 1.0) } else { 0.0 };
            // Samples at the last row take its values exactly, not a trace of the next row, which may lie beyond an
            // event.
            let part = if part < 1e-5 { 0.0 } else { part };
            for (column, (a, b)) in self.columns.iter_mut().zip(v0.iter().zip(values)) {
                column.push(a + part * (b - a));
            }
            self.next += 1;
        }
    }

    /// The columns, each as long as the times. Samples behind the last row take its values.
    pub(super) fn finish(mut self) -> Vec<Vec<f64>> {
        if let Some((_, values)) = self.before.take() {
            self.pass(f64::INFINITY, &values);
        }
        self.columns
    }
}

impl RowSink for SampleCollector<'_> {
    fn row(&mut self, time: f64, values: &[f64]) -> ControlFlow<()> {
        // A later row at the same time, after an event, replaces this one before any sample there is filled.
        self.pass(time, values);
        self.before = Some((time, values.to_vec()));
        ControlFlow::Continue(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_at_samples() {
        let times = [0.0, 1.0, 2.5, 3.0];
        let mut samples = SampleCollector::new(&times, &[VarId(0)]);
        for (t, v) in [(0.0, 1.0), (1.0, 2.0), (1.0, 5.0), (2.0, 6.0), (3.0, 8.0)] {
            let _ = samples.row(t, &[v]);
        }
        assert_eq!(samples.finish(), [[1.0, 5.0, 7.0, 8.0]]);
    }
}
