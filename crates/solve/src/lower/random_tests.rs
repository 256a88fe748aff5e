//! Random systems: machine code equals the interpreter to the bit, both equal the reference evaluation, and the
//! Jacobian equals finite differences.

use super::tests::{Model, check_jacobian, point, values_of};
use super::*;
use approx::relative_eq;
use bramah_expr::function::{Function, SlotExpr, SlotStatement};
use bramah_expr::{BinaryFunction, Exprs, FunctionId, RelationalOp, UnaryFunction};
use bramah_model::structure::BltBlock;
use proptest::prelude::*;

/// One step of building an expression on a stack of known ones.
#[derive(Clone, Debug)]
enum Make {
    Unary(u8, usize),
    Binary(u8, usize, usize),
    If(u8, usize, usize, usize, usize),
    Number(f64),
    Call(usize, usize, u32),
}

fn make() -> impl Strategy<Value = Make> {
    let any = || any::<prop::sample::Index>().prop_map(|i| i.index(1 << 16));
    prop_oneof![
        3 => (0u8..18, any()).prop_map(|(op, a)| Make::Unary(op, a)),
        6 => (0u8..10, any(), any()).prop_map(|(op, a, b)| Make::Binary(op, a, b)),
        2 => (0u8..6, any(), any(), any(), any()).prop_map(|(r, a, b, c, d)| Make::If(r, a, b, c, d)),
        1 => prop_oneof![Just(0.5), Just(2.0), Just(-3.0), Just(0.25), -9.0..9.0].prop_map(Make::Number),
        1 => (any(), any(), 0u32..2).prop_map(|(a, b, output)| Make::Call(a, b, output)),
    ]
}

const BINARY: [BinaryFunction; 10] = [
    BinaryFunction::Add,
    BinaryFunction::Sub,
    BinaryFunction::Mul,
    BinaryFunction::Div,
    BinaryFunction::Pow,
    BinaryFunction::Atan2,
    BinaryFunction::Min,
    BinaryFunction::Max,
    BinaryFunction::And,
    BinaryFunction::Or,
];

const RELATIONS: [RelationalOp; 6] =
    [RelationalOp::Lt, RelationalOp::Le, RelationalOp::Gt, RelationalOp::Ge, RelationalOp::Eq, RelationalOp::Ne];

/// `(a, b) -> (a*b, if a > b then a else b)`
fn function() -> Function {
    let slot = |i| Box::new(SlotExpr::Slot(i));
    let larger = SlotExpr::If(Box::new(SlotExpr::Rel(RelationalOp::Gt, slot(0), slot(1))), slot(0), slot(1));
    Function {
        name: "both".into(),
        inputs: 2,
        slots: 4,
        outputs: vec![2, 3],
        body: vec![
            SlotStatement::Assign(2, SlotExpr::Binary(BinaryFunction::Mul, slot(0), slot(1))),
            SlotStatement::Assign(3, larger),
        ],
    }
}

/// Four states, two parameters, and a chain of variables between which expressions are cut.
fn system(steps: &[Make], smooth: bool, copies: usize) -> Model {
    let mut m = Model::default();
    m.dae.exprs.functions.push(function());
    let (one, two) = (m.number(1.5), m.number(2.0));
    let (a, b) = (m.parameter("a", one), m.parameter("b", two));
    for copy in 0..copies {
        add_copy(&mut m, copy, steps, smooth, &[a, b]);
    }
    m
}

fn add_copy(m: &mut Model, copy: usize, steps: &[Make], smooth: bool, parameters: &[ExprId]) {
    let states: Vec<_> = (0..4).map(|i| m.state(&format!("x[{copy},{i}]"))).collect();
    let mut known: Vec<ExprId> = parameters.to_vec();
    known.extend(states.iter().map(|s| s.1));
    known.push(m.dae.exprs.time());
    for (i, step) in steps.iter().enumerate() {
        let e = if smooth { smooth_step(m, step, &known) } else { any_step(m, step, &known) };
        if i % 3 == 1 {
            let (v, ev) = m.continuous(&format!("v[{copy},{i}]"));
            m.explicit(Unknown::Var(v), e);
            known.push(ev);
        } else {
            known.push(e);
        }
    }
    for (k, &(x, _)) in states.iter().enumerate() {
        let rate = known[known.len() - 1 - k];
        m.explicit(Unknown::Der(x), rate);
    }
}

fn any_step(m: &mut Model, step: &Make, known: &[ExprId]) -> ExprId {
    let of = |i: usize| known[i % known.len()];
    let e = &mut m.dae.exprs;
    match *step {
        // Only truth values are negated and joined, as the type check sees to.
        Make::Unary(1, a) => {
            let truth = e.rel(RelationalOp::Ge, of(a), Exprs::ONE);
            e.not(truth)
        }
        Make::Binary(op @ 8.., a, b) => {
            let (left, right) = (e.rel(RelationalOp::Lt, of(a), of(b)), e.rel(RelationalOp::Ne, of(a), Exprs::ONE));
            e.binary(BINARY[op as usize], left, right)
        }
        Make::Unary(op, a) => e.unary(UnaryFunction::ALL[op as usize], of(a)),
        Make::Binary(op, a, b) => e.binary(BINARY[op as usize], of(a), of(b)),
        Make::If(rel, a, b, c, d) => {
            let condition = e.rel(RELATIONS[rel as usize], of(a), of(b));
            e.if_(condition, of(c), of(d))
        }
        Make::Number(value) => e.num(value),
        Make::Call(a, b, output) => e.call(FunctionId(0), output, &[of(a), of(b)]),
    }
}

/// Operations without kinks whose values stay near 1.
fn smooth_step(m: &mut Model, step: &Make, known: &[ExprId]) -> ExprId {
    let of = |i: usize| known[i % known.len()];
    let e = &mut m.dae.exprs;
    match *step {
        Make::Unary(op, a) => {
            let op =
                [UnaryFunction::Sin, UnaryFunction::Cos, UnaryFunction::Tanh, UnaryFunction::Neg, UnaryFunction::Atan]
                    [op as usize % 5];
            e.unary(op, of(a))
        }
        Make::Binary(op, a, b) if op % 3 == 0 => {
            let square = e.square(of(b));
            let two = e.num(2.0);
            let sum = e.add(square, two);
            let root = e.sqrt(sum);
            e.div(of(a), root)
        }
        Make::Binary(op, a, b) => {
            let value = e.binary(
                [BinaryFunction::Add, BinaryFunction::Mul, BinaryFunction::Sub][op as usize % 3],
                of(a),
                of(b),
            );
            e.unary(UnaryFunction::Tanh, value)
        }
        Make::If(_, a, b, ..) => {
            let time = e.time();
            let early = e.rel(RelationalOp::Lt, time, Exprs::ONE);
            let sine = e.unary(UnaryFunction::Sin, of(a));
            let product = e.mul(sine, of(b));
            e.if_(early, product, of(b))
        }
        Make::Number(value) => e.num(value),
        Make::Call(a, b, _) => {
            let product = e.call(FunctionId(0), 0, &[of(a), of(b)]);
            e.unary(UnaryFunction::Sin, product)
        }
    }
}

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|v| if v.is_nan() { 1 } else { v.to_bits() }).collect()
}

/// Whether an expression and all its parts have finite values.
fn is_of_numbers(system: &ExecutableSystem, e: ExprId, values: &[f64]) -> bool {
    let parts = system.dae.exprs.reachable(&[e], |_| true);
    parts.into_iter().all(|e| system.eval(e, values).is_finite())
}

fn points() -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(prop_oneof![6 => -3.0..3.0, 1 => Just(0.0), 1 => Just(-0.0), 1 => Just(1.0)], 4)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn machine_code_is_the_interpreter(
        steps in prop::collection::vec(make(), 1..60),
        y in points(),
        copies in prop_oneof![Just(1usize), Just(12)],
    ) {
        let y: Vec<f64> = y.iter().copied().cycle().take(4 * copies).collect();
        let run = |native: bool| {
            let system = system(&steps, false, copies).lower(native);
            let mut values = values_of(&system);
            let p = point(&system, &mut values, &y, &y, 3.0);
            (bits(&p.residual), bits(&p.jacobian))
        };
        prop_assert_eq!(run(true), run(false));
    }

    #[test]
    fn observed_values_are_those_of_the_reference(steps in prop::collection::vec(make(), 1..60), y in points()) {
        let system = system(&steps, false, 1).lower(true);
        let mut values = values_of(&system);
        system.observe(0.3, &y, &y, &mut values);
        for block in &system.dae.continuous {
            let BltBlock::Assign(assign) = block else { panic!("only assignments") };
            let (got, expected) = (values[system.layout.unknown(assign.unknown)], system.eval(assign.value, &values));
            // Simplification takes `0*x` for 0 and `x >= x` for true whatever `x` is, and does not keep the sign of a
            // zero that something is divided by, so values that come from such as are not finite may differ.
            if is_of_numbers(&system, assign.value, &values) {
                prop_assert!(relative_eq!(got, expected, max_relative = 1e-12), "{got} {expected}");
            }
        }
    }

    #[test]
    fn the_jacobian_is_the_derivative(steps in prop::collection::vec(make(), 1..60), y in points()) {
        let system = system(&steps, true, 1).lower(true);
        let mut values = values_of(&system);
        check_jacobian(&system, &mut values, &y, &y, 2.0);
    }
}
