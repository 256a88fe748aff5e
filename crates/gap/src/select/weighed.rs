//! Models with what they leave of left-out data, by both weightings.

use super::super::clock::Deadline;
use super::super::estimate::{Candidate, Fit, Task, Weights};
use super::super::policy::{LEAST, OTHER_WEIGHTING, SETTLING, SURE};
use super::super::problem::Problem;
use super::compare::{Sensors, differences, evidence, gap, signal_gap, t_statistic};
use super::folds::{LeftOut, left_out};
use super::models;

/// A fit with what it leaves of left-out data.
#[derive(Clone, Debug)]
pub struct Weighed {
    /// The fit.
    pub fit: Fit,
    /// By pieces, and by recordings where there are enough.
    pub left: Vec<LeftOut>,
}

impl Weighed {
    /// Simulates what was left out.
    pub fn new(problem: &Problem<'_>, fit: Fit) -> Self {
        Weighed { left: left_out(&fit, &problem.train), fit }
    }

    /// Noise-free gap of left-out pieces over all signals, in parts of full scale.
    pub fn gap(&self, sensors: &Sensors) -> f64 {
        gap(&self.left[0], sensors)
    }
}

/// Both weightings: errors as they are now (tolerances hold), and as if only the sensors' noise were left (the data hold).
/// Left-out data and the prior decide. Once the time is over the first one stands.
pub fn weighed(
    problem: &Problem<'_>,
    sensors: &Sensors,
    (candidate, x): (Candidate, Vec<f64>),
    until: Deadline<'_>,
) -> Option<Weighed> {
    let task = problem.task(until);
    let one = Weighed::new(problem, as_they_are(task, candidate, x)?);
    let other = if until.is_over() { None } else { at_the_noise(problem, sensors, &one, until) };
    Some(other.unwrap_or(one))
}

/// A model fitted again with the weights that it left, until left-out data see no difference or the time is over: what is
/// not at its optimum would be improved by any effect. The first of these fits takes the time that it needs.
pub fn settled(problem: &Problem<'_>, sensors: &Sensors, mut model: Weighed, until: Deadline<'_>) -> Weighed {
    for round in 0..SETTLING {
        let until = if round == 0 { Deadline::default() } else { until };
        if until.is_over() {
            break;
        }
        let (candidate, x) = (model.fit.candidate.clone(), model.fit.x.clone());
        let Some(fit) = as_they_are(problem.task(until), candidate, x) else { break };
        let next = Weighed::new(problem, fit);
        if !better(&model, &next, sensors) {
            break;
        }
        model = next;
    }
    model
}

/// The model with the widths of all its effects free, where that is better.
pub fn widened(problem: &Problem<'_>, sensors: &Sensors, one: &Weighed, until: Deadline<'_>) -> Option<Weighed> {
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
pub fn as_in(problem: &Problem<'_>, sensors: &Sensors, before: &Weighed, rival: &Fit) -> Option<Weighed> {
    // the coordinates of the cause that it has beyond the model before stand last
    let x = rival.x[..before.fit.x.len()].to_vec();
    let other = Weighed::new(problem, as_they_are(problem.task(Deadline::default()), before.fit.candidate.clone(), x)?);
    better(before, &other, sensors).then_some(other)
}

/// A fit that weighs errors as large and as correlated as it leaves them.
fn as_they_are(task: Task<'_>, candidate: Candidate, x: Vec<f64>) -> Option<Fit> {
    Fit::of(candidate, x, task, None, 2)
}

/// The same of a model that holds the one before: where it comes out behind, it begins with the weights of that one.
pub fn no_worse(task: Task<'_>, before: &Fit, candidate: Candidate, x: Vec<f64>) -> Option<Fit> {
    let fit = as_they_are(task, candidate.clone(), x.clone());
    if fit.as_ref().is_some_and(|f| before.ahead(f) >= 0.0) {
        return fit;
    }
    let weights = Some(before.weights.clone());
    let other = Fit::of(candidate, x, task, weights, 2);
    fit.into_iter().chain(other).reduce(Fit::better_of)
}

/// The fit that begins where only the sensors' noise is left, where it is better.
pub fn at_the_noise(problem: &Problem<'_>, sensors: &Sensors, one: &Weighed, until: Deadline<'_>) -> Option<Weighed> {
    let task = problem.task(until);
    let white = Weights::sensors(&sensors.noise, &problem.full_scale);
    let (candidate, x) = (one.fit.candidate.clone(), one.fit.x.clone());
    let begun = Fit::of(candidate, x, task, Some(white), 1)?;
    let other = Weighed::new(problem, as_they_are(task, begun.candidate, begun.x)?);
    better(one, &other, sensors).then_some(other)
}

/// Whether left-out data prefer the second of two fits of one model: by their evidence, or block by block.
fn better(one: &Weighed, other: &Weighed, sensors: &Sensors) -> bool {
    let ahead = ahead(one, other, sensors);
    let surely = || t_statistic(&differences(&one.left[0], &other.left[0], sensors)) > SURE;
    ahead > OTHER_WEIGHTING || ahead > 0.0 && surely()
}

/// The fit that begins with parameters at their data sheet, where they are bent away from it and that is better: what was
/// missing before bent them, and from there the fit with it need not find back.
pub fn from_nominal(problem: &Problem<'_>, sensors: &Sensors, one: &Weighed, until: Deadline<'_>) -> Option<Weighed> {
    let Fit { candidate, x, .. } = &one.fit;
    if one.fit.prior() <= OTHER_WEIGHTING {
        return None;
    }
    let begun = as_they_are(problem.task(until), candidate.clone(), at_nominal(problem, candidate, x))?;
    let other = Weighed::new(problem, begun);
    (ahead(one, &other, sensors) > 0.0).then_some(other)
}

/// A point with all parameters in their tolerances at their nominal values.
pub fn at_nominal(problem: &Problem<'_>, candidate: &Candidate, x: &[f64]) -> Vec<f64> {
    let nominal = candidate.coordinates.iter().zip(&problem.tolerances).map(|(c, t)| c.of(t.nominal));
    nominal.chain(x[problem.tolerances.len()..].iter().copied()).collect()
}

/// Evidence of left-out data for the second model, nats.
pub fn nats(a: &Weighed, b: &Weighed, scheme: usize, sensors: &Sensors) -> f64 {
    let tau = |i: usize| a.fit.weights.tau[i].max(b.fit.weights.tau[i]);
    let independent: Vec<f64> = (0..sensors.noise.len()).map(|i| a.fit.samples(i) / tau(i)).collect();
    evidence(&a.left[scheme], &b.left[scheme], &independent, sensors)
}

/// What the second model saves of the prior, nats: without an effect parameters bend, which left-out data do not see.
pub fn saved(a: &Weighed, b: &Weighed) -> f64 {
    a.fit.prior() - b.fit.prior()
}

/// Nats by which left-out pieces and the prior prefer the second model.
pub fn ahead(a: &Weighed, b: &Weighed, sensors: &Sensors) -> f64 {
    nats(a, b, 0, sensors) + saved(a, b)
}

/// Noise-free gap of a signal, in its unit, never quite closed.
pub fn left_by(left: &LeftOut, signal: usize, sensors: &Sensors) -> f64 {
    signal_gap(left, signal, sensors).max(0.1 * LEAST * sensors.full_scale[signal])
}
