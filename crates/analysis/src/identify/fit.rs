//! The result of a fit: values, their uncertainty, and the errors of each signal.
//!
//! A minimum of the least squares enters ([`LeastSquaresSolution`]); a [`ParameterFit`] leaves, which reports, pictures
//! and profiles read. The covariance comes from `crate::estimate::spread`, which models the errors of each signal as
//! autoregressive.

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

/// The result of a fit. Vectors are in the order of [`IdentificationProblem::free`].
#[derive(Clone, Debug)]
pub struct ParameterFit {
    /// The method used: [`IdentifyMethod::Output`] or [`IdentifyMethod::Inverse`].
    pub method: IdentifyMethod,
    /// Estimates in the parameters' units.
    pub values: Vec<f64>,
    /// One standard deviation of each, in its unit; infinite where the data carry no information.
    pub deviations: Vec<f64>,
    /// Degrees of freedom of each deviation (Satterthwaite); few where errors are correlated over many samples.
    pub degrees: Vec<f64>,
    /// Correlations of the estimates, p by p.
    pub correlation: DMatrix<f64>,
    /// Whether each parameter ended at a bound.
    pub at_bound: Vec<bool>,
    /// False when the search stopped before it reached a minimum, or when pieces of recordings do not join.
    pub converged: bool,
    /// Iterations of Levenberg-Marquardt over all rounds.
    pub iterations: usize,
    /// The errors on the train recordings, one entry for each signal (or input, for the inverse model).
    pub train: Vec<SignalFit>,
    /// Whiteness and cross-correlation tests of the errors on the train recordings, one for each signal or input.
    pub residuals: Vec<ResidualTest>,
    /// Measured and modelled values of each signal along the first train recording.
    pub trajectories: Vec<SignalTrajectory>,
    /// The reason why some derivatives were finite differences; `None` where sensitivities were integrated everywhere.
    pub differences: Option<String>,
    /// How the searches from several places ended.
    pub starts: MultistartSummary,
    /// The jumps left between pieces of recordings; `None` where none is cut.
    pub joints: Option<ContinuityDefects>,
    /// All unknowns at the minimum: parameters in z, then initial states.
    pub(super) z: Vec<f64>,
    /// Variances of the parameters in z, corrected for correlated errors.
    pub(super) spread: Vec<f64>,
    /// Variances of the parameters in z if the errors were white: the diagonal of (J'J)^-1.
    pub(super) plain: Vec<f64>,
    /// The weighted sum of squares at the minimum.
    pub(super) cost: f64,
    /// The weights of the rows at the minimum.
    pub(super) weights: ResidualWeights,
}

/// Measured and modelled values of a signal along a recording. All vectors have the same length.
#[derive(Clone, Debug, PartialEq)]
pub struct SignalTrajectory {
    /// The signal's name; for the inverse model the input's.
    pub name: String,
    /// Unit of `measured` and `errors`.
    pub unit: String,
    /// Times of the samples in seconds.
    pub times: Vec<f64>,
    /// Measured values.
    pub measured: Vec<f64>,
    /// Model minus measurement.
    pub errors: Vec<f64>,
}

impl ParameterFit {
    /// The 95 % confidence interval of a parameter, in its unit.
    ///
    /// It is symmetric in z: on a logarithmic scale it is a factor around the value. Its ends are infinite where the
    /// data carry no information.
    pub fn interval(&self, problem: &IdentificationProblem<'_>, parameter: usize) -> (f64, f64) {
        let (free, z) = (&problem.free[parameter], self.z[parameter]);
        let half = student(self.degrees[parameter]) * self.spread[parameter].sqrt();
        (free.value(z - half), free.value(z + half))
    }
}

/// The errors of one signal over some recordings.
#[derive(Clone, Debug, PartialEq)]
pub struct SignalFit {
    /// The signal's name; for the inverse model the input's.
    pub name: String,
    /// Unit of `rmse`.
    pub unit: String,
    /// Root mean square of the errors.
    pub rmse: f64,
    /// `rmse` over the signal's standard deviation; for forces over their root mean square.
    pub relative: f64,
    /// Over how many samples neighbouring errors are correlated; 1 for white errors.
    pub correlation: f64,
}

impl Identification<'_> {
    /// The errors of each measured force, from a residual of the inverse model.
    pub(super) fn force_fits(&self, model: &mut InverseModel<'_>, minimum: &LeastSquaresSolution) -> Vec<SignalFit> {
        let weights = model.weights().clone();
        let one = |(k, input): (usize, &crate::study::BoundInput)| {
            let rmse = weights.rms(k, minimum.residual.as_slice())?;
            let count: usize = weights.series.iter().filter(|s| s.signal == k).map(|s| s.rows.len()).sum();
            // Forces are compared with their root mean square about zero, because a force of zero has a meaning.
            let relative = rmse / (model.power(k) / count as f64).sqrt();
            let (name, unit) = (input.name.clone(), input.unit.clone());
            Some(SignalFit { name, unit, rmse, relative, correlation: weights.correlation[k] })
        };
        self.problem.bound.inputs.iter().enumerate().filter_map(one).collect()
    }

    /// Estimates the uncertainty at a minimum and puts the result together.
    ///
    /// Fields that only one method fills (`residuals`, `differences`, `starts`, `joints`) are left empty for the
    /// caller.
    pub(super) fn estimate(
        &self,
        model: &mut dyn WeightedResiduals,
        minimum: &LeastSquaresSolution,
        train: Vec<SignalFit>,
        trajectories: Vec<SignalTrajectory>,
    ) -> ParameterFit {
        let p = self.problem.free.len();
        let series = &model.weights().series.clone();
        // The covariance of all unknowns, corrected for correlated errors of each signal.
        let spread = spread(LinearizedEstimate { jacobian: &minimum.jacobian, residual: &minimum.residual, series });
        let (mut covariance, plain, degrees) = (spread.covariance.clone(), &spread.plain, spread.degrees());
        // J'J may be singular up to rounding; its inverse would then report a finite deviation for what nobody can
        // know.
        let distinct = separate(&without_rest(&minimum.jacobian.tr_mul(&minimum.jacobian), p));
        let hidden = distinct.blind.iter().filter(|b| b.deviation.is_infinite());
        hidden.flat_map(|b| &b.group).for_each(|&j| covariance[(j, j)] = f64::INFINITY);
        let free = self.problem.free.iter().zip(&minimum.z);
        // Deviations in a parameter's unit are those in z times d value/dz (delta method).
        let slope: Vec<f64> = free.clone().map(|(f, &z)| f.slope(z).abs()).collect();
        let deviation = |j: usize| covariance[(j, j)].max(0.0).sqrt();
        // Of an infinite deviation no correlation is known: 0.
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

    /// Tests the residuals of each signal for whiteness, and for correlation with the inputs (output error only).
    pub(super) fn judge_residuals(&self, fit: &ParameterFit, residual: &[f64]) -> Vec<ResidualTest> {
        let bound = self.problem.bound;
        if self.method() == IdentifyMethod::Inverse {
            // The inputs are the measured forces here, and the residual contains them: a correlation would say nothing.
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

/// The errors of each signal over `recordings`; signals without a sample are left out.
pub(super) fn signal_fits(
    problem: &IdentificationProblem<'_>,
    weights: &ResidualWeights,
    residual: &[f64],
    recordings: &[Recording],
) -> Vec<SignalFit> {
    let one = |(k, signal): (usize, &crate::study::BoundSignal)| {
        let rmse = weights.rms(k, residual)?;
        let values: Vec<f64> = recordings.iter().flat_map(|r| &r.signals[k]).copied().filter(|v| !v.is_nan()).collect();
        // Population deviation of all samples together: the error of the best constant.
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let spread = (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt();
        let correlation = weights.correlation_time(k, residual);
        let (name, unit) = (signal.name.clone(), signal.unit.clone());
        Some(SignalFit { name, unit, rmse, relative: rmse / spread, correlation })
    };
    problem.bound.signals.iter().enumerate().filter_map(one).collect()
}
