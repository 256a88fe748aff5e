//! Why a run stops early, in words.

use super::{Driver, EarlyStop};
use crate::ida::{DaeEquations, EvaluationStatus, IdaFailure};
use crate::model::IntegrationModel;
use crate::report;
use crate::settings::End;
use bramah_syntax::diag::{Code, Diagnostic};

impl<'a> Driver<'a, '_> {
    pub(super) fn non_finite_row(&self, model: &IntegrationModel<'a>) -> EarlyStop {
        let trap = report::find_trap(self.system, &model.values);
        let mut diagnostic = report::non_finite(self.system, self.t, trap);
        if let Some(i) = self.row.iter().position(|v| !v.is_finite()) {
            // behind the values stand their derivatives, as often as there are directions
            let wanted = &self.settings.wanted;
            let variable = &self.system.dae.variables[wanted[i % wanted.len()].index()];
            let what = if i < wanted.len() { "" } else { "a derivative of " };
            diagnostic = diagnostic.note(format!("{what}`{}` is {} then", variable.name, self.row[i]));
        }
        EarlyStop::new(End::NonFinite, diagnostic)
    }

    pub(super) fn interrupted(&self) -> EarlyStop {
        let text = format!("interrupted at time {} s", report::number(self.t));
        EarlyStop::new(End::Interrupted, Diagnostic::new(Code::Interrupted, text))
    }

    pub(super) fn refused(&self, failure: &IdaFailure) -> EarlyStop {
        let text = format!("the integrator refused to start at time {} s: {failure:?}", report::number(self.t));
        EarlyStop::new(End::StepTooSmall, Diagnostic::new(Code::StepTooSmall, text))
    }

    /// What IDA's failure means for the user.
    pub(super) fn failed(&mut self, failure: IdaFailure) -> EarlyStop {
        let (system, t) = (self.system, self.t);
        if let IdaFailure::Panic(text) = failure {
            std::panic::resume_unwind(Box::new(text));
        }
        // what was reached is kept
        let reached = self.with_model(|driver, model, y, yp| {
            model.load(t, y, yp);
            driver.program.run(&mut model.values);
            driver.write_row(model)
        });
        if let Err(stop) = reached {
            return stop;
        }
        if failure == IdaFailure::NonFinite {
            return self.non_finite(t);
        }
        let ida = self.ida();
        let mut errors = Vec::new();
        ida.weighted_errors(&mut errors);
        let (h, y) = (ida.step_lengths().0, ida.y().to_vec());
        errors.truncate(system.columns.len());
        let why = match failure {
            IdaFailure::ErrorTest => "the error test fails however small the step".to_string(),
            IdaFailure::Convergence => "the equations cannot be solved for a step".to_string(),
            IdaFailure::Singular(Some(s)) if s.column < system.columns.len() => {
                let v = system.columns[s.column].variable;
                format!("the equations do not determine `{}` there", system.dae.variables[v.index()].name)
            }
            IdaFailure::Singular(_) => "the equations became singular".to_string(),
            IdaFailure::TooMuchAccuracy => "the tolerance is finer than numbers of 64 bits allow".to_string(),
            other => format!("{other:?}"),
        };
        let collapse = report::step_collapse(system, t, h, &why, &errors, &y);
        EarlyStop::new(
            End::StepTooSmall,
            match self.idle_equation(t, &y) {
                Some(equation) => report::idle_equation(system, collapse, equation),
                None => collapse,
            },
        )
    }

    /// An equation that, with the values as they are, holds neither a derivative of a state nor an algebraic unknown.
    /// It then ties states together and leaves undetermined what it was to determine: the index is higher there than
    /// the structure tells.
    pub(super) fn idle_equation(&mut self, t: f64, y: &[f64]) -> Option<u32> {
        let system = self.system;
        let (pattern, n) = (&system.pattern, system.columns.len());
        let yp = self.ida().yp().to_vec();
        let model = self.ida().equations();
        let mut still = vec![0.0; pattern.rowidx.len()];
        let mut moving = still.clone();
        let done = model.jacobian(t, 0.0, y, &yp, &mut still) == EvaluationStatus::Done
            && model.jacobian(t, 1.0, y, &yp, &mut moving) == EvaluationStatus::Done;
        let mut busy = vec![!done; n];
        for (j, column) in system.columns.iter().enumerate() {
            for k in pattern.colptr[j]..pattern.colptr[j + 1] {
                let entry = if column.is_differential() { moving[k] - still[k] } else { still[k] };
                busy[pattern.rowidx[k]] |= entry != 0.0;
            }
        }
        busy.iter().position(|busy| !busy).and_then(|i| system.rows.get(i)).map(|row| row.equation)
    }

    pub(super) fn non_finite(&mut self, t: f64) -> EarlyStop {
        let system = self.system;
        let model = self.ida().equations();
        let Some((at, y, yp)) = model.trap.take() else {
            return EarlyStop::new(End::NonFinite, report::non_finite(system, t, None));
        };
        model.observe(at, &y, &yp);
        let trap = report::find_trap(system, &model.values);
        let derivative = if trap.is_some() { None } else { infinite_derivative(model, at, &y, &yp) };
        let diagnostic = match derivative {
            Some((row, column)) => report::infinite_derivative(system, at, row, column),
            None => report::non_finite(system, at, trap),
        };
        EarlyStop::new(End::NonFinite, diagnostic)
    }
}

/// Row and column of the first entry of the Jacobian that is not finite.
fn infinite_derivative(model: &mut IntegrationModel<'_>, t: f64, y: &[f64], yp: &[f64]) -> Option<(usize, usize)> {
    let pattern = &model.system.pattern;
    let mut entries = vec![0.0; pattern.nnz()];
    model.jacobian(t, 1.0, y, yp, &mut entries);
    let k = entries.iter().position(|v| !v.is_finite())?;
    Some((pattern.rowidx[k], pattern.colptr.partition_point(|&start| start <= k) - 1))
}
