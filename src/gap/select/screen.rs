//! All hypotheses beside a model, each from all its starts by one damped linear step: which of them are worth a fit, and
//! from where.

use super::super::effects::{Coefficient, Shape};
use super::super::estimate::{Candidate, Coordinate, Fit};
use super::super::hypotheses::{Hypothesis, Signal};
use super::super::policy::{ACCURACY, DAMPINGS, GRID, STARTS};
use super::super::problem::{Chosen, Problem};
use super::compare::Sensors;

/// Sizes, in usual ones, at which effects begin that make no linear model where they vanish.
const SIZES: [f64; 3] = [0.1, 1.0, 10.0];
/// A shape may lie so many times beyond its grid.
const BEYOND: f64 = 3.0;

/// A start of a model with one hypothesis more.
pub struct Start {
    /// The model.
    pub candidate: Candidate,
    /// Where it begins.
    pub x: Vec<f64>,
    /// Weighed squares there, prior included.
    pub cost: f64,
}

/// The sensors of a problem.
pub fn sensors(problem: &Problem<'_>) -> Sensors {
    Sensors { noise: problem.noise_floor.clone(), full_scale: problem.full_scale.clone() }
}

/// A model with these causes; tolerances, where they are given, at these values.
pub fn candidate(problem: &Problem<'_>, causes: &[Chosen], tolerances: Option<&[f64]>) -> Option<Candidate> {
    let mut model = problem.assemble(causes, &[]).ok()?;
    if let Some(values) = tolerances {
        model.theta[model.free.clone()].copy_from_slice(values);
    }
    let hypothesis = |c: &Chosen| &problem.hypotheses[c.hypothesis];
    let mut coordinates: Vec<Coordinate> = Vec::new();
    for (i, t) in problem.tolerances.iter().enumerate() {
        let mut c = Coordinate::plain(i, t.sigma, t.min, t.max);
        c.prior = (!t.free).then_some((t.nominal / t.sigma, 1.0));
        coordinates.push(c);
    }
    let mut own = 0;
    for (cause, places) in causes.iter().zip(&model.attached) {
        let h = hypothesis(cause);
        if h.family == "parameter" {
            coordinates[places[0]].prior = None;
            own += 1;
            continue;
        }
        let (linear, shaped) = places.split_at(h.coefficients.len());
        let coefficients = h.coefficients.iter().zip(linear).filter_map(|(c, &p)| coefficient(c, p));
        let shapes = h.shapes.iter().zip(shaped).filter_map(|(s, &p)| shape(s, p));
        let of_cause: Vec<Coordinate> = coefficients.chain(shapes).collect();
        own += of_cause.len();
        coordinates.extend(of_cause);
    }
    let deviation = |(n, f): (&f64, &f64)| n.max(ACCURACY * f);
    let deviations = problem.noise_floor.iter().zip(&problem.full_scale).map(deviation).collect();
    let unit = |s: &Signal| problem.circuit.units.get(&s.variable).cloned().unwrap_or_default();
    let units = problem.signals.iter().map(unit).collect();
    Some(Candidate { causes: causes.to_vec(), model, coordinates, own, units, deviations })
}

/// A share of a whole is not free: an effect is there or not.
fn coefficient(c: &Coefficient, parameter: usize) -> Option<Coordinate> {
    let bound = |b: Option<f64>, none: f64| b.unwrap_or(none);
    let free = c.whole().is_none();
    free.then(|| {
        Coordinate::plain(parameter, c.nominal.abs(), bound(c.min, f64::NEG_INFINITY), bound(c.max, f64::INFINITY))
    })
}

/// A shape with one value is a width.
fn shape(s: &Shape, parameter: usize) -> Option<Coordinate> {
    let (least, most) = s.grid.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, m), x| (l.min(*x), m.max(*x)));
    if s.grid.len() < 2 {
        return None;
    }
    let (min, max) = (s.min.unwrap_or(f64::NEG_INFINITY), s.max.unwrap_or(f64::INFINITY));
    Some(if least > 0.0 {
        Coordinate::by_logarithm(parameter, min.max(least / BEYOND), max.min(most * BEYOND))
    } else {
        let width = most - least;
        Coordinate::plain(parameter, width, min.max(least - width), max.min(most + width))
    })
}

/// Values of a hypothesis where it may begin: linear coefficients where they vanish, shares as the whole, shapes on their
/// grids.
pub fn beginnings(h: &Hypothesis) -> Vec<Vec<f64>> {
    let sizes: &[f64] = if h.changes_order { &SIZES } else { &[0.0] };
    let value = |c: &Coefficient, size: f64| match c.whole() {
        Some(whole) => whole,
        None => (c.off + size * c.nominal).clamp(c.min.unwrap_or(f64::MIN), c.max.unwrap_or(f64::MAX)),
    };
    let mut all = Vec::new();
    for variant in h.variants() {
        for &size in sizes {
            let mut values: Vec<f64> = h.coefficients.iter().map(|c| value(c, size)).collect();
            values.extend(variant.iter().map(|v| v.1));
            all.push(values);
        }
    }
    let count = all.len();
    if count > GRID {
        all = (0..GRID).map(|i| all[i * (count - 1) / (GRID - 1)].clone()).collect();
    }
    all
}

/// The best starts of a hypothesis beside a model, best first; `None` where it does not get anywhere.
pub fn starts(problem: &Problem<'_>, before: &Fit, hypothesis: usize) -> Option<Vec<Start>> {
    let h = &problem.hypotheses[hypothesis];
    let tolerances = before.tolerances();
    let mut values = beginnings(h);
    if h.family == "parameter" {
        let place = problem.tolerances.iter().position(|t| t.name == h.attachments[0].place.place);
        values = place.map(|p| vec![tolerances[p]]).into_iter().collect();
    }
    let first = values.first()?;
    let mut causes = causes(before);
    causes.push(Chosen { hypothesis, values: first.clone() });
    let first = candidate(problem, &causes, Some(&tolerances))?;
    let with = |values: &Vec<f64>| {
        let mut candidate = first.clone();
        if let (Some(places), true) = (candidate.model.attached.last(), h.family != "parameter") {
            places.iter().zip(values).for_each(|(&p, v)| candidate.model.theta[p] = *v);
        }
        if let Some(cause) = candidate.causes.last_mut() {
            cause.values.clone_from(values);
        }
        candidate
    };
    let mut begun: Vec<Candidate> = values.iter().map(with).collect();
    let whole = h.coefficients.iter().all(|c| c.whole().is_some());
    if whole && begun.len() > STARTS {
        begun = nearest(problem, before, begun);
    }
    let mut promised: Vec<(f64, Fit)> = begun.into_iter().filter_map(|c| promised(problem, before, c)).collect();
    promised.sort_by(|a, b| a.0.total_cmp(&b.0));
    promised.truncate(STARTS);
    let mut found: Vec<Start> = promised.into_iter().filter_map(|(_, fit)| stepped(problem, &fit)).collect();
    found.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    (!found.is_empty()).then_some(found)
}

/// Those that come nearest to the recordings as they stand.
fn nearest(problem: &Problem<'_>, before: &Fit, all: Vec<Candidate>) -> Vec<Candidate> {
    let cost = |c: &Candidate| Some(before.weights.cost(&c.all_errors(&c.present(), &problem.train)?));
    let mut all: Vec<(f64, Candidate)> = all.into_iter().filter_map(|c| Some((cost(&c)?, c))).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    all.into_iter().take(STARTS).map(|(_, c)| c).collect()
}

/// A model where it stands, and the cost that its linear model promises.
fn promised(problem: &Problem<'_>, before: &Fit, candidate: Candidate) -> Option<(f64, Fit)> {
    let x = candidate.present();
    let evaluated = candidate.evaluate(&x, &problem.train)?;
    let fit = Fit { candidate, x, evaluated, weights: before.weights.clone() };
    let system = fit.system(|_, _| true);
    let promised = fit.cost() - system.gain(&fit.x, &system.step(&fit, 0.0));
    promised.is_finite().then_some((promised, fit))
}

/// The causes of a fit with their fitted values.
pub fn causes(fit: &Fit) -> Vec<Chosen> {
    let theta = fit.candidate.theta(&fit.x);
    let with = |(c, places): (&Chosen, &Vec<usize>)| Chosen {
        hypothesis: c.hypothesis,
        values: places.iter().map(|&p| theta[p]).collect(),
    };
    fit.candidate.causes.iter().zip(&fit.candidate.model.attached).map(with).collect()
}

/// A model after the best of some damped linear steps.
fn stepped(problem: &Problem<'_>, fit: &Fit) -> Option<Start> {
    let mut best = Start { candidate: fit.candidate.clone(), x: fit.x.clone(), cost: fit.cost() };
    let system = fit.system(|_, _| true);
    for damping in DAMPINGS {
        let x = system.step(fit, damping);
        let Some(errors) = fit.candidate.all_errors(&x, &problem.train) else { continue };
        let cost = fit.weights.cost(&errors) + fit.candidate.prior(&x);
        if cost < best.cost {
            (best.x, best.cost) = (x, cost);
        }
    }
    best.cost.is_finite().then_some(best)
}
