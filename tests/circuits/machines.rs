//! Gaps and friction of an axial piston machine from its map of efficiencies: what the map can tell, said before the fit,
//! and the values of those that it can.

use bramah::Interpolation;
use bramah::Simulation;
use bramah::Sources;
use bramah::internals::analysis::identify::{
    Identification, IdentificationProblem, IdentifyMethod, ParameterFit, separation_words,
};
use bramah::internals::compile::compile;
use bramah::internals::study::{Recording, RecordingRole, Study};
use bramah::world::MemoryWorld;
use std::path::Path;

/// The pump of the closed circuit between two pressures, other gaps and weights assumed than it has.
const BENCH: &str = "model Bench
  input Real N(unit = \"rev/min\"); input Real p(unit = \"Pa\");
  output Real eta_v(unit = \"1\"); output Real eta_m(unit = \"1\");
  inner Oil.ClosedCircuitOil oil;
  Mechanical.Rotational.Speed drive;
  ClosedCircuit.BenchMachine pump(h_p = 20e-6, w_p = 0.6, w_v = 0.7);
  Hydraulic.PressureSource high(useInput = true); Hydraulic.Tank low(p = 2e6);
protected
  Real ideal(unit = \"W\", nominal = 1e4);
equation
  drive.w_ref = Modelica.Units.Conversions.from_rpm(N); high.p_in = p;
  connect(drive.flange, pump.flange); connect(pump.port_a, high.port); connect(pump.port_b, low.port);
  ideal = pump.V*pump.w/(2*Modelica.Constants.pi)*(p - 2e6);
  eta_v*ideal = pump.Q_A*(p - 2e6); eta_m*pump.T_sh*pump.w = ideal;
end Bench;";

/// Six speeds at each of six pressures, twice each, with an error of 0.1 % of the efficiency.
fn map(signals: &[&str]) -> Recording {
    let point = |k: usize| (k / 12, k / 2 % 6);
    let times: Vec<f64> = (0..72).map(f64::from).collect();
    let speed: Vec<f64> = (0..72).map(|k| 280.0 + 240.0 * point(k).1 as f64).collect();
    let pressure: Vec<f64> = (0..72).map(|k| 3.5e6 * (1 + point(k).0) as f64 + 2e6).collect();
    let mut bench = Simulation::from_text(BENCH).expect("compiles");
    for (name, value) in [("pump.h_p", 24e-6), ("pump.w_p", 0.7), ("pump.w_v", 0.75)] {
        bench.set(name, value).expect("a parameter");
    }
    for (name, values) in [("N", &speed), ("p", &pressure)] {
        bench.input(name, &times, values, Interpolation::Held).expect("an input");
    }
    bench.stop_time(71.0);
    bench.settings().interval = 1.0;
    let run = bench.run().expect("runs").trajectory;
    let mut dice = 12345u64;
    let mut error = || {
        dice = dice.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        1e-3 * 1.7 * ((dice >> 11) as f64 / (1u64 << 52) as f64 - 1.0)
    };
    let mut column = |name: &&str| {
        let index = run.index(name).expect("recorded");
        times.iter().map(|&t| run.value(index, t).expect("inside") * (1.0 + error())).collect()
    };
    let signals = signals.iter().map(&mut column).collect();
    Recording {
        file: "map.csv".into(),
        role: RecordingRole::Train,
        times: times.clone(),
        inputs: vec![speed, pressure],
        signals,
        pieces: 1,
    }
}

/// Asks for parameters by signals, and hands over the question, what was said of it, and the fit.
fn asked<T>(
    signals: &[&str],
    parameters: &[&str],
    see: impl FnOnce(&IdentificationProblem<'_>, &Identification<'_>, Option<ParameterFit>) -> T,
    fit: bool,
) -> T {
    let mut world = MemoryWorld::single("Bench.mo", BENCH);
    let mut text = "version = 1\nmodel = \"Bench.mo\"\n[[recordings]]\nfile = \"map.csv\"\n[inputs]\n".to_owned();
    text += "N = { unit = \"rev/min\", hold = true }\np = { unit = \"Pa\", hold = true }\n[signals]\n";
    signals.iter().for_each(|s| text += &format!("{s} = {{ unit = \"1\" }}\n"));
    text += "[parameters]\n";
    parameters.iter().for_each(|p| text += &format!("\"pump.{p}\" = {{ min = 1e-6, max = 1.0 }}\n"));
    world.add("study.toml", text);
    let mut sources = Sources::default();
    let study = Study::read(&world, Path::new("study.toml"), &mut sources).value.expect("a study");
    let model = compile(&world, &study.request(), &Default::default()).value.expect("compiles");
    let bound = study.bind(&model.flat).value.expect("fits");
    let train = [map(signals)];
    let problem = IdentificationProblem::new(&model, &bound, &train).expect("a sound question");
    let found = Identification::new(&problem, &train, IdentifyMethod::Output).expect("runs");
    let fit = fit.then(|| found.fit().expect("runs"));
    see(&problem, &found, fit)
}

/// All three gaps leak alike: by flow alone one combination is found, and the flow of one gap would tell them apart.
#[test]
fn gaps_from_flow_alone_are_said_to_be_inseparable() {
    let gaps = ["h_s", "h_p", "h_v"];
    let words =
        asked(&["eta_v"], &gaps, |problem, found, _| (found.separation.rank, separation_words(problem, found)), false);
    assert_eq!(words.0, 1, "{}", words.1);
    assert!(words.1.contains("cannot tell apart `pump.h_s`, `pump.h_p`, `pump.h_v`"), "{}", words.1);
    assert!(words.1.contains("would help: pump.Q_p"), "{}", words.1);
}

/// The dry friction of a pair is its weight's complement times its coefficient.
#[test]
fn weight_and_coefficient_of_friction_are_said_to_be_inseparable() {
    let friction = ["w_p", "w_v", "mu_p", "mu_v"];
    let (rank, words) = asked(
        &["eta_v", "eta_m"],
        &friction,
        |problem, found, _| (found.separation.rank, separation_words(problem, found)),
        false,
    );
    assert!(rank < 4 && words.contains("cannot tell apart"), "{words}");
}

/// With slippers and plate known, the gap of the pistons and both weights are found.
#[test]
fn a_gap_and_the_weights_are_found() {
    let (names, truth) = (["h_p", "w_p", "w_v"], [24e-6, 0.7, 0.75]);
    asked(
        &["eta_v", "eta_m"],
        &names,
        |_, found, fit| {
            let fit = fit.expect("asked for");
            assert!(found.separation.blind.is_empty() && fit.converged, "{:?}", found.separation);
            for (j, (name, truth)) in names.iter().zip(truth).enumerate() {
                let (value, std) = (fit.values[j], fit.deviations[j]);
                assert!((value - truth).abs() < 3.0 * std && std < 0.05 * truth, "{name}: {value} +- {std}");
            }
        },
        true,
    );
}
