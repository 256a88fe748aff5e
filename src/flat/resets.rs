//! `reinit` may set only what is integrated.

use super::census::{Groups, as_variable};
use super::{FlatModel, WhenAction};
use crate::diag::{Code, Diagnostic};
use crate::expr::{ExprId, Node, Unary, VarId};
use rustc_hash::FxHashSet;

/// Variables that `reinit` sets although neither their derivative nor that of an equal variable appears anywhere.
pub(super) fn check(flat: &FlatModel) -> Vec<Diagnostic> {
    let actions = flat.whens.iter().flat_map(|w| &w.branches).flat_map(|b| &b.actions);
    let resets: Vec<_> = actions
        .filter_map(|a| match a {
            WhenAction::Reinit { variable, origin, .. } => Some((*variable, *origin)),
            _ => None,
        })
        .collect();
    if resets.is_empty() {
        return Vec::new();
    }
    let (mut equal, integrated) = (equal_variables(flat), integrated(flat));
    let states: FxHashSet<_> = integrated.into_iter().map(|v| equal.root((0, v.0))).collect();
    let wrong = resets.into_iter().filter(|(v, _)| !states.contains(&equal.root((0, v.0))));
    wrong.map(|(v, origin)| message(flat, v, origin.span)).collect()
}

fn integrated(flat: &FlatModel) -> Vec<VarId> {
    let roots: Vec<ExprId> = flat.equations.iter().flat_map(|e| [e.lhs, e.rhs]).collect();
    flat.exprs.dependencies(&roots).ders
}

fn equal_variables(flat: &FlatModel) -> Groups {
    let mut groups = Groups::default();
    for e in &flat.equations {
        if let (Some(a), Some(b)) = (signed(flat, e.lhs), signed(flat, e.rhs)) {
            groups.join((0, a.0), (0, b.0));
        }
    }
    groups
}

/// The variable that an expression is, or is the negative of.
fn signed(flat: &FlatModel, e: ExprId) -> Option<VarId> {
    match flat.exprs.node(e) {
        Node::Unary(Unary::Neg, a) => as_variable(flat, a),
        _ => as_variable(flat, e),
    }
}

fn message(flat: &FlatModel, v: VarId, span: crate::diag::Span) -> Diagnostic {
    let variable = &flat.variables[v.index()];
    let name = &variable.name;
    Diagnostic::new(Code::TypeMismatch, format!("`reinit` cannot set `{name}`: it is not integrated"))
        .at(span, format!("`der({name})` appears in no equation"))
        .at(variable.origin.span, "declared here")
        .help("set the state it is calculated from, or assign a discrete variable with `=`")
}
