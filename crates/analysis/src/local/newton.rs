//! Newton's method for the implicit unknowns of a point, and passes over rates that read each other.
//!
//! Values of states, parameters and inputs enter through `y`; solved unknowns and rates leave in `y` and `yp`. The
//! iteration starts at the last point. Where it does not converge, `LocalEvaluator` uses the solver of whole runs.

use super::LocalError;
use super::plan::EvaluationPlan;
use nalgebra::{DMatrix, DVector};

/// Largest number of iterations.
const NEWTON: usize = 12;
/// Residuals below this share of the first one, and corrections below this share of their unknowns, are rounding.
const CONVERGED: f64 = 1e-11;

/// The point that Newton's method moves, and what it works with there. One entry a column unless said otherwise.
pub(super) struct NewtonPoint<'a> {
    /// Unknowns, states, parameters and inputs; implicit unknowns are updated.
    pub y: &'a mut [f64],
    /// Rates; updated.
    pub yp: &'a mut [f64],
    /// Buffer for residuals, one a row.
    pub residual: &'a mut [f64],
    /// Buffer for the entries of the Jacobian.
    pub entries: &'a mut [f64],
    /// Buffer for those of the Jacobian that counts rates, for implicit rates.
    pub torn_entries: &'a mut [f64],
    /// All values of the system, by its layout; updated.
    pub values: &'a mut [f64],
}

impl EvaluationPlan {
    /// Solves for the implicit unknowns from their last values, and for all explicit rates. False where the iteration
    /// does not converge.
    pub(super) fn newton(&self, time: f64, at: &mut NewtonPoint<'_>) -> Result<bool, LocalError> {
        let system = &self.system;
        let mut first = 0.0;
        // The rate of an explicit row is its residual at rate 0. From a much larger rate only rounding would remain.
        self.explicit.iter().for_each(|&j| at.yp[j] = 0.0);
        for iteration in 0..NEWTON {
            if system.residual(time, at.y, at.yp, at.values, at.residual).is_err() {
                // Without unknowns there is nothing to search for, so the failure is final.
                return if self.implicit.is_empty() { Err(LocalError::NonFinite) } else { Ok(false) };
            }
            for &j in &self.explicit {
                at.yp[j] -= at.residual[j];
            }
            let size = self.implicit.iter().map(|i| at.residual[i.0].abs()).fold(0.0, f64::max);
            // Residuals have fallen to rounding.
            if self.implicit.is_empty() || size == 0.0 || iteration > 0 && size <= CONVERGED * first {
                return Ok(true);
            }
            if iteration == 0 {
                first = size;
            }
            let Ok(change) = self.correction(time, at) else {
                return Ok(false);
            };
            let mut moved = 0.0_f64;
            for (&(column, torn), d) in self.implicit.iter().zip(change.iter()) {
                let unknown = if torn { &mut at.yp[column] } else { &mut at.y[column] };
                *unknown -= d;
                moved = moved.max(d.abs() / (unknown.abs() + f64::MIN_POSITIVE));
            }
            if moved < CONVERGED {
                // The corrections are rounding, so the residual cannot shrink further.
                if system.residual(time, at.y, at.yp, at.values, at.residual).is_err() {
                    return Ok(false);
                }
                for &j in &self.explicit {
                    at.yp[j] -= at.residual[j];
                }
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Evaluates explicit rows repeatedly, until rates that read other rates agree with them.
    pub(super) fn settle_rates(
        &self,
        time: f64,
        y: &[f64],
        yp: &mut [f64],
        residual: &mut [f64],
        values: &mut [f64],
    ) -> Result<(), LocalError> {
        // A chain of rates needs at most one pass for each of them.
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

    /// The Newton step of the implicit unknowns: the solution of their own rows and columns of the Jacobian.
    fn correction(&self, time: f64, at: &mut NewtonPoint<'_>) -> Result<DVector<f64>, LocalError> {
        let NewtonPoint { y, yp, residual, entries, torn_entries, values } = at;
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
                    // For an unknown rate the derivative by yp counts, which is the difference of both Jacobians.
                    matrix[(i, j)] = if torn { torn_entries[k] - entries[k] } else { entries[k] };
                }
            }
        }
        let right = DVector::from_fn(q, |i, _| residual[self.implicit[i].0]);
        matrix.lu().solve(&right).ok_or(LocalError::Singular)
    }
}
