//! The noise floor of a sensor, from its samples alone.

/// Differences of this order cancel what a signal holds below about a sixth of the sampling rate.
const ORDER: usize = 6;
/// The sum of squared binomial coefficients of that order: how much white noise they amplify, C(12, 6).
const AMPLIFICATION: f64 = 924.0;
/// Median absolute deviation to standard deviation of a normal distribution.
const MAD: f64 = 1.4826;

/// Standard deviation of the white noise in the samples of several recordings, in the signal's unit: robust, from
/// sixth differences; 0 where there are too few samples. Gaps (NaN) are left out.
pub fn white(recordings: &[&[f64]]) -> f64 {
    let mut differences: Vec<f64> = recordings.iter().flat_map(|r| sixth_differences(r)).map(f64::abs).collect();
    if differences.is_empty() {
        return 0.0;
    }
    let middle = differences.len() / 2;
    let (_, median, _) = differences.select_nth_unstable_by(middle, f64::total_cmp);
    MAD * *median / AMPLIFICATION.sqrt()
}

/// The same, and never below the noise of the finest quantisation seen.
pub fn floor(recordings: &[&[f64]]) -> f64 {
    white(recordings).max(step(recordings) / 12.0_f64.sqrt())
}

fn sixth_differences(samples: &[f64]) -> Vec<f64> {
    let mut d: Vec<f64> = samples.to_vec();
    for _ in 0..ORDER {
        d = d.windows(2).map(|w| w[1] - w[0]).collect();
    }
    d.retain(|v| v.is_finite());
    d
}

/// The smallest distance between different neighbouring samples: a quantiser's step, if there is one.
fn step(recordings: &[&[f64]]) -> f64 {
    let mut smallest = f64::INFINITY;
    for samples in recordings {
        for w in samples.windows(2) {
            let d = (w[1] - w[0]).abs();
            // differences that are rounding of the same decimal number do not count
            if d > 1e-9 * w[0].abs().max(w[1].abs()) {
                smallest = smallest.min(d);
            }
        }
    }
    if smallest.is_finite() { smallest } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sine_is_no_noise() {
        let mut state = 7u64;
        let mut random = || {
            let mut sum = 0.0;
            for _ in 0..12 {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                sum += (state >> 11) as f64 / (1u64 << 53) as f64;
            }
            sum - 6.0
        };
        let samples: Vec<f64> = (0..4000).map(|k| 50.0 * (k as f64 * 0.05).sin() + 0.3 * random()).collect();
        let sigma = floor(&[&samples]);
        assert!((sigma - 0.3).abs() < 0.02, "{sigma}");
    }
}
