//! Sobol' sequences, and variance-based sensitivity indices with confidence intervals.
//!
//! [`design`] makes the points of a sweep, [`indices`] evaluates the results of its runs. Sources: S. Joe, F. Y. Kuo,
//! SIAM J. Sci. Comput. 30 (2008) 2635; A. Saltelli et al., Comput. Phys. Commun. 181 (2010) 259.

use super::sampling::XorshiftGenerator;

/// Primitive polynomials: degree, coefficients, first direction numbers. Source: Joe and Kuo, as above.
const DIRECTIONS: [(u32, u32, &[u32]); 20] = [
    (1, 0, &[1]),
    (2, 1, &[1, 3]),
    (3, 1, &[1, 3, 1]),
    (3, 2, &[1, 1, 1]),
    (4, 1, &[1, 1, 3, 3]),
    (4, 4, &[1, 3, 5, 13]),
    (5, 2, &[1, 1, 5, 5, 17]),
    (5, 4, &[1, 1, 5, 5, 5]),
    (5, 7, &[1, 1, 7, 11, 19]),
    (5, 11, &[1, 1, 5, 1, 1]),
    (5, 13, &[1, 1, 1, 3, 11]),
    (5, 14, &[1, 3, 5, 5, 31]),
    (6, 1, &[1, 3, 3, 9, 7, 49]),
    (6, 13, &[1, 1, 1, 15, 21, 21]),
    (6, 16, &[1, 3, 1, 13, 27, 49]),
    (6, 19, &[1, 1, 1, 15, 7, 5]),
    (6, 22, &[1, 3, 1, 15, 13, 25]),
    (6, 25, &[1, 1, 5, 5, 19, 61]),
    (7, 1, &[1, 3, 7, 11, 23, 15, 103]),
    (7, 4, &[1, 3, 7, 13, 13, 15, 69]),
];

/// Bits of a coordinate.
const BITS: u32 = 32;

/// The direction numbers of one coordinate; those of the first give the van der Corput sequence.
fn integers(direction: usize) -> Vec<u32> {
    let Some(k) = direction.checked_sub(1) else { return (0..BITS).map(|i| 1 << (31 - i)).collect() };
    let (degree, coefficients, first) = DIRECTIONS[k];
    let s = degree as usize;
    let mut v: Vec<u32> = first.iter().zip(0..).map(|(m, i)| m << (31 - i)).collect();
    for i in s..BITS as usize {
        let mut next = v[i - s] ^ (v[i - s] >> degree);
        for j in 1..s {
            if (coefficients >> (s - 1 - j)) & 1 == 1 {
                next ^= v[i - j];
            }
        }
        v.push(next);
    }
    v
}

/// The first `count` points of the sequence after its origin.
fn points(count: usize, directions: usize) -> Vec<Vec<f64>> {
    let v: Vec<Vec<u32>> = (0..directions).map(integers).collect();
    let mut x = vec![0u32; directions];
    let mut rows = Vec::with_capacity(count);
    for k in 0..count {
        // Gray code order: point k + 1 differs from point k by the direction number of the lowest zero bit of k.
        let bit = (!(k as u32)).trailing_zeros().min(BITS - 1) as usize;
        for (x, v) in x.iter_mut().zip(&v) {
            *x ^= v[bit];
        }
        rows.push(x.iter().map(|&x| (f64::from(x) + 0.5) / 2f64.powi(32)).collect());
    }
    rows
}

/// The points for sensitivity indices.
///
/// Each of `count` base points gives `directions` + 2 rows: A, B, and A with one coordinate of B after the other.
///
/// # Errors
/// A sentence where there are too many parameters.
pub fn design(count: usize, directions: usize) -> Result<Vec<Vec<f64>>, String> {
    // A and B need a coordinate of the sequence for each parameter.
    let most = DIRECTIONS.len().div_ceil(2);
    if directions > most {
        return Err(format!(
            "Sobol' indices are for at most {most} parameters, not {directions}; use `latin-hypercube`"
        ));
    }
    let mut rows = Vec::with_capacity(count * (directions + 2));
    for point in points(count, 2 * directions) {
        let (a, b) = point.split_at(directions);
        rows.push(a.to_vec());
        rows.push(b.to_vec());
        for j in 0..directions {
            let mut mixed = a.to_vec();
            mixed[j] = b[j];
            rows.push(mixed);
        }
    }
    Ok(rows)
}

/// The share of a result's variance that a parameter causes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SobolIndex {
    /// First-order index: by the parameter alone.
    pub first: f64,
    /// Total index: with all interactions.
    pub total: f64,
    /// Half the width of the 95 % confidence interval of `first`.
    pub first_confidence: f64,
    /// Half the width of the 95 % confidence interval of `total`.
    pub total_confidence: f64,
}

/// Number of bootstrap resamplings for the confidence intervals.
const RESAMPLINGS: usize = 200;

/// One index for each parameter, from the results of a `design` in its order.
///
/// Groups with a failed run (NaN) are left out. `None` where fewer than eight groups remain, or where the result is
/// constant. Formulas: Saltelli et al., table 2 (b) and (f).
pub fn indices(results: &[f64], directions: usize, seed: u64) -> Option<Vec<SobolIndex>> {
    let groups: Vec<&[f64]> =
        results.chunks_exact(directions + 2).filter(|g| g.iter().all(|v| v.is_finite())).collect();
    if groups.len() < 8 {
        return None;
    }
    let (first, total) = estimate(&groups, directions)?;
    let mut random = XorshiftGenerator::new(seed);
    let mut spread = vec![(Vec::new(), Vec::new()); directions];
    for _ in 0..RESAMPLINGS {
        let drawn: Vec<&[f64]> = (0..groups.len()).map(|_| groups[random.below(groups.len())]).collect();
        let Some((f, t)) = estimate(&drawn, directions) else { continue };
        for j in 0..directions {
            spread[j].0.push(f[j]);
            spread[j].1.push(t[j]);
        }
    }
    let index = |j: usize| SobolIndex {
        first: first[j],
        total: total[j],
        first_confidence: 1.96 * deviation(&spread[j].0),
        total_confidence: 1.96 * deviation(&spread[j].1),
    };
    Some((0..directions).map(index).collect())
}

/// The population standard deviation.
fn deviation(values: &[f64]) -> f64 {
    let n = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / n;
    (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n).sqrt()
}

/// First-order and total indices of all parameters; `None` where the result is constant.
fn estimate(groups: &[&[f64]], directions: usize) -> Option<(Vec<f64>, Vec<f64>)> {
    let n = groups.len() as f64;
    let all = || groups.iter().flat_map(|g| g[..2].iter());
    let mean = all().sum::<f64>() / (2.0 * n);
    let variance = all().map(|y| (y - mean).powi(2)).sum::<f64>() / (2.0 * n);
    if variance <= 1e-24 * mean * mean || variance == 0.0 {
        return None;
    }
    let sum = |f: &dyn Fn(&[f64]) -> f64| groups.iter().map(|g| f(g)).sum::<f64>() / n / variance;
    let first = (0..directions).map(|j| sum(&|g| (g[1] - mean) * (g[2 + j] - g[0]))).collect();
    let total = (0..directions).map(|j| 0.5 * sum(&|g| (g[0] - g[2 + j]).powi(2))).collect();
    Some((first, total))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_direction_is_spread_evenly() {
        let rows = points(63, 21);
        for j in 0..21 {
            let mut parts: Vec<usize> = rows.iter().map(|r| (r[j] * 64.0) as usize).collect();
            parts.sort_unstable();
            assert_eq!(parts, (1..64).collect::<Vec<_>>(), "direction {j}");
        }
    }

    /// Ishigami's function: indices are known.
    #[test]
    fn indices_of_a_known_function() {
        let f = |x: &[f64]| {
            let x: Vec<f64> = x.iter().map(|p| std::f64::consts::PI * (2.0 * p - 1.0)).collect();
            x[0].sin() + 7.0 * x[1].sin().powi(2) + 0.1 * x[2].powi(4) * x[0].sin()
        };
        let results: Vec<f64> = design(2048, 3).unwrap().iter().map(|x| f(x)).collect();
        let found = indices(&results, 3, 1).unwrap();
        for (i, (first, total)) in [(0.314, 0.558), (0.442, 0.442), (0.0, 0.244)].into_iter().enumerate() {
            let s = found[i];
            assert!((s.first - first).abs() < 0.02 && (s.total - total).abs() < 0.02, "{i}: {s:?}");
            assert!((s.first - first).abs() < 2.0 * s.first_confidence + 0.01, "{i}: {s:?}");
        }
        assert!(indices(&[1.0; 100], 3, 1).is_none());
        assert!(design(4, 11).is_err());
    }
}
