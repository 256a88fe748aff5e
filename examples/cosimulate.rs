//! Co-simulation: a speed controller in Rust at 1 kHz around a hydrostatic drive in Modelica.

#![allow(clippy::print_stdout, clippy::disallowed_methods, reason = "an example shows what it found, with its time")]

use bramah::Simulation;
use std::time::Instant;

const DRIVE: &str = r#"
model Drive "A pump drives a motor with a flywheel; the input is the speed of the pump"
  inner Oil.Fluid oil;
  input Real n(unit = "rad/s", start = 0);
  parameter Real D(unit = "m3/rad") = 3.2e-6 "Displacement of pump and motor";
  parameter Real J(unit = "kg.m2") = 0.05;
  parameter Real d(unit = "N.m.s/rad") = 0.05;
  Hydraulic.Tank tank;
  Hydraulic.Volume line(V = 0.2e-3);
  Hydraulic.ReliefValve relief(p_set = 200e5);
  Real w(unit = "rad/s", start = 0, fixed = true, nominal = 100);
  Machines machines;
  model Machines "What both machines take from the line"
    Interfaces.HydraulicPort port;
  end Machines;
equation
  connect(line.port, machines.port);
  connect(line.port, relief.port_a);
  connect(relief.port_b, tank.port);
  machines.port.q = D*(w - n);
  J*der(w) = D*line.p - d*w;
end Drive;"#;

fn main() -> Result<(), bramah::Error> {
    let drive = Simulation::from_text(DRIVE)?;
    let mut run = drive.stepping()?;
    let (n, w, p) = (run.input("n")?, run.probe("w")?, run.probe("line.p")?);
    let (set_point, dt, seconds) = (100.0, 1e-3, 10.0);
    let (mut integral, mut highest, mut worst) = (0.0, 0.0_f64, 0.0_f64);
    let begun = Instant::now();
    for k in 1..=10_000_u32 {
        let step = Instant::now();
        let error = set_point - run.get(w);
        integral += 0.5 * error * dt;
        run.set(n, (0.5 * error + integral).clamp(-300.0, 300.0));
        run.step_to(f64::from(k) * dt)?;
        highest = highest.max(run.get(p));
        worst = worst.max(step.elapsed().as_secs_f64());
    }
    let factor = seconds / begun.elapsed().as_secs_f64();
    println!("speed {:.2} rad/s after {seconds} s, highest pressure {:.1} bar", run.get(w), highest / 1e5);
    let s = run.statistics();
    println!("{} steps of the integrator, {} restarts", s.steps, s.restarts);
    println!("{factor:.0} times faster than real time, longest step {:.3} ms", 1e3 * worst);
    Ok(())
}
