//! Which of the rivals of one step is taken: once it is sure that something is missing, all that is worth it contends, and
//! held recordings confirm.

use super::super::clock::Deadline;
use super::super::estimate::ModelFit;
use super::super::policy::ALPHA;
use super::super::problem::{DiagnosisProblem, HypothesisValues};
use super::compare::{closed, needed};
use super::confirm::{HoldoutConfirmation, HoldoutRecordings};
use super::criteria::{CrossValidationScore, RejectionReason, RivalHypothesis, SelectionCriteria};
use super::weighed::{CrossValidatedFit, saved, widened};
use rayon::prelude::*;

/// A hypothesis that was weighed in a step.
#[derive(Clone, Debug)]
pub struct HypothesisTrial {
    /// The step: 1, 2, ...
    pub step: usize,
    /// What, with fitted values.
    pub chosen: HypothesisValues,
    /// What left-out data say of it, where it was fitted.
    pub found: Option<CrossValidationScore>,
    /// Nothing for the one that was taken.
    pub reason: Option<RejectionReason>,
}

/// An effect that was taken.
#[derive(Clone, Debug)]
pub struct AcceptedEffect {
    /// Index into [`DiagnosisProblem::hypotheses`].
    pub hypothesis: usize,
    /// Evidence of left-out data and prior when it was taken, nats.
    pub evidence: f64,
    /// t statistic over the blocks.
    pub t: f64,
    /// Part of the left-out gap that it closes.
    pub closes: f64,
    /// What cannot be told from it, with how far it is behind, nats.
    pub set: Vec<(HypothesisValues, f64)>,
}

/// What one step came to.
pub struct SelectionStep {
    /// Every rival with its reason, best first.
    pub trials: Vec<HypothesisTrial>,
    /// The model that is taken, with its effect.
    pub taken: Option<(CrossValidatedFit, AcceptedEffect)>,
    /// What is worth it, where left-out data were sure of nothing.
    pub undecided: Vec<RivalHypothesis>,
}

/// What rivals are judged by, and on which recordings.
pub struct EffectSelector<'a> {
    /// What is diagnosed.
    pub problem: &'a DiagnosisProblem<'a>,
    /// Recordings that only confirm.
    pub held: HoldoutRecordings<'a>,
    /// The tests.
    pub criteria: SelectionCriteria,
}

impl EffectSelector<'_> {
    fn is_shape(&self, rival: &RivalHypothesis) -> bool {
        self.problem.hypotheses[rival.hypothesis].is_shape()
    }

    /// Whether one of some rivals shows that something is missing: then all of them are compared with each other, not with
    /// nothing. Beside shapes, what was weighed before among more hypotheses is not sure now.
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

    /// The rival that is taken, with what cannot be told from it.
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
        // they are asked about what may be taken only
        let held =
            if judged.iter().any(CrossValidationScore::may) { self.held.left_by(&before.fit) } else { Vec::new() };
        // what held recordings refute shows nothing, and has beaten nobody
        let may: Vec<usize> = (0..rivals.len()).filter(|&i| judged[i].may()).collect();
        let ask = |&i: &usize| (i, self.held.ask(&held, &rivals[i].model.fit, &self.criteria.sensors));
        let asked: Vec<(usize, Option<HoldoutConfirmation>)> = may.par_iter().map(ask).collect();
        let refuted =
            |&(i, asked): &(usize, Option<HoldoutConfirmation>)| self.refuted(before, &rivals[i].model, asked);
        let (refuted, confirmed): (Vec<_>, Vec<_>) =
            asked.into_iter().map(|a| (a, refuted(&a))).partition(|(_, reason)| reason.is_some());
        let confirmed: Vec<(usize, Option<HoldoutConfirmation>)> = confirmed.into_iter().map(|(a, _)| a).collect();
        let any = self.is_sure(&confirmed, &rivals, &judged);
        for ((i, _), reason) in refuted {
            if any || judged[i].accepted() {
                reasons[i] = reason;
            }
        }
        let contenders: Vec<usize> = if any { confirmed.into_iter().map(|c| c.0).collect() } else { Vec::new() };
        contenders.iter().for_each(|&i| reasons[i] = None);
        self.widen(&contenders, &mut rivals, until);
        let is_shape = |i: usize| self.is_shape(&rivals[i]);
        let mut order = self.criteria.order(&contenders, &rivals, &judged, &mut reasons);
        // a shape has a coefficient for every bump: it counts where it surely leaves less than what has a name
        if !order.iter().all(|&i| is_shape(i)) {
            order.retain(|&i| !is_shape(i));
        }
        let taken = order.first().copied();
        for &i in order.iter().filter(|i| Some(**i) != taken) {
            reasons[i].get_or_insert(RejectionReason::Alike);
        }
        let trial = |(i, reason): (usize, Option<RejectionReason>)| {
            let chosen = last_cause(&rivals[i].model.fit);
            HypothesisTrial { step, chosen, found: Some(judged[i]), reason }
        };
        let trials = reasons.into_iter().enumerate().map(trial).collect();
        let Some(first) = taken else {
            let worth = rivals.into_iter().zip(&judged).filter(|(_, j)| !any && j.may());
            return SelectionStep { trials, taken: None, undecided: worth.map(|(r, _)| r).collect() };
        };
        let (best, sensors) = (&rivals[first].model, &self.criteria.sensors);
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

    /// Frees the width of what leaves as small a gap as the best with fewer coefficients, and is behind: a corner of a fixed
    /// width is not at its optimum beside a law whose own freedom rounds it.
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

    /// Best first.
    fn sort(&self, before: &CrossValidatedFit, rivals: &mut [RivalHypothesis]) {
        let sensors = &self.criteria.sensors;
        let least = |i: usize| {
            let all = rivals.iter().map(|r| &r.model).chain([before]).map(|w| w.left[0].mean(i));
            closed(sensors, i, all.fold(f64::INFINITY, f64::min))
        };
        let closed: Vec<f64> = (0..sensors.noise.len()).map(least).collect();
        let score = |r: &RivalHypothesis| self.criteria.score(&r.model, &closed);
        rivals.sort_by(|a, b| score(a).total_cmp(&score(b)));
    }

    /// Why held recordings do not confirm a model; nothing where they do, or there are none.
    fn refuted(
        &self,
        before: &CrossValidatedFit,
        model: &CrossValidatedFit,
        asked: Option<HoldoutConfirmation>,
    ) -> Option<RejectionReason> {
        let confirmed = asked?.confirms(saved(before, model), self.criteria.count);
        asked.filter(|_| !confirmed).map(RejectionReason::NotConfirmed)
    }

    /// Few recordings, few blocks: what is worth it is asked of the held recordings too. They are fresh, and a product of
    /// e-values of independent data is one; the bound on it is one for all hypotheses together.
    fn sure_with_held(&self, judged: &CrossValidationScore, asked: Option<HoldoutConfirmation>) -> bool {
        let shown =
            |a: HoldoutConfirmation| a.evidence > 0.0 && judged.evidence + a.evidence > needed(self.criteria.count);
        judged.may() && judged.evidence > 0.0 && asked.is_some_and(shown)
    }
}

/// The cause that a model has beyond the one before.
fn last_cause(fit: &ModelFit) -> HypothesisValues {
    fit.causes().pop().unwrap_or(HypothesisValues { hypothesis: 0, values: Vec::new() })
}
