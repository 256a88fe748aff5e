//! Rows as they come: a function that sees each one and may end the run; the run goes on later from there.

#![allow(clippy::print_stdout, reason = "an example shows what it found")]

use bramah::Simulation;
use std::ops::ControlFlow;

fn main() -> Result<(), bramah::Error> {
    let mut bench = Simulation::shipped("ServoPump.DeadZone")?;
    bench.record(&["N", "p_A"])?;
    let mut highest = 0.0_f64;
    let stopped = bench.run_rows(None, |_, row| {
        highest = highest.max(row[1]);
        if row[1] > 150e5 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    })?;
    println!("stopped at {:.1} s and {:.1} bar", stopped.state.time, highest / 1e5);

    let rest = bench.run_from(&stopped.state)?;
    println!("went on to {:.1} s in {} steps", rest.state.time, rest.statistics.steps);

    // a panic in the function is an error like any other, and the simulation remains of use
    std::panic::set_hook(Box::new(|_| {}));
    let error = bench.run_rows(None, |_, _| panic!("I have seen enough")).map(|_| ());
    println!("{}", error.err().map_or_else(String::new, |e| e.to_string()));
    Ok(())
}
