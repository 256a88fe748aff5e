//! Correlation times: over how many samples errors are correlated with each other.
//!
//! Errors of a signal enter; a number of samples leaves, by which weights and significance tests divide the number of
//! samples.

/// Autocorrelations below this count as zero; summed over many lags they would be noise.
const UNCORRELATED: f64 = 0.05;

/// The integrated autocorrelation time in samples, at least 1.
///
/// It is 1 + 2 sum rho_k up to the first rho_k below `UNCORRELATED` (Sokal, Monte Carlo methods in statistical
/// mechanics, 1997, 3). N samples carry the information of N over this many independent ones. The mean is not removed,
/// because a constant error is an error. NaN is left out.
pub fn time(errors: &[f64]) -> f64 {
    let known: Vec<f64> = errors.iter().copied().filter(|e| e.is_finite()).collect();
    let power: f64 = known.iter().map(|e| e * e).sum();
    if power <= 0.0 {
        return 1.0;
    }
    let product = |lag: usize| known.iter().zip(&known[lag..]).map(|(a, b)| a * b).sum::<f64>() / power;
    let correlated = (1..known.len()).map(product).take_while(|rho| *rho >= UNCORRELATED);
    1.0 + 2.0 * correlated.sum::<f64>()
}

/// The correlation time of a signal in several recordings: the mean, weighted by their samples; 1 without samples.
pub fn mean_time<'a>(recordings: impl Iterator<Item = &'a [f64]>) -> f64 {
    let (mut sum, mut samples) = (0.0, 0.0);
    for errors in recordings {
        let count = errors.iter().filter(|e| e.is_finite()).count() as f64;
        sum += count * time(errors);
        samples += count;
    }
    if samples > 0.0 { sum / samples } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_an_autoregression() {
        // x_k = a x_{k-1} + e_k has rho_k = a^k, so 1 + 2 a/(1 - a) = 19 for a = 0.9; the cut at 0.05 leaves out a
        // tenth
        let (mut x, mut state) = (0.0, 1_u64);
        let samples: Vec<f64> = (0..200_000)
            .map(|_| {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                x = 0.9 * x + (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5;
                x
            })
            .collect();
        let tau = time(&samples);
        assert!((15.5..19.5).contains(&tau), "{tau}");
        assert_eq!(time(&[0.0; 5]), 1.0);
        assert_eq!(time(&[]), 1.0);
        assert!((time(&[2.0, f64::NAN, 2.0, 2.0, 2.0]) - 4.0).abs() < 1e-12);
    }
}
