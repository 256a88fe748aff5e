//! Outputs and protected variables of functions as they begin: with their declared values, or zeros in their shape.

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
    /// The initial value of an output or protected component of a function; zero where nothing is said.
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

    /// Zeros in the declared shape.
    pub(in crate::instance) fn blank(
        &mut self,
        f: &FormalParameter<'a>,
        value: Option<&ModelicaValue>,
    ) -> Option<ModelicaValue> {
        let mut found = self.instance.names().class_at(f.view, &f.component.class)?;
        // `output R r(x = u)`: fields take what the declaration says of them
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
                // without a value of its own it takes the size of what is assigned to it (MLS 12.4.5)
                ast::Subscript::All(_) => value.and_then(|v| v.dims().get(i).copied()).unwrap_or(0),
                ast::Subscript::Expr(e) => match self.instance.evaluator().enumeration_range(e, f.view) {
                    Some(all) => all.len(),
                    None => self.instance.evaluator().known_number(e, f.view)?.0.max(0.0) as usize,
                },
            });
        }
        if dims.iter().product::<usize>() > 1_000_000 {
            return self.instance.fail(
                Code::TooLarge,
                "this array has more than a million elements",
                f.component.name.span,
            );
        }
        Some(repeated(&one, dims))
    }

    pub(in crate::instance) fn blank_one(&mut self, found: &LookupResult<'a>, span: Span) -> Option<ModelicaValue> {
        let of = |b: BuiltinType| match b {
            BuiltinType::Real => ModelicaValue::Scalar(Exprs::ZERO, ScalarType::Real),
            BuiltinType::Integer => ModelicaValue::Scalar(Exprs::ZERO, ScalarType::Integer),
            BuiltinType::Boolean => ModelicaValue::Scalar(Exprs::ZERO, ScalarType::Boolean),
            BuiltinType::Enumeration(i) => ModelicaValue::Scalar(Exprs::ONE, ScalarType::Enumeration(i)),
            // an output of this type is made by what Rust knows of the function
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

    /// The dimensions that a type brings, as `type Orientation = Real[3, 3]` does.
    pub(in crate::instance) fn type_dims(&mut self, t: &Template<'a>) -> Option<Vec<usize>> {
        let mut dims = Vec::new();
        for (subscripts, base) in t.dims.iter().rev() {
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

/// Locals so that each comes after those that its sizes and its value name (MLS 12.4.4).
pub(in crate::instance) fn in_order_of_use<'f, 'a>(locals: &'f [FormalParameter<'a>]) -> Vec<&'f FormalParameter<'a>> {
    let named: Vec<Vec<Symbol>> =
        locals.iter().map(|f| crate::instance::deduce::names_of_declaration(f.component)).collect();
    let mut sorted: Vec<&FormalParameter<'a>> = Vec::with_capacity(locals.len());
    let mut open: Vec<usize> = (0..locals.len()).collect();
    while !open.is_empty() {
        let waits = |k: usize, on: usize| on != k && named[k].contains(&locals[on].name);
        // those that use each other stay as they are declared
        let at = open.iter().position(|&k| !open.iter().any(|&on| waits(k, on))).unwrap_or(0);
        sorted.push(&locals[open.remove(at)]);
    }
    sorted
}

/// An array of these dimensions, all elements of which are one value.
pub(in crate::instance) fn repeated(one: &ModelicaValue, dims: Vec<usize>) -> ModelicaValue {
    if dims.is_empty() {
        return one.clone();
    }
    let inner = one.dims().to_vec();
    let elements = (0..dims.iter().product()).flat_map(|_| one.elements().to_vec()).collect();
    ModelicaValue::array(dims.into_iter().chain(inner).collect(), elements)
}
