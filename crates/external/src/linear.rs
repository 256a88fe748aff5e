//! LAPACK's solvers that the Modelica Standard Library calls: `dgesv` for linear equations, `dgelsy` for least squares.
//! They are carried out by the crate `faer`. The arguments are those of the C calls, with matrices row by row.

use super::ExternalValue;
use bramah_expr::function::ExternalFunction;
use faer::Mat;
use faer::linalg::solvers::Solve as _;
use std::sync::Arc;

/// Singular values below this fraction of the largest count as zero if the caller sets no limit.
/// It is a few rounding errors.
const RANK_LIMIT: f64 = 1e-14;

/// `dgesv`: the solution X of A*X = B and then `info`, or a derivative of these.
///
/// The arguments are n, nrhs, A, lda, B and ldb.
/// Outputs are the elements of X row by row, then `info`.
#[derive(Debug, Default)]
pub struct LinearSolve {
    /// The indices of the arguments by which X is differentiated. Empty for X itself.
    by: Vec<usize>,
}

/// The sizes from which the positions of the matrices in the argument list follow.
struct MatrixOffsets {
    /// Rows and columns of A.
    n: usize,
    /// Columns of B.
    columns: usize,
}

impl MatrixOffsets {
    /// The sizes as given by the arguments. `None` if there are fewer arguments than these sizes need.
    fn of(args: &[f64]) -> Option<Self> {
        let places = MatrixOffsets { n: *args.first()? as usize, columns: *args.get(1)? as usize };
        (args.len() >= places.right_side() + places.n * places.columns).then_some(places)
    }

    /// The index of the first element of B: n, nrhs, A and lda stand before it.
    /// The elements of B follow row by row.
    fn right_side(&self) -> usize {
        2 + self.n * self.n + 1
    }

    /// The row and column of an argument that is an element of A. `None` for other arguments.
    fn of_matrix(&self, argument: usize) -> Option<(usize, usize)> {
        let at = argument.checked_sub(2).filter(|at| *at < self.n * self.n)?;
        Some((at / self.n, at % self.n))
    }
}

impl LinearSolve {
    /// The derivative of X by the arguments in `by`, from one factorisation of A.
    /// It solves A*X_S = B_S - sum over i of E_i*X_(S without i), because A and B are linear in their elements.
    /// E_i is 1 at the element of A that argument i stands for.
    /// For several arguments it calls itself with one of them left out.
    fn derivative(
        places: &MatrixOffsets,
        args: &[f64],
        lu: &faer::linalg::solvers::PartialPivLu<f64>,
        by: &[usize],
    ) -> Mat<f64> {
        let (n, first) = (places.n, places.right_side());
        // The derivative of B: B itself without arguments, 1 at the element for one, 0 for several.
        let mut right = Mat::from_fn(n, places.columns, |i, j| {
            let at = first + i * places.columns + j;
            match by {
                [] => args[at],
                [one] if *one == at => 1.0,
                _ => 0.0,
            }
        });
        for (k, &argument) in by.iter().enumerate() {
            // An element of B contributes to the right side only.
            let Some((row, column)) = places.of_matrix(argument) else { continue };
            let rest: Vec<usize> = by.iter().enumerate().filter(|(i, _)| *i != k).map(|(_, a)| *a).collect();
            let inner = Self::derivative(places, args, lu, &rest);
            for j in 0..places.columns {
                right[(row, j)] -= inner[(column, j)];
            }
        }
        lu.solve(&right)
    }
}

impl ExternalFunction for LinearSolve {
    fn value(&self, output: usize, args: &[f64]) -> f64 {
        let Some(places) = MatrixOffsets::of(args) else { return f64::NAN };
        let (n, count) = (places.n, places.n * places.columns);
        let matrix = Mat::from_fn(n, n, |i, j| args[2 + i * n + j]);
        let lu = matrix.partial_piv_lu();
        if output >= count {
            // LAPACK's `info`: the number of the first zero pivot, counted from 1, or 0.
            let upper = lu.U();
            let zero = (0..n).find(|&i| upper[(i, i)] == 0.0).map_or(0.0, |i| i as f64 + 1.0);
            return if self.by.is_empty() { zero } else { 0.0 };
        }
        let found = Self::derivative(&places, args, &lu, &self.by);
        found[(output / places.columns, output % places.columns)]
    }

    fn partial(&self, input: usize) -> Option<Arc<dyn ExternalFunction>> {
        let by = self.by.iter().copied().chain([input]).collect();
        // n and nrhs are sizes, by which nothing can be differentiated.
        (input >= 2).then(|| Arc::new(LinearSolve { by }) as Arc<dyn ExternalFunction>)
    }
}

/// `dgelsy`: the least-squares solution of minimum norm, then `rank` and `info`.
/// The arguments are those of the C call: nrow, ncol, nrhs, A, nrow, B, nx, jpvt, rcond, rank, work, lwork, info.
/// `None` if an argument is not known before the run, or the decomposition fails.
/// Only known values are solved: least squares are evaluated at compile time.
pub fn least_squares(given: &[ExternalValue]) -> Option<Vec<ExternalValue>> {
    let known = |k: usize| match given.get(k)? {
        ExternalValue::Numbers { dims, values } => {
            Some((dims.clone(), values.iter().copied().collect::<Option<Vec<f64>>>()?))
        }
        _ => None,
    };
    let count = |k: usize| known(k)?.1.first().map(|&x| x as usize);
    let (rows, columns, sides) = (count(0)?, count(1)?, count(2)?);
    let (_, a) = known(3)?;
    let (shape, b) = known(5)?;
    let limit = known(8).and_then(|(_, v)| v.first().copied()).unwrap_or(0.0).max(RANK_LIMIT);
    let matrix = Mat::from_fn(rows, columns, |i, j| a[i * columns + j]);
    let right = Mat::from_fn(rows, sides, |i, j| b[i * sides + j]);
    // By singular values, which also give the rank; LAPACK uses a QR factorisation with pivoting.
    let svd = matrix.thin_svd().ok()?;
    let (u, s, v) = (svd.U(), svd.S().column_vector(), svd.V());
    let largest = (0..s.nrows()).map(|k| s[k]).fold(0.0, f64::max);
    let rank = (0..s.nrows()).filter(|&k| s[k] > limit * largest).count();
    // The solution has the shape of B, which may have more rows than the solution; the rest stays 0.
    let mut values = vec![Some(0.0); shape.iter().product()];
    for j in 0..sides {
        for k in 0..rank {
            let along: f64 = (0..rows).map(|i| u[(i, k)] * right[(i, j)]).sum::<f64>() / s[k];
            for i in 0..columns {
                let at = &mut values[i * sides + j];
                *at = at.map(|x| x + v[(i, k)] * along);
            }
        }
    }
    let single = |x: f64| ExternalValue::Numbers { dims: Vec::new(), values: vec![Some(x)] };
    Some(vec![ExternalValue::Numbers { dims: shape, values }, single(rank as f64), single(0.0)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_are_those_of_differences() {
        let args = [2.0, 1.0, 3.0, 1.0, -1.0, 2.0, 2.0, 5.0, 4.0, 2.0];
        let solve = LinearSolve::default();
        assert!((3.0 * solve.value(0, &args) + solve.value(1, &args) - 5.0).abs() < 1e-14);
        assert_eq!(solve.value(2, &args), 0.0);
        for input in [2, 3, 4, 5, 7, 8] {
            let partial = solve.partial(input).expect("depends on it");
            for output in 0..2 {
                let mut moved = [args, args];
                moved[0][input] -= 1e-5;
                moved[1][input] += 1e-5;
                let difference = (solve.value(output, &moved[1]) - solve.value(output, &moved[0])) / 2e-5;
                assert!((partial.value(output, &args) - difference).abs() < 1e-8);
                // and once more by the first element of the matrix
                let second = partial.partial(2).expect("depends on it");
                let mut moved = [args, args];
                moved[0][2] -= 1e-5;
                moved[1][2] += 1e-5;
                let difference = (partial.value(output, &moved[1]) - partial.value(output, &moved[0])) / 2e-5;
                assert!((second.value(output, &args) - difference).abs() < 1e-8);
            }
        }
    }

    #[test]
    fn a_line_through_points() {
        let of = |dims: Vec<usize>, v: &[f64]| ExternalValue::Numbers {
            dims,
            values: v.iter().copied().map(Some).collect(),
        };
        let one = |x: f64| of(Vec::new(), &[x]);
        let nothing = || of(Vec::new(), &[]);
        let a = of(vec![3, 2], &[0.0, 1.0, 1.0, 1.0, 2.0, 1.0]);
        let b = of(vec![3], &[1.0, 3.0, 5.0]);
        let given = [one(3.0), one(2.0), one(1.0), a, one(3.0), b, one(3.0), nothing(), one(0.0)];
        let found = least_squares(&given).expect("all is known");
        let ExternalValue::Numbers { values, .. } = &found[0] else { panic!("numbers") };
        assert!((values[0].unwrap_or(0.0) - 2.0).abs() < 1e-12 && (values[1].unwrap_or(0.0) - 1.0).abs() < 1e-12);
    }
}
