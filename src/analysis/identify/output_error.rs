//! Output error: runs from the inputs alone against what was measured, with the initial states among the unknowns.
//!
//! Runs carry their derivatives along, which is checked once against a difference; where this fails, derivatives are
//! central differences.

use super::exact::Exact;
use super::least_squares::LeastSquares;
use super::runs::{Broken, Runner, Track};
use super::weights::{Series, Weights};
use super::{Course, Problem, Residuals};
use crate::expr::VarId;
use crate::solve::State;
use crate::study::Recording;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Arc;

/// A state at the start of a recording that is searched for: z is its distance from the model's own value over `size`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FreeState {
    /// The state.
    pub variable: VarId,
    /// Its nominal value: one step of z, and the standard deviation of what is known beforehand.
    pub size: f64,
}

/// One recording with its unknown initial states.
#[derive(Clone, Debug)]
struct Case {
    track: Track,
    /// Measured values, one column a signal.
    measured: Vec<Vec<f64>>,
    states: Vec<FreeState>,
    /// Places of the states in z.
    places: Range<usize>,
}

/// Residual and derivatives of runs along recordings.
pub struct OutputError<'a> {
    problem: &'a Problem<'a>,
    /// How runs are made.
    pub(super) runner: Runner<'a>,
    wanted: Vec<VarId>,
    cases: Vec<Case>,
    weights: Weights,
    /// Parameters in z; 0 where only initial states are searched for.
    parameters: usize,
    /// Parameter values where they are not searched for.
    fixed: Vec<f64>,
    /// What carries derivatives along, where there is anything.
    exact: Option<Arc<Exact>>,
    /// Per recording whether they hold: not known yet, or why they do not.
    trust: Vec<Trust>,
    /// Why the last run failed.
    pub broken: Option<Broken>,
}

/// Whether derivatives carried along hold along a recording.
#[derive(Clone, Debug, PartialEq)]
enum Trust {
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
/// Step of that difference: long, so that the error of the runs does not show.
const CHECK: f64 = 1e-3;

impl<'a> OutputError<'a> {
    /// For recordings: with parameters among the unknowns, or with parameters at `fixed` and initial states alone.
    ///
    /// # Errors
    /// When the model cannot start.
    pub fn new(
        problem: &'a Problem<'a>,
        recordings: &[Recording],
        fixed: Option<&[f64]>,
    ) -> Result<OutputError<'a>, Broken> {
        let tolerance = problem.model.flat.experiment.tolerance.unwrap_or(1e-6).min(1e-6) * 1e-2;
        let runner = Runner { model: problem.model, tolerance };
        let parameters = if fixed.is_some() { 0 } else { problem.free.len() };
        let fixed = fixed.map_or_else(|| vec![0.0; problem.free.len()], <[f64]>::to_vec);
        let mut cases = Vec::new();
        let mut next = parameters;
        for recording in recordings {
            let track = Track::new(problem.bound, recording);
            let states = free_states(problem, &runner, &track, &fixed)?;
            let places = next..next + states.len();
            next = places.end;
            cases.push(Case { track, measured: recording.signals.clone(), states, places });
        }
        let weights = Weights::new(series(&cases), problem.first_deviations());
        let wanted = problem.bound.signals.iter().map(|s| s.variable).collect();
        let trust = vec![Trust::Unknown; cases.len()];
        Ok(OutputError { problem, runner, wanted, cases, weights, parameters, fixed, exact: None, trust, broken: None })
    }

    /// Takes derivatives carried along, or differences for the reason given.
    pub fn differentiate_by(&mut self, exact: Result<Arc<Exact>, String>) {
        match exact {
            Ok(exact) => self.exact = Some(exact),
            Err(why) => self.trust.fill(Trust::Fails(why)),
        }
    }

    /// Why derivatives were differences along some recording.
    pub fn differences(&self) -> Option<&str> {
        self.trust.iter().find_map(|t| if let Trust::Fails(why) = t { Some(why.as_str()) } else { None })
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
        self.cases.iter().any(|c| !c.states.is_empty())
    }

    /// Simulated values along one recording, one column a signal.
    ///
    /// # Errors
    /// When the run does not reach the end.
    pub fn simulate(&self, case: usize, z: &[f64], wanted: &[VarId]) -> Result<Vec<Vec<f64>>, Broken> {
        let case = &self.cases[case];
        let values = if self.parameters > 0 { &z[..self.parameters] } else { self.fixed.as_slice() };
        let parameters = self.problem.parameters(values);
        if case.states.is_empty() {
            return self.runner.run(&case.track, &parameters, None, wanted);
        }
        let mut state = self.runner.start(&case.track, &parameters)?;
        for (free, z) in case.states.iter().zip(&z[case.places.clone()]) {
            state.values[free.variable.index()] += free.size * z;
        }
        self.runner.run(&case.track, &parameters, Some(&state), wanted)
    }

    /// Errors of one recording over the deviations, in the order of its rows.
    fn errors(&self, case: usize, z: &[f64]) -> Result<Vec<f64>, Broken> {
        let simulated = self.simulate(case, z, &self.wanted)?;
        let mut out = Vec::new();
        for (k, (simulated, measured)) in simulated.iter().zip(&self.cases[case].measured).enumerate() {
            let known = simulated.iter().zip(measured).filter(|(_, m)| !m.is_nan());
            out.extend(known.map(|(s, m)| (s - m) / self.weights.sigma[k]));
        }
        if out.iter().all(|v| v.is_finite()) {
            Ok(out)
        } else {
            Err(Broken { time: f64::NAN, message: "a value is not finite".into() })
        }
    }

    /// The unknowns that move a recording.
    fn moves(&self, case: usize) -> impl Iterator<Item = usize> {
        (0..self.parameters).chain(self.cases[case].places.clone())
    }
}

impl LeastSquares for OutputError<'_> {
    fn residual(&mut self, z: &[f64]) -> Option<DVector<f64>> {
        let this = &*self;
        let found: Vec<Result<Vec<f64>, Broken>> =
            (0..this.cases.len()).into_par_iter().map(|c| this.errors(c, z)).collect();
        let mut all = Vec::new();
        for errors in found {
            match errors {
                Ok(errors) => all.extend(errors),
                Err(broken) => {
                    self.broken = Some(broken);
                    return None;
                }
            }
        }
        if self.parameters > 0 {
            all.extend(self.problem.priors(&z[..self.parameters]));
        }
        all.extend(&z[self.parameters..]);
        Some(DVector::from_vec(all))
    }

    fn jacobian(&mut self, z: &[f64], residual: &DVector<f64>) -> Option<DMatrix<f64>> {
        let mut jacobian = DMatrix::zeros(residual.len(), z.len());
        let by_equations = self.by_equations(z);
        let this = &*self;
        let left = (0..this.cases.len()).filter(|&c| by_equations[c].is_none());
        let jobs: Vec<(usize, usize)> = left.flat_map(|c| this.moves(c).map(move |j| (c, j))).collect();
        let columns: Vec<Option<Vec<f64>>> = jobs.par_iter().map(|&(c, j)| this.difference(c, j, z)).collect();
        let mut fill = |c: usize, j: usize, column: Vec<f64>| {
            let rows = jacobian.view_mut((this.first_row(c), j), (column.len(), 1));
            rows.into_iter().zip(column).for_each(|(entry, value)| *entry = value);
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
        let states = z.len() - self.parameters;
        for k in 0..states {
            jacobian[(residual.len() - states + k, self.parameters + k)] = 1.0;
        }
        Some(jacobian)
    }
}

impl OutputError<'_> {
    /// The signals along the first recording with the errors of `residual`.
    pub fn courses(&self, recordings: &[Recording], residual: &[f64]) -> Vec<Course> {
        let one = |s: &Series| {
            let signal = &self.problem.bound.signals[s.signal];
            let measured = &recordings[0].signals[s.signal];
            let known = || recordings[0].times.iter().zip(measured).filter(|(_, m)| !m.is_nan());
            let sigma = self.weights.sigma[s.signal];
            Course {
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
                if this.trust[c] == Trust::Unknown {
                    this.agrees(c, z, &columns).map(|()| columns)
                } else {
                    Ok(columns)
                }
            })
            .collect();
        let judged = found.into_iter().zip(&mut self.trust).map(|(result, trust)| match result {
            Ok(columns) => {
                *trust = Trust::Holds;
                Some(columns)
            }
            Err(why) => {
                *trust = Trust::Fails(why);
                None
            }
        });
        judged.collect()
    }

    /// Derivatives of the weighed errors of a recording, carried along by its run.
    fn exactly(&self, case: usize, z: &[f64]) -> Result<Vec<Vec<f64>>, String> {
        if let Trust::Fails(why) = &self.trust[case] {
            return Err(why.clone());
        }
        let exact = self.exact.as_ref().filter(|_| self.parameters > 0).ok_or("they were not asked for")?;
        let of = &self.cases[case];
        let (free, states) = (&self.problem.free, &of.states);
        let z = (&z[..self.parameters], &z[of.places.clone()]);
        let columns = exact.columns(&of.track, free, states, z, &self.wanted, self.runner.tolerance)?;
        let weighed = |signals: Vec<Vec<f64>>| {
            let mut out = Vec::new();
            for (k, (column, measured)) in signals.iter().zip(&of.measured).enumerate() {
                let known = column.iter().zip(measured).filter(|(_, m)| !m.is_nan());
                out.extend(known.map(|(s, _)| s / self.weights.sigma[k]));
            }
            out
        };
        let columns: Vec<Vec<f64>> = columns.into_iter().map(weighed).collect();
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
        let at = |step: f64| {
            let mut moved = z.to_vec();
            self.moves(case).zip(&share).for_each(|(j, s)| moved[j] += step * s);
            self.errors(case, &moved).map_err(|_| "a run with moved parameters failed".to_owned())
        };
        let (up, down) = (at(CHECK)?, at(-CHECK)?);
        let pairs = (0..up.len()).map(|i| {
            let sum: f64 = columns.iter().zip(&share).map(|(c, s)| s * c[i]).sum();
            ((up[i] - down[i]) / (2.0 * CHECK), sum)
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
    fn difference(&self, case: usize, j: usize, z: &[f64]) -> Option<Vec<f64>> {
        let at = |step: f64| {
            let mut moved = z.to_vec();
            moved[j] += step;
            self.errors(case, &moved).ok()
        };
        let over = |a: Vec<f64>, b: Vec<f64>, h: f64| a.iter().zip(b).map(|(a, b)| (a - b) / h).collect();
        match (at(STEP), at(-STEP)) {
            (Some(up), Some(down)) => Some(over(up, down, 2.0 * STEP)),
            (Some(up), None) => Some(over(up, at(0.0)?, STEP)),
            (None, Some(down)) => Some(over(at(0.0)?, down, STEP)),
            (None, None) => None,
        }
    }
}

impl Residuals for OutputError<'_> {
    fn weights(&mut self) -> &mut Weights {
        &mut self.weights
    }

    fn unknowns(&self) -> usize {
        self.parameters + self.cases.iter().map(|c| c.states.len()).sum::<usize>()
    }
}

fn series(cases: &[Case]) -> Vec<Series> {
    let mut series = Vec::new();
    let mut row = 0;
    for (recording, case) in cases.iter().enumerate() {
        for (signal, measured) in case.measured.iter().enumerate() {
            let known = measured.iter().filter(|m| !m.is_nan()).count();
            series.push(Series { recording, signal, rows: row..row + known });
            row += known;
        }
    }
    series
}

/// The states whose start the model leaves to chance: those that no parameter of the study moves.
fn free_states(problem: &Problem<'_>, runner: &Runner<'_>, track: &Track, z: &[f64]) -> Result<Vec<FreeState>, Broken> {
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
            free.push(FreeState { variable: v, size });
        }
    }
    Ok(free)
}
