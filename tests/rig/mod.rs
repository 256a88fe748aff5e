//! What the tests of circuits share: compiling shipped and written ones, reading trajectories, comparing numbers.

#![allow(dead_code, reason = "each test file uses a part")]

use approx::relative_eq;
use bramah::Override;
use bramah::results::Trajectory;
use bramah::world::MemoryWorld;
use bramah::{Request, Simulation};
use std::path::PathBuf;

/// A shipped class, with parameters of its structure set.
pub fn shipped_with(name: &str, set: &[(&str, &str)]) -> Simulation {
    let overrides = set.iter().map(|(n, v)| Override { name: (*n).into(), value: (*v).into() }).collect();
    let request = Request { source: PathBuf::from(name), overrides, ..Request::default() };
    Simulation::compile(&MemoryWorld::default(), &request).unwrap_or_else(|e| panic!("{name}: {e}"))
}

/// A shipped class as it is.
pub fn shipped(name: &str) -> Simulation {
    shipped_with(name, &[])
}

/// A network without states: an orifice between a source of pressure and a tank.
pub const ORIFICE: &str = "
model Static
  inner Oil.ISOVG46 oil;
  Interfaces.RealInput p(unit = \"Pa\", nominal = 1e6);
  Hydraulic.PressureSource supply(useInput = true);
  Hydraulic.Orifice orifice(A = 1e-5);
  Hydraulic.Tank tank;
  Real q(unit = \"m3/s\", nominal = 1e-4) = orifice.q;
equation
  connect(p, supply.p_in);
  connect(supply.port, orifice.port_a);
  connect(orifice.port_b, tank.port);
end Static;
";

/// A model in the text of its components and equations.
pub fn circuit(components: &str, equations: &str) -> Simulation {
    let text = format!("model Rig\n{components}\nequation\n{equations}\nend Rig;\n");
    let request = Request { source: "rig.mo".into(), ..Request::default() };
    let world = MemoryWorld::single("rig.mo", text.clone());
    Simulation::compile(&world, &request).unwrap_or_else(|e| panic!("{text}\n{e}"))
}

/// The trajectory of a run that must reach its end.
pub fn run(simulation: &Simulation) -> Trajectory {
    simulation.run().unwrap_or_else(|e| panic!("{e}")).trajectory
}

pub fn column<'a>(t: &'a Trajectory, name: &str) -> &'a [f64] {
    t.column(name).unwrap_or_else(|| panic!("no column {name}"))
}

pub fn last(t: &Trajectory, name: &str) -> f64 {
    *column(t, name).last().expect("a row")
}

pub fn at(t: &Trajectory, name: &str, time: f64) -> f64 {
    let index = t.index(name).unwrap_or_else(|| panic!("no column {name}"));
    t.value(index, time).unwrap_or_else(|| panic!("{name} has no value at {time}"))
}

/// Mean over time of a variable, trapezoidal, from a time on.
pub fn mean_from(t: &Trajectory, name: &str, from: f64) -> f64 {
    let values = column(t, name);
    let first = t.times.partition_point(|&time| time < from);
    let area: f64 =
        (first + 1..t.len()).map(|i| (values[i] + values[i - 1]) / 2.0 * (t.times[i] - t.times[i - 1])).sum();
    area / (t.times[t.len() - 1] - t.times[first])
}

/// Fails unless two numbers agree to this part of the larger one.
#[track_caller]
pub fn near(found: f64, wanted: f64, relative: f64) {
    assert!(relative_eq!(found, wanted, epsilon = 0.0, max_relative = relative), "{found} instead of {wanted}");
}

/// Slope and intercept of the straight line through points, and the share of the variance that it explains.
pub fn line(points: impl Iterator<Item = (f64, f64)>) -> (f64, f64, f64) {
    let points: Vec<(f64, f64)> = points.collect();
    let n = points.len() as f64;
    let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / n;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    let sum = |of: &dyn Fn(f64, f64) -> f64| points.iter().map(|p| of(p.0 - x, p.1 - y)).sum::<f64>();
    let (xx, xy, yy) = (sum(&|x, _| x * x), sum(&|x, y| x * y), sum(&|_, y| y * y));
    (xy / xx, y - xy / xx * x, xy * xy / (xx * yy))
}

/// Numbers in 0..1, the same in every run.
pub struct Numbers(pub u64);

impl Numbers {
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }
}
