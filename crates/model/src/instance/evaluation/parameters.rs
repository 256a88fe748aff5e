//! Values of constants and parameters, and of attributes, where they must be known; values given from outside.

use crate::instance::building::components::says;
use crate::instance::building::given::QUANTITY;
use crate::instance::errors::short;
use crate::instance::lookup::LookupResult;
use crate::instance::modifiers::Binding;
use crate::instance::template::TemplateElementKind;
use crate::instance::value::ModelicaValue;
use crate::instance::{LookupContext, ParameterValues};
use bramah_expr::types::{ScalarType, Variability};
use bramah_syntax::ast::{self, ExprKind};
use bramah_syntax::diag::{Code, Diagnostic, Span};
use bramah_syntax::symbol::Symbol;

impl<'a> ParameterValues<'_, 'a, '_> {
    /// The value of a constant or parameter.
    pub(in crate::instance) fn known_value(&mut self, i: u32, span: Span) -> Option<ModelicaValue> {
        let data = &mut self.instance.variables[i as usize];
        if let Some(known) = &data.constant {
            return known.clone().ok();
        }
        if data.busy {
            let (name, declared) = (data.name.clone(), data.span);
            self.instance.report(
                Diagnostic::new(Code::CyclicParameter, format!("`{name}` depends on itself"))
                    .at(declared, "its value leads back to itself")
                    .at(span, "used here")
                    .help("give one of the parameters of the cycle a number"),
            );
            return None;
        }
        data.busy = true;
        data.structural = true;
        let value = self.find_known(i, span);
        let data = &mut self.instance.variables[i as usize];
        data.busy = false;
        data.constant = Some(value.clone().ok_or(()));
        value
    }

    pub(in crate::instance) fn find_known(&mut self, i: u32, span: Span) -> Option<ModelicaValue> {
        let data = &self.instance.variables[i as usize];
        let (name, declared, ty) = (data.name.clone(), data.span, data.ty);
        let start = data.attributes.iter().find(|(n, _)| *n == "start").map(|(_, b)| b.clone());
        match data.binding.clone().or(start) {
            Some(b) => {
                let value = self.bound(i, &b, true)?;
                self.coerce(value, ty, &name, b.expr.span)
            }
            None => {
                self.instance.report(
                    Diagnostic::new(Code::NoValue, format!("`{name}` has no value"))
                        .at(declared, "declared without `= value`")
                        .at(span, "its value is needed here")
                        .instance(name.clone())
                        .help(format!(
                            "give it one where it is used, as in `({} = ...)`, or with `--set {name}=...`",
                            name.rsplit('.').next().unwrap_or(&name)
                        )),
                );
                None
            }
        }
    }

    /// The value bound to a variable; a quantity given from outside is converted to the variable's unit.
    pub fn bound(&mut self, i: u32, b: &Binding<'a>, constant: bool) -> Option<ModelicaValue> {
        if Some(b.expr.span.file) == self.instance.eval.override_file
            && let Some(v) = self.outside_value(i, b)
        {
            return v;
        }
        let value = self.instance.evaluator().binding_value(b, constant)?;
        let data = &self.instance.variables[i as usize];
        match (data.string, &value) {
            (false, ModelicaValue::Text(_) | ModelicaValue::Object(_)) if !data.object => {
                let name = data.name.clone();
                let message = format!("`{name}` is {} and cannot take {}", type_name(data.ty), value.describe());
                let numeric = data.ty == ScalarType::Real;
                let mut d = Diagnostic::new(Code::TypeMismatch, message).at(b.expr.span, "the value").instance(name);
                if numeric {
                    d = d.help("write a number without quotes, in the SI unit of the variable: 200 bar are `200e5`; only `--set` and experiment files take units");
                }
                self.instance.report(d);
                None
            }
            (_, other) if data.object && !matches!(other, ModelicaValue::Object(_)) => {
                let name = data.name.clone();
                let message = format!("`{name}` is an external object and cannot take {}", value.describe());
                self.instance
                    .report(Diagnostic::new(Code::TypeMismatch, message).at(b.expr.span, "the value").instance(name));
                None
            }
            (true, other) if !matches!(other, ModelicaValue::Text(_)) => {
                let name = data.name.clone();
                let message = format!("`{name}` is a String and cannot take {}", value.describe());
                let d = Diagnostic::new(Code::TypeMismatch, message).at(b.expr.span, "the value").instance(name);
                self.instance.report(d.help("write a text in quotes; `String(x)` makes one of a number"));
                None
            }
            _ => Some(value),
        }
    }

    /// Values from outside may be quantities with units, literals of the variable's own enumeration, and texts without
    /// quotes.
    pub(in crate::instance) fn outside_value(&mut self, i: u32, b: &Binding<'a>) -> Option<Option<ModelicaValue>> {
        let data = &self.instance.variables[i as usize];
        if data.string && !matches!(b.expr.kind, ExprKind::String(_)) {
            return self.instance.eval.texts.get(&data.name).map(|raw| Some(ModelicaValue::text(raw.trim())));
        }
        match &b.expr.kind {
            ExprKind::Call { function, args, .. } if function.parts[0].name.name == QUANTITY => {
                let (number, unit) = (
                    self.instance.evaluator().eval(&args[0], b.view)?,
                    self.instance.evaluator().eval(&args[1], b.view)?,
                );
                let x = number.as_number(&self.instance.exprs)?;
                let unit = unit.as_text(&self.instance.exprs)?;
                Some(
                    self.converted(i, x, &unit)
                        .map(|x| ModelicaValue::Scalar(self.instance.exprs.num(x), ScalarType::Real)),
                )
            }
            ExprKind::Reference(r) if r.parts.len() == 1 => {
                let ScalarType::Enumeration(e) = self.instance.variables[i as usize].ty else { return None };
                let at =
                    self.instance.enumerations[e as usize].literals.iter().position(|l| *l == r.parts[0].name.name)?;
                Some(Some(ModelicaValue::Scalar(self.instance.exprs.num(at as f64 + 1.0), ScalarType::Enumeration(e))))
            }
            _ => None,
        }
    }

    pub(in crate::instance) fn converted(&mut self, i: u32, x: f64, unit: &str) -> Option<f64> {
        let name = self.instance.variables[i as usize].name.clone();
        let own = self.text_attribute(i, "unit").unwrap_or_default();
        let parsed =
            (bramah_expr::units::MeasurementUnit::parse(unit), bramah_expr::units::MeasurementUnit::parse(&own));
        let converted = match parsed {
            (Ok(from), Ok(to)) if from.dimension == to.dimension && from.offset != to.offset => {
                match self.is_difference(i) {
                    Some(difference) => from.meant(difference).convert(x, &to.meant(difference)),
                    None => {
                        self.instance.report(
                            Diagnostic::new(Code::BadSet, format!("`{x} {unit}` can be two values of `{name}`"))
                                .note(format!(
                                    "`{name}` is in `{own}`, and its type does not tell a temperature from a difference"
                                ))
                                .help(format!("give it in `{own}`"))
                                .help("or declare it as `Modelica.Units.SI.Temperature` or `TemperatureDifference`"),
                        );
                        return None;
                    }
                }
            }
            (Ok(from), Ok(to)) => from.convert(x, &to),
            _ => None,
        };
        if converted.is_none() {
            self.instance.report(
                Diagnostic::new(Code::BadSet, format!("`{x} {unit}` cannot be given to `{name}`"))
                    .note(if own.is_empty() {
                        format!("`{name}` has no unit")
                    } else {
                        format!("`{name}` is in `{own}`")
                    })
                    .help("give a plain number in the variable's own unit, or a unit of the same kind"),
            );
        }
        converted
    }

    /// Whether a variable in a unit of temperature is a difference, by the annotation `absoluteValue` of its type (MLS
    /// 18.9), its unit for people or its quantity; `None` where none of them tells.
    pub fn is_difference(&mut self, i: u32) -> Option<bool> {
        let types = self.types_of(i);
        let said = types.iter().find_map(|t| says(t.annotation.as_ref()?, "absoluteValue"));
        if let Some(absolute) = said {
            return Some(!absolute);
        }
        let quantity = self.text_attribute(i, "quantity").unwrap_or_default();
        let named = |name: &str| name.contains("Difference");
        if named(&quantity) || types.iter().any(|t| named(t.name.name.as_str())) {
            return Some(true);
        }
        let mut from_a_zero = |attribute: &str| {
            let unit = self.text_attribute(i, attribute).unwrap_or_default();
            bramah_expr::units::MeasurementUnit::parse(&unit).is_ok_and(|u| u.offset != 0.0)
        };
        let from_a_zero = from_a_zero("unit") || from_a_zero("displayUnit");
        (from_a_zero || quantity.ends_with("Temperature")).then_some(false)
    }

    /// The declared type of a variable and what it extends, outermost first; nothing for a built-in one.
    fn types_of(&mut self, i: u32) -> Vec<&'a ast::Class> {
        let data = &self.instance.variables[i as usize];
        let (scope, last) = (data.scope, data.name.rsplit('.').next().unwrap_or(""));
        let name = Symbol::new(last.split('[').next().unwrap_or(""));
        let template = self.instance.scope(scope).template.clone();
        let Some(element) = template.by_name.get(&name).map(|&e| &template.elements[e as usize]) else {
            return Vec::new();
        };
        let TemplateElementKind::Component(declared) = element.kind else { return Vec::new() };
        match self.instance.names().lookup_path(LookupContext { scope, base: element.base }, &declared.class) {
            Ok(LookupResult::Class(c)) => {
                self.instance.names().template(c.class, c.parent).bases.iter().map(|b| b.ast).collect()
            }
            _ => Vec::new(),
        }
    }

    /// An attribute that is a text, such as `unit`.
    pub fn text_attribute(&mut self, i: u32, attribute: &str) -> Option<String> {
        let found = self.instance.variables[i as usize].attributes.iter().find(|(n, _)| *n == attribute);
        let b = found.map(|(_, b)| b.clone())?;
        if let (ExprKind::String(s), true) = (&b.expr.kind, b.access.is_empty()) {
            return Some(s.to_string());
        }
        let value = self.instance.evaluator().binding_value(&b, true)?;
        let text = value.as_text(&self.instance.exprs);
        let reported = |d: &Diagnostic| d.labels.first().is_some_and(|l| l.span == b.expr.span);
        if text.is_none() && !self.instance.diagnostics.iter().any(reported) {
            let name = self.instance.variables[i as usize].name.clone();
            let message = format!("`{attribute}` of `{name}` is a String and cannot take {}", value.describe());
            let d = Diagnostic::new(Code::TypeMismatch, message).at(b.expr.span, "the value").instance(name);
            self.instance.report(d.help(format!("write a text in quotes, as in `{attribute} = \"...\"`")));
        }
        text
    }

    /// An attribute that must be known while the model is built, such as `fixed`.
    pub fn known_attribute(&mut self, i: u32, attribute: Symbol, b: &Binding<'a>, ty: ScalarType) -> Option<f64> {
        let value = self.instance.evaluator().binding_value(b, true)?;
        let name = format!("{}.{attribute}", self.instance.variables[i as usize].name);
        self.coerce(value, ty, &name, b.expr.span)?.as_number(&self.instance.exprs)
    }

    /// Texts have no place in the flat model: those of the model's own parameters are looked at here, read or not.
    pub fn check_texts(&mut self) {
        for i in 0..u32::try_from(self.instance.variables.len()).expect("limited above") {
            let data = &self.instance.variables[i as usize];
            let given = data.binding.is_some() || data.variability <= Variability::Parameter;
            if data.string && given && data.constant.is_none() && self.instance.scope(data.scope).component {
                let span = data.span;
                self.known_value(i, span);
            }
        }
    }

    pub(in crate::instance) fn type_words(&self, ty: ScalarType) -> String {
        match ty {
            ScalarType::Enumeration(i) => {
                format!("an enumeration `{}`", short(&self.instance.enumerations[i as usize].name))
            }
            other => type_name(other).into(),
        }
    }

    /// Checks a value against the type of the variable that takes it.
    pub fn coerce(&mut self, value: ModelicaValue, ty: ScalarType, name: &str, span: Span) -> Option<ModelicaValue> {
        match &value {
            ModelicaValue::Text(_) | ModelicaValue::Object(_) => Some(value),
            ModelicaValue::Scalar(e, own) => match (own, ty) {
                (a, b) if *a == b => Some(value),
                (ScalarType::Integer, ScalarType::Real) => Some(ModelicaValue::Scalar(*e, ScalarType::Real)),
                _ => {
                    let (wanted, given) = (self.type_words(ty), self.type_words(*own));
                    let d =
                        Diagnostic::new(Code::TypeMismatch, format!("`{name}` is {wanted} and cannot take {given}"))
                            .at(span, "the value")
                            .help(conversion(*own, ty));
                    self.instance.report(d.instance(name.to_string()));
                    None
                }
            },
            _ => {
                let d = Diagnostic::new(
                    Code::SizeMismatch,
                    format!("`{name}` is a single value, {}, and cannot take {}", type_name(ty), value.describe()),
                )
                .at(span, "the value");
                self.instance.report(d.instance(name.to_string()));
                None
            }
        }
    }
}

/// How a value of one type is made one of another.
pub(in crate::instance) fn conversion(from: ScalarType, to: ScalarType) -> &'static str {
    match (from, to) {
        (ScalarType::Real, ScalarType::Integer) => {
            "`integer(x)` is the whole number below `x`, `div(a, b)` divides whole numbers; or declare it as Real"
        }
        (ScalarType::Real | ScalarType::Integer, ScalarType::Boolean) => {
            "write a relation, as in `x > 0`, or `true` and `false`"
        }
        (ScalarType::Boolean, ScalarType::Real | ScalarType::Integer) => "write `if b then 1 else 0`",
        (ScalarType::Enumeration(_), ScalarType::Real | ScalarType::Integer) => {
            "`Integer(e)` is the number of an enumeration value"
        }
        (_, ScalarType::Enumeration(_)) => "give one of the literals of its type, as in `Type.literal`",
        _ => "declare both with the same type",
    }
}

pub(in crate::instance) fn type_name(ty: ScalarType) -> &'static str {
    match ty {
        ScalarType::Real => "a Real",
        ScalarType::Integer => "an Integer",
        ScalarType::Boolean => "a Boolean",
        ScalarType::Enumeration(_) => "an enumeration",
    }
}
