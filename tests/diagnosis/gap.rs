//! The diagnosis on small plants made here: what is missing is found, and nothing is found where nothing is missing.

#![allow(clippy::unwrap_used, reason = "tests")]

use crate::rig;

use bramah::Interpolation;
use bramah::Sources;
use bramah::internals::gap::estimate::simulation::from_start;
use bramah::internals::gap::fixed::corrected;
use bramah::internals::gap::plan::{EffectPair, plan};
use bramah::internals::gap::report::report;
use bramah::internals::gap::select::models;
use bramah::internals::gap::select::search::{explained, search};
use bramah::internals::gap::study::{planned, question};
use bramah::internals::gap::verdict::{Verdict, conclude};
use bramah::internals::study::Study;
use bramah::world::MemoryWorld;
use bramah::{Request, Simulation};
use rig::{Numbers, ORIFICE};
use std::fmt::Write;
use std::ops::ControlFlow;
use std::path::Path;

/// A slide on a spring with its own connectors; the plant has dry friction of another form than the library's, waves of
/// friction over the position and friction above a speed, which are in no library.
const MODEL: &str = "
package Slide
  connector Flange Real s(unit = \"m\"); flow Real f(unit = \"N\"); end Flange;
  model Mass
    Flange flange;
    parameter Real m(unit = \"kg\") = 10;
    Real s(unit = \"m\", start = 0, fixed = true, nominal = 0.1);
    Real v(unit = \"m/s\", start = 0, fixed = true, nominal = 0.1);
  equation
    s = flange.s; v = der(s); m*der(v) = flange.f;
  end Mass;
  model Spring
    Flange flange;
    parameter Real c(unit = \"N/m\") = 400;
    parameter Real d(unit = \"N.s/m\") = 30;
  equation
    flange.f = c*flange.s + d*der(flange.s);
  end Spring;
  model Push
    Flange flange;
    input Real u(unit = \"N\");
  equation
    flange.f = -u;
  end Push;
  model Rub
    Flange flange;
    parameter Real F(unit = \"N\") = 0;
    parameter Real W(unit = \"N\") = 0;
    parameter Real Z(unit = \"N\") = 0;
    parameter Real P(unit = \"N\") = 0;
    parameter Real phase(unit = \"rad\") = 1;
    Real v(unit = \"m/s\");
  equation
    v = der(flange.s);
    flange.f = (F + W*(1 + sin(60*flange.s)) + Z*0.5*(1 + tanh((abs(v) - 0.15)/0.01)))*v/sqrt(v^2 + 1e-5) + P*sin(9*time + phase);
  end Rub;
  model Nominal
    input Real u(unit = \"N\");
    Mass mass; Spring spring; Push push(u = u);
  equation
    connect(mass.flange, spring.flange); connect(push.flange, mass.flange);
  end Nominal;
  model Plant
    extends Nominal(mass(m = 10.1), spring(d = 31));
    Rub rub;
  equation
    connect(rub.flange, mass.flange);
  end Plant;
end Slide;";

const STUDY: &str = "
version = 1
model = \"Slide.mo\"
class = \"Slide.Nominal\"
[inputs]
u = { column = \"u\", unit = \"N\", hold = true }
[signals]
s = { variable = \"mass.s\", column = \"s\", unit = \"m\" }
v = { variable = \"mass.v\", column = \"v\", unit = \"m/s\" }
[[recordings]]
file = \"train.csv\"
role = \"train\"
time = \"t\"
[[recordings]]
file = \"held.csv\"
role = \"held\"
time = \"t\"
[parameters]
\"mass.m\" = { sigma = \"2 %\" }
\"spring.c\" = { sigma = \"2 %\" }
\"spring.d\" = { sigma = \"10 %\" }
";

/// Numbers of a normal distribution, the same for the same seed.
pub struct Normal(pub Numbers);

impl Normal {
    pub fn next(&mut self) -> f64 {
        (0..12).map(|_| self.0.next()).sum::<f64>() - 6.0
    }
}

/// A recording of the plant with this friction under steps of random height.
fn recording(world: &MemoryWorld, friction: (&str, f64), seed: u64) -> String {
    recorded(world, &[friction], seed)
}

/// The same with several parameters changed.
fn recorded(world: &MemoryWorld, changed: &[(&str, f64)], seed: u64) -> String {
    let signals = [("s", "mass.s", 2e-4), ("v", "mass.v", 2e-3)];
    stepped(world, ("Slide.mo", "Slide.Plant"), changed, (20.0, 0.004), &signals, seed)
}

/// A recording of a plant under steps of its input `u` of random height, which last 75 samples; of each signal column,
/// variable and noise.
fn stepped(
    world: &MemoryWorld,
    (source, class): (&str, &str),
    changed: &[(&str, f64)],
    (height, h): (f64, f64),
    signals: &[(&str, &str, f64)],
    seed: u64,
) -> String {
    let mut random = Normal(Numbers(seed));
    let heights: Vec<f64> = (0..20).map(|_| height * random.next()).collect();
    let input: Vec<f64> = heights.iter().flat_map(|u| [*u; 75]).collect();
    played(world, (source, class), changed, (&input, h), signals, &mut random)
}

/// A recording of a plant whose input `u` has these values, each held for so long; of each signal column, variable and noise.
pub fn played(
    world: &MemoryWorld,
    (source, class): (&str, &str),
    changed: &[(&str, f64)],
    (input, h): (&[f64], f64),
    signals: &[(&str, &str, f64)],
    random: &mut Normal,
) -> String {
    let request = Request { source: source.into(), model: Some(class.into()), ..Request::default() };
    let mut plant = Simulation::compile(world, &request).unwrap();
    for (name, value) in changed {
        plant.set(name, *value).unwrap();
    }
    let times: Vec<f64> = (0..input.len()).map(|k| k as f64 * h).collect();
    plant.input("u", &times, input, Interpolation::Held).unwrap();
    plant.stop_time(times[times.len() - 1]);
    let settings = plant.settings();
    settings.interval = h;
    settings.event_rows = false;
    settings.tolerance = 1e-8;
    let run = plant.run().unwrap().trajectory;
    let mut text = String::from("t,u");
    signals.iter().for_each(|(column, ..)| write!(text, ",{column}").unwrap());
    for k in 0..times.len() {
        write!(text, "\n{},{}", times[k], input[k]).unwrap();
        for (_, variable, noise) in signals {
            write!(text, ",{}", run.column(variable).unwrap()[k] + noise * random.next()).unwrap();
        }
    }
    text + "\n"
}

fn diagnosed(friction: (&str, f64), held_seed: u64) -> Verdict {
    let world = MemoryWorld::single("Slide.mo", MODEL);
    let (train, held) = (recording(&world, friction, 11), recording(&world, friction, held_seed));
    verdict(world, STUDY, train, held)
}

pub fn verdict(world: MemoryWorld, study: &str, train: String, held: String) -> Verdict {
    judged(world, study, train, held, None)
}

/// The verdict; with an effect by its class, what it does beside the model within its tolerances.
fn judged(mut world: MemoryWorld, study: &str, train: String, held: String, asked: Option<&str>) -> Verdict {
    world.add("train.csv", train);
    world.add("held.csv", held);
    world.add("study.toml", study);
    let mut sources = Sources::default();
    let study = Study::read(&world, Path::new("study.toml"), &mut sources).value.unwrap();
    let question = question(&world, &study, None, &mut sources).ok().unwrap();
    let held = question.held(None, &mut sources).unwrap().recordings;
    let problem = &question.problem;
    let found = match asked {
        None => search(problem, &held, None, &mut |_| ControlFlow::Continue(())),
        Some(class) => {
            let hypothesis = problem.hypotheses.iter().position(|h| h.effect == class).unwrap();
            explained(problem, &held, hypothesis, &mut |_| ControlFlow::Continue(())).map(Option::unwrap)
        }
    };
    conclude(problem, &found.unwrap_or_else(|trouble| panic!("{trouble:?}")), &held, 0.0)
}

/// What a refused effect would do is shown, with the reason against it.
#[test]
fn a_refused_effect_is_shown_on_request() {
    let world = MemoryWorld::single("Slide.mo", MODEL);
    let (train, held) = (recording(&world, ("rub.F", 6.0), 11), recording(&world, ("rub.F", 6.0), 12));
    let verdict = judged(world, STUDY, train, held, Some("Effects.SensorLag"));
    let families: Vec<&str> = verdict.effects.iter().map(|e| e.family.as_str()).collect();
    assert_eq!(families, ["sensor_lag"]);
    assert!(verdict.asked.unwrap().starts_with("it would be refused: "), "{:?}", verdict.weighed);
}

#[test]
fn dry_friction_is_named_at_its_place_and_held_recordings_only_confirm_it() {
    let first = diagnosed(("rub.F", 3.0), 12);
    assert_eq!(first.verdict, "effects");
    let effect = &first.effects[0];
    assert_eq!(effect.family, "dry_friction");
    assert!(effect.places[0].node.iter().any(|n| n == "mass.flange"), "{:?}", effect.places);
    assert!(first.closed_by_effects.unwrap() > 0.6, "{:?}", first.gap.held.total);
    let second = diagnosed(("rub.F", 3.0), 13);
    let same = |a: &Verdict, b: &Verdict| {
        let text = |v: &Verdict| {
            let effects: Vec<String> = v
                .effects
                .iter()
                .map(|e| format!("{} {:?} {} {:?}", e.effect, e.places, e.evidence, e.parameters))
                .collect();
            format!("{} {:?} {:?} {:?} {effects:?} {:?}", v.verdict, v.noise, v.places, v.drifts, v.gap.train)
        };
        text(a) == text(b)
    };
    assert!(same(&first, &second), "held recordings may change the figures for held recordings only");
    assert_ne!(first.gap.held, second.gap.held);
}

/// A motor, a gear and an elastic shaft; what rubs at the motor does so in another form than the library's.
const DRIVE: &str = "
model Drive
  import Mechanical.Rotational.*;
  Interfaces.RealInput u(unit = \"N.m\", nominal = 1);
  Torque motor; Inertia rotor(J = 4e-4); IdealGear gear(ratio = 10); SpringDamper shaft(c = 900, d = 2); Inertia load(J = 0.1);
  Damper rest(d = 1.5); Fixed housing;
equation
  connect(u, motor.tau); connect(motor.flange, rotor.flange_a); connect(rotor.flange_b, gear.flange_a);
  connect(gear.flange_b, shaft.flange_a); connect(shaft.flange_b, load.flange_a);
  connect(load.flange_b, rest.flange_a); connect(rest.flange_b, housing.flange);
end Drive;
model Rub
  Interfaces.RotationalFlange flange;
  Modelica.Units.SI.AngularVelocity w = der(flange.phi);
equation
  flange.tau = 0.06*Modelica.Math.atan(w/0.8)*2/Modelica.Constants.pi;
end Rub;
model RubbingDrive
  extends Drive;
  Rub rub;
equation
  connect(rub.flange, motor.flange);
end RubbingDrive;";

/// Friction between the sides of a gear is friction at one of them. Two ways to say the same were 8 % apart, because one
/// of them gave the rotor's angle another name.
#[test]
fn friction_behind_a_gear_is_at_its_node_and_alone() {
    let world = MemoryWorld::single("Drive.mo", DRIVE);
    let signals = [("w", "rotor.w", 0.18), ("phi", "load.phi", 4e-3)];
    let record = |seed| stepped(&world, ("Drive.mo", "RubbingDrive"), &[], (0.4, 0.004), &signals, seed);
    let (train, held) = (record(11), record(12));
    let study = "
version = 1
model = \"Drive.mo\"
class = \"Drive\"
[inputs]
u = { column = \"u\", unit = \"N.m\", hold = true }
[signals]
w = { variable = \"rotor.w\", column = \"w\", unit = \"rad/s\" }
phi = { variable = \"load.phi\", column = \"phi\", unit = \"rad\" }
[[recordings]]
file = \"train.csv\"
role = \"train\"
time = \"t\"
[[recordings]]
file = \"held.csv\"
role = \"held\"
time = \"t\"
[parameters]
\"rest.d\" = { sigma = \"10 %\" }
\"load.J\" = { sigma = \"3 %\" }
\"shaft.c\" = { sigma = \"5 %\" }
";
    let found = verdict(world.clone(), study, train, held);
    assert_eq!(found.effects.len(), 1, "{:?}", found.effects);
    assert_eq!(found.effects[0].family, "dry_friction");
    let place = &found.effects[0].places[0];
    assert!(["motor.flange", "gear.flange_b"].contains(&place.place.as_str()), "{place:?}");
    for a in &found.effects[0].indistinguishable {
        assert!(a.places.iter().all(|p| p.place != "motor.flange|gear.flange_b"), "{a:?}");
    }
}

#[test]
fn what_no_effect_explains_is_told_by_its_shape() {
    let verdict = diagnosed(("rub.W", 3.0), 12);
    assert_eq!(verdict.verdict, "outside_library", "{:?}", verdict.effects);
    assert!(verdict.places[0].node.iter().any(|n| n == "mass.flange"), "{:?}", verdict.places);
    let shape = &verdict.unexplained.shape.unwrap()[0];
    assert_eq!(shape.term, "Dry friction that depends on the position, again and again along the way");
    assert!(shape.closes > 0.3, "{}", shape.closes);
}

/// A step of friction at a speed is steeper than any shape; in one recording left-out data are not sure of one. No effect
/// is named for it.
#[test]
fn friction_above_a_speed_has_no_name() {
    let verdict = diagnosed(("rub.Z", 6.0), 12);
    assert!(verdict.effects.is_empty(), "{:?}", verdict.effects);
    assert!(matches!(verdict.verdict, "outside_library" | "gap_open"), "{}", verdict.verdict);
}

#[test]
fn a_periodic_force_that_follows_nothing_is_told_as_one() {
    let found = diagnosed(("rub.P", 3.0), 2);
    assert_eq!(found.verdict, "outside_library", "{found:?}");
    let term = &found.unexplained.shape.expect("a shape")[0];
    assert_eq!(term.term, "A periodic force that follows no variable");
    assert_eq!(found.unexplained.place.as_deref(), Some("mass.flange"));
}

/// What follows nothing is at another point of its period when each recording begins.
#[test]
fn a_periodic_force_begins_anywhere_in_its_period() {
    let mut world = MemoryWorld::single("Slide.mo", MODEL);
    let at = |phase: f64, seed: u64| recorded(&world, &[("rub.P", 3.0), ("rub.phase", phase)], seed);
    let (train, second, held) = (at(1.0, 11), at(4.1, 12), at(2.5, 13));
    world.add("second.csv", second);
    let further = "[[recordings]]\nfile = \"second.csv\"\nrole = \"train\"\ntime = \"t\"\n[parameters]\n";
    let found = verdict(world, &STUDY.replace("[parameters]\n", further), train, held);
    assert_eq!(found.verdict, "outside_library", "{found:?}");
    let term = &found.unexplained.shape.expect("a shape")[0];
    assert_eq!(term.term, "A periodic force that follows no variable");
    assert!(term.closes > 0.7, "{}", term.closes);
}

#[test]
fn a_parameter_far_beyond_its_tolerance_is_named() {
    // 13 tolerances off
    let found = diagnosed(("spring.c", 300.0), 2);
    let drift = found.drifts.iter().find(|d| d.parameter == "spring.c").expect("free");
    assert!((drift.value - 300.0).abs() < 3.0 * drift.std.max(1.0), "{drift:?}");
    assert_eq!(found.effects[0].family, "parameter", "{found:?}");
}

/// What lies within its tolerance is not out of it, however surely the data tell its value.
#[test]
fn a_parameter_within_its_tolerance_is_no_finding() {
    // two tolerances off
    let found = diagnosed(("spring.c", 416.0), 2);
    assert!(found.effects.is_empty(), "{:?}", found.effects);
    assert_eq!(found.verdict, "nothing_found");
}

/// A recording without friction of which one column was taken so many samples later, or earlier where it is negative.
fn shifted(world: &MemoryWorld, column: usize, samples: isize, seed: u64) -> String {
    let text = recording(world, ("rub.F", 0.0), seed);
    let mut rows: Vec<Vec<&str>> = text.lines().map(|l| l.split(',').collect()).collect();
    let measured: Vec<&str> = rows.iter().map(|r| r[column]).collect();
    let last = measured.len() - 1;
    for (k, row) in rows.iter_mut().enumerate().skip(1) {
        row[column] = measured[k.saturating_add_signed(-samples).clamp(1, last)];
    }
    rows.into_iter().map(|r| r.join(",") + "\n").collect()
}

/// A spring that is not the same in two recordings is known no better than they agree.
#[test]
fn recordings_that_contradict_each_other_widen_the_deviations() {
    let deviation = |c: f64| {
        let mut world = MemoryWorld::single("Slide.mo", MODEL);
        let [train, held] = [11, 12].map(|seed| recording(&world, ("rub.F", 0.0), seed));
        let second = recorded(&world, &[("rub.F", 0.0), ("spring.c", c)], 13);
        world.add("second.csv", second);
        let held_of = "[[recordings]]\nfile = \"held.csv\"";
        let study = STUDY
            .replace(held_of, &(held_of.replace("held", "second") + "\nrole = \"train\"\ntime = \"t\"\n" + held_of));
        let verdict = verdict(world, &study, train, held);
        verdict.drifts.iter().find(|d| d.parameter == "spring.c").expect("free").std
    };
    let (alike, apart) = (deviation(400.0), deviation(404.0));
    assert!(apart > 2.0 * alike && apart > 0.5, "{alike} {apart}");
}

/// From where they are not, a lag and a dead time look alike.
#[test]
fn a_dead_time_is_no_lag() {
    let world = MemoryWorld::single("Slide.mo", MODEL);
    let (train, held) = (shifted(&world, 1, -3, 11), shifted(&world, 1, -3, 12));
    let verdict = verdict(world, STUDY, train, held);
    assert_eq!(verdict.effects.len(), 1, "{:?}", verdict.effects);
    assert_eq!(verdict.effects[0].family, "dead_time", "{:?}", verdict.effects);
    let time = &verdict.effects[0].parameters["T_d"];
    assert!((time.value - 0.012).abs() < 3.0 * time.std, "{time:?}");
}

/// Twenty samples, twice as long as the longest that is tried first: a small share of it looks like nothing.
#[test]
fn a_sensor_that_comes_very_late_is_named_with_its_delay() {
    let world = MemoryWorld::single("Slide.mo", MODEL);
    let (train, held) = (shifted(&world, 3, 20, 11), shifted(&world, 3, 20, 12));
    let verdict = verdict(world, STUDY, train, held);
    assert_eq!(verdict.effects.len(), 1, "{:?}", verdict.effects);
    assert_eq!(verdict.effects[0].family, "sensor_delay", "{:?}", verdict.effects);
    assert_eq!(verdict.effects[0].places[0].place, "v");
    let time = &verdict.effects[0].parameters["T_d"];
    assert!((time.value - 0.08).abs() < (5.0 * time.std).max(2e-3), "{time:?}");
}

/// Nothing else tells the sign.
#[test]
fn a_rectifying_sensor_is_named() {
    let world = MemoryWorld::single("Slide.mo", MODEL);
    let rectified = |seed: u64| {
        let text = recording(&world, ("rub.F", 0.0), seed);
        let magnitude = |line: &str| match line.rsplit_once(',') {
            Some((before, v)) if !v.starts_with('v') => format!("{before},{}\n", v.trim_start_matches('-')),
            _ => format!("{line}\n"),
        };
        text.lines().map(magnitude).collect::<String>()
    };
    let study = STUDY.replace("s = { variable = \"mass.s\", column = \"s\", unit = \"m\" }\n", "");
    let (train, held) = (rectified(11), rectified(12));
    let verdict = verdict(world, &study, train, held);
    assert_eq!(verdict.verdict, "effects");
    assert_eq!(verdict.effects[0].family, "sensor_rectification", "{:?}", verdict.effects);
    assert!(verdict.closed_by_effects.unwrap() > 0.6, "{:?}", verdict.gap.held.total);
}

/// Before measuring there are inputs only. A further body on the mass is no other than a heavier mass; friction is seen.
#[test]
fn a_plan_says_what_would_be_seen_and_what_could_not_be_told_apart() {
    let mut world = MemoryWorld::single("Slide.mo", MODEL);
    let text = recording(&world, ("rub.F", 0.0), 11);
    let inputs = text.lines().map(|l| l.split(',').take(2).collect::<Vec<_>>().join(",") + "\n").collect::<String>();
    world.add("train.csv", inputs);
    world.add("study.toml", STUDY);
    let mut sources = Sources::default();
    let study = Study::read(&world, Path::new("study.toml"), &mut sources).value.unwrap();
    let mut question = planned(&world, &study, None, &mut sources).ok().unwrap();
    let plan = plan(&mut question.problem, &mut |_| ()).unwrap();
    let of = |family: &str| plan.hypotheses.iter().position(|h| h.family == family).unwrap();
    assert!(plan.hypotheses[of("dry_friction")].nats > 8.0);
    let drift = |i: usize| plan.hypotheses[i].places == ["mass.m"];
    let same = |p: &&EffectPair| plan.hypotheses[p.there].family == "extra_inertia" && drift(p.instead);
    assert!(plan.confused.iter().find(same).unwrap().behind < 0.5);
    assert_eq!(plan.excitations.len(), 5);
    // at rest nothing that depends on motion shows
    let seen = |name: &str| plan.excitations.iter().find(|c| c.what == name).unwrap().seen;
    assert!(seen("hold") < seen("steps"));
}

#[test]
fn a_sound_plant_lacks_nothing() {
    let verdict = diagnosed(("rub.F", 0.0), 12);
    assert!(verdict.effects.is_empty(), "{:?}", verdict.effects);
    assert_eq!(verdict.verdict, "nothing_found");
}

/// The corrected model needs nothing beside it and runs as the model that was fitted; the page holds everything itself.
#[test]
fn the_corrected_model_stands_alone_and_so_does_the_page() {
    let mut world = MemoryWorld::single("Slide.mo", MODEL);
    let (train, held) = (recording(&world, ("rub.F", 3.0), 11), recording(&world, ("rub.F", 3.0), 12));
    world.add("train.csv", train);
    world.add("held.csv", held);
    world.add("study.toml", STUDY);
    let mut sources = Sources::default();
    let study = Study::read(&world, Path::new("study.toml"), &mut sources).value.unwrap();
    let question = question(&world, &study, None, &mut sources).ok().unwrap();
    let problem = &question.problem;
    let others = question.held(None, &mut sources).unwrap();
    let held = &others.recordings;
    let found = search(problem, held, None, &mut |_| ControlFlow::Continue(())).ok().unwrap();
    let verdict = conclude(problem, &found, held, 0.0);

    let text = corrected(problem, &found.last.fit).value.unwrap();
    let alone = MemoryWorld::single("fixed.mo", text);
    let request = Request { source: "fixed.mo".into(), model: Some("Fixed".into()), ..Request::default() };
    let mut fixed = Simulation::compile(&alone, &request).unwrap();
    let input = &held[0].inputs[0];
    fixed.input("u", &held[0].times, input, Interpolation::Held).unwrap();
    fixed.stop_time(held[0].times[held[0].len() - 1]);
    let settings = fixed.settings();
    settings.interval = 0.004;
    settings.event_rows = false;
    settings.tolerance = 1e-8;
    let run = fixed.run().unwrap().trajectory;
    let fit = &found.last.fit;
    let model = &fit.candidate.model;
    let fitted =
        from_start(&model.plan, &fit.candidate.theta(&fit.x), (&model.sizes, model.correction), &held[0]).unwrap();
    for (name, wanted) in ["s", "v"].into_iter().zip(&fitted) {
        let column = run.column(name).unwrap();
        let largest = wanted.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        let apart = column.iter().zip(wanted).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(apart < 0.01 * largest, "{name}: {apart} of {largest}");
    }

    let page = report(problem, &found, &verdict, &others);
    assert!(!page.replace("http://www.w3.org/2000/svg", "").contains("http"));
    assert!(page.matches("<p>").count() > 3, "each sentence of the verdict stands on its own");
    for part in
        ["dry friction", "mass.flange", "spring.d", "v in m/s", "held.csv, held", "corrected", "dB over the noise"]
    {
        assert!(page.contains(part), "{part}");
    }
}

/// The flow of a vessel that was full when the recording began, while the model begins nearly empty: the flow goes with
/// the root of the level.
#[test]
fn a_start_far_from_the_models_is_found_through_an_output_that_bends() {
    let model = "
        model Vessel
          parameter Real h_0(unit = \"m\") = 1e-3;
          parameter Real c(unit = \"m2.5/s\") = 0.3;
          input Real u(unit = \"m3/s\");
          Real h(unit = \"m\", start = h_0, fixed = true, nominal = 1);
          Real q(unit = \"m3/s\", nominal = 1);
        equation
          q = c*h/(h*h + 1e-8)^0.25;
          der(h) = u - q;
        end Vessel;";
    let world = MemoryWorld::single("Vessel.mo", model);
    let recorded = |seed: u64| {
        let request = Request { source: "Vessel.mo".into(), model: Some("Vessel".into()), ..Request::default() };
        let mut vessel = Simulation::compile(&world, &request).unwrap();
        vessel.set("h_0", 1.5).unwrap();
        let mut random = Normal(Numbers(seed));
        let times: Vec<f64> = (0..400).map(|k| f64::from(k) * 0.05).collect();
        let u: Vec<f64> = (0..400).map(|k| if k / 80 % 2 == 0 { 0.2 } else { 0.4 }).collect();
        vessel.input("u", &times, &u, Interpolation::Held).unwrap();
        vessel.stop_time(times[399]);
        let settings = vessel.settings();
        (settings.interval, settings.event_rows) = (0.05, false);
        let run = vessel.run().unwrap().trajectory;
        let (h, q) = (run.column("h").unwrap(), run.column("q").unwrap());
        let mut text = String::from("t,u,h,q\n");
        for k in 0..400 {
            let (dh, dq) = (1e-2 * random.next(), 1e-4 * random.next());
            writeln!(text, "{},{},{},{}", times[k], u[k], h[k] + dh, q[k] + dq).unwrap();
        }
        text
    };
    let (train, held) = (recorded(3), recorded(4));
    let study = "version = 1\nmodel = \"Vessel.mo\"\nclass = \"Vessel\"\n\
        [inputs]\nu = { column = \"u\", unit = \"m3/s\", hold = true }\n\
        [signals]\nh = { variable = \"h\", column = \"h\", unit = \"m\", full_scale = \"2 m\" }\n\
        q = { variable = \"q\", column = \"q\", unit = \"m3/s\", full_scale = \"1 m3/s\" }\n\
        [[recordings]]\nfile = \"train.csv\"\nrole = \"train\"\ntime = \"t\"\n\
        [[recordings]]\nfile = \"held.csv\"\nrole = \"held\"\ntime = \"t\"\n\
        [parameters]\n\"c\" = { sigma = \"2 %\" }\n";
    let verdict = verdict(world, study, train, held);
    assert!(verdict.effects.is_empty(), "{:?}", verdict.effects);
    let left = verdict.gap.held.total.tolerances.unwrap();
    // figures are raw: the sensors' noise is in them, 5e-3 of the level's range and 1e-4 of the flow's
    let noise = ((5e-3_f64.powi(2) + 1e-4_f64.powi(2)) / 2.0).sqrt();
    assert!(left * left - noise * noise < 3e-3_f64.powi(2), "{left}");
}

/// A motor that runs down, cut into windows that begin at speeds far from the model's own start, which the model fixes. Its
/// voltage follows the speed alone, in another unit.
#[test]
fn windows_of_a_run_down_begin_where_their_signal_says() {
    let model = "
        model Rundown
          Mechanical.Rotational.Inertia rotor(J = 2e-5, phi(start = 0, fixed = true), w(start = 300, fixed = true));
          Mechanical.Rotational.Damper bearing(d = 2e-5);
          Mechanical.Rotational.Fixed stand;
          parameter Real k(unit = \"V.s/rad\") = 0.01;
          Real U(unit = \"V\") = k*rotor.w;
        equation
          connect(rotor.flange_b, bearing.flange_a);
          connect(bearing.flange_b, stand.flange);
        end Rundown;";
    // J w' = -d w - tau has an exponential towards -tau/d
    let (lag, below) = (1.0, 70.0);
    let mut random = Normal(Numbers(5));
    let mut row = |k: u32| {
        let t = 0.005 * f64::from(k);
        let w = (400.0 + below) * (-t / lag).exp() - below;
        format!("{t},{}\n", 0.01 * w + 5e-3 * random.next())
    };
    let text = (0..320).fold(String::from("t,U\n"), |text, k| text + &row(k));
    let window = |from: f64, to: f64, role: &str| {
        format!("[[recordings]]\nfile = \"train.csv\"\nrole = \"{role}\"\nwindow = [{from}, {to}]\n")
    };
    let windows = [
        window(0.0, 0.4, "train"),
        window(0.405, 0.8, "train"),
        window(1.2, 1.6, "train"),
        window(0.805, 1.195, "held"),
    ];
    let study = format!(
        "version = 1\nmodel = \"Rundown.mo\"\nclass = \"Rundown\"\n[signals]\nU = {{ unit = \"V\" }}\n{}\
        [parameters]\n\"rotor.J\" = {{ sigma = \"5 %\" }}\n\"bearing.d\" = {{ sigma = \"10 %\" }}\n\"k\" = \"exact\"\n",
        windows.concat()
    );
    let world = MemoryWorld::single("Rundown.mo", model);
    let verdict = verdict(world, &study, text.clone(), text);
    let families: Vec<&str> = verdict.effects.iter().map(|e| e.family.as_str()).collect();
    assert_eq!(families, ["dry_friction"], "{:?}", verdict.weighed);
    let tau = verdict.effects[0].parameters["tau_c"].value;
    assert!((tau - below * 2e-5).abs() < 2e-4, "{tau}");
}

/// A pump that presses oil with air against a closed port: below the pressure at which its check valve closes the oil is so
/// soft that its pressure runs away from any linear model. A coarse first reading leads there, and no further.
#[test]
fn soft_oil_behind_a_check_valve_does_not_lead_the_simulation_astray() {
    let rig = "
        model Rig
          extends ServoPump.DeadZone(
              redeclare ServoPump.IdealDrive motor, break rotor, break speed, break connect(speed.y, motor.w_ref),
              break connect(motor.flange, rotor.flange_a), break connect(rotor.flange_b, pump.flange));
          Interfaces.RealInput w_ref(unit = \"rad/s\", nominal = 3);
        equation
          connect(motor.flange, pump.flange);
          connect(w_ref, motor.w_ref);
        end Rig;";
    let mut world = MemoryWorld::single("Rig.mo", rig);
    let request = Request { source: "Rig.mo".into(), model: Some("Rig".into()), ..Request::default() };
    let mut plant = Simulation::compile(&world, &request).unwrap();
    let times: Vec<f64> = (0..120).map(|k| f64::from(k) * 0.1).collect();
    let speed: Vec<f64> = (0..120).map(|k| [3.2, 2.4, 4.0, 2.8][k / 30]).collect();
    plant.input("w_ref", &times, &speed, Interpolation::Held).unwrap();
    plant.stop_time(times[119]);
    let settings = plant.settings();
    (settings.interval, settings.event_rows) = (0.1, false);
    let run = plant.run().unwrap().trajectory;
    let columns = ["p_A", "p_B", "T_sh"].map(|name| run.column(name).unwrap());
    let mut random = Normal(Numbers(3));
    let mut text = String::from("t,w_ref,p_A,p_B,T_sh\n");
    for k in 0..120 {
        let mut shown = [3e5, 5e4, 0.03].map(|deviation| deviation * random.next());
        shown.iter_mut().zip(&columns).for_each(|(shown, column)| *shown += column[k]);
        if k == 0 {
            shown[0] = 0.0;
        }
        writeln!(text, "{},{},{},{},{}", times[k], speed[k], shown[0], shown[1], shown[2]).unwrap();
    }
    world.add("train.csv", text);
    world.add(
        "study.toml",
        "version = 1\nmodel = \"Rig.mo\"\nclass = \"Rig\"\n\
        [inputs]\nw_ref = { column = \"w_ref\", unit = \"rad/s\", hold = true }\n\
        [signals]\np_A = { variable = \"p_A\", column = \"p_A\", unit = \"Pa\" }\n\
        p_B = { variable = \"p_B\", column = \"p_B\", unit = \"Pa\" }\n\
        T_sh = { variable = \"T_sh\", column = \"T_sh\", unit = \"N.m\" }\n\
        [[recordings]]\nfile = \"train.csv\"\nrole = \"train\"\ntime = \"t\"\n",
    );
    let mut sources = Sources::default();
    let study = Study::read(&world, Path::new("study.toml"), &mut sources).value.unwrap();
    let question = question(&world, &study, None, &mut sources).ok().unwrap();
    let problem = &question.problem;
    let nominal = models::nominal(problem).unwrap();
    let errors = nominal.errors(&nominal.present(), &problem.train[0], Some(0)).unwrap();
    // 17,000 deviations where it goes along
    let farthest = |(e, n): (&Vec<f64>, &f64)| e.iter().fold(0.0_f64, |most, v| most.max(v.abs() / n));
    let most = errors.iter().zip(&problem.noise_floor).map(farthest).fold(0.0, f64::max);
    assert!(most < 10.0, "{most}");
}

/// The bench of a network without states has a sensor with an offset.
#[test]
fn a_model_without_states_is_diagnosed() {
    let world = MemoryWorld::single("Static.mo", ORIFICE);
    let recorded = |seed: u64| {
        let mut random = Normal(Numbers(seed));
        let mut text = String::from("t,p,q\n");
        for k in 0..600 {
            let t = f64::from(k) * 0.01;
            let p = 50e5 + 40e5 * (t * 1.7 + seed as f64).sin();
            // C_d = 0.65, density of the oil at rest; the sensor shows 4e-5 m3/s too much
            let q = 0.65 * 1e-5 * (2.0 * (p - 101_325.0) / 870.0).sqrt();
            writeln!(text, "{t},{p},{}", q + 4e-5 + 2e-6 * random.next()).unwrap();
        }
        text
    };
    let (train, held) = (recorded(3), recorded(4));
    let study = "version = 1\nmodel = \"Static.mo\"\nclass = \"Static\"\n\
        [inputs]\np = { unit = \"Pa\" }\n[signals]\nq = { unit = \"m3/s\" }\n\
        [[recordings]]\nfile = \"train.csv\"\nrole = \"train\"\ntime = \"t\"\n\
        [[recordings]]\nfile = \"held.csv\"\nrole = \"held\"\ntime = \"t\"\n\
        [parameters]\n\"orifice.A\" = { sigma = \"1 %\" }\n";
    let verdict = verdict(world, study, train, held);
    let named: Vec<&str> = verdict.effects.iter().map(|e| e.family.as_str()).collect();
    assert_eq!(named.first(), Some(&"sensor_offset"), "{:?}", verdict.gap);
}

/// Where the nominal model is open to the recordings and nothing may be named, the verdict is not "nothing".
#[test]
fn an_open_gap_is_not_called_nothing() {
    let study = format!("{STUDY}[effects]\ninclude = [\"sensor_offset\"]\n");
    let world = MemoryWorld::single("Slide.mo", MODEL);
    let (train, held) = (recording(&world, ("rub.F", 3.0), 11), recording(&world, ("rub.F", 3.0), 12));
    let verdict = verdict(world, &study, train, held);
    assert!(!matches!(verdict.verdict, "nothing_found" | "undecidable"), "{}", verdict.verdict);
    assert!(!verdict.open.is_empty());
}
