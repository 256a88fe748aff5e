//! Initial values of the outputs and protected variables of a function.
//!
//! A variable starts with its declared value, or else with zeros in its declared shape.
//! The functions here are called after the inputs are bound, because sizes and values may read them.

use crate::instance::FunctionCalls;
use crate::instance::call::{Callee, FormalParameter};
use crate::instance::lookup::{BuiltinType, LookupResult};
use crate::instance::template::Template;
use crate::instance::value::{ModelicaValue, size_text};
use bramah_expr::Exprs;
use bramah_expr::types::ScalarType;
use bramah_syntax::ast::{self};
use bramah_syntax::diag::{Code, Span};
use bramah_syntax::symbol::Symbol;
use std::rc::Rc;

impl<'a> FunctionCalls<'_, 'a, '_> {
    /// The initial value of an output or protected variable of a function. `None` after a message.
    ///
    /// Without a declared value it is zero, in the declared shape. The size of a declared value must fit.
    ///
    /// ```text
    /// protected Real w[size(u, 1)] = 2 * u;   // starts with 2 * u
    /// output Real y[2];                       // starts with {0, 0}
    /// ```
    pub(in crate::instance) fn declared_local(&mut self, f: &FormalParameter<'a>) -> Option<ModelicaValue> {
        let reached = self.instance.names().reached(f.view.scope, f.index);
        let value = match reached.binding {
            Some(b) if b.access.is_empty() => Some(self.instance.evaluator().eval(b.expr, b.view)?),
            Some(b) => Some(self.instance.evaluator().binding_value(&b, true)?),
            None => None,
        };
        let blank = self.blank(f, value.as_ref())?;
        match value {
            None => Some(blank),
            Some(v) => {
                if v.dims() != blank.dims() {
                    let message = format!(
                        "`{}` has size {}, and its value {}",
                        f.name,
                        size_text(blank.dims()),
                        size_text(v.dims())
                    );
                    return self.instance.fail(Code::SizeMismatch, &message, f.component.name.span);
                }
                let ty = blank.element_type().unwrap_or(ScalarType::Real);
                Some(if ty == ScalarType::Real { v.with_type(ty) } else { v })
            }
        }
    }

    /// A value of zeros in the declared shape. `None` after a message.
    ///
    /// `value` is the declared value, if there is one: the dimension `:` takes its size from it.
    /// For a record the fields have their declared values.
    ///
    /// Sizes are evaluated in the frame of the call, so they may depend on inputs: `Real w[size(u, 1)]`.
    /// More than a million elements are reported.
    /// The size of each dimension is at least 0.
    pub(in crate::instance) fn blank(
        &mut self,
        f: &FormalParameter<'a>,
        value: Option<&ModelicaValue>,
    ) -> Option<ModelicaValue> {
        let mut found = self.instance.names().class_at(f.view, &f.component.class)?;
        // Modifiers in the declaration, as in `output R r(x = u)`, give fields their values.
        let given = self.instance.names().reached(f.view.scope, f.index).args;
        if let LookupResult::Class(c) = &mut found
            && !given.is_empty()
        {
            c.args = given.into_iter().chain(c.args.iter().cloned()).collect();
        }
        let one = self.blank_one(&found, f.component.name.span)?;
        let mut dims = Vec::new();
        for (i, s) in f.component.subscripts.iter().enumerate() {
            dims.push(match s {
                // Without a value it starts empty, and takes the size of what is assigned to it (MLS 12.4.5).
                ast::Subscript::All(_) => value.and_then(|v| v.dims().get(i).copied()).unwrap_or(0),
                ast::Subscript::Expr(e) => match self.instance.evaluator().enumeration_range(e, f.view) {
                    Some(all) => all.len(),
                    None => self.instance.evaluator().known_number(e, f.view)?.0.max(0.0) as usize,
                },
            });
        }
        // A wrong size would otherwise use up the memory before anything else notices.
        if dims.iter().product::<usize>() > 1_000_000 {
            return self.instance.fail(
                Code::TooLarge,
                "this array has more than a million elements",
                f.component.name.span,
            );
        }
        Some(repeated(&one, dims))
    }

    /// The zero value of one element of a type: 0, `false`, the first literal, an empty String, or a record.
    ///
    /// `None` after a message, if `found` is a component. `span` is the place of the declaration.
    /// Dimensions that the type itself has are included.
    /// A record consists of the initial values of its components, protected ones included.
    pub(in crate::instance) fn blank_one(&mut self, found: &LookupResult<'a>, span: Span) -> Option<ModelicaValue> {
        let of = |b: BuiltinType| match b {
            BuiltinType::Real => ModelicaValue::Scalar(Exprs::ZERO, ScalarType::Real),
            BuiltinType::Integer => ModelicaValue::Scalar(Exprs::ZERO, ScalarType::Integer),
            BuiltinType::Boolean => ModelicaValue::Scalar(Exprs::ZERO, ScalarType::Boolean),
            BuiltinType::Enumeration(i) => ModelicaValue::Scalar(Exprs::ONE, ScalarType::Enumeration(i)),
            // The function that the C name stands for creates the object later, so any value does here.
            BuiltinType::String | BuiltinType::Object => ModelicaValue::text(""),
        };
        match found {
            LookupResult::Builtin(b) => Some(of(*b)),
            LookupResult::Class(c) => {
                let t = self.instance.names().template(c.class, c.parent);
                let dims = self.type_dims(&t)?;
                if let Some(b) = t.builtin {
                    return Some(repeated(&of(b), dims));
                }
                let mut fields = Vec::new();
                let scope = self.instance.names().package(c);
                let callee = Callee { scope, template: t, name: String::new() };
                for f in self.formals(&callee, |_, _| true) {
                    let value = self.declared_local(&f)?;
                    fields.push((f.name, value));
                }
                let class = self.instance.operators().operator_class(c);
                let one = ModelicaValue::Record(Rc::new(crate::instance::value::RecordValue { fields, class }));
                Some(repeated(&one, dims))
            }
            LookupResult::Component(..) => self.instance.fail(Code::WrongClassKind, "a type is needed here", span),
        }
    }

    /// The dimensions of a type such as `type Orientation = Real[3, 3]`, in the order in which the value has them.
    /// `None` after a message: they must be given as numbers, not as `:`.
    /// They are evaluated around the class that declares them.
    pub(in crate::instance) fn type_dims(&mut self, t: &Template<'a>) -> Option<Vec<usize>> {
        let mut dims = Vec::new();
        for (subscripts, base) in &t.dims {
            let view = t.bases[*base as usize].parent;
            for s in *subscripts {
                dims.push(match s {
                    ast::Subscript::All(span) => {
                        return self.instance.fail(Code::NoValue, "this size is not given", *span);
                    }
                    ast::Subscript::Expr(e) => self.instance.evaluator().extent(e, view)?.size,
                });
            }
        }
        Some(dims)
    }
}

/// Sorts locals so that each comes after those that its dimensions and its value read (MLS 12.4.4).
///
/// Locals that need each other keep the order of their declaration.
/// Evaluating them then reads initial values, which is not reported here.
pub(in crate::instance) fn in_order_of_use<'f, 'a>(locals: &'f [FormalParameter<'a>]) -> Vec<&'f FormalParameter<'a>> {
    let named: Vec<Vec<Symbol>> =
        locals.iter().map(|f| crate::instance::deduce::names_of_declaration(f.component)).collect();
    let mut sorted: Vec<&FormalParameter<'a>> = Vec::with_capacity(locals.len());
    let mut open: Vec<usize> = (0..locals.len()).collect();
    while !open.is_empty() {
        let waits = |k: usize, on: usize| on != k && named[k].contains(&locals[on].name);
        // In a cycle no local is free to go first; the first one in the order of declaration is taken.
        let at = open.iter().position(|&k| !open.iter().any(|&on| waits(k, on))).unwrap_or(0);
        sorted.push(&locals[open.remove(at)]);
    }
    sorted
}

/// An array with the dimensions `dims`, in which each element is the value `one`.
/// The dimensions of `one` come after `dims`. Without dimensions the result is `one` itself.
pub(in crate::instance) fn repeated(one: &ModelicaValue, dims: Vec<usize>) -> ModelicaValue {
    if dims.is_empty() {
        return one.clone();
    }
    let inner = one.dims().to_vec();
    let elements = (0..dims.iter().product()).flat_map(|_| one.elements().to_vec()).collect();
    ModelicaValue::array(dims.into_iter().chain(inner).collect(), elements)
}
