//! A model with hypotheses attached and everything that is free in it: what it leaves of the recordings, and how that
//! depends on what is free.

use super::super::data::Recording;
use super::super::policy::PIECES;
use super::super::problem::{Assembled, Chosen};
use super::super::step;
use super::map::Weights;
use super::simulation::Course;
use super::start::Valued;
use nalgebra::{DMatrix, DVector};
use std::ops::Range;

/// Something that may be chosen: a parameter in its tolerance, a coefficient or shape of an effect.
#[derive(Clone, Debug, PartialEq)]
pub struct Coordinate {
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

impl Coordinate {
    /// A parameter between bounds, by its value.
    pub fn plain(parameter: usize, scale: f64, low: f64, high: f64) -> Self {
        Coordinate { parameter, scale, logarithm: false, low: low / scale, high: high / scale, prior: None }
    }

    /// A positive parameter between bounds, by its logarithm.
    pub fn by_logarithm(parameter: usize, low: f64, high: f64) -> Self {
        Coordinate { parameter, scale: 1.0, logarithm: true, low: low.ln(), high: high.ln(), prior: None }
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
pub struct Candidate {
    /// The hypotheses, with the values that are not free.
    pub causes: Vec<Chosen>,
    /// The model.
    pub model: Assembled,
    /// What is free: tolerances first, then the hypotheses' own in their order.
    pub coordinates: Vec<Coordinate>,
    /// How many coordinates the hypotheses have of their own.
    pub own: usize,
    /// Per signal its unit, as written.
    pub units: Vec<String>,
    /// Per signal the deviation that counts as one where a recording begins.
    pub deviations: Vec<f64>,
}

/// What a model leaves of one recording: per signal measured minus simulated, of the samples behind the beginning; NaN
/// where nothing was measured.
pub type Errors = Vec<Vec<f64>>;

/// Sums over samples of the slopes' products with each other, and with the errors.
#[derive(Clone, Debug)]
pub struct Products {
    /// Slopes with slopes.
    pub slopes: DMatrix<f64>,
    /// Slopes with errors.
    pub errors: DVector<f64>,
}

impl Products {
    /// Sums over no samples.
    pub fn none(width: usize) -> Self {
        Products { slopes: DMatrix::zeros(width, width), errors: DVector::zeros(width) }
    }

    fn add(&mut self, row: &[f64], error: f64) {
        step::add_outer(&mut self.slopes, 1.0, row, row);
        self.errors.iter_mut().zip(row).for_each(|(sum, y)| *sum += y * error);
    }

    /// The same with coordinates behind them that nothing depends on.
    pub fn with_idle(self, width: usize) -> Self {
        Products { slopes: self.slopes.resize(width, width, 0.0), errors: self.errors.resize_vertically(width, 0.0) }
    }

    /// Adds others, weighed.
    pub fn add_weighed(&mut self, other: &Products, weight: f64) {
        self.slopes += &other.slopes * weight;
        self.errors.axpy(weight, &other.errors, 1.0);
    }
}

/// A model at one point: what it leaves of all train recordings, and how that depends on the coordinates.
#[derive(Clone, Debug)]
pub struct Evaluated {
    /// Per recording.
    pub errors: Vec<Errors>,
    /// Per recording, piece and signal.
    pub products: Vec<Vec<Vec<Products>>>,
}

/// The piece of a recording that a counted sample belongs to.
pub fn piece(sample: usize, samples: usize) -> usize {
    (sample * PIECES / samples.max(1)).min(PIECES - 1)
}

impl Candidate {
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

    /// Values for one recording: parameters of the others are nothing there.
    fn theta_of(&self, x: &[f64], number: Option<usize>) -> Vec<f64> {
        let mut theta = self.theta(x);
        self.model.own.iter().filter(|own| Some(own.1) != number).for_each(|own| theta[own.0] = 0.0);
        theta
    }

    /// What the model leaves of a recording: of the train recordings the `number`-th, or any other. `None` where it does
    /// not reach the end.
    pub fn errors(&self, x: &[f64], recording: &Recording, number: Option<usize>) -> Option<Errors> {
        let mut errors = vec![Vec::with_capacity(recording.len()); self.deviations.len()];
        self.run(x, recording, number, false, |errors_of, _| {
            errors.iter_mut().zip(errors_of).for_each(|(all, e)| all.push(*e));
        })?;
        Some(errors)
    }

    /// What the model leaves of the train recordings. `None` where it does not reach the end of one.
    pub fn all_errors(&self, x: &[f64], train: &[Recording]) -> Option<Vec<Errors>> {
        train.iter().enumerate().map(|(i, r)| self.errors(x, r, Some(i))).collect()
    }

    /// The same with slopes.
    pub fn evaluate(&self, x: &[f64], train: &[Recording]) -> Option<Evaluated> {
        let (mut errors, mut products) = (Vec::new(), Vec::new());
        let (signals, width) = (self.deviations.len(), self.coordinates.len());
        for (number, recording) in train.iter().enumerate() {
            let samples = recording.len() - recording.settled() - 1;
            let mut own = vec![Vec::with_capacity(samples); signals];
            let mut sums = vec![vec![Products::none(width); signals]; PIECES];
            let mut sample = 0;
            self.run(x, recording, Some(number), true, |errors_of, slopes| {
                let into = &mut sums[piece(sample, samples)];
                sample += 1;
                for (i, e) in errors_of.iter().enumerate() {
                    own[i].push(*e);
                    if let (true, Some(slopes)) = (e.is_finite(), slopes) {
                        into[i].add(slopes.column(i).as_slice(), *e);
                    }
                }
            })?;
            errors.push(own);
            products.push(sums);
        }
        Some(Evaluated { errors, products })
    }

    /// Groups of coordinates that are tried one at a time beside those in front of them all: of each the weighed sums with
    /// these. `None` where the model does not reach the end of a recording.
    pub fn groups(
        &self,
        x: &[f64],
        train: &[Recording],
        weights: &Weights,
        groups: &[Range<usize>],
    ) -> Option<Vec<Products>> {
        let (common, width) = (groups.first().map_or(0, |g| g.start), x.len());
        let mut across = DMatrix::zeros(common, width);
        let mut errors = DVector::zeros(width);
        let mut own: Vec<Products> = groups.iter().map(|g| Products::none(g.len())).collect();
        for (number, recording) in train.iter().enumerate() {
            self.run(x, recording, Some(number), true, |errors_of, slopes| {
                let Some(slopes) = slopes else { return };
                for (i, e) in errors_of.iter().enumerate().filter(|(_, e)| e.is_finite()) {
                    let (row, weight) = (slopes.column(i), weights.weight(i));
                    step::add_outer(&mut across, weight, &row.as_slice()[..common], row.as_slice());
                    errors.axpy(weight * e, &row, 1.0);
                    for (own, group) in own.iter_mut().zip(groups) {
                        let row = &row.as_slice()[group.clone()];
                        step::add_outer(&mut own.slopes, weight, row, row);
                    }
                }
            })?;
        }
        let joined = |(own, group): (&Products, &Range<usize>)| {
            let mut all = Products::none(common + group.len());
            let beside = across.columns(group.start, group.len());
            all.slopes.view_mut((0, 0), (common, common)).copy_from(&across.columns(0, common));
            all.slopes.view_mut((0, common), beside.shape()).copy_from(&beside);
            all.slopes.view_mut((common, 0), (group.len(), common)).copy_from(&beside.transpose());
            all.slopes.view_mut((common, common), own.slopes.shape()).copy_from(&own.slopes);
            all.errors.rows_mut(0, common).copy_from(&errors.rows(0, common));
            all.errors.rows_mut(common, group.len()).copy_from(&errors.rows(group.start, group.len()));
            all
        };
        Some(own.iter().zip(groups).map(joined).collect())
    }

    fn run(
        &self,
        x: &[f64],
        recording: &Recording,
        number: Option<usize>,
        slopes: bool,
        mut at: impl FnMut(&[f64], Option<&DMatrix<f64>>),
    ) -> Option<()> {
        let theta = self.theta_of(x, number);
        let model = &self.model;
        let acts = |c: &Coordinate| !model.own.iter().any(|own| own.0 == c.parameter && Some(own.1) != number);
        let moved = |(c, x): (&Coordinate, &f64)| (c.parameter, if acts(c) { c.slope(*x) } else { 0.0 });
        let moves: Vec<(usize, f64)> = self.coordinates.iter().zip(x).map(moved).collect();
        let valued = Valued {
            plan: &model.plan,
            theta: &theta,
            sizes: &model.sizes,
            travel: &model.travel,
            units: &self.units,
            deviations: &self.deviations,
        };
        let mut begun = valued.begin(recording, slopes.then_some(&moves[..]))?;
        let from = recording.settled();
        let mut errors = vec![0.0; self.deviations.len()];
        let mut course = Course {
            local: &mut begun.local,
            theta: &theta,
            sizes: &model.sizes,
            state: begun.state,
            slopes: begun.slopes,
        };
        course.run(recording, from..recording.len(), |k, local, slopes| {
            // the sample at which the run begins is known
            if k == from {
                return;
            }
            let signals = recording.signals.iter().zip(&local.outputs);
            errors.iter_mut().zip(signals).for_each(|(e, (y, simulated))| *e = y[k] - simulated);
            at(&errors, slopes);
        })
    }
}
