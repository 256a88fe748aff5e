//! What a run costs, and that its error follows the tolerance: on shipped models, over four decades of it.

#![allow(clippy::disallowed_methods, reason = "tests read their own files")]

use crate::disk;

use bramah::internals::solve::{End, Statistics};
use bramah::results::Trajectory;
use bramah::world::MemoryWorld;
use bramah::{Request, Simulation};
use disk::Disk;
use std::path::{Path, PathBuf};

/// A shipped class, or a file of `models/`.
fn compiled(source: &str) -> Simulation {
    let path = if source.ends_with(".mo") {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("models").join(source)
    } else {
        PathBuf::from(source)
    };
    let request = Request { source: path, ..Request::default() };
    Simulation::compile(&Disk, &request).unwrap_or_else(|e| panic!("{source}: {e}"))
}

fn run(simulation: &mut Simulation, tolerance: f64) -> (Trajectory, Statistics) {
    simulation.settings().tolerance = tolerance;
    let outcome = simulation.run().unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(outcome.end, End::Reached);
    (outcome.trajectory, outcome.statistics)
}

/// Evaluations of residual and Jacobian and the number of events at tolerance 1e-6, as they were when last looked at;
/// those for rows (one or two evaluations each, where there are algebraic unknowns) are counted too.
/// The first two may differ by a tenth from machine to machine, for its exponentials may round differently.
const WORK: [(&str, u64, u64, u64); 8] = [
    // a thousand rows, each solved for the voltages of its motor
    ("ServoPump.DeadZone", 1528, 50, 1),
    // the corners of its reference are events
    ("ServoPump.System", 12587, 312, 5),
    ("ClosedCircuit.Case1", 326, 39, 2),
    ("ClosedCircuit.Case2", 371, 67, 4),
    ("Belt", 7420, 281, 79),
    ("stiff/Robertson.mo", 309, 25, 0),
    ("stiff/AkzoNobel.mo", 342, 19, 0),
    ("stiff/TransistorAmplifier.mo", 6571, 495, 0),
];

#[test]
fn work_stays_what_it_was() {
    let near = |now: u64, then: u64| now.abs_diff(then) * 10 <= then + 20;
    let mut moved = Vec::new();
    for (source, residuals, jacobians, events) in WORK {
        let (_, s) = run(&mut compiled(source), 1e-6);
        let (r, j, e) = (s.residual_evaluations, s.jacobian_evaluations, s.events);
        if !near(r, residuals) || !near(j, jacobians) || e != events {
            moved.push(format!("    (\"{source}\", {r}, {j}, {e}),  // was {residuals}, {jacobians}, {events}"));
        }
    }
    assert!(moved.is_empty(), "less is better, more needs a reason:\n{}", moved.join("\n"));
}

/// The largest difference of the signals over the grid, each as a part of its largest value.
fn difference(a: &Trajectory, b: &Trajectory, signals: &[&str]) -> f64 {
    let mut worst = 0.0_f64;
    for name in signals {
        let (i, y) = (a.index(name).expect("recorded"), b.index(name).expect("recorded"));
        let size = b.columns[y].iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        for (k, &t) in b.times.iter().enumerate() {
            let v = a.value(i, t).expect("equal grids");
            worst = worst.max((v - b.columns[y][k]).abs() / size);
        }
    }
    worst
}

/// Errors at 1e-4, 1e-6 and 1e-8 against a run at 1e-10. With variable order the error of a long run falls like a power
/// of the tolerance somewhat below one: two decades gain a factor of 9 to 60 in most of these models, 6 at least is asked
/// for on the mean of both steps, and some at each. (The amplifier's 1e-6 happens to be better than it should.)
#[test]
fn the_error_follows_the_tolerance() {
    let models: [(&str, &[&str]); 5] = [
        ("ServoPump.DeadZone", &["p_A", "p_B"]),
        ("ClosedCircuit.Case1", &["p", "n_m"]),
        ("stiff/Robertson.mo", &["y_1", "y_2", "y_3"]),
        ("stiff/AkzoNobel.mo", &["y_1", "y_2", "y_6"]),
        ("stiff/TransistorAmplifier.mo", &["y[5]", "y[8]"]),
    ];
    for (source, signals) in models {
        let mut simulation = compiled(source);
        simulation.settings().event_rows = false;
        let (reference, _) = run(&mut simulation, 1e-10);
        let errors =
            [1e-4, 1e-6, 1e-8].map(|tolerance| difference(&run(&mut simulation, tolerance).0, &reference, signals));
        assert!(errors[0] < 2e-2 && errors[2] < 1e-4, "{source}: {errors:?}");
        assert!(errors[1] < errors[0] / 1.5 && errors[2] < errors[1] / 1.5, "{source}: {errors:?}");
        assert!(errors[2] < errors[0] / 36.0, "{source}: {errors:?}");
    }
}

/// Rows of masses with dry friction, hundreds of them sticking and slipping: they pass (one contact used to chatter to the
/// end of the run), with as many events as they have, and a tight run says the same.
#[test]
fn chains_of_frictions_pass() {
    for (n, events, within) in [(10, 29, 2e-3), (100, 344, 2e-2)] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/models/Networks.mo");
        let networks = std::fs::read_to_string(path).expect("the file is there");
        let text = format!("{networks}model Run\n  extends Networks.Frictions(N = {n});\nend Run;\n");
        let model = Some("Run".to_owned());
        let request = Request { source: "run.mo".into(), model, ..Request::default() };
        let world = MemoryWorld::single("run.mo", text);
        let mut simulation = Simulation::compile(&world, &request).unwrap_or_else(|e| panic!("{e}"));
        simulation.settings().event_rows = false;
        let (usual, s) = run(&mut simulation, 1e-6);
        assert!(s.events.abs_diff(events) * 20 <= events, "{n}: {} events", s.events);
        let (tight, _) = run(&mut simulation, 1e-8);
        let apart = difference(&usual, &tight, &["mass[1].s", "mass[1].v"]);
        assert!(apart < within, "{n}: {apart}");
    }
}
