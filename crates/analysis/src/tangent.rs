//! The model with its parameters made states that stand still: the sensitivities of a run to parameters are then those
//! to its start, and the integrator carries them along, right across events.

use super::lift;
use bramah_expr::VarId;
use bramah_model::flat::{FlatModel, ScalarType, Variability, WhenAction};
use bramah_model::structure::{self, StateChoice};
use bramah_solve::lower::{ExecutableSystem, LoweringOptions, lower};
use bramah_solve::{Control, End, RecordedInput, Settings, State, TangentRequest, simulate};
use rayon::prelude::*;
use std::sync::Arc;

/// A model ready to run with sensitivities to some of its parameters.
#[derive(Clone, Debug)]
pub struct TangentModel {
    /// The system; variables of the model keep their numbers.
    pub system: Arc<ExecutableSystem>,
    /// Per parameter, what one unit of its direction means.
    sizes: Vec<f64>,
    raised: Vec<lift::AugmentedState>,
}

/// Step of the differences between starts, in units of the directions.
const STEP: f64 = 1e-4;

impl TangentModel {
    /// For parameters, each with the size of a unit of its direction.
    ///
    /// # Errors
    /// In words, why runs cannot carry the sensitivities along.
    pub fn new(flat: &FlatModel, parameters: &[(VarId, f64)]) -> Result<TangentModel, String> {
        let variables: Vec<VarId> = parameters.iter().map(|p| p.0).collect();
        if let Some(v) = flat.variables.iter().find(|v| v.variability == Variability::Parameter && !v.fixed) {
            return Err(format!("`{}` is found at the start", v.name));
        }
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
        let system = Arc::new(lower(Arc::new(dae), &LoweringOptions { conserve: false, ..LoweringOptions::default() }));
        Ok(TangentModel { system, sizes: parameters.iter().map(|p| p.1).collect(), raised: lifted.parameters })
    }

    /// What a run with these settings carries along: per parameter the derivatives of its start, which are differences
    /// of starts. Parameters that the settings give do not follow others.
    ///
    /// # Errors
    /// In words, when there is no start beside the given one.
    pub fn starts(&self, settings: &Settings, inputs: &[RecordedInput]) -> Result<TangentRequest, String> {
        let at = Settings { stop_time: settings.start_time, interval: 0.0, ..settings.clone() };
        let base = self.start(&at, inputs, None)?;
        let directions: Result<Vec<_>, String> =
            (0..self.raised.len()).into_par_iter().map(|k| self.direction(&at, inputs, &base, k)).collect();
        let still = self.raised.iter().map(|r| r.state).collect();
        Ok(TangentRequest { still, starts: directions?, controlled: false })
    }

    /// What a run carries along that starts at given states: the parameters alone move.
    pub fn inside(&self) -> TangentRequest {
        let raised = self.raised.iter().zip(&self.sizes);
        TangentRequest {
            still: self.raised.iter().map(|r| r.state).collect(),
            starts: raised.map(|(r, &size)| vec![(r.state, size)]).collect(),
            controlled: false,
        }
    }

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

    /// The state at the start, one parameter perhaps elsewhere.
    ///
    /// # Errors
    /// In words, when there is none.
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

    /// Whether a variable is integrated, so that a run may start with another value of it.
    pub fn is_state(&self, v: VarId) -> bool {
        self.system.dae.states.contains(&v)
    }
}

/// Whether a real value set by `when` depends on these parameters or on anything that moves between events.
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
