//! Functional mock-up units of other tools as components: units written in C (`tests/units`), for both standards and both
//! kinds, against closed forms and against the same equations in Modelica.
#![allow(clippy::disallowed_methods, reason = "makes units")]

#[path = "../units/pack.rs"]
mod pack;

use approx::abs_diff_eq;
use bramah::internals::compile::Request;
use bramah::world::DiskWorld;
use bramah::{Error, Outcome, Simulation};
use pack::{ARRAYS, BALL, CONTROLLER, FAULTY, Fmi, OSCILLATOR, TICKER, Unit};
use std::path::Path;

/// A folder with units and a model that names them.
struct Bench {
    folder: tempfile::TempDir,
}

impl Bench {
    fn new() -> Self {
        Bench { folder: tempfile::tempdir().expect("a folder") }
    }

    fn path(&self) -> &Path {
        self.folder.path()
    }

    /// The circuit compiled, with a unit beside it.
    fn compile(&self, unit: Unit, fmi: Fmi, text: &str) -> Result<Simulation, Error> {
        unit.make(fmi, self.path(), &[]);
        self.compile_text(text)
    }

    fn compile_text(&self, text: &str) -> Result<Simulation, Error> {
        let source = self.path().join("Bench.mo");
        std::fs::write(&source, text).expect("writable");
        Simulation::compile(&DiskWorld, &Request { source, ..Request::default() })
    }
}

fn run(mut simulation: Simulation, stop: f64) -> Outcome {
    simulation.stop_time(stop).settings().tolerance = 1e-9;
    simulation.run().unwrap_or_else(|e| panic!("{}", e.full()))
}

/// The values of a variable over time.
fn column(outcome: &Outcome, name: &str) -> Vec<f64> {
    outcome.trajectory.column(name).unwrap_or_else(|| panic!("no {name}")).to_vec()
}

fn assert_near(outcome: &Outcome, name: &str, tolerance: f64, truth: impl Fn(f64) -> f64) {
    let (times, values) = (&outcome.trajectory.times, column(outcome, name));
    for (t, y) in times.iter().zip(values) {
        let wanted = truth(*t);
        assert!(abs_diff_eq!(y, wanted, epsilon = tolerance), "{name} at {t}: {y} instead of {wanted}");
    }
}

/// Free motion of the oscillator.
fn swing(t: f64, x0: f64) -> f64 {
    let (m, c, d) = (2.0, 200.0, 3.0);
    let (delta, omega) = (d / (2.0 * m), f64::sqrt(c / m - d * d / (4.0 * m * m)));
    x0 * (-delta * t).exp() * ((omega * t).cos() + delta / omega * (omega * t).sin())
}

const SWINGS: &str = "model Bench FMU o(file = \"oscillatorN.fmu\", kind = \"HOW\", x0 = 0.05, step = 1e-3);
    equation o.f = 0; end Bench;";

fn both(mut check: impl FnMut(Fmi, &str)) {
    check(Fmi::Two, "2");
    check(Fmi::Three, "3");
}

#[test]
fn an_oscillator_moves_as_it_must() {
    both(|fmi, n| {
        for kind in ["me", "cs"] {
            let text = SWINGS.replace('N', n).replace("HOW", kind);
            let text = if kind == "me" { text.replace(", step = 1e-3", "") } else { text };
            let made = Bench::new().compile(OSCILLATOR, fmi, &text);
            let mut simulation = made.unwrap_or_else(|e| panic!("{}", e.full()));
            simulation.settings().event_rows = false;
            let outcome = run(simulation, 1.0);
            // the unit's own solver is of the first order
            let tolerance = if kind == "me" { 1e-8 } else { 2e-5 };
            assert_near(&outcome, "o.x", tolerance, |t| {
                // a step of Co-Simulation holds what was known at its beginning
                swing(if kind == "me" { t } else { (t / 1e-3 + 1e-6).floor() * 1e-3 }, 0.05)
            });
        }
    });
}

#[test]
fn equations_of_a_unit_are_solved_with_those_around_it() {
    let own = "  Real x(start = 0.1, fixed = true); Real v(start = 0, fixed = true); Real q(start = 1, fixed = true);
        equation der(x) = v; 2*der(v) = f - 3*v - 200*x; f = 50*q - 4*v; der(q) = -q - f*v;";
    let inside = "  FMU o(file = \"oscillatorN.fmu\", kind = \"me\"); Real q(start = 1, fixed = true);
        equation o.f = 50*q - 4*o.v; der(q) = -q - o.power;";
    let truth = Simulation::from_text(&format!("model Bench Real f; {own} end Bench;")).unwrap();
    let truth = column(&run(truth, 2.0), "q").last().copied().unwrap();
    both(|fmi, n| {
        let text = format!("model Bench {} end Bench;", inside.replace('N', n));
        let made = Bench::new().compile(OSCILLATOR, fmi, &text);
        let q = column(&run(made.unwrap(), 2.0), "q");
        assert!((q.last().unwrap() - truth).abs() < 1e-7, "{:e}", q.last().unwrap() - truth);
    });
}

#[test]
fn a_ball_bounces_where_it_must() {
    both(|fmi, n| {
        let text =
            format!("model Bench FMU b(file = \"ball{n}.fmu\", kind = \"me\"); Integer k = b.bounces; end Bench;");
        let made = Bench::new().compile(BALL, fmi, &text);
        let outcome = run(made.unwrap_or_else(|e| panic!("{}", e.full())), 3.0);
        let (times, k, h) = (&outcome.trajectory.times, column(&outcome, "k"), column(&outcome, "b.h"));
        let fall = f64::sqrt(2.0 / 9.81);
        let mut hit = fall;
        let mut speed = 9.81 * fall;
        for bounce in 1..=5 {
            let at = k.iter().position(|&k| k >= f64::from(bounce)).expect("it bounces");
            assert!((times[at] - hit).abs() < 1e-6, "bounce {bounce} at {} instead of {hit}", times[at]);
            speed *= 0.7;
            hit += 2.0 * speed / 9.81;
        }
        assert!(h.iter().all(|&h| h > -1e-6), "below the ground");
        assert_eq!(column(&outcome, "b.lies").last(), Some(&1.0));
    });
}

#[test]
fn events_of_known_time_and_of_discrete_inputs() {
    both(|fmi, n| {
        let text = format!(
            "model Bench FMU t(file = \"ticker{n}.fmu\", kind = \"me\", gain = 3); equation t.u = time; t.go = time > 0.55 and time < 0.77; end Bench;"
        );
        let made = Bench::new().compile(TICKER, fmi, &text);
        let outcome = run(made.unwrap_or_else(|e| panic!("{}", e.full())), 1.05);
        assert_near(&outcome, "t.through", 1e-9, |t| 11.0 * t);
        let last = |name: &str| column(&outcome, name).last().copied().unwrap();
        assert!((last("t.y") - 3.0).abs() < 1e-9, "{}", last("t.y"));
        assert_eq!(last("t.on"), 0.0);
        // ten ticks; each event counts a hundred while `go` is true: its own, and the ticks at 0.6 and 0.7
        assert_eq!(last("t.ticks"), 310.0);
    });
}

const AXIS: &str = "model Bench FMU c(file = \"controllerN.fmu\", step = 0.02, Kp = 0.08);
    Real p(start = 1e5, fixed = true, unit = \"Pa\");
    equation c.set = 20e5; c.measured = p; c.enable = time < 1.5; 0.3*der(p) = 40e5*c.u - p; end Bench;";

/// The same controller, scan by scan, and the pressure between by its closed form.
fn axis(stop: f64) -> Vec<(f64, f64)> {
    let (h, kp, ti) = (0.02, 0.08, 0.2);
    let (mut p, mut u, mut integral, mut measured) = (1.0, 0.0, 0.0, 1.0);
    let mut all = vec![(0.0, 1e5)];
    for k in 1..=(stop / h + 0.5) as usize {
        p = 40.0 * u + (p - 40.0 * u) * f64::exp(-h / 0.3);
        let error: f64 = 20.0 - measured;
        integral += h / ti * error;
        let enabled = (k - 1) as f64 * h < 1.5;
        u = if enabled { (kp * (error + integral)).clamp(-1.0, 1.0) } else { 0.0 };
        measured = p;
        all.push((k as f64 * h, p * 1e5));
    }
    all
}

#[test]
fn a_controller_scans_with_one_period_of_delay_and_units() {
    both(|fmi, n| {
        let made = Bench::new().compile(CONTROLLER, fmi, &AXIS.replace('N', n));
        let simulation = made.unwrap_or_else(|e| panic!("{}", e.full()));
        let outcome = run(simulation, 2.0);
        let (times, p) = (&outcome.trajectory.times, column(&outcome, "p"));
        for (t, truth) in axis(2.0) {
            let at = times.iter().position(|x| (x - t).abs() < 1e-9).expect("a row at each scan");
            assert!((p[at] - truth).abs() < 1e-5 * 20e5, "at {t}: {} instead of {truth}", p[at]);
        }
        assert_eq!(column(&outcome, "c.scans").last(), Some(&100.0));
    });
}

#[test]
fn runs_repeat_to_the_bit_also_in_threads_and_in_part() {
    let made = Bench::new().compile(CONTROLLER, Fmi::Two, &AXIS.replace('N', "2"));
    let simulation = made.unwrap();
    let one = column(&run(simulation.clone(), 2.0), "p");
    std::thread::scope(|scope| {
        let threads: Vec<_> = (0..8)
            .map(|k| {
                let mut own = simulation.clone();
                scope.spawn(move || {
                    own.set("c.Kp", 0.05 + 0.01 * f64::from(k)).unwrap();
                    column(&run(own, 2.0), "p")
                })
            })
            .collect();
        let all: Vec<Vec<f64>> = threads.into_iter().map(|t| t.join().unwrap()).collect();
        assert_eq!(all[3], one);
        assert!(all[0] != one);
    });
    let half = run(simulation.clone(), 1.0);
    let mut rest = simulation;
    rest.stop_time(2.0).settings().tolerance = 1e-9;
    let rest = rest.run_from(&half.state).unwrap();
    let (end, full) = (column(&rest, "p"), one.last().unwrap());
    assert!((end.last().unwrap() - full).abs() < 1e-6 * full);
}

#[test]
fn arrays_odd_names_texts_and_enumerations() {
    let text = "model Bench
        FMU a(file = \"arrays3.fmu\", kind = \"me\", mode = 2, A = {{1, 0, 0}, {0, 0, 1}}, 'block.offset[1]' = 5, 'step' = 7);
        FMU n(file = \"arrays3.fmu\", sign = \"negative\");
      equation a.u = {time, 1, 2}; n.u = {1, 1, 1}; end Bench;";
    let made = Bench::new().compile(ARRAYS, Fmi::Three, text);
    let outcome = run(made.unwrap_or_else(|e| panic!("{}", e.full())), 1.0);
    assert_near(&outcome, "a.y[1]", 1e-9, |t| 2.0 * t + 12.0);
    assert_near(&outcome, "a.y[2]", 1e-9, |_| 16.0);
    assert_near(&outcome, "n.y[2]", 1e-9, |_| -985.0);
}

/// What is said of a run that fails.
fn failure(made: Result<Simulation, Error>) -> String {
    let failed = made.and_then(|mut s| s.stop_time(1.0).run().map(drop));
    failed.expect_err("it fails").full()
}

#[test]
fn a_unit_that_fails_ends_the_run_with_its_own_words() {
    both(|fmi, n| {
        for kind in ["cs", "me"] {
            let says = |fault: u32| {
                let text = format!(
                    "model Bench FMU f(file = \"faulty{n}.fmu\", kind = \"{kind}\", fault = {fault}); end Bench;"
                );
                Bench::new().compile(FAULTY, fmi, &text)
            };
            let made = says(5);
            run(made.unwrap_or_else(|e| panic!("{}", e.full())), 1.0);
            for (fault, words) in [
                (1, "no pressure at port B"),
                (2, "the map of the valve ends at 0.5 s"),
                (3, "not finite"),
                (4, "too far"),
            ] {
                let said = failure(says(fault));
                assert!(said.contains(words), "{kind} {fault}: {said}");
            }
        }
    });
}

#[test]
fn units_that_cannot_be_used_say_why() {
    let bench = Bench::new();
    let says = |bytes: &[u8], more: &str| {
        std::fs::write(bench.path().join("x.fmu"), bytes).unwrap();
        let text = format!("model Bench FMU u(file = \"x.fmu\"{more}); equation u.f = 0; end Bench;");
        failure(bench.compile_text(&text))
    };
    let description = OSCILLATOR.description(Fmi::Two);
    let with = |text: &str| {
        pack::archive(&[("modelDescription.xml", text.as_bytes()), ("binaries/win64/oscillator.dll", b"")])
    };
    assert!(says(b"no archive", "").contains("E029"));
    assert!(says(&pack::archive(&[("a", b"")]), "").contains("modelDescription.xml"));
    assert!(says(&with("<fmiModelDescription"), "").contains("no valid XML"));
    assert!(says(&with(&description.replace("2.0", "1.0")), "").contains("FMI 1.0"));
    let here = says(&with(&description), "");
    assert!(here.contains("libraries for win64"), "{here}");
    assert!(says(&with(&description), ", kind = \"x\"").contains("`kind` is"));
    let path = OSCILLATOR.make(Fmi::Two, bench.path(), &["-DREFUSES"]);
    let refused = says(&std::fs::read(path).unwrap(), "");
    assert!(refused.contains("the licence for oscillator has expired"), "{refused}");
    let path = OSCILLATOR.make(Fmi::Three, bench.path(), &["-DNO_STEP"]);
    let lacking = says(&std::fs::read(path).unwrap(), "");
    assert!(lacking.contains("no function for `do step`"), "{lacking}");
    let path = OSCILLATOR.make(Fmi::Three, bench.path(), &[]);
    let good = std::fs::read(path).unwrap();
    let none = failure(bench.compile_text("model Bench FMU u(file = \"nothing.fmu\"); end Bench;"));
    assert!(none.contains("E902") && none.contains("nothing.fmu"), "{none}");
    let bare = failure(bench.compile_text("model Bench FMU u; end Bench;"));
    assert!(bare.contains("E213"), "{bare}");
    // damaged at random places: a message, or a run, and never a panic
    for k in 0..60 {
        let mut bytes = good.clone();
        let at = k * 7919 % (bytes.len() - 400) + 200;
        // not in the code: what runs there cannot be guarded
        if k % 2 == 0 {
            bytes.truncate(at)
        } else {
            let end = bytes.len();
            bytes[end - 1 - k * 5] ^= 0x55
        }
        std::fs::write(bench.path().join("x.fmu"), &bytes).unwrap();
        let _ = bench.compile_text("model Bench FMU u(file = \"x.fmu\"); equation u.f = 0; end Bench;");
    }
}

#[test]
fn names_and_units_of_ports_are_checked() {
    let bench = Bench::new();
    CONTROLLER.make(Fmi::Two, bench.path(), &[]);
    let says = |equations: &str, more: &str| {
        let text = format!(
            "model Bench FMU c(file = \"controller2.fmu\"{more}); Real q(unit = \"m3/s\") = time; equation {equations} end Bench;"
        );
        match bench.compile_text(&text) {
            Ok(s) => s.diagnostics.iter().map(|d| format!("{} {}", d.code, d.message)).collect::<Vec<_>>().join("\n"),
            Err(e) => e.full(),
        }
    };
    let unit = says("c.set = q; c.measured = 0; c.enable = true;", "");
    assert!(unit.contains("W230"), "{unit}");
    assert!(says("c.set = 0; c.measurd = 0; c.enable = true;", "").contains("measured"));
    assert!(says("c.set = 0; c.measured = 0; c.enable = true;", ", Kpp = 1").contains("did you mean `Kp`"));
    assert!(says("c.set = 0; c.measured = 0;", "").contains("`c.enable`"));
}

const SLIDE: &str = r#"package Slide
  model Nominal "A slide whose force comes from a controller of another tool"
    input Real w(unit = "m") "Where it is to go";
    FMU c(file = "controller2.fmu", step = 0.01, Kp = 1, Ti = 1);
    Mechanical.Translational.Mass mass(m = 10, s(start = 0, fixed = true), v(start = 0, fixed = true));
    Mechanical.Translational.SpringDamper spring(c = 400, d = 60);
    Mechanical.Translational.Fixed wall;
    Mechanical.Translational.Force push;
  equation
    c.set = 1e5*w;
    c.measured = 1e5*mass.s;
    c.enable = true;
    push.f = 400*c.u;
    connect(wall.flange, spring.flange_a);
    connect(spring.flange_b, mass.flange_a);
    connect(push.flange, mass.flange_b);
  end Nominal;
  model Rig "The same with dry friction"
    extends Nominal;
    Mechanical.Translational.SmoothSupportFriction rub(f_c = 4);
  equation
    connect(rub.flange_a, mass.flange_b);
  end Rig;
end Slide;"#;

/// A recording of the slide, with noise of its sensor, and the study that ties it to the model.
fn recorded(bench: &Bench, class: &str, values: &[(&str, f64)], seed: u64, file: &str) {
    let request =
        Request { source: bench.path().join("Slide.mo"), model: Some(class.to_owned()), ..Request::default() };
    let mut rig = Simulation::compile(&DiskWorld, &request).unwrap_or_else(|e| panic!("{}", e.full()));
    for (name, value) in values {
        rig.set(name, *value).expect("a parameter");
    }
    let mut noise = seed;
    let mut random = || {
        noise = noise.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (noise >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    let steps: Vec<f64> = (0..12).map(|_| 0.4 * random()).collect();
    let times: Vec<f64> = (0..=1200).map(|k| 0.005 * f64::from(k)).collect();
    let wanted: Vec<f64> = times.iter().map(|t| steps[((t / 0.5) as usize).min(11)]).collect();
    rig.input("w", &times, &wanted, bramah::Interpolation::Held).expect("an input");
    rig.settings().event_rows = false;
    rig.stop_time(6.0).settings().interval = 0.005;
    let outcome = rig.run().unwrap_or_else(|e| panic!("{}", e.full()));
    let (s, v) = (column(&outcome, "mass.s"), column(&outcome, "mass.v"));
    let mut text = "t,w,s,v\n".to_owned();
    for (k, t) in outcome.trajectory.times.iter().enumerate() {
        text += &format!("{t},{},{},{}\n", wanted[k.min(1200)], s[k] + 4e-5 * random(), v[k] + 4e-4 * random());
    }
    std::fs::write(bench.path().join(file), text).expect("writable");
}

const STUDY: &str = r#"version = 1
model = "Slide.mo"
class = "Slide.Nominal"
[inputs]
w = { column = "w", unit = "m" }
[signals]
s = { variable = "mass.s", column = "s", unit = "m" }
v = { variable = "mass.v", column = "v", unit = "m/s" }
[[recordings]]
file = "a.csv"
role = "train"
time = "t"
[[recordings]]
file = "b.csv"
role = "held"
time = "t"
[parameters]
"mass.m" = { sigma = "3 %" }
"spring.c" = { sigma = "3 %" }
"spring.d" = { sigma = "10 %" }
"#;

fn slide() -> Bench {
    let bench = Bench::new();
    CONTROLLER.make(Fmi::Two, bench.path(), &[]);
    std::fs::write(bench.path().join("Slide.mo"), SLIDE).expect("writable");
    std::fs::write(bench.path().join("study.toml"), STUDY).expect("writable");
    bench
}

#[test]
fn parameters_are_found_around_a_unit() {
    let bench = slide();
    let truth = [("mass.m", 10.3), ("spring.c", 391.0), ("spring.d", 66.0)];
    recorded(&bench, "Slide.Nominal", &truth, 1, "a.csv");
    recorded(&bench, "Slide.Nominal", &truth, 2, "b.csv");
    let found =
        bramah::identify(&DiskWorld, &bench.path().join("study.toml")).unwrap_or_else(|e| panic!("{}", e.full()));
    for (name, value) in truth {
        let parameter = &serde_json::to_value(&found.report).unwrap()["parameters"][name];
        let (at, std) = (parameter["value"].as_f64().unwrap(), parameter["std"].as_f64().unwrap());
        assert!((at - value).abs() < (4.0 * std).max(0.01 * value), "{name}: {at} +- {std} instead of {value}");
    }
}

#[test]
fn a_diagnosis_refuses_what_samples() {
    let bench = slide();
    recorded(&bench, "Slide.Nominal", &[], 1, "a.csv");
    recorded(&bench, "Slide.Nominal", &[], 2, "b.csv");
    let refused = bramah::diagnose(&DiskWorld, &bench.path().join("study.toml")).err().expect("refused").full();
    assert!(refused.contains("cannot follow a model that samples") && refused.contains("controller2.fmu"), "{refused}");
}

#[test]
fn an_effect_is_found_around_a_unit() {
    let bench = slide();
    OSCILLATOR.make(Fmi::Three, bench.path(), &[]);
    // the force follows the input through a unit that is solved with the slide
    let unit = "FMU c(file = \"oscillator3.fmu\", kind = \"me\", d = 40, x0 = 0);";
    let (head, rest) = SLIDE.split_once("FMU c").unwrap();
    let rest = rest.split_once(";\n").unwrap().1;
    let text = format!("{head}{unit}\n{rest}");
    let text = text.replace(
        "c.set = 1e5*w;\n    c.measured = 1e5*mass.s;\n    c.enable = true;\n    push.f = 400*c.u;",
        "c.f = 200*w;\n    push.f = 400*c.x;",
    );
    assert!(text.contains("400*c.x"));
    std::fs::write(bench.path().join("Slide.mo"), text).unwrap();
    recorded(&bench, "Slide.Rig", &[], 3, "a.csv");
    recorded(&bench, "Slide.Rig", &[], 4, "b.csv");
    // without a budget every hypothesis is fitted through the unit: minutes
    let start = std::time::Instant::now();
    let gone = || start.elapsed();
    let budget = Some(bramah::Budget { time: Some(std::time::Duration::from_secs(40)), gone: &gone });
    let options = bramah::DiagnoseOptions { budget, ..Default::default() };
    let study = bench.path().join("study.toml");
    let mut go_on = |_| std::ops::ControlFlow::Continue(());
    let (diagnosis, _) =
        bramah::diagnose_as(&DiskWorld, &study, options, &mut go_on).unwrap_or_else(|e| panic!("{}", e.full()));
    let effects: Vec<&str> = diagnosis.verdict().effects.iter().map(|e| e.effect.as_str()).collect();
    assert_eq!(effects, ["Effects.TranslationalDryFriction"], "{}", diagnosis.words());
    let corrected = diagnosis.corrected().value.expect("it can be written");
    assert!(corrected.contains("oscillator3.fmu"), "{corrected}");
}

#[test]
fn runs_of_one_circuit_may_start_at_other_times() {
    let text =
        "model Bench FMU t(file = \"ticker2.fmu\", kind = \"me\"); equation t.u = time; t.go = false; end Bench;";
    let simulation = Bench::new().compile(TICKER, Fmi::Two, text).unwrap_or_else(|e| panic!("{}", e.full()));
    // a start that goes no further leaves an instance behind
    let mut later = simulation.clone();
    drop(simulation.stepping().unwrap());
    later.settings().start_time = 5.0;
    let outcome = run(later, 6.0);
    assert_near(&outcome, "t.through", 1e-9, |t| 11.0 * t);
}
