use super::*;
use crate::{BinaryFunction, Exprs, RelationalOp};

fn slot(s: u32) -> SlotExpr {
    SlotExpr::Slot(s)
}

fn num(x: f64) -> SlotExpr {
    SlotExpr::Num(x)
}

fn op(op: BinaryFunction, a: SlotExpr, b: SlotExpr) -> SlotExpr {
    SlotExpr::Binary(op, Box::new(a), Box::new(b))
}

fn rel(rel: RelationalOp, a: SlotExpr, b: SlotExpr) -> SlotExpr {
    SlotExpr::Rel(rel, Box::new(a), Box::new(b))
}

fn function(inputs: u32, slots: u32, output: u32, body: Vec<SlotStatement>) -> Function {
    Function { name: "f".into(), inputs, slots, outputs: vec![output], body }
}

fn value(p: &Exprs, f: FunctionId, args: &[f64]) -> f64 {
    let mut out = [f64::NAN];
    p.functions[f.0 as usize].call(&p.functions, args, &mut out);
    out[0]
}

/// First and second derivatives by every input against differences.
fn check_derivatives(function: Function, others: Vec<Function>, args: &[f64]) {
    let mut p = Exprs { functions: others, ..Exprs::default() };
    let f = p.add_function(function);
    for i in 0..args.len() {
        let input = u32::try_from(i).expect("few inputs");
        let first = p.derivative_function(f, input);
        check_slope(&p, f, first, args, i);
        let second = p.derivative_function(first, input);
        check_slope(&p, first, second, args, i);
    }
}

fn check_slope(p: &Exprs, f: FunctionId, derivative: FunctionId, args: &[f64], input: usize) {
    let h = 1e-5;
    let (mut up, mut down) = (args.to_vec(), args.to_vec());
    up[input] += h;
    down[input] -= h;
    let slope = (value(p, f, &up) - value(p, f, &down)) / (2.0 * h);
    let exact = value(p, derivative, args);
    assert!((slope - exact).abs() < 1e-6 * (1.0 + exact.abs()), "input {input}: {exact} against {slope}");
}

/// `y := 1; for i in 1:3 loop y := y*x + i; end for`
fn horner() -> Function {
    let step = op(BinaryFunction::Add, op(BinaryFunction::Mul, slot(1), slot(0)), slot(2));
    let body = vec![
        SlotStatement::Assign(1, num(1.0)),
        SlotStatement::For {
            slot: 2,
            from: num(1.0),
            step: num(1.0),
            to: num(3.0),
            body: vec![SlotStatement::Assign(1, step)],
        },
    ];
    function(1, 3, 1, body)
}

/// Newton's square root: `while abs(y*y - x) > 1e-12 loop y := (y + x/y)/2`
fn newton() -> Function {
    let error = op(BinaryFunction::Sub, op(BinaryFunction::Mul, slot(1), slot(1)), slot(0));
    let far = rel(RelationalOp::Gt, SlotExpr::Unary(crate::UnaryFunction::Abs, Box::new(error)), num(1e-12));
    let better =
        op(BinaryFunction::Div, op(BinaryFunction::Add, slot(1), op(BinaryFunction::Div, slot(0), slot(1))), num(2.0));
    // Two further turns, so that the tangents have converged too.
    let body = vec![
        SlotStatement::Assign(1, slot(0)),
        SlotStatement::While(far, vec![SlotStatement::Assign(1, better.clone())]),
        SlotStatement::Assign(1, better.clone()),
        SlotStatement::Assign(1, better),
    ];
    function(1, 2, 1, body)
}

/// `y := if n < 0.5 then 1 else x*f(x, n - 1)`, calling itself.
fn recursive(own: FunctionId) -> Function {
    let call = SlotExpr::Call(own, 0, vec![slot(0), op(BinaryFunction::Sub, slot(1), num(1.0))]);
    let y = SlotExpr::If(
        Box::new(rel(RelationalOp::Lt, slot(1), num(0.5))),
        Box::new(num(1.0)),
        Box::new(op(BinaryFunction::Mul, slot(0), call)),
    );
    function(2, 3, 2, vec![SlotStatement::Assign(2, y)])
}

/// Fills `a[3]` with powers of x, sums it up to a break.
fn arrays() -> Function {
    let index = |k: u32| Box::new(op(BinaryFunction::Sub, slot(k), num(1.0)));
    let element = SlotExpr::At { base: 2, len: 3, offset: index(5) };
    let fill = SlotStatement::AssignAt {
        base: 2,
        len: 3,
        offset: *index(5),
        value: op(BinaryFunction::Pow, slot(0), slot(5)),
    };
    let stop = SlotStatement::If(vec![(rel(RelationalOp::Gt, slot(5), num(2.5)), vec![SlotStatement::Break])], vec![]);
    let turn = |body| SlotStatement::For { slot: 5, from: num(1.0), step: num(1.0), to: num(3.0), body };
    let body = vec![
        turn(vec![fill]),
        turn(vec![SlotStatement::Assign(1, op(BinaryFunction::Add, slot(1), element)), stop]),
        SlotStatement::If(
            vec![(rel(RelationalOp::Gt, slot(0), num(0.0)), vec![SlotStatement::Return])],
            vec![SlotStatement::Assign(1, num(0.0))],
        ),
        SlotStatement::Assign(1, num(7.0)),
    ];
    function(1, 6, 1, body)
}

#[test]
fn loops_and_arrays_give_values_and_derivatives() {
    let mut p = Exprs::default();
    let f = p.add_function(horner());
    assert_eq!(value(&p, f, &[2.0]), 8.0 + 4.0 + 4.0 + 3.0);
    check_derivatives(horner(), vec![], &[2.0]);
    let f = p.add_function(arrays());
    assert_eq!(value(&p, f, &[2.0]), 14.0);
    assert_eq!(value(&p, f, &[-2.0]), 7.0);
    check_derivatives(arrays(), vec![], &[2.0]);
    let f = p.add_function(newton());
    assert!((value(&p, f, &[2.0]) - 2f64.sqrt()).abs() < 1e-12);
    check_derivatives(newton(), vec![], &[2.0]);
}

#[test]
fn recursion_and_calls_are_differentiated() {
    let mut p = Exprs::default();
    let f = p.add_function(recursive(FunctionId(0)));
    assert_eq!(value(&p, f, &[2.0, 5.0]), 32.0);
    check_derivatives(recursive(FunctionId(0)), vec![], &[1.5, 3.0]);
    let outer = function(
        2,
        3,
        2,
        vec![
            SlotStatement::Call {
                function: FunctionId(0),
                args: vec![op(BinaryFunction::Mul, slot(0), slot(1))],
                outputs: vec![Some(0)],
            },
            SlotStatement::Assign(2, op(BinaryFunction::Mul, slot(0), slot(1))),
        ],
    );
    check_derivatives(outer, vec![horner()], &[1.2, 0.7]);
}

#[test]
fn expressions_differentiate_through_calls() {
    let mut p = Exprs::default();
    let f = p.add_function(horner());
    let x = p.var(crate::VarId(0));
    let inside = p.mul(x, x);
    let call = p.call(f, 0, &[inside]);
    let slope = p.differentiate(call, x);
    let at = |e, x: f64| p.eval(e, &mut |_| x);
    let difference = (at(call, 1.3 + 1e-6) - at(call, 1.3 - 1e-6)) / 2e-6;
    assert!((at(slope, 1.3) - difference).abs() < 1e-6);
}

#[test]
fn failures_are_named_and_give_nan() {
    let mut p = Exprs::default();
    let endless = function(1, 2, 1, vec![SlotStatement::While(num(1.0), vec![])]);
    let deep = function(1, 2, 1, vec![SlotStatement::Assign(1, SlotExpr::Call(FunctionId(1), 0, vec![slot(0)]))]);
    let outside =
        function(1, 3, 2, vec![SlotStatement::Assign(2, SlotExpr::At { base: 1, len: 2, offset: Box::new(slot(0)) })]);
    let assert =
        function(1, 2, 1, vec![SlotStatement::Assert(rel(RelationalOp::Gt, slot(0), num(5.0)), "too small".into())]);
    for f in [endless, deep, outside, assert] {
        p.add_function(f);
    }
    let fail = |f: usize, x: f64| {
        let mut out = [0.0];
        p.functions[f].try_call(&p.functions, &[x], &mut out).map(|()| out[0]).map_err(|failure| failure.to_string())
    };
    assert_eq!(fail(0, 1.0), Err("`f` did not end within 10000000 steps".into()));
    assert_eq!(fail(1, 1.0), Err("`f` is called more than 200 levels deep".into()));
    assert_eq!(fail(2, 2.0), Err("element 3 of an array of 2 in `f`".into()));
    assert_eq!(fail(2, f64::NAN), Err("element NaN of an array of 2 in `f`".into()));
    assert_eq!(fail(3, 1.0), Err("too small (in `f`)".into()));
    assert!(value(&p, FunctionId(3), &[1.0]).is_nan());
    assert_eq!(fail(3, 6.0), Ok(0.0));
}
