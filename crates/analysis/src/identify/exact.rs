//! Forward sensitivities of runs along recordings: derivatives by all unknowns from one run.
//!
//! A recording (or a piece of one) and a point z enter; derivatives of the signals leave, for the Jacobian of
//! `output_error`. A [`TangentModel`] integrates them with the states. Central differences would need two runs for each
//! unknown instead.

use super::pieces::FreeState;
use super::runs::{RunInputs, SampleCollector};
use super::{EstimatedParameter, IdentificationProblem};
use crate::TangentModel;
use bramah_expr::VarId;
use bramah_solve::{Control, End, Settings, State, simulate};

/// A model that integrates its sensitivities to the estimated parameters.
#[derive(Clone, Debug)]
pub struct ForwardSensitivityModel {
    /// The model with its parameters as constant states.
    tangent: TangentModel,
    /// One unit of each parameter's direction, in the parameter's unit: the slope of the value at z = 0.
    sizes: Vec<f64>,
}

impl ForwardSensitivityModel {
    /// Builds the model for the parameters of a problem.
    ///
    /// # Errors
    /// The reason, in words, why finite differences have to be used.
    pub fn new(problem: &IdentificationProblem<'_>) -> Result<ForwardSensitivityModel, String> {
        let sizes: Vec<f64> = problem.free.iter().map(|f| f.slope(0.0).abs()).collect();
        let moved: Vec<(VarId, f64)> = problem.free.iter().map(|f| f.variable).zip(sizes.iter().copied()).collect();
        let tangent = TangentModel::new(&problem.model.flat, &moved)?;
        Ok(ForwardSensitivityModel { tangent, sizes })
    }

    /// Sensitivities of `wanted` at the samples of a track, and the state at its end.
    ///
    /// `states` are the free states at the start, `before` the state in which the piece before ended (`None` at the
    /// start of a recording), `z` the parameters and the free states in z. The result has one entry for each unknown
    /// (parameters, then `states`), in it one column for each of `wanted`.
    ///
    /// # Errors
    /// The reason, in words, why finite differences have to be used.
    pub fn columns(
        &self,
        (track, states, before): (&RunInputs, &[FreeState], Option<&State>),
        free: &[EstimatedParameter],
        z: (&[f64], &[f64]),
        wanted: &[VarId],
        tolerance: f64,
    ) -> Result<(Vec<Vec<Vec<f64>>>, State), String> {
        let (first, last) = (track.times[0], track.times[track.times.len() - 1]);
        let mut settings = Settings {
            start_time: first,
            stop_time: last,
            interval: track.interval,
            tolerance,
            parameters: free.iter().zip(z.0).map(|(f, &z)| (f.variable, f.value(z))).collect(),
            wanted: wanted.to_vec(),
            ..Settings::default()
        };
        // At the start of a recording, initial states depend on the parameters. Inside of it they are unknowns of their
        // own.
        let mut tangents = match before {
            None => self.tangent.starts(&settings, &track.inputs)?,
            Some(_) => self.tangent.inside(),
        };
        // The structural analysis of the lifted model may have selected other states.
        if states.iter().any(|s| !self.tangent.is_state(s.variable)) {
            return Err("other states are integrated than those searched for".to_owned());
        }
        tangents.starts.extend(states.iter().map(|s| vec![(s.variable, s.size)]));
        settings.tangents = Some(tangents);
        let own = || if states.is_empty() { Ok(None) } else { self.start(track, &settings).map(Some) };
        let mut from = before.map_or_else(own, |state| Ok(Some(state.clone())))?;
        if let Some(state) = &mut from {
            states.iter().zip(z.1).for_each(|(free, &z)| free.put(state, z));
        }
        let unknowns = free.len() + states.len();
        // A run with sensitivities records `wanted` once for the values and once more for each unknown.
        let cells: Vec<VarId> = (0..=unknowns).flat_map(|_| wanted.iter().copied()).collect();
        let mut rows = SampleCollector::new(&track.times, &cells);
        let system = &self.tangent.system;
        let run = simulate(system, &settings, &track.inputs, from.as_ref(), &mut rows, &mut Control::default());
        if run.end != End::Reached {
            let said = run.diagnostics.iter().find(|d| d.is_error()).map(|d| d.message.clone());
            return Err(said.unwrap_or_else(|| "the run with derivatives did not reach its end".to_owned()));
        }
        let columns = rows.finish();
        // The direction has the slope at z = 0; on a logarithmic scale the slope at this z differs.
        let scaled = |(j, columns): (usize, &[Vec<f64>])| {
            let scale = if j < free.len() { free[j].slope(z.0[j]) / self.sizes[j] } else { 1.0 };
            columns.iter().map(|c| c.iter().map(|v| scale * v).collect()).collect()
        };
        Ok((columns.chunks(wanted.len()).skip(1).enumerate().map(scaled).collect(), run.state))
    }

    /// The state at the start of the track from the model's initial equations.
    fn start(&self, track: &RunInputs, settings: &Settings) -> Result<State, String> {
        let at_once = Settings { stop_time: settings.start_time, interval: 0.0, ..settings.clone() };
        self.tangent.start(&at_once, &track.inputs, None)
    }
}
