//! Runs that are taken up at a checkpoint go on as if they had never stopped, to the last bit.
#![allow(clippy::disallowed_methods, reason = "starts the command and kills it")]

use bramah::Request;
use bramah::internals::compile::{CompiledModel, compile};
use bramah::internals::lower;
use bramah::internals::solve::{Checkpoint, Control, RecordedInput, RowSink, RunResult, Settings, resume, simulate};
use bramah::internals::structure::StateChoice;
use bramah::world::MemoryWorld;
use std::ops::ControlFlow;
use std::path::Path;
use std::process::{Command, Output};

/// Rows, bit by bit, and checkpoints with the number of rows before each.
#[derive(Default)]
struct Tape {
    rows: Vec<Vec<u64>>,
    checkpoints: Vec<(usize, String)>,
}

impl RowSink for Tape {
    fn row(&mut self, time: f64, values: &[f64]) -> ControlFlow<()> {
        self.rows.push(std::iter::once(time).chain(values.iter().copied()).map(f64::to_bits).collect());
        ControlFlow::Continue(())
    }

    fn checkpoint(&mut self, at: &Checkpoint) -> ControlFlow<()> {
        self.checkpoints.push((self.rows.len(), at.text()));
        ControlFlow::Continue(())
    }
}

fn model(text: &str) -> CompiledModel {
    let request = Request { source: "M.mo".into(), ..Request::default() };
    let outcome = compile(&MemoryWorld::single("M.mo", text), &request, &lower::LoweringOptions::default());
    outcome.value.unwrap_or_else(|| panic!("{:?}", outcome.diagnostics))
}

fn settings(model: &CompiledModel, every: f64) -> Settings {
    let wanted = (0u32..).zip(&model.flat.variables).map(|(i, _)| bramah::internals::expr::VarId(i)).collect();
    Settings { wanted, checkpoint_every: every, ..Settings::from_experiment(&model.flat.experiment) }
}

/// Runs whole, then again from every checkpoint, and compares.
fn goes_on(text: &str, every: f64, inputs: &[RecordedInput]) -> (RunResult, Tape) {
    let model = model(text);
    let settings = settings(&model, every);
    let mut reselect = |choice: &StateChoice| model.with_states(choice);
    let mut whole = Tape::default();
    let mut control = Control { reselect: Some(&mut reselect), ..Control::default() };
    let run = simulate(&model.system, &settings, inputs, None, &mut whole, &mut control);
    assert!(run.end.is_success(), "{:?}", run.diagnostics);
    assert!(whole.checkpoints.len() > 2, "{} checkpoints", whole.checkpoints.len());
    for (i, (before, text)) in whole.checkpoints.iter().enumerate() {
        let from = Checkpoint::from_text(text).expect("it was written so");
        let mut again = |choice: &StateChoice| model.with_states(choice);
        let mut control = Control { reselect: Some(&mut again), ..Control::default() };
        let mut rest = Tape::default();
        let ended = resume(&model.system, &settings, inputs, &from, &mut rest, &mut control);
        assert!(rest.rows == whole.rows[*before..], "other rows from checkpoint {i} on");
        assert!(rest.checkpoints.iter().map(|c| &c.1).eq(whole.checkpoints[i + 1..].iter().map(|c| &c.1)));
        assert_eq!((ended.time, ended.end), (run.time, run.end.clone()));
        assert_eq!((ended.statistics.steps, ended.statistics.events), (run.statistics.steps, run.statistics.events));
    }
    (run, whole)
}

#[test]
fn bounces_and_counters() {
    let (run, _) = goes_on(
        "model M
           Real h(start = 1, fixed = true), v(start = 0, fixed = true);
           discrete Integer n(start = 0, fixed = true);
           discrete Real last(start = 0, fixed = true);
           Boolean falling = v < 0;
         equation
           der(h) = v;
           der(v) = -9.81;
           when h < 0 then
             reinit(v, -0.9*pre(v));
             n = pre(n) + 1;
             last = time;
           end when;
           annotation(experiment(StopTime = 3, Interval = 0.01));
         end M;",
        0.137,
        &[],
    );
    assert!(run.statistics.events > 5);
}

/// What is delayed has a past: jumps and bends in it too.
#[test]
fn delays() {
    let (run, _) = goes_on(
        "model M
           Real x(start = 1, fixed = true), u, y;
         equation
           u = if sin(7*time) > 0.5 then 1 else 0;
           y = delay(u, 0.45);
           der(x) = -4*delay(x, 0.3) + y;
           annotation(experiment(StopTime = 3, Interval = 0.01));
         end M;",
        0.137,
        &[],
    );
    assert!(run.statistics.events > 10);
}

/// Dry friction that sticks and slips, sampled control with seeded noise, and a parameter found at the start.
#[test]
fn friction_sampling_and_noise() {
    goes_on(
        "model M
           Mechanical.Rotational.Inertia rotor(J = 0.1, phi(fixed = true), w(fixed = true));
           Mechanical.Rotational.BearingFriction bearing(tau_c = 2, tau_s = 3);
           Mechanical.Rotational.Torque motor;
           Signal.Measured speed(tau = 0.01, samplePeriod = 0.005, std = 0.1, delay = 2, seed = 7);
           Signal.Pulse reference(amplitude = 20, period = 0.7);
           parameter Real k(fixed = false, start = 1);
           parameter Real gain = 2*k;
         initial equation
           k^3 = 0.008;
         equation
           speed.u = rotor.w;
           motor.tau = gain*(reference.y - speed.y);
           connect(motor.flange, rotor.flange_a);
           connect(rotor.flange_b, bearing.flange_a);
           annotation(experiment(StopTime = 2, Interval = 0.002));
         end M;",
        0.1,
        &[],
    );
}

/// States are chosen anew while the pendulum goes round.
#[test]
fn states_chosen_on_the_way() {
    goes_on(
        "model M
           Real x(start = 1), y(start = 0, fixed = true), vx(start = 0), vy(start = -7, fixed = true), F;
         equation
           vx = der(x);
           vy = der(y);
           der(vx) = -F*x;
           der(vy) = -F*y - 9.81;
           x^2 + y^2 = 1;
           annotation(experiment(StopTime = 5, Interval = 0.01));
         end M;",
        0.3,
        &[],
    );
}

#[test]
fn recorded_inputs_and_loops() {
    let text = "model M
           input Real u, w;
           Real x(start = 0, fixed = true), y(start = 1);
         equation
           der(x) = u - y;
           y + 0.1*y^3 = x + w;
           annotation(experiment(StopTime = 2, Interval = 0.03));
         end M;";
    let compiled = model(text);
    let times: Vec<f64> = (0..40).map(|k| f64::from(k) * 0.05).collect();
    let values: Vec<f64> = times.iter().map(|t| (3.0 * t).sin()).collect();
    let input = |i: usize| compiled.dae.inputs[i];
    let inputs =
        [RecordedInput::held(input(0), times.clone(), values.clone()), RecordedInput::linear(input(1), times, values)];
    // checkpoints upon samples, and between them
    for every in [0.25, 0.17] {
        goes_on(text, every, &inputs);
    }
}

/// Checkpoints do not change what is right.
#[test]
fn the_restarts_stay_within_the_tolerance() {
    let text = "model M Real x(start = 1, fixed = true), v(start = 0, fixed = true);
         equation der(x) = v; der(v) = -x; annotation(experiment(StopTime = 6)); end M;";
    let (run, _) = goes_on(text, 0.5, &[]);
    let x = run.state.values[run.state.names.iter().position(|n| n == "x").expect("a variable")];
    assert!((x - 6.0_f64.cos()).abs() < 1e-4, "{x}");
}

/// A chain that keeps the command busy for a while.
const CHAIN: &str = "
model Chain
  parameter Integer n = 40;
  Real x[n](each start = 0, each fixed = true), v[n](each start = 0, each fixed = true);
  discrete Integer ticks(start = 0, fixed = true);
equation
  der(x) = v;
  der(v[1]) = sin(time) - 2*x[1] + x[2] - 0.01*v[1];
  for i in 2:n - 1 loop
    der(v[i]) = x[i - 1] - 2*x[i] + x[i + 1] - 0.01*v[i];
  end for;
  der(v[n]) = x[n - 1] - x[n];
  when sample(0, 0.7) then
    ticks = pre(ticks) + 1;
  end when;
  annotation(experiment(StopTime = 1500, Interval = 0.05));
end Chain;
";

fn bramah(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_bramah"));
    command.current_dir(folder).args(["simulate", "Chain.mo"]).args(arguments);
    command
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn a_killed_command_goes_on() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    std::fs::write(at("Chain.mo"), CHAIN).expect("written");
    let run = |arguments: &[&str]| bramah(folder.path(), arguments).output().expect("it starts");
    let whole = run(&["--checkpoint", "whole.checkpoint", "-o", "whole.csv"]);
    assert!(whole.status.success(), "{}", said(&whole));
    assert!(!at("whole.checkpoint").exists() && !at("whole.csv.part").exists());

    let arguments = ["--checkpoint", "killed.checkpoint", "-o", "killed.csv"];
    let mut killed = bramah(folder.path(), &arguments).spawn().expect("it starts");
    while !at("killed.checkpoint").exists() && killed.try_wait().expect("it runs").is_none() {
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
    killed.kill().expect("it is there");
    killed.wait().expect("it ends");
    assert!(at("killed.checkpoint").exists() && !at("killed.csv").exists(), "killed on the way");
    // the machine may have stopped in the middle of a row
    let mut part = std::fs::read(at("killed.csv.part")).expect("the part");
    part.extend_from_slice(b"75.1,0.2");
    std::fs::write(at("killed.csv.part"), part).expect("written");

    for (changed, why) in [
        (["--set", "n=41"], "another model"),
        (["--relative-tolerance", "1e-7"], "another settings"),
        (["--checkpoint-every", "3"], "another settings"),
    ] {
        let refused = run(&[&arguments[..], &changed[..]].concat());
        assert_eq!(refused.status.code(), Some(2));
        assert!(said(&refused).contains("E606") && said(&refused).contains(why), "{}", said(&refused));
    }
    let other = run(&["--checkpoint", "killed.checkpoint", "-o", "other.csv"]);
    assert!(said(&other).contains("the result of its run is `killed.csv`"), "{}", said(&other));

    let resumed = run(&arguments);
    assert!(resumed.status.success() && said(&resumed).contains("going on from"), "{}", said(&resumed));
    let bytes = |name: &str| std::fs::read(at(name)).expect("a result");
    assert!(bytes("whole.csv") == bytes("killed.csv"), "the results differ");
    assert!(!at("killed.checkpoint").exists() && !at("killed.csv.part").exists());
}

#[test]
fn what_cannot_have_checkpoints_is_told() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("Chain.mo"), CHAIN).expect("written");
    std::fs::write(folder.path().join("notes.txt"), "not this\n").expect("written");
    for (arguments, why) in [
        (&["--checkpoint", "c", "-o", "out.mat"][..], "writes a CSV file"),
        (&["--checkpoint", "c", "-o", "-"], "writes a CSV file"),
        (&["--checkpoint", "c", "--plot", "p.svg"], "cannot be drawn at once"),
        (&["--checkpoint", "notes.txt"], "it is no file of checkpoints"),
        (&["--checkpoint-every", "1"], "--checkpoint"),
        (&["--checkpoint", "c", "--checkpoint-every", "0"], "write a positive one"),
    ] {
        let refused = bramah(folder.path(), arguments).output().expect("it starts");
        assert_eq!(refused.status.code(), Some(2), "{}", said(&refused));
        assert!(said(&refused).contains(why), "{}", said(&refused));
    }
    assert_eq!(std::fs::read_to_string(folder.path().join("notes.txt")).expect("still there"), "not this\n");
}
