//! Simulation of a model along a recording, from its inputs alone and from a given state.
//!
//! The steps are exponential Rosenbrock steps of third order (Hochbruck, Ostermann, Acta Numerica 2010, 2.4), halved
//! until the correction of the linear step is small. A linearisation is reused as long as the correction stays small.
//! Sensitivities follow the variational equation S' = A S + B of each linearised step, which has the same exponential.
//! Called by `candidate` (residuals) and `start` (initial state). Method: `docs/gap_method.md`, "Simulation".

use super::super::data::{InputSegment, RecordingData};
use super::exponential::{self, MatrixExponential};
use bramah_analysis::local::{EvaluationPlan, LocalEvaluator};
use nalgebra::{DMatrix, DVector};
use std::ops::{ControlFlow, Range};
use std::sync::Arc;

/// Halvings of the distance between two samples that are always allowed.
/// A recording may take as many steps as with this depth everywhere, or [`MANY`] steps if that is more, before depths
/// beyond it are refused. A model that chatters would otherwise take a million steps between two samples.
const DEEP: u32 = 6;
/// Step that must be reachable whatever the sampling, s: valves and friction change within it. A coarsely sampled
/// recording is then simulated like a finely sampled one.
const SHORTEST: f64 = 1e-4;
/// Most halvings of the distance between two samples.
const DEEPEST: u32 = 24;
/// Least number of steps of a recording before depths beyond [`DEEP`] are refused.
const MANY: usize = 20_000;
/// Least and greatest correction of a linear step that is accepted, in parts of the states' sizes.
const CORRECTION: (f64, f64) = (5e-6, 1e-4);
/// Accepted correction in parts of the noise of the best sensor (in parts of its full scale).
/// Costs are compared to half a squared deviation, and 5000 samples that are each a hundredth of the noise off add up
/// to that. Where the model is smooth, a corrected step is ten times more exact; at a corner, as of dry friction, it is
/// not.
const CORRECTED: f64 = 0.01;
/// Correction in parts of the states' sizes beyond which not even a shortest step is accepted. At a snap within
/// microseconds the states would be thrown anywhere.
const WILD: f64 = 1e-2;
/// Steps of a recording that may be shorter than the shortest for this reason. A snap takes some tens of them.
const SHORTER: usize = 1000;
/// Part of the accepted correction below which the next step is doubled. The correction grows with the cube of the
/// step.
const LENGTHENED: f64 = 0.1;
/// Largest change of the linear model over a step, as part of the states, that is added to sensitivities to second
/// order; its cube is neglected. Beyond, the step has the exponential of the mean of both ends.
const MISSED: f64 = 0.1;
/// Factor by which that mean may exceed the transition of the step itself.
/// A larger one means that the step ends within a snap of microseconds, as when a store runs empty. Stretched over the
/// step, what grows for a moment would grow for all of it. Behind a snap the states follow others and forget their
/// past.
const SNAP: f64 = 1e3;

/// Accepted correction of a step in parts of the states' sizes, for sensors with this noise and full scale.
pub fn correction(noise: &[f64], full_scale: &[f64]) -> f64 {
    let finest = noise.iter().zip(full_scale).map(|(n, f)| n / f).filter(|part| part.is_finite());
    let (least, most) = CORRECTION;
    (CORRECTED * finest.fold(f64::INFINITY, f64::min)).clamp(least, most)
}

/// How the remainder (what the linearisation leaves out) grows over a step. It sets the weight of the correction beside
/// phi_2.
#[derive(Clone, Copy)]
enum RemainderGrowth {
    /// With the square of time: the linearisation is that of the step's beginning. The weight is 2 phi_3, approximated
    /// by 2/3 phi_2, which is exact for slow states.
    Square,
    /// In proportion to time: the linearisation is older.
    Proportional,
}

impl RemainderGrowth {
    /// Weight of the correction, beside phi_2 of the step.
    fn weight(self) -> f64 {
        match self {
            RemainderGrowth::Square => 2.0 / 3.0,
            RemainderGrowth::Proportional => 1.0,
        }
    }
}

/// Sensitivities of states and outputs to choices: parameters and the initial state.
#[derive(Clone, Debug)]
pub struct TrajectorySensitivities {
    /// States by choices, in the states' sizes.
    pub states: DMatrix<f64>,
    /// Choices by signals: derivatives of the signals at the last linearisation, SI.
    pub outputs: DMatrix<f64>,
    /// Per choice the parameter that it moves, and how far one unit moves it; `None` for a choice of the initial state.
    moves: Vec<Option<(usize, f64)>>,
    /// The term B of the variational equation at the last linearisation: states by choices, in sizes.
    driven: DMatrix<f64>,
    /// Work space for the next states.
    next: DMatrix<f64>,
    /// Work space for the mean of B over a step.
    ahead: DMatrix<f64>,
    /// Work space for d y / d x: states by signals, in the states' sizes.
    seen: DMatrix<f64>,
}

impl TrajectorySensitivities {
    /// Sensitivities that begin with these of the states (states by choices, in sizes).
    pub fn new(states: DMatrix<f64>, moves: Vec<Option<(usize, f64)>>, signals: usize) -> Self {
        let (n, choices) = states.shape();
        let zeros = || DMatrix::zeros(n, choices);
        TrajectorySensitivities {
            states,
            outputs: DMatrix::zeros(choices, signals),
            moves,
            driven: zeros(),
            next: zeros(),
            ahead: zeros(),
            seen: DMatrix::zeros(n, signals),
        }
    }

    /// Updates the sensitivities of the outputs from the linearisation at this point.
    fn look(&mut self, local: &LocalEvaluator, sizes: &[f64]) {
        let linear = &local.linear;
        let signals = linear.c.nrows();
        for (i, size) in sizes.iter().enumerate() {
            (0..signals).for_each(|y| self.seen[(i, y)] = linear.c[(y, i)] * size);
        }
        for (y, mut out) in self.outputs.column_iter_mut().enumerate() {
            let seen = self.seen.column(y);
            for ((out, states), moved) in out.iter_mut().zip(self.states.column_iter()).zip(&self.moves) {
                *out = states.dot(&seen) + moved.map_or(0.0, |(parameter, factor)| linear.d[(y, parameter)] * factor);
            }
        }
    }

    /// Updates B from the linearisation at this point.
    fn drive(&mut self, local: &LocalEvaluator, sizes: &[f64]) {
        for (mut column, moved) in self.driven.column_iter_mut().zip(&self.moves) {
            if let Some((parameter, factor)) = moved {
                let b = local.linear.b.column(*parameter);
                column.iter_mut().zip(b.iter()).zip(sizes).for_each(|((to, b), size)| *to = b * factor / size);
            }
        }
    }

    /// Advances S over a step to the point where the model was just linearised.
    /// `missed`: what the transition lacks because the matrix changed over the step; `None` if it lacks nothing.
    fn advance(
        &mut self,
        local: &LocalEvaluator,
        exponential: &MatrixExponential,
        missed: Option<&DMatrix<f64>>,
        sizes: &[f64],
    ) {
        // B changes linearly over the step, so the mean of its ends stands for it
        self.ahead.copy_from(&self.driven);
        self.drive(local, sizes);
        self.ahead += &self.driven;
        self.ahead *= 0.5;
        exponential::multiply(&mut self.next, &exponential.transition, &self.states, 0.0);
        exponential::multiply(&mut self.next, &exponential.integral, &self.ahead, 1.0);
        if let Some(missed) = missed {
            // the missing part acts on the states over the whole step; the mean of both ends stands for them, to second
            // order
            self.ahead.copy_from(&self.states);
            self.ahead += &self.next;
            self.ahead *= 0.5;
            exponential::multiply(&mut self.states, missed, &self.ahead, 0.0);
            self.ahead.zip_apply(&self.states, |mean, more| *mean += 0.5 * more);
            exponential::multiply(&mut self.next, missed, &self.ahead, 1.0);
        }
        // the buffers swap roles, so that a step allocates nothing
        std::mem::swap(&mut self.states, &mut self.next);
    }
}

/// A run of a model along a recording.
pub struct RecordingRun<'a> {
    /// Evaluator of the model at the last point.
    pub local: &'a mut LocalEvaluator,
    /// Values of the model's parameters, SI.
    pub theta: &'a [f64],
    /// Usual sizes of its states, SI.
    pub sizes: &'a [f64],
    /// Accepted correction of a step, in parts of these sizes.
    pub correction: f64,
    /// State at the last point, SI.
    pub state: Vec<f64>,
    /// Sensitivities; `None` for a run without.
    pub slopes: Option<TrajectorySensitivities>,
    /// Steps that the run may still take.
    pub left: usize,
}

impl RecordingRun<'_> {
    /// Runs through `samples` of a recording. The state is that at the first of them.
    ///
    /// `at` is called at each sample with its index, the model there and the sensitivities of its signals (choices by
    /// signals); `Break` ends the run. `None` if the model cannot be evaluated on the way, if too many steps are taken,
    /// or on `Break`.
    pub fn along(
        &mut self,
        recording: &RecordingData,
        samples: Range<usize>,
        mut at: impl FnMut(usize, &LocalEvaluator, Option<&DMatrix<f64>>) -> ControlFlow<()>,
    ) -> Option<()> {
        let mut stepper = ExponentialStepper::new(self.sizes.len(), recording);
        let last = samples.end - 1;
        for k in samples {
            recording.input(k, &mut stepper.u);
            let t = recording.times[k];
            // sensitivities need a linearisation at every sample, a run without them does not
            match &self.slopes {
                Some(_) => self.local.linearize(t, &self.state, self.theta, &stepper.u),
                None => self.local.evaluate(t, &self.state, self.theta, &stepper.u),
            }
            .ok()?;
            if let Some(slopes) = &mut self.slopes {
                slopes.look(self.local, self.sizes);
                slopes.drive(self.local, self.sizes);
            }
            if at(k, self.local, self.slopes.as_ref().map(|s| &s.outputs)).is_break() {
                return None;
            }
            if k == last {
                break;
            }
            // inputs have a kink at each sample, so no step crosses one
            stepper.inputs.enter(recording, k);
            stepper.advance(self, t, recording.times[k + 1] - t)?;
            if self.state.iter().any(|v| !v.is_finite()) {
                return None;
            }
        }
        Some(())
    }
}

/// Difference of the scaled matrix at the last linearisation from `from`: states by states.
fn differ(out: &mut DMatrix<f64>, run: &RecordingRun<'_>, from: &DMatrix<f64>) {
    let (a, sizes) = (&run.local.linear.a, run.sizes);
    for (j, mut column) in out.column_iter_mut().enumerate() {
        let from = from.column(j);
        (0..sizes.len()).for_each(|i| column[i] = a[(i, j)] * sizes[j] / sizes[i] - from[i]);
    }
}

/// Whether the missing part of a transition is small enough to be added to second order.
fn is_small(missed: &DMatrix<f64>) -> bool {
    missed.row_iter().all(|row| row.iter().map(|v| v.abs()).sum::<f64>() <= MISSED)
}

/// Outputs of a model over a recording from the model's own start: signals by samples, SI.
/// `None` if the simulation stops early.
pub fn from_start(
    plan: &Arc<EvaluationPlan>,
    theta: &[f64],
    (sizes, correction): (&[f64], f64),
    recording: &RecordingData,
) -> Option<Vec<Vec<f64>>> {
    let u = InputSegment::new(recording).from;
    let mut local = LocalEvaluator::start(plan.clone(), recording.times[0], theta, &u).ok()?;
    let mut outputs = vec![Vec::with_capacity(recording.len()); plan.outputs()];
    let state = local.state();
    let mut run = RecordingRun { local: &mut local, theta, sizes, correction, state, slopes: None, left: usize::MAX };
    run.along(recording, 0..recording.len(), |_, local, _| {
        outputs.iter_mut().zip(&local.outputs).for_each(|(all, y)| all.push(*y));
        ControlFlow::Continue(())
    })?;
    Some(outputs)
}

/// Step control and work space of a run along one recording.
struct ExponentialStepper {
    /// Exponentials by depth, the number of halvings of the distance between two samples.
    exponentials: Vec<MatrixExponential>,
    /// Matrix of the last linearisation, states by states, in sizes.
    a: DMatrix<f64>,
    /// Its input matrix, states by inputs.
    b: DMatrix<f64>,
    /// Difference of the matrix at the step's beginning from that of the exponential.
    change_before: DMatrix<f64>,
    /// The same at the step's end, and work space.
    change_after: DMatrix<f64>,
    /// What the transition lacks of both.
    missed: DMatrix<f64>,
    /// Exponential of the mean matrix, for a step over which the matrix changes much.
    mean: MatrixExponential,
    /// Per depth the step that the last linearisation served, s; 0 where it has served none.
    lengths: [f64; DEEPEST as usize + 1],
    /// Halvings of the last step.
    depth: u32,
    /// Steps until depths beyond [`DEEP`] are refused.
    spare: usize,
    /// Steps that may still be shorter than the shortest.
    shorter: usize,
    /// State derivatives at the step's beginning, in sizes per second.
    rate: DVector<f64>,
    /// A change of the states over the step, in sizes.
    change: DVector<f64>,
    /// What the linear model leaves out of the derivatives at the step's end.
    remainder: DVector<f64>,
    /// Growth of the derivatives by inputs that change linearly, in sizes per second squared.
    ramp: DVector<f64>,
    /// State at the step's end, SI.
    next: Vec<f64>,
    /// Inputs of the current interval.
    inputs: InputSegment,
    /// Work space for the inputs at one time.
    u: Vec<f64>,
}

impl ExponentialStepper {
    /// For a model of `n` states along a recording.
    fn new(n: usize, recording: &RecordingData) -> Self {
        let zeros = || DVector::zeros(n);
        ExponentialStepper {
            exponentials: vec![MatrixExponential::new(n)],
            a: DMatrix::zeros(n, n),
            b: DMatrix::zeros(n, recording.inputs.len()),
            change_before: DMatrix::zeros(n, n),
            change_after: DMatrix::zeros(n, n),
            missed: DMatrix::zeros(n, n),
            mean: MatrixExponential::new(n),
            lengths: [0.0; DEEPEST as usize + 1],
            depth: 0,
            spare: MANY.max(recording.len() << DEEP),
            shorter: SHORTER,
            rate: zeros(),
            change: zeros(),
            remainder: zeros(),
            ramp: zeros(),
            next: vec![0.0; n],
            inputs: InputSegment::new(recording),
            u: vec![0.0; recording.inputs.len()],
        }
    }

    /// Steps from the sample at `t` to the next, `h` later. The model has been evaluated there, and linearised if the
    /// run has sensitivities. `None` if the model cannot be evaluated or the run's steps are used up.
    fn advance(&mut self, run: &mut RecordingRun<'_>, t: f64, h: f64) -> Option<()> {
        // time within the interval is counted in ticks, so that halvings are exact
        const WHOLE: u32 = 1 << DEEPEST;
        let mut linear_here = run.slopes.is_some();
        let mut gone = 0;
        let to_shortest = ((h / SHORTEST).log2().ceil() as u32).clamp(DEEP, DEEPEST);
        self.take_rates(run);
        while gone < WHOLE {
            run.left = run.left.checked_sub(1)?;
            // a recording that has used up its short steps goes on with coarser ones
            let deepest = if self.spare > 0 { to_shortest } else { DEEP };
            self.spare = self.spare.saturating_sub(1);
            self.shorter = self.shorter.saturating_sub(usize::from(self.depth > deepest));
            // a step is doubled only at a point where the longer step of that grid begins
            while self.depth > deepest && gone.is_multiple_of(2 * (WHOLE >> self.depth)) {
                self.depth -= 1;
            }
            let part = WHOLE >> self.depth;
            let fraction = |ticks: u32| h * f64::from(ticks) / f64::from(WHOLE);
            let (after, length) = (fraction(gone), fraction(part));
            let serves = exponential::as_long(length, self.lengths[self.depth as usize]);
            let mut off = f64::INFINITY;
            // an older linearisation is tried first, since it costs neither Jacobian nor exponential
            let older = serves && (run.slopes.is_none() || self.serves_slopes(run));
            if older {
                self.grow();
                off = self.step(run, t, after, length, RemainderGrowth::Proportional);
            }
            // no older linearisation serves, or its correction is too large: linearise here, with the same length
            if off > run.correction {
                if !linear_here {
                    self.inputs.at(after, &mut self.u);
                    run.local.linearize(t + after, &run.state, run.theta, &self.u).ok()?;
                    linear_here = true;
                }
                self.linear(run, length);
                if run.slopes.is_some() {
                    differ(&mut self.change_before, run, &self.exponentials[self.depth as usize].known);
                }
                off = self.step(run, t, after, length, RemainderGrowth::Square);
            }
            // beyond the allowed depth a large correction is accepted, but not a wild one
            let shorter = off > WILD && self.depth < DEEPEST && self.shorter > 0;
            if off > run.correction && self.depth < deepest || shorter {
                self.deepen();
                continue;
            }
            // the model has no value at the end even of the shortest step
            if off.is_infinite() {
                return None;
            }
            run.state.copy_from_slice(&self.next);
            gone += part;
            linear_here = run.slopes.is_some();
            if linear_here {
                run.local.linearize(t + fraction(gone), &run.state, run.theta, &self.u).ok()?;
                self.take_slopes(run, length);
            }
            // at the next sample `along` evaluates the model anyway
            if gone < WHOLE {
                if !linear_here {
                    run.local.evaluate(t + fraction(gone), &run.state, run.theta, &self.u).ok()?;
                }
                self.take_rates(run);
            }
            // doubled only where the longer step begins on its own grid of halvings
            if off < LENGTHENED * run.correction && self.depth > 0 && gone.is_multiple_of(2 * part) {
                self.depth -= 1;
            }
        }
        Some(())
    }

    /// Halves the step.
    fn deepen(&mut self) {
        self.depth += 1;
        if self.exponentials.len() <= self.depth as usize {
            self.exponentials.push(MatrixExponential::new(self.next.len()));
        }
    }

    /// Copies the state derivatives at this point, in sizes per second.
    fn take_rates(&mut self, run: &RecordingRun<'_>) {
        let scaled = run.local.rates.iter().zip(run.sizes).map(|(r, s)| r / s);
        self.rate.iter_mut().zip(scaled).for_each(|(to, r)| *to = r);
    }

    /// Whether the older linearisation is near enough to the present matrix for sensitivities.
    fn serves_slopes(&mut self, run: &RecordingRun<'_>) -> bool {
        let exponential = &self.exponentials[self.depth as usize];
        differ(&mut self.change_before, run, &exponential.known);
        exponential::multiply(&mut self.missed, &exponential.integral, &self.change_before, 0.0);
        is_small(&self.missed)
    }

    /// Advances the sensitivities over a step to the point where the model was just linearised.
    /// The matrix is taken as linear between both ends, A_0 and A_1. With A that of the exponential, the transition
    /// lacks integral (A_0 - A) + twice (A_1 - A_0)/h.
    fn take_slopes(&mut self, run: &mut RecordingRun<'_>, length: f64) {
        let ExponentialStepper { exponentials, change_before, change_after, missed, mean, depth, .. } = self;
        let exponential = &exponentials[*depth as usize];
        differ(change_after, run, &exponential.known);
        *change_after -= &*change_before;
        *change_after /= length;
        exponential::multiply(missed, &exponential.integral, change_before, 0.0);
        exponential::multiply(missed, &exponential.twice, change_after, 1.0);
        let Some(slopes) = &mut run.slopes else { return };
        if is_small(missed) {
            slopes.advance(run.local, exponential, Some(missed), run.sizes);
        } else {
            // The step passes a corner. Added to second order, a stiff matrix behind the corner would make the
            // sensitivities far too large.
            *change_after *= 0.5 * length;
            *change_after += &*change_before;
            *change_after += &exponential.known;
            mean.compute(change_after, length);
            // a mean that exceeds the transition by so much means that the step ends within a snap
            let most = SNAP * exponential.transition.amax();
            let served = if mean.transition.iter().all(|v| v.abs() <= most) { &*mean } else { exponential };
            slopes.advance(run.local, served, None, run.sizes);
        }
    }

    /// Takes over the linearisation at this point, and computes its exponential for steps of `length` s.
    fn linear(&mut self, run: &RecordingRun<'_>, length: f64) {
        let (linear, sizes) = (&run.local.linear, run.sizes);
        let n = sizes.len();
        (0..n).for_each(|j| (0..n).for_each(|i| self.a[(i, j)] = linear.a[(i, j)] * sizes[j] / sizes[i]));
        // the inputs are the last columns, behind the parameters
        let first = linear.b.ncols() - self.b.ncols();
        for (j, mut column) in self.b.column_iter_mut().enumerate() {
            (0..n).for_each(|i| column[i] = linear.b[(i, first + j)] / sizes[i]);
        }
        self.grow();
        // the exponentials of other lengths belong to an older matrix
        self.lengths = [0.0; DEEPEST as usize + 1];
        self.lengths[self.depth as usize] = length;
        self.exponentials[self.depth as usize].compute(&self.a, length);
    }

    /// Growth of the derivatives with the inputs of this interval.
    fn grow(&mut self) {
        self.ramp.fill(0.0);
        let columns = self.b.column_iter().zip(&self.inputs.slope).filter(|(_, slope)| **slope != 0.0);
        columns.for_each(|(column, slope)| self.ramp.axpy(*slope, &column, 1.0));
    }

    /// One step, `after` seconds behind the sample at `t`; writes the state at its end to `next`.
    /// Result: the largest correction of a state in sizes; infinite if the model cannot be evaluated at the end.
    fn step(&mut self, run: &mut RecordingRun<'_>, t: f64, after: f64, length: f64, grows: RemainderGrowth) -> f64 {
        let exponential = &self.exponentials[self.depth as usize];
        // linear step with linearly changing inputs
        exponential::apply(&mut self.change, &exponential.integral, &self.rate, 0.0);
        if self.ramp.iter().any(|v| *v != 0.0) {
            exponential::apply(&mut self.change, &exponential.twice, &self.ramp, 1.0);
        }
        for (i, next) in self.next.iter_mut().enumerate() {
            *next = run.state[i] + self.change[i] * run.sizes[i];
        }
        // derivative that the linear model predicts at the end, to be compared with the model's own
        self.remainder.copy_from(&self.rate);
        exponential::apply(&mut self.remainder, &self.a, &self.change, 1.0);
        self.remainder.axpy(length, &self.ramp, 1.0);
        self.inputs.at(after + length, &mut self.u);
        if run.local.evaluate(t + after + length, &self.next, run.theta, &self.u).is_err() {
            return f64::INFINITY;
        }
        let rates = run.local.rates.iter().zip(run.sizes);
        self.remainder.iter_mut().zip(rates).for_each(|(r, (rate, size))| *r = rate / size - *r);
        exponential::apply(&mut self.change, &exponential.twice, &self.remainder, 0.0);
        self.change *= grows.weight() / length;
        // NaN fails every comparison, so it is counted as an infinite correction
        let most =
            self.change.iter().fold(0.0, |m: f64, v| if v.abs() >= 0.0 { m.max(v.abs()) } else { f64::INFINITY });
        // a large correction means a corner within the step; the derivatives behind it do not hold for the part before
        // it
        if most <= run.correction {
            let moves = self.next.iter_mut().zip(self.change.iter().zip(run.sizes));
            moves.for_each(|(next, (change, size))| *next += change * size);
        }
        most
    }
}
