//! A circuit that ships with bramah, run with two settings of a parameter.

#![allow(clippy::print_stdout, reason = "an example shows what it found")]

use bramah::Simulation;

fn main() -> Result<(), bramah::Error> {
    let mut bench = Simulation::shipped("ServoPump.DeadZone")?;
    bench.record(&["N", "p_A"])?;
    for ramp in [0.5, 1.0] {
        let outcome = bench.set("ramp", ramp)?.run()?;
        let t = &outcome.trajectory;
        let first = t.columns[1].iter().position(|p| *p > 100e5);
        let speed = first.map_or(f64::NAN, |i| t.columns[0][i]);
        println!("100 bar at {speed:.1} r/min, {} steps", outcome.statistics.steps);
    }
    Ok(())
}
