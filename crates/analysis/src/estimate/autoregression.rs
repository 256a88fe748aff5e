//! Autoregressive models of growing order by the Levinson-Durbin recursion (G. E. P. Box, G. M. Jenkins, Time Series
//! Analysis, 1970, ch. 3).
//!
//! Series of errors enter; partial autocorrelations and prediction variances of all orders leave. `spread` chooses an
//! order among them.

/// The autoregressive model of one order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AutoregressionOrder {
    /// Its last partial autocorrelation.
    pub partial: f64,
    /// Variance of the prediction error.
    pub power: f64,
}

/// Mean square of all series, and the models of orders 1 to `most` that they share.
///
/// There are fewer where an order predicts without error. Partial autocorrelations are limited to `limit` in size. The
/// mean is not removed.
pub fn orders<S: AsRef<[f64]>>(series: &[S], most: usize, limit: f64) -> (f64, Vec<AutoregressionOrder>) {
    let rows: usize = series.iter().map(|s| s.as_ref().len()).sum();
    // Products within a series only: its end and the start of the next are not neighbours.
    let product = |lag: usize| {
        let one = |s: &S| s.as_ref().iter().zip(s.as_ref().iter().skip(lag)).map(|(a, b)| a * b).sum::<f64>();
        series.iter().map(one).sum::<f64>() / rows.max(1) as f64
    };
    let correlations: Vec<f64> = (0..=most).map(product).collect();
    let mut power = correlations[0];
    let (mut found, mut coefficients) = (Vec::new(), Vec::new());
    for order in 1..=most {
        if power.is_nan() || power <= 0.0 {
            break;
        }
        // Levinson's recursion: the new partial autocorrelation is what the lower order leaves unexplained at this lag.
        let predicted: f64 = coefficients.iter().enumerate().map(|(i, a)| a * correlations[order - 1 - i]).sum();
        let partial = ((correlations[order] - predicted) / power).clamp(-limit, limit);
        coefficients = longer(&coefficients, partial);
        power *= 1.0 - partial * partial;
        found.push(AutoregressionOrder { partial, power });
    }
    (correlations[0], found)
}

/// The coefficients of the next order from those of the last one and its partial autocorrelation.
pub fn longer(coefficients: &[f64], partial: f64) -> Vec<f64> {
    let old = coefficients.iter().zip(coefficients.iter().rev());
    old.map(|(a, b)| a - partial * b).chain([partial]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_series_that_halves_is_told_by_the_value_before() {
        let series: Vec<f64> = (0..60).map(|k| 0.5_f64.powi(k)).collect();
        let (power, orders) = orders(&[series], 3, 1.0);
        assert!((orders[0].partial - 0.5).abs() < 1e-12, "{orders:?}");
        // only its first value has no value before it to predict it
        assert!((orders[0].power / power - 0.75).abs() < 1e-12, "{orders:?}");
        assert!(orders[1..].iter().all(|o| o.partial.abs() < 1e-9), "{orders:?}");
    }

    #[test]
    fn nothing_has_no_orders() {
        assert_eq!(orders(&[vec![0.0; 5]], 3, 1.0), (0.0, Vec::new()));
    }
}
