//! How fast a line of N volumes is solved and compiled, as ratios to the same line written by hand in C, run in turn.
//!
//! The C programs and the model are in `../shared/bench`; without them it says `skipped`. A ratio is the median over
//! pairs of runs, with the quartiles as a measure of the machine's noise.

#![allow(clippy::disallowed_methods, clippy::print_stdout, reason = "measures, and prints what it measured")]

#[path = "../tests/disk/mod.rs"]
mod disk;

use bramah::Override;
use bramah::{Request, Simulation};
use disk::Disk;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

const PAIRS: usize = 21;

fn main() {
    let shared = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/bench");
    let model = shared.join("Hyd.mo");
    if !model.exists() {
        println!("against_c: skipped, there is no ../shared/bench");
        return;
    }
    solving(&model, built(&shared).as_deref());
    compiling(&model);
    process(&model);
}

/// The folder with the C programs, built once.
fn built(shared: &Path) -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_BIN_EXE_bramah")).parent()?.join("c_floor");
    if !folder.join("ida_line").exists() {
        let done = Command::new("sh").arg(shared.join("build_c_floor.sh")).arg(&folder).status();
        if !done.is_ok_and(|s| s.success()) {
            println!("the C programs could not be built: no ratios");
            return None;
        }
    }
    Some(folder)
}

fn line(model: &Path, n: usize) -> (Simulation, f64) {
    let request = Request {
        source: model.into(),
        model: Some("Hyd.Line".into()),
        overrides: vec![Override { name: "N".into(), value: n.to_string() }],
        ..Request::default()
    };
    let clock = Instant::now();
    let mut simulation = Simulation::compile(&Disk, &request).unwrap_or_else(|e| panic!("{e}"));
    let seconds = clock.elapsed().as_secs_f64();
    let first = simulation.model().dae.variables.iter().position(|v| v.name == "v[1].p").expect("the first volume");
    let settings = simulation.settings();
    settings.wanted = vec![bramah::internals::expr::VarId(u32::try_from(first).expect("few variables"))];
    (settings.stop_time, settings.interval, settings.tolerance) = (1.0, 0.002, 1e-6);
    (simulation, seconds)
}

/// Seconds and evaluations of the C program.
fn by_hand(folder: &Path, n: usize) -> (f64, f64) {
    let out = Command::new(folder.join("ida_line")).arg(n.to_string()).output().expect("it was built");
    let value: serde_json::Value = serde_json::from_slice(&out.stdout).expect("it prints JSON");
    let number = |key: &str| value[key].as_f64().expect("a number");
    (number("solve_s"), number("residuals"))
}

fn solving(model: &Path, c: Option<&Path>) {
    println!("\nsolving, milliseconds     bramah          C   ratio (quartiles)    residuals   C");
    for n in [10, 100, 1000, 10_000] {
        let (simulation, _) = line(model, n);
        let (mut own, mut theirs, mut ratios) = (Vec::new(), Vec::new(), Vec::new());
        let mut residuals = (0, 0.0);
        for _ in 0..if n < 10_000 { PAIRS } else { 5 } {
            let s = simulation.run().unwrap_or_else(|e| panic!("{e}")).statistics;
            own.push(s.solve_s);
            let (seconds, evaluations) = c.map_or((f64::NAN, f64::NAN), |c| by_hand(c, n));
            theirs.push(seconds);
            ratios.push(s.solve_s / seconds);
            residuals = (s.residual_evaluations, evaluations);
        }
        println!(
            "Hyd.Line N = {n:<6} {:>12.3} {:>10.3}    {:.2} ({:.2} to {:.2}) {:>12} {:>5}",
            1e3 * part(&mut own, 0.5),
            1e3 * part(&mut theirs, 0.5),
            part(&mut ratios, 0.5),
            part(&mut ratios, 0.25),
            part(&mut ratios, 0.75),
            residuals.0,
            residuals.1
        );
    }
}

fn part(values: &mut [f64], share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    values[((values.len() - 1) as f64 * share).round() as usize]
}

fn compiling(model: &Path) {
    println!("\ncompiling                 seconds   us per flat equation");
    for n in [10, 100, 1000, 10_000] {
        let mut seconds: Vec<f64> = (0..if n < 10_000 { 9 } else { 3 }).map(|_| line(model, n).1).collect();
        let equations = line(model, n).0.model().flat.equations.len();
        let s = part(&mut seconds, 0.5);
        println!("Hyd.Line N = {n:<6} {s:>14.4} {:>12.1}", 1e6 * s / equations as f64);
    }
}

/// From the start of the process to its end: compile and solve.
fn process(model: &Path) {
    let folder = std::env::temp_dir();
    let out = folder.join(format!("bramah_bench_{}.csv", std::process::id()));
    let mut seconds: Vec<f64> = (0..PAIRS)
        .map(|_| {
            let clock = Instant::now();
            let run = Command::new(env!("CARGO_BIN_EXE_bramah"))
                .args(["simulate", "--model", "Hyd.Circuit", "--stop-time", "3", "--output-interval", "0.006"])
                .arg("--output-file")
                .arg(&out)
                .arg(model)
                .output();
            assert!(run.is_ok_and(|r| r.status.success()));
            clock.elapsed().as_secs_f64()
        })
        .collect();
    let _ = std::fs::remove_file(out);
    println!("\nHyd.Circuit, whole process: {:.1} ms", 1e3 * part(&mut seconds, 0.5));
}
