//! Estimates the noise of a sensor from its samples alone.
//!
//! Samples of a signal enter; one standard deviation leaves. `identify` uses it for signals without an `accuracy`, the
//! diagnosis in `crates/gap` as the smallest error that counts. High differences remove the slow signal and keep noise.

/// Order of the differences. They remove the part of a signal below about a sixth of the sampling rate.
const ORDER: usize = 6;
/// Variance of these differences for white noise of variance 1: the sum of squared binomial coefficients, C(12, 6).
const AMPLIFICATION: f64 = 924.0;
/// Ratio of the standard deviation to the median absolute deviation of a normal distribution.
const MAD: f64 = 1.4826;

/// Standard deviation of white noise in several recordings, in the signal's unit; 0 where there are too few samples.
///
/// It comes from the median, so single outliers do not matter. NaN is left out.
pub fn white(recordings: &[&[f64]]) -> f64 {
    let mut differences: Vec<f64> = recordings.iter().flat_map(|r| sixth_differences(r)).map(f64::abs).collect();
    if differences.is_empty() {
        return 0.0;
    }
    let middle = differences.len() / 2;
    let (_, median, _) = differences.select_nth_unstable_by(middle, f64::total_cmp);
    MAD * *median / AMPLIFICATION.sqrt()
}

/// As [`white`], but at least the deviation of the finest quantisation seen, step/sqrt(12).
pub fn floor(recordings: &[&[f64]]) -> f64 {
    white(recordings).max(step(recordings) / 12.0_f64.sqrt())
}

/// The differences of order 6; those over a gap (NaN) are left out.
fn sixth_differences(samples: &[f64]) -> Vec<f64> {
    let mut d: Vec<f64> = samples.to_vec();
    for _ in 0..ORDER {
        d = d.windows(2).map(|w| w[1] - w[0]).collect();
    }
    d.retain(|v| v.is_finite());
    d
}

/// The smallest difference between neighbouring samples that are not equal: the step of a quantiser, if there is one.
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
