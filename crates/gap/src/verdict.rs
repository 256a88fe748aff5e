//! The verdict as scripts read it: the JSON of `bramah gap`, schema 1.
//!
//! The types are plain data; `conclude` fills them from the result of a search. Field names are the keys of the JSON.
//! `words` and `report` show the verdict to people. Meaning of the verdicts: `docs/gap_method.md`, "When nothing is
//! sure".

mod conclude;

pub use conclude::conclude;

use super::hypotheses::Hypothesis;
use super::problem::SignalDisplayUnit;
use serde::Serialize;
use std::collections::BTreeMap;

/// A number that may be unknown; `null` in JSON.
pub type OptionalNumber = Option<f64>;

/// Result of a diagnosis.
#[derive(Clone, Debug, Serialize)]
pub struct Verdict {
    /// Version of this layout.
    pub schema: u32,
    /// The first that holds of `recording_error`, `effects`, `outside_library`, `gap_open`, `undecidable`,
    /// `nothing_found`. The last requires that the gap on held recordings is closed.
    pub verdict: &'static str,
    /// Standard deviation of each sensor's noise, SI, by signal.
    pub noise: BTreeMap<String, f64>,
    /// Standard deviations that were assumed because the study states none, SI, by parameter.
    pub assumed: BTreeMap<String, f64>,
    /// Errors of the recordings, as wrong signs and units.
    pub recording: Vec<RecordingError>,
    /// Places where model and machine differ, most certain first.
    pub places: Vec<PlaceEvidence>,
    /// Accepted effects, in the order of acceptance.
    pub effects: Vec<VerdictEffect>,
    /// If one effect was asked for: whether it would be accepted, in words.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub asked: Option<String>,
    /// Every parameter with a tolerance, as fitted.
    pub drifts: Vec<ParameterDrift>,
    /// The gap, nothing subtracted.
    pub gap: GapSummary,
    /// Part of the gap on held recordings that tolerances and effects close.
    pub closed: OptionalNumber,
    /// Part of the gap left by tolerances that effects close.
    pub closed_by_effects: OptionalNumber,
    /// Every hypothesis of every step with its score, and the reason why it was not taken.
    pub weighed: Vec<HypothesisAssessment>,
    /// What stays unexplained.
    pub unexplained: UnexplainedGap,
    /// Signals at which the last model leaves a gap wider than three times the noise and a quarter of a per cent of the
    /// range.
    pub open: Vec<OpenGap>,
    /// What to measure next, where the data cannot decide.
    pub next_experiment: Option<String>,
    /// Duration of the diagnosis, s.
    pub seconds: f64,
}

/// A wrong sign or unit of a column.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RecordingError {
    /// File of the recording.
    pub file: String,
    /// Name of the signal or input.
    pub signal: String,
    /// Kind of error: `sign` or `factor`.
    pub error: &'static str,
    /// Recorded value over correct value.
    pub value: f64,
}

/// A place with the evidence that something is missing there.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PlaceEvidence {
    /// Its name.
    pub place: String,
    /// All names of the same place: ports of the node, or parallel bridges.
    pub node: Vec<String>,
    /// Kind of quantity that is missing there: `force`, `flow`, `sensor` and so on.
    pub kind: &'static str,
    /// Evidence in nats.
    pub evidence: f64,
    /// Its part of the evidence of all places, 0 to 1.
    pub share: f64,
}

/// A place by its names.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PlaceName {
    /// Its name.
    pub place: String,
    /// All names of the same place: ports of the node, or parallel bridges.
    pub node: Vec<String>,
}

/// An accepted effect.
#[derive(Clone, Debug, Serialize)]
pub struct VerdictEffect {
    /// Class of the effect.
    pub effect: String,
    /// Family of the effect.
    pub family: String,
    /// What it does, in words.
    pub description: String,
    /// Places where it acts.
    pub places: Vec<PlaceName>,
    /// What flows through it at its first place; `None` for signals and parameters.
    pub flow: Option<EffectFlow>,
    /// Evidence of left-out data and prior when it was accepted, nats.
    pub evidence: f64,
    /// t statistic over blocks of left-out data: mean gain over its standard error.
    pub t: f64,
    /// Part of the held gap left by tolerances that it closes as the only effect.
    pub closes_alone: OptionalNumber,
    /// Part of that gap that opens again if it is left out.
    pub closes_last: OptionalNumber,
    /// Coefficients and shapes by name.
    pub parameters: BTreeMap<String, ParameterEstimate>,
    /// Explanations that the data cannot tell from it.
    pub indistinguishable: Vec<AlternativeExplanation>,
}

/// Force, torque, flow, current or heat through an effect over the train recordings, in the model with all effects.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EffectFlow {
    /// Largest absolute value.
    pub largest: f64,
    /// Root mean square.
    pub rms: f64,
    /// Unit: that of a column of the same dimension, else l/min for a volume flow and SI units for others.
    pub unit: String,
}

/// An estimated value with its uncertainty.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ParameterEstimate {
    /// The estimate, in `unit`.
    pub value: f64,
    /// One standard deviation; 0 for a value that was not free.
    pub std: f64,
    /// Unit of both.
    pub unit: String,
    /// Unit of the study's column for display, where that is another one.
    #[serde(skip)]
    pub shown: Option<SignalDisplayUnit>,
}

/// A hypothesis as it was judged in one step; scores are `None` where it was not fitted.
#[derive(Clone, Debug, Serialize)]
pub struct HypothesisAssessment {
    /// Number of the step, from 1.
    pub step: usize,
    /// Class of the effect.
    pub effect: String,
    /// Its family.
    pub family: String,
    /// Places where it acts.
    pub places: Vec<PlaceName>,
    /// Noise-free gap of left-out data that it leaves, in parts of full scale.
    pub gap: OptionalNumber,
    /// t statistic over the blocks.
    pub t: OptionalNumber,
    /// Evidence, nats.
    pub evidence: OptionalNumber,
    /// Why it was not taken; `None` for the one that was.
    pub refused: Option<String>,
}

/// Another explanation that the data cannot exclude.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AlternativeExplanation {
    /// Class of the effect.
    pub effect: String,
    /// Its family.
    pub family: String,
    /// Places where it acts.
    pub places: Vec<PlaceName>,
    /// Nats behind the named effect; negative if it is ahead.
    pub behind: f64,
}

/// A parameter with a tolerance, as fitted.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ParameterDrift {
    /// Full name in the nominal model.
    pub parameter: String,
    /// Value of the nominal model, SI.
    pub nominal: f64,
    /// Fitted value, SI.
    pub value: f64,
    /// One standard deviation, SI.
    pub std: f64,
    /// Deviation from the data sheet in tolerances; `None` for a parameter that the study leaves free.
    pub tolerances: OptionalNumber,
}

/// Gaps on held and on train recordings.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct GapSummary {
    /// On recordings that took no part in fitting; on the train recordings if there are none.
    pub held: RoleGaps,
    /// On recordings that were used for fitting.
    pub train: RoleGaps,
}

/// Gaps on recordings of one role.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct RoleGaps {
    /// RMS over the signals, in parts of full scale.
    pub total: ModelGaps,
    /// Gap of each signal, by name.
    pub signals: BTreeMap<String, SignalGap>,
}

/// The gap at one signal: root mean squares of measured minus simulated. No noise is subtracted.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct SignalGap {
    /// In parts of the sensor's full scale; its fields are keys of the signal itself in the JSON.
    #[serde(flatten)]
    pub of_full_scale: ModelGaps,
    /// In parts of the signal's range in these recordings.
    pub of_range: ModelGaps,
    /// In `unit`.
    pub rms: ModelGaps,
    /// Unit of the study's column.
    pub unit: String,
    /// Range of the signal in these recordings, in `unit`.
    pub range: f64,
    /// Standard deviation of the noise as estimated from the samples, in `unit`.
    pub noise: f64,
}

/// The gap of three models; `None` where a simulation stops early.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ModelGaps {
    /// The model as the study gives it.
    pub nominal: OptionalNumber,
    /// With parameters fitted within their tolerances.
    pub tolerances: OptionalNumber,
    /// With the accepted effects.
    pub effects: OptionalNumber,
}

/// What stays unexplained.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct UnexplainedGap {
    /// Part of the nominal gap.
    pub share: OptionalNumber,
    /// Place of the accepted shape; `None` without one.
    pub place: Option<String>,
    /// Terms of the accepted shape; `None` without one.
    pub shape: Option<Vec<MissingTerm>>,
}

/// A signal whose gap stays open.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OpenGap {
    /// Name of the signal.
    pub signal: String,
    /// RMS that the last model leaves, in `unit`; `None` if its simulation stops early.
    pub rms: OptionalNumber,
    /// The same as part of the recordings' range.
    pub of_range: OptionalNumber,
    /// The unit of the study's column.
    pub unit: String,
    /// Number of recordings in which the gap is open, and number of all.
    pub recordings: (usize, usize),
}

/// A term of the missing quantity.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MissingTerm {
    /// Variable that the missing quantity follows, in words.
    pub term: String,
    /// Part of the gap of left-out train data that it closes.
    pub closes: f64,
}

/// Experiment that tells effects apart whose trajectories are alike in the recordings.
pub(super) const PARTING: &str =
    "slow triangles through zero, steps and a chirp over the whole range: what moves alike here may part there";

/// Experiment for recordings that could show next to nothing.
pub(super) const EXCITING: &str =
    "more excitation: steps of the inputs over their whole range, then slow triangles through zero";

/// `a` over `b`; `None` if either is unknown or `b` is not positive.
pub(super) fn ratio(a: OptionalNumber, b: OptionalNumber) -> OptionalNumber {
    let b = b.filter(|b| *b > 0.0)?;
    a.map(|a| a / b)
}

/// The places of a hypothesis by name.
pub(super) fn spots(h: &Hypothesis) -> Vec<PlaceName> {
    h.places().into_iter().map(|p| PlaceName { place: p.place.clone(), node: p.node.clone() }).collect()
}

/// A hypothesis that is `behind` nats behind the named one.
pub(super) fn alternative(h: &Hypothesis, behind: f64) -> AlternativeExplanation {
    AlternativeExplanation { effect: h.effect.clone(), family: h.family.clone(), places: spots(h), behind }
}
