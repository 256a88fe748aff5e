//! A circuit built in Rust, with one component declared in text; what is wrong is told as by the command.

#![allow(clippy::print_stdout, reason = "an example shows what it found")]

use bramah::Circuit;

fn press() -> Circuit {
    let mut circuit = Circuit::new("Press");
    circuit
        .declare("model Pump extends Hydraulic.FlowSource(q = 1e-4); end Pump;")
        .inner("oil", "Oil.ISOVG32")
        .add("tank", "Hydraulic.Tank")
        .add("pump", "Pump")
        .add("volume", "Hydraulic.Volume")
        .set("V", "0.5 l")
        .add("relief", "Hydraulic.ReliefValve")
        .set("p_set", "150 bar")
        .connect("pump.port", "volume.port")
        .connect("volume.port", "relief.port_a");
    circuit
}

fn main() -> Result<(), bramah::Error> {
    // the outlet of the relief valve is left open: an error with its place in the text
    if let Err(error) = press().compile() {
        println!("{}", error.full());
    }
    let mut circuit = press();
    circuit.connect("relief.port_b", "tank.port");
    println!("{}", circuit.text());
    let outcome = circuit.compile()?.run()?;
    let p = outcome.trajectory.column("volume.p").and_then(|p| p.last()).copied().unwrap_or(f64::NAN);
    println!("pressure after 1 s: {:.1} bar", p / 1e5);
    Ok(())
}
