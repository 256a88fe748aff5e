//! How often do 95 % intervals hold the truth? A bench is simulated many times with coloured noise, and its parameters
//! are found each time.
//!
//! `cargo run --release --example coverage -- [BENCH] [REPETITIONS] [SEED] [INHERITED] [RECORDINGS]`: the bench `drive`
//! (a servo drive on a load), `pump` (leakages of the servo pump) or `machine` (gap and friction of the axial piston
//! machine); how much of an error the next sample inherits (0.8), and from how many recordings together the parameters
//! are found each time (1).

#![allow(clippy::print_stdout, clippy::disallowed_methods, reason = "an example is asked and shows what it found")]

mod benches;

use benches::Bench;
use bramah::Interpolation;
use bramah::internals::analysis::identify::{Identification, IdentificationProblem, IdentifyMethod};
use bramah::internals::compile::compile;
use bramah::internals::diag::{Diagnostic, Sources, StageResult};
use bramah::internals::lower::LoweringOptions;
use bramah::internals::study::{Recording, RecordingRole, Study};
use bramah::world::MemoryWorld;
use bramah::{Request, Simulation};
use std::error::Error;
use std::path::Path;

/// Noise, as a part of the range.
const NOISE: f64 = 0.005;

/// Normal numbers from a congruential generator.
struct Dice(u64);

impl Dice {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        (-2.0 * (1.0 - self.uniform()).ln()).sqrt() * (std::f64::consts::TAU * self.uniform()).cos()
    }
}

fn times(bench: &Bench) -> Vec<f64> {
    (0..bench.inputs[0].values.len()).map(|k| bench.interval * k as f64).collect()
}

/// The signals without noise.
fn clean(bench: &Bench) -> Result<Vec<Vec<f64>>, Box<dyn Error>> {
    let mut simulation = Simulation::from_text(bench.model)?;
    let times = times(bench);
    for (name, value) in bench.truth {
        simulation.set(name, *value)?;
    }
    for input in &bench.inputs {
        let between = if input.held { Interpolation::Held } else { Interpolation::Linear };
        simulation.input(input.name, &times, &input.values, between)?;
    }
    simulation.stop_time(times[times.len() - 1]);
    simulation.settings().tolerance = 1e-9;
    simulation.settings().interval = bench.interval;
    let rows = simulation.run()?.trajectory;
    let signal = |name: &&str| {
        let column = rows.index(name).ok_or(format!("no {name}"))?;
        times.iter().map(|&t| rows.value(column, t).ok_or_else(|| "a row is missing".into())).collect()
    };
    bench.signals.iter().map(signal).collect()
}

/// The same with noise.
fn noisy(bench: &Bench, clean: &[Vec<f64>], inherited: f64, dice: &mut Dice) -> Recording {
    let mut signal = |values: &Vec<f64>| {
        let bounds = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |b, &v| (b.0.min(v), b.1.max(v)));
        let mut error = dice.normal();
        let mut next = |v: &f64| {
            error = inherited * error + (1.0 - inherited * inherited).sqrt() * dice.normal();
            v + NOISE * (bounds.1 - bounds.0) * error
        };
        values.iter().map(&mut next).collect()
    };
    Recording {
        file: "bench.csv".to_owned(),
        role: RecordingRole::Train,
        times: times(bench),
        inputs: bench.inputs.iter().map(|i| i.values.clone()).collect(),
        signals: clean.iter().map(&mut signal).collect(),
        pieces: 1,
    }
}

fn said(diagnostics: Vec<Diagnostic>) -> String {
    diagnostics.iter().map(|d| d.message.clone()).collect::<Vec<_>>().join("\n")
}

fn checked<T>(it: StageResult<T>) -> Result<T, String> {
    it.value.ok_or_else(|| said(it.diagnostics))
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let name = arguments.next().unwrap_or_else(|| "drive".to_owned());
    let bench = benches::named(&name).ok_or("there are benches `drive`, `pump` and `machine`")?;
    let repetitions: u32 = arguments.next().map_or(Ok(20), |a| a.parse())?;
    let mut dice = Dice(arguments.next().map_or(Ok(1), |a| a.parse())?);
    let inherited: f64 = arguments.next().map_or(Ok(0.8), |a| a.parse())?;
    let recordings: usize = arguments.next().map_or(Ok(1), |a| a.parse())?;
    let mut world = MemoryWorld::single("Bench.mo", bench.model);
    let head = "version = 1\nmodel = \"Bench.mo\"\nclass = \"Bench\"\n[[recordings]]\nfile = \"bench.csv\"\n";
    world.add("study.toml", format!("{head}{}", bench.study));
    let mut sources = Sources::default();
    let study = checked(Study::read(&world, Path::new("study.toml"), &mut sources))?;
    let request: Request = study.request();
    let model = compile(&world, &request, &LoweringOptions::default()).value.ok_or("the model is wrong")?;
    let bound = checked(study.bind(&model.flat))?;
    let clean = clean(&bench)?;
    let mut inside = vec![0u32; bench.truth.len()];
    for _ in 0..repetitions {
        let train: Vec<Recording> = (0..recordings).map(|_| noisy(&bench, &clean, inherited, &mut dice)).collect();
        let problem = IdentificationProblem::new(&model, &bound, &train).map_err(said)?;
        let found = Identification::new(&problem, &train, IdentifyMethod::Output).map_err(|d| d.message)?;
        let fit = found.fit().map_err(|d| d.message)?;
        for (j, (_, truth)) in bench.truth.iter().enumerate() {
            let (low, high) = fit.interval(&problem, j);
            inside[j] += u32::from(low <= *truth && *truth <= high);
        }
    }
    for ((name, truth), inside) in bench.truth.iter().zip(inside) {
        let part = 100.0 * f64::from(inside) / f64::from(repetitions);
        println!("{name} = {truth}: inside {inside} of {repetitions} intervals of 95 % ({part:.1} %)");
    }
    Ok(())
}
