//! Structural regularity: whether the equations can determine the unknowns at all, before anything is differentiated.
//!
//! A variable and its derivatives count as one unknown here. If that system has no perfect matching, no differentiation
//! helps, and Pantelides' algorithm would not end. The over- and underdetermined parts then say what is wrong.
//! `analysis` calls [`check`] before index reduction; `messages` turns the result into a diagnostic.

use super::discrete::lone_unknowns;
use super::draft::{DaeDraft, EquationRole, SystemRole};
use super::dulmage_mendelsohn::{CoarseDecomposition, decompose};
use super::incidence::{IncidenceMatrix, IncidenceScanner, NONE};
use super::matching::{Matching, maximum};
use bramah_expr::{ExprNode, VarId};

/// All continuous and discrete equations with one column for each chain of derivatives.
pub(super) struct SystemOverview {
    /// By column: the lowest variable of its chain.
    pub columns: Vec<VarId>,
    /// By variable: its column, or [`NONE`] for what is no unknown.
    of_var: Vec<u32>,
    /// The columns of each equation. Rows have the numbers of `DaeDraft::equations`.
    pub incidence: IncidenceMatrix,
    /// A maximum matching.
    pub matching: Matching,
}

/// A system that is not regular, with its decomposition.
/// It is boxed in results, since it is large and rare.
pub(super) struct StructuralSingularity {
    /// The system.
    pub overview: SystemOverview,
    /// Its over- and underdetermined parts.
    pub parts: CoarseDecomposition,
}

/// Checks the system of all continuous and discrete equations. `Ok` if it has a perfect matching.
/// It costs one maximum matching.
pub(super) fn check(draft: &DaeDraft) -> Result<(), Box<StructuralSingularity>> {
    let overview = SystemOverview::new(draft);
    let complete = |partners: &[u32]| partners.iter().all(|&p| p != NONE);
    if complete(&overview.matching.column_of) && complete(&overview.matching.row_of) {
        return Ok(());
    }
    let parts = decompose(&overview.incidence, &overview.matching);
    Err(Box::new(StructuralSingularity { overview, parts }))
}

impl SystemOverview {
    /// Numbers the columns, scans the equations and matches them.
    fn new(draft: &DaeDraft) -> Self {
        let mut made = SystemOverview {
            columns: Vec::new(),
            of_var: vec![NONE; draft.variables.len()],
            incidence: IncidenceMatrix::default(),
            matching: Matching::default(),
        };
        made.number_columns(draft);
        made.scan(draft);
        made.matching = maximum(&made.incidence, made.columns.len());
        made
    }

    /// Gives a column to each chain of variables that are derivatives of each other.
    fn number_columns(&mut self, draft: &DaeDraft) {
        let mut integral = vec![NONE; draft.variables.len()];
        for (i, link) in draft.derivative.iter().enumerate() {
            if let Some(w) = link {
                integral[w.variable.index()] = i as u32;
            }
        }
        for i in 0..draft.variables.len() {
            let unknown = matches!(draft.roles[i], SystemRole::Continuous | SystemRole::Discrete);
            // A variable that is the derivative of another belongs to the chain of that one.
            if !unknown || integral[i] != NONE {
                continue;
            }
            let column = self.columns.len() as u32;
            self.columns.push(VarId(i as u32));
            let mut next = Some(VarId(i as u32));
            while let Some(v) = next {
                self.of_var[v.index()] = column;
                next = draft.derivative[v.index()].map(|w| w.variable);
            }
        }
    }

    /// Makes the rows of the incidence matrix.
    /// Rows come in the order of the draft's equations.
    fn scan(&mut self, draft: &DaeDraft) {
        let mut scanner = IncidenceScanner::default();
        let of_var = &self.of_var;
        let column = |node: ExprNode| match node {
            // A variable and its derivative have the same column.
            ExprNode::Var(v) | ExprNode::Der(v) => Some(of_var[v.index()]).filter(|&c| c != NONE),
            _ => None,
        };
        let continuous = |c: u32| draft.role(self.columns[c as usize]) == SystemRole::Continuous;
        for (equation, &kind) in draft.equations.iter().zip(&draft.kinds) {
            let sides = [equation.lhs, equation.rhs];
            if kind == EquationRole::Continuous {
                scanner.push(&draft.exprs, sides, column, continuous, &mut self.incidence);
                continue;
            }
            let lone: Vec<u32> = lone_unknowns(draft, equation, kind).iter().map(|v| of_var[v.index()]).collect();
            scanner.push_discrete(&draft.exprs, sides, &lone, column, &mut self.incidence);
        }
    }
}
