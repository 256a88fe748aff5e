//! The incidence matrix: which unknowns occur in which equations. It is the bipartite graph on which matching, sorting
//! and index reduction work.
//!
//! [`IncidenceMatrix`] stores it by rows. [`IncidenceScanner`] makes the rows from expressions and separates the
//! unknowns that an equation can be solved for from those that it only depends on.

use bramah_expr::visit::NodeTraversal;
use bramah_expr::{BinaryFunction, ExprId, ExprNode, Exprs, UnaryFunction};

/// The number that means "no row" or "no column".
pub(super) const NONE: u32 = u32::MAX;

/// A sparse matrix without values. Rows are equations, columns are unknowns, both numbered from 0. Rows can be
/// appended.
///
/// The columns of a row come in two groups: those that the equation can be solved for in principle, then those that it
/// only depends on, such as unknowns inside a relation.
#[derive(Clone, Debug, Default)]
pub(super) struct IncidenceMatrix {
    /// By row: where its columns begin in `columns`.
    starts: Vec<u32>,
    /// By row: where its second group begins in `columns`.
    splits: Vec<u32>,
    /// The columns of all rows, one row after the other. No column occurs twice in a row.
    columns: Vec<u32>,
}

impl IncidenceMatrix {
    /// The number of rows.
    pub fn rows(&self) -> usize {
        self.splits.len()
    }

    /// Appends a row with its two groups of columns.
    pub fn push(&mut self, solvable: &[u32], dependent: &[u32]) {
        self.starts.push(self.columns.len() as u32);
        self.columns.extend_from_slice(solvable);
        self.splits.push(self.columns.len() as u32);
        self.columns.extend_from_slice(dependent);
    }

    /// Columns that the row may be matched with.
    pub fn solvable(&self, row: u32) -> &[u32] {
        &self.columns[self.starts[row as usize] as usize..self.splits[row as usize] as usize]
    }

    /// All columns of the row, solvable ones first.
    pub fn all(&self, row: u32) -> &[u32] {
        &self.columns[self.starts[row as usize] as usize..self.end(row)]
    }

    /// Where the columns of a row end.
    fn end(&self, row: u32) -> usize {
        self.starts.get(row as usize + 1).map_or(self.columns.len(), |&s| s as usize)
    }

    /// The solvable entries by columns: `(starts, rows)` with `starts.len() == columns + 1`. The rows of column `c` are
    /// `rows[starts[c]..starts[c + 1]]`, ascending.
    /// Linear in the number of entries.
    pub fn transposed(&self, columns: usize) -> (Vec<u32>, Vec<u32>) {
        let mut starts = vec![0_u32; columns + 1];
        for row in 0..self.rows() as u32 {
            for &c in self.solvable(row) {
                starts[c as usize + 1] += 1;
            }
        }
        for c in 0..columns {
            starts[c + 1] += starts[c];
        }
        let mut next = starts.clone();
        let mut rows = vec![0; starts[columns] as usize];
        for row in 0..self.rows() as u32 {
            for &c in self.solvable(row) {
                rows[next[c as usize] as usize] = row;
                next[c as usize] += 1;
            }
        }
        (starts, rows)
    }
}

/// Collects the columns of expressions into an [`IncidenceMatrix`]. It is work space that is reused from row to row.
#[derive(Clone, Debug, Default)]
pub(super) struct IncidenceScanner {
    /// Visits each node once.
    walk: NodeTraversal,
    /// Columns found that the row can be solved for, in the order in which they were met.
    solvable: Vec<u32>,
    /// Columns found that the row only depends on.
    dependent: Vec<u32>,
    /// By column: the stamp of the last scan that met it. It replaces a set that would have to be cleared for each row.
    mark: Vec<u32>,
    /// The stamp of the current scan.
    stamp: u32,
}

impl IncidenceScanner {
    /// Appends the row of the continuous equation `lhs = rhs`. `column` maps a leaf to its column, or to `None` if it
    /// is no unknown; `matchable` says which columns a continuous equation can be solved for.
    pub fn push(
        &mut self,
        pool: &Exprs,
        sides: [ExprId; 2],
        column: impl Fn(ExprNode) -> Option<u32>,
        matchable: impl Fn(u32) -> bool,
        out: &mut IncidenceMatrix,
    ) {
        self.scan(pool, sides, column);
        self.dependent.extend(self.solvable.iter().copied().filter(|&c| !matchable(c)));
        self.solvable.retain(|&c| matchable(c));
        out.push(&self.solvable, &self.dependent);
    }

    /// Appends the row of a discrete equation. It can be solved for the columns `lone` only, because it is an
    /// assignment.
    pub fn push_discrete(
        &mut self,
        pool: &Exprs,
        sides: [ExprId; 2],
        lone: &[u32],
        column: impl Fn(ExprNode) -> Option<u32>,
        out: &mut IncidenceMatrix,
    ) {
        self.scan(pool, sides, column);
        self.solvable.append(&mut self.dependent);
        self.solvable.retain(|c| !lone.contains(c));
        out.push(lone, &self.solvable);
    }

    /// Collects the columns of both sides in `solvable` and `dependent`.
    ///
    /// An equation without conditions needs one pass. For others `scan_rest` makes a second one.
    fn scan(&mut self, pool: &Exprs, sides: [ExprId; 2], column: impl Fn(ExprNode) -> Option<u32>) {
        self.solvable.clear();
        self.dependent.clear();
        self.stamp += 1;
        let mut cut = false;
        let (mark, stamp, solvable) = (&mut self.mark, self.stamp, &mut self.solvable);
        let mut conditions = Vec::new();
        self.walk.each(pool, &sides, |_, node| {
            if let Some(c) = column(node) {
                note(mark, stamp, c, solvable);
            }
            if let ExprNode::If(c, ..) = node {
                conditions.push(c);
            }
            // Below a piecewise constant node an equation cannot be solved, so the walk does not enter it here.
            let blunt = is_piecewise_constant(node);
            cut |= blunt;
            !blunt
        });
        if cut || !conditions.is_empty() {
            self.scan_rest(pool, sides, column, &conditions);
        }
    }

    /// Scans an equation with conditions or piecewise constant parts: the columns outside them are solvable, the others
    /// are dependent.
    fn scan_rest(
        &mut self,
        pool: &Exprs,
        sides: [ExprId; 2],
        column: impl Fn(ExprNode) -> Option<u32>,
        conditions: &[ExprId],
    ) {
        // `scan` has marked columns with its own stamp, so this pass needs a fresh one.
        let (mark, stamp) = (&mut self.mark, self.stamp + 1);
        // The stamp after it stays unused.
        self.stamp += 2;
        let found = std::mem::take(&mut self.solvable);
        let smooth = if conditions.is_empty() { found } else { smooth_columns(pool, sides, &column) };
        for c in smooth {
            note(mark, stamp, c, &mut self.solvable);
        }
        let dependent = &mut self.dependent;
        self.walk.each(pool, &sides, |_, node| {
            if let Some(c) = column(node) {
                note(mark, stamp, c, dependent);
            }
            true
        });
    }
}

/// The columns outside of conditions and of other piecewise constant parts, in the order in which they are met. A
/// column may occur more than once.
/// Each node is visited once.
fn smooth_columns(pool: &Exprs, sides: [ExprId; 2], column: &impl Fn(ExprNode) -> Option<u32>) -> Vec<u32> {
    let mut seen = rustc_hash::FxHashSet::default();
    let mut stack = vec![sides[1], sides[0]];
    let mut found = Vec::new();
    while let Some(e) = stack.pop() {
        let node = pool.node(e);
        if !seen.insert(e) || is_piecewise_constant(node) {
            continue;
        }
        found.extend(column(node));
        match node {
            // The branches count, the condition does not: in it the equation cannot be solved for anything.
            ExprNode::If(_, a, b) => stack.extend([b, a]),
            _ => stack.extend(pool.operands(e).as_slice().iter().rev()),
        }
    }
    found
}

/// Appends a column to `out` unless the current scan has met it.
fn note(mark: &mut Vec<u32>, stamp: u32, column: u32, out: &mut Vec<u32>) {
    let index = column as usize;
    if mark.len() <= index {
        mark.resize(index + 1, 0);
    }
    if mark[index] != stamp {
        mark[index] = stamp;
        out.push(column);
    }
}

/// Whether the derivative of a node by any argument is 0 wherever it exists.
fn is_piecewise_constant(node: ExprNode) -> bool {
    matches!(
        node,
        ExprNode::Rel(..)
            | ExprNode::EventRel(..)
            | ExprNode::EventFloor(_)
            | ExprNode::Unary(UnaryFunction::Floor | UnaryFunction::Sign | UnaryFunction::Not, _)
            | ExprNode::Binary(BinaryFunction::And | BinaryFunction::Or, ..)
    )
}

#[cfg(test)]
impl IncidenceMatrix {
    /// From lists of solvable columns.
    pub fn of(rows: &[Vec<u32>]) -> Self {
        let mut made = IncidenceMatrix::default();
        for row in rows {
            made.push(row, &[]);
        }
        made
    }
}
