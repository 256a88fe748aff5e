//! Tail probabilities of the normal and the chi-square distribution.

use libm::erfc;
use std::f64::consts::PI;

/// The point that a chi-square variable with one degree of freedom stays below in 95 % of all cases.
pub const LEVEL_1: f64 = 3.841_458_820_694_124;
/// The same with two degrees of freedom, 2 ln 20.
pub const LEVEL_2: f64 = 5.991_464_547_107_979;
/// The normal distribution's 97.5 % point.
pub const NORMAL: f64 = 1.959_963_984_540_054;

/// Chance that a normal variable lies further than `z` deviations from its mean, on either side.
pub fn two_sided(z: f64) -> f64 {
    erfc(z.abs() / std::f64::consts::SQRT_2)
}

/// Chance that a chi-square variable with this many degrees of freedom, at least 1, exceeds `x`.
///
/// By the finite sums that hold for whole degrees of freedom.
pub fn beyond(x: f64, degrees: usize) -> f64 {
    if x <= 0.0 {
        return 1.0;
    }
    let half = 0.5 * x;
    let (mut sum, mut term, mut at) = if degrees.is_multiple_of(2) {
        (0.0, (-half).exp(), 1.0)
    } else {
        (erfc(half.sqrt()), (-half).exp() * (half / (0.25 * PI)).sqrt(), 1.5)
    };
    for _ in 0..degrees / 2 {
        sum += term;
        term *= half / at;
        at += 1.0;
    }
    sum.min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tabulated_points() {
        assert!((two_sided(NORMAL) - 0.05).abs() < 1e-14);
        assert!((two_sided(3.290_526_731_491_926) - 1e-3).abs() < 1e-14);
        assert!((beyond(LEVEL_1, 1) - 0.05).abs() < 1e-14 && (beyond(LEVEL_2, 2) - 0.05).abs() < 1e-14);
        // the 95 % points of 5 and 10 degrees of freedom
        assert!((beyond(11.070_497_693_516_35, 5) - 0.05).abs() < 1e-12);
        assert!((beyond(18.307_038_053_275_14, 10) - 0.05).abs() < 1e-12);
        assert_eq!((beyond(0.0, 3), two_sided(0.0)), (1.0, 1.0));
    }
}
