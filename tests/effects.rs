//! Effects at the places of real circuits: what is found, and that everything compiles in one model.

#![allow(
    clippy::disallowed_methods,
    clippy::print_stdout,
    reason = "tests read their own files and say what they skip"
)]

use bramah::diag::render::{Format, render};
use bramah::gap::augment::{Attached, augment, compile};
use bramah::gap::circuit::{Circuit, circuit};
use bramah::gap::effects::{Attach, catalogue};
use bramah::gap::hypotheses::{Hypothesis, Signal, hypotheses};
use bramah::lower;
use bramah::world::{MemoryWorld, World};
use bramah::{Outcome, Request};
use std::path::{Path, PathBuf};

fn value<T>(outcome: Outcome<T>) -> T {
    let said = render(&outcome.sources, &outcome.diagnostics, Format::Short, 160, false);
    outcome.value.unwrap_or_else(|| panic!("{said}"))
}

fn signal(name: &str, variable: &str, scale: f64) -> Signal {
    Signal { name: name.into(), variable: variable.into(), scale }
}

fn listed(all: &[Hypothesis]) -> String {
    let line = |h: &Hypothesis| {
        let places: Vec<&str> = h.places().iter().map(|p| p.place.as_str()).collect();
        let order = if h.changes_order { " (order)" } else { "" };
        format!("{} {} at {}{order} x{}", h.family, h.effect, places.join(" + "), h.variants().len())
    };
    all.iter().map(line).collect::<Vec<_>>().join("\n")
}

fn check(world: &dyn World, request: &Request, signals: &[Signal]) -> String {
    let effects = catalogue(world, None);
    assert!(effects.diagnostics.is_empty(), "{:?}", effects.diagnostics);
    let effects = effects.value.expect("a catalogue");
    assert!(effects.iter().any(|e| e.interface.attach == Attach::Shunt));
    let places = value(circuit(world, request));
    let all = hypotheses(&places, &effects, signals, &[]);
    let mut attached = Vec::new();
    for (i, h) in all.iter().enumerate().filter(|(_, h)| !h.changes_order) {
        for (k, values) in h.variants().into_iter().enumerate() {
            attached.push(Attached { name: format!("h{i}_{k}"), hypothesis: h, values });
        }
    }
    let text = augment(&places, &attached, signals);
    let model = value(compile(world, request, None, &text, &lower::Options::default()));
    let plain = value(bramah::compile(world, request, &lower::Options::default()));
    let states = |m: &bramah::Model, prefix: &str| -> Vec<String> {
        let names = m.dae.states.iter().map(|v| m.dae.variables[v.index()].name.clone());
        let mut names: Vec<String> = names.map(|n| n.strip_prefix(prefix).unwrap_or(&n).to_string()).collect();
        names.sort();
        names
    };
    assert_eq!(states(&model, "plant.").len(), states(&plain, "").len());
    alone(world, request, signals, &places, &all);
    listed(&all)
}

/// Effects that change the order of the system compile one by one, with typical sizes.
fn alone(world: &dyn World, request: &Request, signals: &[Signal], places: &Circuit, all: &[Hypothesis]) {
    let mut bad = Vec::new();
    for h in all.iter().filter(|h| h.changes_order) {
        let values = h.coefficients.iter().map(|c| (c.name.clone(), c.nominal)).collect();
        let text = augment(places, &[Attached { name: "h".into(), hypothesis: h, values }], signals);
        let outcome = compile(world, request, None, &text, &lower::Options::default());
        if outcome.value.is_none() {
            let said = render(&outcome.sources, &outcome.diagnostics, Format::Short, 160, false);
            bad.push(format!("{} at {}\n{said}", h.effect, h.places()[0].place));
        }
    }
    assert!(bad.is_empty(), "{}", bad.join("\n"));
}

#[test]
fn gap_axis() {
    let request = Request { source: PathBuf::from("GapAxis.Nominal"), ..Request::default() };
    let signals = [
        signal("w", "w", 100.0),
        signal("i", "i", 10.0),
        signal("p1", "p1", 5e6),
        signal("p2", "p2", 5e6),
        signal("x", "x", 0.05),
    ];
    insta::assert_snapshot!(check(&MemoryWorld::default(), &request, &signals));
}

#[test]
fn foreign_connectors() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/bench/Hyd.mo");
    let path = if path.exists() { path } else { PathBuf::from("/work/shared/bench/Hyd.mo") };
    let Ok(text) = std::fs::read_to_string(&path) else {
        println!("skipped: there is no {}", path.display());
        return;
    };
    let world = MemoryWorld::single("Hyd.mo", text);
    let request = Request { source: "Hyd.mo".into(), model: Some("Hyd.Circuit".into()), ..Request::default() };
    let signals = [signal("p", "vol2.p", 150e5), signal("x", "mass.s", 0.5)];
    insta::assert_snapshot!(check(&world, &request, &signals));
}
