//! Operators on values: arithmetic on numbers, arrays and matrices, relations, logic, and operators on Strings (MLS
//! 10.6).
//!
//! The evaluator calls [`Operators`] with evaluated operands and the place of the expression for messages.
//! The result is symbolic; the expression pool folds what is known. `None` means that a message was reported.

use crate::instance::Operators;
use crate::instance::value::{ModelicaValue, wider};
use bramah_expr::types::{MessagePart, ScalarType, Variability};
use bramah_expr::{BinaryFunction, Exprs, RelationalOp};
use bramah_syntax::ast::{BinaryOp, UnaryOp};
use bramah_syntax::diag::{Code, Diagnostic, Span};
use std::rc::Rc;

impl<'a> Operators<'_, 'a, '_> {
    /// Applies a unary operator to a value, element by element.
    ///
    /// `-` and `+` need numbers, `not` needs Booleans. An operator record with a function for the operator comes first.
    /// For an array the operator is applied to each element, and the type stays.
    pub(in crate::instance) fn unary(
        &mut self,
        op: UnaryOp,
        value: ModelicaValue,
        span: Span,
    ) -> Option<ModelicaValue> {
        // Operator records have their own functions (MLS 14).
        if let Some(result) = self.overloaded_unary(op, &value, span) {
            return result;
        }
        let ty = value.element_type();
        match op {
            UnaryOp::Not => match ty {
                Some(ScalarType::Boolean) => Some(value.map(&mut |e, _| self.instance.exprs.not(e))),
                _ => self.instance.evaluator().wrong_type("a Boolean", &value, span),
            },
            UnaryOp::Plus | UnaryOp::ElementPlus => Some(value),
            UnaryOp::Minus | UnaryOp::ElementMinus => match ty {
                Some(ScalarType::Real | ScalarType::Integer) => Some(value.map(&mut |e, _| self.instance.exprs.neg(e))),
                // An empty array has no element type, and nothing to negate.
                None if value.elements().is_empty() => Some(value),
                _ => self.instance.evaluator().wrong_type("a number", &value, span),
            },
        }
    }

    /// Applies a binary operator to two values.
    ///
    /// The plain operators follow linear algebra: `*` is the matrix product and `+` needs equal shapes.
    /// The operators with a dot, `.*` and the like, work element by element (MLS 10.6).
    ///
    /// - `+`, `-`: equal shapes. `*`: scalars, vectors, matrices. `/`: a scalar on the right. `^`: scalars or a matrix.
    /// - Relations: two scalars. `and`, `or`: Booleans of equal shape.
    ///
    /// `None` after a message.
    pub(in crate::instance) fn binary(
        &mut self,
        op: BinaryOp,
        a: ModelicaValue,
        b: ModelicaValue,
        span: Span,
    ) -> Option<ModelicaValue> {
        use BinaryOp as B;
        // Operator records come first, then Strings: neither has the shapes that the rest checks.
        if let Some(result) = self.overloaded_binary(op, &a, &b, span) {
            return result;
        }
        if let (ModelicaValue::Text(x), ModelicaValue::Text(y)) = (&a, &b) {
            return self.texts(op, x, y, span);
        }
        match op {
            B::Add | B::Sub | B::ElementAdd | B::ElementSub => self.elementwise(op, &a, &b, span),
            B::Mul => self.product(&a, &b, span),
            B::Div if b.dims().is_empty() => self.broadcast(op, &a, &b, span),
            B::Pow if !a.dims().is_empty() => self.matrix_power(&a, &b, span),
            // Arrays are divided and raised element by element with `./` and `.^` only (MLS 10.6).
            B::Div => self.instance.evaluator().wrong_type("a single number as divisor", &b, span),
            B::Pow if !b.dims().is_empty() => {
                self.instance.evaluator().wrong_type("a single number as exponent", &b, span)
            }
            B::Pow | B::ElementMul | B::ElementDiv | B::ElementPow => self.broadcast(op, &a, &b, span),
            B::Lt | B::Le | B::Gt | B::Ge | B::Eq | B::Ne => self.relation(op, &a, &b, span),
            B::And | B::Or => {
                let (ta, tb) = (a.element_type(), b.element_type());
                if ta != Some(ScalarType::Boolean) {
                    return self.instance.evaluator().wrong_type("a Boolean", &a, span);
                }
                if tb != Some(ScalarType::Boolean) {
                    return self.instance.evaluator().wrong_type("a Boolean", &b, span);
                }
                let and = op == B::And;
                let zipped = a.zip(&b, &mut |x, y, _| {
                    if and { self.instance.exprs.and(x, y) } else { self.instance.exprs.or(x, y) }
                });
                zipped.or_else(|| self.sizes_differ(&a, &b, span))
            }
        }
    }

    /// Applies an operator to two Strings: `+` joins them, relations compare them.
    ///
    /// Joining works for Strings with symbolic values in them. Comparing needs both to be known, else a message is
    /// reported.
    ///
    /// `x` and `y` are the pieces of both Strings. Comparison follows the order of the characters (MLS 3.5).
    pub(in crate::instance) fn texts(
        &mut self,
        op: BinaryOp,
        x: &Rc<Vec<MessagePart>>,
        y: &Rc<Vec<MessagePart>>,
        span: Span,
    ) -> Option<ModelicaValue> {
        if op == BinaryOp::Add {
            return Some(ModelicaValue::Text(Rc::new(x.iter().chain(y.iter()).cloned().collect())));
        }
        let words = |p: &Rc<Vec<MessagePart>>| ModelicaValue::Text(p.clone()).as_text(&self.instance.exprs);
        let (Some(x), Some(y)) = (words(x), words(y)) else {
            return self.instance.fail(Code::NotConstant, "this text must be known before the run", span);
        };
        let truth = match op {
            BinaryOp::Eq => x == y,
            BinaryOp::Ne => x != y,
            BinaryOp::Lt => x < y,
            BinaryOp::Le => x <= y,
            BinaryOp::Gt => x > y,
            BinaryOp::Ge => x >= y,
            _ => return self.instance.fail(Code::TypeMismatch, "texts can only be joined with `+` or compared", span),
        };
        Some(ModelicaValue::Scalar(self.instance.exprs.boolean(truth), ScalarType::Boolean))
    }

    /// Reports that the operands do not fit, and returns `None`.
    /// The code is that of a type error if the shapes agree, else that of a size error.
    pub(in crate::instance) fn sizes_differ<T>(
        &mut self,
        a: &ModelicaValue,
        b: &ModelicaValue,
        span: Span,
    ) -> Option<T> {
        let message = format!("the two sides do not fit: {} and {}", a.describe(), b.describe());
        let code = if a.dims() == b.dims() { Code::TypeMismatch } else { Code::SizeMismatch };
        self.instance.fail(code, &message, span)
    }

    /// Checks that a value consists of numbers. Empty arrays pass, because their element type is not known.
    /// `None` after a message.
    pub(in crate::instance) fn numeric(&mut self, v: &ModelicaValue, span: Span) -> Option<()> {
        match v.element_type() {
            Some(ScalarType::Real | ScalarType::Integer) => Some(()),
            None if v.elements().is_empty() => Some(()),
            _ => self.instance.evaluator().wrong_type("a number", v, span),
        }
    }

    /// `+` and `-`: both operands must have the same shape. `.+` and `.-` also combine a scalar with an array.
    /// `op` is one of these four. `None` after a message.
    ///
    /// The result has the wider type of both. Integers and Reals mix, Booleans are refused.
    pub(in crate::instance) fn elementwise(
        &mut self,
        op: BinaryOp,
        a: &ModelicaValue,
        b: &ModelicaValue,
        span: Span,
    ) -> Option<ModelicaValue> {
        self.numeric(a, span)?;
        self.numeric(b, span)?;
        if matches!(op, BinaryOp::ElementAdd | BinaryOp::ElementSub) && a.dims() != b.dims() {
            return self.broadcast(op, a, b, span);
        }
        let op = scalar_op(op);
        let zipped = a.zip(b, &mut |x, y, _| self.instance.exprs.binary(op, x, y));
        zipped.or_else(|| self.sizes_differ(a, b, span))
    }

    /// Combines a scalar with each element of an array, or two values of equal shape element by element.
    ///
    /// The result is Real if one operand is, and always for division and powers. `None` after a message.
    ///
    /// - Scalar and array: the scalar is combined with each element, on the side on which it stands.
    /// - Equal shapes: corresponding elements are combined.
    /// - Everything else is reported.
    pub(in crate::instance) fn broadcast(
        &mut self,
        op: BinaryOp,
        a: &ModelicaValue,
        b: &ModelicaValue,
        span: Span,
    ) -> Option<ModelicaValue> {
        self.numeric(a, span)?;
        self.numeric(b, span)?;
        let code = scalar_op(op);
        let real = matches!(code, BinaryFunction::Div | BinaryFunction::Pow);
        let result = match (a.scalar(), b.scalar()) {
            (Some((x, tx)), _) if !b.dims().is_empty() => {
                b.map(&mut |y, _| self.instance.exprs.binary(code, x, y)).with_type(tx)
            }
            (_, Some((y, ty))) if !a.dims().is_empty() => {
                a.map(&mut |x, _| self.instance.exprs.binary(code, x, y)).with_type(ty)
            }
            _ => match a.zip(b, &mut |x, y, _| self.instance.exprs.binary(code, x, y)) {
                Some(v) => v,
                None => return self.sizes_differ(a, b, span),
            },
        };
        Some(if real { result.with_type(ScalarType::Real) } else { result })
    }

    /// `a * b`: with a scalar element by element, otherwise a product of vectors and matrices (MLS 10.6).
    ///
    /// A vector on the left counts as a row, on the right as a column. Two vectors give a scalar.
    /// `None` after a message, if the inner sizes differ or an array has more than two dimensions.
    ///
    /// The sizes for `a * b` are:
    /// - `[n, m] * [m, k]` gives `[n, k]`, `[n, m] * [m]` gives `[n]`,
    /// - `[n] * [n, k]` gives `[k]`, `[n] * [n]` gives a scalar.
    ///
    /// The type is Real if one operand is.
    /// Both operands must consist of numbers.
    pub(in crate::instance) fn product(
        &mut self,
        a: &ModelicaValue,
        b: &ModelicaValue,
        span: Span,
    ) -> Option<ModelicaValue> {
        if a.dims().is_empty() || b.dims().is_empty() {
            return self.broadcast(BinaryOp::ElementMul, a, b, span);
        }
        self.numeric(a, span)?;
        self.numeric(b, span)?;
        let ty = wider(a.element_type().unwrap_or(ScalarType::Real), b.element_type().unwrap_or(ScalarType::Real))
            .unwrap_or(ScalarType::Real);
        let (da, db) = (a.dims().to_vec(), b.dims().to_vec());
        if da[da.len() - 1] != db[0] || da.len() > 2 || db.len() > 2 {
            return self.sizes_differ(a, b, span);
        }
        let (rows, inner) = if da.len() == 2 { (da[0], da[1]) } else { (1, da[0]) };
        let columns = if db.len() == 2 { db[1] } else { 1 };
        let entry = |v: &ModelicaValue, i: usize| v.elements()[i].scalar().map_or(Exprs::ZERO, |(e, _)| e);
        let mut elements = Vec::with_capacity(rows * columns);
        for r in 0..rows {
            for c in 0..columns {
                let mut sum = Exprs::ZERO;
                for k in 0..inner {
                    let term = self.instance.exprs.mul(entry(a, r * inner + k), entry(b, k * columns + c));
                    sum = self.instance.exprs.add(sum, term);
                }
                elements.push(ModelicaValue::Scalar(sum, ty));
            }
        }
        // The dimensions that were added to vectors are removed again.
        let dims: Vec<usize> = match (da.len(), db.len()) {
            (2, 2) => vec![rows, columns],
            (2, 1) => vec![rows],
            (1, 2) => vec![columns],
            _ => return elements.pop(),
        };
        Some(ModelicaValue::array(dims, elements))
    }

    /// `A ^ n` for a square matrix and a known whole number `n` from 0 to 100 (MLS 10.6).
    /// `None` after a message.
    /// An exponent of 0 gives the identity matrix.
    pub(in crate::instance) fn matrix_power(
        &mut self,
        a: &ModelicaValue,
        b: &ModelicaValue,
        span: Span,
    ) -> Option<ModelicaValue> {
        let n = b.as_number(&self.instance.exprs).filter(|n| *n >= 0.0 && n.fract() == 0.0 && *n <= 100.0);
        let (&[r, c], Some(n)) = (a.dims(), n) else { return self.sizes_differ(a, b, span) };
        if r != c {
            return self.sizes_differ(a, b, span);
        }
        let mut result = self.identity(r);
        // Repeated multiplication: exponents are small, and the expression pool shares equal products.
        for _ in 0..n as usize {
            result = self.product(&result, a, span)?;
        }
        Some(result)
    }

    /// The identity matrix of size `n` by `n`, with Integer entries.
    pub(in crate::instance) fn identity(&mut self, n: usize) -> ModelicaValue {
        let elements = (0..n * n).map(|i| if i % (n + 1) == 0 { Exprs::ONE } else { Exprs::ZERO });
        ModelicaValue::array(vec![n, n], elements.map(|e| ModelicaValue::Scalar(e, ScalarType::Integer)).collect())
    }

    /// Compares two scalars.
    ///
    /// In a model a relation between continuous Reals raises an event when it changes (MLS 8.5).
    /// It does not inside `noEvent`, in functions, or if both sides change at events only.
    /// `==` and `<>` between continuous Reals are refused outside of functions (MLS 3.5).
    ///
    /// `None` after a message, if the operands are no scalars of comparable types.
    /// The result is a Boolean expression.
    pub(in crate::instance) fn relation(
        &mut self,
        op: BinaryOp,
        a: &ModelicaValue,
        b: &ModelicaValue,
        span: Span,
    ) -> Option<ModelicaValue> {
        let (Some((x, tx)), Some((y, ty))) = (a.scalar(), b.scalar()) else {
            return self.sizes_differ(a, b, span);
        };
        if wider(tx, ty).is_none() {
            return self.sizes_differ(a, b, span);
        }
        let rel = match op {
            BinaryOp::Lt => RelationalOp::Lt,
            BinaryOp::Le => RelationalOp::Le,
            BinaryOp::Gt => RelationalOp::Gt,
            BinaryOp::Ge => RelationalOp::Ge,
            BinaryOp::Eq => RelationalOp::Eq,
            _ => RelationalOp::Ne,
        };
        let plain = self.instance.eval.mode.no_event
            || self.instance.eval.mode.procedure
            || self.instance.variability(x).max(self.instance.variability(y)) <= Variability::Discrete;
        if !plain && matches!(rel, RelationalOp::Eq | RelationalOp::Ne) {
            self.instance.report(
                Diagnostic::new(Code::TypeMismatch, "two Reals cannot be compared with `==` or `<>` in a model")
                    .at(span, "Reals that change continuously are never exactly equal")
                    .help("compare with `<` or `>`, or test `abs(a - b) < eps`"),
            );
            return None;
        }
        let e = if plain { self.instance.exprs.rel(rel, x, y) } else { self.instance.exprs.event_rel(rel, x, y) };
        Some(ModelicaValue::Scalar(e, ScalarType::Boolean))
    }
}

/// The scalar function behind an arithmetic operator. Every operator that is not listed is a product.
/// The caller has checked that the operator is arithmetic.
pub(in crate::instance) fn scalar_op(op: BinaryOp) -> BinaryFunction {
    match op {
        BinaryOp::Add | BinaryOp::ElementAdd => BinaryFunction::Add,
        BinaryOp::Sub | BinaryOp::ElementSub => BinaryFunction::Sub,
        BinaryOp::Div | BinaryOp::ElementDiv => BinaryFunction::Div,
        BinaryOp::Pow | BinaryOp::ElementPow => BinaryFunction::Pow,
        _ => BinaryFunction::Mul,
    }
}
