//! Lifts parameters and inputs to constant states and outputs to derivatives of further states.
//!
//! A [`FlatModel`] enters; a [`StateAugmentedModel`] leaves. Its equations hold der(p) = 0 for each lifted quantity p
//! and der(s) = y for each output y. The Jacobian of this system by its states therefore holds all derivatives of the
//! original model: by states, parameters and inputs, of rates and outputs. `local` and `tangent` evaluate it.

use bramah_expr::visit::Substitution;
use bramah_expr::{ExprId, Exprs, VarId};
use bramah_model::flat::{
    ElementOrigin, FlatEquation, FlatModel, FlatVariable, OriginKind, ScalarType, StateSelect, Variability, WhenAction,
    WhenClause,
};

/// A lifted model.
#[derive(Clone, Debug)]
pub struct StateAugmentedModel {
    /// The lifted equations. Variables of the original model keep their ids.
    pub flat: FlatModel,
    /// The lifted parameters, in the order requested.
    pub parameters: Vec<AugmentedState>,
    /// The lifted top-level inputs, in declaration order.
    pub inputs: Vec<AugmentedState>,
    /// For each output requested the state whose derivative it is.
    pub outputs: Vec<VarId>,
}

/// A parameter or input that became a state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AugmentedState {
    /// The state.
    pub state: VarId,
    /// The parameter that holds the state's start value.
    pub start: VarId,
}

/// Lifts `parameters`, all inputs and `outputs`.
///
/// Parameters that depend on lifted ones become expressions of them. Attributes (`start`, `nominal`, bounds) keep
/// reading the parameters' values at the start.
pub fn lift(flat: &FlatModel, parameters: &[VarId], outputs: &[VarId]) -> StateAugmentedModel {
    let mut lift = StateAugmentation::new(flat.clone());
    let raised: Vec<AugmentedState> = parameters.iter().map(|&p| lift.parameter(p)).collect();
    lift.dependents(parameters);
    // Inputs need no substitution: the variable itself becomes the state.
    lift.substitute();
    let inputs = (0..).map(VarId).zip(&flat.variables).filter(|(_, v)| v.input).map(|(v, _)| v);
    let inputs: Vec<AugmentedState> = inputs.map(|u| lift.input(u)).collect();
    let outputs = outputs.iter().map(|&y| lift.output(y)).collect();
    StateAugmentedModel { flat: lift.flat, parameters: raised, inputs, outputs }
}

/// Lifts `parameters` alone; inputs stay inputs.
pub fn free(flat: &FlatModel, parameters: &[VarId]) -> StateAugmentedModel {
    let mut lift = StateAugmentation::new(flat.clone());
    let parameters: Vec<AugmentedState> = parameters.iter().map(|&p| lift.parameter(p)).collect();
    let originals: Vec<VarId> = parameters.iter().map(|r| r.start).collect();
    lift.dependents(&originals);
    lift.substitute();
    StateAugmentedModel { flat: lift.flat, parameters, inputs: Vec::new(), outputs: Vec::new() }
}

/// A flat model while it is lifted.
struct StateAugmentation {
    /// The model, changed in place.
    flat: FlatModel,
    /// Expressions to replace, each with its replacement.
    replacements: Vec<(ExprId, ExprId)>,
}

impl StateAugmentation {
    /// Starts with a model and no replacements.
    fn new(flat: FlatModel) -> Self {
        StateAugmentation { flat, replacements: Vec::new() }
    }

    /// Adds a variable and returns its id.
    fn add(&mut self, variable: FlatVariable) -> VarId {
        let v = VarId(u32::try_from(self.flat.variables.len()).expect("fewer than 2^32 variables"));
        self.flat.variables.push(variable);
        v
    }

    /// Adds a hidden variable with the attributes of `of` under another name.
    fn beside(&mut self, of: VarId, name: String, variability: Variability) -> VarId {
        let model = &self.flat.variables[of.index()];
        let origin = ElementOrigin { kind: OriginKind::Made, ..model.origin };
        let variable = FlatVariable {
            hidden: true,
            unwanted: true,
            fixed: variability <= Variability::Parameter,
            nominal: model.nominal,
            unit: model.unit.clone(),
            display_unit: model.display_unit.clone(),
            description: model.description.clone(),
            ..FlatVariable::plain(name, ScalarType::Real, variability, origin)
        };
        self.add(variable)
    }

    /// Adds an equation with the origin of the variable `of`.
    fn equation(&mut self, lhs: ExprId, rhs: ExprId, of: VarId) {
        let origin = ElementOrigin { kind: OriginKind::Made, ..self.flat.variables[of.index()].origin };
        self.flat.equations.push(FlatEquation { lhs, rhs, origin });
    }

    /// Makes a variable a constant state: `der(state) = 0`, started at the value of `start`.
    fn stand_still(&mut self, state: VarId, start: VarId) {
        let value = self.flat.exprs.var(start);
        let variable = &mut self.flat.variables[state.index()];
        variable.start = Some(value);
        variable.fixed = true;
        // The structural analysis must choose this variable as a state.
        variable.state_select = StateSelect::Always;
        let der = self.flat.exprs.der(state);
        self.equation(der, Exprs::ZERO, state);
    }

    /// Lifts a parameter. The parameter itself remains and holds the start value.
    fn parameter(&mut self, p: VarId) -> AugmentedState {
        let name = format!("{} (free)", self.flat.variables[p.index()].name);
        let state = self.beside(p, name, Variability::Continuous);
        self.stand_still(state, p);
        self.replace(p, state);
        AugmentedState { state, start: p }
    }

    /// Notes that a variable is to be replaced by another one.
    fn replace(&mut self, old: VarId, new: VarId) {
        let (old, new) = (self.flat.exprs.var(old), self.flat.exprs.var(new));
        self.replacements.push((old, new));
    }

    /// Notes for each Real parameter that depends on a lifted one its binding as a replacement.
    fn dependents(&mut self, lifted: &[VarId]) {
        let mut open = reading(&self.flat, lifted);
        loop {
            // A binding that reads another dependent parameter waits until that one has its replacement.
            let ready = |&(_, binding): &(VarId, ExprId)| {
                !self.flat.exprs.variables(binding).iter().any(|w| open.iter().any(|(v, _)| v == w))
            };
            let (found, rest): (Vec<_>, Vec<_>) = open.iter().copied().partition(ready);
            if found.is_empty() {
                break;
            }
            let mut substitution = Substitution::new(self.replacements.iter().copied());
            for (v, binding) in found {
                let value = substitution.apply(&mut self.flat.exprs, binding);
                self.replacements.push((self.flat.exprs.var(v), value));
            }
            open = rest;
        }
    }

    /// Applies the replacements to everything that holds during a run.
    fn substitute(&mut self) {
        let mut substitution = Substitution::new(self.replacements.drain(..));
        let FlatModel { exprs, equations, initial_equations, whens, asserts, conserved, .. } = &mut self.flat;
        let mut change = |e: &mut ExprId| *e = substitution.apply(exprs, *e);
        for equation in equations.iter_mut().chain(initial_equations) {
            change(&mut equation.lhs);
            change(&mut equation.rhs);
        }
        asserts.iter_mut().for_each(|a| change(&mut a.condition));
        conserved.iter_mut().for_each(|c| [&mut c.quantity, &mut c.rate].into_iter().for_each(&mut change));
        whens.iter_mut().for_each(|w| change_when(w, &mut change));
    }

    /// Lifts an input: the variable becomes a state, and a new parameter holds its start value.
    fn input(&mut self, u: VarId) -> AugmentedState {
        let variable = &self.flat.variables[u.index()];
        let binding = variable.binding.or(variable.start);
        let name = format!("{} (start)", variable.name);
        let start = self.beside(u, name, Variability::Parameter);
        self.flat.variables[start.index()].binding = Some(binding.unwrap_or(Exprs::ZERO));
        let variable = &mut self.flat.variables[u.index()];
        variable.input = false;
        variable.binding = None;
        variable.variability = Variability::Continuous;
        self.stand_still(u, start);
        AugmentedState { state: u, start }
    }

    /// Adds a state whose derivative is `y`.
    fn output(&mut self, y: VarId) -> VarId {
        let name = format!("integral of {}", self.flat.variables[y.index()].name);
        let sum = self.beside(y, name, Variability::Continuous);
        let variable = &mut self.flat.variables[sum.index()];
        variable.start = Some(Exprs::ZERO);
        variable.fixed = true;
        // The unit of y would be wrong for its integral.
        variable.unit = None;
        variable.state_select = StateSelect::Always;
        let (der, value) = (self.flat.exprs.der(sum), self.flat.exprs.var(y));
        self.equation(der, value, y);
        sum
    }
}

/// Real parameters whose bindings depend on one of these, directly or not, with their bindings.
pub(super) fn reading(flat: &FlatModel, lifted: &[VarId]) -> Vec<(VarId, ExprId)> {
    let mut moved = vec![false; flat.variables.len()];
    lifted.iter().for_each(|p| moved[p.index()] = true);
    let mut found = Vec::new();
    loop {
        let before = found.len();
        for (v, variable) in (0..).map(VarId).zip(&flat.variables) {
            let real = variable.variability == Variability::Parameter && variable.ty == ScalarType::Real;
            let Some(binding) = variable.binding.filter(|_| real && !moved[v.index()]) else { continue };
            if flat.exprs.variables(binding).iter().any(|w| moved[w.index()]) {
                moved[v.index()] = true;
                found.push((v, binding));
            }
        }
        if found.len() == before {
            return found;
        }
    }
}

/// Applies a change to all expressions of a `when` clause.
fn change_when(when: &mut WhenClause, change: &mut impl FnMut(&mut ExprId)) {
    for branch in &mut when.branches {
        branch.conditions.iter_mut().for_each(&mut *change);
        for action in &mut branch.actions {
            match action {
                WhenAction::Assign { value, .. } => change(value),
                WhenAction::Reinit { value, guard, .. } => [value, guard].into_iter().for_each(&mut *change),
                WhenAction::Assert(assert) => change(&mut assert.condition),
                WhenAction::Terminate { guard, .. } => change(guard),
            }
        }
    }
}
