//! A model from its inputs alone, from a state at one sample of a recording: exponential Rosenbrock steps of third order
//! (Hochbruck, Ostermann, Acta Numerica 2010, 2.4), halved until the correction of the linear step is small. A linearisation
//! serves as long as the model keeps to it. Slopes go along by the variational equation of each linearised step,
//! S' = A S + B, which has the same exponential.

use super::super::data::{InputSegment, RecordingData};
use super::exponential::{self, MatrixExponential};
use bramah_analysis::local::{EvaluationPlan, LocalEvaluator};
use nalgebra::{DMatrix, DVector};
use std::ops::{ControlFlow, Range};
use std::sync::Arc;

/// Halvings of the distance between two samples: so many at least are allowed, and as many as lead to the shortest step, s, in
/// which valves and friction change; a coarse recording is simulated like a fine one. No more than the last ones. Short steps
/// are for corners, which are passed in a few of them: once a recording has taken as many steps as it would with the first
/// ones everywhere, and some seconds' worth of steps in all, no more than those are allowed. A model that chatters would take a
/// million between two samples.
const DEEP: u32 = 6;
const SHORTEST: f64 = 1e-4;
const DEEPEST: u32 = 24;
const MANY: usize = 20_000;
/// The correction of a linear step that is let pass, in parts of the states' sizes, lies between these, ...
const CORRECTION: (f64, f64) = (5e-6, 1e-4);
/// ... and is this part of the noise of the best sensor in parts of its full scale: costs are compared to half a squared
/// deviation, and 5000 samples that are each a hundredth of the noise off add up to that. Where the model is smooth, what is
/// left after a correction is a tenth and less of it; at a corner (friction that changes sign) it is as much.
const CORRECTED: f64 = 0.01;
/// A correction in parts of the states' sizes with which not even a shortest step is let pass, for so many steps of a
/// recording: at a snap within microseconds the states would be thrown anywhere. A snap takes some tens of steps, so that some
/// tens of snaps are passed.
const WILD: f64 = 1e-2;
const SHORTER: usize = 1000;
/// Part of it below which the next step is twice as long: the correction grows with the cube.
const LENGTHENED: f64 = 0.1;
/// What the change of the linear model over a step may do to slopes, as part of the states, for it to be added to second order:
/// the cube of it is left. Beyond, a step has the exponential of the mean of both its ends.
const MISSED: f64 = 0.1;
/// Times that this mean may make more of the states than the step itself did: as many as a store gives way when it runs empty.
/// Where it makes more, the step ends within such a snap, which takes microseconds: stretched over the step, what grows for a
/// moment would grow for all of it. Behind a snap the states follow others at once, and forget what they were.
const SNAP: f64 = 1e3;

/// The correction of a step that is let pass, in parts of the states' sizes, beside sensors with this noise and full scale.
pub fn correction(noise: &[f64], full_scale: &[f64]) -> f64 {
    let finest = noise.iter().zip(full_scale).map(|(n, f)| n / f).filter(|part| part.is_finite());
    let (least, most) = CORRECTION;
    (CORRECTED * finest.fold(f64::INFINITY, f64::min)).clamp(least, most)
}

/// How what a linearisation leaves out grows over a step: its weight beside phi_2, which belongs to growth in proportion.
#[derive(Clone, Copy)]
enum RemainderGrowth {
    /// The linearisation is that of the beginning: with the square of time. The weight is 2 phi_3, of which 2/3 phi_2 has the
    /// value at zero; of a fast lag it is two thirds, and of what that leaves nothing adds up.
    Square,
    /// It is older: in proportion to time.
    Proportional,
}

impl RemainderGrowth {
    fn weight(self) -> f64 {
        match self {
            RemainderGrowth::Square => 2.0 / 3.0,
            RemainderGrowth::Proportional => 1.0,
        }
    }
}

/// How states and outputs depend on what may be chosen.
#[derive(Clone, Debug)]
pub struct TrajectorySensitivities {
    /// States by choices, in the states' sizes.
    pub states: DMatrix<f64>,
    /// Choices by signals: d y / d choices at the last linearisation.
    pub outputs: DMatrix<f64>,
    /// Per choice the parameter that it moves, and by how much; nothing for a choice of the first state.
    moves: Vec<Option<(usize, f64)>>,
    /// What drives the states where the model was linearised last, in their sizes.
    driven: DMatrix<f64>,
    /// Work space: the next states, what drives them at the end of a step, and d y / d x in the states' sizes, states by
    /// signals.
    next: DMatrix<f64>,
    ahead: DMatrix<f64>,
    seen: DMatrix<f64>,
}

impl TrajectorySensitivities {
    /// Where the states depend on the choices like this.
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

    /// Takes over how the signals depend on states and parameters.
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

    /// Takes over what drives the states where the model was just linearised.
    fn drive(&mut self, local: &LocalEvaluator, sizes: &[f64]) {
        for (mut column, moved) in self.driven.column_iter_mut().zip(&self.moves) {
            if let Some((parameter, factor)) = moved {
                let b = local.linear.b.column(*parameter);
                column.iter_mut().zip(b.iter()).zip(sizes).for_each(|((to, b), size)| *to = b * factor / size);
            }
        }
    }

    /// S over a step whose transition and integral are known, up to where the model was just linearised; `missed`: what the
    /// transition lacks.
    fn advance(
        &mut self,
        local: &LocalEvaluator,
        exponential: &MatrixExponential,
        missed: Option<&DMatrix<f64>>,
        sizes: &[f64],
    ) {
        self.ahead.copy_from(&self.driven);
        self.drive(local, sizes);
        // the mean of both ends drives over the step
        self.ahead += &self.driven;
        self.ahead *= 0.5;
        exponential::multiply(&mut self.next, &exponential.transition, &self.states, 0.0);
        exponential::multiply(&mut self.next, &exponential.integral, &self.ahead, 1.0);
        if let Some(missed) = missed {
            // what is missed acts on the states of the whole step, of which those of both ends are the mean: to second order
            self.ahead.copy_from(&self.states);
            self.ahead += &self.next;
            self.ahead *= 0.5;
            exponential::multiply(&mut self.states, missed, &self.ahead, 0.0);
            self.ahead.zip_apply(&self.states, |mean, more| *mean += 0.5 * more);
            exponential::multiply(&mut self.next, missed, &self.ahead, 1.0);
        }
        std::mem::swap(&mut self.states, &mut self.next);
    }
}

/// A model on its way through a recording.
pub struct RecordingRun<'a> {
    /// The model at the last point.
    pub local: &'a mut LocalEvaluator,
    /// Values of its parameters.
    pub theta: &'a [f64],
    /// Sizes of its states.
    pub sizes: &'a [f64],
    /// What a step may be corrected by, in parts of these sizes.
    pub correction: f64,
    /// The state, SI.
    pub state: Vec<f64>,
    /// Slopes, where they are wanted.
    pub slopes: Option<TrajectorySensitivities>,
    /// Steps that it may still take.
    pub left: usize,
}

impl RecordingRun<'_> {
    /// Goes through samples of a recording; `at` sees the model at each of them, and how its signals depend on the choices
    /// (choices by signals), and may end it there. It ends at the last one. `None` where the model has no value on the way, it
    /// takes more steps than it may, or `at` ended it.
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
            stepper.inputs.enter(recording, k);
            stepper.advance(self, t, recording.times[k + 1] - t)?;
            if self.state.iter().any(|v| !v.is_finite()) {
                return None;
            }
        }
        Some(())
    }
}

/// How the scaled matrix where the model was linearised last differs from another one.
fn differ(out: &mut DMatrix<f64>, run: &RecordingRun<'_>, from: &DMatrix<f64>) {
    let (a, sizes) = (&run.local.linear.a, run.sizes);
    for (j, mut column) in out.column_iter_mut().enumerate() {
        let from = from.column(j);
        (0..sizes.len()).for_each(|i| column[i] = a[(i, j)] * sizes[j] / sizes[i] - from[i]);
    }
}

/// Whether what a transition lacks may be added to second order.
fn is_small(missed: &DMatrix<f64>) -> bool {
    missed.row_iter().all(|row| row.iter().map(|v| v.abs()).sum::<f64>() <= MISSED)
}

/// Outputs of a model over a recording, from its own start: signals by samples. Its states have these sizes, of which a step
/// may be corrected by this part. `None` where it does not reach the end.
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

struct ExponentialStepper {
    /// One for each length of step, in halvings of the distance between two samples.
    exponentials: Vec<MatrixExponential>,
    /// Scaled matrices of the last linearisation: states by states, states by inputs.
    a: DMatrix<f64>,
    b: DMatrix<f64>,
    /// How the matrices at both ends of a step differ from that of its exponential, and what a transition lacks of them.
    change_before: DMatrix<f64>,
    change_after: DMatrix<f64>,
    missed: DMatrix<f64>,
    /// That of a step over which the matrix changes much.
    mean: MatrixExponential,
    /// Per length the step that the linearisation served last; 0 where it did not.
    lengths: [f64; DEEPEST as usize + 1],
    /// Halvings of the last step, steps until only the first ones are allowed, and steps that may be shorter than the shortest.
    depth: u32,
    spare: usize,
    shorter: usize,
    /// x' in sizes where the step begins, a change over the step, and what the linear model leaves out of x' at its end.
    rate: DVector<f64>,
    change: DVector<f64>,
    remainder: DVector<f64>,
    /// How fast the inputs change the rates.
    ramp: DVector<f64>,
    next: Vec<f64>,
    inputs: InputSegment,
    u: Vec<f64>,
}

impl ExponentialStepper {
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

    /// From a sample at `t`, where the model has been evaluated (linearised, where there are slopes), to the next.
    fn advance(&mut self, run: &mut RecordingRun<'_>, t: f64, h: f64) -> Option<()> {
        const WHOLE: u32 = 1 << DEEPEST;
        let mut linear_here = run.slopes.is_some();
        let mut gone = 0;
        let to_shortest = ((h / SHORTEST).log2().ceil() as u32).clamp(DEEP, DEEPEST);
        self.take_rates(run);
        while gone < WHOLE {
            run.left = run.left.checked_sub(1)?;
            let deepest = if self.spare > 0 { to_shortest } else { DEEP };
            self.spare = self.spare.saturating_sub(1);
            self.shorter = self.shorter.saturating_sub(usize::from(self.depth > deepest));
            // a longer step begins where it would have begun
            while self.depth > deepest && gone.is_multiple_of(2 * (WHOLE >> self.depth)) {
                self.depth -= 1;
            }
            let part = WHOLE >> self.depth;
            let fraction = |ticks: u32| h * f64::from(ticks) / f64::from(WHOLE);
            let (after, length) = (fraction(gone), fraction(part));
            let serves = exponential::as_long(length, self.lengths[self.depth as usize]);
            let mut off = f64::INFINITY;
            let older = serves && (run.slopes.is_none() || self.serves_slopes(run));
            if older {
                self.grow();
                off = self.step(run, t, after, length, RemainderGrowth::Proportional);
            }
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
            let shorter = off > WILD && self.depth < DEEPEST && self.shorter > 0;
            if off > run.correction && self.depth < deepest || shorter {
                self.deepen();
                continue;
            }
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
            // at the next sample the model is looked at anyway
            if gone < WHOLE {
                if !linear_here {
                    run.local.evaluate(t + fraction(gone), &run.state, run.theta, &self.u).ok()?;
                }
                self.take_rates(run);
            }
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

    fn take_rates(&mut self, run: &RecordingRun<'_>) {
        let scaled = run.local.rates.iter().zip(run.sizes).map(|(r, s)| r / s);
        self.rate.iter_mut().zip(scaled).for_each(|(to, r)| *to = r);
    }

    /// Whether an older linearisation will do for slopes.
    fn serves_slopes(&mut self, run: &RecordingRun<'_>) -> bool {
        let exponential = &self.exponentials[self.depth as usize];
        differ(&mut self.change_before, run, &exponential.known);
        exponential::multiply(&mut self.missed, &exponential.integral, &self.change_before, 0.0);
        is_small(&self.missed)
    }

    /// Slopes over a step to where the model was just linearised. The matrix goes straight from one end to the other:
    /// what the transition lacks is integral (A_0 - A) + twice (A_1 - A_0)/h.
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
            // a corner was passed: added, what is stiff behind it would throw slopes about
            *change_after *= 0.5 * length;
            *change_after += &*change_before;
            *change_after += &exponential.known;
            mean.compute(change_after, length);
            let most = SNAP * exponential.transition.amax();
            let served = if mean.transition.iter().all(|v| v.abs() <= most) { &*mean } else { exponential };
            slopes.advance(run.local, served, None, run.sizes);
        }
    }

    /// Takes over the linearisation.
    fn linear(&mut self, run: &RecordingRun<'_>, length: f64) {
        let (linear, sizes) = (&run.local.linear, run.sizes);
        let n = sizes.len();
        (0..n).for_each(|j| (0..n).for_each(|i| self.a[(i, j)] = linear.a[(i, j)] * sizes[j] / sizes[i]));
        let first = linear.b.ncols() - self.b.ncols();
        for (j, mut column) in self.b.column_iter_mut().enumerate() {
            (0..n).for_each(|i| column[i] = linear.b[(i, first + j)] / sizes[i]);
        }
        self.grow();
        // other lengths belong to another matrix
        self.lengths = [0.0; DEEPEST as usize + 1];
        self.lengths[self.depth as usize] = length;
        self.exponentials[self.depth as usize].compute(&self.a, length);
    }

    /// How fast the rates grow with the inputs of this interval.
    fn grow(&mut self) {
        self.ramp.fill(0.0);
        let columns = self.b.column_iter().zip(&self.inputs.slope).filter(|(_, slope)| **slope != 0.0);
        columns.for_each(|(column, slope)| self.ramp.axpy(*slope, &column, 1.0));
    }

    /// A step so long after the sample at `t`, corrected by what the linear model leaves out at its end, and the largest
    /// correction of a state, in sizes.
    fn step(&mut self, run: &mut RecordingRun<'_>, t: f64, after: f64, length: f64, grows: RemainderGrowth) -> f64 {
        let exponential = &self.exponentials[self.depth as usize];
        exponential::apply(&mut self.change, &exponential.integral, &self.rate, 0.0);
        if self.ramp.iter().any(|v| *v != 0.0) {
            exponential::apply(&mut self.change, &exponential.twice, &self.ramp, 1.0);
        }
        for (i, next) in self.next.iter_mut().enumerate() {
            *next = run.state[i] + self.change[i] * run.sizes[i];
        }
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
        // what is not a number is as far off as can be
        let most =
            self.change.iter().fold(0.0, |m: f64, v| if v.abs() >= 0.0 { m.max(v.abs()) } else { f64::INFINITY });
        // behind a corner the rates say nothing of the step before it
        if most <= run.correction {
            let moves = self.next.iter_mut().zip(self.change.iter().zip(run.sizes));
            moves.for_each(|(next, (change, size))| *next += change * size);
        }
        most
    }
}
