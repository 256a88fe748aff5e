//! Expressions as MathML: fractions, powers, roots and indices; names stay the names of the source.

use bramah::internals::plot::svg::escape;
use bramah::internals::syntax::ast::{BinaryOp, ComponentReference, Expr, ExprKind, ForIndex, Subscript, UnaryOp};
use bramah::results::number;

/// Greek letters that names may begin with. `w` and `V` are left alone: the page shows what the source says.
const GREEK: [(&str, &str); 21] = [
    ("alpha", "α"),
    ("beta", "β"),
    ("gamma", "γ"),
    ("delta", "δ"),
    ("Delta", "Δ"),
    ("eps", "ε"),
    ("epsilon", "ε"),
    ("zeta", "ζ"),
    ("eta", "η"),
    ("theta", "θ"),
    ("kappa", "κ"),
    ("lambda", "λ"),
    ("mu", "μ"),
    ("nu", "ν"),
    ("xi", "ξ"),
    ("rho", "ρ"),
    ("sigma", "σ"),
    ("tau", "τ"),
    ("phi", "φ"),
    ("psi", "ψ"),
    ("pi", "π"),
];

/// Binding strengths: what stands inside a weaker one needs brackets.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Level {
    Whole,
    Or,
    And,
    Not,
    Relation,
    Sum,
    Product,
    Power,
    Atom,
}

/// An expression as the content of a `math` element.
pub fn expression(e: &Expr) -> String {
    row(&write(e, Level::Whole))
}

/// A sum on the right of a long equation, cut into lines of terms; one line where it is short.
pub fn lines(e: &Expr, room: usize) -> Vec<String> {
    if let ExprKind::Call { function, args, named } = &e.kind
        && width(e) > room
        && named.is_empty()
        && args.len() > 1
        && function.parts.len() > 1
    {
        return call_lines(function, args, room);
    }
    let mut terms = Vec::new();
    split(e, true, &mut terms);
    let mut out: Vec<String> = Vec::new();
    let mut used = 0;
    for (i, (positive, term)) in terms.iter().enumerate() {
        let sign = match (i, positive) {
            (0, true) => "",
            (_, true) => "<mo>+</mo>",
            (_, false) => "<mo>−</mo>",
        };
        let text = format!("{sign}{}", write(term, if *positive && i == 0 { Level::Sum } else { Level::Product }));
        let width = width(term);
        match out.last_mut() {
            Some(line) if used + width <= room => line.push_str(&text),
            _ => {
                out.push(text);
                used = 0;
            }
        }
        used += width + 3;
    }
    out
}

/// A call of a function of a package, with a new line before an argument that has no room.
fn call_lines(function: &ComponentReference, args: &[Expr], room: usize) -> Vec<String> {
    let name: Vec<&str> = function.parts.iter().map(|p| p.name.name.as_str()).collect();
    let mut out = vec![format!("{}<mo stretchy=\"false\">(</mo>", upright(&name.join(".")))];
    let mut used = name_width(function) + 1;
    for (i, arg) in args.iter().enumerate() {
        let end = if i + 1 < args.len() { "<mo>,</mo>" } else { "<mo stretchy=\"false\">)</mo>" };
        let text = format!("{}{end}", write(arg, Level::Whole));
        match out.last_mut() {
            Some(line) if used + width(arg) <= room => line.push_str(&text),
            _ => {
                out.push(text);
                used = 0;
            }
        }
        used += width(arg) + 1;
    }
    out
}

fn split<'a>(e: &'a Expr, positive: bool, out: &mut Vec<(bool, &'a Expr)>) {
    match &e.kind {
        ExprKind::Binary(BinaryOp::Add, a, b) => {
            split(a, positive, out);
            split(b, positive, out);
        }
        ExprKind::Binary(BinaryOp::Sub, a, b) if positive => {
            split(a, positive, out);
            out.push((false, b));
        }
        _ => out.push((positive, e)),
    }
}

/// About how many characters wide an expression is set: fractions count their longer half.
pub fn width(e: &Expr) -> usize {
    match &e.kind {
        ExprKind::Reference(r) => name_width(r),
        ExprKind::Unary(_, a) => 1 + width(a),
        ExprKind::Binary(BinaryOp::Div, a, b) => width(a).max(width(b)),
        ExprKind::Binary(_, a, b) => width(a) + width(b) + 1,
        ExprKind::Call { function, args, named } => {
            let named: usize = named.iter().map(|(n, v)| n.name.as_str().len() + 1 + width(v)).sum();
            name_width(function) + 2 + args.iter().map(|a| width(a) + 1).sum::<usize>() + named
        }
        // two columns: values and conditions
        ExprKind::If { branches, otherwise } => {
            let values = branches.iter().map(|(_, v)| width(v)).max().unwrap_or(0).max(width(otherwise));
            values + 6 + branches.iter().map(|(c, _)| width(c)).max().unwrap_or(0)
        }
        ExprKind::Integer(i) => i.to_string().len(),
        ExprKind::Array(items) => items.iter().map(|i| width(i) + 1).sum::<usize>() + 2,
        ExprKind::Tuple(items) => items.iter().flatten().map(|i| width(i) + 1).sum::<usize>() + 2,
        _ => 6,
    }
}

fn name_width(r: &ComponentReference) -> usize {
    let within = |s: &Subscript| match s {
        Subscript::All(_) => 3,
        Subscript::Expr(e) => 2 + width(e),
    };
    r.parts.iter().map(|p| p.name.name.as_str().len() + p.subscripts.iter().map(within).sum::<usize>()).sum()
}

fn row(content: &str) -> String {
    format!("<mrow>{content}</mrow>")
}

fn write(e: &Expr, level: Level) -> String {
    let (own, text) = parts(e);
    if own < level { round(&text) } else { text }
}

/// Brackets around, high only where something high stands inside.
fn round(text: &str) -> String {
    let high = ["<mfrac", "<mtable", "<munder"].iter().any(|tag| text.contains(tag));
    let stretchy = if high { "" } else { " stretchy=\"false\"" };
    format!("<mrow><mo{stretchy}>(</mo>{text}<mo{stretchy}>)</mo></mrow>")
}

fn parts(e: &Expr) -> (Level, String) {
    match &e.kind {
        ExprKind::Integer(i) if *i < 0 => (Level::Sum, format!("<mn>{i}</mn>")),
        ExprKind::Integer(i) => (Level::Atom, format!("<mn>{i}</mn>")),
        ExprKind::Real(x) => real(*x),
        ExprKind::String(s) => (Level::Atom, format!("<mtext>\"{}\"</mtext>", escape(s))),
        ExprKind::Boolean(b) => (Level::Atom, format!("<mtext>{b}</mtext>")),
        ExprKind::Reference(r) => (Level::Atom, reference(r)),
        ExprKind::Unary(op, a) => unary(*op, a),
        ExprKind::Binary(op, a, b) => binary(*op, a, b),
        ExprKind::If { branches, otherwise } => (Level::Atom, cases(branches, otherwise)),
        ExprKind::Range { from, step, to } => {
            let mut all = vec![from];
            all.extend(step);
            all.push(to);
            let all: Vec<String> = all.iter().map(|e| write(e, Level::Sum)).collect();
            (Level::Whole, all.join("<mo>:</mo>"))
        }
        ExprKind::Call { function, args, named } => call(function, args, named),
        ExprKind::Comprehension { function, body, iterators } => comprehension(function.as_ref(), body, iterators),
        ExprKind::PartialApplication { function, named } => {
            let name: Vec<&str> = function.parts.iter().map(|p| p.name.as_str()).collect();
            (Level::Atom, format!("{}{}", upright(&name.join(".")), bracketed(&[], named)))
        }
        ExprKind::Array(items) => (Level::Atom, format!("<mo>{{</mo>{}<mo>}}</mo>", listed(items))),
        ExprKind::Matrix(rows) => (Level::Atom, matrix(rows)),
        ExprKind::Tuple(items) => {
            let items: Vec<String> =
                items.iter().map(|i| i.as_ref().map_or(String::new(), |e| write(e, Level::Whole))).collect();
            (Level::Atom, format!("<mo>(</mo>{}<mo>)</mo>", items.join("<mo>,</mo>")))
        }
        ExprKind::Index(a, subscripts) => (Level::Atom, format!("{}{}", write(a, Level::Atom), indices(subscripts))),
        ExprKind::End => (Level::Atom, "<mtext>end</mtext>".to_owned()),
        ExprKind::Error => (Level::Atom, "<mtext>?</mtext>".to_owned()),
    }
}

/// A number; powers of ten are set as such.
fn real(x: f64) -> (Level, String) {
    let text = number::text(x);
    match text.split_once(['e', 'E']) {
        Some(("1", exponent)) => (Level::Power, format!("<msup><mn>10</mn><mn>{}</mn></msup>", minus(exponent))),
        Some((mantissa, exponent)) => {
            let power = format!("<msup><mn>10</mn><mn>{}</mn></msup>", minus(exponent));
            (Level::Product, format!("<mn>{}</mn><mo>·</mo>{power}", minus(mantissa)))
        }
        None if x < 0.0 => (Level::Sum, format!("<mn>{}</mn>", minus(&text))),
        None => (Level::Atom, format!("<mn>{text}</mn>")),
    }
}

fn minus(text: &str) -> String {
    text.replace('-', "−")
}

fn unary(op: UnaryOp, a: &Expr) -> (Level, String) {
    match op {
        UnaryOp::Not => (Level::Not, format!("<mtext>not&nbsp;</mtext>{}", write(a, Level::Atom))),
        UnaryOp::Minus | UnaryOp::ElementMinus => (Level::Sum, format!("<mo>−</mo>{}", write(a, Level::Product))),
        UnaryOp::Plus | UnaryOp::ElementPlus => (Level::Sum, format!("<mo>+</mo>{}", write(a, Level::Product))),
    }
}

fn binary(op: BinaryOp, a: &Expr, b: &Expr) -> (Level, String) {
    let infix = |level: Level, sign: &str, left: Level, right: Level| {
        (level, format!("{}{sign}{}", write(a, left), write(b, right)))
    };
    let relation = |sign: &str| infix(Level::Relation, &format!("<mo>{sign}</mo>"), Level::Sum, Level::Sum);
    match op {
        BinaryOp::Add | BinaryOp::ElementAdd => infix(Level::Sum, "<mo>+</mo>", Level::Sum, Level::Product),
        BinaryOp::Sub | BinaryOp::ElementSub => infix(Level::Sum, "<mo>−</mo>", Level::Sum, Level::Product),
        BinaryOp::Mul | BinaryOp::ElementMul => infix(Level::Product, "<mo>·</mo>", Level::Product, Level::Power),
        BinaryOp::Div | BinaryOp::ElementDiv => (Level::Power, fraction(a, b)),
        BinaryOp::Pow | BinaryOp::ElementPow => {
            let base = row(&write(a, Level::Atom));
            (Level::Power, format!("<msup>{base}{}</msup>", row(&write(b, Level::Whole))))
        }
        BinaryOp::Lt => relation("&lt;"),
        BinaryOp::Le => relation("≤"),
        BinaryOp::Gt => relation("&gt;"),
        BinaryOp::Ge => relation("≥"),
        BinaryOp::Eq => relation("="),
        BinaryOp::Ne => relation("≠"),
        BinaryOp::And => infix(Level::And, "<mtext>&nbsp;and&nbsp;</mtext>", Level::And, Level::And),
        BinaryOp::Or => infix(Level::Or, "<mtext>&nbsp;or&nbsp;</mtext>", Level::Or, Level::Or),
    }
}

fn fraction(a: &Expr, b: &Expr) -> String {
    format!("<mfrac>{}{}</mfrac>", row(&write(a, Level::Whole)), row(&write(b, Level::Whole)))
}

fn cases(branches: &[(Expr, Expr)], otherwise: &Expr) -> String {
    let mut rows = String::new();
    for (condition, value) in branches {
        rows.push_str(&format!(
            "<mtr><mtd>{}</mtd><mtd><mtext>if&nbsp;</mtext>{}</mtd></mtr>",
            write(value, Level::Whole),
            write(condition, Level::Whole)
        ));
    }
    rows.push_str(&format!("<mtr><mtd>{}</mtd><mtd><mtext>else</mtext></mtd></mtr>", write(otherwise, Level::Whole)));
    format!("<mrow><mo stretchy=\"true\">{{</mo><mtable class=\"cases\">{rows}</mtable></mrow>")
}

fn matrix(rows: &[Vec<Expr>]) -> String {
    let cells = |r: &Vec<Expr>| r.iter().map(|e| format!("<mtd>{}</mtd>", write(e, Level::Whole))).collect::<String>();
    let rows: String = rows.iter().map(|r| format!("<mtr>{}</mtr>", cells(r))).collect();
    format!("<mrow><mo>[</mo><mtable>{rows}</mtable><mo>]</mo></mrow>")
}

fn listed(items: &[Expr]) -> String {
    items.iter().map(|i| write(i, Level::Whole)).collect::<Vec<_>>().join("<mo>,</mo>")
}

fn bracketed(args: &[Expr], named: &[(bramah::internals::syntax::ast::Ident, Expr)]) -> String {
    let mut all: Vec<String> = args.iter().map(|a| write(a, Level::Whole)).collect();
    all.extend(named.iter().map(|(n, v)| format!("{}<mo>=</mo>{}", name(n.name.as_str()), write(v, Level::Whole))));
    round(&all.join("<mo>,</mo>"))
}

fn call(
    function: &ComponentReference,
    args: &[Expr],
    named: &[(bramah::internals::syntax::ast::Ident, Expr)],
) -> (Level, String) {
    let words: Vec<&str> = function.parts.iter().map(|p| p.name.name.as_str()).collect();
    match (words.join(".").as_str(), args) {
        ("der", [x]) => (Level::Power, derivative(x)),
        ("sqrt", [x]) => (Level::Atom, format!("<msqrt>{}</msqrt>", write(x, Level::Whole))),
        ("abs", [x]) => (Level::Atom, format!("<mrow><mo>|</mo>{}<mo>|</mo></mrow>", write(x, Level::Whole))),
        // What only steers the event handling is no mathematics; the source beside it shows it.
        ("noEvent", [x]) | ("smooth", [_, x]) => parts(x),
        (full, _) => (Level::Atom, format!("{}{}", upright(full), bracketed(args, named))),
    }
}

fn derivative(x: &Expr) -> String {
    let inner = write(x, Level::Atom);
    format!(
        "<mfrac><mrow><mi mathvariant=\"normal\">d</mi>{inner}</mrow><mrow><mi mathvariant=\"normal\">d</mi><mi>t</mi></mrow></mfrac>"
    )
}

fn comprehension(function: Option<&ComponentReference>, body: &Expr, iterators: &[ForIndex]) -> (Level, String) {
    let over = iterators.iter().map(iterator).collect::<Vec<_>>().join("<mo>,</mo>");
    let is_sum = function.is_some_and(|f| f.parts.len() == 1 && f.parts[0].name.name == "sum");
    if is_sum {
        return (
            Level::Product,
            format!("<munder><mo>∑</mo><mrow>{over}</mrow></munder>{}", write(body, Level::Product)),
        );
    }
    let inner = format!("{}<mtext>&nbsp;for&nbsp;</mtext>{over}", write(body, Level::Whole));
    let text = match function {
        Some(f) => format!("{}{}", reference(f), round(&inner)),
        None => format!("<mo>{{</mo>{inner}<mo>}}</mo>"),
    };
    (Level::Atom, text)
}

/// `i ∈ 1:n`, as in loops.
pub fn iterator(i: &ForIndex) -> String {
    let name = name(i.name.name.as_str());
    match &i.range {
        Some(range) => format!("{name}<mo>∈</mo>{}", write(range, Level::Whole)),
        None => name,
    }
}

fn reference(r: &ComponentReference) -> String {
    let parts: Vec<String> =
        r.parts.iter().map(|p| format!("{}{}", name(p.name.name.as_str()), indices(&p.subscripts))).collect();
    if parts.len() == 1 { parts[0].clone() } else { row(&parts.join("<mo lspace=\"0\" rspace=\"0\">.</mo>")) }
}

fn indices(subscripts: &[Subscript]) -> String {
    if subscripts.is_empty() {
        return String::new();
    }
    let all: Vec<String> = subscripts
        .iter()
        .map(|s| match s {
            Subscript::All(_) => "<mo>:</mo>".to_owned(),
            Subscript::Expr(e) => write(e, Level::Whole),
        })
        .collect();
    format!("<mo stretchy=\"false\">[</mo>{}<mo stretchy=\"false\">]</mo>", all.join("<mo>,</mo>"))
}

/// A name: its first letter or Greek word large, what follows the first underscore as an index.
pub fn name(text: &str) -> String {
    let (head, index) = match text.split_once('_') {
        Some((head, index)) if !head.is_empty() && !index.is_empty() => (head, Some(index)),
        _ => (text, None),
    };
    match index {
        Some(index) => format!("<msub>{}<mtext>{}</mtext></msub>", letter(head), escape(&index.replace('_', ","))),
        None => letter(head),
    }
}

fn letter(head: &str) -> String {
    if let Some((_, greek)) = GREEK.iter().find(|(word, _)| *word == head) {
        return format!("<mi>{greek}</mi>");
    }
    // `dp`, `drho`: a difference keeps its d.
    if let Some(rest) = head.strip_prefix('d')
        && let Some((_, greek)) = GREEK.iter().find(|(word, _)| *word == rest)
    {
        return format!("<mi>d{greek}</mi>");
    }
    format!("<mi>{}</mi>", escape(head))
}

fn upright(text: &str) -> String {
    format!("<mi mathvariant=\"normal\">{}</mi>", escape(text))
}

#[cfg(test)]
mod tests {
    use super::*;
    use bramah::Sources;

    fn set(text: &str) -> String {
        let mut sources = Sources::default();
        let file = sources.add("e", text);
        expression(&bramah::internals::syntax::parse_expression(file, text).value.expect("an expression"))
    }

    #[test]
    fn brackets_stand_where_the_meaning_needs_them() {
        assert!(!set("a*b + c").contains("(</mo>"));
        assert!(set("a*(b + c)").contains("(</mo>"));
        assert!(set("a - (b - c)").contains("(</mo>"));
        assert!(!set("(a + b)/c").contains("(</mo>"));
        assert!(set("(a + b)^2").contains("(</mo>"));
        assert!(set("(a/b)^2").contains("(</mo>"));
        assert!(set("-(a + b)").contains("(</mo>"));
        assert!(set("not (a and b)").contains("(</mo>"));
    }

    #[test]
    fn names_numbers_and_derivatives() {
        assert_eq!(set("beta_0"), "<mrow><msub><mi>β</mi><mtext>0</mtext></msub></mrow>");
        assert_eq!(set("1e-6"), "<mrow><msup><mn>10</mn><mn>−6</mn></msup></mrow>");
        assert!(set("der(p)").starts_with("<mrow><mfrac>"));
        assert_eq!(set("noEvent(x)"), "<mrow><mi>x</mi></mrow>");
        assert!(set("if x > 0 then 1 else 2").contains("mtable"));
    }
}
