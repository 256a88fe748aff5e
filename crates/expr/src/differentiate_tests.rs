use super::*;
use approx::relative_eq;
use proptest::prelude::*;

/// An expression before it is simplified.
#[derive(Clone, Debug)]
enum Tree {
    Num(f64),
    Var(u32),
    Unary(UnaryFunction, Box<Tree>),
    Binary(BinaryFunction, Box<Tree>, Box<Tree>),
    If(RelationalOp, Box<Tree>, Box<Tree>, Box<Tree>),
}

const UNARY: [UnaryFunction; 12] = [
    UnaryFunction::Neg,
    UnaryFunction::Abs,
    UnaryFunction::Sign,
    UnaryFunction::Sqrt,
    UnaryFunction::Exp,
    UnaryFunction::Log,
    UnaryFunction::Sin,
    UnaryFunction::Cos,
    UnaryFunction::Atan,
    UnaryFunction::Tanh,
    UnaryFunction::Asin,
    UnaryFunction::Cosh,
];
const BINARY: [BinaryFunction; 8] = [
    BinaryFunction::Add,
    BinaryFunction::Sub,
    BinaryFunction::Mul,
    BinaryFunction::Div,
    BinaryFunction::Pow,
    BinaryFunction::Atan2,
    BinaryFunction::Min,
    BinaryFunction::Max,
];

fn tree() -> impl Strategy<Value = Tree> {
    let numbers = prop::sample::select(vec![0.0, 1.0, -1.0, 2.0, 0.5, -3.0, 0.25, 1.7]);
    let leaf = prop_oneof![numbers.prop_map(Tree::Num), (0..3u32).prop_map(Tree::Var), (0..3u32).prop_map(Tree::Var)];
    leaf.prop_recursive(5, 40, 3, |inner| {
        let boxed = || inner.clone().prop_map(Box::new);
        prop_oneof![
            (prop::sample::select(UNARY.to_vec()), boxed()).prop_map(|(op, a)| Tree::Unary(op, a)),
            (prop::sample::select(BINARY.to_vec()), boxed(), boxed()).prop_map(|(op, a, b)| Tree::Binary(op, a, b)),
            (boxed(), boxed(), boxed()).prop_map(|(a, b, c)| Tree::If(RelationalOp::Lt, a, b, c)),
        ]
    })
}

fn build(p: &mut Exprs, tree: &Tree) -> ExprId {
    match tree {
        Tree::Num(x) => p.num(*x),
        Tree::Var(v) => p.var(VarId(*v)),
        Tree::Unary(op, a) => {
            let a = build(p, a);
            p.unary(*op, a)
        }
        Tree::Binary(op, a, b) => {
            let (a, b) = (build(p, a), build(p, b));
            p.binary(*op, a, b)
        }
        Tree::If(rel, a, b, c) => {
            let (a, b, c) = (build(p, a), build(p, b), build(p, c));
            let holds = p.event_rel(*rel, a, b);
            p.if_(holds, b, c)
        }
    }
}

/// The value without simplification, NaN when any part is not finite.
fn value(tree: &Tree, x: &[f64]) -> f64 {
    use crate::math;
    let value = match tree {
        Tree::Num(x) => *x,
        Tree::Var(v) => x[*v as usize],
        Tree::Unary(op, a) => math::unary(*op, value(a, x)),
        Tree::Binary(op, a, b) => math::binary(*op, value(a, x), value(b, x)),
        Tree::If(rel, a, b, c) => {
            let (a, b, c) = (value(a, x), value(b, x), value(c, x));
            let taken = if math::holds(*rel, a, b) { b } else { c };
            if (a + b + c).is_nan() { f64::NAN } else { taken }
        }
    };
    // The sign of a zero is not kept, and the angle of a point shows it.
    let cut = matches!(tree, Tree::Binary(BinaryFunction::Atan2, ..)) && value.abs() > 3.1;
    if value.is_finite() && !cut { value } else { f64::NAN }
}

fn at(p: &Exprs, e: ExprId, x: &[f64]) -> f64 {
    p.eval(e, &mut |node| match node {
        ExprNode::Var(v) => x[v.index()],
        _ => f64::NAN,
    })
}

fn close(a: f64, b: f64, tolerance: f64) -> bool {
    relative_eq!(a, b, epsilon = tolerance, max_relative = tolerance)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn simplification_keeps_the_value(tree in tree(), x in prop::array::uniform3(-3.0..3.0f64)) {
        let mut p = Exprs::default();
        let e = build(&mut p, &tree);
        let expected = value(&tree, &x);
        // Where the original has no value (0/0, log(-1)), a cancelled one may have one.
        prop_assume!(expected.is_finite());
        prop_assert_eq!(at(&p, e, &x), expected);
    }

    #[test]
    fn derivatives_match_finite_differences(tree in tree(), x in prop::array::uniform3(-3.0..3.0f64)) {
        let mut p = Exprs::default();
        let e = build(&mut p, &tree);
        let leaf = p.var(VarId(0));
        let derivative = p.differentiate(e, leaf);
        let slope = |h: f64| {
            let (mut up, mut down) = (x, x);
            up[0] += h;
            down[0] -= h;
            (at(&p, e, &up) - at(&p, e, &down)) / (2.0 * h)
        };
        let (coarse, fine) = (slope(1e-4), slope(1e-5));
        // Kinks, steps and steep places: the differences themselves do not converge.
        prop_assume!(fine.is_finite() && fine.abs() < 1e4 && close(coarse, fine, 1e-6));
        prop_assume!(at(&p, e, &x).abs() < 1e4);
        let exact = at(&p, derivative, &x);
        prop_assume!(exact.is_finite());
        prop_assert!(close(exact, fine, 1e-4), "{} against {}", exact, fine);
    }

    #[test]
    fn printed_text_reads_back_the_same(tree in tree()) {
        let mut p = Exprs::default();
        let e = build(&mut p, &tree);
        let text = p.print(e, &|v| format!("x{}", v.0));
        let find = |name: &str| VarId(name[1..].parse().expect("a number"));
        let again = crate::from_text::read(&mut p, &text, &find);
        prop_assert_eq!(again, e, "{}", text);
    }

    #[test]
    fn affine_parts_rebuild_the_expression(tree in tree(), x in prop::array::uniform3(-3.0..3.0f64)) {
        let mut p = Exprs::default();
        let e = build(&mut p, &tree);
        let leaf = p.var(VarId(0));
        if let Some(affine) = p.linear_in(e, leaf) {
            prop_assert!(!p.contains(affine.coefficient, leaf) && !p.contains(affine.rest, leaf));
            let (c, r) = (at(&p, affine.coefficient, &x), at(&p, affine.rest, &x));
            let whole = at(&p, e, &x);
            prop_assume!(whole.is_finite() && c.is_finite() && r.is_finite() && c.abs() < 1e6 && r.abs() < 1e6);
            prop_assert!(close(c * x[0] + r, whole, 1e-9));
        }
    }
}

#[test]
fn powers_are_safe_at_zero() {
    let mut p = Exprs::default();
    let (x, two) = (p.var(VarId(0)), p.num(2.0));
    let square = p.pow(x, two);
    let slope = p.differentiate(square, x);
    assert_eq!(at(&p, slope, &[0.0]), 0.0);
    let doubled = p.mul(two, x);
    assert_eq!(slope, doubled);
    let y = p.var(VarId(1));
    let power = p.pow(x, y);
    let by_exponent = p.differentiate(power, y);
    assert_eq!(at(&p, by_exponent, &[0.0, 2.0]), 0.0);
}

#[test]
fn time_derivatives_ask_for_leaves() {
    let mut p = Exprs::default();
    let (x, k, t) = (p.var(VarId(0)), p.var(VarId(1)), p.time());
    let product = p.mul(k, x);
    let sum = p.add(product, t);
    let mut leaf = |p: &mut Exprs, leaf: DerivativeLeaf| match leaf {
        DerivativeLeaf::Var(VarId(0)) => Some(p.der(VarId(0))),
        DerivativeLeaf::Var(_) => Some(Exprs::ZERO),
        DerivativeLeaf::Der(_) => None,
    };
    let first = p.time_derivative(sum, &mut leaf).expect("differentiable");
    let dx = p.der(VarId(0));
    let slope = p.mul(k, dx);
    let expected = p.add(slope, Exprs::ONE);
    assert_eq!(first, expected);
    assert_eq!(p.time_derivative(first, &mut leaf), Err(DerivativeLeaf::Der(VarId(0))));
}

#[test]
fn long_sums_differentiate_without_recursion() {
    let mut p = Exprs::default();
    let x = p.var(VarId(0));
    let mut sum = Exprs::ZERO;
    for i in 1..50_000 {
        let y = p.var(VarId(i));
        let term = p.mul(x, y);
        sum = p.add(sum, term);
    }
    let slope = p.differentiate(sum, x);
    assert_eq!(p.variables(slope).len(), 49_999);
}
