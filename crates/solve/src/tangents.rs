//! What a caller asks of sensitivities, and the derivatives of the residual along a direction.
//!
//! [`TangentRequest`] is part of the settings. `driver/tangents` moves the sensitivities over events; IDAS calls
//! [`DifferentiableEquations`] of the model for its sensitivity equations dF/dy s + dF/dy' s' = 0.

use super::ida::{DaeEquations, DifferentiableEquations, EvaluationStatus};
use super::model::IntegrationModel;
use crate::lower::{ExecutableSystem, ResidualRowKind};
use bramah_expr::VarId;

/// The sensitivities that a run computes beside its solution.
///
/// Each row of the run then holds the wanted values, and after them, for each direction, their derivatives.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TangentRequest {
    /// States that are constant, for example parameters turned into states. They have no integration error.
    pub still: Vec<VarId>,
    /// For each direction the derivatives of states at the start. States that are not named have derivative 0.
    pub starts: Vec<Vec<(VarId, f64)>>,
    /// Whether the errors of the sensitivities limit the steps too.
    ///
    /// It costs two to three times as many steps where the sensitivities change much. It is needed for accurate
    /// sensitivities where equations change within a step of the states, for example where a valve opens.
    pub controlled: bool,
}

/// The column of a variable, or of the variable that it is an alias of, and the sign. `None`: it is no unknown.
pub fn column(system: &ExecutableSystem, v: VarId) -> Option<(usize, f64)> {
    let alias = system.dae.aliases.iter().find(|a| a.variable == v);
    let (target, sign) = alias.map_or((v, 1.0), |a| (a.target, if a.negated { -1.0 } else { 1.0 }));
    system.columns.iter().position(|c| c.variable == target).map(|j| (j, sign))
}

/// dF/dy and dF/dy' at one point, kept because IDAS asks for several directions at the same point.
#[derive(Clone, Debug, Default)]
pub struct ResidualDerivatives {
    /// The point: time, unknowns, derivatives. `None` when nothing valid is stored.
    at: Option<(f64, Vec<f64>, Vec<f64>)>,
    /// Entries of dF/dy in the order of the system's pattern.
    here: Vec<f64>,
    /// Entries of dF/dy' in the same order. Empty where F is `y' - f(t, y)` for all states, so that dF/dy' is known.
    rates: Vec<f64>,
}

impl ResidualDerivatives {
    /// An empty store of the right sizes for a system.
    pub fn new(system: &ExecutableSystem) -> ResidualDerivatives {
        let implicit = |(c, r): (&crate::lower::UnknownColumn, &crate::lower::ResidualRow)| {
            c.is_state() && r.kind != ResidualRowKind::Derivative
        };
        // with such a state dF/dy' is more than 1 in the rows of derivatives
        let torn = system.columns.iter().zip(&system.rows).any(implicit);
        let entries = system.pattern.nnz();
        ResidualDerivatives { at: None, here: vec![0.0; entries], rates: vec![0.0; if torn { entries } else { 0 }] }
    }

    /// Whether the stored derivatives belong to this point. y' matters only where dF/dy' is stored.
    fn stands(&self, t: f64, y: &[f64], yp: &[f64]) -> bool {
        let same = |at: &(f64, Vec<f64>, Vec<f64>)| at.0 == t && at.1 == y && (self.rates.is_empty() || at.2 == yp);
        self.at.as_ref().is_some_and(same)
    }

    /// Records the point of the stored derivatives, reusing its buffers.
    fn note(&mut self, t: f64, y: &[f64], yp: &[f64]) {
        let (time, old, slopes) = self.at.get_or_insert_with(|| (t, Vec::new(), Vec::new()));
        *time = t;
        y.clone_into(old);
        yp.clone_into(slopes);
    }
}

impl DifferentiableEquations for IntegrationModel<'_> {
    /// Stores dF/dy, and dF/dy' where it is not known from the structure, at this point.
    fn differentiate(&mut self, t: f64, y: &[f64], yp: &[f64]) -> EvaluationStatus {
        let mut slopes = self.slopes.take().unwrap_or_else(|| Box::new(ResidualDerivatives::new(self.system)));
        let mut done = EvaluationStatus::Done;
        if !slopes.stands(t, y, yp) {
            done = self.jacobian(t, 0.0, y, yp, &mut slopes.here);
            if done == EvaluationStatus::Done && !slopes.rates.is_empty() {
                // the Jacobian is dF/dy + cj dF/dy': the difference of cj = 1 and cj = 0 is dF/dy'
                done = self.jacobian(t, 1.0, y, yp, &mut slopes.rates);
                slopes.rates.iter_mut().zip(&slopes.here).for_each(|(r, h)| *r -= h);
            }
            slopes.note(t, y, yp);
        }
        // values that are not finite must not be reused
        if done == EvaluationStatus::Retry {
            slopes.at = None;
        }
        self.slopes = Some(slopes);
        done
    }

    /// Discards the stored derivatives.
    fn forget(&mut self) {
        if let Some(slopes) = &mut self.slopes {
            slopes.at = None;
        }
    }

    /// Multiplies the stored derivatives with a direction `s`, `sp`.
    fn along(&self, s: &[f64], sp: &[f64], r: &mut [f64]) {
        let Some(slopes) = &self.slopes else { return };
        let (system, pattern) = (self.system, &self.system.pattern);
        // dF/dy' is 1 in rows of derivatives and 0 elsewhere
        if slopes.rates.is_empty() {
            let own = |(row, sp): (&crate::lower::ResidualRow, &f64)| {
                if row.kind == ResidualRowKind::Derivative { *sp } else { 0.0 }
            };
            r.iter_mut().zip(system.rows.iter().zip(sp)).for_each(|(r, at)| *r = own(at));
        } else {
            r.fill(0.0);
        }
        // sparse matrix times vector, column by column
        for j in 0..pattern.n {
            let places = pattern.colptr[j]..pattern.colptr[j + 1];
            let rows = &pattern.rowidx[places.clone()];
            if s[j] != 0.0 {
                rows.iter().zip(&slopes.here[places.clone()]).for_each(|(&row, v)| r[row] += v * s[j]);
            }
            if !slopes.rates.is_empty() && sp[j] != 0.0 {
                rows.iter().zip(&slopes.rates[places]).for_each(|(&row, v)| r[row] += v * sp[j]);
            }
        }
    }
}
