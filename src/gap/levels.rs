//! How strong the sources and the sensors' noise are: type-II likelihood on linearised steps, without the model.

use super::filter::predict::{source_noise, symmetrize};
use super::filter::{Setting, Step};
use super::step::{add_outer, advance, advance_across, apply};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// Factors by which a level is tried, coarse ones first.
const ROUNDS: [&[f64]; 4] = [&[0.1, 10.0], &[0.3, 3.0], &[0.55, 1.8], &[1.0 / FINE, FINE]];
/// The finest factor; between the last three values a parabola over the logarithm gives the best one. Levels that are a
/// third off cost tens of nats, which would be taken for a difference between effects.
const FINE: f64 = 1.25;

/// Steps at most in a direction that pays.
const FURTHER: usize = 5;
/// What a source may move a state within a step at most, in sizes of the state: a stronger one is no disturbance.
const REACH: f64 = 0.5;

/// Every so many tapes are looked at first; levels that are so much less likely on these are not tried on the others, nats.
const FIRST: usize = 3;
const SURE: f64 = 100.0;

/// Log likelihood of all tapes by the factors of the levels.
struct Likelihood<'a> {
    setting: &'a Setting,
    first: Vec<&'a [Step]>,
    others: Vec<&'a [Step]>,
    /// The best found: on the first ones, and on all.
    best: (f64, f64),
}

impl<'a> Likelihood<'a> {
    fn new(setting: &'a Setting, tapes: &[&'a [Step]], factors: &[f64]) -> Self {
        let part = |first: bool| (0..tapes.len()).filter(|i| (i % FIRST == 0) == first).map(|i| tapes[i]).collect();
        let mut own = Likelihood {
            setting,
            first: part(true),
            others: part(false),
            best: (f64::NEG_INFINITY, f64::NEG_INFINITY),
        };
        own.improves(factors);
        own
    }

    fn sum(&self, tapes: &[&[Step]], factors: &[f64]) -> f64 {
        tapes.par_iter().map(|t| likelihood(self.setting, t, factors)).sum()
    }

    /// Of all tapes.
    fn at(&self, factors: &[f64]) -> f64 {
        self.sum(&self.first, factors) + self.sum(&self.others, factors)
    }

    /// Whether these factors are the best so far.
    fn improves(&mut self, factors: &[f64]) -> bool {
        let first = self.sum(&self.first, factors);
        if first < self.best.0 - SURE {
            return false;
        }
        let all = first + self.sum(&self.others, factors);
        let better = all > self.best.1;
        if better {
            self.best = (first, all);
        }
        better
    }
}

/// Adjusts the levels of the sources, relative to those in the setting, so that the tapes become most likely.
/// Returns the factors, at most `growth`.
pub fn fit(setting: &Setting, tapes: &[&[Step]], growth: f64) -> Vec<f64> {
    let mut factors = vec![1.0; setting.sources.len()];
    let most: Vec<f64> = most(tapes, factors.len()).into_iter().map(|m| m.min(growth)).collect();
    let mut likelihood = Likelihood::new(setting, tapes, &factors);
    for round in ROUNDS {
        for i in 0..factors.len() {
            let before = factors[i];
            let mut kept = before;
            for f in round {
                if before * f > most[i].max(before) {
                    continue;
                }
                factors[i] = before * f;
                if likelihood.improves(&factors) {
                    kept = factors[i];
                    // on in this direction while it pays
                    for _ in 0..FURTHER {
                        factors[i] *= f;
                        if *f > 1.0 && factors[i] > most[i] || !likelihood.improves(&factors) {
                            break;
                        }
                        kept = factors[i];
                    }
                    break;
                }
            }
            factors[i] = kept;
        }
    }
    for i in 0..factors.len() {
        let best = factors[i];
        let mut at = |factor: f64| {
            factors[i] = factor;
            likelihood.at(&factors)
        };
        let (below, above) = (at(best / FINE), at(best * FINE));
        let bend = 2.0 * likelihood.best.1 - below - above;
        let shift = 0.5 * (above - below) / bend;
        factors[i] = if bend > 0.0 { (best * FINE.powf(shift.clamp(-1.0, 1.0))).min(most[i].max(best)) } else { best };
        if !likelihood.improves(&factors) {
            factors[i] = best;
        }
    }
    factors
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

/// Log likelihood of a tape with the sources' levels multiplied by `factors`: a Kalman filter, one signal after the other.
pub fn likelihood(setting: &Setting, tape: &[Step], factors: &[f64]) -> f64 {
    let mut sum = 0.0;
    replay(setting, tape, factors, &mut |sample| {
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
        replay(setting, tape, factors, &mut |sample| {
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

/// Runs the Kalman filter over a tape.
fn replay(setting: &Setting, tape: &[Step], factors: &[f64], each: &mut impl FnMut(Sample)) {
    let Some(first) = tape.first() else { return };
    let nz = first.correction.len();
    let n = nz - factors.len();
    let mut p = DMatrix::identity(nz, nz);
    for (j, f) in factors.iter().enumerate() {
        p[(n + j, n + j)] = f * f;
    }
    let mut next = DMatrix::zeros(nz, nz);
    let mut transposed = DMatrix::zeros(nz, nz);
    // deviation from the prediction at which the tape was linearised
    let (mut d, mut moved) = (DVector::zeros(nz), DVector::zeros(nz));
    let mut pc = DVector::zeros(nz);
    let mut direction = DVector::zeros(nz);
    for step in tape {
        for (row, &signal) in step.here.iter().enumerate() {
            (0..nz).for_each(|j| direction[j] = step.output[(row, j)]);
            apply(&mut pc, &p, &direction, 0.0);
            let variance = direction.dot(&pc) + setting.noise[signal] * setting.noise[signal];
            let left = step.innovation[row] - direction.dot(&d);
            if step.counted {
                each(Sample { signal, left, variance });
            }
            d.axpy(left / variance, &pc, 1.0);
            add_outer(&mut p, -1.0 / variance, pc.as_slice(), pc.as_slice());
        }
        d -= &step.correction;
        apply(&mut moved, &step.transition, &d, 0.0);
        std::mem::swap(&mut d, &mut moved);
        advance(&mut next, &step.transition, n, &p);
        step.transition.transpose_to(&mut transposed);
        advance_across(&mut p, &next, &transposed, n, 0.0);
        for (j, f) in factors.iter().enumerate() {
            let noise = f * f * source_noise(setting.sources[j].tau, step.h);
            let column = step.transition.column(n + j);
            add_outer(&mut p, 0.5 * noise, column.as_slice(), column.as_slice());
            p[(n + j, n + j)] += 0.5 * noise;
        }
        symmetrize(&mut p);
    }
}
