//! Terms with a derivative that a parameter's value takes out, as in `L*der(i)` with `L = 0`: the variable is then no state,
//! which the structure of the equations must know. Such a parameter is fixed with the structure.

use super::{FlatModel, Variability};
use crate::expr::{Binary, ExprId, Exprs, Node};
use crate::instance::Instance;

/// Takes them out of all equations.
pub(super) fn without_vanishing(instance: &mut Instance<'_, '_>, flat: &mut FlatModel) {
    if instance.varied {
        return;
    }
    let roots: Vec<ExprId> =
        flat.equations.iter().chain(&flat.initial_equations).flat_map(|e| [e.lhs, e.rhs]).collect();
    let candidates = products(instance, &roots);
    if candidates.is_empty() {
        return;
    }
    let is_zero = |i: &mut Instance<'_, '_>, factor| i.number_of(factor) == Some(0.0);
    let zero: Vec<(ExprId, ExprId)> =
        instance.without_fixing(|i| candidates.into_iter().filter(|(_, factor)| is_zero(i, *factor)).collect());
    if zero.is_empty() {
        return;
    }
    for (_, factor) in &zero {
        instance.fix(*factor);
    }
    let replaced: Vec<(ExprId, ExprId)> = zero.iter().map(|(product, _)| (*product, Exprs::ZERO)).collect();
    for equation in flat.equations.iter_mut().chain(&mut flat.initial_equations) {
        equation.lhs = instance.exprs.substitute(equation.lhs, &replaced);
        equation.rhs = instance.exprs.substitute(equation.rhs, &replaced);
    }
}

/// Products of parameters and what has a derivative in it, with the factor of parameters.
fn products(instance: &mut Instance<'_, '_>, roots: &[ExprId]) -> Vec<(ExprId, ExprId)> {
    let nodes = instance.exprs.reachable(roots, |_| true);
    // nodes come after what they are made of
    let mut derivative = vec![false; instance.exprs.len()];
    let mut found = Vec::new();
    for e in nodes {
        let node = instance.exprs.node(e);
        let below = instance.exprs.operands(e).as_slice().iter().any(|o| derivative[o.index()]);
        derivative[e.index()] = matches!(node, Node::Der(_)) || below;
        let Node::Binary(Binary::Mul, a, b) = node else { continue };
        for (factor, other) in [(a, b), (b, a)] {
            let of_parameters = || !instance.exprs.variables(factor).is_empty();
            if derivative[other.index()] && !derivative[factor.index()] && of_parameters() {
                let fixed = instance.variability(factor) <= Variability::Parameter && !instance.found_at_start(factor);
                if fixed {
                    found.push((e, factor));
                }
            }
        }
    }
    found
}
