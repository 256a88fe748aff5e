//! The prediction of the filter: state, covariance and columns from one sample to the next, in one linear step, or in
//! several where the model bends within it.

use super::super::step::{self, add_outer, advance, advance_across};
use super::{Filter, Work};
use nalgebra::{DMatrix, DVector};
use std::ops::AddAssign;

/// Parts into which a step is cut where the model bends within it.
const PARTS: usize = 8;
/// A model counts as linear over a step when its curvature moves no state by more than this part of the state's
/// standard deviation, or by [`LEAST_BEND`] of its size.
const BEND: f64 = 0.2;
const LEAST_BEND: f64 = 1e-4;
/// A part is halved when the model bends so many times more than that within it, and so often at most; more often only
/// where the linear model is lost (a valve open far below the pressure at which it closes): the model has no values at its
/// end, or bends by this part of a state's size too. Where it is lost still, the state waits.
const FAR: f64 = 5.0;
const FINEST: u32 = 2;
const LOST: f64 = 0.3;
const DEEPEST: u32 = 9;
/// A step in which a state would run away by this factor is cut even where another model did without.
const RUNAWAY: f64 = 10.0;
/// Parts for each sample so far on the average, beyond which no part is halved any more; the first samples may have as many
/// as these.
const MOST_PARTS: usize = 8;
const FIRST: usize = 100;
/// A corrected state counts as out of the model's reach when its rates differ by so many sizes of the states over a step
/// from what was expected.
const STRANGE: f64 = 10.0;

/// How far the model is from linear over a step: in parts of what is allowed, and whether it is nothing like it.
struct Bend {
    times: f64,
    lost: bool,
}

impl Bend {
    /// Where the model has no values.
    const UNKNOWN: Bend = Bend { times: f64::INFINITY, lost: true };
}

impl Filter<'_> {
    /// From the filtered state at sample `k` to the predicted one at the next: one step where the model is nearly linear
    /// over it, else several. The transition over the whole interval is kept in `work.total`.
    pub(super) fn predict(&mut self, k: usize, correction: &mut DVector<f64>, h: f64) {
        let t = self.recording.times[k];
        let start = self.z.clone();
        self.fill();
        // x' at the filtered state, to first order from the predicted one
        let mut rate = &self.work.a * &*correction;
        for (i, &xi) in self.active.iter().enumerate() {
            rate[i] += self.local.rates[xi] / self.scale[i];
        }
        self.source_rates(correction, &mut rate);
        let n = self.active.len();
        let all = step::ramp(&self.local.linear.b, &self.inputs.slope);
        let ramp = DVector::from_fn(n, |i, _| all[self.active[i]] / self.scale[i]);
        self.work.exponential.compute(&self.work.a, h, Some(&ramp));
        let mut change = &self.work.exponential.integral * &rate;
        change.rows_mut(0, n).add_assign(&self.work.exponential.ramped);
        self.z += &change;
        // with the inputs in the middle of the step from here on
        rate.rows_mut(0, n).axpy(0.5 * h, &ramp, 1.0);
        self.inputs.at(0.5 * h, &mut self.between);
        let finite = change.iter().all(|v| v.is_finite());
        let carried = self.x.clone();
        if finite {
            self.carry(&change, correction, h);
        }
        let nearly_linear = match self.setting.cuts.get(self.number) {
            Some(cut) => !cut.get(k).copied().unwrap_or(false),
            None => self.has_values(t + h) && self.bend(&rate, &change, h).times <= 1.0,
        };
        let m = &self.work.exponential.transition;
        let nearly_linear = nearly_linear && finite && m.diagonal().iter().all(|m| m.abs() < RUNAWAY);
        self.pass.cut[k] = !nearly_linear;
        if nearly_linear {
            self.propagate(h);
            self.work.total.copy_from(&self.work.exponential.transition);
            return;
        }
        self.z = start;
        self.x = carried;
        self.temper(t, &rate, correction, h);
        self.work.total.fill_with_identity();
        let (start, part) = (self.z.clone(), h / PARTS as f64);
        (0..PARTS).for_each(|i| self.advance(k, i as f64 * part, part, 0));
        let change = &self.z - start;
        self.carry(&change, correction, h);
    }

    /// Takes the passive states over a step in which the active ones changed so much behind a correction.
    fn carry(&mut self, change: &DVector<f64>, correction: &DVector<f64>, h: f64) {
        let moved: Vec<f64> =
            (0..self.active.len()).map(|i| (change[i] + 2.0 * correction[i]) * self.scale[i]).collect();
        self.passive.step(&self.local, &self.active, &moved, &mut self.x, h);
    }

    /// Takes back part of a correction that leads to where the model is nothing like what it was linearised as (an
    /// unmeasured pressure below zero, say).
    fn temper(&mut self, t: f64, expected: &DVector<f64>, correction: &mut DVector<f64>, h: f64) {
        let predicted = &self.z - &*correction;
        for halving in 0..=DEEPEST {
            self.load();
            let known = self.local.linearize(t, &self.x, &self.theta, &self.between).is_ok();
            let strange = |(i, &xi): (usize, &usize)| {
                let rate = self.local.rates[xi] / self.scale[i];
                let beyond = h * (rate - expected[i]).abs() > STRANGE * (1.0 + h * expected[i].abs());
                beyond || !rate.is_finite()
            };
            if known && !self.active.iter().enumerate().any(strange) {
                return;
            }
            *correction *= if halving + 1 < DEEPEST { 0.5 } else { 0.0 };
            self.z = &predicted + &*correction;
        }
    }

    /// A part of a cut step that begins `after` sample `k`, linearised there; halved where the model has no value at its
    /// end, or one far from what the linear model says.
    fn advance(&mut self, k: usize, after: f64, h: f64, depth: u32) {
        let (start, t) = (self.z.clone(), self.recording.times[k] + after);
        self.inputs.at(after + 0.5 * h, &mut self.between);
        if !self.possible(t) {
            // the state waits at the edge of where the model has values
            return;
        }
        self.fill();
        let mut rate = DVector::zeros(self.z.len());
        for (i, &xi) in self.active.iter().enumerate() {
            rate[i] = self.local.rates[xi] / self.scale[i];
        }
        self.source_rates(&DVector::zeros(self.z.len()), &mut rate);
        self.work.exponential.compute(&self.work.a, h, None);
        let change = &self.work.exponential.integral * &rate;
        self.z += &change;
        let bend = if self.possible(t + h) { self.bend(&rate, &change, h) } else { Bend::UNKNOWN };
        self.parts += 1;
        let deepest = if self.parts > MOST_PARTS * (k + FIRST) { 0 } else { DEEPEST };
        if depth < deepest && (bend.lost || depth < FINEST && bend.times > FAR) {
            self.z = start;
            self.advance(k, after, 0.5 * h, depth + 1);
            self.advance(k, after + 0.5 * h, 0.5 * h, depth + 1);
            return;
        }
        if bend.lost {
            self.z = start;
            return;
        }
        self.propagate(h);
        self.work.total = &self.work.exponential.transition * &self.work.total;
    }

    /// Whether the model has values and derivatives at the present state.
    fn possible(&mut self, t: f64) -> bool {
        self.load();
        self.local.linearize(t, &self.x, &self.theta, &self.between).is_ok()
    }

    /// Whether the model has values at the present state.
    fn has_values(&mut self, t: f64) -> bool {
        self.load();
        self.local.evaluate(t, &self.x, &self.theta, &self.between).is_ok()
    }

    /// How far x' at the end of a step, where the model was evaluated last, is from what the linear model says.
    fn bend(&self, rate: &DVector<f64>, change: &DVector<f64>, h: f64) -> Bend {
        let expected = rate + &self.work.a * change;
        let mut bend = Bend { times: 0.0, lost: false };
        for (i, &xi) in self.active.iter().enumerate() {
            let found = self.local.rates[xi] / self.scale[i];
            let moved = 0.5 * h * (found - expected[i]).abs();
            // states of an effect may have no size that says anything
            let most = if self.most[i].is_finite() { LOST } else { f64::INFINITY };
            let allowed = (BEND * self.p[(i, i)].max(0.0).sqrt()).max(LEAST_BEND).min(most);
            bend.times = bend.times.max(moved / allowed);
            bend.lost |= moved.is_nan() || moved > most;
        }
        bend
    }

    fn source_rates(&self, correction: &DVector<f64>, rate: &mut DVector<f64>) {
        let n = self.active.len();
        for (j, source) in self.setting.sources.iter().enumerate() {
            rate[n + j] -= (self.z[n + j] - correction[n + j]) / source.tau;
        }
    }

    /// The scaled matrices of the last linearisation.
    fn fill(&mut self) {
        let n = self.active.len();
        let linear = &self.local.linear;
        let Work { a, b, .. } = &mut self.work;
        a.fill(0.0);
        for (j, &xj) in self.active.iter().enumerate() {
            for (i, &xi) in self.active.iter().enumerate() {
                a[(i, j)] = linear.a[(xi, xj)] * self.scale[j] / self.scale[i];
            }
        }
        for (j, source) in self.setting.sources.iter().enumerate() {
            for (i, &xi) in self.active.iter().enumerate() {
                a[(i, n + j)] = linear.b[(xi, source.parameter)] * self.scale[n + j] / self.scale[i];
            }
            a[(n + j, n + j)] = -1.0 / source.tau;
        }
        for (j, &parameter) in self.setting.columns.iter().enumerate() {
            for (i, &xi) in self.active.iter().enumerate() {
                b[(j, i)] = linear.b[(xi, parameter)] / self.scale[i];
            }
        }
    }

    /// Covariance and columns over the step that the exponential holds.
    fn propagate(&mut self, h: f64) {
        let n = self.active.len();
        let Work { b, exponential, next_p, next_s, transposed, .. } = &mut self.work;
        let m = &exponential.transition;
        // parameters move no source
        exponential.integral.transpose_to(transposed);
        advance_across(next_s, b, transposed, n, 0.0);
        m.transpose_to(transposed);
        advance_across(next_s, &self.s, transposed, n, 1.0);
        std::mem::swap(&mut self.s, next_s);
        advance(next_p, m, n, &self.p);
        advance_across(&mut self.p, next_p, transposed, n, 0.0);
        // noise of the sources by the trapezoidal rule over the step
        for (j, source) in self.setting.sources.iter().enumerate() {
            let q = source_noise(source.tau, h);
            let column = m.column(n + j);
            add_outer(&mut self.p, 0.5 * q, column.as_slice(), column.as_slice());
            self.p[(n + j, n + j)] += 0.5 * q;
        }
        symmetrize(&mut self.p);
        self.forget();
    }

    /// Scales down what is carried along of states that run away.
    fn forget(&mut self) {
        for (i, &most) in self.most.iter().enumerate() {
            let variance = self.p[(i, i)];
            if variance > most {
                let part = (most / variance).sqrt();
                self.p.row_mut(i).scale_mut(part);
                self.p.column_mut(i).scale_mut(part);
                self.s.column_mut(i).scale_mut(part);
                self.work.exponential.transition.row_mut(i).scale_mut(part);
            }
        }
    }
}

/// Variance that a source of unit level gains over a step.
pub fn source_noise(tau: f64, h: f64) -> f64 {
    1.0 - (-2.0 * h / tau).exp()
}

/// Replaces a matrix by its symmetric part.
pub fn symmetrize(p: &mut DMatrix<f64>) {
    for j in 0..p.ncols() {
        for i in 0..j {
            let mean = 0.5 * (p[(i, j)] + p[(j, i)]);
            p[(i, j)] = mean;
            p[(j, i)] = mean;
        }
    }
}
