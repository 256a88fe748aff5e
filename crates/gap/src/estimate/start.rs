//! Where a recording begins: the state that its first samples lead to, by least squares between what they show and the
//! model's own start. A recording rarely begins where the model does, and no study says where.

use super::super::data::{InputSegment, RecordingData};
use super::super::policy::SURE;
use super::candidate::RecordingResiduals;
use super::exponential;
use super::simulation::{RecordingRun, TrajectorySensitivities};
use bramah_analysis::estimate::correlation;
use bramah_analysis::local::{EvaluationPlan, LocalEvaluator};
use nalgebra::{Cholesky, DMatrix, DVector};
use std::ops::ControlFlow;
use std::sync::Arc;

/// How far states that nothing measures may be from the model's start when a recording begins, as part of their value there or
/// of their size, whichever is less, and how far one step may lead them.
pub const UNMEASURED: f64 = 0.2;
/// The same for measured ones, whose steps the data hold: by what the others may be off, some signal changes surely.
const MEASURED: f64 = 1.0;
/// Or as part of how far they usually move.
pub const TRAVEL: f64 = 0.5;
/// Absolute temperatures, K.
pub const KELVIN: f64 = 10.0;
/// And those that begin where the model says.
const HELD: f64 = 1e-6;
/// Gauss-Newton steps at most, and halvings of one that leads nowhere.
const ROUNDS: usize = 12;
const HALVINGS: usize = 6;
/// A step of the first state, in its sizes, that the linear model takes along: what it leaves out grows with the square.
const SMALL: f64 = 1e-2;

/// A model with values, and what is known of its states.
#[derive(Clone, Copy)]
pub struct ParameterisedModel<'a> {
    /// The model.
    pub plan: &'a Arc<EvaluationPlan>,
    /// Values of its parameters.
    pub theta: &'a [f64],
    /// Usual size of each state, SI.
    pub sizes: &'a [f64],
    /// What a step may be corrected by, in parts of these sizes.
    pub correction: f64,
    /// How far each moves in the nominal model, SI; 0 where that is not known.
    pub travel: &'a [f64],
    /// Per signal its unit, as written.
    pub units: &'a [String],
    /// Per signal the deviation that counts as one.
    pub deviations: &'a [f64],
}

/// A model at the last sample of a recording's beginning.
pub struct InitialFit {
    /// The model there.
    pub local: LocalEvaluator,
    /// How far its first state was from the model's own start, in sizes.
    pub off: Vec<f64>,
    /// Its state, SI.
    pub state: Vec<f64>,
    /// How the state depends on what was asked for.
    pub slopes: Option<TrajectorySensitivities>,
}

impl ParameterisedModel<'_> {
    /// Goes through the beginning of a recording. `guess`: how far a model much like it began from its own start. `moves`: the
    /// parameters whose slopes are wanted, and by how much one unit of each moves them. `None` where the model has no value
    /// there.
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
        let elsewhere = self.begins_elsewhere(&local, recording, &shown);
        let shown_start = self.shown_start(&local, recording, &shown);
        // what measures a state is seen where the recording begins: at rest a flow depends on every pressure
        let there: Vec<f64> = (0..own.len()).map(|i| own[i] + shown_start[i] * self.sizes[i]).collect();
        if local.linearize(recording.times[0], &there, self.theta, &u).is_err() {
            local.linearize(recording.times[0], &own, self.theta, &u).ok()?;
        }
        let mut loose = self.looseness(&local, &own, &shown, elsewhere);
        // what is shown may be as far from the model's start as it is shown
        loose.iter_mut().zip(shown_start.iter()).for_each(|(loose, off)| *loose = loose.max(off.abs()));
        let moved = moves.unwrap_or(&[]);
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
            // a first reading may be false: the model's own start may be nearer
            let begin = |x: DVector<f64>| {
                let beginning = self.through(recording, &mut local, &own, &x, &[])?;
                Some(InitialStateTrial { beginning, x, slopes: false })
            };
            let both = [shown_start, DVector::zeros(own.len())].map(begin);
            let nearer = |a: InitialStateTrial, b: InitialStateTrial| {
                if b.beginning.data() < a.beginning.data() { b } else { a }
            };
            first = both.into_iter().flatten().reduce(nearer);
            // first as near to the data as the model gets, from there with errors as they are left
            first = first.map(|tried| self.descended(&setting, &mut local, tried, 1.0));
        }
        let scale = first.as_ref()?.beginning.scale();
        let InitialStateTrial { beginning: mut best, x, slopes } = self.descended(&setting, &mut local, first?, scale);
        let off = x.as_slice().to_vec();
        let Some(moves) = moves else { return Some(InitialFit { local, off, state: best.state, slopes: None }) };
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

    /// Gauss-Newton steps of the first state, where squared deviations count by `scale`.
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

    /// Whether what is shown begins elsewhere than the model does.
    fn begins_elsewhere(&self, local: &LocalEvaluator, recording: &RecordingData, shown: &[Option<usize>]) -> bool {
        let off = |y: usize, first: f64| (first - local.outputs[y]).abs() > SURE * self.deviations[y];
        shown.iter().flatten().any(|&y| recording.first_value(y).is_some_and(|first| off(y, first)))
    }

    /// Deviations of the states from the model's own start, in their sizes. What the model fixes and no sensor shows by
    /// itself begins where the model says, for a wrong law would find any other start for it; but not in a recording that
    /// begins elsewhere with what is shown.
    fn looseness(&self, local: &LocalEvaluator, own: &[f64], shown: &[Option<usize>], elsewhere: bool) -> DVector<f64> {
        let c = &local.linear.c;
        let unmeasured = |i: usize| match own[i].abs() / self.sizes[i] {
            value if value > 0.0 => UNMEASURED * value.min(1.0),
            _ => UNMEASURED,
        };
        DVector::from_fn(self.sizes.len(), |i, _| {
            let loose = unmeasured(i).max(TRAVEL * self.travel[i] / self.sizes[i]);
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

    /// The signal that follows a state alone: nothing else, and no input, for that would be a balance of which the state is
    /// a part that may be wrong.
    fn shows(&self, local: &LocalEvaluator, state: usize) -> Option<usize> {
        let (c, d) = (&local.linear.c, &local.linear.d);
        let alone = |y: usize| (0..c.ncols()).all(|j| (c[(y, j)] != 0.0) == (j == state));
        let no_input = |y: usize| (self.plan.parameters()..d.ncols()).all(|j| d[(y, j)] == 0.0);
        (0..c.nrows()).find(|&y| alone(y) && no_input(y))
    }

    /// How far states are from the model's own start by the first sample that shows them, in their sizes: far from what is
    /// shown, a step of the whole start leads nowhere.
    fn shown_start(&self, local: &LocalEvaluator, recording: &RecordingData, shown: &[Option<usize>]) -> DVector<f64> {
        let off = |i: usize| {
            let y = shown[i]?;
            Some((recording.first_value(y)? - local.outputs[y]) / (local.linear.c[(y, i)] * self.sizes[i]))
                .filter(|x| x.is_finite())
        };
        DVector::from_fn(self.sizes.len(), |i, _| off(i).unwrap_or(0.0))
    }

    /// The beginning from `x` sizes off the model's own start.
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

/// A recording, the model's own start, and how far states may be from it, in their sizes.
#[derive(Clone, Copy)]
struct InitialStateProblem<'a> {
    recording: &'a RecordingData,
    own: &'a [f64],
    loose: &'a DVector<f64>,
}

/// A start that was tried, so many sizes off the model's own one; with the slopes that are wanted or without.
struct InitialStateTrial {
    beginning: InitialPassage,
    x: DVector<f64>,
    slopes: bool,
}

/// What one passage through the beginning gave.
struct InitialPassage {
    /// State at its last sample.
    state: Vec<f64>,
    /// How that depends on the first state and on the parameters.
    slopes: DMatrix<f64>,
    /// Products of the first state's columns with all columns and with the errors.
    gram: DMatrix<f64>,
    /// Errors by signal, in deviations.
    errors: RecordingResiduals,
}

impl InitialPassage {
    /// Squared errors.
    fn data(&self) -> f64 {
        self.errors.iter().flatten().map(|e| e * e).sum()
    }

    /// What a squared deviation counts: errors are as large and as correlated as they are, where that is more than noise. What
    /// nothing measures does not make up for a model that is wrong. To a power of two: it does not go along with parameters.
    fn scale(&self) -> f64 {
        let count = self.errors.iter().map(Vec::len).sum::<usize>() as f64;
        let correlated = |e: &Vec<f64>| correlation::time(e) * e.iter().map(|e| e * e).sum::<f64>();
        (self.errors.iter().map(correlated).sum::<f64>() / count).max(1.0).log2().round().exp2()
    }

    /// What it costs to begin so many sizes off the model's own start, where squared deviations count by `scale`.
    fn cost(&self, x: &DVector<f64>, loose: &DVector<f64>, scale: f64) -> f64 {
        self.data() / scale + x.component_div(loose).norm_squared()
    }

    /// Products of the first state's columns and the pull to the model's own start.
    fn information(&self, loose: &DVector<f64>, scale: f64) -> Option<Cholesky<f64, nalgebra::Dyn>> {
        let n = loose.len();
        let mut information = self.gram.view((0, 0), (n, n)) / scale;
        (0..n).for_each(|i| information[(i, i)] += loose[i].powi(-2));
        information.cholesky()
    }

    /// Moves the last state as a step of the first one does.
    fn take_along(&mut self, step: &DVector<f64>, sizes: &[f64]) {
        let moved = self.slopes.columns(0, step.len()) * step;
        self.state.iter_mut().zip(moved.iter().zip(sizes)).for_each(|(s, (m, size))| *s += m * size);
    }

    fn step(&self, x: &DVector<f64>, loose: &DVector<f64>, scale: f64) -> Option<DVector<f64>> {
        let pull = DVector::from_fn(x.len(), |i, _| x[i] * loose[i].powi(-2));
        let last = self.gram.ncols() - 1;
        let step = self.information(loose, scale)?.solve(&(self.gram.column(last) / scale - pull));
        // what nothing measures is led there by the linear model alone, which may end where the model has no sense
        let far =
            |(step, loose): (&f64, &f64)| if *loose < MEASURED { step.abs() / loose.max(UNMEASURED) } else { 0.0 };
        let farthest = step.iter().zip(loose.iter()).map(far).fold(1.0, f64::max);
        Some(step / farthest)
    }

    /// How the state depends on the parameters, the first state found anew for each: by the implicit function theorem.
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
