//! Texts that are Modelica: no message, and printing gives the same tree again.

use super::{FILE, messages, read, without_places};
use crate::ast::{ClassBody, ElementKind, Equation, EquationKind, Expr, ExprKind, LongBody, Subscript};
use crate::{parse_expression, parse_path, parse_reference};

/// Checks that the printed tree reads back as the same tree.
pub fn check_round_trip(text: &str) {
    let tree = read(text).tree;
    let printed = tree.to_string();
    assert_eq!(messages(&printed), "", "printed:\n{printed}");
    assert_eq!(without_places(&read(&printed).tree), without_places(&tree), "printed:\n{printed}");
}

fn expression(text: &str) -> Expr {
    let checked = parse_expression(FILE, text);
    assert_eq!(checked.diagnostics, [], "{text}");
    checked.value.expect("an expression without errors")
}

/// The expression with all brackets written.
fn structure(text: &str) -> String {
    fn show(expr: &Expr) -> String {
        match &expr.kind {
            ExprKind::Unary(op, a) => format!("({op:?} {})", show(a)),
            ExprKind::Binary(op, a, b) => format!("({op:?} {} {})", show(a), show(b)),
            _ => expr.to_string(),
        }
    }
    show(&expression(text))
}

/// The body of the first class.
fn body(text: &str) -> LongBody {
    assert_eq!(messages(text), "", "{text}");
    match read(text).tree.classes.swap_remove(0).body {
        ClassBody::Long(body) => body,
        other => panic!("{other:?} is not a long class"),
    }
}

fn equations(text: &str) -> Vec<Equation> {
    body(&format!("model A equation {text} end A;")).equations
}

const CLASSES: &[&str] = &[
    "",
    "within;",
    "within A.B; final model C end C; package D end D;",
    "\u{feff}model A end A;",
    "class A end A; model B end B; block C end C; record D end D; connector E end E; package F end F; type G end G;",
    "function f end f; operator o end o; operator function g end g; operator record r end r;",
    "pure function f end f; impure function g end g; pure operator function h end h;",
    "expandable connector E end E; encapsulated partial model M end M;",
    "model A \"a\" + \" description\" end A;",
    "model 'a b' end 'a b'; model 'it\\'s' end 'it\\'s'; model '+' end '+';",
    "type A = Real; type B = input Real[3](unit = \"m\") \"text\" annotation(x = 1); connector C = flow Real;",
    "type E = enumeration(a, b \"text\", c annotation(x = 1)); type F = enumeration(:); type G = enumeration();",
    "function f = der(g, x, y) \"text\";",
    "model A model extends B(x = 1) \"text\" Real y; end B; redeclare replaceable model extends C end C; end A;",
    "model A package P model B end B; end P; protected model C = D; public type T = Real; end A;",
    "model A replaceable model M = N constrainedby P(x = 1) \"text\"; end A;",
    "model A replaceable model M end M constrainedby P; inner replaceable package Medium = Water; end A;",
    "model A operator 'constructor' function f end f; end 'constructor'; end A;",
    "model A annotation(Icon(graphics = {Line(points = {{-1, 0}, {1, 0}})}), experiment(StopTime = 3)); end A;",
    "function f external; end f; function g external \"C\" y = g_c(x, size(x, 1)) annotation(Library = \"m\"); end g;",
    "function f external \"C\" f_c(); annotation(Include = \"x\"); end f;",
    "model A initial equation x = 1; equation y = 2; initial algorithm z := 3; algorithm w := 4; equation v = 5; end A;",
    "/* a */ model A // b\n/* c\n d */ end A; // e",
];

const ELEMENTS: &[&str] = &[
    "import A; import A.B; import C = A.B; import A.*; import A.{b, c}; import A.B \"text\";",
    "import .A.B;",
    "extends A; extends B(x = 1, redeclare model M = N) annotation(x = 1); extends .C;",
    "extends A(break b, break connect(c.p, d[1].n), x = 2);",
    "Real x; Real y, z; Real a \"a\", b \"b\";",
    "Real x[3], y[:, 2]; Real[3] z; Real[3] w[2]; .A.B[n] c(x = 1);",
    "parameter Real x = 1; constant Integer n = 2 + 3; discrete Boolean b; flow Real q; stream Real h;",
    "input Real u; output Real y; discrete input Real v; parameter output Real p; flow input Real w;",
    "final parameter Real x = 1; inner A a; outer A b; inner outer A c; redeclare final inner replaceable A d;",
    "Real x(start = 1, fixed = true, each nominal = 2, final min = 0, each final max = 1) = 3;",
    "A a(b(c(d = 1)), e.f = 2, g.h(i = 3) \"text\"); A b(); A c(x \"text\") if false;",
    "A a(redeclare B b, redeclare model M = N(x = 1), replaceable C c = 3 constrainedby D, redeclare each E e);",
    "A a(redeclare each final replaceable B b \"text\" constrainedby C(x = 1));",
    "A a(redeclare replaceable package P = Q constrainedby R, redeclare function f = g(x = 1));",
    "A a(x = break, y(start = 1) = break);",
    "A a if n > 1 and b \"text\" annotation(Placement(transformation(extent = {{-1, -1}, {1, 1}})));",
    "replaceable A a constrainedby B annotation(x = 1); replaceable package P = Q constrainedby R annotation(x = 1);",
    "replaceable A a(x = 1) if c \"text\" constrainedby B(y = 2) \"more\"; replaceable A b, c constrainedby B;",
    "Real x := 1; String s = \"a\\\"b\\\\c\\n\\t\" + \"\u{e4}\";",
    "Real x = if a then 1 elseif b then 2 else 3; Real y[3] = 1:3; Real z = (if a then 1 else 2) + 3;",
    "public Real x; protected Real y; protected Real z; public Real w;",
];

const EQUATIONS: &[&str] = &[
    "x = 1; der(x) = -x \"text\"; 0 = a + b annotation(x = 1); (a, , b) = f(x); {a, b} = c; a:b = 1:2;",
    "connect(a, b); connect(a.b[1].c, d[i + 1]) annotation(Line(points = {{0, 0}, {1, 1}}));",
    "if a then x = 1; elseif b then x = 2; else x = 3; end if; if c then end if;",
    "if a then else if b then x = 1; end if; end if \"text\";",
    "for i in 1:n loop x[i] = i; end for; for i, j in 1:2, k loop x[i, j] = 1; end for;",
    "when a then x = 1; elsewhen {b, c} then reinit(x, 2); end when;",
    "assert(x > 0, \"text\", AssertionLevel.warning); terminate(\"end\"); Connections.root(a.b);",
    "x = a == b; a == b = c; y = a <> b; (a == b) = c; if a == b then x = y == z; end if;",
    "x[end] = y[end - 1]; x[:, 1:end] = y[f(end)];",
    "y = f(x, a = 1, b = function g(c = 2)); y = f(function .h.g(), 1); y = f(); y = f(function g(a = 1), b = 2);",
    "y = {i for i in 1:3}; y = sum(x[i, j] for i in 1:n, j); y = {{1, 2}, {3, 4}}; y = [1, 2; 3, 4]; y = [x];",
    "b = initial() or not terminal() and pre(c); z = pure(f(1)); initial();",
    "y = .A.B.c(.d.e[1]); y = (a + b)[2]; y = 1.; y = 1.5e-3; y = .5; y = 2.E+4; y = 9223372036854775808;",
    "y = 1.*x; y = 1 .* x; y = a .+ b .- c .* d ./ e .^ f; y = .-a; y = 2 .^ x;",
    "y = -a^2; y = -a * b; y = -a + b; y = a - (-b); y = a * (-b); y = 2^(-1); y = (a^b)^c; y = (-a)^2;",
    "y = a < -b; y = not a == b; y = not (not a); y = (a < b) == c; y = 1:-1:-3; x = (1:3) * 2;",
    "y = a - (b - c); y = a / (b * c); y = a * b / c; y = (a or b) and c; y = not (a and b);",
];

const STATEMENTS: &[&str] = &[
    "x := 1; x[1].y := 2 \"text\"; (a, , b) := f(x); (a) := f(x); () := f(); f(x); assert(a, \"b\");",
    "if a then x := 1; elseif b then x := 2; else x := 3; end if; for i in 1:n loop break; end for;",
    "while a loop x := x + 1; if b then return; end if; end while; when a then x := 1; elsewhen b then x := 2; end when;",
];

#[test]
fn good_texts_are_read_and_printed() {
    let within = |before: &str, text: &str, after: &str| format!("{before}{text}{after}");
    let classes = CLASSES.iter().map(|text| within("", text, ""));
    let elements = ELEMENTS.iter().map(|text| within("model A ", text, " end A;"));
    let equations = EQUATIONS.iter().map(|text| within("model A equation ", text, " end A;"));
    let statements = STATEMENTS.iter().map(|text| within("model A algorithm ", text, " end A;"));
    for text in classes.chain(elements).chain(equations).chain(statements) {
        assert_eq!(messages(&text), "", "{text}");
        check_round_trip(&text);
    }
}

#[test]
fn operators_bind_as_the_specification_says() {
    let cases = [
        ("-a^2", "(Minus (Pow a 2))"),
        ("-a * b", "(Minus (Mul a b))"),
        ("-a + b", "(Add (Minus a) b)"),
        ("a - b - c", "(Sub (Sub a b) c)"),
        ("a / b * c", "(Mul (Div a b) c)"),
        ("a + b * c ^ d", "(Add a (Mul b (Pow c d)))"),
        ("not a == b and c or d", "(Or (And (Not (Eq a b)) c) d)"),
        ("a < -b + c", "(Lt a (Add (Minus b) c))"),
        ("a .+ b .* c .^ d", "(ElementAdd a (ElementMul b (ElementPow c d)))"),
        ("1.*x", "(Mul 1.0 x)"),
        ("(a + b) * c", "(Mul (Add a b) c)"),
        ("a or b and c", "(Or a (And b c))"),
    ];
    for (text, expected) in cases {
        assert_eq!(structure(text), expected, "{text}");
    }
}

#[test]
fn numbers_have_their_values() {
    let real = |text: &str| match expression(text).kind {
        ExprKind::Real(value) => value,
        other => panic!("{text} gives {other:?}"),
    };
    for (text, value) in [("1.", 1.0_f64), (".5", 0.5), ("1e5", 1e5), ("1.5E-3", 1.5e-3), ("2.e+2", 200.0)] {
        assert_eq!(real(text).to_bits(), value.to_bits(), "{text}");
    }
    assert!(matches!(expression("9223372036854775807").kind, ExprKind::Integer(i64::MAX)));
    assert_eq!(real("9223372036854775808").to_bits(), 9_223_372_036_854_775_808.0_f64.to_bits());
    assert_eq!(real("1e-400").to_bits(), 0.0_f64.to_bits());
}

#[test]
fn strings_are_resolved() {
    let cases = [
        (r#""a\"b\\c\nd\te""#, "a\"b\\c\nd\te"),
        (r#""\a\b\f\v\?\'""#, "\u{7}\u{8}\u{c}\u{b}?'"),
        ("\"two\nlines\"", "two\nlines"),
        ("\"\"", ""),
    ];
    for (text, expected) in cases {
        match expression(text).kind {
            ExprKind::String(value) => assert_eq!(&*value, expected),
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn subscripts_of_the_type_follow_those_of_the_name() {
    let body = body("model A Real[3, 4] x[2], y; end A;");
    let sizes: Vec<Vec<String>> = body
        .elements
        .iter()
        .map(|element| match &element.kind {
            ElementKind::Component(component) => component.subscripts.iter().map(size).collect(),
            other => panic!("{other:?}"),
        })
        .collect();
    assert_eq!(sizes, [vec!["2", "3", "4"], vec!["3", "4"]]);
}

fn size(subscript: &Subscript) -> String {
    match subscript {
        Subscript::All(_) => ":".to_owned(),
        Subscript::Expr(expr) => expr.to_string(),
    }
}

#[test]
fn places_are_exact() {
    let text = "model A\n  parameter Real x = 1 \"text\", y;\nequation\n  (a + b) * c = f(2) \"text\";\nend A;";
    let words = |span: crate::diag::Span| &text[span.start as usize..span.end as usize];
    let class = read(text).tree.classes.swap_remove(0);
    assert_eq!(words(class.span), &text[..text.len() - 1]);
    let ClassBody::Long(body) = class.body else { panic!("a long class") };
    assert_eq!(words(body.elements[0].span), "parameter Real x = 1 \"text\"");
    assert_eq!(words(body.elements[1].span), "y");
    assert_eq!(words(body.equations[0].span), "(a + b) * c = f(2)");
    let EquationKind::Equal(left, right) = &body.equations[0].kind else { panic!("an equation") };
    assert_eq!((words(left.span), words(right.span)), ("(a + b) * c", "f(2)"));
}

#[test]
fn kinds_of_equations_are_told_apart() {
    let kinds = equations("a = b; f(x); connect(a, b); if a then end if; for i loop end for; when a then end when;");
    assert!(matches!(kinds[0].kind, EquationKind::Equal(..)));
    assert!(matches!(kinds[1].kind, EquationKind::Call(_)));
    assert!(matches!(kinds[2].kind, EquationKind::Connect(..)));
    assert!(matches!(kinds[3].kind, EquationKind::If { .. }));
    assert!(matches!(kinds[4].kind, EquationKind::For { .. }));
    assert!(matches!(kinds[5].kind, EquationKind::When(_)));
}

#[test]
fn names_alone_are_read() {
    assert_eq!(parse_path(FILE, "A.'b c'.d").map(|path| path.to_string()).as_deref(), Some("A.'b c'.d"));
    assert_eq!(parse_path(FILE, ".A.b").map(|path| path.global), Some(true));
    assert_eq!(parse_reference(FILE, "a[2].b[1, :]").map(|path| path.to_string()).as_deref(), Some("a[2].b[1, :]"));
    for text in ["", "a.", "a b", "1", "a[1]", "model", "a..b", "a\0"] {
        assert!(parse_path(FILE, text).is_none(), "{text}");
    }
    for text in ["", "a[", "a[1", "a+b", "a.b c"] {
        assert!(parse_reference(FILE, text).is_none(), "{text}");
    }
}

#[test]
fn expressions_alone_are_read() {
    for text in ["1", "{1, 2}", "-3.5e4", "true", "\"a\"", "Kind.fast", "if a then 1 else 2", "1:3"] {
        assert_eq!(expression(text).to_string(), text.replace("3.5e4", "35000.0"));
    }
    for text in ["", "1 2", "a +", "(", "0.8 ml", "\0"] {
        assert!(parse_expression(FILE, text).value.is_none(), "{text}");
    }
}
