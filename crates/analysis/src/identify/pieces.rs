//! Recordings cut into pieces: each begins at a state of its own that is searched for, and has to end where the next one
//! begins.
//!
//! The conditions stand among the rows of the least squares, weighed more and more until nothing of a jump is left:
//! while they are loose each piece keeps near its part of the recording, which leads a search past the hollows of one
//! long run. Source: H. G. Bock, in Modelling of Chemical Reaction Systems, Springer 1981, 102; the weights as in
//! J. Nocedal, S. J. Wright, Numerical Optimization, 2006, section 17.1.

use super::output_error::OutputError;
use super::runs::RunInputs;
use super::{StoppingCriteria, VariableBounds, minimise};
use bramah_expr::VarId;
use bramah_solve::State;
use std::ops::Range;

/// A state at the start of a run that is searched for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FreeState {
    /// The state.
    pub variable: VarId,
    /// What one step of z means: at the start of a recording the nominal value, which is also the standard deviation of
    /// what is known beforehand; inside of it how far the state ranges.
    pub size: f64,
    /// The value at z = 0; `None` for the model's own.
    pub centre: Option<f64>,
}

impl FreeState {
    /// Puts the state where z says.
    pub fn put(&self, state: &mut State, z: f64) {
        let value = &mut state.values[self.variable.index()];
        *value = self.centre.unwrap_or(*value) + self.size * z;
    }
}

/// A run along a part of a recording.
#[derive(Clone, Debug)]
pub struct ShootingInterval {
    /// Its first sample.
    pub first: usize,
    /// The states at its start that are searched for.
    pub states: Vec<FreeState>,
    /// Their places in z.
    pub places: Range<usize>,
}

/// One recording with its unknown states.
#[derive(Clone, Debug)]
pub struct RecordingCase {
    /// The whole of it.
    pub track: RunInputs,
    /// Measured values, one column a signal.
    pub measured: Vec<Vec<f64>>,
    /// The runs that follow each other along it.
    pub legs: Vec<ShootingInterval>,
    /// Where the first run starts when not at the model's own start.
    pub from: Option<State>,
}

impl RecordingCase {
    /// The samples of a leg.
    pub fn samples(&self, leg: usize) -> Range<usize> {
        self.legs[leg].first..self.legs.get(leg + 1).map_or(self.track.times.len(), |next| next.first)
    }

    /// What a leg runs along: to the start of the next one.
    pub fn along(&self, leg: usize) -> RunInputs {
        let end = self.samples(leg).end.min(self.track.times.len() - 1);
        if self.legs.len() == 1 { self.track.clone() } else { self.track.between(self.legs[leg].first, end) }
    }

    /// The states that the end of a leg has to hand on.
    pub fn handed(&self, leg: usize) -> &[FreeState] {
        self.legs.get(leg + 1).map_or(&[], |next| &next.states)
    }

    /// All places of this recording in z.
    pub fn places(&self) -> Range<usize> {
        let last = &self.legs[self.legs.len() - 1];
        self.legs[0].places.start..last.places.end
    }

    /// How many conditions join its legs.
    pub fn conditions(&self) -> usize {
        self.legs[1..].iter().map(|leg| leg.states.len()).sum()
    }

    /// One leg alone, from a state.
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

/// How pieces of recordings join after a fit.
#[derive(Clone, Debug, PartialEq)]
pub struct ContinuityDefects {
    /// How many places there are where pieces join.
    pub count: usize,
    /// The largest jump left there, as a part of the range of its state.
    pub jump: f64,
    /// That state.
    pub state: String,
}

/// Jumps above this part of a state's range: the pieces are not one motion.
pub const APART: f64 = 1e-3;
/// Standard deviations of jumps, as parts of the states' ranges: where a search begins, by how much each round is
/// stricter, and where it ends. The last one is what runs leave of a jump at their tolerance.
pub const LOOSE: f64 = 0.1;
/// By how much each round is stricter.
pub const STRICTER: f64 = 0.1;
/// Where it ends.
pub const TIGHT: f64 = 1e-6;
/// With which what can be found at all is judged.
pub const USUAL: f64 = 1e-4;

/// The first samples of this many pieces.
pub fn cuts(samples: usize, pieces: usize) -> impl Iterator<Item = usize> {
    (0..pieces).map(move |k| k * samples / pieces)
}

impl OutputError<'_> {
    /// Finds, with the parameters as the model has them, where the pieces of a recording begin: each where its own
    /// samples put it, beginning with where the one before ended. Sizes become how far states range.
    pub(super) fn place_joints(&mut self, case: usize, parameters: &[f64]) {
        let legs = self.cases[case].legs.len();
        let inner: Vec<VarId> = self.cases[case].handed(0).iter().map(|s| s.variable).collect();
        let mut ranges = vec![(f64::INFINITY, f64::NEG_INFINITY); inner.len()];
        let mut before: Option<State> = None;
        for leg in 0..legs {
            if leg > 0 {
                let track = self.cases[case].along(leg);
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
                let spread = range.1 - range.0;
                state.size = if spread.is_finite() { spread.max(1e-3 * state.size) } else { state.size };
            }
        }
    }

    /// The states at the start of a leg from its own samples, the trajectory of the states that pieces hand on, and where it
    /// ends; a leg that cannot be run has neither.
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
        one.cases[0].track = of.along(leg);
        let handed: Vec<VarId> = of.handed(0).iter().map(|s| s.variable).collect();
        match one.leg(0, 0, &z, None, &handed) {
            Ok((columns, end)) => (z, columns, Some(end)),
            Err(_) => (z, Vec::new(), None),
        }
    }

    /// How the pieces join with this residual; `None` where no recording is cut.
    pub(super) fn joints(&self, residual: &[f64]) -> Option<ContinuityDefects> {
        let count: usize = self.cases.iter().map(|c| c.legs.len() - 1).sum();
        let flat = &self.problem.model.flat;
        let name = |s: &FreeState| flat.variables[s.variable.index()].name.clone();
        let mut worst: Option<ContinuityDefects> = None;
        let first = residual.len() - self.all_states();
        for leg in self.cases.iter().flat_map(|c| &c.legs[1..]) {
            for (state, place) in leg.states.iter().zip(leg.places.clone()) {
                let jump = (self.weights.joint * residual[first + place - self.parameters]).abs();
                if worst.as_ref().is_none_or(|w| jump > w.jump) {
                    worst = Some(ContinuityDefects { count, jump, state: name(state) });
                }
            }
        }
        worst
    }
}
