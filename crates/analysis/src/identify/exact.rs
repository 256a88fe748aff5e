//! Derivatives of runs along recordings, carried along by one run instead of two for each unknown.

use super::pieces::FreeState;
use super::runs::{RunInputs, SampleCollector};
use super::{EstimatedParameter, IdentificationProblem};
use crate::TangentModel;
use bramah_expr::VarId;
use bramah_solve::{Control, End, Settings, State, simulate};

/// A model that carries its derivatives by the parameters along.
#[derive(Clone, Debug)]
pub struct ForwardSensitivityModel {
    tangent: TangentModel,
    /// What one unit of each parameter's direction means, in its unit.
    sizes: Vec<f64>,
}

impl ForwardSensitivityModel {
    /// For the parameters of a problem.
    ///
    /// # Errors
    /// In words, why differences have to do.
    pub fn new(problem: &IdentificationProblem<'_>) -> Result<ForwardSensitivityModel, String> {
        let sizes: Vec<f64> = problem.free.iter().map(|f| f.slope(0.0).abs()).collect();
        let moved: Vec<(VarId, f64)> = problem.free.iter().map(|f| f.variable).zip(sizes.iter().copied()).collect();
        let tangent = TangentModel::new(&problem.model.flat, &moved)?;
        Ok(ForwardSensitivityModel { tangent, sizes })
    }

    /// Derivatives of `wanted` at the samples by z: one entry an unknown (parameters, then these states), in it one column
    /// a variable; and the state at the end. The run begins where the one before ended, if there was one.
    ///
    /// # Errors
    /// In words, why differences have to do.
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
        let mut tangents = match before {
            None => self.tangent.starts(&settings, &track.inputs)?,
            Some(_) => self.tangent.inside(),
        };
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
        let cells: Vec<VarId> = (0..=unknowns).flat_map(|_| wanted.iter().copied()).collect();
        let mut rows = SampleCollector::new(&track.times, &cells);
        let system = &self.tangent.system;
        let run = simulate(system, &settings, &track.inputs, from.as_ref(), &mut rows, &mut Control::default());
        if run.end != End::Reached {
            let said = run.diagnostics.iter().find(|d| d.is_error()).map(|d| d.message.clone());
            return Err(said.unwrap_or_else(|| "the run with derivatives did not reach its end".to_owned()));
        }
        let columns = rows.finish();
        let scaled = |(j, columns): (usize, &[Vec<f64>])| {
            let scale = if j < free.len() { free[j].slope(z.0[j]) / self.sizes[j] } else { 1.0 };
            columns.iter().map(|c| c.iter().map(|v| scale * v).collect()).collect()
        };
        Ok((columns.chunks(wanted.len()).skip(1).enumerate().map(scaled).collect(), run.state))
    }

    /// The start of the run as the model has it.
    fn start(&self, track: &RunInputs, settings: &Settings) -> Result<State, String> {
        let at_once = Settings { stop_time: settings.start_time, interval: 0.0, ..settings.clone() };
        self.tangent.start(&at_once, &track.inputs, None)
    }
}
