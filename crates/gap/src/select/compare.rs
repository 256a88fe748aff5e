//! Comparison of two models on left-out data, as pure functions of numbers.
//!
//! Two statistics: a t statistic of loss differences over blocks, and a log likelihood ratio that is an e-value.
//! Also the noise-free gap of a signal and of all signals. Called by the other modules of `select`.

use super::folds::LeftOutErrors;
use crate::policy::{ALPHA, DELTA, LEAST};

/// Noise and full scale of each sensor, SI.
#[derive(Clone, Debug, PartialEq)]
pub struct SensorAccuracy {
    /// Per signal the standard deviation of its noise.
    pub noise: Vec<f64>,
    /// Per signal its full scale.
    pub full_scale: Vec<f64>,
}

/// Loss differences of two models, one per block; positive where `b` is better.
/// Each block and signal has a variance of its own, so that one extreme block cannot decide.
/// Blocks in which both models leave a closed gap contribute almost nothing.
pub fn differences(a: &LeftOutErrors, b: &LeftOutErrors, sensors: &SensorAccuracy) -> Vec<f64> {
    let signals = sensors.noise.len();
    let blocks = a.squares.len();
    let mut all = vec![0.0; blocks];
    for i in 0..signals {
        let closed = closed(sensors, i, a.mean(i).min(b.mean(i)));
        let samples: f64 = a.samples.iter().map(|s| s[i]).sum();
        if samples <= 0.0 {
            continue;
        }
        for (k, d) in all.iter_mut().enumerate() {
            // a signal counts equally in all, however its samples are spread over the blocks
            let weight = a.samples[k][i] / samples * blocks as f64;
            *d += weight * (loss(a.squares[k][i], closed) - loss(b.squares[k][i], closed));
        }
    }
    all
}

/// Mean square of a signal below which its gap counts as closed, if the best model leaves `best`.
pub fn closed(sensors: &SensorAccuracy, signal: usize, best: f64) -> f64 {
    sensors.noise[signal].powi(2) + DELTA * DELTA * best + least(sensors, signal)
}

/// Loss of a block: a Gaussian log likelihood with a variance of its own, without its constant.
/// The limit keeps it finite where a simulation did not get there.
pub fn loss(square: f64, closed: f64) -> f64 {
    (square.min(f64::MAX.sqrt()) + closed).ln()
}

/// Mean square below which errors are rounding, SI squared.
fn least(sensors: &SensorAccuracy, signal: usize) -> f64 {
    (LEAST * sensors.full_scale[signal]).powi(2)
}

/// Mean over its standard error, with the correlation of neighbouring blocks; 0 for fewer than two values.
/// `d`: one difference per block.
pub fn t_statistic(d: &[f64]) -> f64 {
    let n = d.len() as f64;
    if d.len() < 2 {
        return 0.0;
    }
    let mean = d.iter().sum::<f64>() / n;
    let variance = d.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
    let neighbours = d.windows(2).map(|w| (w[0] - mean) * (w[1] - mean)).sum::<f64>() / n;
    // a negative correlation would make the mean look more certain than it is
    let variance = (variance + 2.0 * neighbours.max(0.0)).max(f64::MIN_POSITIVE);
    mean / (variance / n).sqrt()
}

/// Log likelihood ratio of left-out data for `b` over `a`, nats; each signal has the variance that a model leaves.
///
/// `independent`: per signal the number of samples that count as independent. If `a` is true, the evidence exceeds
/// `ln(m/alpha)` with a probability below `alpha/m` (Markov; Vovk, Wang, Annals of Statistics 49, 2021).
pub fn evidence(a: &LeftOutErrors, b: &LeftOutErrors, independent: &[f64], sensors: &SensorAccuracy) -> f64 {
    let one = |i: usize| {
        let floor = least(sensors, i);
        let worse = |m: f64| m.min(f64::MAX.sqrt()) + floor;
        0.5 * independent[i] * (worse(a.mean(i)) / worse(b.mean(i))).ln()
    };
    (0..sensors.noise.len()).map(one).sum()
}

/// Evidence that the best of `hypotheses` needs, nats: `ln(m/ALPHA)`. The factor m is the price of having chosen the
/// best.
pub fn needed(hypotheses: usize) -> f64 {
    (hypotheses.max(1) as f64 / ALPHA).ln()
}

/// Noise-free gap of a signal, in its SI unit.
pub fn signal_gap(left: &LeftOutErrors, signal: usize, sensors: &SensorAccuracy) -> f64 {
    (left.mean(signal) - sensors.noise[signal].powi(2)).max(0.0).sqrt()
}

/// Noise-free gap over all signals, in parts of full scale: root of the mean over signals of their squared parts.
pub fn gap(left: &LeftOutErrors, sensors: &SensorAccuracy) -> f64 {
    let squares: Vec<f64> = (0..sensors.noise.len()).map(|i| left.mean(i)).collect();
    total_gap(&squares, sensors)
}

/// The same from the mean square of each signal, SI squared: `sqrt(mean_i max(m_i - noise_i^2, 0)/scale_i^2)`.
pub fn total_gap(squares: &[f64], sensors: &SensorAccuracy) -> f64 {
    let parts = squares.iter().zip(&sensors.noise).zip(&sensors.full_scale);
    let sum: f64 = parts.map(|((s, noise), scale)| (s - noise * noise).max(0.0) / (scale * scale)).sum();
    (sum / squares.len().max(1) as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sensors() -> SensorAccuracy {
        SensorAccuracy { noise: vec![0.0], full_scale: vec![1.0] }
    }

    fn left(squares: &[f64]) -> LeftOutErrors {
        LeftOutErrors {
            squares: squares.iter().map(|s| vec![*s]).collect(),
            samples: squares.iter().map(|_| vec![10.0]).collect(),
            errors: Vec::new(),
            dampings: Vec::new(),
        }
    }

    fn random(state: &mut u64) -> f64 {
        *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*state >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn normal(state: &mut u64) -> f64 {
        (0..12).map(|_| random(state)).sum::<f64>() - 6.0
    }

    #[test]
    fn evidence_is_an_e_value() {
        // both models are equally good: over many draws the mean of exp(E) stays below 1 for a ratio of fixed variances,
        // and E with variances of its own exceeds log(1/alpha) no more often than alpha
        let mut state = 11;
        let draws = 10_000;
        let beyond = (0..draws)
            .filter(|_| {
                let errors: Vec<(f64, f64)> = (0..50).map(|_| (normal(&mut state), normal(&mut state))).collect();
                let square = |f: &dyn Fn(&(f64, f64)) -> f64| errors.iter().map(|e| f(e).powi(2)).sum::<f64>() / 50.0;
                // the second model's prediction adds something independent of what it predicts
                let (a, b) = (square(&|e| e.0), square(&|e| e.0 + 0.3 * e.1));
                evidence(&left(&[a]), &left(&[b]), &[50.0], &sensors()) > needed(1)
            })
            .count();
        assert!((beyond as f64) < ALPHA * f64::from(draws), "{beyond}");
    }

    #[test]
    fn a_wild_block_does_not_decide_and_scale_does_not_matter() {
        let worse = left(&[1.0; 24]);
        let mut better = left(&[0.5; 24]);
        better.squares[3][0] = 1e6;
        let d = differences(&worse, &better, &sensors());
        assert!(d.iter().filter(|v| **v < 0.0).count() == 1);
        // in another unit the same
        let scaled = |l: &LeftOutErrors| LeftOutErrors {
            squares: l.squares.iter().map(|s| vec![s[0] * 1e10]).collect(),
            samples: l.samples.clone(),
            errors: Vec::new(),
            dampings: Vec::new(),
        };
        let in_other = SensorAccuracy { noise: vec![0.0], full_scale: vec![1e5] };
        let other = differences(&scaled(&worse), &scaled(&better), &in_other);
        d.iter().zip(&other).for_each(|(a, b)| assert!((a - b).abs() < 1e-9));
    }
}
