//! The MAP estimate: Levenberg-Marquardt between bounds, on errors weighted as large and as correlated as the fit
//! leaves them.
//!
//! With a large misfit the data have little weight and the tolerances hold. Once the missing effect is in the model,
//! the errors become small and independent, and the data determine the parameters too.
//!
//! Enters: a `CandidateModel`, a point and a [`FitTask`]. Leaves: a [`ModelFit`]. Called by `select::weighed` and
//! `rivals`. Costs are in squared deviations, twice the negative logarithm of the posterior; evidence is in nats, half
//! of that. Method and cost function: `docs/gap_method.md`, "MAP estimate".

use super::super::clock::Deadline;
use super::super::data::RecordingData;
use super::super::problem::HypothesisValues;
use super::candidate::{CandidateModel, FitCoordinate, ModelEvaluation, RecordingResiduals, SensitivityProducts};
use crate::policy::{DOUBLINGS, ITERATIONS, LEAST, SETTLED, SETTLED_PART, SETTLED_SQUARE, TRIALS};
use bramah_analysis::estimate::correlation;
use nalgebra::{DMatrix, DVector};

/// First damping of a fit, in parts of the diagonal.
const DAMPING: f64 = 1e-3;
/// Divisor of the damping after a step that was accepted.
const EASED: f64 = 5.0;
/// Factor of the damping after a step that was rejected.
const STIFFENED: f64 = 6.0;
/// Least damping to which that factor is applied.
const LEAST_DAMPING: f64 = 1e-4;
/// Part of the slope at a step's beginning that must remain at its end for a longer step to be tried. A step that ends
/// at the minimum of a parabola has none left, one that ends halfway has half.
const STILL_FALLS: f64 = 0.5;
/// Part of the diagonal that keeps a singular system solvable.
const RIDGE: f64 = 1e-9;

/// Weights of the signals' errors. A squared error counts 1/(square tau).
#[derive(Clone, Debug, PartialEq)]
pub struct SignalWeights {
    /// Per signal the mean square of its errors, SI squared.
    pub square: Vec<f64>,
    /// Per signal the autocorrelation time of its errors, in samples.
    pub tau: Vec<f64>,
}

impl SignalWeights {
    /// Weights for errors as large and as correlated as these.
    pub fn of(errors: &[RecordingResiduals], full_scale: &[f64]) -> Self {
        let one = |(i, scale): (usize, &f64)| {
            let square = squares(errors, i) / samples(errors, i).max(1.0);
            // a lower limit, so that a signal that is met exactly does not get an infinite weight
            (square.max((0.01 * LEAST * scale).powi(2)), tau(errors, i))
        };
        let (square, tau) = full_scale.iter().enumerate().map(one).unzip();
        SignalWeights { square, tau }
    }

    /// Weights as if only the sensors' noise were left, white.
    pub fn sensors(noise: &[f64], full_scale: &[f64]) -> Self {
        let square = noise.iter().zip(full_scale).map(|(n, f)| n.max(LEAST * f).powi(2)).collect();
        SignalWeights { square, tau: vec![1.0; noise.len()] }
    }

    /// Weight of a squared error of a signal.
    pub fn weight(&self, signal: usize) -> f64 {
        1.0 / (self.square[signal] * self.tau[signal])
    }

    /// Weighted sum of squares of all signals.
    pub fn cost(&self, errors: &[RecordingResiduals]) -> f64 {
        (0..self.square.len()).map(|i| self.weight(i) * squares(errors, i)).sum()
    }
}

/// Autocorrelation time of a signal's errors over all recordings, in samples.
fn tau(errors: &[RecordingResiduals], signal: usize) -> f64 {
    correlation::mean_time(errors.iter().map(|e| e[signal].as_slice()))
}

/// Number of samples of a signal over all recordings.
fn samples(errors: &[RecordingResiduals], signal: usize) -> f64 {
    errors.iter().map(|e| finite(&e[signal])).sum()
}

/// Number of finite values.
fn finite(errors: &[f64]) -> f64 {
    errors.iter().filter(|v| v.is_finite()).count() as f64
}

/// Sum of a signal's squared errors over all recordings.
pub fn squares(errors: &[RecordingResiduals], signal: usize) -> f64 {
    errors.iter().flat_map(|e| &e[signal]).filter(|v| v.is_finite()).map(|v| v * v).sum()
}

/// Data to which models are fitted, and the time for it.
#[derive(Clone, Copy, Debug)]
pub struct FitTask<'a> {
    /// The train recordings.
    pub train: &'a [RecordingData],
    /// Full scale of each signal, SI.
    pub full_scale: &'a [f64],
    /// Behind it a fit stays where it is.
    pub until: Deadline<'a>,
}

/// A fitted model.
#[derive(Clone, Debug)]
pub struct ModelFit {
    /// The model.
    pub candidate: CandidateModel,
    /// Its coordinates.
    pub x: Vec<f64>,
    /// Residuals and sensitivities there.
    pub evaluated: ModelEvaluation,
    /// Weights with which it was fitted.
    pub weights: SignalWeights,
}

impl ModelFit {
    /// Fits a model from `x` in a number of rounds, each with the weights that the round before left.
    /// `first`: weights of the first round; `None` means as the errors are at `x`. `None` results if the simulation
    /// stops early.
    pub fn of(
        candidate: CandidateModel,
        x: Vec<f64>,
        task: FitTask<'_>,
        first: Option<SignalWeights>,
        rounds: usize,
    ) -> Option<ModelFit> {
        let begun = ModelFit::begun(candidate, x, task, first.as_ref())?;
        let mut fit = begun.clone();
        fit.descend(task, ITERATIONS);
        // With weights from large errors a lower cost may leave more at signals of little weight: the start is then the
        // better fit.
        if first.is_none() && begun.ahead(&fit) < 0.0 {
            return Some(begun);
        }
        for _ in 1..rounds {
            let mut next = fit.clone();
            next.weights = SignalWeights::of(&fit.evaluated.errors, task.full_scale);
            next.descend(task, ITERATIONS);
            // smaller weights of the data may lead away from the data, and the next round would make them smaller still
            if fit.ahead(&next) < 0.0 {
                break;
            }
            fit = next;
        }
        Some(fit)
    }

    /// A fit at its first point, with given weights or with weights as the errors are there.
    /// `None` if the simulation stops early.
    pub fn begun(
        candidate: CandidateModel,
        x: Vec<f64>,
        task: FitTask<'_>,
        weights: Option<&SignalWeights>,
    ) -> Option<ModelFit> {
        let evaluated = candidate.evaluate(&x, task.train)?;
        let weights = weights.cloned().unwrap_or_else(|| SignalWeights::of(&evaluated.errors, task.full_scale));
        Some(ModelFit::at(candidate, x, evaluated, weights))
    }

    /// A fit at a point where the model was evaluated.
    fn at(mut candidate: CandidateModel, x: Vec<f64>, evaluated: ModelEvaluation, weights: SignalWeights) -> ModelFit {
        candidate.off.clone_from(&evaluated.off);
        ModelFit { candidate, x, evaluated, weights }
    }

    /// Nats by which the train data and the prior prefer another fit.
    /// Each signal has the variance that a fit leaves, and the longer of the two autocorrelation times.
    pub fn ahead(&self, other: &ModelFit) -> f64 {
        let one = |i: usize| {
            let correlated = |f: &ModelFit| tau(&f.evaluated.errors, i);
            let independent = self.samples(i) / correlated(self).max(correlated(other));
            let square = |f: &ModelFit| f.mean_square(i).max(f64::MIN_POSITIVE);
            0.5 * independent * (square(self) / square(other)).ln()
        };
        (0..self.weights.tau.len()).map(one).sum::<f64>() + self.prior() - other.prior()
    }

    /// The one of two fits that [`ModelFit::ahead`] prefers.
    pub fn better_of(self, other: ModelFit) -> ModelFit {
        if self.ahead(&other) > 0.0 { other } else { self }
    }

    /// Levenberg-Marquardt with the present weights: at most `iterations` steps, until the deadline or until a step
    /// gains little.
    pub fn descend(&mut self, task: FitTask<'_>, iterations: usize) {
        let mut damping = DAMPING;
        for _ in 0..iterations {
            if task.until.is_over() {
                break;
            }
            let (before, squares) = (self.cost(), self.mean_squares());
            let Some(next) = self.gained(task.train, &mut damping) else { break };
            *self = next;
            let fell = |(now, before): (f64, &f64)| now < (1.0 - SETTLED_SQUARE) * before;
            // a step that closes much of a small signal goes on, though it gains little of the cost
            let closes = self.mean_squares().into_iter().zip(&squares).any(fell);
            if !closes && before - self.cost() < SETTLED.max(SETTLED_PART * before) {
                break;
            }
        }
    }

    /// The fit behind one accepted step, damped as far as needed; `None` if no step gains.
    fn gained(&self, train: &[RecordingData], damping: &mut f64) -> Option<ModelFit> {
        let system = self.system(|_, _| true);
        for _ in 0..TRIALS {
            let x = system.step(&self.candidate.coordinates, &self.x, *damping);
            // bounds hold every coordinate, or the system is singular
            if x == self.x {
                return None;
            }
            if let Some(next) = self.gone(x, train) {
                *damping /= EASED;
                return Some(next.stretched(&system, &self.x, train));
            }
            *damping = damping.max(LEAST_DAMPING) * STIFFENED;
        }
        None
    }

    /// The fit at another point; `None` if it costs no less.
    /// A run without sensitivities takes other steps than one with them, and their costs differ by the simulation's
    /// error. Gains are therefore measured with sensitivities.
    fn gone(&self, x: Vec<f64>, train: &[RecordingData]) -> Option<ModelFit> {
        let before = self.cost();
        let evaluated = self.candidate.evaluate_within(&x, train, &self.weights, before)?;
        let next = ModelFit::at(self.candidate.clone(), x, evaluated, self.weights.clone());
        (next.cost() < before).then_some(next)
    }

    /// Doubles an accepted step while the cost falls, if it still falls at the step's end at least half as fast as at
    /// its beginning. Linear steps are short where a sensitivity falls as an effect grows.
    /// `system`: normal equations where the step began, at `from`.
    fn stretched(self, system: &NormalEquations, from: &[f64], train: &[RecordingData]) -> ModelFit {
        let along = |s: &NormalEquations| (0..from.len()).map(|i| s.towards[i] * (self.x[i] - from[i])).sum::<f64>();
        if along(&self.system(|_, _| true)) < STILL_FALLS * along(system) {
            return self;
        }
        let coordinates = &self.candidate.coordinates;
        let (mut best, mut least) = (self.x.clone(), self.cost());
        for _ in 0..DOUBLINGS {
            let far = |((c, from), to): ((&FitCoordinate, &f64), &f64)| (2.0 * to - from).clamp(c.low, c.high);
            let tried: Vec<f64> = coordinates.iter().zip(from).zip(&best).map(far).collect();
            // runs without sensitivities are enough to find the length; `gone` confirms the gain
            match self.candidate.cost_within(&tried, train, &self.weights, least).filter(|c| *c < least) {
                Some(c) => (best, least) = (tried, c),
                None => break,
            }
        }
        let farther = if best == self.x { None } else { self.gone(best, train) };
        farther.unwrap_or(self)
    }

    /// Weighted squares plus prior, in squared deviations.
    pub fn cost(&self) -> f64 {
        self.weights.cost(&self.evaluated.errors) + self.candidate.prior(&self.x)
    }

    /// Normal equations of the pieces for which `wanted(recording, piece)` holds, with the prior.
    /// No run is needed: the evaluation keeps its sums by piece.
    pub fn system(&self, wanted: impl Fn(usize, usize) -> bool) -> NormalEquations {
        NormalEquations::of(self.sums(wanted), &self.candidate.coordinates, &self.x)
    }

    /// The same sums without the prior.
    pub fn sums(&self, wanted: impl Fn(usize, usize) -> bool) -> SensitivityProducts {
        self.evaluated.sums(self.x.len(), &self.weights, wanted)
    }

    /// Number of samples of a signal.
    pub fn samples(&self, signal: usize) -> f64 {
        samples(&self.evaluated.errors, signal)
    }

    /// Mean square of a signal's errors, SI squared.
    pub fn mean_square(&self, signal: usize) -> f64 {
        squares(&self.evaluated.errors, signal) / self.samples(signal).max(1.0)
    }

    /// Mean squares of all signals.
    pub fn mean_squares(&self) -> Vec<f64> {
        (0..self.weights.tau.len()).map(|i| self.mean_square(i)).collect()
    }

    /// Cost of the prior in nats: half the squared deviations of the parameters from their data sheet.
    pub fn prior(&self) -> f64 {
        0.5 * self.candidate.prior(&self.x)
    }

    /// The attached hypotheses with their fitted values, SI.
    pub fn causes(&self) -> Vec<HypothesisValues> {
        let theta = self.candidate.theta(&self.x);
        let with = |(c, places): (&HypothesisValues, &Vec<usize>)| HypothesisValues {
            hypothesis: c.hypothesis,
            values: places.iter().map(|&p| theta[p]).collect(),
        };
        self.candidate.causes.iter().zip(&self.candidate.model.attached).map(with).collect()
    }

    /// Fitted values of the tolerance parameters, SI.
    pub fn tolerances(&self) -> Vec<f64> {
        self.candidate.theta(&self.x)[self.candidate.model.free.clone()].to_vec()
    }

    /// Standard deviation of each coordinate, in its units; 0 for a coordinate that a bound holds.
    ///
    /// The largest of three: from the information matrix, and from how far the gradients of pieces and of recordings
    /// differ (White, Econometrica 48, 1980; Liang, Zeger, Biometrika 73, 1986).
    pub fn deviations(&self) -> Vec<f64> {
        let system = self.system(|_, _| true);
        let pieces = self.evaluated.products.iter().flatten().map(|signals| self.score([signals]));
        let recordings = self.evaluated.products.iter().map(|pieces| self.score(pieces));
        let scores = [pieces.collect(), recordings.collect::<Vec<_>>()];
        system.deviations(&self.candidate.coordinates, &self.x, &scores)
    }

    /// Half the negative gradient of the weighted squares of some pieces.
    fn score<'a>(&self, pieces: impl IntoIterator<Item = &'a Vec<SensitivityProducts>>) -> DVector<f64> {
        let mut sum = DVector::zeros(self.x.len());
        for signals in pieces {
            signals.iter().enumerate().for_each(|(i, p)| sum.axpy(self.weights.weight(i), &p.errors, 1.0));
        }
        sum
    }
}

/// Normal equations of a Gauss-Newton step at a point.
#[derive(Clone, Debug)]
pub struct NormalEquations {
    /// Weighted sum of y y' with the prior: coordinates by coordinates.
    information: DMatrix<f64>,
    /// Half the negative gradient.
    towards: DVector<f64>,
}

impl NormalEquations {
    /// Normal equations at `x` from weighted sums over samples, with the prior added.
    pub fn of(mut sum: SensitivityProducts, coordinates: &[FitCoordinate], x: &[f64]) -> NormalEquations {
        for (i, (c, x)) in coordinates.iter().zip(x).enumerate() {
            if let Some((mean, sigma)) = c.prior {
                sum.slopes[(i, i)] += sigma.powi(-2);
                sum.errors[i] -= (x - mean) / (sigma * sigma);
            }
        }
        NormalEquations { information: sum.slopes, towards: sum.errors }
    }

    /// Indices of the coordinates that can move where the gradient leads and have an influence at all.
    pub fn free(&self, coordinates: &[FitCoordinate], x: &[f64]) -> Vec<usize> {
        let held = |i: usize| {
            let c = &coordinates[i];
            x[i] <= c.low && self.towards[i] < 0.0 || x[i] >= c.high && self.towards[i] > 0.0
        };
        (0..x.len()).filter(|&i| !held(i) && self.information[(i, i)] > 0.0).collect()
    }

    /// The damped information matrix of some coordinates in units in which its diagonal is 1, and these units.
    fn scaled(&self, free: &[usize], damping: f64) -> (Vec<f64>, DMatrix<f64>) {
        let unit: Vec<f64> = free.iter().map(|&i| self.information[(i, i)].sqrt()).collect();
        let matrix = DMatrix::from_fn(free.len(), free.len(), |a, b| {
            let scaled = self.information[(free[a], free[b])] / (unit[a] * unit[b]);
            if a == b { scaled + damping + RIDGE } else { scaled }
        });
        (unit, matrix)
    }

    /// Decrease of the cost from one point to another if the model were linear, in squared deviations.
    pub fn promised(&self, from: &[f64], to: &[f64]) -> f64 {
        let change = DVector::from_fn(from.len(), |i, _| to[i] - from[i]);
        2.0 * self.towards.dot(&change) - change.dot(&(&self.information * &change))
    }

    /// Where a damped Gauss-Newton step from `x` leads, within the bounds; `x` itself if the system is singular.
    pub fn step(&self, coordinates: &[FitCoordinate], x: &[f64], damping: f64) -> Vec<f64> {
        let free = self.free(coordinates, x);
        let mut x = x.to_vec();
        let (unit, matrix) = self.scaled(&free, damping);
        let right = DVector::from_fn(free.len(), |a, _| self.towards[free[a]] / unit[a]);
        let Some(factor) = matrix.cholesky() else { return x };
        let change = factor.solve(&right);
        for (a, &i) in free.iter().enumerate() {
            let c = &coordinates[i];
            x[i] = (x[i] + change[a] / unit[a]).clamp(c.low, c.high);
        }
        x
    }

    /// Nats that a move by one unit of `moved` coordinates behind the first `first` ones gains, beyond what these take
    /// over.
    pub fn visible(&self, first: usize, moved: usize) -> f64 {
        let ones = DVector::from_element(moved, 1.0);
        let own = self.information.view((first, first), (moved, moved)) * &ones;
        let across = self.information.view((0, first), (first, moved)) * &ones;
        let known: Vec<usize> = (0..first).filter(|&i| self.information[(i, i)] > 0.0).collect();
        let (unit, matrix) = self.scaled(&known, 0.0);
        let across = DVector::from_fn(known.len(), |a, _| across[known[a]] / unit[a]);
        // Schur complement: the part of the move that the known coordinates could imitate
        let taken = matrix.cholesky().map_or(0.0, |f| across.dot(&f.solve(&across)));
        0.5 * (own.sum() - taken).max(0.0)
    }

    /// Standard deviations from the information matrix and from groups of gradients; see [`ModelFit::deviations`].
    /// `scores`: groupings, each a list of half negative gradients.
    fn deviations(&self, coordinates: &[FitCoordinate], x: &[f64], scores: &[Vec<DVector<f64>>]) -> Vec<f64> {
        let free = self.free(coordinates, x);
        let mut deviations = vec![0.0; x.len()];
        let (unit, matrix) = self.scaled(&free, 0.0);
        let Some(inverse) = matrix.try_inverse() else { return deviations };
        let mut variances: DVector<f64> = inverse.diagonal();
        // the scatter of the groups' own estimates needs no assumption on how errors are correlated within a group
        for groups in scores.iter().filter(|g| g.len() > 1) {
            let count = groups.len() as f64;
            let mean = groups.iter().fold(DVector::zeros(x.len()), |sum, g| sum + g) / count;
            let moved = |g: &DVector<f64>| {
                &inverse * DVector::from_fn(free.len(), |a, _| (g[free[a]] - mean[free[a]]) / unit[a])
            };
            let spread = groups
                .iter()
                .map(moved)
                .fold(DVector::zeros(free.len()), |sum: DVector<f64>, m| sum + m.component_mul(&m));
            variances.zip_apply(&(spread * (count / (count - 1.0))), |v, s| *v = v.max(s));
        }
        for (a, &i) in free.iter().enumerate() {
            deviations[i] = variances[a].max(0.0).sqrt() / unit[a];
        }
        deviations
    }
}
