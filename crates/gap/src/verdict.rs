//! The verdict as scripts read it: schema 1.

mod conclude;

pub use conclude::conclude;

use super::hypotheses::Hypothesis;
use super::problem::SignalDisplayUnit;
use serde::Serialize;
use std::collections::BTreeMap;

/// A number that may not be known.
pub type OptionalNumber = Option<f64>;

/// Everything that the diagnosis says.
#[derive(Clone, Debug, Serialize)]
pub struct Verdict {
    /// Version of this layout.
    pub schema: u32,
    /// The first that holds of `recording_error`, `effects`, `outside_library`, `gap_open`, `undecidable`,
    /// `nothing_found`. The last is said only where the gap on held recordings is closed.
    pub verdict: &'static str,
    /// Standard deviation of each sensor's noise, SI.
    pub noise: BTreeMap<String, f64>,
    /// What the study did not say and was assumed.
    pub assumed: BTreeMap<String, f64>,
    /// Gross errors of the recordings.
    pub recording: Vec<RecordingError>,
    /// Places where the two part, most certain first; before anything is named.
    pub places: Vec<PlaceEvidence>,
    /// Effects in the order of acceptance.
    pub effects: Vec<VerdictEffect>,
    /// What the judge says of the effect, if it is shown because it was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub asked: Option<String>,
    /// Every free parameter.
    pub drifts: Vec<ParameterDrift>,
    /// The gap, raw.
    pub gap: GapSummary,
    /// Part of the held gap that is closed by tolerances and effects.
    pub closed: OptionalNumber,
    /// Part that effects close beyond tolerances.
    pub closed_by_effects: OptionalNumber,
    /// Every hypothesis that was weighed, step by step, with the reason why it was not taken.
    pub weighed: Vec<HypothesisAssessment>,
    /// What is left.
    pub unexplained: UnexplainedGap,
    /// Signals at which the last model leaves a gap wider than three times the noise and a quarter of a per cent of the
    /// range.
    pub open: Vec<OpenGap>,
    /// What to measure next, where the data cannot tell.
    pub next_experiment: Option<String>,
    /// Time that the diagnosis took.
    pub seconds: f64,
}

/// A gross error of a recording.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RecordingError {
    /// The file.
    pub file: String,
    /// The signal.
    pub signal: String,
    /// `sign` or `factor`.
    pub error: &'static str,
    /// What it is times what it should be.
    pub value: f64,
}

/// A place with its evidence.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PlaceEvidence {
    /// Its name.
    pub place: String,
    /// Everything that is the same place.
    pub node: Vec<String>,
    /// What is missing there.
    pub kind: &'static str,
    /// Nats.
    pub evidence: f64,
    /// Its part of all evidence.
    pub share: f64,
}

/// A place by name.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PlaceName {
    /// Its name.
    pub place: String,
    /// Everything that is the same place.
    pub node: Vec<String>,
}

/// An accepted effect.
#[derive(Clone, Debug, Serialize)]
pub struct VerdictEffect {
    /// Class of the effect.
    pub effect: String,
    /// Its family.
    pub family: String,
    /// What it does, in words.
    pub description: String,
    /// Where.
    pub places: Vec<PlaceName>,
    /// What flows through it at its first place; nothing for signals and parameters.
    pub flow: Option<EffectFlow>,
    /// Evidence of left-out data and tolerances when it was taken, nats.
    pub evidence: f64,
    /// Statistic over blocks of left-out data: mean gain over its standard error.
    pub t: f64,
    /// Part of the held gap (behind tolerances) that it closes alone.
    pub closes_alone: OptionalNumber,
    /// Part that opens again without it.
    pub closes_last: OptionalNumber,
    /// Coefficients and shapes.
    pub parameters: BTreeMap<String, ParameterEstimate>,
    /// What the data cannot tell from it.
    pub indistinguishable: Vec<AlternativeExplanation>,
}

/// Force, torque, flow, current or heat through an effect over the recordings used, in the model with all effects.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EffectFlow {
    /// Greatest size.
    pub largest: f64,
    /// Root of the mean square.
    pub rms: f64,
    /// Unit: that of a column of the study of the same dimension, else l/min for a volume flow and SI units for others.
    pub unit: String,
}

/// A value with its uncertainty.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ParameterEstimate {
    /// Value.
    pub value: f64,
    /// One standard deviation.
    pub std: f64,
    /// Unit.
    pub unit: String,
    /// How the study speaks of it, where that is in another unit.
    #[serde(skip)]
    pub shown: Option<SignalDisplayUnit>,
}

/// A hypothesis that was weighed; what left-out data say of it where it was fitted.
#[derive(Clone, Debug, Serialize)]
pub struct HypothesisAssessment {
    /// The step: 1, 2, ...
    pub step: usize,
    /// Class of the effect.
    pub effect: String,
    /// Its family.
    pub family: String,
    /// Where.
    pub places: Vec<PlaceName>,
    /// Gap of left-out data that it leaves, in parts of full scale, noise taken out.
    pub gap: OptionalNumber,
    /// t statistic over the blocks.
    pub t: OptionalNumber,
    /// Evidence, nats.
    pub evidence: OptionalNumber,
    /// Why it was not taken.
    pub refused: Option<String>,
}

/// Another explanation that the data cannot exclude.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AlternativeExplanation {
    /// Class of the effect.
    pub effect: String,
    /// Its family.
    pub family: String,
    /// Where.
    pub places: Vec<PlaceName>,
    /// Nats behind the best.
    pub behind: f64,
}

/// A free parameter.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ParameterDrift {
    /// Its name.
    pub parameter: String,
    /// Of the nominal model.
    pub nominal: f64,
    /// As fitted.
    pub value: f64,
    /// One standard deviation.
    pub std: f64,
    /// Deviation in tolerances; nothing where it has none.
    pub tolerances: OptionalNumber,
}

/// Gaps on held and train recordings.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct GapSummary {
    /// On recordings that were not used.
    pub held: RoleGaps,
    /// On those that were.
    pub train: RoleGaps,
}

/// Gaps on one kind of recordings.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct RoleGaps {
    /// RMS over the signals.
    pub total: ModelGaps,
    /// Per signal.
    pub signals: BTreeMap<String, SignalGap>,
}

/// The gap at one signal: root mean squares of measured minus simulated, from which nothing is subtracted.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct SignalGap {
    /// In parts of the sensor's full scale.
    #[serde(flatten)]
    pub of_full_scale: ModelGaps,
    /// In parts of the range of these recordings.
    pub of_range: ModelGaps,
    /// In the unit.
    pub rms: ModelGaps,
    /// The unit of the study's column.
    pub unit: String,
    /// How far the signal moves in these recordings, in the unit.
    pub range: f64,
    /// Standard deviation of the noise that the samples show, in the unit.
    pub noise: f64,
}

/// The gap of three models; nothing where a run stops early.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ModelGaps {
    /// As the study gives it.
    pub nominal: OptionalNumber,
    /// Parameters moved within their tolerances.
    pub tolerances: OptionalNumber,
    /// With the effects.
    pub effects: OptionalNumber,
}

/// What is left.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct UnexplainedGap {
    /// Of the nominal gap.
    pub share: OptionalNumber,
    /// Where, if it can be told.
    pub place: Option<String>,
    /// What it follows, if anything.
    pub shape: Option<Vec<MissingTerm>>,
}

/// A signal at which the gap stays open.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OpenGap {
    /// The signal.
    pub signal: String,
    /// RMS that the last model leaves, in the unit; nothing where its run stops early.
    pub rms: OptionalNumber,
    /// The same as part of the recordings' range.
    pub of_range: OptionalNumber,
    /// The unit of the study's column.
    pub unit: String,
    /// Recordings in which it is open, of how many.
    pub recordings: (usize, usize),
}

/// A term of the missing through variable.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MissingTerm {
    /// What the missing quantity follows.
    pub term: String,
    /// Part of the gap of left-out train data that it closes.
    pub closes: f64,
}

/// What parts effects that move alike.
pub(super) const PARTING: &str =
    "slow triangles through zero, steps and a chirp over the whole range: what moves alike here may part there";

/// What to measure where the recordings show next to nothing.
pub(super) const EXCITING: &str =
    "more excitation: steps of the inputs over their whole range, then slow triangles through zero";

/// One gap over another, where both are known.
pub(super) fn ratio(a: OptionalNumber, b: OptionalNumber) -> OptionalNumber {
    let b = b.filter(|b| *b > 0.0)?;
    a.map(|a| a / b)
}

/// The places of a hypothesis by name.
pub(super) fn spots(h: &Hypothesis) -> Vec<PlaceName> {
    h.places().into_iter().map(|p| PlaceName { place: p.place.clone(), node: p.node.clone() }).collect()
}

/// A hypothesis that is so many nats behind the one named.
pub(super) fn alternative(h: &Hypothesis, behind: f64) -> AlternativeExplanation {
    AlternativeExplanation { effect: h.effect.clone(), family: h.family.clone(), places: spots(h), behind }
}
