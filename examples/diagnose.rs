//! Where model and machine differ: a mass on a spring whose machine has dry friction, which the model lacks. The recordings are
//! made here.

#![allow(clippy::print_stdout, reason = "an example shows what it found")]

use bramah::world::MemoryWorld;
use bramah::{Interpolation, Request, Simulation, diagnose};
use std::fmt::Write;
use std::path::Path;

const MODEL: &str = "
package Slide
  model Nominal
    input Real u(unit = \"N\");
    Mechanical.Translational.Mass mass(m = 10, s(start = 0, fixed = true), v(start = 0, fixed = true));
    Mechanical.Translational.SpringDamper spring(c = 400, d = 30);
    Mechanical.Translational.Fixed wall;
    Mechanical.Translational.Force push;
  equation
    push.f = u;
    connect(wall.flange, spring.flange_a);
    connect(spring.flange_b, mass.flange_a);
    connect(push.flange, mass.flange_b);
  end Nominal;
  model Bench
    extends Nominal;
    Mechanical.Translational.SmoothSupportFriction rub(f_c = 4);
  equation
    connect(rub.flange_a, mass.flange_b);
  end Bench;
end Slide;";

const STUDY: &str = r#"
version = 1
model = "Slide.mo"
class = "Slide.Nominal"
[inputs]
u = { column = "u", unit = "N", hold = true }
[signals]
s = { variable = "mass.s", column = "s", unit = "m" }
v = { variable = "mass.v", column = "v", unit = "m/s" }
[[recordings]]
file = "train.csv"
role = "train"
time = "t"
[[recordings]]
file = "held.csv"
role = "held"
time = "t"
[parameters]
"mass.m" = { sigma = "2 %" }
"spring.c" = { sigma = "2 %" }
"spring.d" = { sigma = "10 %" }
"#;

/// The bench under steps of force, with noise; numbers of a normal distribution, the same in every run.
fn recording(world: &MemoryWorld, mut seed: u64) -> Result<String, bramah::Error> {
    let mut normal = || {
        let mut uniform = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1_u64 << 53) as f64
        };
        (0..12).map(|_| uniform()).sum::<f64>() - 6.0
    };
    let request = Request { source: "Slide.mo".into(), model: Some("Slide.Bench".into()), ..Request::default() };
    let mut bench = Simulation::compile(world, &request)?;
    let times: Vec<f64> = (0..1500).map(|k| 0.004 * f64::from(k)).collect();
    let steps: Vec<f64> = (0..20).map(|_| 20.0 * normal()).collect();
    let force: Vec<f64> = (0..1500).map(|k| steps[k / 75]).collect();
    bench.input("u", &times, &force, Interpolation::Held)?.stop_time(5.996);
    let t = bench.run()?.trajectory;
    let at = |name: &str, time: f64| t.index(name).and_then(|i| t.value(i, time)).unwrap_or(f64::NAN);
    let mut text = String::from("t,u,s,v\n");
    for (&time, u) in times.iter().zip(force) {
        let (s, v) = (at("mass.s", time) + 2e-4 * normal(), at("mass.v", time) + 2e-3 * normal());
        let _ = writeln!(text, "{time},{u},{s},{v}");
    }
    Ok(text)
}

fn main() -> Result<(), bramah::Error> {
    let mut world = MemoryWorld::single("Slide.mo", MODEL);
    let (train, held) = (recording(&world, 11)?, recording(&world, 12)?);
    world.add("train.csv", train);
    world.add("held.csv", held);
    world.add("study.toml", STUDY);
    println!("{}", diagnose(&world, Path::new("study.toml"))?.words());
    Ok(())
}
