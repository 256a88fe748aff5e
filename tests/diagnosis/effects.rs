//! Effects at the places of real circuits: what is found, and that everything compiles in one model.

#![allow(
    clippy::disallowed_methods,
    clippy::print_stdout,
    reason = "tests read their own files and say what they skip"
)]

use bramah::Interpolation;
use bramah::internals::compile::CompileOutcome;
use bramah::internals::diag::render::{DiagnosticFormat, render};
use bramah::internals::gap::augment::{HypothesisInstance, augment, compile};
use bramah::internals::gap::circuit::{CircuitTopology, circuit};
use bramah::internals::gap::effects::{AttachmentKind, EffectModel, catalogue};
use bramah::internals::gap::fixed::fixed;
use bramah::internals::gap::hypotheses::{AttachmentSite, Hypothesis, SensorSignal, UncertainParameter, hypotheses};
use bramah::internals::lower;
use bramah::results::Trajectory;
use bramah::world::{MemoryWorld, World};
use bramah::{Request, Simulation};
use std::path::{Path, PathBuf};

fn value<T>(outcome: CompileOutcome<T>) -> T {
    let said = render(&outcome.sources, &outcome.diagnostics, DiagnosticFormat::Short, 160, false);
    outcome.value.unwrap_or_else(|| panic!("{said}"))
}

fn signal(name: &str, variable: &str, scale: f64) -> SensorSignal {
    SensorSignal { name: name.into(), variable: variable.into(), scale }
}

fn listed(all: &[Hypothesis]) -> String {
    let line = |h: &Hypothesis| {
        let places: Vec<&str> = h.places().iter().map(|p| p.place.as_str()).collect();
        let order = if h.changes_order { " (order)" } else { "" };
        format!("{} {} at {}{order} x{}", h.family, h.effect, places.join(" + "), h.variants().len())
    };
    all.iter().map(line).collect::<Vec<_>>().join("\n")
}

fn check(world: &dyn World, request: &Request, signals: &[SensorSignal]) -> String {
    let effects = catalogue(world, None);
    assert!(effects.diagnostics.is_empty(), "{:?}", effects.diagnostics);
    let effects = effects.value.expect("a catalogue").effects;
    assert!(effects.iter().any(|e| e.interface.attach == AttachmentKind::Shunt));
    let places = value(circuit(world, request));
    let all = hypotheses(&places, &effects, signals, &[]);
    let mut attached = Vec::new();
    for (i, h) in all.iter().enumerate().filter(|(_, h)| !h.changes_order) {
        for (k, values) in h.variants().into_iter().enumerate() {
            attached.push(HypothesisInstance { name: format!("h{i}_{k}"), hypothesis: h, values });
        }
    }
    let text = augment(&places, &attached, signals);
    let model = value(compile(world, request, None, &text, &lower::LoweringOptions::default()));
    let plain = value(bramah::internals::compile::compile(world, request, &lower::LoweringOptions::default()));
    let states = |m: &bramah::internals::compile::CompiledModel, prefix: &str| -> Vec<String> {
        let names = m.dae.states.iter().map(|v| m.dae.variables[v.index()].name.clone());
        let mut names: Vec<String> = names.map(|n| n.strip_prefix(prefix).unwrap_or(&n).to_string()).collect();
        names.sort();
        names
    };
    let (found, expected) = (states(&model, "plant."), states(&plain, ""));
    let effects = attached.iter().flat_map(|a| &a.hypothesis.attachments).filter_map(|a| a.effect.as_ref());
    let own: usize = effects.map(|e| e.states).sum();
    assert_eq!(found.len(), expected.len() + own, "{found:?} instead of {expected:?} and {own} of effects");
    if all.len() < 200 {
        alone(world, request, signals, &places, &all);
    }
    listed(&all)
}

/// Effects that change the order of the system compile one by one, with typical sizes.
fn alone(world: &dyn World, request: &Request, signals: &[SensorSignal], places: &CircuitTopology, all: &[Hypothesis]) {
    let mut bad = Vec::new();
    for h in all.iter().filter(|h| h.changes_order) {
        let values = h.coefficients.iter().map(|c| (c.name.clone(), c.nominal)).collect();
        let text = augment(places, &[HypothesisInstance { name: "h".into(), hypothesis: h, values }], signals);
        let outcome = compile(world, request, None, &text, &lower::LoweringOptions::default());
        // Where the flow is an input, its derivative cannot be had.
        let of_input = outcome.diagnostics.iter().any(|d| d.code.id() == "E304");
        if outcome.value.is_none() && !of_input {
            let said = render(&outcome.sources, &outcome.diagnostics, DiagnosticFormat::Short, 160, false);
            bad.push(format!("{} at {}\n{said}", h.effect, h.places()[0].place));
        }
    }
    assert!(bad.is_empty(), "{}", bad.join("\n"));
}

#[test]
fn gap_axis() {
    let request = Request { source: PathBuf::from("GapAxis.Nominal"), ..Request::default() };
    insta::assert_snapshot!(check(&MemoryWorld::default(), &request, &gap_axis_signals()));
}

#[test]
fn foreign_connectors() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/bench/Hyd.mo");
    let Ok(text) = std::fs::read_to_string(&path) else {
        println!("skipped: there is no {}", path.display());
        return;
    };
    let world = MemoryWorld::single("Hyd.mo", text);
    let request = Request { source: "Hyd.mo".into(), model: Some("Hyd.Circuit".into()), ..Request::default() };
    let signals = [signal("p", "vol2.p", 150e5), signal("x", "mass.s", 0.5)];
    insta::assert_snapshot!(check(&world, &request, &signals));
}

/// Every circuit that ships takes all effects at once; inside of subsystems too.
#[test]
fn shipped_circuits() {
    let world = MemoryWorld::default();
    let classes = [
        "CascadedTanks.Nominal",
        "CoupledDrives.Nominal",
        "Emps.Nominal",
        "ServoPump.DeadZone",
        "ServoPump.NoLoad",
        "ServoPump.Load",
        "ServoPump.System",
        "ClosedCircuit.Case1",
        "ClosedCircuit.Reduced",
        "ClosedCircuit.Bench",
        "Belt",
        "Thermal.Examples.OilMassExample",
        "Electrical.Examples.BridgeExample",
    ];
    let mut said = String::new();
    for class in classes {
        let request = Request { source: class.into(), model: Some(class.into()), ..Request::default() };
        let tried = std::panic::catch_unwind(|| check(&world, &request, &[]).lines().count());
        said.push_str(&match tried {
            Ok(count) => format!("{class}: {count}\n"),
            Err(why) => {
                let why = why.downcast_ref::<String>().cloned().unwrap_or_default();
                format!("{class}: {}\n", why.lines().take(12).collect::<Vec<_>>().join("\n    "))
            }
        });
    }
    insta::assert_snapshot!(said);
}

fn gap_axis_signals() -> [SensorSignal; 5] {
    [
        signal("w", "w", 100.0),
        signal("i", "i", 10.0),
        signal("p1", "p1", 5e6),
        signal("p2", "p2", 5e6),
        signal("x", "x", 0.05),
    ]
}

/// Runs a class with the inputs of the axis in motion.
fn run(world: &dyn World, source: &str, class: &str) -> Trajectory {
    let request = Request { source: source.into(), model: Some(class.into()), ..Request::default() };
    let mut simulation = Simulation::compile(world, &request).unwrap_or_else(|e| panic!("{e}"));
    let times: Vec<f64> = (0..400).map(|k| f64::from(k) * 0.005).collect();
    let u: Vec<f64> = times.iter().map(|t| 60.0 * (7.0 * t).sin() + 20.0 * (31.0 * t).sin()).collect();
    let oil: Vec<f64> = times.iter().map(|t| 30.0 + 10.0 * t).collect();
    simulation.input("u", &times, &u, Interpolation::Linear).expect("an input of the model");
    simulation.input("T_oil", &times, &oil, Interpolation::Linear).expect("an input of the model");
    simulation.settings().tolerance = 1e-9;
    simulation.stop_time(1.5);
    simulation.run().unwrap_or_else(|e| panic!("{e}")).trajectory
}

/// The greatest difference of two runs over the range of the first.
fn difference(a: &Trajectory, b: &Trajectory, of: &str, in_b: &str) -> f64 {
    let (x, y) = (a.column(of).expect("a column"), b.column(in_b).expect("a column"));
    let range = x.iter().fold(0.0f64, |m, v| m.max((v - x[0]).abs()));
    x.iter().zip(y).fold(0.0f64, |m, (v, w)| m.max((v - w).abs())) / range
}

fn axis() -> (Request, CircuitTopology, Vec<Hypothesis>) {
    let request = Request { source: "GapAxis.Nominal".into(), ..Request::default() };
    let effects = catalogue(&MemoryWorld::default(), None).value.expect("a catalogue").effects;
    let places = value(circuit(&MemoryWorld::default(), &request));
    let all = hypotheses(&places, &effects, &gap_axis_signals(), &[]);
    (request, places, all)
}

/// With every effect attached and off, the trajectory is that of the nominal model.
#[test]
fn off_is_nominal() {
    let (_, places, all) = axis();
    let mut attached = Vec::new();
    for (i, h) in all.iter().enumerate() {
        let values = Vec::new();
        // Elements that cut a connection change the structure even when they are off.
        if !h.attachments.iter().any(|a| matches!(a.site, AttachmentSite::Into(_))) {
            attached.push(HypothesisInstance { name: format!("h{i}"), hypothesis: h, values });
        }
    }
    let text = augment(&places, &attached, &gap_axis_signals()).text;
    let nominal = run(&MemoryWorld::default(), "GapAxis.Nominal", "GapAxis.Nominal");
    let augmented = run(&MemoryWorld::single("Augmented.mo", text), "Augmented.mo", "Augmented");
    for name in ["w", "i", "p1", "p2", "x"] {
        let error = difference(&nominal, &augmented, name, name);
        assert!(error < 1e-6, "{name}: {error}");
    }
}

/// Two elements in one connection lie one behind the other: the same current, and both drops.
#[test]
fn series_elements_add_up() {
    let text = "model Loop
      Electrical.Ground ground; Electrical.ConstantVoltage source(V = 12); Electrical.Resistor load(R = 4);
    equation
      connect(source.p, load.p); connect(source.n, load.n); connect(source.n, ground.p);
    end Loop;";
    let world = MemoryWorld::single("Loop.mo", text);
    let request = Request { source: "Loop.mo".into(), ..Request::default() };
    let effects = catalogue(&world, None).value.expect("a catalogue").effects;
    let places = value(circuit(&world, &request));
    let all = hypotheses(&places, &effects, &[], &[]);
    let series: Vec<&Hypothesis> =
        all.iter().filter(|h| matches!(h.attachments[0].site, AttachmentSite::Into(_))).collect();
    let lead = |h: &&&Hypothesis| h.effect == "Effects.SeriesResistance" && h.places()[0].place.contains("load.p");
    let first = series.iter().find(lead).expect("it fits");
    let same = |h: &&&Hypothesis| h.attachments[0].site == first.attachments[0].site && h.effect != first.effect;
    let second = series.iter().find(same).expect("another at the same port");
    let attached = [
        HypothesisInstance { name: "a".into(), hypothesis: first, values: vec![("R".into(), 2.0)] },
        HypothesisInstance { name: "b".into(), hypothesis: second, values: vec![] },
    ];
    let signals = [signal("i", "load.i", 1.0)];
    let world = MemoryWorld::single("Augmented.mo", format!("{text}\n{}", augment(&places, &attached, &signals).text));
    let request = Request { source: "Augmented.mo".into(), model: Some("Augmented".into()), ..Request::default() };
    let mut simulation = Simulation::compile(&world, &request).unwrap_or_else(|e| panic!("{e}"));
    let run = simulation.stop_time(0.1).run().unwrap_or_else(|e| panic!("{e}")).trajectory;
    let i = run.column("i").expect("the current")[0];
    assert!((i - 2.0).abs() < 1e-9, "{i}");
}

/// Behind an ideal gear the speed is that before it times the ratio, so friction there is no new state; a shaft without
/// inertia between two springs has no speed in the model.
#[test]
fn what_an_ideal_gear_drives_has_a_speed() {
    let text = "model Train
      input Real tau(unit = \"N.m\");
      Mechanical.Rotational.Torque motor(tau = tau); Mechanical.Rotational.Inertia rotor(J = 0.01);
      Mechanical.Rotational.IdealGear gear(ratio = 10);
      Mechanical.Rotational.Spring first(c = 100); Mechanical.Rotational.Spring second(c = 200);
      Mechanical.Rotational.Fixed wall;
    equation
      connect(motor.flange, rotor.flange_a); connect(rotor.flange_b, gear.flange_a);
      connect(gear.flange_b, first.flange_a); connect(first.flange_b, second.flange_a);
      connect(second.flange_b, wall.flange);
    end Train;";
    let request = Request { source: "Train.mo".into(), ..Request::default() };
    let places = value(circuit(&MemoryWorld::single("Train.mo", text), &request));
    let node = |name: &str| {
        let of = |p: &bramah::internals::gap::circuit::PhysicalPort| p.name == name;
        let port = places.ports.iter().find(|p| of(p)).expect("a port");
        &places.nodes[port.node]
    };
    assert!(node("rotor.flange_b").has_rate && node("rotor.flange_b").has_acceleration);
    assert!(node("gear.flange_b").has_rate && node("gear.flange_b").has_acceleration);
    assert!(!node("first.flange_b").has_rate);
    // and what acts between its sides acts as well at one of them
    let (geared, elastic) = (node("gear.flange_b").geared, node("first.flange_b").geared);
    assert!(geared == node("rotor.flange_b").geared && geared != elastic);
    let effects = catalogue(&MemoryWorld::default(), None).value.expect("a catalogue").effects;
    let all = hypotheses(&places, &effects, &[], &[]);
    let between = |a: &str, b: &str| {
        let place = format!("{a}|{b}");
        all.iter().flat_map(Hypothesis::places).filter(|p| p.place == place).count()
    };
    assert_eq!(between("gear.flange_a", "gear.flange_b"), 0);
    assert!(between("first.flange_a", "first.flange_b") > 0);
}

/// The file with the corrected model needs nothing beside it and runs as the augmented model does.
#[test]
fn the_corrected_model_stands_alone() {
    let (request, places, all) = axis();
    let free = UncertainParameter { name: "M".into(), nominal: 120.0, sigma: 2.0 };
    let drift = hypotheses(&places, &[], &[], &[free]).remove(0);
    let wanted = [
        ("Effects.InternalLeak", "G", 3e-12),
        ("Effects.TranslationalStribeckFriction", "F_c", 300.0),
        ("Effects.SensorOffset", "b", 2.0),
        ("Effects.CommandDeadTime", "k", 1.0),
        ("Effects.LineInertance", "R", 5e9),
    ];
    let found = wanted.iter().map(|(e, ..)| all.iter().find(|h| h.effect == *e).expect("it fits"));
    let mut attached: Vec<HypothesisInstance<'_>> = wanted
        .iter()
        .zip(found)
        .enumerate()
        .map(|(i, ((_, n, v), hypothesis))| HypothesisInstance {
            name: format!("h{i}"),
            hypothesis,
            values: vec![(n.to_string(), *v)],
        })
        .collect();
    attached[4].values.push(("L".into(), 1e6));
    attached.push(HypothesisInstance { name: "m".into(), hypothesis: &drift, values: vec![("M".into(), 130.0)] });
    let signals = gap_axis_signals();
    let nothing = MemoryWorld::default();
    let text = fixed(&nothing, &request, None, &places, &attached, &signals).value.expect("a text");
    assert!(!text.contains("break connect") && text.contains("package GapAxis"));
    let alone = run(&MemoryWorld::single("fixed.mo", &text), "fixed.mo", "Fixed");
    let augmented = augment(&places, &attached, &signals).text.replace("Plant plant;", "Plant plant(M = 130);");
    let beside = run(&MemoryWorld::single("Augmented.mo", augmented), "Augmented.mo", "Augmented");
    for name in ["w", "i", "p1", "p2", "x"] {
        let error = difference(&beside, &alone, name, name);
        assert!(error < 1e-6, "{name}: {error}");
    }
    let nominal = run(&nothing, "GapAxis.Nominal", "GapAxis.Nominal");
    assert!(difference(&nominal, &alone, "x", "x") > 1e-2);
}

/// Effects that only lose power do so at every moment, whatever moves their ports.
#[test]
fn losses_lose() {
    let effects = catalogue(&MemoryWorld::default(), None).value.expect("a catalogue").effects;
    let families = [
        "dry_friction",
        "viscous_friction",
        "quadratic_drag",
        "pressure_friction",
        "internal_leak",
        "external_leak",
        "compression_loss",
        "valve_early_opening",
    ];
    let losing =
        |e: &&std::sync::Arc<EffectModel>| families.contains(&e.family.as_str()) && !e.class.contains("Asymmetric");
    let mut text = String::from("model Losses\n");
    let mut equations = String::new();
    let mut names = Vec::new();
    for (i, e) in effects.iter().filter(losing).enumerate() {
        let values: Vec<String> = e.coefficients.iter().map(|c| format!("{} = {:e}", c.name, c.nominal)).collect();
        text.push_str(&format!("  {} e{i}({});\n  Real power_{i};\n", e.class, values.join(", ")));
        let mut rates = Vec::new();
        for (k, q) in e.interface.potential.iter().chain(&e.interface.sense).enumerate() {
            let size = if q.unit == "Pa" {
                8e6
            } else if q.unit == "m" {
                0.02
            } else {
                3.0
            };
            let w = 2.0 + 1.3 * k as f64;
            equations.push_str(&format!("  e{i}.{} = {size:e}*(1.1 + sin({w}*time + {k}));\n", q.name));
            let name = format!("e{i}.{}", q.name);
            rates.push(if matches!(q.unit.as_str(), "m" | "rad") { format!("der({name})") } else { name });
        }
        let through = &e.interface.through.as_ref().expect("a through variable").name;
        let drop = match e.interface.potential.len() {
            1 if e.class.ends_with("ToAmbient") => format!("({} - e{i}.p_0)", rates[0]),
            1 => rates[0].clone(),
            _ => format!("({} - {})", rates[0], rates[1]),
        };
        equations.push_str(&format!("  power_{i} = e{i}.{through}*{drop};\n"));
        names.push((format!("power_{i}"), e.class.clone(), e.states > 0));
    }
    text.push_str(&format!("equation\n{equations}end Losses;\n"));
    let world = MemoryWorld::single("Losses.mo", text);
    let request = Request { source: "Losses.mo".into(), ..Request::default() };
    let mut simulation = Simulation::compile(&world, &request).unwrap_or_else(|e| panic!("{e}"));
    let run = simulation.stop_time(10.0).run().unwrap_or_else(|e| panic!("{e}"));
    for (power, class, stores) in names {
        let column = run.trajectory.column(&power).expect("a result");
        if stores {
            // gives back what it stored, but no more
            assert!(column.iter().sum::<f64>() > 0.0, "{class}");
            continue;
        }
        let (least, greatest) = column.iter().fold((0.0f64, 0.0f64), |(a, b), &v| (a.min(v), b.max(v)));
        assert!(greatest > 0.0 && least >= -2e-2 * greatest, "{class}: {least} to {greatest}");
    }
}

/// A model of the user's own in a folder competes with the others.
#[test]
fn own_effects() {
    let mut world = MemoryWorld::default();
    world.add(
        "own/Sticky.mo",
        "model Sticky \"Sticks at one end\"
          extends Effects.Interfaces.TranslationalShunt;
          parameter Real F(unit = \"N\", min = 0, nominal = 50) = 0;
          parameter Real l(unit = \"m\") = 0.01;
        equation
          f = F*exp(-(s/l)^2)*tanh(v/0.01);
          annotation(__bramah(family = \"dry_friction\", coefficients = {\"F\"}, shapes(l = {0.003, 0.01})));
        end Sticky;",
    );
    let folder = Path::new("own");
    let effects = catalogue(&world, Some(folder));
    assert!(effects.diagnostics.is_empty(), "{:?}", effects.diagnostics);
    let effects: Vec<_> = effects.value.unwrap().effects.into_iter().filter(|e| e.class == "Sticky").collect();
    let request = Request { source: "GapAxis.Nominal".into(), ..Request::default() };
    let places = value(circuit(&world, &request));
    let all = hypotheses(&places, &effects, &[], &[]);
    assert_eq!(listed(&all), "dry_friction Sticky at chamber_1.flange x2");
    let attached = [HypothesisInstance { name: "h".into(), hypothesis: &all[0], values: vec![] }];
    let text = augment(&places, &attached, &[]);
    value(compile(&world, &request, Some(folder), &text, &lower::LoweringOptions::default()));
}

/// What a connection or an equation of the model gives to a component may suffer what commands suffer; what only looks may
/// not. The corrected model has the effect in place of the statement.
#[test]
fn signals_inside_the_model_are_places() {
    let text = "
model Loop
  block Control
    input Real e(unit = \"1\");
    output Real y(unit = \"1\");
    parameter Real k = 20;
  equation
    y = k*e;
  end Control;
  model Axis
    input Real u(unit = \"1\");
    Real s(unit = \"m\", start = 0, fixed = true);
  equation
    der(s) = 0.1*u;
  end Axis;
  input Real ref(unit = \"m\");
  output Real s(unit = \"m\");
  Control control;
  Axis axis;
equation
  control.e = ref - axis.s; // closes the loop
  connect(control.y, axis.u);
  s = axis.s;
end Loop;
";
    let world = MemoryWorld::single("Loop.mo", text);
    let request = Request { source: "Loop.mo".into(), ..Request::default() };
    let signals = [signal("s", "s", 0.1)];
    let places = value(circuit(&world, &request));
    let names: Vec<&str> = places.links.iter().map(|l| l.signal.name.as_str()).collect();
    assert_eq!(names, ["control.e", "axis.u"]);
    let listed = check(&world, &request, &signals);
    assert!(listed.contains("dead_zone Effects.CommandDeadZone at axis.u x4"), "{listed}");
    assert!(!listed.contains("at axis.s"), "{listed}");

    let effects = catalogue(&world, None).value.expect("a catalogue").effects;
    let all = hypotheses(&places, &effects, &signals, &[]);
    let zone = |h: &&Hypothesis| h.effect == "Effects.CommandDeadZone" && h.places()[0].place == "axis.u";
    let values = vec![("k".to_string(), 1.0), ("d".to_string(), 0.5)];
    let attached =
        [HypothesisInstance { name: "e0".into(), hypothesis: all.iter().find(zone).expect("a place"), values }];
    let file = fixed(&world, &request, None, &places, &attached, &signals).value.expect("a corrected model");
    assert!(!file.contains("connect(control.y, axis.u)"), "{file}");
    let alone = MemoryWorld::single("Fixed.mo", file);
    let request = Request { source: "Fixed.mo".into(), model: Some("Fixed".into()), ..Request::default() };
    value(bramah::internals::compile::compile(&alone, &request, &lower::LoweringOptions::default()));
}

/// A mistake in an effect of the user's own is shown in its file.
#[test]
fn a_mistake_in_an_own_effect_is_shown_where_it_is() {
    let text = "
model Leak
  extends Effects.Interfaces.HydraulicShunt;
  parameter Nowhere.Conductance G = 0;
equation
  q = G*p;
  annotation(__bramah(family = \"external_leak\", coefficients = {\"G\"}));
end Leak;
";
    let outcome = catalogue(&MemoryWorld::single("fx/Leak.mo", text), Some(Path::new("fx")));
    assert!(outcome.value.is_none());
    let said = render(&outcome.sources, &outcome.diagnostics, DiagnosticFormat::Short, 160, false);
    assert!(said.starts_with("fx/Leak.mo:4:13: error[E010]"), "{said}");
}

/// The law of a play holds beyond the edges of the gap, which a step of a solver may well leave, and from either side: the
/// force of a motion, the motion of a force. Odd and growing, it makes no energy.
#[test]
fn a_play_has_a_force_beyond_its_gap() {
    let play = "Effects.RodBacklash play(b = 0.01, F_min = -1000, F_max = 1000)";
    let text = format!(
        "model Moved {play}; Real f = play.f; Real s; equation s = 0.006*sin(time); play.s_rel = s; end Moved;
         model Loaded {play}; Real f; Real s = play.s_rel; equation f = 4000*sin(time); play.f = f; end Loaded;"
    );
    let world = MemoryWorld::single("play.mo", text);
    let run = |class: &str| {
        let request = Request { source: "play.mo".into(), model: Some(class.into()), ..Request::default() };
        let mut simulation = Simulation::compile(&world, &request).unwrap_or_else(|e| panic!("{e}"));
        simulation.stop_time(7.0);
        let trajectory = simulation.run().unwrap_or_else(|e| panic!("{e}")).trajectory;
        let column = |name: &str| trajectory.column(name).expect("a column").to_vec();
        column("f").into_iter().zip(column("s")).collect::<Vec<(f64, f64)>>()
    };
    // at a fifth beyond the gap: a hundredth of 1000 N per half gap, and 1000 N per twentieth of it
    let most = run("Moved").iter().fold(0.0_f64, |m, p| m.max(p.0));
    assert!((most - (12.0 + 0.2 / 0.05 * 1000.0)).abs() < 5.0, "{most}");
    let far = run("Loaded").iter().fold(0.0_f64, |m, p| m.max(p.1));
    assert!((far - 0.005 * (1.0 + 4.0 * 0.05)).abs() < 1e-5, "{far}");
    for (f, s) in run("Moved").into_iter().chain(run("Loaded")) {
        assert!(f * s >= 0.0, "{f} N at {s} m");
        assert!(s.abs() > 0.0049 || f.abs() < 10.5, "{f} N within the gap, at {s} m");
    }
}

/// Heat needs no component between two bodies.
#[test]
fn heat_passes_between_bodies_that_nothing_joins() {
    let text = "model Two
      Thermal.HeatCapacitor a(C = 5, T_start = 300); Thermal.HeatCapacitor b(C = 5, T_start = 290);
      Thermal.ThermalConductor air(G = 0.1); Thermal.FixedTemperature room(T = 290);
      equation connect(a.port, air.port_a); connect(air.port_b, room.port); end Two;";
    let world = MemoryWorld::single("two.mo", text.to_string());
    let request = Request { source: "two.mo".into(), ..Request::default() };
    let effects = catalogue(&world, None).value.expect("a catalogue").effects;
    let all = hypotheses(&value(circuit(&world, &request)), &effects, &[], &[]);
    let bridges = all.iter().filter(|h| h.effect == "Effects.HeatBridge");
    let places: Vec<&str> = bridges.map(|h| h.places()[0].place.as_str()).collect();
    assert_eq!(places, ["air.port_a|air.port_b", "a.port|b.port", "b.port|air.port_b"]);
}
