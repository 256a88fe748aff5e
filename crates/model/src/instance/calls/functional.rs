//! Functions as arguments of functions (MLS 12.4.2).
//!
//! A function value is a number in a table of the instance, with the inputs that partial application has bound.
//! A procedure is translated for a certain function, so the number is part of its key.

use crate::instance::call::FormalParameter;
use crate::instance::lookup::LookupResult;
use crate::instance::value::ModelicaValue;
use crate::instance::{ClassRef, FunctionCalls, LookupContext};
use bramah_syntax::ast::{ClassKind, ComponentReference, Expr, Ident, Path};
use bramah_syntax::diag::Code;
use std::rc::Rc;

impl<'a> FunctionCalls<'_, 'a, '_> {
    /// A function as a value, with the inputs `bound` already given. `None`, without a message, for other classes.
    /// The class is remembered in the table of the instance, at the index that the value carries.
    pub(in crate::instance) fn function_value(
        &mut self,
        class: &ClassRef<'a>,
        bound: Vec<(Ident, ModelicaValue)>,
    ) -> Option<ModelicaValue> {
        let template = self.instance.names().template(class.class, class.parent);
        if !matches!(template.kind, ClassKind::Function { .. }) {
            return None;
        }
        // The same function must get the same number, because numbers decide whether two function values are equal.
        let same = |c: &ClassRef<'a>| {
            (c.class, c.parent) == (class.class, class.parent)
                && (Rc::ptr_eq(&c.args, &class.args) || c.args.is_empty() && class.args.is_empty())
        };
        let at = self.instance.functions.arguments.iter().position(same).unwrap_or_else(|| {
            self.instance.functions.arguments.push(class.clone());
            self.instance.functions.arguments.len() - 1
        });
        Some(ModelicaValue::Function(u32::try_from(at).expect("few functions"), Rc::new(bound)))
    }

    /// `function f(a = 1)`: a function with some of its inputs given (MLS 12.4.2.1). `None` after a message.
    /// Only named arguments can be bound. They are evaluated here, at the place of the partial application.
    pub(in crate::instance) fn partial_application(
        &mut self,
        function: &'a Path,
        named: &'a [(Ident, Expr)],
        view: LookupContext,
    ) -> Option<ModelicaValue> {
        let mut bound = Vec::with_capacity(named.len());
        for (name, e) in named {
            bound.push((*name, self.instance.evaluator().eval(e, view)?));
        }
        // `f` may itself be an input that is a function; the new bindings are added to those it has.
        if let [name] = function.parts.as_slice()
            && let Some(i) = self.instance.local(name.name)
            && let ModelicaValue::Function(f, before) = self.instance.eval.locals[i].1.clone()
        {
            bound.extend_from_slice(&before);
            return Some(ModelicaValue::Function(f, Rc::new(bound)));
        }
        let found = self.instance.names().class_at(view, function)?;
        let made = match &found {
            LookupResult::Class(class) => self.function_value(class, bound),
            _ => None,
        };
        made.or_else(|| self.instance.fail(Code::UnknownFunction, "this is not a function", function.span))
    }

    /// The function that an input of the function being evaluated stands for, with its bound inputs.
    /// `None`, without a message, if the name is no such input.
    pub(in crate::instance) fn functional_input(
        &self,
        function: &ComponentReference,
    ) -> Option<(ClassRef<'a>, Rc<Vec<(Ident, ModelicaValue)>>)> {
        let [part] = function.parts.as_slice() else { return None };
        match &self.instance.eval.locals[self.instance.local(part.name.name)?].1 {
            ModelicaValue::Function(f, bound) => {
                Some((self.instance.functions.arguments[*f as usize].clone(), bound.clone()))
            }
            _ => None,
        }
    }

    /// Whether an input is declared with a function type, so that it takes a function as its argument.
    pub(in crate::instance) fn is_functional(&mut self, f: &FormalParameter<'a>) -> bool {
        match self.instance.names().lookup_path(f.view, &f.component.class) {
            Ok(LookupResult::Class(c)) => {
                matches!(self.instance.names().template(c.class, c.parent).kind, ClassKind::Function { .. })
            }
            _ => false,
        }
    }
}
