//! Residual tests: are the errors white, and are they correlated with an input?
//!
//! Weighted residuals of a fit and the inputs beside them enter; a [`ResidualTest`] for each signal leaves. The fit and
//! its report read it. Sources: G. M. Ljung, G. E. P. Box, Biometrika 65 (1978) 297; L. Ljung, System Identification,
//! 1999, section 16.6.

use super::chance::{NORMAL, beyond, two_sided};
use super::weights::ResidualWeights;
use crate::study::{BoundStudy, Recording};

/// The tests of one signal's errors.
#[derive(Clone, Debug, PartialEq)]
pub struct ResidualTest {
    /// The signal's name; for the inverse model the input's.
    pub name: String,
    /// Number of samples in all recordings.
    pub samples: usize,
    /// Autocorrelation from lag 1 on, in samples; the mean is not removed.
    pub autocorrelation: Vec<f64>,
    /// The statistic of Ljung and Box over these lags.
    pub statistic: f64,
    /// The probability that white errors give a larger statistic; small for errors that are not white.
    pub chance: f64,
    /// Cross-correlation with each input; empty for the inverse model.
    pub inputs: Vec<InputCrossCorrelation>,
}

/// The strongest correlation of errors with a present or earlier value of an input.
#[derive(Clone, Debug, PartialEq)]
pub struct InputCrossCorrelation {
    /// The input's name.
    pub input: String,
    /// By how many samples the input precedes the error.
    pub lag: usize,
    /// The correlation coefficient there.
    pub correlation: f64,
    /// The probability of a stronger one at any of the lags, for errors independent of the input.
    pub chance: f64,
}

/// Largest number of lags.
const LAGS: usize = 40;
/// A test fails below this probability.
pub const UNLIKELY: f64 = 0.01;

impl ResidualTest {
    /// Tests the errors of signal `k`.
    ///
    /// `inputs` holds for each input its name and, for each recording, its values at the samples of the errors. `None`
    /// where the shortest recording allows fewer than two lags, or where all errors are zero.
    pub fn new(
        name: &str,
        k: usize,
        weights: &ResidualWeights,
        residual: &[f64],
        inputs: &[(String, Vec<Vec<f64>>)],
    ) -> Option<ResidualTest> {
        let of_signal = weights.series.iter().filter(|s| s.signal == k);
        let errors: Vec<&[f64]> = of_signal.map(|s| &residual[s.rows.clone()]).collect();
        let samples: usize = errors.iter().map(|e| e.len()).sum();
        let shortest = errors.iter().map(|e| e.len()).filter(|n| *n > 0).min()?;
        // At lags beyond a fifth of the shortest recording few products remain.
        let lags = LAGS.min(shortest / 5);
        let power = product(&errors, &errors, 0);
        if lags < 2 || power <= 0.0 {
            return None;
        }
        let autocorrelation: Vec<f64> = (1..=lags).map(|lag| product(&errors, &errors, lag) / power).collect();
        let n = samples as f64;
        // Q = n (n + 2) sum r_k^2/(n - k).
        let part = |(i, r): (usize, &f64)| r * r / (n - (i + 1) as f64);
        let statistic = n * (n + 2.0) * autocorrelation.iter().enumerate().map(part).sum::<f64>();
        let follow = inputs.iter().filter_map(|(name, values)| dependence(name, &errors, values, lags));
        Some(ResidualTest {
            name: name.to_owned(),
            samples,
            chance: beyond(statistic, lags),
            statistic,
            inputs: follow.collect(),
            autocorrelation,
        })
    }

    /// 95 % of the autocorrelations of white errors lie within plus and minus this value.
    pub fn bound(&self) -> f64 {
        NORMAL / (self.samples as f64).sqrt()
    }

    /// Whether the test of whiteness passes.
    pub fn white(&self) -> bool {
        self.chance >= UNLIKELY
    }

    /// The inputs with which the errors are significantly correlated.
    pub fn followed(&self) -> impl Iterator<Item = &InputCrossCorrelation> {
        self.inputs.iter().filter(|d| d.chance < UNLIKELY)
    }
}

/// For each input its name and its values at the samples at which a signal was measured, by recording.
pub fn inputs_beside(bound: &BoundStudy, signal: usize, recordings: &[Recording]) -> Vec<(String, Vec<Vec<f64>>)> {
    let beside = |i: usize, r: &Recording| {
        let known = r.inputs[i].iter().zip(&r.signals[signal]).filter(|(_, y)| !y.is_nan());
        known.map(|(u, _)| *u).collect::<Vec<f64>>()
    };
    let all = bound.inputs.iter().enumerate();
    all.map(|(i, input)| (input.name.clone(), recordings.iter().map(|r| beside(i, r)).collect())).collect()
}

/// The sum over all recordings of b(t) a(t + lag).
fn product(a: &[impl AsRef<[f64]>], b: &[impl AsRef<[f64]>], lag: usize) -> f64 {
    let one = |(a, b): (&[f64], &[f64])| a.iter().skip(lag).zip(b).map(|(a, b)| a * b).sum::<f64>();
    a.iter().zip(b).map(|(a, b)| one((a.as_ref(), b.as_ref()))).sum()
}

/// The values minus their mean over all recordings.
fn centred(values: &[impl AsRef<[f64]>]) -> Vec<Vec<f64>> {
    let all = || values.iter().flat_map(|v| v.as_ref());
    let mean = all().sum::<f64>() / all().count().max(1) as f64;
    values.iter().map(|v| v.as_ref().iter().map(|x| x - mean).collect()).collect()
}

/// Tests the cross-correlation of errors with one input; `None` where one of them does not vary.
fn dependence(name: &str, errors: &[&[f64]], input: &[Vec<f64>], lags: usize) -> Option<InputCrossCorrelation> {
    let (e, u) = (centred(errors), centred(input));
    let (e0, u0) = (product(&e, &e, 0), product(&u, &u, 0));
    let size: f64 = input.iter().flatten().map(|v| v * v).sum();
    if e0 <= 0.0 || u0 <= 1e-18 * size || !u0.is_finite() {
        return None;
    }
    // The variance of a correlation of two coloured, independent series is (1 + 2 sum r_e(k) r_u(k))/n (Bartlett). The
    // taper damps the noise of large lags, and 0.1 bounds the sum from below.
    let both = |lag: usize| product(&e, &e, lag) / e0 * product(&u, &u, lag) / u0;
    let taper = |lag: usize| 1.0 - lag as f64 / (lags + 1) as f64;
    let n: usize = e.iter().map(Vec::len).sum();
    let variance = (1.0 + 2.0 * (1..=lags).map(|lag| taper(lag) * both(lag)).sum::<f64>()).max(0.1) / n as f64;
    let at = |lag: usize| product(&e, &u, lag) / (e0 * u0).sqrt();
    let (lag, correlation) =
        (0..=lags).map(|lag| (lag, at(lag))).max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())).expect("lag 0 is there");
    // Bonferroni's bound for the largest of lags + 1 correlations.
    let chance = ((lags + 1) as f64 * two_sided(correlation / variance.sqrt())).min(1.0);
    Some(InputCrossCorrelation { input: name.to_owned(), lag, correlation, chance })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::ResidualSeries;

    /// Numbers of mean 0 from a congruential generator.
    fn noise(seed: u64, count: usize) -> Vec<f64> {
        let mut state = seed;
        let mut roll = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        };
        (0..count).map(|_| roll() + roll() + roll()).collect()
    }

    fn judged(errors: &[f64], input: &[f64]) -> ResidualTest {
        let series = vec![ResidualSeries { recording: 0, signal: 0, rows: 0..errors.len() }];
        let weights = ResidualWeights::new(series, vec![1.0]);
        ResidualTest::new("y", 0, &weights, errors, &[("u".into(), vec![input.to_vec()])]).expect("enough")
    }

    #[test]
    fn white_errors_pass_and_coloured_ones_fail() {
        let u = noise(7, 600);
        let white = judged(&noise(3, 600), &u);
        assert!(white.white() && white.followed().next().is_none(), "{white:?}");
        let mut state = 0.0;
        let filter = |e: &f64| {
            state = 0.8 * state + e;
            state
        };
        let coloured: Vec<f64> = noise(3, 600).iter().map(filter).collect();
        let coloured = judged(&coloured, &u);
        assert!(!coloured.white() && (coloured.autocorrelation[0] - 0.8).abs() < 0.1, "{coloured:?}");
        assert!(coloured.followed().next().is_none());
    }

    #[test]
    fn errors_that_follow_an_input_are_named_with_the_lag() {
        let u = noise(7, 600);
        let errors: Vec<f64> =
            noise(3, 600).iter().enumerate().map(|(k, e)| e + if k >= 5 { 0.4 * u[k - 5] } else { 0.0 }).collect();
        let found = judged(&errors, &u);
        let followed: Vec<(&str, usize)> = found.followed().map(|d| (d.input.as_str(), d.lag)).collect();
        assert_eq!(followed, [("u", 5)]);
    }

    /// About one white series in a hundred fails, as the level says.
    #[test]
    fn the_level_is_kept() {
        let failed = (0..300).filter(|k| !judged(&noise(1000 + 77 * k, 400), &noise(5, 400)).white()).count();
        assert!(failed <= 9, "{failed}");
    }
}
