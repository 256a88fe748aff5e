//! The hypotheses of one step as models that are fitted.

use super::super::clock::Deadline;
use super::super::effects::Coefficient;
use super::super::estimate::{Candidate, Fit, Task, Weights};
use super::super::hypotheses::Hypothesis;
use super::super::policy::{DELTA, FOLLOWED, FRONT, GLANCE, GLANCES, HOPED, KEPT, OTHER_WEIGHTING, ROUGH, TRIED};
use super::super::problem::Problem;
use super::compare::{needed, total_gap};
use super::criteria::Rival;
use super::screen::{Ground, Screened, Start, by_turns};
use super::weighed::{Weighed, at_nominal, at_the_noise, from_nominal, no_worse};
use rayon::prelude::*;

/// What came of fitting hypotheses.
pub struct Fitted {
    /// Those that were fitted.
    pub rivals: Vec<Rival>,
    /// Those for which the time did not last.
    pub passed: Vec<usize>,
}

/// A hypothesis after an iteration from its most promising starts, with the weights of the model before.
struct Tried {
    hypothesis: usize,
    starts: Vec<Start>,
    /// From as many of the first starts as have values.
    ways: Vec<Way>,
}

impl Tried {
    fn fits(&self) -> impl Iterator<Item = &Fit> {
        self.ways.iter().map(|w| &w.fit)
    }
}

/// A rough fit that is on its way to an optimum.
#[derive(Clone)]
struct Way {
    fit: Fit,
    /// It was followed to the end already.
    is_known: bool,
}

impl From<Fit> for Way {
    fn from(fit: Fit) -> Self {
        Way { fit, is_known: false }
    }
}

/// A hypothesis whose best first fit was followed to the end, where it promises to come to something.
struct Followed {
    tried: Tried,
    rival: Option<Rival>,
}

/// Fits hypotheses beside the model before until the time is over, in three stages: an iteration from their first starts, the
/// best of these to the end, and the best of all their starts to the end. A stage goes on with those first that then leave
/// least: a linear model promises much that is not kept. Then the front by both weightings while there is time. `before`: the
/// model before as it was judged.
pub fn fitted(ground: &Ground<'_>, before: &Fit, order: Vec<Screened>, until: Deadline<'_>) -> Fitted {
    let Ground { problem, sensors, .. } = *ground;
    let cost = |t: &Tried| t.fits().map(Fit::cost).fold(f64::INFINITY, f64::min);
    let gap = |t: &Tried| t.fits().map(|f| ground.gap(f)).fold(f64::INFINITY, f64::min);
    let (found, rest) = until.part(GLANCES).rounds(order, |screened| tried(ground, screened, until));
    let mut order = by_turns(found, cost, gap);
    order.extend(rest.into_iter().map(|(hypothesis, starts)| Tried { hypothesis, starts, ways: Vec::new() }));
    let (found, rest) = until.part(FOLLOWED).rounds(order, |tried| followed(ground, before, tried, until));
    let end = |f: &Followed| f.rival.as_ref().map_or_else(|| gap(&f.tried), |r| ground.gap(&r.model.fit));
    let mut order = by_turns(found, |f| cost(&f.tried), end);
    order.extend(rest.into_iter().map(|tried| Followed { tried, rival: None }));
    let (found, rest) = until.rounds(order, |followed| from_all(ground, before, followed, until));
    let mut rivals: Vec<Rival> = found.into_iter().flatten().collect();
    let mut passed = Vec::new();
    for Followed { tried, rival } in rest {
        match rival {
            Some(rival) => rivals.push(rival),
            None => passed.push(tried.hypothesis),
        }
    }
    rivals.sort_by(|a, b| a.model.gap(sensors).total_cmp(&b.model.gap(sensors)));
    let front = FRONT.min(rivals.len());
    rivals[..front].par_iter_mut().for_each(|rival| {
        for other in [from_nominal, at_the_noise] {
            if until.is_over() {
                break;
            }
            if let Some(better) = other(problem, sensors, &rival.model, until) {
                rival.model = better;
            }
        }
    });
    rivals.par_iter_mut().for_each(|r| r.size = size(problem, &problem.hypotheses[r.hypothesis], &r.model.fit));
    Fitted { rivals, passed }
}

impl Ground<'_> {
    /// Noise-free gap that a fit leaves of the data that were fitted, in parts of full scale.
    fn gap(&self, fit: &Fit) -> f64 {
        total_gap(&fit.mean_squares(), self.sensors)
    }

    /// Whether a rough fit may come to something at its end.
    fn is_promising(&self, fit: &Fit) -> bool {
        let fell = |(now, then): (f64, f64)| now < (1.0 - HOPED) * then;
        let falls = fit.mean_squares().into_iter().zip(self.before.mean_squares()).any(fell);
        falls || self.before.ahead(fit) > needed(self.problem.hypotheses.len())
    }

    /// A hypothesis with its fit, weighed.
    fn rival(&self, hypothesis: usize, fit: Fit) -> Rival {
        let h = &self.problem.hypotheses[hypothesis];
        let (places, is_parameter) = (h.attachments.len(), h.family == "parameter");
        Rival { hypothesis, places, size: 0.0, is_parameter, model: Weighed::new(self.problem, fit) }
    }
}

/// An iteration from each of the most promising starts of a hypothesis.
fn tried(ground: &Ground<'_>, (hypothesis, starts): Screened, until: Deadline<'_>) -> Tried {
    let task = ground.problem.task(until);
    let one = |s: &Start| begun(task, s, s.x.clone(), &ground.before.weights, GLANCE).map(Way::from);
    let ways = starts.iter().take(TRIED).filter_map(one).collect();
    Tried { hypothesis, starts, ways }
}

/// So many iterations from a start.
fn begun(task: Task<'_>, start: &Start, x: Vec<f64>, weights: &Weights, iterations: usize) -> Option<Fit> {
    let mut fit = Fit::begun(start.candidate.clone(), x, task, Some(weights))?;
    fit.descend(task, iterations);
    Some(fit)
}

/// The fit that the data prefer of those of the first starts, to the end.
fn followed(ground: &Ground<'_>, before: &Fit, mut tried: Tried, until: Deadline<'_>) -> Followed {
    let ways = &mut tried.ways;
    let best = (0..ways.len()).reduce(|a, b| if ways[a].fit.ahead(&ways[b].fit) > 0.0 { b } else { a });
    let best = best.map(|k| &mut ways[k]).filter(|way| ground.is_promising(&way.fit));
    let end = best.and_then(|way| {
        way.is_known = true;
        completed(before, ground.problem.task(until), way.fit.clone())
    });
    let rival = end.map(|fit| ground.rival(tried.hypothesis, fit));
    Followed { tried, rival }
}

/// The best of a hypothesis from all its starts: the fit that the data prefer, and that with the least gap where it is less by
/// far, each to the end where it promises to come to something.
fn from_all(ground: &Ground<'_>, before: &Fit, followed: Followed, until: Deadline<'_>) -> Option<Rival> {
    let Followed { tried, rival } = followed;
    let hypothesis = tried.hypothesis;
    let task = ground.problem.task(until);
    let mut all = rough(ground, task, tried);
    let first = (0..all.len()).reduce(|a, b| if all[a].fit.ahead(&all[b].fit) > 0.0 { b } else { a });
    let Some(best) = first.map(|k| all.swap_remove(k)) else { return rival };
    let least = all.into_iter().min_by(|a, b| ground.gap(&a.fit).total_cmp(&ground.gap(&b.fit)));
    let other = least.filter(|w| ground.gap(&w.fit) < (1.0 - DELTA) * ground.gap(&best.fit));
    let as_it_is = rival.is_none().then(|| best.fit.clone());
    let ends = [Some(best), other].into_iter().flatten().filter(|w| !w.is_known && ground.is_promising(&w.fit));
    let found = ends.filter_map(|w| completed(before, task, w.fit));
    let known = rival.as_ref().map(|r| r.model.fit.clone());
    let found = known.into_iter().chain(found).reduce(Fit::better_of);
    match (rival, found) {
        (Some(rival), Some(fit)) if fit.x == rival.model.fit.x => Some(rival),
        (_, Some(fit)) => Some(ground.rival(hypothesis, fit)),
        (_, None) => Some(ground.rival(hypothesis, as_it_is?.simulated(false, task.train)?)),
    }
}

/// A rough fit as it is judged, to the end.
fn completed(before: &Fit, task: Task<'_>, Fit { candidate, x, .. }: Fit) -> Option<Fit> {
    no_worse(task, before, Candidate { is_rough: false, ..candidate }, x)
}

/// A few iterations from every start, with the weights of the model before; those with the least cost and the least gap go on.
/// Sizes are looked for over the decades where the linear model has not kept its promise. Where the model before is bent away
/// from the data sheet, its weights may count little what the hypothesis explains: then also as if only the sensors' noise
/// were left, which finds the size that the data ask for, and from there with parameters at the data sheet again.
fn rough(ground: &Ground<'_>, task: Task<'_>, Tried { hypothesis, mut starts, ways: mut bent }: Tried) -> Vec<Way> {
    let Ground { problem, sensors, before } = *ground;
    let costs = |a: &Fit, b: &Fit| a.cost().total_cmp(&b.cost());
    let as_before = |s: &Start| begun(task, s, s.x.clone(), &before.weights, ROUGH).map(Way::from);
    bent.iter_mut().for_each(|w| w.fit.descend(task, ROUGH - GLANCE));
    bent.extend(starts.iter().skip(if bent.is_empty() { 0 } else { TRIED }).filter_map(as_before));
    let gain = |cost: f64| before.cost() - cost;
    let promised = starts.iter().map(|s| gain(s.promises())).fold(0.0, f64::max);
    if !bent.iter().any(|w| gain(w.fit.cost()) >= KEPT * promised) {
        let sizes = starts.first().map(|s| ground.of_size(hypothesis, s)).unwrap_or_default();
        bent.extend(sizes.iter().filter_map(as_before));
        starts.extend(sizes);
    }
    bent.sort_by(|a, b| costs(&a.fit, &b.fit));
    let gap = |k: usize| ground.gap(&bent[k].fit);
    let open = (1..bent.len()).min_by(|&a, &b| gap(a).total_cmp(&gap(b)));
    let mut found: Vec<Way> = open.map(|k| bent.swap_remove(k)).into_iter().chain(bent.into_iter().take(1)).collect();
    found.iter_mut().for_each(|w| w.fit.descend(task, ROUGH));
    if before.prior() > OTHER_WEIGHTING {
        let white = Weights::sensors(&sensors.noise, task.full_scale);
        let unbent = |s: &Start| begun(task, s, at_nominal(problem, &s.candidate, &s.x), &white, ROUGH);
        let sized = starts.iter().filter_map(unbent).min_by(costs);
        found.extend(sized.and_then(|mut sized| {
            sized.descend(task, ROUGH);
            let x = at_nominal(problem, &sized.candidate, &sized.x);
            let mut fit = Fit::begun(sized.candidate, x, task, None)?;
            fit.descend(task, 2 * ROUGH);
            Some(Way::from(fit))
        }));
    }
    found
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
