//! Discrete equations: `when` clauses become equations and actions, and equations for discrete unknowns are recognised.
//!
//! A `when` clause that assigns `v` becomes `v = if fires then value else pre(v)`; `fires` is true in the event
//! iteration in which a condition becomes true (MLS 8.3.5). Its other statements become [`EventAction`]s.
//! [`translate_whens`] does this, [`classify`] marks equations that determine discrete unknowns,
//! [`absorb_initial_pres`] turns initial equations for `pre(v)` into start values. `analysis` calls them in this order,
//! with alias elimination between the first two.

use super::draft::{DaeDraft, EquationRole, SystemRole};
use super::{EventAction, EventActionKind};
use crate::flat::{
    ElementOrigin, FlatEquation, OriginKind, ScalarType, Variability, WhenAction, WhenBranch, WhenClause,
};
use bramah_expr::visit::LeafDependencies;
use bramah_expr::{ExprId, ExprNode, Exprs, VarId};
use petgraph::unionfind::UnionFind;
use rustc_hash::{FxHashMap, FxHashSet};

/// Translates all `when` clauses and empties the list of them.
///
/// `when c then x = e; elsewhen d then x = f; end when` becomes
/// `x = if edge(c) then e else if edge(d) then f else pre(x)`, where `edge(c)` is `c and not pre(c)` (MLS 8.3.5).
pub(super) fn translate_whens(draft: &mut DaeDraft) {
    let whens = std::mem::take(&mut draft.whens);
    // One table for all clauses: equal conditions share a variable.
    let mut conditions = ConditionVariables::default();
    for when in &whens {
        let fires: Vec<ExprId> = when.branches.iter().map(|b| conditions.fires(draft, b, when.origin)).collect();
        assign_variables(draft, when, &fires);
        add_actions(draft, when, &fires);
    }
}

/// The Boolean variables made for `when` conditions.
/// A condition that is a discrete variable already needs none.
#[derive(Default)]
struct ConditionVariables {
    /// By condition: its variable.
    made: FxHashMap<ExprId, VarId>,
}

impl ConditionVariables {
    /// An expression that is true in the event iteration in which one of the branch's conditions becomes true.
    /// `initial()` is true at the start itself and needs no edge.
    /// A `when` with several conditions fires when any of them becomes true (MLS 8.3.5).
    fn fires(&mut self, draft: &mut DaeDraft, branch: &WhenBranch, origin: ElementOrigin) -> ExprId {
        let mut fires = Exprs::ZERO;
        for &condition in &branch.conditions {
            let one = match draft.exprs.node(condition) {
                ExprNode::Initial => condition,
                _ => self.becomes_true(draft, condition, origin),
            };
            fires = draft.exprs.or(fires, one);
        }
        fires
    }

    /// The edge of a condition: `not initial() and c and not pre(c)`.
    /// At the start itself no condition has an edge (MLS 8.6).
    fn becomes_true(&mut self, draft: &mut DaeDraft, condition: ExprId, origin: ElementOrigin) -> ExprId {
        let v = self.variable(draft, condition, origin);
        let pool = &mut draft.exprs;
        let (now, before, initial) = (pool.var(v), pool.pre(v), pool.intern(ExprNode::Initial));
        let (not_before, running) = (pool.not(before), pool.not(initial));
        let edge = pool.and(now, not_before);
        pool.and(running, edge)
    }

    /// The discrete variable that the condition is, or one made for it with an equation `variable = condition`. `pre`
    /// needs a variable, since it is defined for variables only.
    fn variable(&mut self, draft: &mut DaeDraft, condition: ExprId, origin: ElementOrigin) -> VarId {
        if let ExprNode::Var(v) = draft.exprs.node(condition)
            && matches!(draft.role(v), SystemRole::Discrete | SystemRole::Sample)
        {
            return v;
        }
        if let Some(&v) = self.made.get(&condition) {
            return v;
        }
        let origin = ElementOrigin { kind: OriginKind::WhenCondition, ..origin };
        let name = draft.text(condition);
        let v = draft.make_variable(name, ScalarType::Boolean, SystemRole::Discrete, origin);
        let lhs = draft.exprs.var(v);
        draft.add_equation(FlatEquation { lhs, rhs: condition, origin }, EquationRole::Definition);
        self.made.insert(condition, v);
        v
    }
}

/// Adds one equation for each variable that the clause assigns, in order of first appearance.
/// The equation is a definition: it can be solved for that variable only.
fn assign_variables(draft: &mut DaeDraft, when: &WhenClause, fires: &[ExprId]) {
    let mut done: Vec<VarId> = Vec::new();
    for action in when.branches.iter().flat_map(|b| &b.actions) {
        if let WhenAction::Assign { variable, origin, .. } = action
            && !done.contains(variable)
        {
            done.push(*variable);
            let rhs = chosen_value(draft, when, fires, *variable);
            let lhs = draft.exprs.var(*variable);
            draft.add_equation(FlatEquation { lhs, rhs, origin: *origin }, EquationRole::Definition);
        }
    }
}

/// The new value of a variable: that of the first branch that fires. A branch that does not assign the variable leaves
/// it at `pre(variable)`, and so does a clause of which no branch fires.
/// Of several assignments in one branch the last one counts.
fn chosen_value(draft: &mut DaeDraft, when: &WhenClause, fires: &[ExprId], variable: VarId) -> ExprId {
    let before = draft.exprs.pre(variable);
    let mut value = before;
    // From the last branch to the first, so that the first one is the outermost `if` and has priority.
    for (branch, &fires) in when.branches.iter().zip(fires).rev() {
        let assigned = branch.actions.iter().rev().find_map(|action| match action {
            WhenAction::Assign { variable: v, value, .. } if *v == variable => Some(*value),
            _ => None,
        });
        value = draft.exprs.if_(fires, assigned.unwrap_or(before), value);
    }
    value
}

/// Adds the actions for `reinit`, `assert` and `terminate`. Each happens when its branch is the first that fires and
/// the `if`s around it in the clause hold.
///
/// `earlier` collects the conditions of the branches before, which must not have fired. `assert` has no guard of its
/// own: its condition contains that of the `if`s around it.
fn add_actions(draft: &mut DaeDraft, when: &WhenClause, fires: &[ExprId]) {
    let mut earlier = Exprs::ZERO;
    for (branch, &fires) in when.branches.iter().zip(fires) {
        let none = draft.exprs.not(earlier);
        let first = draft.exprs.and(fires, none);
        earlier = draft.exprs.or(earlier, fires);
        for action in &branch.actions {
            let (kind, guard, origin) = match action {
                WhenAction::Assign { .. } => continue,
                WhenAction::Reinit { variable, value, guard, origin } => {
                    (EventActionKind::Reinit(*variable, *value), *guard, *origin)
                }
                WhenAction::Assert(assert) => (EventActionKind::Assert(assert.clone()), Exprs::ONE, assert.origin),
                WhenAction::Terminate { message, guard, origin } => {
                    (EventActionKind::Terminate(message.clone()), *guard, *origin)
                }
            };
            let fires = draft.exprs.and(first, guard);
            draft.actions.push(EventAction { fires, kind, origin });
        }
    }
}

/// The variable of an expression `v` or `pre(v)` where `v` is a discrete unknown; else `None`.
/// Such an expression takes part in the classes of [`absorb_through_equals`].
fn discrete_atom(draft: &DaeDraft, e: ExprId) -> Option<VarId> {
    match draft.exprs.node(e) {
        ExprNode::Var(v) | ExprNode::Pre(v) if draft.role(v) == SystemRole::Discrete => Some(v),
        _ => None,
    }
}

/// Whether both sides of an equation are a discrete unknown or its `pre`.
fn joins_atoms(draft: &DaeDraft, q: &FlatEquation) -> bool {
    [q.lhs, q.rhs].iter().all(|&e| discrete_atom(draft, e).is_some())
}

/// Whether an expression with these leaves reads nothing but parameters and values of `pre`.
fn of_parameters(draft: &DaeDraft, found: &LeafDependencies) -> bool {
    found.ders.is_empty() && !found.time && found.vars.iter().all(|&u| draft.role(u) == SystemRole::Parameter)
}

/// Turns initial equations `a = value` into start values of `v` where the model states `a = pre(v)`, directly or
/// through a chain of equal variables (MLS 8.6). Equal variables and `pre`s form classes; a class that contains a `pre`
/// and gets one known value passes that value to all its `pre`s as fixed starts.
/// A class without a known value, and a class with a `fixed` start, keep their equations.
fn absorb_through_equals(draft: &mut DaeDraft) {
    // A value over parameters alone, which the solver can evaluate before the start.
    let known = |draft: &DaeDraft, e: ExprId| {
        let found = draft.exprs.dependencies(&[e]);
        found.pres.is_empty() && of_parameters(draft, &found)
    };
    let given = |draft: &DaeDraft, q: &FlatEquation| {
        let sides = [(q.lhs, q.rhs), (q.rhs, q.lhs)];
        sides.into_iter().find(|&(a, value)| discrete_atom(draft, a).is_some() && known(draft, value))
    };
    // Nothing to do in most models; the rest costs a pass over all equations.
    if !draft.initial_equations.iter().any(|q| given(draft, q).is_some()) {
        return;
    }
    let all = draft.equations.iter().chain(&draft.initial_equations);
    let joining: Vec<FlatEquation> = all.filter(|q| joins_atoms(draft, q)).copied().collect();
    let mut equals = UnionFind::new(draft.exprs.len());
    for q in &joining {
        equals.union(q.lhs.index(), q.rhs.index());
    }
    let mut before: FxHashMap<usize, Vec<VarId>> = FxHashMap::default();
    for e in joining.iter().flat_map(|q| [q.lhs, q.rhs]) {
        if let ExprNode::Pre(v) = draft.exprs.node(e) {
            before.entry(equals.find(e.index())).or_default().push(v);
        }
    }
    let mut said: FxHashSet<usize> = FxHashSet::default();
    let mut rest = Vec::new();
    for q in std::mem::take(&mut draft.initial_equations) {
        let class = given(draft, &q).map(|(a, value)| (equals.find(a.index()), value));
        match class.and_then(|(class, value)| Some((class, value, before.get(&class)?))) {
            // Only the first value of a class becomes a start, and never against a `fixed` start of the user.
            Some((class, value, starts))
                if !said.contains(&class) && starts.iter().all(|v| !draft.variables[v.index()].fixed) =>
            {
                said.insert(class);
                for v in starts {
                    draft.variables[v.index()].start = Some(value);
                    draft.variables[v.index()].fixed = true;
                }
            }
            _ => rest.push(q),
        }
    }
    // Equations between members of such a class would only repeat what the start values now say.
    rest.retain(|q| !(joins_atoms(draft, q) && said.contains(&equals.find(q.lhs.index()))));
    draft.initial_equations = rest;
}

/// Turns initial equations `pre(v) = value` into start values of `v` where the value is known before the run. Where it
/// is not, a free parameter takes the place of `pre(v)`.
///
/// The solver takes `pre(v)` at the start from the start value, so it is a known quantity of the initial system then.
pub(super) fn absorb_initial_pres(draft: &mut DaeDraft) {
    absorb_through_equals(draft);
    let equations = std::mem::take(&mut draft.initial_equations);
    for equation in equations {
        match given_pre(draft, &equation) {
            Some((v, start)) => {
                draft.variables[v.index()].start = Some(start);
                draft.variables[v.index()].fixed = true;
            }
            None => {
                let equation = with_value_before(draft, equation);
                draft.initial_equations.push(equation);
            }
        }
    }
}

/// An initial equation `pre(v) = value` with a value that is only found at the start (MLS 8.6). A new free parameter
/// stands for `pre(v)` and becomes an unknown of the initial system. Other equations come back unchanged.
fn with_value_before(draft: &mut DaeDraft, equation: FlatEquation) -> FlatEquation {
    let sides = [(equation.lhs, equation.rhs), (equation.rhs, equation.lhs)];
    let found = sides.into_iter().find_map(|(e, value)| match draft.exprs.node(e) {
        ExprNode::Pre(v) if draft.role(v) == SystemRole::Discrete && !draft.variables[v.index()].fixed => {
            Some((v, value))
        }
        _ => None,
    });
    let Some((v, value)) = found.filter(|(v, _)| draft.before_start.iter().all(|(known, _)| known != v)) else {
        return equation;
    };
    let (name, ty) = (format!("pre({})", draft.variables[v.index()].name), draft.variables[v.index()].ty);
    let before = draft.make_variable(name, ty, SystemRole::FreeParameter, equation.origin);
    draft.variables[before.index()].variability = Variability::Parameter;
    draft.before_start.push((v, before));
    FlatEquation { lhs: draft.exprs.var(before), rhs: value, ..equation }
}

/// The variable and its start value, if the equation is `pre(v) = value` with a discrete unknown and a value known
/// before the run. Any `pre(u)` inside the value is replaced by the start of `u`.
/// So the start does not depend on other values before the start.
fn given_pre(draft: &mut DaeDraft, equation: &FlatEquation) -> Option<(VarId, ExprId)> {
    let (v, value) = match (draft.exprs.node(equation.lhs), draft.exprs.node(equation.rhs)) {
        (ExprNode::Pre(v), _) => (v, equation.rhs),
        (_, ExprNode::Pre(v)) => (v, equation.lhs),
        _ => return None,
    };
    let found = draft.exprs.dependencies(&[value]);
    if !of_parameters(draft, &found) || draft.role(v) != SystemRole::Discrete {
        return None;
    }
    let mut replacements = Vec::with_capacity(found.pres.len());
    for u in found.pres {
        let start = draft.variables[u.index()].start;
        let default = super::parameters::default_start(draft.variables[u.index()].ty);
        let value = start.unwrap_or_else(|| draft.exprs.num(default));
        replacements.push((draft.exprs.pre(u), value));
    }
    Some((v, draft.exprs.substitute(value, &replacements)))
}

/// Marks the equations that determine discrete unknowns.
///
/// A lone discrete unknown on the left makes the equation a discrete one, and so does one on the right when the left
/// contains no continuous unknown. What a `when` assigns is determined there and nowhere else.
pub(super) fn classify(draft: &mut DaeDraft) {
    for i in 0..draft.equations.len() {
        if draft.kinds[i] == EquationRole::Continuous && is_discrete(draft, &draft.equations[i]) {
            draft.kinds[i] = EquationRole::Discrete;
        }
    }
}

/// Whether an equation determines a discrete unknown.
/// An equation between a continuous and a discrete unknown is solved for the continuous one, unless the discrete one is
/// alone on the left.
pub(super) fn is_discrete(draft: &DaeDraft, equation: &FlatEquation) -> bool {
    let [left, right] = [equation.lhs, equation.rhs].map(|e| lone_discrete(draft, e));
    if left.is_some_and(|v| may_solve(draft, v)) {
        return true;
    }
    // The left side is a variable that a `when` assigns, so the equation is discrete only if its right side is.
    if left.is_some() {
        return right.is_some() || !has_continuous(draft, equation.rhs);
    }
    right.is_some() && !has_continuous(draft, equation.lhs)
}

/// Whether an expression depends on a continuous unknown or on a derivative.
/// Its value may change between events.
pub(super) fn has_continuous(draft: &DaeDraft, e: ExprId) -> bool {
    let found = draft.exprs.dependencies(&[e]);
    !found.ders.is_empty() || found.vars.iter().any(|&v| draft.role(v) == SystemRole::Continuous)
}

/// Whether equations outside `when` may determine a discrete unknown: those that a `when` assigns are excluded.
pub(super) fn may_solve(draft: &DaeDraft, v: VarId) -> bool {
    !draft.when_assigned[v.index()]
}

/// The discrete unknown that an expression is; `None` for any other expression.
pub(super) fn lone_discrete(draft: &DaeDraft, e: ExprId) -> Option<VarId> {
    match draft.exprs.node(e) {
        ExprNode::Var(v) if draft.role(v) == SystemRole::Discrete => Some(v),
        _ => None,
    }
}

/// The discrete unknowns that a row of the incidence matrix may be solved for. None for a continuous equation; at most
/// one for a definition, at most two for a discrete equation.
/// A variable that a `when` assigns is never among those of a discrete equation.
pub(super) fn lone_unknowns(draft: &DaeDraft, equation: &FlatEquation, kind: EquationRole) -> Vec<VarId> {
    match kind {
        EquationRole::Continuous => Vec::new(),
        EquationRole::Definition => lone_discrete(draft, equation.lhs).into_iter().collect(),
        EquationRole::Discrete => {
            let sides = [equation.lhs, equation.rhs];
            sides.iter().filter_map(|&e| lone_discrete(draft, e)).filter(|&v| may_solve(draft, v)).collect()
        }
    }
}
