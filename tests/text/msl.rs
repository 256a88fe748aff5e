//! A sample of the examples of the Modelica Standard Library, from each of its packages: what docs/validation/libraries.md
//! does not list as refused compiles.

#![allow(clippy::disallowed_methods, clippy::print_stdout, reason = "tests read their own files")]

use crate::disk;

use bramah::{Request, Simulation};
use disk::Disk;
use std::path::{Path, PathBuf};

const SAMPLE: [&str; 20] = [
    "Modelica.Blocks.Examples.PID_Controller",
    "Modelica.Blocks.Examples.LogicalNetwork1",
    "Modelica.ComplexBlocks.Examples.TestConversionBlock",
    "Modelica.Electrical.Analog.Examples.ChuaCircuit",
    "Modelica.Electrical.Digital.Examples.FullAdder",
    "Modelica.Electrical.Machines.Examples.InductionMachines.IMC_DOL",
    "Modelica.Electrical.QuasiStatic.SinglePhase.Examples.SeriesResonance",
    "Modelica.Fluid.Examples.Tanks.ThreeTanks",
    "Modelica.Magnetic.FluxTubes.Examples.BasicExamples.SaturatedInductor",
    "Modelica.Mechanics.MultiBody.Examples.Elementary.Pendulum",
    "Modelica.Mechanics.MultiBody.Examples.Elementary.DoublePendulum",
    "Modelica.Mechanics.MultiBody.Examples.Elementary.PointGravity",
    "Modelica.Mechanics.MultiBody.Examples.Loops.Fourbar1",
    "Modelica.Mechanics.Rotational.Examples.CoupledClutches",
    "Modelica.Mechanics.Rotational.Examples.First",
    "Modelica.Mechanics.Translational.Examples.Oscillator",
    "Modelica.Media.Examples.SimpleLiquidWater",
    "Modelica.StateGraph.Examples.ControlledTanks",
    "Modelica.Thermal.FluidHeatFlow.Examples.SimpleCooling",
    "Modelica.Thermal.HeatTransfer.Examples.TwoMasses",
];

fn folder(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

#[test]
fn examples_of_each_package_compile_as_the_page_says() {
    let library = folder("../shared/libraries/MSL");
    if !library.is_dir() {
        println!("skipped: no folder {}", library.display());
        return;
    }
    let page = std::fs::read_to_string(folder("docs/validation/libraries.md")).expect("the page is there");
    let mut failed = Vec::new();
    for class in SAMPLE {
        assert!(!page.contains(&format!("| {class} | E")), "{class} is refused by the page");
        let request = Request { source: class.into(), libraries: vec![library.clone()], ..Request::default() };
        if let Err(error) = Simulation::compile(&Disk, &request) {
            failed.push(format!("{class}: {error}"));
        }
    }
    assert!(failed.is_empty(), "{}", failed.join("\n"));
}
