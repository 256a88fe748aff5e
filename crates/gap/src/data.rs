//! Recordings in the form in which the estimation reads them: arrays in SI units, one per input and signal.
//!
//! `study` makes them from the files of a study; `estimate` simulates models along them.
//! The first samples of each recording only determine its initial state and count for nothing else.

use std::sync::Arc;

/// The beginning of a recording, from which the initial state is estimated: this part of it, and at most so many
/// seconds.
const START: (f64, f64) = (0.05, 0.2);
/// Least number of samples of that beginning, so that noise averages out, and the largest part of the recording they
/// may be.
const ENOUGH: (usize, f64) = (20, 0.2);

/// One recording in SI units. All columns have as many samples as `times`.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordingData {
    /// Times of the samples in s, increasing.
    pub times: Arc<[f64]>,
    /// Samples of each input, in the order of the model's inputs, without gaps.
    pub inputs: Vec<Arc<[f64]>>,
    /// Per input: `true` if it is interpolated linearly between samples, `false` if each sample is held.
    pub linear: Vec<bool>,
    /// Samples of each signal of the study; NaN where nothing was recorded.
    pub signals: Vec<Arc<[f64]>>,
}

impl RecordingData {
    /// Number of samples.
    pub fn len(&self) -> usize {
        self.times.len()
    }

    /// Whether there are no samples. Recordings of a study always have some.
    pub fn is_empty(&self) -> bool {
        self.times.is_empty()
    }

    /// Time from the first to the last sample, s.
    pub fn duration(&self) -> f64 {
        self.times[self.times.len() - 1] - self.times[0]
    }

    /// Index of the last sample of the beginning.
    /// The initial state is estimated from the samples up to it; residuals count from the sample behind it.
    pub fn settled(&self) -> usize {
        let until = self.times[0] + (START.0 * self.duration()).min(START.1);
        let short = self.times.iter().position(|t| *t >= until).unwrap_or(0);
        let enough = ENOUGH.0.min((ENOUGH.1 * self.len() as f64) as usize);
        short.max(enough).min(self.len() - 1)
    }

    /// First finite value of a signal within the beginning; `None` where none was recorded there.
    pub fn first_value(&self, signal: usize) -> Option<f64> {
        self.signals[signal][..=self.settled()].iter().copied().find(|v| v.is_finite())
    }

    /// Writes the values of all inputs at sample `k` into `u`.
    pub fn input(&self, k: usize, u: &mut [f64]) {
        u.iter_mut().zip(&self.inputs).for_each(|(u, samples)| *u = samples[k]);
    }
}

/// Inputs between two neighbouring samples, as linear functions of time.
#[derive(Clone, Debug)]
pub struct InputSegment {
    /// Values at the sample where the interval begins.
    pub from: Vec<f64>,
    /// Rates of change over the interval, per second; 0 for held inputs.
    pub slope: Vec<f64>,
}

impl InputSegment {
    /// Inputs of the first interval.
    pub fn new(recording: &RecordingData) -> Self {
        let count = recording.inputs.len();
        let mut inputs = InputSegment { from: vec![0.0; count], slope: vec![0.0; count] };
        inputs.enter(recording, 0);
        inputs
    }

    /// Moves to the interval that begins at sample `k`.
    pub fn enter(&mut self, recording: &RecordingData, k: usize) {
        recording.input(k, &mut self.from);
        // Behind the last sample there is no interval: the inputs stay as they are.
        let next = (k + 1).min(recording.len() - 1);
        let h = recording.times[next] - recording.times[k];
        for ((slope, samples), &linear) in self.slope.iter_mut().zip(&recording.inputs).zip(&recording.linear) {
            *slope = if linear && h > 0.0 { (samples[next] - samples[k]) / h } else { 0.0 };
        }
    }

    /// Writes the inputs `after` seconds behind the sample into `u`.
    pub fn at(&self, after: f64, u: &mut [f64]) {
        u.iter_mut().zip(&self.from).zip(&self.slope).for_each(|((u, from), slope)| *u = from + slope * after);
    }
}
