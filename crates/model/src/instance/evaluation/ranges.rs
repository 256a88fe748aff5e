//! Ranges, array sizes, and loops over ranges.
//!
//! Sizes and ranges must be known when the model is built, because they determine the number of variables and
//! equations.
//! Outside of functions the parameters they read therefore become structural.

use crate::instance::deduce::LoopBody;
use crate::instance::value::ModelicaValue;
use crate::instance::{Evaluator, LookupContext};
use bramah_expr::types::{ScalarType, Variability};
use bramah_syntax::ast::{Expr, ExprKind};
use bramah_syntax::diag::{Code, Diagnostic, Span};

impl<'a> Evaluator<'_, 'a, '_> {
    /// Evaluates an array dimension of a declaration.
    /// It is a whole number, or a type whose values are the indices: `Real x[Color]`. `None` after a message.
    pub(in crate::instance) fn extent(&mut self, e: &'a Expr, view: LookupContext) -> Option<ArrayExtent> {
        if let Some(values) = self.enumeration_range(e, view) {
            let by = values.first().and_then(ModelicaValue::element_type)?;
            return Some(ArrayExtent { size: values.len(), by });
        }
        Some(ArrayExtent { size: self.dimension(e, view)?, by: ScalarType::Integer })
    }

    /// An array size: a known whole number, at least 0. `None` after a message.
    /// Reals are refused even if they are whole, as MLS 10.1 asks for Integers.
    /// The upper limit of 1e9 elements only keeps the number in range; other limits are lower.
    pub(in crate::instance) fn dimension(&mut self, e: &'a Expr, view: LookupContext) -> Option<usize> {
        let value = self.constant(e, view)?;
        match (value.scalar(), value.as_number(&self.instance.exprs)) {
            (Some((_, ScalarType::Integer)), Some(x)) if (0.0..1e9).contains(&x) => Some(x as usize),
            (Some((_, ScalarType::Integer)), Some(x)) => {
                self.instance.fail(Code::OutOfRange, &format!("an array cannot have {x} elements"), e.span)
            }
            (Some((_, ScalarType::Integer)), None) => {
                self.instance.fail(Code::NotConstant, "the size of an array must be known before the run", e.span)
            }
            _ => self.wrong_type("an Integer", &value, e.span),
        }
    }

    /// Evaluates a range `from : step : to` to a vector (MLS 10.4.3). `None` after a message.
    ///
    /// The elements are Integers if all three parts are. The step is 1 if it is not written.
    ///
    /// - `1:3` is `{1, 2, 3}`, `1:2:5` is `{1, 3, 5}`, `3:1` is empty.
    /// - A step of 0 and more than ten million elements are errors.
    pub(in crate::instance) fn range(&mut self, e: &'a Expr, view: LookupContext) -> Option<ModelicaValue> {
        let ExprKind::Range { from, step, to } = &e.kind else { return None };
        let from = self.known_number(from, view)?;
        let to = self.known_number(to, view)?;
        let step = match step {
            Some(s) => self.known_number(s, view)?,
            None => (1.0, ScalarType::Integer),
        };
        if step.0 == 0.0 {
            return self.instance.fail(Code::OutOfRange, "the step of a range is 0", e.span);
        }
        // An enumeration or Boolean range has its own type; a single Real part makes all elements Real.
        let ty = [from.1, step.1, to.1].into_iter().find(|t| *t != ScalarType::Integer).unwrap_or(ScalarType::Integer);
        // A small tolerance absorbs rounding, so that `0:0.1:1` has eleven elements.
        let count = ((to.0 - from.0) / step.0 + 1e-10).floor() + 1.0;
        if count > 1e7 {
            return self.instance.fail(Code::TooLarge, "this range has more than ten million elements", e.span);
        }
        let count = count.max(0.0) as usize;
        let values = (0..count)
            .map(|i| ModelicaValue::Scalar(self.instance.exprs.num(from.0 + step.0 * i as f64), ty))
            .collect();
        Some(ModelicaValue::array(vec![count], values))
    }

    /// A number that must be known, with its type.
    ///
    /// In a function it may depend on arguments, if these are known. Otherwise `not_inline` is set, so that the
    /// function becomes a procedure. Outside of functions an unknown number is an error.
    pub(in crate::instance) fn known_number(&mut self, e: &'a Expr, view: LookupContext) -> Option<(f64, ScalarType)> {
        let value = if self.instance.eval.mode.procedure || self.instance.eval.frame > 0 {
            self.eval(e, view)
        } else {
            self.constant(e, view)
        };
        let value = value?;
        let Some((id, ty)) = value.scalar() else { return self.wrong_type("a number", &value, e.span) };
        match self.instance.exprs.as_num(id) {
            Some(x) => Some((x, ty)),
            None => {
                if self.instance.eval.frame > 0 || self.instance.eval.mode.procedure {
                    self.instance.eval.not_inline = true;
                    return None;
                }
                self.instance.fail(Code::NotConstant, "this must be known before the run", e.span)
            }
        }
    }

    /// Both Booleans as values, in the order of Boolean indices.
    pub(in crate::instance) fn truth_values(&mut self) -> Vec<ModelicaValue> {
        [false, true].map(|b| ModelicaValue::Scalar(self.instance.exprs.boolean(b), ScalarType::Boolean)).into()
    }

    /// The values of a type that stands in the place of a range: `for c in Color loop`, `Real x[Boolean]`.
    /// `None` if the expression is no enumeration type or `Boolean`; no message is reported.
    ///
    /// Only a plain name counts. It may be a path, as `Types.Color`, and the name of a type that is based on an
    /// enumeration.
    /// The values are Booleans, or the numbers of the literals with their type.
    pub(in crate::instance) fn enumeration_range(
        &mut self,
        e: &'a Expr,
        view: LookupContext,
    ) -> Option<Vec<ModelicaValue>> {
        use crate::instance::lookup::{BuiltinType, LookupResult};
        let ExprKind::Reference(r) = &e.kind else { return None };
        if r.parts.iter().any(|p| !p.subscripts.is_empty()) {
            return None;
        }
        // A local of the same name is nearer than the type.
        if r.parts.len() == 1 && self.instance.local(r.parts[0].name.name).is_some() {
            return None;
        }
        let path = bramah_syntax::ast::Path {
            global: r.global,
            parts: r.parts.iter().map(|p| p.name).collect(),
            span: r.span,
        };
        let builtin = match self.instance.names().lookup_path(view, &path).ok()? {
            LookupResult::Builtin(b) => b,
            LookupResult::Class(c) => self.instance.names().template(c.class, c.parent).builtin?,
            LookupResult::Component(..) => return None,
        };
        match builtin {
            BuiltinType::Boolean => Some(self.truth_values()),
            BuiltinType::Enumeration(i) => {
                let n = self.instance.enumerations[i as usize].literals.len();
                Some(
                    (1..=n)
                        .map(|k| ModelicaValue::Scalar(self.instance.exprs.num(k as f64), ScalarType::Enumeration(i)))
                        .collect(),
                )
            }
            _ => None,
        }
    }

    /// The values that the variable of a `for` loop takes, in order. `None` after a message.
    ///
    /// The loop runs over a range, a vector, an enumeration type, or without a range over an array indexed in `body`.
    ///
    /// `body` is what the loop repeats. It is only used for loops without a range.
    /// Outside of functions the bounds are parameters, which become structural.
    pub(in crate::instance) fn iterate(
        &mut self,
        iterator: &'a bramah_syntax::ast::ForIndex,
        body: LoopBody<'a>,
        view: LookupContext,
    ) -> Option<Vec<ModelicaValue>> {
        let Some(range) = &iterator.range else { return self.deduced_range(iterator, body, view) };
        if let Some(values) = self.enumeration_range(range, view) {
            return Some(values);
        }
        let inside = self.instance.eval.frame > 0 || self.instance.eval.mode.procedure;
        // Bounds outside of functions are evaluated by value, because each value gives its own equations.
        let mut value = match &range.kind {
            ExprKind::Range { .. } if !inside => self.constant(range, view)?,
            _ => self.eval(range, view)?,
        };
        // Integers and enumeration values may be used as subscripts, so they must be known.
        // Other elements of a vector may change during the run.
        let mut scalars = Vec::new();
        value.scalars(&mut scalars);
        let fixed = scalars.iter().all(|e| self.instance.variability(*e) <= Variability::Parameter);
        if !inside && fixed && !matches!(value.element_type(), Some(ScalarType::Real) | None) {
            value = self.constant(range, view)?;
        }
        match &value {
            ModelicaValue::Array { dims, .. } if dims.len() == 1 => (0..dims[0]).map(|i| value.slice(i)).collect(),
            _ => self.wrong_type("a range or vector", &value, range.span),
        }
    }

    /// The values of a loop without a range, from the array that its variable indexes (MLS 11.2.2.1).
    /// `None` after a message, if no array determines them.
    /// Numbers count from 1. An array indexed by Booleans or an enumeration gives the values of that type.
    /// `iterator` is the variable. The loop runs over all indices of that dimension.
    pub(in crate::instance) fn deduced_range(
        &mut self,
        iterator: &'a bramah_syntax::ast::ForIndex,
        body: LoopBody<'a>,
        view: LookupContext,
    ) -> Option<Vec<ModelicaValue>> {
        let name = iterator.name.name;
        match self.deduced_extent(name, body, view) {
            Some(ArrayExtent { by: ScalarType::Boolean, .. }) => Some(self.truth_values()),
            Some(ArrayExtent { size, by }) => {
                Some((1..=size).map(|i| ModelicaValue::Scalar(self.instance.exprs.num(i as f64), by)).collect())
            }
            None => {
                self.instance.report(
                    Diagnostic::new(Code::BadIndex, format!("how often the loop over `{name}` runs is not said"))
                        .at(iterator.name.span, "no range, and no array that this alone indexes")
                        .help(format!("write `for {name} in 1:n`")),
                );
                None
            }
        }
    }

    /// A comprehension: an array `{e for i in A}`, or a reduction `sum(e for i in A)` (MLS 10.3.4.1, 10.4.1).
    /// `None` after a message.
    ///
    /// `function` is the reduction, `None` for an array. The iterators are locals while `body` is evaluated.
    pub(in crate::instance) fn comprehension(
        &mut self,
        function: Option<&'a bramah_syntax::ast::ComponentReference>,
        body: &'a Expr,
        iterators: &'a [bramah_syntax::ast::ForIndex],
        view: LookupContext,
        span: Span,
    ) -> Option<ModelicaValue> {
        match function {
            None => self.array_comprehension(body, iterators, view, span),
            Some(f) => {
                let mut values = Vec::new();
                self.each_element(body, iterators, view, &mut values)?;
                self.instance.builtins().reduction(f, values, span)
            }
        }
    }

    /// `{e for i in A, j in B}`: the last iterator gives the first dimension and varies slowest (MLS 10.4.1).
    /// `None` after a message.
    ///
    /// ```text
    /// {10 * i + j for i in 1:3, j in 1:2}   // {{11, 21, 31}, {12, 22, 32}}
    /// ```
    pub(in crate::instance) fn array_comprehension(
        &mut self,
        body: &'a Expr,
        iterators: &'a [bramah_syntax::ast::ForIndex],
        view: LookupContext,
        span: Span,
    ) -> Option<ModelicaValue> {
        let Some((last, rest)) = iterators.split_last() else { return self.eval(body, view) };
        let mut items = Vec::new();
        for value in self.iterate(last, LoopBody::Expr(body), view)? {
            self.instance.eval.locals.push((last.name.name, value));
            let item = self.array_comprehension(body, rest, view, span);
            self.instance.eval.locals.pop();
            items.push(item?);
        }
        // Without elements the sizes of the inner dimensions are not known; they count as 0.
        if items.is_empty() {
            return Some(ModelicaValue::array(vec![0; iterators.len()], Vec::new()));
        }
        self.stacked(items, span)
    }

    /// Appends the values of `body` for all combinations of the iterators, the last one fastest, for reductions.
    /// `None` after a message.
    /// `out` collects the values for reductions, where their order plays no role for the result.
    pub(in crate::instance) fn each_element(
        &mut self,
        body: &'a Expr,
        iterators: &'a [bramah_syntax::ast::ForIndex],
        view: LookupContext,
        out: &mut Vec<ModelicaValue>,
    ) -> Option<()> {
        let Some((first, rest)) = iterators.split_first() else {
            out.push(self.eval(body, view)?);
            return Some(());
        };
        for value in self.iterate(first, LoopBody::Expr(body), view)? {
            self.instance.eval.locals.push((first.name.name, value));
            let done = self.each_element(body, rest, view, out);
            self.instance.eval.locals.pop();
            done?;
        }
        Some(())
    }
}

/// One dimension of an array.
#[derive(Clone, Copy, Debug)]
pub(in crate::instance) struct ArrayExtent {
    /// The number of elements.
    pub size: usize,
    /// The index type: Integer, Boolean or an enumeration.
    pub by: ScalarType,
}
