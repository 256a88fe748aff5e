//! Multiple shooting: recordings cut into pieces, each of which starts at states of its own and has to end where the
//! next one starts.
//!
//! `output_error` builds [`RecordingCase`]s and runs along them. The conditions at the joints are rows of the least
//! squares (a quadratic penalty) whose weight grows from round to round. With small weights each piece stays near its
//! section of the recording, which avoids local minima of one long run. Source: H. G. Bock, in Modelling of Chemical
//! Reaction Systems, Springer 1981, 102; penalty weights: J. Nocedal, S. J. Wright, Numerical Optimization, 2006,
//! section 17.1.

use super::output_error::OutputError;
use super::runs::RunInputs;
use super::{StoppingCriteria, VariableBounds, minimise};
use bramah_expr::VarId;
use bramah_solve::State;
use std::ops::Range;

/// An unknown state at the start of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FreeState {
    /// The model's state.
    pub variable: VarId,
    /// The change of the state for a step of 1 in z.
    ///
    /// At the start of a recording it is the nominal value, which is also the standard deviation of the prior. At a
    /// joint it is the range of the state along the recording.
    pub size: f64,
    /// The value at z = 0; `None` for the value of the model's own start.
    pub centre: Option<f64>,
}

impl FreeState {
    /// Sets the state to its value at `z`.
    pub fn put(&self, state: &mut State, z: f64) {
        let value = &mut state.values[self.variable.index()];
        *value = self.centre.unwrap_or(*value) + self.size * z;
    }
}

/// One piece of a recording.
#[derive(Clone, Debug)]
pub struct ShootingInterval {
    /// Index of its first sample.
    pub first: usize,
    /// Its unknown initial states.
    pub states: Vec<FreeState>,
    /// Where these stand in z.
    pub places: Range<usize>,
}

/// A recording with its pieces.
#[derive(Clone, Debug)]
pub struct RecordingCase {
    /// Inputs and times of the samples of the whole recording.
    pub track: RunInputs,
    /// Measured values, one column for each signal; NaN where nothing was measured.
    pub measured: Vec<Vec<f64>>,
    /// The pieces in the order of time; one where the recording is not cut.
    pub legs: Vec<ShootingInterval>,
    /// The state before the first piece; `None` for the model's own start.
    pub from: Option<State>,
}

impl RecordingCase {
    /// The samples of a piece.
    pub fn samples(&self, leg: usize) -> Range<usize> {
        self.legs[leg].first..self.legs.get(leg + 1).map_or(self.track.times.len(), |next| next.first)
    }

    /// Inputs and times of a piece, up to and including the first sample of the next one.
    pub fn along(&self, leg: usize) -> RunInputs {
        let end = self.samples(leg).end.min(self.track.times.len() - 1);
        if self.legs.len() == 1 { self.track.clone() } else { self.track.between(self.legs[leg].first, end) }
    }

    /// The states that are compared at the end of a piece; none for the last one.
    pub fn handed(&self, leg: usize) -> &[FreeState] {
        self.legs.get(leg + 1).map_or(&[], |next| &next.states)
    }

    /// All places of this recording in z.
    pub fn places(&self) -> Range<usize> {
        let last = &self.legs[self.legs.len() - 1];
        self.legs[0].places.start..last.places.end
    }

    /// How many states are compared at all joints together.
    pub fn conditions(&self) -> usize {
        self.legs[1..].iter().map(|leg| leg.states.len()).sum()
    }

    /// One piece as a recording of its own that starts at `from`.
    fn alone(&self, leg: usize, from: Option<State>) -> RecordingCase {
        let samples = self.samples(leg);
        let track = self.track.between(samples.start, samples.end - 1);
        let measured = self.measured.iter().map(|m| m[samples.clone()].to_vec()).collect();
        let states = self.legs[leg].states.clone();
        RecordingCase {
            track,
            measured,
            legs: vec![ShootingInterval { first: 0, places: 0..states.len(), states }],
            from,
        }
    }
}

/// The jumps left between pieces after a fit.
#[derive(Clone, Debug, PartialEq)]
pub struct ContinuityDefects {
    /// Number of joints.
    pub count: usize,
    /// The largest jump, relative to the range of its state.
    pub jump: f64,
    /// The name of that state.
    pub state: String,
}

/// Pieces whose largest jump exceeds this share of a state's range do not count as joined.
pub const APART: f64 = 1e-3;
/// Standard deviation of jumps in the first round, relative to the states' ranges.
pub const LOOSE: f64 = 0.1;
/// Factor of that deviation from round to round.
pub const STRICTER: f64 = 0.1;
/// The deviation of the last round: about what runs at their tolerance leave of a jump.
pub const TIGHT: f64 = 1e-6;
/// The deviation with which the identifiability is checked before the fit.
pub const USUAL: f64 = 1e-4;

/// The first samples of `pieces` pieces of about equal length.
pub fn cuts(samples: usize, pieces: usize) -> impl Iterator<Item = usize> {
    (0..pieces).map(move |k| k * samples / pieces)
}

impl OutputError<'_> {
    /// Estimates the states at all joints of a recording, with the parameters fixed.
    ///
    /// Each piece is fitted to its own samples and starts where the one before ended. Afterwards `centre` is the
    /// estimate and `size` the range of the state along the recording. Without a start the remaining joints stay as
    /// they are.
    pub(super) fn place_joints(&mut self, case: usize, parameters: &[f64]) {
        let legs = self.cases[case].legs.len();
        let inner: Vec<VarId> = self.cases[case].handed(0).iter().map(|s| s.variable).collect();
        let mut ranges = vec![(f64::INFINITY, f64::NEG_INFINITY); inner.len()];
        let mut before: Option<State> = None;
        for leg in 0..legs {
            if leg > 0 {
                let track = self.cases[case].along(leg);
                // After a piece that could not be run, the model's own start has to do.
                before = before.or_else(|| self.runner.start(&track, &self.problem.parameters(parameters)).ok());
                let Some(start) = &before else { return };
                let states = &mut self.cases[case].legs[leg].states;
                states.iter_mut().for_each(|s| s.centre = Some(start.values[s.variable.index()]));
            }
            let (z, columns, end) = self.fit_alone(case, leg, before.take(), parameters);
            let states = &mut self.cases[case].legs[leg].states;
            states.iter_mut().zip(z).for_each(|(s, z)| s.centre = s.centre.map(|c| c + s.size * z));
            before = end;
            for (range, column) in ranges.iter_mut().zip(columns) {
                column.iter().for_each(|&v| *range = (range.0.min(v), range.1.max(v)));
            }
        }
        for leg in &mut self.cases[case].legs[1..] {
            for (state, range) in leg.states.iter_mut().zip(&ranges) {
                // A state that stands still has no range; a thousandth of its nominal value replaces it.
                let spread = range.1 - range.0;
                state.size = if spread.is_finite() { spread.max(1e-3 * state.size) } else { state.size };
            }
        }
    }

    /// Fits the initial states of one piece to its own samples.
    ///
    /// Returns them in z, the trajectories of the states that joints compare, and the end state. The trajectories are
    /// empty and the state is `None` where the piece cannot be run.
    fn fit_alone(
        &self,
        case: usize,
        leg: usize,
        from: Option<State>,
        parameters: &[f64],
    ) -> (Vec<f64>, Vec<Vec<f64>>, Option<State>) {
        let of = &self.cases[case];
        let mut one = self.single(of.alone(leg, from), parameters);
        let n = of.legs[leg].states.len();
        let free = VariableBounds { low: vec![f64::NEG_INFINITY; n], high: vec![f64::INFINITY; n] };
        let effort = StoppingCriteria { iterations: 20, ..StoppingCriteria::default() };
        let z = minimise(&mut one, &vec![0.0; n], &free, effort).map_or_else(|| vec![0.0; n], |found| found.z);
        // The run now goes on to the first sample of the next piece.
        one.cases[0].track = of.along(leg);
        let handed: Vec<VarId> = of.handed(0).iter().map(|s| s.variable).collect();
        match one.leg(0, 0, &z, None, &handed) {
            Ok((columns, end)) => (z, columns, Some(end)),
            Err(_) => (z, Vec::new(), None),
        }
    }

    /// The jumps left in `residual`; `None` where no recording is cut.
    pub(super) fn joints(&self, residual: &[f64]) -> Option<ContinuityDefects> {
        let count: usize = self.cases.iter().map(|c| c.legs.len() - 1).sum();
        let flat = &self.problem.model.flat;
        let name = |s: &FreeState| flat.variables[s.variable.index()].name.clone();
        let mut worst: Option<ContinuityDefects> = None;
        let first = residual.len() - self.all_states();
        for leg in self.cases.iter().flat_map(|c| &c.legs[1..]) {
            for (state, place) in leg.states.iter().zip(leg.places.clone()) {
                // Rows of jumps are divided by their deviation; this undoes it.
                let jump = (self.weights.joint * residual[first + place - self.parameters]).abs();
                if worst.as_ref().is_none_or(|w| jump > w.jump) {
                    worst = Some(ContinuityDefects { count, jump, state: name(state) });
                }
            }
        }
        worst
    }
}
