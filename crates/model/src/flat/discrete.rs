//! What changes at events only must be given so: a `discrete` or Integer variable by its equation, `pre` by its argument.

use super::{FlatEquation, FlatModel, OriginKind, ScalarType, Variability, WhenAction, WhenClause};
use crate::instance::Instance;
use bramah_expr::{ExprId, ExprNode, UnaryFunction, VarId};
use bramah_syntax::diag::{Code, Diagnostic, Span};
use rustc_hash::{FxHashMap, FxHashSet};

/// Tells what is wrong; the expressions are still those of the instance.
pub(super) fn check(instance: &mut Instance<'_, '_>, flat: &FlatModel) {
    let assigned: FxHashSet<VarId> = flat.whens.iter().flat_map(WhenClause::assigned).collect();
    check_equations(instance, flat, &assigned);
    check_own_values(instance, flat);
    check_reinits(instance, flat);
    check_pre(instance, flat, &assigned);
}

/// The variable that a side of an equation is, with the other side.
fn bare(instance: &Instance<'_, '_>, e: &FlatEquation) -> impl Iterator<Item = (VarId, ExprId)> + use<> {
    let of = |side, other| match instance.exprs.node(side) {
        ExprNode::Var(v) => Some((v, other)),
        _ => None,
    };
    [of(e.lhs, e.rhs), of(e.rhs, e.lhs)].into_iter().flatten()
}

fn check_equations(instance: &mut Instance<'_, '_>, flat: &FlatModel, assigned: &FxHashSet<VarId>) {
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

/// `n = n + 1` in a `when` asks for a whole number that is its own successor; `pre(n) + 1` was meant.
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

/// `reinit` of one variable stands in one `when` only (MLS 8.3.6): of two that fire at once neither would say the value.
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

/// Neither calls nor switches: what these give may be constant between events all the same.
fn is_smooth(instance: &Instance<'_, '_>, e: ExprId) -> bool {
    let steps = |e: &ExprId| match instance.exprs.node(*e) {
        ExprNode::Unary(op, _) => matches!(op, UnaryFunction::Floor | UnaryFunction::Sign),
        node => matches!(node, ExprNode::Call(..) | ExprNode::Rel(..) | ExprNode::If(..)),
    };
    !instance.exprs.reachable(&[e], |_| true).iter().any(steps)
}

fn check_pre(instance: &mut Instance<'_, '_>, flat: &FlatModel, assigned: &FxHashSet<VarId>) {
    let smooth = |v: VarId| {
        let variable = flat.variables.get(v.index());
        variable.is_some_and(|x| x.ty == ScalarType::Real && x.variability == Variability::Continuous)
            && !assigned.contains(&v)
    };
    let wrong = |e: ExprId| matches!(instance.exprs.node(e), ExprNode::Pre(v) if smooth(v));
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
