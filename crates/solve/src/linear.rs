//! LU factorization of sparse Jacobians behind one type.
//!
//! Small or well filled matrices use dense code of fixed size (`dense`), all others the sparse code with a recorded
//! pivot order (`sparse`). Rows are weighed by their largest entry when pivots are chosen, with columns in units of
//! their nominal values, because units differ by 1e16 (Pa and m3/s). The weights influence only the choice of pivots;
//! the numbers are not scaled. IDA, Newton, the algebraic solver and the sensitivities use this module.

mod dense;
mod sparse;

pub use sparse::SparseLu;

use crate::lower::SparsityPattern;

/// No usable pivot was found: the column depends on those before it, or holds values that are not finite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SingularMatrix {
    /// Index of the column, which is that of the unknown.
    pub column: usize,
}

/// LU factors of a square matrix of fixed pattern.
#[derive(Debug)]
pub struct Lu {
    /// The factorization chosen for the size of the matrix.
    kind: LuKind,
    /// Factors that keep unknowns which the equations do not determine. Made when they are first needed.
    keeping: Option<Box<SparseLu>>,
    /// Whether the next factorization uses `keeping`.
    may_keep: bool,
    /// Whether the last factorization used it.
    kept: bool,
    /// Number of factorizations so far.
    pub factorizations: u64,
    /// Number of factorizations that searched for pivots.
    pub pivot_searches: u64,
}

/// The factorization by size.
#[derive(Debug)]
enum LuKind {
    /// A matrix without rows, as of a system without unknowns.
    Empty,
    /// Dense code for one fixed size.
    Dense(Box<dyn dense::DenseFactorization>),
    /// Sparse code with a recorded pattern of the factors.
    Sparse(Box<SparseLu>),
}

impl Lu {
    /// Prepares for matrices of this pattern. `column_scale` holds the nominal value of each unknown.
    pub fn new(pattern: &SparsityPattern, column_scale: &[f64]) -> Self {
        let kind = match pattern.n {
            0 => LuKind::Empty,
            n if Self::prefers_dense(n, pattern.nnz()) => {
                LuKind::Dense(dense::new(pattern, column_scale).expect("prefers_dense knows the sizes"))
            }
            _ => LuKind::Sparse(Box::new(SparseLu::new(pattern, column_scale))),
        };
        Lu { kind, keeping: None, may_keep: false, kept: false, factorizations: 0, pivot_searches: 0 }
    }

    /// Sets whether unknowns without a usable pivot keep their value, from the next factorization on.
    ///
    /// The solution is 0 for them as long as the right-hand side satisfies the equations that are left over. Otherwise
    /// it is not small, so that an iteration which waits for small corrections does not end.
    pub fn may_keep(&mut self, allowed: bool) {
        self.may_keep = allowed;
    }

    /// Whether the last factorization left unknowns without a pivot.
    pub fn keeps(&self) -> bool {
        self.kept && self.keeping.as_ref().is_some_and(|lu| lu.kept() > 0)
    }

    /// Whether dense code is faster: the matrix is tiny, or small with at least a quarter of the entries.
    ///
    /// The limits are measured, see `benches/`.
    fn prefers_dense(n: usize, nnz: usize) -> bool {
        n <= dense::LARGEST && (n <= 8 || 4 * nnz >= n * n)
    }

    /// Factorizes the matrix with these entries, in the order of the pattern.
    ///
    /// # Errors
    /// [`SingularMatrix`] when there is no usable pivot. The factors must not be used then.
    pub fn factor(&mut self, val: &[f64]) -> Result<(), SingularMatrix> {
        self.factorizations += 1;
        // `solve` must use the same factors as this factorization
        self.kept = self.may_keep;
        if self.kept {
            if self.keeping.is_none() {
                self.keeping = self.kind.shape().map(|(pattern, scale)| Box::new(SparseLu::keeping(pattern, scale)));
            }
            if let Some(lu) = &mut self.keeping {
                self.pivot_searches += u64::from(lu.factor(val)?);
            }
            return Ok(());
        }
        match &mut self.kind {
            LuKind::Empty => Ok(()),
            // dense code searches pivots every time, which costs little
            LuKind::Dense(lu) => {
                self.pivot_searches += 1;
                lu.factor(val)
            }
            LuKind::Sparse(lu) => {
                let searched = lu.factor(val)?;
                self.pivot_searches += u64::from(searched);
                Ok(())
            }
        }
    }

    /// Replaces `b` by the solution; false when the solution is not finite.
    pub fn solve(&mut self, b: &mut [f64]) -> bool {
        if let (true, Some(keeping)) = (self.kept, &mut self.keeping) {
            return keeping.solve(b);
        }
        match &mut self.kind {
            LuKind::Empty => true,
            LuKind::Dense(lu) => lu.solve(b),
            LuKind::Sparse(lu) => lu.solve(b),
        }
    }
}

impl LuKind {
    /// Pattern of the matrix and nominal values of its unknowns; `None` for the empty matrix.
    fn shape(&self) -> Option<(&SparsityPattern, &[f64])> {
        match self {
            LuKind::Empty => None,
            LuKind::Dense(lu) => Some(lu.shape()),
            LuKind::Sparse(lu) => Some(lu.shape()),
        }
    }
}

/// Writes `1 / max_j |a_ij| s_j` for each row i, with the column scales s; 0 for a row without entries.
fn row_weights(pattern: &SparsityPattern, val: &[f64], column_scale: &[f64], weights: &mut [f64]) {
    weights.fill(0.0);
    for j in 0..pattern.n {
        for k in pattern.colptr[j]..pattern.colptr[j + 1] {
            let w = &mut weights[pattern.rowidx[k]];
            *w = w.max(val[k].abs() * column_scale[j]);
        }
    }
    for w in weights {
        *w = if *w > 0.0 && w.is_finite() { 1.0 / *w } else { 0.0 };
    }
}

#[cfg(test)]
mod tests;
