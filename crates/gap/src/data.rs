//! Recordings as the inference reads them.

use std::sync::Arc;

/// The start of a recording from which the initial state is estimated: this part of it, and at most so many seconds.
const START: (f64, f64) = (0.05, 0.2);
/// But so many samples at least, so that the noise of a few is not the state's, up to this part of the recording.
const ENOUGH: (usize, f64) = (20, 0.2);

/// One recording in SI units.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordingData {
    /// Times of the samples in seconds, growing.
    pub times: Arc<[f64]>,
    /// Per input of the model its samples; complete.
    pub inputs: Vec<Arc<[f64]>>,
    /// Per input: straight between samples instead of held.
    pub linear: Vec<bool>,
    /// Per signal of the study its samples; NaN where there is none.
    pub signals: Vec<Arc<[f64]>>,
}

impl RecordingData {
    /// Number of samples.
    pub fn len(&self) -> usize {
        self.times.len()
    }

    /// Never by construction, but a reader may ask.
    pub fn is_empty(&self) -> bool {
        self.times.is_empty()
    }

    /// From the first sample to the last, s.
    pub fn duration(&self) -> f64 {
        self.times[self.times.len() - 1] - self.times[0]
    }

    /// The first sample behind the start, from which the state is estimated and which counts for nothing else.
    pub fn settled(&self) -> usize {
        let until = self.times[0] + (START.0 * self.duration()).min(START.1);
        let short = self.times.iter().position(|t| *t >= until).unwrap_or(0);
        let enough = ENOUGH.0.min((ENOUGH.1 * self.len() as f64) as usize);
        short.max(enough).min(self.len() - 1)
    }

    /// The first value of a signal within the start.
    pub fn first_value(&self, signal: usize) -> Option<f64> {
        self.signals[signal][..=self.settled()].iter().copied().find(|v| v.is_finite())
    }

    /// Inputs at a sample.
    pub fn input(&self, k: usize, u: &mut [f64]) {
        u.iter_mut().zip(&self.inputs).for_each(|(u, samples)| *u = samples[k]);
    }
}

/// Inputs of the interval after a sample.
#[derive(Clone, Debug)]
pub struct InputSegment {
    /// At the sample.
    pub from: Vec<f64>,
    /// How fast they change, per second; held ones do not.
    pub slope: Vec<f64>,
}

impl InputSegment {
    /// Those of the first interval.
    pub fn new(recording: &RecordingData) -> Self {
        let count = recording.inputs.len();
        let mut inputs = InputSegment { from: vec![0.0; count], slope: vec![0.0; count] };
        inputs.enter(recording, 0);
        inputs
    }

    /// Goes to the interval after sample `k`.
    pub fn enter(&mut self, recording: &RecordingData, k: usize) {
        recording.input(k, &mut self.from);
        let next = (k + 1).min(recording.len() - 1);
        let h = recording.times[next] - recording.times[k];
        for ((slope, samples), &linear) in self.slope.iter_mut().zip(&recording.inputs).zip(&recording.linear) {
            *slope = if linear && h > 0.0 { (samples[next] - samples[k]) / h } else { 0.0 };
        }
    }

    /// Inputs so long after the sample, s.
    pub fn at(&self, after: f64, u: &mut [f64]) {
        u.iter_mut().zip(&self.from).zip(&self.slope).for_each(|((u, from), slope)| *u = from + slope * after);
    }
}
