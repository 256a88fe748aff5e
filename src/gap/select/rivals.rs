//! The hypotheses of one step as models that are fitted.

use super::super::effects::Coefficient;
use super::super::estimate::{Fit, Weights};
use super::super::hypotheses::Hypothesis;
use super::super::policy::{DELTA, FRONT, HOPED, OTHER_WEIGHTING};
use super::super::problem::Problem;
use super::clock::Deadline;
use super::compare::{needed, total_gap};
use super::criteria::Rival;
use super::screen::{Ground, Screened, Start};
use super::weighed::{Weighed, at_nominal, at_the_noise, from_nominal, no_worse};
use rayon::prelude::*;

/// What came of fitting hypotheses.
pub struct Fitted {
    /// Those that were fitted.
    pub rivals: Vec<Rival>,
    /// Those for which the time did not last.
    pub passed: Vec<usize>,
}

/// Fits hypotheses from all their starts, beside the model before, until the time is over; at least the first ones. The
/// front by both weightings while there is time.
pub fn fitted(ground: &Ground<'_>, order: Vec<Screened>, until: Deadline<'_>) -> Fitted {
    let Ground { problem, sensors, .. } = *ground;
    let one = |(hypothesis, starts): Screened| {
        let fit = from_all(ground, needed(problem.hypotheses.len()), hypothesis, starts, until)?;
        let h = &problem.hypotheses[hypothesis];
        let (places, is_parameter) = (h.attachments.len(), h.family == "parameter");
        Some(Rival { hypothesis, places, size: 0.0, is_parameter, model: Weighed::new(problem, fit) })
    };
    let (found, passed) = until.rounds(order, one);
    let mut rivals: Vec<Rival> = found.into_iter().flatten().collect();
    rivals.sort_by(|a, b| a.model.gap(sensors).total_cmp(&b.model.gap(sensors)));
    let front = FRONT.min(rivals.len());
    rivals[..front].par_iter_mut().for_each(|rival| {
        for other in [from_nominal, at_the_noise] {
            if until.is_over() {
                break;
            }
            if let Some(better) = other(problem, sensors, &rival.model) {
                rival.model = better;
            }
        }
    });
    rivals.par_iter_mut().for_each(|r| r.size = size(problem, &problem.hypotheses[r.hypothesis], &r.model.fit));
    Fitted { rivals, passed: passed.into_iter().map(|s| s.0).collect() }
}

/// A few iterations from every start; where they gain anything, the best fit is completed, and, while there is time, that
/// with the least gap if it is less by far.
fn from_all(
    ground: &Ground<'_>,
    needed: f64,
    hypothesis: usize,
    mut starts: Vec<Start>,
    until: Deadline<'_>,
) -> Option<Fit> {
    let sizes = starts.first().map(|s| ground.of_size(hypothesis, s)).unwrap_or_default();
    starts.extend(sizes);
    let Ground { problem, sensors, before } = *ground;
    let mut all: Vec<Fit> = starts.into_iter().filter_map(|s| rough(ground, s)).collect();
    let gap = |f: &Fit| total_gap(&f.mean_squares(), sensors);
    let least = |a: &Fit, b: &Fit| gap(a).total_cmp(&gap(b));
    let first = (0..all.len()).reduce(|a, b| if all[a].ahead(&all[b]) > 0.0 { b } else { a })?;
    let best = all.swap_remove(first);
    let other = all.into_iter().min_by(least).filter(|f| gap(f) < (1.0 - DELTA) * gap(&best));
    let falls =
        |f: &Fit| f.mean_squares().iter().zip(before.mean_squares()).any(|(now, then)| *now < (1.0 - HOPED) * then);
    if !falls(&best) && before.ahead(&best) <= needed && !other.as_ref().is_some_and(falls) {
        return Some(best);
    }
    let completed = |f: Fit| no_worse(problem, before, f.candidate, f.x);
    let other = other.filter(|_| !until.is_over());
    [Some(best), other].into_iter().flatten().filter_map(completed).reduce(Fit::better_of)
}

/// A few iterations from a start, with the weights of the model before. Where that is bent away from the data sheet, they may
/// count little what the hypothesis explains: then also as if only the sensors' noise were left, which finds the size that the
/// data ask for, and from there with parameters at the data sheet again.
fn rough(ground: &Ground<'_>, start: Start) -> Option<Fit> {
    let Ground { problem, sensors, before } = *ground;
    let (candidate, x, train) = (start.candidate, start.x, &problem.train);
    let unbent = (before.prior() > OTHER_WEIGHTING).then(|| {
        let white = Weights::sensors(&sensors.noise, &problem.full_scale);
        let sized = Fit::rough(candidate.clone(), at_nominal(problem, &candidate, &x), train, &white)?;
        let x = at_nominal(problem, &sized.candidate, &sized.x);
        Fit::rough_by_errors(sized.candidate, x, train, &problem.full_scale)
    });
    let bent = Fit::rough(candidate, x, train, &before.weights);
    bent.into_iter().chain(unbent.flatten()).reduce(Fit::better_of)
}

/// By how many of its standard deviations the largest free coefficient of a model's last cause differs from nothing; a
/// parameter that is said to be out of tolerance from its data sheet, what is known of both counted.
fn size(problem: &Problem<'_>, h: &Hypothesis, fit: &Fit) -> f64 {
    let Some(places) = fit.candidate.model.attached.last().filter(|_| !h.is_shape()) else { return f64::INFINITY };
    let deviations = fit.deviations();
    if let ("parameter", Some(&k)) = (h.family.as_str(), places.first()) {
        let t = &problem.tolerances[k];
        return (fit.x[k] - t.nominal / t.sigma).abs() / deviations[k].hypot(1.0);
    }
    let coordinates = &fit.candidate.coordinates;
    let one = |(c, &place): (&Coefficient, &usize)| {
        let k = coordinates.iter().position(|own| own.parameter == place)?;
        let off = (fit.x[k] - coordinates[k].of(c.off)).abs();
        Some(if off > 0.0 { off / deviations[k] } else { 0.0 })
    };
    h.coefficients.iter().zip(places).filter_map(one).reduce(f64::max).unwrap_or(f64::INFINITY)
}
