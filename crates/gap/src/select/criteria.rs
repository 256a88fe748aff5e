//! When is a hypothesis taken? When left-out data are sure of it, it is worth a name and it opens nothing; of those, the
//! simplest among what cannot be told apart. Everything else has its reason.

use super::super::data::RecordingData;
use super::super::policy::{ACCURACY, ALPHA, DELTA, NEAR, SURE};
use super::compare::{SensorAccuracy, differences, loss, needed, t_statistic};
use super::confirm::HoldoutConfirmation;
use super::matched::{AdjustableModel, evidence, refitted};
use super::weighed::{CrossValidatedFit, ahead, left_by, saved};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// A hypothesis beside the model of one step.
#[derive(Clone, Debug)]
pub struct RivalHypothesis {
    /// Which of the problem's hypotheses.
    pub hypothesis: usize,
    /// At how many places it acts.
    pub places: usize,
    /// By how many of its standard deviations its largest coefficient differs from nothing; infinite where none is free.
    pub size: f64,
    /// For a parameter, by how many of its tolerances it is off: it has to be out of them, whatever it gains.
    pub tolerances: Option<f64>,
    /// The model with it.
    pub model: CrossValidatedFit,
}

/// Why a hypothesis was not taken; printed as it is. Gaps are parts of full scale, evidence is in nats.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RejectionReason {
    /// It was not fitted: others promised more, and the time was over.
    #[error("not weighed: the time was over; `--budget` gives more")]
    Behind,
    /// Left-out data do not show that it is better: evidence, and the evidence needed.
    #[error("left-out data are not sure: evidence {0:.1} of {1:.1} nats")]
    NotSure(f64, f64),
    /// It closes too little.
    #[error("closes less than is worth a name")]
    NotWorth,
    /// Its size may as well be none, by so many of its standard deviations.
    #[error("its size does not differ significantly from zero: {0:.1} standard deviations")]
    NoSize(f64),
    /// The gap over all signals grows, by this factor.
    #[error("the gap over all signals grows to {0:.2} times what it was")]
    Opens(f64),
    /// The held recordings do not show the same.
    #[error(
        "held recordings do not confirm it: evidence {:.1} nats, gap {:.4} to {:.4} of full scale, nominal {:.4}",
        .0.evidence, .0.before, .0.after, .0.nominal
    )]
    NotConfirmed(HoldoutConfirmation),
    /// Surely worse than the best: the gap that it leaves, and the best one's.
    #[error("surely worse: leaves {0:.4} of full scale, the best {1:.4}")]
    Beaten(f64, f64),
    /// It leaves as small a gap as the best, but left-out data and the prior prefer that one, by so many nats.
    #[error("as small a gap, but {0:.1} nats behind the best")]
    NatsBehind(f64),
    /// It was chosen at first, but with two effects it does not stand.
    #[error("chosen at first, but another explanation with a second effect leaves less, or needs no second one")]
    Reconsidered,
    /// In the set of what was taken.
    #[error("indistinguishable from an accepted effect that is simpler or more common")]
    Alike,
}

/// What left-out data say of a model with a hypothesis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CrossValidationScore {
    /// t statistic over the blocks.
    pub t: f64,
    /// Evidence of left-out data and prior, nats.
    pub evidence: f64,
    /// Gap that it leaves, in parts of full scale.
    pub gap: f64,
    sure: bool,
    /// Evidence alone is, of what had no size before.
    plain: bool,
    worth: bool,
    size: f64,
    /// What it was before.
    before: f64,
    opens: bool,
}

impl CrossValidationScore {
    /// Whether it may be taken.
    pub fn accepted(&self) -> bool {
        self.sure && self.may()
    }

    /// Whether it may be taken where other data are sure of it.
    pub fn may(&self) -> bool {
        self.worth && self.has_size() && !self.opens
    }

    /// Whether it is not nothing: by its standard deviation, or by evidence that is plain, for a deviation is that of a model
    /// which is linear in it.
    fn has_size(&self) -> bool {
        self.size > SURE || self.plain
    }

    /// Why it may not be taken.
    pub fn refused(&self, needed: f64) -> RejectionReason {
        match () {
            () if !self.sure => RejectionReason::NotSure(self.evidence, needed),
            () if !self.worth => RejectionReason::NotWorth,
            () if !self.has_size() => RejectionReason::NoSize(self.size),
            () => RejectionReason::Opens(self.gap / self.before),
        }
    }
}

/// What rivals are judged by.
pub struct SelectionCriteria {
    /// The sensors.
    pub sensors: SensorAccuracy,
    /// Noise-free gap of each signal before anything was taken.
    pub first: Vec<f64>,
    /// How many hypotheses there are.
    pub count: usize,
}

impl SelectionCriteria {
    /// Whether no signal has a gap that could shrink by as much as is worth a name, and no parameter is bent.
    pub fn nothing_is_worth_it(&self, before: &CrossValidatedFit) -> bool {
        let left = |i: usize| left_by(&before.left[0], i, &self.sensors);
        (0..self.first.len()).all(|i| self.least(before, i) > left(i)) && !self.is_bent(before)
    }

    /// Whether parameters are so far off that an effect which brings them back is worth a name.
    fn is_bent(&self, before: &CrossValidatedFit) -> bool {
        before.fit.prior() > needed(self.count) || before.fit.candidate.is_bent(&before.fit.x)
    }

    /// By how much the gap of a signal must shrink to be worth a name: by a part of what it is and was at first, and by the
    /// sensors' accuracy.
    fn least(&self, before: &CrossValidatedFit, signal: usize) -> f64 {
        let now = left_by(&before.left[0], signal, &self.sensors);
        (DELTA * now).max(0.5 * DELTA * self.first[signal]).max(ACCURACY * self.sensors.full_scale[signal])
    }

    /// Whether left-out data are sure of each rival, and whether it is worth a name. Of what is not worth one the evidence is
    /// not refined.
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
            let refined = with
                .and_then(|b| Some(refitted(b, &AdjustableModel::new(model, train, &self.sensors)?, &self.sensors)));
            judged.evidence = refined.unwrap_or_else(|| {
                let by = |k: usize| evidence(&before.left[k].errors, &model.left[k].errors, &self.sensors);
                (0..schemes).map(by).fold(f64::NEG_INFINITY, f64::max) + saved(before, model)
            });
            judged.sure = judged.evidence > needed + (schemes as f64).ln();
            judged.plain = judged.sure && rival.tolerances.is_none_or(|off| off > SURE);
            judged
        };
        rivals.par_iter().map(one).collect()
    }

    /// The gap of a signal must shrink, or the parameters return to their data sheet.
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

    /// Two models that are one for the user.
    pub fn alike(&self, a: f64, best: f64) -> bool {
        a <= ((1.0 + NEAR) * best).max(best + ACCURACY)
    }

    /// Nats by which left-out data and the prior prefer the best to another model.
    pub fn behind(&self, best: &CrossValidatedFit, other: &CrossValidatedFit) -> f64 {
        evidence(&other.left[0].errors, &best.left[0].errors, &self.sensors) + saved(other, best)
    }

    /// Why a model is surely worse than the best; nothing where it is not.
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

    /// Mean loss over blocks and signals: what orders rivals.
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

    /// The set of what cannot be told apart: those that leave hardly more than the best first, of these what leaves parameters
    /// where they are known to be, then the simplest (fewest coefficients, fewest places), then what the data prefer, then what
    /// is usual on machines.
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
            match self.worse(&rivals[best].model, &rivals[i].model).filter(|_| i != best) {
                Some(reason) => reasons[i] = Some(reason),
                None => set.push(i),
            }
        }
        // each coefficient costs as much as a bent parameter may
        let once = (1.0 / ALPHA).ln();
        let cost = |i: usize| rivals[i].model.fit.prior() + once * rivals[i].model.fit.candidate.own as f64;
        let least = set.iter().filter(|&&i| near(i)).map(|&i| cost(i)).fold(f64::INFINITY, f64::min);
        let bent = |i: usize| cost(i) - least > once;
        let simple = |i: usize| (rivals[i].model.fit.candidate.own, rivals[i].places);
        let behind = |i: usize| {
            let as_simple = set.iter().filter(|&&k| k != i && near(k) && simple(k) == simple(i));
            as_simple.map(|&k| ahead(&rivals[i].model, &rivals[k].model, &self.sensors)).fold(0.0, f64::max) > once
        };
        // nobody is named who is not sure himself, however simple
        let unsure = |i: usize| !judged[i].accepted();
        let key = |&i: &usize| (i, (!near(i), unsure(i), bent(i), simple(i), behind(i), rivals[i].hypothesis));
        let keys: BTreeMap<usize, _> = set.iter().map(key).collect();
        set.sort_by_key(|i| keys[i]);
        set
    }
}
