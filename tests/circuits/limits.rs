//! Every example of the library with parameters between their limits: drawn at random, finite numbers or a diagnostic
//! with a code; one alone at a limit, a run.
//!
//! The draws are the same in every run. `BRAMAH_DRAWS=200 BRAMAH_SEED=7 cargo test --release --test circuits limits:: --
//! --nocapture` looks further, takes every limit instead of some, and says how each run ended.

#![allow(clippy::disallowed_methods, reason = "reads the library and what it is asked to do")]
#![allow(clippy::print_stdout, reason = "the long run lists how each run ended")]

use crate::disk;
use crate::rig;

use bramah::Request;
use bramah::internals::compile::{CompiledModel, compile};
use bramah::internals::expr::VarId;
use bramah::internals::flat::{ScalarType, Variability};
use bramah::internals::lower::LoweringOptions;
use bramah::internals::solve::{Control, End, Progress, Settings, signals, simulate};
use bramah::results::{Trajectory, number};
use disk::Disk;
use rig::Numbers;
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Rows, events and pauses of a run before it is left.
const PATIENCE: u32 = 600;
/// Rows of a run.
const ROWS: f64 = 50.0;
/// Parameters changed in a draw, at most.
const CHANGED: f64 = 4.0;

/// Of how many limits one is tried every day.
const SOME: usize = 31;
/// `Modelica.Constants.inf` as a limit is none.
const HUGE: f64 = 1e60;

/// The recorded examples, each once.
fn examples() -> Vec<&'static str> {
    let lines = include_str!("../examples.csv").lines().skip(1);
    let mut classes: Vec<&str> = lines.filter_map(|line| line.split(',').next()).collect();
    classes.dedup();
    classes
}

fn from_environment(name: &str, otherwise: u64) -> u64 {
    std::env::var(name).ok().map_or(otherwise, |text| text.parse().expect("a whole number"))
}

/// A parameter that a run may change, with its value and its limits.
struct Parameter {
    id: VarId,
    name: String,
    ty: ScalarType,
    value: f64,
    min: f64,
    max: f64,
}

/// An example, read from the folder beside the tests.
fn model(class: &str, native: bool) -> CompiledModel {
    let library = concat!(env!("CARGO_MANIFEST_DIR"), "/components").into();
    let request = Request { source: class.into(), libraries: vec![library], ..Request::default() };
    let compiled = compile(&Disk, &request, &LoweringOptions { native, ..LoweringOptions::default() });
    compiled.value.unwrap_or_else(|| panic!("{class} does not compile"))
}

/// What users may change without compiling again: neither protected parameters nor those of an array.
fn parameters(model: &CompiledModel) -> Vec<Parameter> {
    let system = &model.system;
    let mut values = system.layout.values();
    system.evaluate_parameters(&mut values, &vec![false; model.dae.variables.len()]);
    let count = u32::try_from(model.dae.variables.len()).expect("few variables");
    let changeable = (0..count).map(VarId).filter_map(|id| {
        let v = &model.dae.variables[id.index()];
        let value = values[system.layout.var(id)];
        let open = v.variability == Variability::Parameter && !v.hidden && !v.name.contains('[');
        (open && value.is_finite()).then(|| Parameter {
            id,
            name: v.name.clone(),
            ty: v.ty,
            value,
            min: system.min(id, &values).unwrap_or(f64::NEG_INFINITY),
            max: system.max(id, &values).unwrap_or(f64::INFINITY),
        })
    });
    changeable.collect()
}

/// A value that the declaration allows: near the given one, at a limit, or anywhere between.
fn draw(p: &Parameter, numbers: &mut Numbers, model: &CompiledModel) -> f64 {
    match p.ty {
        ScalarType::Boolean => f64::from(numbers.next() < 0.5),
        ScalarType::Enumeration(e) => {
            let literals = model.dae.enumerations[e as usize].1.len() as f64;
            1.0 + (numbers.next() * literals).floor()
        }
        ScalarType::Integer => between_limits(p, numbers).round(),
        ScalarType::Real => between_limits(p, numbers),
    }
}

fn between_limits(p: &Parameter, numbers: &mut Numbers) -> f64 {
    let bounded = p.min.is_finite() && p.max.is_finite();
    let value = match numbers.next() {
        k if k < 0.1 && p.min.is_finite() => p.min,
        k if k < 0.2 && p.max.is_finite() => p.max,
        k if k < 0.3 => 0.0,
        k if k < 0.5 && bounded => numbers.between(p.min, p.max),
        k if k < 0.7 => p.value * numbers.between(0.5, 2.0),
        _ => p.value * 10.0_f64.powf(numbers.between(-2.0, 2.0)),
    };
    let signed = if p.min >= 0.0 || numbers.next() < 0.9 { value } else { -value };
    signed.clamp(p.min, p.max).clamp(-HUGE, HUGE)
}

/// Runs with these values; the word for its end, or what is wrong with it.
fn run(model: &CompiledModel, given: &[(VarId, f64)]) -> Result<String, String> {
    let count = u32::try_from(model.flat.variables.len()).expect("few variables");
    let usual = Settings::from_experiment(&model.flat.experiment);
    let settings = Settings {
        wanted: (0..count).map(VarId).collect(),
        interval: (usual.stop_time - usual.start_time) / ROWS,
        parameters: given.to_vec(),
        ..usual
    };
    let mut rows = Trajectory::new(signals(&model.dae, &settings.wanted));
    let mut left = PATIENCE;
    let mut patient = |_: &Progress| {
        left -= 1;
        left > 0
    };
    let mut control = Control { progress: Some(&mut patient), ..Control::default() };
    let run = simulate(&model.system, &settings, &[], None, &mut rows, &mut control);
    if let Some(column) = rows.columns.iter().position(|c| c.iter().any(|v| !v.is_finite())) {
        return Err(format!("`{}` is not finite", rows.signals[column].name));
    }
    match run.diagnostics.iter().find(|d| d.is_error()) {
        Some(error) => Ok(format!("{} {}", error.code.id(), error.message)),
        None if run.end.is_success() || run.end == End::Interrupted => Ok(run.end.word().to_string()),
        None => Err(format!("ends with {} and no word", run.end.word())),
    }
}

/// One draw: what was changed, and what came of it.
fn one(model: &CompiledModel, all: &[Parameter], numbers: &mut Numbers) -> (String, Result<String, String>) {
    let many = 1 + (numbers.next() * CHANGED) as usize;
    let mut given = Vec::new();
    let mut said = Vec::new();
    for _ in 0..many {
        let p = &all[(numbers.next() * all.len() as f64) as usize];
        let value = draw(p, numbers, model);
        said.push(format!("{}={}", p.name, number::text(value)));
        given.push((p.id, value));
    }
    let end = catch_unwind(AssertUnwindSafe(|| run(model, &given)));
    (said.join(" "), end.unwrap_or_else(|_| Err("panics".into())))
}

/// The first word of each end, counted; what is wrong stays.
#[derive(Default)]
struct Tally {
    talks: bool,
    ends: BTreeMap<String, usize>,
    bad: Vec<String>,
}

impl Tally {
    fn note(&mut self, class: &str, given: &str, end: Result<String, String>) {
        match end {
            Ok(word) => {
                *self.ends.entry(word.split(' ').next().unwrap_or_default().to_string()).or_default() += 1;
                if self.talks {
                    println!("{class} {given}: {}", word.lines().next().unwrap_or_default());
                }
            }
            Err(why) => self.bad.push(format!("{class} with {given}: {why}")),
        }
    }

    fn judge(&self) {
        if self.talks {
            println!("{:#?}", self.ends);
        }
        assert!(self.bad.is_empty(), "{} runs\n{}", self.bad.len(), self.bad.join("\n"));
    }
}

fn thorough() -> bool {
    std::env::var_os("BRAMAH_DRAWS").is_some()
}

#[test]
fn parameters_between_their_limits_give_numbers_or_a_diagnostic() {
    let (draws, seed) = (from_environment("BRAMAH_DRAWS", 1), from_environment("BRAMAH_SEED", 1));
    let mut tally = Tally { talks: thorough(), ..Tally::default() };
    for (i, class) in (0u64..).zip(examples()) {
        let model = model(class, thorough());
        let all = parameters(&model);
        let mut numbers = Numbers(seed.wrapping_mul(1_000_003).wrapping_add(i));
        for _ in 0..if all.is_empty() { 0 } else { draws } {
            let (given, end) = one(&model, &all, &mut numbers);
            tally.note(class, &given, end);
        }
    }
    tally.judge();
}

/// What is allowed at a limit: the end, an assertion that ties the parameter to others, or that the circuit around it
/// becomes stiffer (E501), faster (E502) or larger (E504) than 64 bits hold, once it moves. The start is found, and each
/// event has an end.
fn bearable(end: &str) -> bool {
    let usual = ["reached", "terminated", "E507", "E503", "E501", "E502"].iter().any(|word| end.starts_with(word));
    usual || end.starts_with("E504") && !end.contains("at time 0 s")
}

/// A limit says how far a parameter may go: the component must have a meaning there, all else being as it was.
#[test]
fn a_parameter_at_its_limit_gives_numbers() {
    let mut tally = Tally { talks: thorough(), ..Tally::default() };
    let mut number = 0;
    for class in examples() {
        let model = model(class, thorough());
        for p in parameters(&model).iter().filter(|p| matches!(p.ty, ScalarType::Real | ScalarType::Integer)) {
            for value in [p.min, p.max].into_iter().filter(|v| v.abs() < HUGE) {
                number += 1;
                if number % SOME != 0 && !thorough() {
                    continue;
                }
                let end = catch_unwind(AssertUnwindSafe(|| run(&model, &[(p.id, value)])));
                let end = end.unwrap_or_else(|_| Err("panics".into()));
                let end = end.and_then(|word| if bearable(&word) { Ok(word) } else { Err(word) });
                tally.note(class, &format!("{}={}", p.name, number::text(value)), end);
            }
        }
    }
    tally.judge();
}
