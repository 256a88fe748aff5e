//! All hypotheses beside a model, each from all its starts by one damped linear step: which of them are worth a fit, and
//! from where. What vanishes at its off value leaves the model as it is there: one run with the slopes of all of them
//! serves them all.

use super::super::estimate::candidate::Products;
use super::super::estimate::{Candidate, Fit, System};
use super::super::hypotheses::Hypothesis;
use super::super::policy::{DAMPINGS, STARTS};
use super::super::problem::{Chosen, Problem};
use super::models::{beginnings, candidate, causes, shaped};
use rayon::prelude::*;
use std::ops::Range;

/// Hypotheses in one joint run at most: its costs grow with the states by hypotheses, that of a run of its own does not.
const TOGETHER: usize = 64;
/// Hypotheses that are stepped before those that promise less are looked at again.
const ROUND: usize = 8;

/// A start of a model with one hypothesis more.
pub struct Start {
    /// The model.
    pub candidate: Candidate,
    /// Where it begins.
    pub x: Vec<f64>,
    /// Weighed squares there, prior included.
    pub cost: f64,
    /// What the linear model at the first values of the hypothesis promises instead.
    pub promised: f64,
}

/// A hypothesis with its starts, best first.
pub type Screened = (usize, Vec<Start>);

/// A model where its hypothesis begins.
struct Begun {
    candidate: Candidate,
    x: Vec<f64>,
    cost: f64,
    /// The linear model there, and the cost that it promises.
    system: System,
    promised: f64,
}

impl Begun {
    /// `None` where the linear model has no sense.
    fn new(candidate: Candidate, cost: f64, sums: Products) -> Option<Self> {
        let x = candidate.present();
        let system = System::of(sums, &candidate.coordinates, &x);
        let promised = cost - system.gain(&x, &system.step(&candidate.coordinates, &x, 0.0));
        promised.is_finite().then_some(Begun { candidate, x, cost, system, promised })
    }
}

/// The best `with` hypotheses that have something to fit, and the best `without`.
pub fn screened(problem: &Problem<'_>, before: &Fit, open: &[usize], [with, without]: [usize; 2]) -> Vec<Screened> {
    let attached = |&i: &usize| Some((i, attached(problem, before, i)?));
    let all: Vec<(usize, Vec<Candidate>)> = open.par_iter().filter_map(attached).collect();
    let (vanishing, others): (Vec<_>, Vec<_>) =
        all.into_iter().partition(|(i, models)| vanishes(&problem.hypotheses[*i], &models[0], before));
    let mut begun = together(problem, before, vanishing);
    begun.par_extend(
        others.into_par_iter().map(|(i, models)| (i, alone(problem, before, &problem.hypotheses[i], models))),
    );
    for (_, models) in &mut begun {
        models.sort_by(|a, b| a.promised.total_cmp(&b.promised));
        models.truncate(STARTS);
    }
    begun.retain(|(_, models)| !models.is_empty());
    begun.sort_by(|a, b| a.1[0].promised.total_cmp(&b.1[0].promised));
    let has_own = |b: &(usize, Vec<Begun>)| b.1[0].candidate.own > before.candidate.own;
    let (own, nothing): (Vec<_>, Vec<_>) = begun.into_iter().partition(has_own);
    let mut found = best(problem, before, own, with);
    found.extend(best(problem, before, nothing, without));
    found
}

/// The model with a hypothesis, at each of its beginnings.
fn attached(problem: &Problem<'_>, before: &Fit, hypothesis: usize) -> Option<Vec<Candidate>> {
    let h = &problem.hypotheses[hypothesis];
    let tolerances = before.tolerances();
    let mut values = beginnings(h);
    let is_parameter = h.family == "parameter";
    if is_parameter {
        let place = problem.tolerances.iter().position(|t| t.name == h.attachments[0].place.place);
        values = place.map(|p| vec![tolerances[p]]).into_iter().collect();
    }
    let mut causes = causes(before);
    causes.push(Chosen { hypothesis, values: values.first()?.clone() });
    let first = candidate(problem, &causes, Some(&tolerances))?;
    let with = |values: &Vec<f64>| {
        let mut candidate = first.clone();
        if let (Some(places), false) = (candidate.model.attached.last(), is_parameter) {
            places.iter().zip(values).for_each(|(&p, v)| candidate.model.theta[p] = *v);
        }
        if let Some(cause) = candidate.causes.last_mut() {
            cause.values.clone_from(values);
        }
        candidate
    };
    Some(values.iter().map(with).collect())
}

/// Whether the model with a hypothesis is at its first values the model without it.
fn vanishes(h: &Hypothesis, model: &Candidate, before: &Fit) -> bool {
    let off = |c: &super::super::effects::Coefficient| {
        c.whole().is_none() && c.min.is_none_or(|m| m <= c.off) && c.max.is_none_or(|m| m >= c.off)
    };
    let states = model.model.plan.states() == before.candidate.model.plan.states();
    h.family == "parameter" || !h.changes_order && states && h.coefficients.iter().all(off)
}

/// Hypotheses that vanish where they begin.
fn together(problem: &Problem<'_>, before: &Fit, all: Vec<(usize, Vec<Candidate>)>) -> Vec<(usize, Vec<Begun>)> {
    let is_parameter = |i: usize| problem.hypotheses[i].family == "parameter";
    let entries: Vec<(usize, Vec<f64>)> = all
        .iter()
        .filter(|(i, _)| !is_parameter(*i))
        .flat_map(|(i, models)| models.iter().filter_map(|m| Some((*i, m.causes.last()?.values.clone()))))
        .collect();
    let rounds = entries.len().div_ceil(TOGETHER).max(rayon::current_num_threads());
    let long = entries.len().div_ceil(rounds).max(1);
    let joint = |some: &[(usize, Vec<f64>)]| jointly(problem, before, some);
    let sums: Vec<Option<Products>> = entries.par_chunks(long).flat_map_iter(joint).collect();
    let mut sums = sums.into_iter();
    let cost = before.cost();
    let mut begun = |i: usize, model: Candidate| {
        if is_parameter(i) {
            let prior = before.candidate.prior(&before.x) - model.prior(&model.present());
            return Begun::new(model, cost - prior, before.sums(|_, _| true));
        }
        match sums.next()? {
            Some(sums) => {
                let width = model.coordinates.len();
                Begun::new(model, cost, sums.with_idle(width))
            }
            None => on_its_own(problem, before, model),
        }
    };
    all.into_iter().map(|(i, models)| (i, models.into_iter().filter_map(|m| begun(i, m)).collect())).collect()
}

/// Weighed sums of hypotheses that share one model; where they cannot, halves do, and one that cannot has none.
fn jointly(problem: &Problem<'_>, before: &Fit, some: &[(usize, Vec<f64>)]) -> Vec<Option<Products>> {
    if let Some(all) = joint(problem, before, some) {
        return all.into_iter().map(Some).collect();
    }
    if some.len() < 2 {
        return vec![None; some.len()];
    }
    let (left, right) = some.split_at(some.len() / 2);
    let mut all = jointly(problem, before, left);
    all.extend(jointly(problem, before, right));
    all
}

fn joint(problem: &Problem<'_>, before: &Fit, some: &[(usize, Vec<f64>)]) -> Option<Vec<Products>> {
    let mut causes = causes(before);
    let shapes = causes.len();
    causes.extend(some.iter().map(|(i, values)| Chosen { hypothesis: *i, values: values.clone() }));
    let model = shaped(problem, &causes, Some(&before.tolerances()), shapes)?;
    let mut first = before.x.len();
    let group = |(i, _): &(usize, Vec<f64>)| {
        let from = first;
        first += problem.hypotheses[*i].coefficients.len();
        from..first
    };
    let groups: Vec<Range<usize>> = some.iter().map(group).collect();
    if first != model.coordinates.len() {
        return None;
    }
    model.groups(&model.present(), &problem.train, &before.weights, &groups)
}

/// A hypothesis that does not vanish where it begins.
fn alone(problem: &Problem<'_>, before: &Fit, h: &Hypothesis, mut models: Vec<Candidate>) -> Vec<Begun> {
    let is_whole = h.coefficients.iter().all(|c| c.whole().is_some());
    if is_whole && models.len() > STARTS {
        models = nearest(problem, before, models);
    }
    models.into_iter().filter_map(|m| on_its_own(problem, before, m)).collect()
}

/// Those that come nearest to the recordings as they stand.
fn nearest(problem: &Problem<'_>, before: &Fit, all: Vec<Candidate>) -> Vec<Candidate> {
    let cost = |c: &Candidate| Some(before.weights.cost(&c.all_errors(&c.present(), &problem.train)?));
    let mut all: Vec<(f64, Candidate)> = all.into_iter().filter_map(|c| Some((cost(&c)?, c))).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    all.into_iter().take(STARTS).map(|(_, c)| c).collect()
}

/// A model by a run of its own.
fn on_its_own(problem: &Problem<'_>, before: &Fit, candidate: Candidate) -> Option<Begun> {
    let x = candidate.present();
    let evaluated = candidate.evaluate(&x, &problem.train)?;
    let fit = Fit { candidate, x, evaluated, weights: before.weights.clone() };
    Begun::new(fit.candidate.clone(), fit.cost(), fit.sums(|_, _| true))
}

/// Steps the most promising hypotheses first, until none promises what `wanted` of them have come to.
fn best(problem: &Problem<'_>, before: &Fit, all: Vec<(usize, Vec<Begun>)>, wanted: usize) -> Vec<Screened> {
    let mut found: Vec<Screened> = Vec::new();
    for round in all.chunks(ROUND) {
        if found.get(wanted - 1).is_some_and(|last| round[0].1[0].promised >= last.1[0].cost) {
            break;
        }
        let one = |(i, models): &(usize, Vec<Begun>)| {
            let mut starts: Vec<Start> = models.iter().filter_map(|m| stepped(problem, before, m)).collect();
            starts.sort_by(|a, b| a.cost.total_cmp(&b.cost));
            (!starts.is_empty()).then_some((*i, starts))
        };
        found.par_extend(round.par_iter().filter_map(one));
        found.sort_by(|a, b| a.1[0].cost.total_cmp(&b.1[0].cost));
        found.truncate(wanted);
    }
    found
}

/// A model after the best of some damped linear steps.
fn stepped(problem: &Problem<'_>, before: &Fit, begun: &Begun) -> Option<Start> {
    let Begun { candidate, x, cost, system, promised } = begun;
    let mut best = Start { candidate: candidate.clone(), x: x.clone(), cost: *cost, promised: *promised };
    for damping in DAMPINGS {
        let x = system.step(&candidate.coordinates, x, damping);
        let Some(errors) = candidate.all_errors(&x, &problem.train) else { continue };
        let cost = before.weights.cost(&errors) + candidate.prior(&x);
        if cost < best.cost {
            (best.x, best.cost) = (x, cost);
        }
    }
    best.cost.is_finite().then_some(best)
}
