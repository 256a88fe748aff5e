//! Models with what they leave of left-out data, by both weightings.

use super::super::clock::Deadline;
use super::super::estimate::{CandidateModel, FitTask, ModelFit, SignalWeights};
use super::super::policy::{LEAST, OTHER_WEIGHTING, SETTLING, SURE};
use super::super::problem::DiagnosisProblem;
use super::compare::{SensorAccuracy, differences, evidence, gap, signal_gap, t_statistic};
use super::folds::{LeftOutErrors, left_out};
use super::models;

/// A fit with what it leaves of left-out data.
#[derive(Clone, Debug)]
pub struct CrossValidatedFit {
    /// The fit.
    pub fit: ModelFit,
    /// By pieces, and by recordings where there are enough.
    pub left: Vec<LeftOutErrors>,
}

impl CrossValidatedFit {
    /// Simulates what was left out.
    pub fn new(problem: &DiagnosisProblem<'_>, fit: ModelFit) -> Self {
        CrossValidatedFit { left: left_out(&fit, &problem.train), fit }
    }

    /// Noise-free gap of left-out pieces over all signals, in parts of full scale.
    pub fn gap(&self, sensors: &SensorAccuracy) -> f64 {
        gap(&self.left[0], sensors)
    }
}

/// Both weightings: errors as they are now (tolerances hold), and as if only the sensors' noise were left (the data hold).
/// Left-out data and the prior decide. Once the time is over the first one stands.
pub fn weighed(
    problem: &DiagnosisProblem<'_>,
    sensors: &SensorAccuracy,
    (candidate, x): (CandidateModel, Vec<f64>),
    until: Deadline<'_>,
) -> Option<CrossValidatedFit> {
    let task = problem.task(until);
    let one = CrossValidatedFit::new(problem, as_they_are(task, candidate, x)?);
    let other = if until.is_over() { None } else { at_the_noise(problem, sensors, &one, until) };
    Some(other.unwrap_or(one))
}

/// A model fitted again with the weights that it left, until left-out data see no difference or the time is over: what is
/// not at its optimum would be improved by any effect. The first of these fits takes the time that it needs.
pub fn settled(
    problem: &DiagnosisProblem<'_>,
    sensors: &SensorAccuracy,
    mut model: CrossValidatedFit,
    until: Deadline<'_>,
) -> CrossValidatedFit {
    for round in 0..SETTLING {
        let until = if round == 0 { Deadline::default() } else { until };
        if until.is_over() {
            break;
        }
        let (candidate, x) = (model.fit.candidate.clone(), model.fit.x.clone());
        let Some(fit) = as_they_are(problem.task(until), candidate, x) else { break };
        let next = CrossValidatedFit::new(problem, fit);
        if !better(&model, &next, sensors) {
            break;
        }
        model = next;
    }
    model
}

/// The model with the widths of all its effects free, where that is better.
pub fn widened(
    problem: &DiagnosisProblem<'_>,
    sensors: &SensorAccuracy,
    one: &CrossValidatedFit,
    until: Deadline<'_>,
) -> Option<CrossValidatedFit> {
    let causes = one.fit.causes();
    let wider = models::candidate(problem, &causes, Some(&one.fit.tolerances()), causes.len())?;
    if wider.coordinates.len() <= one.fit.x.len() {
        return None;
    }
    let x = wider.present();
    let fitted = weighed(problem, sensors, (wider, x), until)?;
    (ahead(one, &fitted, sensors) > 0.0).then_some(fitted)
}

/// The model before a rival, fitted anew from where parameters are in the rival, where that is better. It takes the time that
/// it needs: what is not at its optimum would make a claim of any effect.
pub fn as_in(
    problem: &DiagnosisProblem<'_>,
    sensors: &SensorAccuracy,
    before: &CrossValidatedFit,
    rival: &ModelFit,
) -> Option<CrossValidatedFit> {
    // the coordinates of the cause that it has beyond the model before stand last
    let x = rival.x[..before.fit.x.len()].to_vec();
    let other = CrossValidatedFit::new(
        problem,
        as_they_are(problem.task(Deadline::default()), before.fit.candidate.clone(), x)?,
    );
    better(before, &other, sensors).then_some(other)
}

/// A fit that weighs errors as large and as correlated as it leaves them.
fn as_they_are(task: FitTask<'_>, candidate: CandidateModel, x: Vec<f64>) -> Option<ModelFit> {
    ModelFit::of(candidate, x, task, None, 2)
}

/// The same of a model that holds the one before: where it comes out behind, it begins with the weights of that one.
pub fn no_worse(task: FitTask<'_>, before: &ModelFit, candidate: CandidateModel, x: Vec<f64>) -> Option<ModelFit> {
    let fit = as_they_are(task, candidate.clone(), x.clone());
    if fit.as_ref().is_some_and(|f| before.ahead(f) >= 0.0) {
        return fit;
    }
    let weights = Some(before.weights.clone());
    let other = ModelFit::of(candidate, x, task, weights, 2);
    fit.into_iter().chain(other).reduce(ModelFit::better_of)
}

/// The fit that begins where only the sensors' noise is left, where it is better.
pub fn at_the_noise(
    problem: &DiagnosisProblem<'_>,
    sensors: &SensorAccuracy,
    one: &CrossValidatedFit,
    until: Deadline<'_>,
) -> Option<CrossValidatedFit> {
    let task = problem.task(until);
    let white = SignalWeights::sensors(&sensors.noise, &problem.full_scale);
    let (candidate, x) = (one.fit.candidate.clone(), one.fit.x.clone());
    let begun = ModelFit::of(candidate, x, task, Some(white), 1)?;
    let other = CrossValidatedFit::new(problem, as_they_are(task, begun.candidate, begun.x)?);
    better(one, &other, sensors).then_some(other)
}

/// Whether left-out data prefer the second of two fits of one model: by their evidence, or block by block.
fn better(one: &CrossValidatedFit, other: &CrossValidatedFit, sensors: &SensorAccuracy) -> bool {
    let ahead = ahead(one, other, sensors);
    let surely = || t_statistic(&differences(&one.left[0], &other.left[0], sensors)) > SURE;
    ahead > OTHER_WEIGHTING || ahead > 0.0 && surely()
}

/// The fit that begins with parameters at their data sheet, where they are bent away from it and that is better: what was
/// missing before bent them, and from there the fit with it need not find back.
pub fn from_nominal(
    problem: &DiagnosisProblem<'_>,
    sensors: &SensorAccuracy,
    one: &CrossValidatedFit,
    until: Deadline<'_>,
) -> Option<CrossValidatedFit> {
    let ModelFit { candidate, x, .. } = &one.fit;
    if one.fit.prior() <= OTHER_WEIGHTING {
        return None;
    }
    let begun = as_they_are(problem.task(until), candidate.clone(), at_nominal(problem, candidate, x))?;
    let other = CrossValidatedFit::new(problem, begun);
    (ahead(one, &other, sensors) > 0.0).then_some(other)
}

/// A point with all parameters in their tolerances at their nominal values.
pub fn at_nominal(problem: &DiagnosisProblem<'_>, candidate: &CandidateModel, x: &[f64]) -> Vec<f64> {
    let nominal = candidate.coordinates.iter().zip(&problem.tolerances).map(|(c, t)| c.of(t.nominal));
    nominal.chain(x[problem.tolerances.len()..].iter().copied()).collect()
}

/// Evidence of left-out data for the second model, nats.
pub fn nats(a: &CrossValidatedFit, b: &CrossValidatedFit, scheme: usize, sensors: &SensorAccuracy) -> f64 {
    let tau = |i: usize| a.fit.weights.tau[i].max(b.fit.weights.tau[i]);
    let independent: Vec<f64> = (0..sensors.noise.len()).map(|i| a.fit.samples(i) / tau(i)).collect();
    evidence(&a.left[scheme], &b.left[scheme], &independent, sensors)
}

/// What the second model saves of the prior, nats: without an effect parameters bend, which left-out data do not see.
pub fn saved(a: &CrossValidatedFit, b: &CrossValidatedFit) -> f64 {
    a.fit.prior() - b.fit.prior()
}

/// Nats by which left-out pieces and the prior prefer the second model.
pub fn ahead(a: &CrossValidatedFit, b: &CrossValidatedFit, sensors: &SensorAccuracy) -> f64 {
    nats(a, b, 0, sensors) + saved(a, b)
}

/// Noise-free gap of a signal, in its unit, never quite closed.
pub fn left_by(left: &LeftOutErrors, signal: usize, sensors: &SensorAccuracy) -> f64 {
    signal_gap(left, signal, sensors).max(0.1 * LEAST * sensors.full_scale[signal])
}
