//! Random texts: nothing panics, and what is printed reads back.

use super::good::check_round_trip;
use super::{FILE, messages, read, without_places};
use crate::ast::{BinaryOp, ComponentReference, Expr, ExprKind, Ident, ReferencePart, Subscript, UnaryOp};
use crate::diag::Span;
use crate::parse_expression;
use crate::symbol::Symbol;
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::select;

const WORDS: &[&str] = &[
    "algorithm",
    "and",
    "annotation",
    "block",
    "break",
    "class",
    "connect",
    "connector",
    "constant",
    "constrainedby",
    "der",
    "discrete",
    "each",
    "else",
    "elseif",
    "elsewhen",
    "encapsulated",
    "end",
    "enumeration",
    "equation",
    "expandable",
    "extends",
    "external",
    "false",
    "final",
    "flow",
    "for",
    "function",
    "if",
    "import",
    "impure",
    "in",
    "initial",
    "inner",
    "input",
    "loop",
    "model",
    "not",
    "operator",
    "or",
    "outer",
    "output",
    "package",
    "parameter",
    "partial",
    "protected",
    "public",
    "pure",
    "record",
    "redeclare",
    "replaceable",
    "return",
    "stream",
    "then",
    "true",
    "type",
    "when",
    "while",
    "within",
    "(",
    ")",
    "[",
    "]",
    "{",
    "}",
    ";",
    ";",
    ";",
    ",",
    ".",
    ":",
    ":=",
    "=",
    "==",
    "<>",
    "<",
    "<=",
    ">",
    ">=",
    "+",
    "-",
    "*",
    "/",
    "^",
    ".+",
    ".-",
    ".*",
    "./",
    ".^",
    "&&",
    "||",
    "!",
    "!=",
    "**",
    "a",
    "b",
    "A",
    "B",
    "A",
    "Real",
    "x",
    "'q'",
    "elif",
    "endif",
    "1",
    "2.5",
    "1e400",
    "\"s\"",
    "\"",
    "'",
    "/*",
    "*/",
    "//",
    "#",
    "\u{e4}",
    "\u{2212}",
    "\\",
    "$",
    "end A;",
    "model A",
    "\n",
    "\n",
];

const MODEL: &str = r#"within P.Q;
package A "a"
  import X.*;
  connector Port
    Real p(unit = "Pa");
    flow Real q;
  end Port;
  partial model B
    extends C(redeclare model M = N(x = 1), break d);
    parameter Real x[3] = {1, 2, 3} "x";
    replaceable D d if x[1] > 0 constrainedby E annotation(Placement(visible = true));
  protected
    Real y(start = 1), z;
  initial equation
    y = x[end];
  equation
    connect(a.b, c[1].d) annotation(Line(points = {{0, 0}}));
    if y > 1 and not z < 2 then
      der(y) = -z^2;
    elseif true then
      y = sum(i for i in 1:3);
    else
      y = if a then b else ([1, 2; 3, 4])[1, 1];
    end if;
    for i in 1:3 loop
      when sample(0, 1) then
        reinit(y, pre(y));
      elsewhen b then
        assert(x > 1, "text");
      end when;
    end for;
  algorithm
    while a loop
      (x, , y) := f(a, b = function g(c = 1));
    end while;
    annotation(experiment(StopTime = 3));
  end B;
  type E = enumeration(a, b "c");
end A;
"#;

fn soup() -> impl Strategy<Value = String> {
    vec(select(WORDS), 0..60).prop_map(|words| words.join(" "))
}

/// A good model with some words taken out, doubled or replaced.
fn mutated() -> impl Strategy<Value = String> {
    vec((any::<proptest::sample::Index>(), 0..3_u8, select(WORDS)), 1..6).prop_map(|changes| {
        let mut words: Vec<&str> = MODEL.split_inclusive([' ', '\n', '(', ')', ',', ';']).collect();
        for (index, change, word) in changes {
            let i = index.index(words.len());
            match change {
                0 => drop(words.remove(i)),
                1 => words.insert(i, word),
                _ => words[i] = word,
            }
        }
        words.concat()
    })
}

/// Whatever the text, places lie in it and trees without errors can be printed.
fn check_any(text: &str) {
    let parsed = read(text);
    for diagnostic in &parsed.diagnostics {
        assert!(!diagnostic.message.contains('\n'), "{}", diagnostic.message);
        for label in &diagnostic.labels {
            let (start, end) = (label.span.start as usize, label.span.end as usize);
            assert!(text.get(start..end).is_some(), "{start}..{end} in {text}");
        }
    }
    if parsed.diagnostics.is_empty() {
        check_round_trip(text);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn word_soup_does_no_harm(text in soup()) {
        check_any(&text);
        check_any(&format!("model A equation {text} end A;"));
        check_any(&format!("model A algorithm {text} end A;"));
        let _ = parse_expression(FILE, &text);
    }

    #[test]
    fn mutated_models_do_no_harm(text in mutated()) {
        check_any(&text);
    }

    #[test]
    fn random_characters_do_no_harm(text in ".*") {
        check_any(&text);
    }

    #[test]
    fn cut_models_do_no_harm(at in 0..MODEL.len()) {
        prop_assume!(MODEL.is_char_boundary(at));
        check_any(&MODEL[..at]);
        check_any(&MODEL[at..]);
    }

    #[test]
    fn printed_expressions_read_back(expr in expression()) {
        let text = expr.to_string();
        let read = parse_expression(FILE, &text);
        prop_assert_eq!(&read.diagnostics, &[], "{}", text);
        prop_assert_eq!(without_places(&read.value.expect("no errors")), without_places(&expr), "{}", text);
    }
}

#[test]
fn the_model_that_is_mutated_is_good() {
    assert_eq!(messages(MODEL), "");
}

#[test]
fn one_missing_word_gives_few_errors() {
    let words: Vec<&str> = MODEL.split_inclusive([' ', '\n', '(', ')', ',', ';']).collect();
    let errors = |i: usize| read(&[&words[..i], &words[i + 1..]].concat().concat()).diagnostics.len();
    let counts: Vec<usize> = (0..words.len()).map(errors).collect();
    assert!(counts.iter().all(|&n| n <= 5), "{counts:?}");
    assert!(counts.iter().sum::<usize>() < 2 * words.len(), "{counts:?}");
}

// Random expressions.

const NOWHERE: Span = Span { file: FILE, start: 0, end: 0 };

fn node(kind: ExprKind) -> Expr {
    Expr { kind, span: NOWHERE }
}

fn ident(name: &str) -> Ident {
    Ident { name: Symbol::new(name), span: NOWHERE }
}

fn reference(name: &str, subscripts: Vec<Subscript>) -> ComponentReference {
    ComponentReference { global: false, parts: vec![ReferencePart { name: ident(name), subscripts }], span: NOWHERE }
}

fn leaf() -> impl Strategy<Value = Expr> {
    prop_oneof![
        (0..i64::MAX).prop_map(ExprKind::Integer),
        (0.0..f64::MAX).prop_map(ExprKind::Real),
        any::<bool>().prop_map(ExprKind::Boolean),
        "[ -~\n\t]*".prop_map(|text| ExprKind::String(text.into())),
        select(&["a", "b", "'c d'"][..]).prop_map(|name| ExprKind::Reference(reference(name, Vec::new()))),
    ]
    .prop_map(node)
}

fn unary_op() -> impl Strategy<Value = UnaryOp> {
    use UnaryOp::{ElementMinus, ElementPlus, Minus, Not, Plus};
    select(&[Plus, Minus, ElementPlus, ElementMinus, Not][..])
}

fn binary_op() -> impl Strategy<Value = BinaryOp> {
    use BinaryOp as B;
    select(
        &[
            B::Add,
            B::Sub,
            B::Mul,
            B::Div,
            B::Pow,
            B::ElementAdd,
            B::ElementSub,
            B::ElementMul,
            B::ElementDiv,
            B::ElementPow,
            B::Lt,
            B::Le,
            B::Gt,
            B::Ge,
            B::Eq,
            B::Ne,
            B::And,
            B::Or,
        ][..],
    )
}

fn call(args: Vec<Expr>, value: Expr) -> ExprKind {
    ExprKind::Call { function: reference("f", Vec::new()), args, named: vec![(ident("n"), value)] }
}

fn expression() -> impl Strategy<Value = Expr> {
    leaf().prop_recursive(6, 60, 4, |inner| {
        let boxed = || inner.clone().prop_map(Box::new);
        prop_oneof![
            (unary_op(), boxed()).prop_map(|(op, a)| ExprKind::Unary(op, a)),
            (binary_op(), boxed(), boxed()).prop_map(|(op, a, b)| ExprKind::Binary(op, a, b)),
            (binary_op(), boxed(), boxed()).prop_map(|(op, a, b)| ExprKind::Binary(op, a, b)),
            (vec((inner.clone(), inner.clone()), 1..3), boxed())
                .prop_map(|(branches, otherwise)| ExprKind::If { branches, otherwise }),
            (boxed(), proptest::option::of(boxed()), boxed()).prop_map(|(from, step, to)| ExprKind::Range {
                from,
                step,
                to
            }),
            (vec(inner.clone(), 0..3), inner.clone()).prop_map(|(args, value)| call(args, value)),
            vec(inner.clone(), 1..4).prop_map(ExprKind::Array),
            vec(vec(inner.clone(), 1..3), 1..3).prop_map(ExprKind::Matrix),
            vec(proptest::option::of(inner.clone()), 2..4).prop_map(ExprKind::Tuple),
            (boxed(), inner.clone()).prop_map(|(a, i)| ExprKind::Index(a, vec![Subscript::Expr(i)])),
            inner.clone().prop_map(|i| ExprKind::Reference(reference("x", vec![Subscript::Expr(i)]))),
        ]
        .prop_map(node)
    })
}
