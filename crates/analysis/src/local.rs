//! A model as x' = f(x, theta, u), y = g(x, theta, u) at one point: values, and exact derivatives by the system's own
//! Jacobian. Algebraic unknowns are eliminated by the implicit function theorem.

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
pub use plan::EvaluationPlan;
use std::sync::Arc;

/// A rate that reads others changes by more than this part of it when they do.
const PROBED: f64 = 1e-9;

/// Why there is no value.
#[derive(Clone, Debug, thiserror::Error)]
pub enum LocalError {
    /// The equations have no solution there.
    #[error("{}", .0.message)]
    NoSolution(Box<Diagnostic>),
    /// A value or derivative is not finite.
    #[error("a value is not finite")]
    NonFinite,
    /// The algebraic part does not determine its unknowns.
    #[error("the equations are singular")]
    Singular,
}

impl From<Box<Diagnostic>> for LocalError {
    fn from(d: Box<Diagnostic>) -> Self {
        LocalError::NoSolution(d)
    }
}

/// A model that is evaluated point by point; one for each thread.
#[derive(Debug)]
pub struct LocalEvaluator {
    plan: Arc<EvaluationPlan>,
    point: ConsistentPoint,
    y: Vec<f64>,
    yp: Vec<f64>,
    residual: Vec<f64>,
    entries: Vec<f64>,
    torn_entries: Vec<f64>,
    /// Implicit unknowns of the last solution.
    implicit: Vec<f64>,
    /// Some rate or output reads the rate of another state (`f = d*der(s)`).
    reads_rates: bool,
    /// Entries of `linear` (row, column) that went through implicit unknowns.
    through_unknowns: Vec<(usize, usize)>,
    /// x' at the last point.
    pub rates: Vec<f64>,
    /// y at the last point.
    pub outputs: Vec<f64>,
    /// Derivatives at the last point.
    pub linear: Linearization,
}

impl LocalEvaluator {
    /// At the start of the model, with these parameters and inputs.
    ///
    /// # Errors
    /// When the initial system has no solution.
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

    /// Whether explicit rows change with the rates put into them; there is no value at the start where this cannot be
    /// told.
    fn looks_for_read_rates(&mut self, time: f64) -> bool {
        let LocalEvaluator { plan, point, y, yp, residual, .. } = self;
        let system = &plan.system;
        for (j, c) in system.columns.iter().enumerate() {
            y[j] = point.values[system.layout.var(c.variable)];
            yp[j] = 0.0;
        }
        let mut rates = |probe: f64| {
            let tried: Vec<f64> = (0..yp.len()).map(|j| probe * (1.0 + 0.37 * j as f64)).collect();
            plan.explicit.iter().for_each(|&j| yp[j] = tried[j]);
            let known = system.residual(time, y, yp, &mut point.values, residual).is_ok();
            known.then(|| plan.explicit.iter().map(|&j| tried[j] - residual[j]).collect::<Vec<f64>>())
        };
        let (Some(without), Some(with)) = (rates(0.0), rates(1.0)) else { return true };
        without.iter().zip(&with).any(|(a, b)| (a - b).abs() > PROBED * (1.0 + a.abs()))
    }

    /// What is evaluated.
    pub fn plan(&self) -> &Arc<EvaluationPlan> {
        &self.plan
    }

    /// Takes over a state of the model itself, as a run left it: discrete values too. Evaluate afterwards.
    pub fn adopt(&mut self, state: &bramah_solve::State) {
        state.restore(&self.plan.system, &mut self.point.values);
    }

    /// The states at the last point.
    pub fn state(&self) -> Vec<f64> {
        let layout = &self.plan.system.layout;
        self.plan.states.iter().map(|&(_, v)| self.point.values[layout.var(v)]).collect()
    }

    /// The usual size of each state, positive.
    pub fn nominals(&self) -> Vec<f64> {
        self.plan.states.iter().map(|&(_, v)| self.point.nominal(v)).collect()
    }

    /// The value of any variable at the last point.
    pub fn value(&self, v: VarId) -> f64 {
        self.point.values[self.plan.system.layout.var(v)]
    }

    /// Values of x' and y.
    ///
    /// # Errors
    /// [`LocalError`]; the values are then meaningless.
    pub fn evaluate(&mut self, time: f64, x: &[f64], theta: &[f64], u: &[f64]) -> Result<(), LocalError> {
        let result = self.values(time, x, theta, u);
        self.remember(result.is_ok());
        result
    }

    fn values(&mut self, time: f64, x: &[f64], theta: &[f64], u: &[f64]) -> Result<(), LocalError> {
        let LocalEvaluator { plan, point, y, yp, residual, entries, torn_entries, reads_rates, .. } = self;
        let system = &plan.system;
        for (&(column, _), &value) in plan.states.iter().zip(x) {
            y[column] = value;
        }
        for (place, &value) in plan.raised.iter().zip(theta.iter().chain(u)) {
            y[place.column] = if place.negated { -value } else { value };
        }
        if plan.discrete || !plan.newton(time, y, yp, residual, entries, torn_entries, &mut point.values)? {
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

    /// Remembers the implicit unknowns where there is a solution; where there is none, the next search begins there.
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

    /// x' as a vector.
    pub fn rate_vector(&self) -> DVector<f64> {
        DVector::from_column_slice(&self.rates)
    }
}
