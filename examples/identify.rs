//! Parameters from a recording, with standard deviations. The recording is made here, with another truth and noise.

#![allow(clippy::print_stdout, reason = "an example shows what it found")]

use bramah::world::MemoryWorld;
use bramah::{Interpolation, Request, Simulation, identify};
use std::fmt::Write;
use std::path::Path;

const MODEL: &str = "
model Tank
  input Real u(unit = \"V\");
  parameter Real k_p(unit = \"m/(s.V)\") = 0.1;
  parameter Real a(unit = \"m0.5/s\") = 0.1;
  Real h(unit = \"m\", start = 0.5, fixed = true);
equation
  der(h) = k_p*u - a*sqrt(h);
end Tank;";

const STUDY: &str = r#"
version = 1
model = "Tank.mo"
class = "Tank"
[inputs]
u = { column = "u", unit = "V", hold = true }
[signals]
h = { variable = "h", column = "h", unit = "m" }
[[recordings]]
file = "bench.csv"
role = "train"
time = "t"
[parameters]
k_p = { min = 0.01, max = 1 }
a = { min = 0.01, max = 1 }
"#;

/// The tank with k_p = 0.15 and a = 0.2, its level read to a millimetre.
fn recording(world: &MemoryWorld) -> Result<String, bramah::Error> {
    let mut bench = Simulation::compile(world, &Request { source: "Tank.mo".into(), ..Request::default() })?;
    let times: Vec<f64> = (0..400).map(|k| 0.1 * f64::from(k)).collect();
    let u: Vec<f64> = (0..400).map(|k| if k / 50 % 2 == 0 { 2.0 } else { 0.5 }).collect();
    bench.set("k_p", 0.15)?.set("a", 0.2)?.input("u", &times, &u, Interpolation::Held)?.stop_time(40.0);
    let t = bench.run()?.trajectory;
    let h = t.index("h").unwrap_or(0);
    let mut text = String::from("t,u,h\n");
    for (&time, u) in times.iter().zip(u) {
        let level = (t.value(h, time).unwrap_or(f64::NAN) * 1e3).round() / 1e3;
        let _ = writeln!(text, "{time},{u},{level}");
    }
    Ok(text)
}

fn main() -> Result<(), bramah::Error> {
    let mut world = MemoryWorld::single("Tank.mo", MODEL);
    world.add("study.toml", STUDY);
    world.add("bench.csv", recording(&world)?);
    let found = identify(&world, Path::new("study.toml"))?;
    println!("{}", found.words);
    println!("k_p = {}", found.report.parameters["k_p"]["value"]);
    Ok(())
}
