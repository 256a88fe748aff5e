//! The unknowns of an identification: parameters in scales that suit the search.

use super::IdentificationProblem;
use crate::study::{BoundParameter, DataSheetTolerance};
use bramah_expr::VarId;

/// A parameter that is searched for. The search moves z, which is 0 at the start and of the order of 1.
#[derive(Clone, Debug, PartialEq)]
pub struct EstimatedParameter {
    /// The parameter.
    pub variable: VarId,
    /// Its name.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// Its value in the model.
    pub start: f64,
    /// theta = start exp(size z), else start + size z.
    pub logarithmic: bool,
    /// What one step of z means.
    pub size: f64,
    /// One standard deviation of what is known beforehand, in z; infinite for nothing.
    pub prior: f64,
    /// Bounds in the parameter's unit.
    pub min: f64,
    /// Bounds in the parameter's unit.
    pub max: f64,
}

impl EstimatedParameter {
    /// A parameter of the study with its value, bounds and nominal value in the model; `None` for exact ones.
    pub fn new(bound: &BoundParameter, start: f64, min: f64, max: f64, nominal: f64) -> Option<EstimatedParameter> {
        let min = bound.min.unwrap_or(min);
        let max = bound.max.unwrap_or(max);
        let usual = if start == 0.0 { nominal } else { start.abs() };
        let (logarithmic, prior) = match bound.knowledge {
            DataSheetTolerance::Exact => return None,
            DataSheetTolerance::Relative(part) => (start > 0.0, part),
            DataSheetTolerance::Absolute(sigma) => (false, sigma / usual),
            DataSheetTolerance::Free => (min > 0.0 && start > 0.0, f64::INFINITY),
        };
        let size = if logarithmic { 1.0 } else { usual };
        let (variable, name, unit) = (bound.variable, bound.name.clone(), bound.unit.clone());
        Some(EstimatedParameter { variable, name, unit, start, logarithmic, size, prior, min, max })
    }

    /// The parameter's value.
    pub fn value(&self, z: f64) -> f64 {
        if self.logarithmic { self.start * (self.size * z).exp() } else { self.start + self.size * z }
    }

    /// Where a value lies on the scale of the search.
    pub fn place(&self, value: f64) -> f64 {
        if self.logarithmic {
            if value > 0.0 { (value / self.start).ln() / self.size } else { f64::NEG_INFINITY }
        } else {
            (value - self.start) / self.size
        }
    }

    /// How much the value moves with z.
    pub fn slope(&self, z: f64) -> f64 {
        if self.logarithmic { self.value(z) * self.size } else { self.size }
    }
}

impl IdentificationProblem<'_> {
    /// Parameter values for a run.
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
