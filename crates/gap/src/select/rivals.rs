//! The hypotheses of one step as models that are fitted.

use super::super::clock::Deadline;
use super::super::effects::EffectCoefficient;
use super::super::estimate::{FitTask, ModelFit, SignalWeights};
use super::super::hypotheses::Hypothesis;
use super::super::policy::{ACCURACY, DELTA, FRONT, HOPED, OTHER_WEIGHTING, ROUGH, TRIED};
use super::super::problem::DiagnosisProblem;
use super::compare::{SensorAccuracy, needed, total_gap};
use super::criteria::RivalHypothesis;
use super::screen::{FitStart, ScreenedHypothesis, ScreeningContext, by_turns};
use super::weighed::{CrossValidatedFit, at_nominal, at_the_noise, from_nominal, no_worse, widened};
use rayon::prelude::*;

/// What came of fitting hypotheses.
pub struct RivalFits {
    /// Those that were fitted.
    pub rivals: Vec<RivalHypothesis>,
    /// Those for which the time did not last.
    pub passed: Vec<usize>,
}

/// A hypothesis after a few iterations from its most promising starts, with the weights of the model before.
struct PreliminaryFits {
    hypothesis: usize,
    starts: Vec<FitStart>,
    /// From as many of the first starts as have values.
    fits: Vec<ModelFit>,
}

/// A hypothesis after a few iterations from all its starts: the fit that the data prefer, and that with the least gap where
/// it is less by far.
struct RoughFit {
    hypothesis: usize,
    best: ModelFit,
    other: Option<ModelFit>,
}

impl RoughFit {
    fn fits(&self) -> impl Iterator<Item = &ModelFit> {
        [&self.best].into_iter().chain(&self.other)
    }
}

/// Fits hypotheses beside the model before until the time is over, in three stages, each for at most half of the time that is
/// left: from their first starts, from all starts, to the end. A stage goes on with those first that then leave least: a
/// linear model promises much that is not kept. What was not fitted to the end contends as it is. The front by both weightings
/// while there is time.
pub fn fitted(ground: &ScreeningContext<'_>, order: Vec<ScreenedHypothesis>, until: Deadline<'_>) -> RivalFits {
    let ScreeningContext { problem, sensors, .. } = *ground;
    let cost = |fits: &mut dyn Iterator<Item = &ModelFit>| fits.map(ModelFit::cost).fold(f64::INFINITY, f64::min);
    let gap = |fits: &mut dyn Iterator<Item = &ModelFit>| {
        fits.map(|f| total_gap(&f.mean_squares(), sensors)).fold(f64::INFINITY, f64::min)
    };
    let (tried, rest) = until.of_step().rounds(order, |screened| tried(ground, screened, until));
    let mut order = by_turns(tried, |t| cost(&mut t.fits.iter()), |t| gap(&mut t.fits.iter()));
    order.extend(rest.into_iter().map(|(hypothesis, starts)| PreliminaryFits { hypothesis, starts, fits: Vec::new() }));
    let (roughly, passed) = until.of_step().rounds(order, |tried| from_all(ground, tried, until));
    let roughly = roughly.into_iter().flatten().collect();
    let order = by_turns(roughly, |r: &RoughFit| cost(&mut r.fits()), |r| gap(&mut r.fits()));
    let (mut found, cut) = until.rounds(order, |r| (r.hypothesis, completed(ground, r, until)));
    found.extend(cut.into_iter().map(|r| (r.hypothesis, Some(r.best))));
    let rival = |(hypothesis, fit): (usize, Option<ModelFit>)| {
        let h = &problem.hypotheses[hypothesis];
        let model = CrossValidatedFit::new(problem, fit?);
        Some(RivalHypothesis { hypothesis, places: h.attachments.len(), size: 0.0, tolerances: None, model })
    };
    let mut rivals: Vec<RivalHypothesis> = found.into_par_iter().filter_map(rival).collect();
    rivals.sort_by(|a, b| a.model.gap(sensors).total_cmp(&b.model.gap(sensors)));
    let front = FRONT.min(rivals.len());
    rivals[..front].par_iter_mut().for_each(|rival| {
        for other in [from_nominal, at_the_noise, wider] {
            if until.is_over() {
                break;
            }
            if let Some(better) = other(problem, sensors, &rival.model, until) {
                rival.model = better;
            }
        }
    });
    rivals.par_iter_mut().for_each(|r| {
        let h = &problem.hypotheses[r.hypothesis];
        r.tolerances = tolerances(problem, h, &r.model.fit);
        r.size = size(h, &r.model.fit, r.tolerances);
    });
    RivalFits { rivals, passed: passed.into_iter().map(|t| t.hypothesis).collect() }
}

/// With widths free where what is left is worth a name: a corner that is rounder or sharper than the effect's would count
/// against the effect.
fn wider(
    problem: &DiagnosisProblem<'_>,
    sensors: &SensorAccuracy,
    one: &CrossValidatedFit,
    until: Deadline<'_>,
) -> Option<CrossValidatedFit> {
    if one.gap(sensors) > ACCURACY { widened(problem, sensors, one, until) } else { None }
}

/// A few iterations from the most promising starts of a hypothesis.
fn tried(
    ground: &ScreeningContext<'_>,
    (hypothesis, starts): ScreenedHypothesis,
    until: Deadline<'_>,
) -> PreliminaryFits {
    let task = ground.problem.task(until);
    let one = |s: &FitStart| begun(task, s, s.x.clone(), &ground.before.weights);
    let fits = starts.iter().take(TRIED).filter_map(one).collect();
    PreliminaryFits { hypothesis, starts, fits }
}

/// A few iterations from a start.
fn begun(task: FitTask<'_>, start: &FitStart, x: Vec<f64>, weights: &SignalWeights) -> Option<ModelFit> {
    let mut fit = ModelFit::begun(start.candidate.clone(), x, task, Some(weights))?;
    fit.descend(task, ROUGH);
    Some(fit)
}

/// A few iterations from every start.
fn from_all(ground: &ScreeningContext<'_>, tried: PreliminaryFits, until: Deadline<'_>) -> Option<RoughFit> {
    let hypothesis = tried.hypothesis;
    let mut all = rough(ground, ground.problem.task(until), tried);
    let gap = |f: &ModelFit| total_gap(&f.mean_squares(), ground.sensors);
    let least = |a: &ModelFit, b: &ModelFit| gap(a).total_cmp(&gap(b));
    let first = (0..all.len()).reduce(|a, b| if all[a].ahead(&all[b]) > 0.0 { b } else { a })?;
    let best = all.swap_remove(first);
    let other = all.into_iter().min_by(least).filter(|f| gap(f) < (1.0 - DELTA) * gap(&best));
    Some(RoughFit { hypothesis, best, other })
}

/// The best fit of a hypothesis, to the end where it gains anything, and, while there is time, that with the least gap.
fn completed(
    ground: &ScreeningContext<'_>,
    RoughFit { best, other, .. }: RoughFit,
    until: Deadline<'_>,
) -> Option<ModelFit> {
    let ScreeningContext { problem, before, .. } = *ground;
    let falls = |f: &ModelFit| {
        f.mean_squares().iter().zip(before.mean_squares()).any(|(now, then)| *now < (1.0 - HOPED) * then)
    };
    let gains = before.ahead(&best) > needed(problem.hypotheses.len());
    if !falls(&best) && !gains && !other.as_ref().is_some_and(falls) {
        return Some(best);
    }
    let completed = |f: ModelFit| no_worse(problem.task(until), before, f.candidate, f.x);
    let other = other.filter(|_| !until.is_over());
    [Some(best), other].into_iter().flatten().filter_map(completed).reduce(ModelFit::better_of)
}

/// A few iterations from every start, with the weights of the model before; those with the least cost and the least gap go on.
/// Sizes are looked for over the decades where the linear model has not kept its promise. Where the model before is bent away
/// from the data sheet, its weights may count little what the hypothesis explains: then also as if only the sensors' noise
/// were left, which finds the size that the data ask for, and from there with parameters at the data sheet again.
fn rough(
    ground: &ScreeningContext<'_>,
    task: FitTask<'_>,
    PreliminaryFits { hypothesis, mut starts, fits: mut bent }: PreliminaryFits,
) -> Vec<ModelFit> {
    let ScreeningContext { problem, sensors, before } = *ground;
    let costs = |a: &ModelFit, b: &ModelFit| a.cost().total_cmp(&b.cost());
    let gap = |f: &ModelFit| total_gap(&f.mean_squares(), sensors);
    let as_before = |s: &FitStart| begun(task, s, s.x.clone(), &before.weights);
    bent.extend(starts.iter().skip(if bent.is_empty() { 0 } else { TRIED }).filter_map(as_before));
    let promised = starts.iter().map(FitStart::promises).fold(f64::INFINITY, f64::min);
    let off = before.cost();
    if !bent.iter().any(|f| off - f.cost() >= (1.0 - DELTA) * (off - promised)) {
        let sizes = starts.first().map(|s| ground.of_size(hypothesis, s, task.until)).unwrap_or_default();
        bent.extend(sizes.iter().filter_map(as_before));
        starts.extend(sizes);
    }
    bent.sort_by(costs);
    let open = (1..bent.len()).min_by(|&a, &b| gap(&bent[a]).total_cmp(&gap(&bent[b])));
    let mut found: Vec<ModelFit> =
        open.map(|k| bent.swap_remove(k)).into_iter().chain(bent.into_iter().take(1)).collect();
    found.iter_mut().for_each(|f| f.descend(task, ROUGH));
    if before.prior() > OTHER_WEIGHTING {
        let white = SignalWeights::sensors(&sensors.noise, task.full_scale);
        let unbent = |s: &FitStart| begun(task, s, at_nominal(problem, &s.candidate, &s.x), &white);
        let sized = starts.iter().filter_map(unbent).min_by(costs);
        found.extend(sized.and_then(|mut sized| {
            sized.descend(task, ROUGH);
            let x = at_nominal(problem, &sized.candidate, &sized.x);
            let mut fit = ModelFit::begun(sized.candidate, x, task, None)?;
            fit.descend(task, 2 * ROUGH);
            Some(fit)
        }));
    }
    found
}

/// By how many of its tolerances a parameter is off its data sheet; nothing for effects.
fn tolerances(problem: &DiagnosisProblem<'_>, h: &Hypothesis, fit: &ModelFit) -> Option<f64> {
    let &k = fit.candidate.model.attached.last().filter(|_| h.family == "parameter")?.first()?;
    let t = &problem.tolerances[k];
    Some((fit.x[k] - t.nominal / t.sigma).abs())
}

/// By how many of its standard deviations the largest free coefficient of a model's last cause differs from nothing; a
/// parameter that is off by so many tolerances from its data sheet, what is known of both counted.
fn size(h: &Hypothesis, fit: &ModelFit, tolerances: Option<f64>) -> f64 {
    let Some(places) = fit.candidate.model.attached.last().filter(|_| !h.is_shape()) else { return f64::INFINITY };
    let deviations = fit.deviations();
    if let (Some(off), Some(&k)) = (tolerances, places.first()) {
        return off / deviations[k].hypot(1.0);
    }
    let coordinates = &fit.candidate.coordinates;
    let one = |(c, &place): (&EffectCoefficient, &usize)| {
        let k = coordinates.iter().position(|own| own.parameter == place)?;
        let off = (fit.x[k] - coordinates[k].of(c.off)).abs();
        Some(if off > 0.0 { off / deviations[k] } else { 0.0 })
    };
    h.coefficients.iter().zip(places).filter_map(one).reduce(f64::max).unwrap_or(f64::INFINITY)
}
