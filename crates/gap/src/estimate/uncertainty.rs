//! Standard deviations of a fit's coordinates that the verdict shows.
//!
//! They follow the rule of all estimates of the program (`bramah_analysis::estimate`): an autoregressive model of each
//! signal's errors, found by restricted maximum likelihood. Called by the verdict.

use super::super::data::RecordingData;
use super::map::ModelFit;
use bramah_analysis::estimate::{LinearizedEstimate, ResidualSeries, spread};
use nalgebra::{DMatrix, DVector};

impl ModelFit {
    /// Standard deviation of each coordinate, in its units; 0 for a coordinate that a bound holds.
    /// `None` if the simulation stops early.
    pub fn uncertainty(&self, train: &[RecordingData]) -> Option<Vec<f64>> {
        let free = self.system(|_, _| true).free(&self.candidate.coordinates, &self.x);
        let mut rows = EstimateRows::default();
        for (number, recording) in train.iter().enumerate() {
            // the complete Jacobian is needed here, since the rule whitens each series of residuals
            let slopes = self.candidate.slopes(&self.x, recording, number)?;
            self.add_data(&mut rows, number, &slopes, &free);
        }
        self.add_known(&mut rows, &free);
        let jacobian = DMatrix::from_row_slice(rows.residual.len(), free.len(), &rows.jacobian);
        let residual = DVector::from_vec(rows.residual);
        let found = spread(LinearizedEstimate { jacobian: &jacobian, residual: &residual, series: &rows.series });
        let mut deviations = vec![0.0; self.x.len()];
        free.iter().enumerate().for_each(|(a, &i)| deviations[i] = found.covariance[(a, a)].max(0.0).sqrt());
        Some(deviations)
    }

    /// Adds the rows of one recording, signal by signal. `slopes`: samples by signals by coordinates.
    fn add_data(&self, rows: &mut EstimateRows, number: usize, slopes: &[f32], free: &[usize]) {
        let (errors, width) = (&self.evaluated.errors[number], self.x.len());
        for (signal, of_signal) in errors.iter().enumerate() {
            let (first, weight) = (rows.residual.len(), self.weights.weight(signal).sqrt());
            for (k, error) in of_signal.iter().enumerate().filter(|(_, e)| e.is_finite()) {
                let row = &slopes[(k * errors.len() + signal) * width..][..width];
                // the residual of an estimate is simulated minus measured
                rows.add(free.iter().map(|&i| weight * f64::from(row[i])), -weight * error);
            }
            rows.series.push(ResidualSeries { recording: number, signal, rows: first..rows.residual.len() });
        }
    }

    /// Adds a row for each coordinate with a prior.
    fn add_known(&self, rows: &mut EstimateRows, free: &[usize]) {
        for (a, &i) in free.iter().enumerate() {
            let coordinate = &self.candidate.coordinates[i];
            if let Some((_, sigma)) = coordinate.prior {
                let own = (0..free.len()).map(|b| if a == b { 1.0 / sigma } else { 0.0 });
                rows.add(own, coordinate.distance(self.x[i]));
            }
        }
    }
}

/// Rows of a linearised estimate as they are collected.
#[derive(Default)]
struct EstimateRows {
    /// Row-major: rows by free coordinates.
    jacobian: Vec<f64>,
    /// Weighted residual of each row.
    residual: Vec<f64>,
    /// Rows that follow each other in time, one entry per recording and signal.
    series: Vec<ResidualSeries>,
}

impl EstimateRows {
    /// Adds one row.
    fn add(&mut self, slopes: impl Iterator<Item = f64>, residual: f64) {
        self.jacobian.extend(slopes);
        self.residual.push(residual);
    }
}
