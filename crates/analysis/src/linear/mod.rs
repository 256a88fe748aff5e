//! Linear state-space models at an operating point: x' = A x + B u, y = C x + D u, with poles, zeros and frequency
//! responses, and the quasi-linear form over a grid of operating points.
//!
//! A compiled model, the names of inputs and outputs ([`InputOutputSelection`]) and a state of a run enter;
//! [`linearize`] returns a [`StateSpace`] with exact derivatives, [`schedule()`] a [`QuasiLpvModel`]. The commands
//! `bramah linearize` and `bramah steady` and the trait [`crate::Analyze`] call it. The user's page is
//! `docs/linearize.md`.

mod export;
mod frequency;
mod modal;
mod schedule;
mod scheduled;

pub use export::{csv, mat, modelica, words};
pub use frequency::{bode, plane, response};
pub use modal::{Pole, poles, zeros};
pub use schedule::{QuasiLpvModel, schedule};

use super::local::{EvaluationPlan, LocalError, LocalEvaluator};
use super::{StateAugmentedModel, lift};
use bramah_circuit::compiled::CompiledModel;
use bramah_expr::VarId;
use bramah_model::flat::{FlatModel, FlatVariable, ScalarType, Variability};
use bramah_solve::State;
use bramah_syntax::diag::{Code, Diagnostic, nearest};
use nalgebra::DMatrix;
use std::sync::Arc;

/// A state, input or output of a linear model.
#[derive(Clone, Debug, PartialEq)]
pub struct Quantity {
    /// Its dotted name in the model.
    pub name: String,
    /// Its unit; empty for none.
    pub unit: String,
    /// Its value at the operating point.
    pub value: f64,
    /// Its nominal value, positive; matrices are scaled by it.
    pub nominal: f64,
}

impl Quantity {
    /// A variable of the model with its values.
    fn of(variable: &FlatVariable, value: f64, nominal: f64) -> Self {
        let unit = variable.unit.as_deref().unwrap_or("").to_owned();
        Quantity { name: variable.name.clone(), unit, value, nominal }
    }

    /// Name and unit, for comments and descriptions in files.
    fn words(&self) -> String {
        let unit = if self.unit.is_empty() { "1" } else { &self.unit };
        format!("{} in {unit}", self.name)
    }
}

/// A linear model of n states, m inputs and p outputs. Its quantities are deviations from their values at the operating
/// point.
#[derive(Clone, Debug)]
pub struct StateSpace {
    /// The name of the model's class.
    pub class: String,
    /// Time of the operating point in seconds.
    pub time: f64,
    /// The n states.
    pub states: Vec<Quantity>,
    /// The m inputs; parameters may be among them.
    pub inputs: Vec<Quantity>,
    /// The p outputs.
    pub outputs: Vec<Quantity>,
    /// Derivatives of the states at the operating point; zero where it is steady.
    pub rates: Vec<f64>,
    /// d x'/d x, n by n.
    pub a: DMatrix<f64>,
    /// d x'/d u, n by m.
    pub b: DMatrix<f64>,
    /// d y/d x, p by n.
    pub c: DMatrix<f64>,
    /// d y/d u, p by m.
    pub d: DMatrix<f64>,
}

/// The inputs and outputs of a linear model, by name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct InputOutputSelection {
    /// Inputs: top-level inputs or parameters. Empty for all top-level inputs.
    pub inputs: Vec<String>,
    /// Outputs: any variables. Empty for all top-level outputs, or else all states.
    pub outputs: Vec<String>,
}

/// A model prepared for linearisation: parameters and inputs are lifted to states, outputs are chosen.
#[derive(Clone, Debug)]
pub struct LinearizationSetup {
    /// The lifted equations.
    pub plan: Arc<EvaluationPlan>,
    /// Parameters that became inputs.
    parameters: Vec<VarId>,
    /// All top-level inputs, in declaration order; they are lifted whether requested or not.
    all_inputs: Vec<VarId>,
    /// The requested inputs: the column among (parameters, all inputs), and the variable.
    columns: Vec<(usize, VarId)>,
    /// The output variables.
    outputs: Vec<VarId>,
    /// Scheduling quantities; empty but for a quasi-linear form.
    rho: Vec<SchedulingVariable>,
}

/// A scheduling quantity of a quasi-linear form.
#[derive(Clone, Debug, PartialEq)]
pub struct SchedulingVariable {
    /// Its name.
    pub name: String,
    /// Its unit; empty for none.
    pub unit: String,
    /// Where its value comes from.
    source: SchedulingSource,
}

/// Where the value of a scheduling quantity comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
enum SchedulingSource {
    /// An input of the plan: its place among parameters, then inputs.
    Given(usize),
    /// An output of the plan with this index.
    Output(usize),
}

impl LinearizationSetup {
    /// Resolves the names and lifts the model. The parameters of `extra` become inputs too.
    ///
    /// # Errors
    /// [`Code::BadArgument`] for names that the model does not have, that cannot be used as such, or that are given
    /// twice; diagnostics of the structural analysis of the lifted model.
    pub fn new(
        flat: &FlatModel,
        choice: &InputOutputSelection,
        extra: &[VarId],
    ) -> Result<LinearizationSetup, Vec<Diagnostic>> {
        once(&choice.inputs, "input").map_err(|d| vec![d])?;
        once(&choice.outputs, "output").map_err(|d| vec![d])?;
        let all_inputs: Vec<VarId> = ids(flat).filter(|v| flat.variables[v.index()].input).collect();
        let wanted = names(flat, &choice.inputs, input_fits).map_err(|d| vec![d])?;
        let wanted = if choice.inputs.is_empty() { all_inputs.clone() } else { wanted };
        let mut parameters: Vec<VarId> = wanted.iter().copied().filter(|v| !all_inputs.contains(v)).collect();
        parameters.extend(extra.iter().filter(|v| !all_inputs.contains(v) && !wanted.contains(v)));
        let outputs = match choice.outputs.is_empty() {
            true => ids(flat).filter(|v| flat.variables[v.index()].output && is_real(flat, *v)).collect(),
            false => names(flat, &choice.outputs, output_fits).map_err(|d| vec![d])?,
        };
        let plan = EvaluationPlan::new(&lift(flat, &parameters, &outputs))?;
        let place = |v: &VarId| {
            let own = parameters.iter().position(|p| p == v);
            own.or_else(|| all_inputs.iter().position(|i| i == v).map(|i| parameters.len() + i))
        };
        let columns = wanted.iter().filter_map(|v| place(v).map(|c| (c, *v))).collect();
        let rho = Vec::new();
        let mut chosen = LinearizationSetup { plan: Arc::new(plan), parameters, all_inputs, columns, outputs, rho };
        // Without outputs the states are the outputs. They are known only after the first analysis, so it runs twice.
        if chosen.outputs.is_empty() {
            chosen.outputs = chosen.plan.state_variables().collect();
            let lifted: StateAugmentedModel = lift(flat, &chosen.parameters, &chosen.outputs);
            chosen.plan = Arc::new(EvaluationPlan::new(&lifted)?);
        }
        Ok(chosen)
    }

    /// Prepares a quasi-linear form. `rho` may name inputs, parameters or other variables.
    ///
    /// # Errors
    /// As [`LinearizationSetup::new`].
    pub fn scheduled(
        flat: &FlatModel,
        inputs: &[String],
        rho: &[String],
    ) -> Result<LinearizationSetup, Vec<Diagnostic>> {
        once(rho, "scheduling quantity").map_err(|d| vec![d])?;
        let given = |name: &String| {
            let found = flat.variables.iter().position(|v| v.name == *name);
            found.is_some_and(|i| input_fits(flat, VarId(u32::try_from(i).expect("fewer than 2^32 variables"))))
        };
        // Inputs and parameters are given from outside; all others are outputs, whose coefficients show what they
        // multiply.
        let (outside, inside): (Vec<String>, Vec<String>) = rho.iter().cloned().partition(given);
        let extra = names(flat, &outside, input_fits).map_err(|d| vec![d])?;
        let choice = InputOutputSelection { inputs: inputs.to_vec(), outputs: inside.clone() };
        let mut chosen = LinearizationSetup::new(flat, &choice, &extra)?;
        for name in rho {
            let output = inside.iter().position(|n| n == name);
            let v = ids(flat).find(|v| flat.variables[v.index()].name == *name).expect("found before");
            let source = match output {
                Some(k) => SchedulingSource::Output(k),
                None => SchedulingSource::Given(chosen.place(v).expect("raised above")),
            };
            let unit = flat.variables[v.index()].unit.as_deref().unwrap_or("").to_owned();
            chosen.rho.push(SchedulingVariable { name: name.clone(), unit, source });
        }
        Ok(chosen)
    }

    /// The scheduling quantities.
    pub fn rho(&self) -> &[SchedulingVariable] {
        &self.rho
    }

    /// The requested inputs.
    pub fn asked(&self) -> Vec<VarId> {
        self.columns.iter().map(|c| c.1).collect()
    }

    /// The parameters that became inputs.
    pub fn raised(&self) -> impl Iterator<Item = VarId> {
        self.parameters.iter().copied()
    }

    /// All independent quantities: states, then parameters, then inputs.
    pub fn quantities(&self) -> impl Iterator<Item = VarId> {
        self.plan.state_variables().chain(self.parameters.iter().copied()).chain(self.all_inputs.iter().copied())
    }

    /// The column of a variable among parameters, then inputs.
    fn place(&self, v: VarId) -> Option<usize> {
        let own = self.parameters.iter().position(|p| *p == v);
        own.or_else(|| self.all_inputs.iter().position(|i| *i == v).map(|i| self.parameters.len() + i))
    }

    /// Values of the parameters and of the inputs (in this order) in a state of the model.
    pub fn given(&self, state: &State) -> (Vec<f64>, Vec<f64>) {
        let of = |list: &[VarId]| list.iter().map(|v| state.values[v.index()]).collect();
        (of(&self.parameters), of(&self.all_inputs))
    }

    /// The model evaluated and linearised at a state of a run, discrete values included.
    ///
    /// # Errors
    /// When the equations have no solution there.
    pub fn at(&self, state: &State) -> Result<LocalEvaluator, LocalError> {
        let (theta, u) = self.given(state);
        let mut local = LocalEvaluator::start(self.plan.clone(), state.time, &theta, &u)?;
        // The start of the lifted model solves its own initial equations; the state of the run replaces that solution.
        local.adopt(state);
        let x = local.state();
        local.linearize(state.time, &x, &theta, &u)?;
        Ok(local)
    }
}

/// The linear model at a state of a run.
///
/// # Errors
/// As [`LinearizationSetup::at`].
pub fn linearize(model: &CompiledModel, chosen: &LinearizationSetup, state: &State) -> Result<StateSpace, LocalError> {
    let local = chosen.at(state)?;
    let system = &chosen.plan.system;
    let variables = &system.dae.variables;
    let quantity = |v: VarId, value: f64, nominal: f64| Quantity::of(&variables[v.index()], value, nominal);
    let sizes = sizes(model);
    let size = |v: VarId| sizes.get(v.index()).copied().unwrap_or(1.0);
    let columns: Vec<usize> = chosen.columns.iter().map(|c| c.0).collect();
    let linear = &local.linear;
    // The plan has all inputs as columns; only the requested ones are returned.
    let pick = |m: &DMatrix<f64>| m.select_columns(&columns);
    let states = chosen.plan.state_variables().zip(local.state()).zip(local.nominals());
    Ok(StateSpace {
        class: model.dae.class.clone(),
        time: state.time,
        states: states.map(|((v, x), n)| quantity(v, x, n)).collect(),
        inputs: chosen.columns.iter().map(|&(_, v)| quantity(v, state.values[v.index()], size(v))).collect(),
        outputs: chosen.outputs.iter().zip(&local.outputs).map(|(&v, &y)| quantity(v, y, size(v))).collect(),
        rates: local.rates.clone(),
        a: linear.a.clone(),
        b: pick(&linear.b),
        c: linear.c.clone(),
        d: pick(&linear.d),
    })
}

/// The nominal value of each variable of the flat model.
fn sizes(model: &CompiledModel) -> Vec<f64> {
    let system = &model.system;
    let mut values = system.layout.values();
    system.evaluate_parameters(&mut values, &[]);
    ids(&model.flat).map(|v| system.nominal(v, &values)).collect()
}

/// The ids of all variables.
fn ids(flat: &FlatModel) -> impl Iterator<Item = VarId> {
    let count = u32::try_from(flat.variables.len()).expect("fewer than 2^32 variables");
    (0..count).map(VarId)
}

/// Whether a variable is of type Real.
fn is_real(flat: &FlatModel, v: VarId) -> bool {
    flat.variables[v.index()].ty == ScalarType::Real
}

/// Whether a variable can be an input of a linear model: a Real input or parameter.
fn input_fits(flat: &FlatModel, v: VarId) -> bool {
    let variable = &flat.variables[v.index()];
    is_real(flat, v) && (variable.input || variable.variability == Variability::Parameter)
}

/// Whether a variable can be an output: Real and continuous.
fn output_fits(flat: &FlatModel, v: VarId) -> bool {
    is_real(flat, v) && flat.variables[v.index()].variability == Variability::Continuous
}

/// Rejects names that are given twice: they would make two equal rows or columns, and a singular model.
fn once(wanted: &[String], role: &str) -> Result<(), Diagnostic> {
    match wanted.iter().enumerate().find(|(k, name)| wanted[..*k].contains(name)) {
        None => Ok(()),
        Some((_, name)) => Err(Diagnostic::new(Code::BadArgument, format!("the {role} `{name}` is named twice"))
            .note("two equal columns or rows would come of it")
            .help(format!("name `{name}` once"))),
    }
}

/// The variables with these names, in this order, all of which pass `fits`.
///
/// # Errors
/// [`Code::BadArgument`] with the most similar name.
pub fn names(
    flat: &FlatModel,
    wanted: &[String],
    fits: fn(&FlatModel, VarId) -> bool,
) -> Result<Vec<VarId>, Diagnostic> {
    let find = |name: &String| {
        let found = ids(flat).find(|v| flat.variables[v.index()].name == *name);
        match found {
            Some(v) if fits(flat, v) => Ok(v),
            Some(_) => Err(Diagnostic::new(Code::BadArgument, format!("`{name}` cannot be used here"))
                .help("inputs are top-level inputs or real parameters; outputs vary continuously")),
            None => {
                let d = Diagnostic::new(Code::BadArgument, format!("the model has no variable `{name}`"));
                let known = ids(flat).filter(|v| fits(flat, *v)).map(|v| flat.variables[v.index()].name.as_str());
                Err(match nearest(name, known) {
                    Some(near) => d.help(format!("did you mean `{near}`?")),
                    None => d,
                })
            }
        }
    };
    wanted.iter().map(find).collect()
}

/// The continuous Real variables with these names.
///
/// # Errors
/// As [`names`].
pub fn outputs(flat: &FlatModel, wanted: &[String]) -> Result<Vec<VarId>, Diagnostic> {
    names(flat, wanted, output_fits)
}

#[cfg(test)]
mod tests;
