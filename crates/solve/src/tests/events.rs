//! Events: bounces, stick and slip, clocks, recorded inputs.

use super::*;
use crate::End;
use bramah_expr::UnaryFunction;

fn bouncing_ball() -> ExecutableSystem {
    let mut m = Make::default();
    let (h, eh) = m.state("h", 1.0);
    let (v, ev) = m.state("v", 0.0);
    let g = m.parameter("g", 9.81);
    let zero = m.num(0.0);
    let below = m.relation("h <= 0", RelationalOp::Le, eh, zero);
    m.assign(Unknown::Der(h), ev);
    let fall = m.e().neg(g);
    m.assign(Unknown::Der(v), fall);
    let e = m.num(-0.7);
    let back = m.e().mul(e, ev);
    m.reinit(below, v, back);
    m.system()
}

#[test]
fn a_ball_bounces() {
    let (run, t) = run(&bouncing_ball(), Settings { stop_time: 2.0, ..Settings::default() }, &[]);
    assert_eq!(run.end, End::Reached, "{:?}", run.diagnostics);
    let fall = (2.0_f64 / 9.81).sqrt();
    let first = t.times.windows(2).position(|w| w[0] == w[1]).expect("an event");
    assert!((t.times[first] - fall).abs() < 1e-6);
    let v = t.column("v").expect("recorded");
    assert!((v[first] + 9.81 * fall).abs() < 1e-5 && (v[first + 1] - 0.7 * 9.81 * fall).abs() < 1e-5);
    // impacts at fall (1 + 2 (0.7 + 0.7^2 + ...)): 4 within 2 s; each is an event, and so is each leaving
    assert!(t.column("h").expect("recorded").iter().all(|h| *h > -1e-6));
}

/// The ball that every textbook has: it lies still once a bounce is too small to leave the ground.
#[test]
fn a_ball_comes_to_rest() {
    let mut m = Make::default();
    let (h, eh) = m.state("h", 1.0);
    let (v, ev) = m.state("v", 0.0);
    let (zero, g, e) = (m.num(0.0), m.num(-9.81), m.num(-0.7));
    let (flying, eflying) = m.discrete("flying", 1.0);
    let impact = m.relation("h <= 0", RelationalOp::Le, eh, zero);
    let falls = m.relation("v <= 0", RelationalOp::Le, ev, zero);
    let both = m.e().and(impact, falls);
    let (lands, elands) = m.discrete("lands", 0.0);
    m.assign_discrete(lands, both);
    let edge = m.edge(impact);
    let back = m.e().mul(e, ev);
    let new = m.e().if_(edge, back, zero);
    let up = m.e().rel(RelationalOp::Gt, new, zero);
    let hit = m.edge(elands);
    let either = m.e().or(edge, hit);
    let before = m.e().pre(flying);
    let value = m.e().if_(either, up, before);
    m.assign_discrete(flying, value);
    m.assign(Unknown::Der(h), ev);
    let fall = m.e().if_(eflying, g, zero);
    m.assign(Unknown::Der(v), fall);
    m.dae.actions.push(EventAction { fires: either, kind: EventActionKind::Reinit(v, new), origin: ORIGIN });
    let (run, t) = run(&m.system(), Settings { stop_time: 10.0, ..Settings::default() }, &[]);
    assert_eq!(run.end, End::Reached, "{:?}", run.diagnostics);
    assert!(last(&t, "h").abs() < 1e-5 && last(&t, "v") == 0.0, "{} {}", last(&t, "h"), last(&t, "v"));
}

/// Mass on a belt, as an automaton of stick (0), forward (1) and backward (-1) slip.
fn belt() -> ExecutableSystem {
    let mut m = Make::default();
    let (x, ex) = m.state("x", 0.0);
    let (v, ev) = m.state("v", 0.0);
    for state in [x, v] {
        m.dae.variables[state.index()].nominal = Some(m.dae.exprs.num(0.01));
    }
    let [mass, k, c, belt, stick, slip, stribeck] =
        [("m", 1.0), ("k", 100.0), ("c", 0.2), ("vb", 0.1), ("Fs", 4.0), ("Fc", 3.0), ("vs", 0.1)]
            .map(|(n, value)| m.parameter(n, value));
    let relative = m.e().sub(belt, ev);
    let relative = m.algebraic("vr", relative);
    // the friction that holds the mass on the belt
    let spring = m.e().mul(k, ex);
    let damper = m.e().mul(c, ev);
    let load = m.e().add(spring, damper);
    let load = m.algebraic("load", load);
    let (mode, emode) = m.discrete("mode", 1.0);
    let zero = m.num(0.0);
    let positive = m.relation("vr > 0", RelationalOp::Gt, relative, zero);
    let negative = m.relation("vr < 0", RelationalOp::Lt, relative, zero);
    let breaks_up = m.relation("load > Fs", RelationalOp::Gt, load, stick);
    let minus = m.e().neg(stick);
    let breaks_down = m.relation("load < -Fs", RelationalOp::Lt, load, minus);
    // stuck: breaks away when the load is too large; sliding: sticks when the relative speed changes its sign
    let before = m.e().pre(mode);
    let (one, minus_one) = (m.num(1.0), m.num(-1.0));
    let was_stuck = m.e().rel(RelationalOp::Eq, before, zero);
    let was_forward = m.e().rel(RelationalOp::Eq, before, one);
    let from_stuck = m.e().if_(breaks_down, minus_one, zero);
    let from_stuck = m.e().if_(breaks_up, one, from_stuck);
    let ends = |m: &mut Make, relation: ExprId| {
        let bramah_expr::ExprNode::Var(v) = m.dae.exprs.node(relation) else { panic!("a variable") };
        let before = m.e().pre(v);
        let now = m.e().not(relation);
        m.e().and(before, now)
    };
    let (ends_forward, ends_backward) = (ends(&mut m, positive), ends(&mut m, negative));
    let from_forward = m.e().if_(ends_forward, zero, one);
    let from_backward = m.e().if_(ends_backward, zero, minus_one);
    let sliding = m.e().if_(was_forward, from_forward, from_backward);
    let value = m.e().if_(was_stuck, from_stuck, sliding);
    m.assign_discrete(mode, value);
    // sliding: the mode sets the sign of friction; stuck: no acceleration
    let ratio = m.e().div(relative, stribeck);
    let square = m.e().mul(ratio, ratio);
    let square = m.e().neg(square);
    let bell = m.e().unary(UnaryFunction::Exp, square);
    let rise = m.e().sub(stick, slip);
    let rise = m.e().mul(rise, bell);
    let size = m.e().add(slip, rise);
    let friction = m.e().mul(emode, size);
    let stuck = m.e().rel(RelationalOp::Eq, emode, zero);
    let force = m.e().if_(stuck, load, friction);
    let force = m.algebraic("F", force);
    m.assign(Unknown::Der(x), ev);
    let net = m.e().sub(force, load);
    let acceleration = m.e().div(net, mass);
    m.assign(Unknown::Der(v), acceleration);
    m.system()
}

#[test]
fn the_belt_sticks_and_slips() {
    let settings = |tolerance| Settings { stop_time: 20.0, interval: 0.01, tolerance, ..Settings::default() };
    let (result, t) = run(&belt(), settings(1e-6), &[]);
    assert_eq!(result.end, End::Reached, "{:?}", result.diagnostics);
    let mode = t.column("mode").expect("recorded");
    let sticks = mode.windows(2).filter(|w| w[0] != 0.0 && w[1] == 0.0).count();
    assert_eq!(sticks, 27);
    let (_, reference) = run(&belt(), settings(1e-10), &[]);
    let on_grid =
        |t: &Trajectory| -> Vec<f64> { (1..2000).map(|k| t.value(0, f64::from(k) * 0.01).expect("inside")).collect() };
    let squares = on_grid(&t).iter().zip(on_grid(&reference)).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
    let rms = (squares / 2000.0).sqrt();
    assert!(rms < 2e-6, "{rms}");
    // a hand-written state machine with IDAReInit needs 6071
    assert!(result.statistics.residual_evaluations < 9100, "{:?}", result.statistics);
}

#[test]
fn clocks_count_without_drift() {
    let mut m = Make::default();
    let tick = m.sample(0.0, 0.1);
    let (count, _) = m.discrete("count", 0.0);
    let (one, before) = (m.num(1.0), m.e().pre(count));
    let more = m.e().add(before, one);
    m.when(tick, count, more);
    let (run, t) = run(&m.system(), Settings { stop_time: 100.0, interval: 1.0, ..Settings::default() }, &[]);
    assert_eq!(run.end, End::Reached, "{:?}", run.diagnostics);
    assert_eq!(t.column("count").expect("recorded")[0], 1.0);
    assert_eq!(last(&t, "count"), 1001.0);
    assert!(t.times.contains(&(3.0 * 0.1)));
}

#[test]
fn time_events_are_exact_and_may_move() {
    // when time >= pre(next) then next = pre(next) + 0.3
    let mut m = Make::default();
    let (x, _) = m.state("x", 0.0);
    let (next, _) = m.discrete("next", 0.25);
    let before = m.e().pre(next);
    let due = m.after("time >= pre(next)", before);
    let step = m.num(0.3);
    let later = m.e().add(before, step);
    m.when(due, next, later);
    let (one, zero) = (m.num(1.0), m.num(0.0));
    let rate = m.var(next);
    let high = m.e().rel(RelationalOp::Gt, rate, one);
    let rate = m.e().if_(high, one, zero);
    m.assign(Unknown::Der(x), rate);
    let (run, t) = run(&m.system(), Settings { stop_time: 2.0, interval: 0.5, ..Settings::default() }, &[]);
    assert_eq!(run.end, End::Reached, "{:?}", run.diagnostics);
    // events at 0.25, 0.55, 0.85, 1.15, 1.45, 1.75; next > 1 from 0.85 on
    assert_eq!(run.statistics.events, 6);
    assert!((last(&t, "x") - (2.0 - 0.85)).abs() < 1e-9, "{}", last(&t, "x"));
    assert!(t.times.contains(&0.25));
}

fn first_order(input: VarId, m: &mut Make) {
    let u = m.var(input);
    let (x, e) = m.state("x", 0.0);
    let difference = m.e().sub(u, e);
    let rate = m.num(10.0);
    let value = m.e().mul(rate, difference);
    m.assign(Unknown::Der(x), value);
}

fn with_input() -> (ExecutableSystem, VarId) {
    let mut m = Make::default();
    let u = m.add(FlatVariable { input: true, ..variable("u") });
    m.dae.inputs.push(u);
    first_order(u, &mut m);
    (m.system(), u)
}

#[test]
fn held_inputs_jump_at_their_samples() {
    let (system, u) = with_input();
    let input = RecordedInput::held(u, vec![0.0, 0.5], vec![0.0, 1.0]);
    let (run, t) = run(&system, Settings { interval: 0.25, ..Settings::default() }, &[input]);
    assert_eq!(run.end, End::Reached, "{:?}", run.diagnostics);
    assert_eq!(t.times, [0.0, 0.25, 0.5, 0.5, 0.75, 1.0]);
    assert_eq!(t.column("u").expect("recorded"), [0.0, 0.0, 0.0, 1.0, 1.0, 1.0]);
    assert!((last(&t, "x") - (1.0 - (-5.0_f64).exp())).abs() < 1e-5);
}

#[test]
fn linear_inputs_run_straight() {
    let (system, u) = with_input();
    let input = RecordedInput::linear(u, vec![0.0, 1.0], vec![0.0, 1.0]);
    let (run, t) = run(&system, Settings { interval: 0.25, ..Settings::default() }, &[input]);
    assert_eq!(run.end, End::Reached, "{:?}", run.diagnostics);
    assert_eq!(t.column("u").expect("recorded"), [0.0, 0.25, 0.5, 0.75, 1.0]);
    // x = t - 0.1 (1 - exp(-10 t))
    assert!((last(&t, "x") - (1.0 - 0.1 * (1.0 - (-10.0_f64).exp()))).abs() < 1e-6);
}

#[test]
fn a_recording_at_1_khz_is_cheap() {
    let (system, u) = with_input();
    let times: Vec<f64> = (0..4000).map(|k| f64::from(k) * 1e-3).collect();
    let values: Vec<f64> = times.iter().map(|t| (2.0 * t).sin()).collect();
    let (run, t) = run(
        &system,
        Settings { stop_time: 4.0, interval: 0.01, ..Settings::default() },
        &[RecordedInput::held(u, times, values)],
    );
    assert_eq!(run.end, End::Reached, "{:?}", run.diagnostics);
    assert!(run.statistics.residual_evaluations < 30_000, "{:?}", run.statistics);
    assert!((last(&t, "x") - 0.97).abs() < 0.1);
}

#[test]
fn floor_counts_cells_up_and_down() {
    let mut m = Make::default();
    let time = m.e().time();
    let (two, three) = (m.num(2.0), m.num(3.2));
    let phase = m.e().mul(two, time);
    let wave = m.e().unary(UnaryFunction::Sin, phase);
    let y = m.e().mul(three, wave);
    let y = m.algebraic("y", y);
    let (cell, _) = m.discrete("floor(y)", 0.0);
    m.dae.crossings.push(ZeroCrossing { mode: cell, kind: CrossingKind::Floor(y), origin: ORIGIN });
    let value = m.e().unary(UnaryFunction::Floor, y);
    m.assign_discrete(cell, value);
    let (run, t) = run(&m.system(), Settings { stop_time: 3.0, interval: 0.01, ..Settings::default() }, &[]);
    assert_eq!(run.end, End::Reached, "{:?}", run.diagnostics);
    let (y, cell) = (t.column("y").expect("recorded"), t.column("floor(y)").expect("recorded"));
    for (y, cell) in y.iter().zip(cell) {
        assert!(*y > cell - 1e-6 && *y < cell + 1.0 + 1e-6, "{y} {cell}");
    }
    // up 1 2 3, down 2 1 0 -1 ... -4, up again
    assert_eq!(cell.iter().copied().fold(0.0, f64::max), 3.0);
    assert_eq!(cell.iter().copied().fold(0.0, f64::min), -4.0);
}

#[test]
fn a_sign_without_a_state_between_is_named_as_chattering() {
    // x' = -sign(x - 0.5): slides on x = 0.5
    let mut m = Make::default();
    let (x, e) = m.state("x", 0.0);
    let half = m.num(0.5);
    let above = m.relation("x > 0.5", RelationalOp::Gt, e, half);
    let (up, down) = (m.num(1.0), m.num(-1.0));
    let value = m.e().if_(above, down, up);
    m.assign(Unknown::Der(x), value);
    let (run, _) = run(&m.system(), Settings::default(), &[]);
    assert_eq!(run.end, End::Chattering);
    assert!((run.time - 0.5).abs() < 1e-3, "{}", run.time);
    assert!(run.diagnostics[0].message.contains("x > 0.5"));
}
