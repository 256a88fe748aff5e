//! Derivatives of runs along recordings by the variational equations: one run instead of two for each unknown.

use super::output_error::FreeState;
use super::runs::{Samples, Track};
use super::{Free, Problem};
use crate::analysis::Variation;
use crate::analysis::variation::Watch;
use crate::expr::VarId;
use crate::solve::{Control, End, Settings, Sink, State, simulate};

/// A model that carries its derivatives by the parameters along, and by some initial states.
#[derive(Clone, Debug)]
pub struct Exact {
    variation: Variation,
    /// What one unit of each parameter's direction means, in its unit.
    sizes: Vec<f64>,
    /// How many initial states it can tell apart.
    states: usize,
}

impl Exact {
    /// For the parameters of a problem and recordings with at most this many unknown initial states.
    ///
    /// # Errors
    /// In words, why differences have to do.
    pub fn new(problem: &Problem<'_>, states: usize) -> Result<Exact, String> {
        let sizes: Vec<f64> = problem.free.iter().map(|f| f.slope(0.0).abs()).collect();
        let independent: Vec<VarId> = problem.free.iter().map(|f| f.variable).collect();
        let moved: Vec<(VarId, f64)> = independent.iter().copied().zip(sizes.iter().copied()).collect();
        let variation = Variation::new(&problem.model.flat, &moved, &independent, states)?;
        Ok(Exact { variation, sizes, states })
    }

    /// Derivatives of `wanted` at the samples by z: one entry an unknown (parameters, then these states), in it one column
    /// a variable.
    ///
    /// # Errors
    /// In words, why differences have to do.
    pub fn columns(
        &self,
        track: &Track,
        free: &[Free],
        states: &[FreeState],
        z: (&[f64], &[f64]),
        wanted: &[VarId],
        tolerance: f64,
    ) -> Result<Vec<Vec<Vec<f64>>>, String> {
        let unknowns = free.len() + states.len();
        let companion = |(j, v): (usize, &VarId)| self.variation.companion(*v, j);
        let all: Vec<Option<VarId>> =
            (0..unknowns).flat_map(|j| wanted.iter().map(move |v| (j, v))).map(companion).collect();
        let (first, last) = (track.times[0], track.times[track.times.len() - 1]);
        let rates = &self.variation.rates;
        let settings = Settings {
            start_time: first,
            stop_time: last,
            interval: track.interval,
            tolerance,
            parameters: free.iter().zip(z.0).map(|(f, &z)| (f.variable, f.value(z))).collect(),
            wanted: all.iter().flatten().chain(rates).copied().collect(),
            ..Settings::default()
        };
        let from =
            if states.is_empty() { None } else { Some(self.start(track, &settings, free.len(), states, z.1)?) };
        let mut rows = Samples::new(&track.times, &settings.wanted[..settings.wanted.len() - rates.len()]);
        let mut watch = Watch::new(&mut rows, rates.len(), &track.times);
        self.run(track, &settings, from.as_ref(), &mut watch)?;
        let mut found = rows.finish().into_iter();
        let columns: Vec<Vec<f64>> =
            all.iter().map(|c| c.and_then(|_| found.next()).unwrap_or_else(|| vec![0.0; track.times.len()])).collect();
        let scaled = |(j, columns): (usize, &[Vec<f64>])| {
            let scale = if j < free.len() { free[j].slope(z.0[j]) / self.sizes[j] } else { 1.0 };
            columns.iter().map(|c| c.iter().map(|v| scale * v).collect()).collect()
        };
        Ok(columns.chunks(wanted.len()).enumerate().map(scaled).collect())
    }

    /// The start of the run with the states moved, and each state's companion along its own direction.
    fn start(
        &self,
        track: &Track,
        settings: &Settings,
        parameters: usize,
        states: &[FreeState],
        z: &[f64],
    ) -> Result<State, String> {
        if states.len() > self.states {
            return Err("there are more initial states than directions".to_owned());
        }
        let at_once =
            Settings { stop_time: settings.start_time, interval: 0.0, wanted: Vec::new(), ..settings.clone() };
        let mut state = self.run(track, &at_once, None, &mut Samples::new(&[], &[]))?;
        for (k, (free, z)) in states.iter().zip(z).enumerate() {
            let direction = parameters + k;
            let companion = self.variation.companion(free.variable, direction);
            let Some(companion) = companion.filter(|_| self.variation.is_state(free.variable, direction)) else {
                return Err("other states are integrated than those searched for".to_owned());
            };
            state.values[free.variable.index()] += free.size * z;
            state.values[companion.index()] = free.size;
        }
        Ok(state)
    }

    fn run(
        &self,
        track: &Track,
        settings: &Settings,
        from: Option<&State>,
        rows: &mut dyn Sink,
    ) -> Result<State, String> {
        let system = &self.variation.system;
        let run = simulate(system, settings, &track.inputs, from, rows, &mut Control::default());
        match run.end {
            End::Reached => Ok(run.state),
            End::Interrupted => Err(format!("rates jump at {} s", crate::results::number::rounded(run.time, 6))),
            _ => Err("the run with derivatives did not reach its end".to_owned()),
        }
    }
}
