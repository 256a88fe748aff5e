//! Binds the arguments of a call to the inputs of a function, or to the fields of a record constructor.
//!
//! Positional arguments come first, then named ones, then defaults (MLS 12.4.1).
//! Each bound value is pushed as a local, so that later defaults and the body can read it.

use crate::instance::call::{Callee, FormalParameter};
use crate::instance::lookup::{BuiltinType, LookupResult};
use crate::instance::template::TemplateElementKind;
use crate::instance::value::ModelicaValue;
use crate::instance::{ClassRef, FunctionCalls, Instance, LookupContext};
use bramah_expr::types::ScalarType;
use bramah_syntax::ast::{self, CausalityPrefix, ClassKind, Ident};
use bramah_syntax::diag::{Code, Diagnostic, Span};
use bramah_syntax::symbol::Symbol;

impl<'a> FunctionCalls<'_, 'a, '_> {
    /// The components of a function or record that pass a test, in declaration order, inherited ones included.
    ///
    /// The test gets the declaration and whether it is protected. `is_input` is the most common one.
    ///
    /// For a function these are inputs, outputs or protected variables, for a record its fields.
    pub(in crate::instance) fn formals(
        &self,
        callee: &Callee<'a>,
        wanted: impl Fn(&ast::ComponentDeclaration, bool) -> bool,
    ) -> Vec<FormalParameter<'a>> {
        let with_index = (0u32..).zip(&callee.template.elements);
        let found = with_index.filter_map(|(index, e)| match e.kind {
            TemplateElementKind::Component(component) if wanted(component, e.protected) => Some(FormalParameter {
                name: e.name,
                component,
                index,
                view: LookupContext { scope: callee.scope, base: e.base },
            }),
            _ => None,
        });
        found.collect()
    }

    /// Runs `f` in a frame of its own, in which the inputs of a function are locals with the values of the arguments.
    ///
    /// `None` if the arguments do not fit, after a message, or if `f` returns it.
    /// The locals are removed afterwards.
    pub(in crate::instance) fn with_inputs<T>(
        &mut self,
        callee: &Callee<'a>,
        positional: Vec<ModelicaValue>,
        named: Vec<(Ident, ModelicaValue)>,
        span: Span,
        f: impl FnOnce(&mut Instance<'a, '_>) -> Option<T>,
    ) -> Option<T> {
        let inputs = self.formals(callee, is_input);
        self.instance.in_frame(|s| s.calls().bind(callee, &inputs, positional, named, span).and_then(|()| f(s)))
    }

    /// Binds arguments to inputs in the present frame, which must be a fresh one.
    ///
    /// A default may read inputs that are declared before it. `None` after a message.
    /// Messages are reported for too many arguments, for unknown names, and for inputs without a value.
    ///
    /// `formals` are the inputs or fields in the order of their declaration, `positional` and `named` the arguments.
    /// Arguments are checked against the declared types. Bounds are checked for values and defaults.
    /// A number outside of the declared bounds is reported, and the call goes on.
    /// Each argument is bound once: named ones are taken for the inputs that positional ones leave.
    pub(in crate::instance) fn bind(
        &mut self,
        callee: &Callee<'a>,
        formals: &[FormalParameter<'a>],
        positional: Vec<ModelicaValue>,
        named: Vec<(Ident, ModelicaValue)>,
        span: Span,
    ) -> Option<()> {
        if positional.len() > formals.len() {
            let message =
                format!("`{}` takes {} arguments, and {} are given", callee.name, formals.len(), positional.len());
            return self.instance.fail(Code::BadCall, &message, span);
        }
        if let Some((name, _)) = named.iter().find(|(n, _)| formals.iter().all(|f| f.name != n.name)) {
            let names: Vec<Symbol> = formals.iter().map(|f| f.name).collect();
            let mut d = Diagnostic::new(Code::BadCall, format!("`{}` has no input `{}`", callee.name, name.name))
                .at(name.span, "not an input");
            d = match crate::instance::errors::nearest(name.name.as_str(), names.iter().map(|n| n.as_str())) {
                Some(near) => d.meant(near),
                None => d.help(crate::instance::errors::list_names("it takes", &names)),
            };
            self.instance.report(d);
            return None;
        }
        let mut positional = positional.into_iter();
        for f in formals {
            // A positional argument counts more than a named one for the same input; this is not reported as an error.
            let given =
                positional.next().or_else(|| named.iter().find(|(n, _)| n.name == f.name).map(|(_, v)| v.clone()));
            let given_here = given.is_some();
            let value = match given {
                Some(v @ ModelicaValue::Function(..)) if self.is_functional(f) => v,
                Some(v) => self.fit_argument(callee, f, v, span)?,
                None => match self.default_value(f)? {
                    Some(v) => v,
                    None => {
                        let message = format!("`{}` needs a value for its input `{}`", callee.name, f.name);
                        let d = Diagnostic::new(Code::BadCall, message)
                            .at(span, "this call")
                            .at(f.component.name.span, "declared here without a default");
                        self.instance.report(d);
                        return None;
                    }
                },
            };
            let place = match given_here {
                // A bound violated by a default is shown at the default, not at the call.
                true => span,
                false => self.instance.names().reached(f.view.scope, f.index).binding.map_or(span, |b| b.expr.span),
            };
            self.check_bounds(callee, f, &value, place);
            self.instance.eval.locals.push((f.name, value));
        }
        Some(())
    }

    /// Reports a number that lies outside of `min` and `max` in the declaration of an input.
    ///
    /// Only known numbers and literal bounds are compared. The same message is reported once, however often the
    /// function is called. It does not stop the call.
    pub(in crate::instance) fn check_bounds(
        &mut self,
        callee: &Callee<'a>,
        f: &FormalParameter<'a>,
        value: &ModelicaValue,
        span: Span,
    ) {
        let Some(x) = value.as_number(&self.instance.exprs) else { return };
        let bound = match (declared_number(f.component, "min"), declared_number(f.component, "max")) {
            (Some(low), _) if x < low => format!("less than its `min`, {low}"),
            (_, Some(high)) if x > high => format!("more than its `max`, {high}"),
            _ => return,
        };
        let message = format!("the input `{}` of `{}` is {x}, {bound}", f.name, callee.name);
        if self.instance.diagnostics.iter().all(|d| d.message != message) {
            self.instance.report(
                Diagnostic::new(Code::OutOfRange, message)
                    .at(span, "this value")
                    .at(f.component.name.span, "declared here")
                    .help("give a value within the bounds, in the unit of the input"),
            );
        }
    }

    /// Checks an argument against the declared type and number of dimensions of an input.
    ///
    /// Integers become Reals where a Real is declared. Sizes are not compared here.
    /// Records pass unchecked, because they may come from a class with the same fields. `None` after a message.
    ///
    /// `callee` and `f` name the function and the input in messages. `span` is the call.
    /// An input that is a function accepts nothing else; the caller handles matching arguments before.
    /// Enumerations must be the same type. External objects and Strings must be such values.
    pub(in crate::instance) fn fit_argument(
        &mut self,
        callee: &Callee<'a>,
        f: &FormalParameter<'a>,
        value: ModelicaValue,
        span: Span,
    ) -> Option<ModelicaValue> {
        let wanted = match self.instance.names().class_at(f.view, &f.component.class)? {
            LookupResult::Builtin(b) => Some(b),
            LookupResult::Class(c) => {
                let t = self.instance.names().template(c.class, c.parent);
                if matches!(t.kind, ClassKind::Function { .. }) {
                    let message = format!(
                        "input `{}` of `{}` is a function, and this is {}",
                        f.name,
                        callee.name,
                        value.describe()
                    );
                    return self.instance.fail(Code::BadCall, &message, span);
                }
                if t.dims.is_empty() { t.builtin } else { None }
            }
            LookupResult::Component(..) => None,
        };
        // Only predefined types and types based on them are checked; array types and records end here.
        let Some(b) = wanted else { return Some(value) };
        let declared = f.component.subscripts.len();
        if value.dims().len() != declared {
            let message = format!(
                "input `{}` of `{}` is {}, and this is {}",
                f.name,
                callee.name,
                if declared == 0 { "a single value".into() } else { format!("an array of {declared} dimensions") },
                value.describe()
            );
            return self.instance.fail(Code::BadCall, &message, span);
        }
        let fits = match (b, value.element_type()) {
            (BuiltinType::Real, Some(ScalarType::Real | ScalarType::Integer)) => true,
            (BuiltinType::Integer, Some(ScalarType::Integer)) | (BuiltinType::Boolean, Some(ScalarType::Boolean)) => {
                true
            }
            (BuiltinType::Enumeration(a), Some(ScalarType::Enumeration(b))) => a == b,
            (BuiltinType::Object, _) => matches!(value, ModelicaValue::Object(_)),
            (BuiltinType::String, _) => matches!(value.elements().first(), Some(ModelicaValue::Text(_)) | None),
            (_, None) => value.elements().is_empty(),
            _ => false,
        };
        if !fits {
            let message = format!(
                "input `{}` of `{}` is of type {}, and this is {}",
                f.name,
                callee.name,
                crate::instance::errors::builtin_name(b),
                value.describe()
            );
            return self.instance.fail(Code::BadCall, &message, span);
        }
        Some(if b == BuiltinType::Real { value.with_type(ScalarType::Real) } else { value })
    }

    /// The default of an input, evaluated in the frame of the call.
    ///
    /// `Some(None)` if it has none; `None` after a message.
    /// A record without a default is built from the defaults of its fields.
    pub(in crate::instance) fn default_value(&mut self, f: &FormalParameter<'a>) -> Option<Option<ModelicaValue>> {
        let reached = self.instance.names().reached(f.view.scope, f.index);
        match reached.binding {
            Some(b) => {
                // In the frame of the call, so that earlier inputs are seen.
                let value = if b.access.is_empty() {
                    self.instance.evaluator().eval(b.expr, b.view)
                } else {
                    self.instance.evaluator().binding_value(&b, true)
                };
                value.map(Some)
            }
            None => match self.instance.names().class_at(f.view, &f.component.class)? {
                // A record without a value takes its fields' defaults.
                LookupResult::Class(c) if f.component.subscripts.is_empty() => self.default_record(&c),
                _ => Some(None),
            },
        }
    }

    /// A record built from the defaults of its fields.
    ///
    /// `Some(None)` if a field has no default or the class is no record. `None` does not occur.
    pub(in crate::instance) fn default_record(&mut self, class: &ClassRef<'a>) -> Option<Option<ModelicaValue>> {
        let template = self.instance.names().template(class.class, class.parent);
        if !matches!(template.kind, ClassKind::Record { .. }) {
            return Some(None);
        }
        let scope = self.instance.names().package(class);
        let name = self.instance.library.full_name(class.class);
        let callee = Callee { scope, template, name };
        let span = self.instance.library.class(class.class).name.span;
        let (value, messages) = self.instance.attempt(|i| i.calls().construct(&callee, Vec::new(), Vec::new(), span));
        // fields without a default say nothing here: the record may get its value later
        self.instance.diagnostics.extend(messages.into_iter().filter(|_| value.is_some()));
        Some(value)
    }
}

/// An attribute that a declaration gives as a literal number: 0 for `min` in `Real x(min = 0)`.
/// `None` if it is missing or any other expression.
pub(in crate::instance) fn declared_number(component: &ast::ComponentDeclaration, attribute: &str) -> Option<f64> {
    let arguments = &component.modification.as_ref()?.arguments;
    let value = arguments.iter().find_map(|argument| match &argument.kind {
        ast::ModificationArgumentKind::Modify { path, modification, .. }
            if path.parts[0].name.as_str() == attribute =>
        {
            modification.as_ref()?.value.as_ref()
        }
        _ => None,
    });
    value?.as_number()
}

/// Whether a component of a function is an input: public, and declared `input`.
pub(in crate::instance) fn is_input(c: &ast::ComponentDeclaration, protected: bool) -> bool {
    !protected && c.prefix.causality == Some(CausalityPrefix::Input)
}
