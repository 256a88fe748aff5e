//! Output error: runs from the inputs alone against what was measured, with the initial states among the unknowns.
//!
//! Runs carry their derivatives along, which is checked once against a difference; where this fails, derivatives are
//! central differences.

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

/// Residual and derivatives of runs along recordings.
pub struct OutputError<'a> {
    pub(super) problem: &'a IdentificationProblem<'a>,
    /// How runs are made.
    pub(super) runner: ModelRunner<'a>,
    wanted: Vec<VarId>,
    pub(super) cases: Vec<RecordingCase>,
    pub(super) weights: ResidualWeights,
    /// Parameters in z; 0 where only initial states are searched for.
    pub(super) parameters: usize,
    /// Parameter values where they are not searched for.
    fixed: Vec<f64>,
    /// What carries derivatives along, where there is anything.
    exact: Option<Arc<ForwardSensitivityModel>>,
    /// Per recording whether they hold: not known yet, or why they do not.
    trust: Vec<DerivativeValidity>,
    /// Why the last run failed.
    pub broken: Option<RunFailure>,
}

/// Whether derivatives carried along hold along a recording.
#[derive(Clone, Debug, PartialEq)]
enum DerivativeValidity {
    Unknown,
    Holds,
    /// Why not.
    Fails(String),
}

/// Step of the differences in z.
const STEP: f64 = 1e-4;
/// How far derivatives carried along may be from a difference, as a part of its largest value.
const AGREE: f64 = 2e-3;
/// The part of the samples that may lie between the moved times of an event.
const BETWEEN: f64 = 0.02;
/// Steps of that difference: a long one, so that the error of the runs does not show, and a shorter one where the signals
/// are strongly curved.
const CHECKS: [f64; 2] = [1e-3, 1e-4];

impl<'a> OutputError<'a> {
    /// For recordings: with parameters among the unknowns, or with parameters at `fixed` and initial states alone.
    ///
    /// # Errors
    /// When the model cannot start.
    pub fn new(
        problem: &'a IdentificationProblem<'a>,
        recordings: &[Recording],
        fixed: Option<&[f64]>,
    ) -> Result<OutputError<'a>, RunFailure> {
        let tolerance = problem.model.flat.experiment.tolerance.unwrap_or(1e-6).min(1e-6) * 1e-2;
        let runner = ModelRunner { model: problem.model, tolerance };
        let parameters = if fixed.is_some() { 0 } else { problem.free.len() };
        let fixed = fixed.map_or_else(|| vec![0.0; problem.free.len()], <[f64]>::to_vec);
        let mut cases = Vec::new();
        let mut next = parameters;
        for recording in recordings {
            let track = RunInputs::new(problem.bound, recording);
            let states = free_states(problem, &runner, &track, &fixed)?;
            let mut legs = Vec::new();
            for first in pieces::cuts(track.times.len(), recording.pieces) {
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
        for case in (0..all.cases.len()).filter(|&c| recordings[c].pieces > 1) {
            all.place_joints(case, &all.fixed.clone());
        }
        Ok(all)
    }

    /// The same problem for states at the start of one case alone, parameters standing still.
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
            trust: vec![DerivativeValidity::Fails("it is not asked for".to_owned())],
            broken: None,
        }
    }

    /// Takes derivatives carried along, or differences for the reason given.
    pub fn differentiate_by(&mut self, exact: Result<Arc<ForwardSensitivityModel>, String>) {
        match exact {
            Ok(exact) => self.exact = Some(exact),
            Err(why) => self.trust.fill(DerivativeValidity::Fails(why)),
        }
    }

    /// Why derivatives were differences along some recording.
    pub fn differences(&self) -> Option<&str> {
        self.trust.iter().find_map(|t| if let DerivativeValidity::Fails(why) = t { Some(why.as_str()) } else { None })
    }

    /// The same with only the first seconds of each recording.
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

    /// True where initial states are searched for.
    pub fn frees_states(&self) -> bool {
        self.all_states() > 0
    }

    /// How many states are searched for.
    pub(super) fn all_states(&self) -> usize {
        self.cases.iter().map(|c| c.places().len()).sum()
    }

    /// Simulated values along one recording, one column a variable.
    ///
    /// # Errors
    /// When the run does not reach the end.
    pub fn simulate(&self, case: usize, z: &[f64], wanted: &[VarId]) -> Result<Vec<Vec<f64>>, RunFailure> {
        self.trajectory(case, z, wanted).map(|run| run.signals)
    }

    /// One leg from the end of the one before: the values of `wanted` at its samples and at the start of the next leg,
    /// and the state there.
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
        let start = match before {
            Some(state) => Some(state),
            None if leg.states.is_empty() => None,
            None => Some(self.runner.start(&track, &parameters)?),
        };
        let start = start.map(|mut state| {
            leg.states.iter().zip(&z[leg.places.clone()]).for_each(|(free, &z)| free.put(&mut state, z));
            state
        });
        self.runner.run_on(&track, &parameters, start.as_ref(), wanted)
    }

    /// All legs of a recording.
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

    /// One leg: the signals at its own samples, the jumps to the next leg, and its end.
    fn leg_values(
        &self,
        case: usize,
        leg: usize,
        z: &[f64],
        before: Option<State>,
        wanted: &[VarId],
    ) -> Result<(ShootingValues, State), RunFailure> {
        let of = &self.cases[case];
        let asked = with_handed(wanted, of.handed(leg));
        let (mut columns, end) = self.leg(case, leg, z, before, &asked)?;
        let handed = columns.split_off(wanted.len());
        let next = of.legs.get(leg + 1).map_or(0..0, |next| next.places.clone());
        let jump = |((column, state), z): ((&Vec<f64>, &FreeState), &f64)| {
            (column[column.len() - 1] - state.centre.unwrap_or(0.0)) / state.size - z
        };
        let jumps = handed.iter().zip(of.handed(leg)).zip(&z[next]).map(jump).collect();
        columns.iter_mut().for_each(|c| c.truncate(of.samples(leg).len()));
        Ok((ShootingValues { signals: columns, jumps }, end))
    }

    /// Errors of one recording over the deviations in the order of its rows, and its jumps over theirs.
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

    /// Values along one recording over the deviations, where something was measured, and jumps over theirs.
    fn weighed(&self, case: usize, values: &ShootingValues) -> Vec<f64> {
        let mut out = Vec::new();
        for (k, (column, measured)) in values.signals.iter().zip(&self.cases[case].measured).enumerate() {
            let known = column.iter().zip(measured).filter(|(_, m)| !m.is_nan());
            out.extend(known.map(|(v, _)| v / self.weights.sigma[k]));
        }
        out.extend(values.jumps.iter().map(|j| j / self.weights.joint));
        out
    }

    /// The unknowns that move a recording.
    fn moves(&self, case: usize) -> impl Iterator<Item = usize> {
        (0..self.parameters).chain(self.cases[case].places())
    }
}

/// What runs along a recording say: values of signals at the samples, and how far each leg misses the start of the next,
/// in the sizes of the states; or the derivatives of both.
#[derive(Clone, Debug, Default)]
struct ShootingValues {
    signals: Vec<Vec<f64>>,
    jumps: Vec<f64>,
}

impl ShootingValues {
    /// (a - b)/h
    fn over(a: &ShootingValues, b: &ShootingValues, h: f64) -> ShootingValues {
        let over = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b) / h).collect();
        let signals = a.signals.iter().zip(&b.signals).map(|(a, b)| over(a, b)).collect();
        ShootingValues { signals, jumps: over(&a.jumps, &b.jumps) }
    }
}

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
                    let jumps = errors.split_off(errors.len() - case.conditions());
                    all.extend(errors);
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

    fn jacobian(&mut self, z: &[f64], residual: &DVector<f64>) -> Option<DMatrix<f64>> {
        let mut jacobian = DMatrix::zeros(residual.len(), z.len());
        let by_equations = self.by_equations(z);
        let this = &*self;
        let left = (0..this.cases.len()).filter(|&c| by_equations[c].is_none());
        let jobs: Vec<(usize, usize)> = left.flat_map(|c| this.moves(c).map(move |j| (c, j))).collect();
        let ends: Vec<Vec<State>> = (0..this.cases.len()).map(|c| this.ends(c, z)).collect::<Result<_, _>>().ok()?;
        let columns: Vec<Option<Vec<f64>>> =
            jobs.par_iter().map(|&(c, j)| this.difference(c, j, z, &ends[c])).collect();
        let states = residual.len() - self.all_states();
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
        for place in self.cases.iter().flat_map(|c| c.legs[0].places.clone()) {
            jacobian[(states + place - self.parameters, place)] = 1.0;
        }
        Some(jacobian)
    }

    fn conditions(&self) -> usize {
        // states at the start of recordings, known to their nominal values, stand among them and do not matter
        if self.cases.iter().any(|c| c.legs.len() > 1) { self.all_states() } else { 0 }
    }
}

impl OutputError<'_> {
    /// The signals along the first recording with the errors of `residual`.
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

    fn first_row(&self, case: usize) -> usize {
        self.weights.series.iter().filter(|s| s.recording < case).map(|s| s.rows.len()).sum()
    }

    /// Per recording one column an unknown that moves it, where derivatives carried along hold.
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

    /// Derivatives of the weighed errors of a recording, carried along by its run.
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
            let own = (0..self.parameters).chain(leg.places.clone().map(|j| j - of.places().start + self.parameters));
            for (unknown, columns) in own.zip(columns) {
                let (samples, to) = (of.samples(k), &mut all[unknown]);
                for (signal, column) in to.signals.iter_mut().zip(&columns) {
                    signal[samples.clone()].copy_from_slice(&column[..samples.len()]);
                }
                let ends = columns[self.wanted.len()..].iter().zip(handed);
                ends.enumerate().for_each(|(i, (c, s))| to.jumps[jump + i] = c[c.len() - 1] / s.size);
            }
            let next = of.legs.get(k + 1).map_or(0..0, |next| next.places.clone());
            next.enumerate().for_each(|(i, j)| all[j - of.places().start + self.parameters].jumps[jump + i] = -1.0);
            jump += handed.len();
            before = Some(end);
        }
        let columns: Vec<Vec<f64>> = all.iter().map(|values| self.weighed(case, values)).collect();
        let finite = columns.iter().flatten().all(|v| v.is_finite());
        if finite { Ok(columns) } else { Err("a derivative is not finite".to_owned()) }
    }

    /// Compares with the difference along one direction in which all unknowns move.
    fn agrees(&self, case: usize, z: &[f64], columns: &[Vec<f64>]) -> Result<(), String> {
        // each as far as it moves the errors alike, so that none hides behind another
        let size = |c: &Vec<f64>| c.iter().map(|v| v * v).sum::<f64>().sqrt();
        let largest = columns.iter().map(size).fold(0.0, f64::max);
        let reach = |c: &Vec<f64>| if largest > 0.0 { (largest / size(c).max(1e-3 * largest)).min(10.0) } else { 1.0 };
        let share: Vec<f64> = columns.iter().enumerate().map(|(k, c)| reach(c) * (1.0 + k as f64).cos()).collect();
        let mut checks = CHECKS.iter().map(|&step| self.agrees_over(case, z, (columns, &share), step));
        let first = checks.next().expect("there are some");
        first.or_else(|why| checks.find_map(Result::ok).ok_or(why))
    }

    /// Compares over one step, in which each unknown takes its share.
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
        // a sample between the moved times of an event tells nothing
        let apart = pairs.iter().filter(|p| (p.0 - p.1).abs() > AGREE * most).count();
        if apart as f64 <= (BETWEEN * pairs.len() as f64).ceil() {
            Ok(())
        } else {
            Err("signals do not follow their derivatives".to_owned())
        }
    }

    /// By central differences of tight runs, which are right across events too; one-sided where a run fails.
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

    /// Where the legs of a cut recording end.
    fn ends(&self, case: usize, z: &[f64]) -> Result<Vec<State>, RunFailure> {
        let legs = self.cases[case].legs.len();
        let mut ends: Vec<State> = Vec::new();
        for leg in 0..if legs > 1 { legs } else { 0 } {
            let before = ends.last().cloned();
            ends.push(self.leg(case, leg, z, before, &[])?.1);
        }
        Ok(ends)
    }

    /// What an unknown moves along a recording: the start of a piece its own leg alone, all else stays 0.
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

/// The states whose start the model leaves to chance: those that no parameter of the study moves.
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
        let given = moved.iter().any(|m| (m.values[v.index()] - base.values[v.index()]).abs() > 1e-7 * size);
        if !given {
            free.push(FreeState { variable: v, size, centre: None });
        }
    }
    Ok(free)
}

/// All states, for the start of a piece.
fn inner_states(problem: &IdentificationProblem<'_>) -> Vec<FreeState> {
    let system = &problem.model.system;
    let mut values = system.layout.values();
    system.evaluate_parameters(&mut values, &[]);
    let one = |&v: &VarId| FreeState { variable: v, size: system.nominal(v, &values), centre: None };
    system.dae.states.iter().map(one).collect()
}
