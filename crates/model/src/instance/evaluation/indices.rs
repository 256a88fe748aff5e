//! Subscripts: elements and parts of arrays, by numbers that are known or change during the run.

use crate::instance::errors::short;
use crate::instance::value::ModelicaValue;
use crate::instance::{Evaluator, LookupContext};
use bramah_expr::types::{MessagePart, ScalarType, Variability};
use bramah_expr::{ExprId, Exprs, RelationalOp};
use bramah_syntax::ast::Subscript;
use bramah_syntax::diag::{Code, Diagnostic, Span};
use std::rc::Rc;

impl<'a> Evaluator<'_, 'a, '_> {
    /// Applies subscripts to a value.
    pub(in crate::instance) fn subscript(
        &mut self,
        value: ModelicaValue,
        subscripts: &'a [Subscript],
        view: LookupContext,
        span: Span,
    ) -> Option<ModelicaValue> {
        self.subscript_by(value, subscripts, &[], view, span)
    }

    /// Applies subscripts to the value of an array of which is known what counts along its dimensions.
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
        picks.extend(dims[subscripts.len()..].iter().map(|&n| SubscriptValue::Many((0..n).collect())));
        if picks.iter().any(|p| matches!(p, SubscriptValue::Symbolic(_))) {
            return self.dynamic(dims, elements, &picks, span);
        }
        Some(pick(dims, elements, &picks))
    }

    /// One subscript: a known place, several, or one only known at run time. What counts along the dimension is not
    /// known of an array that was computed.
    pub(in crate::instance) fn index(
        &mut self,
        s: &'a Subscript,
        (size, by): (usize, Option<ScalarType>),
        view: LookupContext,
        span: Span,
    ) -> Option<SubscriptValue> {
        let Subscript::Expr(e) = s else { return Some(SubscriptValue::Many((0..size).collect())) };
        if let Some(all) = self.enumeration_range(e, view) {
            self.check_index(all.first().and_then(ModelicaValue::element_type), by, e.span)?;
            return Some(SubscriptValue::Many((0..all.len()).collect()));
        }
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
                    let first = if v.element_type() == Some(ScalarType::Boolean) { 0.0 } else { 1.0 };
                    places.push(self.in_range(x - first + 1.0, size, e.span)?);
                }
                Some(SubscriptValue::Many(places))
            }
            _ => self.wrong_type("an Integer", &value, e.span),
        }
    }

    /// An array is indexed by what its declaration counts by (MLS 10.5): literals of an enumeration and numbers do not
    /// stand for each other.
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

    /// `false` and `true` as indices of an array declared with `[Boolean]`.
    pub(in crate::instance) fn boolean_index(&mut self, e: ExprId) -> SubscriptValue {
        match self.instance.exprs.as_num(e) {
            Some(x) => SubscriptValue::One(usize::from(x != 0.0)),
            None => {
                let two = self.instance.exprs.num(2.0);
                SubscriptValue::Symbolic(self.instance.exprs.if_(e, two, Exprs::ONE))
            }
        }
    }

    /// An index that changes must stay inside the array during the run, wherever it is used.
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

    pub(in crate::instance) fn in_range(&mut self, x: f64, size: usize, span: Span) -> Option<usize> {
        if x >= 1.0 && x <= size as f64 && x.fract() == 0.0 {
            return Some(x as usize - 1);
        }
        self.instance.fail(Code::BadIndex, &format!("index {x} lies outside 1..{size}"), span)
    }

    /// An element chosen at run time: a chain of `if`, or an indexed slot in a procedure.
    pub(in crate::instance) fn dynamic(
        &mut self,
        dims: &[usize],
        elements: &Rc<Vec<ModelicaValue>>,
        picks: &[SubscriptValue],
        span: Span,
    ) -> Option<ModelicaValue> {
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

/// A subscript after evaluation.
#[derive(Clone, Debug)]
pub enum SubscriptValue {
    /// One place, from 0.
    One(usize),
    /// Several places; the dimension stays.
    Many(Vec<usize>),
    /// A place known at run time only.
    Symbolic(ExprId),
}

/// Picks elements by known places.
pub(in crate::instance) fn pick(dims: &[usize], elements: &[ModelicaValue], picks: &[SubscriptValue]) -> ModelicaValue {
    let (kept, places) = places(dims, picks);
    if kept.is_empty() {
        return elements[places[0]].clone();
    }
    ModelicaValue::array(kept, places.into_iter().map(|i| elements[i].clone()).collect())
}

/// The row-major places of what is picked, and the sizes that stay.
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
        places = places.iter().flat_map(|&base| choices.iter().map(move |&c| base * d + c)).collect();
    }
    (kept, places)
}
