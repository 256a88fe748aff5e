//! The initial state of a recording, estimated from its first samples.
//!
//! A recording rarely begins in the state in which the model starts, and no study says where. The state is a
//! regularised least squares estimate between what the first samples show and the model's own start, by Gauss-Newton
//! steps. Enters: a model with values, a recording. Leaves: the state at the last sample of the beginning, with
//! sensitivities. Called by `candidate` at the beginning of every run. Method: `docs/gap_method.md`, "Simulation".

use super::super::data::{InputSegment, RecordingData};
use super::candidate::RecordingResiduals;
use super::exponential;
use super::simulation::{RecordingRun, TrajectorySensitivities};
use crate::policy::SURE;
use bramah_analysis::estimate::correlation;
use bramah_analysis::local::{EvaluationPlan, LocalEvaluator};
use nalgebra::{Cholesky, DMatrix, DVector};
use std::ops::ControlFlow;
use std::sync::Arc;

/// Standard deviation of the initial value of a state that nothing measures, as part of its value or its size,
/// whichever is less. One step moves it by no more.
pub const UNMEASURED: f64 = 0.2;
/// The same for a measured state, in sizes. Some signal would surely change if it were wrong, so the data hold its
/// steps.
const MEASURED: f64 = 1.0;
/// Or as part of how far the state moves in the nominal model.
pub const TRAVEL: f64 = 0.5;
/// The same for absolute temperatures, K.
pub const KELVIN: f64 = 10.0;
/// The same for states that begin where the model says, in sizes.
const HELD: f64 = 1e-6;
/// Most Gauss-Newton steps.
const ROUNDS: usize = 12;
/// Most halvings of a step that leads nowhere.
const HALVINGS: usize = 6;
/// Step in sizes that is applied by the linear model alone, without another run. Its error grows with the square.
const SMALL: f64 = 1e-2;

/// A model with values of its parameters, and what is known of its states.
#[derive(Clone, Copy)]
pub struct ParameterisedModel<'a> {
    /// The compiled model with derivatives.
    pub plan: &'a Arc<EvaluationPlan>,
    /// Values of its parameters, SI.
    pub theta: &'a [f64],
    /// Usual size of each state, SI.
    pub sizes: &'a [f64],
    /// Accepted correction of a step, in parts of these sizes.
    pub correction: f64,
    /// How far each state moves in the nominal model, SI; 0 where unknown.
    pub travel: &'a [f64],
    /// Unit of each signal as written.
    pub units: &'a [String],
    /// Per signal the error that counts as one standard deviation, SI.
    pub deviations: &'a [f64],
}

/// A model at the last sample of a recording's beginning.
pub struct InitialFit {
    /// The evaluator of the model.
    pub local: LocalEvaluator,
    /// Distance of the initial state from the model's own start, in sizes.
    pub off: Vec<f64>,
    /// State at the last sample of the beginning, SI.
    pub state: Vec<f64>,
    /// Sensitivities of that state to the parameters asked for.
    pub slopes: Option<TrajectorySensitivities>,
}

impl ParameterisedModel<'_> {
    /// Estimates the initial state and runs through the beginning of a recording.
    ///
    /// `guess`: `off` of a similar model, in sizes. `moves`: parameters whose sensitivities are wanted, and how far one
    /// unit moves each. `None` if the model cannot be evaluated there.
    pub fn begin(
        &self,
        recording: &RecordingData,
        guess: Option<&[f64]>,
        moves: Option<&[(usize, f64)]>,
    ) -> Option<InitialFit> {
        let u = InputSegment::new(recording).from;
        let mut local = LocalEvaluator::start(self.plan.clone(), recording.times[0], self.theta, &u).ok()?;
        let own = local.state();
        local.linearize(recording.times[0], &own, self.theta, &u).ok()?;
        let shown: Vec<Option<usize>> = (0..own.len()).map(|i| self.shows(&local, i)).collect();
        // states that the model fixes are only free in a recording that begins elsewhere than the model
        let elsewhere = self.begins_elsewhere(&local, recording, &shown);
        let shown_start = self.shown_start(&local, recording, &shown);
        // Linearised where the recording begins: at the model's start a machine may be at rest, where a flow depends on
        // every pressure.
        let there: Vec<f64> = (0..own.len()).map(|i| own[i] + shown_start[i] * self.sizes[i]).collect();
        if local.linearize(recording.times[0], &there, self.theta, &u).is_err() {
            local.linearize(recording.times[0], &own, self.theta, &u).ok()?;
        }
        let mut loose = self.looseness(&local, &own, &shown, elsewhere);
        // a state that a signal shows may be as far off as that signal says
        loose.iter_mut().zip(shown_start.iter()).for_each(|(loose, off)| *loose = loose.max(off.abs()));
        let moved = moves.unwrap_or(&[]);
        // with a guess the first run already has all sensitivities
        let mut first = guess.filter(|g| g.len() == own.len()).and_then(|g| {
            let x = DVector::from_column_slice(g);
            Some(InitialStateTrial {
                beginning: self.through(recording, &mut local, &own, &x, moved)?,
                x,
                slopes: true,
            })
        });
        let setting = InitialStateProblem { recording, own: &own, loose: &loose };
        if first.is_none() {
            // a first sample may be wrong, so the model's own start is tried too
            let begin = |x: DVector<f64>| {
                let beginning = self.through(recording, &mut local, &own, &x, &[])?;
                Some(InitialStateTrial { beginning, x, slopes: false })
            };
            let both = [shown_start, DVector::zeros(own.len())].map(begin);
            let nearer = |a: InitialStateTrial, b: InitialStateTrial| {
                if b.beginning.data() < a.beginning.data() { b } else { a }
            };
            first = both.into_iter().flatten().reduce(nearer);
            // first with unit weight, as near to the data as the model gets; then with the errors that this leaves
            first = first.map(|tried| self.descended(&setting, &mut local, tried, 1.0));
        }
        // from here on squared errors count by how large and correlated they are, up to a power of two
        let scale = first.as_ref()?.beginning.scale();
        let InitialStateTrial { beginning: mut best, x, slopes } = self.descended(&setting, &mut local, first?, scale);
        let off = x.as_slice().to_vec();
        let Some(moves) = moves else { return Some(InitialFit { local, off, state: best.state, slopes: None }) };
        // the last run was without sensitivities to parameters
        if !slopes {
            best = self.through(recording, &mut local, &own, &x, moves)?;
        }
        Some(InitialFit {
            local,
            off,
            slopes: Some(best.slopes_of_choices(&loose, scale, moves, self.units.len())),
            state: best.state,
        })
    }

    /// Gauss-Newton steps of the initial state, with squared deviations divided by `scale`.
    fn descended(
        &self,
        setting: &InitialStateProblem<'_>,
        local: &mut LocalEvaluator,
        mut best: InitialStateTrial,
        scale: f64,
    ) -> InitialStateTrial {
        let InitialStateProblem { recording, own, loose } = *setting;
        for _ in 0..ROUNDS {
            let Some(mut step) = best.beginning.step(&best.x, loose, scale) else { break };
            // no further run: the linear model is exact enough for a step this small
            if step.amax() < SMALL {
                best.beginning.take_along(&step, self.sizes);
                best.x += &step;
                break;
            }
            let costs = best.beginning.cost(&best.x, loose, scale);
            let mut found = None;
            for _ in 0..HALVINGS {
                let to = &best.x + &step;
                let tried = self.through(recording, local, own, &to, &[]);
                // a step counts only if the cost does not grow
                found = tried.filter(|t| t.cost(&to, loose, scale) <= costs);
                if found.is_some() {
                    break;
                }
                step *= 0.5;
            }
            let Some(beginning) = found else { break };
            best = InitialStateTrial { beginning, x: best.x + step, slopes: false };
        }
        best
    }

    /// Whether a signal that shows a state begins more than [`SURE`] deviations from the model's own start.
    fn begins_elsewhere(&self, local: &LocalEvaluator, recording: &RecordingData, shown: &[Option<usize>]) -> bool {
        let off = |y: usize, first: f64| (first - local.outputs[y]).abs() > SURE * self.deviations[y];
        shown.iter().flatten().any(|&y| recording.first_value(y).is_some_and(|first| off(y, first)))
    }

    /// Standard deviations of the initial states from the model's own start, in sizes.
    /// A state that the model fixes and no sensor shows begins where the model says: a wrong law would otherwise find
    /// another start for it. The exception is a recording that begins elsewhere.
    fn looseness(&self, local: &LocalEvaluator, own: &[f64], shown: &[Option<usize>], elsewhere: bool) -> DVector<f64> {
        let c = &local.linear.c;
        let unmeasured = |i: usize| match own[i].abs() / self.sizes[i] {
            value if value > 0.0 => UNMEASURED * value.min(1.0),
            _ => UNMEASURED,
        };
        DVector::from_fn(self.sizes.len(), |i, _| {
            let loose = unmeasured(i).max(TRAVEL * self.travel[i] / self.sizes[i]);
            // a state counts as measured if its own deviation would surely change some signal
            let moves = |(c, deviation): (&f64, &f64)| (c * loose * self.sizes[i]).abs() > SURE * deviation;
            let measured = shown[i].is_some() || c.column(i).iter().zip(self.deviations).any(moves);
            match self.plan.state_unit(i) {
                _ if self.plan.state_is_fixed(i) && !elsewhere && shown[i].is_none() => HELD,
                Some("K") => KELVIN / self.sizes[i],
                _ if measured => MEASURED,
                _ => loose,
            }
        })
    }

    /// The signal that depends on this state alone; `None` if there is none.
    /// A signal that also depends on inputs or other states is a balance whose other terms may be wrong.
    fn shows(&self, local: &LocalEvaluator, state: usize) -> Option<usize> {
        let (c, d) = (&local.linear.c, &local.linear.d);
        let alone = |y: usize| (0..c.ncols()).all(|j| (c[(y, j)] != 0.0) == (j == state));
        let no_input = |y: usize| (self.plan.parameters()..d.ncols()).all(|j| d[(y, j)] == 0.0);
        (0..c.nrows()).find(|&y| alone(y) && no_input(y))
    }

    /// Distances of the states from the model's own start according to the first samples that show them, in sizes; 0
    /// for others. Far from what is shown, a step of the whole initial state leads nowhere.
    fn shown_start(&self, local: &LocalEvaluator, recording: &RecordingData, shown: &[Option<usize>]) -> DVector<f64> {
        let off = |i: usize| {
            let y = shown[i]?;
            Some((recording.first_value(y)? - local.outputs[y]) / (local.linear.c[(y, i)] * self.sizes[i]))
                .filter(|x| x.is_finite())
        };
        DVector::from_fn(self.sizes.len(), |i, _| off(i).unwrap_or(0.0))
    }

    /// Runs through the beginning from `x` sizes off the model's own start.
    /// `None` if the model cannot be evaluated or the errors are not finite.
    fn through(
        &self,
        recording: &RecordingData,
        local: &mut LocalEvaluator,
        own: &[f64],
        x: &DVector<f64>,
        moves: &[(usize, f64)],
    ) -> Option<InitialPassage> {
        let n = own.len();
        let state: Vec<f64> = (0..n).map(|i| own[i] + x[i] * self.sizes[i]).collect();
        // choices are the initial states, then the parameters
        let width = n + moves.len();
        let mut slopes = DMatrix::zeros(n, width);
        slopes.view_mut((0, 0), (n, n)).fill_with_identity();
        let choices = (0..n).map(|_| None).chain(moves.iter().map(|m| Some(*m))).collect();
        let slopes = Some(TrajectorySensitivities::new(slopes, choices, self.deviations.len()));
        let mut gram = DMatrix::zeros(n, width + 1);
        let mut row = vec![0.0; width + 1];
        let mut errors: RecordingResiduals = vec![Vec::with_capacity(recording.settled() + 1); self.deviations.len()];
        let (theta, sizes, correction) = (self.theta, self.sizes, self.correction);
        let mut run = RecordingRun { local, theta, sizes, correction, state, slopes, left: usize::MAX };
        run.along(recording, 0..recording.settled() + 1, |k, local, slopes| {
            let Some(slopes) = slopes else { return ControlFlow::Continue(()) };
            for (i, deviation) in self.deviations.iter().enumerate() {
                let error = (recording.signals[i][k] - local.outputs[i]) / deviation;
                if !error.is_finite() {
                    continue;
                }
                errors[i].push(error);
                row.iter_mut().zip(slopes.column(i).iter()).for_each(|(to, s)| *to = s / deviation);
                // the last column collects the products with the errors
                row[width] = error;
                exponential::add_outer(&mut gram, 1.0, &row[..n], &row);
            }
            ControlFlow::Continue(())
        })?;
        let (state, slopes) = (run.state, run.slopes?.states);
        let beginning = InitialPassage { state, slopes, gram, errors };
        beginning.data().is_finite().then_some(beginning)
    }
}

/// The recording, the model's own start (SI) and the standard deviations of the initial states in sizes.
#[derive(Clone, Copy)]
struct InitialStateProblem<'a> {
    /// The recording.
    recording: &'a RecordingData,
    /// The model's own start, SI.
    own: &'a [f64],
    /// Standard deviation of each initial state from that start, in sizes.
    loose: &'a DVector<f64>,
}

/// A start that was tried.
struct InitialStateTrial {
    /// What the run from it gave.
    beginning: InitialPassage,
    /// Its distance from the model's own start, in sizes.
    x: DVector<f64>,
    /// The run had the sensitivities to the parameters.
    slopes: bool,
}

/// Result of one run through the beginning.
struct InitialPassage {
    /// State at its last sample, SI.
    state: Vec<f64>,
    /// Sensitivities of that state: states by (initial states, parameters), in sizes.
    slopes: DMatrix<f64>,
    /// Products of the initial states' columns with all columns and with the errors (last column).
    gram: DMatrix<f64>,
    /// Errors by signal, in deviations.
    errors: RecordingResiduals,
}

impl InitialPassage {
    /// Sum of squared errors.
    fn data(&self) -> f64 {
        self.errors.iter().flatten().map(|e| e * e).sum()
    }

    /// Divisor of squared deviations: mean square of the errors times their correlation time, at least 1.
    /// A model that is wrong then does not move states that nothing measures. It is rounded to a power of two, so that
    /// it does not change with the parameters.
    fn scale(&self) -> f64 {
        let count = self.errors.iter().map(Vec::len).sum::<usize>() as f64;
        let correlated = |e: &Vec<f64>| correlation::time(e) * e.iter().map(|e| e * e).sum::<f64>();
        (self.errors.iter().map(correlated).sum::<f64>() / count).max(1.0).log2().round().exp2()
    }

    /// Cost of a start `x` sizes off the model's own one.
    fn cost(&self, x: &DVector<f64>, loose: &DVector<f64>, scale: f64) -> f64 {
        self.data() / scale + x.component_div(loose).norm_squared()
    }

    /// Cholesky factor of the information matrix of the initial state; `None` if it is not positive definite.
    fn information(&self, loose: &DVector<f64>, scale: f64) -> Option<Cholesky<f64, nalgebra::Dyn>> {
        let n = loose.len();
        let mut information = self.gram.view((0, 0), (n, n)) / scale;
        (0..n).for_each(|i| information[(i, i)] += loose[i].powi(-2));
        information.cholesky()
    }

    /// Moves the last state as `step` of the initial state moves it in the linear model.
    fn take_along(&mut self, step: &DVector<f64>, sizes: &[f64]) {
        let moved = self.slopes.columns(0, step.len()) * step;
        self.state.iter_mut().zip(moved.iter().zip(sizes)).for_each(|(s, (m, size))| *s += m * size);
    }

    /// Gauss-Newton step of the initial state in sizes; `None` without an information matrix.
    fn step(&self, x: &DVector<f64>, loose: &DVector<f64>, scale: f64) -> Option<DVector<f64>> {
        let pull = DVector::from_fn(x.len(), |i, _| x[i] * loose[i].powi(-2));
        let last = self.gram.ncols() - 1;
        let step = self.information(loose, scale)?.solve(&(self.gram.column(last) / scale - pull));
        // Unmeasured states follow the linear model alone, which may lead where the model cannot be evaluated: the step
        // is limited.
        let far =
            |(step, loose): (&f64, &f64)| if *loose < MEASURED { step.abs() / loose.max(UNMEASURED) } else { 0.0 };
        let farthest = step.iter().zip(loose.iter()).map(far).fold(1.0, f64::max);
        Some(step / farthest)
    }

    /// Sensitivities of the last state to the parameters, with the initial state estimated anew for each change of
    /// them. They follow from the implicit function theorem.
    fn slopes_of_choices(
        &self,
        loose: &DVector<f64>,
        scale: f64,
        moves: &[(usize, f64)],
        signals: usize,
    ) -> TrajectorySensitivities {
        let (n, m) = (loose.len(), moves.len());
        let direct = self.slopes.columns(n, m);
        let states = match self.information(loose, scale) {
            Some(information) => {
                let first = information.solve(&(self.gram.view((0, n), (n, m)) / scale));
                direct - self.slopes.columns(0, n) * first
            }
            None => direct.into_owned(),
        };
        TrajectorySensitivities::new(states, moves.iter().map(|m| Some(*m)).collect(), signals)
    }
}
