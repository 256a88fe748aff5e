//! Errors that are no white noise: where no source follows what the model does not know, its errors are as coloured as
//! that is. An autoregression tells each from those before it, and what it does not tell is white (generalised least
//! squares; Box, Jenkins, Time Series Analysis, 1970, ch. 7; Ljung, System Identification, 1999, 7.3).

use crate::analysis::autoregression;
use std::collections::VecDeque;

/// Order of the autoregression.
pub const ORDER: usize = 12;
/// Partial autocorrelations at most: an error that never fades would leave nothing to weigh.
const LIMIT: f64 = 0.9999;

/// How the errors of a signal tell the next one.
#[derive(Clone, Debug, PartialEq)]
pub struct Colour {
    /// Coefficients, the last error first.
    pub coefficients: Vec<f64>,
    /// Variance of what they do not tell, over that of the errors.
    pub power: f64,
}

impl Colour {
    /// That of errors in stretches without gaps.
    pub fn of(errors: &[Vec<f64>]) -> Self {
        let (all, orders) = autoregression::orders(errors, ORDER, LIMIT);
        let coefficients = orders.iter().fold(Vec::new(), |c, o| autoregression::longer(&c, o.partial));
        let left = orders.last().map_or(all, |o| o.power);
        Colour { coefficients, power: if all > 0.0 { left / all } else { 1.0 } }
    }
}

/// The rows of a signal (columns, then the error) before the present one, the last first.
#[derive(Clone, Debug, Default)]
pub(super) struct Past(VecDeque<Vec<f64>>);

impl Past {
    /// After a sample that is missing nothing is told.
    pub(super) fn forget(&mut self) {
        self.0.clear();
    }

    /// Takes from a row what those before tell of it, in units of what they do not tell; false where too few are known.
    pub(super) fn whiten(&mut self, colour: &Colour, row: &mut [f64]) -> bool {
        let known = self.0.len() == colour.coefficients.len();
        let own = row.to_vec();
        for (a, before) in colour.coefficients.iter().zip(&self.0) {
            row.iter_mut().zip(before).for_each(|(v, b)| *v -= a * b);
        }
        let root = colour.power.sqrt();
        row.iter_mut().for_each(|v| *v /= root);
        self.0.push_front(own);
        self.0.truncate(colour.coefficients.len());
        known
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_errors_before_do_not_tell_is_white() {
        let mut state = 1u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
        let mut errors = vec![0.0; 20_000];
        for k in 1..errors.len() {
            errors[k] = 0.95 * errors[k - 1] + random();
        }
        let colour = Colour::of(std::slice::from_ref(&errors));
        let mut past = Past::default();
        let power = errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64;
        let white: Vec<f64> = errors
            .iter()
            .filter_map(|e| {
                let mut row = [e / power.sqrt()];
                past.whiten(&colour, &mut row).then_some(row[0])
            })
            .collect();
        assert_eq!(white.len(), errors.len() - ORDER);
        let mean = |lag: usize| white.iter().zip(&white[lag..]).map(|(a, b)| a * b).sum::<f64>() / white.len() as f64;
        assert!((mean(0) - 1.0).abs() < 0.02, "{}", mean(0));
        assert!((1..5).all(|lag| mean(lag).abs() < 0.03));
    }

    #[test]
    fn nothing_is_told_after_a_gap() {
        let colour = Colour { coefficients: vec![0.5], power: 0.75 };
        let mut past = Past::default();
        assert!(!past.whiten(&colour, &mut [1.0]));
        assert!(past.whiten(&colour, &mut [1.0]));
        past.forget();
        assert!(!past.whiten(&colour, &mut [1.0]));
    }
}
