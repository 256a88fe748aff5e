//! The system while it is being analysed: one expression pool, all variables and equations, and what is known so far.
//!
//! [`DaeDraft::new`] copies the flat model and gives each variable its role. The steps of `analysis` then change the
//! draft in place: they add variables and equations, rewrite expressions and reclassify unknowns. `analysis::assemble`
//! turns the final draft into a `Dae`.

use super::{CrossingKind, DelayInput, EventAction, EventActionKind, SampleEvent, ZeroCrossing};
use crate::flat::{self, FlatModel, ScalarType, Variability};
use bramah_expr::{ExprId, ExprNode, Exprs, VarId};

/// What a variable is to the sorted systems: known, unknown, or eliminated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SystemRole {
    /// A constant, or a parameter whose value is known before the run.
    Parameter,
    /// A parameter found at initialization.
    FreeParameter,
    /// A value that comes from outside: a top-level input, or the stand-in of a `delay`.
    Input,
    /// Set by the solver at events: the mode of a `sample`.
    Sample,
    /// An unknown that changes at events only.
    Discrete,
    /// An unknown that may change at any time.
    Continuous,
    /// Equals another variable, or its negative. No expression contains it after alias elimination.
    Alias,
}

/// Which unknowns an equation may be solved for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum EquationRole {
    /// Any continuous unknown in it.
    Continuous,
    /// A discrete unknown that is one of its sides by itself.
    Discrete,
    /// Only the variable that is its left side.
    Definition,
}

/// A variable or its negative.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct SignedVariable {
    /// The variable.
    pub variable: VarId,
    /// True for the negative.
    pub negated: bool,
}

impl SignedVariable {
    /// Interns the variable, or its negative, in the pool.
    pub fn expression(self, pool: &mut Exprs) -> ExprId {
        let e = pool.var(self.variable);
        if self.negated { pool.neg(e) } else { e }
    }
}

/// The system during the analysis.
///
/// `roles`, `when_assigned` and `derivative` are parallel to `variables`; `kinds` is parallel to `equations`.
#[derive(Clone, Debug, Default)]
pub(super) struct DaeDraft {
    /// The pool of all expressions. It also holds nodes that no field refers to: see [`DaeDraft::live_nodes`].
    pub exprs: Exprs,
    /// The flat variables, then those that the analysis makes.
    pub variables: Vec<flat::FlatVariable>,
    /// By variable: its role.
    pub roles: Vec<SystemRole>,
    /// By variable: whether a `when` assigns it, so that no other equation can determine it.
    pub when_assigned: Vec<bool>,
    /// By variable: the variable that is its time derivative. `None` where the derivative is no variable.
    pub derivative: Vec<Option<SignedVariable>>,
    /// All equations of the run, those of index reduction included.
    pub equations: Vec<flat::FlatEquation>,
    /// By equation: its role.
    pub kinds: Vec<EquationRole>,
    /// Equations that hold at the start only.
    pub initial_equations: Vec<flat::FlatEquation>,
    /// Discrete unknowns `v` whose `pre(v)` an initial equation determines, each with the free parameter that stands
    /// for `pre(v)`.
    pub before_start: Vec<(VarId, VarId)>,
    /// The `when` clauses. `discrete::translate_whens` empties this list.
    pub whens: Vec<flat::WhenClause>,
    /// Assertions outside `when`.
    pub asserts: Vec<flat::FlatAssertion>,
    /// Statements `Connections.conserved`.
    pub conserved: Vec<flat::ConservationDeclaration>,
    /// Relations and `floor`s that make events.
    pub crossings: Vec<ZeroCrossing>,
    /// Replaced `sample` expressions.
    pub samples: Vec<SampleEvent>,
    /// Replaced `delay` expressions, inner ones before those that contain them.
    pub delays: Vec<DelayInput>,
    /// Actions of `when` clauses that are no assignments.
    pub actions: Vec<EventAction>,
    /// Component instances, for messages.
    pub instances: Vec<flat::InstanceInfo>,
    /// Equations that must hold at the start although they determine nothing there.
    pub initial_checks: Vec<flat::FlatEquation>,
}

impl DaeDraft {
    /// Copies the flat model and gives each variable its role. All equations count as continuous until
    /// `discrete::classify` runs.
    pub fn new(flat: &FlatModel) -> Self {
        let mut when_assigned = vec![false; flat.variables.len()];
        for action in flat.whens.iter().flat_map(|w| &w.branches).flat_map(|b| &b.actions) {
            if let flat::WhenAction::Assign { variable, .. } = action {
                when_assigned[variable.index()] = true;
            }
        }
        let roles: Vec<SystemRole> =
            flat.variables.iter().zip(&when_assigned).map(|(v, &assigned)| role(v, assigned)).collect();
        let mut variables = flat.variables.clone();
        for (v, _) in variables.iter_mut().zip(&roles).filter(|(_, role)| **role == SystemRole::Discrete) {
            // A Real that a `when` assigns is declared continuous but changes at events only.
            v.variability = Variability::Discrete;
        }
        let mut draft = DaeDraft {
            exprs: flat.exprs.clone(),
            variables,
            roles,
            when_assigned,
            derivative: vec![None; flat.variables.len()],
            equations: flat.equations.clone(),
            kinds: vec![EquationRole::Continuous; flat.equations.len()],
            initial_equations: flat.initial_equations.clone(),
            before_start: Vec::new(),
            whens: flat.whens.clone(),
            asserts: flat.asserts.clone(),
            conserved: flat.conserved.clone(),
            instances: flat.instances.clone(),
            ..DaeDraft::default()
        };
        draft.let_continuous_be_their_left_limit();
        draft
    }

    /// Replaces `pre(v)` of a continuous `v` by `v`: it does not jump while an event is being handled.
    fn let_continuous_be_their_left_limit(&mut self) {
        let roles = self.roles.clone();
        let continuous = |v: VarId| roles[v.index()] == SystemRole::Continuous;
        // Most models have no such `pre`; rewriting all expressions would be wasted work.
        let mut nodes = (0..self.exprs.len() as u32).map(|i| self.exprs.node(ExprId(i)));
        if !nodes.any(|node| matches!(node, ExprNode::Pre(v) if continuous(v))) {
            return;
        }
        let map = self.rewritten(|pool, node| match node {
            ExprNode::Pre(v) if continuous(v) => Some(pool.var(v)),
            _ => None,
        });
        self.map_expressions(&map);
    }

    /// The role of a variable.
    pub fn role(&self, v: VarId) -> SystemRole {
        self.roles[v.index()]
    }

    /// All variables of a role, in ascending order.
    pub fn with_role(&self, role: SystemRole) -> Vec<VarId> {
        (0..self.variables.len()).filter(|&i| self.roles[i] == role).map(|i| VarId(i as u32)).collect()
    }

    /// Adds a variable made by the compiler and returns its number. It is hidden and unwanted, so results never show
    /// it; its name serves messages. `when_assigned` and `derivative` get an entry too, so the parallel lists stay
    /// parallel.
    pub fn make_variable(
        &mut self,
        name: String,
        ty: ScalarType,
        role: SystemRole,
        origin: flat::ElementOrigin,
    ) -> VarId {
        let variability = if role == SystemRole::Continuous { Variability::Continuous } else { Variability::Discrete };
        // Grow by an eighth instead of doubling: a variable is a large record, and spare capacity would dominate the
        // memory of a large model.
        if self.variables.len() == self.variables.capacity() {
            self.variables.reserve_exact(self.variables.len() / 8 + 64);
        }
        self.variables.push(flat::FlatVariable {
            hidden: true,
            unwanted: true,
            ..flat::FlatVariable::plain(name, ty, variability, origin)
        });
        self.roles.push(role);
        self.when_assigned.push(false);
        self.derivative.push(None);
        VarId(self.variables.len() as u32 - 1)
    }

    /// An expression as the user would write it, cut after 80 characters.
    pub fn text(&self, e: ExprId) -> String {
        self.exprs.print_short(e, &|v| self.variables[v.index()].name.clone(), 80)
    }

    /// Appends an equation with its role. Its index is `equations.len() - 1` afterwards.
    pub fn add_equation(&mut self, equation: flat::FlatEquation, kind: EquationRole) {
        self.equations.push(equation);
        self.kinds.push(kind);
    }

    /// Replaces every expression `e` by `map[e]`. Expressions beyond the end of the map stay: they were interned while
    /// the map was made and are images already.
    pub fn map_expressions(&mut self, map: &[ExprId]) {
        self.each_expression(|e| *e = map.get(e.index()).copied().unwrap_or(*e));
    }

    /// Calls `visit` with every expression that the draft holds. A new field with expressions must be added here, else
    /// rewriting would leave stale expressions in it.
    pub fn each_expression(&mut self, mut visit: impl FnMut(&mut ExprId)) {
        for v in &mut self.variables {
            [&mut v.binding, &mut v.start, &mut v.min, &mut v.max, &mut v.nominal]
                .into_iter()
                .flatten()
                .for_each(&mut visit);
        }
        let equations = self.equations.iter_mut().chain(&mut self.initial_equations);
        for equation in equations.chain(&mut self.initial_checks) {
            visit(&mut equation.lhs);
            visit(&mut equation.rhs);
        }
        for branch in self.whens.iter_mut().flat_map(|w| &mut w.branches) {
            branch.conditions.iter_mut().for_each(&mut visit);
            for action in &mut branch.actions {
                match action {
                    flat::WhenAction::Assign { value, .. } => visit(value),
                    flat::WhenAction::Reinit { value, guard, .. } => [value, guard].into_iter().for_each(&mut visit),
                    flat::WhenAction::Assert(assert) => each_of_assert(assert, &mut visit),
                    flat::WhenAction::Terminate { message, guard, .. } => {
                        visit(guard);
                        each_of_message(message, &mut visit);
                    }
                }
            }
        }
        self.asserts.iter_mut().for_each(|assert| each_of_assert(assert, &mut visit));
        self.conserved.iter_mut().flat_map(|c| [&mut c.quantity, &mut c.rate, &mut c.state]).for_each(&mut visit);
        self.crossings.iter_mut().for_each(|crossing| each_of_crossing(crossing, &mut visit));
        for sample in &mut self.samples {
            visit(&mut sample.start);
            visit(&mut sample.interval);
        }
        for delay in &mut self.delays {
            visit(&mut delay.source);
            visit(&mut delay.time);
        }
        self.actions.iter_mut().for_each(|action| each_of_action(action, &mut visit));
    }

    /// By node of the pool: whether some expression of the draft contains it. Earlier stages leave nodes in the pool
    /// that no expression contains any more, and whose variables may have no meaning here.
    pub fn live_nodes(&mut self) -> Vec<bool> {
        let mut live = vec![false; self.exprs.len()];
        self.each_expression(|e| live[e.index()] = true);
        // Arguments have smaller ids than their node.
        // Arguments have smaller ids than their node, so one descending pass reaches all of them.
        for i in (0..live.len()).rev() {
            if live[i] {
                for a in self.exprs.operands(ExprId(i as u32)).as_slice() {
                    live[a.index()] = true;
                }
            }
        }
        live
    }

    /// The image of every live node of the pool, by node. `leaf` gives the image of a node, or `None` to rebuild the
    /// node from the images of its arguments. Dead nodes map to themselves.
    pub fn rewritten(&mut self, mut leaf: impl FnMut(&mut Exprs, ExprNode) -> Option<ExprId>) -> Vec<ExprId> {
        let live = self.live_nodes();
        let mut map = Vec::with_capacity(live.len());
        for i in 0..live.len() as u32 {
            if !live[i as usize] {
                map.push(ExprId(i));
                continue;
            }
            let node = self.exprs.node(ExprId(i));
            let image = match leaf(&mut self.exprs, node) {
                Some(image) => image,
                None => carried(&mut self.exprs, ExprId(i), &map),
            };
            map.push(image);
        }
        map
    }
}

/// The node with its arguments replaced by their images; the node itself when no argument changes. All arguments must
/// be in `map` already.
pub(super) fn carried(pool: &mut Exprs, e: ExprId, map: &[ExprId]) -> ExprId {
    if pool.operands(e).as_slice().iter().all(|&a| map[a.index()] == a) {
        return e;
    }
    pool.with_operands(e, |a| map[a.index()])
}

/// The role of a flat variable before aliases are known: it follows from variability, type, `fixed`, and whether a
/// `when` assigns the variable.
fn role(v: &flat::FlatVariable, when_assigned: bool) -> SystemRole {
    match v.variability {
        Variability::Constant => SystemRole::Parameter,
        // `fixed = false` with a binding and no `start` still has a value: the binding.
        Variability::Parameter if v.fixed || v.binding.is_some() && v.start.is_none() => SystemRole::Parameter,
        Variability::Parameter => SystemRole::FreeParameter,
        _ if v.input => SystemRole::Input,
        Variability::Discrete => SystemRole::Discrete,
        // Boolean, Integer and enumeration unknowns are piecewise constant in Modelica (MLS 3.8).
        Variability::Continuous if v.ty != ScalarType::Real || when_assigned => SystemRole::Discrete,
        Variability::Continuous => SystemRole::Continuous,
    }
}

/// Visits the values inside a message.
fn each_of_message(message: &mut flat::MessageTemplate, visit: &mut impl FnMut(&mut ExprId)) {
    for part in &mut message.parts {
        if let flat::MessagePart::Value(e, _) = part {
            visit(e);
        }
    }
}

/// Visits the condition and the message of an assertion.
fn each_of_assert(assert: &mut flat::FlatAssertion, visit: &mut impl FnMut(&mut ExprId)) {
    visit(&mut assert.condition);
    each_of_message(&mut assert.message, visit);
}

/// Visits what a crossing watches.
fn each_of_crossing(crossing: &mut ZeroCrossing, visit: &mut impl FnMut(&mut ExprId)) {
    match &mut crossing.kind {
        CrossingKind::Relation(_, a, b) => {
            visit(a);
            visit(b);
        }
        CrossingKind::Time(_, e) | CrossingKind::Floor(e) => visit(e),
    }
}

/// Visits when an action happens and what it evaluates.
fn each_of_action(action: &mut EventAction, visit: &mut impl FnMut(&mut ExprId)) {
    visit(&mut action.fires);
    match &mut action.kind {
        EventActionKind::Reinit(_, value) => visit(value),
        EventActionKind::Terminate(message) => each_of_message(message, visit),
        EventActionKind::Assert(assert) => each_of_assert(assert, visit),
    }
}
