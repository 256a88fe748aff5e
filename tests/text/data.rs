//! Study files that ship: each ties to its model; with the recordings at hand, the models follow them as published.

#![allow(clippy::disallowed_methods, reason = "tests read their own files")]
#![allow(clippy::print_stdout, reason = "a test without its data says so")]

use crate::disk;

use bramah::Sources;
use bramah::internals::analysis::identify::{
    Identification, IdentificationProblem, IdentificationReport, IdentifyMethod,
};
use bramah::internals::diag::render::{DiagnosticFormat, render};
use bramah::internals::study::{BoundStudy, Recording, RecordingRole, Study};
use bramah::world::MemoryWorld;
use bramah::{Request, Simulation};
use disk::Disk;
use std::path::{Path, PathBuf};

fn models() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("models")
}

fn shipped(class: &str) -> Simulation {
    let request = Request { source: PathBuf::from(class), ..Request::default() };
    Simulation::compile(&MemoryWorld::default(), &request).unwrap_or_else(|e| panic!("{class}: {e}"))
}

fn study(file: &str) -> Study {
    let mut sources = Sources::default();
    let read = Study::read(&Disk, &models().join(file), &mut sources);
    read.value.unwrap_or_else(|| panic!("{}", render(&sources, &read.diagnostics, DiagnosticFormat::Short, 120, false)))
}

/// A study tied to its class, or to another one with the same signals.
fn tied(study: &Study, class: Option<&str>) -> (BoundStudy, Simulation) {
    let simulation = shipped(class.or(study.class.as_deref()).expect("a class"));
    let tied = study.bind(&simulation.model().flat);
    let said: Vec<&str> = tied.diagnostics.iter().map(|d| d.message.as_str()).collect();
    assert!(said.is_empty(), "{said:?}");
    (tied.value.expect("no diagnostics"), simulation)
}

/// The recordings of one role, or nothing where the data of the bench are not at hand.
fn recordings(bound: &BoundStudy, folder: &str, role: RecordingRole) -> Option<Vec<Recording>> {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared").join(folder);
    if !data.is_dir() {
        println!("skipped: no folder ../shared/{folder}");
        return None;
    }
    let mut sources = Sources::default();
    let loaded = bound.load(&Disk, Some(&data), role, &mut sources);
    let said = render(&sources, &loaded.diagnostics, DiagnosticFormat::Short, 120, false);
    Some(loaded.value.unwrap_or_else(|| panic!("{said}")))
}

/// Root mean square of measured minus simulated, a number for each signal; and that of the measured signal itself.
fn errors(simulation: &mut Simulation, bound: &BoundStudy, recording: &Recording) -> Vec<(f64, f64)> {
    let times = &recording.times;
    for (input, values) in bound.inputs.iter().zip(&recording.inputs) {
        simulation.input(&input.name, times, values, input.interpolation).expect("an input");
    }
    let end = *times.last().expect("samples");
    simulation.stop_time(end).settings().interval = times[1] - times[0];
    let run = simulation.run().unwrap_or_else(|e| panic!("{e}")).trajectory;
    let signals = bound.signals.iter().zip(&recording.signals);
    signals
        .map(|(signal, measured)| {
            let index = run.index(&simulation.model().flat.variables[signal.variable.index()].name).expect("recorded");
            let pairs = || times.iter().zip(measured).filter(|(_, m)| m.is_finite());
            let mean = |of: &dyn Fn(f64, f64) -> f64| {
                let sum: f64 = pairs().map(|(t, m)| of(*t, *m).powi(2)).sum();
                (sum / pairs().count() as f64).sqrt()
            };
            (mean(&|t, m| m - run.value(index, t).expect("inside the run")), mean(&|_, m| m))
        })
        .collect()
}

#[test]
fn every_study_ties_to_its_model() {
    for file in [
        "CascadedTanks/identify.toml",
        "CascadedTanks/gap.toml",
        "CoupledDrives/identify.toml",
        "CoupledDrives/in_sample.toml",
        "CoupledDrives/gap.toml",
        "Emps/identify.toml",
        "Emps/gap.toml",
        "GapAxis/study.toml",
    ] {
        let (bound, _) = tied(&study(file), None);
        assert!(!bound.signals.is_empty(), "{file}");
    }
}

/// With one initial state for both records: 0.67 V without overflow and dead zone, 0.19 V with them and the sensor's curve.
#[test]
fn the_tanks_follow_the_validation_record() {
    for (class, wanted) in [("CascadedTanks.Nominal", 0.67), ("CascadedTanks.Complete", 0.194)] {
        let (bound, mut simulation) = tied(&study("CascadedTanks/gap.toml"), Some(class));
        let Some(held) = recordings(&bound, "data/cascaded_tanks", RecordingRole::Held) else { return };
        let (error, _) = errors(&mut simulation, &bound, &held[0])[0];
        assert!((error - wanted).abs() < 0.01, "{class}: {error} V");
    }
}

/// In the loop the position stays within micrometres, the force shows the friction.
#[test]
fn the_axis_follows_force_and_position() {
    for (class, share) in [("Emps.Nominal", 0.38), ("Emps.Complete", 0.06)] {
        let (bound, mut simulation) = tied(&study("Emps/gap.toml"), Some(class));
        let Some(train) = recordings(&bound, "data/emps", RecordingRole::Train) else { return };
        let found = errors(&mut simulation, &bound, &train[0]);
        assert!(found[0].0 < 2e-5, "position: {} m", found[0].0);
        assert!((found[1].0 / found[1].1 - share).abs() < 0.02, "{class}: force {:?}", found[1]);
    }
}

/// Closed loop with the sampled controller and friction that sticks: 4.5 % of the force is published for it, 38 % without
/// dry friction. The recording begins in motion: 7.45 um and, as its first voltage tells, 5.65 mm/s.
#[test]
fn the_sampled_loop_follows_the_force() {
    let mut in_loop = study("Emps/gap.toml");
    in_loop.class = Some("Emps.ClosedLoop".into());
    in_loop.parameters.clear();
    for (dry, share) in [(20.3935, 0.046), (0.0, 0.38)] {
        let (bound, mut simulation) = tied(&in_loop, None);
        let Some(train) = recordings(&bound, "data/emps", RecordingRole::Train) else { return };
        for (name, value) in [("F_c", dry), ("q_start", 7.45e-6), ("v_start", 5.65e-3)] {
            simulation.set(name, value).expect("a parameter");
        }
        let found = errors(&mut simulation, &bound, &train[0]);
        assert!((found[1].0 / found[1].1 - share).abs() < 0.003, "{dry}: force {:?}", found[1]);
    }
}

#[test]
fn the_drives_follow_the_held_record_with_the_rectifying_pick_up() {
    for (class, wanted) in [("CoupledDrives.Nominal", 2.5), ("CoupledDrives.Complete", 0.5)] {
        let (bound, mut simulation) = tied(&study("CoupledDrives/gap.toml"), Some(class));
        let Some(held) = recordings(&bound, "data/ced_coupled_drives", RecordingRole::Held) else { return };
        let (error, _) = errors(&mut simulation, &bound, &held[0])[0];
        assert!((error - wanted).abs() < 0.1, "{class}: {error} V");
    }
}

/// The nominal plant of the gap bench, made by another simulator: relative deviation below 1e-4 for each signal.
#[test]
fn the_axis_of_the_gap_bench_reproduces_its_nominal_plant() {
    for file in ["chirp.csv", "steps.csv"] {
        let mut nominal = study("GapAxis/study.toml");
        nominal.recordings.truncate(1);
        nominal.recordings[0].file = file.into();
        let (bound, mut simulation) = tied(&nominal, None);
        let Some(train) = recordings(&bound, "gapbench/nominal", RecordingRole::Train) else { return };
        for (signal, (error, size)) in bound.signals.iter().zip(errors(&mut simulation, &bound, &train[0])) {
            assert!(error < 1e-4 * size, "{file}: {} by {}", signal.name, error / size);
        }
    }
}

/// What `bramah identify` finds with a study: values by parameter, and errors by signal on the held recordings.
fn identified(file: &str, folder: &str) -> Option<IdentificationReport> {
    let (bound, simulation) = tied(&study(file), None);
    let train = recordings(&bound, folder, RecordingRole::Train)?;
    let problem = IdentificationProblem::new(simulation.model(), &bound, &train).expect("a sound question");
    let found = Identification::new(&problem, &train, IdentifyMethod::Auto).expect("runs");
    let fit = found.fit().expect("runs");
    let held =
        if bound.has(RecordingRole::Held) { recordings(&bound, folder, RecordingRole::Held)? } else { Vec::new() };
    let held = if held.is_empty() { Vec::new() } else { found.judge_held(&fit, &held).expect("runs") };
    Some(IdentificationReport::new(&problem, &found, &fit, &held, &[]))
}

/// The published values, within what the publication and ours differ in filtering.
#[test]
fn the_axis_is_identified_by_its_inverse_model() {
    let Some(report) = identified("Emps/identify.toml", "data/emps") else { return };
    for (name, published, share) in [("M", 95.1, 0.01), ("F_v", 203.5, 0.04), ("F_c", 20.4, 0.04), ("F_0", -3.16, 0.03)]
    {
        let (value, std) = (report.parameters[name]["value"].as_f64(), report.parameters[name]["std"].as_f64());
        let (value, std) = value.zip(std).expect("numbers");
        assert!((value - published).abs() < share * published.abs(), "{name}: {value}");
        assert!((value - published).abs() < 2.0 * std, "{name}: {value} +- {std}");
    }
    assert!(report.converged && report.fit_relative.train["F"].as_f64().expect("a number") < 0.041);
}

/// 0.34 V is the reference fit with overflow and dead zone, 0.18 V the best published grey box.
#[test]
fn the_tanks_are_identified() {
    let Some(report) = identified("CascadedTanks/identify.toml", "data/cascaded_tanks") else { return };
    assert!(report.converged && report.fit.held["y"].as_f64().expect("a number") < 0.2, "{:?}", report.fit);
}

/// 0.18 V is published for the record that was fitted.
#[test]
fn the_drives_are_identified_in_sample() {
    let Some(report) = identified("CoupledDrives/in_sample.toml", "data/ced_coupled_drives") else { return };
    assert!(report.converged && report.fit.train["y"].as_f64().expect("a number") < 0.11, "{:?}", report.fit);
}
