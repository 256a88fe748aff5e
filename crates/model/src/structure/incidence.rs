//! Which unknowns occur in which equations: the bipartite graph that all structural algorithms walk.

use bramah_expr::visit::NodeTraversal;
use bramah_expr::{BinaryFunction, ExprId, ExprNode, Exprs, UnaryFunction};

/// "None" for rows and columns.
pub(super) const NONE: u32 = u32::MAX;

/// Rows are equations, columns are unknowns, both numbered from 0; rows can be appended.
///
/// The columns of a row come in two groups: those that the equation can be solved for in principle, then those that
/// only matter to it (they stand inside a relation, say).
#[derive(Clone, Debug, Default)]
pub(super) struct IncidenceMatrix {
    starts: Vec<u32>,
    splits: Vec<u32>,
    columns: Vec<u32>,
}

impl IncidenceMatrix {
    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.splits.len()
    }

    /// Appends a row.
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

    /// All columns that the row contains.
    pub fn all(&self, row: u32) -> &[u32] {
        &self.columns[self.starts[row as usize] as usize..self.end(row)]
    }

    fn end(&self, row: u32) -> usize {
        self.starts.get(row as usize + 1).map_or(self.columns.len(), |&s| s as usize)
    }

    /// The rows of each column, over the solvable entries: `(starts, rows)` with `starts.len() == columns + 1`.
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

/// Collects the columns of expressions into an [`IncidenceMatrix`], telling apart what an equation can be solved for.
#[derive(Clone, Debug, Default)]
pub(super) struct IncidenceScanner {
    walk: NodeTraversal,
    solvable: Vec<u32>,
    dependent: Vec<u32>,
    mark: Vec<u32>,
    stamp: u32,
}

impl IncidenceScanner {
    /// Appends the row of the continuous equation `lhs = rhs`. `column` maps a leaf to a column or to nothing;
    /// `matchable` says which columns a continuous equation can be solved for.
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

    /// Appends the row of a discrete equation, which can be solved for the given columns only.
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
            let blunt = is_piecewise_constant(node);
            cut |= blunt;
            !blunt
        });
        if cut || !conditions.is_empty() {
            self.scan_rest(pool, sides, column, &conditions);
        }
    }

    /// With piecewise constant parts: solvable is what occurs outside them, the rest depends only.
    fn scan_rest(
        &mut self,
        pool: &Exprs,
        sides: [ExprId; 2],
        column: impl Fn(ExprNode) -> Option<u32>,
        conditions: &[ExprId],
    ) {
        let (mark, stamp) = (&mut self.mark, self.stamp + 1);
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

/// Columns outside conditions and other piecewise constant parts.
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
            ExprNode::If(_, a, b) => stack.extend([b, a]),
            _ => stack.extend(pool.operands(e).as_slice().iter().rev()),
        }
    }
    found
}

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

/// Its derivative by any argument is 0 wherever it exists.
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
