//! Parameters and inputs made states that stand still, outputs made states that add up: the Jacobian of the system so
//! made holds every derivative of the original one.

use bramah_expr::visit::Substitution;
use bramah_expr::{ExprId, Exprs, VarId};
use bramah_model::flat::{
    ElementOrigin, FlatEquation, FlatModel, FlatVariable, OriginKind, ScalarType, StateSelect, Variability, WhenAction,
    WhenClause,
};

/// A flat model whose chosen parameters and inputs are states with derivative 0, and whose outputs are the derivatives
/// of further states.
#[derive(Clone, Debug)]
pub struct StateAugmentedModel {
    /// The model.
    pub flat: FlatModel,
    /// For each chosen parameter, in the order asked for.
    pub parameters: Vec<AugmentedState>,
    /// For each top-level input, in declaration order.
    pub inputs: Vec<AugmentedState>,
    /// For each output asked for: the state whose derivative it is.
    pub outputs: Vec<VarId>,
}

/// A quantity that became a state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AugmentedState {
    /// The state.
    pub state: VarId,
    /// The parameter that holds its value at the start.
    pub start: VarId,
}

/// Lifts `parameters`, all inputs and `outputs`. Parameters that depend on lifted ones become expressions of them;
/// attributes (`start`, `nominal`, bounds) keep reading the parameters' values at the start.
pub fn lift(flat: &FlatModel, parameters: &[VarId], outputs: &[VarId]) -> StateAugmentedModel {
    let mut lift = StateAugmentation::new(flat.clone());
    let raised: Vec<AugmentedState> = parameters.iter().map(|&p| lift.parameter(p)).collect();
    lift.dependents(parameters);
    lift.substitute();
    let inputs = (0..).map(VarId).zip(&flat.variables).filter(|(_, v)| v.input).map(|(v, _)| v);
    let inputs: Vec<AugmentedState> = inputs.map(|u| lift.input(u)).collect();
    let outputs = outputs.iter().map(|&y| lift.output(y)).collect();
    StateAugmentedModel { flat: lift.flat, parameters: raised, inputs, outputs }
}

/// Lifts parameters alone: inputs stay inputs.
pub fn free(flat: &FlatModel, parameters: &[VarId]) -> StateAugmentedModel {
    let mut lift = StateAugmentation::new(flat.clone());
    let parameters: Vec<AugmentedState> = parameters.iter().map(|&p| lift.parameter(p)).collect();
    let originals: Vec<VarId> = parameters.iter().map(|r| r.start).collect();
    lift.dependents(&originals);
    lift.substitute();
    StateAugmentedModel { flat: lift.flat, parameters, inputs: Vec::new(), outputs: Vec::new() }
}

struct StateAugmentation {
    flat: FlatModel,
    replacements: Vec<(ExprId, ExprId)>,
}

impl StateAugmentation {
    fn new(flat: FlatModel) -> Self {
        StateAugmentation { flat, replacements: Vec::new() }
    }

    fn add(&mut self, variable: FlatVariable) -> VarId {
        let v = VarId(u32::try_from(self.flat.variables.len()).expect("fewer than 2^32 variables"));
        self.flat.variables.push(variable);
        v
    }

    /// A hidden variable like `of` under another name.
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

    fn equation(&mut self, lhs: ExprId, rhs: ExprId, of: VarId) {
        let origin = ElementOrigin { kind: OriginKind::Made, ..self.flat.variables[of.index()].origin };
        self.flat.equations.push(FlatEquation { lhs, rhs, origin });
    }

    /// `der(state) = 0` from the value of `start`.
    fn stand_still(&mut self, state: VarId, start: VarId) {
        let value = self.flat.exprs.var(start);
        let variable = &mut self.flat.variables[state.index()];
        variable.start = Some(value);
        variable.fixed = true;
        variable.state_select = StateSelect::Always;
        let der = self.flat.exprs.der(state);
        self.equation(der, Exprs::ZERO, state);
    }

    fn parameter(&mut self, p: VarId) -> AugmentedState {
        let name = format!("{} (free)", self.flat.variables[p.index()].name);
        let state = self.beside(p, name, Variability::Continuous);
        self.stand_still(state, p);
        self.replace(p, state);
        AugmentedState { state, start: p }
    }

    fn replace(&mut self, old: VarId, new: VarId) {
        let (old, new) = (self.flat.exprs.var(old), self.flat.exprs.var(new));
        self.replacements.push((old, new));
    }

    /// Real parameters whose bindings read a lifted one, however indirectly: their bindings, over the states, stand in
    /// their place.
    fn dependents(&mut self, lifted: &[VarId]) {
        let mut open = reading(&self.flat, lifted);
        loop {
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

    /// Puts the states in the place of their parameters in everything that holds during the run.
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

    fn output(&mut self, y: VarId) -> VarId {
        let name = format!("integral of {}", self.flat.variables[y.index()].name);
        let sum = self.beside(y, name, Variability::Continuous);
        let variable = &mut self.flat.variables[sum.index()];
        variable.start = Some(Exprs::ZERO);
        variable.fixed = true;
        variable.unit = None;
        variable.state_select = StateSelect::Always;
        let (der, value) = (self.flat.exprs.der(sum), self.flat.exprs.var(y));
        self.equation(der, value, y);
        sum
    }
}

/// Real parameters with bindings that read one of these, however indirectly.
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
