//! Diagnostics for runs that stop early.
//!
//! `legs` and `event` call these functions with the return of IDA. Each returns an `EarlyStop` with a message that
//! names a time, and a variable or equation where one can be found.

use super::{Driver, EarlyStop};
use crate::ida::{DaeEquations, EvaluationStatus, IdaFailure};
use crate::model::IntegrationModel;
use crate::report;
use crate::settings::End;
use bramah_syntax::diag::{Code, Diagnostic};

impl<'a> Driver<'a, '_> {
    /// The end of a run whose row contains NaN or infinity. The message names the first such variable of the row.
    pub(super) fn non_finite_row(&self, model: &IntegrationModel<'a>) -> EarlyStop {
        let trap = report::find_trap(self.system, &model.values);
        let mut diagnostic = report::non_finite(self.system, self.t, trap);
        if let Some(i) = self.row.iter().position(|v| !v.is_finite()) {
            // after the values come their derivatives, once for each direction
            let wanted = &self.settings.wanted;
            let variable = &self.system.dae.variables[wanted[i % wanted.len()].index()];
            let what = if i < wanted.len() { "" } else { "a derivative of " };
            diagnostic = diagnostic.note(format!("{what}`{}` is {} then", variable.name, self.row[i]));
        }
        EarlyStop::new(End::NonFinite, diagnostic)
    }

    /// The end of a run that the caller or the sink has stopped.
    pub(super) fn interrupted(&self) -> EarlyStop {
        let text = format!("interrupted at time {} s", report::number(self.t));
        EarlyStop::new(End::Interrupted, Diagnostic::new(Code::Interrupted, text))
    }

    /// The end of a run because IDA rejected its input.
    ///
    /// This points to an error in this crate, not in the model.
    pub(super) fn refused(&self, failure: &IdaFailure) -> EarlyStop {
        let text = format!("the integrator refused to start at time {} s: {failure:?}", report::number(self.t));
        EarlyStop::new(End::StepTooSmall, Diagnostic::new(Code::StepTooSmall, text))
    }

    /// Translates a failure of IDA into the end of the run.
    ///
    /// The last accepted values are written as a row first. The diagnostic names the unknown with the largest error, or
    /// an equation that determines nothing.
    pub(super) fn failed(&mut self, failure: IdaFailure) -> EarlyStop {
        let (system, t) = (self.system, self.t);
        if let IdaFailure::Panic(text) = failure {
            // a panic of a callback was caught at the border to C and continues here
            std::panic::resume_unwind(Box::new(text));
        }
        // the row of the last accepted values helps the user to see what went wrong
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
        // without unknowns IDA integrates one constant, which no message may name
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
                // an equation that determines nothing is a better explanation than a collapsed step
                Some(equation) => report::idle_equation(system, collapse, equation),
                None => collapse,
            },
        )
    }

    /// An equation that at these values contains no derivative of a state and no algebraic unknown.
    ///
    /// Such an equation constrains states and leaves undetermined the unknown that it was matched with: the index is
    /// higher at this point than the structure of the equations shows. The result is an index into `Dae::equations`.
    pub(super) fn idle_equation(&mut self, t: f64, y: &[f64]) -> Option<u32> {
        let system = self.system;
        let (pattern, n) = (&system.pattern, system.columns.len());
        let yp = self.ida().yp().to_vec();
        let model = self.ida().equations();
        // with cj = 0 the Jacobian is dF/dy; the difference to cj = 1 is dF/dy'
        let mut still = vec![0.0; pattern.rowidx.len()];
        let mut moving = still.clone();
        let done = model.jacobian(t, 0.0, y, &yp, &mut still) == EvaluationStatus::Done
            && model.jacobian(t, 1.0, y, &yp, &mut moving) == EvaluationStatus::Done;
        // no row is reported when the Jacobian is not finite
        let mut busy = vec![!done; n];
        for (j, column) in system.columns.iter().enumerate() {
            for k in pattern.colptr[j]..pattern.colptr[j + 1] {
                // dF/dy' counts for columns that IDA integrates, dF/dy for all others
                let entry = if column.is_differential() { moving[k] - still[k] } else { still[k] };
                busy[pattern.rowidx[k]] |= entry != 0.0;
            }
        }
        busy.iter().position(|busy| !busy).and_then(|i| system.rows.get(i)).map(|row| row.equation)
    }

    /// The end of a run whose equations or Jacobian are not finite.
    ///
    /// The message names the operation that causes it, or the derivative when all values are finite.
    pub(super) fn non_finite(&mut self, t: f64) -> EarlyStop {
        let system = self.system;
        let model = self.ida().equations();
        // where the evaluation failed, as recorded by the model; the last accepted point is finite
        let Some((at, y, yp)) = model.trap.take() else {
            return EarlyStop::new(End::NonFinite, report::non_finite(system, t, None));
        };
        model.observe(at, &y, &yp);
        let trap = report::find_trap(system, &model.values);
        // all values are finite, so the Jacobian must have failed: for example the slope of a square root at zero
        let derivative = if trap.is_some() { None } else { infinite_derivative(model, at, &y, &yp) };
        let diagnostic = match derivative {
            Some((row, column)) => report::infinite_derivative(system, at, row, column),
            None => report::non_finite(system, at, trap),
        };
        EarlyStop::new(End::NonFinite, diagnostic)
    }
}

/// Row and column of the first entry of the Jacobian that is not finite; `None` when all are finite.
fn infinite_derivative(model: &mut IntegrationModel<'_>, t: f64, y: &[f64], yp: &[f64]) -> Option<(usize, usize)> {
    let pattern = &model.system.pattern;
    let mut entries = vec![0.0; pattern.nnz()];
    model.jacobian(t, 1.0, y, yp, &mut entries);
    let k = entries.iter().position(|v| !v.is_finite())?;
    // the column is the last one that starts at or before entry k
    Some((pattern.rowidx[k], pattern.colptr.partition_point(|&start| start <= k) - 1))
}
