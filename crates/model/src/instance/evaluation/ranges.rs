//! Ranges, loops over them, and sizes, which must be known.

use crate::instance::deduce::Body;
use crate::instance::value::Val;
use crate::instance::{Evaluator, View};
use bramah_expr::types::{Type, Variability};
use bramah_syntax::ast::{Expr, ExprKind};
use bramah_syntax::diag::{Code, Diagnostic, Span};

impl<'a> Evaluator<'_, 'a, '_> {
    /// A dimension: a whole number that must be known, or a type whose values count.
    pub(in crate::instance) fn extent(&mut self, e: &'a Expr, view: View) -> Option<Extent> {
        if let Some(values) = self.enumeration_range(e, view) {
            let by = values.first().and_then(Val::element_type)?;
            return Some(Extent { size: values.len(), by });
        }
        Some(Extent { size: self.dimension(e, view)?, by: Type::Integer })
    }

    /// A size that must be known.
    pub(in crate::instance) fn dimension(&mut self, e: &'a Expr, view: View) -> Option<usize> {
        let value = self.constant(e, view)?;
        match (value.scalar(), value.as_number(&self.instance.exprs)) {
            (Some((_, Type::Integer)), Some(x)) if (0.0..1e9).contains(&x) => Some(x as usize),
            (Some((_, Type::Integer)), Some(x)) => {
                self.instance.fail(Code::OutOfRange, &format!("an array cannot have {x} elements"), e.span)
            }
            (Some((_, Type::Integer)), None) => {
                self.instance.fail(Code::NotConstant, "the size of an array must be known before the run", e.span)
            }
            _ => self.wrong_type("an Integer", &value, e.span),
        }
    }

    pub(in crate::instance) fn range(&mut self, e: &'a Expr, view: View) -> Option<Val> {
        let ExprKind::Range { from, step, to } = &e.kind else { return None };
        let from = self.known_number(from, view)?;
        let to = self.known_number(to, view)?;
        let step = match step {
            Some(s) => self.known_number(s, view)?,
            None => (1.0, Type::Integer),
        };
        if step.0 == 0.0 {
            return self.instance.fail(Code::OutOfRange, "the step of a range is 0", e.span);
        }
        let ty = [from.1, step.1, to.1].into_iter().find(|t| *t != Type::Integer).unwrap_or(Type::Integer);
        // A tiny allowance keeps 0:0.1:1 at eleven elements.
        let count = ((to.0 - from.0) / step.0 + 1e-10).floor() + 1.0;
        if count > 1e7 {
            return self.instance.fail(Code::TooLarge, "this range has more than ten million elements", e.span);
        }
        let count = count.max(0.0) as usize;
        let values = (0..count).map(|i| Val::Scalar(self.instance.exprs.num(from.0 + step.0 * i as f64), ty)).collect();
        Some(Val::array(vec![count], values))
    }

    /// A number that must be known, with its type; in functions it may depend on inputs that are known.
    pub(in crate::instance) fn known_number(&mut self, e: &'a Expr, view: View) -> Option<(f64, Type)> {
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

    pub(in crate::instance) fn truth_values(&mut self) -> Vec<Val> {
        [false, true].map(|b| Val::Scalar(self.instance.exprs.boolean(b), Type::Boolean)).into()
    }

    /// The literals when a range is an enumeration type or `Boolean`.
    pub(in crate::instance) fn enumeration_range(&mut self, e: &'a Expr, view: View) -> Option<Vec<Val>> {
        use crate::instance::lookup::{Builtin, Found};
        let ExprKind::Reference(r) = &e.kind else { return None };
        if r.parts.iter().any(|p| !p.subscripts.is_empty()) {
            return None;
        }
        if r.parts.len() == 1 && self.instance.local(r.parts[0].name.name).is_some() {
            return None;
        }
        let path = bramah_syntax::ast::Path {
            global: r.global,
            parts: r.parts.iter().map(|p| p.name).collect(),
            span: r.span,
        };
        let builtin = match self.instance.names().lookup_path(view, &path).ok()? {
            Found::Builtin(b) => b,
            Found::Class(c) => self.instance.names().template(c.class, c.parent).builtin?,
            Found::Component(..) => return None,
        };
        match builtin {
            Builtin::Boolean => Some(self.truth_values()),
            Builtin::Enumeration(i) => {
                let n = self.instance.enumerations[i as usize].literals.len();
                Some((1..=n).map(|k| Val::Scalar(self.instance.exprs.num(k as f64), Type::Enumeration(i))).collect())
            }
            _ => None,
        }
    }

    /// The values a loop variable takes.
    pub(in crate::instance) fn iterate(
        &mut self,
        iterator: &'a bramah_syntax::ast::Iterator,
        body: Body<'a>,
        view: View,
    ) -> Option<Vec<Val>> {
        let Some(range) = &iterator.range else { return self.deduced_range(iterator, body, view) };
        if let Some(values) = self.enumeration_range(range, view) {
            return Some(values);
        }
        let inside = self.instance.eval.frame > 0 || self.instance.eval.mode.procedure;
        let mut value = match &range.kind {
            ExprKind::Range { .. } if !inside => self.constant(range, view)?,
            _ => self.eval(range, view)?,
        };
        // Indices and counts must be known; other elements may change during the run.
        let mut scalars = Vec::new();
        value.scalars(&mut scalars);
        let fixed = scalars.iter().all(|e| self.instance.variability(*e) <= Variability::Parameter);
        if !inside && fixed && !matches!(value.element_type(), Some(Type::Real) | None) {
            value = self.constant(range, view)?;
        }
        match &value {
            Val::Array { dims, .. } if dims.len() == 1 => (0..dims[0]).map(|i| value.slice(i)).collect(),
            _ => self.wrong_type("a range or vector", &value, range.span),
        }
    }

    pub(in crate::instance) fn deduced_range(
        &mut self,
        iterator: &'a bramah_syntax::ast::Iterator,
        body: Body<'a>,
        view: View,
    ) -> Option<Vec<Val>> {
        let name = iterator.name.name;
        match self.deduced_extent(name, body, view) {
            Some(Extent { by: Type::Boolean, .. }) => Some(self.truth_values()),
            Some(Extent { size, by }) => {
                Some((1..=size).map(|i| Val::Scalar(self.instance.exprs.num(i as f64), by)).collect())
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

    pub(in crate::instance) fn comprehension(
        &mut self,
        function: Option<&'a bramah_syntax::ast::Reference>,
        body: &'a Expr,
        iterators: &'a [bramah_syntax::ast::Iterator],
        view: View,
        span: Span,
    ) -> Option<Val> {
        match function {
            None => self.array_comprehension(body, iterators, view, span),
            Some(f) => {
                let mut values = Vec::new();
                self.each_element(body, iterators, view, &mut values)?;
                self.instance.builtins().reduction(f, values, span)
            }
        }
    }

    /// `{e for i in A, j in B}`: the last iterator varies slowest and gives the first dimension (MLS 10.4.1).
    pub(in crate::instance) fn array_comprehension(
        &mut self,
        body: &'a Expr,
        iterators: &'a [bramah_syntax::ast::Iterator],
        view: View,
        span: Span,
    ) -> Option<Val> {
        let Some((last, rest)) = iterators.split_last() else { return self.eval(body, view) };
        let mut items = Vec::new();
        for value in self.iterate(last, Body::Expr(body), view)? {
            self.instance.eval.locals.push((last.name.name, value));
            let item = self.array_comprehension(body, rest, view, span);
            self.instance.eval.locals.pop();
            items.push(item?);
        }
        if items.is_empty() {
            return Some(Val::array(vec![0; iterators.len()], Vec::new()));
        }
        self.stacked(items, span)
    }

    pub(in crate::instance) fn each_element(
        &mut self,
        body: &'a Expr,
        iterators: &'a [bramah_syntax::ast::Iterator],
        view: View,
        out: &mut Vec<Val>,
    ) -> Option<()> {
        let Some((first, rest)) = iterators.split_first() else {
            out.push(self.eval(body, view)?);
            return Some(());
        };
        for value in self.iterate(first, Body::Expr(body), view)? {
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
pub(in crate::instance) struct Extent {
    /// How many elements.
    pub size: usize,
    /// What counts: Integers, truth values or the literals of an enumeration.
    pub by: Type,
}
