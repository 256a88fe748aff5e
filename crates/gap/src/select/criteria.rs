//! Criteria by which a hypothesis is accepted, and the order of those that cannot be told apart.
//!
//! A hypothesis must be sure by left-out data, worth a name, different from zero, and must not open the gap elsewhere.
//! Of several that stand, the simplest is preferred. `choose` applies the criteria.
//! Method: the table of `docs/gap_method.md`, "When an effect is accepted".

use super::super::data::RecordingData;
use super::compare::{SensorAccuracy, differences, loss, needed, t_statistic};
use super::confirm::HoldoutConfirmation;
use super::matched::{AdjustableModel, evidence, refitted};
use super::weighed::{CrossValidatedFit, ahead, left_by, saved};
use crate::policy::{ACCURACY, ALPHA, DELTA, NEAR, SURE};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// A fitted hypothesis beside the model of one step.
#[derive(Clone, Debug)]
pub struct RivalHypothesis {
    /// Index into the problem's hypotheses.
    pub hypothesis: usize,
    /// Number of places at which it acts.
    pub places: usize,
    /// Distance of its largest coefficient from zero, in standard deviations; infinite where no coefficient is free.
    pub size: f64,
    /// For a parameter its distance from the data sheet in tolerances; it must be out of them, whatever it gains.
    pub tolerances: Option<f64>,
    /// The fitted model with it.
    pub model: CrossValidatedFit,
}

/// Why a hypothesis was not taken; printed in the verdict as it is. Gaps are parts of full scale, evidence is in nats.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RejectionReason {
    /// It was not fitted for lack of time.
    #[error("not weighed: the time was over; `--budget` gives more")]
    Behind,
    /// Left-out data are not sure of it: evidence, and the evidence that is needed.
    #[error("left-out data are not sure: evidence {0:.1} of {1:.1} nats")]
    NotSure(f64, f64),
    /// It closes less than is worth a name.
    #[error("closes less than is worth a name")]
    NotWorth,
    /// Its size is not significantly different from zero: distance in standard deviations.
    #[error("its size does not differ significantly from zero: {0:.1} standard deviations")]
    NoSize(f64),
    /// The gap over all signals grows by this factor.
    #[error("the gap over all signals grows to {0:.2} times what it was")]
    Opens(f64),
    /// The held recordings do not show the same.
    #[error(
        "held recordings do not confirm it: evidence {:.1} nats, gap {:.4} to {:.4} of full scale, nominal {:.4}",
        .0.evidence, .0.before, .0.after, .0.nominal
    )]
    /// Held recordings do not confirm it.
    NotConfirmed(HoldoutConfirmation),
    /// It is surely worse than the best: the gap that it leaves, and that of the best.
    #[error("surely worse: leaves {0:.4} of full scale, the best {1:.4}")]
    Beaten(f64, f64),
    /// It leaves as small a gap as the best, but left-out data and the prior prefer the best by so many nats.
    #[error("as small a gap, but {0:.1} nats behind the best")]
    NatsBehind(f64),
    /// It was accepted first, but another explanation replaced it when a second effect was accepted.
    #[error("chosen at first, but another explanation with a second effect leaves less, or needs no second one")]
    Reconsidered,
    /// It cannot be told from the effect that was taken.
    #[error("indistinguishable from an accepted effect that is simpler or more common")]
    Alike,
}

/// Score of a hypothesis on left-out data, with the outcome of each criterion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CrossValidationScore {
    /// t statistic over the blocks.
    pub t: f64,
    /// Evidence of left-out data and prior, nats.
    pub evidence: f64,
    /// Gap that the model leaves, in parts of full scale.
    pub gap: f64,
    /// The evidence exceeds what the best of all hypotheses needs.
    sure: bool,
    /// The evidence also stands for a size: it is sure, and a parameter is out of its tolerances.
    plain: bool,
    /// It closes enough of some signal's gap, or returns parameters to their data sheet.
    worth: bool,
    /// Distance of its size from zero in standard deviations.
    size: f64,
    /// Gap of the model before, in parts of full scale.
    before: f64,
    /// The gap over all signals grows by more than the scatter of gaps.
    opens: bool,
}

impl CrossValidationScore {
    /// Whether all criteria on train data hold.
    pub fn accepted(&self) -> bool {
        self.sure && self.may()
    }

    /// Whether all criteria but the evidence hold: it may be taken if other data are sure of it.
    pub fn may(&self) -> bool {
        self.worth && self.has_size() && !self.opens
    }

    /// Whether its size differs from zero: by its standard deviation, or by plain evidence.
    /// The standard deviation is that of a model linear in the coefficient, which need not hold for a corner or a dead
    /// zone.
    fn has_size(&self) -> bool {
        self.size > SURE || self.plain
    }

    /// The first criterion that fails; `needed` is the evidence that is asked for.
    pub fn refused(&self, needed: f64) -> RejectionReason {
        match () {
            () if !self.sure => RejectionReason::NotSure(self.evidence, needed),
            () if !self.worth => RejectionReason::NotWorth,
            () if !self.has_size() => RejectionReason::NoSize(self.size),
            () => RejectionReason::Opens(self.gap / self.before),
        }
    }
}

/// Data that the criteria need.
pub struct SelectionCriteria {
    /// Noise and full scales of the sensors.
    pub sensors: SensorAccuracy,
    /// Noise-free gap of each signal before any effect, SI.
    pub first: Vec<f64>,
    /// Number of hypotheses `m` in the bound `ln(m/ALPHA)`.
    pub count: usize,
}

impl SelectionCriteria {
    /// Whether no signal has a gap that could shrink by as much as is worth a name, and no parameter is far off its
    /// data sheet.
    pub fn nothing_is_worth_it(&self, before: &CrossValidatedFit) -> bool {
        let left = |i: usize| left_by(&before.left[0], i, &self.sensors);
        (0..self.first.len()).all(|i| self.least(before, i) > left(i)) && !self.is_bent(before)
    }

    /// Whether parameters are so far off their data sheet that an effect which returns them is worth a name.
    fn is_bent(&self, before: &CrossValidatedFit) -> bool {
        before.fit.prior() > needed(self.count) || before.fit.candidate.is_bent(&before.fit.x)
    }

    /// Least decrease of a signal's gap that is worth a name, SI: a part of what it is and was at first, and the
    /// accuracy.
    fn least(&self, before: &CrossValidatedFit, signal: usize) -> f64 {
        let now = left_by(&before.left[0], signal, &self.sensors);
        (DELTA * now).max(0.5 * DELTA * self.first[signal]).max(ACCURACY * self.sensors.full_scale[signal])
    }

    /// Scores of all rivals, in their order.
    /// Rivals that are not worth a name, or that open the gap, get the evidence without the refit, since it cannot save
    /// them.
    pub fn judged(
        &self,
        before: &CrossValidatedFit,
        rivals: &[RivalHypothesis],
        train: &[RecordingData],
    ) -> Vec<CrossValidationScore> {
        let (schemes, needed) = (before.left.len(), needed(self.count));
        let movable = AdjustableModel::new(before, train, &self.sensors);
        let one = |rival: &RivalHypothesis| {
            let mut judged = self.worth(before, rival);
            let model = &rival.model;
            judged.t = t_statistic(&differences(&before.left[0], &model.left[0], &self.sensors));
            let with = movable.as_ref().filter(|_| judged.worth && !judged.opens);
            // the refit needs one run with sensitivities of each model
            let refined = with
                .and_then(|b| Some(refitted(b, &AdjustableModel::new(model, train, &self.sensors)?, &self.sensors)));
            judged.evidence = refined.unwrap_or_else(|| {
                let by = |k: usize| evidence(&before.left[k].errors, &model.left[k].errors, &self.sensors);
                (0..schemes).map(by).fold(f64::NEG_INFINITY, f64::max) + saved(before, model)
            });
            // with two schemes the larger evidence counts, which costs ln 2
            judged.sure = judged.evidence > needed + (schemes as f64).ln();
            judged.plain = judged.sure && rival.tolerances.is_none_or(|off| off > SURE);
            judged
        };
        rivals.par_iter().map(one).collect()
    }

    /// A score with gap, worth and size; evidence and t are still missing.
    fn worth(&self, before: &CrossValidatedFit, rival: &RivalHypothesis) -> CrossValidationScore {
        let model = &rival.model;
        let closes = |i: usize| {
            let left = |w: &CrossValidatedFit| left_by(&w.left[0], i, &self.sensors);
            left(before) - left(model) >= self.least(before, i)
        };
        let gap = model.gap(&self.sensors);
        let worth = (0..self.first.len()).any(closes) || saved(before, model) > needed(self.count);
        let before = before.gap(&self.sensors).max(f64::MIN_POSITIVE);
        let opens = !self.alike(gap, before);
        let (t, evidence) = (f64::NEG_INFINITY, f64::NEG_INFINITY);
        CrossValidationScore { t, evidence, gap, sure: false, plain: false, worth, size: rival.size, before, opens }
    }

    /// Whether the gap `a` counts as equal to the best one, in parts of full scale.
    pub fn alike(&self, a: f64, best: f64) -> bool {
        a <= ((1.0 + NEAR) * best).max(best + ACCURACY)
    }

    /// Nats by which left-out data and the prior prefer the best to another model.
    pub fn behind(&self, best: &CrossValidatedFit, other: &CrossValidatedFit) -> f64 {
        evidence(&other.left[0].errors, &best.left[0].errors, &self.sensors) + saved(other, best)
    }

    /// Why a model is surely worse than the best; `None` if it is not.
    pub fn worse(&self, best: &CrossValidatedFit, other: &CrossValidatedFit) -> Option<RejectionReason> {
        let (gap, least) = (other.gap(&self.sensors), best.gap(&self.sensors));
        let nats = self.behind(best, other);
        let beaten = nats > (1.0 / ALPHA).ln();
        if self.alike(gap, least) {
            return beaten.then_some(RejectionReason::NatsBehind(nats));
        }
        let t = || t_statistic(&differences(&other.left[0], &best.left[0], &self.sensors));
        (beaten || t() > SURE).then_some(RejectionReason::Beaten(gap, least))
    }

    /// Sum of the losses of a model over blocks and signals, which orders rivals. `closed`: per signal the level of
    /// [`super::compare::closed`].
    pub fn score(&self, model: &CrossValidatedFit, closed: &[f64]) -> f64 {
        let left = &model.left[0];
        let mut sum = 0.0;
        for (squares, samples) in left.squares.iter().zip(&left.samples) {
            for i in 0..closed.len() {
                sum += samples[i] * loss(squares[i], closed[i]);
            }
        }
        sum
    }

    /// The contenders that are not surely worse than the best, most preferred first. Others get their reason.
    ///
    /// `accepted` are indices of rivals, the best first. The order is: a gap equal to the best one's, sure by itself,
    /// parameters within their tolerances, fewest coefficients, fewest places, what left-out data prefer, the order of
    /// the library.
    pub fn order(
        &self,
        accepted: &[usize],
        rivals: &[RivalHypothesis],
        judged: &[CrossValidationScore],
        reasons: &mut [Option<RejectionReason>],
    ) -> Vec<usize> {
        let Some(&best) = accepted.first() else { return Vec::new() };
        let of = |i: usize| rivals[i].model.gap(&self.sensors);
        let near = |i: usize| self.alike(of(i), of(best));
        let mut set = Vec::new();
        for &i in accepted {
            // the best itself is not compared with itself
            match self.worse(&rivals[best].model, &rivals[i].model).filter(|_| i != best) {
                Some(reason) => reasons[i] = Some(reason),
                None => set.push(i),
            }
        }
        // a coefficient costs as many squared deviations as evidence for one hypothesis needs nats
        let once = (1.0 / ALPHA).ln();
        let cost = |i: usize| rivals[i].model.fit.prior() + once * rivals[i].model.fit.candidate.own as f64;
        // only those with an equal gap set the standard for the parameters
        let least = set.iter().filter(|&&i| near(i)).map(|&i| cost(i)).fold(f64::INFINITY, f64::min);
        let bent = |i: usize| cost(i) - least > once;
        let simple = |i: usize| (rivals[i].model.fit.candidate.own, rivals[i].places);
        // data decide only among models of equal complexity
        let behind = |i: usize| {
            let as_simple = set.iter().filter(|&&k| k != i && near(k) && simple(k) == simple(i));
            as_simple.map(|&k| ahead(&rivals[i].model, &rivals[k].model, &self.sensors)).fold(0.0, f64::max) > once
        };
        // a hypothesis that is not sure by itself comes behind those that are, however simple it is
        let unsure = |i: usize| !judged[i].accepted();
        let key = |&i: &usize| (i, (!near(i), unsure(i), bent(i), simple(i), behind(i), rivals[i].hypothesis));
        // keys are computed once, since each takes comparisons with the rest of the set
        let keys: BTreeMap<usize, _> = set.iter().map(key).collect();
        set.sort_by_key(|i| keys[i]);
        set
    }
}
