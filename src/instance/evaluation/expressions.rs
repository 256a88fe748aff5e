//! Expressions of the language to values: symbolic in the flat model, by number where a value must be known.

use crate::instance::deduce::Body;
use crate::instance::errors::short;
use crate::instance::modifiers::{Access, Binding};
use crate::instance::value::{Val, size_text, stack, wider};
use crate::instance::{Instance, View};
use crate::diag::{Code, Diagnostic, FileId, Span};
use crate::expr::{Binary, ExprId, Exprs, Rel};
use crate::types::{MessagePart, Type, Variability};
use crate::syntax::ast::{BinaryOp, Expr, ExprKind, Subscript, UnaryOp};
use crate::syntax::symbol::Symbol;
use rustc_hash::FxHashMap;
use std::rc::Rc;

/// The mutable surroundings of an evaluation.
#[derive(Default)]
pub struct State {
    /// Loop variables and the locals of functions, innermost last.
    pub locals: Vec<(Symbol, Val)>,
    /// First local of the function being evaluated.
    pub frame: usize,
    /// Parameters count by their values.
    pub constant: bool,
    /// Relations make no events.
    pub no_event: bool,
    /// Sizes that `end` means, and what counts along the dimension, innermost last.
    pub ends: Vec<(usize, Type)>,
    /// Depth of function calls.
    pub depth: usize,
    /// Set when a function cannot be written as an expression and must become a procedure.
    pub not_inline: bool,
    /// A procedure is being translated.
    pub procedure: bool,
    /// What a procedure calls is being written out.
    pub under_procedure: bool,
    /// An assertion fails where the run may not come: the function around it must become a procedure.
    pub may_fail: bool,
    /// Statements carried out, to end what never ends.
    pub work: Work,
    /// `when`s met in an algorithm section of the model.
    pub whens: Vec<crate::instance::algorithm::AlgorithmWhen>,
    /// `assert`s and `terminate`s met there since the section, or the branch of a `when`, began.
    pub calls: Vec<crate::instance::algorithm::AlgorithmCall>,
    /// Conditions of the `if`s around the present statement of such a section.
    pub guards: Vec<ExprId>,
    /// The procedure being translated.
    pub(in crate::instance) translation: crate::instance::procedure::Translation,
    /// The variables of the algorithm section being carried out, among the locals.
    pub section: std::ops::Range<usize>,
    /// Inside `pre`: variables of the section mean themselves, not what the section has made of them.
    pub before: bool,
    /// Assertions of the function being carried out are kept for the run.
    pub keep_asserts: bool,
    /// The text of values given from outside.
    pub override_file: Option<FileId>,
    /// These values as they were given, by the names of the variables.
    pub texts: FxHashMap<String, String>,
}

/// Statements carried out, against the most that are allowed.
#[derive(Clone, Copy, Debug, Default)]
pub struct Work {
    /// The present function is called with known values only.
    pub known: bool,
    /// By functions that are written out, and by those that are simply carried out.
    done: [usize; 2],
    most: [usize; 2],
}

impl Work {
    /// A fresh allowance for what is written out and what is carried out.
    pub fn allowed(most: [usize; 2]) -> Self {
        Work { known: false, done: [0; 2], most }
    }

    /// Counts a statement; false when there have been too many.
    pub fn step(&mut self) -> bool {
        let of = usize::from(self.known);
        self.done[of] += 1;
        self.done[of] <= self.most[of]
    }
}

/// How a value given from outside is written into the model: as Modelica, as a quantity with its unit, or as a text.
pub fn override_text(value: &str) -> String {
    let parsed = crate::syntax::parse_expression(FileId(0), value);
    if parsed.diagnostics.is_empty() {
        return value.to_string();
    }
    let trimmed = value.trim();
    let is_number = |i: &usize| trimmed.get(..*i).is_some_and(|t| t.trim_end().parse::<f64>().is_ok());
    let split = (1..=trimmed.len().min(60)).rev().find(is_number).unwrap_or(trimmed.len());
    let (number, unit) = trimmed.split_at(split);
    let number = number.trim_end();
    match number.parse::<f64>() {
        Ok(_) if !unit.trim().is_empty() => {
            format!("{QUANTITY}({number}, \"{}\")", unit.trim().replace(['\\', '"'], ""))
        }
        _ if is_text(trimmed) => format!("\"{}\"", trimmed.replace('\\', "\\\\")),
        _ => value.to_string(),
    }
}

/// The name of a file or the like: letters, digits and what stands in paths, no Modelica.
fn is_text(value: &str) -> bool {
    let path = |c: char| c.is_alphanumeric() || "._-/\\: ".contains(c);
    value.chars().all(path) && value.contains(char::is_alphabetic)
}

/// The name under which a number with a unit stands in the text of values given from outside.
pub const QUANTITY: &str = "'quantity'";

impl<'a> Instance<'a, '_> {
    /// Evaluates an expression; `None` after a message. A call with several outputs counts as its first (MLS 12.4.3).
    pub fn eval(&mut self, e: &'a Expr, view: View) -> Option<Val> {
        match self.eval_all(e, view)? {
            Val::Tuple(values) => match values.first() {
                Some(first) => Some(first.clone()),
                None => self.no_output(e),
            },
            value => Some(value),
        }
    }

    /// A call that gives nothing cannot be a value.
    fn no_output(&mut self, e: &'a Expr) -> Option<Val> {
        let name = match &e.kind {
            ExprKind::Call { function, .. } => {
                function.parts.iter().map(|p| p.name.name.as_str()).collect::<Vec<_>>().join(".")
            }
            _ => "this".to_owned(),
        };
        self.fail(Code::BadCall, &format!("`{name}` has no output"), e.span)
    }

    /// Evaluates an expression with all outputs of a call.
    pub fn eval_all(&mut self, e: &'a Expr, view: View) -> Option<Val> {
        match &e.kind {
            ExprKind::Integer(i) => Some(self.integer(*i as f64)),
            ExprKind::Real(x) => Some(Val::Scalar(self.exprs.num(*x), Type::Real)),
            ExprKind::Boolean(b) => Some(Val::Scalar(self.exprs.boolean(*b), Type::Boolean)),
            ExprKind::String(s) => Some(Val::text(&**s)),
            ExprKind::Reference(r) => self.reference(r, view),
            ExprKind::Unary(op, a) => {
                let value = self.eval(a, view)?;
                self.unary(*op, value, e.span)
            }
            ExprKind::Binary(op, a, b) => {
                let (x, y) = (self.eval(a, view), self.eval(b, view));
                self.binary(*op, x?, y?, e.span)
            }
            ExprKind::If { branches, otherwise } => self.if_expression(branches, otherwise, view, e.span),
            ExprKind::Range { .. } => self.range(e, view),
            ExprKind::Call { function, args, named } => self.call(function, args, named, view, e.span),
            ExprKind::Comprehension { function, body, iterators } => {
                self.comprehension(function.as_ref(), body, iterators, view, e.span)
            }
            ExprKind::Array(items) => {
                let values: Option<Vec<Val>> = items.iter().map(|i| self.eval(i, view)).collect();
                self.stacked(values?, e.span)
            }
            ExprKind::Matrix(rows) => self.matrix(rows, view, e.span),
            ExprKind::Tuple(items) => {
                let values: Option<Vec<Val>> =
                    items.iter().map(|i| i.as_ref().map_or(Some(Val::text("")), |i| self.eval(i, view))).collect();
                Some(Val::Tuple(Rc::new(values?)))
            }
            ExprKind::Index(inner, subscripts) => {
                let value = self.eval(inner, view)?;
                self.subscript(value, subscripts, view, e.span)
            }
            ExprKind::End => match self.eval.ends.last() {
                // of an enumeration its last literal, of truth values `true` (MLS 10.5)
                Some(&(_, Type::Boolean)) => Some(Val::Scalar(Exprs::ONE, Type::Boolean)),
                Some(&(n, by)) => Some(Val::Scalar(self.exprs.num(n as f64), by)),
                None => self.fail(Code::BadIndex, "`end` is only known inside brackets `[...]`", e.span),
            },
            ExprKind::PartialApplication { function, named } => self.partial_application(function, named, view),
            ExprKind::Error => None,
        }
    }

    /// Evaluates with parameters by value.
    pub fn constant(&mut self, e: &'a Expr, view: View) -> Option<Val> {
        let before = std::mem::replace(&mut self.eval.constant, true);
        let value = self.eval(e, view);
        self.eval.constant = before;
        value
    }

    /// A truth value that must be known.
    pub fn constant_boolean(&mut self, e: &'a Expr, view: View) -> Option<bool> {
        let value = self.constant(e, view)?;
        match (value.scalar(), value.as_number(&self.exprs)) {
            (Some((_, Type::Boolean)), Some(x)) => Some(x != 0.0),
            (Some((_, Type::Boolean)), None) => {
                self.fail(Code::NotConstant, "this condition must be known before the run", e.span)
            }
            _ => self.wrong_type("a Boolean", &value, e.span),
        }
    }

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
        match (value.scalar(), value.as_number(&self.exprs)) {
            (Some((_, Type::Integer)), Some(x)) if (0.0..1e9).contains(&x) => Some(x as usize),
            (Some((_, Type::Integer)), Some(x)) => {
                self.fail(Code::OutOfRange, &format!("an array cannot have {x} elements"), e.span)
            }
            (Some((_, Type::Integer)), None) => {
                self.fail(Code::NotConstant, "the size of an array must be known before the run", e.span)
            }
            _ => self.wrong_type("an Integer", &value, e.span),
        }
    }

    pub(in crate::instance) fn integer(&mut self, x: f64) -> Val {
        Val::Scalar(self.exprs.num(x), Type::Integer)
    }

    pub(in crate::instance) fn fail<T>(&mut self, code: Code, message: &str, span: Span) -> Option<T> {
        self.report(Diagnostic::new(code, message).at(span, ""));
        None
    }

    pub(in crate::instance) fn wrong_type<T>(&mut self, wanted: &str, got: &Val, span: Span) -> Option<T> {
        let message = format!("{wanted} is needed here, and this is {}", got.describe());
        self.fail(Code::TypeMismatch, &message, span)
    }

    /// The value of a binding, or the part of it that is meant for one element.
    pub fn binding_value(&mut self, b: &Binding<'a>, constant: bool) -> Option<Val> {
        if b.access.is_empty() {
            return self.isolated(b, constant);
        }
        let key = (std::ptr::from_ref(b.expr), b.view, constant);
        let whole = match self.array_values.get(&key) {
            Some(v) => v.clone(),
            None => {
                let v = self.isolated(b, constant)?;
                self.array_values.insert(key, v.clone());
                v
            }
        };
        self.access(whole, &b.access, b.expr.span)
    }

    fn isolated(&mut self, b: &Binding<'a>, constant: bool) -> Option<Val> {
        let frame = std::mem::replace(&mut self.eval.frame, self.eval.locals.len());
        let was_constant = std::mem::replace(&mut self.eval.constant, constant);
        let no_event = std::mem::replace(&mut self.eval.no_event, false);
        let ends = std::mem::take(&mut self.eval.ends);
        let value = self.eval(b.expr, b.view);
        self.eval.frame = frame;
        self.eval.constant = was_constant;
        self.eval.no_event = no_event;
        self.eval.ends = ends;
        value
    }

    fn access(&mut self, mut value: Val, access: &[Access], span: Span) -> Option<Val> {
        for step in access {
            let next = match step {
                Access::Index(at) if value.dims().first().is_some_and(|&n| n == at.of as usize) => {
                    value.slice(at.place as usize)
                }
                Access::Index(_) => None,
                Access::Field(name) => match &value {
                    Val::Record(record) => record.fields.iter().find(|(n, _)| n == name).map(|(_, v)| v.clone()),
                    _ => None,
                },
            };
            value = match (next, step) {
                (Some(v), _) => v,
                (None, Access::Index(at)) => {
                    self.wrong_count(at.of, &value, span);
                    return None;
                }
                (None, Access::Field(name)) => {
                    let message = format!("this has no field `{name}`: it is {}", value.describe());
                    return self.fail(Code::TypeMismatch, &message, span);
                }
            };
        }
        Some(value)
    }

    /// A value for an array of another size, reported once for all its elements.
    fn wrong_count(&mut self, wanted: u32, value: &Val, span: Span) {
        let message = format!("an array of {wanted} elements is needed here, and this is {}", value.describe());
        if self.diagnostics.iter().any(|d| d.message == message && d.labels.first().is_some_and(|l| l.span == span)) {
            return;
        }
        self.report(
            Diagnostic::new(Code::SizeMismatch, message)
                .at(span, "the value for an array")
                .help("give one value for each element, or write `each` to give all of them the same"),
        );
    }

    pub(in crate::instance) fn stacked(&mut self, values: Vec<Val>, span: Span) -> Option<Val> {
        let shapes: Vec<String> = values.iter().map(Val::describe).collect();
        match stack(values) {
            Some(v) => Some(v),
            None => {
                let message = format!("the elements of an array differ in size: {}", shapes.join(", "));
                self.fail(Code::SizeMismatch, &message, span)
            }
        }
    }

    fn matrix(&mut self, rows: &'a [Vec<Expr>], view: View, span: Span) -> Option<Val> {
        let mut lines = Vec::new();
        for row in rows {
            let values: Option<Vec<Val>> = row.iter().map(|e| self.eval(e, view)).collect();
            let values = values?.into_iter().map(as_matrix).collect();
            lines.push(self.concatenate(2, values, span)?);
        }
        self.concatenate(1, lines, span)
    }

    /// `cat(k, ...)`
    pub(in crate::instance) fn concatenate(&mut self, along: usize, values: Vec<Val>, span: Span) -> Option<Val> {
        let Some(first) = values.first() else { return Some(Val::array(vec![0], Vec::new())) };
        let mut dims = first.dims().to_vec();
        if along == 0 || along > dims.len() {
            return self.fail(Code::SizeMismatch, &format!("there is no dimension {along} to join along"), span);
        }
        let k = along - 1;
        for v in &values[1..] {
            let fits = v.dims().len() == dims.len() && (0..dims.len()).all(|i| i == k || v.dims()[i] == dims[i]);
            if !fits {
                let message = format!("sizes {} and {} cannot be joined", size_text(&dims), size_text(v.dims()));
                return self.fail(Code::SizeMismatch, &message, span);
            }
        }
        dims[k] = values.iter().map(|v| v.dims()[k]).sum();
        let outer: usize = dims[..k].iter().product();
        let mut elements = Vec::with_capacity(dims.iter().product());
        for o in 0..outer {
            for v in &values {
                let chunk = v.elements().len() / outer.max(1);
                elements.extend_from_slice(&v.elements()[o * chunk..(o + 1) * chunk]);
            }
        }
        Some(Val::array(dims, elements))
    }

    fn unary(&mut self, op: UnaryOp, value: Val, span: Span) -> Option<Val> {
        if let Some(result) = self.overloaded_unary(op, &value, span) {
            return result;
        }
        let ty = value.element_type();
        match op {
            UnaryOp::Not => match ty {
                Some(Type::Boolean) => Some(value.map(&mut |e, _| self.exprs.not(e))),
                _ => self.wrong_type("a Boolean", &value, span),
            },
            UnaryOp::Plus | UnaryOp::ElementPlus => Some(value),
            UnaryOp::Minus | UnaryOp::ElementMinus => match ty {
                Some(Type::Real | Type::Integer) => Some(value.map(&mut |e, _| self.exprs.neg(e))),
                None if value.elements().is_empty() => Some(value),
                _ => self.wrong_type("a number", &value, span),
            },
        }
    }

    pub(in crate::instance) fn binary(&mut self, op: BinaryOp, a: Val, b: Val, span: Span) -> Option<Val> {
        use BinaryOp as B;
        if let Some(result) = self.overloaded_binary(op, &a, &b, span) {
            return result;
        }
        if let (Val::Text(x), Val::Text(y)) = (&a, &b) {
            return self.texts(op, x, y, span);
        }
        match op {
            B::Add | B::Sub | B::ElementAdd | B::ElementSub => self.elementwise(op, &a, &b, span),
            B::Mul => self.product(&a, &b, span),
            B::Div if b.dims().is_empty() => self.broadcast(op, &a, &b, span),
            B::Pow if !a.dims().is_empty() => self.matrix_power(&a, &b, span),
            // arrays are divided and raised element by element with `./` and `.^` only (MLS 10.6)
            B::Div => self.wrong_type("a single number as divisor", &b, span),
            B::Pow if !b.dims().is_empty() => self.wrong_type("a single number as exponent", &b, span),
            B::Pow | B::ElementMul | B::ElementDiv | B::ElementPow => self.broadcast(op, &a, &b, span),
            B::Lt | B::Le | B::Gt | B::Ge | B::Eq | B::Ne => self.relation(op, &a, &b, span),
            B::And | B::Or => {
                let (ta, tb) = (a.element_type(), b.element_type());
                if ta != Some(Type::Boolean) {
                    return self.wrong_type("a Boolean", &a, span);
                }
                if tb != Some(Type::Boolean) {
                    return self.wrong_type("a Boolean", &b, span);
                }
                let and = op == B::And;
                let zipped = a.zip(&b, &mut |x, y, _| if and { self.exprs.and(x, y) } else { self.exprs.or(x, y) });
                zipped.or_else(|| self.sizes_differ(&a, &b, span))
            }
        }
    }

    fn texts(&mut self, op: BinaryOp, x: &Rc<Vec<MessagePart>>, y: &Rc<Vec<MessagePart>>, span: Span) -> Option<Val> {
        if op == BinaryOp::Add {
            return Some(Val::Text(Rc::new(x.iter().chain(y.iter()).cloned().collect())));
        }
        let words = |p: &Rc<Vec<MessagePart>>| Val::Text(p.clone()).as_text(&self.exprs);
        let (Some(x), Some(y)) = (words(x), words(y)) else {
            return self.fail(Code::NotConstant, "this text must be known before the run", span);
        };
        let truth = match op {
            BinaryOp::Eq => x == y,
            BinaryOp::Ne => x != y,
            BinaryOp::Lt => x < y,
            BinaryOp::Le => x <= y,
            BinaryOp::Gt => x > y,
            BinaryOp::Ge => x >= y,
            _ => return self.fail(Code::TypeMismatch, "texts can only be joined with `+` or compared", span),
        };
        Some(Val::Scalar(self.exprs.boolean(truth), Type::Boolean))
    }

    pub(in crate::instance) fn sizes_differ<T>(&mut self, a: &Val, b: &Val, span: Span) -> Option<T> {
        let message = format!("the two sides do not fit: {} and {}", a.describe(), b.describe());
        let code = if a.dims() == b.dims() { Code::TypeMismatch } else { Code::SizeMismatch };
        self.fail(code, &message, span)
    }

    fn numeric(&mut self, v: &Val, span: Span) -> Option<()> {
        match v.element_type() {
            Some(Type::Real | Type::Integer) => Some(()),
            None if v.elements().is_empty() => Some(()),
            _ => self.wrong_type("a number", v, span),
        }
    }

    fn elementwise(&mut self, op: BinaryOp, a: &Val, b: &Val, span: Span) -> Option<Val> {
        self.numeric(a, span)?;
        self.numeric(b, span)?;
        if matches!(op, BinaryOp::ElementAdd | BinaryOp::ElementSub) && a.dims() != b.dims() {
            return self.broadcast(op, a, b, span);
        }
        let op = scalar_op(op);
        let zipped = a.zip(b, &mut |x, y, _| self.exprs.binary(op, x, y));
        zipped.or_else(|| self.sizes_differ(a, b, span))
    }

    /// Scalar with array or equal shapes, element by element.
    fn broadcast(&mut self, op: BinaryOp, a: &Val, b: &Val, span: Span) -> Option<Val> {
        self.numeric(a, span)?;
        self.numeric(b, span)?;
        let code = scalar_op(op);
        let real = matches!(code, Binary::Div | Binary::Pow);
        let result = match (a.scalar(), b.scalar()) {
            (Some((x, tx)), _) if !b.dims().is_empty() => {
                b.map(&mut |y, _| self.exprs.binary(code, x, y)).with_type(tx)
            }
            (_, Some((y, ty))) if !a.dims().is_empty() => {
                a.map(&mut |x, _| self.exprs.binary(code, x, y)).with_type(ty)
            }
            _ => match a.zip(b, &mut |x, y, _| self.exprs.binary(code, x, y)) {
                Some(v) => v,
                None => return self.sizes_differ(a, b, span),
            },
        };
        Some(if real { result.with_type(Type::Real) } else { result })
    }

    fn product(&mut self, a: &Val, b: &Val, span: Span) -> Option<Val> {
        if a.dims().is_empty() || b.dims().is_empty() {
            return self.broadcast(BinaryOp::ElementMul, a, b, span);
        }
        self.numeric(a, span)?;
        self.numeric(b, span)?;
        let ty =
            wider(a.element_type().unwrap_or(Type::Real), b.element_type().unwrap_or(Type::Real)).unwrap_or(Type::Real);
        let (da, db) = (a.dims().to_vec(), b.dims().to_vec());
        if da[da.len() - 1] != db[0] || da.len() > 2 || db.len() > 2 {
            return self.sizes_differ(a, b, span);
        }
        let (rows, inner) = if da.len() == 2 { (da[0], da[1]) } else { (1, da[0]) };
        let columns = if db.len() == 2 { db[1] } else { 1 };
        let entry = |v: &Val, i: usize| v.elements()[i].scalar().map_or(Exprs::ZERO, |(e, _)| e);
        let mut elements = Vec::with_capacity(rows * columns);
        for r in 0..rows {
            for c in 0..columns {
                let mut sum = Exprs::ZERO;
                for k in 0..inner {
                    let term = self.exprs.mul(entry(a, r * inner + k), entry(b, k * columns + c));
                    sum = self.exprs.add(sum, term);
                }
                elements.push(Val::Scalar(sum, ty));
            }
        }
        let dims: Vec<usize> = match (da.len(), db.len()) {
            (2, 2) => vec![rows, columns],
            (2, 1) => vec![rows],
            (1, 2) => vec![columns],
            _ => return elements.pop(),
        };
        Some(Val::array(dims, elements))
    }

    fn matrix_power(&mut self, a: &Val, b: &Val, span: Span) -> Option<Val> {
        let n = b.as_number(&self.exprs).filter(|n| *n >= 0.0 && n.fract() == 0.0 && *n <= 100.0);
        let (&[r, c], Some(n)) = (a.dims(), n) else { return self.sizes_differ(a, b, span) };
        if r != c {
            return self.sizes_differ(a, b, span);
        }
        let mut result = self.identity(r);
        for _ in 0..n as usize {
            result = self.product(&result, a, span)?;
        }
        Some(result)
    }

    pub(in crate::instance) fn identity(&mut self, n: usize) -> Val {
        let elements = (0..n * n).map(|i| if i % (n + 1) == 0 { Exprs::ONE } else { Exprs::ZERO });
        Val::array(vec![n, n], elements.map(|e| Val::Scalar(e, Type::Integer)).collect())
    }

    fn relation(&mut self, op: BinaryOp, a: &Val, b: &Val, span: Span) -> Option<Val> {
        let (Some((x, tx)), Some((y, ty))) = (a.scalar(), b.scalar()) else {
            return self.sizes_differ(a, b, span);
        };
        if wider(tx, ty).is_none() {
            return self.sizes_differ(a, b, span);
        }
        let rel = match op {
            BinaryOp::Lt => Rel::Lt,
            BinaryOp::Le => Rel::Le,
            BinaryOp::Gt => Rel::Gt,
            BinaryOp::Ge => Rel::Ge,
            BinaryOp::Eq => Rel::Eq,
            _ => Rel::Ne,
        };
        let plain = self.eval.no_event
            || self.eval.procedure
            || self.variability(x).max(self.variability(y)) <= Variability::Discrete;
        if !plain && matches!(rel, Rel::Eq | Rel::Ne) {
            self.report(
                Diagnostic::new(Code::TypeMismatch, "two Reals cannot be compared with `==` or `<>` in a model")
                    .at(span, "Reals that change continuously are never exactly equal")
                    .help("compare with `<` or `>`, or test `abs(a - b) < eps`"),
            );
            return None;
        }
        let e = if plain { self.exprs.rel(rel, x, y) } else { self.exprs.event_rel(rel, x, y) };
        Some(Val::Scalar(e, Type::Boolean))
    }

    fn if_expression(
        &mut self,
        branches: &'a [(Expr, Expr)],
        otherwise: &'a Expr,
        view: View,
        span: Span,
    ) -> Option<Val> {
        let Some(((condition, value), rest)) = branches.split_first() else { return self.eval(otherwise, view) };
        let c = self.eval(condition, view)?;
        let Some((test, Type::Boolean)) = c.scalar() else {
            return self.wrong_type("a Boolean", &c, condition.span);
        };
        if let Some(known) = self.exprs.as_num(test) {
            return if known == 0.0 { self.if_expression(rest, otherwise, view, span) } else { self.eval(value, view) };
        }
        let mark = (self.diagnostics.len(), self.eval.calls.len());
        let not = self.exprs.not(test);
        let a = self.guarded(test, |s| s.eval(value, view));
        let b = self.guarded(not, |s| s.if_expression(rest, otherwise, view, span));
        let by_parameter =
            self.variability(test) <= Variability::Parameter && !self.eval.procedure && self.eval.frame == 0;
        // what is a state must be known before the run
        if by_parameter
            && let (Some(a), Some(b)) = (&a, &b)
            && self.derivatives_differ(a, b)
            && !self.found_at_start(test)
        {
            self.eval.calls.truncate(mark.1);
            return match self.constant_boolean(condition, view)? {
                true => self.eval(value, view),
                false => self.if_expression(rest, otherwise, view, span),
            };
        }
        let merged = match (&a, &b) {
            (Some(a), Some(b)) => a.zip(b, &mut |x, y, _| self.exprs.if_(test, x, y)),
            _ => None,
        };
        if merged.is_some() {
            return merged;
        }
        // A branch that has no meaning here (an absent component, another size) is allowed when a parameter decides.
        if by_parameter {
            self.diagnostics.truncate(mark.0);
            self.eval.calls.truncate(mark.1);
            return match self.constant_boolean(condition, view)? {
                true => self.eval(value, view),
                false => self.if_expression(rest, otherwise, view, span),
            };
        }
        let (a, b) = (a?, b?);
        if let (Val::Text(_), Val::Text(_)) = (&a, &b) {
            return self.fail(Code::NotConstant, "this text must be known before the run", span);
        }
        self.sizes_differ(&a, &b, span)
    }

    /// Whether one of two values has derivatives that the other one has not.
    fn derivatives_differ(&self, a: &Val, b: &Val) -> bool {
        let of = |v: &Val| {
            let mut scalars = Vec::new();
            v.scalars(&mut scalars);
            let mut found: Vec<_> = scalars.into_iter().flat_map(|e| self.exprs.derivatives(e)).collect();
            found.sort_unstable();
            found.dedup();
            found
        };
        of(a) != of(b)
    }

    fn range(&mut self, e: &'a Expr, view: View) -> Option<Val> {
        let ExprKind::Range { from, step, to } = &e.kind else { return None };
        let from = self.known_number(from, view)?;
        let to = self.known_number(to, view)?;
        let step = match step {
            Some(s) => self.known_number(s, view)?,
            None => (1.0, Type::Integer),
        };
        if step.0 == 0.0 {
            return self.fail(Code::OutOfRange, "the step of a range is 0", e.span);
        }
        let ty = [from.1, step.1, to.1].into_iter().find(|t| *t != Type::Integer).unwrap_or(Type::Integer);
        // A tiny allowance keeps 0:0.1:1 at eleven elements.
        let count = ((to.0 - from.0) / step.0 + 1e-10).floor() + 1.0;
        if count > 1e7 {
            return self.fail(Code::TooLarge, "this range has more than ten million elements", e.span);
        }
        let count = count.max(0.0) as usize;
        let values = (0..count).map(|i| Val::Scalar(self.exprs.num(from.0 + step.0 * i as f64), ty)).collect();
        Some(Val::array(vec![count], values))
    }

    /// A number that must be known, with its type; in functions it may depend on inputs that are known.
    pub(in crate::instance) fn known_number(&mut self, e: &'a Expr, view: View) -> Option<(f64, Type)> {
        let value =
            if self.eval.procedure || self.eval.frame > 0 { self.eval(e, view) } else { self.constant(e, view) };
        let value = value?;
        let Some((id, ty)) = value.scalar() else { return self.wrong_type("a number", &value, e.span) };
        match self.exprs.as_num(id) {
            Some(x) => Some((x, ty)),
            None => {
                if self.eval.frame > 0 || self.eval.procedure {
                    self.eval.not_inline = true;
                    return None;
                }
                self.fail(Code::NotConstant, "this must be known before the run", e.span)
            }
        }
    }

    fn truth_values(&mut self) -> Vec<Val> {
        [false, true].map(|b| Val::Scalar(self.exprs.boolean(b), Type::Boolean)).into()
    }

    /// The literals when a range is an enumeration type or `Boolean`.
    pub(in crate::instance) fn enumeration_range(&mut self, e: &'a Expr, view: View) -> Option<Vec<Val>> {
        use crate::instance::lookup::{Builtin, Found};
        let ExprKind::Reference(r) = &e.kind else { return None };
        if r.parts.iter().any(|p| !p.subscripts.is_empty()) {
            return None;
        }
        if r.parts.len() == 1 && self.local(r.parts[0].name.name).is_some() {
            return None;
        }
        let path = crate::syntax::ast::Path {
            global: r.global,
            parts: r.parts.iter().map(|p| p.name).collect(),
            span: r.span,
        };
        let builtin = match self.lookup_path(view, &path).ok()? {
            Found::Builtin(b) => b,
            Found::Class(c) => self.template(c.class, c.parent).builtin?,
            Found::Component(..) => return None,
        };
        match builtin {
            Builtin::Boolean => Some(self.truth_values()),
            Builtin::Enumeration(i) => {
                let n = self.enumerations[i as usize].literals.len();
                Some((1..=n).map(|k| Val::Scalar(self.exprs.num(k as f64), Type::Enumeration(i))).collect())
            }
            _ => None,
        }
    }

    /// The values a loop variable takes.
    pub(in crate::instance) fn iterate(
        &mut self,
        iterator: &'a crate::syntax::ast::Iterator,
        body: Body<'a>,
        view: View,
    ) -> Option<Vec<Val>> {
        let Some(range) = &iterator.range else { return self.deduced_range(iterator, body, view) };
        if let Some(values) = self.enumeration_range(range, view) {
            return Some(values);
        }
        let inside = self.eval.frame > 0 || self.eval.procedure;
        let mut value = match &range.kind {
            ExprKind::Range { .. } if !inside => self.constant(range, view)?,
            _ => self.eval(range, view)?,
        };
        // Indices and counts must be known; other elements may change during the run.
        let mut scalars = Vec::new();
        value.scalars(&mut scalars);
        let fixed = scalars.iter().all(|e| self.variability(*e) <= Variability::Parameter);
        if !inside && fixed && !matches!(value.element_type(), Some(Type::Real) | None) {
            value = self.constant(range, view)?;
        }
        match &value {
            Val::Array { dims, .. } if dims.len() == 1 => (0..dims[0]).map(|i| value.slice(i)).collect(),
            _ => self.wrong_type("a range or vector", &value, range.span),
        }
    }

    fn deduced_range(
        &mut self,
        iterator: &'a crate::syntax::ast::Iterator,
        body: Body<'a>,
        view: View,
    ) -> Option<Vec<Val>> {
        let name = iterator.name.name;
        match self.deduced_extent(name, body, view) {
            Some(Extent { by: Type::Boolean, .. }) => Some(self.truth_values()),
            Some(Extent { size, by }) => Some((1..=size).map(|i| Val::Scalar(self.exprs.num(i as f64), by)).collect()),
            None => {
                self.report(
                    Diagnostic::new(Code::BadIndex, format!("how often the loop over `{name}` runs is not said"))
                        .at(iterator.name.span, "no range, and no array that this alone indexes")
                        .help(format!("write `for {name} in 1:n`")),
                );
                None
            }
        }
    }

    fn comprehension(
        &mut self,
        function: Option<&'a crate::syntax::ast::Reference>,
        body: &'a Expr,
        iterators: &'a [crate::syntax::ast::Iterator],
        view: View,
        span: Span,
    ) -> Option<Val> {
        match function {
            None => self.array_comprehension(body, iterators, view, span),
            Some(f) => {
                let mut values = Vec::new();
                self.each_element(body, iterators, view, &mut values)?;
                self.reduction(f, values, span)
            }
        }
    }

    /// `{e for i in A, j in B}`: the last iterator varies slowest and gives the first dimension (MLS 10.4.1).
    fn array_comprehension(
        &mut self,
        body: &'a Expr,
        iterators: &'a [crate::syntax::ast::Iterator],
        view: View,
        span: Span,
    ) -> Option<Val> {
        let Some((last, rest)) = iterators.split_last() else { return self.eval(body, view) };
        let mut items = Vec::new();
        for value in self.iterate(last, Body::Expr(body), view)? {
            self.eval.locals.push((last.name.name, value));
            let item = self.array_comprehension(body, rest, view, span);
            self.eval.locals.pop();
            items.push(item?);
        }
        if items.is_empty() {
            return Some(Val::array(vec![0; iterators.len()], Vec::new()));
        }
        self.stacked(items, span)
    }

    fn each_element(
        &mut self,
        body: &'a Expr,
        iterators: &'a [crate::syntax::ast::Iterator],
        view: View,
        out: &mut Vec<Val>,
    ) -> Option<()> {
        let Some((first, rest)) = iterators.split_first() else {
            out.push(self.eval(body, view)?);
            return Some(());
        };
        for value in self.iterate(first, Body::Expr(body), view)? {
            self.eval.locals.push((first.name.name, value));
            let done = self.each_element(body, rest, view, out);
            self.eval.locals.pop();
            done?;
        }
        Some(())
    }

    /// Applies subscripts to a value.
    pub(in crate::instance) fn subscript(&mut self, value: Val, subscripts: &'a [Subscript], view: View, span: Span) -> Option<Val> {
        self.subscript_by(value, subscripts, &[], view, span)
    }

    /// Applies subscripts to the value of an array of which is known what counts along its dimensions.
    pub(in crate::instance) fn subscript_by(
        &mut self,
        value: Val,
        subscripts: &'a [Subscript],
        by: &[Type],
        view: View,
        span: Span,
    ) -> Option<Val> {
        if subscripts.is_empty() {
            return Some(value);
        }
        let Val::Array { dims, elements } = &value else {
            return self.fail(Code::BadIndex, &format!("{} cannot be indexed", value.describe()), span);
        };
        if subscripts.len() > dims.len() {
            let message = format!("{} indices for {}", subscripts.len(), value.describe());
            return self.fail(Code::BadIndex, &message, span);
        }
        let mut picks = Vec::new();
        for (i, s) in subscripts.iter().enumerate() {
            picks.push(self.index(s, (dims[i], by.get(i).copied()), view, span)?);
        }
        picks.extend(dims[subscripts.len()..].iter().map(|&n| Pick::Many((0..n).collect())));
        if picks.iter().any(|p| matches!(p, Pick::Symbolic(_))) {
            return self.dynamic(dims, elements, &picks, span);
        }
        Some(pick(dims, elements, &picks))
    }

    /// One subscript: a known place, several, or one only known at run time. What counts along the dimension is not
    /// known of an array that was computed.
    pub(in crate::instance) fn index(
        &mut self,
        s: &'a Subscript,
        (size, by): (usize, Option<Type>),
        view: View,
        span: Span,
    ) -> Option<Pick> {
        let Subscript::Expr(e) = s else { return Some(Pick::Many((0..size).collect())) };
        if let Some(all) = self.enumeration_range(e, view) {
            self.check_index(all.first().and_then(Val::element_type), by, e.span)?;
            return Some(Pick::Many((0..all.len()).collect()));
        }
        self.eval.ends.push((size, by.unwrap_or(Type::Integer)));
        let value = self.eval(e, view);
        self.eval.ends.pop();
        let value = value?;
        self.check_index(value.element_type(), by, e.span)?;
        match &value {
            Val::Scalar(id, Type::Boolean) if size == 2 => Some(self.boolean_index(*id)),
            Val::Scalar(id, ty @ (Type::Integer | Type::Enumeration(_))) => match self.exprs.as_num(*id) {
                Some(x) => Some(Pick::One(self.in_range(x, size, e.span)?)),
                None => {
                    let outside = self.eval.frame == 0 && !self.eval.procedure;
                    if outside && self.variability(*id) <= Variability::Parameter && !self.found_at_start(*id) {
                        let known = self.constant(e, view)?.as_number(&self.exprs);
                        if let Some(x) = known {
                            return Some(Pick::One(self.in_range(x, size, e.span)?));
                        }
                    }
                    if *ty == Type::Integer && !self.eval.procedure {
                        self.watch_index(*id, size, e.span);
                    }
                    Some(Pick::Symbolic(*id))
                }
            },
            Val::Array { elements, .. } => {
                let mut places = Vec::new();
                for v in elements.iter() {
                    let Some(x) = v.as_number(&self.exprs) else {
                        return self.fail(Code::NotConstant, "an index must be known before the run", span);
                    };
                    let first = if v.element_type() == Some(Type::Boolean) { 0.0 } else { 1.0 };
                    places.push(self.in_range(x - first + 1.0, size, e.span)?);
                }
                Some(Pick::Many(places))
            }
            _ => self.wrong_type("an Integer", &value, e.span),
        }
    }

    /// An array is indexed by what its declaration counts by (MLS 10.5): literals of an enumeration and numbers do not
    /// stand for each other.
    fn check_index(&mut self, given: Option<Type>, by: Option<Type>, span: Span) -> Option<()> {
        let (Some(given), Some(by)) = (given, by) else { return Some(()) };
        if given == by {
            return Some(());
        }
        let (wanted, words) = (self.type_words(by), self.type_words(given));
        let help = match (by, given) {
            (Type::Enumeration(e), _) => {
                let e = &self.enumerations[e as usize];
                let name = short(&e.name);
                let first = e.literals.first().map_or("", |l| l.as_str());
                format!("give a literal, as in `[{name}.{first}]`, or loop with `for i in {name} loop`")
            }
            (Type::Boolean, _) => "give `false` or `true`, or a relation".into(),
            (_, Type::Enumeration(_)) => "`Integer(e)` is the number of an enumeration value".into(),
            _ => "give a whole number; `integer(x)` is the one below `x`".into(),
        };
        let message = format!("this dimension counts by {wanted}, and the index is {words}");
        self.report(Diagnostic::new(Code::TypeMismatch, message).at(span, "the index").help(help));
        None
    }

    /// `false` and `true` as indices of an array declared with `[Boolean]`.
    fn boolean_index(&mut self, e: ExprId) -> Pick {
        match self.exprs.as_num(e) {
            Some(x) => Pick::One(usize::from(x != 0.0)),
            None => {
                let two = self.exprs.num(2.0);
                Pick::Symbolic(self.exprs.if_(e, two, Exprs::ONE))
            }
        }
    }

    /// An index that changes must stay inside the array during the run, wherever it is used.
    fn watch_index(&mut self, index: ExprId, size: usize, span: Span) {
        let last = self.exprs.num(size as f64);
        let (low, high) = (self.exprs.rel(Rel::Ge, index, Exprs::ONE), self.exprs.rel(Rel::Le, index, last));
        let condition = self.exprs.and(low, high);
        let parts = vec![
            MessagePart::Text("the index ".into()),
            MessagePart::Value(index, Type::Integer),
            MessagePart::Text(format!(" lies outside 1..{size}")),
        ];
        self.keep_call(Some(condition), Some(Val::Text(Rc::new(parts))), false, span);
    }

    fn in_range(&mut self, x: f64, size: usize, span: Span) -> Option<usize> {
        if x >= 1.0 && x <= size as f64 && x.fract() == 0.0 {
            return Some(x as usize - 1);
        }
        self.fail(Code::BadIndex, &format!("index {x} lies outside 1..{size}"), span)
    }

    /// An element chosen at run time: a chain of `if`, or an indexed slot in a procedure.
    fn dynamic(&mut self, dims: &[usize], elements: &Rc<Vec<Val>>, picks: &[Pick], span: Span) -> Option<Val> {
        if self.eval.frame > 0 && !self.eval.procedure && elements.len() > 12 {
            self.eval.not_inline = true;
            return None;
        }
        if self.eval.procedure
            && let Some(v) = self.indexed_slot(dims, elements, picks)
        {
            return Some(v);
        }
        let at = picks.iter().position(|p| matches!(p, Pick::Symbolic(_)))?;
        let Pick::Symbolic(index) = picks[at] else { return None };
        let mut result: Option<Val> = None;
        for k in (0..dims[at]).rev() {
            let mut fixed = picks.to_vec();
            fixed[at] = Pick::One(k);
            let value = if fixed.iter().any(|p| matches!(p, Pick::Symbolic(_))) {
                self.dynamic(dims, elements, &fixed, span)?
            } else {
                pick(dims, elements, &fixed)
            };
            result = Some(match result {
                None => value,
                Some(rest) => {
                    let number = self.exprs.num(k as f64 + 1.0);
                    let plain = self.exprs.rel(Rel::Le, index, number);
                    value.zip(&rest, &mut |x, y, _| self.exprs.if_(plain, x, y))?
                }
            });
        }
        result.or_else(|| self.fail(Code::BadIndex, "an index into an empty array", span))
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

/// A subscript after evaluation.
#[derive(Clone, Debug)]
pub enum Pick {
    /// One place, from 0.
    One(usize),
    /// Several places; the dimension stays.
    Many(Vec<usize>),
    /// A place known at run time only.
    Symbolic(ExprId),
}

/// Picks elements by known places.
pub(in crate::instance) fn pick(dims: &[usize], elements: &[Val], picks: &[Pick]) -> Val {
    let (kept, places) = places(dims, picks);
    if kept.is_empty() {
        return elements[places[0]].clone();
    }
    Val::array(kept, places.into_iter().map(|i| elements[i].clone()).collect())
}

/// The row-major places of what is picked, and the sizes that stay.
pub(in crate::instance) fn places(dims: &[usize], picks: &[Pick]) -> (Vec<usize>, Vec<usize>) {
    let mut places = vec![0usize];
    let mut kept = Vec::new();
    for (p, &d) in picks.iter().zip(dims) {
        let choices: &[usize] = match p {
            Pick::One(i) => std::slice::from_ref(i),
            Pick::Many(many) => {
                kept.push(many.len());
                many
            }
            Pick::Symbolic(_) => &[],
        };
        places = places.iter().flat_map(|&base| choices.iter().map(move |&c| base * d + c)).collect();
    }
    (kept, places)
}

/// A scalar or vector as a matrix, for `[a, b; c, d]`: vectors are columns.
fn as_matrix(v: Val) -> Val {
    let mut dims = v.dims().to_vec();
    while dims.len() < 2 {
        dims.push(1);
    }
    let elements = v.elements().to_vec();
    Val::array(dims, elements)
}

fn scalar_op(op: BinaryOp) -> Binary {
    match op {
        BinaryOp::Add | BinaryOp::ElementAdd => Binary::Add,
        BinaryOp::Sub | BinaryOp::ElementSub => Binary::Sub,
        BinaryOp::Div | BinaryOp::ElementDiv => Binary::Div,
        BinaryOp::Pow | BinaryOp::ElementPow => Binary::Pow,
        _ => Binary::Mul,
    }
}

impl Val {
    /// Numbers of the wider of their own and the given type.
    pub(in crate::instance) fn with_type(&self, ty: Type) -> Val {
        match self {
            Val::Scalar(e, own) => Val::Scalar(*e, wider(*own, ty).unwrap_or(*own)),
            Val::Array { dims, elements } => {
                Val::array(dims.clone(), elements.iter().map(|v| v.with_type(ty)).collect())
            }
            other => other.clone(),
        }
    }
}
