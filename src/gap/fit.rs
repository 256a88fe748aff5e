//! Parameters of one model fitted to the train recordings: Gauss-Newton on the one-step prediction error, linearised
//! anew in each iteration, with the levels of sources and noise by type-II likelihood.

use super::data::Recording;
use super::evidence::{self, Free};
use super::filter::{self, Pass, Setting, Source, Tape};
use super::levels;
use super::problem::{Assembled, Problem};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// Iterations at most of a fit that counts.
pub const ITERATIONS: usize = 5;
/// Mean square of whitened innovations beyond which the noise floor is not believed.
const MISFIT: f64 = 4.0;
/// Turns of levels and parameters at most.
const TURNS: usize = 4;
/// The log likelihood that another iteration must promise, nats.
const WORTHWHILE: f64 = 0.3;
/// Levels that stay so far below the greatest growth of a round are settled.
const SETTLED: f64 = 3.0;

/// Standard deviations within which every prior is Gaussian.
const OPEN: f64 = 5.0;

/// Prior of a parameter of the plan.
#[derive(Clone, Debug, PartialEq)]
pub struct Prior {
    /// Index among the plan's parameters.
    pub parameter: usize,
    /// Most probable value.
    pub mean: f64,
    /// Standard deviation.
    pub sigma: f64,
    /// How large it is is not known: beyond five standard deviations the prior falls with the inverse of the distance
    /// only. A Gaussian would charge what is strongest with a fixed part of all that it explains.
    pub open: bool,
    /// Least value.
    pub min: f64,
    /// Greatest value.
    pub max: f64,
}

impl Prior {
    /// Standard deviation of the Gaussian that stands for the prior about a value.
    pub fn deviation_at(&self, value: f64) -> f64 {
        let beyond = ((value - self.mean) / self.sigma).abs();
        if self.open { self.sigma * (beyond / OPEN).max(1.0) } else { self.sigma }
    }

    /// As a column of a model linearised at a value.
    pub fn about(&self, value: f64, column: usize) -> Free {
        let bounds = (self.min - value, self.max - value);
        Free { column, mean: self.mean - value, sigma: self.deviation_at(value), bounds }
    }

    /// Log density at a value, relative to that at the mean.
    fn log_density(&self, value: f64) -> f64 {
        let deviation = self.deviation_at(value);
        -0.5 * ((value - self.mean) / deviation).powi(2) - (deviation / self.sigma).ln()
    }
}

/// A fitted model.
#[derive(Clone, Debug)]
pub struct Fit {
    /// Values, levels and noise.
    pub setting: Setting,
    /// The priors under which it was fitted.
    pub priors: Vec<Prior>,
    /// Log evidence, in nats scaled by `share`.
    pub evidence: f64,
    /// Log likelihood at the optimum, not scaled.
    pub likelihood: f64,
    /// Log likelihood by block, not scaled.
    pub blocks: Vec<f64>,
    /// Covariance of the fitted parameters, in the order of the priors.
    pub covariance: DMatrix<f64>,
    /// Factor of variances by which the recordings contradict that, where it was asked for; 1 otherwise.
    pub dispersed: f64,
    /// Effective share of independent samples.
    pub share: f64,
    /// Whitened innovations by recording.
    pub white: Vec<DMatrix<f64>>,
    /// Where steps were cut, by recording.
    pub cuts: Vec<Vec<bool>>,
}

/// Runs the filter over all recordings, in parallel.
pub fn passes(setting: &Setting, train: &[Recording], samples: usize, tape: Tape) -> Option<Vec<Pass>> {
    let one = |(i, r): (usize, &Recording)| {
        let mut pass = filter::run(&setting.of_recording(i), r, i, samples, tape).ok()?;
        for foreign in setting.foreign(i) {
            for k in (0..setting.columns.len()).filter(|k| setting.columns[*k] == foreign) {
                pass.gram.row_mut(k).fill(0.0);
                pass.gram.column_mut(k).fill(0.0);
            }
        }
        Some(pass)
    };
    train.par_iter().enumerate().map(one).collect()
}

/// Log likelihood of the recordings, not scaled; `None` where the model has no value on the way.
pub fn likelihood(setting: &Setting, train: &[Recording]) -> Option<f64> {
    Some(total(&passes(&setting.alone(), train, usize::MAX, Tape::Nothing)?).0)
}

fn total(passes: &[Pass]) -> (f64, DMatrix<f64>) {
    let likelihood = passes.iter().map(|p| p.likelihood).sum();
    let width = passes.first().map_or(0, |p| p.gram.nrows());
    let gram = passes.iter().fold(DMatrix::zeros(width, width), |sum, p| sum + &p.gram);
    (likelihood, gram)
}

/// Tolerances beyond which a parameter no longer counts as within its tolerance.
const WITHIN: f64 = 3.0;

/// Priors of the tolerances: parameters stay within three of them, beyond is a hypothesis of its own.
pub fn tolerance_priors(problem: &Problem<'_>) -> Vec<Prior> {
    let prior = |(parameter, t): (usize, &super::problem::Tolerance)| Prior {
        parameter,
        mean: t.nominal,
        sigma: t.sigma,
        open: false,
        min: t.min.max(t.nominal - WITHIN * t.sigma),
        max: t.max.min(t.nominal + WITHIN * t.sigma),
    };
    problem.tolerances.iter().enumerate().map(prior).collect()
}

/// Sources of which each is as strong as the sensors can see in one sample, roughly: where the search
/// for their levels begins.
pub fn first_sources(assembled: &Assembled, noise: &[f64], train: &[Recording]) -> Option<Vec<Source>> {
    let setting = assembled.setting(&[], noise, assembled.sources.clone().collect());
    let samples = 600;
    let (_, gram) = total(&passes(&setting, &train[..1], samples, Tape::Nothing)?);
    let n = (samples.min(train[0].len()) as f64 - train[0].settled() as f64).max(1.0);
    let level = |i: usize| if gram[(i, i)] > 0.0 { 0.3 * (n / gram[(i, i)]).sqrt() } else { 1e-12 };
    let source = |(i, parameter)| Source { parameter, level: level(i), tau: assembled.tau };
    Some(assembled.sources.clone().enumerate().map(source).collect())
}

/// Adjusts levels and noise at the present values of the parameters.
pub fn adjust(setting: &mut Setting, train: &[Recording]) -> Option<()> {
    adjust_slowly(setting, train, 1, f64::INFINITY)
}

/// The same in so many rounds at most, in each of which levels grow by a factor at most: steps are linearised where the
/// sources of the round before led the states.
pub fn adjust_slowly(setting: &mut Setting, train: &[Recording], rounds: usize, growth: f64) -> Option<()> {
    let columns = std::mem::take(&mut setting.columns);
    for _ in 0..rounds {
        let found = passes(setting, train, usize::MAX, Tape::Stretches)?;
        setting.starts = found.iter().map(|p| p.start.clone()).collect();
        let tapes: Vec<&[filter::Step]> = found.iter().flat_map(|p| &p.tapes).map(Vec::as_slice).collect();
        let factors = levels::fit(setting, &tapes, growth);
        let settled = factors.iter().all(|f| *f < growth / SETTLED);
        adjust_noise(setting, &tapes, &factors);
        setting.sources.iter_mut().zip(factors).for_each(|(s, f)| s.level *= f);
        if settled {
            break;
        }
    }
    setting.columns = columns;
    Some(())
}

/// What the sources can take is not noise.
fn adjust_noise(setting: &mut Setting, tapes: &[&[filter::Step]], factors: &[f64]) {
    for (i, noise) in levels::noise(setting, tapes, factors).into_iter().enumerate() {
        if noise.misfit > MISFIT {
            setting.most_noise[i] *= 2.0;
        }
        if noise.variance > 0.0 {
            setting.noise[i] = noise.variance.sqrt().max(0.2 * setting.noise[i]).min(setting.most_noise[i]);
        }
    }
}

/// Fits the parameters of `priors` from the values in `setting`. `share` scales the evidence; `None` finds it.
pub fn fit(
    mut setting: Setting,
    priors: &[Prior],
    train: &[Recording],
    share: Option<f64>,
    iterations: usize,
) -> Option<Fit> {
    setting.columns = priors.iter().map(|p| p.parameter).collect();
    setting.common = setting.columns.len();
    let mut found = passes(&setting, train, usize::MAX, Tape::Nothing)?;
    setting.starts = found.iter().map(|p| p.start.clone()).collect();
    let share =
        share.unwrap_or_else(|| evidence::independent_share(&found.iter().map(|p| &p.white).collect::<Vec<_>>()));
    for _ in 0..iterations {
        let (likelihood, gram) = total(&found);
        let (gram, before) = (gram * share, objective(&setting, priors, likelihood * share));
        let local = evidence::explain(&gram, &free(&setting, priors))?;
        if local.promise < WORTHWHILE {
            break;
        }
        let mut length = 1.0;
        let start = setting.theta.clone();
        let mut accepted = false;
        while length > 0.05 {
            for (prior, d) in priors.iter().zip(&local.estimate) {
                let value = start[prior.parameter] + length * d;
                setting.theta[prior.parameter] = value.clamp(prior.min, prior.max);
            }
            if let Some(next) = passes(&setting, train, usize::MAX, Tape::Nothing) {
                let (likelihood, _) = total(&next);
                if objective(&setting, priors, likelihood * share) >= before - 0.01 {
                    found = next;
                    accepted = true;
                    break;
                }
            }
            length *= 0.35;
        }
        if !accepted {
            setting.theta = start;
            break;
        }
        let (after, _) = total(&found);
        if objective(&setting, priors, after * share) - before < 0.5 * WORTHWHILE {
            break;
        }
    }
    let (likelihood, gram) = total(&found);
    let gram = gram * share;
    let local = evidence::explain(&gram, &free(&setting, priors))?;
    // what another step promises has not been reached: the model may bend
    let evidence = share * likelihood + local.evidence - local.promise;
    if !evidence.is_finite() {
        return None;
    }
    Some(Fit {
        evidence,
        likelihood,
        blocks: found.iter().flat_map(|p| p.blocks.iter().copied()).collect(),
        covariance: local.covariance,
        dispersed: 1.0,
        share,
        cuts: found.iter().map(|p| p.cut.clone()).collect(),
        white: found.into_iter().map(|p| p.white).collect(),
        priors: priors.to_vec(),
        setting,
    })
}

/// Levels and parameters in turn until neither gains: comparisons are between optima only. Without `share` it is found
/// anew at the end.
pub fn polish(mut best: Fit, train: &[Recording], share: Option<f64>) -> Fit {
    for _ in 0..TURNS {
        let mut setting = best.setting.clone();
        if adjust(&mut setting, train).is_none() {
            break;
        }
        let Some(next) = fit(setting, &best.priors, train, share, ITERATIONS) else { break };
        // noise and levels may move the constant of the likelihood: only what is more likely is kept
        let gain = next.evidence_at(best.share) - best.evidence;
        if gain <= 0.0 {
            break;
        }
        best = next;
        if gain < 1.0 {
            break;
        }
    }
    best
}

/// The parameters of `priors` as columns in their order, about their present values.
fn free(setting: &Setting, priors: &[Prior]) -> Vec<Free> {
    priors.iter().enumerate().map(|(column, p)| p.about(setting.theta[p.parameter], column)).collect()
}

fn objective(setting: &Setting, priors: &[Prior], likelihood: f64) -> f64 {
    likelihood + priors.iter().map(|p| p.log_density(setting.theta[p.parameter])).sum::<f64>()
}

/// Fits count at least this share of the samples as independent: how coloured the rest is shows only once what is
/// missing has been found.
const LEAST_SHARE: f64 = 0.1;

impl Fit {
    /// The same fit with its evidence counted at another share of independent samples.
    pub fn at_share(self, share: f64) -> Fit {
        Fit { evidence: self.evidence_at(share), share, ..self }
    }

    fn evidence_at(&self, share: f64) -> f64 {
        self.evidence + (share - self.share) * self.likelihood
    }

    /// The share at which models that are to explain more are weighed.
    pub fn search_share(&self) -> f64 {
        self.share.max(LEAST_SHARE)
    }

    /// Effective share of independent samples that its own innovations show.
    pub fn own_share(&self) -> f64 {
        evidence::independent_share(&self.white.iter().collect::<Vec<_>>())
    }

    /// Mean square of the whitened innovations: 1 where the model is right.
    pub fn misfit(&self) -> f64 {
        let (sum, count) = self.white.iter().fold((0.0, 0), |(s, n), w| (s + w.norm_squared(), n + w.len()));
        sum / count.max(1) as f64
    }

    /// The part of the log posterior that the priors take, nats.
    pub fn prior_cost(&self, count: usize) -> f64 {
        let square = |p: &Prior| ((self.setting.theta[p.parameter] - p.mean) / p.sigma).powi(2);
        0.5 * self.priors.iter().take(count).map(square).sum::<f64>()
    }

    /// By how much more the recordings pull the parameters apart than their errors would if so large a share of the samples
    /// were independent, as a factor of variances, 1 at least. Source: McCullagh, Nelder, Generalized Linear Models, 1989,
    /// ch. 4.5 and 9 (overdispersion), with a recording for a cluster.
    pub fn dispersion(&self, train: &[Recording], share: f64) -> f64 {
        self.pulls(train, share).filter(|factor| factor.is_finite()).map_or(1.0, |factor| factor.max(1.0))
    }

    fn pulls(&self, train: &[Recording], share: f64) -> Option<f64> {
        let mut setting = self.setting.clone();
        setting.columns = self.priors.iter().map(|p| p.parameter).collect();
        setting.common = setting.columns.len();
        let free = free(&setting, &self.priors);
        let (n, count) = (free.len(), train.len() as f64);
        let (mut pull, mut expected) = (0.0, 0.0);
        for pass in passes(&setting, train, usize::MAX, Tape::Nothing)? {
            let own = DMatrix::from_fn(n, n, |i, j| share * free[i].sigma * pass.gram[(i, j)] * free[j].sigma);
            let slope = DVector::from_fn(n, |i, _| {
                share * free[i].sigma * pass.gram[(i, n)] + free[i].mean / free[i].sigma / count
            });
            // what the priors hold is not pulled
            let inverse = (&own + DMatrix::identity(n, n) / count).try_inverse()?;
            pull += slope.dot(&(&inverse * &slope));
            expected += (inverse * own).trace();
        }
        // together they pull nowhere at the optimum
        (train.len() > 1 && expected > 0.0).then(|| pull / (expected * (1.0 - 1.0 / count)))
    }

    /// Standard deviation of a fitted parameter if the first `known` were known: what the data alone leave open.
    pub fn deviation_knowing(&self, i: usize, known: usize) -> f64 {
        let among = self.covariance.view((0, 0), (known, known)).into_owned();
        let with = self.covariance.view((0, i), (known, 1)).into_owned();
        let explained = among.cholesky().map_or(0.0, |factor| with.dot(&factor.solve(&with)));
        (self.covariance[(i, i)] - explained).max(0.0).sqrt()
    }

    /// Standard deviation of a fitted parameter by its place in the priors, as wide as the recordings pull it apart.
    pub fn deviation(&self, i: usize) -> f64 {
        (self.dispersed * self.covariance[(i, i)]).max(0.0).sqrt()
    }
}

/// Block-wise Vuong statistic of `a` over `b`: mean difference of log likelihoods over its standard error, corrected for
/// the correlation of neighbouring blocks.
pub fn vuong(a: &[f64], b: &[f64]) -> f64 {
    let d: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
    let n = d.len() as f64;
    let mean = d.iter().sum::<f64>() / n;
    let variance = d.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0).max(1.0);
    if variance <= 0.0 {
        return 0.0;
    }
    let neighbours = d.windows(2).map(|w| (w[0] - mean) * (w[1] - mean)).sum::<f64>() / (n - 1.0).max(1.0);
    let correlation = (neighbours / variance).clamp(0.0, 0.9);
    mean / (variance / n * (1.0 + correlation) / (1.0 - correlation)).sqrt()
}
