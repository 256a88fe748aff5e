//! Inverse model: the force that the measured motion needs, compared with the measured force.
//!
//! Recordings of a mechanical system enter; force errors and their Jacobian leave, for [`super::minimise`]. It applies
//! where all inputs are measured forces or torques, and each state is a signal or the derivative of one. No run is
//! needed: states and accelerations come from filtered signals, and the equations of motion are solved for the force.
//!
//! Errors and derivatives pass the same low-pass and are thinned (parallel filter), so that noise above the band of the
//! motion does not bias the result. Source: M. Gautier, Dynamic identification of robots with power model, ICRA 1997;
//! A. Janot, P.-O. Vandanjon, M. Gautier, IEEE Trans. CST 22 (2014) 132.

use super::filter::{LowPass, derivative, filled};
use super::least_squares::LeastSquares;
use super::weights::ResidualWeights;
use super::{IdentificationProblem, SignalTrajectory, WeightedResiduals};
use crate::estimate::ResidualSeries;
use crate::local::EvaluationPlan;
use crate::study::Recording;
use crate::{LocalEvaluator, lift};
use bramah_expr::VarId;
use bramah_expr::units::{Dimension, MeasurementUnit};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use std::sync::Arc;

/// Where the values of a state come from.
#[derive(Clone, Copy, Debug, PartialEq)]
enum StateSource {
    /// The signal with this index, divided by a factor.
    Signal(usize, f64),
    /// The time derivative of the state with this index.
    Rate(usize),
}

/// How to compute the states and forces of a model from its signals.
#[derive(Clone, Debug)]
pub struct ModelInversion {
    /// The equations, lifted by the estimated parameters, with the signals as outputs.
    plan: Arc<EvaluationPlan>,
    /// The source of each state, in the order of the plan's states.
    origins: Vec<StateSource>,
    /// The states in an order in which each stands behind the one that it is derived from.
    order: Vec<usize>,
    /// States whose rates the inputs determine: the velocities. There are as many as inputs.
    driven: Vec<usize>,
    /// For each input of the plan its index among the inputs of the study.
    inputs: Vec<usize>,
}

impl ModelInversion {
    /// Finds out how to invert the model.
    ///
    /// `None` where an input is no force or torque, where an input of the model is not recorded, or where a state is
    /// neither a signal nor the derivative of one.
    pub fn new(problem: &IdentificationProblem<'_>) -> Option<ModelInversion> {
        let bound = problem.bound;
        let force =
            |unit: &str| MeasurementUnit::parse(unit).is_ok_and(|u| u.dimension == FORCE || u.dimension == TORQUE);
        if bound.inputs.is_empty() || !bound.inputs.iter().all(|i| force(&i.unit)) {
            return None;
        }
        let parameters: Vec<VarId> = problem.free.iter().map(|f| f.variable).collect();
        let outputs: Vec<VarId> = bound.signals.iter().map(|s| s.variable).collect();
        let plan = Arc::new(EvaluationPlan::new(&lift(&problem.model.flat, &parameters, &outputs)).ok()?);
        let mut inverse = ModelInversion {
            order: Vec::new(),
            driven: Vec::new(),
            inputs: plan_inputs(problem)?,
            origins: vec![StateSource::Rate(usize::MAX); plan.states()],
            plan,
        };
        inverse.find_origins(problem)?;
        (inverse.driven.len() == inverse.inputs.len()).then_some(inverse)
    }

    /// Reads from the Jacobian which states are signals and which are derivatives of other states.
    ///
    /// Two points are compared, so that a coefficient that only happens to be the same at one point does not count.
    /// `None` where the source of a state remains unknown.
    fn find_origins(&mut self, problem: &IdentificationProblem<'_>) -> Option<()> {
        let n = self.plan.states();
        let theta: Vec<f64> = problem.free.iter().map(|f| f.start).collect();
        let u = vec![0.0; self.inputs.len()];
        let mut local = LocalEvaluator::start(self.plan.clone(), 0.0, &theta, &u).ok()?;
        let (x0, nominals) = (local.state(), local.nominals());
        // Both points lie off the start, where the derivatives of nonlinear terms often vanish.
        let mut points = Vec::new();
        for shift in [0.01, 0.037] {
            let x: Vec<f64> = x0.iter().zip(&nominals).map(|(x, n)| x + shift * n).collect();
            local.linearize(0.0, &x, &theta, &u).ok()?;
            points.push(local.linear.clone());
        }
        // An output y = a x of one state alone makes that state a signal.
        let mut known = vec![false; n];
        for s in 0..problem.bound.signals.len() {
            let lone = points.iter().map(|p| lone(p.c.row(s).iter(), p.d.row(s).iter())).collect::<Option<Vec<_>>>();
            if let Some([(i, a), (j, b)]) = lone.as_deref()
                && i == j
                && a == b
                && !known[*i]
            {
                known[*i] = true;
                self.origins[*i] = StateSource::Signal(s, *a);
                self.order.push(*i);
            }
        }
        // A rate x' = z of one state alone makes z the derivative of x. `order` grows while it is walked, so
        // derivatives of derivatives are found too.
        let mut defines = vec![false; n];
        let mut at = 0;
        while at < self.order.len() {
            let row = self.order[at];
            let lone =
                points.iter().map(|p| lone(p.a.row(row).iter(), p.b.row(row).iter())).collect::<Option<Vec<_>>>();
            if let Some([(i, a), (j, b)]) = lone.as_deref()
                && i == j
                && *a == 1.0
                && *b == 1.0
            {
                defines[row] = true;
                if !known[*i] {
                    known[*i] = true;
                    self.origins[*i] = StateSource::Rate(row);
                    self.order.push(*i);
                }
            }
            at += 1;
        }
        // Rates that define no other state are equations of motion.
        self.driven = (0..n).filter(|&i| !defines[i]).collect();
        known.iter().all(|k| *k).then_some(())
    }

    /// The derivatives of the driven rates by the inputs, square.
    fn force_matrix(&self, b: &DMatrix<f64>, parameters: usize) -> DMatrix<f64> {
        DMatrix::from_fn(self.driven.len(), self.inputs.len(), |i, k| b[(self.driven[i], parameters + k)])
    }
}

/// Dimension of a force, kg m s^-2.
const FORCE: Dimension = Dimension::new([1, 1, -2, 0, 0, 0, 0]);
/// Dimension of a torque, kg m^2 s^-2.
const TORQUE: Dimension = Dimension::new([1, 2, -2, 0, 0, 0, 0]);

/// For each input of the model, in declaration order, its index in the study; `None` where one is not recorded.
fn plan_inputs(problem: &IdentificationProblem<'_>) -> Option<Vec<usize>> {
    let all = (0..).map(VarId).zip(&problem.model.flat.variables).filter(|(_, v)| v.input);
    all.map(|(v, _)| problem.bound.inputs.iter().position(|i| i.variable == v)).collect()
}

/// The only nonzero entry of a row and its place; `None` where the row has another number of them, or where `others`
/// holds one.
fn lone<'v>(row: impl Iterator<Item = &'v f64>, mut others: impl Iterator<Item = &'v f64>) -> Option<(usize, f64)> {
    let mut entries = row.enumerate().filter(|(_, v)| **v != 0.0);
    let (i, v) = entries.next()?;
    (entries.next().is_none() && others.all(|v| *v == 0.0)).then_some((i, *v))
}

/// The motion of one recording, with all columns as long as `times`.
struct RecordedMotion {
    /// Times of the samples in seconds.
    times: Vec<f64>,
    /// One column for each state, in the order of the plan.
    states: Vec<Vec<f64>>,
    /// One column for each driven state: its measured rate.
    rates: Vec<Vec<f64>>,
    /// One column for each input: the measured force.
    forces: Vec<Vec<f64>>,
    /// The parallel filter.
    low_pass: LowPass,
    /// One of so many samples remains after thinning.
    stride: usize,
    /// Samples left out at both ends, where the filter has transients.
    margin: usize,
}

/// Corner of the low-pass for the signals, as a fraction of the sampling rate.
const SIGNAL_CORNER: f64 = 0.1;
/// The parallel filter passes the band that holds this share of the force's variance.
const POWER: f64 = 0.99;

/// The force-error problem along some recordings. Its unknowns are the parameters alone.
pub struct InverseModel<'a> {
    /// The model, its study and the parameters to estimate.
    problem: &'a IdentificationProblem<'a>,
    /// How to compute states and forces.
    inverse: &'a ModelInversion,
    /// The recordings, filtered.
    motions: Vec<RecordedMotion>,
    /// The deviation of each force, and the rows of each series.
    weights: ResidualWeights,
    /// Measured forces, filtered and thinned, in the order of the residual.
    measured: Vec<f64>,
}

impl<'a> InverseModel<'a> {
    /// Filters the recordings. `None` where one is too short.
    pub fn new(
        problem: &'a IdentificationProblem<'a>,
        inverse: &'a ModelInversion,
        recordings: &[Recording],
    ) -> Option<Self> {
        let motions: Vec<RecordedMotion> = recordings.iter().map(|r| motion(inverse, r)).collect::<Option<_>>()?;
        let mut measured = Vec::new();
        let mut series = Vec::new();
        for (recording, motion) in motions.iter().enumerate() {
            for (signal, forces) in motion.forces.iter().enumerate() {
                let start = measured.len();
                measured.extend(motion.thin(forces));
                series.push(ResidualSeries { recording, signal, rows: start..measured.len() });
            }
        }
        // Deviations of 1 until `search` learns them from the errors at the start.
        let weights = ResidualWeights::new(series, vec![1.0; inverse.inputs.len()]);
        Some(InverseModel { problem, inverse, motions, weights, measured })
    }

    /// The sum of squares of the measured force of one input.
    pub fn power(&self, input: usize) -> f64 {
        let of = self.weights.series.iter().filter(|s| s.signal == input);
        of.flat_map(|s| &self.measured[s.rows.clone()]).map(|f| f * f).sum()
    }

    /// Measured and modelled forces along the first recording, from a residual of this problem.
    pub fn trajectories(&self, residual: &[f64]) -> Vec<SignalTrajectory> {
        let one = |s: &ResidualSeries| {
            let input = &self.problem.bound.inputs[self.inverse.inputs[s.signal]];
            let sigma = self.weights.sigma[s.signal];
            SignalTrajectory {
                name: input.name.clone(),
                unit: input.unit.clone(),
                times: self.motions[0].thin_times(),
                measured: self.measured[s.rows.clone()].to_vec(),
                errors: residual[s.rows.clone()].iter().map(|r| r * sigma).collect(),
            }
        };
        self.weights.series.iter().filter(|s| s.recording == 0).map(one).collect()
    }

    /// Filtered and thinned force errors of all recordings, in the forces' units.
    ///
    /// `None` where more than half the samples of a recording determine no force.
    fn errors(&self, theta: &[f64]) -> Option<Vec<f64>> {
        let mut out = Vec::new();
        for motion in &self.motions {
            for column in self.raw_errors(motion, theta)? {
                let found = column.iter().filter(|v| v.is_finite()).count();
                if found < column.len() / 2 {
                    return None;
                }
                // Samples without a force are bridged by straight lines, because the filter needs all samples.
                out.extend(motion.thin(&filled(&column)));
            }
        }
        Some(out)
    }

    /// The force that the motion needs minus the measured one, one column for each input.
    ///
    /// NaN where the equations determine no force, as where friction holds a mass.
    fn raw_errors(&self, motion: &RecordedMotion, theta: &[f64]) -> Option<Vec<Vec<f64>>> {
        let (n, k) = (motion.states.len(), motion.forces.len());
        let mut columns = vec![vec![f64::NAN; motion.times.len()]; k];
        let (mut x, mut u) = (vec![0.0; n], vec![0.0; k]);
        let mut local = LocalEvaluator::start(self.inverse.plan.clone(), motion.times[0], theta, &u).ok()?;
        for (t, &time) in motion.times.iter().enumerate() {
            x.iter_mut().zip(&motion.states).for_each(|(x, s)| *x = s[t]);
            u.iter_mut().zip(&motion.forces).for_each(|(u, f)| *u = f[t]);
            if local.linearize(time, &x, theta, &u).is_err() {
                continue;
            }
            // rate(measured) - rate(equations with the measured force): what a further force has to add.
            let lacks = DVector::from_iterator(
                k,
                self.inverse.driven.iter().zip(&motion.rates).map(|(&i, rate)| rate[t] - local.rates[i]),
            );
            // Solving the linearised equations is exact where the rates are affine in the forces.
            let acts = self.inverse.force_matrix(&local.linear.b, theta.len());
            if let Some(error) = acts.lu().solve(&lacks).filter(|e| e.iter().all(|v| v.is_finite())) {
                columns.iter_mut().zip(error.iter()).for_each(|(c, e)| c[t] = *e);
            }
        }
        Some(columns)
    }
}

impl LeastSquares for InverseModel<'_> {
    fn residual(&mut self, z: &[f64]) -> Option<DVector<f64>> {
        let mut all = self.errors(&values(self.problem, z))?;
        self.weights.scale(&mut all);
        all.extend(self.problem.priors(z));
        Some(DVector::from_vec(all))
    }

    /// By forward differences: the force is affine or nearly so in most parameters.
    fn jacobian(&mut self, z: &[f64], residual: &DVector<f64>) -> Option<DMatrix<f64>> {
        let this = &*self;
        let columns: Option<Vec<Vec<f64>>> = (0..z.len())
            .into_par_iter()
            .map(|j| {
                let mut moved = z.to_vec();
                moved[j] += STEP;
                let mut column = this.errors(&values(this.problem, &moved))?;
                this.weights.scale(&mut column);
                Some(column)
            })
            .collect();
        let mut jacobian = DMatrix::zeros(residual.len(), z.len());
        for (j, column) in columns?.iter().enumerate() {
            for (i, value) in column.iter().enumerate() {
                jacobian[(i, j)] = (value - residual[i]) / STEP;
            }
        }
        self.problem.prior_rows(&mut jacobian);
        Some(jacobian)
    }
}

impl WeightedResiduals for InverseModel<'_> {
    fn weights(&mut self) -> &mut ResidualWeights {
        &mut self.weights
    }

    fn unknowns(&self) -> usize {
        self.problem.free.len()
    }
}

/// Step of the differences, in z.
const STEP: f64 = 1e-5;

/// The parameters' values at `z`, in the order of the plan.
fn values(problem: &IdentificationProblem<'_>, z: &[f64]) -> Vec<f64> {
    problem.parameters(z).into_iter().map(|p| p.1).collect()
}

impl RecordedMotion {
    /// Filters a column, drops both ends and keeps one sample of each stride.
    fn thin(&self, values: &[f64]) -> Vec<f64> {
        let filtered = self.low_pass.apply(values);
        filtered[self.margin..filtered.len() - self.margin].iter().copied().step_by(self.stride).collect()
    }

    /// The times of thinned samples.
    fn thin_times(&self) -> Vec<f64> {
        self.times[self.margin..self.times.len() - self.margin].iter().copied().step_by(self.stride).collect()
    }
}

/// Computes states, rates and forces of a recording from its signals. `None` where it is shorter than four margins.
fn motion(inverse: &ModelInversion, recording: &Recording) -> Option<RecordedMotion> {
    let times = &recording.times;
    let step = (times[times.len() - 1] - times[0]) / (times.len() - 1) as f64;
    let forces: Vec<Vec<f64>> = inverse.inputs.iter().map(|&k| recording.inputs[k].clone()).collect();
    // One filter for all forces, so that residual and derivatives pass the same one.
    let band = forces.iter().map(|f| band(f)).fold(0.0, f64::max);
    let low_pass = LowPass::new(band);
    let margin = (1.0 / band).ceil() as usize;
    if times.len() < 4 * margin {
        return None;
    }
    let smooth = LowPass::new(SIGNAL_CORNER);
    let mut states = vec![Vec::new(); inverse.origins.len()];
    for &i in &inverse.order {
        states[i] = match inverse.origins[i] {
            StateSource::Signal(s, factor) => {
                smooth.apply(&filled(&recording.signals[s])).into_iter().map(|v| v / factor).collect()
            }
            StateSource::Rate(of) => derivative(&states[of], step),
        };
    }
    let rates = inverse.driven.iter().map(|&i| derivative(&states[i], step)).collect();
    // 0.4 samples per period of the band's end keeps about its Nyquist rate: further samples would repeat information.
    let stride = ((0.4 / band) as usize).max(1);
    Some(RecordedMotion { times: times.clone(), states, rates, forces, low_pass, stride, margin })
}

/// The frequency, as a fraction of the sampling rate, below which [`POWER`] of the force's variance lies.
///
/// Low-passes of falling corners are tried until one keeps less.
fn band(force: &[f64]) -> f64 {
    let mean = force.iter().sum::<f64>() / force.len() as f64;
    let centred: Vec<f64> = force.iter().map(|f| f - mean).collect();
    let power = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>();
    let whole = power(&centred);
    let mut corner = 0.4;
    while corner > 1e-4 {
        let next = corner / 1.25;
        if power(&LowPass::new(next).apply(&centred)) < POWER * whole {
            break;
        }
        corner = next;
    }
    corner
}
