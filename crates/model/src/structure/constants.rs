//! Unknowns that equal a parameter or a number, such as a temperature that nothing heats or the potential of a ground.
//!
//! The other equations read the parameter instead. So a factor made of such unknowns is known to be constant wherever
//! that decides about the structure. `analysis` calls [`read`] before `dependence`.

use super::alias::{self, AliasEquation};
use super::draft::{DaeDraft, EquationRole, SignedVariable, SystemRole};
use bramah_expr::{ExprId, ExprNode, Exprs, VarId};

/// Rewrites the continuous equations in terms of the parameters and numbers. The equations that define the unknowns
/// stay, so that the unknowns are still computed. Initial equations are not changed.
/// Nothing happens where no such equation exists.
pub(super) fn read(draft: &mut DaeDraft) {
    let mut equal: Vec<Option<ExprId>> = vec![None; draft.variables.len()];
    let mut says = vec![false; draft.equations.len()];
    for (i, says) in says.iter_mut().enumerate() {
        // Of two equations for one unknown only the first defines it; the second must stay visible as a contradiction.
        let found = if draft.kinds[i] == EquationRole::Continuous { constant(draft, i) } else { None };
        if let Some((v, constant)) = found.filter(|(v, _)| equal[v.index()].is_none()) {
            equal[v.index()] = Some(constant);
            *says = true;
        }
    }
    if !says.contains(&true) {
        return;
    }
    let map = draft.rewritten(|_, node| match node {
        ExprNode::Var(v) => equal[v.index()],
        _ => None,
    });
    for (equation, says) in draft.equations.iter_mut().zip(says) {
        if !says {
            equation.lhs = map[equation.lhs.index()];
            equation.rhs = map[equation.rhs.index()];
        }
    }
}

/// The unknown and what it equals, where an equation states just that: `v = 0`, `v = p` or `v = -p` with a parameter
/// `p`. `None` for all others.
/// The sign of an alias equation goes into the expression.
fn constant(draft: &mut DaeDraft, equation: usize) -> Option<(VarId, ExprId)> {
    let is = |v: VarId, role| draft.role(v) == role;
    match alias::simple_form(&draft.exprs, &draft.equations[equation])? {
        AliasEquation::Zero(v) if is(v, SystemRole::Continuous) => Some((v, Exprs::ZERO)),
        AliasEquation::Equal(a, b)
            if is(a.variable, SystemRole::Continuous) && is(b.variable, SystemRole::Parameter) =>
        {
            Some((a.variable, b.expression(&mut draft.exprs)))
        }
        AliasEquation::Equal(a, b)
            if is(a.variable, SystemRole::Parameter) && is(b.variable, SystemRole::Continuous) =>
        {
            let parameter = SignedVariable { variable: a.variable, negated: b.negated };
            Some((b.variable, parameter.expression(&mut draft.exprs)))
        }
        _ => None,
    }
}
