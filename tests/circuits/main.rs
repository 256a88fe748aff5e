//! Tests of circuits: physics, balances, examples, and what each component does.

mod assemblies;
mod balances;
mod benches;
mod closed_forms;
mod conservation;
#[path = "../disk/mod.rs"]
mod disk;
mod drives;
mod examples;
mod limits;
mod line_friction;
mod machines;
mod mobile;
mod physics;
mod pneumatics;
#[path = "../rig/mod.rs"]
mod rig;
mod signals;
mod thermo_hydraulics;
mod valves;
mod water_hammer;
