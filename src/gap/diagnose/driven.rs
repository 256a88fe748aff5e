//! What the inputs alone bring about: whether a model's own course explains more, or only its filter, which may follow
//! the colour of a disturbance. The model's errors are taken as autoregressive noise (Box, Jenkins, Time Series
//! Analysis, 1970, ch. 7).

use super::super::filter::{SILENT, Setting};
use super::super::fit::{self, Fit, Prior};
use super::super::held;
use super::super::problem::Problem;
use super::refine::{Refined, switched_off};
use crate::analysis::autoregression;

/// Order of the autoregression.
const ORDER: usize = 12;
/// Turns of parameters and noise.
const TURNS: usize = 3;

/// Part of a plain gap by which other parameters must be better to be taken.
const BETTER: f64 = 0.1;

/// A model fitted by what it says from the inputs alone; its sources must be silent. All its errors count as noise, as much
/// of it independent as `share` says or as is found.
pub(super) fn fitted(problem: &Problem<'_>, mut setting: Setting, priors: &[Prior], share: Option<f64>) -> Option<Fit> {
    let mut best = None;
    for _ in 0..TURNS {
        let found = fit::fit(setting, priors, &problem.train, share, fit::ITERATIONS)?;
        setting = found.setting.clone();
        for (i, noise) in setting.noise.iter_mut().enumerate() {
            let (sum, count) =
                found.white.iter().fold((0.0, 0), |(s, n), w| (s + w.column(i).norm_squared(), n + w.nrows()));
            *noise *= (sum / count.max(1) as f64).sqrt().max(1e-6);
        }
        best = Some(found);
    }
    best
}

/// A fit with the parameters of output error where these simulate the train recordings clearly better: where sources follow
/// all that moves slowly, the filter cares little for how the model goes on without them.
pub(super) fn simulating(problem: &Problem<'_>, fit: Fit) -> Fit {
    let gap = |setting: &Setting| held::gap_of(problem, setting, &problem.train, &fit.setting.noise);
    let before = gap(&fit.setting);
    if !before.is_plain(&fit.setting.noise, &problem.full_scale) {
        return fit;
    }
    let mut setting = fit.setting.clone();
    setting.sources = setting.sources_times(SILENT);
    for ((noise, gap), scale) in setting.noise.iter_mut().zip(&before.signals).zip(&problem.full_scale) {
        *noise = noise.max(gap * scale);
    }
    let Some(found) = fitted(problem, setting, &fit.priors, Some(1.0)) else { return fit };
    let covariance = &found.covariance / found.own_share();
    let setting = Setting { theta: found.setting.theta, ..fit.setting.clone() };
    let better = gap(&setting).total < (1.0 - BETTER) * before.total;
    if better { Fit { setting, covariance, ..fit } } else { fit }
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
