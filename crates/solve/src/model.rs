//! A lowered system together with its values, as the equations that IDA integrates.
//!
//! [`IntegrationModel`] is owned by `Ida`. It updates recorded inputs and delays before each evaluation.

use super::ida::{DaeEquations, EvaluationStatus};
use super::inputs::InputPlayback;
use super::modes::RootFunctions;
use super::tangents::ResidualDerivatives;
use crate::lower::ExecutableSystem;

/// The values of one run, and what changes them while the integrator steps.
#[derive(Clone, Debug)]
pub struct IntegrationModel<'a> {
    /// The equations.
    pub system: &'a ExecutableSystem,
    /// All slots; see `ValueLayout`.
    pub values: Vec<f64>,
    /// The functions watched for sign changes.
    pub roots: RootFunctions,
    /// Recorded inputs and delayed values.
    pub playback: InputPlayback,
    /// Where the equations last had no finite value: time, y, y'. Messages are made from it.
    pub trap: Option<(f64, Vec<f64>, Vec<f64>)>,
    /// dF/dy and dF/dy' where they were last computed for sensitivities; `None` without sensitivities.
    pub slopes: Option<Box<ResidualDerivatives>>,
}

impl IntegrationModel<'_> {
    /// Records the point of an evaluation that is not finite.
    fn judge<E>(&mut self, result: Result<(), E>, t: f64, y: &[f64], yp: &[f64]) -> EvaluationStatus {
        match result {
            Ok(()) => EvaluationStatus::Done,
            Err(_) => {
                self.trap = Some((t, y.to_vec(), yp.to_vec()));
                EvaluationStatus::Retry
            }
        }
    }

    /// Writes time, unknowns and recorded inputs into their slots.
    pub fn load(&mut self, t: f64, y: &[f64], yp: &[f64]) {
        self.playback.follow(t, &mut self.values);
        self.system.load(t, y, yp, &mut self.values);
    }

    /// One of the unshifted crossing functions at these unknowns, with the explicit variables that it needs.
    pub fn raw_crossing(&mut self, t: f64, y: &[f64], yp: &[f64], raw: usize) -> f64 {
        self.playback.follow(t, &mut self.values);
        self.system.crossings(t, y, yp, &mut self.values, self.roots.raw());
        self.roots.raw()[raw]
    }

    /// The delayed expressions, evaluated from the slots.
    pub fn sources(&self) -> Vec<f64> {
        self.playback.delays.sources(self.system, &self.values)
    }

    /// Computes all variables at these unknowns into their slots.
    pub fn observe(&mut self, t: f64, y: &[f64], yp: &[f64]) {
        self.playback.follow(t, &mut self.values);
        self.system.observe(t, y, yp, &mut self.values);
    }
}

impl DaeEquations for IntegrationModel<'_> {
    /// Evaluates the residual after recorded inputs and delays have been set for `t`. Records the point where it fails.
    fn residual(&mut self, t: f64, y: &[f64], yp: &[f64], r: &mut [f64]) -> EvaluationStatus {
        if self.system.columns.is_empty() {
            // the constant that stands in for a system without unknowns
            r[0] = yp[0];
            return EvaluationStatus::Done;
        }
        self.playback.follow(t, &mut self.values);
        let result = self.system.residual(t, y, yp, &mut self.values, r);
        self.judge(result, t, y, yp)
    }

    /// As `residual`, with rows `y' - f` for as many unknowns as possible.
    fn rate_residual(&mut self, t: f64, y: &[f64], yp: &[f64], r: &mut [f64]) -> EvaluationStatus {
        if self.system.columns.is_empty() {
            return self.residual(t, y, yp, r);
        }
        self.playback.follow(t, &mut self.values);
        let result = self.system.rate_residual(t, y, yp, &mut self.values, r);
        self.judge(result, t, y, yp)
    }

    /// Evaluates the Jacobian in the order of the system's pattern.
    fn jacobian(&mut self, t: f64, cj: f64, y: &[f64], yp: &[f64], val: &mut [f64]) -> EvaluationStatus {
        if self.system.columns.is_empty() {
            val[0] = cj;
            return EvaluationStatus::Done;
        }
        self.playback.follow(t, &mut self.values);
        let result = self.system.jacobian(t, cj, y, yp, &mut self.values, val);
        self.judge(result, t, y, yp)
    }

    /// Evaluates the shifted root functions, one entry per function.
    fn crossings(&mut self, t: f64, y: &[f64], yp: &[f64], g: &mut [f64]) {
        self.playback.follow(t, &mut self.values);
        self.system.crossings(t, y, yp, &mut self.values, self.roots.raw());
        self.roots.write(g);
    }
}
