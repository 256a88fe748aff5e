//! The choice among the rivals of one step.
//!
//! Enters: the model before and the fitted rivals. Leaves: a [`SelectionStep`] with the accepted effect, or none, and a
//! reason for every rival that was not taken. Once one rival is sure, something is missing; then all rivals that are
//! worth a name and that held recordings confirm compete, and the simplest of those that cannot be told apart is taken.
//! Method: `docs/gap_method.md`, "Which of several is taken".

use super::super::clock::Deadline;
use super::super::estimate::ModelFit;
use super::super::problem::{DiagnosisProblem, HypothesisValues};
use super::compare::{closed, needed};
use super::confirm::{HoldoutConfirmation, HoldoutRecordings};
use super::criteria::{CrossValidationScore, RejectionReason, RivalHypothesis, SelectionCriteria};
use super::weighed::{CrossValidatedFit, saved, widened};
use crate::policy::ALPHA;
use rayon::prelude::*;

/// A hypothesis as it was judged in one step.
#[derive(Clone, Debug)]
pub struct HypothesisTrial {
    /// Number of the step, from 1.
    pub step: usize,
    /// The hypothesis with its fitted values; no values where it was not fitted.
    pub chosen: HypothesisValues,
    /// Its score on left-out data; `None` where it was not fitted.
    pub found: Option<CrossValidationScore>,
    /// Why it was not taken; `None` for the one that was.
    pub reason: Option<RejectionReason>,
}

/// An accepted effect.
#[derive(Clone, Debug)]
pub struct AcceptedEffect {
    /// Index into [`DiagnosisProblem::hypotheses`].
    pub hypothesis: usize,
    /// Evidence of left-out data and prior when it was accepted, nats.
    pub evidence: f64,
    /// t statistic over the blocks of left-out data.
    pub t: f64,
    /// Part of the left-out gap of the model before that it closes.
    pub closes: f64,
    /// Hypotheses that cannot be told from it, and how many nats each is behind it (negative: ahead).
    pub set: Vec<(HypothesisValues, f64)>,
}

/// Result of one step.
pub struct SelectionStep {
    /// Every rival with its score and reason, best first.
    pub trials: Vec<HypothesisTrial>,
    /// The model with the accepted effect, and that effect.
    pub taken: Option<(CrossValidatedFit, AcceptedEffect)>,
    /// Rivals that are worth a name, in a step in which left-out data were sure of none.
    pub undecided: Vec<RivalHypothesis>,
}

/// Criteria and recordings by which rivals are judged.
pub struct EffectSelector<'a> {
    /// What is diagnosed.
    pub problem: &'a DiagnosisProblem<'a>,
    /// Held recordings, which only confirm.
    pub held: HoldoutRecordings<'a>,
    /// Criteria of acceptance.
    pub criteria: SelectionCriteria,
}

impl EffectSelector<'_> {
    /// Whether a rival is a shape without a physical name.
    fn is_shape(&self, rival: &RivalHypothesis) -> bool {
        self.problem.hypotheses[rival.hypothesis].is_shape()
    }

    /// Whether one of `some` shows that something is missing, by train data or together with held data.
    /// Beside shapes only a shape can show it: the effects among them were judged in their own step and were not sure.
    fn is_sure(
        &self,
        some: &[(usize, Option<HoldoutConfirmation>)],
        rivals: &[RivalHypothesis],
        judged: &[CrossValidationScore],
    ) -> bool {
        let any_shape = rivals.iter().any(|r| self.is_shape(r));
        let mut fresh = some.iter().filter(|(i, _)| !any_shape || self.is_shape(&rivals[*i]));
        fresh.any(|&(i, asked)| judged[i].accepted() || self.sure_with_held(&judged[i], asked))
    }

    /// Judges the rivals of a step and takes one of them, with the set of those that cannot be told from it.
    pub fn choose(
        &self,
        step: usize,
        before: &CrossValidatedFit,
        mut rivals: Vec<RivalHypothesis>,
        until: Deadline<'_>,
    ) -> SelectionStep {
        self.sort(before, &mut rivals);
        let judged = self.criteria.judged(before, &rivals, &self.problem.train);
        let needed = needed(self.criteria.count);
        let mut reasons: Vec<Option<RejectionReason>> =
            judged.iter().map(|j| (!j.accepted()).then(|| j.refused(needed))).collect();
        // held recordings are simulated only if some rival may be taken
        let held =
            if judged.iter().any(CrossValidationScore::may) { self.held.left_by(&before.fit) } else { Vec::new() };
        // A rival that held recordings refute shows nothing, and cannot beat another one.
        let may: Vec<usize> = (0..rivals.len()).filter(|&i| judged[i].may()).collect();
        let ask = |&i: &usize| (i, self.held.ask(&held, &rivals[i].model.fit, &self.criteria.sensors));
        let asked: Vec<(usize, Option<HoldoutConfirmation>)> = may.par_iter().map(ask).collect();
        let refuted =
            |&(i, asked): &(usize, Option<HoldoutConfirmation>)| self.refuted(before, &rivals[i].model, asked);
        let (refuted, confirmed): (Vec<_>, Vec<_>) =
            asked.into_iter().map(|a| (a, refuted(&a))).partition(|(_, reason)| reason.is_some());
        let confirmed: Vec<(usize, Option<HoldoutConfirmation>)> = confirmed.into_iter().map(|(a, _)| a).collect();
        // from here on rivals are compared with each other, not with the model before
        let any = self.is_sure(&confirmed, &rivals, &judged);
        for ((i, _), reason) in refuted {
            // otherwise the reason of the train data stays: not sure
            if any || judged[i].accepted() {
                reasons[i] = reason;
            }
        }
        let contenders: Vec<usize> = if any { confirmed.into_iter().map(|c| c.0).collect() } else { Vec::new() };
        // contenders need not be sure one by one
        contenders.iter().for_each(|&i| reasons[i] = None);
        self.widen(&contenders, &mut rivals, until);
        let is_shape = |i: usize| self.is_shape(&rivals[i]);
        let mut order = self.criteria.order(&contenders, &rivals, &judged, &mut reasons);
        // A shape has a coefficient for every bump, so it counts only if it surely leaves less than every named effect.
        if !order.iter().all(|&i| is_shape(i)) {
            order.retain(|&i| !is_shape(i));
        }
        let taken = order.first().copied();
        for &i in order.iter().filter(|i| Some(**i) != taken) {
            // what stands and is not taken is indistinguishable
            reasons[i].get_or_insert(RejectionReason::Alike);
        }
        let trial = |(i, reason): (usize, Option<RejectionReason>)| {
            let chosen = last_cause(&rivals[i].model.fit);
            HypothesisTrial { step, chosen, found: Some(judged[i]), reason }
        };
        let trials = reasons.into_iter().enumerate().map(trial).collect();
        let Some(first) = taken else {
            // they may still be taken once a shape has shown that something is missing
            let worth = rivals.into_iter().zip(&judged).filter(|(_, j)| !any && j.may());
            return SelectionStep { trials, taken: None, undecided: worth.map(|(r, _)| r).collect() };
        };
        let (best, sensors) = (&rivals[first].model, &self.criteria.sensors);
        // beyond a likelihood ratio of 1/ALPHA the data do tell two models apart
        let once = (1.0 / ALPHA).ln();
        let behind = |&i: &usize| {
            let other = &rivals[i].model;
            let nats = self.criteria.behind(best, other);
            (nats <= once).then(|| (last_cause(&other.fit), nats))
        };
        let CrossValidationScore { evidence, t, .. } = judged[first];
        let effect = AcceptedEffect {
            hypothesis: rivals[first].hypothesis,
            evidence,
            t,
            closes: 1.0 - best.gap(sensors) / before.gap(sensors).max(f64::MIN_POSITIVE),
            set: order.iter().filter(|i| **i != first).filter_map(behind).collect(),
        };
        SelectionStep { trials, taken: Some((best.clone(), effect)), undecided: Vec::new() }
    }

    /// Frees the widths of rivals that leave as small a gap as the first contender with fewer coefficients, but are
    /// behind it. A corner of a fixed width is at a disadvantage beside a law whose own freedom rounds the corner.
    fn widen(&self, contenders: &[usize], rivals: &mut [RivalHypothesis], until: Deadline<'_>) {
        let Some((&first, others)) = contenders.split_first() else { return };
        let own = |r: &RivalHypothesis| r.model.fit.candidate.own;
        for &i in others {
            let why = self.criteria.worse(&rivals[first].model, &rivals[i].model);
            if matches!(why, Some(RejectionReason::NatsBehind(_)))
                && own(&rivals[i]) < own(&rivals[first])
                && !until.is_over()
                && let Some(wider) = widened(self.problem, &self.criteria.sensors, &rivals[i].model, until)
            {
                rivals[i].model = wider;
            }
        }
    }

    /// Sorts rivals by their mean loss over blocks and signals, the least first.
    fn sort(&self, before: &CrossValidatedFit, rivals: &mut [RivalHypothesis]) {
        let sensors = &self.criteria.sensors;
        // the level of a closed gap is set by the best model of each signal
        let least = |i: usize| {
            let all = rivals.iter().map(|r| &r.model).chain([before]).map(|w| w.left[0].mean(i));
            closed(sensors, i, all.fold(f64::INFINITY, f64::min))
        };
        let closed: Vec<f64> = (0..sensors.noise.len()).map(least).collect();
        let score = |r: &RivalHypothesis| self.criteria.score(&r.model, &closed);
        rivals.sort_by(|a, b| score(a).total_cmp(&score(b)));
    }

    /// Why held recordings do not confirm a model; `None` if they do, or if there are none (`asked` is `None`).
    fn refuted(
        &self,
        before: &CrossValidatedFit,
        model: &CrossValidatedFit,
        asked: Option<HoldoutConfirmation>,
    ) -> Option<RejectionReason> {
        let confirmed = asked?.confirms(saved(before, model), self.criteria.count);
        asked.filter(|_| !confirmed).map(RejectionReason::NotConfirmed)
    }

    /// Whether train and held recordings together are sure of a rival that train data alone are not sure of.
    /// Held recordings are independent of the train ones, and a product of e-values of independent data is an e-value.
    /// The bound for all hypotheses together therefore holds for the sum of the evidences.
    fn sure_with_held(&self, judged: &CrossValidationScore, asked: Option<HoldoutConfirmation>) -> bool {
        let shown =
            |a: HoldoutConfirmation| a.evidence > 0.0 && judged.evidence + a.evidence > needed(self.criteria.count);
        judged.may() && judged.evidence > 0.0 && asked.is_some_and(shown)
    }
}

/// The cause that a model has beyond the one before: its last one.
fn last_cause(fit: &ModelFit) -> HypothesisValues {
    fit.causes().pop().unwrap_or(HypothesisValues { hypothesis: 0, values: Vec::new() })
}
