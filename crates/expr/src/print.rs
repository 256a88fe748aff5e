//! Expressions in Modelica syntax.
//!
//! Brackets stand only where the text would otherwise mean something else; `a + (b + c)` keeps them, because it rounds
//! differently. Relations are printed without `noEvent`. What the pool shares is printed as often as it is used, so
//! long expressions are cut off where a limit is set, and always at [`LONGEST`].

use super::{Binary, ExprId, Exprs, Node, Rel, Unary, VarId};

/// No text is longer than about this many bytes.
pub const LONGEST: usize = 100_000;

/// How tightly an operator binds; arguments that bind less tightly than asked are put in brackets.
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

/// What is still to be written; the last one is next.
enum Piece {
    Text(&'static str),
    Name(String),
    /// An expression that must bind at least so tightly; `true` when numbers mean truth values.
    Expr(ExprId, u8, bool),
}

/// A text being written.
struct Printer<'a> {
    pool: &'a Exprs,
    names: &'a dyn Fn(VarId) -> String,
    /// Significant digits of numbers, or as many as it takes.
    digits: Option<usize>,
    todo: Vec<Piece>,
    text: String,
}

impl Exprs {
    /// The whole expression, numbers with as many digits as it takes to read back the same.
    pub fn print(&self, e: ExprId, names: &dyn Fn(VarId) -> String) -> String {
        self.print_within(e, names, None, LONGEST)
    }

    /// For messages: numbers with 6 digits, and cut off with `...` after about `limit` bytes.
    pub fn print_short(&self, e: ExprId, names: &dyn Fn(VarId) -> String, limit: usize) -> String {
        self.print_within(e, names, Some(6), limit)
    }

    fn print_within(&self, e: ExprId, names: &dyn Fn(VarId) -> String, digits: Option<usize>, limit: usize) -> String {
        let mut printer = Printer { pool: self, names, digits, todo: vec![], text: String::new() };
        printer.todo.push(Piece::Expr(e, bind::WHOLE, false));
        while let Some(piece) = printer.todo.pop() {
            if printer.text.len() > limit {
                printer.text.push_str("...");
                break;
            }
            match piece {
                Piece::Text(text) => printer.text.push_str(text),
                Piece::Name(name) => printer.text.push_str(&name),
                Piece::Expr(e, least, truth) => printer.expression(e, least, truth),
            }
        }
        printer.text
    }
}

impl Printer<'_> {
    fn expression(&mut self, e: ExprId, least: u8, truth: bool) {
        let (binding, pieces) = self.pieces(e, truth);
        let brackets = binding < least;
        if brackets {
            self.todo.push(Piece::Text(")"));
        }
        self.todo.extend(pieces.into_iter().rev());
        if brackets {
            self.todo.push(Piece::Text("("));
        }
    }

    /// The parts of one node's text, and how tightly the whole binds.
    fn pieces(&self, e: ExprId, truth: bool) -> (u8, Vec<Piece>) {
        use Piece::{Expr, Name, Text};
        let name = |v: VarId| Name((self.names)(v));
        match self.pool.node(e) {
            Node::Num(bits) => self.number(f64::from_bits(bits), truth),
            Node::Time => (bind::PRIMARY, vec![Text("time")]),
            Node::Var(v) => (bind::PRIMARY, vec![name(v)]),
            Node::Der(v) => (bind::PRIMARY, vec![Text("der("), name(v), Text(")")]),
            Node::Pre(v) => (bind::PRIMARY, vec![Text("pre("), name(v), Text(")")]),
            Node::Initial => (bind::PRIMARY, vec![Text("initial()")]),
            Node::Terminal => (bind::PRIMARY, vec![Text("terminal()")]),
            Node::Unary(Unary::Neg, a) => (bind::SUM, vec![Text("-"), Expr(a, bind::PRODUCT, false)]),
            Node::Unary(Unary::Not, a) => (bind::NOT, vec![Text("not "), Expr(a, bind::REL, true)]),
            Node::Unary(op, a) => call(unary_name(op), &[a]),
            Node::EventFloor(a) => call("floor", &[a]),
            Node::Binary(op, a, b) => binary(op, a, b),
            Node::Rel(rel, a, b) | Node::EventRel(rel, a, b) => {
                let sign = match rel {
                    Rel::Lt => " < ",
                    Rel::Le => " <= ",
                    Rel::Gt => " > ",
                    Rel::Ge => " >= ",
                    Rel::Eq => " == ",
                    Rel::Ne => " <> ",
                };
                (bind::REL, vec![Expr(a, bind::SUM, false), Text(sign), Expr(b, bind::SUM, false)])
            }
            Node::If(c, a, b) => {
                let branch = |e| Expr(e, bind::WHOLE, truth);
                let pieces =
                    vec![Text("if "), Expr(c, bind::OR, true), Text(" then "), branch(a), Text(" else "), branch(b)];
                (bind::WHOLE, pieces)
            }
            Node::Sample(a, b) => call("sample", &[a, b]),
            Node::Delay(a, b) => call("delay", &[a, b]),
            Node::Homotopy(a, b) => call("homotopy", &[a, b]),
            Node::Call(function, output, args) => {
                let function = &self.pool.functions[function.0 as usize];
                let mut pieces = vec![Name(function.name.clone()), Text("(")];
                arguments(&mut pieces, self.pool.args(args));
                if function.outputs.len() > 1 {
                    pieces.push(Name(format!("[{}]", output + 1)));
                }
                (bind::PRIMARY, pieces)
            }
        }
    }

    fn number(&self, value: f64, truth: bool) -> (u8, Vec<Piece>) {
        if truth {
            return (bind::PRIMARY, vec![Piece::Text(if value == 0.0 { "false" } else { "true" })]);
        }
        let binding = if value < 0.0 { bind::SUM } else { bind::PRIMARY };
        (binding, vec![Piece::Name(number(value, self.digits))])
    }
}

/// Comma-separated arguments and the closing bracket.
fn arguments(pieces: &mut Vec<Piece>, args: &[ExprId]) {
    for (i, &arg) in args.iter().enumerate() {
        if i > 0 {
            pieces.push(Piece::Text(", "));
        }
        pieces.push(Piece::Expr(arg, bind::WHOLE, false));
    }
    pieces.push(Piece::Text(")"));
}

fn call(name: &'static str, args: &[ExprId]) -> (u8, Vec<Piece>) {
    let mut pieces = vec![Piece::Text(name), Piece::Text("(")];
    arguments(&mut pieces, args);
    (bind::PRIMARY, pieces)
}

fn binary(op: Binary, a: ExprId, b: ExprId) -> (u8, Vec<Piece>) {
    let (own, left, sign, right) = match op {
        Binary::Add => (bind::SUM, bind::SUM, " + ", bind::PRODUCT),
        Binary::Sub => (bind::SUM, bind::SUM, " - ", bind::PRODUCT),
        Binary::Mul => (bind::PRODUCT, bind::PRODUCT, "*", bind::POWER),
        Binary::Div => (bind::PRODUCT, bind::PRODUCT, "/", bind::POWER),
        Binary::Pow => (bind::POWER, bind::PRIMARY, "^", bind::PRIMARY),
        Binary::And => (bind::AND, bind::AND, " and ", bind::NOT),
        Binary::Or => (bind::OR, bind::OR, " or ", bind::AND),
        Binary::Min => return call("min", &[a, b]),
        Binary::Max => return call("max", &[a, b]),
        Binary::Atan2 => return call("atan2", &[a, b]),
    };
    let truth = matches!(op, Binary::And | Binary::Or);
    (own, vec![Piece::Expr(a, left, truth), Piece::Text(sign), Piece::Expr(b, right, truth)])
}

/// The Modelica name of a function of one argument.
fn unary_name(op: Unary) -> &'static str {
    match op {
        Unary::Neg => "-",
        Unary::Not => "not",
        Unary::Abs => "abs",
        Unary::Sign => "sign",
        Unary::Sqrt => "sqrt",
        Unary::Exp => "exp",
        Unary::Log => "log",
        Unary::Log10 => "log10",
        Unary::Sin => "sin",
        Unary::Cos => "cos",
        Unary::Tan => "tan",
        Unary::Asin => "asin",
        Unary::Acos => "acos",
        Unary::Atan => "atan",
        Unary::Sinh => "sinh",
        Unary::Cosh => "cosh",
        Unary::Tanh => "tanh",
        Unary::Floor => "floor",
    }
}

/// A number as text: shortest that reads back the same, or rounded to so many significant digits. Powers of ten are
/// used from 1e5 up and below 1e-3, where they are not longer.
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
        let less = p.event_rel(Rel::Lt, x, Exprs::ZERO);
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
