//! Output error: the difference between runs from the inputs alone and the measured signals.
//!
//! Recordings and a point z enter; the residual and its Jacobian leave, for [`super::minimise`]. The unknowns are the
//! parameters, then the initial states of each recording, then the states at the joints of its pieces (`pieces`).
//!
//! Rows of the residual: for each recording and signal one error per measured sample, over the signal's deviation; then
//! priors of the parameters; then for each recording its initial states (their prior) and its jumps at joints.
//!
//! The Jacobian comes from sensitivities that are integrated with the run (`exact`). They are checked once against a
//! finite difference along each recording; where they fail, central differences replace them.

use super::exact::ForwardSensitivityModel;
use super::least_squares::LeastSquares;
use super::pieces::{self, FreeState, RecordingCase, ShootingInterval};
use super::runs::{ModelRunner, RunFailure, RunInputs};
use super::weights::ResidualWeights;
use super::{IdentificationProblem, SignalTrajectory, WeightedResiduals};
use crate::estimate::ResidualSeries;
use crate::study::Recording;
use bramah_expr::VarId;
use bramah_solve::State;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use std::sync::Arc;

/// The output-error problem along some recordings.
pub struct OutputError<'a> {
    /// The model, its study and the parameters to estimate.
    pub(super) problem: &'a IdentificationProblem<'a>,
    /// Runs the model with a tight tolerance.
    pub(super) runner: ModelRunner<'a>,
    /// The model's variable of each signal.
    wanted: Vec<VarId>,
    /// The recordings, each with its unknown states.
    pub(super) cases: Vec<RecordingCase>,
    /// Deviations of signals and joints, and the rows of each series.
    pub(super) weights: ResidualWeights,
    /// How many parameters z holds; 0 where only initial states are estimated.
    pub(super) parameters: usize,
    /// Parameters in z for runs in which they are not estimated.
    fixed: Vec<f64>,
    /// The model that integrates its own sensitivities; `None` until [`OutputError::differentiate_by`] sets it.
    exact: Option<Arc<ForwardSensitivityModel>>,
    /// For each recording, whether integrated sensitivities are valid there.
    trust: Vec<DerivativeValidity>,
    /// The failure of the last run that failed.
    pub broken: Option<RunFailure>,
}

/// Whether integrated sensitivities are valid along a recording.
#[derive(Clone, Debug, PartialEq)]
enum DerivativeValidity {
    /// Not checked yet.
    Unknown,
    /// They agreed with a finite difference.
    Holds,
    /// They did not, or could not be computed, for this reason.
    Fails(String),
}

/// Step of central differences, in z.
const STEP: f64 = 1e-4;
/// Largest difference between a sensitivity and a finite difference, relative to the largest sensitivity of the
/// recording.
const AGREE: f64 = 2e-3;
/// Share of samples that may disagree, because they lie between the shifted times of an event.
const BETWEEN: f64 = 0.02;
/// Steps of the checking difference, in z: a long one, which stands out of the integration error, and a shorter one for
/// signals that are strongly curved in z.
const CHECKS: [f64; 2] = [1e-3, 1e-4];

impl<'a> OutputError<'a> {
    /// Sets up the problem for `recordings`.
    ///
    /// With `fixed`, parameters stay at these values in z and only initial states are estimated. The starts of pieces
    /// of a cut recording are placed along the recording (`place_joints`).
    ///
    /// # Errors
    /// When the model cannot start.
    pub fn new(
        problem: &'a IdentificationProblem<'a>,
        recordings: &[Recording],
        fixed: Option<&[f64]>,
    ) -> Result<OutputError<'a>, RunFailure> {
        // Finite differences divide the integration error by a step of 1e-4, so runs are a hundred times tighter than
        // usual.
        let tolerance = problem.model.flat.experiment.tolerance.unwrap_or(1e-6).min(1e-6) * 1e-2;
        let runner = ModelRunner { model: problem.model, tolerance };
        let parameters = if fixed.is_some() { 0 } else { problem.free.len() };
        let fixed = fixed.map_or_else(|| vec![0.0; problem.free.len()], <[f64]>::to_vec);
        let mut cases = Vec::new();
        let mut next = parameters;
        for recording in recordings {
            let track = RunInputs::new(problem.bound, recording);
            // Initial states that a parameter decides are not free: the parameter already moves them.
            let states = free_states(problem, &runner, &track, &fixed)?;
            let mut legs = Vec::new();
            for first in pieces::cuts(track.times.len(), recording.pieces) {
                // At a joint all states are free, whatever the parameters move.
                let states = if first == 0 { states.clone() } else { inner_states(problem) };
                let places = next..next + states.len();
                next = places.end;
                legs.push(ShootingInterval { first, states, places });
            }
            cases.push(RecordingCase { track, measured: recording.signals.clone(), legs, from: None });
        }
        let weights = ResidualWeights::new(series(&cases), problem.first_deviations());
        let wanted = problem.bound.signals.iter().map(|s| s.variable).collect();
        let trust = vec![DerivativeValidity::Unknown; cases.len()];
        let mut all = OutputError {
            problem,
            runner,
            wanted,
            cases,
            weights,
            parameters,
            fixed,
            exact: None,
            trust,
            broken: None,
        };
        // Placing the joints needs runs, so it comes after the problem is complete.
        for case in (0..all.cases.len()).filter(|&c| recordings[c].pieces > 1) {
            all.place_joints(case, &all.fixed.clone());
        }
        Ok(all)
    }

    /// The problem of one case alone with fixed parameters, in which only states at its start are unknown.
    pub(super) fn single(&self, case: RecordingCase, parameters: &[f64]) -> OutputError<'a> {
        let cases = vec![case];
        OutputError {
            problem: self.problem,
            runner: self.runner,
            wanted: self.wanted.clone(),
            weights: ResidualWeights::new(series(&cases), self.weights.sigma.clone()),
            cases,
            parameters: 0,
            fixed: parameters.to_vec(),
            exact: None,
            // Few unknowns: central differences are cheap enough.
            trust: vec![DerivativeValidity::Fails("it is not asked for".to_owned())],
            broken: None,
        }
    }

    /// Sets the source of derivatives: integrated sensitivities, or finite differences for the reason given.
    pub fn differentiate_by(&mut self, exact: Result<Arc<ForwardSensitivityModel>, String>) {
        match exact {
            Ok(exact) => self.exact = Some(exact),
            Err(why) => self.trust.fill(DerivativeValidity::Fails(why)),
        }
    }

    /// Why finite differences were used along some recording; `None` where they were used nowhere.
    pub fn differences(&self) -> Option<&str> {
        self.trust.iter().find_map(|t| if let DerivativeValidity::Fails(why) = t { Some(why.as_str()) } else { None })
    }

    /// The same problem with only the beginning of each recording. `length` gives its seconds from the times of the
    /// samples.
    #[must_use]
    pub fn beginning(mut self, length: impl Fn(&[f64]) -> f64) -> OutputError<'a> {
        for case in &mut self.cases {
            let track = case.track.until(case.track.times[0] + length(&case.track.times));
            case.measured.iter_mut().for_each(|m| m.truncate(track.times.len()));
            case.track = track;
        }
        self.weights.series = series(&self.cases);
        self
    }

    /// Whether z holds states.
    pub fn frees_states(&self) -> bool {
        self.all_states() > 0
    }

    /// How many states z holds: initial ones and those at joints.
    pub(super) fn all_states(&self) -> usize {
        self.cases.iter().map(|c| c.places().len()).sum()
    }

    /// Simulated values along one recording at its samples, one column for each of `wanted`.
    ///
    /// # Errors
    /// When the run does not reach the end.
    pub fn simulate(&self, case: usize, z: &[f64], wanted: &[VarId]) -> Result<Vec<Vec<f64>>, RunFailure> {
        self.trajectory(case, z, wanted).map(|run| run.signals)
    }

    /// Runs one piece (leg) of a recording.
    ///
    /// `before` is the state at the end of the piece before; `None` for the first one. Returns the values of `wanted`
    /// at the samples of the piece and at the first sample of the next one, and the state there.
    pub(super) fn leg(
        &self,
        case: usize,
        leg: usize,
        z: &[f64],
        before: Option<State>,
        wanted: &[VarId],
    ) -> Result<(Vec<Vec<f64>>, State), RunFailure> {
        let values = if self.parameters > 0 { &z[..self.parameters] } else { self.fixed.as_slice() };
        let parameters = self.problem.parameters(values);
        let of = &self.cases[case];
        let (track, leg) = (of.along(leg), &of.legs[leg]);
        let before = before.or_else(|| of.from.clone());
        // A run starts at the model's own initial equations where no state is free.
        let start = match before {
            Some(state) => Some(state),
            None if leg.states.is_empty() => None,
            None => Some(self.runner.start(&track, &parameters)?),
        };
        // Free states replace those of `before`; everything else, as discrete variables, carries over.
        let start = start.map(|mut state| {
            leg.states.iter().zip(&z[leg.places.clone()]).for_each(|(free, &z)| free.put(&mut state, z));
            state
        });
        self.runner.run_on(&track, &parameters, start.as_ref(), wanted)
    }

    /// Runs all pieces of a recording one after the other.
    fn trajectory(&self, case: usize, z: &[f64], wanted: &[VarId]) -> Result<ShootingValues, RunFailure> {
        let of = &self.cases[case];
        let mut all = ShootingValues { signals: vec![Vec::new(); wanted.len()], jumps: Vec::new() };
        let mut before = None;
        for leg in 0..of.legs.len() {
            let (values, end) = self.leg_values(case, leg, z, before, wanted)?;
            all.signals.iter_mut().zip(values.signals).for_each(|(all, part)| all.extend(part));
            all.jumps.extend(values.jumps);
            before = Some(end);
        }
        Ok(all)
    }

    /// Runs one piece and returns its signals at its own samples, its jumps to the next piece, and its end state.
    ///
    /// A jump is (end of this piece - start of the next) of a state, in units of the state's range.
    fn leg_values(
        &self,
        case: usize,
        leg: usize,
        z: &[f64],
        before: Option<State>,
        wanted: &[VarId],
    ) -> Result<(ShootingValues, State), RunFailure> {
        let of = &self.cases[case];
        // The states at the joint are requested behind the signals and split off after the run.
        let asked = with_handed(wanted, of.handed(leg));
        let (mut columns, end) = self.leg(case, leg, z, before, &asked)?;
        let handed = columns.split_off(wanted.len());
        let next = of.legs.get(leg + 1).map_or(0..0, |next| next.places.clone());
        // Both sides are expressed on the scale of z of the next piece: (end - centre)/size - z.
        let jump = |((column, state), z): ((&Vec<f64>, &FreeState), &f64)| {
            (column[column.len() - 1] - state.centre.unwrap_or(0.0)) / state.size - z
        };
        let jumps = handed.iter().zip(of.handed(leg)).zip(&z[next]).map(jump).collect();
        // The last value belongs to the first sample of the next piece, which scores it.
        columns.iter_mut().for_each(|c| c.truncate(of.samples(leg).len()));
        Ok((ShootingValues { signals: columns, jumps }, end))
    }

    /// The residual of one recording without priors: errors over deviations, then jumps over theirs.
    ///
    /// # Errors
    /// When a run fails or a value is not finite.
    fn errors(&self, case: usize, z: &[f64]) -> Result<Vec<f64>, RunFailure> {
        let mut values = self.trajectory(case, z, &self.wanted)?;
        for (simulated, measured) in values.signals.iter_mut().zip(&self.cases[case].measured) {
            simulated.iter_mut().zip(measured).for_each(|(s, m)| *s -= m);
        }
        let out = self.weighed(case, &values);
        if out.iter().all(|v| v.is_finite()) {
            Ok(out)
        } else {
            Err(RunFailure { time: f64::NAN, message: "a value is not finite".into() })
        }
    }

    /// Flattens `values` into rows: signals at measured samples over their deviations, then jumps over theirs.
    fn weighed(&self, case: usize, values: &ShootingValues) -> Vec<f64> {
        let mut out = Vec::new();
        for (k, (column, measured)) in values.signals.iter().zip(&self.cases[case].measured).enumerate() {
            let known = column.iter().zip(measured).filter(|(_, m)| !m.is_nan());
            out.extend(known.map(|(v, _)| v / self.weights.sigma[k]));
        }
        out.extend(values.jumps.iter().map(|j| j / self.weights.joint));
        out
    }

    /// The places in z that affect a recording: all parameters and its own states.
    fn moves(&self, case: usize) -> impl Iterator<Item = usize> {
        (0..self.parameters).chain(self.cases[case].places())
    }
}

/// Values along the pieces of a recording, or their derivatives by one unknown.
#[derive(Clone, Debug, Default)]
struct ShootingValues {
    /// One column for each signal, at all samples.
    signals: Vec<Vec<f64>>,
    /// The jump of each state at each joint, in units of the state's range.
    jumps: Vec<f64>,
}

impl ShootingValues {
    /// The difference quotient (a - b)/h.
    fn over(a: &ShootingValues, b: &ShootingValues, h: f64) -> ShootingValues {
        let over = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b) / h).collect();
        let signals = a.signals.iter().zip(&b.signals).map(|(a, b)| over(a, b)).collect();
        ShootingValues { signals, jumps: over(&a.jumps, &b.jumps) }
    }
}

/// The variables `wanted`, followed by the states that a joint compares.
fn with_handed(wanted: &[VarId], handed: &[FreeState]) -> Vec<VarId> {
    wanted.iter().copied().chain(handed.iter().map(|s| s.variable)).collect()
}

impl LeastSquares for OutputError<'_> {
    fn residual(&mut self, z: &[f64]) -> Option<DVector<f64>> {
        let this = &*self;
        let found: Vec<Result<Vec<f64>, RunFailure>> =
            (0..this.cases.len()).into_par_iter().map(|c| this.errors(c, z)).collect();
        let (mut all, mut last) = (Vec::new(), Vec::new());
        for (errors, case) in found.into_iter().zip(&this.cases) {
            match errors {
                Ok(mut errors) => {
                    // Rows of states of all recordings stand last, so jumps wait in `last` until the errors are
                    // complete.
                    let jumps = errors.split_off(errors.len() - case.conditions());
                    all.extend(errors);
                    // z of an initial state is in units of its prior deviation, so z itself is the residual of the
                    // prior.
                    last.extend(&z[case.legs[0].places.clone()]);
                    last.extend(jumps);
                }
                Err(broken) => {
                    self.broken = Some(broken);
                    return None;
                }
            }
        }
        if self.parameters > 0 {
            all.extend(self.problem.priors(&z[..self.parameters]));
        }
        all.extend(last);
        Some(DVector::from_vec(all))
    }

    // Recordings without valid sensitivities are differentiated column by column, all columns in parallel.
    fn jacobian(&mut self, z: &[f64], residual: &DVector<f64>) -> Option<DMatrix<f64>> {
        let mut jacobian = DMatrix::zeros(residual.len(), z.len());
        let by_equations = self.by_equations(z);
        let this = &*self;
        let left = (0..this.cases.len()).filter(|&c| by_equations[c].is_none());
        let jobs: Vec<(usize, usize)> = left.flat_map(|c| this.moves(c).map(move |j| (c, j))).collect();
        // The end states at z are shared by all columns of a cut recording: a joint moves only the piece behind it.
        let ends: Vec<Vec<State>> = (0..this.cases.len()).map(|c| this.ends(c, z)).collect::<Result<_, _>>().ok()?;
        let columns: Vec<Option<Vec<f64>>> =
            jobs.par_iter().map(|&(c, j)| this.difference(c, j, z, &ends[c])).collect();
        // The first row about states.
        let states = residual.len() - self.all_states();
        // Writes a column of one recording: its errors at its own rows, its jumps behind its initial states.
        let mut fill = |c: usize, j: usize, column: Vec<f64>| {
            let case = &this.cases[c];
            let (errors, jumps) = column.split_at(column.len() - case.conditions());
            let joints = states + case.legs[0].places.end - this.parameters;
            for (first, part) in [(this.first_row(c), errors), (joints, jumps)] {
                let rows = jacobian.view_mut((first, j), (part.len(), 1));
                rows.into_iter().zip(part).for_each(|(entry, value)| *entry = *value);
            }
        };
        for ((c, j), column) in jobs.into_iter().zip(columns) {
            fill(c, j, column?);
        }
        for (c, columns) in by_equations.into_iter().enumerate() {
            for (j, column) in this.moves(c).zip(columns.into_iter().flatten()) {
                fill(c, j, column);
            }
        }
        if self.parameters > 0 {
            self.problem.prior_rows(&mut jacobian);
        }
        // Priors of initial states are z itself: slope 1.
        for place in self.cases.iter().flat_map(|c| c.legs[0].places.clone()) {
            jacobian[(states + place - self.parameters, place)] = 1.0;
        }
        Some(jacobian)
    }

    fn conditions(&self) -> usize {
        // Joints get large weights. Initial states of recordings are among these rows too, with a weight of 1; leaving
        // their slopes out of the damping does no harm.
        if self.cases.iter().any(|c| c.legs.len() > 1) { self.all_states() } else { 0 }
    }
}

impl OutputError<'_> {
    /// Measured and modelled signals along the first recording, from a residual of this problem.
    pub fn trajectories(&self, recordings: &[Recording], residual: &[f64]) -> Vec<SignalTrajectory> {
        let one = |s: &ResidualSeries| {
            let signal = &self.problem.bound.signals[s.signal];
            let measured = &recordings[0].signals[s.signal];
            let known = || recordings[0].times.iter().zip(measured).filter(|(_, m)| !m.is_nan());
            let sigma = self.weights.sigma[s.signal];
            SignalTrajectory {
                name: signal.name.clone(),
                unit: signal.unit.clone(),
                times: known().map(|k| *k.0).collect(),
                measured: known().map(|k| *k.1).collect(),
                errors: residual[s.rows.clone()].iter().map(|r| r * sigma).collect(),
            }
        };
        self.weights.series.iter().filter(|s| s.recording == 0).map(one).collect()
    }

    /// The first row of a recording among the data.
    fn first_row(&self, case: usize) -> usize {
        self.weights.series.iter().filter(|s| s.recording < case).map(|s| s.rows.len()).sum()
    }

    /// For each recording the columns of integrated sensitivities, one for each unknown in [`OutputError::moves`];
    /// `None` where they are not valid.
    ///
    /// The first use along a recording checks them and remembers the outcome.
    fn by_equations(&mut self, z: &[f64]) -> Vec<Option<Vec<Vec<f64>>>> {
        let this = &*self;
        let found: Vec<Result<Vec<Vec<f64>>, String>> = (0..this.cases.len())
            .into_par_iter()
            .map(|c| {
                let columns = this.exactly(c, z)?;
                if this.trust[c] == DerivativeValidity::Unknown {
                    this.agrees(c, z, &columns).map(|()| columns)
                } else {
                    Ok(columns)
                }
            })
            .collect();
        let judged = found.into_iter().zip(&mut self.trust).map(|(result, trust)| match result {
            Ok(columns) => {
                *trust = DerivativeValidity::Holds;
                Some(columns)
            }
            Err(why) => {
                *trust = DerivativeValidity::Fails(why);
                None
            }
        });
        judged.collect()
    }

    /// Sensitivities of the residual of one recording, integrated with its run; one column for each unknown that moves
    /// it.
    ///
    /// # Errors
    /// The reason why finite differences have to be used.
    fn exactly(&self, case: usize, z: &[f64]) -> Result<Vec<Vec<f64>>, String> {
        if let DerivativeValidity::Fails(why) = &self.trust[case] {
            return Err(why.clone());
        }
        let exact = self.exact.as_ref().filter(|_| self.parameters > 0).ok_or("they were not asked for")?;
        let of = &self.cases[case];
        let free = &self.problem.free;
        let nothing = || ShootingValues {
            signals: vec![vec![0.0; of.track.times.len()]; self.wanted.len()],
            jumps: vec![0.0; of.conditions()],
        };
        let mut all: Vec<ShootingValues> = self.moves(case).map(|_| nothing()).collect();
        let (mut before, mut jump) = (None, 0);
        for (k, leg) in of.legs.iter().enumerate() {
            let (track, handed) = (of.along(k), of.handed(k));
            let wanted = with_handed(&self.wanted, handed);
            let z = (&z[..self.parameters], &z[leg.places.clone()]);
            let run = (&track, leg.states.as_slice(), before.as_ref());
            let (columns, end) = exact.columns(run, free, z, &wanted, self.runner.tolerance)?;
            // Columns of a piece belong to the parameters and to the states at its own start only, because the next
            // piece starts at states of its own.
            let own = (0..self.parameters).chain(leg.places.clone().map(|j| j - of.places().start + self.parameters));
            for (unknown, columns) in own.zip(columns) {
                let (samples, to) = (of.samples(k), &mut all[unknown]);
                for (signal, column) in to.signals.iter_mut().zip(&columns) {
                    signal[samples.clone()].copy_from_slice(&column[..samples.len()]);
                }
                // d jump/d unknown at the end of this piece.
                let ends = columns[self.wanted.len()..].iter().zip(handed);
                ends.enumerate().for_each(|(i, (c, s))| to.jumps[jump + i] = c[c.len() - 1] / s.size);
            }
            // A jump is the end minus z of the next piece, so its derivative by that z is -1.
            let next = of.legs.get(k + 1).map_or(0..0, |next| next.places.clone());
            next.enumerate().for_each(|(i, j)| all[j - of.places().start + self.parameters].jumps[jump + i] = -1.0);
            jump += handed.len();
            before = Some(end);
        }
        let columns: Vec<Vec<f64>> = all.iter().map(|values| self.weighed(case, values)).collect();
        let finite = columns.iter().flatten().all(|v| v.is_finite());
        if finite { Ok(columns) } else { Err("a derivative is not finite".to_owned()) }
    }

    /// Checks sensitivities against a central difference along one direction that moves all unknowns at once.
    fn agrees(&self, case: usize, z: &[f64], columns: &[Vec<f64>]) -> Result<(), String> {
        // Each unknown moves far enough to affect the errors equally, so that a wrong column cannot hide behind a
        // larger one. The cosine varies the sign, so that wrong columns do not cancel each other systematically.
        let size = |c: &Vec<f64>| c.iter().map(|v| v * v).sum::<f64>().sqrt();
        let largest = columns.iter().map(size).fold(0.0, f64::max);
        let reach = |c: &Vec<f64>| if largest > 0.0 { (largest / size(c).max(1e-3 * largest)).min(10.0) } else { 1.0 };
        let share: Vec<f64> = columns.iter().enumerate().map(|(k, c)| reach(c) * (1.0 + k as f64).cos()).collect();
        let mut checks = CHECKS.iter().map(|&step| self.agrees_over(case, z, (columns, &share), step));
        // The second, shorter step runs only when the first one disagrees.
        let first = checks.next().expect("there are some");
        first.or_else(|why| checks.find_map(Result::ok).ok_or(why))
    }

    /// Checks over one step, of which each unknown takes its share; `Err` says why the check failed.
    fn agrees_over(
        &self,
        case: usize,
        z: &[f64],
        (columns, share): (&[Vec<f64>], &[f64]),
        step: f64,
    ) -> Result<(), String> {
        let at = |step: f64| {
            let mut moved = z.to_vec();
            self.moves(case).zip(share).for_each(|(j, s)| moved[j] += step * s);
            self.errors(case, &moved).map_err(|_| "a run with moved parameters failed".to_owned())
        };
        let (up, down) = (at(step)?, at(-step)?);
        let pairs = (0..up.len()).map(|i| {
            let sum: f64 = columns.iter().zip(share).map(|(c, s)| s * c[i]).sum();
            ((up[i] - down[i]) / (2.0 * step), sum)
        });
        let pairs: Vec<(f64, f64)> = pairs.collect();
        let most = pairs.iter().fold(0.0f64, |m, p| m.max(p.1.abs()));
        // Between the two times at which an event happens, a difference quotient jumps: such samples say nothing.
        let apart = pairs.iter().filter(|p| (p.0 - p.1).abs() > AGREE * most).count();
        if apart as f64 <= (BETWEEN * pairs.len() as f64).ceil() {
            Ok(())
        } else {
            Err("signals do not follow their derivatives".to_owned())
        }
    }

    /// One column of the Jacobian along a recording by central differences, which are right across events too.
    ///
    /// One-sided where one of the two runs fails; `None` where both fail.
    fn difference(&self, case: usize, j: usize, z: &[f64], ends: &[State]) -> Option<Vec<f64>> {
        let at = |step: f64| {
            let mut moved = z.to_vec();
            moved[j] += step;
            self.part(case, j, &moved, ends).ok()
        };
        let slope = match (at(STEP), at(-STEP)) {
            (Some(up), Some(down)) => ShootingValues::over(&up, &down, 2.0 * STEP),
            (Some(up), None) => ShootingValues::over(&up, &at(0.0)?, STEP),
            (None, Some(down)) => ShootingValues::over(&at(0.0)?, &down, STEP),
            (None, None) => return None,
        };
        Some(self.weighed(case, &slope)).filter(|column| column.iter().all(|v| v.is_finite()))
    }

    /// The states at the ends of the pieces of a cut recording; empty where it is not cut.
    fn ends(&self, case: usize, z: &[f64]) -> Result<Vec<State>, RunFailure> {
        let legs = self.cases[case].legs.len();
        let mut ends: Vec<State> = Vec::new();
        for leg in 0..if legs > 1 { legs } else { 0 } {
            let before = ends.last().cloned();
            ends.push(self.leg(case, leg, z, before, &[])?.1);
        }
        Ok(ends)
    }

    /// What the unknown `j` affects along a recording. All other values stay 0 and cancel in the difference.
    ///
    /// The start of a piece affects this piece alone and the jumps at both its ends. Any other unknown affects
    /// everything.
    fn part(&self, case: usize, j: usize, z: &[f64], ends: &[State]) -> Result<ShootingValues, RunFailure> {
        let of = &self.cases[case];
        let Some(leg) = (1..of.legs.len()).find(|&k| of.legs[k].places.contains(&j)) else {
            return self.trajectory(case, z, &self.wanted);
        };
        let mut all = ShootingValues {
            signals: vec![vec![0.0; of.track.times.len()]; self.wanted.len()],
            jumps: vec![0.0; of.conditions()],
        };
        let (values, _) = self.leg_values(case, leg, z, Some(ends[leg - 1].clone()), &self.wanted)?;
        let samples = of.samples(leg);
        for (all, part) in all.signals.iter_mut().zip(values.signals) {
            all[samples.clone()].copy_from_slice(&part);
        }
        let from = of.legs[leg].places.start - of.legs[0].places.end;
        // the end of the piece before is missed by as much as the start moves
        let places = of.legs[leg].places.clone();
        all.jumps[from..from + places.len()].iter_mut().zip(&z[places.clone()]).for_each(|(jump, z)| *jump = -z);
        let behind = from + places.len();
        all.jumps[behind..behind + values.jumps.len()].copy_from_slice(&values.jumps);
        Ok(all)
    }
}

impl WeightedResiduals for OutputError<'_> {
    fn weights(&mut self) -> &mut ResidualWeights {
        &mut self.weights
    }

    fn unknowns(&self) -> usize {
        self.parameters + self.all_states()
    }

    fn loosen(&mut self) {
        self.weights.joint = pieces::LOOSE;
    }

    fn tighten(&mut self) -> bool {
        let cut = self.cases.iter().any(|c| c.legs.len() > 1);
        let on = cut && self.weights.joint > 1.5 * pieces::TIGHT;
        if on {
            self.weights.joint *= pieces::STRICTER;
        }
        on
    }
}

/// The rows of each recording and signal: one row for each sample that holds a number.
fn series(cases: &[RecordingCase]) -> Vec<ResidualSeries> {
    let mut series = Vec::new();
    let mut row = 0;
    for (recording, case) in cases.iter().enumerate() {
        for (signal, measured) in case.measured.iter().enumerate() {
            let known = measured.iter().filter(|m| !m.is_nan()).count();
            series.push(ResidualSeries { recording, signal, rows: row..row + known });
            row += known;
        }
    }
    series
}

/// The initial states that no estimated parameter decides: they become unknowns.
///
/// Each parameter is moved by 1e-3 in z, and the states that the start of the model then takes are compared.
///
/// # Errors
/// When the model cannot start at `z`.
fn free_states(
    problem: &IdentificationProblem<'_>,
    runner: &ModelRunner<'_>,
    track: &RunInputs,
    z: &[f64],
) -> Result<Vec<FreeState>, RunFailure> {
    let base = runner.start(track, &problem.parameters(z))?;
    let moved: Vec<State> = (0..problem.free.len())
        .into_par_iter()
        .filter_map(|j| {
            let mut z = z.to_vec();
            z[j] += 1e-3;
            runner.start(track, &problem.parameters(&z)).ok()
        })
        .collect();
    let system = &problem.model.system;
    let mut values = system.layout.values();
    system.evaluate_parameters(&mut values, &[]);
    let mut free = Vec::new();
    for &v in &system.dae.states {
        let size = system.nominal(v, &values).max(base.values[v.index()].abs());
        // A parameter that moves the state by more than the rounding of the initial equations decides it.
        let given = moved.iter().any(|m| (m.values[v.index()] - base.values[v.index()]).abs() > 1e-7 * size);
        if !given {
            free.push(FreeState { variable: v, size, centre: None });
        }
    }
    Ok(free)
}

/// All states of the model, unknown at the start of a piece. `place_joints` fills their centres and sizes.
fn inner_states(problem: &IdentificationProblem<'_>) -> Vec<FreeState> {
    let system = &problem.model.system;
    let mut values = system.layout.values();
    system.evaluate_parameters(&mut values, &[]);
    let one = |&v: &VarId| FreeState { variable: v, size: system.nominal(v, &values), centre: None };
    system.dae.states.iter().map(one).collect()
}
