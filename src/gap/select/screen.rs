//! All hypotheses beside a model, each from all its starts: which of them are worth a fit, and from where. What the linear
//! model promises is looked at first, then a damped step, then a second one; each time fewer go on. What vanishes at its
//! off value leaves the model as it is there: one run with the slopes of all of them serves them all.

use super::super::effects::Coefficient;
use super::super::estimate::candidate::{Errors, Products};
use super::super::estimate::map::squares;
use super::super::estimate::{Candidate, Fit, System};
use super::super::hypotheses::Hypothesis;
use super::super::policy::{DAMPINGS, FITTED, FITTED_WITHOUT, HOPED, OTHER_WEIGHTING, PROMISED, STARTS, STEPPED};
use super::super::problem::{Chosen, Problem};
use super::compare::{Sensors, total_gap};
use super::models::{self, beginnings, candidate};
use super::weighed::at_nominal;
use nalgebra::DVector;
use rayon::prelude::*;
use std::ops::Range;

/// Hypotheses in one joint run at most: its costs grow with the states by hypotheses, that of a run of its own does not.
const TOGETHER: usize = 64;
/// Hypotheses that are stepped before those that promise less are looked at again.
const ROUND: usize = 8;

/// Starts that are nearer in all coordinates, in their units, are one.
const NEAR_BY: f64 = 0.1;

/// A model to which hypotheses are added.
#[derive(Clone, Copy)]
pub struct Ground<'a> {
    /// What is diagnosed.
    pub problem: &'a Problem<'a>,
    /// The sensors.
    pub sensors: &'a Sensors,
    /// The model.
    pub before: &'a Fit,
    /// Whether a model that leaves such mean squares of the signals closes a part of what is worth a name.
    pub may_be_worth: &'a (dyn Fn(&[f64], f64) -> bool + Sync),
}

/// A start of a model with one hypothesis more.
pub struct Start {
    /// The model.
    pub candidate: Candidate,
    /// Where it begins.
    pub x: Vec<f64>,
    /// What it leaves there.
    pub leaves: Leaves,
    /// What its linear model promised to leave.
    pub promised: Leaves,
}

impl Start {
    /// Whether it is not where another one is, of the same hypothesis.
    fn is_elsewhere(&self, other: &Start) -> bool {
        self.x.iter().zip(&other.x).any(|(a, b)| (a - b).abs() > NEAR_BY)
    }
}

/// What a model leaves of the train recordings.
#[derive(Clone, Debug)]
pub struct Leaves {
    /// Weighed squares, prior included: by it signals count whose errors are small and white.
    pub cost: f64,
    /// Mean square of each signal.
    pub squares: Vec<f64>,
    /// Noise-free gap over all signals, in parts of full scale: by it those count whose errors are large.
    pub gap: f64,
}

/// What hypotheses are ranked by; half of those that are fitted are the best of each.
type Criterion = fn(&Leaves) -> f64;
const CRITERIA: [Criterion; 2] = [|l| l.cost, |l| l.gap];

/// A hypothesis with its starts, best first.
pub type Screened = (usize, Vec<Start>);

/// What came of all hypotheses.
pub struct Screen {
    /// Those worth a fit.
    pub best: Vec<Screened>,
    /// Those whose linear model promises too little, with the gap that it would leave, in parts of full scale.
    pub too_little: Vec<(usize, f64)>,
    /// Per hypothesis that vanishes where it begins: what it would gain at its usual size, nats.
    pub visible: Vec<f64>,
}

/// A model where its hypothesis begins, and the linear model there.
struct Begun {
    candidate: Candidate,
    x: Vec<f64>,
    now: Leaves,
    system: System,
    promised: Leaves,
}

/// A hypothesis with the models with it, at each of its beginnings.
type Attached = (usize, Vec<Candidate>);
/// The same with the linear model there.
type Beginnings = (usize, Vec<Begun>);

/// The hypotheses that are worth a fit.
pub fn screened(ground: &Ground<'_>, open: &[usize]) -> Screen {
    let mut all = ground.begun(open);
    let visible = all.iter().filter_map(|(i, models)| ground.visible(*i, models)).collect();
    if let Some(nominal) = ground.nominal() {
        // those that need a run each are begun once
        let other = Ground { before: &nominal, ..*ground };
        let (vanishing, _) = other.attached_to(open);
        for (i, models) in other.together(vanishing) {
            if let Some((_, known)) = all.iter_mut().find(|(k, _)| *k == i) {
                known.extend(models);
            }
        }
    }
    all.retain(|(_, models)| !models.is_empty());
    let promises = |m: &Begun| (ground.may_be_worth)(&m.promised.squares, HOPED);
    let (all, others): (Vec<_>, Vec<_>) = all.into_iter().partition(|(_, models)| models.iter().any(promises));
    let gap = |(i, models): &Beginnings| (*i, models.iter().map(|m| m.promised.gap).fold(f64::INFINITY, f64::min));
    let mut too_little: Vec<(usize, f64)> = others.iter().map(gap).collect();
    let has_own = |b: &Beginnings| b.1[0].candidate.own > ground.before.candidate.own;
    let (own, nothing): (Vec<_>, Vec<_>) = all.into_iter().partition(has_own);
    let mut best = ground.best(&own, FITTED);
    best.extend(ground.best(&nothing, FITTED_WITHOUT));
    let shows = |l: &Leaves| (ground.may_be_worth)(&l.squares, PROMISED);
    let (best, others): (Vec<Screened>, Vec<Screened>) =
        best.into_iter().partition(|s| s.1.iter().any(|start| shows(&start.leaves) || shows(&start.promised)));
    too_little.extend(others.iter().map(|s| (s.0, s.1[0].leaves.gap)));
    Screen { best, too_little, visible }
}

/// Whether the model with a hypothesis is at its first values the model without it.
fn vanishes(h: &Hypothesis, model: &Candidate, before: &Fit) -> bool {
    let off =
        |c: &Coefficient| c.whole().is_none() && c.min.is_none_or(|m| m <= c.off) && c.max.is_none_or(|m| m >= c.off);
    let states = model.model.plan.states() == before.candidate.model.plan.states();
    h.family == "parameter" || !h.changes_order && states && h.coefficients.iter().all(off)
}

impl Ground<'_> {
    fn h(&self, hypothesis: usize) -> &Hypothesis {
        &self.problem.hypotheses[hypothesis]
    }

    fn is_parameter(&self, hypothesis: usize) -> bool {
        self.h(hypothesis).family == "parameter"
    }

    /// What errors come to; `prior` in squared deviations.
    fn leaves(&self, errors: &[Errors], prior: f64) -> Leaves {
        let all = |i: usize| squares(errors, i);
        self.left((0..self.sensors.noise.len()).map(all).collect(), prior)
    }

    /// The same from the sum of squares of each signal.
    fn left(&self, sums: Vec<f64>, prior: f64) -> Leaves {
        let weights = &self.before.weights;
        let cost = sums.iter().enumerate().map(|(i, s)| weights.weight(i) * s).sum::<f64>() + prior;
        let mean = |(i, s): (usize, &f64)| s.max(0.0) / self.before.samples(i).max(1.0);
        let squares: Vec<f64> = sums.iter().enumerate().map(mean).collect();
        Leaves { cost, gap: total_gap(&squares, self.sensors), squares }
    }

    /// A model at nominal values of its tolerances, where it is bent away from them: what is large bends parameters, and from
    /// there no linear step leads to it.
    fn nominal(&self) -> Option<Fit> {
        if self.before.prior() <= OTHER_WEIGHTING {
            return None;
        }
        let mut fit = self.before.clone();
        fit.x = at_nominal(self.problem, &fit.candidate, &fit.x);
        fit.evaluated = fit.candidate.evaluate(&fit.x, &self.problem.train)?;
        Some(fit)
    }

    /// A model where it stands; `None` where the linear model has no sense.
    fn begin(&self, candidate: Candidate, x: Vec<f64>, errors: &[Errors], sums: &[Products]) -> Option<Begun> {
        let mut sum = Products::none(x.len());
        sums.iter().enumerate().for_each(|(i, s)| sum.add_weighed(s, self.before.weights.weight(i)));
        let system = System::of(sum, &candidate.coordinates, &x);
        let to = system.step(&candidate.coordinates, &x, 0.0);
        let change = DVector::from_fn(x.len(), |i, _| to[i] - x[i]);
        let falls = |(i, s): (usize, &Products)| squares(errors, i) - s.gain(&change);
        let promised = self.left(sums.iter().enumerate().map(falls).collect(), candidate.prior(&to));
        let now = self.leaves(errors, candidate.prior(&x));
        promised.cost.is_finite().then_some(Begun { candidate, x, now, system, promised })
    }

    /// What a hypothesis that vanishes where it begins would gain at its usual size, nats.
    fn visible(&self, hypothesis: usize, models: &[Begun]) -> Option<f64> {
        let h = self.h(hypothesis);
        let gain = |m: &Begun| m.system.visible(self.before.x.len(), h.coefficients.len());
        let vanishing = !self.is_parameter(hypothesis) && vanishes(h, &models.first()?.candidate, self.before);
        vanishing.then(|| models.iter().map(gain).fold(0.0, f64::max))
    }

    /// All of some hypotheses, each at its beginnings.
    fn begun(&self, open: &[usize]) -> Vec<Beginnings> {
        let (vanishing, others) = self.attached_to(open);
        let mut begun = self.together(vanishing);
        begun.par_extend(others.into_par_iter().map(|(i, models)| (i, self.alone(i, models))));
        begun.sort_by_key(|b| b.0);
        begun
    }

    /// Hypotheses that vanish where they begin, and others.
    fn attached_to(&self, open: &[usize]) -> (Vec<Attached>, Vec<Attached>) {
        let attached = |&i: &usize| Some((i, self.attached(i)?));
        let all: Vec<Attached> = open.par_iter().filter_map(attached).collect();
        all.into_iter().partition(|(i, models)| vanishes(self.h(*i), &models[0], self.before))
    }

    /// The model with a hypothesis, at each of its beginnings.
    fn attached(&self, hypothesis: usize) -> Option<Vec<Candidate>> {
        let h = self.h(hypothesis);
        let tolerances = self.before.tolerances();
        let mut values = beginnings(h);
        let is_parameter = self.is_parameter(hypothesis);
        if is_parameter {
            let place = self.problem.tolerances.iter().position(|t| t.name == h.attachments[0].place.place);
            values = place.map(|p| vec![tolerances[p]]).into_iter().collect();
        }
        let mut causes = self.before.causes();
        causes.push(Chosen { hypothesis, values: values.first()?.clone() });
        let mut first = candidate(self.problem, &causes, Some(&tolerances), self.before.candidate.taken)?;
        first.begins_as(&self.before.candidate);
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

    /// Hypotheses that vanish where they begin.
    fn together(&self, all: Vec<Attached>) -> Vec<Beginnings> {
        let entries: Vec<Chosen> = all
            .iter()
            .filter(|(i, _)| !self.is_parameter(*i))
            .flat_map(|(_, models)| models.iter().filter_map(|m| m.causes.last().cloned()))
            .collect();
        let rounds = entries.len().div_ceil(TOGETHER).max(rayon::current_num_threads());
        let long = entries.len().div_ceil(rounds).max(1);
        let sums: Vec<Option<_>> = entries.par_chunks(long).flat_map_iter(|some| self.jointly(some)).collect();
        let mut sums = sums.into_iter();
        let Fit { x, evaluated, .. } = self.before;
        let mut begun = |i: usize, model: Candidate| {
            let present = model.present();
            if self.is_parameter(i) {
                return self.begin(model, present, &evaluated.errors, &evaluated.by_signal(x.len()));
            }
            let Some(sums) = sums.next()? else { return self.on_its_own(model) };
            let sums: Vec<Products> = sums.into_iter().map(|s: Products| s.with_idle(present.len())).collect();
            self.begin(model, present, &evaluated.errors, &sums)
        };
        all.into_iter().map(|(i, models)| (i, models.into_iter().filter_map(|m| begun(i, m)).collect())).collect()
    }

    /// Sums of hypotheses that share one model, signal by signal; where they cannot, halves do, and one that cannot has none.
    fn jointly(&self, some: &[Chosen]) -> Vec<Option<Vec<Products>>> {
        if let Some(all) = self.joint(some) {
            return all.into_iter().map(Some).collect();
        }
        if some.len() < 2 {
            return vec![None; some.len()];
        }
        let (left, right) = some.split_at(some.len() / 2);
        let mut all = self.jointly(left);
        all.extend(self.jointly(right));
        all
    }

    fn joint(&self, some: &[Chosen]) -> Option<Vec<Vec<Products>>> {
        let mut causes = self.before.causes();
        let shapes = causes.len();
        causes.extend(some.iter().cloned());
        let taken = self.before.candidate.taken;
        let mut model = models::attached(self.problem, &causes, Some(&self.before.tolerances()), taken, shapes).ok()?;
        model.begins_as(&self.before.candidate);
        let mut first = self.before.x.len();
        let group = |c: &Chosen| {
            let from = first;
            first += self.h(c.hypothesis).coefficients.len();
            from..first
        };
        let groups: Vec<Range<usize>> = some.iter().map(group).collect();
        if first != model.coordinates.len() {
            return None;
        }
        model.groups(&model.present(), &self.problem.train, &groups)
    }

    /// A hypothesis that does not vanish where it begins.
    fn alone(&self, hypothesis: usize, mut models: Vec<Candidate>) -> Vec<Begun> {
        let is_whole = self.h(hypothesis).coefficients.iter().all(|c| c.whole().is_some());
        if is_whole && models.len() > STARTS {
            models = self.nearest(models);
        }
        models.into_iter().filter_map(|m| self.on_its_own(m)).collect()
    }

    /// Those that come nearest to the recordings as they stand.
    fn nearest(&self, all: Vec<Candidate>) -> Vec<Candidate> {
        let cost = |c: &Candidate| Some(self.before.weights.cost(&c.all_errors(&c.present(), &self.problem.train)?));
        let mut all: Vec<(f64, Candidate)> = all.into_iter().filter_map(|c| Some((cost(&c)?, c))).collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        all.into_iter().take(STARTS).map(|(_, c)| c).collect()
    }

    /// A model by a run of its own.
    fn on_its_own(&self, candidate: Candidate) -> Option<Begun> {
        let x = candidate.present();
        self.at(candidate, x)
    }

    /// A model at a point.
    fn at(&self, mut candidate: Candidate, x: Vec<f64>) -> Option<Begun> {
        let evaluated = candidate.evaluate(&x, &self.problem.train)?;
        candidate.off.clone_from(&evaluated.off);
        let sums = evaluated.by_signal(x.len());
        self.begin(candidate, x, &evaluated.errors, &sums)
    }

    /// The best by all criteria.
    fn best(&self, all: &[Beginnings], wanted: usize) -> Vec<Screened> {
        let each = wanted.div_ceil(CRITERIA.len());
        let mut found: Vec<Screened> = Vec::new();
        for criterion in CRITERIA {
            let stepped = self.stepped(criterion, all, STEPPED * each);
            let mut again: Vec<Screened> = stepped.into_par_iter().map(|s| self.again(criterion, s)).collect();
            sort(&mut again, criterion);
            for (i, starts) in again.into_iter().take(each) {
                match found.iter_mut().find(|f| f.0 == i) {
                    Some((_, known)) => {
                        // each criterion has its best start; one is enough where they are the same
                        known.truncate(1);
                        let other = starts.into_iter().next().filter(|s| s.is_elsewhere(&known[0]));
                        known.extend(other);
                    }
                    None => found.push((i, starts)),
                }
            }
        }
        found
    }

    /// The best of one criterion after a step: the most promising are stepped first, until none promises what so many of them
    /// have come to.
    fn stepped(&self, criterion: Criterion, all: &[Beginnings], wanted: usize) -> Vec<Screened> {
        let promised = |m: &Begun| criterion(&m.promised);
        let best_of = |models: &[Begun]| models.iter().map(promised).fold(f64::INFINITY, f64::min);
        let mut order: Vec<&Beginnings> = all.iter().collect();
        order.sort_by(|a, b| best_of(&a.1).total_cmp(&best_of(&b.1)));
        let mut found: Vec<Screened> = Vec::new();
        for round in order.chunks(ROUND) {
            let enough = |last: &Screened| best_of(&round[0].1) >= criterion(&last.1[0].leaves);
            if found.get(wanted - 1).is_some_and(enough) {
                break;
            }
            let one = |(hypothesis, models): &&Beginnings| {
                let mut models: Vec<&Begun> = models.iter().collect();
                models.sort_by(|a, b| promised(a).total_cmp(&promised(b)));
                let starts = models.iter().take(STARTS).map(|m| self.step(m, criterion));
                let mut starts: Vec<Start> = starts.collect();
                starts.sort_by(|a, b| criterion(&a.leaves).total_cmp(&criterion(&b.leaves)));
                (*hypothesis, starts)
            };
            found.par_extend(round.par_iter().map(one));
            sort(&mut found, criterion);
            found.truncate(wanted);
        }
        found
    }

    /// A second step from the best start.
    fn again(&self, criterion: Criterion, (hypothesis, mut starts): Screened) -> Screened {
        let first = &starts[0];
        let next = self.at(first.candidate.clone(), first.x.clone()).map(|m| self.step(&m, criterion));
        if let Some(next) = next.filter(|n| criterion(&n.leaves) < criterion(&first.leaves)) {
            starts[0] = next;
        }
        (hypothesis, starts)
    }

    /// A model after the least damped linear step that helps, doubled as long as that helps more.
    fn step(&self, begun: &Begun, criterion: Criterion) -> Start {
        let Begun { candidate, x: from, now, system, promised } = begun;
        let leaves = |x: &[f64]| {
            let errors = candidate.all_errors(x, &self.problem.train)?;
            Some(self.leaves(&errors, candidate.prior(x)))
        };
        let is_better = |a: &Leaves, b: &Leaves| criterion(a) < criterion(b);
        let (mut x, mut best) = (from.clone(), now.clone());
        for damping in DAMPINGS {
            let tried = system.step(&candidate.coordinates, from, damping);
            if let Some(found) = leaves(&tried).filter(|l| is_better(l, &best)) {
                (x, best) = candidate.stretched(from, (tried, found), &leaves, is_better);
                break;
            }
        }
        Start { candidate: candidate.clone(), x, leaves: best, promised: promised.clone() }
    }
}

/// Best first.
fn sort(all: &mut [Screened], criterion: Criterion) {
    all.sort_by(|a, b| criterion(&a.1[0].leaves).total_cmp(&criterion(&b.1[0].leaves)));
}
