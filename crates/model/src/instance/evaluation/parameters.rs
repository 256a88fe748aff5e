//! Values of constants and parameters, and of attributes, where they must be known when the model is built.
//!
//! The evaluator asks for them in the mode `constant`, `flat` asks for attributes and binding equations.
//! Each parameter asked for becomes structural: its value is built into the flat model.
//! Values from outside are handled here as well: they may have units, as in `--set p=200bar`.

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
    /// The value of constant or parameter `i`, an index into `variables`. `None` after a message.
    ///
    /// The variable becomes structural, and its value is kept. `span` is where the value is needed.
    ///
    /// The value is found once and kept. While it is being found the variable is `busy`.
    /// A variable that depends on itself is reported with both places.
    pub(in crate::instance) fn known_value(&mut self, i: u32, span: Span) -> Option<ModelicaValue> {
        let data = &mut self.instance.variables[i as usize];
        if let Some(known) = &data.constant {
            return known.clone().ok();
        }
        // Meeting a variable that is being evaluated means that its binding equation leads back to it.
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
        // A failure is kept too, so that its message appears once.
        data.constant = Some(value.clone().ok_or(()));
        value
    }

    /// Evaluates the binding equation of a parameter, or its start value if it has none (MLS 4.5).
    /// Reports a parameter that has neither. `None` after a message.
    ///
    /// The value is checked against the type of the variable.
    /// Parameters without a value are reported with the place where the value is needed.
    pub(in crate::instance) fn find_known(&mut self, i: u32, span: Span) -> Option<ModelicaValue> {
        let data = &self.instance.variables[i as usize];
        let (name, declared, ty) = (data.name.clone(), data.span, data.ty);
        let start = data.attributes.iter().find(|(n, _)| *n == "start").map(|(_, b)| b.clone());
        // A parameter without a binding equation takes its start value (MLS 8.6).
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

    /// Evaluates what is bound to variable `i`: its binding equation or an attribute.
    ///
    /// Checks that Strings and external objects get values of their kind. `coerce` checks the numeric types.
    /// A quantity given from outside is converted to the unit of the variable. `None` after a message.
    ///
    /// `constant` asks for parameters by value. With it false the result may contain parameters as symbols.
    /// A number in quotes gets a hint, since units are written that way by mistake.
    /// `b` is the expression with the place of its names, `i` an index into `variables`.
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

    /// The value of a binding from outside in one of the forms that Modelica does not have.
    ///
    /// These are quantities with units, literals of the variable's own enumeration without its name, and Strings
    /// without quotes. The outer `None` means that the text is an ordinary expression, the inner one that a message was
    /// reported.
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

    /// A quantity in `unit` as a number in the unit of variable `i`. `None` after a message.
    ///
    /// Both units must have the same dimension. If the variable has no unit, the quantity is refused.
    /// If it is not clear whether the variable is a temperature or a difference, a message asks for the variable's own
    /// unit.
    /// `x` is the number and `unit` the unit as given, as in `200 bar`.
    pub(in crate::instance) fn converted(&mut self, i: u32, x: f64, unit: &str) -> Option<f64> {
        let name = self.instance.variables[i as usize].name.clone();
        let own = self.text_attribute(i, "unit").unwrap_or_default();
        let parsed =
            (bramah_expr::units::MeasurementUnit::parse(unit), bramah_expr::units::MeasurementUnit::parse(&own));
        let converted = match parsed {
            // Units with an offset, as degrees Celsius: a temperature and a temperature difference convert differently.
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

    /// Whether a variable in a unit of temperature is a temperature difference.
    ///
    /// The annotation `absoluteValue` of its type decides (MLS 18.9), then "Difference" in its quantity or in the name
    /// of a type. A unit with an offset, or a quantity that ends in "Temperature", makes it an absolute temperature.
    /// `None` if none of these applies.
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

    /// The declared type of a variable followed by the types it extends. Empty for predefined types.
    /// The list begins with the class itself. It is used to read annotations and names along the chain of types.
    /// A component of a record or array is found by its own name.
    fn types_of(&mut self, i: u32) -> Vec<&'a ast::Class> {
        let data = &self.instance.variables[i as usize];
        let (scope, last) = (data.scope, data.name.rsplit('.').next().unwrap_or(""));
        // The variable has no reference to its declaration: the last part of its name, without subscripts, finds it.
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

    /// The value of a String attribute such as `unit`. `None` if it is not set, or after a message.
    /// Also `displayUnit` and `quantity`. A value that is no String is reported once for each place.
    /// A unit may be given by a parameter; then it is evaluated by value.
    pub fn text_attribute(&mut self, i: u32, attribute: &str) -> Option<String> {
        let found = self.instance.variables[i as usize].attributes.iter().find(|(n, _)| *n == attribute);
        let b = found.map(|(_, b)| b.clone())?;
        // Almost all units are plain literals: these need no evaluation.
        if let (ExprKind::String(s), true) = (&b.expr.kind, b.access.is_empty()) {
            return Some(s.to_string());
        }
        let value = self.instance.evaluator().binding_value(&b, true)?;
        let text = value.as_text(&self.instance.exprs);
        // The elements of an array share the modifier, and one message is enough.
        let reported = |d: &Diagnostic| d.labels.first().is_some_and(|l| l.span == b.expr.span);
        if text.is_none() && !self.instance.diagnostics.iter().any(reported) {
            let name = self.instance.variables[i as usize].name.clone();
            let message = format!("`{attribute}` of `{name}` is a String and cannot take {}", value.describe());
            let d = Diagnostic::new(Code::TypeMismatch, message).at(b.expr.span, "the value").instance(name);
            self.instance.report(d.help(format!("write a text in quotes, as in `{attribute} = \"...\"`")));
        }
        text
    }

    /// The value of an attribute that must be known when the model is built, as `fixed` or `stateSelect`.
    /// Booleans are 0 and 1, enumeration values their numbers. `None` after a message.
    pub fn known_attribute(&mut self, i: u32, attribute: Symbol, b: &Binding<'a>, ty: ScalarType) -> Option<f64> {
        let value = self.instance.evaluator().binding_value(b, true)?;
        let name = format!("{}.{attribute}", self.instance.variables[i as usize].name);
        self.coerce(value, ty, &name, b.expr.span)?.as_number(&self.instance.exprs)
    }

    /// Evaluates the String parameters of the model that nobody has read.
    /// Strings are not in the flat model, so errors in them would otherwise pass unnoticed.
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

    /// The name of a type with its article, for messages: "a Real", "an enumeration `Color`".
    pub(in crate::instance) fn type_words(&self, ty: ScalarType) -> String {
        match ty {
            ScalarType::Enumeration(i) => {
                format!("an enumeration `{}`", short(&self.instance.enumerations[i as usize].name))
            }
            other => type_name(other).into(),
        }
    }

    /// Checks a value against the type of the scalar variable that takes it, and makes Integers Reals where needed.
    /// `None` after a message. Strings and external objects pass; `bound` has checked them.
    ///
    /// `name` is the name of the variable for messages. The value must be a single one: arrays and records are
    /// reported.
    /// Integers fit Reals, every other difference of types is an error (MLS 10.6.13).
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

/// How to convert a value of one type to another, as help in messages.
/// `from` is the type of the value, `to` that of the variable. The text completes a message about their difference.
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

/// A type with its article, for messages. Enumerations are not named.
pub(in crate::instance) fn type_name(ty: ScalarType) -> &'static str {
    match ty {
        ScalarType::Real => "a Real",
        ScalarType::Integer => "an Integer",
        ScalarType::Boolean => "a Boolean",
        ScalarType::Enumeration(_) => "an enumeration",
    }
}
