//! Confirmation by held recordings, which take no part in fitting and ranking.
//!
//! They are evaluated with the parameters of the fits, nothing refitted. Enters: the fits without and with one
//! hypothesis. Leaves: a [`HoldoutConfirmation`]. Criterion "confirmed" of `docs/gap_method.md`, "When an effect is
//! accepted".

use super::super::data::RecordingData;
use super::super::estimate::candidate::RecordingResiduals;
use super::super::estimate::{CandidateModel, ModelFit};
use super::compare::{SensorAccuracy, gap, needed, signal_gap};
use super::folds::LeftOutErrors;
use super::matched::evidence;
use crate::policy::{ACCURACY, ALPHA, DELTA, OPENS};

/// Comparison of a model with the one before on held recordings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HoldoutConfirmation {
    /// Evidence for the model, nats.
    pub evidence: f64,
    /// Noise-free gap of the model before, in parts of full scale.
    pub before: f64,
    /// Noise-free gap of the model.
    pub after: f64,
    /// Noise-free gap of the nominal model.
    pub nominal: f64,
    /// The gap of some signal falls by half of what is worth a name on train data.
    pub closes: bool,
}

impl HoldoutConfirmation {
    /// Whether the held recordings confirm the model.
    /// `saved`: nats of prior that it saves; `hypotheses`: number among which it was found.
    pub fn confirms(&self, saved: f64, hypotheses: usize) -> bool {
        // a corrected model must not be worse than the nominal one
        if self.after > (1.0 + OPENS) * self.nominal {
            return false;
        }
        // an effect that returns parameters to their data sheet only must not be contradicted
        if saved > needed(hypotheses) && self.evidence > -1.0 {
            return true;
        }
        self.evidence > 0.0 && (self.closes || self.evidence > (1.0 / ALPHA).ln())
    }
}

/// The held recordings, with the gap of the nominal model on them.
pub struct HoldoutRecordings<'a> {
    /// The recordings; may be empty.
    recordings: &'a [RecordingData],
    /// Noise-free gap of the nominal model on them, in parts of full scale.
    nominal: f64,
}

impl<'a> HoldoutRecordings<'a> {
    /// Simulates the nominal model at the coordinates `x` on the held recordings.
    pub fn new(recordings: &'a [RecordingData], nominal: &CandidateModel, x: &[f64], sensors: &SensorAccuracy) -> Self {
        HoldoutRecordings { recordings, nominal: gap(&LeftOutErrors::of(all(nominal, x, recordings)), sensors) }
    }

    /// Errors of a fit on the held recordings.
    pub fn left_by(&self, fit: &ModelFit) -> Vec<RecordingResiduals> {
        all(&fit.candidate, &fit.x, self.recordings)
    }

    /// Compares a fit with the model before, whose errors are `before`; `None` if there are no held recordings.
    pub fn ask(
        &self,
        before: &[RecordingResiduals],
        after: &ModelFit,
        sensors: &SensorAccuracy,
    ) -> Option<HoldoutConfirmation> {
        if self.recordings.is_empty() {
            return None;
        }
        let after = self.left_by(after);
        let evidence = evidence(before, &after, sensors);
        let (a, b) = (LeftOutErrors::of(before.to_vec()), LeftOutErrors::of(after));
        let falls = |i: usize| {
            let before = signal_gap(&a, i, sensors);
            // half of what train data ask for, since nothing was fitted to these recordings
            let worth = (0.5 * DELTA * before).max(0.5 * ACCURACY * sensors.full_scale[i]);
            before - signal_gap(&b, i, sensors) >= worth
        };
        let closes = (0..sensors.noise.len()).any(falls);
        Some(HoldoutConfirmation {
            evidence,
            before: gap(&a, sensors),
            after: gap(&b, sensors),
            nominal: self.nominal,
            closes,
        })
    }
}

/// Errors of a model on all held recordings.
fn all(candidate: &CandidateModel, x: &[f64], recordings: &[RecordingData]) -> Vec<RecordingResiduals> {
    recordings.iter().map(|r| of(candidate, x, r)).collect()
}

/// Errors of a model on one held recording; infinite at every sample if the simulation stops early.
fn of(candidate: &CandidateModel, x: &[f64], recording: &RecordingData) -> RecordingResiduals {
    // a model with coefficients per recording has none for this one, so they are found here by cross-validation
    let found = if candidate.model.own.is_empty() {
        candidate.errors(x, recording, None)
    } else {
        candidate.errors_elsewhere(x, recording)
    };
    found.unwrap_or_else(|| {
        let samples = recording.len() - recording.settled() - 1;
        recording.signals.iter().map(|_| vec![f64::INFINITY; samples]).collect()
    })
}
