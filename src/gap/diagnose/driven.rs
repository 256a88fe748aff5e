//! What the inputs alone bring about: whether a model's own course explains more, or only its filter, which may follow
//! the colour of a disturbance. The model's errors are taken as autoregressive noise (Box, Jenkins, Time Series
//! Analysis, 1970, ch. 7).

use super::super::data::Recording;
use super::super::filter::colour::{Colour, ORDER};
use super::super::filter::{SILENT, Setting};
use super::super::fit::{self, Fit, Prior};
use super::super::held::{self, Residuals};
use super::super::problem::{Chosen, Problem};
use super::super::screen::{Accepted, Candidate, Screen};
use super::refine::{Refined, best_first, fitted as followed, make_whole, ready, switched_off, values};
use super::{CERTAIN, CLAIMED, Found, Search, Trial, simplest};
use crate::analysis::autoregression;
use nalgebra::DMatrix;
use rayon::prelude::*;
use std::sync::Arc;

/// Turns of parameters and noise.
const TURNS: usize = 3;

/// Part of a plain gap by which other parameters must be better to be taken.
const BETTER: f64 = 0.1;
/// Part of the simulated gap that an effect leaves at most which only the course shows.
const LEAVES: f64 = 0.8;
/// Candidates at most that are fitted by the course.
const FITTED: usize = 5;

/// The accepted effects fitted by what the inputs alone bring about.
pub(super) struct Course {
    /// By the errors as they are, which is how near the course comes.
    plain: Fit,
    /// With errors that tell the next ones, which is how likely it is.
    fit: Fit,
    accepted: Vec<Accepted>,
}

impl Course {
    /// All hypotheses beside it.
    pub(super) fn screened(&self, screen: &Screen<'_>, last: &Fit) -> Vec<Candidate> {
        screen.driven(&self.plain, &self.accepted, &last.setting.noise)
    }

    /// It and one effect more, with how near that comes.
    fn with(&self, problem: &Problem<'_>, mut candidate: Candidate) -> Option<(Refined, Fit)> {
        let h = &problem.hypotheses[candidate.chosen.hypothesis];
        if h.is_bounded() {
            make_whole(h, &mut candidate);
        }
        let accepted = candidate.accepted();
        let all: Vec<Accepted> = self.accepted.iter().chain([&accepted]).cloned().collect();
        let (assembled, priors) = ready(problem, &self.plain, &all)?;
        let setting = assembled.setting(&[], &self.plain.setting.noise, Vec::new());
        let (plain, fit) = plain_and_coloured(problem, setting, &priors)?;
        Some((Refined::new(problem, accepted, assembled, fit), plain))
    }
}

impl Search {
    /// The accepted effects by their course.
    pub(super) fn course(&self, problem: &Problem<'_>) -> Option<Course> {
        let (assembled, priors) = ready(problem, &self.last, &self.accepted)?;
        let setting = assembled.setting(&[], &problem.full_scale, Vec::new());
        let (plain, fit) = plain_and_coloured(problem, setting, &priors)?;
        let with = |(a, own): (&Accepted, &Vec<usize>)| {
            let chosen = Chosen { values: values(&plain, own), ..a.chosen.clone() };
            Accepted { chosen, ..a.clone() }
        };
        let accepted = self.accepted.iter().zip(&assembled.attached).map(with).collect();
        Some(Course { plain, fit, accepted })
    }

    /// Accepts an effect that explains the course where the filter, whose sources follow all that moves slowly or that many
    /// samples in a row have in common, is not sure of it. It must come clearly nearer to the recordings, for certain (what
    /// a disturbance left stands in many blocks in a row), and the filter must not speak against it. True when there was
    /// one.
    pub(super) fn course_explained(
        &mut self,
        problem: &Problem<'_>,
        course: &Course,
        candidates: Vec<Candidate>,
    ) -> bool {
        let before = &course.fit;
        let promises = |c: &Candidate| {
            c.gain > CLAIMED && !problem.hypotheses[c.chosen.hypothesis].is_shape() && !self.has(c.chosen.hypothesis)
        };
        let promising: Vec<Candidate> = candidates.into_iter().filter(promises).take(FITTED).collect();
        let found: Vec<(Refined, Fit)> = promising.into_par_iter().filter_map(|c| course.with(problem, c)).collect();
        let noise = &self.last.setting.noise;
        let gap = |fit: &Fit| held::gap_of(problem, &fit.setting, &problem.train, noise).total;
        let left = LEAVES * gap(&course.plain);
        let nearer = found.into_iter().filter(|(r, plain)| !self.halved(problem, r) && gap(plain) < left);
        let mut refined: Vec<Refined> = nearer.map(|(r, _)| r).collect();
        best_first(&mut refined);
        let round = self.accepted.len() + 1;
        self.trials.extend(refined.iter().map(|r| Trial::over(before, round, r)));
        if refined.is_empty() {
            return false;
        }
        let best = refined.remove(simplest(problem, &refined, before.evidence));
        let found = Found::over(before, &best, &refined);
        let sure = found.gain > CLAIMED && found.t > CERTAIN;
        if !sure || self.mends_form(problem, &best.accepted, found.gain) {
            return false;
        }
        let all: Vec<Accepted> = self.accepted.iter().chain([&best.accepted]).cloned().collect();
        let Some((fit, model)) = followed(problem, &self.last, &all) else { return false };
        if self.gain(&fit) <= 0.0 {
            return false;
        }
        self.found.push(found);
        self.accepted = all;
        self.adopt(fit, model);
        true
    }
}

/// A model fitted by what it says from the inputs alone; its sources must be silent. All its errors count as noise, as much
/// of it independent as `share` says or as is found.
pub(super) fn fitted(train: &[Recording], setting: Setting, priors: &[Prior], share: Option<f64>) -> Option<Fit> {
    in_turns(train, setting, priors, share, |setting, found| {
        for (i, noise) in setting.noise.iter_mut().enumerate() {
            let (sum, count) =
                found.white.iter().fold((0.0, 0), |(s, n), w| (s + w.column(i).norm_squared(), n + w.nrows()));
            *noise *= (sum / count.max(1) as f64).sqrt().max(1e-6);
        }
    })
}

/// A model without sources fitted by what it says from the inputs alone: first by its errors as they are, with their size
/// and colour, then with errors that tell the next ones. These weigh what is fast and small as much as what is slow and
/// large, and lead astray from afar.
fn plain_and_coloured(problem: &Problem<'_>, setting: Setting, priors: &[Prior]) -> Option<(Fit, Fit)> {
    let mut plain = fitted(&problem.train, setting, priors, Some(1.0))?;
    (plain.setting.noise, plain.setting.colours) = errors(&plain);
    let coloured = in_turns(&problem.train, plain.setting.clone(), priors, Some(1.0), |setting, found| {
        (setting.noise, setting.colours) = errors(found);
    })?;
    Some((plain, coloured))
}

/// Fits parameters and noise in turn; the last fit is at the noise that the one before left.
fn in_turns(
    train: &[Recording],
    mut setting: Setting,
    priors: &[Prior],
    share: Option<f64>,
    renew: impl Fn(&mut Setting, &Fit),
) -> Option<Fit> {
    let mut best = None;
    for _ in 0..TURNS {
        let found = fit::fit(setting, priors, train, share, fit::ITERATIONS)?;
        setting = found.setting.clone();
        renew(&mut setting, &found);
        best = Some(found);
    }
    best
}

/// How large the errors of each signal are, and their colours.
fn errors(fit: &Fit) -> (Vec<f64>, Vec<Colour>) {
    let signal = |(i, noise): (usize, &f64)| {
        // there is no error of exactly 0 but where no sample is
        let one = |w: &DMatrix<f64>| {
            let all: Vec<f64> = w.column(i).iter().copied().collect();
            all.split(|e| *e == 0.0).filter(|s| !s.is_empty()).map(<[f64]>::to_vec).collect::<Vec<_>>()
        };
        let stretches: Vec<Vec<f64>> = fit.white.iter().flat_map(one).collect();
        let count = stretches.iter().map(Vec::len).sum::<usize>().max(1);
        let square = stretches.iter().flatten().map(|e| e * e).sum::<f64>() / count as f64;
        (noise * square.sqrt().max(1e-6), Colour::of(&stretches))
    };
    fit.setting.noise.iter().enumerate().map(signal).unzip()
}

/// A fit with the parameters of output error where these simulate clearly better what they were not fitted to: where sources
/// follow all that moves slowly, the filter cares little for how the model goes on without them, but what disturbances did
/// in one recording they do not do in the next.
pub(super) fn simulating(problem: &Problem<'_>, fit: Fit) -> Fit {
    let (train, noise) = (&problem.train, &fit.setting.noise);
    let before = held::gap_of(problem, &fit.setting, train, noise);
    let dispersed = |fit: Fit| Fit { dispersed: fit.dispersion(train, fit.share), ..fit };
    if !before.is_plain(noise, &problem.full_scale) {
        return dispersed(fit);
    }
    let mut silent = fit.setting.clone();
    silent.sources = silent.sources_times(SILENT);
    for ((noise, gap), scale) in silent.noise.iter_mut().zip(&before.signals).zip(&problem.full_scale) {
        *noise = noise.max(gap * scale);
    }
    let fitted_to = |train: &[Recording]| fitted(train, silent.clone(), &fit.priors, Some(1.0));
    let Some(course) = fitted_to(train) else { return dispersed(fit) };
    let share = course.own_share();
    let found = Fit {
        covariance: &course.covariance / share,
        dispersed: course.dispersion(train, share),
        setting: Setting { theta: course.setting.theta.clone(), ..fit.setting.clone() },
        ..fit.clone()
    };
    let others = |k: usize| {
        let theta =
            if train.len() > 1 { fitted_to(&without(train, k))?.setting.theta } else { course.setting.theta.clone() };
        held::simulate_all(&Setting { theta, ..fit.setting.clone() }, train).swap_remove(k)
    };
    let runs: Vec<Option<Residuals>> = (0..train.len()).into_par_iter().map(others).collect();
    let after = held::gap(&runs, train, noise, &problem.full_scale);
    if after.total < (1.0 - BETTER) * before.total { found } else { dispersed(fit) }
}

/// The recordings, of one of them only the samples that tell where it begins.
fn without(train: &[Recording], number: usize) -> Vec<Recording> {
    let mut train = train.to_vec();
    let settled = train[number].settled();
    train[number].signals.iter_mut().for_each(|s| Arc::make_mut(s)[settled..].fill(f64::NAN));
    train
}

/// Nats that a refined candidate gains by the course that the inputs alone bring about, over the model before and over
/// itself without the effect: the lesser of both.
pub(super) fn gain(problem: &Problem<'_>, refined: &Refined, before: &Fit) -> Option<f64> {
    let without = switched_off(problem, &refined.accepted, &refined.assembled, &refined.fit);
    let own = likelihood(problem, &refined.fit.setting)?;
    Some(own - likelihood(problem, &before.setting)?.max(likelihood(problem, &without)?))
}

/// Log likelihood of the train recordings by the course that the inputs alone bring about, nats.
fn likelihood(problem: &Problem<'_>, setting: &Setting) -> Option<f64> {
    let runs = held::simulate_all(setting, &problem.train);
    let mut sum = 0.0;
    for signal in 0..problem.signals.len() {
        let errors = problem.train.iter().zip(&runs).map(|(r, run)| {
            let run = run.as_ref()?;
            let errors = (0..run.simulated[signal].len()).map(|k| run.error(r, signal, k));
            Some(errors.filter(|e| e.is_finite()).collect::<Vec<f64>>())
        });
        let errors: Vec<Vec<f64>> = errors.collect::<Option<_>>()?;
        let count: usize = errors.iter().map(Vec::len).sum();
        let (power, orders) = autoregression::orders(&errors, ORDER, 1.0);
        let variance = orders.last().map_or(power, |o| o.power);
        if count > 10 * ORDER && variance > 0.0 {
            sum -= 0.5 * count as f64 * variance.ln();
        }
    }
    Some(sum)
}
