//! Co-simulation: a speed controller in Rust at 1 kHz around a hydraulic drive in Modelica.

#![allow(clippy::print_stdout, clippy::disallowed_methods, reason = "an example shows what it found, with its time")]

use bramah::Simulation;
use std::time::Instant;

const DRIVE: &str = "
model Drive \"A pump drives another, as a motor with a flywheel; the input is the speed of the first\"
  inner Oil.Fluid oil;
  input Real n(unit = \"rad/s\", start = 0);
  Hydraulic.Tank tank;
  Hydraulic.Pump pump(V = 20e-6);
  Mechanical.Rotational.Speed shaft;
  Hydraulic.Volume line(V = 0.2e-3);
  Hydraulic.ReliefValve relief(p_set = 200e5);
  Hydraulic.Pump motor(V = 20e-6);
  Mechanical.Rotational.Inertia wheel(J = 0.05);
  Mechanical.Rotational.Damper load(d = 0.05);
  Mechanical.Rotational.Fixed wall;
equation
  shaft.w_ref = n;
  connect(shaft.flange, pump.flange);
  connect(tank.port, pump.port_b);
  connect(pump.port_a, line.port);
  connect(line.port, relief.port_a);
  connect(relief.port_b, tank.port);
  connect(line.port, motor.port_b);
  connect(motor.port_a, tank.port);
  connect(motor.flange, wheel.flange_a);
  connect(wheel.flange_b, load.flange_a);
  connect(load.flange_b, wall.flange);
end Drive;";

fn main() -> Result<(), bramah::Error> {
    let drive = Simulation::from_text(DRIVE)?;
    let mut run = drive.stepping()?;
    let (n, w, p) = (run.input("n")?, run.probe("wheel.w")?, run.probe("line.p")?);
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
