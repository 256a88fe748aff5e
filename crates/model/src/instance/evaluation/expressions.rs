//! Evaluates expressions to values.
//!
//! A syntax tree and the place to look up its names go in, a [`ModelicaValue`] comes out.
//! Values are symbolic by default. In the mode `constant` parameters count by value, for sizes and conditions.
//! `None` always means that a message was reported.

use crate::instance::evaluation::state::EvaluationMode;
use crate::instance::modifiers::{AccessStep, Binding};
use crate::instance::value::{ModelicaValue, size_text, stack};
use crate::instance::{Evaluator, LookupContext, Statements};
use bramah_expr::types::{ScalarType, Variability};
use bramah_expr::{ExprId, Exprs};
use bramah_syntax::ast::{Expr, ExprKind};
use bramah_syntax::diag::{Code, Diagnostic, Span};
use std::rc::Rc;

impl<'a> Evaluator<'_, 'a, '_> {
    /// Evaluates an expression. `None` after a message.
    /// A call with several outputs gives its first one (MLS 12.4.3).
    pub fn eval(&mut self, e: &'a Expr, view: LookupContext) -> Option<ModelicaValue> {
        match self.eval_all(e, view)? {
            ModelicaValue::Tuple(values) => match values.first() {
                Some(first) => Some(first.clone()),
                None => self.no_output(e),
            },
            value => Some(value),
        }
    }

    /// Reports a call without outputs that is used as a value.
    /// `None` always. The message names the function if the expression is a call.
    fn no_output(&mut self, e: &'a Expr) -> Option<ModelicaValue> {
        let name = match &e.kind {
            ExprKind::Call { function, .. } => {
                function.parts.iter().map(|p| p.name.name.as_str()).collect::<Vec<_>>().join(".")
            }
            _ => "this".to_owned(),
        };
        self.instance.fail(Code::BadCall, &format!("`{name}` has no output"), e.span)
    }

    /// Evaluates an expression. A call with several outputs gives a tuple of all of them.
    ///
    /// Each form of expression has its function here or in another view.
    /// - Literals are constants of the pool.
    /// - Names are references, see `references`.
    /// - Operators go to [`Operators`](crate::instance::Operators), calls to
    ///   [`FunctionCalls`](crate::instance::FunctionCalls).
    /// - Array constructors stack the values of their elements.
    /// - `end` is the size of the array whose subscript is evaluated.
    ///
    /// `None` after a message. An expression with a syntax error gives `None` without one, because the parser reported
    /// it.
    pub fn eval_all(&mut self, e: &'a Expr, view: LookupContext) -> Option<ModelicaValue> {
        match &e.kind {
            ExprKind::Integer(i) => Some(self.integer(*i as f64)),
            ExprKind::Real(x) => Some(ModelicaValue::Scalar(self.instance.exprs.num(*x), ScalarType::Real)),
            ExprKind::Boolean(b) => Some(ModelicaValue::Scalar(self.instance.exprs.boolean(*b), ScalarType::Boolean)),
            ExprKind::String(s) => Some(ModelicaValue::text(&**s)),
            ExprKind::Reference(r) => self.reference(r, view),
            ExprKind::Unary(op, a) => {
                let value = self.eval(a, view)?;
                self.instance.operators().unary(*op, value, e.span)
            }
            ExprKind::Binary(op, a, b) => {
                // Both sides are evaluated before `?`, so that one message does not hide another one.
                let (x, y) = (self.eval(a, view), self.eval(b, view));
                self.instance.operators().binary(*op, x?, y?, e.span)
            }
            ExprKind::If { branches, otherwise } => self.if_expression(branches, otherwise, view, e.span),
            ExprKind::Range { .. } => self.range(e, view),
            ExprKind::Call { function, args, named } => self.instance.calls().call(function, args, named, view, e.span),
            ExprKind::Comprehension { function, body, iterators } => {
                self.comprehension(function.as_ref(), body, iterators, view, e.span)
            }
            ExprKind::Array(items) => {
                let values: Option<Vec<ModelicaValue>> = items.iter().map(|i| self.eval(i, view)).collect();
                self.stacked(values?, e.span)
            }
            ExprKind::Matrix(rows) => self.matrix(rows, view, e.span),
            ExprKind::Tuple(items) => {
                let values: Option<Vec<ModelicaValue>> = items
                    .iter()
                    // An omitted item, as in `(, b) = f(x)`, is an empty text that nobody reads.
                    .map(|i| i.as_ref().map_or(Some(ModelicaValue::text("")), |i| self.eval(i, view)))
                    .collect();
                Some(ModelicaValue::Tuple(Rc::new(values?)))
            }
            ExprKind::Index(inner, subscripts) => {
                let value = self.eval(inner, view)?;
                self.subscript(value, subscripts, view, e.span)
            }
            ExprKind::End => match self.instance.eval.ends.last() {
                // `end` of an enumeration is its last literal, of Booleans `true` (MLS 10.5).
                Some(&(_, ScalarType::Boolean)) => Some(ModelicaValue::Scalar(Exprs::ONE, ScalarType::Boolean)),
                Some(&(n, by)) => Some(ModelicaValue::Scalar(self.instance.exprs.num(n as f64), by)),
                None => self.instance.fail(Code::BadIndex, "`end` is only known inside brackets `[...]`", e.span),
            },
            ExprKind::PartialApplication { function, named } => {
                self.instance.calls().partial_application(function, named, view)
            }
            // The parser has reported it.
            ExprKind::Error => None,
        }
    }

    /// Evaluates an expression with the values of parameters, which makes these parameters structural.
    pub fn constant(&mut self, e: &'a Expr, view: LookupContext) -> Option<ModelicaValue> {
        self.instance.in_mode(|m| m.constant = true, |s| s.evaluator().eval(e, view))
    }

    /// Evaluates a condition that must be known when the model is built. `None` after a message.
    /// Used for conditional components, `if` equations and `if` expressions of parameters.
    pub fn constant_boolean(&mut self, e: &'a Expr, view: LookupContext) -> Option<bool> {
        let value = self.constant(e, view)?;
        match (value.scalar(), value.as_number(&self.instance.exprs)) {
            (Some((_, ScalarType::Boolean)), Some(x)) => Some(x != 0.0),
            (Some((_, ScalarType::Boolean)), None) => {
                self.instance.fail(Code::NotConstant, "this condition must be known before the run", e.span)
            }
            _ => self.wrong_type("a Boolean", &value, e.span),
        }
    }

    /// An Integer value.
    pub(in crate::instance) fn integer(&mut self, x: f64) -> ModelicaValue {
        ModelicaValue::Scalar(self.instance.exprs.num(x), ScalarType::Integer)
    }

    /// Reports that another type is needed, and returns `None`.
    pub(in crate::instance) fn wrong_type<T>(&mut self, wanted: &str, got: &ModelicaValue, span: Span) -> Option<T> {
        let message = format!("{wanted} is needed here, and this is {}", got.describe());
        self.instance.fail(Code::TypeMismatch, &message, span)
    }

    /// Evaluates a binding equation and takes the part for one element.
    /// `constant` asks for parameters by value. `None` after a message.
    ///
    /// ```text
    /// A a[2](x = {1, 2});   // a[2].x takes element 2 of the value {1, 2}
    /// ```
    pub fn binding_value(&mut self, b: &Binding<'a>, constant: bool) -> Option<ModelicaValue> {
        if b.access.is_empty() {
            return self.isolated(b, constant);
        }
        // The elements of an array share one expression: it is evaluated once and the result is kept.
        let key = (std::ptr::from_ref(b.expr), b.view, constant);
        let whole = match self.instance.values.arrays.get(&key) {
            Some(v) => v.clone(),
            None => {
                let v = self.isolated(b, constant)?;
                self.instance.values.arrays.insert(key, v.clone());
                v
            }
        };
        self.access(whole, &b.access, b.expr.span)
    }

    /// Evaluates the complete expression of a binding, whatever evaluation is going on around.
    /// The locals, the meaning of `end` and `noEvent` around it do not apply inside.
    fn isolated(&mut self, b: &Binding<'a>, constant: bool) -> Option<ModelicaValue> {
        let frame = std::mem::replace(&mut self.instance.eval.frame, self.instance.eval.locals.len());
        let ends = std::mem::take(&mut self.instance.eval.ends);
        let change = |m: &mut EvaluationMode| (m.constant, m.no_event) = (constant, false);
        let value = self.instance.in_mode(change, |s| s.evaluator().eval(b.expr, b.view));
        self.instance.eval.frame = frame;
        self.instance.eval.ends = ends;
        value
    }

    /// Follows the steps to a part of a value. `None` after a message, if the value has no such part.
    ///
    /// - An index step needs an array whose first dimension has exactly the expected size.
    /// - A field step needs a record with that field.
    ///
    /// `span` is the expression, where messages point to.
    fn access(&mut self, mut value: ModelicaValue, access: &[AccessStep], span: Span) -> Option<ModelicaValue> {
        for step in access {
            let next = match step {
                AccessStep::Index(at) if value.dims().first().is_some_and(|&n| n == at.of as usize) => {
                    value.slice(at.place as usize)
                }
                AccessStep::Index(_) => None,
                AccessStep::Field(name) => match &value {
                    ModelicaValue::Record(record) => {
                        record.fields.iter().find(|(n, _)| n == name).map(|(_, v)| v.clone())
                    }
                    _ => None,
                },
            };
            value = match (next, step) {
                (Some(v), _) => v,
                (None, AccessStep::Index(at)) => {
                    self.wrong_count(at.of, &value, span);
                    return None;
                }
                (None, AccessStep::Field(name)) => {
                    let message = format!("this has no field `{name}`: it is {}", value.describe());
                    return self.instance.fail(Code::TypeMismatch, &message, span);
                }
            };
        }
        Some(value)
    }

    /// Reports a value whose size is not that of the array. It is reported once for all elements.
    ///
    /// ```text
    /// A a[3](x = {1, 2});   // an array of 3 elements is needed here
    /// ```
    ///
    /// The help proposes `each`, which is what is missing most often.
    fn wrong_count(&mut self, wanted: u32, value: &ModelicaValue, span: Span) {
        let message = format!("an array of {wanted} elements is needed here, and this is {}", value.describe());
        if self
            .instance
            .diagnostics
            .iter()
            .any(|d| d.message == message && d.labels.first().is_some_and(|l| l.span == span))
        {
            return;
        }
        self.instance.report(
            Diagnostic::new(Code::SizeMismatch, message)
                .at(span, "the value for an array")
                .help("give one value for each element, or write `each` to give all of them the same"),
        );
    }

    /// An array from values of equal shape. `None` after a message, if their shapes differ.
    /// Integers among Reals become Reals. The message lists the shapes of all elements.
    pub(in crate::instance) fn stacked(&mut self, values: Vec<ModelicaValue>, span: Span) -> Option<ModelicaValue> {
        let shapes: Vec<String> = values.iter().map(ModelicaValue::describe).collect();
        match stack(values) {
            Some(v) => Some(v),
            None => {
                let message = format!("the elements of an array differ in size: {}", shapes.join(", "));
                self.instance.fail(Code::SizeMismatch, &message, span)
            }
        }
    }

    /// `[a, b; c, d]`: concatenation along dimension 2 in each row, then of the rows along dimension 1 (MLS 10.4.2.1).
    ///
    /// `[1, 2; 3, 4]` is a 2 by 2 matrix. The entries may be matrices, whose sizes must fit.
    fn matrix(&mut self, rows: &'a [Vec<Expr>], view: LookupContext, span: Span) -> Option<ModelicaValue> {
        let mut lines = Vec::new();
        for row in rows {
            let values: Option<Vec<ModelicaValue>> = row.iter().map(|e| self.eval(e, view)).collect();
            // Scalars and vectors count as matrices of one column.
            let values = values?.into_iter().map(as_matrix).collect();
            lines.push(self.concatenate(2, values, span)?);
        }
        self.concatenate(1, lines, span)
    }

    /// Joins arrays along dimension `along`, counted from 1: `cat(k, ...)`, also used for `[a, b; c, d]` (MLS 10.4.2).
    ///
    /// All other dimensions must be equal. `None` after a message, if they are not or there is no such dimension.
    /// The result keeps the order of the arguments along `along`. No arguments give an empty vector.
    pub(in crate::instance) fn concatenate(
        &mut self,
        along: usize,
        values: Vec<ModelicaValue>,
        span: Span,
    ) -> Option<ModelicaValue> {
        // Only a matrix without entries comes here without arguments.
        let Some(first) = values.first() else { return Some(ModelicaValue::array(vec![0], Vec::new())) };
        let mut dims = first.dims().to_vec();
        if along == 0 || along > dims.len() {
            return self.instance.fail(
                Code::SizeMismatch,
                &format!("there is no dimension {along} to join along"),
                span,
            );
        }
        let k = along - 1;
        for v in &values[1..] {
            let fits = v.dims().len() == dims.len() && (0..dims.len()).all(|i| i == k || v.dims()[i] == dims[i]);
            if !fits {
                let message = format!("sizes {} and {} cannot be joined", size_text(&dims), size_text(v.dims()));
                return self.instance.fail(Code::SizeMismatch, &message, span);
            }
        }
        dims[k] = values.iter().map(|v| v.dims()[k]).sum();
        // In row-major order the result consists of `outer` blocks; each takes one consecutive chunk of every argument.
        let outer: usize = dims[..k].iter().product();
        let mut elements = Vec::with_capacity(dims.iter().product());
        for o in 0..outer {
            for v in &values {
                let chunk = v.elements().len() / outer.max(1);
                elements.extend_from_slice(&v.elements()[o * chunk..(o + 1) * chunk]);
            }
        }
        Some(ModelicaValue::array(dims, elements))
    }

    /// `if c then a elseif d then b else e`: a value that contains the condition, or one branch if the condition is
    /// known.
    ///
    /// The rules, in this order:
    /// - A condition that is a number selects its branch. The others are not evaluated.
    /// - So does a condition of parameters that are all annotated `Evaluate = true`.
    /// - Otherwise both branches are evaluated and merged scalar by scalar.
    /// - If a parameter decides and the branches do not fit each other, or contain different derivatives, the parameter
    ///   becomes structural and selects the branch.
    ///
    /// Messages of a branch are dropped together with the branch. `None` after a message.
    /// `branches` are the conditions with their values, `otherwise` is the value of `else`.
    fn if_expression(
        &mut self,
        branches: &'a [(Expr, Expr)],
        otherwise: &'a Expr,
        view: LookupContext,
        span: Span,
    ) -> Option<ModelicaValue> {
        let Some(((condition, value), rest)) = branches.split_first() else { return self.eval(otherwise, view) };
        let c = self.eval(condition, view)?;
        let Some((test, ScalarType::Boolean)) = c.scalar() else {
            return self.wrong_type("a Boolean", &c, condition.span);
        };
        if let Some(known) = self.instance.exprs.as_num(test) {
            return if known == 0.0 { self.if_expression(rest, otherwise, view, span) } else { self.eval(value, view) };
        }
        if self.is_evaluated(test) {
            let (known, messages) = self.instance.attempt(|i| i.evaluator().constant_boolean(condition, view));
            if let Some(first) = known {
                self.instance.diagnostics.extend(messages);
                return if first { self.eval(value, view) } else { self.if_expression(rest, otherwise, view, span) };
            }
            // Inside a function the arguments are expressions without a value, so evaluating the condition may fail.
            // Both branches are evaluated then.
        }
        // If the branches are thrown away below, the assertions that they left go with them.
        let calls = self.instance.eval.calls.len();
        let not = self.instance.exprs.not(test);
        let ((a, b), messages) = self.instance.attempt(|i| {
            // The guards tell assertions inside the branch under which condition they apply.
            let a = i.statements().guarded(test, |s| s.instance.evaluator().eval(value, view));
            let rest =
                |s: &mut Statements<'_, 'a, '_>| s.instance.evaluator().if_expression(rest, otherwise, view, span);
            (a, i.statements().guarded(not, rest))
        });
        let by_parameter = self.instance.variability(test) <= Variability::Parameter
            && !self.instance.eval.mode.procedure
            && self.instance.eval.frame == 0;
        // `der(x)` in one branch only makes `x` a state for some parameter values, and states must be known before the
        // run.
        if by_parameter
            && let (Some(a), Some(b)) = (&a, &b)
            && self.derivatives_differ(a, b)
            && !self.instance.found_at_start(test)
        {
            self.instance.diagnostics.extend(messages);
            self.instance.eval.calls.truncate(calls);
            return match self.constant_boolean(condition, view)? {
                true => self.eval(value, view),
                false => self.if_expression(rest, otherwise, view, span),
            };
        }
        let merged = match (&a, &b) {
            (Some(a), Some(b)) => a.zip(b, &mut |x, y, _| self.instance.exprs.if_(test, x, y)),
            _ => None,
        };
        if merged.is_some() {
            self.instance.diagnostics.extend(messages);
            return merged;
        }
        // A branch may be meaningless here, as with an absent component or another size, if a parameter decides.
        if by_parameter {
            self.instance.eval.calls.truncate(calls);
            return match self.constant_boolean(condition, view)? {
                true => self.eval(value, view),
                false => self.if_expression(rest, otherwise, view, span),
            };
        }
        self.instance.diagnostics.extend(messages);
        let (a, b) = (a?, b?);
        // Strings are not part of the run, so nothing could choose between two of them.
        if let (ModelicaValue::Text(_), ModelicaValue::Text(_)) = (&a, &b) {
            return self.instance.fail(Code::NotConstant, "this text must be known before the run", span);
        }
        self.instance.operators().sizes_differ(&a, &b, span)
    }

    /// Whether a condition reads only parameters annotated `Evaluate = true`, and at least one (MLS 18.3).
    /// Always false inside functions, whose arguments are no parameters.
    fn is_evaluated(&self, test: ExprId) -> bool {
        let variables = self.instance.exprs.variables(test);
        let own = !self.instance.eval.mode.procedure && self.instance.eval.frame == 0;
        own && !variables.is_empty() && variables.iter().all(|v| self.instance.variable(*v).evaluate)
    }

    /// Whether two values contain derivatives of different variables.
    /// It decides whether a condition of parameters determines which variables are states.
    fn derivatives_differ(&self, a: &ModelicaValue, b: &ModelicaValue) -> bool {
        let of = |v: &ModelicaValue| {
            let mut scalars = Vec::new();
            v.scalars(&mut scalars);
            let mut found: Vec<_> = scalars.into_iter().flat_map(|e| self.instance.exprs.derivatives(e)).collect();
            found.sort_unstable();
            found.dedup();
            found
        };
        of(a) != of(b)
    }
}

/// A scalar or vector as a matrix, for `[a, b; c, d]`. Missing dimensions become 1, so vectors are columns.
fn as_matrix(v: ModelicaValue) -> ModelicaValue {
    let mut dims = v.dims().to_vec();
    while dims.len() < 2 {
        dims.push(1);
    }
    let elements = v.elements().to_vec();
    ModelicaValue::array(dims, elements)
}
