//! How strong the sources and the sensors' noise are: type-II likelihood on linearised steps, without the model.

use super::filter::{Setting, Step, source_noise, symmetrize};
use super::step::multiply;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// Factors by which a level is tried, coarse ones first.
const ROUNDS: [&[f64]; 3] = [&[0.1, 10.0], &[0.3, 3.0], &[0.55, 1.8]];

/// Steps at most in a direction that pays.
const FURTHER: usize = 5;

/// Adjusts the levels of the sources, relative to those in the setting, so that the tapes become most likely.
/// Returns the factors and the log likelihood reached.
pub fn fit(setting: &Setting, tapes: &[&[Step]]) -> (Vec<f64>, f64) {
    let mut factors = vec![1.0; setting.sources.len()];
    let value = |factors: &[f64]| tapes.par_iter().map(|t| likelihood(setting, t, factors)).sum::<f64>();
    let mut best = value(&factors);
    for round in ROUNDS {
        for i in 0..factors.len() {
            let before = factors[i];
            let mut kept = before;
            for f in round {
                factors[i] = before * f;
                let found = value(&factors);
                if found > best {
                    // on in this direction while it pays
                    (best, kept) = (found, factors[i]);
                    for _ in 0..FURTHER {
                        factors[i] *= f;
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

/// Log likelihood of a tape with the sources' levels multiplied by `factors`: a Kalman filter, one signal after the other.
pub fn likelihood(setting: &Setting, tape: &[Step], factors: &[f64]) -> f64 {
    let Some(first) = tape.first() else { return 0.0 };
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
    let mut sum = 0.0;
    for step in tape {
        for (row, &i) in step.here.iter().enumerate() {
            (0..nz).for_each(|j| direction[j] = step.output[(row, j)]);
            pc.gemv(1.0, &p, &direction, 0.0);
            let variance = direction.dot(&pc) + setting.noise[i] * setting.noise[i];
            let left = step.innovation[row] - direction.dot(&d);
            sum -= 0.5 * (left * left / variance + variance.ln() + (2.0 * std::f64::consts::PI).ln());
            d.axpy(left / variance, &pc, 1.0);
            p.ger(-1.0 / variance, &pc, &pc, 1.0);
        }
        d -= &step.correction;
        moved.gemv(1.0, &step.transition, &d, 0.0);
        std::mem::swap(&mut d, &mut moved);
        multiply(&mut next, &step.transition, &p, 0.0);
        step.transition.transpose_to(&mut transposed);
        multiply(&mut p, &next, &transposed, 0.0);
        for (j, f) in factors.iter().enumerate() {
            let noise = f * f * source_noise(setting.sources[j].tau, step.h);
            let column = step.transition.column(n + j);
            p.ger(0.5 * noise, &column, &column, 1.0);
            p[(n + j, n + j)] += 0.5 * noise;
        }
        symmetrize(&mut p);
    }
    if sum.is_finite() { sum } else { f64::NEG_INFINITY }
}
