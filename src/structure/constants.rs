//! Unknowns that equal a parameter or a number, such as a temperature that nothing heats or the potential of a ground:
//! the other equations read what they equal, so that it is known to be constant wherever that decides about the structure.

use super::alias;
use super::draft::{Draft, Role, RowKind, Signed};
use crate::expr::{ExprId, Exprs, Node, VarId};

/// Rewrites the continuous equations, but for those that say what the unknowns equal.
pub(super) fn read(draft: &mut Draft) {
    let mut equal: Vec<Option<ExprId>> = vec![None; draft.variables.len()];
    let mut says = vec![false; draft.equations.len()];
    for (i, says) in says.iter_mut().enumerate() {
        if draft.kinds[i] != RowKind::Continuous {
            continue;
        }
        let Some((v, constant)) = constant(draft, i) else { continue };
        if equal[v.index()].is_none() {
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
    let (v, other) = alias::equal(&draft.exprs, &draft.equations[equation])?;
    let is = |v: VarId, role| draft.role(v) == role;
    match other {
        None => is(v, Role::Continuous).then_some((v, Exprs::ZERO)),
        Some(other) if is(v, Role::Continuous) && is(other.variable, Role::Parameter) => {
            Some((v, other.expression(&mut draft.exprs)))
        }
        Some(other) if is(v, Role::Parameter) && is(other.variable, Role::Continuous) => {
            let parameter = Signed { variable: v, negated: other.negated };
            Some((other.variable, parameter.expression(&mut draft.exprs)))
        }
        Some(_) => None,
    }
}
