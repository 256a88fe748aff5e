//! Algebraic unknowns: how closely they are watched, and their values where no step ends.
//!
//! What IDA's error test measures of an algebraic unknown is not its error. Predicted is the trajectory of its old values,
//! which already hold the errors of the states behind them; at order one and with steps of equal length these cancel,
//! after any change of the step they do not, and the integrator is caught at tiny steps. The error of an algebraic
//! unknown is that of the states times its sensitivity to them, as if it were eliminated. So the test holds it loosely,
//! close enough that steps do not pass over events, and rows are made here: states by interpolation, the rest and the
//! derivatives by Newton's method.

use super::ida::{DaeEquations, EvaluationStatus};
use super::linear::Lu;
use super::model::IntegrationModel;
use crate::lower::{ColumnRole, ExecutableSystem};

/// Weight of the derivatives in the matrix: so large that states do not move.
pub const HOLD_STATES: f64 = 1e60;
/// The last correction, in tolerances.
const ENOUGH: f64 = 0.1;
/// A rate that is not believed to be smaller.
const LEAST_RATE: f64 = 1e-3;
/// A correction that is a larger part of the one before asks for a new matrix.
const SLOW: f64 = 0.1;
const CORRECTIONS: u32 = 6;

/// How much looser algebraic unknowns are held than states. With 100, diodes at a sine are missed.
const LOOSE: f64 = 10.0;

/// The part of each unknown in the error test: as if states and algebraic unknowns were measured apart, each by the
/// root of their mean square, so that the number of the ones does not change what the others may do.
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

/// Factors of a Jacobian with [`HOLD_STATES`]; `solved` is false for each unknown whose derivative is sought instead: beside
/// that, what an equation has of the unknown itself is no pivot.
pub fn holding(system: &ExecutableSystem, nominal: &[f64], solved: &[bool]) -> Lu {
    let size = |(n, &solved): (&f64, &bool)| if solved { *n } else { n / HOLD_STATES };
    Lu::new(&system.pattern, &nominal.iter().zip(solved).map(size).collect::<Vec<f64>>())
}

/// Work done.
#[derive(Clone, Copy, Debug, Default)]
pub struct EvaluationCounts {
    /// Evaluations of the equations.
    pub residuals: u64,
    /// Evaluations of the Jacobian.
    pub jacobians: u64,
}

/// The solver, with the values it last found.
#[derive(Debug)]
pub struct AlgebraicSolver {
    /// False for each unknown that is a state; empty when all are, or none is.
    solved: Vec<bool>,
    /// Size of each unknown times the tolerance.
    absolute: Vec<f64>,
    relative: f64,
    lu: Lu,
    val: Vec<f64>,
    factored: bool,
    /// By what part a correction was smaller than the one before, lately.
    rate: f64,
    step: Vec<f64>,
    y: Vec<f64>,
    yp: Vec<f64>,
    /// Work done so far.
    pub effort: EvaluationCounts,
}

impl AlgebraicSolver {
    /// For the unknowns of a system with these nominal values.
    pub fn new(system: &ExecutableSystem, nominal: &[f64], tolerance: f64) -> Self {
        // states that follow from a quantity are interpolated like others where nothing else has to be solved
        let needed = system.columns.iter().any(|c| c.role == ColumnRole::Algebraic);
        Self::where_needed(system, nominal, tolerance, needed)
    }

    /// Whether what the equations leave open may keep its value ([`Lu::may_keep`]).
    pub fn may_keep(&mut self, allowed: bool) {
        self.lu.may_keep(allowed);
    }

    /// The same, also where there are derivatives only.
    pub fn with_rates(system: &ExecutableSystem, nominal: &[f64], tolerance: f64) -> Self {
        Self::where_needed(system, nominal, tolerance, !system.columns.is_empty())
    }

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

    /// Unknowns and derivatives at `t`, with the states of `y`; as they were given when they cannot be solved.
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

    /// With the matrix at hand, or else with a new one from the values given.
    fn iterate(&mut self, model: &mut IntegrationModel<'_>, t: f64, y: &[f64], yp: &[f64]) -> bool {
        self.begin(y, yp);
        if self.factored && self.converge(model, t, false) {
            return true;
        }
        self.begin(y, yp);
        self.factor(model, t) && self.converge(model, t, true)
    }

    fn begin(&mut self, y: &[f64], yp: &[f64]) {
        self.y.clear();
        self.y.extend_from_slice(y);
        self.yp.clear();
        self.yp.extend_from_slice(yp);
    }

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

    fn factor(&mut self, model: &mut IntegrationModel<'_>, t: f64) -> bool {
        self.effort.jacobians += 1;
        let done = model.jacobian(t, HOLD_STATES, &self.y, &self.yp, &mut self.val) == EvaluationStatus::Done;
        self.factored = done && self.lu.factor(&self.val).is_ok();
        self.factored
    }

    /// One correction; the largest of an algebraic unknown, in tolerances. None when it is not finite.
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
                self.yp[i] -= HOLD_STATES * self.step[i];
            }
        }
        largest.is_finite().then_some(largest)
    }
}
