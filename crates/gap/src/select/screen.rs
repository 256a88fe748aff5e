//! All hypotheses beside a model, each at all its beginnings, with what the linear model there promises: the most promising
//! are fitted first. What vanishes at its off value leaves the model as it is there: one run with the slopes of all of them
//! serves them all. What has no linear model at its off value is looked at over the decades where it may be.

use super::super::clock::Deadline;
use super::super::effects::EffectCoefficient;
use super::super::estimate::candidate::{RecordingResiduals, SensitivityProducts};
use super::super::estimate::map::squares;
use super::super::estimate::{CandidateModel, ModelFit, NormalEquations};
use super::super::hypotheses::Hypothesis;
use super::super::policy::{DECADES, OTHER_WEIGHTING, SCANNED, SIZES, SLOWER, STARTS, UNCHANGED};
use super::super::problem::{DiagnosisProblem, HypothesisValues};
use super::compare::{SensorAccuracy, total_gap};
use super::models::{self, beginnings, candidate};
use super::weighed::at_nominal;
use nalgebra::DVector;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::ops::Range;

/// Hypotheses in one joint run at most: its costs grow with the states by hypotheses, that of a run of its own does not.
const TOGETHER: usize = 64;

/// A model to which hypotheses are added.
#[derive(Clone, Copy)]
pub struct ScreeningContext<'a> {
    /// What is diagnosed.
    pub problem: &'a DiagnosisProblem<'a>,
    /// The sensors.
    pub sensors: &'a SensorAccuracy,
    /// The model.
    pub before: &'a ModelFit,
}

/// What a model leaves of the train recordings.
#[derive(Clone, Debug)]
pub struct TrainingResidual {
    /// Weighed squares, prior included: by it signals count whose errors are small and white.
    pub cost: f64,
    /// Noise-free gap over all signals, in parts of full scale: by it those count whose errors are large.
    pub gap: f64,
}

/// A place from which a model with one hypothesis more is fitted, and the linear model there.
pub struct FitStart {
    /// The model.
    pub candidate: CandidateModel,
    /// Where it begins.
    pub x: Vec<f64>,
    system: NormalEquations,
    promised: TrainingResidual,
}

impl FitStart {
    /// The weighed squares that the linear model promises, prior included.
    pub fn promises(&self) -> f64 {
        self.promised.cost
    }
}

/// A hypothesis with its starts, the most promising first.
pub type ScreenedHypothesis = (usize, Vec<FitStart>);

/// What came of all hypotheses.
pub struct ScreeningResult {
    /// In the order in which they are to be fitted.
    pub order: Vec<ScreenedHypothesis>,
    /// Those for which the time did not last.
    pub passed: Vec<usize>,
    /// Per hypothesis that vanishes where it begins: what it would gain at its usual size, nats.
    pub visible: Vec<f64>,
}

/// A hypothesis with the models with it, at each of its beginnings.
type HypothesisModels = (usize, Vec<CandidateModel>);
/// The same with the linear model there.
type HypothesisStarts = (usize, Vec<FitStart>);

/// Hypotheses in the order in which they are to be fitted, those alone that are looked at until the time is over.
pub fn screened(ground: &ScreeningContext<'_>, open: &[usize], until: Deadline<'_>) -> ScreeningResult {
    let (vanishing, mut others) = ground.attached_to(open);
    let nominal = ground.nominal();
    let moved = nominal.as_ref().map(|fit| (fit, moved(fit, &vanishing)));
    let mut all = ground.together(vanishing);
    let visible = all.iter().filter_map(|(i, models)| ground.visible(*i, models)).collect();
    if let Some((before, vanishing)) = moved {
        // those that need a run each are begun once
        let begun = ScreeningContext { before, ..*ground }.together(vanishing);
        all.iter_mut().zip(begun).for_each(|(known, more)| known.1.extend(more.1));
    }
    // a scan takes many runs of stiff models: what needs none comes first
    others.sort_by_key(|(i, models)| ground.is_scanned(*i, &models[0]));
    let (alone, passed) = until.rounds(others, |(i, models)| (i, ground.alone(i, models, until)));
    all.extend(alone);
    all.sort_by_key(|b| b.0);
    all.retain(|(_, models)| !models.is_empty());
    ScreeningResult { order: ordered(all), passed: passed.into_iter().map(|(i, _)| i).collect(), visible }
}

/// Models with hypotheses beside a model at other values of its parameters.
fn moved(before: &ModelFit, all: &[HypothesisModels]) -> Vec<HypothesisModels> {
    let theta = before.candidate.theta(&before.x);
    let free = before.candidate.model.free.clone();
    let one = |model: &CandidateModel| {
        let mut model = model.clone();
        model.model.theta[free.clone()].copy_from_slice(&theta[free.clone()]);
        model.begins_as(&before.candidate);
        model
    };
    all.iter().map(|(i, models)| (*i, models.iter().map(one).collect())).collect()
}

/// The most promising first, by the weighed cost and by the gap in turn: by one of them signals count whose errors are
/// small and white, by the other those whose errors are large.
fn ordered(all: Vec<HypothesisStarts>) -> Vec<ScreenedHypothesis> {
    let least = |models: &[FitStart], by: fn(&TrainingResidual) -> f64| {
        models.iter().map(|m| by(&m.promised)).fold(f64::INFINITY, f64::min)
    };
    let order = by_turns(all, |b| least(&b.1, |l| l.cost), |b| least(&b.1, |l| l.gap));
    order.into_iter().map(|(i, models)| (i, starts(models))).collect()
}

/// Things in the order of two measures in turn, the least first.
pub fn by_turns<T>(all: Vec<T>, one: impl Fn(&T) -> f64, other: impl Fn(&T) -> f64) -> Vec<T> {
    let ranks = |values: Vec<f64>| {
        let mut order: Vec<usize> = (0..values.len()).collect();
        order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
        let mut rank = vec![0; values.len()];
        order.into_iter().enumerate().for_each(|(r, i)| rank[i] = r);
        rank
    };
    let (first, second) = (ranks(all.iter().map(one).collect()), ranks(all.iter().map(other).collect()));
    let mut order: Vec<usize> = (0..all.len()).collect();
    order.sort_by_key(|&i| (first[i].min(second[i]), first[i], i));
    let mut all: Vec<Option<T>> = all.into_iter().map(Some).collect();
    order.into_iter().filter_map(|i| all[i].take()).collect()
}

/// The most promising of the beginnings of a hypothesis, by both in turn.
fn starts(mut models: Vec<FitStart>) -> Vec<FitStart> {
    let mut found: Vec<FitStart> = Vec::new();
    let by: [fn(&TrainingResidual) -> f64; 2] = [|l| l.cost, |l| l.gap];
    while found.len() < STARTS && !models.is_empty() {
        let by = by[found.len() % by.len()];
        let best = |a: &usize, b: &usize| by(&models[*a].promised).total_cmp(&by(&models[*b].promised));
        let Some(k) = (0..models.len()).min_by(best) else { break };
        found.push(models.swap_remove(k));
    }
    found
}

/// Whether the model with a hypothesis is at its first values the model without it.
fn vanishes(h: &Hypothesis, model: &CandidateModel, before: &ModelFit) -> bool {
    let off = |c: &EffectCoefficient| {
        c.whole().is_none() && c.min.is_none_or(|m| m <= c.off) && c.max.is_none_or(|m| m >= c.off)
    };
    let states = model.model.plan.states() == before.candidate.model.plan.states();
    h.family == "parameter" || !h.changes_order && states && h.coefficients.iter().all(off)
}

impl ScreeningContext<'_> {
    fn h(&self, hypothesis: usize) -> &Hypothesis {
        &self.problem.hypotheses[hypothesis]
    }

    fn is_parameter(&self, hypothesis: usize) -> bool {
        self.h(hypothesis).family == "parameter"
    }

    /// What sums of squares of each signal come to; `prior` in squared deviations.
    fn left(&self, sums: Vec<f64>, prior: f64) -> TrainingResidual {
        let weights = &self.before.weights;
        let cost = sums.iter().enumerate().map(|(i, s)| weights.weight(i) * s).sum::<f64>() + prior;
        let mean = |(i, s): (usize, &f64)| s.max(0.0) / self.before.samples(i).max(1.0);
        let squares: Vec<f64> = sums.iter().enumerate().map(mean).collect();
        TrainingResidual { cost, gap: total_gap(&squares, self.sensors) }
    }

    /// A model at nominal values of its tolerances, where it is bent away from them: what is large bends parameters, and from
    /// there no linear step leads to it.
    fn nominal(&self) -> Option<ModelFit> {
        if self.before.prior() <= OTHER_WEIGHTING {
            return None;
        }
        let mut fit = self.before.clone();
        fit.x = at_nominal(self.problem, &fit.candidate, &fit.x);
        fit.evaluated = fit.candidate.evaluate(&fit.x, &self.problem.train)?;
        Some(fit)
    }

    /// A model where it stands; `None` where the linear model has no sense.
    fn begin(
        &self,
        candidate: CandidateModel,
        x: Vec<f64>,
        errors: &[RecordingResiduals],
        sums: &[SensitivityProducts],
    ) -> Option<FitStart> {
        let mut sum = SensitivityProducts::none(x.len());
        sums.iter().enumerate().for_each(|(i, s)| sum.add_weighed(s, self.before.weights.weight(i)));
        let system = NormalEquations::of(sum, &candidate.coordinates, &x);
        let to = system.step(&candidate.coordinates, &x, 0.0);
        let change = DVector::from_fn(x.len(), |i, _| to[i] - x[i]);
        let falls = |(i, s): (usize, &SensitivityProducts)| squares(errors, i) - s.gain(&change);
        let promised = self.left(sums.iter().enumerate().map(falls).collect(), candidate.prior(&to));
        promised.cost.is_finite().then_some(FitStart { candidate, x, system, promised })
    }

    /// What a hypothesis that vanishes where it begins would gain at its usual size, nats.
    fn visible(&self, hypothesis: usize, models: &[FitStart]) -> Option<f64> {
        let h = self.h(hypothesis);
        let gain = |m: &FitStart| m.system.visible(self.before.x.len(), h.coefficients.len());
        let vanishing = !self.is_parameter(hypothesis) && vanishes(h, &models.first()?.candidate, self.before);
        vanishing.then(|| models.iter().map(gain).fold(0.0, f64::max))
    }

    /// Hypotheses that vanish where they begin, and others.
    fn attached_to(&self, open: &[usize]) -> (Vec<HypothesisModels>, Vec<HypothesisModels>) {
        let attached = |&i: &usize| Some((i, self.attached(i)?));
        let all: Vec<HypothesisModels> = open.par_iter().filter_map(attached).collect();
        all.into_iter().partition(|(i, models)| vanishes(self.h(*i), &models[0], self.before))
    }

    /// The model with a hypothesis, at each of its beginnings.
    fn attached(&self, hypothesis: usize) -> Option<Vec<CandidateModel>> {
        let h = self.h(hypothesis);
        let tolerances = self.before.tolerances();
        let mut values = beginnings(h);
        let is_parameter = self.is_parameter(hypothesis);
        if is_parameter {
            let place = self.problem.tolerances.iter().position(|t| t.name == h.attachments[0].place.place);
            values = place.map(|p| vec![tolerances[p]]).into_iter().collect();
        }
        let mut causes = self.before.causes();
        causes.push(HypothesisValues { hypothesis, values: values.first()?.clone() });
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
    fn together(&self, all: Vec<HypothesisModels>) -> Vec<HypothesisStarts> {
        let entries: Vec<HypothesisValues> = all
            .iter()
            .filter(|(i, _)| !self.is_parameter(*i))
            .flat_map(|(_, models)| models.iter().filter_map(|m| m.causes.last().cloned()))
            .collect();
        let rounds = entries.len().div_ceil(TOGETHER).max(rayon::current_num_threads());
        let long = entries.len().div_ceil(rounds).max(1);
        let sums: Vec<Option<_>> = entries.par_chunks(long).flat_map_iter(|some| self.jointly(some)).collect();
        let mut sums = sums.into_iter();
        let ModelFit { x, evaluated, .. } = self.before;
        let mut begun = |i: usize, model: CandidateModel| {
            let present = model.present();
            if self.is_parameter(i) {
                return self.begin(model, present, &evaluated.errors, &evaluated.by_signal(x.len()));
            }
            let Some(sums) = sums.next()? else { return self.on_its_own(model) };
            let sums: Vec<SensitivityProducts> =
                sums.into_iter().map(|s: SensitivityProducts| s.with_idle(present.len())).collect();
            self.begin(model, present, &evaluated.errors, &sums)
        };
        all.into_iter().map(|(i, models)| (i, models.into_iter().filter_map(|m| begun(i, m)).collect())).collect()
    }

    /// Sums of hypotheses that share one model, signal by signal; where they cannot, halves do, and one that cannot has none.
    fn jointly(&self, some: &[HypothesisValues]) -> Vec<Option<Vec<SensitivityProducts>>> {
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

    fn joint(&self, some: &[HypothesisValues]) -> Option<Vec<Vec<SensitivityProducts>>> {
        let mut causes = self.before.causes();
        let shapes = causes.len();
        causes.extend(some.iter().cloned());
        let taken = self.before.candidate.taken;
        let mut model = models::attached(self.problem, &causes, Some(&self.before.tolerances()), taken, shapes).ok()?;
        model.begins_as(&self.before.candidate);
        let mut first = self.before.x.len();
        let group = |c: &HypothesisValues| {
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
    fn alone(&self, hypothesis: usize, models: Vec<CandidateModel>, until: Deadline<'_>) -> Vec<FitStart> {
        let of_size = |m: CandidateModel| {
            if self.is_scanned(hypothesis, &m) { self.scanned(&m, &m.model.theta, until) } else { vec![m] }
        };
        models.into_iter().flat_map(of_size).filter_map(|m| self.on_its_own(m)).collect()
    }

    /// Whether the size of a hypothesis that does not vanish where it begins is looked for.
    fn is_scanned(&self, hypothesis: usize, model: &CandidateModel) -> bool {
        self.h(hypothesis).changes_order && !self.sized(model).is_empty()
    }

    /// Starts at the sizes of a hypothesis that vanishes where it begins, looked for where the linear model leads: beyond the
    /// first gain a step may end where the model does not come back from. None for others.
    pub fn of_size(&self, hypothesis: usize, begun: &FitStart, until: Deadline<'_>) -> Vec<FitStart> {
        if !vanishes(self.h(hypothesis), &begun.candidate, self.before) {
            return Vec::new();
        }
        let model = &begun.candidate;
        let to = begun.system.step(&model.coordinates, &begun.x, 0.0);
        let mut theta = model.model.theta.clone();
        let sized = self.sized(model);
        sized.iter().for_each(|&i| theta[model.coordinates[i].parameter] = model.coordinates[i].value(to[i]));
        if sized.iter().all(|&i| to[i] == 0.0) {
            return Vec::new();
        }
        self.scanned(model, &theta, until).into_iter().filter_map(|m| self.on_its_own(m)).collect()
    }

    /// The coordinates of a model's last cause that may be of any size above nothing.
    fn sized(&self, model: &CandidateModel) -> Vec<usize> {
        let free = |i: &usize| {
            let c = &model.coordinates[*i];
            !c.logarithm && c.low == 0.0 && c.high.is_infinite()
        };
        (self.before.x.len()..model.coordinates.len()).filter(free).collect()
    }

    /// A model with its last cause of the sizes at which it comes nearest to the recordings as it stands: decades up from
    /// `usual` until nothing changes any more, and down until the effect is gone. Once the time is over, of those looked at.
    fn scanned(&self, model: &CandidateModel, usual: &[f64], until: Deadline<'_>) -> Vec<CandidateModel> {
        let places: Vec<usize> = self.sized(model).iter().map(|&i| model.coordinates[i].parameter).collect();
        let at = |half_decades: i32| {
            let mut model = model.clone();
            places.iter().for_each(|&p| model.model.theta[p] = usual[p] * 10f64.powf(0.5 * f64::from(half_decades)));
            model
        };
        let off = self.before.cost();
        let cost = |half_decades: i32| {
            if until.is_over() {
                return f64::INFINITY;
            }
            let mut model = at(half_decades);
            model.allowed = self.before.evaluated.steps.iter().map(|steps| SLOWER * steps).collect();
            let found = model.cost_within(&model.present(), &self.problem.train, &self.before.weights, SCANNED * off);
            found.unwrap_or(f64::INFINITY)
        };
        let same = |a: f64, b: f64| (a - b).abs() <= UNCHANGED * b || a.is_infinite() && b.is_infinite();
        let mut known = BTreeMap::from([(0, cost(0))]);
        for up in [true, false] {
            let mut last = known[&0];
            for k in 1..=DECADES {
                if !up && same(last, off) {
                    break;
                }
                let next = if up { 2 * k } else { -2 * k };
                let now = cost(next);
                known.insert(next, now);
                if up && same(now, last) && !same(now, off) {
                    break;
                }
                last = now;
            }
        }
        let least = |known: &BTreeMap<i32, f64>| known.iter().min_by(|a, b| a.1.total_cmp(b.1)).map_or(0, |b| *b.0);
        let best = least(&known);
        [best - 1, best + 1].into_iter().for_each(|k| {
            known.insert(k, cost(k));
        });
        let mut order: Vec<(i32, f64)> = known.into_iter().filter(|k| k.1.is_finite() && !same(k.1, off)).collect();
        order.sort_by(|a, b| a.1.total_cmp(&b.1));
        order.into_iter().take(SIZES).map(|(k, _)| at(k)).collect()
    }

    /// A model by a run of its own.
    fn on_its_own(&self, candidate: CandidateModel) -> Option<FitStart> {
        let x = candidate.present();
        self.at(candidate, x)
    }

    /// A model at a point.
    fn at(&self, mut candidate: CandidateModel, x: Vec<f64>) -> Option<FitStart> {
        let evaluated = candidate.evaluate(&x, &self.problem.train)?;
        candidate.off.clone_from(&evaluated.off);
        let sums = evaluated.by_signal(x.len());
        self.begin(candidate, x, &evaluated.errors, &sums)
    }
}
