//! Subscripts: `x[2]`, `x[2:3, :]`, `x[i]` with an `i` that may change during the run (MLS 10.5).
//!
//! Subscripts are evaluated to [`SubscriptValue`]s. [`places`] turns known ones into positions in row-major order.
//! The others become an indexed slot in a procedure, or a chain of `if` in an expression.

use crate::instance::errors::short;
use crate::instance::value::ModelicaValue;
use crate::instance::{Evaluator, LookupContext};
use bramah_expr::types::{MessagePart, ScalarType, Variability};
use bramah_expr::{ExprId, Exprs, RelationalOp};
use bramah_syntax::ast::Subscript;
use bramah_syntax::diag::{Code, Diagnostic, Span};
use std::rc::Rc;

impl<'a> Evaluator<'_, 'a, '_> {
    /// Applies subscripts to a computed value, whose index types are not known. `None` after a message.
    /// The complete subscripts are `subscripts`; `view` is where their names are looked up.
    pub(in crate::instance) fn subscript(
        &mut self,
        value: ModelicaValue,
        subscripts: &'a [Subscript],
        view: LookupContext,
        span: Span,
    ) -> Option<ModelicaValue> {
        self.subscript_by(value, subscripts, &[], view, span)
    }

    /// Applies subscripts to an array. `by` holds the index types of its dimensions, as far as they are known.
    /// Missing subscripts select the complete dimension. `None` after a message.
    ///
    /// `span` is the complete expression. More subscripts than dimensions are an error.
    /// Several vectors as subscripts select all combinations: `a[{1, 2}, {3, 4}]` is a 2 by 2 array (MLS 10.5).
    pub(in crate::instance) fn subscript_by(
        &mut self,
        value: ModelicaValue,
        subscripts: &'a [Subscript],
        by: &[ScalarType],
        view: LookupContext,
        span: Span,
    ) -> Option<ModelicaValue> {
        if subscripts.is_empty() {
            return Some(value);
        }
        let ModelicaValue::Array { dims, elements } = &value else {
            return self.instance.fail(Code::BadIndex, &format!("{} cannot be indexed", value.describe()), span);
        };
        if subscripts.len() > dims.len() {
            let message = format!("{} indices for {}", subscripts.len(), value.describe());
            return self.instance.fail(Code::BadIndex, &message, span);
        }
        let mut picks = Vec::new();
        for (i, s) in subscripts.iter().enumerate() {
            picks.push(self.index(s, (dims[i], by.get(i).copied()), view, span)?);
        }
        // Dimensions without a subscript are kept, as if `:` were written.
        picks.extend(dims[subscripts.len()..].iter().map(|&n| SubscriptValue::Many((0..n).collect())));
        if picks.iter().any(|p| matches!(p, SubscriptValue::Symbolic(_))) {
            return self.dynamic(dims, elements, &picks, span);
        }
        Some(pick(dims, elements, &picks))
    }

    /// Evaluates one subscript for a dimension with `size` elements.
    ///
    /// `by` is the index type of the dimension; `None` for computed arrays, whose index type is not known.
    /// A parameter as subscript outside of functions becomes structural, so that the element is known.
    /// A subscript that changes is checked during the run. `None` after a message.
    ///
    /// - `:` selects all positions.
    /// - An Integer or enumeration value selects one position, a Boolean one of two.
    /// - A vector selects its elements in order.
    /// - An enumeration type or `Boolean` selects all positions.
    ///
    /// In a function a subscript of an argument may be symbolic; the caller then needs a procedure.
    pub(in crate::instance) fn index(
        &mut self,
        s: &'a Subscript,
        (size, by): (usize, Option<ScalarType>),
        view: LookupContext,
        span: Span,
    ) -> Option<SubscriptValue> {
        let Subscript::Expr(e) = s else { return Some(SubscriptValue::Many((0..size).collect())) };
        // `x[Color]` and `x[Boolean]` select all elements in the order of the values.
        if let Some(all) = self.enumeration_range(e, view) {
            self.check_index(all.first().and_then(ModelicaValue::element_type), by, e.span)?;
            return Some(SubscriptValue::Many((0..all.len()).collect()));
        }
        // `end` inside of the subscript means the last index of this dimension (MLS 10.5).
        self.instance.eval.ends.push((size, by.unwrap_or(ScalarType::Integer)));
        let value = self.eval(e, view);
        self.instance.eval.ends.pop();
        let value = value?;
        self.check_index(value.element_type(), by, e.span)?;
        match &value {
            ModelicaValue::Scalar(id, ScalarType::Boolean) if size == 2 => Some(self.boolean_index(*id)),
            ModelicaValue::Scalar(id, ty @ (ScalarType::Integer | ScalarType::Enumeration(_))) => {
                match self.instance.exprs.as_num(*id) {
                    Some(x) => Some(SubscriptValue::One(self.in_range(x, size, e.span)?)),
                    None => {
                        // Inside a function an expression of arguments has no value that could be looked up.
                        let outside = self.instance.eval.frame == 0 && !self.instance.eval.mode.procedure;
                        if outside
                            && self.instance.variability(*id) <= Variability::Parameter
                            && !self.instance.found_at_start(*id)
                        {
                            let known = self.constant(e, view)?.as_number(&self.instance.exprs);
                            if let Some(x) = known {
                                return Some(SubscriptValue::One(self.in_range(x, size, e.span)?));
                            }
                        }
                        // In a procedure the index depends on slots, which an assertion of the flat model cannot read.
                        if *ty == ScalarType::Integer && !self.instance.eval.mode.procedure {
                            self.watch_index(*id, size, e.span);
                        }
                        Some(SubscriptValue::Symbolic(*id))
                    }
                }
            }
            ModelicaValue::Array { elements, .. } => {
                let mut places = Vec::new();
                for v in elements.iter() {
                    let Some(x) = v.as_number(&self.instance.exprs) else {
                        return self.instance.fail(Code::NotConstant, "an index must be known before the run", span);
                    };
                    // Numbers count from 1; `false`, the first Boolean, is 0.
                    let first = if v.element_type() == Some(ScalarType::Boolean) { 0.0 } else { 1.0 };
                    places.push(self.in_range(x - first + 1.0, size, e.span)?);
                }
                Some(SubscriptValue::Many(places))
            }
            _ => self.wrong_type("an Integer", &value, e.span),
        }
    }

    /// Checks that a subscript has the index type of the dimension (MLS 10.5).
    /// Enumeration literals and Integers are not interchangeable. Unknown types pass. `None` after a message.
    /// `given` is the type of the subscript. `None` for either type means that it is not known, which passes.
    pub(in crate::instance) fn check_index(
        &mut self,
        given: Option<ScalarType>,
        by: Option<ScalarType>,
        span: Span,
    ) -> Option<()> {
        let (Some(given), Some(by)) = (given, by) else { return Some(()) };
        if given == by {
            return Some(());
        }
        let (wanted, words) = (self.instance.parameters().type_words(by), self.instance.parameters().type_words(given));
        let help = match (by, given) {
            (ScalarType::Enumeration(e), _) => {
                let e = &self.instance.enumerations[e as usize];
                let name = short(&e.name);
                let first = e.literals.first().map_or("", |l| l.as_str());
                format!("give a literal, as in `[{name}.{first}]`, or loop with `for i in {name} loop`")
            }
            (ScalarType::Boolean, _) => "give `false` or `true`, or a relation".into(),
            (_, ScalarType::Enumeration(_)) => "`Integer(e)` is the number of an enumeration value".into(),
            _ => "give a whole number; `integer(x)` is the one below `x`".into(),
        };
        let message = format!("this dimension counts by {wanted}, and the index is {words}");
        self.instance.report(Diagnostic::new(Code::TypeMismatch, message).at(span, "the index").help(help));
        None
    }

    /// The position for a Boolean subscript: `false` is the first element, `true` the second.
    /// `x[b]` with a changing `b` becomes the subscript `if b then 2 else 1`.
    pub(in crate::instance) fn boolean_index(&mut self, e: ExprId) -> SubscriptValue {
        match self.instance.exprs.as_num(e) {
            Some(x) => SubscriptValue::One(usize::from(x != 0.0)),
            None => {
                let two = self.instance.exprs.num(2.0);
                // As an Integer expression, so that it is handled like every other symbolic subscript.
                SubscriptValue::Symbolic(self.instance.exprs.if_(e, two, Exprs::ONE))
            }
        }
    }

    /// Adds an assertion that a changing subscript stays within 1 to `size`.
    /// It applies under the conditions of the `if`s around the subscript.
    /// A violation stops the run with a message that shows the value of the subscript.
    pub(in crate::instance) fn watch_index(&mut self, index: ExprId, size: usize, span: Span) {
        let last = self.instance.exprs.num(size as f64);
        let (low, high) = (
            self.instance.exprs.rel(RelationalOp::Ge, index, Exprs::ONE),
            self.instance.exprs.rel(RelationalOp::Le, index, last),
        );
        let condition = self.instance.exprs.and(low, high);
        let parts = vec![
            MessagePart::Text("the index ".into()),
            MessagePart::Value(index, ScalarType::Integer),
            MessagePart::Text(format!(" lies outside 1..{size}")),
        ];
        self.instance.statements().keep_call(Some(condition), Some(ModelicaValue::Text(Rc::new(parts))), false, span);
    }

    /// A known subscript as a position from 0. `None` after a message, if it is no whole number from 1 to `size`.
    pub(in crate::instance) fn in_range(&mut self, x: f64, size: usize, span: Span) -> Option<usize> {
        if x >= 1.0 && x <= size as f64 && x.fract() == 0.0 {
            return Some(x as usize - 1);
        }
        self.instance.fail(Code::BadIndex, &format!("index {x} lies outside 1..{size}"), span)
    }

    /// Elements at a position that is known only during the run.
    ///
    /// In a procedure this is an indexed slot. Elsewhere it is a chain of `if` over all elements.
    /// `None` after a message, or with `not_inline` set if the function around must become a procedure.
    ///
    /// `picks` has one entry for each dimension. With several symbolic entries the function calls itself for each of
    /// them.
    /// An empty array has no element to choose, which is reported.
    pub(in crate::instance) fn dynamic(
        &mut self,
        dims: &[usize],
        elements: &Rc<Vec<ModelicaValue>>,
        picks: &[SubscriptValue],
        span: Span,
    ) -> Option<ModelicaValue> {
        // A chain of `if` over many elements, repeated for each use, is longer than a procedure with an index.
        if self.instance.eval.frame > 0 && !self.instance.eval.mode.procedure && elements.len() > 12 {
            self.instance.eval.not_inline = true;
            return None;
        }
        if self.instance.eval.mode.procedure
            && let Some(v) = self.instance.procedures().indexed_slot(dims, elements, picks)
        {
            return Some(v);
        }
        let at = picks.iter().position(|p| matches!(p, SubscriptValue::Symbolic(_)))?;
        let SubscriptValue::Symbolic(index) = picks[at] else { return None };
        let mut result: Option<ModelicaValue> = None;
        // From the last element to the first: the chain is built from its end, and tests `index <= k` from below.
        for k in (0..dims[at]).rev() {
            let mut fixed = picks.to_vec();
            fixed[at] = SubscriptValue::One(k);
            let value = if fixed.iter().any(|p| matches!(p, SubscriptValue::Symbolic(_))) {
                self.dynamic(dims, elements, &fixed, span)?
            } else {
                pick(dims, elements, &fixed)
            };
            result = Some(match result {
                None => value,
                Some(rest) => {
                    let number = self.instance.exprs.num(k as f64 + 1.0);
                    let plain = self.instance.exprs.rel(RelationalOp::Le, index, number);
                    value.zip(&rest, &mut |x, y, _| self.instance.exprs.if_(plain, x, y))?
                }
            });
        }
        result.or_else(|| self.instance.fail(Code::BadIndex, "an index into an empty array", span))
    }
}

/// A subscript after evaluation. Positions are counted from 0.
#[derive(Clone, Debug)]
pub enum SubscriptValue {
    /// One position; the dimension disappears.
    One(usize),
    /// Several positions; the dimension stays, with this many elements.
    Many(Vec<usize>),
    /// A position known only during the run, as an expression counted from 1; the dimension disappears.
    Symbolic(ExprId),
}

/// Selects elements at known positions: one element, or an array with the sizes that stay.
/// `dims` and `elements` are the array in row-major order; there is one entry of `picks` for each dimension.
pub(in crate::instance) fn pick(dims: &[usize], elements: &[ModelicaValue], picks: &[SubscriptValue]) -> ModelicaValue {
    let (kept, places) = places(dims, picks);
    if kept.is_empty() {
        return elements[places[0]].clone();
    }
    ModelicaValue::array(kept, places.into_iter().map(|i| elements[i].clone()).collect())
}

/// The sizes that stay, and the row-major positions of the selected elements.
/// Symbolic subscripts select nothing here; callers handle them before.
///
/// ```text
/// dims [2, 3], picks [One(1), Many([0, 2])]   // sizes [2], positions [3, 5]
/// ```
pub(in crate::instance) fn places(dims: &[usize], picks: &[SubscriptValue]) -> (Vec<usize>, Vec<usize>) {
    let mut places = vec![0usize];
    let mut kept = Vec::new();
    for (p, &d) in picks.iter().zip(dims) {
        let choices: &[usize] = match p {
            SubscriptValue::One(i) => std::slice::from_ref(i),
            SubscriptValue::Many(many) => {
                kept.push(many.len());
                many
            }
            SubscriptValue::Symbolic(_) => &[],
        };
        // Each dimension extends the positions so far: the row-major position is built from the left.
        places = places.iter().flat_map(|&base| choices.iter().map(move |&c| base * d + c)).collect();
    }
    (kept, places)
}
