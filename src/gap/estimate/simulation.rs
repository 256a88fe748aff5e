//! A model from its inputs alone, from a state at one sample of a recording: exponential steps (Rosenbrock-Euler;
//! Hochbruck, Ostermann, Acta Numerica 2010, 2.4), halved until the model is nearly linear over each. A linearisation
//! serves as long as the model keeps to it, and inputs do not move within a step. Slopes go along by the variational
//! equation of each linearised step, S' = A S + B, which has the same exponential.

use super::super::data::{Inputs, Recording};
use super::super::step::{self, Exponential};
use crate::analysis::local::Local;
use nalgebra::{DMatrix, DVector};
use std::ops::Range;

/// Halvings of a step at most.
const DEEPEST: u32 = 6;
/// The curvature within a step that is let pass, in parts of the states' sizes.
const CURVATURE: f64 = 1e-5;

/// How states and outputs depend on what may be chosen.
#[derive(Clone, Debug)]
pub struct Slopes {
    /// States by choices, in the states' sizes.
    pub states: DMatrix<f64>,
    /// Per choice the parameter that it moves, and by how much; nothing for a choice of the first state.
    pub moves: Vec<Option<(usize, f64)>>,
}

impl Slopes {
    /// d y / d choices at the last linearisation, signals by choices.
    pub fn outputs(&self, local: &Local, sizes: &[f64]) -> DMatrix<f64> {
        let linear = &local.linear;
        let c = DMatrix::from_fn(linear.c.nrows(), sizes.len(), |i, j| linear.c[(i, j)] * sizes[j]);
        let mut slopes = c * &self.states;
        for (column, moved) in self.moves.iter().enumerate() {
            if let Some((parameter, factor)) = moved {
                slopes.column_mut(column).axpy(*factor, &linear.d.column(*parameter), 1.0);
            }
        }
        slopes
    }

    /// S over a step whose transition and integral are known.
    fn advance(&mut self, local: &Local, exponential: &Exponential, scale: &DVector<f64>) {
        let mut driven = DMatrix::zeros(scale.len(), self.moves.len());
        for (column, moved) in self.moves.iter().enumerate() {
            if let Some((parameter, factor)) = moved {
                let drive = local.linear.b.column(*parameter).component_div(scale) * *factor;
                driven.set_column(column, &drive);
            }
        }
        self.states = &exponential.transition * &self.states + &exponential.integral * driven;
    }
}

/// A model on its way through a recording.
pub struct Course<'a> {
    /// The model at the last point.
    pub local: &'a mut Local,
    /// Values of its parameters.
    pub theta: &'a [f64],
    /// Sizes of its states.
    pub sizes: &'a [f64],
    /// The state, SI.
    pub state: Vec<f64>,
    /// Slopes, where they are wanted.
    pub slopes: Option<Slopes>,
}

impl Course<'_> {
    /// Goes through samples of a recording; `at` sees the model at each of them, with slopes linearised there. It ends at
    /// the last one. `None` where the model has no value on the way.
    pub fn run(
        &mut self,
        recording: &Recording,
        samples: Range<usize>,
        mut at: impl FnMut(usize, &Local, Option<&Slopes>),
    ) -> Option<()> {
        let n = self.sizes.len();
        let mut stepper = Stepper {
            scale: DVector::from_column_slice(self.sizes),
            exponential: Exponential::new(n, 0),
            a: DMatrix::zeros(n, n),
            length: 0.0,
            since: 0.0,
            inputs: Inputs::new(recording),
            u: vec![0.0; recording.inputs.len()],
        };
        let last = samples.end - 1;
        for k in samples {
            recording.input(k, &mut stepper.u);
            let t = recording.times[k];
            match &self.slopes {
                Some(_) => self.local.linearize(t, &self.state, self.theta, &stepper.u),
                None => self.local.evaluate(t, &self.state, self.theta, &stepper.u),
            }
            .ok()?;
            at(k, self.local, self.slopes.as_ref());
            if k == last {
                break;
            }
            stepper.since = t;
            stepper.inputs.enter(recording, k);
            stepper.advance(self, t, recording.times[k + 1] - t, 0)?;
            if self.state.iter().any(|v| !v.is_finite()) {
                return None;
            }
        }
        Some(())
    }
}

struct Stepper {
    scale: DVector<f64>,
    exponential: Exponential,
    /// Scaled matrix and step of the last linearisation; no step yet where it is 0.
    a: DMatrix<f64>,
    length: f64,
    /// When the last sample was, and the inputs after it.
    since: f64,
    inputs: Inputs,
    u: Vec<f64>,
}

impl Stepper {
    /// From `t`, where the model has been evaluated.
    fn advance(&mut self, course: &mut Course<'_>, t: f64, h: f64, depth: u32) -> Option<()> {
        let still = DVector::zeros(self.scale.len());
        if step::as_long(h, self.length) && self.inputs.slope.iter().all(|v| *v == 0.0) {
            self.exponential.ramped.fill(0.0);
            let (next, bend) = self.step(course, t, h, &still);
            if bend <= CURVATURE {
                self.accept(course, next);
                return Some(());
            }
        }
        self.inputs.at(t - self.since, &mut self.u);
        course.local.linearize(t, &course.state, course.theta, &self.u).ok()?;
        let ramp = self.linear(course.local, h);
        let (next, bend) = self.step(course, t, h, &ramp);
        if depth < DEEPEST && bend > CURVATURE {
            self.advance(course, t, 0.5 * h, depth + 1)?;
            let middle = t + 0.5 * h;
            self.inputs.at(middle - self.since, &mut self.u);
            course.local.evaluate(middle, &course.state, course.theta, &self.u).ok()?;
            return self.advance(course, middle, 0.5 * h, depth + 1);
        }
        self.accept(course, next);
        Some(())
    }

    fn accept(&self, course: &mut Course<'_>, next: Vec<f64>) {
        if let Some(slopes) = &mut course.slopes {
            slopes.advance(course.local, &self.exponential, &self.scale);
        }
        course.state = next;
    }

    /// Takes over the linearisation; gives how fast the inputs change the rates.
    fn linear(&mut self, local: &Local, h: f64) -> DVector<f64> {
        let n = self.scale.len();
        self.a = DMatrix::from_fn(n, n, |i, j| local.linear.a[(i, j)] * self.scale[j] / self.scale[i]);
        self.length = h;
        let ramp = step::ramp(&local.linear.b, &self.inputs.slope).component_div(&self.scale);
        self.exponential.compute(&self.a, h, Some(&ramp));
        ramp
    }

    /// A step from where the model was evaluated last, and how far the model is from linear over it.
    fn step(&mut self, course: &mut Course<'_>, t: f64, h: f64, ramp: &DVector<f64>) -> (Vec<f64>, f64) {
        let (local, x) = (&mut *course.local, &course.state);
        let rate = local.rate_vector().component_div(&self.scale);
        let change = &self.exponential.integral * &rate + &self.exponential.ramped;
        let next: Vec<f64> = (0..x.len()).map(|i| x[i] + change[i] * self.scale[i]).collect();
        let expected = rate + &self.a * change + ramp * h;
        self.inputs.at(t + h - self.since, &mut self.u);
        if local.evaluate(t + h, &next, course.theta, &self.u).is_err() {
            return (next, f64::INFINITY);
        }
        let off = |i: usize| 0.5 * h * (local.rates[i] / self.scale[i] - expected[i]).abs();
        (next, (0..x.len()).map(off).fold(0.0, f64::max))
    }
}
