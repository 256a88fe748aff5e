//! Index reduction by Pantelides' algorithm (SIAM J. Sci. Stat. Comput. 9, 1988).
//!
//! An equation that holds no derivative of highest order beyond those already taken is a constraint; it is
//! differentiated, with all equations that share its unknowns, until every equation has an unknown of its own.

use super::draft::{DaeDraft, EquationRole, SignedVariable, SystemRole};
use super::incidence::{IncidenceMatrix, IncidenceScanner, NONE};
use super::matching::{Matching, PathAugmenter};
use super::{Unknown, messages};
use crate::flat::{ElementOrigin, FlatEquation, OriginKind, ScalarType};
use bramah_expr::differentiate::{DerivativeLeaf, TimeDerivative};
use bramah_expr::{ExprId, ExprNode, Exprs, VarId};
use bramah_syntax::diag::Diagnostic;

/// A variable or derivative, with its neighbours in the chain of derivatives.
#[derive(Clone, Copy, Debug)]
pub(super) struct ReductionColumn {
    pub unknown: Unknown,
    pub derivative: u32,
    pub integral: u32,
}

/// Continuous equations and their unknowns with all derivatives.
#[derive(Debug, Default)]
pub(super) struct IndexReduction {
    pub columns: Vec<ReductionColumn>,
    of_var: Vec<u32>,
    of_der: Vec<u32>,
    /// Index into `DaeDraft::equations`, by row.
    pub equations: Vec<u32>,
    /// The row that is the derivative of a row, or [`NONE`].
    pub derivative: Vec<u32>,
    /// The row of which a row is the derivative, or [`NONE`].
    pub integral: Vec<u32>,
    /// How often a row has been differentiated.
    order: Vec<usize>,
    incidence: IncidenceMatrix,
    scanner: IncidenceScanner,
    time_derivative: TimeDerivative,
}

impl IndexReduction {
    /// The columns and rows of the continuous equations, undifferentiated.
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

    /// Whether anything was differentiated.
    pub fn is_trivial(&self) -> bool {
        self.derivative.iter().all(|&d| d == NONE)
    }

    /// Equations of one unknown that were differentiated at least twice: the unknown, and the index of the equation.
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

    /// The variable of a column that is one.
    pub fn variable(&self, column: u32) -> Option<VarId> {
        match self.columns[column as usize].unknown {
            Unknown::Var(v) => Some(v),
            Unknown::Der(_) => None,
        }
    }

    /// The leaf that stands for a column.
    pub fn leaf(&self, pool: &mut Exprs, column: u32) -> ExprId {
        match self.columns[column as usize].unknown {
            Unknown::Var(v) => pool.var(v),
            Unknown::Der(v) => pool.der(v),
        }
    }

    /// Columns that a row holds where it can be solved for them.
    pub fn solvable(&self, row: u32) -> &[u32] {
        self.incidence.solvable(row)
    }

    /// The column of a leaf that is an unknown or its derivative.
    pub fn column(&self, draft: &DaeDraft, leaf: ExprNode) -> Option<u32> {
        column(&self.of_var, &self.of_der, &draft.derivative, leaf)
    }

    /// Columns of a row that are derivatives of highest order.
    pub fn highest(&self, row: u32) -> impl Iterator<Item = u32> {
        self.incidence.solvable(row).iter().copied().filter(|&c| self.columns[c as usize].derivative == NONE)
    }

    fn push_column(&mut self, unknown: Unknown, integral: u32) -> u32 {
        let column = self.columns.len() as u32;
        self.columns.push(ReductionColumn { unknown, derivative: NONE, integral });
        if integral != NONE {
            self.columns[integral as usize].derivative = column;
        }
        column
    }

    fn link(&mut self, draft: &DaeDraft) {
        for (i, link) in draft.derivative.iter().enumerate() {
            if let (Some(w), true) = (link, self.of_var[i] != NONE) {
                let (x, w) = (self.of_var[i], self.of_var[w.variable.index()]);
                self.columns[x as usize].derivative = w;
                self.columns[w as usize].integral = x;
            }
        }
    }

    /// Columns for derivatives that stand in continuous equations, in the order of variables.
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

    /// Differentiates until every equation of highest order has an unknown of highest order.
    ///
    /// The system must be structurally regular when a variable and its derivatives count as one unknown, else this
    /// would not end. Unknowns may cancel when an equation is differentiated (`der(x) - der(x)`), so what was regular
    /// is looked at again where that happens. Where they cancel only beyond what can be seen, orders would grow for
    /// ever: no order of a regular system is above the number of its unknowns, derivatives among them, since each
    /// equation is differentiated by at most the sum of the orders of an assignment (Pryce, BIT 41, 2001).
    pub fn reduce(&mut self, draft: &mut DaeDraft) -> Result<(), Diagnostic> {
        let most = self.columns.len();
        let mut matching = self.first_matching();
        let mut augmenter = PathAugmenter::default();
        for first in 0..self.equations.len() as u32 {
            let mut row = first;
            while matching.column_of[row as usize] == NONE {
                let columns = &self.columns;
                let highest = |_, _, c: u32| columns[c as usize].derivative == NONE;
                if augmenter.augment(&self.incidence, &mut matching, row, highest) {
                    break;
                }
                let (mut rows, mut seen) = (augmenter.rows_seen.clone(), augmenter.columns_seen.clone());
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

    /// A largest matching with the derivatives of highest order.
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

    /// Adds the derivatives of these columns and rows. A matched row's derivative gets the derivative of its column.
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
        if cancelled { self.check_regular(draft) } else { Ok(()) }
    }

    /// How many columns of a row have a derivative of highest order.
    fn next_to_highest(&self, row: u32) -> usize {
        let derivative = |c: u32| self.columns[c as usize].derivative;
        let next = |&&c: &&u32| derivative(c) != NONE && derivative(derivative(c)) == NONE;
        self.incidence.solvable(row).iter().filter(next).count()
    }

    /// Fails if the rows of highest order cannot determine one unknown each, a variable and its derivatives counted as
    /// one.
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

    /// About the equation of which a row is a derivative.
    fn determines_nothing(&self, draft: &DaeDraft, mut row: u32) -> Diagnostic {
        while self.integral[row as usize] != NONE {
            row = self.integral[row as usize];
        }
        messages::cancelling(draft, &draft.equations[self.equations[row as usize] as usize])
    }

    fn first_of_chain(&self, mut column: u32) -> u32 {
        while self.columns[column as usize].integral != NONE {
            column = self.columns[column as usize].integral;
        }
        column
    }

    fn add_derivative(&mut self, draft: &mut DaeDraft, column: u32) {
        let v = self.materialize(draft, column);
        let made = self.push_column(Unknown::Der(v), column);
        self.of_der[v.index()] = made;
    }

    /// The derivative of this order of the variable of a column that is no derivative.
    pub fn derivative_of(&mut self, draft: &mut DaeDraft, mut column: u32, order: u32) -> ExprId {
        for _ in 0..order {
            if self.columns[column as usize].derivative == NONE {
                self.add_derivative(draft, column);
            }
            column = self.columns[column as usize].derivative;
        }
        self.leaf(&mut draft.exprs, column)
    }

    /// The derivative of a part of an equation.
    pub fn differentiate(
        &mut self,
        draft: &mut DaeDraft,
        equation: &FlatEquation,
        e: ExprId,
    ) -> Result<ExprId, Diagnostic> {
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

    /// The variable of a column; a derivative becomes a variable of its own, named as the user would write it.
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
        self.of_var.push(column);
        self.of_der.push(NONE);
        made
    }

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

    fn differentiate_side(&mut self, draft: &mut DaeDraft, e: ExprId) -> ExprId {
        let (roles, links) = (&draft.roles, &draft.derivative);
        let mut leaf = |pool: &mut Exprs, leaf: DerivativeLeaf| Some(leaf_derivative(pool, roles, links, leaf));
        self.time_derivative.derive(&mut draft.exprs, e, &mut leaf).expect("every leaf has an answer")
    }
}

/// The column of a leaf.
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

/// The time derivative of a variable or of a derivative that is a variable. What has none is marked, since it may stand
/// in a condition where its derivative does not matter: see [`undifferentiable`].
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
        _ => Exprs::ZERO,
    };
    if negated { pool.neg(derivative) } else { derivative }
}

/// A variable whose derivative is needed but does not exist: an input, or something of too high an order.
fn undifferentiable(draft: &DaeDraft, sides: [ExprId; 2]) -> Option<VarId> {
    let mut found = None;
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
