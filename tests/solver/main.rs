//! Tests of the solver: accuracy, steps, checkpoints, stiff problems, sweeps, and input that is wrong on purpose.

mod accuracy;
mod checkpoint;
#[path = "../disk/mod.rs"]
mod disk;
mod networks;
mod robust;
mod stepping;
mod stiff;
mod sweep;
