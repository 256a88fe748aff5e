//! Effects that change the model's order (an elastic coupling between two inertias, the oil's inertia in a line): at
//! their off value the model with them is singular, so they cannot be screened together with the others. Each is tried by
//! itself at a part of its usual size, on the beginning of the first recording.

use super::super::evidence::{self, Free};
use super::super::filter::Tape;
use super::super::fit::{self, Prior};
use super::super::hypotheses::{Hypothesis, Sharing};
use super::super::problem::{Chosen, Problem};
use super::super::screen::{self, Accepted, Candidate};
use super::Search;
use super::refine::ready;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// Part of the usual size at which an effect is tried where that size is so many nats worse than none: the linear model
/// reaches some way beyond.
const SMALL: f64 = 0.03;
const FAR: f64 = 100.0;
/// Samples of the first recording with which it is tried.
const SAMPLES: usize = 1000;
/// Samples after which so many more are looked at: where most steps have to be cut, the model is too stiff.
const LOOK: usize = 12;
/// Effects at most that are refined, and the gain that each must promise on the whole recordings, nats.
const MOST: usize = 3;
const PROMISING: f64 = 10.0;
/// Gains of one effect that differ by this part of them are the same.
const SAME: f64 = 1e-6;
/// Factor by which the linear model may lead away from where it was tried.
const REACH: f64 = 10.0;
/// Part of its usual size that an effect has at least: the model becomes too stiff on the way to its off value.
const LEAST: f64 = 1e-3;
/// Within this part of a bound a value is held by it.
const ROUNDING: f64 = 1e-9;

impl Search {
    /// The best effects that change the order, with what each promises. Those that the filter cannot follow, or that are far
    /// worse than none, are not tried again.
    pub(super) fn reordering(&mut self, problem: &Problem<'_>) -> Vec<Candidate> {
        let before = self.beginning(problem, None).and_then(|b| b.explained(b.priors.len()));
        let Some((before, _)) = before else { return Vec::new() };
        let taken = |i: usize| self.has(i) || self.unfit.contains(&i);
        let open = |i: &usize| {
            let h = &problem.hypotheses[*i];
            h.changes_order && !h.is_shape() && h.sharing == Sharing::Single && !taken(*i)
        };
        let open: Vec<usize> = (0..problem.hypotheses.len()).filter(open).collect();
        let used = problem.train.first().map_or(0, |r| r.len().min(SAMPLES));
        let scale = problem.train.iter().map(|r| r.len()).sum::<usize>() as f64 / used.max(1) as f64;
        let effect = |c: &Candidate| problem.hypotheses[c.chosen.hypothesis].effect.clone();
        let tried = |i: usize| {
            let h = &problem.hypotheses[i];
            let off = screen::variants(h, i).into_iter().next()?;
            let at = |part: f64| self.beginning_with(problem, h, started(h, off.clone(), part));
            let mut candidate = at(1.0)?;
            if candidate.gain < before - FAR {
                candidate = at(SMALL)?;
            }
            candidate.gain = (candidate.gain - before) * scale;
            (candidate.gain > -FAR * scale).then_some(candidate)
        };
        let tried: Vec<(usize, Option<Candidate>)> = open.into_par_iter().map(|i| (i, tried(i))).collect();
        self.unfit.extend(tried.iter().filter(|t| t.1.is_none()).map(|t| t.0));
        let mut found: Vec<Candidate> = tried.into_iter().filter_map(|t| t.1).filter(|c| c.gain > PROMISING).collect();
        found.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        // both ends of a massless element are the same place
        found.dedup_by(|a, b| b.gain - a.gain < SAME * b.gain && effect(a) == effect(b));
        found.truncate(MOST);
        found
    }

    /// What the accepted effects and one more promise there after one iteration, with the values of the last one. `None`
    /// where the filter cannot follow.
    fn beginning_with(&self, problem: &Problem<'_>, h: &Hypothesis, mut chosen: Chosen) -> Option<Candidate> {
        let sigmas: Vec<f64> = h.coefficients.iter().map(|c| c.nominal.abs()).collect();
        let further = Accepted { priors: screen::priors(h, &chosen.values, &sigmas), chosen: chosen.clone() };
        let mut beginning = self.beginning(problem, Some(further))?;
        let count = beginning.priors.len() - chosen.values.len();
        let base = beginning.free(count);
        for (column, c) in (count..).zip(&h.coefficients) {
            let info = evidence::new_information(&beginning.gram, column, &base);
            let prior = &mut beginning.priors[column];
            prior.sigma = screen::deviation(c, info, problem.blocks());
            prior.min = prior.min.max(LEAST * c.nominal.abs());
        }
        let (mut gain, estimate) = beginning.explained(count + h.coefficients.len())?;
        let priors = beginning.priors.split_off(count);
        for ((value, change), prior) in chosen.values.iter_mut().zip(estimate.iter().skip(count)).zip(&priors) {
            if *value + change - prior.min <= ROUNDING * prior.min.abs() {
                // held by its bound: less than nothing would be better
                gain = f64::MIN;
            }
            *value = (*value + change).clamp(*value / REACH, *value * REACH);
        }
        gain.is_finite().then_some(Candidate { chosen, gain, priors, visible: 0.0 })
    }

    /// The filter over the beginning of the first recording, with the accepted effects and perhaps one more. `None` where it
    /// cannot follow, or only in steps far shorter than the samples.
    fn beginning(&self, problem: &Problem<'_>, further: Option<Accepted>) -> Option<Beginning> {
        let all: Vec<Accepted> = self.accepted.iter().cloned().chain(further).collect();
        let (model, priors) = ready(problem, &self.last, &all)?;
        let columns = priors.iter().map(|p| p.parameter).collect();
        let setting = model.setting(&self.last.setting.sources, &self.last.setting.noise, columns);
        let samples = |samples| fit::passes(&setting, &problem.train[..1], samples, Tape::Nothing)?.pop();
        let stiff = samples(2 * LOOK)?.cut[LOOK..].iter().filter(|cut| **cut).count();
        if stiff > LOOK / 2 {
            return None;
        }
        let pass = samples(SAMPLES)?;
        let share = self.last.search_share();
        let likelihood = share * pass.likelihood;
        let values = priors.iter().map(|p| setting.theta[p.parameter]).collect();
        Some(Beginning { priors, values, likelihood, gram: pass.gram * share })
    }
}

/// A model on the beginning of the first recording: what is free with its present values, and what the filter found.
struct Beginning {
    priors: Vec<Prior>,
    values: Vec<f64>,
    likelihood: f64,
    gram: DMatrix<f64>,
}

impl Beginning {
    /// The first `count` parameters about their present values.
    fn free(&self, count: usize) -> Vec<Free> {
        let known = self.priors.iter().zip(&self.values).take(count).enumerate();
        known.map(|(column, (p, &value))| p.about(value, column)).collect()
    }

    /// Likelihood with evidence when the first `count` parameters are fitted, nats, and their changes.
    fn explained(&self, count: usize) -> Option<(f64, DVector<f64>)> {
        let found = evidence::explain(&self.gram, &self.free(count))?;
        Some((self.likelihood + found.evidence, found.estimate))
    }
}

/// An effect at a part of its usual size.
fn started(h: &Hypothesis, mut chosen: Chosen, part: f64) -> Chosen {
    for (value, c) in chosen.values.iter_mut().zip(&h.coefficients) {
        *value = part * c.nominal;
    }
    chosen
}
