//! Reconsideration of the first effect once a second one is accepted.
//!
//! The first effect was chosen among several that the data could not distinguish. If that choice was wrong, the second
//! effect may only make up for it. So each of the others is fitted alone and with the best partner of its own, and the
//! explanations are compared (`docs/gap_method.md`, "Which of several is taken").

use super::super::super::problem::HypothesisValues;
use super::super::choose::{AcceptedEffect, HypothesisTrial};
use super::super::criteria::RejectionReason;
use super::super::models;
use super::super::weighed::{CrossValidatedFit, settled};
use super::EffectSearch;
use crate::policy::{ALPHA, FRONT};

/// An explanation of the gap: a model with its accepted effects.
#[derive(Clone)]
pub(super) struct EffectExplanation {
    /// The fitted model.
    pub model: CrossValidatedFit,
    /// Its effects, in the order of the model's causes.
    pub taken: Vec<AcceptedEffect>,
}

impl EffectExplanation {
    /// Number of effects.
    fn effects(&self) -> usize {
        self.taken.len()
    }

    /// The first effect with its fitted values; `None` for a model without effects.
    fn first(&self) -> Option<HypothesisValues> {
        self.model.fit.causes().into_iter().next()
    }
}

impl EffectSearch<'_> {
    /// The best explanation among `found` (two effects) and those that begin with an effect indistinguishable from its
    /// first.
    ///
    /// Explanations that are surely worse than the best are dropped. Of the rest the one with the fewest effects
    /// stands, and of several the one that was found first. The `set` of its first effect lists the others with as many
    /// effects, and those that were not tried for lack of time. At most [`FRONT`] alternatives are tried.
    pub(super) fn reconsidered(&mut self, base: &CrossValidatedFit, found: EffectExplanation) -> EffectExplanation {
        let set = found.taken.first().map(|t| t.set.clone()).unwrap_or_default();
        let before = found.taken.clone();
        let mut all = vec![found];
        let mut asked = 0;
        // each alternative costs a fit and a complete step of the search
        while asked < set.len().min(FRONT) && !self.ends.is_over() {
            let alone = self.alone(base, &set[asked].0);
            let pair = alone.as_ref().and_then(|a| self.with_partner(a));
            all.extend(alone.into_iter().chain(pair));
            asked += 1;
        }
        let mut chosen = self.standing(&all);
        if let Some(first) = chosen.taken.first_mut() {
            first.set.extend(set.into_iter().skip(asked));
        }
        self.rewrite(&before, &chosen);
        chosen
    }

    /// The explanation that stands among `all`, with the set of alternatives that have as many effects.
    /// The first entry of `all` is the one found by the search.
    fn standing(&self, all: &[EffectExplanation]) -> EffectExplanation {
        let criteria = &self.chooser.criteria;
        let gap = |e: &EffectExplanation| e.model.gap(&criteria.sensors);
        let best = all[1..].iter().fold(&all[0], |best, e| if gap(e) < gap(best) { e } else { best });
        // the best has the least gap; another one stands unless it is surely worse
        let stands = |e: &&EffectExplanation| gap(e) <= gap(best) || criteria.worse(&best.model, &e.model).is_none();
        let standing: Vec<&EffectExplanation> = all.iter().filter(stands).collect();
        let fewest = standing.iter().map(|e| e.effects()).min().unwrap_or(best.effects());
        let chosen = standing.iter().copied().find(|e| e.effects() == fewest).unwrap_or(best);
        let nats = |e: &&EffectExplanation| Some((e.first()?, criteria.behind(&chosen.model, &e.model)));
        // a ratio of 1/ALPHA between two models: below it they count as indistinguishable
        let once = (1.0 / ALPHA).ln();
        let as_many = standing
            .iter()
            .copied()
            .filter(|e| e.effects() == chosen.effects() && e.taken[0].hypothesis != chosen.taken[0].hypothesis);
        let others = as_many.filter_map(|e| nats(&e)).filter(|(_, nats)| *nats <= once).collect();
        let mut chosen = chosen.clone();
        if let Some(first) = chosen.taken.first_mut() {
            first.set = others;
        }
        chosen
    }

    /// One hypothesis fitted beside the model within its tolerances.
    /// `None` if it cannot be simulated, or if the first step did not judge it.
    fn alone(&self, base: &CrossValidatedFit, chosen: &HypothesisValues) -> Option<EffectExplanation> {
        let causes = [chosen.clone()];
        let fitted = self.weighed(models::candidate(self.problem, &causes, Some(&base.fit.tolerances()), 1)?)?;
        let sensors = &self.chooser.criteria.sensors;
        let model = settled(self.problem, sensors, fitted, self.ends);
        // evidence and t are those of the first step, where all hypotheses were compared with the same model
        let judged = self.trials.iter().find(|t| t.step == 1 && t.chosen.hypothesis == chosen.hypothesis)?.found?;
        let closes = 1.0 - model.gap(sensors) / base.gap(sensors).max(f64::MIN_POSITIVE);
        let (evidence, t) = (judged.evidence, judged.t);
        let taken = AcceptedEffect { hypothesis: chosen.hypothesis, evidence, t, closes, set: Vec::new() };
        Some(EffectExplanation { model, taken: vec![taken] })
    }

    /// The explanation with its best second effect; `None` if no hypothesis is accepted beside it.
    fn with_partner(&mut self, alone: &EffectExplanation) -> Option<EffectExplanation> {
        // the fits for this explanation must not change the list of the step that the search is in
        let passed = std::mem::take(&mut self.passed);
        let open = self.open(&alone.model.fit);
        let rivals = self.rivals(2, &alone.model, &open, None);
        self.passed = passed;
        let (model, partner) = self.chooser.choose(2, &alone.model, rivals, self.ends).taken?;
        let model = self.freed(model);
        let taken = alone.taken.iter().cloned().chain([partner]).collect();
        Some(EffectExplanation { model, taken })
    }

    /// Corrects the reasons in the trials: effects that were accepted and do not stand any more get
    /// [`RejectionReason::Reconsidered`], those of the new explanation get none.
    fn rewrite(&mut self, before: &[AcceptedEffect], chosen: &EffectExplanation) {
        let named = |step: usize, hypothesis: usize| {
            chosen.taken.get(step - 1).is_some_and(|t: &AcceptedEffect| t.hypothesis == hypothesis)
        };
        for (step, old) in (1..).zip(before) {
            let of_step = |t: &&mut HypothesisTrial| t.step == step;
            for trial in self.trials.iter_mut().filter(of_step) {
                let hypothesis = trial.chosen.hypothesis;
                if named(step, hypothesis) {
                    trial.reason = None;
                } else if hypothesis == old.hypothesis {
                    trial.reason = Some(RejectionReason::Reconsidered);
                }
            }
        }
    }
}
