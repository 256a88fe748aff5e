//! Smooth problems with known solutions.

use super::*;
use crate::{End, State};
use bramah_expr::UnaryFunction;

fn decay() -> ExecutableSystem {
    let mut m = Make::default();
    let (x, e) = m.state("x", 1.0);
    let rate = m.parameter("rate", 1.0);
    let product = m.e().mul(rate, e);
    let value = m.e().neg(product);
    m.assign(Unknown::Der(x), value);
    m.system()
}

#[test]
fn exponential_decay_on_the_grid() {
    let system = decay();
    let (run, t) = run(&system, Settings { stop_time: 2.0, interval: 0.3, ..Settings::default() }, &[]);
    assert_eq!(run.end, End::Reached, "{:?}", run.diagnostics);
    assert_eq!(t.times, [0.0, 0.3, 0.6, 0.9, 1.2, 1.5, 1.8, 2.0]);
    for (time, x) in t.times.iter().zip(t.column("x").expect("recorded")) {
        assert!((x - (-time).exp()).abs() < 1e-5, "{time} {x}");
    }
    assert_eq!((run.statistics.unknowns, run.statistics.states), (1, 1));
}

#[test]
fn error_follows_the_tolerance_over_four_decades() {
    let system = decay();
    let error = |tolerance| {
        let (_, t) = run(&system, Settings { tolerance, stop_time: 3.0, ..Settings::default() }, &[]);
        (last(&t, "x") - (-3.0_f64).exp()).abs()
    };
    let errors = [1e-4, 1e-6, 1e-8].map(error);
    assert!(errors[0] < 1e-3 && errors[1] < errors[0] / 10.0 && errors[2] < errors[1] / 10.0, "{errors:?}");
}

#[test]
fn parameters_change_without_lowering_again() {
    let system = decay();
    let parameters = vec![(VarId(1), 2.0)];
    let (_, t) = run(&system, Settings { parameters, ..Settings::default() }, &[]);
    assert!((last(&t, "x") - (-2.0_f64).exp()).abs() < 1e-5);
}

#[test]
fn goes_on_from_a_saved_state() {
    let system = decay();
    let (half, _) = run(&system, Settings { stop_time: 0.5, ..Settings::default() }, &[]);
    let settings = Settings { wanted: vec![VarId(0)], ..Settings::default() };
    let mut t = Trajectory::new(signals(&system.dae, &settings.wanted));
    let state: State = half.state;
    let run = simulate(&system, &settings, &[], Some(&state), &mut t, &mut Control::default());
    assert_eq!(run.end, End::Reached);
    assert_eq!(t.times[0], 0.5);
    assert!((last(&t, "x") - (-1.0_f64).exp()).abs() < 1e-5);
}

fn van_der_pol(mu: f64) -> ExecutableSystem {
    let mut m = Make::default();
    let (x, ex) = m.state("x", 2.0);
    let (y, ey) = m.state("y", 0.0);
    m.assign(Unknown::Der(x), ey);
    let one = m.num(1.0);
    let mu = m.parameter("mu", mu);
    let square = m.e().mul(ex, ex);
    let damping = m.e().sub(one, square);
    let damping = m.e().mul(mu, damping);
    let damping = m.e().mul(damping, ey);
    let value = m.e().sub(damping, ex);
    m.assign(Unknown::Der(y), value);
    m.system()
}

#[test]
fn van_der_pol_stiff() {
    // reference at 1e-12 by an independent Radau integration: x(2) for mu = 1, x(2000) of mu = 1000 (IVP test set)
    let (run_, t) = run(
        &van_der_pol(1000.0),
        Settings { stop_time: 2000.0, interval: 20.0, tolerance: 1e-7, ..Settings::default() },
        &[],
    );
    assert_eq!(run_.end, End::Reached);
    assert!((last(&t, "x") - 1.706_167_732_170_483).abs() < 1e-3, "{}", last(&t, "x"));
    assert!(run_.statistics.steps < 3000, "{:?}", run_.statistics);
}

/// Robertson with its third concentration from an algebraic loop, which stays an unknown of IDA.
#[test]
fn robertson_with_an_algebraic_unknown() {
    let mut m = Make::default();
    let (a, ea) = m.state("a", 1.0);
    let (b, eb) = m.state("b", 0.0);
    let c = m.add(variable("c"));
    let ec = m.var(c);
    let one = m.num(1.0);
    let sum = m.e().add(ea, eb);
    let sum = m.e().add(sum, ec);
    let residual = m.e().sub(sum, one);
    m.torn(vec![Unknown::Var(c)], vec![residual], true);
    let (k1, k2, k3) = (m.num(0.04), m.num(3e7), m.num(1e4));
    let bc = m.e().mul(eb, ec);
    let back = m.e().mul(k3, bc);
    let forth = m.e().mul(k1, ea);
    let net = m.e().sub(back, forth);
    m.assign(Unknown::Der(a), net);
    let bb = m.e().mul(eb, eb);
    let lost = m.e().mul(k2, bb);
    let gain = m.e().neg(net);
    let value = m.e().sub(gain, lost);
    m.assign(Unknown::Der(b), value);
    m.dae.variables[b.index()].nominal = Some(m.dae.exprs.num(1e-5));
    let system = m.system();
    let (run, t) = run(&system, Settings { stop_time: 400.0, interval: 40.0, ..Settings::default() }, &[]);
    assert_eq!(run.end, End::Reached, "{:?}", run.diagnostics);
    // published at t = 400
    assert!((last(&t, "a") - 4.505_18e-1).abs() < 2e-5, "{}", last(&t, "a"));
    assert!((last(&t, "b") - 3.222_901e-6).abs() < 1e-9);
    assert!((last(&t, "c") - 5.494_786e-1).abs() < 2e-5);
    assert_eq!((run.statistics.unknowns, run.statistics.states), (3, 2));
}

/// y from `y + y^3 = x`, with x falling.
#[test]
fn a_nonlinear_loop_is_solved_at_the_start() {
    let mut m = Make::default();
    let (x, ex) = m.state("x", 10.0);
    let y = m.add(variable("y"));
    let ey = m.var(y);
    let three = m.num(3.0);
    let cube = m.e().pow(ey, three);
    let sum = m.e().add(ey, cube);
    let residual = m.e().sub(sum, ex);
    m.torn(vec![Unknown::Var(y)], vec![residual], false);
    let value = m.e().neg(ey);
    m.assign(Unknown::Der(x), value);
    let (run, t) = run(&m.system(), Settings::default(), &[]);
    assert_eq!(run.end, End::Reached, "{:?}", run.diagnostics);
    assert!((t.column("y").expect("recorded")[0] - 2.0).abs() < 1e-10);
    let (x, y) = (last(&t, "x"), last(&t, "y"));
    assert!((y + y * y * y - x).abs() < 1e-5);
}

#[test]
fn without_unknowns_there_are_still_rows_and_roots() {
    let mut m = Make::default();
    let time = m.e().time();
    let w = m.num(6.0);
    let phase = m.e().mul(w, time);
    let y = m.e().unary(UnaryFunction::Sin, phase);
    let y = m.algebraic("y", y);
    let zero = m.num(0.0);
    let up = m.relation("y > 0", RelationalOp::Gt, y, zero);
    let (count, _) = m.discrete("count", 0.0);
    let before = m.e().pre(count);
    let one = m.num(1.0);
    let more = m.e().add(before, one);
    m.when(up, count, more);
    let (run, t) = run(&m.system(), Settings { stop_time: 4.0, interval: 0.5, ..Settings::default() }, &[]);
    assert_eq!(run.end, End::Reached, "{:?}", run.diagnostics);
    // sin(6 t) rises through zero at 2 pi k / 6, k = 1, 2, 3, and at 0 itself just after the start
    assert_eq!(last(&t, "count"), 4.0);
    assert!((last(&t, "y") - 24.0_f64.sin()).abs() < 1e-12);
}

#[test]
fn a_singularity_ends_with_what_was_reached() {
    // x' = x^2, x(0) = 1: infinite at t = 1
    let mut m = Make::default();
    let (x, e) = m.state("x", 1.0);
    let square = m.e().mul(e, e);
    m.assign(Unknown::Der(x), square);
    let (run, t) = run(&m.system(), Settings { stop_time: 2.0, interval: 0.1, ..Settings::default() }, &[]);
    assert!(matches!(run.end, End::StepTooSmall | End::NonFinite), "{:?}", run.end);
    assert!(t.len() >= 10 && run.time < 1.1);
    assert!(run.diagnostics[0].message.contains("`x`"), "{:?}", run.diagnostics);
}

#[test]
fn the_root_of_a_negative_number_is_named() {
    // x' = -sqrt(x) - 1 passes zero
    let mut m = Make::default();
    let (x, e) = m.state("x", 1.0);
    let root = m.e().unary(UnaryFunction::Sqrt, e);
    let one = m.num(1.0);
    let sum = m.e().add(root, one);
    let value = m.e().neg(sum);
    m.assign(Unknown::Der(x), value);
    let (run, _) = run(&m.system(), Settings::default(), &[]);
    assert_eq!(run.end, End::NonFinite);
    assert!(run.diagnostics[0].message.contains("sqrt(x)"), "{:?}", run.diagnostics);
}
