//! Maximum a posteriori: Levenberg-Marquardt between bounds, on errors weighed as large and as correlated as the fit
//! leaves them. With a large misfit the data are weak and tolerances hold; once what is missing is in, the errors become
//! small and independent, and the data speak about parameters too.

use super::super::clock::Deadline;
use super::super::data::RecordingData;
use super::super::policy::{DOUBLINGS, ITERATIONS, LEAST, SETTLED, SETTLED_PART, SETTLED_SQUARE, TRIALS};
use super::super::problem::HypothesisValues;
use super::candidate::{CandidateModel, FitCoordinate, ModelEvaluation, RecordingResiduals, SensitivityProducts};
use bramah_analysis::estimate::correlation;
use nalgebra::{DMatrix, DVector};

/// First damping, what divides it after a step that was taken, and what multiplies it, at least, after one that was not.
const DAMPING: f64 = 1e-3;
const EASED: f64 = 5.0;
const STIFFENED: f64 = 6.0;
const LEAST_DAMPING: f64 = 1e-4;
/// Part of the slope at a step's beginning that is left at its end where a longer one is tried: a step that ends at the minimum
/// of a parabola has none, one that ends halfway has half.
const STILL_FALLS: f64 = 0.5;
/// Part of the diagonal that keeps a singular system solvable.
const RIDGE: f64 = 1e-9;

/// How much the errors of each signal count.
#[derive(Clone, Debug, PartialEq)]
pub struct SignalWeights {
    /// Per signal the mean square of its errors.
    pub square: Vec<f64>,
    /// Per signal how many samples in a row say the same.
    pub tau: Vec<f64>,
}

impl SignalWeights {
    /// As large and as correlated as errors are.
    pub fn of(errors: &[RecordingResiduals], full_scale: &[f64]) -> Self {
        let one = |(i, scale): (usize, &f64)| {
            let square = squares(errors, i) / samples(errors, i).max(1.0);
            (square.max((0.01 * LEAST * scale).powi(2)), tau(errors, i))
        };
        let (square, tau) = full_scale.iter().enumerate().map(one).unzip();
        SignalWeights { square, tau }
    }

    /// As if only the sensors' noise were left.
    pub fn sensors(noise: &[f64], full_scale: &[f64]) -> Self {
        let square = noise.iter().zip(full_scale).map(|(n, f)| n.max(LEAST * f).powi(2)).collect();
        SignalWeights { square, tau: vec![1.0; noise.len()] }
    }

    /// What a squared error of a signal counts.
    pub fn weight(&self, signal: usize) -> f64 {
        1.0 / (self.square[signal] * self.tau[signal])
    }

    /// Sum of weighed squares.
    pub fn cost(&self, errors: &[RecordingResiduals]) -> f64 {
        (0..self.square.len()).map(|i| self.weight(i) * squares(errors, i)).sum()
    }
}

/// How many samples of a signal in a row say the same.
fn tau(errors: &[RecordingResiduals], signal: usize) -> f64 {
    correlation::mean_time(errors.iter().map(|e| e[signal].as_slice()))
}

fn samples(errors: &[RecordingResiduals], signal: usize) -> f64 {
    errors.iter().map(|e| finite(&e[signal])).sum()
}

fn finite(errors: &[f64]) -> f64 {
    errors.iter().filter(|v| v.is_finite()).count() as f64
}

/// Sum of a signal's squared errors over all recordings.
pub fn squares(errors: &[RecordingResiduals], signal: usize) -> f64 {
    errors.iter().flat_map(|e| &e[signal]).filter(|v| v.is_finite()).map(|v| v * v).sum()
}

/// What models are fitted to, and for how long.
#[derive(Clone, Copy, Debug)]
pub struct FitTask<'a> {
    /// The recordings.
    pub train: &'a [RecordingData],
    /// Full scale of each signal, SI.
    pub full_scale: &'a [f64],
    /// A fit that has no more time stays where it came.
    pub until: Deadline<'a>,
}

/// A model at its optimum.
#[derive(Clone, Debug)]
pub struct ModelFit {
    /// The model.
    pub candidate: CandidateModel,
    /// Its coordinates.
    pub x: Vec<f64>,
    /// What it leaves there.
    pub evaluated: ModelEvaluation,
    /// How much that counted.
    pub weights: SignalWeights,
}

impl ModelFit {
    /// Fits a model from `x`: once for each of `rounds`, with weights that the round before left. `first` are those of the
    /// first round, where they are not to be as the errors are at `x`. `None` where the model does not reach the end of a
    /// recording.
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
        // by weights that are those of the errors, what costs less may leave more of the signals that count little
        if first.is_none() && begun.ahead(&fit) < 0.0 {
            return Some(begun);
        }
        for _ in 1..rounds {
            let mut next = fit.clone();
            next.weights = SignalWeights::of(&fit.evaluated.errors, task.full_scale);
            next.descend(task, ITERATIONS);
            // a weaker weight of the data may lead away from them for good
            if fit.ahead(&next) < 0.0 {
                break;
            }
            fit = next;
        }
        Some(fit)
    }

    /// A model at a point that is fitted with given weights, or with weights as the errors are there. `None` where the model
    /// does not reach the end of a recording.
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

    /// A model where it was evaluated.
    fn at(mut candidate: CandidateModel, x: Vec<f64>, evaluated: ModelEvaluation, weights: SignalWeights) -> ModelFit {
        candidate.off.clone_from(&evaluated.off);
        ModelFit { candidate, x, evaluated, weights }
    }

    /// Nats by which the data that were fitted and the prior prefer another fit to them, each signal with the variance that
    /// a fit leaves, and as correlated as the more correlated errors are.
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

    /// Levenberg-Marquardt with these weights, at most so many iterations, while there is time.
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
            let closes = self.mean_squares().into_iter().zip(&squares).any(fell);
            if !closes && before - self.cost() < SETTLED.max(SETTLED_PART * before) {
                break;
            }
        }
    }

    /// Where a step that gains leads, damped as far as it must be; `None` where no step gains.
    fn gained(&self, train: &[RecordingData], damping: &mut f64) -> Option<ModelFit> {
        let system = self.system(|_, _| true);
        for _ in 0..TRIALS {
            let x = system.step(&self.candidate.coordinates, &self.x, *damping);
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

    /// The model at another point; `None` where it costs no less. A run without slopes takes other steps than one with them,
    /// and their costs differ by the error of the simulation: what is gained is gained with slopes.
    fn gone(&self, x: Vec<f64>, train: &[RecordingData]) -> Option<ModelFit> {
        let before = self.cost();
        let evaluated = self.candidate.evaluate_within(&x, train, &self.weights, before)?;
        let next = ModelFit::at(self.candidate.clone(), x, evaluated, self.weights.clone());
        (next.cost() < before).then_some(next)
    }

    /// Goes further along a step that was taken if the cost still falls there at least half as fast as where it began: where
    /// a sensitivity falls as an effect grows, linear steps are short.
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
            match self.candidate.cost_within(&tried, train, &self.weights, least).filter(|c| *c < least) {
                Some(c) => (best, least) = (tried, c),
                None => break,
            }
        }
        let farther = if best == self.x { None } else { self.gone(best, train) };
        farther.unwrap_or(self)
    }

    /// Weighed squares and the prior.
    pub fn cost(&self) -> f64 {
        self.weights.cost(&self.evaluated.errors) + self.candidate.prior(&self.x)
    }

    /// The normal equations of the pieces wanted, by recording and piece.
    pub fn system(&self, wanted: impl Fn(usize, usize) -> bool) -> NormalEquations {
        NormalEquations::of(self.sums(wanted), &self.candidate.coordinates, &self.x)
    }

    /// Their weighed sums, without what is known of the coordinates beforehand.
    pub fn sums(&self, wanted: impl Fn(usize, usize) -> bool) -> SensitivityProducts {
        self.evaluated.sums(self.x.len(), &self.weights, wanted)
    }

    /// Samples of a signal with a value.
    pub fn samples(&self, signal: usize) -> f64 {
        samples(&self.evaluated.errors, signal)
    }

    /// Mean square of a signal's errors.
    pub fn mean_square(&self, signal: usize) -> f64 {
        squares(&self.evaluated.errors, signal) / self.samples(signal).max(1.0)
    }

    /// The same of all signals.
    pub fn mean_squares(&self) -> Vec<f64> {
        (0..self.weights.tau.len()).map(|i| self.mean_square(i)).collect()
    }

    /// Nats that the distance of parameters from their data sheet costs.
    pub fn prior(&self) -> f64 {
        0.5 * self.candidate.prior(&self.x)
    }

    /// Its hypotheses with their fitted values.
    pub fn causes(&self) -> Vec<HypothesisValues> {
        let theta = self.candidate.theta(&self.x);
        let with = |(c, places): (&HypothesisValues, &Vec<usize>)| HypothesisValues {
            hypothesis: c.hypothesis,
            values: places.iter().map(|&p| theta[p]).collect(),
        };
        self.candidate.causes.iter().zip(&self.candidate.model.attached).map(with).collect()
    }

    /// Values of the parameters that may be off within their tolerances, SI.
    pub fn tolerances(&self) -> Vec<f64> {
        self.candidate.theta(&self.x)[self.candidate.model.free.clone()].to_vec()
    }

    /// Standard deviation of each coordinate, in its units; what a bound holds has none. The largest of three: from the
    /// information, and from how far the pieces and the recordings contradict each other (White, Econometrica 48, 1980;
    /// Liang, Zeger, Biometrika 73, 1986).
    pub fn deviations(&self) -> Vec<f64> {
        let system = self.system(|_, _| true);
        let pieces = self.evaluated.products.iter().flatten().map(|signals| self.score([signals]));
        let recordings = self.evaluated.products.iter().map(|pieces| self.score(pieces));
        let scores = [pieces.collect(), recordings.collect::<Vec<_>>()];
        system.deviations(&self.candidate.coordinates, &self.x, &scores)
    }

    /// Minus half the gradient of some pieces' weighed squares.
    fn score<'a>(&self, pieces: impl IntoIterator<Item = &'a Vec<SensitivityProducts>>) -> DVector<f64> {
        let mut sum = DVector::zeros(self.x.len());
        for signals in pieces {
            signals.iter().enumerate().for_each(|(i, p)| sum.axpy(self.weights.weight(i), &p.errors, 1.0));
        }
        sum
    }
}

/// Normal equations at a point.
#[derive(Clone, Debug)]
pub struct NormalEquations {
    information: DMatrix<f64>,
    /// Minus half the gradient.
    towards: DVector<f64>,
}

impl NormalEquations {
    /// Those of weighed sums over samples at `x`, with what is known of the coordinates beforehand.
    pub fn of(mut sum: SensitivityProducts, coordinates: &[FitCoordinate], x: &[f64]) -> NormalEquations {
        for (i, (c, x)) in coordinates.iter().zip(x).enumerate() {
            if let Some((mean, sigma)) = c.prior {
                sum.slopes[(i, i)] += sigma.powi(-2);
                sum.errors[i] -= (x - mean) / (sigma * sigma);
            }
        }
        NormalEquations { information: sum.slopes, towards: sum.errors }
    }

    /// Coordinates that are free to go where the gradient leads, and seen at all.
    pub fn free(&self, coordinates: &[FitCoordinate], x: &[f64]) -> Vec<usize> {
        let held = |i: usize| {
            let c = &coordinates[i];
            x[i] <= c.low && self.towards[i] < 0.0 || x[i] >= c.high && self.towards[i] > 0.0
        };
        (0..x.len()).filter(|&i| !held(i) && self.information[(i, i)] > 0.0).collect()
    }

    /// The damped information of some coordinates in units in which its diagonal is 1, and these units.
    fn scaled(&self, free: &[usize], damping: f64) -> (Vec<f64>, DMatrix<f64>) {
        let unit: Vec<f64> = free.iter().map(|&i| self.information[(i, i)].sqrt()).collect();
        let matrix = DMatrix::from_fn(free.len(), free.len(), |a, b| {
            let scaled = self.information[(free[a], free[b])] / (unit[a] * unit[b]);
            if a == b { scaled + damping + RIDGE } else { scaled }
        });
        (unit, matrix)
    }

    /// By how much the cost falls from one point to another, if the model is linear between them.
    pub fn promised(&self, from: &[f64], to: &[f64]) -> f64 {
        let change = DVector::from_fn(from.len(), |i, _| to[i] - from[i]);
        2.0 * self.towards.dot(&change) - change.dot(&(&self.information * &change))
    }

    /// Where a damped Gauss-Newton step from `x` leads, within the bounds.
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

    /// Nats that a move by one unit of some coordinates behind the first ones gains, beyond what these can take over.
    pub fn visible(&self, first: usize, moved: usize) -> f64 {
        let ones = DVector::from_element(moved, 1.0);
        let own = self.information.view((first, first), (moved, moved)) * &ones;
        let across = self.information.view((0, first), (first, moved)) * &ones;
        let known: Vec<usize> = (0..first).filter(|&i| self.information[(i, i)] > 0.0).collect();
        let (unit, matrix) = self.scaled(&known, 0.0);
        let across = DVector::from_fn(known.len(), |a, _| across[known[a]] / unit[a]);
        let taken = matrix.cholesky().map_or(0.0, |f| across.dot(&f.solve(&across)));
        0.5 * (own.sum() - taken).max(0.0)
    }

    fn deviations(&self, coordinates: &[FitCoordinate], x: &[f64], scores: &[Vec<DVector<f64>>]) -> Vec<f64> {
        let free = self.free(coordinates, x);
        let mut deviations = vec![0.0; x.len()];
        let (unit, matrix) = self.scaled(&free, 0.0);
        let Some(inverse) = matrix.try_inverse() else { return deviations };
        let mut variances: DVector<f64> = inverse.diagonal();
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
