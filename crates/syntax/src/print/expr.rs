//! Text of names and expressions, with brackets only where they are needed.

use super::SyntaxPrinter;
use crate::ast::{
    BinaryOp, ComponentReference, Expr, ExprKind, ForIndex, Ident, Path, ReferencePart, Subscript, UnaryOp,
};
use std::fmt::Write;

// Precedences, as in the parser, with ranges and operands at the two ends.
const ANY: u8 = 0;
const RANGE: u8 = 1;
const OR: u8 = 2;
const AND: u8 = 3;
const NOT: u8 = 4;
const RELATION: u8 = 5;
const SUM: u8 = 6;
const PRODUCT: u8 = 7;
const POWER: u8 = 8;
const OPERAND: u8 = 9;

/// The text of names and expressions.
impl SyntaxPrinter {
    /// A dotted name.
    pub(super) fn path(&mut self, path: &Path) {
        if path.global {
            self.word(".");
        }
        self.separated(&path.parts, ".", |p, part| p.ident(part));
    }

    /// An identifier, with its single quotes if it has them.
    pub(super) fn ident(&mut self, ident: &Ident) {
        self.word(ident.name.as_str());
    }

    /// A component reference.
    pub(super) fn reference(&mut self, reference: &ComponentReference) {
        if reference.global {
            self.word(".");
        }
        self.separated(&reference.parts, ".", Self::reference_part);
    }

    /// A name with its subscripts.
    fn reference_part(&mut self, part: &ReferencePart) {
        self.ident(&part.name);
        self.subscripts(&part.subscripts);
    }

    /// `[i, :]`, nothing without subscripts.
    pub(super) fn subscripts(&mut self, subscripts: &[Subscript]) {
        if subscripts.is_empty() {
            return;
        }
        self.word("[");
        self.separated(subscripts, ", ", |p, subscript| match subscript {
            Subscript::All(_) => p.word(":"),
            Subscript::Expr(expr) => p.expression(expr),
        });
        self.word("]");
    }

    /// An expression of any kind, without brackets around it.
    pub(super) fn expression(&mut self, expr: &Expr) {
        self.operand(expr, ANY);
    }

    /// An expression that may not begin with `if`, as on the left of an equation; such a one is put in brackets.
    pub(super) fn simple_expression(&mut self, expr: &Expr) {
        self.operand(expr, RANGE);
    }

    /// An operand, in brackets if it binds more weakly than `least` requires at this place.
    /// `least` is the precedence that the surrounding operator requires.
    fn operand(&mut self, expr: &Expr, least: u8) {
        if strength(&expr.kind) < least {
            self.word("(");
            self.bare(&expr.kind);
            self.word(")");
        } else {
            self.bare(&expr.kind);
        }
    }

    /// The text of an expression, without brackets around it.
    /// Operands inside get brackets where their precedence requires it.
    fn bare(&mut self, kind: &ExprKind) {
        match kind {
            ExprKind::Integer(value) => self.number(value),
            ExprKind::Real(value) => self.number(value),
            ExprKind::String(value) => self.string(value),
            ExprKind::Boolean(value) => self.word(if *value { "true" } else { "false" }),
            ExprKind::Reference(reference) => self.reference(reference),
            ExprKind::Unary(op, operand) => self.unary(*op, operand),
            ExprKind::Binary(op, left, right) => self.binary(*op, left, right),
            ExprKind::If { branches, otherwise } => self.if_expression(branches, otherwise),
            ExprKind::Range { from, step, to } => self.range(from, step.as_deref(), to),
            ExprKind::Call { function, args, named } => {
                self.reference(function);
                self.arguments(args, named);
            }
            ExprKind::Comprehension { function, body, iterators } => {
                self.comprehension(function.as_ref(), body, iterators);
            }
            ExprKind::PartialApplication { function, named } => {
                self.word("function ");
                self.path(function);
                self.arguments(&[], named);
            }
            ExprKind::Array(items) => self.between("{", "}", |p| p.separated(items, ", ", Self::expression)),
            ExprKind::Matrix(rows) => self.between("[", "]", |p| p.separated(rows, "; ", |p, row| p.row(row))),
            ExprKind::Tuple(items) => self.tuple(items),
            ExprKind::Index(inner, indices) => {
                self.between("(", ")", |p| p.expression(inner));
                self.subscripts(indices);
            }
            ExprKind::End => self.word("end"),
            // A quoted identifier: the text reads back, though not as the same tree.
            ExprKind::Error => self.word("'?'"),
        }
    }

    /// A number in the shortest digits that read back as the same value, as `Debug` of Rust gives them.
    /// They are valid Modelica, except for infinity and NaN.
    fn number(&mut self, value: &impl std::fmt::Debug) {
        write!(self.out, "{value:?}").expect("writing to a string succeeds");
    }

    /// A string in quotation marks, with the escapes of Modelica 3.6, section 2.4.4.
    /// Quotes and backslashes get a backslash, as do control characters that have an escape.
    pub(super) fn string(&mut self, value: &str) {
        self.word("\"");
        for c in value.chars() {
            match c {
                '"' => self.word("\\\""),
                '\\' => self.word("\\\\"),
                '\u{7}' => self.word("\\a"),
                '\u{8}' => self.word("\\b"),
                '\u{c}' => self.word("\\f"),
                '\u{b}' => self.word("\\v"),
                '\r' => self.word("\\r"),
                '\t' => self.word("\\t"),
                // Line breaks may stand in a string as they are.
                _ => self.out.push(c),
            }
        }
        self.word("\"");
    }

    /// A prefix operator with its operand.
    /// `not` takes a relation; a sign takes a product, so that `-(a + b)` keeps its brackets.
    fn unary(&mut self, op: UnaryOp, operand: &Expr) {
        match op {
            UnaryOp::Plus => self.word("+"),
            UnaryOp::Minus => self.word("-"),
            UnaryOp::ElementPlus => self.word(".+"),
            UnaryOp::ElementMinus => self.word(".-"),
            UnaryOp::Not => {
                self.word("not ");
                return self.operand(operand, RELATION);
            }
        }
        // A sign takes a product as operand: `-a * b` is `-(a * b)`.
        self.operand(operand, PRODUCT);
    }

    /// Two operands with their operator.
    /// Blanks surround the operator, except for powers.
    fn binary(&mut self, op: BinaryOp, left: &Expr, right: &Expr) {
        let (sign, strength) = sign_and_strength(op);
        // Left-associative operators need no brackets on the left; relations and powers do not associate at all.
        let chains = !matches!(strength, RELATION | POWER);
        self.operand(left, if chains { strength } else { strength + 1 });
        if strength == POWER {
            // `2.^x` would read as `2.` to the power of `x`.
            let is_dotted = sign.starts_with('.') && matches!(left.kind, ExprKind::Integer(_));
            self.word(if is_dotted { " .^" } else { sign });
        } else {
            self.word(" ");
            self.word(sign);
            self.word(" ");
        }
        self.operand(right, strength + 1);
    }

    /// `if c then a elseif d then b else e`.
    fn if_expression(&mut self, branches: &[(Expr, Expr)], otherwise: &Expr) {
        let mut keyword = "if ";
        for (condition, value) in branches {
            self.word(keyword);
            self.expression(condition);
            self.word(" then ");
            self.expression(value);
            keyword = " elseif ";
        }
        self.word(" else ");
        self.expression(otherwise);
    }

    /// `from:to` or `from:step:to`.
    fn range(&mut self, from: &Expr, step: Option<&Expr>, to: &Expr) {
        self.operand(from, OR);
        for next in step.into_iter().chain([to]) {
            self.word(":");
            self.operand(next, OR);
        }
    }

    /// What `inner` writes, between two signs.
    fn between(&mut self, open: &str, close: &str, inner: impl FnOnce(&mut Self)) {
        self.word(open);
        inner(self);
        self.word(close);
    }

    /// The elements of a row of a matrix, separated by commas.
    fn row(&mut self, row: &[Expr]) {
        self.separated(row, ", ", Self::expression);
    }

    /// A list of outputs, of which each may be missing: `(a, , c)`.
    pub(super) fn tuple(&mut self, items: &[Option<Expr>]) {
        self.between("(", ")", |p| p.separated(items, ", ", |p, item| item.iter().for_each(|x| p.expression(x))));
    }

    /// The arguments of a call in brackets, positional ones first.
    /// Named arguments follow as `name = value`.
    fn arguments(&mut self, args: &[Expr], named: &[(Ident, Expr)]) {
        self.word("(");
        self.separated(args, ", ", Self::expression);
        if !args.is_empty() && !named.is_empty() {
            self.word(", ");
        }
        self.separated(named, ", ", |p, (name, value)| {
            p.ident(name);
            p.word(" = ");
            p.expression(value);
        });
        self.word(")");
    }

    /// A reduction, `f(body for i in r)`, or an array comprehension, `{body for i in r}`.
    fn comprehension(&mut self, function: Option<&ComponentReference>, body: &Expr, iterators: &[ForIndex]) {
        if let Some(function) = function {
            self.reference(function);
        }
        let (open, close) = if function.is_some() { ("(", ")") } else { ("{", "}") };
        self.between(open, close, |p| {
            p.expression(body);
            p.word(" for ");
            p.iterators(iterators);
        });
    }

    /// Iterators separated by commas, outermost first.
    pub(super) fn iterators(&mut self, iterators: &[ForIndex]) {
        self.separated(iterators, ", ", |p, iterator| {
            p.ident(&iterator.name);
            if let Some(range) = &iterator.range {
                p.word(" in ");
                p.expression(range);
            }
        });
    }
}

/// The precedence of an expression. Expressions that need no brackets anywhere have [`OPERAND`].
/// Compare with `strength` of the operators in the parser.
fn strength(kind: &ExprKind) -> u8 {
    match kind {
        ExprKind::If { .. } => ANY,
        ExprKind::Range { .. } => RANGE,
        ExprKind::Unary(UnaryOp::Not, _) => NOT,
        ExprKind::Unary(..) => SUM,
        // A negative literal is written with a sign, and binds like one.
        ExprKind::Integer(value) if *value < 0 => SUM,
        ExprKind::Real(value) if value.is_sign_negative() => SUM,
        ExprKind::Binary(op, ..) => sign_and_strength(*op).1,
        _ => OPERAND,
    }
}

/// The sign of an operator, and its precedence.
fn sign_and_strength(op: BinaryOp) -> (&'static str, u8) {
    match op {
        BinaryOp::Or => ("or", OR),
        BinaryOp::And => ("and", AND),
        BinaryOp::Lt => ("<", RELATION),
        BinaryOp::Le => ("<=", RELATION),
        BinaryOp::Gt => (">", RELATION),
        BinaryOp::Ge => (">=", RELATION),
        BinaryOp::Eq => ("==", RELATION),
        BinaryOp::Ne => ("<>", RELATION),
        BinaryOp::Add => ("+", SUM),
        BinaryOp::Sub => ("-", SUM),
        BinaryOp::ElementAdd => (".+", SUM),
        BinaryOp::ElementSub => (".-", SUM),
        BinaryOp::Mul => ("*", PRODUCT),
        BinaryOp::Div => ("/", PRODUCT),
        BinaryOp::ElementMul => (".*", PRODUCT),
        BinaryOp::ElementDiv => ("./", PRODUCT),
        BinaryOp::Pow => ("^", POWER),
        BinaryOp::ElementPow => (".^", POWER),
    }
}
