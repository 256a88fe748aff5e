//! A model with hypotheses attached and everything that is free in it: what it leaves of the recordings, and how that
//! depends on what is free.

use super::super::data::RecordingData;
use super::super::policy::{BENT, PIECES};
use super::super::problem::{AssembledModel, HypothesisValues};
use super::exponential;
use super::map::SignalWeights;
use super::simulation::RecordingRun;
use super::start::ParameterisedModel;
use bramah_expr::VarId;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::ops::{ControlFlow, Range};
use std::sync::atomic::{AtomicU64, Ordering};

/// Something that may be chosen: a parameter in its tolerance, a coefficient or shape of an effect.
#[derive(Clone, Debug, PartialEq)]
pub struct FitCoordinate {
    /// Which parameter of the model it is.
    pub parameter: usize,
    /// What is one unit of it: a size of the parameter, or of its logarithm.
    pub scale: f64,
    /// It counts by its logarithm: it may be off by orders of magnitude.
    pub logarithm: bool,
    /// Least value, in units.
    pub low: f64,
    /// Greatest value, in units.
    pub high: f64,
    /// Mean and standard deviation in units, for what is known of it beforehand.
    pub prior: Option<(f64, f64)>,
}

impl FitCoordinate {
    /// A parameter between bounds, by its value.
    pub fn plain(parameter: usize, scale: f64, low: f64, high: f64) -> Self {
        FitCoordinate { parameter, scale, logarithm: false, low: low / scale, high: high / scale, prior: None }
    }

    /// A positive parameter between bounds, by its logarithm.
    pub fn by_logarithm(parameter: usize, low: f64, high: f64) -> Self {
        FitCoordinate { parameter, scale: 1.0, logarithm: true, low: low.ln(), high: high.ln(), prior: None }
    }

    /// The parameter's value.
    pub fn value(&self, x: f64) -> f64 {
        if self.logarithm { x.exp() } else { x * self.scale }
    }

    /// Where a value is, within the bounds.
    pub fn of(&self, value: f64) -> f64 {
        let x = if self.logarithm { value.ln() } else { value / self.scale };
        x.clamp(self.low, self.high)
    }

    /// How far a unit moves the parameter.
    pub fn slope(&self, x: f64) -> f64 {
        if self.logarithm { x.exp() } else { self.scale }
    }

    /// Distance from what is known beforehand, in deviations.
    pub fn distance(&self, x: f64) -> f64 {
        self.prior.map_or(0.0, |(mean, sigma)| (x - mean) / sigma)
    }
}

/// A model with hypotheses attached.
#[derive(Clone, Debug)]
pub struct CandidateModel {
    /// The hypotheses, with the values that are not free.
    pub causes: Vec<HypothesisValues>,
    /// Of so many, the first ones, widths are free.
    pub taken: usize,
    /// The model.
    pub model: AssembledModel,
    /// What is free: tolerances first, then the hypotheses' own in their order.
    pub coordinates: Vec<FitCoordinate>,
    /// How many coordinates without a prior the hypotheses have of their own: widths are not among them.
    pub own: usize,
    /// Per signal its unit, as written.
    pub units: Vec<String>,
    /// Per signal the deviation that counts as one where a recording begins.
    pub deviations: Vec<f64>,
    /// How far the first state of each train recording was from the model's own start where that was found last, in sizes;
    /// nothing where it was not.
    pub off: Vec<Vec<f64>>,
    /// Steps that a simulation of each train recording may take; any number where nothing is said.
    pub allowed: Vec<usize>,
}

/// What a model leaves of one recording: per signal measured minus simulated, of the samples behind the beginning; NaN
/// where nothing was measured.
pub type RecordingResiduals = Vec<Vec<f64>>;

/// Sums over samples of the slopes' products with each other, and with the errors.
#[derive(Clone, Debug)]
pub struct SensitivityProducts {
    /// Slopes with slopes.
    pub slopes: DMatrix<f64>,
    /// Slopes with errors.
    pub errors: DVector<f64>,
}

impl SensitivityProducts {
    /// Sums over no samples.
    pub fn none(width: usize) -> Self {
        SensitivityProducts { slopes: DMatrix::zeros(width, width), errors: DVector::zeros(width) }
    }

    fn add(&mut self, row: &[f64], error: f64) {
        exponential::add_outer(&mut self.slopes, 1.0, row, row);
        self.errors.iter_mut().zip(row).for_each(|(sum, y)| *sum += y * error);
    }

    /// The same with coordinates behind them that nothing depends on.
    pub fn with_idle(self, width: usize) -> Self {
        SensitivityProducts {
            slopes: self.slopes.resize(width, width, 0.0),
            errors: self.errors.resize_vertically(width, 0.0),
        }
    }

    /// By how much squared errors fall in the linear model where the coordinates move like this.
    pub fn gain(&self, change: &DVector<f64>) -> f64 {
        2.0 * self.errors.dot(change) - change.dot(&(&self.slopes * change))
    }

    /// Adds others, weighed.
    pub fn add_weighed(&mut self, other: &SensitivityProducts, weight: f64) {
        self.slopes += &other.slopes * weight;
        self.errors.axpy(weight, &other.errors, 1.0);
    }
}

/// Sums of coordinates in front with all, and of each group behind them with itself.
struct GroupedProducts {
    across: DMatrix<f64>,
    errors: DVector<f64>,
    own: Vec<DMatrix<f64>>,
}

impl GroupedProducts {
    fn none(common: usize, width: usize, groups: &[Range<usize>]) -> Self {
        let own = groups.iter().map(|g| DMatrix::zeros(g.len(), g.len())).collect();
        GroupedProducts { across: DMatrix::zeros(common, width), errors: DVector::zeros(width), own }
    }

    fn add(&mut self, row: &[f64], error: f64, groups: &[Range<usize>]) {
        let common = self.across.nrows();
        exponential::add_outer(&mut self.across, 1.0, &row[..common], row);
        self.errors.iter_mut().zip(row).for_each(|(sum, y)| *sum += error * y);
        for (own, group) in self.own.iter_mut().zip(groups) {
            exponential::add_outer(own, 1.0, &row[group.clone()], &row[group.clone()]);
        }
    }

    /// The sums of one group with what is in front.
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

/// A model at one point: what it leaves of all train recordings, and how that depends on the coordinates.
#[derive(Clone, Debug)]
pub struct ModelEvaluation {
    /// Per recording.
    pub errors: Vec<RecordingResiduals>,
    /// Per recording, piece and signal.
    pub products: Vec<Vec<Vec<SensitivityProducts>>>,
    /// Per recording how far its first state is from the model's own start, in sizes.
    pub off: Vec<Vec<f64>>,
    /// Per recording the steps that the simulation took.
    pub steps: Vec<usize>,
}

/// What came of one recording.
struct RecordingEvaluation {
    errors: RecordingResiduals,
    /// Per piece and signal.
    products: Vec<Vec<SensitivityProducts>>,
    gone: CompletedRun,
}

/// A run that came to its end.
struct CompletedRun {
    /// How far its first state is from the model's own start, in sizes.
    off: Vec<f64>,
    /// Steps that it took.
    steps: usize,
}

impl ModelEvaluation {
    /// Weighed sums over the pieces wanted, by recording and piece.
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

    /// Sums of each signal over all recordings.
    pub fn by_signal(&self, width: usize) -> Vec<SensitivityProducts> {
        let signals = self.errors.first().map_or(0, Vec::len);
        let mut sums = vec![SensitivityProducts::none(width); signals];
        for of_piece in self.products.iter().flatten() {
            sums.iter_mut().zip(of_piece).for_each(|(sum, p)| sum.add_weighed(p, 1.0));
        }
        sums
    }
}

/// The piece of a recording that a counted sample belongs to.
pub fn piece(sample: usize, samples: usize) -> usize {
    (sample * PIECES / samples.max(1)).min(PIECES - 1)
}

impl CandidateModel {
    /// Values of all parameters of the model.
    pub fn theta(&self, x: &[f64]) -> Vec<f64> {
        let mut theta = self.model.theta.clone();
        self.coordinates.iter().zip(x).for_each(|(c, x)| theta[c.parameter] = c.value(*x));
        theta
    }

    /// Where the model's parameters are now.
    pub fn present(&self) -> Vec<f64> {
        self.coordinates.iter().map(|c| c.of(self.model.theta[c.parameter])).collect()
    }

    /// What the prior costs, in squared deviations.
    pub fn prior(&self, x: &[f64]) -> f64 {
        self.coordinates.iter().zip(x).map(|(c, x)| c.distance(*x).powi(2)).sum()
    }

    /// Whether a parameter is off beyond what its tolerance leaves.
    pub fn is_bent(&self, x: &[f64]) -> bool {
        self.coordinates.iter().zip(x).any(|(c, x)| !c.logarithm && c.distance(*x).abs() > BENT)
    }

    /// Values for one recording: parameters of the others are nothing there.
    fn theta_of(&self, x: &[f64], number: Option<usize>) -> Vec<f64> {
        let mut theta = self.theta(x);
        self.model.own.iter().filter(|own| Some(own.1) != number).for_each(|own| theta[own.0] = 0.0);
        theta
    }

    /// What the model leaves of a recording: of the train recordings the `number`-th, or any other. `None` where it does
    /// not reach the end.
    pub fn errors(&self, x: &[f64], recording: &RecordingData, number: Option<usize>) -> Option<RecordingResiduals> {
        let mut errors = vec![Vec::with_capacity(recording.len()); self.deviations.len()];
        self.run(x, recording, number, false, |errors_of, _| {
            errors.iter_mut().zip(errors_of).for_each(|(all, e)| all.push(*e));
            ControlFlow::Continue(())
        })?;
        Some(errors)
    }

    /// What the model leaves of a recording that took no part, where it has values of its own for each recording: each piece
    /// with those that fit the other pieces best. `None` where it does not reach the end.
    pub fn errors_elsewhere(&self, x: &[f64], recording: &RecordingData) -> Option<RecordingResiduals> {
        // the values of the first recording stand for those of this one
        let is_own = |c: &FitCoordinate| self.model.own.contains(&(c.parameter, 0));
        let own: Vec<usize> = (0..x.len()).filter(|&i| is_own(&self.coordinates[i])).collect();
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

    /// Some coordinates where they fit some pieces best, the others as they are.
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

    /// Begins where a model much like it did: states of one name are the same.
    pub fn begins_as(&mut self, other: &CandidateModel) {
        let name = |c: &CandidateModel, v: VarId| c.model.plan.system.dae.variables[v.index()].name.clone();
        let known: BTreeMap<String, usize> =
            other.model.plan.state_variables().enumerate().map(|(i, v)| (name(other, v), i)).collect();
        let places: Vec<_> = self.model.plan.state_variables().map(|v| known.get(&name(self, v)).copied()).collect();
        let guess = |off: &Vec<f64>| places.iter().map(|p| p.map_or(0.0, |i| off[i])).collect();
        self.off = other.off.iter().map(guess).collect();
    }

    /// When the simulation of a train recording stops before its end, s.
    pub fn stops(&self, x: &[f64], recording: &RecordingData) -> Option<f64> {
        let mut sample = recording.settled();
        let ends = self.run(x, recording, None, false, |_, _| {
            sample += 1;
            ControlFlow::Continue(())
        });
        ends.is_none().then(|| recording.times[sample.min(recording.len() - 1)])
    }

    /// What the model leaves of the train recordings. `None` where it does not reach the end of one.
    pub fn all_errors(&self, x: &[f64], train: &[RecordingData]) -> Option<Vec<RecordingResiduals>> {
        train.par_iter().enumerate().map(|(i, r)| self.errors(x, r, Some(i))).collect()
    }

    /// How the simulated signals of a train recording depend on the coordinates: samples by signals by coordinates. `None`
    /// where the model does not reach the end.
    pub fn slopes(&self, x: &[f64], recording: &RecordingData, number: usize) -> Option<Vec<f32>> {
        let mut all = Vec::with_capacity(recording.len() * self.deviations.len() * x.len());
        self.run(x, recording, Some(number), true, |_, slopes| {
            all.extend(slopes.into_iter().flat_map(|s| s.iter()).map(|v| *v as f32));
            ControlFlow::Continue(())
        })?;
        Some(all)
    }

    /// Weighed squares and the prior at a point, as far as they stay within a bound: a run ends where they pass it. `None`
    /// there, and where the model does not reach the end of a recording.
    pub fn cost_within(&self, x: &[f64], train: &[RecordingData], weights: &SignalWeights, bound: f64) -> Option<f64> {
        let limit = ResidualLimit::new(weights, self.prior(x), bound);
        let one = |(number, recording): (usize, &RecordingData)| {
            let mut own = 0.0;
            self.run(x, recording, Some(number), false, |errors, _| limit.count(errors, &mut own))?;
            limit.add(own);
            Some(own)
        };
        let all: Option<Vec<f64>> = train.par_iter().enumerate().map(one).collect();
        // summed in order, so that it does not depend on who came first
        Some(all?.iter().sum::<f64>() + self.prior(x)).filter(|sum| *sum <= bound)
    }

    /// What it leaves of the train recordings, with slopes.
    pub fn evaluate(&self, x: &[f64], train: &[RecordingData]) -> Option<ModelEvaluation> {
        self.evaluated(x, train, None)
    }

    /// The same, as far as weighed squares and the prior stay within a bound: a run ends where they pass it.
    pub fn evaluate_within(
        &self,
        x: &[f64],
        train: &[RecordingData],
        weights: &SignalWeights,
        bound: f64,
    ) -> Option<ModelEvaluation> {
        self.evaluated(x, train, Some(&ResidualLimit::new(weights, self.prior(x), bound)))
    }

    fn evaluated(&self, x: &[f64], train: &[RecordingData], limit: Option<&ResidualLimit>) -> Option<ModelEvaluation> {
        let one = |(i, r): (usize, &RecordingData)| self.evaluate_one(x, r, i, limit);
        let all: Option<Vec<_>> = train.par_iter().enumerate().map(one).collect();
        let mut found =
            ModelEvaluation { errors: Vec::new(), products: Vec::new(), off: Vec::new(), steps: Vec::new() };
        for RecordingEvaluation { errors, products, gone } in all? {
            found.errors.push(errors);
            found.products.push(products);
            found.off.push(gone.off);
            found.steps.push(gone.steps);
        }
        Some(found)
    }

    /// What the model leaves of the `number`-th train recording.
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

    /// Groups of coordinates that are tried one at a time beside those in front of them all: of each the sums with these,
    /// signal by signal. `None` where the model does not reach the end of a recording.
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

    /// Goes through a recording.
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
            // the sample at which the run begins is known
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

/// Weighed squares that runs may come to together.
struct ResidualLimit {
    weight: Vec<f64>,
    bound: f64,
    /// Those of the prior and of runs that have ended.
    gone: AtomicU64,
}

impl ResidualLimit {
    fn new(weights: &SignalWeights, prior: f64, bound: f64) -> Self {
        let weight = (0..weights.square.len()).map(|i| weights.weight(i)).collect();
        ResidualLimit { weight, bound, gone: AtomicU64::new(prior.to_bits()) }
    }

    /// Adds the errors of a sample to what a run has come to; whether it may go on.
    fn count(&self, errors: &[f64], own: &mut f64) -> ControlFlow<()> {
        let squares = errors.iter().zip(&self.weight).filter(|(e, _)| e.is_finite()).map(|(e, w)| w * e * e);
        *own += squares.sum::<f64>();
        let gone = f64::from_bits(self.gone.load(Ordering::Relaxed));
        if gone + *own > self.bound { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    /// Adds what a run came to.
    fn add(&self, own: f64) {
        let add = |sum: u64| (f64::from_bits(sum) + own).to_bits();
        let mut known = self.gone.load(Ordering::Relaxed);
        while let Err(now) = self.gone.compare_exchange_weak(known, add(known), Ordering::Relaxed, Ordering::Relaxed) {
            known = now;
        }
    }
}
