//! The crate from outside: steps with inputs set in between, rows handed to a function, and misuse.

use bramah::Code;
use bramah::internals::solve::{End, Interpolation};
use bramah::{Error, Simulation};
use std::ops::ControlFlow;

const LAG: &str = "
model Lag
  input Real u(start = 0);
  parameter Real T = 0.1;
  Real x(start = 0, fixed = true), y(start = 0, fixed = true);
  Boolean high = y > 0.5;
  discrete Integer count(start = 0, fixed = true);
equation
  T*der(x) = u - x;
  T*der(y) = x - y;
  when high then
    count = pre(count) + 1;
  end when;
end Lag;";

fn lag() -> Simulation {
    Simulation::from_text(LAG).unwrap_or_else(|e| panic!("{e}"))
}

fn trajectory(k: u32) -> f64 {
    1.0 + (f64::from(k) * 0.05).sin()
}

fn code(error: &Error) -> Code {
    error.diagnostics[0].code
}

/// A failed `unwrap` shows the messages, not the texts of the library.
#[test]
fn an_error_in_debug_is_its_messages() {
    let error = Simulation::from_text("model M Hydraulic.Volume v(W = 1); end M;").unwrap_err();
    let shown = format!("{error:?}");
    assert!(shown.contains("E012") && shown.len() < 2000, "{shown}");
}

#[test]
fn steps_give_what_a_recorded_input_gives() {
    let mut whole = lag();
    let times: Vec<f64> = (0..500).map(|k| f64::from(k) * 1e-3).collect();
    let values: Vec<f64> = (0..500).map(trajectory).collect();
    whole.input("u", &times, &values, Interpolation::Held).expect("an input").stop_time(0.5);
    let outcome = whole.run().expect("it runs");
    let stepped = lag();
    let mut run = stepped.stepping().expect("it starts");
    let (u, y, count) = (run.input("u").expect("u"), run.probe("y").expect("y"), run.probe("count").expect("count"));
    for k in 0..500 {
        run.set(u, trajectory(k));
        run.step_to(f64::from(k + 1) * 1e-3).expect("it steps");
    }
    let last = |name: &str| *outcome.trajectory.column(name).and_then(|c| c.last()).expect("a row");
    assert!((run.get(y) - last("y")).abs() < 1e-5, "{} {}", run.get(y), last("y"));
    assert_eq!(run.get(count), last("count"));
    assert!(run.statistics().steps > 0 && run.terminated().is_none());
    // and on from there, in another way
    let state = run.state();
    assert!(whole.stop_time(0.6).run_from(&state).is_ok());
}

#[test]
fn a_function_may_end_the_run_and_its_panic_is_an_error() {
    let mut simulation = lag();
    simulation.record(&["y"]).expect("a variable").stop_time(1.0);
    let ended = simulation
        .run_rows(None, |time, _| if time < 0.3 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) })
        .expect("ending is fine");
    assert_eq!(ended.end, End::Interrupted);
    assert!((ended.state.time - 0.3).abs() < 0.01);
    let error = simulation.run_rows(None, |_, _| panic!("enough")).expect_err("it panicked");
    assert_eq!(code(&error), Code::CallbackPanicked);
    assert!(error.to_string().contains("enough"), "{error}");
    assert!(simulation.run().is_ok(), "the simulation remains of use");
}

#[test]
fn misuse_is_told_by_codes() {
    let mut simulation = lag();
    assert_eq!(code(&simulation.record(&["z"]).map(|_| ()).expect_err("no such variable")), Code::BadSet);
    assert_eq!(code(&simulation.set("u", 1.0).map(|_| ()).expect_err("no parameter")), Code::BadSet);
    let mut run = simulation.stepping().expect("it starts");
    assert_eq!(code(&run.input("x").map(|_| ()).expect_err("no input")), Code::BadMap);
    assert_eq!(code(&run.probe("z").map(|_| ()).expect_err("no variable")), Code::BadSet);
    assert_eq!(code(&run.step(-1.0).expect_err("backwards")), Code::BadArgument);
    assert_eq!(code(&run.step(f64::NAN).expect_err("nowhere")), Code::BadArgument);
    assert!(run.step(0.0).is_ok() && run.step(0.1).is_ok());
    assert!(Simulation::from_text("model M Real x; end M;").is_err());
}

#[test]
fn parameters_can_be_asked_for() {
    let text = "model P parameter Real a = 2, b = 3*a; constant Real c = 5; Real x = b*c*time; end P;";
    let mut simulation = Simulation::from_text(text).unwrap_or_else(|e| panic!("{e}"));
    let value = |s: &Simulation, name| s.get(name).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!((value(&simulation, "b"), value(&simulation, "c")), (6.0, 5.0));
    simulation.set("a", 4.0).expect("a parameter");
    assert_eq!((value(&simulation, "a"), value(&simulation, "b")), (4.0, 12.0));
    simulation.set("b", 1.0).expect("a parameter");
    assert_eq!(value(&simulation, "b"), 1.0);
    let wrong = simulation.get("x").expect_err("no parameter");
    assert!(code(&wrong) == Code::BadSet && wrong.to_string().contains("`x` is not a parameter"));
}

#[test]
fn a_value_outside_its_range_is_refused_as_the_command_does() {
    let text = "model M parameter Real a(min = 0, max = b, unit = \"m\") = 1; parameter Real b = 2; Real x = a; end M;";
    let mut simulation = Simulation::from_text(text).unwrap_or_else(|e| panic!("{e}"));
    for wrong in [-1.0, 3.0, f64::NAN, f64::INFINITY] {
        let error = simulation.set("a", wrong).map(|_| ()).expect_err("outside");
        assert_eq!(code(&error), Code::OutOfRange, "{wrong}: {error}");
    }
    simulation.set("b", 4.0).expect("a parameter");
    simulation.set("a", 3.0).expect("within the new limit");
    assert_eq!(simulation.get("a").expect("a parameter"), 3.0);
}

#[test]
fn a_state_from_behind_the_stop_time_goes_on() {
    let text = "model Lag Real y(start = 1, fixed = true); equation der(y) = -y; annotation(experiment(StopTime = 1)); end Lag;";
    let mut lag = Simulation::from_text(text).unwrap();
    let state = lag.stop_time(2.0).run().unwrap().state;
    lag.stop_time(1.0);
    let mut run = lag.stepping_from(&state).unwrap();
    let y = run.probe("y").unwrap();
    run.step(1.0).unwrap();
    assert!((run.get(y) - (-3.0_f64).exp()).abs() < 1e-4);
    let other = Simulation::from_text("model M Real x; equation x = time; end M;").unwrap();
    assert!(other.stepping_from(&state).is_err());
}

#[test]
fn an_input_that_is_set_does_not_go_back_when_a_controller_samples() {
    let text = "model Held input Real u; discrete Real y(start = 0, fixed = true);
        equation when sample(0.1, 0.1) then y = u; end when; end Held;";
    let mut held = Simulation::from_text(text).unwrap();
    held.input("u", &[0.0], &[1.0], Interpolation::Held).unwrap();
    let mut run = held.stepping().unwrap();
    let (u, y) = (run.input("u").unwrap(), run.probe("y").unwrap());
    run.step(0.05).unwrap();
    run.set(u, 2.0);
    run.step(0.02).unwrap();
    run.step(0.08).unwrap();
    assert_eq!(run.get(y), 2.0);
}

#[test]
fn a_model_for_others_to_integrate_has_its_events() {
    let text = "model Saw input Real u(start = 1); Real x(start = 0, fixed = true); Integer n(start = 0, fixed = true);
        equation der(x) = u; when x > 1 then reinit(x, x - 1); n = pre(n) + 1; end when;
        end Saw;";
    let saw = Simulation::from_text(text).unwrap();
    let mut model = saw.exchange().unwrap();
    let (u, n) = (model.input("u").unwrap(), model.probe("n").unwrap());
    model.set(u, 2.0);
    assert_eq!(model.derivatives().unwrap(), [2.0]);
    let before = model.indicators().unwrap().to_vec();
    model.set_time(0.5);
    model.set_states(&[1.0 + 1e-9]);
    let after = model.indicators().unwrap().to_vec();
    assert!(before.iter().zip(&after).any(|(a, b)| a * b < 0.0), "{before:?} {after:?}");
    let happened = model.event().unwrap();
    assert!(happened.states_changed && model.states()[0] < 1e-6, "{happened:?}");
    assert_eq!(model.get(n).unwrap(), 1.0);
    let delayed = "model Late input Real u(start = 0); Real y = delay(u, 0.1); end Late;";
    let refused = Simulation::from_text(delayed).unwrap().exchange().err().expect("refused").full();
    assert!(refused.contains("E017") && refused.contains("delay"), "{refused}");
}
