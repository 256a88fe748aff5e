//! The hypotheses of one step as models that are fitted.

use super::super::clock::Deadline;
use super::super::effects::Coefficient;
use super::super::estimate::{Fit, Task, Weights};
use super::super::hypotheses::Hypothesis;
use super::super::policy::{ACCURACY, DELTA, FRONT, HOPED, OTHER_WEIGHTING, ROUGH, TRIED};
use super::super::problem::Problem;
use super::compare::{Sensors, needed, total_gap};
use super::criteria::Rival;
use super::screen::{Ground, Screened, Start, by_turns};
use super::weighed::{Weighed, at_nominal, at_the_noise, from_nominal, no_worse, widened};
use rayon::prelude::*;

/// What came of fitting hypotheses.
pub struct Fitted {
    /// Those that were fitted.
    pub rivals: Vec<Rival>,
    /// Those for which the time did not last.
    pub passed: Vec<usize>,
}

/// A hypothesis after a few iterations from its most promising starts, with the weights of the model before.
struct Tried {
    hypothesis: usize,
    starts: Vec<Start>,
    /// From as many of the first starts as have values.
    fits: Vec<Fit>,
}

/// A hypothesis after a few iterations from all its starts: the fit that the data prefer, and that with the least gap where
/// it is less by far.
struct Rough {
    hypothesis: usize,
    best: Fit,
    other: Option<Fit>,
}

impl Rough {
    fn fits(&self) -> impl Iterator<Item = &Fit> {
        [&self.best].into_iter().chain(&self.other)
    }
}

/// Fits hypotheses beside the model before until the time is over, in three stages, each for at most half of the time that is
/// left: from their first starts, from all starts, to the end. A stage goes on with those first that then leave least: a
/// linear model promises much that is not kept. What was not fitted to the end contends as it is. The front by both weightings
/// while there is time.
pub fn fitted(ground: &Ground<'_>, order: Vec<Screened>, until: Deadline<'_>) -> Fitted {
    let Ground { problem, sensors, .. } = *ground;
    let cost = |fits: &mut dyn Iterator<Item = &Fit>| fits.map(Fit::cost).fold(f64::INFINITY, f64::min);
    let gap = |fits: &mut dyn Iterator<Item = &Fit>| {
        fits.map(|f| total_gap(&f.mean_squares(), sensors)).fold(f64::INFINITY, f64::min)
    };
    let (tried, rest) = until.of_step().rounds(order, |screened| tried(ground, screened, until));
    let mut order = by_turns(tried, |t| cost(&mut t.fits.iter()), |t| gap(&mut t.fits.iter()));
    order.extend(rest.into_iter().map(|(hypothesis, starts)| Tried { hypothesis, starts, fits: Vec::new() }));
    let (roughly, passed) = until.of_step().rounds(order, |tried| from_all(ground, tried, until));
    let roughly = roughly.into_iter().flatten().collect();
    let order = by_turns(roughly, |r: &Rough| cost(&mut r.fits()), |r| gap(&mut r.fits()));
    let (mut found, cut) = until.rounds(order, |r| (r.hypothesis, completed(ground, r, until)));
    found.extend(cut.into_iter().map(|r| (r.hypothesis, Some(r.best))));
    let rival = |(hypothesis, fit): (usize, Option<Fit>)| {
        let h = &problem.hypotheses[hypothesis];
        let model = Weighed::new(problem, fit?);
        Some(Rival { hypothesis, places: h.attachments.len(), size: 0.0, tolerances: None, model })
    };
    let mut rivals: Vec<Rival> = found.into_par_iter().filter_map(rival).collect();
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
    Fitted { rivals, passed: passed.into_iter().map(|t| t.hypothesis).collect() }
}

/// With widths free where what is left is worth a name: a corner that is rounder or sharper than the effect's would count
/// against the effect.
fn wider(problem: &Problem<'_>, sensors: &Sensors, one: &Weighed, until: Deadline<'_>) -> Option<Weighed> {
    if one.gap(sensors) > ACCURACY { widened(problem, sensors, one, until) } else { None }
}

/// A few iterations from the most promising starts of a hypothesis.
fn tried(ground: &Ground<'_>, (hypothesis, starts): Screened, until: Deadline<'_>) -> Tried {
    let task = ground.problem.task(until);
    let one = |s: &Start| begun(task, s, s.x.clone(), &ground.before.weights);
    let fits = starts.iter().take(TRIED).filter_map(one).collect();
    Tried { hypothesis, starts, fits }
}

/// A few iterations from a start.
fn begun(task: Task<'_>, start: &Start, x: Vec<f64>, weights: &Weights) -> Option<Fit> {
    let mut fit = Fit::begun(start.candidate.clone(), x, task, Some(weights))?;
    fit.descend(task, ROUGH);
    Some(fit)
}

/// A few iterations from every start.
fn from_all(ground: &Ground<'_>, tried: Tried, until: Deadline<'_>) -> Option<Rough> {
    let hypothesis = tried.hypothesis;
    let mut all = rough(ground, ground.problem.task(until), tried);
    let gap = |f: &Fit| total_gap(&f.mean_squares(), ground.sensors);
    let least = |a: &Fit, b: &Fit| gap(a).total_cmp(&gap(b));
    let first = (0..all.len()).reduce(|a, b| if all[a].ahead(&all[b]) > 0.0 { b } else { a })?;
    let best = all.swap_remove(first);
    let other = all.into_iter().min_by(least).filter(|f| gap(f) < (1.0 - DELTA) * gap(&best));
    Some(Rough { hypothesis, best, other })
}

/// The best fit of a hypothesis, to the end where it gains anything, and, while there is time, that with the least gap.
fn completed(ground: &Ground<'_>, Rough { best, other, .. }: Rough, until: Deadline<'_>) -> Option<Fit> {
    let Ground { problem, before, .. } = *ground;
    let falls =
        |f: &Fit| f.mean_squares().iter().zip(before.mean_squares()).any(|(now, then)| *now < (1.0 - HOPED) * then);
    let gains = before.ahead(&best) > needed(problem.hypotheses.len());
    if !falls(&best) && !gains && !other.as_ref().is_some_and(falls) {
        return Some(best);
    }
    let completed = |f: Fit| no_worse(problem.task(until), before, f.candidate, f.x);
    let other = other.filter(|_| !until.is_over());
    [Some(best), other].into_iter().flatten().filter_map(completed).reduce(Fit::better_of)
}

/// A few iterations from every start, with the weights of the model before; those with the least cost and the least gap go on.
/// Sizes are looked for over the decades where the linear model has not kept its promise. Where the model before is bent away
/// from the data sheet, its weights may count little what the hypothesis explains: then also as if only the sensors' noise
/// were left, which finds the size that the data ask for, and from there with parameters at the data sheet again.
fn rough(ground: &Ground<'_>, task: Task<'_>, Tried { hypothesis, mut starts, fits: mut bent }: Tried) -> Vec<Fit> {
    let Ground { problem, sensors, before } = *ground;
    let costs = |a: &Fit, b: &Fit| a.cost().total_cmp(&b.cost());
    let gap = |f: &Fit| total_gap(&f.mean_squares(), sensors);
    let as_before = |s: &Start| begun(task, s, s.x.clone(), &before.weights);
    bent.extend(starts.iter().skip(if bent.is_empty() { 0 } else { TRIED }).filter_map(as_before));
    let promised = starts.iter().map(Start::promises).fold(f64::INFINITY, f64::min);
    let off = before.cost();
    if !bent.iter().any(|f| off - f.cost() >= (1.0 - DELTA) * (off - promised)) {
        let sizes = starts.first().map(|s| ground.of_size(hypothesis, s, task.until)).unwrap_or_default();
        bent.extend(sizes.iter().filter_map(as_before));
        starts.extend(sizes);
    }
    bent.sort_by(costs);
    let open = (1..bent.len()).min_by(|&a, &b| gap(&bent[a]).total_cmp(&gap(&bent[b])));
    let mut found: Vec<Fit> = open.map(|k| bent.swap_remove(k)).into_iter().chain(bent.into_iter().take(1)).collect();
    found.iter_mut().for_each(|f| f.descend(task, ROUGH));
    if before.prior() > OTHER_WEIGHTING {
        let white = Weights::sensors(&sensors.noise, task.full_scale);
        let unbent = |s: &Start| begun(task, s, at_nominal(problem, &s.candidate, &s.x), &white);
        let sized = starts.iter().filter_map(unbent).min_by(costs);
        found.extend(sized.and_then(|mut sized| {
            sized.descend(task, ROUGH);
            let x = at_nominal(problem, &sized.candidate, &sized.x);
            let mut fit = Fit::begun(sized.candidate, x, task, None)?;
            fit.descend(task, 2 * ROUGH);
            Some(fit)
        }));
    }
    found
}

/// By how many of its tolerances a parameter is off its data sheet; nothing for effects.
fn tolerances(problem: &Problem<'_>, h: &Hypothesis, fit: &Fit) -> Option<f64> {
    let &k = fit.candidate.model.attached.last().filter(|_| h.family == "parameter")?.first()?;
    let t = &problem.tolerances[k];
    Some((fit.x[k] - t.nominal / t.sigma).abs())
}

/// By how many of its standard deviations the largest free coefficient of a model's last cause differs from nothing; a
/// parameter that is off by so many tolerances from its data sheet, what is known of both counted.
fn size(h: &Hypothesis, fit: &Fit, tolerances: Option<f64>) -> f64 {
    let Some(places) = fit.candidate.model.attached.last().filter(|_| !h.is_shape()) else { return f64::INFINITY };
    let deviations = fit.deviations();
    if let (Some(off), Some(&k)) = (tolerances, places.first()) {
        return off / deviations[k].hypot(1.0);
    }
    let coordinates = &fit.candidate.coordinates;
    let one = |(c, &place): (&Coefficient, &usize)| {
        let k = coordinates.iter().position(|own| own.parameter == place)?;
        let off = (fit.x[k] - coordinates[k].of(c.off)).abs();
        Some(if off > 0.0 { off / deviations[k] } else { 0.0 })
    };
    h.coefficients.iter().zip(places).filter_map(one).reduce(f64::max).unwrap_or(f64::INFINITY)
}
