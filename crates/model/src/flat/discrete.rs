//! Checks of discrete variables: what changes at events only must get its value in a way that changes at events only.
//!
//! Enters: the flat model before the pool of expressions moves into it. Leaves: messages in the instance. `flatten`
//! calls [`check`] once. The rules are those of variability of expressions (MLS 3.8) and of discrete-time variables
//! (MLS 4.4.4).

use super::{FlatEquation, FlatModel, OriginKind, ScalarType, Variability, WhenAction, WhenClause};
use crate::instance::Instance;
use bramah_expr::{ExprId, ExprNode, UnaryFunction, VarId};
use bramah_syntax::diag::{Code, Diagnostic, Span};
use rustc_hash::{FxHashMap, FxHashSet};

/// Reports all violations. The expressions are still those of the instance.
///
/// Codes: E210 for values of the wrong variability, E303 for two `reinit`s.
pub(super) fn check(instance: &mut Instance<'_, '_>, flat: &FlatModel) {
    let assigned: FxHashSet<VarId> = flat.whens.iter().flat_map(WhenClause::assigned).collect();
    check_equations(instance, flat, &assigned);
    check_own_values(instance, flat);
    check_reinits(instance, flat);
    check_pre(instance, flat, &assigned);
}

/// The sides of an equation that are variables, each with the other side.
fn bare(instance: &Instance<'_, '_>, e: &FlatEquation) -> impl Iterator<Item = (VarId, ExprId)> + use<> {
    let of = |side, other| match instance.exprs.node(side) {
        ExprNode::Var(v) => Some((v, other)),
        _ => None,
    };
    [of(e.lhs, e.rhs), of(e.rhs, e.lhs)].into_iter().flatten()
}

/// Checks equations for `discrete` Reals and Integers. A value that changes between events is an error unless another
/// equation gives the variable a discrete value. A `discrete` Real must get its value in a `when`.
///
/// Three messages are possible: a `discrete` variable outside of `when`, an Integer that changes all the time, and a
/// `discrete` variable that does. Values that contain calls or conditions are not judged, because they may be constant
/// between events.
fn check_equations(instance: &mut Instance<'_, '_>, flat: &FlatModel, assigned: &FxHashSet<VarId>) {
    // Discrete unknowns outside of `when`: those that a `when` assigns are determined there.
    let stepping = |v: VarId| {
        let variable = &flat.variables[v.index()];
        let declared = variable.variability == Variability::Discrete || variable.ty == ScalarType::Integer;
        declared && variable.variability > Variability::Parameter && !variable.input && !assigned.contains(&v)
    };
    let mut given: FxHashSet<VarId> = FxHashSet::default();
    let mut doubtful = Vec::new();
    for e in &flat.equations {
        for (v, other) in bare(instance, e).filter(|b| stepping(b.0)) {
            if instance.variability(other) <= Variability::Discrete {
                given.insert(v);
            // An equation between two variables may determine the other one.
            } else if !matches!(instance.exprs.node(other), ExprNode::Var(_)) && is_smooth(instance, other) {
                doubtful.push((v, e.origin.span));
            }
        }
    }
    for e in &flat.equations {
        for (v, other) in bare(instance, e) {
            let variable = &flat.variables[v.index()];
            let real = variable.variability == Variability::Discrete && variable.ty == ScalarType::Real;
            let own = real
                && !variable.input
                && !assigned.contains(&v)
                && !matches!(instance.exprs.node(other), ExprNode::Var(_));
            // Equations of connections give values without a `when`, too.
            let written = matches!(e.origin.kind, OriginKind::Declared | OriginKind::Binding);
            if own && written && instance.variability(other) <= Variability::Discrete {
                let message = format!("`{}` is `discrete` and gets its value outside `when`", variable.name);
                let d = Diagnostic::new(Code::TypeMismatch, message).at(e.origin.span, "this equation");
                instance.diagnostics.push(
                    d.at(variable.origin.span, "declared here")
                        .help("drop `discrete`, or give the value in a `when`")
                        .note("Modelica 3.6, 4.4.4"),
                );
            }
        }
    }
    // An equation in doubt may determine something else, if another one gives the variable its value.
    for (v, span) in doubtful.into_iter().filter(|(v, _)| !given.contains(v)) {
        let variable = &flat.variables[v.index()];
        let kind = if variable.ty == ScalarType::Integer { "an Integer" } else { "`discrete`" };
        let message = format!("`{}` is {kind} and is given a value that changes all the time", variable.name);
        let d = Diagnostic::new(Code::TypeMismatch, message).at(span, "this changes between events");
        instance.diagnostics.push(d.at(variable.origin.span, "declared here").help(
            "sample it in a `when`, round it by `integer(..)`, or declare the variable as a Real that is not `discrete`",
        ));
    }
}

/// Checks that a value assigned in a `when` does not read the variable itself: `n = n + 1` asks for a whole number that
/// is its own successor; `pre(n) + 1` was meant. For a Real it would be an equation that can be solved.
/// The help is to write `pre(n)`.
fn check_own_values(instance: &mut Instance<'_, '_>, flat: &FlatModel) {
    for action in flat.whens.iter().flat_map(|w| &w.branches).flat_map(|b| &b.actions) {
        let WhenAction::Assign { variable, value, origin } = action else { continue };
        let v = &flat.variables[variable.index()];
        if v.ty == ScalarType::Real || !instance.exprs.dependencies(&[*value]).vars.contains(variable) {
            continue;
        }
        let name = &v.name;
        let message = format!("the new value of `{name}` is computed from itself");
        let d =
            Diagnostic::new(Code::TypeMismatch, message).at(origin.span, format!("`{name}` means its new value here"));
        instance.diagnostics.push(d.help(format!("write `pre({name})` for the value before the event")));
    }
}

/// Checks that `reinit` of one variable occurs in one `when` clause only (MLS 8.3.6). If two fired at once, the value
/// would be undefined. Only the first conflict is reported.
/// The help is one clause with `elsewhen`, whose order decides.
fn check_reinits(instance: &mut Instance<'_, '_>, flat: &FlatModel) {
    let mut first: FxHashMap<VarId, (usize, Span)> = FxHashMap::default();
    for (clause, when) in flat.whens.iter().enumerate() {
        for action in when.branches.iter().flat_map(|b| &b.actions) {
            let WhenAction::Reinit { variable, origin, .. } = action else { continue };
            let (other, span) = *first.entry(*variable).or_insert((clause, origin.span));
            if other == clause {
                continue;
            }
            let name = &flat.variables[variable.index()].name;
            let message = format!("`{name}` gets a new value from two `when` clauses");
            let d = Diagnostic::new(Code::Overdetermined, message).at(origin.span, "here again").at(span, "first here");
            instance.diagnostics.push(d.help(
                "write one clause, with `elsewhen` for the other condition: its order says which of the two counts",
            ));
            return;
        }
    }
}

/// Whether an expression has neither calls nor conditions nor steps. The value of what has some may be constant between
/// events although its variability is continuous.
fn is_smooth(instance: &Instance<'_, '_>, e: ExprId) -> bool {
    let steps = |e: &ExprId| match instance.exprs.node(*e) {
        ExprNode::Unary(op, _) => matches!(op, UnaryFunction::Floor | UnaryFunction::Sign),
        node => matches!(node, ExprNode::Call(..) | ExprNode::Rel(..) | ExprNode::If(..)),
    };
    !instance.exprs.reachable(&[e], |_| true).iter().any(steps)
}

/// Checks that `pre` of a continuous variable does not occur outside `when` clauses. The clauses themselves are not
/// searched, since `pre` is allowed there.
fn check_pre(instance: &mut Instance<'_, '_>, flat: &FlatModel, assigned: &FxHashSet<VarId>) {
    let smooth = |v: VarId| {
        let variable = flat.variables.get(v.index());
        variable.is_some_and(|x| x.ty == ScalarType::Real && x.variability == Variability::Continuous)
            && !assigned.contains(&v)
    };
    let wrong = |e: ExprId| matches!(instance.exprs.node(e), ExprNode::Pre(v) if smooth(v));
    // Most models have no such node at all.
    if !(0..).map(ExprId).take(instance.exprs.len()).any(wrong) {
        return;
    }
    for e in &flat.equations {
        let pres = instance.exprs.dependencies(&[e.lhs, e.rhs]).pres;
        if let Some(v) = pres.into_iter().find(|&v| smooth(v)) {
            let name = &flat.variables[v.index()].name;
            let message = format!("`pre({name})` outside a `when`: `{name}` changes all the time");
            let d = Diagnostic::new(Code::TypeMismatch, message).at(e.origin.span, "in this equation");
            instance.diagnostics.push(d.help("`pre` means the value before an event: use it inside a `when`"));
        }
    }
}
