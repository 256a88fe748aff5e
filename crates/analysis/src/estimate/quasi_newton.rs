//! Minimisation of smooth functions of a few variables, with derivatives by finite differences.
//!
//! A function and a start enter; the minimum, gradients or second derivatives leave. `spread` fits its models of errors
//! with it.

use nalgebra::{DMatrix, DVector};

/// Largest number of steps.
const STEPS: usize = 100;
/// The search ends when all slopes are below this.
const FLAT: f64 = 1e-4;

/// Minimises from `start`; differences use `step`. The function may be infinite in places.
///
/// The inverse Hessian is updated by the BFGS formula. Source: J. Nocedal, S. J. Wright, Numerical Optimization, 2006,
/// algorithm 6.1.
pub fn descend(function: &mut dyn FnMut(&[f64]) -> f64, start: &[f64], step: f64) -> Vec<f64> {
    let n = start.len();
    let mut at = DVector::from_column_slice(start);
    let mut value = function(at.as_slice());
    let mut slope = gradient(function, &at, step);
    let mut inverse = DMatrix::identity(n, n);
    for _ in 0..STEPS {
        if slope.amax().is_nan() || slope.amax() < FLAT {
            break;
        }
        let mut along = -(&inverse * &slope);
        if along.dot(&slope) >= 0.0 {
            // Rounding has made the direction one of ascent: start again with steepest descent.
            inverse.fill_with_identity();
            along = -slope.clone();
        }
        // No variable moves by more than 1, because the first Hessian is only a guess.
        along *= (1.0 / along.amax()).min(1.0);
        let Some((next, lower)) = shortened(function, &at, value, &along, along.dot(&slope)) else { break };
        let new = gradient(function, &next, step);
        learn(&mut inverse, &(&next - &at), &(&new - &slope));
        (at, value, slope) = (next, lower, new);
    }
    at.as_slice().to_vec()
}

/// Backtracking line search: the first of ever shorter steps that satisfies Armijo's condition, with its value.
///
/// `fall` is the directional derivative. `None` where no step decreases the function enough.
fn shortened(
    function: &mut dyn FnMut(&[f64]) -> f64,
    at: &DVector<f64>,
    value: f64,
    along: &DVector<f64>,
    fall: f64,
) -> Option<(DVector<f64>, f64)> {
    let mut part = 1.0;
    for _ in 0..30 {
        let next = at + part * along;
        let found = function(next.as_slice());
        if found < value + 1e-4 * part * fall {
            return Some((next, found));
        }
        part *= 0.5;
    }
    None
}

/// The BFGS update of the inverse Hessian from a step and the change of the gradient.
fn learn(inverse: &mut DMatrix<f64>, moved: &DVector<f64>, turned: &DVector<f64>) {
    let product = moved.dot(turned);
    if product.is_nan() || product <= 1e-12 * moved.norm() * turned.norm() {
        // Without positive curvature along the step the matrix would lose its definiteness.
        return;
    }
    let n = moved.len();
    let left = DMatrix::identity(n, n) - moved * turned.transpose() / product;
    *inverse = &left * &*inverse * left.transpose() + moved * moved.transpose() / product;
}

/// The point `at` with variable `j` changed.
fn moved(at: &[f64], j: usize, by: f64) -> Vec<f64> {
    let mut next = at.to_vec();
    next[j] += by;
    next
}

/// The gradient by central differences.
fn gradient(function: &mut dyn FnMut(&[f64]) -> f64, at: &DVector<f64>, step: f64) -> DVector<f64> {
    let one = |j: usize| {
        let (up, down) = (function(&moved(at.as_slice(), j, step)), function(&moved(at.as_slice(), j, -step)));
        (up - down) / (2.0 * step)
    };
    DVector::from_iterator(at.len(), (0..at.len()).map(one))
}

/// The Jacobian of several functions by central differences, one row for each function.
pub fn slopes(functions: &mut dyn FnMut(&[f64]) -> DVector<f64>, at: &[f64], step: f64) -> DMatrix<f64> {
    let columns: Vec<DVector<f64>> = (0..at.len())
        .map(|j| (functions(&moved(at, j, step)) - functions(&moved(at, j, -step))) / (2.0 * step))
        .collect();
    if columns.is_empty() { DMatrix::zeros(functions(at).len(), 0) } else { DMatrix::from_columns(&columns) }
}

/// The Hessian by central differences.
pub fn bend(function: &mut dyn FnMut(&[f64]) -> f64, at: &[f64], step: f64) -> DMatrix<f64> {
    let n = at.len();
    let mut out = DMatrix::zeros(n, n);
    let mut corner = |i: usize, j: usize, a: f64, b: f64| function(&moved(&moved(at, i, a * step), j, b * step));
    for i in 0..n {
        for j in 0..=i {
            let all =
                corner(i, j, 1.0, 1.0) - corner(i, j, 1.0, -1.0) - corner(i, j, -1.0, 1.0) + corner(i, j, -1.0, -1.0);
            out[(i, j)] = all / (4.0 * step * step);
            out[(j, i)] = out[(i, j)];
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curved_valley_with_a_wall() {
        let mut valley = |z: &[f64]| {
            if z[0] > 1.5 { f64::INFINITY } else { 100.0 * (z[1] - z[0] * z[0]).powi(2) + (1.0 - z[0]).powi(2) }
        };
        let found = descend(&mut valley, &[-1.2, 1.0], 1e-5);
        assert!((found[0] - 1.0).abs() < 1e-3 && (found[1] - 1.0).abs() < 2e-3, "{found:?}");
        let curvature = bend(&mut valley, &[1.0, 1.0], 1e-4);
        assert!((curvature[(0, 0)] - 802.0).abs() < 0.1 && (curvature[(0, 1)] + 400.0).abs() < 0.1, "{curvature}");
    }
}
