//! The unknown parameters of an identification, on the scale z of the search.
//!
//! Parameters of the study with their values and bounds in the model enter; [`EstimatedParameter`]s leave. They map z
//! to values and back. On this scale the start is 0 and a step of 1 is of the order of the parameter's usual value.

use super::IdentificationProblem;
use crate::study::{BoundParameter, DataSheetTolerance};
use bramah_expr::VarId;

/// A parameter to estimate, with its scale, prior and bounds.
#[derive(Clone, Debug, PartialEq)]
pub struct EstimatedParameter {
    /// The model's variable.
    pub variable: VarId,
    /// Its dotted name.
    pub name: String,
    /// The unit of `start`, `min` and `max`.
    pub unit: String,
    /// Its value in the model.
    pub start: f64,
    /// Whether the scale is logarithmic: value = start exp(size z), else value = start + size z.
    pub logarithmic: bool,
    /// The change of the value, or of its logarithm, for a step of 1 in z.
    pub size: f64,
    /// Standard deviation of the prior about the start, in z; infinite where there is no prior.
    pub prior: f64,
    /// Lower bound.
    pub min: f64,
    /// Upper bound.
    pub max: f64,
}

impl EstimatedParameter {
    /// A parameter of the study; `None` for one that the study calls exact.
    ///
    /// `min`, `max` and `nominal` are those of the model. Bounds of the study replace those of the model.
    pub fn new(bound: &BoundParameter, start: f64, min: f64, max: f64, nominal: f64) -> Option<EstimatedParameter> {
        let min = bound.min.unwrap_or(min);
        let max = bound.max.unwrap_or(max);
        let usual = if start == 0.0 { nominal } else { start.abs() };
        let (logarithmic, prior) = match bound.knowledge {
            DataSheetTolerance::Exact => return None,
            // A relative deviation of a positive value is a deviation of its logarithm.
            DataSheetTolerance::Relative(part) => (start > 0.0, part),
            DataSheetTolerance::Absolute(sigma) => (false, sigma / usual),
            // A parameter that must be positive may be off by a factor, so it gets a logarithmic scale.
            DataSheetTolerance::Free => (min > 0.0 && start > 0.0, f64::INFINITY),
        };
        let size = if logarithmic { 1.0 } else { usual };
        let (variable, name, unit) = (bound.variable, bound.name.clone(), bound.unit.clone());
        Some(EstimatedParameter { variable, name, unit, start, logarithmic, size, prior, min, max })
    }

    /// The parameter's value at `z`.
    pub fn value(&self, z: f64) -> f64 {
        if self.logarithmic { self.start * (self.size * z).exp() } else { self.start + self.size * z }
    }

    /// The inverse of [`EstimatedParameter::value`]; negative infinity for a value without a logarithm.
    pub fn place(&self, value: f64) -> f64 {
        if self.logarithmic {
            if value > 0.0 { (value / self.start).ln() / self.size } else { f64::NEG_INFINITY }
        } else {
            (value - self.start) / self.size
        }
    }

    /// The derivative of the value by z.
    pub fn slope(&self, z: f64) -> f64 {
        if self.logarithmic { self.value(z) * self.size } else { self.size }
    }
}

impl IdentificationProblem<'_> {
    /// The parameters' values at `z`, as a run takes them.
    pub fn parameters(&self, z: &[f64]) -> Vec<(VarId, f64)> {
        self.free.iter().zip(z).map(|(f, &z)| (f.variable, f.value(z))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bramah_syntax::diag::{FileId, Span};

    fn free(knowledge: DataSheetTolerance, start: f64, min: f64) -> EstimatedParameter {
        let span = Span { file: FileId(0), start: 0, end: 0 };
        let bound = BoundParameter {
            variable: VarId(0),
            name: "k".into(),
            unit: String::new(),
            knowledge,
            min: None,
            max: None,
            span,
        };
        EstimatedParameter::new(&bound, start, min, f64::INFINITY, 10.0).expect("not exact")
    }

    #[test]
    fn scales_follow_what_is_known() {
        let log = free(DataSheetTolerance::Relative(0.03), 2.0, 0.0);
        assert!(log.logarithmic && log.prior == 0.03 && log.value(0.0) == 2.0);
        assert!((log.place(log.value(0.7)) - 0.7).abs() < 1e-12);
        let linear = free(DataSheetTolerance::Absolute(0.5), -2.0, f64::NEG_INFINITY);
        assert_eq!((linear.logarithmic, linear.size, linear.prior), (false, 2.0, 0.25));
        assert_eq!(free(DataSheetTolerance::Free, 0.0, 0.0).size, 10.0);
        assert!(free(DataSheetTolerance::Free, 2.0, 0.1).logarithmic);
    }
}
