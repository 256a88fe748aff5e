//! A candidate: a model with hypotheses attached, its free coordinates, and its residuals on recordings.
//!
//! Enters: an assembled model with coordinates (from `select::models`) and a point `x`. Leaves: residuals, their
//! sensitivities as sums of products, or only the cost. Recordings are simulated in parallel.
//! Called by `map` (fits), `select::screen` (linear models) and `select::folds` (left-out data).
//!
//! Coordinates are scaled parameters: tolerance parameters in units of their tolerance, coefficients in their typical
//! size, positive shapes by their logarithm. All bounds, priors and sensitivities are in these units.

use super::super::data::RecordingData;
use super::super::problem::{AssembledModel, HypothesisValues};
use super::exponential;
use super::map::SignalWeights;
use super::simulation::RecordingRun;
use super::start::ParameterisedModel;
use crate::policy::{BENT, PIECES};
use bramah_expr::VarId;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::ops::{ControlFlow, Range};
use std::sync::atomic::{AtomicU64, Ordering};

/// A free coordinate of a fit: a parameter within its tolerance, or a coefficient or shape of an effect.
#[derive(Clone, Debug, PartialEq)]
pub struct FitCoordinate {
    /// Index into the parameters of the model's plan.
    pub parameter: usize,
    /// One unit of the coordinate in SI units; 1 for a logarithm.
    pub scale: f64,
    /// The coordinate is the natural logarithm of the parameter, which may be off by orders of magnitude.
    pub logarithm: bool,
    /// Lower bound, in units.
    pub low: f64,
    /// Upper bound, in units.
    pub high: f64,
    /// Mean and standard deviation of the prior, in units; `None` without a prior.
    pub prior: Option<(f64, f64)>,
}

impl FitCoordinate {
    /// A coordinate proportional to its parameter; scale and bounds in SI units.
    pub fn plain(parameter: usize, scale: f64, low: f64, high: f64) -> Self {
        FitCoordinate { parameter, scale, logarithm: false, low: low / scale, high: high / scale, prior: None }
    }

    /// A coordinate that is the logarithm of a positive parameter; bounds in SI units.
    pub fn by_logarithm(parameter: usize, low: f64, high: f64) -> Self {
        FitCoordinate { parameter, scale: 1.0, logarithm: true, low: low.ln(), high: high.ln(), prior: None }
    }

    /// Value of the parameter, SI.
    pub fn value(&self, x: f64) -> f64 {
        if self.logarithm { x.exp() } else { x * self.scale }
    }

    /// Coordinate of a parameter's value, moved into the bounds.
    pub fn of(&self, value: f64) -> f64 {
        let x = if self.logarithm { value.ln() } else { value / self.scale };
        x.clamp(self.low, self.high)
    }

    /// Derivative of the parameter by the coordinate.
    pub fn slope(&self, x: f64) -> f64 {
        if self.logarithm { x.exp() } else { self.scale }
    }

    /// Distance from the mean of the prior, in standard deviations; 0 without a prior.
    pub fn distance(&self, x: f64) -> f64 {
        self.prior.map_or(0.0, |(mean, sigma)| (x - mean) / sigma)
    }
}

/// A model with hypotheses attached and everything that is free in it.
#[derive(Clone, Debug)]
pub struct CandidateModel {
    /// The attached hypotheses with the values of what is not free.
    pub causes: Vec<HypothesisValues>,
    /// Number of causes, from the first, whose widths are free: those of accepted effects.
    pub taken: usize,
    /// The compiled model.
    pub model: AssembledModel,
    /// Free coordinates: tolerance parameters first, then those of the causes in their order.
    pub coordinates: Vec<FitCoordinate>,
    /// Number of the causes' coordinates without a prior, which measures how complex they are. Widths do not count.
    pub own: usize,
    /// Unit of each signal as written.
    pub units: Vec<String>,
    /// Per signal the error that counts as one standard deviation where a recording begins, SI.
    pub deviations: Vec<f64>,
    /// Per train recording the distance of its last initial state from the model's own start, in sizes: the first guess
    /// of the next run. Empty where there was no run yet.
    pub off: Vec<Vec<f64>>,
    /// Per train recording the steps that a simulation may take; empty means any number.
    pub allowed: Vec<usize>,
}

/// Residuals of one recording: per signal measured minus simulated, SI, of the samples behind the beginning; NaN where
/// nothing was measured.
pub type RecordingResiduals = Vec<Vec<f64>>;

/// Sums over samples of products of sensitivities `y` and errors `e`: all that a Gauss-Newton step needs.
#[derive(Clone, Debug)]
pub struct SensitivityProducts {
    /// Sum of y y', coordinates by coordinates.
    pub slopes: DMatrix<f64>,
    /// Sum of y e, per coordinate.
    pub errors: DVector<f64>,
}

impl SensitivityProducts {
    /// Sums over no samples, for `width` coordinates.
    pub fn none(width: usize) -> Self {
        SensitivityProducts { slopes: DMatrix::zeros(width, width), errors: DVector::zeros(width) }
    }

    /// Adds one sample.
    fn add(&mut self, row: &[f64], error: f64) {
        exponential::add_outer(&mut self.slopes, 1.0, row, row);
        self.errors.iter_mut().zip(row).for_each(|(sum, y)| *sum += y * error);
    }

    /// The sums with further coordinates behind, up to `width`, on which nothing depends.
    pub fn with_idle(self, width: usize) -> Self {
        SensitivityProducts {
            slopes: self.slopes.resize(width, width, 0.0),
            errors: self.errors.resize_vertically(width, 0.0),
        }
    }

    /// Decrease of the squared errors in the linear model if the coordinates change by `change`.
    pub fn gain(&self, change: &DVector<f64>) -> f64 {
        2.0 * self.errors.dot(change) - change.dot(&(&self.slopes * change))
    }

    /// Adds other sums times a weight.
    pub fn add_weighed(&mut self, other: &SensitivityProducts, weight: f64) {
        self.slopes += &other.slopes * weight;
        self.errors.axpy(weight, &other.errors, 1.0);
    }
}

/// Sums for groups of coordinates that are tried one at a time: products of the common coordinates in front with all,
/// and of each group with itself. Products between groups are not needed.
struct GroupedProducts {
    /// Common coordinates by all coordinates.
    across: DMatrix<f64>,
    /// Products with the errors, per coordinate.
    errors: DVector<f64>,
    /// Per group its own products.
    own: Vec<DMatrix<f64>>,
}

impl GroupedProducts {
    /// Sums over no samples.
    fn none(common: usize, width: usize, groups: &[Range<usize>]) -> Self {
        let own = groups.iter().map(|g| DMatrix::zeros(g.len(), g.len())).collect();
        GroupedProducts { across: DMatrix::zeros(common, width), errors: DVector::zeros(width), own }
    }

    /// Adds one sample.
    fn add(&mut self, row: &[f64], error: f64, groups: &[Range<usize>]) {
        let common = self.across.nrows();
        exponential::add_outer(&mut self.across, 1.0, &row[..common], row);
        self.errors.iter_mut().zip(row).for_each(|(sum, y)| *sum += error * y);
        for (own, group) in self.own.iter_mut().zip(groups) {
            exponential::add_outer(own, 1.0, &row[group.clone()], &row[group.clone()]);
        }
    }

    /// Sums of the common coordinates and the k-th group, as if there were no others.
    fn of(&self, k: usize, group: &Range<usize>) -> SensitivityProducts {
        let (common, len) = (self.across.nrows(), group.len());
        let mut all = SensitivityProducts::none(common + len);
        let beside = self.across.columns(group.start, len);
        all.slopes.view_mut((0, 0), (common, common)).copy_from(&self.across.columns(0, common));
        all.slopes.view_mut((0, common), (common, len)).copy_from(&beside);
        all.slopes.view_mut((common, 0), (len, common)).copy_from(&beside.transpose());
        all.slopes.view_mut((common, common), (len, len)).copy_from(&self.own[k]);
        all.errors.rows_mut(0, common).copy_from(&self.errors.rows(0, common));
        all.errors.rows_mut(common, len).copy_from(&self.errors.rows(group.start, len));
        all
    }
}

/// Residuals of a model on all train recordings at one point, and their sensitivities as sums of products.
#[derive(Clone, Debug)]
pub struct ModelEvaluation {
    /// Residuals per recording.
    pub errors: Vec<RecordingResiduals>,
    /// Sums of products per recording, piece and signal.
    pub products: Vec<Vec<Vec<SensitivityProducts>>>,
    /// Per recording the distance of its initial state from the model's own start, in sizes.
    pub off: Vec<Vec<f64>>,
    /// Per recording the number of steps of the simulation.
    pub steps: Vec<usize>,
}

/// The same for one recording.
struct RecordingEvaluation {
    /// Its residuals.
    errors: RecordingResiduals,
    /// Sums of products per piece and signal.
    products: Vec<Vec<SensitivityProducts>>,
    /// Initial state and steps.
    gone: CompletedRun,
}

/// What is known of a run that reached its end.
struct CompletedRun {
    /// Distance of its initial state from the model's own start, in sizes.
    off: Vec<f64>,
    /// Number of its steps.
    steps: usize,
}

impl ModelEvaluation {
    /// Weighted sums over signals and over the pieces for which `wanted(recording, piece)` holds.
    pub fn sums(
        &self,
        width: usize,
        weights: &SignalWeights,
        wanted: impl Fn(usize, usize) -> bool,
    ) -> SensitivityProducts {
        let mut sum = SensitivityProducts::none(width);
        for (number, pieces) in self.products.iter().enumerate() {
            for (_, signals) in pieces.iter().enumerate().filter(|(piece, _)| wanted(number, *piece)) {
                signals.iter().enumerate().for_each(|(i, p)| sum.add_weighed(p, weights.weight(i)));
            }
        }
        sum
    }

    /// Sums of each signal over all recordings and pieces, without weights.
    pub fn by_signal(&self, width: usize) -> Vec<SensitivityProducts> {
        let signals = self.errors.first().map_or(0, Vec::len);
        let mut sums = vec![SensitivityProducts::none(width); signals];
        for of_piece in self.products.iter().flatten() {
            sums.iter_mut().zip(of_piece).for_each(|(sum, p)| sum.add_weighed(p, 1.0));
        }
        sums
    }
}

/// The piece of a recording to which a counted sample belongs, out of `samples`.
pub fn piece(sample: usize, samples: usize) -> usize {
    (sample * PIECES / samples.max(1)).min(PIECES - 1)
}

impl CandidateModel {
    /// Values of all parameters of the plan at a point, SI.
    pub fn theta(&self, x: &[f64]) -> Vec<f64> {
        let mut theta = self.model.theta.clone();
        self.coordinates.iter().zip(x).for_each(|(c, x)| theta[c.parameter] = c.value(*x));
        theta
    }

    /// The coordinates of the model's present parameter values, moved into the bounds.
    pub fn present(&self) -> Vec<f64> {
        self.coordinates.iter().map(|c| c.of(self.model.theta[c.parameter])).collect()
    }

    /// Cost of the prior at a point, in squared deviations.
    pub fn prior(&self, x: &[f64]) -> f64 {
        self.coordinates.iter().zip(x).map(|(c, x)| c.distance(*x).powi(2)).sum()
    }

    /// Whether a parameter is more than [`BENT`] tolerances off its data sheet. Widths (logarithms) do not count.
    pub fn is_bent(&self, x: &[f64]) -> bool {
        self.coordinates.iter().zip(x).any(|(c, x)| !c.logarithm && c.distance(*x).abs() > BENT)
    }

    /// Parameter values for the `number`-th train recording: coefficients that belong to other recordings are zero.
    fn theta_of(&self, x: &[f64], number: Option<usize>) -> Vec<f64> {
        let mut theta = self.theta(x);
        self.model.own.iter().filter(|own| Some(own.1) != number).for_each(|own| theta[own.0] = 0.0);
        theta
    }

    /// Residuals of a recording without sensitivities. `number`: its index among the train recordings, `None` for any
    /// other. `None` if the simulation stops early.
    pub fn errors(&self, x: &[f64], recording: &RecordingData, number: Option<usize>) -> Option<RecordingResiduals> {
        let mut errors = vec![Vec::with_capacity(recording.len()); self.deviations.len()];
        self.run(x, recording, number, false, |errors_of, _| {
            errors.iter_mut().zip(errors_of).for_each(|(all, e)| all.push(*e));
            ControlFlow::Continue(())
        })?;
        Some(errors)
    }

    /// Residuals of a recording that took no part, for a model with coefficients per recording.
    /// Each piece is simulated with the coefficients that fit the other pieces best. `None` if the simulation stops
    /// early.
    pub fn errors_elsewhere(&self, x: &[f64], recording: &RecordingData) -> Option<RecordingResiduals> {
        // the coefficients of the first train recording take the place of those of this one
        let is_own = |c: &FitCoordinate| self.model.own.contains(&(c.parameter, 0));
        let own: Vec<usize> = (0..x.len()).filter(|&i| is_own(&self.coordinates[i])).collect();
        // the coefficients of this recording are found by one linear step from zero
        let mut without = x.to_vec();
        own.iter().for_each(|&i| without[i] = self.coordinates[i].of(0.0));
        let RecordingEvaluation { mut errors, products, .. } = self.evaluate_one(&without, recording, 0, None)?;
        let samples = errors.first().map_or(0, Vec::len);
        for k in 0..PIECES {
            let others = products.iter().enumerate().filter(|(piece, _)| *piece != k).map(|(_, signals)| signals);
            let fitted = self.moved(&without, &own, others);
            let found = self.errors(&fitted, recording, Some(0))?;
            for (to, from) in errors.iter_mut().zip(&found) {
                (0..samples).filter(|s| piece(*s, samples) == k).for_each(|s| to[s] = from[s]);
            }
        }
        Some(errors)
    }

    /// The coordinates `x` with the coordinates `own` where the linear model fits the given pieces best.
    fn moved<'a>(
        &self,
        x: &[f64],
        own: &[usize],
        pieces: impl Iterator<Item = &'a Vec<SensitivityProducts>>,
    ) -> Vec<f64> {
        let mut sum = SensitivityProducts::none(x.len());
        for signals in pieces {
            signals.iter().zip(&self.deviations).for_each(|(p, d)| sum.add_weighed(p, d.powi(-2)));
        }
        let seen: Vec<usize> = own.iter().copied().filter(|&i| sum.slopes[(i, i)] > 0.0).collect();
        let information = DMatrix::from_fn(seen.len(), seen.len(), |a, b| sum.slopes[(seen[a], seen[b])]);
        let mut x = x.to_vec();
        if let Some(factor) = information.cholesky() {
            let change = factor.solve(&DVector::from_fn(seen.len(), |a, _| sum.errors[seen[a]]));
            for (a, &i) in seen.iter().enumerate() {
                x[i] = (x[i] + change[a]).clamp(self.coordinates[i].low, self.coordinates[i].high);
            }
        }
        x
    }

    /// Takes over the initial states of another candidate, state by state by name, as the first guess.
    pub fn begins_as(&mut self, other: &CandidateModel) {
        let name = |c: &CandidateModel, v: VarId| c.model.plan.system.dae.variables[v.index()].name.clone();
        let known: BTreeMap<String, usize> =
            other.model.plan.state_variables().enumerate().map(|(i, v)| (name(other, v), i)).collect();
        let places: Vec<_> = self.model.plan.state_variables().map(|v| known.get(&name(self, v)).copied()).collect();
        let guess = |off: &Vec<f64>| places.iter().map(|p| p.map_or(0.0, |i| off[i])).collect();
        self.off = other.off.iter().map(guess).collect();
    }

    /// Time at which the simulation of a recording stops before its end, s; `None` if it reaches the end.
    pub fn stops(&self, x: &[f64], recording: &RecordingData) -> Option<f64> {
        let mut sample = recording.settled();
        let ends = self.run(x, recording, None, false, |_, _| {
            sample += 1;
            ControlFlow::Continue(())
        });
        ends.is_none().then(|| recording.times[sample.min(recording.len() - 1)])
    }

    /// Residuals of all train recordings. `None` if a simulation stops early.
    pub fn all_errors(&self, x: &[f64], train: &[RecordingData]) -> Option<Vec<RecordingResiduals>> {
        train.par_iter().enumerate().map(|(i, r)| self.errors(x, r, Some(i))).collect()
    }

    /// Sensitivities of the simulated signals of a train recording: samples by signals by coordinates, SI per unit.
    /// `None` if the simulation stops early.
    pub fn slopes(&self, x: &[f64], recording: &RecordingData, number: usize) -> Option<Vec<f32>> {
        let mut all = Vec::with_capacity(recording.len() * self.deviations.len() * x.len());
        self.run(x, recording, Some(number), true, |_, slopes| {
            // single precision: these matrices are large, and only corrections and standard deviations use them
            all.extend(slopes.into_iter().flat_map(|s| s.iter()).map(|v| *v as f32));
            ControlFlow::Continue(())
        })?;
        Some(all)
    }

    /// Cost (weighted squares and prior) at a point, without sensitivities.
    /// `None` if it exceeds `bound`, in which case the runs end early, or if a simulation stops early.
    pub fn cost_within(&self, x: &[f64], train: &[RecordingData], weights: &SignalWeights, bound: f64) -> Option<f64> {
        let limit = ResidualLimit::new(weights, self.prior(x), bound);
        let one = |(number, recording): (usize, &RecordingData)| {
            let mut own = 0.0;
            self.run(x, recording, Some(number), false, |errors, _| limit.count(errors, &mut own))?;
            limit.add(own);
            Some(own)
        };
        let all: Option<Vec<f64>> = train.par_iter().enumerate().map(one).collect();
        // summed in the order of the recordings, so that rounding does not depend on the threads
        Some(all?.iter().sum::<f64>() + self.prior(x)).filter(|sum| *sum <= bound)
    }

    /// Residuals and sensitivities on all train recordings. `None` if a simulation stops early.
    pub fn evaluate(&self, x: &[f64], train: &[RecordingData]) -> Option<ModelEvaluation> {
        self.evaluated(x, train, None)
    }

    /// The same while the cost stays within `bound`; `None` also if it exceeds it.
    pub fn evaluate_within(
        &self,
        x: &[f64],
        train: &[RecordingData],
        weights: &SignalWeights,
        bound: f64,
    ) -> Option<ModelEvaluation> {
        self.evaluated(x, train, Some(&ResidualLimit::new(weights, self.prior(x), bound)))
    }

    /// Evaluates all recordings in parallel, within a limit of the cost if there is one.
    fn evaluated(&self, x: &[f64], train: &[RecordingData], limit: Option<&ResidualLimit>) -> Option<ModelEvaluation> {
        let one = |(i, r): (usize, &RecordingData)| self.evaluate_one(x, r, i, limit);
        let all: Option<Vec<_>> = train.par_iter().enumerate().map(one).collect();
        let mut found =
            ModelEvaluation { errors: Vec::new(), products: Vec::new(), off: Vec::new(), steps: Vec::new() };
        // collected in the order of the recordings, whatever the threads did
        for RecordingEvaluation { errors, products, gone } in all? {
            found.errors.push(errors);
            found.products.push(products);
            found.off.push(gone.off);
            found.steps.push(gone.steps);
        }
        Some(found)
    }

    /// Residuals and sensitivities of the `number`-th train recording.
    fn evaluate_one(
        &self,
        x: &[f64],
        recording: &RecordingData,
        number: usize,
        limit: Option<&ResidualLimit>,
    ) -> Option<RecordingEvaluation> {
        let (signals, width) = (self.deviations.len(), self.coordinates.len());
        let samples = recording.len() - recording.settled() - 1;
        let mut errors = vec![Vec::with_capacity(samples); signals];
        let mut sums = vec![vec![SensitivityProducts::none(width); signals]; PIECES];
        let (mut sample, mut cost) = (0, 0.0);
        let gone = self.run(x, recording, Some(number), true, |errors_of, slopes| {
            // sums are kept by piece, so that cross-validation needs no further run
            let into = &mut sums[piece(sample, samples)];
            sample += 1;
            for (i, e) in errors_of.iter().enumerate() {
                errors[i].push(*e);
                if let (true, Some(slopes)) = (e.is_finite(), slopes) {
                    into[i].add(slopes.column(i).as_slice(), *e);
                }
            }
            limit.map_or(ControlFlow::Continue(()), |l| l.count(errors_of, &mut cost))
        })?;
        if let Some(limit) = limit {
            limit.add(cost);
        }
        Some(RecordingEvaluation { errors, products: sums, gone })
    }

    /// Sensitivity products of groups of coordinates that are tried one at a time beside the common ones in front.
    /// Outer index group, inner index signal. `None` if a simulation stops early.
    pub fn groups(
        &self,
        x: &[f64],
        train: &[RecordingData],
        groups: &[Range<usize>],
    ) -> Option<Vec<Vec<SensitivityProducts>>> {
        let common = groups.first().map_or(0, |g| g.start);
        let mut sums: Vec<GroupedProducts> =
            self.deviations.iter().map(|_| GroupedProducts::none(common, x.len(), groups)).collect();
        for (number, recording) in train.iter().enumerate() {
            self.run(x, recording, Some(number), true, |errors_of, slopes| {
                let Some(slopes) = slopes else { return ControlFlow::Continue(()) };
                for (i, (sums, e)) in sums.iter_mut().zip(errors_of).enumerate().filter(|(_, (_, e))| e.is_finite()) {
                    sums.add(slopes.column(i).as_slice(), *e, groups);
                }
                ControlFlow::Continue(())
            })?;
        }
        Some(groups.iter().enumerate().map(|(k, group)| sums.iter().map(|s| s.of(k, group)).collect()).collect())
    }

    /// Runs through a recording; `at` sees the errors of each counted sample and, if `slopes`, the sensitivities of the
    /// signals. First the initial state is estimated from the beginning. `None` if the simulation stops early or `at`
    /// ends it.
    fn run(
        &self,
        x: &[f64],
        recording: &RecordingData,
        number: Option<usize>,
        slopes: bool,
        mut at: impl FnMut(&[f64], Option<&DMatrix<f64>>) -> ControlFlow<()>,
    ) -> Option<CompletedRun> {
        let theta = self.theta_of(x, number);
        let model = &self.model;
        let acts = |c: &FitCoordinate| !model.own.iter().any(|own| own.0 == c.parameter && Some(own.1) != number);
        // a coefficient of another recording has no influence on this one
        let moved = |(c, x): (&FitCoordinate, &f64)| (c.parameter, if acts(c) { c.slope(*x) } else { 0.0 });
        let moves: Vec<(usize, f64)> = self.coordinates.iter().zip(x).map(moved).collect();
        let valued = ParameterisedModel {
            plan: &model.plan,
            theta: &theta,
            sizes: &model.sizes,
            correction: model.correction,
            travel: &model.travel,
            units: &self.units,
            deviations: &self.deviations,
        };
        // the initial state is estimated anew in every run, from the last one as the first guess
        let guess = number.and_then(|k| self.off.get(k));
        let mut begun = valued.begin(recording, guess.map(Vec::as_slice), slopes.then_some(&moves[..]))?;
        let from = recording.settled();
        let mut errors = vec![0.0; self.deviations.len()];
        let allowed = number.and_then(|k| self.allowed.get(k)).copied().unwrap_or(usize::MAX);
        let mut run = RecordingRun {
            local: &mut begun.local,
            theta: &theta,
            sizes: &model.sizes,
            correction: model.correction,
            state: begun.state,
            slopes: begun.slopes,
            left: allowed,
        };
        run.along(recording, from..recording.len(), |k, local, slopes| {
            // the first sample of this run was used for the initial state and does not count
            if k == from {
                return ControlFlow::Continue(());
            }
            let signals = recording.signals.iter().zip(&local.outputs);
            errors.iter_mut().zip(signals).for_each(|(e, (y, simulated))| *e = y[k] - simulated);
            at(&errors, slopes)
        })?;
        Some(CompletedRun { off: begun.off, steps: allowed - run.left })
    }
}

/// A bound of the cost that parallel runs must not exceed together.
struct ResidualLimit {
    /// Weight of a squared error, per signal.
    weight: Vec<f64>,
    /// Cost that must not be exceeded.
    bound: f64,
    /// Cost of the prior and of the runs that have ended, as the bits of an `f64`.
    gone: AtomicU64,
}

impl ResidualLimit {
    /// For given weights, a cost of the prior and a bound.
    fn new(weights: &SignalWeights, prior: f64, bound: f64) -> Self {
        let weight = (0..weights.square.len()).map(|i| weights.weight(i)).collect();
        ResidualLimit { weight, bound, gone: AtomicU64::new(prior.to_bits()) }
    }

    /// Adds the errors of one sample to the cost `own` of a run. `Break` if the bound is exceeded.
    fn count(&self, errors: &[f64], own: &mut f64) -> ControlFlow<()> {
        let squares = errors.iter().zip(&self.weight).filter(|(e, _)| e.is_finite()).map(|(e, w)| w * e * e);
        *own += squares.sum::<f64>();
        let gone = f64::from_bits(self.gone.load(Ordering::Relaxed));
        if gone + *own > self.bound { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    /// Adds the cost of a run that has ended.
    fn add(&self, own: f64) {
        // there is no atomic sum of f64, hence the loop over the bits
        let add = |sum: u64| (f64::from_bits(sum) + own).to_bits();
        let mut known = self.gone.load(Ordering::Relaxed);
        while let Err(now) = self.gone.compare_exchange_weak(known, add(known), Ordering::Relaxed, Ordering::Relaxed) {
            known = now;
        }
    }
}
