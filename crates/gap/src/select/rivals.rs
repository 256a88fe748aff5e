//! Fits of the screened hypotheses of one step.
//!
//! Enters: hypotheses with their starts, ordered by `screen`. Leaves: [`RivalHypothesis`] entries for `criteria`.
//! Fitting goes in three stages, each for at most half of the time that is left, and each stage goes on with those
//! first that leave least so far. Method: `docs/gap_method.md`, "Order of the hypotheses", last paragraph.

use super::super::clock::Deadline;
use super::super::effects::EffectCoefficient;
use super::super::estimate::{FitTask, ModelFit, SignalWeights};
use super::super::hypotheses::Hypothesis;
use super::super::problem::DiagnosisProblem;
use super::compare::{SensorAccuracy, needed, total_gap};
use super::criteria::RivalHypothesis;
use super::screen::{FitStart, ScreenedHypothesis, ScreeningContext, by_turns};
use super::weighed::{CrossValidatedFit, at_nominal, at_the_noise, from_nominal, no_worse, widened};
use crate::policy::{ACCURACY, DELTA, FRONT, HOPED, OTHER_WEIGHTING, ROUGH, TRIED};
use rayon::prelude::*;

/// Result of fitting the hypotheses of a step.
pub struct RivalFits {
    /// Fitted hypotheses with their left-out errors, in the order of their gaps, the least first.
    pub rivals: Vec<RivalHypothesis>,
    /// Indices of hypotheses that were not fitted for lack of time.
    pub passed: Vec<usize>,
}

/// A hypothesis behind the first stage: fits of [`ROUGH`] iterations from its first starts.
struct PreliminaryFits {
    /// Index of the hypothesis.
    hypothesis: usize,
    /// All its starts, the most promising first.
    starts: Vec<FitStart>,
    /// Fits from the first [`TRIED`] starts at which the model can be simulated; empty if the time was over.
    fits: Vec<ModelFit>,
}

/// A hypothesis behind the second stage: fits from all its starts.
struct RoughFit {
    /// Index of the hypothesis.
    hypothesis: usize,
    /// The fit that the train data and the prior prefer.
    best: ModelFit,
    /// The fit with the least gap, if its gap is less than that of `best` by the part [`DELTA`].
    other: Option<ModelFit>,
}

impl RoughFit {
    /// One or two fits.
    fn fits(&self) -> impl Iterator<Item = &ModelFit> {
        [&self.best].into_iter().chain(&self.other)
    }
}

/// Fits hypotheses beside the model before, until the deadline.
///
/// Stage 1: two iterations from the first two starts. Stage 2: all starts, and sizes looked for over decades. Stage 3:
/// to the end. A linear model may promise much more than a fit keeps, hence the order anew behind each stage.
/// A hypothesis that did not reach stage 3 competes with the fit that it has.
/// The [`FRONT`] rivals with the least gap are fitted with other weightings and free widths too, while there is time.
pub fn fitted(ground: &ScreeningContext<'_>, order: Vec<ScreenedHypothesis>, until: Deadline<'_>) -> RivalFits {
    let ScreeningContext { problem, sensors, .. } = *ground;
    let cost = |fits: &mut dyn Iterator<Item = &ModelFit>| fits.map(ModelFit::cost).fold(f64::INFINITY, f64::min);
    let gap = |fits: &mut dyn Iterator<Item = &ModelFit>| {
        fits.map(|f| total_gap(&f.mean_squares(), sensors)).fold(f64::INFINITY, f64::min)
    };
    let (tried, rest) = until.of_step().rounds(order, |screened| tried(ground, screened, until));
    let mut order = by_turns(tried, |t| cost(&mut t.fits.iter()), |t| gap(&mut t.fits.iter()));
    // those without a fit come behind all others
    order.extend(rest.into_iter().map(|(hypothesis, starts)| PreliminaryFits { hypothesis, starts, fits: Vec::new() }));
    let (roughly, passed) = until.of_step().rounds(order, |tried| from_all(ground, tried, until));
    let roughly = roughly.into_iter().flatten().collect();
    let order = by_turns(roughly, |r: &RoughFit| cost(&mut r.fits()), |r| gap(&mut r.fits()));
    let (mut found, cut) = until.rounds(order, |r| (r.hypothesis, completed(ground, r, until)));
    // these compete with their rough fits
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
        // each variant replaces the fit only if left-out data prefer it
        for other in [from_nominal, at_the_noise, wider] {
            if until.is_over() {
                break;
            }
            if let Some(better) = other(problem, sensors, &rival.model, until) {
                rival.model = better;
            }
        }
    });
    // sizes are read off at the end, because the variants above change the fits
    rivals.par_iter_mut().for_each(|r| {
        let h = &problem.hypotheses[r.hypothesis];
        r.tolerances = tolerances(problem, h, &r.model.fit);
        r.size = size(h, &r.model.fit, r.tolerances);
    });
    RivalFits { rivals, passed: passed.into_iter().map(|t| t.hypothesis).collect() }
}

/// The model with the widths of its corners free, if its gap is worth a name and left-out data prefer it.
/// A corner that is rounder or sharper than the fixed width would count against the effect.
fn wider(
    problem: &DiagnosisProblem<'_>,
    sensors: &SensorAccuracy,
    one: &CrossValidatedFit,
    until: Deadline<'_>,
) -> Option<CrossValidatedFit> {
    if one.gap(sensors) > ACCURACY { widened(problem, sensors, one, until) } else { None }
}

/// Stage 1: fits from the first [`TRIED`] starts of a hypothesis.
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

/// A fit of [`ROUGH`] iterations from a start at `x`. `None` if the model cannot be simulated there.
fn begun(task: FitTask<'_>, start: &FitStart, x: Vec<f64>, weights: &SignalWeights) -> Option<ModelFit> {
    let mut fit = ModelFit::begun(start.candidate.clone(), x, task, Some(weights))?;
    fit.descend(task, ROUGH);
    Some(fit)
}

/// Stage 2: fits from every start. `None` if the model cannot be simulated at any.
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

/// Stage 3: the fits of a hypothesis to their optimum, and the better one of them.
/// A hypothesis that lowers no signal's mean square by [`HOPED`] and gains no evidence stays at its rough fit.
fn completed(
    ground: &ScreeningContext<'_>,
    RoughFit { best, other, .. }: RoughFit,
    until: Deadline<'_>,
) -> Option<ModelFit> {
    let ScreeningContext { problem, before, .. } = *ground;
    // mean squares are compared signal by signal, since an effect may act on one signal only
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

/// Fits from all starts of a hypothesis: that with the least cost, and of the others that with the least gap.
///
/// Where no fit reaches nine tenths of what the linear model promised, the size is looked for over decades.
/// Where the model before has parameters far off their data sheet, its weights may count little what the hypothesis
/// explains. Then the hypothesis is also fitted as if only the sensors' noise were left, which finds the size that the
/// data ask for. From there it is fitted again with parameters at their data sheet.
fn rough(
    ground: &ScreeningContext<'_>,
    task: FitTask<'_>,
    PreliminaryFits { hypothesis, mut starts, fits: mut bent }: PreliminaryFits,
) -> Vec<ModelFit> {
    let ScreeningContext { problem, sensors, before } = *ground;
    let costs = |a: &ModelFit, b: &ModelFit| a.cost().total_cmp(&b.cost());
    let gap = |f: &ModelFit| total_gap(&f.mean_squares(), sensors);
    let as_before = |s: &FitStart| begun(task, s, s.x.clone(), &before.weights);
    // the first starts were fitted in stage 1
    bent.extend(starts.iter().skip(if bent.is_empty() { 0 } else { TRIED }).filter_map(as_before));
    let promised = starts.iter().map(FitStart::promises).fold(f64::INFINITY, f64::min);
    let off = before.cost();
    // a scan over decades takes many runs, so it is left out where the linear model was right
    if !bent.iter().any(|f| off - f.cost() >= (1.0 - DELTA) * (off - promised)) {
        let sizes = starts.first().map(|s| ground.of_size(hypothesis, s, task.until)).unwrap_or_default();
        bent.extend(sizes.iter().filter_map(as_before));
        starts.extend(sizes);
    }
    bent.sort_by(costs);
    // position 0 has the least cost; the least gap is looked for among the others
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
            // only the size of the effect is kept from the fit at the noise
            let x = at_nominal(problem, &sized.candidate, &sized.x);
            let mut fit = ModelFit::begun(sized.candidate, x, task, None)?;
            fit.descend(task, 2 * ROUGH);
            Some(fit)
        }));
    }
    found
}

/// Distance of a freed parameter from its data sheet, in tolerances; `None` for effects.
fn tolerances(problem: &DiagnosisProblem<'_>, h: &Hypothesis, fit: &ModelFit) -> Option<f64> {
    let &k = fit.candidate.model.attached.last().filter(|_| h.family == "parameter")?.first()?;
    let t = &problem.tolerances[k];
    Some((fit.x[k] - t.nominal / t.sigma).abs())
}

/// Distance of the largest free coefficient of the last cause from zero, in standard deviations; infinite for shapes
/// and where no coefficient is free. For a parameter: its distance from the data sheet over the combined deviation of
/// tolerance and estimate.
fn size(h: &Hypothesis, fit: &ModelFit, tolerances: Option<f64>) -> f64 {
    let Some(places) = fit.candidate.model.attached.last().filter(|_| !h.is_shape()) else { return f64::INFINITY };
    let deviations = fit.deviations();
    if let (Some(off), Some(&k)) = (tolerances, places.first()) {
        // in units of the tolerance, whose own deviation is 1
        return off / deviations[k].hypot(1.0);
    }
    let coordinates = &fit.candidate.coordinates;
    let one = |(c, &place): (&EffectCoefficient, &usize)| {
        let k = coordinates.iter().position(|own| own.parameter == place)?;
        let off = (fit.x[k] - coordinates[k].of(c.off)).abs();
        // at zero, where a bound may hold it, a coefficient has no deviation to divide by
        Some(if off > 0.0 { off / deviations[k] } else { 0.0 })
    };
    h.coefficients.iter().zip(places).filter_map(one).reduce(f64::max).unwrap_or(f64::INFINITY)
}
