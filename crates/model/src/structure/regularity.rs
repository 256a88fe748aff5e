//! Whether the equations can determine the unknowns at all, before anything is differentiated.
//!
//! A variable and its derivatives count as one unknown here: if that system has no perfect matching, no amount of
//! differentiation helps, and the over- and under-determined parts say why.

use super::discrete::lone_unknowns;
use super::draft::{DaeDraft, EquationRole, SystemRole};
use super::dulmage_mendelsohn::{CoarseDecomposition, decompose};
use super::incidence::{IncidenceMatrix, IncidenceScanner, NONE};
use super::matching::{Matching, maximum};
use bramah_expr::{ExprNode, VarId};

/// The whole system with one column for each chain of derivatives.
pub(super) struct SystemOverview {
    /// The lowest variable of each column's chain.
    pub columns: Vec<VarId>,
    /// By variable.
    of_var: Vec<u32>,
    pub incidence: IncidenceMatrix,
    pub matching: Matching,
}

/// What is wrong with a system that is not regular.
pub(super) struct StructuralSingularity {
    pub overview: SystemOverview,
    pub parts: CoarseDecomposition,
}

/// Checks the system of all continuous and discrete equations.
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

    fn number_columns(&mut self, draft: &DaeDraft) {
        let mut integral = vec![NONE; draft.variables.len()];
        for (i, link) in draft.derivative.iter().enumerate() {
            if let Some(w) = link {
                integral[w.variable.index()] = i as u32;
            }
        }
        for i in 0..draft.variables.len() {
            let unknown = matches!(draft.roles[i], SystemRole::Continuous | SystemRole::Discrete);
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

    fn scan(&mut self, draft: &DaeDraft) {
        let mut scanner = IncidenceScanner::default();
        let of_var = &self.of_var;
        let column = |node: ExprNode| match node {
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
