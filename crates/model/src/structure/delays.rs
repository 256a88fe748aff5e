//! `delay` becomes an input that the run itself records (MLS 3.7).
//!
//! Enters: the draft with nodes `Delay(source, time)`. Leaves: an input variable in the place of each, and a
//! [`DelayInput`] that says what to record. The solver interpolates the recorded trajectory. `analysis` calls
//! [`extract`] first of all steps that deal with events; `initial` calls [`undelayed`].

use super::DelayInput;
use super::draft::{DaeDraft, SystemRole, carried};
use crate::flat::{ElementOrigin, ScalarType, Variability};
use bramah_expr::visit::Substitution;
use bramah_expr::{ExprId, ExprNode};

/// Replaces every `delay` of the draft by an input. Equal expressions share one input, because the pool is hash-consed.
pub(super) fn extract(draft: &mut DaeDraft) {
    let live = draft.live_nodes();
    let any = |i: usize| matches!(draft.exprs.node(ExprId(i as u32)), ExprNode::Delay(..));
    if !(0..live.len()).any(|i| live[i] && any(i)) {
        return;
    }
    let mut map: Vec<ExprId> = Vec::with_capacity(live.len());
    // Ascending ids: the source of a delay is rewritten before the delay, so nested delays refer to earlier inputs.
    for (i, live) in live.into_iter().enumerate() {
        let e = ExprId(i as u32);
        let image = match draft.exprs.node(e) {
            _ if !live => e,
            ExprNode::Delay(source, time) => input(draft, e, map[source.index()], map[time.index()]),
            _ => carried(&mut draft.exprs, e, &map),
        };
        map.push(image);
    }
    draft.map_expressions(&map);
}

/// Makes the input of one `delay` and returns it as an expression.
/// The input is named like the expression.
fn input(draft: &mut DaeDraft, e: ExprId, source: ExprId, time: ExprId) -> ExprId {
    let origin = origin(draft, e);
    let variable = draft.make_variable(draft.text(e), ScalarType::Real, SystemRole::Input, origin);
    // `make_variable` takes an input for discrete; a delayed value changes at any time.
    draft.variables[variable.index()].variability = Variability::Continuous;
    draft.delays.push(DelayInput { variable, source, time, origin });
    draft.exprs.var(variable)
}

/// The origin of the first equation, condition or assertion that contains an expression. If only other places contain
/// it, that of the first `when`, or of the first variable.
fn origin(draft: &DaeDraft, e: ExprId) -> ElementOrigin {
    let equations = draft.equations.iter().chain(&draft.initial_equations).map(|q| (vec![q.lhs, q.rhs], q.origin));
    let conditions = draft.whens.iter().flat_map(|w| w.branches.iter().map(|b| (b.conditions.clone(), w.origin)));
    let asserts = draft.asserts.iter().map(|a| (vec![a.condition], a.origin));
    let mut holders = equations.chain(conditions).chain(asserts);
    let found = holders.find(|(sides, _)| sides.iter().any(|&side| draft.exprs.contains(side, e)));
    found.map(|f| f.1).or(draft.whens.first().map(|w| w.origin)).unwrap_or(draft.variables[0].origin)
}

/// Changes a map of expressions for the start: nothing has been recorded there, so a delayed value is the value itself.
/// The sources take the place of their inputs in every image of `map`.
pub(super) fn undelayed(draft: &mut DaeDraft, map: &mut [ExprId]) {
    if draft.delays.is_empty() {
        return;
    }
    let mut replacements: Vec<(ExprId, ExprId)> = Vec::with_capacity(draft.delays.len());
    for delay in draft.delays.clone() {
        let source = map.get(delay.source.index()).copied().unwrap_or(delay.source);
        // The source may contain inputs of earlier delays, which have their replacements already.
        let source = Substitution::new(replacements.iter().copied()).apply(&mut draft.exprs, source);
        replacements.push((draft.exprs.var(delay.variable), source));
    }
    let mut substitution = Substitution::new(replacements);
    map.iter_mut().for_each(|e| *e = substitution.apply(&mut draft.exprs, *e));
}
