//! The search: one effect after another, until no hypothesis is sure, worth it and confirmed.

use super::super::data::Recording;
use super::super::diagnose::Stage;
use super::super::estimate::{Candidate, Fit, Weights};
use super::super::hypotheses::Hypothesis;
use super::super::policy::{
    ACCURACY, ALPHA, DELTA, EFFECTS, FITTED, FITTED_WITHOUT, FRONT, LEAST, NEAR, OPENS, OTHER_WEIGHTING, PROMISED, SURE,
};
use super::super::problem::{Chosen, Problem};
use super::compare::{Sensors, chances, closed, differences, evidence, gap, loss, needed, signal_gap, t_statistic};
use super::confirm::{Asked, ask};
use super::folds::{LeftOut, left_out};
use super::models;
use super::screen::{Screened, Start, screened};
use rayon::prelude::*;

/// A fit with what it leaves of left-out data.
#[derive(Clone, Debug)]
pub struct Weighed {
    /// The fit.
    pub fit: Fit,
    /// By pieces, and by recordings where there are enough.
    pub left: Vec<LeftOut>,
}

/// A hypothesis beside the model of one step.
#[derive(Clone, Debug)]
pub struct Rival {
    /// Index into [`Problem::hypotheses`].
    pub hypothesis: usize,
    /// The model with it.
    pub model: Weighed,
}

/// Why a hypothesis was not taken; printed as it is. Gaps are parts of full scale, evidence is in nats.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Reason {
    /// It was not fitted: others promised more.
    #[error("not fitted: a linear step of others promises more")]
    Behind,
    /// It was not fitted: weighed squares before, and what it promises to leave of them.
    #[error(
        "not fitted: a linear step leaves {1:.4} of weighed squares where {0:.4} are left without it, which is not worth a name"
    )]
    TooLittle(f64, f64),
    /// Left-out data do not show that it is better: chance, evidence, and the evidence needed.
    #[error("left-out data are not sure: chance {0:.3}, evidence {1:.1} of {2:.1} nats")]
    NotSure(f64, f64, f64),
    /// It closes too little.
    #[error("closes less than is worth a name")]
    NotWorth,
    /// The gap over all signals grows, by this factor.
    #[error("the gap over all signals grows to {0:.2} times what it was")]
    Opens(f64),
    /// The held recordings do not show the same.
    #[error(
        "held recordings do not confirm it: evidence {:.1} nats, gap {:.4} to {:.4} of full scale",
        .0.evidence, .0.before, .0.after
    )]
    NotConfirmed(Asked),
    /// Surely worse than the best: the gap that it leaves, and the best one's.
    #[error("surely worse: leaves {0:.4} of full scale, the best {1:.4}")]
    Beaten(f64, f64),
    /// In the set of what was taken.
    #[error("cannot be told from what was taken, which is simpler or more usual")]
    Alike,
}

/// A hypothesis that was weighed in a step.
#[derive(Clone, Debug)]
pub struct Trial {
    /// The step: 1, 2, ...
    pub step: usize,
    /// What, with fitted values.
    pub chosen: Chosen,
    /// What left-out data say of it, where it was fitted.
    pub found: Option<Judged>,
    /// Nothing for the one that was taken.
    pub reason: Option<Reason>,
}

/// An effect that was taken.
#[derive(Clone, Debug)]
pub struct Taken {
    /// Index into [`Problem::hypotheses`].
    pub hypothesis: usize,
    /// Evidence of left-out data and prior when it was taken, nats.
    pub evidence: f64,
    /// t statistic over the blocks.
    pub t: f64,
    /// What cannot be told from it, with how far it is behind, nats.
    pub set: Vec<(Chosen, f64)>,
}

/// What a search came to.
pub struct Found {
    /// The model within its tolerances.
    pub base: Weighed,
    /// With everything that was taken.
    pub last: Weighed,
    /// What was taken, in the order of the last model's causes.
    pub taken: Vec<Taken>,
    /// Everything that was weighed, best of each step first.
    pub trials: Vec<Trial>,
}

/// A search on its way.
struct Search<'a> {
    problem: &'a Problem<'a>,
    held: &'a [Recording],
    sensors: Sensors,
    /// Noise-free gap of each signal before anything was taken.
    first: Vec<f64>,
    trials: Vec<Trial>,
    /// What the screen left aside in this step.
    passed: Vec<Trial>,
}

/// Searches; held recordings only confirm. `None` where the model within its tolerances does not reach the end of the
/// recordings.
pub fn search(problem: &Problem<'_>, held: &[Recording], progress: &mut dyn FnMut(Stage)) -> Option<Found> {
    progress(Stage::Anchor);
    let sensors = models::sensors(problem);
    let nominal = models::candidate(problem, &[], None)?;
    let x = nominal.present();
    let base = weighed(problem, &sensors, &nominal, &x)?;
    let first = (0..sensors.noise.len()).map(|i| left_by(&base.left[0], i, &sensors)).collect();
    let mut search = Search { problem, held, sensors, first, trials: Vec::new(), passed: Vec::new() };
    let (mut last, mut taken) = (base.clone(), Vec::new());
    for step in 1..=EFFECTS {
        progress(Stage::Screen(step));
        let screened = search.screened(step, &last);
        progress(Stage::Refine(step));
        let rivals = search.fitted(screened);
        let Some((chosen, effect)) = search.choose(step, &last, rivals) else { break };
        last = chosen;
        taken.push(effect);
        search.drop_needless(&mut last, &mut taken);
        if search.is_recording_error(&taken) {
            break;
        }
    }
    Some(Found { base, last, taken, trials: search.trials })
}

impl Weighed {
    fn new(problem: &Problem<'_>, fit: Fit) -> Self {
        Weighed { left: left_out(&fit, &problem.train), fit }
    }
}

/// Both weightings: errors as they are now (tolerances hold), and as if only the sensors' noise were left (the data hold).
/// Left-out data and the prior decide.
pub fn weighed(problem: &Problem<'_>, sensors: &Sensors, candidate: &Candidate, x: &[f64]) -> Option<Weighed> {
    let one = Weighed::new(problem, as_they_are(problem, candidate.clone(), x.to_vec())?);
    Some(at_the_noise(problem, sensors, &one).unwrap_or(one))
}

/// A fit that weighs errors as large and as correlated as it leaves them.
fn as_they_are(problem: &Problem<'_>, candidate: Candidate, x: Vec<f64>) -> Option<Fit> {
    Fit::of(candidate, x, &problem.train, &problem.full_scale, None, 2)
}

/// The fit that begins where only the sensors' noise is left, where it is better.
fn at_the_noise(problem: &Problem<'_>, sensors: &Sensors, one: &Weighed) -> Option<Weighed> {
    let white = Weights::sensors(&sensors.noise, &problem.full_scale);
    let (candidate, x) = (one.fit.candidate.clone(), one.fit.x.clone());
    let begun = Fit::of(candidate, x, &problem.train, &problem.full_scale, Some(white), 1)?;
    let other = Weighed::new(problem, as_they_are(problem, begun.candidate, begun.x)?);
    (nats(one, &other, 0, sensors) + saved(one, &other) > OTHER_WEIGHTING).then_some(other)
}

/// Evidence of left-out data for the second model, nats.
fn nats(a: &Weighed, b: &Weighed, scheme: usize, sensors: &Sensors) -> f64 {
    let tau = |i: usize| a.fit.weights.tau[i].max(b.fit.weights.tau[i]);
    let independent: Vec<f64> = (0..sensors.noise.len()).map(|i| a.fit.samples(i) / tau(i)).collect();
    evidence(&a.left[scheme], &b.left[scheme], &independent, sensors)
}

/// What the second model saves of the prior, nats: without an effect parameters bend, which left-out data do not see.
fn saved(a: &Weighed, b: &Weighed) -> f64 {
    a.fit.prior() - b.fit.prior()
}

fn left_by(left: &LeftOut, signal: usize, sensors: &Sensors) -> f64 {
    signal_gap(left, signal, sensors).max(0.1 * LEAST * sensors.full_scale[signal])
}

/// What left-out data say of a model with a hypothesis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Judged {
    /// t statistic over the blocks.
    pub t: f64,
    /// Chance that the best of all hypotheses does as well by accident.
    pub chance: f64,
    /// Evidence of left-out data and prior, nats.
    pub evidence: f64,
    /// Gap that it leaves, in parts of full scale.
    pub gap: f64,
    sure: bool,
    worth: bool,
    opens: f64,
}

impl Judged {
    fn accepted(&self) -> bool {
        self.sure && self.may()
    }

    fn may(&self) -> bool {
        self.worth && self.opens <= 1.0 + OPENS
    }

    fn refused(&self, needed: f64) -> Reason {
        match () {
            () if !self.sure => Reason::NotSure(self.chance, self.evidence, needed),
            () if !self.worth => Reason::NotWorth,
            () => Reason::Opens(self.opens),
        }
    }
}

impl Search<'_> {
    fn h(&self, index: usize) -> &Hypothesis {
        &self.problem.hypotheses[index]
    }

    /// Hypotheses that may be tried beside what was taken.
    fn open(&self, before: &Fit) -> Vec<usize> {
        let taken: Vec<usize> = before.candidate.causes.iter().map(|c| c.hypothesis).collect();
        let one_law = |i: usize, t: usize| {
            let (a, b) = (self.h(i), self.h(t));
            a.law() == b.law() && a.attachments[0].site.is_at(&b.attachments[0].site)
        };
        let free = |i: usize| {
            let parameter = self.h(i).family == "parameter";
            let known =
                |t: &super::super::problem::Tolerance| t.name == self.h(i).attachments[0].place.place && !t.free;
            !parameter || self.problem.tolerances.iter().any(known)
        };
        let open = |&i: &usize| {
            let first = !self.h(i).is_recording_error() || taken.is_empty();
            first && !self.h(i).is_shape() && free(i) && !taken.iter().any(|&t| t == i || one_law(i, t))
        };
        (0..self.problem.hypotheses.len()).filter(open).collect()
    }

    /// How many hypotheses there are.
    fn count(&self) -> usize {
        self.problem.hypotheses.iter().filter(|h| !h.is_shape()).count()
    }

    /// The starts of the hypotheses that are worth a fit.
    fn screened(&mut self, step: usize, before: &Weighed) -> Vec<Screened> {
        let open = self.open(&before.fit);
        let mut all = screened(self.problem, &before.fit, &open, [FITTED, FITTED_WITHOUT]);
        let (cost, least) = (before.fit.cost(), self.least_gain(before));
        let leaves = |s: &Screened| s.1.iter().map(|s| s.cost.min(s.promised)).fold(f64::INFINITY, f64::min);
        let reason = |i: usize| match all.iter().find(|s| s.0 == i) {
            Some(s) if cost - leaves(s) < least => Some(Reason::TooLittle(cost, leaves(s))),
            Some(_) => None,
            None => Some(Reason::Behind),
        };
        let not_fitted: Vec<(usize, Reason)> = open.into_iter().filter_map(|i| Some((i, reason(i)?))).collect();
        all.retain(|s| !not_fitted.iter().any(|(i, _)| *i == s.0));
        let trial = |(hypothesis, reason)| {
            let chosen = Chosen { hypothesis, values: Vec::new() };
            Trial { step, chosen, found: None, reason: Some(reason) }
        };
        self.passed = not_fitted.into_iter().map(trial).collect();
        all
    }

    /// By how much weighed squares must fall at least where an effect is worth a name.
    fn least_gain(&self, before: &Weighed) -> f64 {
        let of_signal = |i: usize| {
            let (now, least) = (left_by(&before.left[0], i, &self.sensors), self.least(before, i));
            let falls = if least > now { f64::INFINITY } else { now * now - (now - least).powi(2) };
            before.fit.weights.weight(i) * before.fit.samples(i) * falls
        };
        let needed = needed(self.count());
        let of_prior = if before.fit.prior() > needed { 2.0 * needed } else { f64::INFINITY };
        PROMISED * (0..self.first.len()).map(of_signal).fold(of_prior, f64::min)
    }

    /// By how much the gap of a signal must shrink to be worth a name: by a part of what it is and was at first, and by the
    /// sensors' accuracy.
    fn least(&self, before: &Weighed, signal: usize) -> f64 {
        let now = left_by(&before.left[0], signal, &self.sensors);
        (DELTA * now).max(0.5 * DELTA * self.first[signal]).max(ACCURACY * self.sensors.full_scale[signal])
    }

    /// Fits from the best start; the front from its others too, and by both weightings.
    fn fitted(&self, screened: Vec<Screened>) -> Vec<Rival> {
        let (problem, sensors) = (self.problem, &self.sensors);
        let one = |(hypothesis, starts): Screened| {
            let mut starts = starts.into_iter();
            let first = starts.next()?;
            let model = Weighed::new(problem, as_they_are(problem, first.candidate, first.x)?);
            Some((Rival { hypothesis, model }, starts.collect::<Vec<Start>>()))
        };
        let mut rivals: Vec<(Rival, Vec<Start>)> = screened.into_par_iter().filter_map(one).collect();
        rivals.sort_by(|a, b| gap(&a.0.model.left[0], sensors).total_cmp(&gap(&b.0.model.left[0], sensors)));
        let front = FRONT.min(rivals.len());
        rivals[..front].par_iter_mut().for_each(|(rival, others)| {
            let others = others.drain(..).filter_map(|s| as_they_are(problem, s.candidate, s.x));
            let best = others.min_by(|a, b| a.nats().total_cmp(&b.nats()));
            if let Some(better) = best.filter(|b| b.nats() < rival.model.fit.nats()) {
                rival.model = Weighed::new(problem, better);
            }
            if let Some(better) = at_the_noise(problem, sensors, &rival.model) {
                rival.model = better;
            }
        });
        rivals.into_iter().map(|r| r.0).collect()
    }

    /// Whether left-out data are sure of each rival, and whether it is worth a name.
    fn judged(&self, before: &Weighed, rivals: &[Rival]) -> Vec<Judged> {
        let (schemes, needed) = (before.left.len(), needed(self.count()));
        let mut all: Vec<Judged> = rivals.iter().map(|r| self.worth(before, &r.model)).collect();
        for scheme in 0..schemes {
            let d: Vec<Vec<f64>> = rivals
                .iter()
                .map(|r| differences(&before.left[scheme], &r.model.left[scheme], &self.sensors))
                .collect();
            let chances = chances(&d);
            for (i, judged) in all.iter_mut().enumerate() {
                let found = nats(before, &rivals[i].model, scheme, &self.sensors);
                judged.t = judged.t.max(t_statistic(&d[i]));
                judged.chance = judged.chance.min(chances[i]);
                judged.evidence = judged.evidence.max(found + saved(before, &rivals[i].model));
            }
        }
        for j in &mut all {
            j.sure = j.chance <= ALPHA / schemes as f64 || j.evidence > needed + (schemes as f64).ln();
        }
        all
    }

    /// The gap of a signal must shrink, or the parameters return to their data sheet.
    fn worth(&self, before: &Weighed, model: &Weighed) -> Judged {
        let closes = |i: usize| {
            let left = |w: &Weighed| left_by(&w.left[0], i, &self.sensors);
            left(before) - left(model) >= self.least(before, i)
        };
        let gap = |w: &Weighed| gap(&w.left[0], &self.sensors);
        let worth = (0..self.first.len()).any(closes) || saved(before, model) > needed(self.count());
        let opens = gap(model) / gap(before).max(f64::MIN_POSITIVE);
        let (t, evidence) = (f64::NEG_INFINITY, f64::NEG_INFINITY);
        Judged { t, chance: 1.0, evidence, gap: gap(model), sure: false, worth, opens }
    }

    /// Two models that are one for the user.
    fn alike(&self, a: f64, best: f64) -> bool {
        a <= ((1.0 + NEAR) * best).max(best + ACCURACY)
    }

    /// Whether a model is surely worse than the best.
    fn worse(&self, best: &Weighed, other: &Weighed) -> bool {
        let of = |w: &Weighed| gap(&w.left[0], &self.sensors);
        if self.alike(of(other), of(best)) {
            return false;
        }
        let t = t_statistic(&differences(&other.left[0], &best.left[0], &self.sensors));
        t > SURE || nats(other, best, 0, &self.sensors) + saved(other, best) > (1.0 / ALPHA).ln()
    }

    /// Mean loss over blocks and signals: what orders rivals.
    fn score(&self, model: &Weighed, closed: &[f64]) -> f64 {
        let left = &model.left[0];
        let mut sum = 0.0;
        for (squares, samples) in left.squares.iter().zip(&left.samples) {
            for i in 0..closed.len() {
                sum += samples[i] * loss(squares[i], closed[i]);
            }
        }
        sum
    }

    /// The rival that is taken, with what cannot be told from it.
    fn choose(&mut self, step: usize, before: &Weighed, mut rivals: Vec<Rival>) -> Option<(Weighed, Taken)> {
        let least = |i: usize| {
            let all = rivals.iter().map(|r| &r.model).chain([before]).map(|w| w.left[0].mean(i));
            closed(&self.sensors, i, all.fold(f64::INFINITY, f64::min))
        };
        let closed: Vec<f64> = (0..self.first.len()).map(least).collect();
        rivals.sort_by(|a, b| self.score(&a.model, &closed).total_cmp(&self.score(&b.model, &closed)));
        let judged = self.judged(before, &rivals);
        let needed = needed(self.count());
        let mut reasons: Vec<Option<Reason>> =
            judged.iter().map(|j| (!j.accepted()).then(|| j.refused(needed))).collect();
        let mut accepted: Vec<usize> = (0..rivals.len()).filter(|&i| judged[i].accepted()).collect();
        if accepted.is_empty() {
            accepted.extend(self.with_held(before, &rivals, &judged, &mut reasons));
        }
        let order = self.order(&accepted, &rivals, &mut reasons);
        let taken = order.iter().copied().find(|&i| {
            let asked = ask(&before.fit, &rivals[i].model.fit, self.held, &self.sensors);
            let refused =
                asked.filter(|a| !a.confirms(saved(before, &rivals[i].model), self.count())).map(Reason::NotConfirmed);
            reasons[i] = refused;
            reasons[i].is_none()
        });
        for &i in order.iter().filter(|i| Some(**i) != taken) {
            reasons[i].get_or_insert(Reason::Alike);
        }
        let trial = |i: usize| Trial {
            step,
            chosen: last_cause(&rivals[i].model.fit),
            found: Some(judged[i]),
            reason: reasons[i].clone(),
        };
        self.trials.extend((0..rivals.len()).map(trial));
        self.trials.append(&mut self.passed);
        let first = taken?;
        let best = &rivals[first].model;
        let set = order.iter().filter(|i| **i != first).map(|&i| {
            let behind = nats(&rivals[i].model, best, 0, &self.sensors) + saved(&rivals[i].model, best);
            (last_cause(&rivals[i].model.fit), behind)
        });
        let effect = Taken {
            hypothesis: rivals[first].hypothesis,
            evidence: judged[first].evidence,
            t: judged[first].t,
            set: set.collect(),
        };
        Some((best.clone(), effect))
    }

    /// Few recordings, few blocks: the one that leaves least is asked of the held recordings too. They are fresh, and a
    /// product of e-values of independent data is one.
    fn with_held(
        &self,
        before: &Weighed,
        rivals: &[Rival],
        judged: &[Judged],
        reasons: &mut [Option<Reason>],
    ) -> Option<usize> {
        let best = (0..rivals.len()).find(|&i| judged[i].may())?;
        let asked = ask(&before.fit, &rivals[best].model.fit, self.held, &self.sensors)?;
        let sum = judged[best].evidence + asked.evidence;
        if sum > needed(self.count()) && asked.evidence > 0.0 {
            reasons[best] = None;
            return Some(best);
        }
        None
    }

    /// The set of what cannot be told apart: those that leave hardly more than the best first, of these the simplest, then
    /// what leaves parameters where they are known to be, then what is usual on machines.
    fn order(&self, accepted: &[usize], rivals: &[Rival], reasons: &mut [Option<Reason>]) -> Vec<usize> {
        let Some(&best) = accepted.first() else { return Vec::new() };
        let of = |i: usize| gap(&rivals[i].model.left[0], &self.sensors);
        let near = |i: usize| self.alike(of(i), of(best));
        let mut set = Vec::new();
        for &i in accepted {
            if i != best && self.worse(&rivals[best].model, &rivals[i].model) {
                reasons[i] = Some(Reason::Beaten(of(i), of(best)));
            } else {
                set.push(i);
            }
        }
        let prior = |i: usize| rivals[i].model.fit.prior();
        let least = set.iter().filter(|&&i| near(i)).map(|&i| prior(i)).fold(f64::INFINITY, f64::min);
        let bent = |i: usize| prior(i) - least > (1.0 / ALPHA).ln();
        set.sort_by_key(|&i| (!near(i), rivals[i].model.fit.candidate.own, bent(i), rivals[i].hypothesis));
        set
    }

    /// Drops what was taken before and is not missed any more.
    fn drop_needless(&self, last: &mut Weighed, taken: &mut Vec<Taken>) {
        let mut i = 0;
        while i + 1 < taken.len() {
            let mut causes = models::causes(&last.fit);
            causes.remove(i);
            let without = models::candidate(self.problem, &causes, Some(&last.fit.tolerances()));
            let fitted = without.and_then(|c| weighed(self.problem, &self.sensors, &c, &c.present()));
            match fitted.filter(|f| !self.worse(last, f)) {
                Some(fitted) => {
                    *last = fitted;
                    taken.remove(i);
                }
                None => i += 1,
            }
        }
    }

    fn is_recording_error(&self, taken: &[Taken]) -> bool {
        taken.iter().any(|t| self.h(t.hypothesis).is_recording_error())
    }
}

/// The cause that a model has beyond the one before.
fn last_cause(fit: &Fit) -> Chosen {
    models::causes(fit).pop().unwrap_or(Chosen { hypothesis: 0, values: Vec::new() })
}
