//! The system while it is being analysed: one pool, all variables and equations, and what is known about them so far.

use super::{CrossingKind, DelayInput, EventAction, EventActionKind, SampleEvent, ZeroCrossing};
use crate::flat::{self, FlatModel, ScalarType, Variability};
use bramah_expr::{ExprId, ExprNode, Exprs, VarId};

/// What a variable is to the sorted systems.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SystemRole {
    /// A constant, or a parameter whose value is known before the run.
    Parameter,
    /// A parameter found at initialization.
    FreeParameter,
    /// Comes from outside.
    Input,
    /// Set by the solver at events: the mode of a `sample`.
    Sample,
    /// Unknown, changes at events only.
    Discrete,
    /// Unknown, changes at any time.
    Continuous,
    /// Equals another variable.
    Alias,
}

/// Which unknowns an equation may be solved for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum EquationRole {
    /// Any continuous unknown.
    Continuous,
    /// A lone discrete unknown on either side.
    Discrete,
    /// The variable on its left side only.
    Definition,
}

/// A variable or its negative.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct SignedVariable {
    pub variable: VarId,
    pub negated: bool,
}

impl SignedVariable {
    /// The variable, or its negative.
    pub fn expression(self, pool: &mut Exprs) -> ExprId {
        let e = pool.var(self.variable);
        if self.negated { pool.neg(e) } else { e }
    }
}

/// The system in the making.
#[derive(Clone, Debug, Default)]
pub(super) struct DaeDraft {
    pub exprs: Exprs,
    pub variables: Vec<flat::FlatVariable>,
    pub roles: Vec<SystemRole>,
    /// Assigned in a `when`, so that no other equation can determine it.
    pub when_assigned: Vec<bool>,
    /// The variable that is the derivative of a variable, if there is one.
    pub derivative: Vec<Option<SignedVariable>>,
    pub equations: Vec<flat::FlatEquation>,
    /// Parallel to `equations`.
    pub kinds: Vec<EquationRole>,
    pub initial_equations: Vec<flat::FlatEquation>,
    /// Discrete unknowns whose values before the start initial equations determine, with the unknowns that these are.
    pub before_start: Vec<(VarId, VarId)>,
    pub whens: Vec<flat::WhenClause>,
    pub asserts: Vec<flat::FlatAssertion>,
    pub conserved: Vec<flat::ConservationDeclaration>,
    pub crossings: Vec<ZeroCrossing>,
    pub samples: Vec<SampleEvent>,
    pub delays: Vec<DelayInput>,
    pub actions: Vec<EventAction>,
    pub instances: Vec<flat::InstanceInfo>,
    /// Equations that must hold at the start although they determine nothing there.
    pub initial_checks: Vec<flat::FlatEquation>,
}

impl DaeDraft {
    /// The flat model with every variable's role, equations not yet classified.
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

    /// `pre` of a variable that no `when` assigns is the variable: it does not move while an event is being handled.
    fn let_continuous_be_their_left_limit(&mut self) {
        let roles = self.roles.clone();
        let continuous = |v: VarId| roles[v.index()] == SystemRole::Continuous;
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

    /// All variables of a role, in order.
    pub fn with_role(&self, role: SystemRole) -> Vec<VarId> {
        (0..self.variables.len()).filter(|&i| self.roles[i] == role).map(|i| VarId(i as u32)).collect()
    }

    /// Adds a variable made by the compiler.
    pub fn make_variable(
        &mut self,
        name: String,
        ty: ScalarType,
        role: SystemRole,
        origin: flat::ElementOrigin,
    ) -> VarId {
        let variability = if role == SystemRole::Continuous { Variability::Continuous } else { Variability::Discrete };
        // a variable is large: twice as many places as are needed would be most of what a model takes
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

    /// An expression as the user would write it, not too long.
    pub fn text(&self, e: ExprId) -> String {
        self.exprs.print_short(e, &|v| self.variables[v.index()].name.clone(), 80)
    }

    /// Adds an equation.
    pub fn add_equation(&mut self, equation: flat::FlatEquation, kind: EquationRole) {
        self.equations.push(equation);
        self.kinds.push(kind);
    }

    /// Replaces every expression by what `map` says; those beyond it were made along with the map.
    pub fn map_expressions(&mut self, map: &[ExprId]) {
        self.each_expression(|e| *e = map.get(e.index()).copied().unwrap_or(*e));
    }

    /// Calls `visit` with every expression there is.
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

    /// Which nodes of the pool any expression holds; earlier stages leave others behind that may mean nothing here.
    pub fn live_nodes(&mut self) -> Vec<bool> {
        let mut live = vec![false; self.exprs.len()];
        self.each_expression(|e| live[e.index()] = true);
        // Arguments have smaller ids than their node.
        for i in (0..live.len()).rev() {
            if live[i] {
                for a in self.exprs.operands(ExprId(i as u32)).as_slice() {
                    live[a.index()] = true;
                }
            }
        }
        live
    }

    /// The image of every live node of the pool when `leaf` replaces some of them, arguments first.
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

/// The node with its arguments replaced; itself when they stay.
pub(super) fn carried(pool: &mut Exprs, e: ExprId, map: &[ExprId]) -> ExprId {
    if pool.operands(e).as_slice().iter().all(|&a| map[a.index()] == a) {
        return e;
    }
    pool.with_operands(e, |a| map[a.index()])
}

fn role(v: &flat::FlatVariable, when_assigned: bool) -> SystemRole {
    match v.variability {
        Variability::Constant => SystemRole::Parameter,
        Variability::Parameter if v.fixed || v.binding.is_some() && v.start.is_none() => SystemRole::Parameter,
        Variability::Parameter => SystemRole::FreeParameter,
        _ if v.input => SystemRole::Input,
        Variability::Discrete => SystemRole::Discrete,
        Variability::Continuous if v.ty != ScalarType::Real || when_assigned => SystemRole::Discrete,
        Variability::Continuous => SystemRole::Continuous,
    }
}

fn each_of_message(message: &mut flat::MessageTemplate, visit: &mut impl FnMut(&mut ExprId)) {
    for part in &mut message.parts {
        if let flat::MessagePart::Value(e, _) = part {
            visit(e);
        }
    }
}

fn each_of_assert(assert: &mut flat::FlatAssertion, visit: &mut impl FnMut(&mut ExprId)) {
    visit(&mut assert.condition);
    each_of_message(&mut assert.message, visit);
}

fn each_of_crossing(crossing: &mut ZeroCrossing, visit: &mut impl FnMut(&mut ExprId)) {
    match &mut crossing.kind {
        CrossingKind::Relation(_, a, b) => {
            visit(a);
            visit(b);
        }
        CrossingKind::Time(_, e) | CrossingKind::Floor(e) => visit(e),
    }
}

fn each_of_action(action: &mut EventAction, visit: &mut impl FnMut(&mut ExprId)) {
    visit(&mut action.fires);
    match &mut action.kind {
        EventActionKind::Reinit(_, value) => visit(value),
        EventActionKind::Terminate(message) => each_of_message(message, visit),
        EventActionKind::Assert(assert) => each_of_assert(assert, visit),
    }
}
