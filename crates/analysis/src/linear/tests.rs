use super::*;
use crate::Analyze;
use bramah_circuit::Simulation;
use bramah_model::compile::Request;
use bramah_syntax::world::MemoryWorld;

fn start(text: &str) -> (Simulation, State) {
    let world = MemoryWorld::single("m.mo", text);
    let mut simulation =
        Simulation::compile(&world, &Request { source: "m.mo".into(), ..Request::default() }).expect("sound");
    let state = simulation.stop_time(1e-9).run().expect("starts").state;
    (simulation, state)
}

fn strings(names: &[&str]) -> Vec<String> {
    names.iter().map(|n| (*n).to_owned()).collect()
}

const OSCILLATOR: &str = "model M
    parameter Real m = 2, d = 0.8, c = 50;
    input Real F(start = 0); Real x(start = 0, fixed = true), v(start = 0, fixed = true);
    output Real y, a;
  equation
    der(x) = v; m*der(v) = F - d*v - c*x; y = x; a = der(v);
  end M;";

fn oscillator() -> StateSpace {
    let (simulation, state) = start(OSCILLATOR);
    let chosen =
        LinearizationSetup::new(&simulation.model().flat, &InputOutputSelection::default(), &[]).expect("fits");
    linearize(simulation.model(), &chosen, &state).expect("has derivatives")
}

#[test]
fn matrices_poles_and_zeros_of_an_oscillator() {
    let model = oscillator();
    assert_eq!(model.a, DMatrix::from_row_slice(2, 2, &[0.0, 1.0, -25.0, -0.4]));
    assert_eq!((model.b[(1, 0)], model.c[(0, 0)], model.d[(1, 0)]), (0.5, 1.0, 0.5));
    let poles = poles(&model);
    assert_eq!(poles.len(), 1);
    assert!(
        (poles[0].frequency - 5.0 / std::f64::consts::TAU).abs() < 1e-12 && (poles[0].damping - 0.04).abs() < 1e-12
    );
    let shares: f64 = poles[0].participation.iter().map(|s| s.1).sum();
    assert!((shares - 1.0).abs() < 1e-9 && (poles[0].participation[0].1 - 0.5).abs() < 1e-6);
    // force to position has none; force to acceleration has two at zero
    assert!(zeros(&model, 0, 0).is_empty());
    let at_zero = zeros(&model, 0, 1);
    assert!(at_zero.len() == 2 && at_zero.iter().all(|z| z.norm() < 1e-6), "{at_zero:?}");
    // at resonance the amplitude is 1/(d w)
    let response = response(&model, 5.0 / std::f64::consts::TAU).expect("damped");
    assert!((response[(0, 0)].norm() - 1.0 / (0.8 * 5.0)).abs() < 1e-12);
}

/// Poles of states and their shares, in whole per cent, of a model that is at its start.
fn modes(text: &str) -> Vec<(f64, usize, Vec<(String, i64)>)> {
    let (simulation, state) = start(text);
    let chosen =
        LinearizationSetup::new(&simulation.model().flat, &InputOutputSelection::default(), &[]).expect("fits");
    let model = linearize(simulation.model(), &chosen, &state).expect("has derivatives");
    let shares = |p: &Pole| {
        let mut named: Vec<(String, i64)> =
            p.participation.iter().map(|s| (model.states[s.0].name.clone(), (100.0 * s.1).round() as i64)).collect();
        named.sort();
        named
    };
    poles(&model).iter().map(|p| (p.re, p.together, shares(p))).collect()
}

/// Two lags of one rate beside each other, two in a row and two integrators in a row: the first ones name one state,
/// the others the other one.
#[test]
fn poles_that_coincide_name_their_own_states() {
    for (first, second) in [("-2*x", "-2*z"), ("-2*x", "x - 2*z"), ("z", "0.5*far"), ("1", "x")] {
        let text = format!(
            "model M Real x(start = 1, fixed = true), z(start = 1, fixed = true), far(start = 1, fixed = true);
              equation der(x) = {first}; der(z) = {second}; der(far) = -50*far; end M;"
        );
        let found = modes(&text);
        assert_eq!(found.len(), 3);
        let mut names: Vec<&str> = Vec::new();
        for (_, together, shares) in &found[..2] {
            assert_eq!((*together, shares.len(), shares[0].1), (1, 1, 100), "{first} {second}: {found:?}");
            names.push(&shares[0].0);
        }
        names.sort_unstable();
        assert_eq!(names, ["x", "z"], "{first} {second}");
    }
}

/// A critically damped mass, and two masses of 1 and 2 with a spring between them that move on together: their two
/// poles belong to the same states.
#[test]
fn poles_that_coincide_within_a_circle_are_told_together() {
    let damped = modes(
        "model M Real x(start = 0, fixed = true), v(start = 0, fixed = true);
          equation der(x) = v; der(v) = -6*v - 9*x; end M;",
    );
    let both = vec![("v".to_owned(), 50), ("x".to_owned(), 50)];
    assert_eq!(damped.len(), 2);
    assert!(
        damped.iter().all(|(re, together, s)| (re + 3.0).abs() < 1e-6 && *together == 2 && *s == both),
        "{damped:?}"
    );
    let free = modes(
        "model M Real x(start = 0, fixed = true), v(start = 0, fixed = true), y(start = 0, fixed = true), w(start = 0, fixed = true);
          equation der(x) = v; der(y) = w; der(v) = 100*(y - x); 2*der(w) = 100*(x - y); end M;",
    );
    let shares = [("v", 17), ("w", 33), ("x", 17), ("y", 33)].map(|(n, s)| (n.to_owned(), s)).to_vec();
    assert_eq!(free.len(), 3);
    assert!(free[..2].iter().all(|(re, together, s)| re.abs() < 1e-6 && *together == 2 && *s == shares), "{free:?}");
}

#[test]
fn zeros_of_a_lead() {
    // (s + 3)/((s + 1)(s + 10)) with a chain of two lags
    let text =
        "model M input Real u(start = 0); Real x(start = 0, fixed = true), z(start = 0, fixed = true); output Real y;
      equation der(x) = -x + u; der(z) = -10*z + u; y = (2*x + 7*z)/9; end M;";
    let (simulation, state) = start(text);
    let chosen =
        LinearizationSetup::new(&simulation.model().flat, &InputOutputSelection::default(), &[]).expect("fits");
    let model = linearize(simulation.model(), &chosen, &state).expect("has derivatives");
    let found = zeros(&model, 0, 0);
    assert!(found.len() == 1 && (found[0].re + 3.0).abs() < 1e-9, "{found:?}");
}

#[test]
fn words_and_files() {
    let model = oscillator();
    insta::assert_snapshot!(words(&model));
    insta::assert_snapshot!(csv(&model));
    let text = modelica(&model, "Near");
    insta::assert_snapshot!(text);
    let world = MemoryWorld::single("n.mo", &text);
    let simulation = Simulation::compile(&world, &Request { source: "n.mo".into(), ..Request::default() });
    simulation.unwrap_or_else(|e| panic!("{e}"));
    assert!(mat(&model).len() > 200);
    assert_eq!(model.json()["poles"][0]["states"][0]["state"].as_str().map(str::len), Some(1));
}

#[test]
fn names_that_do_not_fit() {
    let (simulation, _) = start(OSCILLATOR);
    let said = |inputs: &[&str], outputs: &[&str]| {
        let choice = InputOutputSelection { inputs: strings(inputs), outputs: strings(outputs) };
        LinearizationSetup::new(&simulation.model().flat, &choice, &[]).expect_err("does not fit")[0].message.clone()
    };
    assert_eq!(said(&["v"], &[]), "`v` cannot be used here");
    assert_eq!(said(&["mm"], &[]), "the model has no variable `mm`");
    assert_eq!(said(&[], &["m"]), "`m` cannot be used here");
}

const PUMP: &str = "model M
    parameter Real f = 30;
    input Real u(start = 1);
    Real w(start = 20, fixed = true), p(start = 5, fixed = true), n;
  equation
    der(w) = 3*(f - w) - (0.1 + 0.01*tanh(w))*p; der(p) = w*sqrt(1 + p^2/100) - 0.2*p*abs(w) - u*p; n = 60*w;
  end M;";

fn quasi_linear(rho: &[&str]) -> QuasiLpvModel {
    quasi_linear_at(rho, &vec![vec![1.0, 10.0]; rho.len()])
}

fn quasi_linear_at(rho: &[&str], grid: &[Vec<f64>]) -> QuasiLpvModel {
    let (simulation, state) = start(PUMP);
    let model = simulation.model();
    let chosen = LinearizationSetup::scheduled(&model.flat, &strings(&["f", "u"]), &strings(rho)).expect("fits");
    let ranges = [(-40.0, 40.0), (0.0, 20.0), (10.0, 40.0), (0.0, 3.0)];
    let grid: Vec<Option<Vec<f64>>> = grid.iter().cloned().map(Some).collect();
    schedule(&chosen, &state, &grid, &ranges).expect("has values")
}

#[test]
fn the_quasi_linear_form_is_exact_where_the_rest_is_linear() {
    let exact = quasi_linear(&["p", "n"]);
    assert_eq!(exact.inputs.iter().map(|q| q.name.as_str()).collect::<Vec<_>>(), ["f", "u"]);
    assert_eq!((exact.points.len(), exact.is_exact()), (4, true), "{:?}", exact.error);
    let short = quasi_linear(&["p"]);
    assert!(!short.is_exact() && short.error[1] > 1e-3, "{:?}", short.error);
    assert!(short.words().contains("not exact"));
    assert_eq!(exact.csv().lines().count(), 5);
}

/// The written model follows the model it comes from: exactly scheduled it differs by the interpolation between the
/// points of its grid, and at a point of the grid not at all.
#[test]
fn the_written_form_simulates() {
    let form = quasi_linear_at(&["p", "n"], &[vec![12.0, 0.0, 3.0, 6.0], vec![0.0, 900.0, 1200.0, 1500.0, 1800.0]]);
    let text = format!(
        "{}\n{}\nmodel Beside\n  M bench(f = 30, u = 1);\n  Form form(u_1 = 30, u_2 = 1, x_1(start = 20), x_2(start = 5));\nend Beside;",
        PUMP.replace("parameter Real f = 30;", "input Real f;"),
        form.modelica("Form")
    );
    let world = MemoryWorld::single("m.mo", &text);
    let request = Request { source: "m.mo".into(), model: Some("Beside".into()), ..Request::default() };
    let mut simulation = Simulation::compile(&world, &request).expect("the written form compiles");
    let run = simulation.stop_time(0.2).run().expect("runs");
    let last = |name: &str| *run.trajectory.column(name).expect("a column").last().expect("rows");
    let (w, p) = (last("bench.w"), last("bench.p"));
    assert!((last("form.x_1") - w).abs() < 1e-3 * w && (last("form.x_2") - p).abs() < 2e-2 * p, "{w} {p}");
    assert!(form.mat().len() > 20 * 8 * (4 + 6));
}

/// The largest error of a shipped model's form over the terms of its rows, from states within a fifth (at least
/// `least`) of where its run, cut at `stop`, ends.
fn largest_error(class: &str, stop: Option<f64>, inputs: &[&str], rho: &[&str], least: f64) -> f64 {
    let request = Request { source: class.into(), ..Request::default() };
    let simulation = Simulation::compile(&MemoryWorld::default(), &request).expect("ships");
    let state = match stop {
        None => simulation.state_at(Some(simulation.clone().settings().stop_time)),
        Some(stop) => simulation.state_at(Some(stop)),
    };
    let state = state.expect("runs");
    let chosen =
        LinearizationSetup::scheduled(&simulation.model().flat, &strings(inputs), &strings(rho)).expect("fits");
    let around = chosen.quantities().map(|v| {
        let now = state.values[v.index()];
        let margin = (0.2 * now.abs()).max(least);
        (now - margin, now + margin)
    });
    let around: Vec<(f64, f64)> = around.collect();
    let grid: Vec<Option<Vec<f64>>> = rho.iter().map(|_| None).collect();
    let found = schedule(&chosen, &state, &grid, &around).expect("has values");
    assert!(found.tried > 150, "{} states", found.tried);
    found.error.iter().fold(0.0f64, |m, e| m.max(*e))
}

/// P2's circuit without the low side: exact with all that it schedules; the paper's shorter list misses friction's
/// part.
#[test]
fn the_closed_circuit_is_quasi_linear() {
    let error = |rho: &[&str]| largest_error("ClosedCircuit.Reduced", None, &["f", "u"], rho, 0.0);
    assert!(error(&["p", "n_p", "n_m", "f"]) < 1e-14);
    let short = error(&["p", "n_p"]);
    assert!((1e-3..0.2).contains(&short), "{short}");
}

/// The root of a level is a factor times the level.
#[test]
fn the_cascaded_tanks_are_quasi_linear() {
    let error = |rho: &[&str]| largest_error("CascadedTanks.Nominal", Some(400.0), &["u"], rho, 0.0);
    let exact = error(&["upper.h", "lower.h"]);
    assert!(exact < 1e-12, "{exact}");
    assert!(error(&["upper.h"]) > 1e-3);
}

/// Valves follow the pressures, the chambers' volumes the position.
#[test]
fn the_axis_with_a_pump_in_a_closed_circuit_is_quasi_linear() {
    let error = |rho: &[&str]| largest_error("GapAxis.Nominal", Some(1.0), &["u"], rho, 1e-2);
    let exact = error(&["chamber_1.p", "chamber_2.p", "load.s"]);
    assert!(exact < 1e-12, "{exact}");
    assert!(error(&["chamber_1.p", "chamber_2.p"]) > 1e-4);
}
