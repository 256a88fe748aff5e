//! The stiff and DAE set of `models/stiff` against published or own reference values (`tests/stiff/references.toml`), at
//! three tolerances, with the work that a run is.

#![allow(clippy::disallowed_methods, reason = "tests read their own files")]

use bramah::internals::solve::{End, Statistics};
use bramah::world::MemoryWorld;
use bramah::{Request, Simulation};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::fmt::Write;

const TOLERANCES: [f64; 3] = [1e-4, 1e-6, 1e-8];

#[derive(Deserialize)]
struct References {
    problem: Vec<Problem>,
}

#[derive(Deserialize)]
struct Problem {
    model: String,
    end: f64,
    source: String,
    note: Option<String>,
    modify: Option<String>,
    limit: [f64; 3],
    values: BTreeMap<String, f64>,
}

fn references() -> Vec<Problem> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/stiff/references.toml");
    let text = std::fs::read_to_string(path).expect("the file is there");
    toml::from_str::<References>(&text).expect("it is a table").problem
}

fn compiled(problem: &Problem) -> Simulation {
    let (class, modify) = (&problem.model, problem.modify.as_deref().unwrap_or(""));
    let world = MemoryWorld::single("run.mo", format!("model Run\n  extends {class}({modify});\nend Run;\n"));
    let request = Request { source: "run.mo".into(), ..Request::default() };
    let mut simulation = Simulation::compile(&world, &request).unwrap_or_else(|e| panic!("{e}"));
    simulation.stop_time(problem.end).settings().interval = 0.0;
    simulation
}

/// The largest error of the values at the end, each relative to its reference, and the work.
fn error(problem: &Problem, simulation: &mut Simulation, tolerance: f64) -> (f64, Statistics) {
    simulation.settings().tolerance = tolerance;
    let outcome = simulation.run().unwrap_or_else(|e| panic!("{} at {tolerance:e}: {e}", problem.model));
    assert_eq!(outcome.end, End::Reached);
    let relative = |(name, reference): (&String, &f64)| {
        let column = outcome.trajectory.column(name).unwrap_or_else(|| panic!("{} has no {name}", problem.model));
        (column.last().expect("a row") - reference).abs() / reference.abs()
    };
    (problem.values.iter().map(relative).fold(0.0, f64::max), outcome.statistics)
}

/// To two digits: the third depends on how the machine rounds its exponentials.
fn about(count: u64) -> u64 {
    let unit = 10_u64.pow(count.checked_ilog10().unwrap_or(0).saturating_sub(1));
    (count + unit / 2) / unit * unit
}

#[test]
fn the_stiff_set_ends_at_its_reference_values() {
    let mut table = String::from("model                tolerance   steps  residuals  Jacobians  failed  events\n");
    let mut errors = String::new();
    let mut bad = 0;
    for problem in references() {
        assert!(problem.source == "published" || problem.note.is_some(), "{}: own digits need a word", problem.model);
        let mut simulation = compiled(&problem);
        for (tolerance, limit) in TOLERANCES.into_iter().zip(problem.limit) {
            let (error, s) = error(&problem, &mut simulation, tolerance);
            let _ = writeln!(
                table,
                "{:20} {tolerance:9.0e} {:>7} {:>10} {:>10} {:>7} {:>7}",
                problem.model,
                about(s.steps),
                about(s.residual_evaluations),
                about(s.jacobian_evaluations),
                about(s.error_test_failures),
                s.events
            );
            let judged = if error <= limit { "" } else { "  too large" };
            bad += usize::from(error > limit);
            let _ = writeln!(errors, "{:20} {tolerance:9.0e} {error:9.1e} of {limit:7.0e}{judged}", problem.model);
        }
    }
    assert!(bad == 0, "{errors}");
    insta::assert_snapshot!(table);
}
