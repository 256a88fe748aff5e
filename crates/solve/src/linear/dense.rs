//! Dense LU with partial pivoting. The code is instantiated for each size up to 24, so that loop bounds are constants.
//!
//! `Lu` uses it for small matrices. The matrix is stored by columns; L and U overwrite it.

use super::{SingularMatrix, row_weights};
use crate::lower::SparsityPattern;

/// The largest size for which there is code.
pub const LARGEST: usize = 24;

/// A dense factorization of some fixed size.
pub trait DenseFactorization: Send + std::fmt::Debug {
    /// Factorizes the matrix with these entries, in the order of the pattern. `Err` when there is no pivot.
    fn factor(&mut self, val: &[f64]) -> Result<(), SingularMatrix>;
    /// Replaces `b` by the solution; false when the solution is not finite.
    fn solve(&mut self, b: &mut [f64]) -> bool;
    /// Pattern of the matrix and nominal values of its unknowns.
    fn shape(&self) -> (&SparsityPattern, &[f64]);
}

/// A factorization for this pattern; `None` when the matrix is larger than [`LARGEST`].
pub fn new(pattern: &SparsityPattern, column_scale: &[f64]) -> Option<Box<dyn DenseFactorization>> {
    macro_rules! sizes {
        ($($n:literal)*) => {
            match pattern.n { $($n => Some(Box::new(FixedSizeLu::<$n>::new(pattern, column_scale)) as Box<dyn DenseFactorization>),)* _ => None }
        };
    }
    sizes!(1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24)
}

/// The factors of an N x N matrix.
#[derive(Debug)]
struct FixedSizeLu<const N: usize> {
    /// Pattern of the matrix.
    pattern: SparsityPattern,
    /// Nominal value of each unknown.
    column_scale: Vec<f64>,
    /// The factors by columns: L below the diagonal, U on and above it.
    a: [[f64; N]; N],
    /// Reciprocal pivots.
    inverse: [f64; N],
    /// Row of the matrix that became pivot row `i`.
    row: [usize; N],
    /// Row weights, in the present order of rows.
    weights: [f64; N],
}

impl<const N: usize> FixedSizeLu<N> {
    /// Zero factors for a pattern of N columns, with the nominal values of the unknowns.
    fn new(pattern: &SparsityPattern, column_scale: &[f64]) -> Self {
        FixedSizeLu {
            pattern: pattern.clone(),
            column_scale: column_scale.to_vec(),
            a: [[0.0; N]; N],
            inverse: [0.0; N],
            row: [0; N],
            weights: [0.0; N],
        }
    }

    /// Writes the entries into the dense matrix.
    fn load(&mut self, val: &[f64]) {
        self.a = [[0.0; N]; N];
        for j in 0..N {
            for k in self.pattern.colptr[j]..self.pattern.colptr[j + 1] {
                self.a[j][self.pattern.rowidx[k]] += val[k];
            }
        }
    }

    /// The row at or below `j` with the largest weighed entry in column `j`; `None` when there is no usable one.
    fn pivot(&self, j: usize) -> Option<usize> {
        let mut best = (0.0, j);
        for i in j..N {
            let v = self.a[j][i].abs() * self.weights[i];
            // NaN is taken on purpose: the result is then refused as not finite
            if v > best.0 || v.is_nan() {
                best = (v, i);
            }
        }
        (best.0 > 0.0 && best.0.is_finite()).then_some(best.1)
    }

    /// Exchanges two rows with their weights and records the permutation.
    fn swap_rows(&mut self, i: usize, j: usize) {
        if i != j {
            for column in &mut self.a {
                column.swap(i, j);
            }
            self.row.swap(i, j);
            self.weights.swap(i, j);
        }
    }

    /// Divides column `j` below the pivot and updates all columns to its right.
    ///
    /// Multipliers that are zero cost nothing.
    fn eliminate(&mut self, j: usize) {
        let inverse = 1.0 / self.a[j][j];
        self.inverse[j] = inverse;
        for i in j + 1..N {
            self.a[j][i] *= inverse;
        }
        let (left, right) = self.a.split_at_mut(j + 1);
        let l = &left[j];
        for column in right {
            let u = column[j];
            if u != 0.0 {
                for i in j + 1..N {
                    column[i] -= l[i] * u;
                }
            }
        }
    }
}

impl<const N: usize> DenseFactorization for FixedSizeLu<N> {
    // right-looking elimination: pivot, exchange, update of the rest
    fn factor(&mut self, val: &[f64]) -> Result<(), SingularMatrix> {
        self.load(val);
        row_weights(&self.pattern, val, &self.column_scale, &mut self.weights);
        for (i, r) in self.row.iter_mut().enumerate() {
            *r = i;
        }
        for j in 0..N {
            let i = self.pivot(j).ok_or(SingularMatrix { column: j })?;
            self.swap_rows(i, j);
            self.eliminate(j);
            if !self.inverse[j].is_finite() {
                return Err(SingularMatrix { column: j });
            }
        }
        Ok(())
    }

    fn solve(&mut self, b: &mut [f64]) -> bool {
        // forward substitution with L in the pivot order, then back substitution with U
        let mut x = [0.0; N];
        for i in 0..N {
            x[i] = b[self.row[i]];
        }
        for j in 0..N {
            let v = x[j];
            for i in j + 1..N {
                x[i] -= self.a[j][i] * v;
            }
        }
        for j in (0..N).rev() {
            let v = x[j] * self.inverse[j];
            x[j] = v;
            for i in 0..j {
                x[i] -= self.a[j][i] * v;
            }
        }
        b[..N].copy_from_slice(&x);
        x.iter().all(|v| v.is_finite())
    }

    fn shape(&self) -> (&SparsityPattern, &[f64]) {
        (&self.pattern, &self.column_scale)
    }
}
