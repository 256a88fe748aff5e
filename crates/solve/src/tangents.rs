//! Sensitivities that a run carries along: what is asked, and the equations' derivatives along a direction.

use super::ida::{DaeEquations, DifferentiableEquations, EvaluationStatus};
use super::model::IntegrationModel;
use crate::lower::{ExecutableSystem, ResidualRowKind};
use bramah_expr::VarId;

/// The sensitivities that a run shall carry along. Each row of the run then holds the wanted values, and after them for
/// each direction their derivatives.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TangentRequest {
    /// States that stand still, as parameters made states do: there is no error of theirs to count.
    pub still: Vec<VarId>,
    /// Per direction the derivatives of states at the start, those not named being 0.
    pub starts: Vec<Vec<(VarId, f64)>>,
    /// Their errors bound the steps too: two to three times as many where they move much, and right where the equations
    /// change within a step of the states, as where a valve opens.
    pub controlled: bool,
}

/// The column of a variable, or of the one it is an alias of, and the sign.
pub fn column(system: &ExecutableSystem, v: VarId) -> Option<(usize, f64)> {
    let alias = system.dae.aliases.iter().find(|a| a.variable == v);
    let (target, sign) = alias.map_or((v, 1.0), |a| (a.target, if a.negated { -1.0 } else { 1.0 }));
    system.columns.iter().position(|c| c.variable == target).map(|j| (j, sign))
}

/// dF/dy and dF/dy' at a point.
#[derive(Clone, Debug, Default)]
pub struct ResidualDerivatives {
    /// Where: time, unknowns, derivatives.
    at: Option<(f64, Vec<f64>, Vec<f64>)>,
    /// dF/dy, by the system's pattern.
    here: Vec<f64>,
    /// dF/dy' by the same pattern; empty where only the rows of derivatives have it, as 1.
    rates: Vec<f64>,
}

impl ResidualDerivatives {
    /// For a system.
    pub fn new(system: &ExecutableSystem) -> ResidualDerivatives {
        let implicit = |(c, r): (&crate::lower::UnknownColumn, &crate::lower::ResidualRow)| {
            c.is_state() && r.kind != ResidualRowKind::Derivative
        };
        let torn = system.columns.iter().zip(&system.rows).any(implicit);
        let entries = system.pattern.nnz();
        ResidualDerivatives { at: None, here: vec![0.0; entries], rates: vec![0.0; if torn { entries } else { 0 }] }
    }

    fn stands(&self, t: f64, y: &[f64], yp: &[f64]) -> bool {
        let same = |at: &(f64, Vec<f64>, Vec<f64>)| at.0 == t && at.1 == y && (self.rates.is_empty() || at.2 == yp);
        self.at.as_ref().is_some_and(same)
    }

    fn note(&mut self, t: f64, y: &[f64], yp: &[f64]) {
        let (time, old, slopes) = self.at.get_or_insert_with(|| (t, Vec::new(), Vec::new()));
        *time = t;
        y.clone_into(old);
        yp.clone_into(slopes);
    }
}

impl DifferentiableEquations for IntegrationModel<'_> {
    fn differentiate(&mut self, t: f64, y: &[f64], yp: &[f64]) -> EvaluationStatus {
        let mut slopes = self.slopes.take().unwrap_or_else(|| Box::new(ResidualDerivatives::new(self.system)));
        let mut done = EvaluationStatus::Done;
        if !slopes.stands(t, y, yp) {
            done = self.jacobian(t, 0.0, y, yp, &mut slopes.here);
            if done == EvaluationStatus::Done && !slopes.rates.is_empty() {
                done = self.jacobian(t, 1.0, y, yp, &mut slopes.rates);
                slopes.rates.iter_mut().zip(&slopes.here).for_each(|(r, h)| *r -= h);
            }
            slopes.note(t, y, yp);
        }
        if done == EvaluationStatus::Retry {
            slopes.at = None;
        }
        self.slopes = Some(slopes);
        done
    }

    fn forget(&mut self) {
        if let Some(slopes) = &mut self.slopes {
            slopes.at = None;
        }
    }

    fn along(&self, s: &[f64], sp: &[f64], r: &mut [f64]) {
        let Some(slopes) = &self.slopes else { return };
        let (system, pattern) = (self.system, &self.system.pattern);
        if slopes.rates.is_empty() {
            let own = |(row, sp): (&crate::lower::ResidualRow, &f64)| {
                if row.kind == ResidualRowKind::Derivative { *sp } else { 0.0 }
            };
            r.iter_mut().zip(system.rows.iter().zip(sp)).for_each(|(r, at)| *r = own(at));
        } else {
            r.fill(0.0);
        }
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
