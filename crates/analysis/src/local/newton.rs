//! Implicit unknowns by Newton's method, rates that read each other.

use super::LocalError;
use super::plan::EvaluationPlan;
use nalgebra::{DMatrix, DVector};

/// Iterations of Newton's method on the implicit unknowns.
const NEWTON: usize = 12;
/// Residuals and corrections are rounding below this part of what they began with.
const CONVERGED: f64 = 1e-11;

impl EvaluationPlan {
    /// Solves for the implicit unknowns from their last values, and for all rates; false where that does not converge.
    pub(super) fn newton(
        &self,
        time: f64,
        y: &mut [f64],
        yp: &mut [f64],
        residual: &mut [f64],
        entries: &mut [f64],
        torn_entries: &mut [f64],
        values: &mut [f64],
    ) -> Result<bool, LocalError> {
        let system = &self.system;
        let mut first = 0.0;
        // a rate is what is left of its row at rate 0: from another rate, far larger, only its rounding would be left
        self.explicit.iter().for_each(|&j| yp[j] = 0.0);
        for iteration in 0..NEWTON {
            if system.residual(time, y, yp, values, residual).is_err() {
                return if self.implicit.is_empty() { Err(LocalError::NonFinite) } else { Ok(false) };
            }
            for &j in &self.explicit {
                yp[j] -= residual[j];
            }
            let size = self.implicit.iter().map(|i| residual[i.0].abs()).fold(0.0, f64::max);
            // residuals at the level of rounding: of the first ones, or of the unknowns' own contributions
            if self.implicit.is_empty() || size == 0.0 || iteration > 0 && size <= CONVERGED * first {
                return Ok(true);
            }
            if iteration == 0 {
                first = size;
            }
            let Ok(change) = self.correction(time, y, yp, residual, entries, torn_entries, values) else {
                return Ok(false);
            };
            let mut moved = 0.0_f64;
            for (&(column, torn), d) in self.implicit.iter().zip(change.iter()) {
                let unknown = if torn { &mut yp[column] } else { &mut y[column] };
                *unknown -= d;
                moved = moved.max(d.abs() / (unknown.abs() + f64::MIN_POSITIVE));
            }
            if moved < CONVERGED {
                // the residual can shrink no further: it is rounding
                if system.residual(time, y, yp, values, residual).is_err() {
                    return Ok(false);
                }
                for &j in &self.explicit {
                    yp[j] -= residual[j];
                }
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Rates that read other rates, which follow from each other one after the other.
    pub(super) fn settle_rates(
        &self,
        time: f64,
        y: &[f64],
        yp: &mut [f64],
        residual: &mut [f64],
        values: &mut [f64],
    ) -> Result<(), LocalError> {
        for _ in 0..self.explicit.len() {
            self.system.residual(time, y, yp, values, residual).map_err(|_| LocalError::NonFinite)?;
            let settled = self.explicit.iter().all(|&j| residual[j].abs() <= CONVERGED * yp[j].abs());
            self.explicit.iter().for_each(|&j| yp[j] -= residual[j]);
            if settled {
                break;
            }
        }
        Ok(())
    }

    fn correction(
        &self,
        time: f64,
        y: &[f64],
        yp: &[f64],
        residual: &[f64],
        entries: &mut [f64],
        torn_entries: &mut [f64],
        values: &mut [f64],
    ) -> Result<DVector<f64>, LocalError> {
        let system = &self.system;
        let torn = self.implicit.iter().any(|i| i.1);
        system.jacobian(time, 0.0, y, yp, values, entries).map_err(|_| LocalError::NonFinite)?;
        if torn {
            system.jacobian(time, 1.0, y, yp, values, torn_entries).map_err(|_| LocalError::NonFinite)?;
        }
        let q = self.implicit.len();
        let mut matrix = DMatrix::zeros(q, q);
        let pattern = &system.pattern;
        for (j, &(column, torn)) in self.implicit.iter().enumerate() {
            for k in pattern.colptr[column]..pattern.colptr[column + 1] {
                if let Some(i) = self.implicit_row[pattern.rowidx[k]] {
                    matrix[(i, j)] = if torn { torn_entries[k] - entries[k] } else { entries[k] };
                }
            }
        }
        let right = DVector::from_fn(q, |i, _| residual[self.implicit[i].0]);
        matrix.lu().solve(&right).ok_or(LocalError::Singular)
    }
}
