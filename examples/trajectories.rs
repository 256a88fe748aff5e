//! Reading results: columns with their units, values between rows, comparison of two runs, CSV.

#![allow(clippy::print_stdout, reason = "an example shows what it found")]

use bramah::Simulation;
use bramah::results::{CsvWriter, Trajectory};

fn csv(t: &Trajectory) -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let mut writer = CsvWriter::new(&mut bytes, &t.signals)?;
    for (row, &time) in t.times.iter().enumerate() {
        writer.row(time, t.columns.iter().map(|c| c[row]))?;
    }
    writer.finish()?;
    Ok(bytes)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut oscillator = Simulation::from_text(
        "model Oscillator parameter Real d(unit = \"N.s/m\") = 0.2; parameter Real m(unit = \"kg\") = 1;
           Real s(unit = \"m\", start = 1, fixed = true); Real v(unit = \"m/s\", start = 0, fixed = true);
         equation v = der(s); m*der(v) + d*v + 4*s = 0; end Oscillator;",
    )?;
    let run = oscillator.stop_time(10.0).run()?;
    let t = &run.trajectory;
    for (signal, column) in t.signals.iter().zip(&t.columns) {
        let (least, most) = column.iter().fold((f64::MAX, f64::MIN), |(a, b), v| (a.min(*v), b.max(*v)));
        println!("{} from {least:.3} to {most:.3} {}", signal.name, signal.unit);
    }
    let s = t.index("s").and_then(|i| t.value(i, std::f64::consts::PI)).unwrap_or(f64::NAN);
    println!("s = {s:.4} m at 3.1416 s");
    let text = String::from_utf8(csv(t)?)?;
    println!("{}", text.lines().take(3).collect::<Vec<_>>().join("\n"));
    Ok(())
}
