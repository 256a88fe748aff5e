//! How far the coordinates of a fit may be off, by the rule of all estimates (`bramah_analysis::estimate`).

use super::super::data::RecordingData;
use super::map::ModelFit;
use bramah_analysis::estimate::{LinearizedEstimate, ResidualSeries, spread};
use nalgebra::{DMatrix, DVector};

impl ModelFit {
    /// Standard deviation of each coordinate, in its units; what a bound holds has none. `None` where the model does not reach
    /// the end of a recording.
    pub fn uncertainty(&self, train: &[RecordingData]) -> Option<Vec<f64>> {
        let free = self.system(|_, _| true).free(&self.candidate.coordinates, &self.x);
        let mut rows = EstimateRows::default();
        for (number, recording) in train.iter().enumerate() {
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

    /// The samples of one recording, signal by signal; slopes are samples by signals by coordinates.
    fn add_data(&self, rows: &mut EstimateRows, number: usize, slopes: &[f32], free: &[usize]) {
        let (errors, width) = (&self.evaluated.errors[number], self.x.len());
        for (signal, of_signal) in errors.iter().enumerate() {
            let (first, weight) = (rows.residual.len(), self.weights.weight(signal).sqrt());
            for (k, error) in of_signal.iter().enumerate().filter(|(_, e)| e.is_finite()) {
                let row = &slopes[(k * errors.len() + signal) * width..][..width];
                rows.add(free.iter().map(|&i| weight * f64::from(row[i])), -weight * error);
            }
            rows.series.push(ResidualSeries { recording: number, signal, rows: first..rows.residual.len() });
        }
    }

    /// What is known of the coordinates beforehand.
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

/// Rows of an estimate as they are collected.
#[derive(Default)]
struct EstimateRows {
    jacobian: Vec<f64>,
    residual: Vec<f64>,
    series: Vec<ResidualSeries>,
}

impl EstimateRows {
    fn add(&mut self, slopes: impl Iterator<Item = f64>, residual: f64) {
        self.jacobian.extend(slopes);
        self.residual.push(residual);
    }
}
