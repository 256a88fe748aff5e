//! Exact derivatives at a point: the entries of the system's Jacobian, sorted into A, B, C and D.
//!
//! Rows of the system are `der(x) - value` or implicit equations. The first kind gives derivatives directly; unknowns
//! of the second kind are eliminated by the implicit function theorem, and rates that other rows read by one more
//! solve.

use super::plan::{LocalColumnRole, LocalRowTarget};
use super::{LocalError, LocalEvaluator};
use nalgebra::DMatrix;

/// Derivatives at a point, for n states, m parameters, k inputs and p outputs. Columns of `b` and `d`: parameters, then
/// inputs.
#[derive(Clone, Debug)]
pub struct Linearization {
    /// d x'/d x, n by n.
    pub a: DMatrix<f64>,
    /// d x'/d (theta, u), n by (m + k).
    pub b: DMatrix<f64>,
    /// d y/d x, p by n.
    pub c: DMatrix<f64>,
    /// d y/d (theta, u), p by (m + k).
    pub d: DMatrix<f64>,
}

impl Linearization {
    /// An entry by its row (rates, then outputs) and its column (states, then parameters, then inputs).
    fn get(&self, row: usize, column: usize) -> f64 {
        let n = self.a.nrows();
        match (row < n, column < n) {
            (true, true) => self.a[(row, column)],
            (true, false) => self.b[(row, column - n)],
            (false, true) => self.c[(row - n, column)],
            (false, false) => self.d[(row - n, column - n)],
        }
    }

    /// Sets an entry by row and column as [`Linearization::get`] counts them.
    fn set(&mut self, row: usize, column: usize, value: f64) {
        let n = self.a.nrows();
        match (row < n, column < n) {
            (true, true) => self.a[(row, column)] = value,
            (true, false) => self.b[(row, column - n)] = value,
            (false, true) => self.c[(row - n, column)] = value,
            (false, false) => self.d[(row - n, column - n)] = value,
        }
    }
}

impl LocalEvaluator {
    /// Computes `rates`, `outputs` and `linear`.
    ///
    /// # Errors
    /// [`LocalError`]; values and derivatives are then meaningless.
    pub fn linearize(&mut self, time: f64, x: &[f64], theta: &[f64], u: &[f64]) -> Result<(), LocalError> {
        self.evaluate(time, x, theta, u)?;
        let LocalEvaluator { plan, point, y, yp, entries, torn_entries, .. } = self;
        let system = &plan.system;
        // The coefficient of d/d yp is 0 here and 1 below: the difference of both is the derivative by the rates.
        system.jacobian(time, 0.0, y, yp, &mut point.values, entries).map_err(|_| LocalError::NonFinite)?;
        let torn = plan.implicit.iter().any(|i| i.1);
        if torn || self.reads_rates {
            system.jacobian(time, 1.0, y, yp, &mut point.values, torn_entries).map_err(|_| LocalError::NonFinite)?;
        }
        self.scatter();
        if !self.plan.implicit.is_empty() {
            self.eliminate(torn)?;
        }
        if self.reads_rates { self.through_rates() } else { Ok(()) }
    }

    /// Adds what passes through rates that other rows read: r = g(x, r) has dr/dx = (1 - dg/dr)^-1 dg/dx.
    fn through_rates(&mut self) -> Result<(), LocalError> {
        let LocalEvaluator { plan, entries, torn_entries, linear, through_unknowns, .. } = self;
        let (n, p) = (plan.states.len(), plan.outputs.len());
        let mut read = DMatrix::zeros(n + p, n);
        let pattern = &plan.system.pattern;
        for (column, role) in plan.roles.iter().enumerate() {
            let LocalColumnRole::State(j) = *role else { continue };
            for k in pattern.colptr[column]..pattern.colptr[column + 1] {
                match plan.targets[pattern.rowidx[k]] {
                    LocalRowTarget::Rate(i) if i != j => read[(i, j)] = entries[k] - torn_entries[k],
                    LocalRowTarget::Output(i) => read[(n + i, j)] = entries[k] - torn_entries[k],
                    _ => {}
                }
            }
        }
        let own = DMatrix::identity(n, n) - read.rows(0, n);
        let own = own.lu();
        linear.a = own.solve(&linear.a).ok_or(LocalError::Singular)?;
        linear.b = own.solve(&linear.b).ok_or(LocalError::Singular)?;
        linear.c += read.rows(n, p) * &linear.a;
        linear.d += read.rows(n, p) * &linear.b;
        // All entries may be nonzero now, so the next point has to clear all of them.
        let width = n + linear.b.ncols();
        // All entries may be nonzero now, so the next point clears all of them.
        through_unknowns.clear();
        through_unknowns.extend((0..n + p).flat_map(|row| (0..width).map(move |column| (row, column))));
        Ok(())
    }

    /// Copies the explicit part: minus the entries of rows `der(x) - value`.
    ///
    /// All other entries are zero already, except those that passed through implicit unknowns at the last point.
    fn scatter(&mut self) {
        let LocalEvaluator { plan, entries, linear, through_unknowns, .. } = self;
        through_unknowns.drain(..).for_each(|(row, column)| linear.set(row, column, 0.0));
        let pattern = &plan.system.pattern;
        let n = plan.states.len();
        for (column, role) in plan.roles.iter().enumerate() {
            let (column_at, sign) = match *role {
                LocalColumnRole::State(j) => (j, -1.0),
                LocalColumnRole::Raised(j) if plan.raised[j].negated => (n + j, 1.0),
                LocalColumnRole::Raised(j) => (n + j, -1.0),
                _ => continue,
            };
            for k in pattern.colptr[column]..pattern.colptr[column + 1] {
                match plan.targets[pattern.rowidx[k]] {
                    LocalRowTarget::Rate(i) => linear.set(i, column_at, sign * entries[k]),
                    LocalRowTarget::Output(i) => linear.set(n + i, column_at, sign * entries[k]),
                    LocalRowTarget::Other => {}
                }
            }
        }
    }

    /// Adds what passes through the implicit unknowns.
    ///
    /// F(w, q) = 0 gives dq/dw = -(dF/dq)^-1 dF/dw; `unknown` is dF/dq, `known` dF/dw for the independent quantities w
    /// that implicit equations read.
    fn eliminate(&mut self, torn: bool) -> Result<(), LocalError> {
        let LocalEvaluator { plan, entries, torn_entries, linear, through_unknowns, .. } = self;
        let (n, p, q) = (plan.states.len(), plan.outputs.len(), plan.implicit.len());
        let rows = &plan.implicit_row;
        let mut unknown = DMatrix::zeros(q, q);
        let mut known = DMatrix::zeros(q, plan.reached.len());
        // Derivatives of rates and outputs by the unknowns.
        let mut through = DMatrix::zeros(n + p, q);
        let pattern = &plan.system.pattern;
        let mut implicit_of = vec![None; plan.system.columns.len()];
        plan.implicit.iter().enumerate().filter(|(_, i)| i.1).for_each(|(i, &(c, _))| implicit_of[c] = Some(i));
        for column in 0..plan.roles.len() {
            for k in pattern.colptr[column]..pattern.colptr[column + 1] {
                let row = pattern.rowidx[k];
                let value = entries[k];
                let target = match plan.targets[row] {
                    LocalRowTarget::Rate(i) => Some(i),
                    LocalRowTarget::Output(i) => Some(n + i),
                    LocalRowTarget::Other => None,
                };
                match (rows[row], plan.roles[column]) {
                    (Some(i), LocalColumnRole::State(j)) => known[(i, plan.reached_place[j])] = value,
                    (Some(i), LocalColumnRole::Raised(j)) => {
                        known[(i, plan.reached_place[n + j])] = if plan.raised[j].negated { -value } else { value };
                    }
                    (Some(i), LocalColumnRole::Implicit(j)) => unknown[(i, j)] = value,
                    (None, LocalColumnRole::Implicit(j)) => {
                        if let Some(t) = target {
                            through[(t, j)] = -value;
                        }
                    }
                    _ => {}
                }
                if torn && let Some(j) = implicit_of[column] {
                    let value = torn_entries[k] - entries[k];
                    match (rows[row], target) {
                        (Some(i), _) => unknown[(i, j)] += value,
                        // Another row reads this implicit rate.
                        (None, Some(t)) => through[(t, j)] -= value,
                        (None, None) => {}
                    }
                }
            }
        }
        let solution = unknown.lu().solve(&known).ok_or(LocalError::Singular)?;
        let mut finite = entries.iter().all(|v| v.is_finite());
        for t in (0..n + p).filter(|&t| through.row(t).iter().any(|v| *v != 0.0)) {
            for (place, &j) in plan.reached.iter().enumerate() {
                let sum: f64 = (0..q).map(|k| through[(t, k)] * solution[(k, place)]).sum();
                finite &= sum.is_finite();
                linear.set(t, j, linear.get(t, j) - sum);
                through_unknowns.push((t, j));
            }
        }
        for (i, &(column, torn)) in plan.implicit.iter().enumerate() {
            if torn && let LocalColumnRole::State(k) = plan.roles[column] {
                for (place, &j) in plan.reached.iter().enumerate() {
                    finite &= solution[(i, place)].is_finite();
                    // An implicit rate is an unknown itself, so its derivatives are the solution.
                    linear.set(k, j, -solution[(i, place)]);
                    through_unknowns.push((k, j));
                }
            }
        }
        if finite { Ok(()) } else { Err(LocalError::NonFinite) }
    }
}
