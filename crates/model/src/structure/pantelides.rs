//! Index reduction by Pantelides' algorithm (C. C. Pantelides, The consistent initialization of differential-algebraic
//! systems, SIAM J. Sci. Stat. Comput. 9, 1988).
//!
//! An equation that contains no derivative of highest order beyond those already matched is a constraint. It is
//! differentiated, together with all equations that compete for its unknowns, until every equation has an unknown of
//! highest order of its own. The differentiated equations are appended to the draft; the original ones stay.
//!
//! [`IndexReduction::new`] numbers unknowns and equations, [`IndexReduction::reduce`] differentiates. `dependence` uses
//! the numbering before that; `dummy_derivatives` reads the result.

use super::draft::{DaeDraft, EquationRole, SignedVariable, SystemRole};
use super::incidence::{IncidenceMatrix, IncidenceScanner, NONE};
use super::matching::{Matching, PathAugmenter};
use super::{Unknown, messages};
use crate::flat::{ElementOrigin, FlatEquation, OriginKind, ScalarType};
use bramah_expr::differentiate::{DerivativeLeaf, TimeDerivative};
use bramah_expr::{ExprId, ExprNode, Exprs, VarId};
use bramah_syntax::diag::Diagnostic;

/// A variable or derivative, with its neighbours in the chain of derivatives of one variable.
#[derive(Clone, Copy, Debug)]
pub(super) struct ReductionColumn {
    /// What the column stands for. A derivative that must be differentiated again becomes a variable: see
    /// [`IndexReduction::materialize`].
    pub unknown: Unknown,
    /// The column of its time derivative, or [`NONE`].
    pub derivative: u32,
    /// The column of which it is the time derivative, or [`NONE`].
    pub integral: u32,
}

/// The continuous equations (rows) and their unknowns with all derivatives (columns).
#[derive(Debug, Default)]
pub(super) struct IndexReduction {
    /// The columns. Lower derivatives of a chain come before higher ones, except where a variable is the derivative of
    /// another.
    pub columns: Vec<ReductionColumn>,
    /// By variable: its column, or [`NONE`].
    of_var: Vec<u32>,
    /// By variable: the column of its derivative while that is no variable, or [`NONE`].
    of_der: Vec<u32>,
    /// Index into `DaeDraft::equations`, by row.
    pub equations: Vec<u32>,
    /// The row that is the derivative of a row, or [`NONE`].
    pub derivative: Vec<u32>,
    /// The row of which a row is the derivative, or [`NONE`].
    pub integral: Vec<u32>,
    /// By row: how often the original equation was differentiated to get it.
    order: Vec<usize>,
    /// The columns of each row.
    incidence: IncidenceMatrix,
    /// Work space for `incidence`.
    scanner: IncidenceScanner,
    /// The differentiator, with the derivatives of subexpressions that it has made.
    time_derivative: TimeDerivative,
}

impl IndexReduction {
    /// The columns and rows of the continuous equations, undifferentiated. The derivatives that occur get columns too.
    ///
    /// Rows are numbered in the order of the draft's equations; discrete equations have no row.
    pub fn new(draft: &mut DaeDraft) -> Self {
        let mut made = IndexReduction {
            of_var: vec![NONE; draft.variables.len()],
            of_der: vec![NONE; draft.variables.len()],
            ..IndexReduction::default()
        };
        for v in draft.with_role(SystemRole::Continuous) {
            made.of_var[v.index()] = made.push_column(Unknown::Var(v), NONE);
        }
        made.link(draft);
        made.add_occurring_derivatives(draft);
        let rows: Vec<u32> = (0..draft.equations.len() as u32)
            .filter(|&i| draft.kinds[i as usize] == EquationRole::Continuous)
            .collect();
        for row in rows {
            made.push_row(draft, row, NONE);
        }
        made
    }

    /// Whether no equation was differentiated: then the index was at most 1.
    pub fn is_trivial(&self) -> bool {
        self.derivative.iter().all(|&d| d == NONE)
    }

    /// Original equations with a single unknown that were differentiated at least twice: the unknown, and the index of
    /// the equation in the draft.
    pub fn constraints_twice_differentiated(&self) -> impl Iterator<Item = (VarId, usize)> {
        let twice = |&row: &usize| match (self.integral[row], self.derivative[row]) {
            (NONE, d) if d != NONE => self.derivative[d as usize] != NONE,
            _ => false,
        };
        (0..self.equations.len()).filter(twice).filter_map(|row| match self.incidence.all(row as u32) {
            [c] => Some((self.variable(*c)?, self.equations[row] as usize)),
            _ => None,
        })
    }

    /// The variable of a column; `None` for a derivative that is no variable.
    pub fn variable(&self, column: u32) -> Option<VarId> {
        match self.columns[column as usize].unknown {
            Unknown::Var(v) => Some(v),
            Unknown::Der(_) => None,
        }
    }

    /// The expression that stands for a column.
    pub fn leaf(&self, pool: &mut Exprs, column: u32) -> ExprId {
        match self.columns[column as usize].unknown {
            Unknown::Var(v) => pool.var(v),
            Unknown::Der(v) => pool.der(v),
        }
    }

    /// Columns that a row contains outside of conditions, so that it can be solved for them in principle.
    pub fn solvable(&self, row: u32) -> &[u32] {
        self.incidence.solvable(row)
    }

    /// The column of a leaf that is a continuous unknown or its derivative; `None` for other leaves.
    pub fn column(&self, draft: &DaeDraft, leaf: ExprNode) -> Option<u32> {
        column(&self.of_var, &self.of_der, &draft.derivative, leaf)
    }

    /// Columns of a row that are derivatives of highest order in their chain.
    pub fn highest(&self, row: u32) -> impl Iterator<Item = u32> {
        self.incidence.solvable(row).iter().copied().filter(|&c| self.columns[c as usize].derivative == NONE)
    }

    /// Appends a column and links it to the column of which it is the derivative, if any.
    fn push_column(&mut self, unknown: Unknown, integral: u32) -> u32 {
        let column = self.columns.len() as u32;
        self.columns.push(ReductionColumn { unknown, derivative: NONE, integral });
        if integral != NONE {
            self.columns[integral as usize].derivative = column;
        }
        column
    }

    /// Links the columns of variables that alias elimination found to be derivatives of others.
    fn link(&mut self, draft: &DaeDraft) {
        for (i, link) in draft.derivative.iter().enumerate() {
            if let (Some(w), true) = (link, self.of_var[i] != NONE) {
                let (x, w) = (self.of_var[i], self.of_var[w.variable.index()]);
                self.columns[x as usize].derivative = w;
                self.columns[w as usize].integral = x;
            }
        }
    }

    /// Adds columns for derivatives that occur in equations, in the order of variables. A linked derivative has its
    /// column already.
    fn add_occurring_derivatives(&mut self, draft: &mut DaeDraft) {
        let mut occurs = vec![false; draft.variables.len()];
        let mut walk = bramah_expr::visit::NodeTraversal::default();
        let roots: Vec<ExprId> = draft.equations.iter().flat_map(|e| [e.lhs, e.rhs]).collect();
        walk.each(&draft.exprs, &roots, |_, node| {
            if let ExprNode::Der(v) = node {
                occurs[v.index()] = true;
            }
            true
        });
        for (i, v) in draft.variables.iter().enumerate() {
            // A variable that must be a state is differentiated even if its derivative occurs nowhere.
            occurs[i] |= v.state_select == crate::flat::StateSelect::Always;
        }
        for v in (0..occurs.len()).filter(|&i| occurs[i]) {
            let x = self.of_var[v];
            if x != NONE && self.columns[x as usize].derivative == NONE {
                self.of_der[v] = self.push_column(Unknown::Der(VarId(v as u32)), x);
            }
        }
    }

    /// Appends a row for an equation of the draft. `integral` is the row of which it is the derivative, or [`NONE`].
    /// Returns the number of the row.
    fn push_row(&mut self, draft: &DaeDraft, equation: u32, integral: u32) -> u32 {
        let row = self.equations.len() as u32;
        let FlatEquation { lhs, rhs, .. } = draft.equations[equation as usize];
        let (of_var, of_der, derivative) = (&self.of_var, &self.of_der, &draft.derivative);
        let column = |node: ExprNode| column(of_var, of_der, derivative, node);
        self.scanner.push(&draft.exprs, [lhs, rhs], column, |_| true, &mut self.incidence);
        self.equations.push(equation);
        self.derivative.push(NONE);
        self.integral.push(integral);
        self.order.push(if integral == NONE { 0 } else { self.order[integral as usize] + 1 });
        if integral != NONE {
            self.derivative[integral as usize] = row;
        }
        row
    }

    /// Differentiates until every row of highest order is matched with an unknown of highest order.
    ///
    /// The system must be structurally regular when a variable and its derivatives count as one unknown, else this
    /// would not end. Unknowns may cancel when an equation is differentiated (`der(x) - der(x)`); where that happens,
    /// regularity is checked again. Where they cancel without being recognised, orders would grow for ever. The limit
    /// for them: no order in a regular system exceeds the number of its unknowns, derivatives included, since each
    /// equation is differentiated by at most the sum of the orders of an assignment (J. Pryce, BIT 41, 2001). `Err`
    /// names the equation that determines nothing, or a derivative that does not exist.
    pub fn reduce(&mut self, draft: &mut DaeDraft) -> Result<(), Diagnostic> {
        let most = self.columns.len();
        let mut matching = self.first_matching();
        let mut augmenter = PathAugmenter::default();
        for first in 0..self.equations.len() as u32 {
            let mut row = first;
            // Each pass matches the row or replaces it by its derivative, which is matched next.
            while matching.column_of[row as usize] == NONE {
                let columns = &self.columns;
                let highest = |_, _, c: u32| columns[c as usize].derivative == NONE;
                if augmenter.augment(&self.incidence, &mut matching, row, highest) {
                    break;
                }
                // The failed search has visited exactly the rows that compete for too few unknowns of highest order.
                // All of them are differentiated together.
                let (mut rows, mut seen) = (augmenter.rows_seen.clone(), augmenter.columns_seen.clone());
                // Sorted, so that new variables and equations do not depend on the order of the search.
                rows.sort_unstable();
                seen.sort_unstable();
                if let Some(&row) = rows.iter().find(|&&r| self.order[r as usize] > most) {
                    return Err(self.determines_nothing(draft, row));
                }
                self.differentiate_all(draft, &rows, &seen, &mut matching)?;
                row = self.derivative[row as usize];
            }
        }
        Ok(())
    }

    /// A maximum matching of rows with derivatives of highest order, made at once. `reduce` extends it row by row; it
    /// saves most searches for single rows.
    /// It is a matching of rows and columns of the reduction.
    pub fn first_matching(&self) -> Matching {
        let mut highest = IncidenceMatrix::default();
        let mut columns = Vec::new();
        for row in 0..self.equations.len() as u32 {
            columns.clear();
            columns.extend(self.highest(row));
            highest.push(&columns, &[]);
        }
        super::matching::maximum(&highest, self.columns.len())
    }

    /// Appends the derivatives of these columns and rows. The derivative of a matched row is matched with the
    /// derivative of its column, so that the matching stays valid.
    ///
    /// Columns come first: the derivatives of the rows contain the derivatives of the columns. `Err` where a derivative
    /// does not exist or the system is no longer regular.
    fn differentiate_all(
        &mut self,
        draft: &mut DaeDraft,
        rows: &[u32],
        columns: &[u32],
        matching: &mut Matching,
    ) -> Result<(), Diagnostic> {
        for &c in columns {
            self.add_derivative(draft, c);
            matching.row_of.push(NONE);
        }
        let mut cancelled = false;
        for &row in rows {
            let made = self.differentiate_row(draft, row)?;
            cancelled |= self.highest(made).count() < self.next_to_highest(row);
            matching.column_of.push(NONE);
            let partner = matching.column_of[row as usize];
            if partner != NONE {
                matching.join(made, self.columns[partner as usize].derivative);
            }
        }
        // Only a row with fewer unknowns than expected can break structural regularity.
        if cancelled { self.check_regular(draft) } else { Ok(()) }
    }

    /// How many columns of a row have a derivative of highest order. So many highest derivatives should occur in the
    /// derivative of the row.
    fn next_to_highest(&self, row: u32) -> usize {
        let derivative = |c: u32| self.columns[c as usize].derivative;
        let next = |&&c: &&u32| derivative(c) != NONE && derivative(derivative(c)) == NONE;
        self.incidence.solvable(row).iter().filter(next).count()
    }

    /// Fails if the rows of highest order cannot be matched with one chain each: a variable and its derivatives count
    /// as one.
    /// The matching is made anew, because the cancelled unknowns may have been partners.
    fn check_regular(&self, draft: &DaeDraft) -> Result<(), Diagnostic> {
        let rows: Vec<u32> =
            (0..self.equations.len() as u32).filter(|&r| self.derivative[r as usize] == NONE).collect();
        let mut chains = IncidenceMatrix::default();
        for &row in &rows {
            let mut columns: Vec<u32> = self.incidence.solvable(row).iter().map(|&c| self.first_of_chain(c)).collect();
            columns.sort_unstable();
            columns.dedup();
            chains.push(&columns, &[]);
        }
        let matching = super::matching::maximum(&chains, self.columns.len());
        let Some(lone) = matching.column_of.iter().position(|&c| c == NONE) else { return Ok(()) };
        Err(self.determines_nothing(draft, rows[lone]))
    }

    /// The diagnostic about the original equation of which a row is a derivative.
    fn determines_nothing(&self, draft: &DaeDraft, mut row: u32) -> Diagnostic {
        while self.integral[row as usize] != NONE {
            row = self.integral[row as usize];
        }
        messages::cancelling(draft, &draft.equations[self.equations[row as usize] as usize])
    }

    /// The lowest column of the chain of a column.
    fn first_of_chain(&self, mut column: u32) -> u32 {
        while self.columns[column as usize].integral != NONE {
            column = self.columns[column as usize].integral;
        }
        column
    }

    /// Appends the derivative of a column. The column becomes a variable first, since only variables have a `Der`.
    fn add_derivative(&mut self, draft: &mut DaeDraft, column: u32) {
        let v = self.materialize(draft, column);
        let made = self.push_column(Unknown::Der(v), column);
        self.of_der[v.index()] = made;
    }

    /// The derivative of the given order of the unknown of a column. Adds columns that do not exist yet.
    pub fn derivative_of(&mut self, draft: &mut DaeDraft, mut column: u32, order: u32) -> ExprId {
        for _ in 0..order {
            if self.columns[column as usize].derivative == NONE {
                self.add_derivative(draft, column);
            }
            column = self.columns[column as usize].derivative;
        }
        self.leaf(&mut draft.exprs, column)
    }

    /// The time derivative of a part of an equation. `Err` where it needs a derivative that does not exist.
    pub fn differentiate(
        &mut self,
        draft: &mut DaeDraft,
        equation: &FlatEquation,
        e: ExprId,
    ) -> Result<ExprId, Diagnostic> {
        // Derivatives must be variables before they can be differentiated again.
        for x in draft.exprs.derivatives(e) {
            if let Some(column) = self.column(draft, ExprNode::Der(x)) {
                self.materialize(draft, column);
            }
        }
        let derivative = self.differentiate_side(draft, e);
        match undifferentiable(draft, [derivative, Exprs::ZERO]) {
            Some(v) => Err(messages::not_differentiable(draft, equation, v)),
            None => Ok(derivative),
        }
    }

    /// The variable of a column. A derivative that is none becomes a hidden variable `der(x)`, linked in
    /// `DaeDraft::derivative`.
    ///
    /// In the draft, `Der(x)` keeps its meaning; the link says that it equals the new variable.
    pub fn materialize(&mut self, draft: &mut DaeDraft, column: u32) -> VarId {
        let x = match self.columns[column as usize].unknown {
            Unknown::Var(v) => return v,
            Unknown::Der(x) => x,
        };
        let name = format!("der({})", draft.variables[x.index()].name);
        let origin = ElementOrigin { kind: OriginKind::Differentiated, ..draft.variables[x.index()].origin };
        let made = draft.make_variable(name, ScalarType::Real, SystemRole::Continuous, origin);
        draft.derivative[x.index()] = Some(SignedVariable { variable: made, negated: false });
        self.columns[column as usize].unknown = Unknown::Var(made);
        self.of_der[x.index()] = NONE;
        // `make_variable` has appended a variable, so both lists grow with it.
        self.of_var.push(column);
        self.of_der.push(NONE);
        made
    }

    /// Appends the derivative of a row to the draft and to the reduction. Returns the number of the new row.
    fn differentiate_row(&mut self, draft: &mut DaeDraft, row: u32) -> Result<u32, Diagnostic> {
        let equation = draft.equations[self.equations[row as usize] as usize];
        let lhs = self.differentiate_side(draft, equation.lhs);
        let rhs = self.differentiate_side(draft, equation.rhs);
        if let Some(v) = undifferentiable(draft, [lhs, rhs]) {
            return Err(messages::not_differentiable(draft, &equation, v));
        }
        let origin = ElementOrigin { kind: OriginKind::Differentiated, ..equation.origin };
        draft.add_equation(FlatEquation { lhs, rhs, origin }, EquationRole::Continuous);
        Ok(self.push_row(draft, draft.equations.len() as u32 - 1, row))
    }

    /// The time derivative of an expression.
    fn differentiate_side(&mut self, draft: &mut DaeDraft, e: ExprId) -> ExprId {
        let (roles, links) = (&draft.roles, &draft.derivative);
        let mut leaf = |pool: &mut Exprs, leaf: DerivativeLeaf| Some(leaf_derivative(pool, roles, links, leaf));
        self.time_derivative.derive(&mut draft.exprs, e, &mut leaf).expect("every leaf has an answer")
    }
}

/// The column of a leaf. Derivatives that are variables are found through their link.
fn column(of_var: &[u32], of_der: &[u32], links: &[Option<SignedVariable>], leaf: ExprNode) -> Option<u32> {
    let place = |of: &[u32], v: VarId| of.get(v.index()).copied();
    let found = match leaf {
        ExprNode::Var(v) => place(of_var, v),
        ExprNode::Der(v) => match links[v.index()] {
            Some(w) => place(of_var, w.variable),
            None => place(of_der, v),
        },
        _ => None,
    };
    found.filter(|&c| c != NONE)
}

/// The time derivative of a variable, or of a derivative that is a variable. Inputs get `Der(v)` and derivatives
/// without a variable get `Pre(x)` as marks, since they may occur in a condition where their derivative does not
/// matter: [`undifferentiable`] looks for marks that are left.
fn leaf_derivative(
    pool: &mut Exprs,
    roles: &[SystemRole],
    links: &[Option<SignedVariable>],
    leaf: DerivativeLeaf,
) -> ExprId {
    let (v, negated) = match leaf {
        DerivativeLeaf::Var(v) => (v, false),
        DerivativeLeaf::Der(x) => match links[x.index()] {
            Some(w) => (w.variable, w.negated),
            None => return pool.pre(x),
        },
    };
    let derivative = match (roles[v.index()], links[v.index()]) {
        (SystemRole::Continuous, Some(w)) => w.expression(pool),
        (SystemRole::Continuous | SystemRole::Input, _) => pool.der(v),
        // Parameters are constant, and discrete unknowns are constant between events.
        _ => Exprs::ZERO,
    };
    if negated { pool.neg(derivative) } else { derivative }
}

/// The first variable whose derivative is needed but does not exist: an input, or a derivative of too high an order.
/// `None` if both sides are valid.
fn undifferentiable(draft: &DaeDraft, sides: [ExprId; 2]) -> Option<VarId> {
    let mut found = None;
    // `Pre` of a continuous variable does not occur otherwise: `DaeDraft::new` has replaced it.
    bramah_expr::visit::NodeTraversal::default().each(&draft.exprs, &sides, |_, node| {
        match node {
            ExprNode::Der(v) if draft.role(v) == SystemRole::Input => found = found.or(Some(v)),
            ExprNode::Pre(v) if draft.role(v) == SystemRole::Continuous => found = found.or(Some(v)),
            _ => {}
        }
        true
    });
    found
}
