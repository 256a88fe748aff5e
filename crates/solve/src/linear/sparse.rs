//! Sparse LU after Gilbert and Peierls: the first factorisation chooses pivots and records the patterns of L and U,
//! later ones only redo the arithmetic, as long as the pivots stay good.

use super::{SingularMatrix, row_weights};
use crate::lower::SparsityPattern;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::colamd;

const NONE: u32 = u32::MAX;
/// The diagonal entry is taken while it is not smaller than this part of the best one: it keeps the fill low.
const DIAGONAL_PREFERENCE: f64 = 1e-3;
/// A multiplier beyond this (in weighed rows) means that the recorded pivots have gone bad.
const LARGEST_MULTIPLIER: f64 = 1e6;
/// A pivot below this part of the largest entry of its row is what rounding has left of a column that depends on others.
const DEPENDENT: f64 = 1e-12;

/// Sparse LU factors with a fixed column order and pivots that change only when they must.
#[derive(Debug)]
pub struct SparseLu {
    pattern: SparsityPattern,
    column_scale: Vec<f64>,
    /// Column of the matrix at each position of the elimination.
    order: Vec<u32>,
    /// Position at which each row is pivot row.
    position: Vec<u32>,
    /// Pivot row at each position.
    pivot_row: Vec<u32>,
    lower: SparseFactor,
    upper: SparseFactor,
    inverse: Vec<f64>,
    /// The matrix entries in elimination order: position of the row, and index into the values.
    load_ptr: Vec<u32>,
    load_row: Vec<u32>,
    load_from: Vec<u32>,
    /// Row weights, by row while pivots are searched, then by position.
    weights: Vec<f64>,
    x: Vec<f64>,
    work: Vec<f64>,
    search: DepthFirstScratch,
    ready: bool,
    /// Whether columns without a usable pivot are kept.
    keeping: bool,
    /// How many are, the last ones in `order`.
    kept: usize,
}

/// Columns of L (without the unit diagonal) or U (without the diagonal).
#[derive(Debug, Default)]
struct SparseFactor {
    ptr: Vec<u32>,
    idx: Vec<u32>,
    val: Vec<f64>,
}

impl SparseFactor {
    fn clear(&mut self) {
        self.ptr.clear();
        self.ptr.push(0);
        self.idx.clear();
        self.val.clear();
    }

    fn push(&mut self, index: u32, value: f64) {
        self.idx.push(index);
        self.val.push(value);
    }

    fn close_column(&mut self) {
        self.ptr.push(count(self.idx.len()));
    }

    fn range(&self, j: usize) -> std::ops::Range<usize> {
        self.ptr[j] as usize..self.ptr[j + 1] as usize
    }
}

/// Scratch space of the depth-first search.
#[derive(Debug, Default)]
struct DepthFirstScratch {
    mark: Vec<u32>,
    stack: Vec<(u32, u32)>,
    /// Positions whose L columns update the current column, in post-order.
    updates: Vec<u32>,
    /// Rows that may become pivot.
    rows: Vec<u32>,
}

fn count(n: usize) -> u32 {
    u32::try_from(n).expect("fewer than 2^32 entries")
}

impl SparseLu {
    /// Orders the columns; the first factorisation chooses the pivots.
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

    /// The same, where a column without a usable pivot gets one of the size of a row that is left over: as long as that
    /// row holds, its unknown stays as it is.
    pub fn keeping(pattern: &SparsityPattern, column_scale: &[f64]) -> Self {
        SparseLu { keeping: true, ..Self::new(pattern, column_scale) }
    }

    /// Pattern of the matrix and sizes of its unknowns.
    pub fn shape(&self) -> (&SparsityPattern, &[f64]) {
        (&self.pattern, &self.column_scale)
    }

    /// How many unknowns the last factorisation keeps.
    pub fn kept(&self) -> usize {
        self.kept
    }

    /// Entries of both factors.
    pub fn nnz(&self) -> usize {
        self.lower.idx.len() + self.upper.idx.len() + self.pattern.n
    }

    /// Factorises; true when pivots were searched for.
    ///
    /// # Errors
    /// [`SingularMatrix`] when there is no usable pivot.
    pub fn factor(&mut self, val: &[f64]) -> Result<bool, SingularMatrix> {
        if self.ready && self.refactor(val) {
            return Ok(false);
        }
        self.ready = false;
        self.x.fill(0.0);
        self.kept = 0;
        while let Err(singular) = self.search_pivots(val) {
            if !self.keeping || self.kept == self.pattern.n || !val.iter().all(|v| v.is_finite()) {
                return Err(singular);
            }
            self.postpone(singular.column);
        }
        self.ready = true;
        Ok(true)
    }

    /// Moves a column behind all others, among those that are kept.
    fn postpone(&mut self, column: usize) {
        let at = self.order.iter().position(|&c| c as usize == column).expect("a column of the matrix");
        self.order[at..].rotate_left(1);
        self.kept += 1;
    }

    fn search_pivots(&mut self, val: &[f64]) -> Result<(), SingularMatrix> {
        let n = self.pattern.n;
        row_weights(&self.pattern, val, &self.column_scale, &mut self.weights);
        self.position.fill(NONE);
        self.lower.clear();
        self.upper.clear();
        self.search.mark.clear();
        self.search.mark.resize(n, NONE);
        for j in 0..n {
            self.reach(j);
            self.update_column(j, val);
            self.choose_pivot(j)?;
        }
        self.renumber();
        Ok(())
    }

    /// Finds which earlier columns update column `j` and which rows it fills.
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

    fn update_column(&mut self, j: usize, val: &[f64]) {
        let column = self.order[j] as usize;
        for p in self.pattern.colptr[column]..self.pattern.colptr[column + 1] {
            self.x[self.pattern.rowidx[p]] += val[p];
        }
        for &k in self.search.updates.iter().rev() {
            let u = std::mem::take(&mut self.x[self.pivot_row[k as usize] as usize]);
            self.upper.push(k, u);
            for t in self.lower.range(k as usize) {
                self.x[self.lower.idx[t] as usize] -= self.lower.val[t] * u;
            }
        }
        self.upper.close_column();
    }

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
            let v = std::mem::take(&mut self.x[r as usize]);
            if r != row {
                self.lower.push(r, v / pivot);
            }
        }
        self.lower.close_column();
        if self.inverse[j].is_finite() { Ok(()) } else { Err(self.give_up(column)) }
    }

    /// The pivot of a column that is kept, in a row that none of the others needed.
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

    /// In units of row and column the pivot is 1.
    fn inverse_of_kept(&self, j: usize, row_weight: f64) -> f64 {
        let weight = if row_weight > 0.0 { row_weight } else { 1.0 };
        weight * self.column_scale[self.order[j] as usize]
    }

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

    fn give_up(&mut self, column: u32) -> SingularMatrix {
        self.x.fill(0.0);
        SingularMatrix { column: column as usize }
    }

    /// Rows become positions, so that refactorisation and solution need no permutation inside.
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

    /// The arithmetic alone; false when a pivot has gone bad.
    fn refactor(&mut self, val: &[f64]) -> bool {
        for j in 0..self.pattern.n {
            for p in self.load_ptr[j] as usize..self.load_ptr[j + 1] as usize {
                self.x[self.load_row[p] as usize] += val[self.load_from[p] as usize];
            }
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

    fn divide(&mut self, j: usize) -> bool {
        let pivot = std::mem::take(&mut self.x[j]);
        let scale = self.column_scale[self.order[j] as usize];
        if j >= self.pattern.n - self.kept {
            self.inverse[j] = self.inverse_of_kept(j, self.weights[j]);
            // no other rows are left but those of columns that are kept too; one without entries has no size
            let rests = |v: f64, w: f64| v == 0.0 || (w > 0.0 && v.abs() * w * scale <= DEPENDENT);
            let open =
                rests(pivot, self.weights[j]) && self.x[j..].iter().zip(&self.weights[j..]).all(|(&v, &w)| rests(v, w));
            self.x[j..].fill(0.0);
            return open;
        }
        let inverse = 1.0 / pivot;
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

    /// Replaces `b` by the solution; false when it is not finite.
    pub fn solve(&mut self, b: &mut [f64]) -> bool {
        let (n, w) = (self.pattern.n, &mut self.work);
        for j in 0..n {
            w[j] = b[self.pivot_row[j] as usize];
        }
        for j in 0..n {
            let v = w[j];
            if v != 0.0 {
                let range = self.lower.range(j);
                for (&i, &l) in self.lower.idx[range.clone()].iter().zip(&self.lower.val[range]) {
                    w[i as usize] -= l * v;
                }
            }
        }
        let mut finite = true;
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
    /// Depth first through the columns of L from the row on the stack.
    fn descend(&mut self, mark: u32, position: &[u32], lower: &SparseFactor) {
        while let Some((row, next)) = self.stack.last_mut() {
            let at = position[*row as usize];
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

/// COLAMD by faer; the given order should that fail.
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
