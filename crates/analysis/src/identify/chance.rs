//! Tail probabilities of the normal, the chi-square and Student's distribution.
//!
//! Residual tests, confidence intervals and profiles read them. `statrs` supplies the incomplete gamma and beta
//! functions; where its quantiles are too inaccurate, this file computes them from these functions.

use statrs::function::beta::beta_reg;
use statrs::function::gamma::checked_gamma_ur;

/// The 97.5 % quantile of the normal distribution.
pub const NORMAL: f64 = 1.959_963_984_540_054;

/// The probability that a standard normal variable exceeds `z` in absolute value.
pub fn two_sided(z: f64) -> f64 {
    // z^2 is chi-square with 1 degree of freedom; `erfc` of statrs is accurate to 1e-10 only.
    beyond(z * z, 1)
}

/// The probability that a chi-square variable with `degrees` degrees of freedom (at least 1) exceeds `x`; 1 where `x`
/// is NaN.
pub fn beyond(x: f64, degrees: usize) -> f64 {
    checked_gamma_ur(0.5 * degrees as f64, 0.5 * x).unwrap_or(if x > 0.0 { 0.0 } else { 1.0 }).min(1.0)
}

/// From this many degrees of freedom on Student's distribution is taken as normal.
const MANY: f64 = 1e6;

/// The 97.5 % quantile of Student's distribution. `degrees` is at least 1 and need not be an integer.
pub fn student(degrees: f64) -> f64 {
    if degrees >= MANY {
        return NORMAL;
    }
    // statrs' own quantile is off by 1e-5 from 1e5 degrees of freedom on. The two-sided tail probability of t is the
    // incomplete beta function I_x(n/2, 1/2) at x = n/(n + t^2); bisection inverts it. 13 exceeds the quantile of one
    // degree of freedom, 12.7.
    let outside = |t: f64| beta_reg(0.5 * degrees, 0.5, degrees / (degrees + t * t));
    let (mut low, mut high) = (NORMAL, 13.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if outside(middle) > 0.05 { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// The radius, in deviations, of the joint 95 % confidence region of two normal variables whose variances have
/// `degrees` degrees of freedom.
///
/// It is the root of twice the 95 % quantile of Fisher's distribution with 2 and `degrees` degrees of freedom, which
/// has a closed form.
pub fn pair_size(degrees: f64) -> f64 {
    let part = if degrees >= MANY { -2.0 * 0.05f64.ln() } else { degrees * (0.05f64.powf(-2.0 / degrees) - 1.0) };
    part.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tabulated_points() {
        assert!((two_sided(NORMAL) - 0.05).abs() < 1e-14);
        assert!((two_sided(3.290_526_731_491_926) - 1e-3).abs() < 1e-14);
        assert!(
            (beyond(NORMAL * NORMAL, 1) - 0.05).abs() < 1e-14 && (beyond(-2.0 * 0.05f64.ln(), 2) - 0.05).abs() < 1e-14
        );
        // the 95 % points of 5 and 10 degrees of freedom
        assert!((beyond(11.070_497_693_516_35, 5) - 0.05).abs() < 1e-12);
        assert!((beyond(18.307_038_053_275_14, 10) - 0.05).abs() < 1e-12);
        for (degrees, point) in [(1.0, 12.706_204_736_432_1), (5.0, 2.570_581_835_636), (30.0, 2.042_272_456_301)] {
            assert!((student(degrees) - point).abs() < 1e-9, "{degrees}: {}", student(degrees));
        }
        assert!((student(1e5) - NORMAL).abs() < 1e-4 && student(f64::INFINITY) == NORMAL);
        // twice the 95 % point of Fisher's distribution with 2 and 10 degrees of freedom
        assert!((pair_size(10.0).powi(2) - 2.0 * 4.102_821_015).abs() < 1e-8);
        assert!((pair_size(1e5) - pair_size(f64::INFINITY)).abs() < 1e-3);
        assert_eq!((beyond(0.0, 3), two_sided(0.0)), (1.0, 1.0));
    }
}
