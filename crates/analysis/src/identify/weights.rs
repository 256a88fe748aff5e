//! Weights of the residual: one standard deviation for each signal, enlarged where neighbouring errors are correlated.
//!
//! Both residuals (`output_error`, `inverse`) hold a [`ResidualWeights`]. The search learns the deviations from the
//! errors between its rounds.

use crate::estimate::{ResidualSeries, correlation};

/// Weights of the rows of a residual.
#[derive(Clone, Debug)]
pub struct ResidualWeights {
    /// The rows of data, one series for each recording and signal; other rows follow them.
    pub series: Vec<ResidualSeries>,
    /// For each signal the divisor of its errors: its deviation times the root of its correlation time.
    pub sigma: Vec<f64>,
    /// For each signal the standard deviation of its errors, in its unit.
    pub deviation: Vec<f64>,
    /// For each signal over how many samples neighbouring errors are correlated.
    pub correlation: Vec<f64>,
    /// Standard deviation of the jumps between pieces of a recording, relative to the states' ranges.
    pub joint: f64,
}

impl ResidualWeights {
    /// Weights with first values of the deviations.
    pub fn new(series: Vec<ResidualSeries>, sigma: Vec<f64>) -> ResidualWeights {
        let correlation = vec![1.0; sigma.len()];
        ResidualWeights { series, correlation, deviation: sigma.clone(), sigma, joint: super::pieces::USUAL }
    }

    /// Divides errors by the `sigma` of their signals, in place.
    pub fn scale(&self, errors: &mut [f64]) {
        for s in &self.series {
            errors[s.rows.clone()].iter_mut().for_each(|e| *e /= self.sigma[s.signal]);
        }
    }

    /// The root mean square of a signal's errors, in its unit, from a weighted residual; `None` where it has no sample.
    pub fn rms(&self, signal: usize, residual: &[f64]) -> Option<f64> {
        let rows = self.series.iter().filter(|s| s.signal == signal);
        let (mut sum, mut count) = (0.0, 0usize);
        for s in rows {
            sum += residual[s.rows.clone()].iter().map(|r| r * r).sum::<f64>();
            count += s.rows.len();
        }
        (count > 0).then(|| self.sigma[signal] * (sum / count as f64).sqrt())
    }

    /// Over how many samples a signal's errors are correlated (see [`correlation::time`]).
    pub fn correlation_time(&self, signal: usize, residual: &[f64]) -> f64 {
        let of_signal = self.series.iter().filter(|s| s.signal == signal);
        correlation::mean_time(of_signal.map(|s| &residual[s.rows.clone()]))
    }

    /// Sets the deviations from a weighted residual, but not below `floor`, in the signals' units.
    ///
    /// Returns the largest change of the logarithm of a `sigma`.
    pub fn learn(&mut self, residual: &[f64], floor: &[f64]) -> f64 {
        let mut change = 0.0f64;
        for k in 0..self.sigma.len() {
            let Some(rms) = self.rms(k, residual) else { continue };
            self.correlation[k] = self.correlation_time(k, residual);
            self.deviation[k] = rms.max(floor[k]).max(f64::MIN_POSITIVE);
            // n samples correlated over tau of them carry the information of n/tau independent ones.
            let sigma = self.deviation[k] * self.correlation[k].sqrt();
            change = change.max((sigma / self.sigma[k]).ln().abs());
            self.sigma[k] = sigma;
        }
        change
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn standard_deviations_are_learned() {
        let series = vec![ResidualSeries { recording: 0, signal: 0, rows: 0..4 }];
        let mut weights = ResidualWeights::new(series, vec![2.0]);
        let mut errors = [2.0, -2.0, 2.0, -2.0];
        weights.scale(&mut errors);
        assert_eq!(errors, [1.0, -1.0, 1.0, -1.0]);
        assert_eq!(weights.rms(0, &errors), Some(2.0));
        assert!(weights.learn(&errors, &[0.0]) < 1e-12);
        weights.learn(&errors, &[5.0]);
        assert_eq!(weights.sigma, [5.0]);
    }
}
