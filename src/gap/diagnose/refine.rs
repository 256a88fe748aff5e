//! Candidates of a screen one by one: each fitted together with everything accepted before, the front to its optimum.

use super::super::filter::{Setting, Tape};
use super::super::fit::{self, Fit, Prior, vuong};
use super::super::hypotheses::Hypothesis;
use super::super::locate;
use super::super::problem::{Assembled, Chosen, Problem};
use super::super::screen::{self, Accepted, Candidate};
use super::{CONSISTENT, SCATTER, Search};
use rayon::prelude::*;
use std::collections::BTreeSet;

/// Candidates of a screen that are refined.
const REFINED: usize = 5;
/// Gain that a candidate must promise to be refined, nats.
const PROMISING: f64 = 5.0;
/// Candidates behind this part of the best one's gain are not refined.
const FAR: f64 = 0.1;
/// Others of the best one's kind that are refined beside it, at most, and what they may be behind in the screen, nats.
const SIBLINGS: usize = 4;
const LEVEL: f64 = 15.0;
/// Those first by what the inputs alone bring about that are refined too.
const DRIVEN: usize = 3;
/// Part of a tolerance within which a parameter counts as at its end.
pub(super) const AT_BOUND: f64 = 1e-3;
/// Candidates that are there or not; the deviation of their share from the whole, and samples with which their shapes are
/// tried.
const BOUNDED: usize = 4;
const WHOLE: f64 = 0.3;
const TRIED: usize = 1500;
/// Lags and dead times that the screen does not see and that are refined all the same, at most.
const LATE: usize = 2;
/// Part of the time of a lag that is tried beside it.
const SHORT: f64 = 0.1;
/// Shapes without a name that are refined beside, each of another kind.
const SHAPES: usize = 5;
/// Iterations with which candidates are compared before the front is polished, and candidates polished.
const RACE: usize = 2;
const POLISHED: usize = 5;
/// Those behind by this part of the front's gain and by so many nats stay as they are: first at the levels of the model
/// before, then at their own.
const BEHIND: f64 = 0.4;
const FAR_BEHIND: f64 = 0.5;
const CLOSE: f64 = 200.0;
/// Turns at most in which those that are nearly as good take over each other's levels.
const LEVELLED: usize = 2;
/// A candidate that is so much worse than the model without it is not tried further, nats.
const HOPELESS: f64 = 3e3;

/// A refined candidate.
pub(super) struct Refined {
    pub accepted: Accepted,
    pub assembled: Assembled,
    pub fit: Fit,
}

impl Refined {
    /// With the fitted values; a choice among variants has its price.
    pub(super) fn new(problem: &Problem<'_>, accepted: Accepted, assembled: Assembled, mut fit: Fit) -> Self {
        fit.evidence -= screen::variants_cost(&problem.hypotheses[accepted.chosen.hypothesis]);
        let values = assembled.attached.last().map_or_else(Vec::new, |own| values(&fit, own));
        let chosen = Chosen { values, ..accepted.chosen };
        Refined { accepted: Accepted { chosen, ..accepted }, assembled, fit }
    }

    /// The same with another fit of its model.
    fn refitted(self, problem: &Problem<'_>, another: impl FnOnce(Fit) -> Fit) -> Self {
        let cost = screen::variants_cost(&problem.hypotheses[self.accepted.chosen.hypothesis]);
        let fit = Fit { evidence: self.fit.evidence + cost, ..self.fit };
        Refined::new(problem, self.accepted, self.assembled, another(fit))
    }

    pub(super) fn is_shape(&self, problem: &Problem<'_>) -> bool {
        problem.hypotheses[self.accepted.chosen.hypothesis].is_shape()
    }
}

impl Search {
    /// Fits candidates one by one; best first. At the levels of the model before, those that fall far behind stay as they
    /// are; for the others the levels are found anew.
    pub(super) fn refined(&self, problem: &Problem<'_>, chosen: &[Candidate]) -> Vec<Refined> {
        let is_lag = |c: &Candidate| is_lag(&problem.hypotheses[c.chosen.hypothesis]);
        let without = if chosen.iter().any(is_lag) { self.tried(problem, None) } else { None };
        let mut refined: Vec<Refined> = chosen.par_iter().filter_map(|c| self.refine(problem, c, without)).collect();
        best_first(&mut refined);
        let front = refined.first().map_or(0.0, |r| self.gain(&r.fit));
        let far = (BEHIND * front).max(CLOSE);
        let readjust = |r: Refined| {
            if self.gain(&r.fit) < front - far {
                return r;
            }
            r.refitted(problem, |fit| readjusted(problem, &self.last, fit))
        };
        let mut refined: Vec<Refined> = refined.into_par_iter().map(readjust).collect();
        best_first(&mut refined);
        refined
    }

    /// Fits one candidate together with everything accepted before. An effect that is there or not (a rectifying sensor)
    /// looks small from where it is not: it begins as a whole, and less than half of it would be something else. `without`
    /// is the likelihood of the model without it on the beginning of the first recording.
    fn refine(&self, problem: &Problem<'_>, candidate: &Candidate, without: Option<f64>) -> Option<Refined> {
        let h = &problem.hypotheses[candidate.chosen.hypothesis];
        let mut whole = candidate.clone();
        if h.is_bounded() {
            make_whole(h, &mut whole);
            if h.variants().len() > 1 {
                let found = self.shape_of_whole(problem, h, &mut whole);
                if is_lag(h) && !without.is_none_or(|w| self.comes_late(problem, &whole, found, w)) {
                    return None;
                }
            }
        }
        let accepted = whole.accepted();
        let mut all = self.accepted.clone();
        all.push(accepted.clone());
        let (fit, assembled) = at_levels(problem, &self.last, &all)?;
        Some(Refined::new(problem, accepted, assembled, fit))
    }

    /// Effects that are there or not, at the places of such that come near the front: from where they are not they all look
    /// alike (a lag, a dead time), and one shorter than the samples may seem to act the other way. Those that are better
    /// than nothing as a whole.
    pub(super) fn kin(&self, problem: &Problem<'_>, refined: &[Refined]) -> Vec<Candidate> {
        let site = |index: usize| &problem.hypotheses[index].attachments[0].site;
        let of = |r: &Refined| r.accepted.chosen.hypothesis;
        let front = refined.first().map_or(0.0, |r| self.gain(&r.fit));
        let near =
            |r: &&Refined| problem.hypotheses[of(r)].is_bounded() && self.gain(&r.fit) > PROMISING.max(BEHIND * front);
        let sites: Vec<_> = refined.iter().filter(near).map(|r| site(of(r))).collect();
        let known = |i: usize| self.has(i) || refined.iter().any(|r| of(r) == i);
        let open = |i: &usize| problem.hypotheses[*i].is_bounded() && sites.contains(&site(*i)) && !known(*i);
        let open: Vec<usize> = (0..problem.hypotheses.len()).filter(open).collect();
        self.better_whole(problem, &open).into_iter().map(|(_, candidate)| candidate).collect()
    }

    /// Lags and dead times that look like nothing from where they are not and are better than nothing as a whole: a sensor
    /// that comes later than the model's time constants leads the filter wherever it says.
    pub(super) fn late(&self, problem: &Problem<'_>, chosen: &[Candidate]) -> Vec<Candidate> {
        let known = |i: usize| self.has(i) || chosen.iter().any(|c| c.chosen.hypothesis == i);
        let open = |i: &usize| is_lag(&problem.hypotheses[*i]) && !known(*i);
        let open: Vec<usize> = (0..problem.hypotheses.len()).filter(open).collect();
        let mut found = self.better_whole(problem, &open);
        found.sort_by(|a, b| b.0.total_cmp(&a.0));
        found.into_iter().take(LATE).map(|(_, candidate)| candidate).collect()
    }

    /// Those that are better as a whole than nothing on the beginning of the first recording, and by how much.
    fn better_whole(&self, problem: &Problem<'_>, open: &[usize]) -> Vec<(f64, Candidate)> {
        if open.is_empty() {
            return Vec::new();
        }
        let Some(without) = self.tried(problem, None) else { return Vec::new() };
        let better = |&i: &usize| {
            let h = &problem.hypotheses[i];
            let mut candidate = whole(h, i)?;
            let gain = self.shape_of_whole(problem, h, &mut candidate)? - without;
            (gain > 0.0).then_some((gain, candidate))
        };
        open.par_iter().filter_map(better).collect()
    }

    /// Whether a lag or dead time with the best time of its grid, or a much shorter one, is better than none on the
    /// beginning of the first recording.
    fn comes_late(&self, problem: &Problem<'_>, whole: &Candidate, found: Option<f64>, without: f64) -> bool {
        let mut short = whole.accepted();
        let count = problem.hypotheses[whole.chosen.hypothesis].coefficients.len();
        short.chosen.values[count..].iter_mut().for_each(|t| *t *= SHORT);
        found.is_some_and(|f| f > without) || self.tried(problem, Some(short)).is_some_and(|f| f > without)
    }

    /// Gives a whole effect the shape that fits it: that of a small share of it may be nothing like (a twentieth of twenty
    /// samples' delay is one sample's). Gives its likelihood on the beginning of the first recording.
    fn shape_of_whole(&self, problem: &Problem<'_>, h: &Hypothesis, whole: &mut Candidate) -> Option<f64> {
        let count = h.coefficients.len();
        let with = |variant: Chosen| {
            let mut formed = whole.clone();
            formed.chosen.values[count..].copy_from_slice(&variant.values[count..]);
            let shapes = h.shapes.iter().zip(&variant.values[count..]);
            formed.priors.splice(count.., shapes.map(|(s, &x)| screen::shape_prior(s, x)));
            Some((self.tried(problem, Some(formed.accepted()))?, formed))
        };
        let variants = screen::variants(h, whole.chosen.hypothesis).into_iter();
        let (likelihood, best) = variants.filter_map(with).max_by(|a, b| a.0.total_cmp(&b.0))?;
        *whole = best;
        Some(likelihood)
    }

    /// Likelihood of the accepted effects and perhaps a further one on the beginning of the first recording, as they stand.
    fn tried(&self, problem: &Problem<'_>, further: Option<Accepted>) -> Option<f64> {
        let all: Vec<Accepted> = self.accepted.iter().cloned().chain(further).collect();
        let (model, _) = ready(problem, &self.last, &all)?;
        let setting = model.setting(&self.last.setting.sources, &self.last.setting.noise, Vec::new());
        Some(fit::passes(&setting, &problem.train[..1], TRIED, Tape::Nothing)?[0].likelihood)
    }

    /// Those at the front are fitted to the end: comparisons are between optima only. The share of independent samples is
    /// that of the whitest: a model that explains what is missing leaves white innovations, and then all samples count.
    pub(super) fn sharpen(&mut self, problem: &Problem<'_>, refined: &mut Vec<Refined>) {
        let front = refined.first().map_or(0.0, |r| r.fit.evidence);
        let far = (FAR_BEHIND * (front - self.last.evidence)).max(CLOSE);
        let idle = |r: &Refined| self.gain(&r.fit) < PROMISING && vuong(&r.fit.blocks, &self.last.blocks) < CONSISTENT;
        let sharper = |(i, r): (usize, Refined)| {
            if i >= POLISHED || r.fit.evidence < front - far || idle(&r) {
                return r;
            }
            r.refitted(problem, |fit| fit::polish(fit, &problem.train, Some(self.last.search_share())))
        };
        let taken = std::mem::take(refined);
        let mut polished: Vec<Refined> = taken.into_par_iter().enumerate().map(sharper).collect();
        best_first(&mut polished);
        self.share_levels(problem, &mut polished);
        let share = polished.iter().take(POLISHED).map(|r| r.fit.own_share()).fold(self.last.share, f64::max);
        refined.extend(polished.into_iter().map(|r| Refined { fit: r.fit.at_share(share), ..r }));
        self.last = self.last.clone().at_share(share);
    }

    /// Fits those that are nearly as good as the best one from its levels, and that one from theirs: levels found on
    /// different ways differ, and with them the evidence.
    fn share_levels(&self, problem: &Problem<'_>, refined: &mut [Refined]) {
        for _ in 0..LEVELLED {
            let Some(front) = refined.first() else { return };
            let (like, index) = (front.fit.clone(), front.accepted.chosen.hypothesis);
            let least = like.evidence - SCATTER * self.gain(&like);
            let others = refined[1..].par_iter_mut().filter(|r| r.fit.evidence >= least && !r.is_shape(problem));
            others.for_each(|r| {
                let Some(fit) = at_levels_of(&like, &r.fit, problem) else { return };
                let another = Refined::new(problem, r.accepted.clone(), r.assembled.clone(), fit);
                if another.fit.evidence > r.fit.evidence {
                    *r = another;
                }
            });
            best_first(refined);
            if refined[0].accepted.chosen.hypothesis == index {
                return;
            }
        }
    }

    /// Fits the model without a further effect from the levels and noise that the best candidate led to: what they alone
    /// gain is no gain of the effect.
    pub(super) fn relevel(&mut self, problem: &Problem<'_>, front: &Fit) {
        let share = self.last.share;
        let fit = at_levels_of(front, &self.last, problem);
        if let Some(fit) = fit
            && fit.evidence > self.last.evidence
        {
            self.last = fit::polish(fit, &problem.train, Some(share));
            if self.accepted.is_empty() {
                self.base = self.last.clone();
            }
        }
    }
}

pub(super) fn best_first(refined: &mut [Refined]) {
    refined.sort_by(|a, b| b.fit.evidence.total_cmp(&a.fit.evidence));
}

/// What is refined: the best effects, the best of those that are there or not, which may look small from where they are
/// not, the best shape of each kind, and parameters that their tolerances hold back. And the rest.
pub(super) fn promising(
    problem: &Problem<'_>,
    last: &Fit,
    candidates: Vec<Candidate>,
) -> (Vec<Candidate>, Vec<Candidate>) {
    let h = |c: &Candidate| &problem.hypotheses[c.chosen.hypothesis];
    let front = candidates.iter().find(|c| !h(c).is_shape() && !h(c).is_bounded()).map_or(0.0, |c| c.gain);
    let (mut effects, mut switched) = (0, 0);
    let mut kinds = BTreeSet::new();
    candidates.into_iter().partition(|c| {
        let worth = c.gain > PROMISING.max(FAR * front);
        if held_back(problem, last, h(c)) {
            return true;
        }
        if h(c).is_shape() {
            worth && kinds.len() < SHAPES && kinds.insert(h(c).effect.clone())
        } else if h(c).is_bounded() {
            switched += 1;
            c.gain > PROMISING && switched <= BOUNDED
        } else {
            effects += 1;
            worth && effects <= REFINED
        }
    })
}

/// Adds the best of those that explain what the inputs alone bring about: sources that follow what moves slowly hide them.
pub(super) fn hidden(chosen: &mut Vec<Candidate>, driven: &[Candidate]) {
    let known: BTreeSet<usize> = chosen.iter().map(|c| c.chosen.hypothesis).collect();
    let new = |c: &Candidate| c.gain > PROMISING && !known.contains(&c.chosen.hypothesis);
    chosen.extend(driven.iter().take(DRIVEN).filter(|c| new(c)).cloned());
}

/// A parameter that stands at the end of its tolerance, beyond which sources may have taken what it would explain.
fn held_back(problem: &Problem<'_>, last: &Fit, h: &Hypothesis) -> bool {
    let index = if h.family == "parameter" { screen::drifting(problem, h) } else { None };
    let prior = index.and_then(|i| last.priors.get(i));
    prior.is_some_and(|p| {
        let value = last.setting.theta[p.parameter];
        let near = AT_BOUND * p.sigma;
        value < p.min + near || value > p.max - near
    })
}

/// Others that may be the same as the best one: those of its family at its place, or elsewhere where the screen could not
/// tell them from it.
pub(super) fn siblings(
    problem: &Problem<'_>,
    chosen: &[Candidate],
    rest: &[Candidate],
    front: &Refined,
) -> Vec<Candidate> {
    let h = |c: &Chosen| &problem.hypotheses[c.hypothesis];
    let index = front.accepted.chosen.hypothesis;
    let own = h(&front.accepted.chosen);
    let gain = chosen.iter().find(|c| c.chosen.hypothesis == index).map_or(f64::INFINITY, |c| c.gain);
    let alike = |c: &&Candidate| {
        let other = h(&c.chosen);
        let here = other.attachments[0].site.is_at(&own.attachments[0].site);
        c.gain > PROMISING && other.family == own.family && (here || c.gain > gain - LEVEL)
    };
    rest.iter().filter(|c| !own.is_shape() && alike(c)).take(SIBLINGS).cloned().collect()
}

/// A lag or a dead time, or a sum of them.
fn is_lag(h: &Hypothesis) -> bool {
    h.is_bounded() && h.variants().len() > 1 && h.shapes.iter().all(|s| s.unit == "s")
}

/// An effect as a whole, with the first of its shapes.
pub(super) fn whole(h: &Hypothesis, index: usize) -> Option<Candidate> {
    let chosen = screen::variants(h, index).into_iter().next()?;
    let sigmas: Vec<f64> = h.coefficients.iter().map(|c| c.nominal.abs()).collect();
    let priors = screen::priors(h, &chosen.values, &sigmas);
    let mut candidate = Candidate { chosen, gain: 0.0, priors, visible: 0.0 };
    make_whole(h, &mut candidate);
    Some(candidate)
}

/// Begins with the shares of an effect that is there or not at the whole.
pub(super) fn make_whole(h: &Hypothesis, candidate: &mut Candidate) {
    for (i, c) in h.coefficients.iter().enumerate() {
        let Some(max) = c.whole() else { continue };
        candidate.chosen.values[i] = max;
        let prior = &mut candidate.priors[i];
        (prior.mean, prior.sigma, prior.open, prior.min) = (max, WHOLE * max, false, 0.5 * max);
    }
}

/// A fit with its last effect at the off value.
pub(super) fn switched_off(problem: &Problem<'_>, last: &Accepted, assembled: &Assembled, fit: &Fit) -> Setting {
    let mut setting = fit.setting.clone();
    let coefficients = &problem.hypotheses[last.chosen.hypothesis].coefficients;
    let places = assembled.attached.last().into_iter().flatten();
    places.zip(coefficients).for_each(|(&place, c)| setting.theta[place] = c.off);
    setting
}

pub(super) fn values(fit: &Fit, places: &[usize]) -> Vec<f64> {
    places.iter().map(|&p| fit.setting.theta[p]).collect()
}

/// The model with a set of effects at the values of an earlier fit, and the priors of all that is free.
pub(super) fn ready(problem: &Problem<'_>, from: &Fit, accepted: &[Accepted]) -> Option<(Assembled, Vec<Prior>)> {
    let chosen: Vec<Chosen> = accepted.iter().map(|a| a.chosen.clone()).collect();
    let mut assembled = problem.assemble(&chosen, &problem.node_sources()).ok()?;
    locate::carry(from, accepted, &mut assembled);
    assembled.begin_like(&from.setting, &problem.train);
    let mut priors = fit::tolerance_priors(problem);
    for (places, a) in assembled.attached.iter().zip(accepted) {
        for (&parameter, prior) in places.iter().zip(&a.priors) {
            let own = Prior { parameter, ..prior.clone() };
            match priors.iter_mut().find(|p| p.parameter == parameter) {
                Some(p) => *p = own,
                None => priors.push(own),
            }
        }
    }
    // a parameter that was let go and is no more returns to its tolerance
    for p in &priors {
        let value = &mut assembled.theta[p.parameter];
        *value = value.max(p.min).min(p.max);
    }
    Some((assembled, priors))
}

/// Fits a set of effects, from the values of an earlier fit.
pub(super) fn fitted(problem: &Problem<'_>, from: &Fit, accepted: &[Accepted]) -> Option<(Fit, Assembled)> {
    let (first, assembled) = at_levels(problem, from, accepted)?;
    Some((readjusted(problem, from, first), assembled))
}

/// The same at the levels of that fit.
fn at_levels(problem: &Problem<'_>, from: &Fit, accepted: &[Accepted]) -> Option<(Fit, Assembled)> {
    let (assembled, priors) = ready(problem, from, accepted)?;
    let setting = assembled.setting(&from.setting.sources, &from.setting.noise, Vec::new());
    Some((fit::fit(setting, &priors, &problem.train, Some(from.search_share()), RACE)?, assembled))
}

/// A fit again from the levels and noise of another one.
fn at_levels_of(like: &Fit, own: &Fit, problem: &Problem<'_>) -> Option<Fit> {
    let mut setting = own.setting.clone();
    setting.sources.iter_mut().zip(&like.setting.sources).for_each(|(s, l)| s.level = l.level);
    setting.noise.clone_from(&like.setting.noise);
    fit::fit(setting, &own.priors, &problem.train, Some(own.share), fit::ITERATIONS)
}

/// The same with levels of its own: sources as strong as the model before needed them hide how right this one is.
fn readjusted(problem: &Problem<'_>, from: &Fit, first: Fit) -> Fit {
    if first.evidence < from.evidence - HOPELESS {
        return first;
    }
    let mut setting = first.setting.clone();
    let fit = |s| fit::fit(s, &first.priors, &problem.train, Some(from.search_share()), RACE);
    match fit::adjust(&mut setting, &problem.train).and_then(|()| fit(setting)) {
        Some(second) if second.evidence > first.evidence => second,
        _ => first,
    }
}
