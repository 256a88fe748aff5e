//! Nonlinear least squares within bounds: the Levenberg-Marquardt method with an active set of bounds.
//!
//! A [`LeastSquares`] problem, a start and bounds enter; a [`LeastSquaresSolution`] leaves. `identify` calls it, and
//! the profiles too. A point at which the model cannot run counts as a rejected step, not as a failure of the search.
//! Source: K. Madsen, H. B. Nielsen, O. Tingleff, Methods for non-linear least squares problems, 2004, section 3.2.

use nalgebra::{DMatrix, DVector};

/// A problem to minimise: half the sum of squares of the residual.
pub trait LeastSquares {
    /// The residual at a point; `None` where it has no value, as after a failed run.
    fn residual(&mut self, z: &[f64]) -> Option<DVector<f64>>;
    /// The Jacobian at `z`: one row for each entry of `residual`, one column for each variable. `None` where it cannot
    /// be computed.
    fn jacobian(&mut self, z: &[f64], residual: &DVector<f64>) -> Option<DMatrix<f64>>;
    /// How many of the last rows are conditions with much larger weights than data.
    ///
    /// The damping leaves their slopes out, because it would otherwise hold back every step along the conditions.
    fn conditions(&self) -> usize {
        0
    }
}

/// When a search stops. It converges when both `gain` and `step` are undercut.
#[derive(Clone, Copy, Debug)]
pub struct StoppingCriteria {
    /// Largest number of iterations.
    pub iterations: usize,
    /// The expected decrease of the sum of squares, relative to the sum.
    pub gain: f64,
    /// The largest move of a variable.
    pub step: f64,
}

impl Default for StoppingCriteria {
    fn default() -> Self {
        StoppingCriteria { iterations: 50, gain: 1e-7, step: 1e-3 }
    }
}

/// The end of a search.
#[derive(Clone, Debug)]
pub struct LeastSquaresSolution {
    /// The variables.
    pub z: Vec<f64>,
    /// The residual at `z`.
    pub residual: DVector<f64>,
    /// The Jacobian at `z`.
    pub jacobian: DMatrix<f64>,
    /// False when the iterations ran out.
    pub converged: bool,
    /// Number of iterations, rejected steps among them.
    pub iterations: usize,
    /// For each variable, whether it rests at a bound that the gradient pushes it against.
    pub at_bound: Vec<bool>,
}

/// Bounds of the variables, one entry each; infinite where there is none.
#[derive(Clone, Debug)]
pub struct VariableBounds {
    /// Lower bounds.
    pub low: Vec<f64>,
    /// Upper bounds.
    pub high: Vec<f64>,
}

impl VariableBounds {
    /// `z` moved into the bounds of variable `j`.
    fn clamp(&self, j: usize, z: f64) -> f64 {
        z.max(self.low[j]).min(self.high[j])
    }

    /// Whether variable `j` belongs to the active set: it is at a bound, and descent leads beyond the bound.
    fn blocks(&self, j: usize, z: f64, gradient: f64) -> bool {
        (z <= self.low[j] && gradient > 0.0) || (z >= self.high[j] && gradient < 0.0)
    }
}

/// Damping at which steps are too short to change anything.
const HOPELESS: f64 = 1e12;

/// Minimises from `start`, which must lie within the bounds.
///
/// `None` where the residual has no value at the start, or the Jacobian none at an accepted point. The damping follows
/// Nielsen's rule: it falls smoothly with the ratio of actual to expected gain, and grows ever faster at rejected
/// steps.
pub fn minimise(
    problem: &mut dyn LeastSquares,
    start: &[f64],
    bounds: &VariableBounds,
    effort: StoppingCriteria,
) -> Option<LeastSquaresSolution> {
    let mut z = start.to_vec();
    let mut residual = problem.residual(&z)?;
    let mut jacobian = problem.jacobian(&z, &residual)?;
    let mut damping = 1e-3;
    let mut growth = 2.0;
    let (mut converged, mut iterations) = (z.is_empty(), 0);
    while !converged && iterations < effort.iterations && damping < HOPELESS {
        iterations += 1;
        let Some((next, expected, last)) =
            step(&z, &residual, &jacobian, bounds, (damping, problem.conditions()), effort)
        else {
            // The damped normal matrix is not positive definite in floating point.
            damping *= growth;
            growth *= 2.0;
            continue;
        };
        let cost = residual.norm_squared();
        // A step that is expected to gain nothing needs no run.
        let found = if last { None } else { problem.residual(&next) };
        match found {
            Some(better) if better.norm_squared() < cost => {
                // The gain ratio: 1 where the linear model predicts the decrease exactly.
                let ratio = (cost - better.norm_squared()) / expected.max(f64::MIN_POSITIVE);
                damping *= (1.0 - (2.0 * ratio - 1.0).powi(3)).clamp(1.0 / 3.0, 2.0);
                growth = 2.0;
                // The Jacobian is evaluated at accepted points only: it costs many more runs than the residual.
                (z, residual) = (next, better);
                jacobian = problem.jacobian(&z, &residual)?;
            }
            _ if last => converged = true,
            _ => {
                damping *= growth;
                growth *= 2.0;
            }
        }
    }
    // Steps have become so short that nothing improves any more: the numerical noise of the runs is reached.
    converged |= damping >= HOPELESS;
    let gradient = jacobian.tr_mul(&residual);
    let at_bound = (0..z.len()).map(|j| bounds.blocks(j, z[j], gradient[j])).collect();
    Some(LeastSquaresSolution { z, residual, jacobian, converged, iterations, at_bound })
}

/// One damped Gauss-Newton step: the next point, the decrease of the sum of squares that the linear model expects, and
/// whether that decrease and the step are too small to go on.
///
/// `None` when the damped normal matrix cannot be factorised.
fn step(
    z: &[f64],
    residual: &DVector<f64>,
    jacobian: &DMatrix<f64>,
    bounds: &VariableBounds,
    (damping, conditions): (f64, usize),
    effort: StoppingCriteria,
) -> Option<(Vec<f64>, f64, bool)> {
    let gradient = jacobian.tr_mul(residual);
    let mut normal = jacobian.tr_mul(jacobian);
    let mut right = -&gradient;
    // Marquardt's scaling: the damping of a variable is proportional to its diagonal entry of J'J, from the data rows.
    let soft = jacobian.rows(0, jacobian.nrows() - conditions);
    let slopes: Vec<f64> = soft.column_iter().map(|c| c.norm_squared()).collect();
    let usual = slopes.iter().fold(f64::MIN_POSITIVE, |m: f64, s| m.max(*s));
    for j in 0..z.len() {
        // A variable of the active set stands still: its row and column become those of the identity.
        if bounds.blocks(j, z[j], gradient[j]) {
            normal.row_mut(j).fill(0.0);
            normal.column_mut(j).fill(0.0);
            right[j] = 0.0;
            normal[(j, j)] = 1.0;
        } else {
            // The floor keeps the matrix regular where a variable has no influence.
            normal[(j, j)] += damping * slopes[j].max(1e-9 * usual);
        }
    }
    let wanted = normal.cholesky()?.solve(&right);
    // Steps beyond a bound end there, so the expected gain is computed from the clamped move.
    let next: Vec<f64> = z.iter().enumerate().map(|(j, z)| bounds.clamp(j, z + wanted[j])).collect();
    let moved = DVector::from_iterator(z.len(), next.iter().zip(z).map(|(a, b)| a - b));
    // |r|^2 - |r + J s|^2 = -2 g's - |J s|^2 with g = J'r.
    let expected = -2.0 * gradient.dot(&moved) - (jacobian * &moved).norm_squared();
    let little = expected <= effort.gain * residual.norm_squared() && moved.amax() < effort.step;
    Some((next, expected, little || moved.amax() == 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rosenbrock's valley, with a hole where there is no value.
    struct Valley;

    impl LeastSquares for Valley {
        fn residual(&mut self, z: &[f64]) -> Option<DVector<f64>> {
            (z[0] < 2.0).then(|| DVector::from_vec(vec![10.0 * (z[1] - z[0] * z[0]), 1.0 - z[0]]))
        }

        fn jacobian(&mut self, z: &[f64], _: &DVector<f64>) -> Option<DMatrix<f64>> {
            Some(DMatrix::from_row_slice(2, 2, &[-20.0 * z[0], 10.0, -1.0, 0.0]))
        }
    }

    fn bounds(low: f64, high: f64) -> VariableBounds {
        VariableBounds { low: vec![low; 2], high: vec![high; 2] }
    }

    #[test]
    fn finds_the_least_value_and_respects_bounds() {
        let found = minimise(&mut Valley, &[-1.2, 1.0], &bounds(-5.0, 5.0), StoppingCriteria::default()).unwrap();
        assert!(found.converged && (found.z[0] - 1.0).abs() < 1e-4, "{found:?}");
        let found = minimise(&mut Valley, &[-1.2, 0.2], &bounds(-5.0, 0.5), StoppingCriteria::default()).unwrap();
        assert_eq!(found.at_bound, [true, false]);
        assert!(found.converged && found.z[0] == 0.5 && (found.z[1] - 0.25).abs() < 1e-4, "{found:?}");
        assert!(minimise(&mut Valley, &[3.0, 0.0], &bounds(-5.0, 5.0), StoppingCriteria::default()).is_none());
    }
}
