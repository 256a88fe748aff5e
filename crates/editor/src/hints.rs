//! Inlay hints: values and units shown behind the parameters of a text, such as `V = 10 ml`.
//!
//! [`ParameterHints`] stores the values of models that the background check has compiled. `hints` puts them behind
//! the bindings in a file, where the text has an expression or a number in SI units.

use super::DocumentView;
use bramah_circuit::compiled::CompiledModel;
use bramah_expr::VarId;
use bramah_expr::types::Variability;
use bramah_expr::units::MeasurementUnit;
use bramah_model::resolve::ClassId;
use bramah_syntax::ast::{ElementKind, Expr, Modification, ModificationArgument, ModificationArgumentKind};
use lsp_types::{InlayHint, InlayHintLabel};
use rustc_hash::FxHashMap;

/// Values of parameters of compiled models.
#[derive(Clone, Debug, Default)]
pub struct ParameterHints {
    /// By full class name, then by the full name of the parameter.
    models: FxHashMap<String, FxHashMap<String, HintValue>>,
}

/// The value of one parameter.
#[derive(Clone, Debug)]
struct HintValue {
    /// In `unit`.
    value: f64,
    /// Unit of the model; empty when there is none.
    unit: String,
    /// Unit for display; empty when there is none.
    display: String,
}

impl ParameterHints {
    /// Stores the parameters of a model and replaces those of an earlier version.
    ///
    /// Constants are stored too, as the text may contain expressions of them.
    pub fn learn(&mut self, model: &CompiledModel) {
        let system = &model.system;
        let mut values = system.layout.values();
        // Parameters may depend on others, so they are evaluated before they are read.
        system.evaluate_parameters(&mut values, &[]);
        let known = model.flat.variables.iter().enumerate().filter(|(_, v)| v.variability <= Variability::Parameter);
        let all = known.map(|(i, v)| {
            let value = values[system.layout.var(VarId(i as u32))];
            let text = |u: &Option<Box<str>>| u.as_deref().unwrap_or("").to_owned();
            (v.name.clone(), HintValue { value, unit: text(&v.unit), display: text(&v.display_unit) })
        });
        self.models.insert(model.flat.class.clone(), all.collect());
    }

    /// The value of a parameter in its unit, followed by the value in its display unit. `None`: the model or parameter
    /// is not known.
    pub fn value(&self, model: &str, name: &str) -> Option<String> {
        Some(self.models.get(model)?.get(name)?.shown(true))
    }
}

impl HintValue {
    /// The value as text. With `both`, the value in the unit of the model comes first.
    ///
    /// Without `both`, only the value in the display unit is given, if there is one.
    fn shown(&self, both: bool) -> String {
        let plain = format!("{} {}", bramah_results::number::text(self.value), self.unit).trim().to_owned();
        match self.converted() {
            Some(text) if both => format!("{plain} = {text}"),
            Some(text) => text,
            None => plain,
        }
    }

    /// The value in its display unit. `None`: there is no other display unit, or it does not fit.
    fn converted(&self) -> Option<String> {
        if self.display.is_empty() || self.display == self.unit {
            return None;
        }
        let (from, to) = (MeasurementUnit::parse(&self.unit).ok()?, MeasurementUnit::parse(&self.display).ok()?);
        let value = from.convert(self.value, &to)?;
        // Conversion adds digits that mean nothing, such as 9.999999999 bar.
        let rounded: f64 = format!("{value:.5e}").parse().ok()?;
        Some(format!("{} {}", bramah_results::number::text(rounded), self.display))
    }
}

/// The hints of a file, behind the bindings of its models.
///
/// Empty until the background check has compiled a model of the file.
pub fn hints(view: &mut DocumentView<'_, '_>, facts: &ParameterHints) -> Vec<InlayHint> {
    let mut found = Vec::new();
    for id in view.classes.clone() {
        of_class(view, id, facts, &mut found);
    }
    found
}

/// Adds the hints of one class, if it has been compiled as a model.
///
/// Bindings of components and modifiers in extends clauses are visited. Classes that were not compiled have no values.
fn of_class(view: &DocumentView<'_, '_>, id: ClassId, facts: &ParameterHints, found: &mut Vec<InlayHint>) {
    let Some(values) = facts.models.get(&view.library.full_name(id)) else { return };
    let Some(body) = bramah_model::resolve::names::body(view.library.class(id)) else { return };
    for element in &body.elements {
        match &element.kind {
            ElementKind::Component(c) => {
                modification(view, values, c.name.name.as_str(), c.modification.as_ref(), found);
            }
            ElementKind::Extends(x) => {
                let arguments = x.modification.iter().flat_map(|m| &m.arguments);
                arguments.for_each(|a| argument(view, values, "", a, found));
            }
            _ => {}
        }
    }
}

/// Adds the hint of a binding and those of the modifiers in its brackets. `name` is the full name in the model.
fn modification(
    view: &DocumentView<'_, '_>,
    values: &FxHashMap<String, HintValue>,
    name: &str,
    modification: Option<&Modification>,
    found: &mut Vec<InlayHint>,
) {
    let Some(modification) = modification else { return };
    if let (Some(value), Some(written)) = (values.get(name), &modification.value) {
        hint(view, value, written, found);
    }
    modification.arguments.iter().for_each(|a| argument(view, values, name, a, found));
}

/// Adds the hints of one modifier. `around` is the full name of the component; empty in an extends clause.
fn argument(
    view: &DocumentView<'_, '_>,
    values: &FxHashMap<String, HintValue>,
    around: &str,
    argument: &ModificationArgument,
    found: &mut Vec<InlayHint>,
) {
    if let ModificationArgumentKind::Modify { path, modification: m, .. } = &argument.kind {
        let name = if around.is_empty() { path.dotted() } else { format!("{around}.{}", path.dotted()) };
        modification(view, values, &name, m.as_ref(), found);
    }
}

/// Adds one hint. A number without a unit needs none, since the text shows it already.
///
/// A number gets its unit and, where there is one, the value in the display unit. An expression gets its value.
fn hint(view: &DocumentView<'_, '_>, value: &HintValue, written: &Expr, found: &mut Vec<InlayHint>) {
    let is_number = written.as_number().is_some();
    // An inherited binding may come from another file.
    if is_number && value.unit.is_empty() || written.span.file != view.file {
        return;
    }
    // A number is in the text, so only its unit is added; an expression gets its value.
    let label = match (is_number, value.converted()) {
        (true, None) => value.unit.clone(),
        (true, Some(text)) => format!("{} = {text}", value.unit),
        (false, _) => format!("= {}", value.shown(false)),
    };
    found.push(InlayHint {
        position: view.position(written.span.end),
        label: InlayHintLabel::String(label),
        kind: None,
        text_edits: None,
        tooltip: None,
        padding_left: Some(true),
        padding_right: None,
        data: None,
    });
}
