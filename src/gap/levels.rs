//! How strong and how slow the sources are, and the sensors' noise: type-II likelihood on linearised steps, without the
//! model.

use super::filter::{Setting, Source, Step, source_noise, symmetrize};
use super::step::multiply;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// Factors by which a level is tried, coarse ones first.
const ROUNDS: [&[f64]; 3] = [&[0.1, 10.0], &[0.3, 3.0], &[0.55, 1.8]];

/// Steps at most in a direction that pays.
const FURTHER: usize = 5;
/// Factors by which correlation times are tried, those at most as part of the longest recording, and the log likelihood
/// that another one must be worth, nats.
const TIMES: [f64; 2] = [3.0, 1.0 / 3.0];
const LONGEST: f64 = 0.1;
const WORTHWHILE: f64 = 3.0;
/// What a source may move a state within a step at most, in sizes of the state: a stronger one is no disturbance.
const REACH: f64 = 0.5;

/// Adjusts the levels of the sources, relative to those in the setting, so that the tapes become most likely.
/// Returns the factors, at most `growth`, and the log likelihood reached.
pub fn fit(setting: &Setting, tapes: &[&[Step]], growth: f64) -> (Vec<f64>, f64) {
    let mut factors = vec![1.0; setting.sources.len()];
    let value = |factors: &[f64]| tapes.par_iter().map(|t| likelihood(setting, t, factors)).sum::<f64>();
    let most: Vec<f64> = most(tapes, factors.len()).into_iter().map(|m| m.min(growth)).collect();
    let mut best = value(&factors);
    for round in ROUNDS {
        for i in 0..factors.len() {
            let before = factors[i];
            let mut kept = before;
            for f in round {
                if before * f > most[i].max(before) {
                    continue;
                }
                factors[i] = before * f;
                let found = value(&factors);
                if found > best {
                    // on in this direction while it pays
                    (best, kept) = (found, factors[i]);
                    for _ in 0..FURTHER {
                        factors[i] *= f;
                        if *f > 1.0 && factors[i] > most[i] {
                            break;
                        }
                        let next = value(&factors);
                        if next <= best {
                            break;
                        }
                        (best, kept) = (next, factors[i]);
                    }
                    break;
                }
            }
            factors[i] = kept;
        }
    }
    (factors, best)
}

/// Factors at which each of the sources moves the states as far as it may, half of the time.
fn most(tapes: &[&[Step]], sources: usize) -> Vec<f64> {
    let reach = |j: usize| {
        let moved = |step: &Step| {
            let n = step.transition.nrows() - sources;
            step.transition.column(n + j).iter().take(n).fold(0.0, |most: f64, v| most.max(v.abs()))
        };
        let mut all: Vec<f64> = tapes.iter().flat_map(|t| t.iter().map(moved)).collect();
        all.sort_by(f64::total_cmp);
        REACH / all.get(all.len() / 2).copied().unwrap_or(0.0).max(1e-300)
    };
    (0..sources).map(reach).collect()
}

/// The sources with correlation times that make the tapes most likely. When one changes, what the source does in a short
/// time stays the same, or what it does in a long one.
pub fn coloured(setting: &Setting, tapes: &[&[Step]]) -> Vec<Source> {
    let mut sources = setting.sources.clone();
    let value = |sources: &[Source]| tapes.par_iter().map(|t| likelihood_with(setting, t, sources)).sum::<f64>();
    let longest = tapes.iter().map(|t| t.iter().map(|s| s.h).sum::<f64>()).fold(0.0, f64::max);
    let step = longest / tapes.iter().map(|t| t.len()).max().unwrap_or(1).max(1) as f64;
    let mut best = value(&sources);
    for i in 0..sources.len() {
        for (f, power) in TIMES.into_iter().flat_map(|f| [(f, 0.5), (f, -0.5)]) {
            for _ in 0..FURTHER {
                let before = sources[i].clone();
                let tau = (before.tau * f).clamp(step, LONGEST * longest);
                let level = before.level * (tau / before.tau).powf(power);
                sources[i] = Source { tau, level, ..before.clone() };
                let found = value(&sources);
                if found <= best + WORTHWHILE {
                    sources[i] = before;
                    break;
                }
                best = found;
            }
        }
    }
    sources
}

/// Log likelihood of a tape with the sources' levels multiplied by `factors`.
pub fn likelihood(setting: &Setting, tape: &[Step], factors: &[f64]) -> f64 {
    likelihood_with(setting, tape, &scaled(setting, factors))
}

fn scaled(setting: &Setting, factors: &[f64]) -> Vec<Source> {
    let scaled = |(s, f): (&Source, &f64)| Source { level: s.level * f, ..s.clone() };
    setting.sources.iter().zip(factors).map(scaled).collect()
}

/// Log likelihood of a tape with other sources: a Kalman filter, one signal after the other.
fn likelihood_with(setting: &Setting, tape: &[Step], sources: &[Source]) -> f64 {
    let mut sum = 0.0;
    replay(setting, tape, sources, &mut |sample| {
        let (left, variance) = (sample.left, sample.variance);
        sum -= 0.5 * (left * left / variance + variance.ln() + (2.0 * std::f64::consts::PI).ln());
    });
    if sum.is_finite() { sum } else { f64::NEG_INFINITY }
}

/// What the tapes say of a signal's noise, over all its samples.
#[derive(Clone, Copy, Debug, Default)]
pub struct Noise {
    /// Mean square of the whitened innovations: 1 where the model is right.
    pub misfit: f64,
    /// The variance that makes what is left most likely (expectation step).
    pub variance: f64,
    count: f64,
}

/// Noise of every signal at these levels.
pub fn noise(setting: &Setting, tapes: &[&[Step]], factors: &[f64]) -> Vec<Noise> {
    let mut found = vec![Noise::default(); setting.noise.len()];
    for tape in tapes {
        replay(setting, tape, &scaled(setting, factors), &mut |sample| {
            let own = &mut found[sample.signal];
            let r = setting.noise[sample.signal] * setting.noise[sample.signal];
            // behind the update with this sample alone the residual shrinks by r/variance
            let residual = sample.left * r / sample.variance;
            own.misfit += sample.left * sample.left / sample.variance;
            own.variance += residual * residual + (sample.variance - r) * r / sample.variance;
            own.count += 1.0;
        });
    }
    for own in found.iter_mut().filter(|n| n.count > 0.0) {
        own.misfit /= own.count;
        own.variance /= own.count;
    }
    found
}

/// One sample of one signal on a tape.
struct Sample {
    signal: usize,
    /// Innovation.
    left: f64,
    /// Its variance.
    variance: f64,
}

/// Runs the Kalman filter over a tape, with sources as strong and as slow as these.
fn replay(setting: &Setting, tape: &[Step], sources: &[Source], each: &mut impl FnMut(Sample)) {
    let Some(first) = tape.first() else { return };
    let nz = first.correction.len();
    let n = nz - sources.len();
    let factor = |j: usize| sources[j].level / setting.sources[j].level.max(1e-300);
    let factors: Vec<f64> = (0..sources.len()).map(factor).collect();
    let slower: Vec<usize> = (0..sources.len()).filter(|&j| sources[j].tau != setting.sources[j].tau).collect();
    let mut p = DMatrix::identity(nz, nz);
    for (j, f) in factors.iter().enumerate() {
        p[(n + j, n + j)] = f * f;
    }
    let mut next = DMatrix::zeros(nz, nz);
    let mut transposed = DMatrix::zeros(nz, nz);
    let mut transition = DMatrix::zeros(nz, nz);
    // deviation from the prediction at which the tape was linearised
    let (mut d, mut moved) = (DVector::zeros(nz), DVector::zeros(nz));
    let mut pc = DVector::zeros(nz);
    let mut direction = DVector::zeros(nz);
    // what the tape's own filter took the sources for
    let mut taken = vec![0.0; sources.len()];
    for step in tape {
        for (row, &signal) in step.here.iter().enumerate() {
            (0..nz).for_each(|j| direction[j] = step.output[(row, j)]);
            pc.gemv(1.0, &p, &direction, 0.0);
            let variance = direction.dot(&pc) + setting.noise[signal] * setting.noise[signal];
            let left = step.innovation[row] - direction.dot(&d);
            if step.counted {
                each(Sample { signal, left, variance });
            }
            d.axpy(left / variance, &pc, 1.0);
            p.ger(-1.0 / variance, &pc, &pc, 1.0);
        }
        d -= &step.correction;
        let m = if slower.is_empty() {
            &step.transition
        } else {
            transition.copy_from(&step.transition);
            for &j in &slower {
                slow(&mut transition, n + j, setting.sources[j].tau, sources[j].tau, step.h);
            }
            &transition
        };
        moved.gemv(1.0, m, &d, 0.0);
        for (j, taken) in taken.iter_mut().enumerate() {
            *taken += step.correction[n + j];
            if slower.contains(&j) {
                let change = m.column(n + j) - step.transition.column(n + j);
                moved.axpy(*taken, &change, 1.0);
            }
            *taken *= step.transition[(n + j, n + j)];
        }
        std::mem::swap(&mut d, &mut moved);
        multiply(&mut next, m, &p, 0.0);
        m.transpose_to(&mut transposed);
        multiply(&mut p, &next, &transposed, 0.0);
        for (j, f) in factors.iter().enumerate() {
            let noise = f * f * source_noise(sources[j].tau, step.h);
            let column = m.column(n + j);
            p.ger(0.5 * noise, &column, &column, 1.0);
            p[(n + j, n + j)] += 0.5 * noise;
        }
        symmetrize(&mut p);
    }
}

/// Gives a source another correlation time: over a step it acts with its mean, and decays.
fn slow(transition: &mut DMatrix<f64>, source: usize, from: f64, to: f64, h: f64) {
    let mean = |tau: f64| -(-h / tau).exp_m1() * tau / h;
    let mut column = transition.column_mut(source);
    column *= mean(to) / mean(from);
    column[source] = (-h / to).exp();
}
