//! Algebraic unknowns: their weight in the error test, and their values where no step ends.
//!
//! What IDA's error test measures of an algebraic unknown is not its error. The predictor extrapolates old values,
//! which already contain the errors of the states behind them. With order 1 and equal steps these cancel; after a
//! change of the step they do not, and the integrator stays at tiny steps. The real error of an algebraic unknown is
//! that of the states times its sensitivity to them, as if it were eliminated. So the test weighs it loosely, but
//! tightly enough that steps do not pass over events. Rows take interpolated states, and [`AlgebraicSolver`] computes
//! all other unknowns and the derivatives from them by Newton's method.

use super::ida::{DaeEquations, EvaluationStatus};
use super::linear::Lu;
use super::model::IntegrationModel;
use crate::lower::{ColumnRole, ExecutableSystem};

/// The factor cj in the matrix: so large that states do not move, and their derivatives are solved for instead.
pub const HOLD_STATES: f64 = 1e60;
/// The iteration ends when the correction is below this, in tolerances.
const ENOUGH: f64 = 0.1;
/// Lower limit of the estimated convergence rate.
const LEAST_RATE: f64 = 1e-3;
/// A correction that is a larger part of the one before asks for a new matrix.
const SLOW: f64 = 0.1;
/// Corrections at most.
const CORRECTIONS: u32 = 6;

/// How much looser algebraic unknowns are tested than states. With 100, switching diodes on a sine are missed.
const LOOSE: f64 = 10.0;

/// The weight of each unknown in the error test.
///
/// States and algebraic unknowns are measured as if separately, each by the root of their mean square. So the number of
/// the ones does not change how accurate the others are.
pub fn shares(system: &ExecutableSystem) -> Vec<f64> {
    let count = |role| system.columns.iter().filter(|c| c.role == role).count() as f64;
    let (n, states) = (system.columns.len() as f64, count(ColumnRole::State) + count(ColumnRole::Following));
    let algebraic = count(ColumnRole::Algebraic);
    let share = |role| match role {
        ColumnRole::Algebraic if states == 0.0 => 1.0,
        ColumnRole::Algebraic => (n / algebraic).sqrt() / LOOSE,
        // a conserved quantity counts beside the states, not among them
        _ => (n / states).sqrt(),
    };
    system.columns.iter().map(|c| share(c.role)).collect()
}

/// A factorization for the Jacobian with cj = [`HOLD_STATES`].
///
/// `solved` is false for each unknown whose derivative is sought instead. There the entry of the unknown itself must
/// not become a pivot, so its column scale is divided by `HOLD_STATES`.
pub fn holding(system: &ExecutableSystem, nominal: &[f64], solved: &[bool]) -> Lu {
    let size = |(n, &solved): (&f64, &bool)| if solved { *n } else { n / HOLD_STATES };
    Lu::new(&system.pattern, &nominal.iter().zip(solved).map(size).collect::<Vec<f64>>())
}

/// Work done by the solver.
#[derive(Clone, Copy, Debug, Default)]
pub struct EvaluationCounts {
    /// Evaluations of the residual.
    pub residuals: u64,
    /// Evaluations of the Jacobian.
    pub jacobians: u64,
}

/// Solves algebraic unknowns and derivatives for given states, and holds the last solution.
#[derive(Debug)]
pub struct AlgebraicSolver {
    /// For each column whether the unknown itself is solved for (false: its derivative). Empty when nothing must be
    /// solved.
    solved: Vec<bool>,
    /// Absolute tolerance of each unknown.
    absolute: Vec<f64>,
    /// Relative tolerance.
    relative: f64,
    /// Factors of the Jacobian at `HOLD_STATES`.
    lu: Lu,
    /// Entries of that Jacobian.
    val: Vec<f64>,
    /// Whether `lu` is valid.
    factored: bool,
    /// Recent ratio of a correction to the one before.
    rate: f64,
    /// The present correction.
    step: Vec<f64>,
    /// Unknowns of the last solution.
    y: Vec<f64>,
    /// Derivatives of the last solution.
    yp: Vec<f64>,
    /// Work done so far.
    pub effort: EvaluationCounts,
}

impl AlgebraicSolver {
    /// A solver for a system with these nominal values. It does nothing where there are no algebraic unknowns.
    pub fn new(system: &ExecutableSystem, nominal: &[f64], tolerance: f64) -> Self {
        // states that follow from a quantity are interpolated like others where nothing else has to be solved
        let needed = system.columns.iter().any(|c| c.role == ColumnRole::Algebraic);
        Self::where_needed(system, nominal, tolerance, needed)
    }

    /// Sets whether unknowns that the equations leave open may keep their value ([`Lu::may_keep`]).
    pub fn may_keep(&mut self, allowed: bool) {
        self.lu.may_keep(allowed);
    }

    /// As [`AlgebraicSolver::new`], but it also solves where only derivatives are unknown.
    pub fn with_rates(system: &ExecutableSystem, nominal: &[f64], tolerance: f64) -> Self {
        Self::where_needed(system, nominal, tolerance, !system.columns.is_empty())
    }

    /// A solver that solves if `needed`.
    fn where_needed(system: &ExecutableSystem, nominal: &[f64], tolerance: f64, needed: bool) -> Self {
        let solved: Vec<bool> = system.columns.iter().map(|c| !c.is_differential()).collect();
        AlgebraicSolver {
            absolute: nominal.iter().map(|n| n * tolerance).collect(),
            relative: tolerance,
            lu: if needed { holding(system, nominal, &solved) } else { Lu::new(&Default::default(), &[]) },
            val: vec![0.0; if needed { system.pattern.nnz() } else { 0 }],
            factored: false,
            rate: 1.0,
            step: vec![0.0; solved.len()],
            y: Vec::new(),
            yp: Vec::new(),
            solved: if needed { solved } else { Vec::new() },
            effort: EvaluationCounts::default(),
        }
    }

    /// Unknowns and derivatives at `t`, with the states of `y`. The given ones where they cannot be solved.
    pub fn solve<'s>(
        &'s mut self,
        model: &mut IntegrationModel<'_>,
        t: f64,
        y: &'s [f64],
        yp: &'s [f64],
    ) -> (&'s [f64], &'s [f64]) {
        if self.solved.is_empty() {
            return (y, yp);
        }
        if self.iterate(model, t, y, yp) { (&self.y, &self.yp) } else { (y, yp) }
    }

    /// The same; `None` when they cannot be solved.
    pub fn solved(
        &mut self,
        model: &mut IntegrationModel<'_>,
        t: f64,
        y: &[f64],
        yp: &[f64],
    ) -> Option<(&[f64], &[f64])> {
        self.iterate(model, t, y, yp).then_some((&self.y, &self.yp))
    }

    /// Solves with the stored matrix, and with a new one if that fails; false when both fail.
    fn iterate(&mut self, model: &mut IntegrationModel<'_>, t: f64, y: &[f64], yp: &[f64]) -> bool {
        self.begin(y, yp);
        if self.factored && self.converge(model, t, false) {
            return true;
        }
        self.begin(y, yp);
        self.factor(model, t) && self.converge(model, t, true)
    }

    /// Starts from the given values.
    fn begin(&mut self, y: &[f64], yp: &[f64]) {
        self.y.clear();
        self.y.extend_from_slice(y);
        self.yp.clear();
        self.yp.extend_from_slice(yp);
    }

    /// Corrects until the correction is small enough; false when it does not converge.
    ///
    /// `fresh` allows a new matrix during the iteration.
    fn converge(&mut self, model: &mut IntegrationModel<'_>, t: f64, fresh: bool) -> bool {
        let mut last = f64::INFINITY;
        for _ in 0..CORRECTIONS {
            let Some(size) = self.correct(model, t) else { return false };
            if last.is_finite() {
                self.rate = (size / last).clamp(LEAST_RATE, 1.0);
            }
            // two small ones in a row are as good as rounding allows
            if size <= ENOUGH || size <= 1.0 && (last <= 1.0 || size * self.rate <= ENOUGH) {
                return true;
            }
            if size > SLOW * last && (!fresh || size > last || !self.factor(model, t)) {
                return false;
            }
            last = size;
        }
        last <= 1.0
    }

    /// Computes and factorizes the Jacobian; false when it is singular or not finite.
    fn factor(&mut self, model: &mut IntegrationModel<'_>, t: f64) -> bool {
        self.effort.jacobians += 1;
        let done = model.jacobian(t, HOLD_STATES, &self.y, &self.yp, &mut self.val) == EvaluationStatus::Done;
        self.factored = done && self.lu.factor(&self.val).is_ok();
        self.factored
    }

    /// Makes one correction. Returns its largest entry of an algebraic unknown in tolerances; `None` when it is not
    /// finite.
    fn correct(&mut self, model: &mut IntegrationModel<'_>, t: f64) -> Option<f64> {
        self.effort.residuals += 1;
        if model.residual(t, &self.y, &self.yp, &mut self.step) == EvaluationStatus::Retry
            || !self.lu.solve(&mut self.step)
        {
            return None;
        }
        let mut largest = 0.0_f64;
        for (i, &solved) in self.solved.iter().enumerate() {
            if solved {
                self.y[i] -= self.step[i];
                largest = largest.max(self.step[i].abs() / (self.relative * self.y[i].abs() + self.absolute[i]));
            } else {
                // the column of this unknown was multiplied by cj, so its correction is that of the derivative
                self.yp[i] -= HOLD_STATES * self.step[i];
            }
        }
        largest.is_finite().then_some(largest)
    }
}
