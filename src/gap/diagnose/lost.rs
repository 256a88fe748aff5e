//! Effects that the filter loses: where a sensor folds the signal (it shows the magnitude, or clips it), the state that
//! belongs to a sample is not unique, and a filter that has taken the wrong one stays there. Its likelihood then says
//! nothing about the effect. Such effects are weighed by what the model says from the inputs alone instead (output
//! error; Ljung, System Identification, 1999, ch. 7), with the model's errors as noise of the sensors.

use super::super::data::Recording;
use super::super::filter::{SILENT, Setting};
use super::super::fit::{Fit, Prior, vuong};
use super::super::held;
use super::super::hypotheses::{Hypothesis, Site};
use super::super::problem::{Assembled, Problem};
use super::super::screen::{Accepted, Candidate};
use super::refine::{Refined, ready, switched_off, whole};
use super::{CONSISTENT, Found, SEEN, Search, driven};
use rayon::prelude::*;

/// An effect is lost when the filter says that it is so much worse than the model without it, nats.
const LOST: f64 = 50.0;
/// What such an effect must leave of the simulated gap that the best effect followed leaves, to be weighed.
const CLOSING: f64 = 0.5;

impl Search {
    /// Effects of sensors that the screen cannot see from where they are not, and with which as a whole the nominal model
    /// alone comes much nearer to the first recording.
    pub(super) fn unseen(&self, problem: &Problem<'_>, seen: &[Candidate]) -> Vec<Candidate> {
        let known = |i: usize| seen.iter().any(|c| c.chosen.hypothesis == i);
        let unknown = |&i: &usize| {
            let h = &problem.hypotheses[i];
            matches!(h.attachments[0].site, Site::Sensor(_)) && h.is_bounded() && !known(i)
        };
        let open: Vec<usize> = (0..problem.hypotheses.len()).filter(|i| unknown(i) && !self.has(*i)).collect();
        let first = &problem.train[..1];
        // parameters that were fitted in the filter may simulate worse than those of the nominal model
        let plain = self.gap_with(problem, &[], first).unwrap_or(f64::INFINITY);
        let left = self.gap_of(problem, &self.last.setting, first).min(plain);
        let near = |i: usize| {
            let candidate = of_shares(&problem.hypotheses[i], i)?;
            let gap = self.gap_with(problem, &[candidate.accepted()], first)?;
            (gap < CLOSING * left).then_some(candidate)
        };
        open.into_par_iter().filter_map(near).collect()
    }

    /// The lost effect that explains the recordings so much better than the model without it and than the best effect
    /// followed that it is the cause, as weighed from the inputs alone, with what it gains.
    pub(super) fn lost(&self, problem: &Problem<'_>, refined: &[Refined]) -> Option<(Refined, Found)> {
        let lost = |r: &Refined| {
            let h = &problem.hypotheses[r.accepted.chosen.hypothesis];
            h.is_bounded() && r.fit.evidence < self.last.evidence - LOST
        };
        let left = refined.iter().find(|r| !lost(r)).map_or(&self.last, |r| &r.fit);
        let left = self.gap_of(problem, &left.setting, &problem.train);
        let near = |r: &Refined| {
            self.gap_with(problem, std::slice::from_ref(&r.accepted), &problem.train)
                .is_some_and(|gap| gap < CLOSING * left)
        };
        let places: Vec<usize> = (0..refined.len()).filter(|&i| lost(&refined[i]) && near(&refined[i])).collect();
        if places.is_empty() {
            return None;
        }
        let weighed = |extra: &[Accepted]| {
            let mut all = self.accepted.clone();
            all.extend_from_slice(extra);
            output_error(problem, &self.last, &all)
        };
        let alone = |r: &Refined| weighed(std::slice::from_ref(&r.accepted));
        let (index, (fit, assembled)) = places
            .into_iter()
            .filter_map(|i| Some((i, alone(&refined[i])?)))
            .max_by(|a, b| a.1.0.likelihood.total_cmp(&b.1.0.likelihood))?;
        // what it must beat: the model as it is, from its own parameters and from those found with the effect, and the best
        // effect that the filter can follow
        let mut rivals = vec![weighed(&[])?.0, without(problem, &refined[index], &fit, &assembled)?];
        rivals.extend(refined.iter().find(|r| !lost(r)).and_then(alone).map(|r| r.0));
        let share = rivals.iter().chain([&fit]).map(Fit::own_share).fold(0.0, f64::max);
        let fit = fit.at_share(share);
        let over = |rival: Fit| {
            let rival = rival.at_share(share);
            (fit.evidence - rival.evidence, vuong(&fit.blocks, &rival.blocks))
        };
        let over: Vec<(f64, f64)> = rivals.into_iter().map(over).collect();
        // and it must be the effect that closes the gap, not the parameters found with it
        let off = switched_off(problem, &refined[index].accepted, &assembled, &fit);
        let closes =
            self.gap_of(problem, &fit.setting, &problem.train) < CLOSING * self.gap_of(problem, &off, &problem.train);
        let beaten = closes && over.iter().all(|(gain, t)| *gain > SEEN && *t > CONSISTENT);
        let least = |of: fn(&(f64, f64)) -> f64| over.iter().map(of).fold(f64::INFINITY, f64::min);
        let found = Found { gain: least(|o| o.0), t: least(|o| o.1), alternatives: Vec::new() };
        beaten.then(|| (Refined::new(problem, refined[index].accepted.clone(), assembled, fit), found))
    }

    /// The simulated gap of the nominal model with the effects accepted and further ones.
    fn gap_with(&self, problem: &Problem<'_>, further: &[Accepted], recordings: &[Recording]) -> Option<f64> {
        let mut all = self.accepted.clone();
        all.extend_from_slice(further);
        let (assembled, _) = at_nominal(problem, &self.last, &all)?;
        let setting = assembled.setting(&[], &self.last.setting.noise, Vec::new());
        Some(self.gap_of(problem, &setting, recordings))
    }

    fn gap_of(&self, problem: &Problem<'_>, setting: &Setting, recordings: &[Recording]) -> f64 {
        held::gap_of(problem, setting, recordings, &self.last.setting.noise).total
    }
}

/// An effect as a whole that is nothing but shares of one.
fn of_shares(h: &Hypothesis, index: usize) -> Option<Candidate> {
    if h.coefficients.iter().all(|c| c.whole().is_some()) { whole(h, index) } else { None }
}

/// The model with effects, parameters at their nominal values.
fn at_nominal(problem: &Problem<'_>, from: &Fit, accepted: &[Accepted]) -> Option<(Assembled, Vec<Prior>)> {
    let (mut assembled, priors) = ready(problem, from, accepted)?;
    for (i, t) in assembled.free.clone().zip(&problem.tolerances) {
        assembled.theta[i] = t.nominal;
    }
    Some((assembled, priors))
}

/// A model fitted by what it says from the inputs alone, from the nominal parameters.
fn output_error(problem: &Problem<'_>, from: &Fit, accepted: &[Accepted]) -> Option<(Fit, Assembled)> {
    let (assembled, priors) = at_nominal(problem, from, accepted)?;
    let sources = from.setting.sources_times(SILENT);
    // where the errors are not known yet, they are as large as the signals
    let noise: Vec<f64> = problem.full_scale.iter().zip(&from.setting.noise).map(|(f, n)| f.max(*n)).collect();
    let setting = assembled.setting(&sources, &noise, Vec::new());
    Some((driven::fitted(&problem.train, setting, &priors, None)?, assembled))
}

/// The same fit where the effect is off again, from the parameters found with it.
fn without(problem: &Problem<'_>, r: &Refined, fit: &Fit, assembled: &Assembled) -> Option<Fit> {
    let own = assembled.attached.last()?;
    let setting = switched_off(problem, &r.accepted, assembled, fit);
    let priors: Vec<Prior> = fit.priors.iter().filter(|p| !own.contains(&p.parameter)).cloned().collect();
    driven::fitted(&problem.train, setting, &priors, None)
}
