//! Sparse LU by Gilbert and Peierls, with refactorization on a recorded pattern.
//!
//! The first factorization searches pivots and records the patterns of L and U. Later factorizations repeat only the
//! arithmetic, as long as the recorded pivots are good enough; otherwise pivots are searched again. Columns are ordered
//! by COLAMD. Source: J. R. Gilbert, T. Peierls, SIAM J. Sci. Stat. Comput. 9 (1988) 862; the idea of refactorization
//! is that of KLU (T. A. Davis, E. Palamadai Natarajan, ACM TOMS 37 (2010) 36).

use super::{SingularMatrix, row_weights};
use crate::lower::SparsityPattern;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::colamd;

/// No row or position.
const NONE: u32 = u32::MAX;
/// The diagonal entry is chosen as pivot while it is at least this part of the best one. This keeps the fill low.
const DIAGONAL_PREFERENCE: f64 = 1e-3;
/// A multiplier above this, in weighed rows, makes a recorded pivot unusable.
const LARGEST_MULTIPLIER: f64 = 1e6;
/// A pivot below this part of the largest entry of its row is rounding error of a dependent column.
const DEPENDENT: f64 = 1e-12;

/// Sparse LU factors of an n x n matrix, with a column order that is fixed except for kept columns.
#[derive(Debug)]
pub struct SparseLu {
    /// Pattern of the matrix.
    pattern: SparsityPattern,
    /// Nominal value of each unknown, by column.
    column_scale: Vec<f64>,
    /// Column of the matrix at each position of the elimination.
    order: Vec<u32>,
    /// Position at which each row is the pivot row; `NONE` while it is not chosen.
    position: Vec<u32>,
    /// Pivot row at each position.
    pivot_row: Vec<u32>,
    /// L without its unit diagonal. Indices are rows during the pivot search, positions afterwards.
    lower: SparseFactor,
    /// U without its diagonal. Indices are positions.
    upper: SparseFactor,
    /// Reciprocal pivots by position.
    inverse: Vec<f64>,
    /// For each position, where its matrix entries begin in `load_row` and `load_from`; n + 1 entries.
    load_ptr: Vec<u32>,
    /// Position of the row of each matrix entry.
    load_row: Vec<u32>,
    /// Index of each matrix entry in the array of values.
    load_from: Vec<u32>,
    /// Row weights: by row while pivots are searched, by position afterwards.
    weights: Vec<f64>,
    /// The dense column in work. All zero between columns.
    x: Vec<f64>,
    /// The right-hand side in work.
    work: Vec<f64>,
    /// Workspace of the depth-first search.
    search: DepthFirstScratch,
    /// Whether recorded pivots exist.
    ready: bool,
    /// Whether columns without a usable pivot are kept instead of failing.
    keeping: bool,
    /// Number of kept columns. They are the last ones in `order`.
    kept: usize,
}

/// The columns of one factor, compressed.
#[derive(Debug, Default)]
struct SparseFactor {
    /// Start of each column in `idx` and `val`, and the end of the last one.
    ptr: Vec<u32>,
    /// Row or position of each entry.
    idx: Vec<u32>,
    /// Value of each entry.
    val: Vec<f64>,
}

impl SparseFactor {
    /// Removes all columns.
    fn clear(&mut self) {
        self.ptr.clear();
        self.ptr.push(0);
        self.idx.clear();
        self.val.clear();
    }

    /// Adds an entry to the open column.
    fn push(&mut self, index: u32, value: f64) {
        self.idx.push(index);
        self.val.push(value);
    }

    /// Ends the open column.
    fn close_column(&mut self) {
        self.ptr.push(count(self.idx.len()));
    }

    /// The entries of column `j`.
    fn range(&self, j: usize) -> std::ops::Range<usize> {
        self.ptr[j] as usize..self.ptr[j + 1] as usize
    }
}

/// Workspace of the depth-first search that finds the pattern of a column.
#[derive(Debug, Default)]
struct DepthFirstScratch {
    /// For each row the position of the column that visited it last.
    mark: Vec<u32>,
    /// Rows on the path, each with the number of entries visited in its L column.
    stack: Vec<(u32, u32)>,
    /// Positions whose L columns update the current column, in post-order.
    updates: Vec<u32>,
    /// Rows of the column that are not pivot rows yet.
    rows: Vec<u32>,
}

/// A size as `u32`, which halves the memory of the indices.
fn count(n: usize) -> u32 {
    u32::try_from(n).expect("fewer than 2^32 entries")
}

impl SparseLu {
    /// Orders the columns. The first factorization searches the pivots.
    pub fn new(pattern: &SparsityPattern, column_scale: &[f64]) -> Self {
        let n = pattern.n;
        SparseLu {
            order: column_order(pattern),
            pattern: pattern.clone(),
            column_scale: column_scale.to_vec(),
            position: vec![NONE; n],
            pivot_row: vec![0; n],
            lower: SparseFactor::default(),
            upper: SparseFactor::default(),
            inverse: vec![0.0; n],
            load_ptr: Vec::new(),
            load_row: Vec::new(),
            load_from: Vec::new(),
            weights: vec![0.0; n],
            x: vec![0.0; n],
            work: vec![0.0; n],
            search: DepthFirstScratch::default(),
            ready: false,
            keeping: false,
            kept: 0,
        }
    }

    /// As [`SparseLu::new`], but a column without a usable pivot gets an artificial one.
    ///
    /// The pivot has the size of a row that no other column needed. As long as that row holds, the unknown stays as it
    /// is.
    pub fn keeping(pattern: &SparsityPattern, column_scale: &[f64]) -> Self {
        SparseLu { keeping: true, ..Self::new(pattern, column_scale) }
    }

    /// Pattern of the matrix and nominal values of its unknowns.
    pub fn shape(&self) -> (&SparsityPattern, &[f64]) {
        (&self.pattern, &self.column_scale)
    }

    /// Number of unknowns that the last factorization keeps.
    pub fn kept(&self) -> usize {
        self.kept
    }

    /// Number of entries of both factors, diagonals counted once.
    pub fn nnz(&self) -> usize {
        self.lower.idx.len() + self.upper.idx.len() + self.pattern.n
    }

    /// Factorizes the matrix with these entries; true when pivots were searched.
    ///
    /// # Errors
    /// [`SingularMatrix`] when there is no usable pivot.
    pub fn factor(&mut self, val: &[f64]) -> Result<bool, SingularMatrix> {
        if self.ready && self.refactor(val) {
            return Ok(false);
        }
        self.ready = false;
        // a refactorization that stopped midway may have left entries in the column
        self.x.fill(0.0);
        self.kept = 0;
        // each failure names one dependent column: it moves to the end, and the search begins again
        while let Err(singular) = self.search_pivots(val) {
            if !self.keeping || self.kept == self.pattern.n || !val.iter().all(|v| v.is_finite()) {
                return Err(singular);
            }
            self.postpone(singular.column);
        }
        self.ready = true;
        Ok(true)
    }

    /// Moves a column to the end of the order, where the kept columns stand.
    fn postpone(&mut self, column: usize) {
        let at = self.order.iter().position(|&c| c as usize == column).expect("a column of the matrix");
        self.order[at..].rotate_left(1);
        self.kept += 1;
    }

    /// The first factorization: finds pattern and pivots column by column.
    fn search_pivots(&mut self, val: &[f64]) -> Result<(), SingularMatrix> {
        let n = self.pattern.n;
        row_weights(&self.pattern, val, &self.column_scale, &mut self.weights);
        self.position.fill(NONE);
        self.lower.clear();
        self.upper.clear();
        self.search.mark.clear();
        self.search.mark.resize(n, NONE);
        for j in 0..n {
            // symbolic step, numeric step, pivot: the left-looking algorithm
            self.reach(j);
            self.update_column(j, val);
            self.choose_pivot(j)?;
        }
        self.renumber();
        Ok(())
    }

    /// Finds which earlier columns update column `j` and which rows it fills.
    ///
    /// These are the nodes that can be reached from the entries of the column in the graph of L. The effort is
    /// proportional to the number of operations, not to n.
    fn reach(&mut self, j: usize) {
        let column = self.order[j] as usize;
        let (s, mark) = (&mut self.search, count(j));
        s.updates.clear();
        s.rows.clear();
        for p in self.pattern.colptr[column]..self.pattern.colptr[column + 1] {
            let row = count(self.pattern.rowidx[p]);
            if s.mark[row as usize] != mark {
                s.mark[row as usize] = mark;
                s.stack.push((row, 0));
                s.descend(mark, &self.position, &self.lower);
            }
        }
    }

    /// Computes column `j` of U, and the rest of the column for L, in the dense vector `x`.
    ///
    /// It subtracts each earlier column of L that reaches this one, times the entry of U.
    fn update_column(&mut self, j: usize, val: &[f64]) {
        let column = self.order[j] as usize;
        for p in self.pattern.colptr[column]..self.pattern.colptr[column + 1] {
            self.x[self.pattern.rowidx[p]] += val[p];
        }
        // reverse post-order is a topological order of the updates
        for &k in self.search.updates.iter().rev() {
            let u = std::mem::take(&mut self.x[self.pivot_row[k as usize] as usize]);
            self.upper.push(k, u);
            for t in self.lower.range(k as usize) {
                self.x[self.lower.idx[t] as usize] -= self.lower.val[t] * u;
            }
        }
        self.upper.close_column();
    }

    /// Chooses the pivot of column `j` and divides the rest of the column by it.
    fn choose_pivot(&mut self, j: usize) -> Result<(), SingularMatrix> {
        if j >= self.pattern.n - self.kept {
            self.keep(j);
            return Ok(());
        }
        let column = self.order[j];
        let row = self.best_row(column).ok_or_else(|| self.give_up(column))?;
        let pivot = self.x[row as usize];
        self.inverse[j] = 1.0 / pivot;
        self.position[row as usize] = count(j);
        self.pivot_row[j] = row;
        for &r in &self.search.rows {
            // taking the values leaves the dense column zero for the next one
            let v = std::mem::take(&mut self.x[r as usize]);
            if r != row {
                self.lower.push(r, v / pivot);
            }
        }
        self.lower.close_column();
        if self.inverse[j].is_finite() { Ok(()) } else { Err(self.give_up(column)) }
    }

    /// Gives a kept column an artificial pivot, in a row that no other column needed.
    fn keep(&mut self, j: usize) {
        let row = self.position.iter().position(|&p| p == NONE).expect("as many rows as columns");
        for &r in &self.search.rows {
            self.x[r as usize] = 0.0;
        }
        self.inverse[j] = self.inverse_of_kept(j, self.weights[row]);
        self.position[row] = count(j);
        self.pivot_row[j] = count(row);
        self.lower.close_column();
    }

    /// The reciprocal of an artificial pivot, which is 1 in units of its row and column.
    fn inverse_of_kept(&self, j: usize, row_weight: f64) -> f64 {
        let weight = if row_weight > 0.0 { row_weight } else { 1.0 };
        weight * self.column_scale[self.order[j] as usize]
    }

    /// The pivot row of a column: the diagonal where it is large enough, else the largest weighed entry.
    ///
    /// Row `column` counts as the diagonal. `None` when no entry is usable, or when one is NaN.
    fn best_row(&self, column: u32) -> Option<u32> {
        let weighed = |r: u32| self.x[r as usize].abs() * self.weights[r as usize];
        let mut best = (0.0, NONE);
        for &r in &self.search.rows {
            let v = weighed(r);
            if v.is_nan() {
                return None;
            }
            if v > best.0 {
                best = (v, r);
            }
        }
        let least = if self.keeping { DEPENDENT / self.column_scale[column as usize] } else { 0.0 };
        if !(best.0 > least && best.0.is_finite()) {
            return None;
        }
        let diagonal = self.search.rows.contains(&column) && weighed(column) >= DIAGONAL_PREFERENCE * best.0;
        Some(if diagonal { column } else { best.1 })
    }

    /// Clears the dense column and names the column without a pivot.
    fn give_up(&mut self, column: u32) -> SingularMatrix {
        self.x.fill(0.0);
        SingularMatrix { column: column as usize }
    }

    /// Replaces rows by positions, so that refactorization and solution need no permutation inside.
    fn renumber(&mut self) {
        for r in &mut self.lower.idx {
            *r = self.position[*r as usize];
        }
        self.work.copy_from_slice(&self.weights);
        for (j, &row) in self.pivot_row.iter().enumerate() {
            self.weights[j] = self.work[row as usize];
        }
        self.load_ptr.clear();
        self.load_ptr.push(0);
        self.load_row.clear();
        self.load_from.clear();
        for &column in &self.order {
            for p in self.pattern.colptr[column as usize]..self.pattern.colptr[column as usize + 1] {
                self.load_row.push(self.position[self.pattern.rowidx[p]]);
                self.load_from.push(count(p));
            }
            self.load_ptr.push(count(self.load_row.len()));
        }
    }

    /// Repeats the arithmetic with the recorded pivots and pattern.
    ///
    /// False when a pivot is no longer usable; the factors are then incomplete, and pivots must be searched again.
    fn refactor(&mut self, val: &[f64]) -> bool {
        for j in 0..self.pattern.n {
            for p in self.load_ptr[j] as usize..self.load_ptr[j + 1] as usize {
                self.x[self.load_row[p] as usize] += val[self.load_from[p] as usize];
            }
            // the stored order of U is the topological order of the pivot search
            for t in self.upper.range(j) {
                let k = self.upper.idx[t] as usize;
                let u = std::mem::take(&mut self.x[k]);
                self.upper.val[t] = u;
                let range = self.lower.range(k);
                for (&i, &l) in self.lower.idx[range.clone()].iter().zip(&self.lower.val[range]) {
                    self.x[i as usize] -= l * u;
                }
            }
            if !self.divide(j) {
                return false;
            }
        }
        true
    }

    /// Divides column `j` by its recorded pivot.
    ///
    /// False when the pivot is too small against the rest of its column, or when a kept column has become independent.
    fn divide(&mut self, j: usize) -> bool {
        let pivot = std::mem::take(&mut self.x[j]);
        let scale = self.column_scale[self.order[j] as usize];
        if j >= self.pattern.n - self.kept {
            self.inverse[j] = self.inverse_of_kept(j, self.weights[j]);
            // a kept column must still be dependent: only rounding error may be left in the remaining rows
            let rests = |v: f64, w: f64| v == 0.0 || (w > 0.0 && v.abs() * w * scale <= DEPENDENT);
            let open =
                rests(pivot, self.weights[j]) && self.x[j..].iter().zip(&self.weights[j..]).all(|(&v, &w)| rests(v, w));
            self.x[j..].fill(0.0);
            return open;
        }
        let inverse = 1.0 / pivot;
        // a large multiplier means loss of accuracy, so the pivots are searched again
        let bound = LARGEST_MULTIPLIER * pivot.abs() * self.weights[j];
        let mut largest = 0.0_f64;
        for t in self.lower.range(j) {
            let i = self.lower.idx[t] as usize;
            let v = std::mem::take(&mut self.x[i]);
            largest = largest.max(v.abs() * self.weights[i]);
            self.lower.val[t] = v * inverse;
        }
        self.inverse[j] = inverse;
        let least = if self.keeping { DEPENDENT } else { 0.0 };
        inverse.is_finite() && largest <= bound && pivot.abs() * self.weights[j] * scale >= least
    }

    /// Replaces `b` by the solution of A x = b; false when the solution is not finite.
    ///
    /// `b` is indexed by rows on entry and by columns on return.
    pub fn solve(&mut self, b: &mut [f64]) -> bool {
        let (n, w) = (self.pattern.n, &mut self.work);
        for j in 0..n {
            // row permutation
            w[j] = b[self.pivot_row[j] as usize];
        }
        for j in 0..n {
            let v = w[j];
            // a zero in the right-hand side needs no column of L
            if v != 0.0 {
                let range = self.lower.range(j);
                for (&i, &l) in self.lower.idx[range.clone()].iter().zip(&self.lower.val[range]) {
                    w[i as usize] -= l * v;
                }
            }
        }
        let mut finite = true;
        // U is stored by columns, so the substitution goes column by column from the last one
        for j in (0..n).rev() {
            let v = w[j] * self.inverse[j];
            finite &= v.is_finite();
            let range = self.upper.range(j);
            for (&i, &u) in self.upper.idx[range.clone()].iter().zip(&self.upper.val[range]) {
                w[i as usize] -= u * v;
            }
            b[self.order[j] as usize] = v;
        }
        finite
    }
}

impl DepthFirstScratch {
    /// Visits the columns of L that can be reached from the row on the stack, without recursion.
    fn descend(&mut self, mark: u32, position: &[u32], lower: &SparseFactor) {
        while let Some((row, next)) = self.stack.last_mut() {
            let at = position[*row as usize];
            // not a pivot row yet: the search ends here, and the row is a candidate for the pivot
            if at == NONE {
                self.rows.push(*row);
                self.stack.pop();
                continue;
            }
            let range = lower.range(at as usize);
            let mut found = None;
            while range.start + (*next as usize) < range.end {
                let r = lower.idx[range.start + *next as usize];
                *next += 1;
                if self.mark[r as usize] != mark {
                    self.mark[r as usize] = mark;
                    found = Some(r);
                    break;
                }
            }
            match found {
                Some(r) => self.stack.push((r, 0)),
                None => {
                    self.updates.push(at);
                    self.stack.pop();
                }
            }
        }
    }
}

/// The column order of COLAMD (from `faer`), or the given order should that fail.
fn column_order(pattern: &SparsityPattern) -> Vec<u32> {
    let n = pattern.n;
    let matrix = SymbolicSparseColMatRef::new_unsorted_checked(n, n, &pattern.colptr, None, &pattern.rowidx);
    let (mut forward, mut inverse) = (vec![0usize; n], vec![0usize; n]);
    let mut memory = MemBuffer::new(colamd::order_scratch::<usize>(n, n, pattern.nnz()));
    let stack = MemStack::new(&mut memory);
    match colamd::order(&mut forward, &mut inverse, matrix, colamd::Control::default(), stack) {
        Ok(()) => forward.into_iter().map(count).collect(),
        Err(_) => (0..count(n)).collect(),
    }
}
