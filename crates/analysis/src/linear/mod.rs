//! A model near an operating point: x' = A x + B u, y = C x + D u, its poles and zeros, and its quasi-linear form.

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

/// A quantity of a linear model.
#[derive(Clone, Debug, PartialEq)]
pub struct Quantity {
    /// Its name in the model.
    pub name: String,
    /// Its unit; may be empty.
    pub unit: String,
    /// Its value at the operating point.
    pub value: f64,
    /// Its usual size, positive.
    pub nominal: f64,
}

impl Quantity {
    fn of(variable: &FlatVariable, value: f64, nominal: f64) -> Self {
        let unit = variable.unit.as_deref().unwrap_or("").to_owned();
        Quantity { name: variable.name.clone(), unit, value, nominal }
    }

    /// Name and unit, as comments and descriptions show them.
    fn words(&self) -> String {
        let unit = if self.unit.is_empty() { "1" } else { &self.unit };
        format!("{} in {unit}", self.name)
    }
}

/// A linear model around an operating point: the quantities are deviations from their values there.
#[derive(Clone, Debug)]
pub struct StateSpace {
    /// The class.
    pub class: String,
    /// Time of the operating point in seconds.
    pub time: f64,
    /// States.
    pub states: Vec<Quantity>,
    /// Inputs, parameters that were asked for among them.
    pub inputs: Vec<Quantity>,
    /// Outputs.
    pub outputs: Vec<Quantity>,
    /// Rates of the states at the operating point; all zero where it is steady.
    pub rates: Vec<f64>,
    /// By states and states.
    pub a: DMatrix<f64>,
    /// By states and inputs.
    pub b: DMatrix<f64>,
    /// By outputs and states.
    pub c: DMatrix<f64>,
    /// By outputs and inputs.
    pub d: DMatrix<f64>,
}

/// Which quantities a linear model has.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct InputOutputSelection {
    /// Inputs: top-level inputs or parameters. Empty for all top-level inputs.
    pub inputs: Vec<String>,
    /// Outputs: any variables. Empty for all top-level outputs, or else all states.
    pub outputs: Vec<String>,
}

/// A model lifted for a [`InputOutputSelection`].
#[derive(Clone, Debug)]
pub struct LinearizationSetup {
    /// What is evaluated.
    pub plan: Arc<EvaluationPlan>,
    /// Raised parameters, as inputs.
    parameters: Vec<VarId>,
    /// All top-level inputs, in declaration order.
    all_inputs: Vec<VarId>,
    /// Columns of B and D that were asked for: parameters, then inputs.
    columns: Vec<(usize, VarId)>,
    outputs: Vec<VarId>,
    /// What schedules, where the choice was made for a quasi-linear form.
    rho: Vec<SchedulingVariable>,
}

/// A quantity that schedules.
#[derive(Clone, Debug, PartialEq)]
pub struct SchedulingVariable {
    /// Its name.
    pub name: String,
    /// Its unit; may be empty.
    pub unit: String,
    /// Where it is found.
    source: SchedulingSource,
}

/// Where a scheduling quantity is found.
#[derive(Clone, Copy, Debug, PartialEq)]
enum SchedulingSource {
    /// Among raised parameters, then inputs.
    Given(usize),
    /// Among the outputs.
    Output(usize),
}

impl LinearizationSetup {
    /// Finds the names and lifts the model. `extra` are raised too, whatever the choice says.
    ///
    /// # Errors
    /// [`Code::BadArgument`] for names that the model does not have, that cannot be used so, or that stand twice.
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
        if chosen.outputs.is_empty() {
            chosen.outputs = chosen.plan.state_variables().collect();
            let lifted: StateAugmentedModel = lift(flat, &chosen.parameters, &chosen.outputs);
            chosen.plan = Arc::new(EvaluationPlan::new(&lifted)?);
        }
        Ok(chosen)
    }

    /// For a quasi-linear form with these inputs, scheduled by inputs, parameters or other variables.
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

    /// What schedules.
    pub fn rho(&self) -> &[SchedulingVariable] {
        &self.rho
    }

    /// The inputs that were asked for.
    pub fn asked(&self) -> Vec<VarId> {
        self.columns.iter().map(|c| c.1).collect()
    }

    /// Parameters that became inputs.
    pub fn raised(&self) -> impl Iterator<Item = VarId> {
        self.parameters.iter().copied()
    }

    /// States, then raised parameters, then inputs.
    pub fn quantities(&self) -> impl Iterator<Item = VarId> {
        self.plan.state_variables().chain(self.parameters.iter().copied()).chain(self.all_inputs.iter().copied())
    }

    /// The place of a raised parameter or input among parameters, then inputs.
    fn place(&self, v: VarId) -> Option<usize> {
        let own = self.parameters.iter().position(|p| *p == v);
        own.or_else(|| self.all_inputs.iter().position(|i| *i == v).map(|i| self.parameters.len() + i))
    }

    /// Values of the raised parameters and of the inputs in a state of the model.
    pub fn given(&self, state: &State) -> (Vec<f64>, Vec<f64>) {
        let of = |list: &[VarId]| list.iter().map(|v| state.values[v.index()]).collect();
        (of(&self.parameters), of(&self.all_inputs))
    }

    /// The model at a state that a run has left.
    ///
    /// # Errors
    /// When the equations have no solution there.
    pub fn at(&self, state: &State) -> Result<LocalEvaluator, LocalError> {
        let (theta, u) = self.given(state);
        let mut local = LocalEvaluator::start(self.plan.clone(), state.time, &theta, &u)?;
        local.adopt(state);
        let x = local.state();
        local.linearize(state.time, &x, &theta, &u)?;
        Ok(local)
    }
}

/// The linear model at a state.
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

/// The usual size of each variable.
fn sizes(model: &CompiledModel) -> Vec<f64> {
    let system = &model.system;
    let mut values = system.layout.values();
    system.evaluate_parameters(&mut values, &[]);
    ids(&model.flat).map(|v| system.nominal(v, &values)).collect()
}

fn ids(flat: &FlatModel) -> impl Iterator<Item = VarId> {
    let count = u32::try_from(flat.variables.len()).expect("fewer than 2^32 variables");
    (0..count).map(VarId)
}

fn is_real(flat: &FlatModel, v: VarId) -> bool {
    flat.variables[v.index()].ty == ScalarType::Real
}

fn input_fits(flat: &FlatModel, v: VarId) -> bool {
    let variable = &flat.variables[v.index()];
    is_real(flat, v) && (variable.input || variable.variability == Variability::Parameter)
}

fn output_fits(flat: &FlatModel, v: VarId) -> bool {
    is_real(flat, v) && flat.variables[v.index()].variability == Variability::Continuous
}

/// Of a name that stands twice two equal columns or rows would come.
fn once(wanted: &[String], role: &str) -> Result<(), Diagnostic> {
    match wanted.iter().enumerate().find(|(k, name)| wanted[..*k].contains(name)) {
        None => Ok(()),
        Some((_, name)) => Err(Diagnostic::new(Code::BadArgument, format!("the {role} `{name}` is named twice"))
            .note("two equal columns or rows would come of it")
            .help(format!("name `{name}` once"))),
    }
}

/// The variables of these names that fit.
///
/// # Errors
/// [`Code::BadArgument`] with the nearest name.
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

/// Any continuous real variable, for names given from outside.
///
/// # Errors
/// As [`names`].
pub fn outputs(flat: &FlatModel, wanted: &[String]) -> Result<Vec<VarId>, Diagnostic> {
    names(flat, wanted, output_fits)
}

#[cfg(test)]
mod tests;
