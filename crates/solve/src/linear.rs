//! LU factorisation of the Jacobian behind one type: dense of fixed size for the small, sparse with refactorisation
//! on a recorded pattern for the rest.
//!
//! Rows are weighed by their largest entry when pivots are chosen (units differ by 1e16: Pa and m3/s), with columns in
//! units of their nominal values. The weights only steer the choice; the numbers themselves are not scaled.

mod dense;
mod sparse;

pub use sparse::SparseLu;

use crate::lower::SparsityPattern;

/// No usable pivot was found: the column depends on those before it, or holds values that are not finite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SingularMatrix {
    /// Index of the column, that is of the unknown.
    pub column: usize,
}

/// A factorised square matrix of fixed pattern.
#[derive(Debug)]
pub struct Lu {
    kind: LuKind,
    /// Factors that keep what the equations do not determine; made when they are first needed.
    keeping: Option<Box<SparseLu>>,
    /// Whether the next factorisation makes them.
    may_keep: bool,
    /// Whether the last one did.
    kept: bool,
    /// Factorisations done so far.
    pub factorizations: u64,
    /// Factorisations that searched for pivots.
    pub pivot_searches: u64,
}

#[derive(Debug)]
enum LuKind {
    Empty,
    Dense(Box<dyn dense::DenseFactorization>),
    Sparse(Box<SparseLu>),
}

impl Lu {
    /// Prepares for matrices of this pattern; `column_scale` holds the nominal value of each unknown.
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

    /// Whether, from the next factorisation on, unknowns without a usable pivot keep their value: the solution is 0 there
    /// as long as the right-hand side lets the equations that are left over hold, and not small otherwise.
    pub fn may_keep(&mut self, allowed: bool) {
        self.may_keep = allowed;
    }

    /// Whether the last factorisation left unknowns as they are.
    pub fn keeps(&self) -> bool {
        self.kept && self.keeping.as_ref().is_some_and(|lu| lu.kept() > 0)
    }

    /// Dense pays while the matrix is tiny, or small and well filled (measured: see `benches/`).
    fn prefers_dense(n: usize, nnz: usize) -> bool {
        n <= dense::LARGEST && (n <= 8 || 4 * nnz >= n * n)
    }

    /// Factorises the matrix with these entries.
    ///
    /// # Errors
    /// [`SingularMatrix`] when there is no usable pivot; the factors must not be used then.
    pub fn factor(&mut self, val: &[f64]) -> Result<(), SingularMatrix> {
        self.factorizations += 1;
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

    /// Replaces `b` by the solution; false when it is not finite.
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
    /// Pattern of the matrix and sizes of its unknowns.
    fn shape(&self) -> Option<(&SparsityPattern, &[f64])> {
        match self {
            LuKind::Empty => None,
            LuKind::Dense(lu) => Some(lu.shape()),
            LuKind::Sparse(lu) => Some(lu.shape()),
        }
    }
}

/// `1 / max_j |a_ij| s_j` for each row; 0 for a row without entries.
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
