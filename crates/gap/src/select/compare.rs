//! Is one model better than another? Two tests on left-out data, numbers alone: block losses under random flips of
//! sign, and the likelihood ratio as an e-value.

use super::super::policy::{ALPHA, DELTA, LEAST};
use super::folds::LeftOutErrors;

/// What there is to know of the sensors.
#[derive(Clone, Debug, PartialEq)]
pub struct SensorAccuracy {
    /// Per signal the standard deviation of its noise.
    pub noise: Vec<f64>,
    /// Per signal its full scale.
    pub full_scale: Vec<f64>,
}

/// Loss differences of two models, block by block: how much better the second one is. Each block and signal has a
/// variance of its own, so that one wild block cannot decide; blocks in which both are closed do not vote.
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
            let weight = a.samples[k][i] / samples * blocks as f64;
            *d += weight * (loss(a.squares[k][i], closed) - loss(b.squares[k][i], closed));
        }
    }
    all
}

/// The mean square of a signal below which its gap is closed, where the best model leaves `best`.
pub fn closed(sensors: &SensorAccuracy, signal: usize, best: f64) -> f64 {
    sensors.noise[signal].powi(2) + DELTA * DELTA * best + least(sensors, signal)
}

/// Loss of a block. Where a simulation does not get, the error is as large as numbers are.
pub fn loss(square: f64, closed: f64) -> f64 {
    (square.min(f64::MAX.sqrt()) + closed).ln()
}

fn least(sensors: &SensorAccuracy, signal: usize) -> f64 {
    (LEAST * sensors.full_scale[signal]).powi(2)
}

/// Mean over its standard error, neighbours' correlation included; 0 for less than two.
pub fn t_statistic(d: &[f64]) -> f64 {
    let n = d.len() as f64;
    if d.len() < 2 {
        return 0.0;
    }
    let mean = d.iter().sum::<f64>() / n;
    let variance = d.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
    let neighbours = d.windows(2).map(|w| (w[0] - mean) * (w[1] - mean)).sum::<f64>() / n;
    let variance = (variance + 2.0 * neighbours.max(0.0)).max(f64::MIN_POSITIVE);
    mean / (variance / n).sqrt()
}

/// Log likelihood ratio of left-out data, nats: how much better the second model is, each signal with the variance that
/// the model leaves. `independent`: per signal how many samples count. If the first model is true, it exceeds log(m/alpha)
/// with probability below alpha/m (Markov; Vovk, Wang, Annals of Statistics 49, 2021).
pub fn evidence(a: &LeftOutErrors, b: &LeftOutErrors, independent: &[f64], sensors: &SensorAccuracy) -> f64 {
    let one = |i: usize| {
        let floor = least(sensors, i);
        let worse = |m: f64| m.min(f64::MAX.sqrt()) + floor;
        0.5 * independent[i] * (worse(a.mean(i)) / worse(b.mean(i))).ln()
    };
    (0..sensors.noise.len()).map(one).sum()
}

/// What evidence must pass where the best of so many hypotheses is asked for, nats.
pub fn needed(hypotheses: usize) -> f64 {
    (hypotheses.max(1) as f64 / ALPHA).ln()
}

/// Noise-free gap of a signal, in its unit.
pub fn signal_gap(left: &LeftOutErrors, signal: usize, sensors: &SensorAccuracy) -> f64 {
    (left.mean(signal) - sensors.noise[signal].powi(2)).max(0.0).sqrt()
}

/// Noise-free gap over all signals, in parts of full scale.
pub fn gap(left: &LeftOutErrors, sensors: &SensorAccuracy) -> f64 {
    let squares: Vec<f64> = (0..sensors.noise.len()).map(|i| left.mean(i)).collect();
    total_gap(&squares, sensors)
}

/// The same from the mean square of each signal.
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
