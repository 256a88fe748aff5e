//! Zero-phase low-pass filters for recorded signals, numerical derivatives, and interpolation over gaps.
//!
//! The inverse model uses them to get states and their rates from measured signals. All functions take samples at equal
//! distances and return as many. Coefficients come from the bilinear transform of the Butterworth low-pass with its
//! corner prewarped (A. V. Oppenheim, R. W. Schafer, Discrete-Time Signal Processing).

use std::f64::consts::PI;

/// A second-order section (biquad) in the transposed direct form II, with a0 = 1.
#[derive(Clone, Copy, Debug)]
struct SecondOrderSection {
    /// Coefficients of the input: b0, b1, b2.
    b: [f64; 3],
    /// Coefficients of the output: a1, a2.
    a: [f64; 2],
}

/// A fourth-order Butterworth low-pass that runs forwards and backwards: no phase shift, half the amplitude at the
/// corner.
#[derive(Clone, Copy, Debug)]
pub struct LowPass {
    /// The two pole pairs.
    sections: [SecondOrderSection; 2],
    /// Samples after which a transient has decayed.
    settle: usize,
}

impl LowPass {
    /// A filter with a corner as a fraction of the sampling rate, below one half.
    pub fn new(corner: f64) -> LowPass {
        let corner = corner.clamp(1e-6, 0.49);
        // Prewarping: the bilinear transform maps this analogue frequency to the wanted corner.
        let w = (PI * corner).tan();
        // Pole pairs of a fourth-order Butterworth filter have the damping cos(pi/8) and cos(3 pi/8).
        let section = |angle: f64| {
            let zeta = (angle * PI / 8.0).cos();
            let scale = 1.0 + 2.0 * zeta * w + w * w;
            let gain = w * w / scale;
            let a = [2.0 * (w * w - 1.0) / scale, (1.0 - 2.0 * zeta * w + w * w) / scale];
            SecondOrderSection { b: [gain, 2.0 * gain, gain], a }
        };
        LowPass { sections: [section(1.0), section(3.0)], settle: (1.5 / corner).ceil() as usize }
    }

    /// The filtered samples, as many as `values`.
    ///
    /// The ends are continued by the samples rotated about the end point, which keeps value and slope there.
    pub fn apply(&self, values: &[f64]) -> Vec<f64> {
        let n = values.len();
        if n < 2 {
            return values.to_vec();
        }
        let pad = self.settle.min(n - 1);
        let (first, last) = (values[0], values[n - 1]);
        let mut work: Vec<f64> = (1..=pad).rev().map(|k| 2.0 * first - values[k]).collect();
        work.extend_from_slice(values);
        work.extend((1..=pad).map(|k| 2.0 * last - values[n - 1 - k]));
        // Each pass filters and reverses; the second one cancels the phase of the first.
        for _ in 0..2 {
            for section in &self.sections {
                section.run(&mut work);
            }
            work.reverse();
        }
        work[pad..pad + n].to_vec()
    }
}

impl SecondOrderSection {
    /// Filters in place. It starts in the steady state for the first value, so that a constant passes unchanged.
    fn run(&self, values: &mut [f64]) {
        let x0 = values[0];
        let mut s2 = (self.b[2] - self.a[1]) * x0;
        let mut s1 = (self.b[1] - self.a[0]) * x0 + s2;
        for value in values {
            let x = *value;
            let y = self.b[0] * x + s1;
            s1 = self.b[1] * x - self.a[0] * y + s2;
            s2 = self.b[2] * x - self.a[1] * y;
            *value = y;
        }
    }
}

/// Central differences of samples `step` seconds apart; one-sided at the ends.
pub fn derivative(values: &[f64], step: f64) -> Vec<f64> {
    let n = values.len();
    let at = |i: usize| {
        let (low, high) = (i.saturating_sub(1), (i + 1).min(n - 1));
        (values[high] - values[low]) / ((high - low).max(1) as f64 * step)
    };
    (0..n).map(at).collect()
}

/// Replaces NaN by linear interpolation, at the ends by the nearest value. All zero where no sample is a number.
pub fn filled(values: &[f64]) -> Vec<f64> {
    let mut out = values.to_vec();
    let known: Vec<usize> = (0..values.len()).filter(|&i| !values[i].is_nan()).collect();
    let (Some(&first), Some(&last)) = (known.first(), known.last()) else { return vec![0.0; values.len()] };
    out[..first].fill(values[first]);
    out[last..].fill(values[last]);
    for pair in known.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        for i in a + 1..b {
            out[i] = values[a] + (values[b] - values[a]) * (i - a) as f64 / (b - a) as f64;
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise;

    fn wave(frequency: f64) -> Vec<f64> {
        (0..2000).map(|k| (2.0 * PI * frequency * f64::from(k)).sin()).collect()
    }

    /// The largest value in the middle.
    fn amplitude(values: &[f64]) -> f64 {
        values[500..1500].iter().fold(0.0, |m, v| v.abs().max(m))
    }

    #[test]
    fn passes_slow_waves_without_shift_and_stops_fast_ones() {
        let filter = LowPass::new(0.05);
        let slow = wave(0.005);
        let passed = filter.apply(&slow);
        assert!(slow.iter().zip(&passed).all(|(a, b)| (a - b).abs() < 2e-3));
        assert!((amplitude(&filter.apply(&wave(0.05))) - 0.5).abs() < 0.01);
        assert!(amplitude(&filter.apply(&wave(0.2))) < 1e-4);
        assert_eq!(filter.apply(&[3.0; 50]).iter().map(|v| (v * 1e9).round()).sum::<f64>(), 150e9);
    }

    #[test]
    fn derivatives_gaps_and_noise() {
        assert_eq!(derivative(&[0.0, 1.0, 4.0, 9.0], 0.5), [2.0, 4.0, 8.0, 10.0]);
        let n = f64::NAN;
        assert_eq!(filled(&[n, 1.0, n, n, 4.0, n]), [1.0, 1.0, 2.0, 3.0, 4.0, 4.0]);
        // a congruential generator's numbers, evenly spread over 1: sigma 1/sqrt(12)
        let mut seed = 1u64;
        let mut next = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1u64 << 53) as f64
        };
        let noisy: Vec<f64> = wave(0.01).iter().map(|v| 10.0 * v + next()).collect();
        assert!((noise::white(&[&noisy]) - 0.289).abs() < 0.02, "{}", noise::white(&[&noisy]));
    }
}
