//! Values given from outside, as by `--set pump.D=20ml`: they become modifiers of the model.
//!
//! The values are written into a Modelica text, which is parsed like any other. Messages can then show their place.
//! Values of single array elements, as `a[2].p`, cannot be written as modifiers. They are kept and looked up by name
//! when the variable is built.

use crate::instance::building::components::ModelRequest;
use crate::instance::modifiers::{AccessStep, Binding, Modifier};
use crate::instance::{ComponentBuilder, InstanceVariable, LookupContext};
use bramah_expr::types::Variability;
use bramah_syntax::ast::{self};
use bramah_syntax::diag::FileId;
use bramah_syntax::diag::{Code, Diagnostic, nearest};
use std::rc::Rc;

impl<'a> ComponentBuilder<'_, 'a, '_> {
    /// The modifiers for all values of a request, outermost of all. Empty, after a message, if the text has errors.
    ///
    /// Whole names go into `model Set extends Model(pump.D = ...); end Set;`.
    ///
    /// `each` modifiers and subscripts inside names are handled by the form of the text.
    /// The texts of the values are kept by name, for Strings without quotes.
    /// `request` may contain both kinds of names.
    pub(in crate::instance) fn override_args(&mut self, request: &ModelRequest) -> Rc<[Modifier<'a>]> {
        if request.overrides.is_empty() {
            return Rc::from([]);
        }
        let (whole, elements): (Vec<&Override>, Vec<&Override>) =
            request.overrides.iter().partition(|o| element_name(&o.name).is_none());
        let list: Vec<String> = whole.iter().map(|o| format!("{} = {}", o.name, override_text(&o.value))).collect();
        self.instance.eval.texts = request.overrides.iter().map(|o| (o.name.clone(), o.value.clone())).collect();
        // A modifier names complete arrays, so values of single elements become declarations beside it.
        let beside: Vec<String> =
            (1..).zip(&elements).map(|(k, o)| format!("  Real element_{k} = {};\n", override_text(&o.value))).collect();
        let list = if list.is_empty() { String::new() } else { format!("(\n    {}\n  )", list.join(",\n    ")) };
        let text = format!("model Set\n  extends Model{list};\n{}end Set;\n", beside.concat());
        // The text must not appear among the user's own classes, and its parser errors get a message of their own.
        let before = self.instance.library.diagnostics.len();
        let own = self.instance.library.own.len();
        let ids = self.instance.library.add_text(GIVEN, &text);
        self.instance.library.own.truncate(own);
        let bad = self.instance.library.diagnostics.split_off(before);
        self.instance.eval.override_file = ids.first().map(|&id| self.instance.library.class(id).name.span.file);
        if !bad.is_empty() {
            let names: Vec<_> = request.overrides.iter().map(|o| format!("`{}={}`", o.name, o.value)).collect();
            self.instance.report(
                Diagnostic::new(Code::BadSet, format!("cannot read {}", names.join(", "))).help(
                    "a value is NAME=VALUE with a dotted name and a Modelica expression, or a number with a unit",
                ),
            );
            return Rc::from([]);
        }
        let Some(ast::ClassBody::Long(body)) = ids.first().map(|&id| &self.instance.library.class(id).body) else {
            return Rc::from([]);
        };
        let Some(ast::ElementKind::Extends(e)) = body.elements.first().map(|e| &e.kind) else { return Rc::from([]) };
        let view = LookupContext { scope: self.instance.root, base: 0 };
        let none: Rc<[AccessStep]> = Rc::from([]);
        let values = body.elements[1..].iter().filter_map(|e| match &e.kind {
            ast::ElementKind::Component(c) => c.modification.as_ref()?.value.as_ref(),
            _ => None,
        });
        for (o, expr) in elements.iter().zip(values) {
            let name = element_name(&o.name).unwrap_or_default();
            self.instance.eval.texts.insert(name.clone(), o.value.clone());
            let binding = Binding { expr, view, access: none.clone(), final_: false };
            self.instance.building.given_elements.push(GivenElement { name, binding, met: false });
        }
        // `each` is passed on: a value for `a.p` applies to all elements of an array `a`.
        let arguments = e.modification.iter().flat_map(|m| &m.arguments);
        arguments.filter_map(|a| Modifier::new(a, view, &none, true)).collect()
    }

    /// The value given for one array element or its `start`, by its full name. `None` if there is none.
    /// The entry is marked, so that values without an element can be reported.
    pub(in crate::instance) fn given_element(&mut self, name: &str) -> Option<Binding<'a>> {
        let mut found = None;
        for given in self.instance.building.given_elements.iter_mut().filter(|g| g.name == name) {
            given.met = true;
            found = Some(given.binding.clone());
        }
        found
    }

    /// Reports values given for array elements that do not exist or cannot be set.
    ///
    /// Nothing is reported if the model has errors, because its variables are not complete then.
    /// The help tells whether the array exists, whether the name is a variable of the run, or which name is similar.
    pub(in crate::instance) fn elements_not_met(&mut self) {
        let open: Vec<String> =
            self.instance.building.given_elements.iter().filter(|g| !g.met).map(|g| g.name.clone()).collect();
        if self.instance.diagnostics.iter().any(Diagnostic::is_error) {
            // what was not built could not meet anything
            return;
        }
        for name in open {
            // The variable exists but is no parameter, so the value was not looked up for it.
            if self.instance.variables.iter().any(|v| v.name == name) {
                let d = Diagnostic::new(Code::BadSet, format!("`{name}` is no parameter that can be set"));
                let help = format!("it varies during runs: its start value is `{name}.start`");
                self.instance.report(d.note("it was given from outside").help(help));
                continue;
            }
            // The message names the elements that the array has, or the most similar parameter.
            let array = name.rsplit_once('[').map_or("", |(array, _)| array);
            let known = |i: &&InstanceVariable<'_>| i.variability <= Variability::Parameter && !i.hidden;
            let of_array = |v: &&InstanceVariable<'_>| v.name.rsplit_once('[').is_some_and(|(a, _)| a == array);
            let mut elements = self.instance.variables.iter().filter(known).filter(of_array).map(|v| v.name.as_str());
            let help = match (elements.next(), elements.next_back()) {
                (Some(first), Some(last)) => format!("its elements are `{first}` to `{last}`"),
                (Some(only), None) => format!("its only element is `{only}`"),
                (None, _) if self.instance.variables.iter().any(|v| v.name == array) => {
                    format!("`{array}` is no array: `{array}=VALUE` sets it")
                }
                (None, _) => {
                    match nearest(&name, self.instance.variables.iter().filter(known).map(|v| v.name.as_str())) {
                        Some(near) => format!("did you mean `{near}`?"),
                        None => "`bramah check FILE --emit flat` lists all parameters".to_string(),
                    }
                }
            };
            let text = format!("the model has no parameter `{name}`");
            self.instance.report(Diagnostic::new(Code::BadSet, text).note("it was given from outside").help(help));
        }
    }
}

/// The path of the text of values from outside, shown in messages.
pub const GIVEN: &str = "<values given from outside>";

/// A value for a parameter or start attribute, given from outside.
#[derive(Clone, Debug, PartialEq)]
pub struct Override {
    /// Dotted name, as in `pump.D`, `vol.p.start` or `a[2].p`.
    pub name: String,
    /// An expression in Modelica syntax, or a number with a unit such as `0.8 ml`.
    pub value: String,
}

/// A value given from outside for one element of an array.
pub struct GivenElement<'a> {
    /// The full name with its subscripts, as the variable is called: `a[2].p`.
    name: String,
    /// The value, as an expression of the text.
    binding: Binding<'a>,
    /// A variable of this name was built.
    met: bool,
}

/// A name with subscripts in the form in which variables are called: `a[ 2 ].p` is `a[2].p`.
/// `None` if it has no subscripts, or one that is not a plain number.
/// Spaces around the name and inside the brackets are dropped.
pub(in crate::instance) fn element_name(name: &str) -> Option<String> {
    let mut parts = name.split('[');
    let mut full = parts.next()?.trim().to_string();
    let mut any = false;
    for part in parts {
        let (inside, rest) = part.split_once(']')?;
        let numbers: Option<Vec<String>> =
            inside.split(',').map(|n| n.trim().parse::<usize>().ok().map(|n| n.to_string())).collect();
        full += &format!("[{}]{}", numbers?.join(","), rest.trim());
        any = true;
    }
    any.then_some(full)
}

/// The Modelica text of a value given from outside.
///
/// An expression stays as it is. A number with a unit becomes a call of [`QUANTITY`]. A path or a word becomes a
/// String.
pub fn override_text(value: &str) -> String {
    let parsed = bramah_syntax::parse_expression(FileId(0), value);
    if parsed.diagnostics.is_empty() {
        return value.to_string();
    }
    let trimmed = value.trim();
    let is_number = |i: &usize| trimmed.get(..*i).is_some_and(|t| t.trim_end().parse::<f64>().is_ok());
    // The longest beginning that is a number: in `1e5 Pa` the exponent belongs to the number.
    let split = (1..=trimmed.len().min(60)).rev().find(is_number).unwrap_or(trimmed.len());
    let (number, unit) = trimmed.split_at(split);
    let number = number.trim_end();
    match number.parse::<f64>() {
        Ok(_) if !unit.trim().is_empty() => {
            format!("{QUANTITY}({number}, \"{}\")", unit.trim().replace(['\\', '"'], ""))
        }
        _ if is_text(trimmed) => format!("\"{}\"", trimmed.replace('\\', "\\\\")),
        _ => value.to_string(),
    }
}

/// Whether a value looks like a file name or a word: letters, digits and the characters of paths.
/// At least one letter is needed.
pub(in crate::instance) fn is_text(value: &str) -> bool {
    let path = |c: char| c.is_alphanumeric() || "._-/\\: ".contains(c);
    value.chars().all(path) && value.contains(char::is_alphabetic)
}

/// The function name under which a number with a unit appears in the text of values from outside.
/// Its quotes keep it from being the name of a user's function by accident.
pub const QUANTITY: &str = "'quantity'";
