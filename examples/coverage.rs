//! How often do 95 % intervals hold the truth? A bench is simulated many times with coloured noise, and its parameters
//! are found each time.
//!
//! `cargo run --release --example coverage -- [REPETITIONS] [SEED] [INHERITED] [RECORDINGS]`: how much of an error the next
//! sample inherits (0.8), and from how many recordings together the parameters are found each time (1).

#![allow(clippy::print_stdout, clippy::disallowed_methods, reason = "an example is asked and shows what it found")]

use bramah::analysis::identify::{Identification, Method, Problem};
use bramah::diag::{Checked, Diagnostic, Sources};
use bramah::lower::Options;
use bramah::solve::Interpolation;
use bramah::study::{Recording, Role, Study};
use bramah::world::MemoryWorld;
use bramah::{Request, Simulation, compile};
use std::error::Error;
use std::fmt::Write;
use std::path::Path;

/// A pump with leakage presses into a volume with a load orifice; the speed follows its command.
const MODEL: &str = "
model Bench
  parameter Real T(unit = \"s\", min = 0) = 0.03 \"Time constant of the drive\";
  parameter Real G(unit = \"l/(min.bar)\", min = 0) = 0.02 \"Leakage\";
  parameter Real q0(unit = \"l/min\") = 0 \"Offset of the flow sensor\";
  parameter Real D(unit = \"l\") = 0.01 \"Displacement\";
  parameter Real C(unit = \"l/bar\") = 2e-4 \"Capacity\";
  parameter Real R(unit = \"l/(min.bar0.5)\") = 0.8 \"Load\";
  input Real n_c(unit = \"1/min\");
  Real n(unit = \"1/min\", start = 500, fixed = true);
  Real p(unit = \"bar\", start = 30, fixed = true);
  output Real q(unit = \"l/min\");
  output Real p_m(unit = \"bar\");
equation
  T*der(n) = n_c - n;
  60*C*der(p) = D*n - G*p - R*sqrt(p);
  q = R*sqrt(p) + q0;
  p_m = p;
end Bench;";

const STUDY: &str = r#"
version = 1
model = "Bench.mo"
class = "Bench"
[inputs]
n_c = { column = "n_c", unit = "1/min", hold = true }
[signals]
q = { column = "q", unit = "l/min" }
p_m = { column = "p", unit = "bar" }
[[recordings]]
file = "bench.csv"
time = "t"
[parameters]
T = { min = 0.001, max = 1 }
G = { min = 0.0, max = 1 }
q0 = { min = -1, max = 1 }
"#;

/// The truth, in the order of the study.
const TRUTH: [(&str, f64); 3] = [("T", 0.04), ("G", 0.03), ("q0", 0.05)];
/// Samples, every 5 ms.
const SAMPLES: u32 = 400;
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

/// The bench without noise: times, command, flow, pressure.
fn clean() -> Result<Vec<[f64; 4]>, Box<dyn Error>> {
    let mut bench = Simulation::from_text(MODEL)?;
    let times: Vec<f64> = (0..SAMPLES).map(|k| 0.005 * f64::from(k)).collect();
    let command: Vec<f64> = (0..SAMPLES).map(|k| [500.0, 1500.0, 900.0, 1200.0][k as usize / 50 % 4]).collect();
    for (name, value) in TRUTH {
        bench.set(name, value)?;
    }
    bench.input("n_c", &times, &command, Interpolation::Held)?.stop_time(times[times.len() - 1]);
    bench.settings().tolerance = 1e-9;
    bench.settings().interval = 0.005;
    let rows = bench.run()?.trajectory;
    let column = |name: &str| rows.index(name).ok_or(format!("no {name}"));
    let (q, p) = (column("q")?, column("p_m")?);
    let value = |c: usize, t: f64| rows.value(c, t).ok_or("a row is missing");
    times.iter().zip(command).map(|(&t, n)| Ok([t, n, value(q, t)?, value(p, t)?])).collect()
}

/// The same with noise on flow and pressure.
fn noisy(clean: &[[f64; 4]], inherited: f64, dice: &mut Dice) -> Recording {
    let mut columns = vec![Vec::new(), Vec::new()];
    for (s, column) in columns.iter_mut().enumerate() {
        let values = || clean.iter().map(|r| r[2 + s]);
        let range = values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min);
        let mut error = dice.normal();
        column.extend(values().map(|v| {
            error = inherited * error + (1.0 - inherited * inherited).sqrt() * dice.normal();
            v + NOISE * range * error
        }));
    }
    Recording {
        file: "bench.csv".to_owned(),
        role: Role::Train,
        times: clean.iter().map(|r| r[0]).collect(),
        inputs: vec![clean.iter().map(|r| r[1]).collect()],
        signals: columns,
    }
}

fn said(diagnostics: Vec<Diagnostic>) -> String {
    diagnostics.iter().map(|d| d.message.clone()).collect::<Vec<_>>().join("\n")
}

fn checked<T>(it: Checked<T>) -> Result<T, String> {
    it.value.ok_or_else(|| said(it.diagnostics))
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let repetitions: u32 = arguments.next().map_or(Ok(20), |a| a.parse())?;
    let mut dice = Dice(arguments.next().map_or(Ok(1), |a| a.parse())?);
    let inherited: f64 = arguments.next().map_or(Ok(0.8), |a| a.parse())?;
    let recordings: usize = arguments.next().map_or(Ok(1), |a| a.parse())?;
    let clean = clean()?;
    let mut header = String::from("t,n_c,q,p\n");
    clean.iter().try_for_each(|[t, n, q, p]| writeln!(header, "{t},{n},{q},{p}"))?;
    let mut world = MemoryWorld::single("Bench.mo", MODEL);
    world.add("study.toml", STUDY);
    world.add("bench.csv", header);
    let mut sources = Sources::default();
    let study = checked(Study::read(&world, Path::new("study.toml"), &mut sources))?;
    let request: Request = study.request();
    let model = compile(&world, &request, &Options::default()).value.ok_or("the model is wrong")?;
    let bound = checked(study.bind(&model.flat))?;
    let mut inside = [0u32; TRUTH.len()];
    for _ in 0..repetitions {
        let train: Vec<Recording> = (0..recordings).map(|_| noisy(&clean, inherited, &mut dice)).collect();
        let problem = Problem::new(&model, &bound, &train).map_err(said)?;
        let found = Identification::new(&problem, &train, Method::Output).map_err(|d| d.message)?;
        let fit = found.fit().map_err(|d| d.message)?;
        for (j, (_, truth)) in TRUTH.iter().enumerate() {
            let (low, high) = fit.interval(&problem, j);
            inside[j] += u32::from(low <= *truth && *truth <= high);
        }
    }
    for ((name, truth), inside) in TRUTH.iter().zip(inside) {
        let part = 100.0 * f64::from(inside) / f64::from(repetitions);
        println!("{name} = {truth}: inside {inside} of {repetitions} intervals of 95 % ({part:.1} %)");
    }
    Ok(())
}
