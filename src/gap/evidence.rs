//! Gaussian evidence of sets of parameters from the Gram matrix of whitened columns and data.

use nalgebra::{DMatrix, DVector};

/// A column of the Gram matrix whose parameter is free: its prior and its bounds, relative to where the model was linearised.
#[derive(Clone, Debug)]
pub struct Free {
    /// Index in the Gram matrix.
    pub column: usize,
    /// Most probable deviation.
    pub mean: f64,
    /// Standard deviation of the prior.
    pub sigma: f64,
    /// Least and greatest deviation.
    pub bounds: (f64, f64),
}

/// What a set of parameters explains, by the linear model: data = columns times deviations + white noise.
#[derive(Clone, Debug)]
pub struct Explained {
    /// Log evidence over that of no deviation, nats.
    pub evidence: f64,
    /// The part of it that is gained on the way from where the model was linearised, nats.
    pub promise: f64,
    /// Most probable deviations within the bounds, in the order of the set.
    pub estimate: DVector<f64>,
    /// Their covariance.
    pub covariance: DMatrix<f64>,
}

/// Evidence of a set under independent Gaussian priors. Bounds hold for the most probable deviations, not for the width of
/// what is probable about them: sets are compared among each other, and a bound that one reaches and another does not must
/// not count as a parameter less. `gram` has the data as its last row and column. `None` when the matrix is not
/// positive, which only rounding or infinite values bring about.
pub fn explain(gram: &DMatrix<f64>, set: &[Free]) -> Option<Explained> {
    let (n, data) = (set.len(), gram.nrows() - 1);
    // in units of the priors' deviations: matrix = 1 + S G S
    let curvature = curvature(gram, set);
    let prior = DVector::from_fn(n, |i, _| set[i].mean / set[i].sigma);
    let slope = DVector::from_fn(n, |i, _| set[i].sigma * gram[(set[i].column, data)] + prior[i]);
    let factor = curvature.clone().cholesky()?;
    let log_det: f64 = 2.0 * factor.l().diagonal().iter().map(|v| v.ln()).sum::<f64>();
    let bounds: Vec<(f64, f64)> = set.iter().map(|f| (f.bounds.0 / f.sigma, f.bounds.1 / f.sigma)).collect();
    let best = within(&curvature, &slope, factor.solve(&slope), &bounds)?;
    let promise = slope.dot(&best) - 0.5 * best.dot(&(&curvature * &best));
    let inverse = factor.inverse();
    Some(Explained {
        evidence: promise - 0.5 * (prior.norm_squared() + log_det),
        promise,
        estimate: DVector::from_fn(n, |i, _| best[i] * set[i].sigma),
        covariance: DMatrix::from_fn(n, n, |i, j| inverse[(i, j)] * set[i].sigma * set[j].sigma),
    })
}

/// The maximum of slope x - x curvature x / 2 within bounds, from that without any: what would lie beyond a bound is held
/// there and the others make the best of that; what a bound no longer holds is let go.
fn within(
    curvature: &DMatrix<f64>,
    slope: &DVector<f64>,
    mut best: DVector<f64>,
    bounds: &[(f64, f64)],
) -> Option<DVector<f64>> {
    let n = slope.len();
    let mut held: Vec<Option<f64>> = vec![None; n];
    // each round holds or lets go of one at least; a circle, which rounding may bring about, ends at what is feasible
    for _ in 0..4 * n {
        let mut changed = false;
        for i in 0..n {
            let (min, max) = bounds[i];
            if held[i].is_none() && !(min..=max).contains(&best[i]) {
                held[i] = Some(best[i].clamp(min, max));
                changed = true;
            }
        }
        if !changed {
            let rest = slope - curvature * &best;
            let freed =
                |i: &usize| held[*i].is_some_and(|x| if x <= bounds[*i].0 { rest[*i] > 0.0 } else { rest[*i] < 0.0 });
            let Some(most) = (0..n).filter(freed).max_by(|a, b| rest[*a].abs().total_cmp(&rest[*b].abs())) else {
                return Some(best);
            };
            held[most] = None;
        }
        let free: Vec<usize> = (0..n).filter(|i| held[*i].is_none()).collect();
        best = DVector::from_fn(n, |i, _| held[i].unwrap_or(0.0));
        let rest = slope - curvature * &best;
        let matrix = DMatrix::from_fn(free.len(), free.len(), |i, j| curvature[(free[i], free[j])]);
        let right = DVector::from_fn(free.len(), |i, _| rest[free[i]]);
        let solved = matrix.cholesky()?.solve(&right);
        free.iter().zip(solved.iter()).for_each(|(&i, x)| best[i] = *x);
    }
    Some(DVector::from_fn(n, |i, _| best[i].clamp(bounds[i].0, bounds[i].1)))
}

fn curvature(gram: &DMatrix<f64>, set: &[Free]) -> DMatrix<f64> {
    let entry = |i: usize, j: usize| set[i].sigma * gram[(set[i].column, set[j].column)] * set[j].sigma;
    DMatrix::from_fn(set.len(), set.len(), |i, j| entry(i, j) + f64::from(u8::from(i == j)))
}

/// The part of a column's square that the columns of `set` leave: what is new in it.
pub fn new_information(gram: &DMatrix<f64>, column: usize, set: &[Free]) -> f64 {
    let cross = DVector::from_fn(set.len(), |i, _| set[i].sigma * gram[(set[i].column, column)]);
    let Some(factor) = curvature(gram, set).cholesky() else { return 0.0 };
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
        let free = |bounds| Free { column: 0, mean: 0.0, sigma: s, bounds };
        let found = explain(&gram, &[free((f64::NEG_INFINITY, f64::INFINITY))]).expect("positive");
        let det = 1.0 + s * s * dot(&c, &c);
        let exact = 0.5 * (s * s * dot(&c, &y).powi(2) / det) - 0.5 * det.ln();
        assert!((found.evidence - exact).abs() < 1e-12);
        assert!((found.covariance[(0, 0)] - s * s / det).abs() < 1e-12);
    }

    /// Of all points of a fine grid within the bounds none is better, in two correlated parameters.
    #[test]
    fn bounds_hold_for_all_at_once() {
        let gram = DMatrix::from_row_slice(3, 3, &[4.0, 3.0, 5.0, 3.0, 4.0, 1.0, 5.0, 1.0, 9.0]);
        let (unbounded, step) = ((f64::NEG_INFINITY, f64::INFINITY), 0.01);
        let cases =
            [((-0.5, 0.5), unbounded), ((0.2, 0.3), (-0.1, 3.0)), ((-9.0, 9.0), (0.5, 1.0)), ((1.0, 2.0), (1.0, 2.0))];
        for (a, b) in cases {
            let free = [(0, a), (1, b)].map(|(column, bounds)| Free { column, mean: 0.1, sigma: 2.0, bounds });
            let found = explain(&gram, &free).expect("positive");
            let [x, y] = [found.estimate[0], found.estimate[1]];
            let value = |x: f64, y: f64| {
                let fits = 5.0 * x + y - 0.5 * (4.0 * x * x + 6.0 * x * y + 4.0 * y * y);
                fits - 0.125 * ((x - 0.1).powi(2) + (y - 0.1).powi(2))
            };
            for (dx, dy) in [(step, 0.0), (-step, 0.0), (0.0, step), (0.0, -step), (step, -step), (-step, step)] {
                let inside = |v: f64, (min, max): (f64, f64)| v >= min && v <= max;
                assert!(inside(x, a) && inside(y, b), "{x} {y}");
                if inside(x + dx, a) && inside(y + dy, b) {
                    assert!(value(x + dx, y + dy) <= value(x, y), "{x} {y}");
                }
            }
            assert!((found.promise - value(x, y) + value(0.0, 0.0)).abs() < 1e-12);
        }
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
