//! Nonlinear least squares within bounds: Levenberg-Marquardt with an active set. A point without a value is a rejected
//! step, not a failure.

use nalgebra::{DMatrix, DVector};

/// What is minimised: half the sum of squares of the residual.
pub trait LeastSquares {
    /// The residual at a point; `None` where there is none, as after a failed run.
    fn residual(&mut self, z: &[f64]) -> Option<DVector<f64>>;
    /// Its derivatives there, one column a variable.
    fn jacobian(&mut self, z: &[f64], residual: &DVector<f64>) -> Option<DMatrix<f64>>;
    /// How many of the last rows are conditions, weighed much more than data: damping by their slopes as well would hold
    /// back every step along them.
    fn conditions(&self) -> usize {
        0
    }
}

/// When to stop.
#[derive(Clone, Copy, Debug)]
pub struct StoppingCriteria {
    /// Most iterations.
    pub iterations: usize,
    /// The sum of squares counts as least when it is expected to fall by less than this part.
    pub gain: f64,
    /// And no variable moves by more than this.
    pub step: f64,
}

impl Default for StoppingCriteria {
    fn default() -> Self {
        StoppingCriteria { iterations: 50, gain: 1e-7, step: 1e-3 }
    }
}

/// Where the search ended.
#[derive(Clone, Debug)]
pub struct LeastSquaresSolution {
    /// The variables.
    pub z: Vec<f64>,
    /// The residual there.
    pub residual: DVector<f64>,
    /// The derivatives there.
    pub jacobian: DMatrix<f64>,
    /// False where the iterations ran out.
    pub converged: bool,
    /// Steps taken.
    pub iterations: usize,
    /// Per variable whether it rests at a bound.
    pub at_bound: Vec<bool>,
}

/// Bounds of the variables; infinite for none.
#[derive(Clone, Debug)]
pub struct VariableBounds {
    /// Lower ones.
    pub low: Vec<f64>,
    /// Upper ones.
    pub high: Vec<f64>,
}

impl VariableBounds {
    fn clamp(&self, j: usize, z: f64) -> f64 {
        z.max(self.low[j]).min(self.high[j])
    }

    /// At a bound, and downhill lies beyond it.
    fn blocks(&self, j: usize, z: f64, gradient: f64) -> bool {
        (z <= self.low[j] && gradient > 0.0) || (z >= self.high[j] && gradient < 0.0)
    }
}

/// Damping beyond which no step is short enough.
const HOPELESS: f64 = 1e12;

/// Minimises from `start`, which must lie within the bounds. `None` where there is no value at the start.
///
/// Source: K. Madsen, H. B. Nielsen, O. Tingleff, Methods for non-linear least squares problems, 2004, section 3.2.
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
            damping *= growth;
            growth *= 2.0;
            continue;
        };
        let cost = residual.norm_squared();
        let found = if last { None } else { problem.residual(&next) };
        match found {
            Some(better) if better.norm_squared() < cost => {
                let ratio = (cost - better.norm_squared()) / expected.max(f64::MIN_POSITIVE);
                damping *= (1.0 - (2.0 * ratio - 1.0).powi(3)).clamp(1.0 / 3.0, 2.0);
                growth = 2.0;
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
    // Steps so short that nothing improves any more: the noise of the runs is reached.
    converged |= damping >= HOPELESS;
    let gradient = jacobian.tr_mul(&residual);
    let at_bound = (0..z.len()).map(|j| bounds.blocks(j, z[j], gradient[j])).collect();
    Some(LeastSquaresSolution { z, residual, jacobian, converged, iterations, at_bound })
}

/// The next point, how much the sum of squares should fall, and whether that is too little to go on.
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
    let soft = jacobian.rows(0, jacobian.nrows() - conditions);
    let slopes: Vec<f64> = soft.column_iter().map(|c| c.norm_squared()).collect();
    let usual = slopes.iter().fold(f64::MIN_POSITIVE, |m: f64, s| m.max(*s));
    for j in 0..z.len() {
        if bounds.blocks(j, z[j], gradient[j]) {
            normal.row_mut(j).fill(0.0);
            normal.column_mut(j).fill(0.0);
            right[j] = 0.0;
            normal[(j, j)] = 1.0;
        } else {
            normal[(j, j)] += damping * slopes[j].max(1e-9 * usual);
        }
    }
    let wanted = normal.cholesky()?.solve(&right);
    let next: Vec<f64> = z.iter().enumerate().map(|(j, z)| bounds.clamp(j, z + wanted[j])).collect();
    let moved = DVector::from_iterator(z.len(), next.iter().zip(z).map(|(a, b)| a - b));
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
