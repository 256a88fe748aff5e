//! Resolves the names of a study in a compiled model.
//!
//! A [`Study`] and a [`FlatModel`] enter; a [`BoundStudy`] leaves, whose entries hold variables and values in their
//! units. All mistakes are collected before it fails, so that a user sees them at once.

use super::table::at;
use super::{Amount, InputColumn, ParameterEntry, RecordingFile, SignalColumn, Study};
use bramah_expr::VarId;
use bramah_expr::units::MeasurementUnit;
use bramah_model::flat::{FlatModel, FlatVariable, ScalarType, Variability};
use bramah_solve::Interpolation;
use bramah_syntax::diag::{Code, Diagnostic, Span, StageResult, nearest};
use std::path::PathBuf;

/// A study whose names are resolved in a model.
#[derive(Clone, Debug)]
pub struct BoundStudy {
    /// The driven inputs, in the order of the study.
    pub inputs: Vec<BoundInput>,
    /// The measured signals, in the order of the study.
    pub signals: Vec<BoundSignal>,
    /// The parameters listed, in the order of the study.
    pub parameters: Vec<BoundParameter>,
    /// The folder of the study, which recordings are relative to by default.
    pub(super) folder: PathBuf,
    /// The recordings, not yet read.
    pub(super) recordings: Vec<RecordingFile>,
}

/// An input with the column that drives it.
#[derive(Clone, Debug, PartialEq)]
pub struct BoundInput {
    /// The model's input.
    pub variable: VarId,
    /// Its name.
    pub name: String,
    /// Its unit; empty where it has none.
    pub unit: String,
    /// Whether it is a temperature difference, which converts without offset.
    pub difference: bool,
    /// How values between samples are interpolated.
    pub interpolation: Interpolation,
    /// The entry of the study.
    pub entry: InputColumn,
}

/// A measured variable with its column.
#[derive(Clone, Debug, PartialEq)]
pub struct BoundSignal {
    /// The name that reports use.
    pub name: String,
    /// The model's variable.
    pub variable: VarId,
    /// The variable's unit; empty where it has none.
    pub unit: String,
    /// Whether it is a temperature difference, which converts without offset.
    pub difference: bool,
    /// The sensor's range in the variable's unit; `None` where the study does not state it.
    pub full_scale: Option<f64>,
    /// One standard deviation of the sensor: a share of the full scale, or a value in the variable's unit.
    pub accuracy: Option<Amount>,
    /// The entry of the study.
    pub entry: SignalColumn,
}

impl BoundSignal {
    /// One standard deviation in the variable's unit; `None` where the study does not state it.
    pub fn deviation(&self, full_scale: f64) -> Option<f64> {
        match self.accuracy {
            Some(Amount::Part(part)) => Some(part * full_scale),
            Some(Amount::Value(value, _)) => Some(value),
            None => None,
        }
    }
}

/// How well a parameter is known before the fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DataSheetTolerance {
    /// It is never changed.
    Exact,
    /// One standard deviation relative to the value; log-normal where the value is positive.
    Relative(f64),
    /// One standard deviation in the parameter's unit.
    Absolute(f64),
    /// Only its bounds are known.
    Free,
}

/// A parameter with its tolerance and bounds.
#[derive(Clone, Debug, PartialEq)]
pub struct BoundParameter {
    /// The model's parameter.
    pub variable: VarId,
    /// Its name.
    pub name: String,
    /// Its unit; empty where it has none.
    pub unit: String,
    /// Its tolerance.
    pub knowledge: DataSheetTolerance,
    /// Lower bound in its unit; `None` for that of the model.
    pub min: Option<f64>,
    /// Upper bound in its unit; `None` for that of the model.
    pub max: Option<f64>,
    /// Where the study speaks of it.
    pub span: Span,
}

impl Study {
    /// Resolves the study in a model.
    ///
    /// # Errors
    /// [`Code::BadStudy`]: names that the model does not have, units that cannot be converted, parameters that cannot
    /// be changed, bounds in the wrong order, inputs without a column or value.
    pub fn bind(&self, model: &FlatModel) -> StageResult<BoundStudy> {
        let mut binder = StudyBinder { model, diagnostics: Vec::new() };
        let bound = BoundStudy {
            inputs: self.inputs.iter().filter_map(|i| binder.input(i)).collect(),
            signals: self.signals.iter().filter_map(|s| binder.signal(s)).collect(),
            parameters: self.parameters.iter().filter_map(|p| binder.parameter(p)).collect(),
            folder: self.folder.clone(),
            recordings: self.recordings.clone(),
        };
        binder.check_inputs(self, &bound);
        if binder.diagnostics.is_empty() {
            StageResult::new(bound, Vec::new())
        } else {
            StageResult::failed(binder.diagnostics)
        }
    }
}

/// Resolves entries one by one and collects their mistakes.
struct StudyBinder<'a> {
    model: &'a FlatModel,
    diagnostics: Vec<Diagnostic>,
}

impl<'a> StudyBinder<'a> {
    /// Adds a mistake at a place of the study.
    fn report(&mut self, span: Span, message: impl Into<String>, label: impl Into<String>) {
        self.diagnostics.push(at(span, message, label));
    }

    /// The variable with a name. `fits` only selects the names that the message proposes; the caller checks the
    /// variable.
    fn find(
        &mut self,
        span: Span,
        what: &str,
        name: &str,
        fits: fn(&FlatVariable) -> bool,
    ) -> Option<(VarId, &'a FlatVariable)> {
        let variables = &self.model.variables;
        if let Some(i) = variables.iter().position(|v| v.name == name) {
            let id = VarId(u32::try_from(i).expect("fewer than 2^32 variables"));
            return Some((id, &variables[i]));
        }
        let mut d = at(span, format!("the model has no {what} `{name}`"), "not in the model");
        let known: Vec<&str> = variables.iter().filter(|v| fits(v) && !v.hidden).map(|v| v.name.as_str()).collect();
        if let Some(near) = nearest(name, known.iter().copied()) {
            d = d.help(format!("did you mean `{near}`?"));
        } else if known.len() <= 20 && !known.is_empty() {
            d = d.help(format!("known: {}", known.join(", ")));
        }
        self.diagnostics.push(d);
        None
    }

    /// An entry of `[inputs]`; `None` with a message where it does not fit.
    fn input(&mut self, entry: &InputColumn) -> Option<BoundInput> {
        let (variable, v) = self.find(entry.span, "input", &entry.name, |v| v.input)?;
        if !v.input {
            self.report(entry.span, format!("`{}` is not an input of the model", entry.name), "computed by the model");
            return None;
        }
        let unit = v.unit.as_deref().unwrap_or("").to_owned();
        self.check_unit(entry.span, entry.unit.as_deref(), &unit, &entry.name)?;
        // Integer and Boolean inputs have no values between samples.
        let held = entry.hold || v.ty != ScalarType::Real;
        let interpolation = if held { Interpolation::Held } else { Interpolation::Linear };
        let (name, difference) = (entry.name.clone(), v.difference);
        Some(BoundInput { variable, name, unit, difference, interpolation, entry: entry.clone() })
    }

    /// An entry of `[signals]`; `None` with a message where it does not fit.
    fn signal(&mut self, entry: &SignalColumn) -> Option<BoundSignal> {
        let varies = |v: &FlatVariable| v.variability > Variability::Parameter;
        let (variable, v) = self.find(entry.span, "variable", &entry.variable, varies)?;
        if !varies(v) {
            self.report(entry.span, format!("`{}` does not change during a run", entry.variable), "a parameter");
            return None;
        }
        let unit = v.unit.as_deref().unwrap_or("").to_owned();
        self.check_unit(entry.span, entry.unit.as_deref(), &unit, &entry.variable)?;
        let full_scale = self.amount(entry.span, entry.full_scale.as_ref(), &unit, entry.unit.as_deref());
        let accuracy = match &entry.accuracy {
            // A share stays one: the full scale may come from recordings that are not read yet.
            Some(Amount::Part(part)) => Some(Amount::Part(*part)),
            other => {
                self.amount(entry.span, other.as_ref(), &unit, entry.unit.as_deref()).map(|v| Amount::Value(v, None))
            }
        };
        let (name, difference) = (entry.name.clone(), v.difference);
        Some(BoundSignal { name, variable, unit, difference, full_scale, accuracy, entry: entry.clone() })
    }

    /// An amount as a difference in the variable's unit. A plain number counts in the column's unit.
    fn amount(&mut self, span: Span, amount: Option<&Amount>, unit: &str, column: Option<&str>) -> Option<f64> {
        let amount = match amount? {
            Amount::Value(value, None) => Amount::Value(*value, column.map(str::to_owned)),
            other => other.clone(),
        };
        match amount.difference_in_unit(unit, 0.0) {
            Ok(value) => Some(value),
            Err(why) => {
                self.report(span, why, "in this entry");
                None
            }
        }
    }

    /// Checks that the column's unit converts to the variable's; `None` with a message where it does not.
    fn check_unit(&mut self, span: Span, column: Option<&str>, unit: &str, name: &str) -> Option<()> {
        match conversion(column.unwrap_or(""), unit) {
            Ok(_) => Some(()),
            Err(()) => {
                let column = column.unwrap_or("");
                let text = format!("the column is in `{column}`, `{name}` in `{unit}`");
                let help = "give a `unit` of the same kind, or tie the column to another variable";
                self.diagnostics.push(at(span, text, "cannot be converted").help(help));
                None
            }
        }
    }

    /// An entry of `[parameters]`; `None` with a message where it does not fit.
    fn parameter(&mut self, entry: &ParameterEntry) -> Option<BoundParameter> {
        let parameter = |v: &FlatVariable| v.variability == Variability::Parameter;
        let (variable, v) = self.find(entry.span, "parameter", &entry.name, parameter)?;
        match v.variability {
            Variability::Parameter if v.ty == ScalarType::Real => {}
            Variability::Parameter => {
                self.report(entry.span, format!("`{}` is not a real number", entry.name), "cannot be varied smoothly");
                return None;
            }
            // The structure depends on it, so it is a constant of the flat model. `"exact"` asks for nothing else.
            Variability::Constant if entry.exact => return None,
            Variability::Constant => {
                let text = format!("the structure of the model depends on `{}`", entry.name);
                let d = at(entry.span, text, "it cannot be moved");
                self.diagnostics.push(d.help("call it `\"exact\"`, or leave it out"));
                return None;
            }
            _ => {
                self.report(entry.span, format!("`{}` is not a parameter", entry.name), "it changes during a run");
                return None;
            }
        }
        let unit = v.unit.as_deref().unwrap_or("").to_owned();
        let bound = |binder: &mut Self, b| binder.bound(entry, b, &unit, v.difference);
        let (min, max) = (bound(self, &entry.min), bound(self, &entry.max));
        if min.zip(max).is_some_and(|(a, b)| a >= b) {
            self.report(entry.span, format!("`min` of `{}` does not lie below its `max`", entry.name), "here");
        }
        let knowledge = match &entry.sigma {
            _ if entry.exact => DataSheetTolerance::Exact,
            Some(Amount::Part(part)) => DataSheetTolerance::Relative(*part),
            None => DataSheetTolerance::Free,
            absolute => DataSheetTolerance::Absolute(self.amount(entry.span, absolute.as_ref(), &unit, None)?),
        };
        Some(BoundParameter { variable, name: entry.name.clone(), unit, knowledge, min, max, span: entry.span })
    }

    /// A bound in the parameter's unit.
    fn bound(&mut self, entry: &ParameterEntry, bound: &Option<Amount>, unit: &str, difference: bool) -> Option<f64> {
        let bound = bound.as_ref()?;
        let value = if difference { bound.difference_in_unit(unit, 0.0) } else { bound.in_unit(unit, 0.0) };
        value.map_err(|why| self.report(entry.span, why, "a bound of this parameter")).ok()
    }

    /// Checks that every input of the model has a column, or a value of its own.
    fn check_inputs(&mut self, study: &Study, bound: &BoundStudy) {
        for (i, v) in (0u32..).zip(&self.model.variables) {
            let driven = bound.inputs.iter().any(|b| b.variable == VarId(i));
            let named = study.inputs.iter().any(|e| e.name == v.name);
            if v.input && !driven && !named && v.binding.is_none() && v.start.is_none() {
                let d = Diagnostic::new(Code::BadStudy, format!("the input `{}` has no column", v.name))
                    .help(format!("add to `[inputs]`: {} = {{ column = \"...\" }}", v.name));
                self.diagnostics.push(d);
            }
        }
    }
}

/// The two units of a conversion. `Ok(None)` where values stay as they are; `Err` where units are unknown or do not
/// convert.
pub(super) fn conversion(from: &str, to: &str) -> Result<Option<(MeasurementUnit, MeasurementUnit)>, ()> {
    // A missing unit on either side means that the values are already in the other one.
    if from.is_empty() || to.is_empty() || from == to {
        return Ok(None);
    }
    let (from, to) = (MeasurementUnit::parse(from).map_err(|_| ())?, MeasurementUnit::parse(to).map_err(|_| ())?);
    if from.convert(0.0, &to).is_some() { Ok(Some((from, to))) } else { Err(()) }
}
