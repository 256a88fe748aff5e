//! Linear screening: all hypotheses beside a fitted model, ordered by what a Gauss-Newton step promises.
//!
//! Enters: the fitted model of the step and the indices of the open hypotheses. Leaves: starts for the fits of
//! `rivals`.
//!
//! A hypothesis that vanishes at its off value does not change the trajectory there. One run with the sensitivities of
//! many such hypotheses therefore serves all of them. A hypothesis without a linear model at its off value gets runs of
//! its own, and its size is looked for over decades. Method: `docs/gap_method.md`, "Order of the hypotheses".

use super::super::clock::Deadline;
use super::super::effects::EffectCoefficient;
use super::super::estimate::candidate::{RecordingResiduals, SensitivityProducts};
use super::super::estimate::map::squares;
use super::super::estimate::{CandidateModel, ModelFit, NormalEquations};
use super::super::hypotheses::Hypothesis;
use super::super::problem::{DiagnosisProblem, HypothesisValues};
use super::compare::{SensorAccuracy, total_gap};
use super::models::{self, beginnings, candidate};
use super::weighed::at_nominal;
use crate::policy::{DECADES, OTHER_WEIGHTING, SCANNED, SIZES, SLOWER, STARTS, UNCHANGED};
use nalgebra::DVector;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::ops::Range;

/// Most hypotheses in one joint run. The cost of a run grows with states times hypotheses.
const TOGETHER: usize = 64;

/// The model to which hypotheses are added, with what is needed to add them.
#[derive(Clone, Copy)]
pub struct ScreeningContext<'a> {
    /// What is diagnosed.
    pub problem: &'a DiagnosisProblem<'a>,
    /// Noise and full scales of the sensors.
    pub sensors: &'a SensorAccuracy,
    /// The fitted model without the hypotheses.
    pub before: &'a ModelFit,
}

/// Two measures of the residuals on the train recordings.
#[derive(Clone, Debug)]
pub struct TrainingResidual {
    /// Weighted sum of squares with the prior. Signals with small and white errors dominate it.
    pub cost: f64,
    /// Noise-free gap over all signals, in parts of full scale. Signals with large errors dominate it.
    pub gap: f64,
}

/// A point from which the model with one more hypothesis is fitted, and the linear model there.
pub struct FitStart {
    /// The model with the hypothesis.
    pub candidate: CandidateModel,
    /// Coordinates of the start, in the order of the candidate's coordinates.
    pub x: Vec<f64>,
    /// Normal equations at the start, with the weights of the model before.
    system: NormalEquations,
    /// Residual that the linear model predicts behind one undamped step.
    promised: TrainingResidual,
}

impl FitStart {
    /// Cost that the linear model predicts behind one step, prior included.
    pub fn promises(&self) -> f64 {
        self.promised.cost
    }
}

/// Index of a hypothesis and its starts, the most promising first; at most [`STARTS`].
pub type ScreenedHypothesis = (usize, Vec<FitStart>);

/// Result of the screening.
pub struct ScreeningResult {
    /// Hypotheses in the order in which they should be fitted.
    pub order: Vec<ScreenedHypothesis>,
    /// Indices of hypotheses that were not screened for lack of time.
    pub passed: Vec<usize>,
    /// For each hypothesis that vanishes at its off value: what it would gain at its usual size, nats.
    pub visible: Vec<f64>,
}

/// Index of a hypothesis and the models with it, one for each of its starting values.
type HypothesisModels = (usize, Vec<CandidateModel>);
/// Index of a hypothesis and its starts with their linear models.
type HypothesisStarts = (usize, Vec<FitStart>);

/// Screens the hypotheses `open`. Those that need runs of their own are screened until the deadline, at least one
/// round.
pub fn screened(ground: &ScreeningContext<'_>, open: &[usize], until: Deadline<'_>) -> ScreeningResult {
    let (vanishing, mut others) = ground.attached_to(open);
    // Parameters far off their data sheet may stand in for the hypothesis, so it is also started from the data sheet.
    let nominal = ground.nominal();
    let moved = nominal.as_ref().map(|fit| (fit, moved(fit, &vanishing)));
    let mut all = ground.together(vanishing);
    // visibility is that beside the fitted model, before the starts at the data sheet are added
    let visible = all.iter().filter_map(|(i, models)| ground.visible(*i, models)).collect();
    if let Some((before, vanishing)) = moved {
        // hypotheses that need runs of their own are started from the fitted model only
        let begun = ScreeningContext { before, ..*ground }.together(vanishing);
        all.iter_mut().zip(begun).for_each(|(known, more)| known.1.extend(more.1));
    }
    // a scan over decades takes many runs of stiff models, so hypotheses without one come first
    others.sort_by_key(|(i, models)| ground.is_scanned(*i, &models[0]));
    let (alone, passed) = until.rounds(others, |(i, models)| (i, ground.alone(i, models, until)));
    all.extend(alone);
    // back in the order of the hypotheses, which decides ties of the ranking
    all.sort_by_key(|b| b.0);
    all.retain(|(_, models)| !models.is_empty());
    ScreeningResult { order: ordered(all), passed: passed.into_iter().map(|(i, _)| i).collect(), visible }
}

/// The models with the tolerance parameters of another fit.
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

/// Hypotheses ordered by their least promised cost and their least promised gap in turn, each with its best starts.
fn ordered(all: Vec<HypothesisStarts>) -> Vec<ScreenedHypothesis> {
    let least = |models: &[FitStart], by: fn(&TrainingResidual) -> f64| {
        models.iter().map(|m| by(&m.promised)).fold(f64::INFINITY, f64::min)
    };
    let order = by_turns(all, |b| least(&b.1, |l| l.cost), |b| least(&b.1, |l| l.gap));
    order.into_iter().map(|(i, models)| (i, starts(models))).collect()
}

/// Orders items by two measures in turn, the least first: an item counts by the better of its two ranks.
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

/// The at most [`STARTS`] most promising starts, chosen by cost and by gap in turn.
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

/// Whether the model with a hypothesis at its first values equals the model without it.
/// That needs the off value of each coefficient within its bounds and no additional states.
fn vanishes(h: &Hypothesis, model: &CandidateModel, before: &ModelFit) -> bool {
    let off = |c: &EffectCoefficient| {
        c.whole().is_none() && c.min.is_none_or(|m| m <= c.off) && c.max.is_none_or(|m| m >= c.off)
    };
    let states = model.model.plan.states() == before.candidate.model.plan.states();
    h.family == "parameter" || !h.changes_order && states && h.coefficients.iter().all(off)
}

impl ScreeningContext<'_> {
    /// The hypothesis of this index.
    fn h(&self, hypothesis: usize) -> &Hypothesis {
        &self.problem.hypotheses[hypothesis]
    }

    /// Whether the hypothesis frees a parameter from its tolerance.
    fn is_parameter(&self, hypothesis: usize) -> bool {
        self.h(hypothesis).family == "parameter"
    }

    /// Cost and gap of given sums of squares, one per signal; `prior` in squared deviations.
    fn left(&self, sums: Vec<f64>, prior: f64) -> TrainingResidual {
        let weights = &self.before.weights;
        let cost = sums.iter().enumerate().map(|(i, s)| weights.weight(i) * s).sum::<f64>() + prior;
        let mean = |(i, s): (usize, &f64)| s.max(0.0) / self.before.samples(i).max(1.0);
        let squares: Vec<f64> = sums.iter().enumerate().map(mean).collect();
        TrainingResidual { cost, gap: total_gap(&squares, self.sensors) }
    }

    /// The fitted model moved to the nominal values of its tolerance parameters.
    /// `None` if they are close to it already, or the model cannot be simulated there.
    /// A large missing effect bends parameters, and no linear step leads from the bent parameters to the effect.
    fn nominal(&self) -> Option<ModelFit> {
        if self.before.prior() <= OTHER_WEIGHTING {
            return None;
        }
        let mut fit = self.before.clone();
        fit.x = at_nominal(self.problem, &fit.candidate, &fit.x);
        fit.evaluated = fit.candidate.evaluate(&fit.x, &self.problem.train)?;
        Some(fit)
    }

    /// A start with its linear model. `errors` are the residuals and `sums` the sensitivity products, one per signal.
    /// `None` if the linear model predicts a cost that is not finite.
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
        // undamped: this only ranks, the fit damps its steps
        let to = system.step(&candidate.coordinates, &x, 0.0);
        let change = DVector::from_fn(x.len(), |i, _| to[i] - x[i]);
        let falls = |(i, s): (usize, &SensitivityProducts)| squares(errors, i) - s.gain(&change);
        let promised = self.left(sums.iter().enumerate().map(falls).collect(), candidate.prior(&to));
        promised.cost.is_finite().then_some(FitStart { candidate, x, system, promised })
    }

    /// Nats that a hypothesis would gain at its usual size; `None` if it does not vanish at its off value.
    /// Of several starts the one that gains most counts.
    fn visible(&self, hypothesis: usize, models: &[FitStart]) -> Option<f64> {
        let h = self.h(hypothesis);
        let gain = |m: &FitStart| m.system.visible(self.before.x.len(), h.coefficients.len());
        let vanishing = !self.is_parameter(hypothesis) && vanishes(h, &models.first()?.candidate, self.before);
        vanishing.then(|| models.iter().map(gain).fold(0.0, f64::max))
    }

    /// Models of all open hypotheses: first those that vanish at their off value, then the others.
    fn attached_to(&self, open: &[usize]) -> (Vec<HypothesisModels>, Vec<HypothesisModels>) {
        let attached = |&i: &usize| Some((i, self.attached(i)?));
        let all: Vec<HypothesisModels> = open.par_iter().filter_map(attached).collect();
        all.into_iter().partition(|(i, models)| vanishes(self.h(*i), &models[0], self.before))
    }

    /// The model with a hypothesis at each of its starting values; `None` if it does not compile.
    fn attached(&self, hypothesis: usize) -> Option<Vec<CandidateModel>> {
        let h = self.h(hypothesis);
        let tolerances = self.before.tolerances();
        let mut values = beginnings(h);
        let is_parameter = self.is_parameter(hypothesis);
        // a parameter starts where the fit before left it
        if is_parameter {
            let place = self.problem.tolerances.iter().position(|t| t.name == h.attachments[0].place.place);
            values = place.map(|p| vec![tolerances[p]]).into_iter().collect();
        }
        let mut causes = self.before.causes();
        causes.push(HypothesisValues { hypothesis, values: values.first()?.clone() });
        // one compilation serves all starting values, which differ in parameter values only
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

    /// Starts of hypotheses that vanish at their off value, by joint runs.
    fn together(&self, all: Vec<HypothesisModels>) -> Vec<HypothesisStarts> {
        let entries: Vec<HypothesisValues> = all
            .iter()
            .filter(|(i, _)| !self.is_parameter(*i))
            .flat_map(|(_, models)| models.iter().filter_map(|m| m.causes.last().cloned()))
            .collect();
        // at least as many groups as threads, so that all of them are busy
        let rounds = entries.len().div_ceil(TOGETHER).max(rayon::current_num_threads());
        let long = entries.len().div_ceil(rounds).max(1);
        let sums: Vec<Option<_>> = entries.par_chunks(long).flat_map_iter(|some| self.jointly(some)).collect();
        let mut sums = sums.into_iter();
        let ModelFit { x, evaluated, .. } = self.before;
        let mut begun = |i: usize, model: CandidateModel| {
            let present = model.present();
            // the sensitivity to a tolerance parameter is known from the fit before; only its prior is gone
            if self.is_parameter(i) {
                return self.begin(model, present, &evaluated.errors, &evaluated.by_signal(x.len()));
            }
            // a hypothesis that cannot be attached even alone in a joint run gets a run of its own
            let Some(sums) = sums.next()? else { return self.on_its_own(model) };
            let sums: Vec<SensitivityProducts> =
                sums.into_iter().map(|s: SensitivityProducts| s.with_idle(present.len())).collect();
            self.begin(model, present, &evaluated.errors, &sums)
        };
        all.into_iter().map(|(i, models)| (i, models.into_iter().filter_map(|m| begun(i, m)).collect())).collect()
    }

    /// Sensitivity products per signal for each of `some`. If the joint model fails, its halves are tried.
    /// `None` for a hypothesis that fails alone.
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

    /// Sensitivity products of hypotheses attached to one model: outer index hypothesis, inner index signal.
    /// `None` if the model does not compile, a coefficient is not free, or the simulation stops early.
    fn joint(&self, some: &[HypothesisValues]) -> Option<Vec<Vec<SensitivityProducts>>> {
        let mut causes = self.before.causes();
        let shapes = causes.len();
        causes.extend(some.iter().cloned());
        let taken = self.before.candidate.taken;
        let mut model = models::attached(self.problem, &causes, Some(&self.before.tolerances()), taken, shapes).ok()?;
        model.begins_as(&self.before.candidate);
        // coordinates of the hypotheses follow those of the model before, one group per hypothesis
        let mut first = self.before.x.len();
        let group = |c: &HypothesisValues| {
            let from = first;
            first += self.h(c.hypothesis).coefficients.len();
            from..first
        };
        let groups: Vec<Range<usize>> = some.iter().map(group).collect();
        // a coefficient that is not free would shift the groups
        if first != model.coordinates.len() {
            return None;
        }
        model.groups(&model.present(), &self.problem.train, &groups)
    }

    /// Starts of a hypothesis that does not vanish at its off value, each by a run of its own.
    fn alone(&self, hypothesis: usize, models: Vec<CandidateModel>, until: Deadline<'_>) -> Vec<FitStart> {
        let of_size = |m: CandidateModel| {
            if self.is_scanned(hypothesis, &m) { self.scanned(&m, &m.model.theta, until) } else { vec![m] }
        };
        models.into_iter().flat_map(of_size).filter_map(|m| self.on_its_own(m)).collect()
    }

    /// Whether the size of a hypothesis must be looked for over decades: it changes the order of the model, and has a
    /// coefficient of unbounded size.
    fn is_scanned(&self, hypothesis: usize, model: &CandidateModel) -> bool {
        self.h(hypothesis).changes_order && !self.sized(model).is_empty()
    }

    /// Starts at the sizes found over decades for a hypothesis that vanishes at its off value.
    /// The scan goes on from where the linear model leads, because a step beyond the first gain may end where the model
    /// cannot come back from. Empty for other hypotheses, and where the linear model does not move the size.
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

    /// Indices of the coordinates of the last cause that may have any value above zero.
    fn sized(&self, model: &CandidateModel) -> Vec<usize> {
        let free = |i: &usize| {
            let c = &model.coordinates[*i];
            !c.logarithm && c.low == 0.0 && c.high.is_infinite()
        };
        (self.before.x.len()..model.coordinates.len()).filter(free).collect()
    }

    /// The model with its last cause at the sizes where its cost is least, without refitting anything else.
    ///
    /// Sizes go up from `usual` by decades until the cost does not change any more, and down until it equals the cost
    /// without the effect. The two half decades beside the best one are tried last. At most [`SIZES`] models, the best
    /// first. Behind the deadline no further size is evaluated.
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
            // a size at which the model chatters takes very many steps and is given up
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
                // upwards the effect is as strong as it gets when the cost stays the same
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
        // sizes that leave the cost as without the effect are no starts
        let mut order: Vec<(i32, f64)> = known.into_iter().filter(|k| k.1.is_finite() && !same(k.1, off)).collect();
        order.sort_by(|a, b| a.1.total_cmp(&b.1));
        order.into_iter().take(SIZES).map(|(k, _)| at(k)).collect()
    }

    /// Start of a model at its present values, by a run of its own; `None` if the simulation stops early.
    fn on_its_own(&self, candidate: CandidateModel) -> Option<FitStart> {
        let x = candidate.present();
        self.at(candidate, x)
    }

    /// Start of a model at the coordinates `x`; `None` if the simulation stops early.
    fn at(&self, mut candidate: CandidateModel, x: Vec<f64>) -> Option<FitStart> {
        let evaluated = candidate.evaluate(&x, &self.problem.train)?;
        // the initial states found here are the first guess of the fit
        candidate.off.clone_from(&evaluated.off);
        let sums = evaluated.by_signal(x.len());
        self.begin(candidate, x, &evaluated.errors, &sums)
    }
}
