//! Vectorized calls: a function of scalars called with arrays (MLS 12.4.6).
//!
//! `sin({1, 2})` calls `sin` for each element. All arguments with additional dimensions must agree in these; the other
//! arguments are the same in all calls.

use crate::instance::FunctionCalls;
use crate::instance::call::{Callee, FormalParameter};
use crate::instance::calls::binding::is_input;
use crate::instance::lookup::LookupResult;
use crate::instance::value::{ModelicaValue, stack};
use bramah_syntax::ast::Ident;
use bramah_syntax::diag::{Code, Diagnostic, Span};
use std::rc::Rc;

/// The evaluated arguments of a call.
#[derive(Clone)]
pub(in crate::instance) struct CallArguments {
    /// Positional arguments, in order.
    pub positional: Vec<ModelicaValue>,
    /// Named arguments, in the order in which they are written.
    pub named: Vec<(Ident, ModelicaValue)>,
}

impl<'a> FunctionCalls<'_, 'a, '_> {
    /// Calls a function, once for each element if arguments have more dimensions than their inputs.
    ///
    /// The results are arrays with the additional dimensions in front. `None` after a message.
    ///
    /// ```text
    /// function f input Real x; input Real p; output Real y; ... end f;
    /// f({1, 2}, 3)     // {f(1, 3), f(2, 3)}
    /// ```
    pub(in crate::instance) fn call_elementwise(
        &mut self,
        callee: &Callee<'a>,
        given: CallArguments,
        span: Span,
    ) -> Option<ModelicaValue> {
        let mut values = given.positional.iter().chain(given.named.iter().map(|(_, v)| v));
        // The most common case: only scalars, which need no look at the declared inputs.
        if values.all(|v| v.dims().is_empty()) {
            return self.call_function(callee, given.positional, given.named, span);
        }
        let inputs = self.formals(callee, is_input);
        let Some(dims) = self.shared_dims(callee, &inputs, &given, span)? else {
            return self.call_function(callee, given.positional, given.named, span);
        };
        let count: usize = dims.iter().product();
        // Without elements there is no call, and so no shape of a result: it is taken as a scalar.
        if count == 0 {
            return Some(ModelicaValue::array(dims, Vec::new()));
        }
        let mut extra = |f: Option<&FormalParameter<'a>>, v: &ModelicaValue| f.map_or(0, |f| self.extra_dims(f, v));
        let by_place: Vec<usize> = given.positional.iter().enumerate().map(|(k, v)| extra(inputs.get(k), v)).collect();
        let by_name: Vec<usize> =
            given.named.iter().map(|(n, v)| extra(inputs.iter().find(|f| f.name == n.name), v)).collect();
        let mut results = Vec::with_capacity(count);
        for i in 0..count {
            let one = |v: &ModelicaValue, extra: usize| if extra > 0 { block(v, extra, i) } else { v.clone() };
            let positional = given.positional.iter().zip(&by_place).map(|(v, &n)| one(v, n)).collect();
            let named = given.named.iter().zip(&by_name).map(|((name, v), &n)| (*name, one(v, n))).collect();
            results.push(self.call_function(callee, positional, named, span)?);
        }
        self.gathered(dims, results, span)
    }

    /// The dimensions that arguments have beyond those of their inputs.
    /// `Some(None)` if no argument has more. `None` after a message, if arguments disagree.
    ///
    /// `inputs` are the declared inputs in order. A named argument is compared with the input of its name.
    /// The message about different sizes names both inputs.
    /// Arguments for inputs that do not exist are reported later, when they are bound.
    fn shared_dims(
        &mut self,
        callee: &Callee<'a>,
        inputs: &[FormalParameter<'a>],
        given: &CallArguments,
        span: Span,
    ) -> Option<Option<Vec<usize>>> {
        let mut shared: Option<(&FormalParameter<'a>, Vec<usize>)> = None;
        let by_place = inputs.iter().zip(&given.positional);
        let by_name = given.named.iter().filter_map(|(n, v)| Some((inputs.iter().find(|f| f.name == n.name)?, v)));
        for (f, v) in by_place.chain(by_name) {
            let extra = self.extra_dims(f, v);
            let own = &v.dims()[..extra];
            match &shared {
                _ if extra == 0 => {}
                None => shared = Some((f, own.to_vec())),
                Some((_, dims)) if dims == own => {}
                Some((first, dims)) => {
                    let message = format!(
                        "`{}` is called for each element of its arguments, and these differ in size: {} for `{}`, {} \
                         for `{}`",
                        callee.name,
                        crate::instance::value::size_text(dims),
                        first.name,
                        crate::instance::value::size_text(own),
                        f.name
                    );
                    let d = Diagnostic::new(Code::SizeMismatch, message).at(span, "this call");
                    self.instance.report(d.help("give arrays of the same size, or single values that all calls share"));
                    return None;
                }
            }
        }
        Some(shared.map(|(_, dims)| dims))
    }

    /// How many more dimensions a value has than the input that takes it.
    /// Dimensions of the declaration and of its type both count.
    /// A dimension of the type, as in `input Orientation R`, is no reason to call the function for each element.
    fn extra_dims(&mut self, f: &FormalParameter<'a>, v: &ModelicaValue) -> usize {
        let declared = f.component.subscripts.len();
        if v.dims().len() <= declared {
            return 0;
        }
        let of_type = match self.instance.names().lookup_path(f.view, &f.component.class) {
            Ok(LookupResult::Class(c)) => {
                self.instance.names().template(c.class, c.parent).dims.iter().map(|(s, _)| s.len()).sum()
            }
            _ => 0,
        };
        v.dims().len().saturating_sub(declared + of_type)
    }

    /// The results of all calls as arrays with the dimensions `dims` in front, one array for each output.
    /// `None` after a message, if the calls gave different shapes.
    /// A function with several outputs gives a tuple of arrays.
    fn gathered(&mut self, dims: Vec<usize>, results: Vec<ModelicaValue>, span: Span) -> Option<ModelicaValue> {
        let outputs = match &results[0] {
            ModelicaValue::Tuple(first) => first.len(),
            _ => return self.shaped(dims, results, span),
        };
        let mut arrays = Vec::with_capacity(outputs);
        for k in 0..outputs {
            let pick = |r: &ModelicaValue| match r {
                ModelicaValue::Tuple(values) => values[k].clone(),
                other => other.clone(),
            };
            arrays.push(self.shaped(dims.clone(), results.iter().map(pick).collect(), span)?);
        }
        Some(ModelicaValue::Tuple(Rc::new(arrays)))
    }

    /// The results of one output, stacked in row-major order, as an array with the dimensions `dims` in front.
    /// `None` after a message, if their shapes differ.
    fn shaped(&mut self, dims: Vec<usize>, results: Vec<ModelicaValue>, span: Span) -> Option<ModelicaValue> {
        let shapes: Vec<String> = results.iter().map(ModelicaValue::describe).collect();
        let Some(ModelicaValue::Array { dims: stacked, elements }) = stack(results) else {
            let message = format!("the calls for each element differ in size: {}", shapes.join(", "));
            return self.instance.fail(Code::SizeMismatch, &message, span);
        };
        // `stack` has put all results along one dimension; that is replaced by `dims`.
        Some(ModelicaValue::Array { dims: dims.into_iter().chain(stacked[1..].iter().copied()).collect(), elements })
    }
}

/// The part of an array for call `number`: the first `outer` dimensions, in row-major order, select it.
fn block(v: &ModelicaValue, outer: usize, number: usize) -> ModelicaValue {
    let inner = v.dims()[outer..].to_vec();
    let step: usize = inner.iter().product();
    if inner.is_empty() {
        return v.elements()[number].clone();
    }
    ModelicaValue::array(inner, v.elements()[number * step..(number + 1) * step].to_vec())
}
