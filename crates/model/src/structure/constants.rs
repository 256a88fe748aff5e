//! Unknowns that equal a parameter or a number, such as a temperature that nothing heats or the potential of a ground:
//! the other equations read what they equal, so that it is known to be constant wherever that decides about the structure.

use super::alias::{self, Simple};
use super::draft::{Draft, Role, RowKind, Signed};
use bramah_expr::{ExprId, Exprs, Node, VarId};

/// Rewrites the continuous equations, but for those that say what the unknowns equal.
pub(super) fn read(draft: &mut Draft) {
    let mut equal: Vec<Option<ExprId>> = vec![None; draft.variables.len()];
    let mut says = vec![false; draft.equations.len()];
    for (i, says) in says.iter_mut().enumerate() {
        let found = if draft.kinds[i] == RowKind::Continuous { constant(draft, i) } else { None };
        if let Some((v, constant)) = found.filter(|(v, _)| equal[v.index()].is_none()) {
            equal[v.index()] = Some(constant);
            *says = true;
        }
    }
    if !says.contains(&true) {
        return;
    }
    let map = draft.rewritten(|_, node| match node {
        Node::Var(v) => equal[v.index()],
        _ => None,
    });
    for (equation, says) in draft.equations.iter_mut().zip(says) {
        if !says {
            equation.lhs = map[equation.lhs.index()];
            equation.rhs = map[equation.rhs.index()];
        }
    }
}

/// The unknown and what it equals, where an equation says no more than that.
fn constant(draft: &mut Draft, equation: usize) -> Option<(VarId, ExprId)> {
    let is = |v: VarId, role| draft.role(v) == role;
    match alias::simple_form(&draft.exprs, &draft.equations[equation])? {
        Simple::Zero(v) if is(v, Role::Continuous) => Some((v, Exprs::ZERO)),
        Simple::Equal(a, b) if is(a.variable, Role::Continuous) && is(b.variable, Role::Parameter) => {
            Some((a.variable, b.expression(&mut draft.exprs)))
        }
        Simple::Equal(a, b) if is(a.variable, Role::Parameter) && is(b.variable, Role::Continuous) => {
            let parameter = Signed { variable: a.variable, negated: b.negated };
            Some((b.variable, parameter.expression(&mut draft.exprs)))
        }
        _ => None,
    }
}
