//! Held recordings: they take no part in fitting and ranking, and are asked about one hypothesis at a time.

use super::super::data::RecordingData;
use super::super::estimate::candidate::RecordingResiduals;
use super::super::estimate::{CandidateModel, ModelFit};
use super::super::policy::{ACCURACY, ALPHA, DELTA, OPENS};
use super::compare::{SensorAccuracy, gap, needed, signal_gap};
use super::folds::LeftOutErrors;
use super::matched::evidence;

/// What held recordings say of a model against the one before, nothing refitted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HoldoutConfirmation {
    /// Evidence for it, nats.
    pub evidence: f64,
    /// Noise-free gap of the model before, in parts of full scale.
    pub before: f64,
    /// That of the model.
    pub after: f64,
    /// That of the nominal model.
    pub nominal: f64,
    /// The gap of some signal falls by half of what is worth a name.
    pub closes: bool,
}

impl HoldoutConfirmation {
    /// Whether they confirm it. `saved`: nats that it saves of the prior; `hypotheses`: among how many it was found.
    pub fn confirms(&self, saved: f64, hypotheses: usize) -> bool {
        // a corrected model is better than the nominal one, or it is none
        if self.after > (1.0 + OPENS) * self.nominal {
            return false;
        }
        // what brings parameters back to their data sheet must only not be contradicted
        if saved > needed(hypotheses) && self.evidence > -1.0 {
            return true;
        }
        self.evidence > 0.0 && (self.closes || self.evidence > (1.0 / ALPHA).ln())
    }
}

/// Held recordings.
pub struct HoldoutRecordings<'a> {
    recordings: &'a [RecordingData],
    /// Noise-free gap of the nominal model on them, in parts of full scale.
    nominal: f64,
}

impl<'a> HoldoutRecordings<'a> {
    /// Those on which the nominal model leaves so much.
    pub fn new(recordings: &'a [RecordingData], nominal: &CandidateModel, x: &[f64], sensors: &SensorAccuracy) -> Self {
        HoldoutRecordings { recordings, nominal: gap(&LeftOutErrors::of(all(nominal, x, recordings)), sensors) }
    }

    /// What a model leaves of them.
    pub fn left_by(&self, fit: &ModelFit) -> Vec<RecordingResiduals> {
        all(&fit.candidate, &fit.x, self.recordings)
    }

    /// What they say of a model against the one before, which leaves so much; `None` where there are none.
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

fn all(candidate: &CandidateModel, x: &[f64], recordings: &[RecordingData]) -> Vec<RecordingResiduals> {
    recordings.iter().map(|r| of(candidate, x, r)).collect()
}

/// Errors on a recording that took no part; infinite where the simulation does not reach the end.
fn of(candidate: &CandidateModel, x: &[f64], recording: &RecordingData) -> RecordingResiduals {
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
