//! Runs a model together with its sensitivities to parameters.
//!
//! A flat model and parameters enter; a [`TangentModel`] leaves, whose system the solver integrates with a
//! [`TangentRequest`]. Parameters are lifted to constant states, so that sensitivities to parameters are sensitivities
//! to start values, which the integrator carries across events. `sensitivity` and the output error of `identify` use
//! it.

use super::lift;
use bramah_expr::VarId;
use bramah_model::flat::{FlatModel, ScalarType, Variability, WhenAction};
use bramah_model::structure::{self, StateChoice};
use bramah_solve::lower::{ExecutableSystem, LoweringOptions, lower};
use bramah_solve::{Control, End, RecordedInput, Settings, State, TangentRequest, simulate};
use rayon::prelude::*;
use std::sync::Arc;

/// A model that can run with sensitivities to some of its parameters.
#[derive(Clone, Debug)]
pub struct TangentModel {
    /// The lifted system; variables of the model keep their ids.
    pub system: Arc<ExecutableSystem>,
    /// One unit of each parameter's direction, in the parameter's unit.
    sizes: Vec<f64>,
    /// The lifted parameters.
    raised: Vec<lift::AugmentedState>,
}

/// Step of the differences between starts, in units of the directions.
const STEP: f64 = 1e-4;

impl TangentModel {
    /// Lifts parameters, each given with the size of its direction, and analyses the equations.
    ///
    /// # Errors
    /// The reason, in words, why sensitivities cannot be integrated.
    pub fn new(flat: &FlatModel, parameters: &[(VarId, f64)]) -> Result<TangentModel, String> {
        let variables: Vec<VarId> = parameters.iter().map(|p| p.0).collect();
        // A parameter that the initial equations determine has a sensitivity of its own, which is not integrated.
        if let Some(v) = flat.variables.iter().find(|v| v.variability == Variability::Parameter && !v.fixed) {
            return Err(format!("`{}` is found at the start", v.name));
        }
        // Sampled values jump with what they sample; only the continuous part is differentiated.
        if sampled(flat, &variables) {
            return Err("sampled values depend on what moves".to_owned());
        }
        let lifted = lift::free(flat, &variables);
        let Some(dae) = structure::analyze(&lifted.flat, &StateChoice::default()).value else {
            return Err("the equations cannot be sorted with parameters that move".to_owned());
        };
        if !dae.delays.is_empty() {
            return Err("what is delayed is not carried along".to_owned());
        }
        // The directions refer to states alone, so conserved quantities are not made unknowns of their own.
        let system = Arc::new(lower(Arc::new(dae), &LoweringOptions { conserve: false, ..LoweringOptions::default() }));
        Ok(TangentModel { system, sizes: parameters.iter().map(|p| p.1).collect(), raised: lifted.parameters })
    }

    /// The directions of a run that starts at the model's own start: for each parameter the derivatives of all initial
    /// states, by differences of starts.
    ///
    /// A parameter whose value the settings give no longer follows others.
    ///
    /// # Errors
    /// The reason, in words, why there is no start with a parameter moved.
    pub fn starts(&self, settings: &Settings, inputs: &[RecordedInput]) -> Result<TangentRequest, String> {
        let at = Settings { stop_time: settings.start_time, interval: 0.0, ..settings.clone() };
        let base = self.start(&at, inputs, None)?;
        let directions: Result<Vec<_>, String> =
            (0..self.raised.len()).into_par_iter().map(|k| self.direction(&at, inputs, &base, k)).collect();
        let still = self.raised.iter().map(|r| r.state).collect();
        Ok(TangentRequest { still, starts: directions?, controlled: false })
    }

    /// The directions of a run that starts at given states: each parameter moves alone.
    pub fn inside(&self) -> TangentRequest {
        let raised = self.raised.iter().zip(&self.sizes);
        TangentRequest {
            still: self.raised.iter().map(|r| r.state).collect(),
            starts: raised.map(|(r, &size)| vec![(r.state, size)]).collect(),
            controlled: false,
        }
    }

    /// The derivatives of all initial states by parameter `k`, one-sided where there is a start on one side only.
    fn direction(
        &self,
        settings: &Settings,
        inputs: &[RecordedInput],
        base: &State,
        k: usize,
    ) -> Result<Vec<(VarId, f64)>, String> {
        let (raised, size) = (self.raised[k], self.sizes[k]);
        let centre = base.values[raised.state.index()];
        let at = |step: f64| self.start(settings, inputs, Some((raised.start, centre + step * size)));
        let (up, down, reach) = match (at(STEP), at(-STEP)) {
            (Ok(up), Ok(down)) => (up, down, 2.0 * STEP),
            (Ok(up), Err(_)) => (up, base.clone(), STEP),
            (Err(_), Ok(down)) => (base.clone(), down, STEP),
            (Err(why), Err(_)) => return Err(why),
        };
        let by = |v: VarId| (up.values[v.index()] - down.values[v.index()]) / reach;
        let states = self.system.dae.states.iter().map(|&v| (v, if v == raised.state { size } else { by(v) }));
        Ok(states.filter(|(_, by)| *by != 0.0).collect())
    }

    /// The state at the start, with one parameter moved to another value.
    ///
    /// # Errors
    /// When the initial equations have no solution.
    pub fn start(
        &self,
        settings: &Settings,
        inputs: &[RecordedInput],
        moved: Option<(VarId, f64)>,
    ) -> Result<State, String> {
        let mut settings = Settings { tangents: None, wanted: Vec::new(), ..settings.clone() };
        settings.parameters.retain(|p| moved.is_none_or(|m| m.0 != p.0));
        settings.parameters.extend(moved);
        let mut nowhere = bramah_results::Trajectory::new(Vec::new());
        let run = simulate(&self.system, &settings, inputs, None, &mut nowhere, &mut Control::default());
        match run.end {
            End::Reached => Ok(run.state),
            _ => Err("there is no start with moved parameters".to_owned()),
        }
    }

    /// Whether a variable is a state of the system, so that a run may start at another value of it.
    pub fn is_state(&self, v: VarId) -> bool {
        self.system.dae.states.contains(&v)
    }
}

/// Whether a Real value assigned in a `when` clause depends on these parameters or on a continuous variable.
fn sampled(flat: &FlatModel, parameters: &[VarId]) -> bool {
    let followers: Vec<VarId> = lift::reading(flat, parameters).into_iter().map(|f| f.0).collect();
    let mut moves: Vec<bool> = flat
        .variables
        .iter()
        .map(|v| v.variability == Variability::Continuous && v.ty == ScalarType::Real && !v.input)
        .collect();
    parameters.iter().chain(&followers).for_each(|v| moves[v.index()] = true);
    let actions = flat.whens.iter().flat_map(|w| &w.branches).flat_map(|b| &b.actions);
    let mut values = actions.filter_map(|a| match a {
        WhenAction::Assign { variable, value, .. } if flat.variables[variable.index()].ty == ScalarType::Real => {
            Some(*value)
        }
        _ => None,
    });
    values.any(|value| flat.exprs.variables(value).iter().any(|v| moves[v.index()]))
}

#[cfg(test)]
#[path = "tangent_tests.rs"]
mod tests;
