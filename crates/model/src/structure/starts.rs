//! How a start value is spoken of: the parameter that gives it, the modifier that frees it.

use crate::flat::FlatVariable;
use bramah_expr::{ExprNode, Exprs, VarId};

/// The parameter that a user would change to change the start of `v`: the end of the chain of parameters that are each
/// bound to the next. `None` where the start is a number or a formula.
pub fn parameter_behind<'a>(exprs: &Exprs, variables: &'a [FlatVariable], v: VarId) -> Option<&'a str> {
    let mut next = variables[v.index()].start;
    let mut found = None;
    // parameters in a circle have been refused long before, but this must end in any case
    for _ in 0..variables.len() {
        let Some(ExprNode::Var(p)) = next.map(|e| exprs.node(e)) else { break };
        found = Some(variables[p.index()].name.as_str());
        next = variables[p.index()].binding;
    }
    found
}

/// `cylinder(piston(s(fixed = false)))` for `cylinder.piston.s`; `None` inside arrays, whose elements differ.
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
