//! Start values in messages: the parameter that gives one, and the modifier that frees it.
//!
//! `messages` and the later crates use these to advise the user what to change.

use crate::flat::FlatVariable;
use bramah_expr::{ExprNode, Exprs, VarId};

/// The parameter that a user would change to change the start of `v`: the end of the chain of parameters that are each
/// bound to the next. `None` where the start is missing, a number or a formula.
pub fn parameter_behind<'a>(exprs: &Exprs, variables: &'a [FlatVariable], v: VarId) -> Option<&'a str> {
    let mut next = variables[v.index()].start;
    let mut found = None;
    // Circles of parameters are refused earlier, but this loop must end in any case.
    for _ in 0..variables.len() {
        let Some(ExprNode::Var(p)) = next.map(|e| exprs.node(e)) else { break };
        found = Some(variables[p.index()].name.as_str());
        next = variables[p.index()].binding;
    }
    found
}

/// The modifier that sets `fixed` of a variable: `cylinder(piston(s(fixed = false)))` for `cylinder.piston.s`. `None`
/// inside arrays, where a modifier would change all elements.
pub fn modifier(name: &str, fixed: bool) -> Option<String> {
    if name.contains('[') {
        return None;
    }
    let parts: Vec<&str> = name.split('.').collect();
    Some(format!("{}(fixed = {fixed}{}", parts.join("("), ")".repeat(parts.len())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn modifiers_nest_as_components_do() {
        assert_eq!(modifier("x", true).as_deref(), Some("x(fixed = true)"));
        assert_eq!(modifier("cylinder.piston.s", false).as_deref(), Some("cylinder(piston(s(fixed = false)))"));
        assert_eq!(modifier("v[2].p", false), None);
    }
}
