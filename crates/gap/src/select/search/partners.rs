//! Once a second effect is taken: does what could not be told from the first one explain as much alone, or more with a partner
//! of its own? The first effect was chosen among equals, and a second beside a wrong one makes up for it.

use super::super::super::policy::{ALPHA, FRONT};
use super::super::super::problem::HypothesisValues;
use super::super::choose::{AcceptedEffect, HypothesisTrial};
use super::super::criteria::RejectionReason;
use super::super::models;
use super::super::weighed::{CrossValidatedFit, settled};
use super::EffectSearch;

/// A model with the effects that it takes.
#[derive(Clone)]
pub(super) struct EffectExplanation {
    pub model: CrossValidatedFit,
    pub taken: Vec<AcceptedEffect>,
}

impl EffectExplanation {
    fn effects(&self) -> usize {
        self.taken.len()
    }

    /// Its first effect, with fitted values.
    fn first(&self) -> Option<HypothesisValues> {
        self.model.fit.causes().into_iter().next()
    }
}

impl EffectSearch<'_> {
    /// What stands of an explanation with two effects and of those that begin with what cannot be told from its first effect:
    /// of all that are not surely worse than the best, that with the fewest effects, found first. Its set has the others that
    /// stand with as many, and those for which there was no time.
    pub(super) fn reconsidered(&mut self, base: &CrossValidatedFit, found: EffectExplanation) -> EffectExplanation {
        let set = found.taken.first().map(|t| t.set.clone()).unwrap_or_default();
        let before = found.taken.clone();
        let mut all = vec![found];
        let mut asked = 0;
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

    /// Of what is not surely worse than the best that with the fewest effects, found first; its set has the others that stand
    /// with as many.
    fn standing(&self, all: &[EffectExplanation]) -> EffectExplanation {
        let criteria = &self.chooser.criteria;
        let gap = |e: &EffectExplanation| e.model.gap(&criteria.sensors);
        let best = all[1..].iter().fold(&all[0], |best, e| if gap(e) < gap(best) { e } else { best });
        let stands = |e: &&EffectExplanation| gap(e) <= gap(best) || criteria.worse(&best.model, &e.model).is_none();
        let standing: Vec<&EffectExplanation> = all.iter().filter(stands).collect();
        let fewest = standing.iter().map(|e| e.effects()).min().unwrap_or(best.effects());
        let chosen = standing.iter().copied().find(|e| e.effects() == fewest).unwrap_or(best);
        let nats = |e: &&EffectExplanation| Some((e.first()?, criteria.behind(&chosen.model, &e.model)));
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

    /// One hypothesis of the first step beside the model within its tolerances.
    fn alone(&self, base: &CrossValidatedFit, chosen: &HypothesisValues) -> Option<EffectExplanation> {
        let causes = [chosen.clone()];
        let fitted = self.weighed(models::candidate(self.problem, &causes, Some(&base.fit.tolerances()), 1)?)?;
        let sensors = &self.chooser.criteria.sensors;
        let model = settled(self.problem, sensors, fitted, self.ends);
        let judged = self.trials.iter().find(|t| t.step == 1 && t.chosen.hypothesis == chosen.hypothesis)?.found?;
        let closes = 1.0 - model.gap(sensors) / base.gap(sensors).max(f64::MIN_POSITIVE);
        let (evidence, t) = (judged.evidence, judged.t);
        let taken = AcceptedEffect { hypothesis: chosen.hypothesis, evidence, t, closes, set: Vec::new() };
        Some(EffectExplanation { model, taken: vec![taken] })
    }

    /// The same with the best second effect beside it; `None` where no hypothesis is sure.
    fn with_partner(&mut self, alone: &EffectExplanation) -> Option<EffectExplanation> {
        let passed = std::mem::take(&mut self.passed);
        let open = self.open(&alone.model.fit);
        let rivals = self.rivals(2, &alone.model, &open, None);
        self.passed = passed;
        let (model, partner) = self.chooser.choose(2, &alone.model, rivals, self.ends).taken?;
        let model = self.freed(model);
        let taken = alone.taken.iter().cloned().chain([partner]).collect();
        Some(EffectExplanation { model, taken })
    }

    /// Says of what was taken first and is not named why, and names what is.
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
