//! Prints expressions in Modelica syntax, for messages, listings of equations and tests.
//!
//! Brackets stand only where the text would otherwise mean something else. `a + (b + c)` keeps them, because it rounds
//! differently. Relations are printed without `noEvent`.
//! Shared subexpressions are printed wherever they occur, so the text may be much longer than the graph. It is cut off
//! at
//! a given limit, and always at [`LONGEST`].

use super::{BinaryFunction, ExprId, ExprNode, Exprs, RelationalOp, UnaryFunction, VarId};

/// The largest length of a text in bytes, approximately.
pub const LONGEST: usize = 100_000;

/// Operator precedences. An operand that binds less tightly than required is put in brackets.
mod bind {
    pub const WHOLE: u8 = 0;
    pub const OR: u8 = 1;
    pub const AND: u8 = 2;
    pub const NOT: u8 = 3;
    pub const REL: u8 = 4;
    pub const SUM: u8 = 5;
    pub const PRODUCT: u8 = 6;
    pub const POWER: u8 = 7;
    pub const PRIMARY: u8 = 8;
}

/// A piece of text that is still to be written. The pieces are a stack, whose top is next.
enum PrintPiece {
    /// A fixed text.
    Text(&'static str),
    /// A name or number.
    Name(String),
    /// An expression, the least precedence it must have, and whether numbers in it mean Boolean values.
    Expr(ExprId, u8, bool),
}

/// A text under construction. A stack of pieces instead of recursion allows deep expressions.
struct ExprPrinter<'a> {
    /// The pool of the expressions.
    pool: &'a Exprs,
    /// Gives the names of variables.
    names: &'a dyn Fn(VarId) -> String,
    /// The significant digits of numbers. `None` prints the shortest text that reads back as the same number.
    digits: Option<usize>,
    /// The pieces still to be written, the next one last.
    todo: Vec<PrintPiece>,
    /// The text so far.
    text: String,
}

impl Exprs {
    /// The complete expression, with numbers that read back as the same values.
    pub fn print(&self, e: ExprId, names: &dyn Fn(VarId) -> String) -> String {
        self.print_within(e, names, None, LONGEST)
    }

    /// The expression for messages: numbers with 6 digits, and `...` after about `limit` bytes.
    pub fn print_short(&self, e: ExprId, names: &dyn Fn(VarId) -> String, limit: usize) -> String {
        self.print_within(e, names, Some(6), limit)
    }

    /// Prints until all is written, or the limit is exceeded.
    /// It takes pieces from the stack one by one.
    fn print_within(&self, e: ExprId, names: &dyn Fn(VarId) -> String, digits: Option<usize>, limit: usize) -> String {
        let mut printer = ExprPrinter { pool: self, names, digits, todo: vec![], text: String::new() };
        printer.todo.push(PrintPiece::Expr(e, bind::WHOLE, false));
        while let Some(piece) = printer.todo.pop() {
            if printer.text.len() > limit {
                printer.text.push_str("...");
                break;
            }
            match piece {
                PrintPiece::Text(text) => printer.text.push_str(text),
                PrintPiece::Name(name) => printer.text.push_str(&name),
                PrintPiece::Expr(e, least, truth) => printer.expression(e, least, truth),
            }
        }
        printer.text
    }
}

impl ExprPrinter<'_> {
    /// Puts the pieces of an expression on the stack, in brackets if it binds less tightly than `least`.
    fn expression(&mut self, e: ExprId, least: u8, truth: bool) {
        let (binding, pieces) = self.pieces(e, truth);
        let brackets = binding < least;
        if brackets {
            self.todo.push(PrintPiece::Text(")"));
        }
        // The stack is read from its end.
        self.todo.extend(pieces.into_iter().rev());
        if brackets {
            self.todo.push(PrintPiece::Text("("));
        }
    }

    /// The pieces of one node's text, and its precedence.
    /// `truth` is true if the value is a Boolean one.
    fn pieces(&self, e: ExprId, truth: bool) -> (u8, Vec<PrintPiece>) {
        use PrintPiece::{Expr, Name, Text};
        let name = |v: VarId| Name((self.names)(v));
        match self.pool.node(e) {
            ExprNode::Num(bits) => self.number(f64::from_bits(bits), truth),
            ExprNode::Time => (bind::PRIMARY, vec![Text("time")]),
            ExprNode::Var(v) => (bind::PRIMARY, vec![name(v)]),
            ExprNode::Der(v) => (bind::PRIMARY, vec![Text("der("), name(v), Text(")")]),
            ExprNode::Pre(v) => (bind::PRIMARY, vec![Text("pre("), name(v), Text(")")]),
            ExprNode::Initial => (bind::PRIMARY, vec![Text("initial()")]),
            ExprNode::Terminal => (bind::PRIMARY, vec![Text("terminal()")]),
            ExprNode::Unary(UnaryFunction::Neg, a) => (bind::SUM, vec![Text("-"), Expr(a, bind::PRODUCT, false)]),
            ExprNode::Unary(UnaryFunction::Not, a) => (bind::NOT, vec![Text("not "), Expr(a, bind::REL, true)]),
            ExprNode::Unary(op, a) => call(unary_name(op), &[a]),
            ExprNode::EventFloor(a) => call("floor", &[a]),
            ExprNode::Binary(op, a, b) => binary(op, a, b),
            ExprNode::Rel(rel, a, b) | ExprNode::EventRel(rel, a, b) => {
                // Relations with and without event look alike.
                let sign = match rel {
                    RelationalOp::Lt => " < ",
                    RelationalOp::Le => " <= ",
                    RelationalOp::Gt => " > ",
                    RelationalOp::Ge => " >= ",
                    RelationalOp::Eq => " == ",
                    RelationalOp::Ne => " <> ",
                };
                (bind::REL, vec![Expr(a, bind::SUM, false), Text(sign), Expr(b, bind::SUM, false)])
            }
            ExprNode::If(c, a, b) => {
                // The branches have the type of the expression, so that truth values in them are printed as such.
                let branch = |e| Expr(e, bind::WHOLE, truth);
                let pieces =
                    vec![Text("if "), Expr(c, bind::OR, true), Text(" then "), branch(a), Text(" else "), branch(b)];
                (bind::WHOLE, pieces)
            }
            ExprNode::Sample(a, b) => call("sample", &[a, b]),
            ExprNode::Delay(a, b) => call("delay", &[a, b]),
            ExprNode::Homotopy(a, b) => call("homotopy", &[a, b]),
            ExprNode::Call(function, output, args) => {
                let function = &self.pool.functions[function.0 as usize];
                let mut pieces = vec![Name(function.name.clone()), Text("(")];
                arguments(&mut pieces, self.pool.args(args));
                // Modelica has no syntax for one output of several; its number stands behind the call.
                if function.outputs.len() > 1 {
                    pieces.push(Name(format!("[{}]", output + 1)));
                }
                (bind::PRIMARY, pieces)
            }
        }
    }

    /// A number, or a Boolean value if `truth` is true. A negative number binds like a sum.
    /// `truth` is true where the number stands for a Boolean value.
    fn number(&self, value: f64, truth: bool) -> (u8, Vec<PrintPiece>) {
        if truth {
            return (bind::PRIMARY, vec![PrintPiece::Text(if value == 0.0 { "false" } else { "true" })]);
        }
        let binding = if value < 0.0 { bind::SUM } else { bind::PRIMARY };
        (binding, vec![PrintPiece::Name(number(value, self.digits))])
    }
}

/// The arguments separated by commas, and the closing bracket.
fn arguments(pieces: &mut Vec<PrintPiece>, args: &[ExprId]) {
    for (i, &arg) in args.iter().enumerate() {
        if i > 0 {
            pieces.push(PrintPiece::Text(", "));
        }
        pieces.push(PrintPiece::Expr(arg, bind::WHOLE, false));
    }
    pieces.push(PrintPiece::Text(")"));
}

/// A call with its arguments, and its precedence.
/// The arguments need no brackets, as commas separate them.
fn call(name: &'static str, args: &[ExprId]) -> (u8, Vec<PrintPiece>) {
    let mut pieces = vec![PrintPiece::Text(name), PrintPiece::Text("(")];
    arguments(&mut pieces, args);
    (bind::PRIMARY, pieces)
}

/// An infix operator or a function of two arguments. The right operand must bind more tightly, since operators
/// associate
/// to the left; powers do not associate.
fn binary(op: BinaryFunction, a: ExprId, b: ExprId) -> (u8, Vec<PrintPiece>) {
    let (own, left, sign, right) = match op {
        BinaryFunction::Add => (bind::SUM, bind::SUM, " + ", bind::PRODUCT),
        BinaryFunction::Sub => (bind::SUM, bind::SUM, " - ", bind::PRODUCT),
        BinaryFunction::Mul => (bind::PRODUCT, bind::PRODUCT, "*", bind::POWER),
        BinaryFunction::Div => (bind::PRODUCT, bind::PRODUCT, "/", bind::POWER),
        BinaryFunction::Pow => (bind::POWER, bind::PRIMARY, "^", bind::PRIMARY),
        BinaryFunction::And => (bind::AND, bind::AND, " and ", bind::NOT),
        BinaryFunction::Or => (bind::OR, bind::OR, " or ", bind::AND),
        BinaryFunction::Min => return call("min", &[a, b]),
        BinaryFunction::Max => return call("max", &[a, b]),
        BinaryFunction::Atan2 => return call("atan2", &[a, b]),
    };
    let truth = matches!(op, BinaryFunction::And | BinaryFunction::Or);
    (own, vec![PrintPiece::Expr(a, left, truth), PrintPiece::Text(sign), PrintPiece::Expr(b, right, truth)])
}

/// The Modelica name of an operator or function of one argument.
/// `Neg` and `Not` are prefix operators.
fn unary_name(op: UnaryFunction) -> &'static str {
    match op {
        UnaryFunction::Neg => "-",
        UnaryFunction::Not => "not",
        UnaryFunction::Abs => "abs",
        UnaryFunction::Sign => "sign",
        UnaryFunction::Sqrt => "sqrt",
        UnaryFunction::Exp => "exp",
        UnaryFunction::Log => "log",
        UnaryFunction::Log10 => "log10",
        UnaryFunction::Sin => "sin",
        UnaryFunction::Cos => "cos",
        UnaryFunction::Tan => "tan",
        UnaryFunction::Asin => "asin",
        UnaryFunction::Acos => "acos",
        UnaryFunction::Atan => "atan",
        UnaryFunction::Sinh => "sinh",
        UnaryFunction::Cosh => "cosh",
        UnaryFunction::Tanh => "tanh",
        UnaryFunction::Floor => "floor",
    }
}

/// A number as text: the shortest that reads back as the same value, or rounded to some significant digits.
/// Powers of ten are used from 1e5 on and below 1e-3, if they are not longer.
pub fn number(value: f64, digits: Option<usize>) -> String {
    let value = match digits {
        Some(digits) if value.is_finite() => format!("{value:.*e}", digits.saturating_sub(1)).parse().unwrap_or(value),
        _ => value,
    };
    let plain = format!("{value}");
    let magnitude = value.abs();
    if !value.is_finite() || magnitude == 0.0 || (1e-3..1e5).contains(&magnitude) {
        return plain;
    }
    let power = format!("{value:e}");
    if power.len() <= plain.len() { power } else { plain }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn name(v: VarId) -> String {
        ["x", "y", "z"][v.index()].into()
    }

    #[test]
    fn brackets_stand_where_they_must() {
        let mut p = Exprs::default();
        let (x, y, z) = (p.var(VarId(0)), p.var(VarId(1)), p.var(VarId(2)));
        let (sum, difference, product) = (p.add(x, y), p.sub(y, z), p.mul(x, y));
        let minus_two = p.num(-2.0);
        let minus = p.neg(x);
        let cases = [
            (p.mul(sum, z), "(x + y)*z"),
            (p.add(z, sum), "z + (x + y)"),
            (p.add(sum, x), "x + y + x"),
            (p.sub(x, difference), "x - (y - z)"),
            (p.div(z, product), "z/(x*y)"),
            (p.div(product, z), "x*y/z"),
            (p.pow(x, minus_two), "x^(-2)"),
            (p.pow(sum, z), "(x + y)^z"),
            (p.mul(x, minus_two), "x*(-2)"),
            (p.sub(minus, sum), "-x - (x + y)"),
            (p.abs(sum), "abs(x + y)"),
        ];
        for (e, text) in cases {
            assert_eq!(p.print(e, &name), text);
        }
    }

    #[test]
    fn logic_and_leaves() {
        let mut p = Exprs::default();
        let (x, y) = (p.var(VarId(0)), p.pre(VarId(1)));
        let dx = p.der(VarId(0));
        let less = p.event_rel(RelationalOp::Lt, x, Exprs::ZERO);
        let not = p.not(y);
        let both = p.and(not, less);
        let either = p.or(both, y);
        let e = p.if_(either, dx, Exprs::ONE);
        assert_eq!(p.print(e, &name), "if not pre(y) and x < 0 or pre(y) then der(x) else 1");
        let sum = p.add(x, e);
        let short = p.print_short(sum, &name, 20);
        assert!(short.starts_with("x + (if not pre(y)") && short.ends_with("...") && short.len() < 30);
    }

    #[test]
    fn numbers_are_short() {
        let cases = [(0.1, "0.1"), (210e5, "2.1e7"), (1e5, "1e5"), (10000.0, "10000"), (1e-5, "1e-5"), (0.0, "0")];
        for (value, text) in cases {
            assert_eq!(number(value, None), text);
        }
        assert_eq!(number(std::f64::consts::PI, Some(6)), "3.14159");
        assert_eq!(number(123456.0, None), "123456");
        assert_eq!(number(f64::INFINITY, Some(6)), "inf");
    }

    #[test]
    fn shared_parts_do_not_explode() {
        let mut p = Exprs::default();
        let mut e = p.var(VarId(0));
        for _ in 0..200 {
            let double = p.sqrt(e);
            e = p.mul(double, e);
        }
        assert!(p.print(e, &name).len() < LONGEST + 100);
        assert!(p.print_short(e, &name, 60).len() < 100);
    }
}
