//! What a fit found: values, their uncertainty, and how well the signals are met.

use super::chance::student;
use super::inverse::InverseModel;
use super::least_squares::LeastSquaresSolution;
use super::residuals::inputs_beside;
use super::separate::{separate, without_rest};
use super::weights::ResidualWeights;
use super::{
    ContinuityDefects, Identification, IdentificationProblem, IdentifyMethod, MultistartSummary, ResidualTest,
    WeightedResiduals,
};
use crate::estimate::{LinearizedEstimate, spread};
use crate::study::Recording;
use nalgebra::DMatrix;

/// What the fit found. Vectors are in the order of [`IdentificationProblem::free`].
#[derive(Clone, Debug)]
pub struct ParameterFit {
    /// [`IdentifyMethod::Output`] or [`IdentifyMethod::Inverse`].
    pub method: IdentifyMethod,
    /// Values in the parameters' units.
    pub values: Vec<f64>,
    /// One standard deviation of each.
    pub deviations: Vec<f64>,
    /// Degrees of freedom behind each deviation; few where errors resemble each other for long.
    pub degrees: Vec<f64>,
    /// Correlations of the estimates.
    pub correlation: DMatrix<f64>,
    /// Parameters that ended at a bound.
    pub at_bound: Vec<bool>,
    /// False where the search ended before a least value was reached.
    pub converged: bool,
    /// Steps of the search.
    pub iterations: usize,
    /// Per signal (or input, for the inverse model) the errors on the train recordings.
    pub train: Vec<SignalFit>,
    /// What the errors on the train recordings look like, one a signal (or input, for the inverse model).
    pub residuals: Vec<ResidualTest>,
    /// Measured and modelled trajectory of each signal along the first train recording.
    pub trajectories: Vec<SignalTrajectory>,
    /// Why derivatives were differences along some recording; `None` where runs carried them all along.
    pub differences: Option<String>,
    /// Where searches from several places ended.
    pub starts: MultistartSummary,
    /// How pieces of recordings join; `None` where none is cut.
    pub joints: Option<ContinuityDefects>,
    /// All unknowns: the parameters on the scale of the search, then initial states.
    pub(super) z: Vec<f64>,
    /// Variances of the parameters on that scale.
    pub(super) spread: Vec<f64>,
    /// What they would be if the errors were white.
    pub(super) plain: Vec<f64>,
    /// The sum of squares.
    pub(super) cost: f64,
    /// How errors were weighed.
    pub(super) weights: ResidualWeights,
}

/// A signal along a recording.
#[derive(Clone, Debug, PartialEq)]
pub struct SignalTrajectory {
    /// The signal's name; for the inverse model the input's.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// Seconds.
    pub times: Vec<f64>,
    /// What was measured.
    pub measured: Vec<f64>,
    /// Model minus measurement.
    pub errors: Vec<f64>,
}

impl ParameterFit {
    /// The 95 % interval of a parameter, in its unit, from its deviation on the scale of the search and Student's
    /// distribution: on a logarithmic scale it lies about the value by a factor. Infinite where the data say nothing.
    pub fn interval(&self, problem: &IdentificationProblem<'_>, parameter: usize) -> (f64, f64) {
        let (free, z) = (&problem.free[parameter], self.z[parameter]);
        let half = student(self.degrees[parameter]) * self.spread[parameter].sqrt();
        (free.value(z - half), free.value(z + half))
    }
}

/// How well one signal is met.
#[derive(Clone, Debug, PartialEq)]
pub struct SignalFit {
    /// The signal's name; for the inverse model the input's.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// Root mean square of the errors.
    pub rmse: f64,
    /// The same over the signal's own root mean square about its mean (about zero for forces).
    pub relative: f64,
    /// Over how many samples the errors resemble each other; 1 for white ones.
    pub correlation: f64,
}

impl Identification<'_> {
    pub(super) fn force_fits(&self, model: &mut InverseModel<'_>, minimum: &LeastSquaresSolution) -> Vec<SignalFit> {
        let weights = model.weights().clone();
        let one = |(k, input): (usize, &crate::study::BoundInput)| {
            let rmse = weights.rms(k, minimum.residual.as_slice())?;
            let count: usize = weights.series.iter().filter(|s| s.signal == k).map(|s| s.rows.len()).sum();
            let relative = rmse / (model.power(k) / count as f64).sqrt();
            let (name, unit) = (input.name.clone(), input.unit.clone());
            Some(SignalFit { name, unit, rmse, relative, correlation: weights.correlation[k] })
        };
        self.problem.bound.inputs.iter().enumerate().filter_map(one).collect()
    }

    pub(super) fn estimate(
        &self,
        model: &mut dyn WeightedResiduals,
        minimum: &LeastSquaresSolution,
        train: Vec<SignalFit>,
        trajectories: Vec<SignalTrajectory>,
    ) -> ParameterFit {
        let p = self.problem.free.len();
        let series = &model.weights().series.clone();
        let spread = spread(LinearizedEstimate { jacobian: &minimum.jacobian, residual: &minimum.residual, series });
        let (mut covariance, plain, degrees) = (spread.covariance.clone(), &spread.plain, spread.degrees());
        // what nothing is known about has no finite deviation
        let distinct = separate(&without_rest(&minimum.jacobian.tr_mul(&minimum.jacobian), p));
        let hidden = distinct.blind.iter().filter(|b| b.deviation.is_infinite());
        hidden.flat_map(|b| &b.group).for_each(|&j| covariance[(j, j)] = f64::INFINITY);
        let free = self.problem.free.iter().zip(&minimum.z);
        let slope: Vec<f64> = free.clone().map(|(f, &z)| f.slope(z).abs()).collect();
        let deviation = |j: usize| covariance[(j, j)].max(0.0).sqrt();
        let correlation = DMatrix::from_fn(p, p, |i, j| {
            if i == j {
                return 1.0;
            }
            let scale = deviation(i) * deviation(j);
            if scale > 0.0 && scale.is_finite() { covariance[(i, j)] / scale } else { f64::from(u8::from(i == j)) }
        });
        ParameterFit {
            method: self.method(),
            values: free.map(|(f, &z)| f.value(z)).collect(),
            deviations: (0..p).map(|j| slope[j] * deviation(j)).collect(),
            correlation,
            at_bound: minimum.at_bound[..p].to_vec(),
            converged: minimum.converged,
            iterations: minimum.iterations,
            train,
            residuals: Vec::new(),
            trajectories,
            differences: None,
            starts: MultistartSummary::default(),
            joints: None,
            z: minimum.z.clone(),
            spread: (0..p).map(|j| covariance[(j, j)].max(0.0)).collect(),
            plain: (0..p).map(|j| plain[(j, j)].max(0.0)).collect(),
            degrees: degrees[..p].to_vec(),
            cost: minimum.residual.norm_squared(),
            weights: model.weights().clone(),
        }
    }

    /// Tests what is left over.
    pub(super) fn judge_residuals(&self, fit: &ParameterFit, residual: &[f64]) -> Vec<ResidualTest> {
        let bound = self.problem.bound;
        if self.method() == IdentifyMethod::Inverse {
            let all = bound.inputs.iter().enumerate();
            return all
                .filter_map(|(k, input)| ResidualTest::new(&input.name, k, &fit.weights, residual, &[]))
                .collect();
        }
        let one = |(k, signal): (usize, &crate::study::BoundSignal)| {
            let beside = inputs_beside(bound, k, self.train);
            ResidualTest::new(&signal.name, k, &fit.weights, residual, &beside)
        };
        bound.signals.iter().enumerate().filter_map(one).collect()
    }
}

/// How well each signal is met.
pub(super) fn signal_fits(
    problem: &IdentificationProblem<'_>,
    weights: &ResidualWeights,
    residual: &[f64],
    recordings: &[Recording],
) -> Vec<SignalFit> {
    let one = |(k, signal): (usize, &crate::study::BoundSignal)| {
        let rmse = weights.rms(k, residual)?;
        let values: Vec<f64> = recordings.iter().flat_map(|r| &r.signals[k]).copied().filter(|v| !v.is_nan()).collect();
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let spread = (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt();
        let correlation = weights.correlation_time(k, residual);
        let (name, unit) = (signal.name.clone(), signal.unit.clone());
        Some(SignalFit { name, unit, rmse, relative: rmse / spread, correlation })
    };
    problem.bound.signals.iter().enumerate().filter_map(one).collect()
}
