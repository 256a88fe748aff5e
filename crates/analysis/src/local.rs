//! Evaluates a model as x' = f(x, theta, u), y = g(x, theta, u) at single points, with exact derivatives.
//!
//! An [`EvaluationPlan`] (made from a lifted model) and values of x, theta and u enter; rates, outputs and the matrices
//! of a [`Linearization`] leave. `linear`, `steady`, the inverse model and the diagnosis in `crates/gap` use it. The
//! system's own Jacobian holds the derivatives; algebraic unknowns are eliminated by the implicit function theorem.

mod derivatives;
mod newton;
mod plan;
#[cfg(test)]
mod tests;

use bramah_expr::VarId;
use bramah_solve::ConsistentPoint;
use bramah_syntax::diag::Diagnostic;
pub use derivatives::Linearization;
use nalgebra::{DMatrix, DVector};
use newton::NewtonPoint;
pub use plan::EvaluationPlan;
use std::sync::Arc;

/// A rate reads other rates when it changes by more than this share of itself as they change.
const PROBED: f64 = 1e-9;

/// Why a model has no value at a point.
#[derive(Clone, Debug, thiserror::Error)]
pub enum LocalError {
    /// The equations have no solution.
    #[error("{}", .0.message)]
    NoSolution(Box<Diagnostic>),
    /// A value or derivative is not finite.
    #[error("a value is not finite")]
    NonFinite,
    /// The algebraic equations do not determine their unknowns.
    #[error("the equations are singular")]
    Singular,
}

impl From<Box<Diagnostic>> for LocalError {
    fn from(d: Box<Diagnostic>) -> Self {
        LocalError::NoSolution(d)
    }
}

/// Evaluates a model point by point. It holds buffers and the last solution, so each thread needs its own.
#[derive(Debug)]
pub struct LocalEvaluator {
    /// The structure of the equations.
    plan: Arc<EvaluationPlan>,
    /// Values of all variables at the last point.
    point: ConsistentPoint,
    /// Columns of the system at the last point.
    y: Vec<f64>,
    /// Derivatives of these columns.
    yp: Vec<f64>,
    /// Residual of the system; one entry for each row.
    residual: Vec<f64>,
    /// Entries of the Jacobian by y, in the order of the system's pattern.
    entries: Vec<f64>,
    /// Entries of the Jacobian by y and yp together (coefficient 1), in the same order.
    torn_entries: Vec<f64>,
    /// Implicit unknowns of the last solution, at which the next Newton iteration starts after a failure.
    implicit: Vec<f64>,
    /// Whether some rate or output reads the rate of another state, as in `f = d*der(s)`.
    reads_rates: bool,
    /// Row and column of the entries of `linear` that depend on implicit unknowns; they are cleared at the next point.
    through_unknowns: Vec<(usize, usize)>,
    /// x' at the last point, n entries.
    pub rates: Vec<f64>,
    /// y at the last point, p entries.
    pub outputs: Vec<f64>,
    /// Derivatives at the last point.
    pub linear: Linearization,
}

impl LocalEvaluator {
    /// An evaluator at the model's start, with these parameters and inputs.
    ///
    /// # Errors
    /// When the initial equations have no solution.
    pub fn start(plan: Arc<EvaluationPlan>, time: f64, theta: &[f64], u: &[f64]) -> Result<Self, LocalError> {
        let given = plan.raised.iter().zip(theta.iter().chain(u)).map(|(p, v)| (p.start, *v)).collect();
        let point = ConsistentPoint::start(plan.system.clone(), time, given)?;
        let (n, p, r) = (plan.states.len(), plan.outputs.len(), plan.raised.len());
        let columns = plan.system.columns.len();
        let entries = plan.system.pattern.nnz();
        let linear = Linearization {
            a: DMatrix::zeros(n, n),
            b: DMatrix::zeros(n, r),
            c: DMatrix::zeros(p, n),
            d: DMatrix::zeros(p, r),
        };
        let mut local = LocalEvaluator {
            point,
            y: vec![0.0; columns],
            yp: vec![0.0; columns],
            residual: vec![0.0; columns],
            entries: vec![0.0; entries],
            torn_entries: vec![0.0; entries],
            implicit: vec![0.0; plan.implicit.len()],
            reads_rates: false,
            through_unknowns: Vec::new(),
            rates: vec![0.0; n],
            outputs: vec![0.0; p],
            linear,
            plan,
        };
        local.reads_rates = local.looks_for_read_rates(time);
        Ok(local)
    }

    /// Whether rows of rates change with the rates put into them.
    ///
    /// True where it cannot be found out, because the equations have no value at the start.
    fn looks_for_read_rates(&mut self, time: f64) -> bool {
        let LocalEvaluator { plan, point, y, yp, residual, .. } = self;
        let system = &plan.system;
        for (j, c) in system.columns.iter().enumerate() {
            y[j] = point.values[system.layout.var(c.variable)];
            yp[j] = 0.0;
        }
        let mut rates = |probe: f64| {
            // Different values, so that their effects on a row do not cancel.
            let tried: Vec<f64> = (0..yp.len()).map(|j| probe * (1.0 + 0.37 * j as f64)).collect();
            plan.explicit.iter().for_each(|&j| yp[j] = tried[j]);
            let known = system.residual(time, y, yp, &mut point.values, residual).is_ok();
            known.then(|| plan.explicit.iter().map(|&j| tried[j] - residual[j]).collect::<Vec<f64>>())
        };
        let (Some(without), Some(with)) = (rates(0.0), rates(1.0)) else { return true };
        without.iter().zip(&with).any(|(a, b)| (a - b).abs() > PROBED * (1.0 + a.abs()))
    }

    /// The structure of the equations.
    pub fn plan(&self) -> &Arc<EvaluationPlan> {
        &self.plan
    }

    /// Takes over a state of the original model, discrete values included. Evaluate afterwards.
    pub fn adopt(&mut self, state: &bramah_solve::State) {
        state.restore(&self.plan.system, &mut self.point.values);
    }

    /// The states at the last point.
    pub fn state(&self) -> Vec<f64> {
        let layout = &self.plan.system.layout;
        self.plan.states.iter().map(|&(_, v)| self.point.values[layout.var(v)]).collect()
    }

    /// The nominal value of each state, positive.
    pub fn nominals(&self) -> Vec<f64> {
        self.plan.states.iter().map(|&(_, v)| self.point.nominal(v)).collect()
    }

    /// The value of any variable at the last point.
    pub fn value(&self, v: VarId) -> f64 {
        self.point.values[self.plan.system.layout.var(v)]
    }

    /// Computes `rates` and `outputs`.
    ///
    /// # Errors
    /// [`LocalError`]; the values are then meaningless.
    pub fn evaluate(&mut self, time: f64, x: &[f64], theta: &[f64], u: &[f64]) -> Result<(), LocalError> {
        let result = self.values(time, x, theta, u);
        self.remember(result.is_ok());
        result
    }

    /// Solves the equations at a point and fills `rates` and `outputs`.
    fn values(&mut self, time: f64, x: &[f64], theta: &[f64], u: &[f64]) -> Result<(), LocalError> {
        let LocalEvaluator { plan, point, y, yp, residual, entries, torn_entries, reads_rates, .. } = self;
        let system = &plan.system;
        for (&(column, _), &value) in plan.states.iter().zip(x) {
            y[column] = value;
        }
        for (place, &value) in plan.raised.iter().zip(theta.iter().chain(u)) {
            // An alias with the opposite sign holds the negative value.
            y[place.column] = if place.negated { -value } else { value };
        }
        // `settle` also handles events, which discrete variables need, and it solves where Newton's method does not.
        let mut at = NewtonPoint { y, yp, residual, entries, torn_entries, values: &mut point.values };
        if plan.discrete || !plan.newton(time, &mut at)? {
            for (j, c) in system.columns.iter().enumerate().filter(|(_, c)| c.is_state()) {
                point.values[system.layout.var(c.variable)] = y[j];
            }
            point.settle(time)?;
            for (j, c) in system.columns.iter().enumerate() {
                y[j] = point.values[system.layout.var(c.variable)];
                yp[j] = if c.is_state() { point.values[system.layout.der(c.variable).expect("a state")] } else { 0.0 };
            }
        }
        if *reads_rates && !plan.discrete {
            plan.settle_rates(time, y, yp, residual, &mut point.values)?;
        }
        for (rate, &(column, _)) in self.rates.iter_mut().zip(&plan.states) {
            *rate = yp[column];
        }
        for (output, &column) in self.outputs.iter_mut().zip(&plan.outputs) {
            *output = yp[column];
        }
        let finite = self.rates.iter().chain(&self.outputs).all(|v| v.is_finite());
        if finite { Ok(()) } else { Err(LocalError::NonFinite) }
    }

    /// Keeps the implicit unknowns of a solution, or goes back to the last kept ones.
    fn remember(&mut self, found: bool) {
        for (kept, &(column, torn)) in self.implicit.iter_mut().zip(&self.plan.implicit) {
            let unknown = if torn { &mut self.yp[column] } else { &mut self.y[column] };
            if found {
                *kept = *unknown;
            } else {
                *unknown = *kept;
            }
        }
    }

    /// x' as a column vector.
    pub fn rate_vector(&self) -> DVector<f64> {
        DVector::from_column_slice(&self.rates)
    }
}
