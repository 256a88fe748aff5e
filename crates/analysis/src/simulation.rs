//! Analyses as methods of a compiled [`Simulation`]: states, linear models, operating points and sensitivities.
//!
//! The trait [`Analyze`] is the interface for Rust; the Python package uses it too. Names enter as texts and errors
//! leave as [`Error`] with messages for users.

use super::linear::{self, InputOutputSelection, LinearizationSetup, StateSpace};
use super::sensitivity::{Sensitivity, SensitivityParameter, TOLERANCE, sensitivity};
use super::steady;
use bramah_circuit::Simulation;
use bramah_circuit::compiled::CompiledModel;
use bramah_expr::VarId;
use bramah_model::flat::{ScalarType, Variability};
use bramah_results::Trajectory;
use bramah_solve::{Control, Settings, State};
use bramah_syntax::diag::{Code, Diagnostic, Error};
use std::borrow::Cow;
use std::sync::atomic::AtomicBool;

/// Analyses of a [`Simulation`]: import the trait and call these as methods.
pub trait Analyze {
    /// The state of a run at a time in seconds, or at its start.
    ///
    /// # Errors
    /// As [`Simulation::run`].
    fn state_at(&self, time: Option<f64>) -> Result<State, Error>;

    /// The linear model at a state: x' = A x + B u, y = C x + D u, in deviations. `inputs` are top-level inputs or
    /// parameters, none for all top-level inputs; `outputs` any variables, none for all top-level outputs, or else the
    /// states.
    ///
    /// ```
    /// # fn main() -> Result<(), bramah::Error> {
    /// use bramah::Analyze;
    /// let tank = bramah::Simulation::from_text(
    ///     "model Tank input Real u(start = 1); parameter Real k = 2; Real h(start = 1, fixed = true);
    ///      equation der(h) = u - k*sqrt(h); end Tank;",
    /// )?;
    /// let linear = tank.linearize(&tank.state_at(None)?, &["u", "k"], &[])?;
    /// assert!((linear.a[(0, 0)] + 1.0).abs() < 1e-9);
    /// assert_eq!(linear.inputs[0].name, "u");
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// `E023` or `E903` for a name that does not fit, `E504` where the model has no derivatives.
    fn linearize(&self, at: &State, inputs: &[&str], outputs: &[&str]) -> Result<StateSpace, Error>;

    /// The operating point reached from a state: all rates vanish that anything depends on.
    ///
    /// # Errors
    /// `E501` where no operating point is found.
    fn steady(&self, from: &State) -> Result<State, Error>;

    /// The sensitivities of the recorded continuous variables to parameters, each by the parameter's own size.
    ///
    /// # Errors
    /// `E023` for a name that is no parameter; the message of a run that failed; `E903` where inputs are given, because
    /// such runs are not differentiated.
    fn sensitivity(&self, parameters: &[&str]) -> Result<Sensitivity, Error>;
}

impl Analyze for Simulation {
    fn state_at(&self, time: Option<f64>) -> Result<State, Error> {
        let mut until = self.clone();
        let settings = until.settings();
        settings.stop_time = time.unwrap_or(settings.start_time);
        settings.interval = (settings.stop_time - settings.start_time) / 200.0;
        settings.wanted.clear();
        // inputs without a value count as 0: they may be what the model is to be linear in
        let mut nothing = Trajectory::new(Vec::new());
        let run = until.run_into(None, &mut Control::default(), &mut nothing)?;
        if run.end.is_success() { Ok(run.state) } else { Err(self.errors(run.diagnostics)) }
    }

    fn linearize(&self, at: &State, inputs: &[&str], outputs: &[&str]) -> Result<StateSpace, Error> {
        let model = as_set(self)?;
        let chosen = chosen(self, &model, inputs, outputs)?;
        linear::linearize(&model, &chosen, at).map_err(|why| {
            let text = format!("the model has no derivatives at this point: {why}");
            self.errors(vec![Diagnostic::new(Code::NonFinite, text)])
        })
    }

    fn steady(&self, from: &State) -> Result<State, Error> {
        let model = as_set(self)?;
        let chosen = chosen(self, &model, &[], &[])?;
        let found = steady::rest(&model, &chosen, from, &AtomicBool::new(false));
        found.map_err(|why| self.errors(vec![why.said(&chosen)]))
    }

    fn sensitivity(&self, parameters: &[&str]) -> Result<Sensitivity, Error> {
        if !self.given_inputs().is_empty() {
            let d = Diagnostic::new(Code::BadMap, "runs with given inputs have no sensitivities");
            return Err(
                self.errors(vec![d.help("put the inputs' trajectories into the model, as a table or a source")])
            );
        }
        let moved = parameters.iter().map(|name| moved(self, name)).collect::<Result<Vec<_>, _>>()?;
        let moves = |v: &VarId| {
            let variable = &self.model().flat.variables[v.index()];
            variable.ty == ScalarType::Real && variable.variability == Variability::Continuous
        };
        let wanted = self.run_settings().wanted.iter().copied().filter(moves).collect();
        let settings =
            Settings { tolerance: self.run_settings().tolerance.min(TOLERANCE), wanted, ..self.run_settings().clone() };
        sensitivity(self.model(), &settings, &moved, &AtomicBool::new(false))
            .map_err(|why| self.errors(vec![Diagnostic::new(Code::StepTooSmall, format!("a run failed: {why}"))]))
    }
}

/// The model with the values that were set compiled into its equations, because linearisation reads them there.
fn as_set(simulation: &Simulation) -> Result<Cow<'_, CompiledModel>, Error> {
    match simulation.run_settings().parameters.as_slice() {
        [] => Ok(Cow::Borrowed(simulation.model())),
        set => {
            simulation.model().with_values(set).map(Cow::Owned).map_err(|diagnostics| simulation.errors(diagnostics))
        }
    }
}

/// The model prepared for linearisation with these inputs and outputs.
fn chosen(
    simulation: &Simulation,
    model: &CompiledModel,
    inputs: &[&str],
    outputs: &[&str],
) -> Result<LinearizationSetup, Error> {
    let list = |names: &[&str]| names.iter().map(|&n| n.to_owned()).collect();
    let choice = InputOutputSelection { inputs: list(inputs), outputs: list(outputs) };
    LinearizationSetup::new(&model.flat, &choice, &[]).map_err(|diagnostics| simulation.errors(diagnostics))
}

/// A Real parameter by name, with its value and size.
fn moved(simulation: &Simulation, name: &str) -> Result<SensitivityParameter, Error> {
    let variable: VarId = simulation.variable(name)?;
    let declared = &simulation.model().flat.variables[variable.index()];
    if declared.variability != Variability::Parameter || declared.ty != ScalarType::Real {
        let text = format!("`{name}` is no parameter that can move during runs");
        return Err(simulation.errors(vec![Diagnostic::new(Code::BadSet, text)]));
    }
    Ok(SensitivityParameter::of(simulation.model(), variable, &simulation.parameter_values()))
}

#[cfg(test)]
mod tests {
    use super::*;

    const TANK: &str = "model Tank parameter Real u = 1; parameter Real k = 2; Real h(start = 1, fixed = true);
        equation der(h) = u - k*sqrt(h); end Tank;";

    #[test]
    fn values_that_were_set_count() {
        let mut tank = Simulation::from_text(TANK).unwrap();
        tank.set("u", 3.0).unwrap();
        let steady = tank.steady(&tank.state_at(None).unwrap()).unwrap();
        assert!((steady.values[steady.names.iter().position(|n| n == "h").unwrap()] - 2.25).abs() < 1e-6);
        let linear = tank.linearize(&steady, &["u"], &[]).unwrap();
        assert!((linear.a[(0, 0)] + 2.0 / (2.0 * 1.5)).abs() < 1e-6, "{}", linear.a);
        let found = tank.stop_time(20.0).sensitivity(&["u"]).unwrap();
        // dh/d ln u = 2 u^2/k^2 at rest
        assert!((found.columns[0][0].last().unwrap() - 4.5).abs() < 1e-3);
    }

    #[test]
    fn names_that_do_not_fit() {
        let tank = Simulation::from_text(TANK).unwrap();
        let start = tank.state_at(None).unwrap();
        let said = |e: Error| e.to_string();
        assert!(said(tank.linearize(&start, &["v"], &[]).unwrap_err()).contains("`v`"));
        assert!(said(tank.sensitivity(&["h"]).unwrap_err()).contains("`h` is no parameter"));
        assert!(said(tank.sensitivity(&["kk"]).unwrap_err()).contains("`kk`"));
    }
}
