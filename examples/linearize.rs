//! A linear model at the start of a run: A, B, C, D, and its poles.

#![allow(clippy::print_stdout, reason = "an example shows what it found")]

use bramah::linear::poles;
use bramah::{Analyze, Simulation};

const TANKS: &str = "
model Tanks
  input Real u(unit = \"m3/s\", start = 1e-4);
  output Real y(unit = \"m\");
  parameter Real k(unit = \"m2.5/s\") = 1e-4;
  Real h_1(unit = \"m\", start = 1, fixed = true);
  Real h_2(unit = \"m\", start = 1, fixed = true);
equation
  0.1*der(h_1) = u - k*sqrt(h_1);
  0.2*der(h_2) = k*sqrt(h_1) - k*sqrt(h_2);
  y = h_2;
end Tanks;";

fn main() -> Result<(), bramah::Error> {
    let tanks = Simulation::from_text(TANKS)?;
    let linear = tanks.linearize(&tanks.state_at(None)?, &[], &[])?;
    println!("A ={}B ={}C ={}D ={}", linear.a, linear.b, linear.c, linear.d);
    for pole in poles(&linear) {
        println!("pole at {:.3e} 1/s", pole.re);
    }
    Ok(())
}
