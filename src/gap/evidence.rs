//! Gaussian evidence of sets of parameters from the Gram matrix of whitened columns and data.

use nalgebra::{DMatrix, DVector};

/// What a set of parameters explains, by the linear model: data = columns times deviations + white noise.
#[derive(Clone, Debug)]
pub struct Explained {
    /// Log evidence over that of no deviation, nats.
    pub evidence: f64,
    /// Most probable deviations, in the order of the set.
    pub estimate: DVector<f64>,
    /// Their covariance.
    pub covariance: DMatrix<f64>,
}

/// Evidence of `set` (indices of columns) under independent Gaussian priors with these means and standard deviations.
/// `gram` has the data as its last row and column. `None` when the matrix is not positive, which only rounding or
/// infinite values bring about.
pub fn explain(gram: &DMatrix<f64>, set: &[usize], means: &[f64], sigmas: &[f64]) -> Option<Explained> {
    let (n, data) = (set.len(), gram.nrows() - 1);
    // in units of the priors' deviations: matrix = 1 + S G S
    let mut matrix = DMatrix::from_fn(n, n, |i, j| sigmas[i] * gram[(set[i], set[j])] * sigmas[j]);
    let mut right = DVector::from_fn(n, |i, _| sigmas[i] * gram[(set[i], data)]);
    let prior = DVector::from_fn(n, |i, _| means[i] / sigmas[i]);
    for i in 0..n {
        matrix[(i, i)] += 1.0;
        right[i] += prior[i];
    }
    let factor = matrix.cholesky()?;
    let scaled = factor.solve(&right);
    let log_det: f64 = 2.0 * factor.l().diagonal().iter().map(|v| v.ln()).sum::<f64>();
    let evidence = 0.5 * (right.dot(&scaled) - prior.norm_squared() - log_det);
    let inverse = factor.inverse();
    Some(Explained {
        evidence,
        estimate: DVector::from_fn(n, |i, _| scaled[i] * sigmas[i]),
        covariance: DMatrix::from_fn(n, n, |i, j| inverse[(i, j)] * sigmas[i] * sigmas[j]),
    })
}

/// The part of a column's square that the columns of `set` (with prior deviations) leave: what is new in it.
pub fn new_information(gram: &DMatrix<f64>, column: usize, set: &[usize], sigmas: &[f64]) -> f64 {
    let n = set.len();
    let mut matrix = DMatrix::from_fn(n, n, |i, j| sigmas[i] * gram[(set[i], set[j])] * sigmas[j]);
    (0..n).for_each(|i| matrix[(i, i)] += 1.0);
    let cross = DVector::from_fn(n, |i, _| sigmas[i] * gram[(set[i], column)]);
    let Some(factor) = matrix.cholesky() else { return 0.0 };
    (gram[(column, column)] - cross.dot(&factor.solve(&cross))).max(0.0)
}

/// The factor by which evidence shrinks because whitened innovations are not white: the effective share of independent
/// samples, 1/(1 + 2 sum of autocorrelations) up to the first one inside noise (Geyer's rule), averaged over signals.
pub fn independent_share(white: &[&DMatrix<f64>]) -> f64 {
    let signals = white.first().map_or(0, |w| w.ncols());
    let mut shares = Vec::new();
    for signal in 0..signals {
        let series: Vec<Vec<f64>> = white.iter().map(|w| w.column(signal).iter().copied().collect()).collect();
        let total: usize = series.iter().map(Vec::len).sum();
        let power: f64 = series.iter().flatten().map(|v| v * v).sum();
        if power <= 0.0 {
            continue;
        }
        let mut sum = 0.0;
        let longest = series.iter().map(Vec::len).max().unwrap_or(0) / 4;
        for lag in 1..longest.max(2) {
            let products: f64 =
                series.iter().map(|s| s.iter().zip(s.iter().skip(lag)).map(|(a, b)| a * b).sum::<f64>()).sum();
            let correlation = products / power;
            if correlation < 2.0 / (total as f64).sqrt() {
                break;
            }
            sum += correlation;
        }
        shares.push(1.0 / (1.0 + 2.0 * sum));
    }
    if shares.is_empty() { 1.0 } else { shares.iter().sum::<f64>() / shares.len() as f64 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn evidence_is_that_of_the_gaussian_integral() {
        // y = a c + noise, one column: log N(y; 0, 1 + s^2 c c') - log N(y; 0, 1)
        let (c, y, s) = ([1.0, 2.0, -1.0], [0.9, 2.3, -1.2], 0.7);
        let dot = |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let gram = DMatrix::from_row_slice(2, 2, &[dot(&c, &c), dot(&c, &y), dot(&c, &y), dot(&y, &y)]);
        let found = explain(&gram, &[0], &[0.0], &[s]).expect("positive");
        let det = 1.0 + s * s * dot(&c, &c);
        let exact = 0.5 * (s * s * dot(&c, &y).powi(2) / det) - 0.5 * det.ln();
        assert!((found.evidence - exact).abs() < 1e-12);
        assert!((found.covariance[(0, 0)] - s * s / det).abs() < 1e-12);
    }

    #[test]
    fn white_noise_counts_fully_and_slow_noise_little() {
        let mut state = 1u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
        let white = DMatrix::from_fn(4000, 1, |_, _| random());
        assert!(independent_share(&[&white]) > 0.9);
        let mut slow = white.clone();
        for k in 1..4000 {
            slow[k] += 0.95 * slow[k - 1];
        }
        let share = independent_share(&[&slow]);
        assert!((share - 0.05 / 1.95).abs() < 0.015, "{share}");
    }
}
